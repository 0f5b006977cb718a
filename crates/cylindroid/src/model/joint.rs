//! Joints: their kinds, frames and limits.
//!
//! Checked  tests/formats/mechanism_file.rs::every_joint_type_is_read, tests/it/graph.rs,
//!          tests in this file

use std::ops::Range;

use crate::scalar::clamp;
use crate::spatial::{Pose, Vec3};
use crate::tolerance::LIMIT_MET;

/// The kind of a joint, with its coordinates in order.
///
/// Every coordinate has one entry in `q` and one in the joint velocities. For all kinds but
/// `Spherical` and `Free`, the velocity is the derivative of the coordinate. Those two have no
/// global coordinates without a singularity; their entries in `q` are a rotation vector (and a
/// position), and their velocities are the twist in the axes of the child (`Mechanism::integrate`
/// advances `q` by velocities).
///
/// A [reversed](Joint::reversed) joint has the same `q`, and the inverse motion of its kind. If it is
/// spherical, its velocity is the angular velocity of its second link (the parent in the tree)
/// relative to its first, in the axes of the first: again in those of the child. If it is free, the
/// velocities of its position are the derivatives, in the same axes.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum JointKind {
    /// No motion.
    Fixed,
    /// Rotation about the axis (rad), within limits.
    Revolute,
    /// Rotation about the axis (rad), unlimited.
    Continuous,
    /// Translation along the axis (m).
    Prismatic,
    /// Rotation about the axis (rad) with a translation of `pitch` [m/rad] along it.
    Helical {
        /// Advance per radian [m/rad].
        pitch: f64,
    },
    /// Translation along the axis (m) and rotation about it (rad).
    Cylindrical,
    /// Rotation about the axis (rad), then about the second axis, which it carries (rad).
    Universal {
        /// The second axis, in the joint frame at zero.
        second: Vec3,
    },
    /// Rotation about a point: rotation vector (rad); its velocity is the angular velocity in child
    /// axes.
    Spherical,
    /// Translation in the plane normal to the axis along its x and y (m), then rotation about the
    /// axis (rad).
    Planar,
    /// Free motion: position (m) and rotation vector (rad); its velocity is the twist in child
    /// axes.
    Free,
}

/// What a joint keeps in place, on both of its links.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum JointLocus {
    /// A line: the point at which a file draws the joint on it means nothing.
    Axis,
    /// A point.
    Center,
    /// Neither: slides, planar and free joints have directions only.
    Nowhere,
}

impl JointKind {
    /// What it keeps in place.
    pub(crate) const fn locus(self) -> JointLocus {
        match self {
            Self::Revolute | Self::Continuous | Self::Helical { .. } | Self::Cylindrical => {
                JointLocus::Axis
            }
            Self::Universal { .. } | Self::Spherical => JointLocus::Center,
            Self::Fixed | Self::Prismatic | Self::Planar | Self::Free => JointLocus::Nowhere,
        }
    }

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

    /// True if position limits are meaningful: not for rotation vectors and free bodies, whose
    /// velocities are not the derivative of `q`.
    #[must_use]
    pub const fn takes_position_limits(self) -> bool {
        !matches!(self, Self::Spherical | Self::Free)
    }

    /// True if its inverse motion is not that about (or along) the opposite axis.
    pub(super) const fn has_several_axes(self) -> bool {
        matches!(self, Self::Universal { .. } | Self::Spherical | Self::Planar | Self::Free)
    }

    /// The name in files and tables.
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

/// Limits of position, velocity, acceleration, jerk and effort. Infinite if unknown.
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
    /// Largest jerk [rad/s^3 or m/s^3].
    pub jerk: f64,
    /// Largest torque or force [N m or N].
    pub effort: f64,
}

impl Limits {
    /// Zero if the limits permit, otherwise their middle, so that no joint rests at a limit.
    pub(super) fn rest(&self) -> f64 {
        let (lower, upper) = (self.lower, self.upper);
        let middle = 0.5 * (lower + upper);
        match (lower <= 0.0 && 0.0 <= upper, middle.is_finite()) {
            (true, _) => 0.0,
            (false, true) => middle,
            (false, false) => clamp(0.0, lower, upper),
        }
    }

    /// No limits.
    pub const NONE: Self = Self {
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
        velocity: f64::INFINITY,
        acceleration: f64::INFINITY,
        jerk: f64::INFINITY,
        effort: f64::INFINITY,
    };

    /// True if the position is outside the limits by more than rounding.
    pub(crate) fn exclude(&self, position: f64) -> bool {
        let beyond = (self.lower - position).max(position - self.upper);
        beyond > LIMIT_MET * (1.0 + position.abs())
    }

    /// True if some finite position is within the limits.
    pub(super) fn permit_a_position(&self) -> bool {
        self.lower <= self.upper && self.lower < f64::INFINITY && self.upper > f64::NEG_INFINITY
    }
}

impl Default for Limits {
    fn default() -> Self {
        Self::NONE
    }
}

/// A mimic joint: its position is `multiplier * q + offset`.
#[derive(Debug, Clone, PartialEq)]
pub struct Mimic {
    /// Name of the joint that it follows.
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
    /// The joint frame at zero, in the parent link.
    pub parent_from_joint: Pose,
    /// The child's link frame, in the joint frame that moves it: the identity except for formats
    /// whose bodies have frames of their own (MJCF, SDF).
    pub joint_from_child: Pose,
    /// Unit axis in the joint frame (z if the kind has none).
    pub axis: Vec3,
    /// True if its coordinates describe the motion of the parent relative to the child: the joint
    /// is written from the link farther from ground, and has several axes. (One axis is reversed
    /// instead.)
    pub reversed: bool,
    /// Limits as in the file; those of a joint with several coordinates apply to each.
    pub limits: Limits,
    /// The joint that it follows, for a mimic joint.
    pub mimic: Option<Mimic>,
    /// Its entries in `q`; those of the followed joint for a mimic joint.
    pub coordinates: Range<usize>,
    /// True if it is actuated: all joints of a serial robot are, unless the file says otherwise.
    pub actuated: bool,
    /// Inertia of its drive, reflected to the joint [kg m^2, or kg for a slide], for each of its
    /// coordinates: the mass matrix has it on its diagonal.
    pub armature: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_exclude_what_is_beyond_them_by_more_than_rounding() {
        for (lower, upper) in [(-1.0, 2.0), (-300.0, -200.0), (200.0, 300.0), (-0.1, 0.1)] {
            let limits = Limits { lower, upper, ..Limits::NONE };
            for (end, outwards) in [(lower, -1.0), (upper, 1.0)] {
                let rounding = LIMIT_MET * (1.0 + end.abs());
                assert!(!limits.exclude(end), "{limits:?}");
                assert!(!limits.exclude(end + outwards * 0.9 * rounding), "{limits:?}");
                assert!(limits.exclude(end + outwards * 1.1 * rounding), "{limits:?}");
                assert!(limits.exclude(end + outwards), "{limits:?}");
            }
            assert!(!limits.exclude(0.5 * (lower + upper)), "{limits:?}");
        }
        assert!(!Limits::NONE.exclude(1e300));
    }
}
