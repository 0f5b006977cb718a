//! Inverse kinematics: the solver of one frame, prepared once.

use std::ffi::{CString, c_char};

use cylindroid::EndEffector;
use cylindroid::ik::{Goal, IkOptions, Solver, Task};

use crate::arguments::{end_effector, free, give, handle, handle_mut, pose, slice, slice_mut};
use crate::mechanism::cyl_mechanism;
use crate::status::{cyl_status, guard, null};

/// A solver of inverse kinematics for one frame of a tree.
#[derive(Debug)]
pub struct cyl_ik {
    solver: Solver,
    of: EndEffector,
    n: usize,
    reason: CString,
}

/// The result of a solution besides its configuration.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct cyl_ik_result {
    /// True if the target is reached within tolerance, inside all limits.
    pub success: bool,
    /// Distance to the target (m).
    pub position_error: f64,
    /// Angle to the target (rad).
    pub orientation_error: f64,
    /// Iterations over all restarts.
    pub iterations: usize,
    /// Number of restarts.
    pub restarts: usize,
}

/// A solver for whole poses of a frame, an index or CYL_DEFAULT_FRAME.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_ik_new(
    mechanism: *const cyl_mechanism,
    frame: usize,
    out: *mut *mut cyl_ik,
) -> cyl_status {
    guard(|| {
        // SAFETY: as the header requires.
        let (mechanism, out) =
            unsafe { (handle("mechanism", mechanism)?, handle_mut("out", out)?) };
        let robot = &mechanism.inner;
        let of = end_effector(robot, frame)?;
        let target = robot.state(robot.home())?.pose(of)?;
        let goals = [Goal::frame(of, Task::POSE, target)];
        let options = IkOptions { nearest: true, ..IkOptions::default() };
        let solver = Solver::new(robot, &goals, &options)?;
        give(out, cyl_ik { solver, of, n: robot.n(), reason: CString::default() });
        Ok(())
    })
}

/// Frees a solver; null is nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_ik_free(ik: *mut cyl_ik) {
    // SAFETY: as the header requires.
    unsafe { free(ik) }
}

/// The configuration nearest to `guess` (n numbers, or null for the last guess, home at first) at which
/// the frame has this pose; without success the closest one found, which is CYL_OK as well:
/// `result->success` says it. `q` has n numbers and may be `guess`, `result` may be null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_ik_solve(
    ik: *mut cyl_ik,
    target: *const f64,
    guess: *const f64,
    q: *mut f64,
    result: *mut cyl_ik_result,
) -> cyl_status {
    guard(|| {
        // SAFETY: as the header requires.
        let (ik, target) = unsafe { (handle_mut("ik", ik)?, pose("target", target)?) };
        if q.is_null() && ik.n > 0 {
            return Err(null("q"));
        }
        if !guess.is_null() {
            // SAFETY: n numbers, as the header says; `q` may be the same ones, so that it becomes
            // a slice after the last use of these.
            ik.solver.set_initial_guess(unsafe { slice("guess", guess, ik.n) }?)?;
        }
        let found = ik.solver.solve(&[Goal::frame(ik.of, Task::POSE, target)])?;
        // SAFETY: as `guess`.
        unsafe { slice_mut("q", q, ik.n) }?.copy_from_slice(&found.q);
        let reason = found.reason.map(|reason| reason.to_string()).unwrap_or_default();
        ik.reason = CString::new(reason).unwrap_or_default();
        // SAFETY: as the header requires.
        if let Some(result) = unsafe { result.as_mut() } {
            *result = cyl_ik_result {
                success: found.success,
                position_error: found.position_error,
                orientation_error: found.orientation_error,
                iterations: found.iterations,
                restarts: found.restarts,
            };
        }
        Ok(())
    })
}

/// Why the last solution missed its target; empty after success. Valid until the next solution.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_ik_reason(ik: *const cyl_ik) -> *const c_char {
    // SAFETY: as the header requires.
    unsafe { ik.as_ref() }.map_or(std::ptr::null(), |ik| ik.reason.as_ptr())
}
