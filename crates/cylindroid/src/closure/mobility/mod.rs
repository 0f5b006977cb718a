//! Mobility: the motions that the constraint leaves, their counts, and which of them are finite.
//!
//! `motion_space` is the kernel of the constraint, `relation` its projection on actuated joints and
//! object; `report` counts the kinds of motion and force, `blocks` partitions the motions. Read these
//! four first.
//! `actuation_map` (from actuated to all joint velocities) and `reference_twists` serve control
//! and screw systems. `limbs` computes the screw systems of each limb between ground and platform,
//! with `limb_graph` and `limb_motion`. `lyapunov_schmidt`, `rays`, `branches`, `second_order` and
//! `finite_mobility` go beyond first order.

pub(crate) mod actuation_map;
pub(crate) mod blocks;
pub(crate) mod branches;
pub(crate) mod compression;
pub(crate) mod coordinate_partitioning;
pub(crate) mod counts;
pub(crate) mod finite_mobility;
pub(crate) mod force_spaces;
pub(crate) mod limb_graph;
pub(crate) mod limb_motion;
pub(crate) mod limbs;
pub(crate) mod lyapunov_schmidt;
pub(crate) mod motion_space;
pub(crate) mod rays;
pub(crate) mod reference_twists;
pub(crate) mod relation;
pub(crate) mod report;
pub(crate) mod second_order;
pub(crate) mod subspace;
