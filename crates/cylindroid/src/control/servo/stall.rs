//! When a servo gets no nearer to its target, and why.
//!
//! Formula  stalled when the error e = |dp| / L + |angle| has not fallen below (1 - share) of its
//!          best within the window. The window begins when no joint gains speed under an
//!          acceleration limit, and is longer by the time 4 |rate| / A that the weakest joint takes
//!          to turn round from its rate at the best (|rate| / A to stop, the way back and its end)
//! Causes   out of reach: the target is farther from the chain's first joint than the chain is
//!          long (a proof); limits, slow: the error has a part along directions that are not lost,
//!          and joints stand at limits against it, or not; singular: the error is along directions
//!          that are lost here, and the arm can do more in other postures; too few joints: the
//!          same, and it cannot
//! Lost     is a direction that the inverse cuts, or whose singular value is below `TRUNCATION` of
//!          the largest; a gain that is weak because the inverse is damped much is not a lost one
//! Units    m, rad, s
//! Checked  tests/it/servo/stall.rs::stall_*

use crate::linalg::Svd;
use crate::screws::NoInverse;
use crate::tolerance::TRUNCATION;

/// Window within which the error must fall (s), and by which share [-].
const WINDOW: f64 = 1.0;
const SHARE: f64 = 1e-3;
/// Times |rate| / A that a joint takes to come back to where it was [-]: 1 + 2 sqrt 2, rounded up.
const TURN_ROUND: f64 = 4.0;
/// Share of the squared error that must lie along directions that are not lost for the motion to
/// count as possible [-].
const POSSIBLE: f64 = 1e-4;

/// Why the end effector does not get nearer to its target.
#[derive(Debug, Clone, PartialEq)]
pub enum Stall {
    /// The target cannot be reached by any posture: it is too far away.
    OutOfReach {
        /// Distance from the first joint to the target (m).
        distance: f64,
        /// Length of the stretched chain (m).
        length: f64,
    },
    /// Joints stand at their position limits and the rest cannot do the task without them.
    Limits {
        /// Their places in `q`.
        coordinates: Vec<usize>,
    },
    /// The remaining error lies along directions lost in a singular pose.
    Singular {
        /// Smallest singular value over the largest.
        ratio: f64,
        /// The remaining error as a unit vector in task space.
        direction: Vec<f64>,
    },
    /// The arm has fewer independent motions than the task asks for; the error that remains is
    /// outside of what it can do here.
    TooFewJoints {
        /// Independent motions of the arm here.
        rank: usize,
        /// Components of the task.
        task: usize,
        /// The remaining error as a unit vector in task space.
        direction: Vec<f64>,
    },
    /// The inverse that was asked for does not exist here, and no other was named.
    NoInverse(NoInverse),
    /// The remaining error is what the projection gives up, although the arm could lessen it.
    Projected {
        /// The remaining error as a unit vector in task space.
        direction: Vec<f64>,
    },
    /// A motion of the object is about to escape the drives of a closed chain (type II
    /// singularity): the servo stops before.
    TypeII {
        /// Actuated share of that motion, which has length one in units
        /// scaled by the reach [-].
        share: f64,
        /// The motion as a unit vector in task space.
        direction: Vec<f64>,
    },
    /// None of these: the inverse is damped so much, or the limits so tight, that progress is
    /// slower than the window.
    Slow,
}

impl Stall {
    /// Its name in reports.
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

/// Watches the error.
#[derive(Debug, Clone)]
pub(super) struct StallDetector {
    best: f64,
    since: f64,
    window: f64,
}

/// How the joints go about a step.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct BrakingState {
    /// True if a joint gains speed as fast as its acceleration limit lets it.
    pub(super) accelerating: bool,
    /// The largest |rate| / A of the joints (s).
    pub(super) stopping_time: f64,
}

impl StallDetector {
    pub(super) const fn new() -> Self {
        Self { best: f64::INFINITY, since: 0.0, window: WINDOW }
    }

    /// Notes the error of a step of `dt` seconds; true if stalled.
    pub(super) fn stalled(&mut self, error: f64, braking: BrakingState, dt: f64) -> bool {
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

/// What the classification looks at.
#[derive(Debug)]
pub(super) struct StallInputs<'a> {
    pub(super) svd: &'a Svd,
    /// Gains of the inverse along each direction.
    pub(super) gains: &'a [f64],
    /// The remaining error in scaled task coordinates.
    pub(super) error: &'a [f64],
    /// The same as projected.
    pub(super) projected_error: &'a [f64],
    /// Why there is no projector, if the arm was stopped for it.
    pub(super) no_inverse: Option<NoInverse>,
    /// Coordinates that stand at a position limit against the desired motion.
    pub(super) at_limit: &'a [usize],
    pub(super) distance: f64,
    pub(super) length: f64,
    /// Rank of the task Jacobian in postures that are not singular.
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
    if possible > POSSIBLE * total {
        return if e.at_limit.is_empty() {
            Stall::Slow
        } else {
            Stall::Limits { coordinates: e.at_limit.to_vec() }
        };
    }
    let direction: Vec<f64> = e.error.iter().map(|x| x / norm).collect();
    if realised(e.error) > POSSIBLE * total {
        return Stall::Projected { direction };
    }
    let rank = (0..e.svd.len()).filter(kept).count();
    if rank >= e.generic_rank {
        return Stall::TooFewJoints { rank, task: e.error.len(), direction };
    }
    let ratio = if e.svd.is_empty() || e.svd.value(0) == 0.0 {
        0.0
    } else {
        e.svd.value(e.svd.len() - 1) / e.svd.value(0)
    };
    Stall::Singular { ratio, direction }
}
