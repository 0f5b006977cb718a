//! Convergence of the numerical iteration: the errors of a configuration, the damping and step
//! bound shared by single and batched restarts, and the criterion to abandon a restart.
//!
//! Units    m, rad; squared errors are scaled as in `levenberg_marquardt.rs` [-]
//! Checked  tests/it/ik.rs, src/ik/levenberg_marquardt.rs (single against batched restarts)

use super::options::IkOptions;

/// Ratio of the damping to the squared error [-].
pub(super) const DAMPING: f64 = 0.03;
/// Minimum damping, relative to the squared norm of A: keeps the matrix positive definite.
pub(super) const MIN_DAMPING: f64 = 1e-14;
/// Iterations within which the squared error must fall to a quarter; otherwise the restart is
/// abandoned.
pub(super) const MAX_STAGNATION: usize = 4;
/// Largest change of a coordinate per iteration [rad, or lengths].
pub(super) const MAX_STEP: f64 = 1.5;

/// The errors of a configuration: the largest over all goals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Errors {
    /// (m)
    pub(super) position: f64,
    /// (rad)
    pub(super) orientation: f64,
    /// Scaled, squared, summed over all goals [-].
    pub(super) squared: f64,
}

/// True if all errors are within tolerance.
pub(super) fn is_reached(errors: Errors, options: &IkOptions) -> bool {
    errors.position <= options.position_tolerance
        && errors.orientation <= options.orientation_tolerance
}
