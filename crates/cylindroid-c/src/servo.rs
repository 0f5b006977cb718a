//! The servo: joint velocities from the configuration and a target, in a loop of fixed period.

use std::ffi::{CString, c_char};

use cylindroid::closure::ClosedChain;
use cylindroid::control::{
    InverseSelection, PoseTolerance, ServoGains, SpeedLimit, Status, Step, Target, TwistStatus,
};
use cylindroid::{Servo, ServoOptions, Twist};

use crate::arguments::{
    CYL_DEFAULT_FRAME, end_effector, free, give, handle, handle_mut, pose, slice, slice_mut, text,
    twist, write_pose,
};
use crate::mechanism::cyl_mechanism;
use crate::status::{Failure, cyl_status, guard};

/// A Cartesian controller for one frame.
#[derive(Debug)]
pub struct cyl_servo {
    inner: Servo,
    stall: CString,
}

/// Options of a servo; cyl_servo_defaults() fills them in.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct cyl_servo_options {
    /// The frame, an index or CYL_DEFAULT_FRAME.
    pub frame: usize,
    /// The components of the task: x, y, z and the three rotations, in world axes.
    pub components: [bool; 6],
    /// Time between steps (s).
    pub dt: f64,
    /// Gain of the position error [1/s].
    pub gain_position: f64,
    /// Gain of the orientation error [1/s].
    pub gain_orientation: f64,
    /// Position tolerance of a target that is reached (m).
    pub tolerance_position: f64,
    /// Orientation tolerance (rad).
    pub tolerance_orientation: f64,
    /// Largest speed of the frame [m/s]; infinite for none.
    pub speed_linear: f64,
    /// Largest angular speed [rad/s]; infinite for none.
    pub speed_angular: f64,
    /// Acceleration limit of coordinates without one in the model [rad/s^2 or m/s^2]; 0 for the default
    /// ramp (20 rad/s^2, or lengths of the mechanism/s^2), infinite for none.
    pub acceleration: f64,
    /// Jerk limit of coordinates without one in the model [rad/s^3 or m/s^3]; infinite for none.
    pub jerk: f64,
    /// Time from a measurement until the drives receive the command computed from it (s).
    pub delay: f64,
    /// Time constant with which the drives follow their commands (s).
    pub time_constant: f64,
    /// Largest error of measured positions [rad or m]: joints keep this distance from their position
    /// limits, wherever the measurements may place them.
    pub noise: f64,
    /// Time for which a commanded twist holds without a new one (s); infinite for no watchdog.
    pub command_timeout: f64,
    /// Characteristic length that scales the linear rows of the Jacobian (m).
    pub length: f64,
    /// Name of the inverse, as `--inverse` of the command line; null for the default.
    pub inverse: *const c_char,
}

/// The status of a servo after a step.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum cyl_servo_status {
    /// Moving towards the target, or along the twist.
    CYL_MOVING = 0,
    /// The target is reached within tolerance; of a twist: all joints rest, and none is commanded.
    CYL_REACHED = 1,
    /// The error no longer falls, or the frame does not move along the twist: cyl_servo_stall().
    CYL_STALLED = 2,
    /// No twist is commanded, or the last command is too old: the joints brake.
    CYL_BRAKING = 3,
}

/// The result of a step.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct cyl_step {
    /// Status.
    pub status: cyl_servo_status,
    /// Distance to the target, in the components of the task (m).
    pub position_error: f64,
    /// Angle to the target (rad).
    pub orientation_error: f64,
    /// Time that the frame is behind a moving target (s).
    pub lag: f64,
    /// Ratio of the smallest to the largest singular value.
    pub singular_ratio: f64,
    /// The share of the task that the limits permit.
    pub scale: f64,
    /// The pose of the frame before the step, by columns.
    pub pose: [f64; 16],
}

fn step_of(step: &Step, status: cyl_servo_status) -> cyl_step {
    let mut pose = [0.0; 16];
    write_pose(step.pose, &mut pose);
    cyl_step {
        status,
        position_error: step.position_error,
        orientation_error: step.orientation_error,
        lag: step.lag,
        singular_ratio: step.singular_ratio,
        scale: step.saturation.scale,
        pose,
    }
}

const fn status_of(status: Status) -> cyl_servo_status {
    match status {
        Status::Moving => cyl_servo_status::CYL_MOVING,
        Status::Reached => cyl_servo_status::CYL_REACHED,
        Status::Stalled => cyl_servo_status::CYL_STALLED,
    }
}

const fn status_of_twist(status: TwistStatus) -> cyl_servo_status {
    match status {
        TwistStatus::AtRest => cyl_servo_status::CYL_REACHED,
        TwistStatus::Braking => cyl_servo_status::CYL_BRAKING,
        TwistStatus::Following => cyl_servo_status::CYL_MOVING,
        TwistStatus::Stalled => cyl_servo_status::CYL_STALLED,
    }
}

