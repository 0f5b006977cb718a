//! Convergence of the numerical iteration: the errors of a configuration, the damping and step
//! bound shared by single and batched restarts, and the criterion to abandon a restart.
//!
//! Units    m, rad; squared errors are scaled as in `levenberg_marquardt.rs` [-]
//! Checked  tests/it/ik.rs, src/ik/levenberg_marquardt.rs (single against batched restarts)

use super::options::IkOptions;
use crate::error::all_finite;
use crate::model::Mechanism;

/// Ratio of the damping to the squared error [-].
pub(super) const DAMPING: f64 = 0.03;
/// Minimum damping, relative to the squared norm of A: keeps the matrix positive definite.
pub(super) const MIN_DAMPING: f64 = 1e-14;
/// Iterations within which the squared error must fall to a quarter; otherwise the restart is
/// abandoned.
pub(super) const MAX_STAGNATION: usize = 4;
/// Largest change of a coordinate per iteration [rad, or m times [`stretch`]].
pub(super) const MAX_STEP: f64 = 1.5;

/// Unit (m) in which a slide of this travel (m) is measured when the goals are this far away (m), so
/// that a step may cover the distance or the travel; 1 up to [`MAX_STEP`]. Without travel, as for
/// angles, it is 1 rad.
///
/// Why so   squared errors damp changes of all coordinates: with 1 m as the unit a slide would
/// approach a goal at a distance of d m by 1/d m per iteration
#[inline(always)]
pub(super) fn stretch(travel: f64, distance: f64) -> f64 {
    (travel.min(distance) / MAX_STEP).max(1.0)
}

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

/// True for a configuration that may be a solution: all coordinates, also those that move no goal, are
/// finite and within their limits. Trees and closed chains call nothing a success without it.
pub(super) fn is_admissible(mechanism: &Mechanism, q: &[f64]) -> bool {
    all_finite(q) && mechanism.outside_limits(q).next().is_none()
}

#[cfg(test)]
mod tests {
    use super::{is_admissible, stretch};
    use crate::model::catalogue;

    /// Angles and short slides keep their unit exactly.
    #[test]
    fn units_of_slides() {
        for distance in [0.0, 1.0, 1e6, f64::INFINITY, f64::NAN] {
            assert!(stretch(0.0, distance) == 1.0 && stretch(1.5, distance) == 1.0);
        }
        assert!(stretch(1e9, 1.5) == 1.0 && stretch(f64::INFINITY, 300.0) == 200.0);
        assert_eq!(stretch(30.0, 300.0), 20.0);
    }

    #[test]
    fn what_may_be_a_solution() {
        let robot = catalogue::load("panda").unwrap();
        let at = |joint: usize, x: f64| {
            let mut q = robot.home().to_vec();
            q[joint] = x;
            is_admissible(&robot, &q)
        };
        assert!(at(3, -1.0) && !at(3, 1.0));
        // Joints without limits, too.
        let free = robot.without_position_limits();
        for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut q = robot.home().to_vec();
            q[6] = x;
            assert!(!at(6, x) && !is_admissible(&free, &q), "{x}");
        }
    }
}
