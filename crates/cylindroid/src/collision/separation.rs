//! Distance, closest points and normal of two shapes.
//!
//! Checked  tests/collision/laws.rs::points_normal_and_distance_agree

use crate::spatial::Vec3;

/// The separation of two shapes a and b, in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Separation {
    /// Distance (m); negative: penetration depth.
    pub distance: f64,
    /// Closest point of a; in penetration the deepest one.
    pub point_a: Vec3,
    /// Closest point of b.
    pub point_b: Vec3,
    /// Unit normal from a to b: `point_b - point_a = distance * normal`.
    pub normal: Vec3,
}

impl Separation {
    /// The same seen from b.
    #[must_use]
    pub fn reversed(self) -> Self {
        let Self { distance, point_a, point_b, normal } = self;
        Self { distance, point_a: point_b, point_b: point_a, normal: -normal }
    }
}
