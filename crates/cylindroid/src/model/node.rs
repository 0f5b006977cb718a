//! Nodes: the form of a mechanism that kinematics reads, a list of moving frames, parents first.
//!
//! Every joint is one or more nodes that rotate about or translate along their own z axis (or move
//! freely); fixed joints and fixed links are merged into the placements.

use crate::spatial::AlignedPose;

/// A moving frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Node {
    /// Slot of the parent: 0 is the ground, node `i` is slot `i + 1`.
    pub(crate) parent: usize,
    /// The frame at zero, seen from the parent.
    pub(crate) placement: AlignedPose,
    /// Its kind.
    pub(crate) kind: NodeKind,
    /// Its first coordinate.
    pub(crate) coordinate: usize,
    /// Mimic ratio (1 for independent joints); for `Spherical`, the factor of rotation vector and
    /// velocity: -1 for reversed joints.
    pub(crate) multiplier: f64,
    /// Mimic offset (0 for independent joints).
    pub(crate) offset: f64,
}

/// The kind of a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum NodeKind {
    /// Fixed: the tool at the end of a chain. Its coordinate is not used.
    Fixed,
    /// Rotation about z.
    Revolute,
    /// Translation along z.
    Prismatic,
    /// Rotation about z with an advance of the pitch [m/rad].
    Helical(f64),
    /// Rotation vector; its velocity is the angular velocity in its own axes.
    Spherical,
    /// Position and rotation vector; its velocity is the twist in its own axes.
    Free,
}

impl NodeKind {
    /// Number of coordinates.
    pub(crate) const fn dof(self) -> usize {
        match self {
            Self::Fixed => 0,
            Self::Revolute | Self::Prismatic | Self::Helical(_) => 1,
            Self::Spherical => 3,
            Self::Free => 6,
        }
    }
}