/// The default options for a mechanism: 1 kHz, gains of 5/s, its tool or reference.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_servo_defaults(
    mechanism: *const cyl_mechanism,
    options: *mut cyl_servo_options,
) -> cyl_status {
    guard(|| {
        // SAFETY: as the header requires.
        let (mechanism, options) =
            unsafe { (handle("mechanism", mechanism)?, handle_mut("options", options)?) };
        let usual = ServoOptions::new(&mechanism.inner);
        *options = cyl_servo_options {
            frame: CYL_DEFAULT_FRAME,
            components: usual.task.components,
            dt: usual.dt,
            gain_position: usual.gain.position,
            gain_orientation: usual.gain.orientation,
            tolerance_position: usual.tolerance.position,
            tolerance_orientation: usual.tolerance.orientation,
            speed_linear: usual.speed.linear,
            speed_angular: usual.speed.angular,
            acceleration: usual.acceleration.unwrap_or(0.0),
            jerk: usual.jerk,
            delay: usual.plant.delay,
            time_constant: usual.plant.time_constant,
            noise: usual.plant.noise,
            command_timeout: usual.command_timeout,
            length: usual.length,
            inverse: std::ptr::null(),
        };
        Ok(())
    })
}

/// A servo at rest. `options` may be null for the defaults.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_servo_new(
    mechanism: *const cyl_mechanism,
    options: *const cyl_servo_options,
    out: *mut *mut cyl_servo,
) -> cyl_status {
    guard(|| {
        // SAFETY: as the header requires.
        let (mechanism, out) =
            unsafe { (handle("mechanism", mechanism)?, handle_mut("out", out)?) };
        let robot = &mechanism.inner;
        let mut chosen = ServoOptions::new(robot);
        // SAFETY: as the header requires.
        if let Some(o) = unsafe { options.as_ref() } {
            chosen.end_effector = end_effector(robot, o.frame)?;
            chosen.task.components = o.components;
            chosen.dt = o.dt;
            chosen.gain = ServoGains { position: o.gain_position, orientation: o.gain_orientation };
            chosen.tolerance = PoseTolerance {
                position: o.tolerance_position,
                orientation: o.tolerance_orientation,
            };
            chosen.speed = SpeedLimit { linear: o.speed_linear, angular: o.speed_angular };
            chosen.acceleration = (o.acceleration != 0.0).then_some(o.acceleration);
            chosen.jerk = o.jerk;
            chosen.plant.delay = o.delay;
            chosen.plant.time_constant = o.time_constant;
            chosen.plant.noise = o.noise;
            (chosen.command_timeout, chosen.length) = (o.command_timeout, o.length);
            if !o.inverse.is_null() {
                // SAFETY: as the header requires.
                let name = unsafe { text("inverse", o.inverse) }?;
                InverseSelection { name, ..InverseSelection::default() }.apply(&mut chosen)?;
            }
        }
        give(out, cyl_servo { inner: Servo::new(robot, chosen)?, stall: CString::default() });
        Ok(())
    })
}

/// Frees a servo; null is nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_servo_free(servo: *mut cyl_servo) {
    // SAFETY: as the header requires.
    unsafe { free(servo) }
}

/// Writes the velocities of a step and its result.
///
/// # Safety
/// As the header requires of the two pointers.
unsafe fn write(
    servo: &Servo,
    step: cyl_step,
    velocities: *mut f64,
    out: *mut cyl_step,
) -> Result<(), Failure> {
    let own = servo.joint_velocities();
    // SAFETY: n numbers, as the header says.
    unsafe { slice_mut("velocities", velocities, own.len()) }?.copy_from_slice(own);
    // SAFETY: as the header requires.
    if let Some(out) = unsafe { out.as_mut() } {
        *out = step;
    }
    Ok(())
}

/// One step towards a pose: `q` has n numbers, `target` 16, `target_twist` six (world axes, at the
/// frame) or is null for a target at rest; `velocities` takes the n joint velocities to command until the
/// next step; `step` may be null. No allocation (closed chains: away from type II singularities).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_servo_step(
    servo: *mut cyl_servo,
    q: *const f64,
    n: usize,
    target: *const f64,
    target_twist: *const f64,
    velocities: *mut f64,
    step: *mut cyl_step,
) -> cyl_status {
    guard(|| {
        // SAFETY: as the header requires.
        let (servo, q) = unsafe { (handle_mut("servo", servo)?, slice("q", q, n)?) };
        // SAFETY: as the header requires.
        let target = unsafe { target_of(target, target_twist) }?;
        let found = servo.inner.step(q, target)?;
        // SAFETY: as the header requires.
        unsafe { write(&servo.inner, step_of(&found, status_of(found.status)), velocities, step) }
    })
}

