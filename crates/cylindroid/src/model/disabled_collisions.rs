//! Pairs of links whose shapes do not collide.
//!
//! Checked  tests/collision/files.rs::mjcf_types_affinities_and_exclusions

use super::mechanism::Mechanism;

impl Mechanism {
    /// Pairs of links whose shapes do not collide, by the file (`<exclude>` of MJCF).
    #[must_use]
    pub fn disabled_collisions(&self) -> &[[usize; 2]] {
        &self.data.disabled_collisions
    }
}
