//! Reconfiguration: a configuration within all limits that reaches a target at which the servo,
//! moving straight towards it, stalls.
//!
//! Method   inverse kinematics with the present configuration as initial guess; of several
//!          solutions the closest one. Position limits form a box, so the straight joint-space path
//!          to it respects them.
//! Units    rad, m
//! Valid    any task; trees without spherical and free joints (otherwise `None`). `None` means that
//!          no restart reached the target: probably, but not provably, no configuration does. The
//!          restarts are the same in every run.
//! Why so   a servo nearly always stalls because of its initial configuration
//! Checked  tests/it/servo/reconfiguration.rs::a_reconfiguration_reaches_what_the_servo_does_not

use crate::control::servo::Servo;
use crate::error::Result;
use crate::ik::{Budget, Goal, ITERATIONS_PER_RESTART, IkOptions, solve};
use crate::model::CoordinateKind;
use crate::spatial::Pose;

/// Share of the servo's tolerance within which the configuration reaches the target [-].
const WITHIN: f64 = 0.5;

/// A configuration that reaches the target.
#[derive(Debug, Clone, PartialEq)]
pub struct Reconfiguration {
    /// The configuration, all n coordinates.
    pub q: Vec<f64>,
    /// Number of restarts, including those for closer solutions.
    pub restarts: usize,
}

/// A configuration within the limits that places the servo's end effector at `target`; coordinates
/// that do not move the end effector, and those locked by a limit, keep their values of `q`.
///
/// ```
/// use cylindroid::control::find_reachable_configuration;
/// use cylindroid::{Servo, ServoOptions};
///
/// let robot = cylindroid::load("ur5e")?;
/// let servo = Servo::new(&robot, ServoOptions::new(&robot))?;
/// let target = robot.state(&[0.3, -1.1, 1.4, 0.2, 1.0, 0.4])?.pose(robot.tool())?;
/// let found = find_reachable_configuration(&servo, robot.home(), target, 100)?.expect("in reach");
/// let there = robot.state(&found.q)?.pose(robot.tool())?;
/// assert!(there.error_to(target).linear.norm() < servo.options().tolerance.position);
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// # Errors
/// A `q` of the wrong size or non-finite; a non-finite target.
pub fn find_reachable_configuration(
    servo: &Servo,
    q: &[f64],
    target: Pose,
    max_restarts: usize,
) -> Result<Option<Reconfiguration>> {
    let mechanism = servo.mechanism();
    mechanism.check_q("q", q)?;
    let straight = |c: &usize| {
        matches!(mechanism.coordinates()[*c].kind, CoordinateKind::Angle | CoordinateKind::Length)
    };
    if mechanism.is_closed() || !servo.coordinates().iter().all(straight) {
        return Ok(None); // there is no straight way for spherical and free joints, nor in loops
    }
    let options = servo.options();
    let free: Vec<usize> = servo.free_coordinates().collect();
    let ik = IkOptions {
        position_tolerance: WITHIN * options.tolerance.position,
        orientation_tolerance: WITHIN * options.tolerance.orientation,
        initial_guess: Some(q.to_vec()),
        fixed: (0..mechanism.n()).filter(|c| !free.contains(c)).collect(),
        nearest: true,
        budget: Budget {
            iterations: ITERATIONS_PER_RESTART.saturating_mul(max_restarts.max(1)),
            time: None,
        },
        length: Some(options.length),
        ..IkOptions::default()
    };
    let goal = Goal::frame(options.end_effector, options.task, target);
    let found = solve(mechanism, &[goal], &ik)?;
    Ok(found.success.then_some(Reconfiguration { q: found.q, restarts: found.restarts }))
}
