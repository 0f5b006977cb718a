//! The quantities of a sweep and their columns.
//!
//! Units    of each column with it; a column of both metres and radians says so
//! Frame    poses `world_from_frame`, Jacobians at the frame's origin in world axes; of a sweep relative
//!          to another frame, poses and axes are those seen from it
//! Checked  tests/sweep/quantities.rs, tests/sweep/relative.rs

use super::table::Column;
use crate::error::{Error, Result};
use crate::manipulability::ManipulabilityBatch;
use crate::model::Mechanism;

/// A quantity of each configuration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Quantity {
    /// Position and quaternion of the frame in the world.
    Pose,
    /// The Jacobian at the frame's origin in world axes, a column for each entry.
    Jacobian,
    /// The singular values of the Jacobian, linear rows over the characteristic length, largest
    /// first.
    SingularValues,
    /// The last of them.
    SmallestSingularValue,
    /// The largest over the smallest of them; infinite at a singularity.
    Condition,
    /// Yoshikawa's measure, sqrt(det J J^T): the product of the singular values in the metric.
    Yoshikawa,
    /// Smallest distance to a position limit; negative outside.
    LimitDistance,
    /// Smallest distance of links that can collide; negative: penetration depth. Of closed chains too.
    SelfDistance,
    /// Smallest distance of a link to an obstacle of [`SweepOptions::collision`](super::SweepOptions);
    /// negative: penetration depth. Of closed chains too.
    ObstacleDistance,
    /// Largest force at the frame's origin along [`SweepOptions::direction`](super::SweepOptions)
    /// that the actuated joints balance within their effort limits, without own weight and inertia;
    /// of closed chains too. Infinite where the structure alone bears it.
    Payload,
    /// Gibson-Hunt class and principal pitches of the screw system of the Jacobian's columns.
    GibsonHunt,
    /// Mobility counts, distances to singularities and kinematic efficiencies, as in
    /// [`ManipulabilityBatch`]; of closed chains too.
    Measures,
}

impl Quantity {
    /// All of them.
    pub const ALL: [Self; 12] = [
        Self::Pose,
        Self::Jacobian,
        Self::SingularValues,
        Self::SmallestSingularValue,
        Self::Condition,
        Self::Yoshikawa,
        Self::LimitDistance,
        Self::SelfDistance,
        Self::ObstacleDistance,
        Self::Payload,
        Self::GibsonHunt,
        Self::Measures,
    ];

