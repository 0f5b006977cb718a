//! The dimension of a mechanism: the plane or space.

/// The dimension of the space in which a mechanism moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Dimension {
    /// The plane x-y of the world: two translations and the rotation about z.
    Planar,
    /// Space.
    #[default]
    Spatial,
}

impl Dimension {
    /// 2 or 3, as in files.
    #[must_use]
    pub const fn number(self) -> usize {
        match self {
            Self::Planar => 2,
            Self::Spatial => 3,
        }
    }

    /// The components of a twist `[v; w]` or wrench `[f; m]` of a body: in the plane x, y and the
    /// rotation about z.
    #[must_use]
    pub const fn components(self) -> &'static [usize] {
        match self {
            Self::Planar => &[0, 1, 5],
            Self::Spatial => &[0, 1, 2, 3, 4, 5],
        }
    }

    /// Degrees of freedom of a body: 3 in the plane, 6 in space.
    #[must_use]
    pub const fn freedoms(self) -> usize {
        self.components().len()
    }
}