/// # Safety
/// As the header requires of the two pointers.
unsafe fn target_of(target: *const f64, target_twist: *const f64) -> Result<Target, Failure> {
    // SAFETY: as required of the caller.
    let (pose, forward) =
        unsafe { (pose("target", target)?, twist("target_twist", target_twist)?) };
    Ok(Target { pose, feed_forward: forward.unwrap_or(Twist::ZERO) })
}

/// One step of a closed chain whose drives alone are measured: `actuated` has
/// cyl_actuated_count() positions; the passive coordinates are tracked. The rest as cyl_servo_step().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_servo_step_actuated(
    servo: *mut cyl_servo,
    actuated: *const f64,
    count: usize,
    target: *const f64,
    target_twist: *const f64,
    velocities: *mut f64,
    step: *mut cyl_step,
) -> cyl_status {
    guard(|| {
        // SAFETY: as the header requires.
        let (servo, actuated) =
            unsafe { (handle_mut("servo", servo)?, slice("actuated", actuated, count)?) };
        // SAFETY: as the header requires.
        let target = unsafe { target_of(target, target_twist) }?;
        let found = servo.inner.step_actuated(actuated, target)?;
        // SAFETY: as the header requires.
        unsafe { write(&servo.inner, step_of(&found, status_of(found.status)), velocities, step) }
    })
}

/// One step along a twist (six numbers, world axes, at the frame), or null if no command came in this
/// cycle: after the time `command_timeout` the joints brake. The rest as cyl_servo_step().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_servo_step_twist(
    servo: *mut cyl_servo,
    q: *const f64,
    n: usize,
    command: *const f64,
    velocities: *mut f64,
    step: *mut cyl_step,
) -> cyl_status {
    guard(|| {
        // SAFETY: as the header requires.
        let (servo, q, command) =
            unsafe { (handle_mut("servo", servo)?, slice("q", q, n)?, twist("command", command)?) };
        let found = servo.inner.step_twist(q, command)?;
        let found = step_of(&found.step, status_of_twist(found.status));
        // SAFETY: as the header requires.
        unsafe { write(&servo.inner, found, velocities, step) }
    })
}

/// cyl_servo_step_twist() of a closed chain whose drives alone are measured, as
/// cyl_servo_step_actuated() takes them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_servo_step_twist_actuated(
    servo: *mut cyl_servo,
    actuated: *const f64,
    count: usize,
    command: *const f64,
    velocities: *mut f64,
    step: *mut cyl_step,
) -> cyl_status {
    guard(|| {
        // SAFETY: as the header requires.
        let (servo, actuated) =
            unsafe { (handle_mut("servo", servo)?, slice("actuated", actuated, count)?) };
        // SAFETY: as the header requires.
        let command = unsafe { twist("command", command) }?;
        let found = servo.inner.step_twist_actuated(actuated, command)?;
        let found = step_of(&found.step, status_of_twist(found.status));
        // SAFETY: as the header requires.
        unsafe { write(&servo.inner, found, velocities, step) }
    })
}

/// Resets a servo to rest.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_servo_reset(servo: *mut cyl_servo) -> cyl_status {
    guard(|| {
        // SAFETY: as the header requires.
        unsafe { handle_mut("servo", servo) }?.inner.reset();
        Ok(())
    })
}

/// Integrates `q` (n numbers) by the velocities of the last step, for the simulation of an ideal robot.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_servo_advance(
    servo: *const cyl_servo,
    q: *mut f64,
    n: usize,
) -> cyl_status {
    guard(|| {
        // SAFETY: as the header requires.
        let (servo, q) = unsafe { (handle("servo", servo)?, slice_mut("q", q, n)?) };
        servo.inner.mechanism().check_q("q", q)?;
        servo.inner.advance(q);
        Ok(())
    })
}

/// How far the loops of a closed chain are open at the configuration of the last step: `distance` (m)
/// and `angle` (rad), zero without loops; near a type II singularity they are not closed. Either may be
/// null. Allocates.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_servo_closure_error(
    servo: *const cyl_servo,
    distance: *mut f64,
    angle: *mut f64,
) -> cyl_status {
    guard(|| {
        // SAFETY: as the header requires.
        let servo = &unsafe { handle("servo", servo) }?.inner;
        let state = servo.mechanism().state(servo.configuration())?;
        let error = ClosedChain::of(&state, None, None)?.closure_error;
        for (out, value) in [(distance, error.distance), (angle, error.angle)] {
            // SAFETY: as the header requires.
            if let Some(out) = unsafe { out.as_mut() } {
                *out = value;
            }
        }
        Ok(())
    })
}

/// The kind of reason why the last step made no progress: "singular", "limits", "out of reach", ...
/// Valid until the next call with this servo. Allocates.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cyl_servo_stall(servo: *mut cyl_servo) -> *const c_char {
    // SAFETY: as the header requires.
    let Some(servo) = (unsafe { servo.as_mut() }) else { return std::ptr::null() };
    servo.stall = CString::new(servo.inner.stall().name()).unwrap_or_default();
    servo.stall.as_ptr()
}