    /// Its name in options and recipes.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Pose => "pose",
            Self::Jacobian => "jacobian",
            Self::SingularValues => "singular_values",
            Self::SmallestSingularValue => "smallest_singular_value",
            Self::Condition => "condition",
            Self::Yoshikawa => "yoshikawa",
            Self::LimitDistance => "limit_distance",
            Self::SelfDistance => "self_distance",
            Self::ObstacleDistance => "obstacle_distance",
            Self::Payload => "payload",
            Self::GibsonHunt => "gibson_hunt",
            Self::Measures => "measures",
        }
    }

    /// One phrase.
    #[must_use]
    pub const fn description(self) -> &'static str {
        match self {
            Self::Pose => "position and unit quaternion of the frame, world_from_frame",
            Self::Jacobian => "Jacobian at the frame's origin, world axes, linear rows first",
            Self::SingularValues => {
                "singular values of the Jacobian, linear rows over the characteristic length"
            }
            Self::SmallestSingularValue => "smallest of these singular values",
            Self::Condition => "largest over smallest of these singular values",
            Self::Yoshikawa => "Yoshikawa's measure sqrt(det J J^T) in the metric",
            Self::LimitDistance => "smallest distance to a position limit, negative outside",
            Self::SelfDistance => "smallest distance of links that can collide, negative inside",
            Self::ObstacleDistance => "smallest distance of a link to an obstacle, negative inside",
            Self::Payload => {
                "largest force along the direction within the effort limits, without weight"
            }
            Self::GibsonHunt => "Gibson-Hunt class and principal pitches of the screw system",
            Self::Measures => {
                "mobility counts, distances to singularities and kinematic efficiencies"
            }
        }
    }

    /// One phrase, of a sweep relative to another frame.
    const fn relative_description(self) -> &'static str {
        match self {
            Self::Pose => "position and unit quaternion of the frame, relative_to_from_frame",
            Self::Jacobian => {
                "relative Jacobian at the frame's origin, axes of relative_to, linear rows first"
            }
            Self::SingularValues => {
                "singular values of the relative Jacobian, linear rows over the characteristic length"
            }
            Self::Yoshikawa => "Yoshikawa's measure sqrt(det J J^T) of the relative Jacobian",
            Self::GibsonHunt => {
                "Gibson-Hunt class and principal pitches of the relative screw system"
            }
            other => other.description(),
        }
    }

    /// Those that are computed where none are named: what a closed chain has, and what else others
    /// have.
    #[must_use]
    pub fn usual(mechanism: &Mechanism) -> &'static [Self] {
        if mechanism.is_closed() {
            &[Self::Pose, Self::Measures]
        } else {
            &[
                Self::Pose,
                Self::Yoshikawa,
                Self::SmallestSingularValue,
                Self::LimitDistance,
                Self::GibsonHunt,
            ]
        }
    }

    /// The quantity of this name.
    ///
    /// # Errors
    /// [`Error::UnknownName`] with the nearest names.
    pub fn named(name: &str) -> Result<Self> {
        let found = Self::ALL.into_iter().find(|q| q.name() == name);
        found.ok_or_else(|| Error::unknown("quantity", name, Self::ALL.map(Self::name)))
    }

    /// True if the task restricts it.
    pub(super) const fn sees_task(self) -> bool {
        matches!(
            self,
            Self::SingularValues
                | Self::SmallestSingularValue
                | Self::Condition
                | Self::Yoshikawa
                | Self::Measures
        )
    }

    /// True if loops do not invalidate it: the others are of the Jacobian of the spanning tree.
    pub(super) const fn has_loops(self) -> bool {
        self.sees_collisions()
            || matches!(self, Self::Pose | Self::LimitDistance | Self::Payload | Self::Measures)
    }

    /// True if it is the same for all frames, or can be that of a frame seen from another.
    pub(super) const fn is_relative(self) -> bool {
        !matches!(self, Self::Payload | Self::Measures)
    }

    /// True if it is a distance of collision shapes.
    pub(super) const fn sees_collisions(self) -> bool {
        matches!(self, Self::SelfDistance | Self::ObstacleDistance)
    }

    /// Its columns; `values`: number of singular values.
    pub(super) fn columns(
        self,
        mechanism: &Mechanism,
        values: usize,
        is_relative: bool,
    ) -> Vec<Column> {
        let description =
            if is_relative { self.relative_description() } else { self.description() };
        let number = |name: &str, unit| Column::number(name, unit, description);
        match self {
            Self::Pose => {
                let position = ["x", "y", "z"].map(|name| number(name, "m"));
                let quaternion = ["qw", "qx", "qy", "qz"].map(|name| number(name, "1"));
                position.into_iter().chain(quaternion).collect()
            }
            Self::Jacobian => {
                let rows = ["vx", "vy", "vz", "wx", "wy", "wz"];
                let row = |(i, row): (usize, &str)| {
                    let columns = mechanism.coordinates().iter().map(move |c| {
                        let unit = match (i < 3, c.kind.is_length()) {
                            (true, true) => "m/m",
                            (true, false) => "m/rad",
                            (false, true) => "rad/m",
                            (false, false) => "rad/rad",
                        };
                        number(&format!("jacobian_{row}_{}", c.name), unit)
                    });
                    columns.collect::<Vec<_>>()
                };
                rows.into_iter().enumerate().flat_map(row).collect()
            }
            Self::SingularValues => {
                (1..=values).map(|i| number(&format!("singular_value_{i}"), "1")).collect()
            }
            Self::SmallestSingularValue | Self::Condition => vec![number(self.name(), "1")],
            Self::Yoshikawa => vec![number(self.name(), "m and rad, of the metric")],
            Self::LimitDistance => vec![number(self.name(), "rad or m, of the joint")],
            Self::SelfDistance | Self::ObstacleDistance => vec![number(self.name(), "m")],
            Self::Payload => vec![number(self.name(), "N")],
            Self::GibsonHunt => {
                let class = Column::text(self.name(), description);
                let pitch = |i| number(&format!("principal_pitch_{i}"), "m/rad");
                std::iter::once(class).chain((1..=PITCHES).map(pitch)).collect()
            }
            Self::Measures => {
                let columns = ManipulabilityBatch::COLUMNS.iter().enumerate();
                columns
                    .map(|(i, &name)| match name {
                        "closure_distance" => number(name, "m"),
                        "closure_angle" => number(name, "rad"),
                        name if ManipulabilityBatch::COUNTS.contains(&i) => {
                            Column::count(name, description)
                        }
                        "volume" | "largest" | "smallest" => number(name, "of the metric"),
                        _ => number(name, "1"),
                    })
                    .collect()
            }
        }
    }
}

/// Principal pitches of a screw system at most.
pub(super) const PITCHES: usize = 3;
