//! The form in which kinematics reads a mechanism: a list of moving frames, parents first.
//!
//! Every joint is written as one or more nodes that turn about or slide along their own z axis
//! (or move freely); fixed joints and fixed links are folded into the placements.

use crate::spatial::AlignedPose;

/// A moving frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Node {
    /// Slot of the parent: 0 is the ground, node `i` is slot `i + 1`.
    pub(crate) parent: usize,
    /// The frame at zero, seen from the parent.
    pub(crate) placement: AlignedPose,
    /// What it does.
    pub(crate) kind: NodeKind,
    /// Its first coordinate.
    pub(crate) coordinate: usize,
    /// Mimic ratio (1 for joints of their own).
    pub(crate) multiplier: f64,
    /// Mimic offset (0 for joints of their own).
    pub(crate) offset: f64,
}

/// What a node does with its coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum NodeKind {
    /// Nothing: the tool at the end of a chain. Its coordinate is not read for anything.
    Fixed,
    /// Turns about z.
    Revolute,
    /// Slides along z.
    Prismatic,
    /// Turns about z and advances by the pitch [m/rad].
    Helical(f64),
    /// Rotation vector; rates are the angular velocity in its own axes.
    Spherical,
    /// Position and rotation vector; rates are the twist in its own axes.
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
