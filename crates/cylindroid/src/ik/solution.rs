//! The result of inverse kinematics: configuration, errors, method.
//!
//! Checked  tests/it/ik.rs, tests/it/ik_misses.rs

use super::convergence::Errors;
use super::reason::MissReason;

/// The method that found a solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum FoundBy {
    /// Closed form: see [`Analytic`](super::Analytic).
    Analytic,
    /// Numerical solver with random restarts; also without success.
    Numerical,
}

impl FoundBy {
    /// The name: "analytic" or "numerical".
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Analytic => "analytic",
            Self::Numerical => "numerical",
        }
    }
}

/// The result of inverse kinematics: a configuration, its errors and how it was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Solution {
    /// True if all goals are reached within tolerance.
    pub success: bool,
    /// The configuration, all n coordinates; without success the closest one found.
    pub q: Vec<f64>,
    /// Largest position error of all goals, in the components of the task (m).
    pub position_error: f64,
    /// Largest orientation error of all goals, in the components of the task (rad).
    pub orientation_error: f64,
    /// The method that found it.
    pub found_by: FoundBy,
    /// Iterations over all restarts; an evaluation of the closed form counts as one.
    pub iterations: usize,
    /// Number of restarts, including evaluations of the closed form.
    pub restarts: usize,
    /// Proof that no solution exists: the distance of the target from the first joint, and the
    /// length of the chain from there (m).
    pub out_of_reach: Option<(f64, f64)>,
    /// The value of [`IkOptions::criterion`](super::IkOptions::criterion) at `q`; `None` without one.
    pub criterion: Option<f64>,
    /// The reason why no solution was found; `None` with success.
    pub reason: Option<MissReason>,
}

/// A solution, with its distance from the initial guess or the cost of the criterion.
#[derive(Debug, Clone)]
pub(super) struct Candidate {
    pub(super) cost: f64,
    pub(super) q: Vec<f64>,
    pub(super) errors: Errors,
    pub(super) found_by: FoundBy,
}
