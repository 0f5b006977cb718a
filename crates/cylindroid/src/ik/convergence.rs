//! Convergence of the numerical iteration: the errors of a configuration, the damping and step
//! bound that single and batched restarts share, and when a restart is abandoned.
//!
//! Units    m, rad; squared errors are scaled as in `levenberg_marquardt.rs` [-]
//! Checked  tests/it/ik.rs, tests in `levenberg_marquardt.rs` (single against batched restarts)

use super::options::IkOptions;

/// Damping over the squared error [-].
pub(super) const DAMPING: f64 = 0.03;
/// Damping at the least, relative to the size of A squared: keeps the matrix positive definite.
pub(super) const MIN_DAMPING: f64 = 1e-14;
/// Steps within which the squared error must fall to a quarter, or the attempt is abandoned.
pub(super) const MAX_STAGNATION: usize = 4;
/// Largest change of a coordinate in a step [rad, or lengths].
pub(super) const MAX_STEP: f64 = 1.5;

/// The errors of a posture: the largest of all goals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Errors {
    /// (m)
    pub(super) position: f64,
    /// (rad)
    pub(super) orientation: f64,
    /// Scaled, squared, of all together [-].
    pub(super) squared: f64,
}

/// True where all errors are within tolerance.
pub(super) fn is_reached(errors: Errors, options: &IkOptions) -> bool {
    errors.position <= options.position_tolerance
        && errors.orientation <= options.orientation_tolerance
}
