//! Joints: what they are, where they sit, how far and how fast they go.
//!
//! Checked  tests/formats/mechanism_file.rs::every_joint_type_is_read, tests/it/graph.rs

use std::ops::Range;

use crate::spatial::{Pose, Vec3};

/// The kind of a joint, in the order of its coordinates.
///
/// Every coordinate has one number in `q` and one in the rates. For all kinds but `Spherical` and
/// `Free` the rate is the derivative of the coordinate. Those two have no global coordinates of
/// that kind without a singular place; their numbers in `q` are a rotation vector, and their rates
/// are the velocity itself, in the axes of the child (`Mechanism::integrate` moves `q` by rates).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum JointKind {
    /// No motion.
    Fixed,
    /// Turns about the axis (rad), within limits.
    Revolute,
    /// Turns about the axis (rad) without end.
    Continuous,
    /// Slides along the axis (m).
    Prismatic,
    /// Turns about the axis (rad) and moves `pitch` [m/rad] times as far along it.
    Helical {
        /// Advance per radian [m/rad].
        pitch: f64,
    },
    /// Slides along the axis (m) and turns about it (rad).
    Cylindrical,
    /// Turns about the axis (rad), then about the second axis, carried along (rad).
    Universal {
        /// The second axis, in the joint frame at zero.
        second: Vec3,
    },
    /// Turns about a point: rotation vector (rad); rates are the angular velocity in child axes.
    Spherical,
    /// Slides in the plane normal to the axis along its x and y (m), then turns about the axis (rad).
    Planar,
    /// Moves freely: position (m) and rotation vector (rad); rates are the twist in child axes.
    Free,
}

impl JointKind {
    /// Number of coordinates.
    #[must_use]
    pub const fn dof(self) -> usize {
        match self {
            Self::Fixed => 0,
            Self::Revolute | Self::Continuous | Self::Prismatic | Self::Helical { .. } => 1,
            Self::Cylindrical | Self::Universal { .. } => 2,
            Self::Spherical | Self::Planar => 3,
            Self::Free => 6,
        }
    }

    /// True if position limits mean something: not where the rates are not the derivative of `q`,
    /// on rotation vectors and free bodies.
    #[must_use]
    pub const fn takes_position_limits(self) -> bool {
        !matches!(self, Self::Spherical | Self::Free)
    }

    /// The field's word for it, as in files and tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Fixed => "fixed",
            Self::Revolute => "revolute",
            Self::Continuous => "continuous",
            Self::Prismatic => "prismatic",
            Self::Helical { .. } => "helical",
            Self::Cylindrical => "cylindrical",
            Self::Universal { .. } => "universal",
            Self::Spherical => "spherical",
            Self::Planar => "planar",
            Self::Free => "free",
        }
    }
}

/// How far, fast and hard a coordinate may go. Infinite where nothing is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Smallest position [rad or m]; spherical and free joints have none.
    pub lower: f64,
    /// Largest position [rad or m]; spherical and free joints have none.
    pub upper: f64,
    /// Largest speed [rad/s or m/s].
    pub velocity: f64,
    /// Largest acceleration [rad/s^2 or m/s^2].
    pub acceleration: f64,
    /// Largest torque or force [N m or N].
    pub effort: f64,
}

impl Limits {
    /// No limits.
    pub const NONE: Self = Self {
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
        velocity: f64::INFINITY,
        acceleration: f64::INFINITY,
        effort: f64::INFINITY,
    };

    /// True if some finite position is within them.
    pub(super) fn leave_a_position(&self) -> bool {
        self.lower <= self.upper && self.lower < f64::INFINITY && self.upper > f64::NEG_INFINITY
    }
}

impl Default for Limits {
    fn default() -> Self {
        Self::NONE
    }
}

/// A joint that follows another: its position is `multiplier * q + offset`.
#[derive(Debug, Clone, PartialEq)]
pub struct Mimic {
    /// Name of the joint that is followed.
    pub joint: String,
    /// Ratio of the motions.
    pub multiplier: f64,
    /// Position when the followed joint is at zero [rad or m].
    pub offset: f64,
}

/// A joint of a mechanism.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Its name.
    pub name: String,
    /// Its kind.
    pub kind: JointKind,
    /// Index of the parent link.
    pub parent: usize,
    /// Index of the child link.
    pub child: usize,
    /// The joint frame at zero, seen from the parent link.
    pub parent_from_joint: Pose,
    /// The child's link frame, seen from the joint frame that moves it: the identity but for
    /// formats whose bodies have frames of their own (MJCF, SDF).
    pub joint_from_child: Pose,
    /// Unit axis in the joint frame (z where the kind has none).
    pub axis: Vec3,
    /// Limits as in the file; those of a joint with several coordinates hold for each.
    pub limits: Limits,
    /// The joint it follows, if it does.
    pub mimic: Option<Mimic>,
    /// Its entries in `q`; those of the followed joint for a mimic joint.
    pub coordinates: Range<usize>,
    /// True if a motor actuators it. All joints of a serial robot are actuated unless the file says no.
    pub actuated: bool,
}
