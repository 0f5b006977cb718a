//! Options of a collision model.

/// The shape that stands for a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum MeshShape {
    /// The convex hull of its vertices.
    #[default]
    ConvexHull,
    /// The smallest capsule that was found around its vertices: contains the mesh, costs less.
    Capsule,
}

impl MeshShape {
    /// All of them, with the names used on the command line and in Python.
    pub const NAMES: [(&'static str, Self); 2] =
        [("convex_hull", Self::ConvexHull), ("capsule", Self::Capsule)];

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::NAMES.into_iter().find(|(_, m)| *m == self).map_or("", |(name, _)| name)
    }
}

/// Options of [`CollisionModel::new`](super::CollisionModel::new).
#[derive(Debug, Clone, PartialEq)]
pub struct CollisionOptions {
    /// The shape that stands for a mesh.
    pub meshes: MeshShape,
    /// Pairs of links that are not watched, by name: `disable_collisions` of an SRDF.
    pub disabled: Vec<[String; 2]>,
    /// Number of random configurations within the limits: a pair that touches in all of them, or
    /// in none and not on the way down from the nearest of them either, is not watched; 0 keeps
    /// all pairs.
    pub samples: usize,
    /// Seed of the random configurations.
    pub seed: u64,
    /// A pair whose distance stays above this (m) never touches.
    pub never_margin: f64,
}

impl Default for CollisionOptions {
    fn default() -> Self {
        Self {
            meshes: MeshShape::ConvexHull,
            disabled: Vec::new(),
            samples: 200,
            seed: 0,
            never_margin: crate::tolerance::NEVER_NEAR,
        }
    }
}
