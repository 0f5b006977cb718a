//! Stall detection: when a servo makes no progress towards its target, and why.
//!
//! Formula  stalled when neither the error e = |dp| / L + |angle| nor f, f^2 = k_p |dp|^2 / L^2 +
//!          k_o angle^2 with the gains k, has fallen below (1 - share) of its minimum within the window; of
//!          targets that are proved to be out of reach when either e or |dp| has not. The window is
//!          suspended while a joint accelerates at its limit, and is extended by 4 |v| / A, the time in
//!          which the weakest joint reverses from its velocity v at the minimum (|v| / A to stop, then the
//!          way back)
//! Causes   `OutOfReach`: the target is farther from the first joint than the length of the chain
//!          (a proof); `Limits`/`Slow`: the error has a component along controllable directions,
//!          and joints at their limits do / do not block it; `Singular`: the error lies along
//!          directions lost at this configuration, but not generically; `TooFewJoints`: lost
//!          everywhere
//! Lost     directions are those that the inverse cuts, or with a singular value below `TRUNCATION`
//!          of the largest; a gain that is small because of strong damping is not a lost direction
//! Units    m, rad, s
//! Why so   joint velocities J+ K e reduce f, at any rank; e rises on good ways, where an orientation that
//!          has arrived gives way while the position comes on. Out of reach f creeps on for long
//! Checked  tests/it/servo/stall.rs

use super::options::ServoGains;
use super::stopping::stopping_time;
use crate::control::solver::bounds::LimitKind;
use crate::linalg::Svd;
use crate::model::Limits;
use crate::screws::NoInverse;
use crate::tolerance::TRUNCATION;

/// Window within which the error must fall (s), and by which share [-].
const WINDOW: f64 = 1.0;
const SHARE: f64 = 1e-3;
/// Times |v| / A that a joint takes to return to its position [-]: 1 + 2 sqrt 2, rounded up.
pub(super) const TURN_ROUND: f64 = 4.0;
/// Share of the squared error along controllable directions above which the motion towards a target that
/// rests counts as possible [-].
pub(super) const POSSIBLE: f64 = 1e-4;

/// A stall: the reason why the end effector makes no progress towards its target.
///
/// ```text
/// e = |dp| / L + |angle|,   f^2 = k_p |dp|^2 / L^2 + k_o angle^2
/// stalled if neither has fallen by 0.1 % of its minimum within 1 s
/// ```
///
/// The window is suspended while a joint accelerates at its limit, and extended by 4 |v| / A, the
/// time in which the slowest joint reverses from its velocity v. Lost directions are those cut by
/// the inverse, or with a singular value below `tolerance::TRUNCATION` of the largest.
#[derive(Debug, Clone, PartialEq)]
pub enum Stall {
    /// No configuration reaches the target: it is too far away.
    OutOfReach {
        /// Distance from the first joint to the target (m).
        distance: f64,
        /// Length of the fully stretched chain (m).
        length: f64,
    },
    /// Joints are at their position limits, and the others cannot perform the task alone.
    Limits {
        /// Their indices in `q`.
        coordinates: Vec<usize>,
    },
    /// The remaining error lies along directions lost in a singular configuration.
    Singular {
        /// Ratio of the smallest to the largest singular value.
        ratio: f64,
        /// The remaining error as a unit vector in task space.
        direction: Vec<f64>,
    },
    /// The arm has fewer independent motions than the task has components; the remaining error lies
    /// outside their span, of a twist or of a moving target nine tenths of its square at least.
    TooFewJoints {
        /// Independent motions of the arm at this configuration.
        rank: usize,
        /// Components of the task.
        task: usize,
        /// The remaining error as a unit vector in task space.
        direction: Vec<f64>,
    },
    /// The requested inverse does not exist here, and no fallback was given.
    NoInverse(NoInverse),
    /// The remaining error is the component discarded by the projection, although the arm could
    /// reduce it.
    Projected {
        /// The remaining error as a unit vector in task space.
        direction: Vec<f64>,
    },
    /// A type II singularity is near, where the object of a closed chain would gain an uncontrolled
    /// motion: the servo stops before it.
    TypeII {
        /// Actuated share of that motion, which has unit length in units scaled by the
        /// characteristic length [-].
        share: f64,
        /// The motion as a unit vector in task space.
        direction: Vec<f64>,
    },
    /// None of these: strong damping or tight limits make progress slower than the window.
    Slow,
}

impl Stall {
    /// The name in reports.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::OutOfReach { .. } => "out-of-reach",
            Self::Limits { .. } => "limits",
            Self::Singular { .. } => "singular",
            Self::TooFewJoints { .. } => "too-few-joints",
            Self::NoInverse(_) => "no-inverse",
            Self::Projected { .. } => "projected",
            Self::TypeII { .. } => "type-ii",
            Self::Slow => "slow",
        }
    }
}

/// What is left of a motion towards a pose.
#[derive(Debug, Clone, Copy)]
pub(in crate::control) struct Remainder {
    /// Of the position (m).
    pub(in crate::control) position: f64,
    /// Of the orientation (rad).
    pub(in crate::control) orientation: f64,
    /// Characteristic length L (m).
    pub(in crate::control) length: f64,
    pub(in crate::control) gain: ServoGains,
    /// True where no configuration reaches the pose: the position decides, for the orientation may creep
    /// on for minutes.
    pub(in crate::control) is_out_of_reach: bool,
}

