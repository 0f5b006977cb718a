//! The status of the node: a state, the reason for it, and figures.

use cylindroid::Mechanism;
use cylindroid::control::Stall;

use crate::messages::{DiagnosticStatus, KeyValue};

/// State of the node.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum State {
    /// The joint states are not complete: nothing is commanded.
    #[default]
    Waiting,
    /// Nothing to follow: nothing is commanded.
    AtRest,
    /// The joints brake, for the reason given.
    Braking,
    /// The tool moves towards a pose.
    Moving,
    /// The pose is reached.
    Reached,
    /// The tool follows a twist.
    Following,
    /// The tool does not come nearer, or does not follow, for the reason given.
    Stalled,
    /// At rest because of the reason given; targets are not followed.
    Stopped,
}

impl State {
    /// The name in the status.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Waiting => "waiting",
            Self::AtRest => "at-rest",
            Self::Braking => "braking",
            Self::Moving => "moving",
            Self::Reached => "reached",
            Self::Following => "following",
            Self::Stalled => "stalled",
            Self::Stopped => "stopped",
        }
    }

    /// Level of a diagnostic status: OK, WARN or ERROR.
    const fn level(self) -> u8 {
        match self {
            Self::AtRest | Self::Moving | Self::Reached | Self::Following => 0,
            Self::Waiting | Self::Braking | Self::Stalled => 1,
            Self::Stopped => 2,
        }
    }
}

/// What the node does, and why.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Report {
    /// The state.
    pub state: State,
    /// The reason, for states that have one; otherwise empty.
    pub reason: String,
    /// The last message that was refused, while that is recent; otherwise empty.
    pub refused: String,
    /// Distance and angle to the target pose (m, rad).
    pub errors: Option<[f64; 2]>,
    /// Ratio of the smallest to the largest singular value of the scaled task Jacobian.
    pub singular_ratio: Option<f64>,
    /// Largest distance of a joint from its commanded position [rad or m].
    pub following_error: Option<f64>,
    /// Age of the oldest joint state (s).
    pub age: Option<f64>,
}

impl Report {
    /// The text of the status: the state, and the reason after a colon.
    #[must_use]
    pub fn text(&self) -> String {
        let refused =
            if self.refused.is_empty() { String::new() } else { format!(" ({})", self.refused) };
        match self.reason.as_str() {
            "" => format!("{}{refused}", self.state.name()),
            reason => format!("{}: {reason}{refused}", self.state.name()),
        }
    }

    /// The same with all figures, and these of the loop.
    pub(crate) fn diagnostic(
        &self,
        node: &str,
        robot: &str,
        more: &[(&str, f64)],
    ) -> DiagnosticStatus {
        let own = [
            ("position_error [m]", self.errors.map(|e| e[0])),
            ("orientation_error [rad]", self.errors.map(|e| e[1])),
            ("singular_ratio", self.singular_ratio),
            ("following_error [rad or m]", self.following_error),
            ("joint_state_age [s]", self.age),
        ];
        let own = own.into_iter().filter_map(|(key, value)| Some((key, value?)));
        let pair =
            |(key, value): (&str, f64)| KeyValue { key: key.into(), value: value.to_string() };
        DiagnosticStatus {
            level: self.state.level(),
            name: format!("{node}: servo"),
            message: self.text(),
            hardware_id: robot.to_owned(),
            values: own.chain(more.iter().copied()).map(pair).collect(),
        }
    }
}

/// The reason of a stall.
pub(crate) fn stall_reason(stall: &Stall, robot: &Mechanism) -> String {
    match stall {
        Stall::OutOfReach { distance, length } => format!(
            "the target is {distance:.3} m from the first joint, the stretched arm {length:.3} m long"
        ),
        Stall::Limits { coordinates } => {
            let name = |i: &usize| robot.coordinates()[*i].name.as_str();
            format!(
                "at the limit of {}",
                coordinates.iter().map(name).collect::<Vec<_>>().join(", ")
            )
        }
        Stall::Singular { ratio, .. } => {
            format!("a singular configuration: smallest singular value {ratio:.2e} of the largest")
        }
        Stall::TooFewJoints { rank, task, .. } => {
            format!("{rank} independent motions for a task of {task} components")
        }
        Stall::NoInverse(reason) => format!("the inverse does not exist here: {reason}"),
        Stall::Projected { .. } => {
            "the remaining error is the component discarded by the inverse".to_owned()
        }
        Stall::TypeII { share, .. } => format!(
            "a type II singularity is near: the actuated share of the object's weakest motion is \
             {share:.2e}"
        ),
        Stall::Slow => {
            "no progress for a second, with neither limits nor a singular configuration: \
                        use less damping, a higher gain or speed"
                .to_owned()
        }
    }
}
