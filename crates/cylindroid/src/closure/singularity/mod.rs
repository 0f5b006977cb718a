//! Singularities: one verdict on a configuration, from which every sentence about it follows.
//!
//! `generic_mobility` finds the counts that the mechanism has at regular configurations;
//! `singularity_types` compares the counts at hand with them (type I, II, III, configuration
//! space, passive) and measures the distance to each type; `diagnosis` adds the motions lost and
//! gained, as screws. Read them in this order. `operation_modes` searches for the modes of motion
//! of a mechanism, with their counts, and `crossings` for the configurations in which they meet;
//! `zlatanov` states the six types of Zlatanov; `transmission`
//! measures how well the limbs transmit motion and force.

mod crossings;
pub(crate) mod diagnosis;
pub(crate) mod generic_mobility;
pub(crate) mod operation_modes;
pub(crate) mod singularity_types;
pub(crate) mod transmission;
pub(crate) mod verdict;
pub(crate) mod zlatanov;