/// Detects that a motion towards a pose makes no progress.
#[derive(Debug, Clone)]
pub(in crate::control) struct StallDetector {
    sum: Fall,
    squares: Fall,
    position: Fall,
}

/// The least value of an error and the time since then.
#[derive(Debug, Clone)]
struct Fall {
    best: f64,
    since: f64,
    window: f64,
}

/// Acceleration of the joints in a step.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::control) struct BrakingState {
    /// True if a joint accelerates at its acceleration or jerk limit.
    pub(in crate::control) accelerating: bool,
    /// The largest |v| / A, or |v| / A + 2 A / J, of the joints (s).
    pub(in crate::control) stopping_time: f64,
}

impl BrakingState {
    /// Adds a joint with its velocities of this step and of the one before.
    pub(in crate::control) fn add(
        &mut self,
        limits: &Limits,
        met: Option<LimitKind>,
        [before, velocity]: [f64; 2],
    ) {
        let speed = velocity.abs();
        let met = matches!(met, Some(LimitKind::Acceleration | LimitKind::Jerk));
        self.accelerating |= met && speed > before.abs();
        self.stopping_time = self.stopping_time.max(stopping_time(speed, limits));
    }
}

impl StallDetector {
    pub(in crate::control) const fn new() -> Self {
        Self { sum: Fall::NONE, squares: Fall::NONE, position: Fall::NONE }
    }

    /// The share of its speed that a way to the nearest pose keeps which has brought no progress for twice
    /// the time in which a stall is named: one that swings about the pose comes to rest.
    pub(in crate::control) fn patience(&self) -> f64 {
        (2.0 * self.sum.window / self.sum.since).powi(4).min(1.0)
    }

    /// Records what is left after a step of `dt` seconds; true if stalled.
    pub(in crate::control) fn stalled(
        &mut self,
        left: Remainder,
        braking: BrakingState,
        dt: f64,
    ) -> bool {
        let Remainder { position, orientation, length, gain, is_out_of_reach } = left;
        let sum = position / length + orientation;
        let squares =
            gain.position * (position / length).powi(2) + gain.orientation * orientation.powi(2);
        let position = self.position.has_ended(position, braking, dt);
        let squares = self.squares.has_ended(squares.sqrt(), braking, dt);
        let sum = self.sum.has_ended(sum, braking, dt);
        if is_out_of_reach { position || sum } else { squares && sum }
    }
}

impl Fall {
    const NONE: Self = Self { best: f64::INFINITY, since: 0.0, window: WINDOW };

    /// Records the error; true if it has not fallen for the window.
    fn has_ended(&mut self, error: f64, braking: BrakingState, dt: f64) -> bool {
        if error < self.best * (1.0 - SHARE) {
            let window = WINDOW + TURN_ROUND * braking.stopping_time;
            *self = Self { best: error, since: 0.0, window };
            return false;
        }
        if !braking.accelerating {
            self.since += dt;
        }
        self.since > self.window
    }
}

/// Inputs of the classification.
#[derive(Debug)]
pub(super) struct StallInputs<'a> {
    /// Share of the squared error above which the motion is possible [-].
    pub(super) possible: f64,
    pub(super) svd: &'a Svd,
    /// Gains of the inverse along each direction.
    pub(super) gains: &'a [f64],
    /// The remaining error in scaled task coordinates.
    pub(super) error: &'a [f64],
    /// The same after projection.
    pub(super) projected_error: &'a [f64],
    /// The reason why there is no projector, if the arm was stopped for it.
    pub(super) no_inverse: Option<NoInverse>,
    /// Coordinates at a position limit that blocks the desired motion.
    pub(super) at_limit: &'a [usize],
    pub(super) distance: f64,
    pub(super) length: f64,
    /// Rank of the task Jacobian at non-singular configurations.
    pub(super) generic_rank: usize,
}

pub(super) fn classify(e: &StallInputs<'_>) -> Stall {
    if let Some(reason) = e.no_inverse {
        return Stall::NoInverse(reason);
    }
    if e.distance > e.length * (1.0 + 1e-12) {
        return Stall::OutOfReach { distance: e.distance, length: e.length };
    }
    let total: f64 = e.error.iter().map(|x| x * x).sum();
    let norm = total.sqrt().max(f64::MIN_POSITIVE);
    let kept = |i: &usize| e.gains[*i] > 0.0 && e.svd.value(*i) > TRUNCATION * e.svd.value(0);
    let realised = |error: &[f64]| -> f64 {
        let along = |i| e.svd.u(i).iter().zip(error).map(|(u, x)| u * x).sum::<f64>();
        (0..e.svd.len()).filter(kept).map(|i| along(i).powi(2)).sum()
    };
    let possible = realised(e.projected_error);
    if possible > e.possible * total {
        return if e.at_limit.is_empty() {
            Stall::Slow
        } else {
            Stall::Limits { coordinates: e.at_limit.to_vec() }
        };
    }
    let direction: Vec<f64> = e.error.iter().map(|x| x / norm).collect();
    if realised(e.error) > e.possible * total {
        return Stall::Projected { direction };
    }
    let rank = (0..e.svd.len()).filter(kept).count();
    if rank >= e.generic_rank {
        return Stall::TooFewJoints { rank, task: e.error.len(), direction };
    }
    Stall::Singular { ratio: e.svd.singular_ratio(), direction }
}
