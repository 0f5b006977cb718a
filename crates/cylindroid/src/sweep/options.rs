//! The options of a sweep.
//!
//! Checked  tests/sweep/quantities.rs, tests/sweep/pose_files.rs, tests/sweep/clearances.rs,
//!          tests/sweep/relative.rs

use super::own_columns::OwnColumn;
use super::quantity::Quantity;
use super::source::Source;
use crate::collision::CollisionModel;
use crate::error::{Error, Result};
use crate::kinematics::EndEffector;
use crate::model::{FrameId, Mechanism};
use crate::spatial::Vec3;
use crate::task::{Task, check_pose};

/// Rows of a part by default.
pub(super) const PART_ROWS: u64 = 1 << 16;

/// What a sweep computes. [`Sweep::new`](super::Sweep::new) checks all of it.
#[derive(Debug, Clone)]
pub struct SweepOptions {
    /// The configurations.
    pub source: Source,
    /// The quantities, in the order of their columns.
    pub quantities: Vec<Quantity>,
    /// Columns of the caller, after those of the quantities.
    pub columns: Vec<OwnColumn>,
    /// The frame: the reference of a closed chain, otherwise the tool, by default.
    pub end_effector: Option<EndEffector>,
    /// The frame from which `end_effector` is seen, which may move: two arms together. Poses are those
    /// relative to it, and Jacobians those of
    /// [`State::relative_jacobian`](crate::kinematics::State::relative_jacobian); the world by default.
    pub relative_to: Option<FrameId>,
    /// The components of the twist that the Jacobian's measures see, in world axes or those of
    /// `relative_to`; in the plane those of the plane. All by default.
    pub task: Option<Task>,
    /// The metric of [`Quantity::Yoshikawa`] and [`Quantity::Measures`].
    pub metric: VelocityMetric,
    /// Characteristic length (m): that of the mechanism by default.
    pub length: Option<f64>,
    /// The direction of [`Quantity::Payload`] in world axes, of any length: down by default.
    pub direction: Vec3,
    /// Shapes and obstacles of [`Quantity::SelfDistance`] and [`Quantity::ObstacleDistance`], of this
    /// mechanism: those of its links alone by default, also of each design.
    pub collision: Option<CollisionModel>,
    /// Rows of a part, the unit of work and the file of [`Sweep::write`](super::Sweep::write).
    pub part_rows: u64,
}

impl SweepOptions {
    /// The frame and the characteristic length (m) for a mechanism, which has coordinates.
    pub(super) fn place(&self, mechanism: &Mechanism) -> Result<(EndEffector, f64)> {
        if mechanism.n() == 0 {
            return Err(Error::Model {
                model: mechanism.name().to_owned(),
                culprit: String::new(),
                message: "it has no coordinates to sweep".to_owned(),
            });
        }
        let length = mechanism.length_or(self.length)?;
        let default = if mechanism.is_closed() { mechanism.reference() } else { mechanism.tool() };
        let end_effector = self.end_effector.unwrap_or(default.into());
        mechanism.check_frame(end_effector.frame)?;
        check_pose("frame_from_tool of the end effector", &end_effector.frame_from_tool)?;
        Ok((end_effector, length))
    }
}

impl Default for SweepOptions {
    fn default() -> Self {
        Self {
            source: Source::Samples { count: 0, seed: 0 },
            quantities: vec![Quantity::Pose, Quantity::Yoshikawa],
            columns: Vec::new(),
            end_effector: None,
            relative_to: None,
            task: None,
            metric: VelocityMetric::Unit,
            length: None,
            direction: Vec3::new(0.0, 0.0, -1.0),
            collision: None,
            part_rows: PART_ROWS,
        }
    }
}

/// The metric of twists and joint velocities.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum VelocityMetric {
    /// m and rad, unscaled.
    #[default]
    Unit,
    /// Lengths over the characteristic length.
    Length,
    /// As `Length`, and joint velocities over their limits.
    Limits,
}

impl VelocityMetric {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Unit, Self::Length, Self::Limits];

    /// Its name in options and recipes.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Unit => "unit",
            Self::Length => "length",
            Self::Limits => "limits",
        }
    }

    /// The metric of this name.
    ///
    /// # Errors
    /// [`Error::UnknownName`] with the nearest names.
    pub fn named(name: &str) -> Result<Self> {
        let found = Self::ALL.into_iter().find(|m| m.name() == name);
        found.ok_or_else(|| Error::unknown("metric", name, Self::ALL.map(Self::name)))
    }
}
