//! What a redundant mechanism makes as large as possible along its self-motion: manipulability or
//! the distance from joint limits. `ascent.rs` computes it.
//!
//! Checked  tests/it/ik_criteria.rs

use crate::error::{Error, Result};
use crate::kinematics::{Chain, EndEffector};
use crate::model::Mechanism;
use crate::task::Task;

/// What the self-motion makes as large as possible.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Criterion {
    /// Yoshikawa's measure of a frame: the product of the singular values of its task Jacobian,
    /// lengths over the characteristic length.
    Manipulability {
        /// The frame and the tool point.
        end_effector: EndEffector,
        /// The components of its task.
        components: Task,
    },
    /// Distance from joint limits: minus half of the sum of squares of the shares by which joints
    /// are inside a margin of their limits; zero if none is.
    LimitAvoidance {
        /// The margin, as a share of the range of each joint; 0.5 reaches to its middle [-].
        margin: f64,
    },
}

/// Margin of limit avoidance by name: every joint counts, up to the middle of its range [-].
const WHOLE_RANGE: f64 = 0.5;

impl Criterion {
    /// The names of all.
    pub const NAMES: [&str; 2] = ["manipulability", "limit-avoidance"];

    /// The criterion of this name: manipulability of a frame, or limit avoidance in which every
    /// joint counts over its whole range.
    ///
    /// # Errors
    /// Another name, with those that there are.
    pub fn by_name(
        name: &str,
        end_effector: impl Into<EndEffector>,
        components: Task,
    ) -> Result<Self> {
        match name {
            "manipulability" => {
                let end_effector = end_effector.into();
                Ok(Self::Manipulability { end_effector, components })
            }
            "limit-avoidance" => Ok(Self::LimitAvoidance { margin: WHOLE_RANGE }),
            _ => Err(Error::unknown("criterion", name, Self::NAMES)),
        }
    }

    /// Its name in options and reports.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Manipulability { .. } => "manipulability",
            Self::LimitAvoidance { .. } => "limit-avoidance",
        }
    }

    pub(super) fn check(&self, mechanism: &Mechanism) -> Result<()> {
        match *self {
            Self::Manipulability { end_effector, components } => {
                mechanism.check_frame(end_effector.frame)?;
                components.check()
            }
            Self::LimitAvoidance { margin } if margin > 0.0 && margin <= 0.5 => Ok(()),
            Self::LimitAvoidance { margin } => Err(Error::InvalidOption {
                option: "margin",
                value: margin.to_string(),
                reason: "give a share of the range, more than 0 and at most 0.5".to_owned(),
            }),
        }
    }

    /// The coordinates that change it, besides those of the goals.
    pub(super) fn coordinates(&self, mechanism: &Mechanism) -> Vec<usize> {
        match *self {
            Self::Manipulability { end_effector, .. } => {
                Chain::of(mechanism, end_effector).coordinates().to_vec()
            }
            Self::LimitAvoidance { .. } => Vec::new(),
        }
    }
}
