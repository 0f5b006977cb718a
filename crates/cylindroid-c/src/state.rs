//! States: a configuration with its forward kinematics, poses and Jacobians.

use cylindroid::{EndEffector, Matrix, State};

use crate::arguments::{
    end_effector, free, give, handle, handle_mut, reference, slice, slice_mut, write_pose,
};
use crate::mechanism::cyl_mechanism;
use crate::status::{cyl_status, guard};

/// A configuration whose forward kinematics was computed.
#[derive(Debug)]
pub struct cyl_state {
    inner: State,
    jacobian: Matrix,
}

/// A state at the home configuration.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_state_new(
    mechanism: *const cyl_mechanism,
    out: *mut *mut cyl_state,
) -> cyl_status {
    guard(|| {
        // SAFETY: as the header requires.
        let (mechanism, out) =
            unsafe { (handle("mechanism", mechanism)?, handle_mut("out", out)?) };
        let robot = &mechanism.inner;
        let inner = robot.state(robot.home())?;
        give(out, cyl_state { inner, jacobian: Matrix::zeros(6, robot.n()) });
        Ok(())
    })
}

/// Frees a state; null is nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_state_free(state: *mut cyl_state) {
    // SAFETY: as the header requires.
    unsafe { free(state) }
}

/// Moves a state to a configuration of n coordinates. No allocation.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_state_set(
    state: *mut cyl_state,
    q: *const f64,
    n: usize,
) -> cyl_status {
    guard(|| {
        // SAFETY: as the header requires.
        let (state, q) = unsafe { (handle_mut("state", state)?, slice("q", q, n)?) };
        Ok(state.inner.set(q)?)
    })
}

/// world_from_frame as 16 numbers by columns. `frame` is an index or CYL_DEFAULT_FRAME. No allocation.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_state_pose(
    state: *const cyl_state,
    frame: usize,
    pose: *mut f64,
) -> cyl_status {
    guard(|| {
        // SAFETY: as the header requires.
        let (state, pose) = unsafe { (handle("state", state)?, slice_mut("pose", pose, 16)?) };
        let of = end_effector(state.inner.mechanism(), frame)?;
        write_pose(state.inner.pose(of)?, pose);
        Ok(())
    })
}

/// The Jacobian of a frame, 6 x n numbers by columns, linear rows first. `reference` is a
/// cyl_reference. No allocation.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_state_jacobian(
    state: *mut cyl_state,
    frame: usize,
    reference_number: i32,
    jacobian: *mut f64,
) -> cyl_status {
    guard(|| {
        // SAFETY: as the header requires.
        let state = unsafe { handle_mut("state", state) }?;
        let robot = state.inner.mechanism();
        let (of, n): (EndEffector, usize) = (end_effector(robot, frame)?, robot.n());
        // SAFETY: 6 n numbers, as the header says.
        let out = unsafe { slice_mut("jacobian", jacobian, 6 * n) }?;
        state.inner.jacobian_into(of, reference(reference_number)?, &mut state.jacobian)?;
        out.copy_from_slice(state.jacobian.as_slice());
        Ok(())
    })
}
