//! The servo: laws, limits, stalls, secondary tasks.

mod braking_path;
mod closed_edges;
mod closed_tasks;
mod condition;
mod edge;
mod escape;
mod figure_eights;
mod hybrid;
mod inertia;
mod internal_force;
mod inverse_choice;
mod jerk;
mod just_beyond;
mod limits;
mod measured;
mod measured_twist;
mod moving;
mod object;
mod plant;
mod plant_noise;
mod projection;
mod reconfiguration;
mod reference_point;
mod secondary;
mod shared;
mod stall;
mod steps;
mod task_braking;
mod task_edges;
mod task_invariance;
mod task_kinds;
mod task_reports;
mod task_twist;
mod tasks;
mod tool_speed;
mod twist;
mod weak_postures;

pub(crate) use tasks::two_armed;

pub(crate) use cylindroid::control::{
    JointDefaults, JointMove, JointSample, JointState, KinematicBounds, LimitKind, MotionResult,
    PoseTolerance, SecondaryNullSpace, SecondaryTask, ServoGains, SpeedLimit, Stall, Status,
    Target, Task, VelocityBounds, find_reachable_configuration, simulate,
};
pub(crate) use cylindroid::inverse::Method;
pub(crate) use cylindroid::linalg::{RowSpace, Svd};
pub(crate) use cylindroid::model::{JointKind, JointSpec, Limits, Mimic};
pub(crate) use cylindroid::spatial::{Pose, Rotation, Rpy, Twist, Vec3};
pub(crate) use cylindroid::{
    Error, Matrix, Mechanism, ReferenceFrame, Servo, ServoOptions, catalogue,
};

pub(crate) use crate::support::{Random, odd_arm, planar, unlimited};

pub(crate) fn run(servo: &mut Servo, q: &[f64], target: Pose) -> MotionResult {
    simulate(servo, q, 30.0, |_| (Target::from(target), true), |_| {}).unwrap()
}

pub(crate) fn servo(robot: &Mechanism, change: impl FnOnce(&mut ServoOptions)) -> Servo {
    let mut options = ServoOptions::new(robot);
    change(&mut options);
    Servo::new(robot, options).unwrap()
}

/// Drives and checks on every step that no limit is left: position, velocity, acceleration.
pub(crate) fn run_checked(
    robot: &Mechanism,
    servo: &mut Servo,
    q: &[f64],
    target: Pose,
) -> MotionResult {
    run_checked_for(30.0, robot, servo, q, target)
}

pub(crate) fn run_checked_for(
    duration: f64,
    robot: &Mechanism,
    servo: &mut Servo,
    q: &[f64],
    target: Pose,
) -> MotionResult {
    let dt = servo.options().dt;
    let fallback = servo.options().acceleration.unwrap_or(f64::INFINITY);
    let mut before = vec![0.0; robot.n()];
    servo.reset();
    simulate(
        servo,
        q,
        duration,
        |_| (Target::from(target), true),
        |sample| {
            for (i, c) in robot.coordinates().iter().enumerate() {
                let (l, q, rate) = (&c.limits, sample.q[i], sample.joint_velocities[i]);
                let a = if l.acceleration.is_finite() { l.acceleration } else { fallback };
                assert!(rate.is_finite() && q.is_finite(), "{} is not finite", c.name);
                assert!(q >= l.lower && q <= l.upper, "{} left its limits: {q}", c.name);
                assert!(rate.abs() <= l.velocity * (1.0 + 1e-12), "{}: rate {rate}", c.name);
                // A position has no more digits than f64: their rounding, over dt, is in the rate.
                let rounding = 16.0 * f64::EPSILON * (1.0 + q.abs()) / dt;
                let excess = (rate - before[i]).abs() - a * dt * (1.0 + 1e-12);
                assert!(
                    excess <= rounding + 1e-15 * rate.abs(),
                    "{}: {excess:e} over {}, rounding {rounding:e}",
                    c.name,
                    a * dt
                );
                before[i] = rate;
            }
        },
    )
    .unwrap()
}
