//! Limits of the jerk: kept in every step, with the targets reached.

use cylindroid::control::{MotionTask, TaskObjective, TaskServo, TaskServoOptions};
use cylindroid::model::JointLimits;

use super::*;

/// Accelerations and jerks of published arms.
fn panda() -> Mechanism {
    let panda = cylindroid::load("panda").unwrap();
    let jerks = [7500.0, 3750.0, 5000.0, 6250.0, 7500.0, 10_000.0, 10_000.0];
    let limits: Vec<(&str, JointLimits)> = panda
        .coordinates()
        .iter()
        .zip(jerks)
        .map(|(c, jerk)| {
            // A twentieth, so that it counts at the usual gains.
            (c.name.as_str(), JointLimits { jerk: Some(0.05 * jerk), ..JointLimits::default() })
        })
        .collect();
    panda.with_limits(&limits).unwrap()
}

/// Largest share of a limit of the jerk and of the acceleration in a list of velocities.
fn shares(robot: &Mechanism, velocities: &[Vec<f64>], dt: f64) -> [f64; 2] {
    let mut most = [0.0_f64; 2];
    for (i, c) in robot.coordinates().iter().enumerate() {
        let at = |k: usize| if k < 2 { 0.0 } else { velocities[k - 2][i] };
        for k in 2..velocities.len() + 2 {
            let change = (at(k) - at(k - 1)) / dt;
            let before = if k > 2 { (at(k - 1) - at(k - 2)) / dt } else { 0.0 };
            most[0] = most[0].max((change - before).abs() / dt / c.limits.jerk);
            most[1] = most[1].max(change.abs() / c.limits.acceleration);
        }
    }
    most
}

#[test]
fn targets_are_reached_within_limits_of_the_jerk() {
    let robot = panda();
    for dt in [1e-3, 4e-3] {
        let mut servo = servo(&robot, |o| o.dt = dt);
        let mut q = vec![0.3, -0.4, 0.1, -2.0, 0.2, 1.7, 0.5];
        let start = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
        let mut velocities = Vec::new();
        for way in [Vec3::new(0.1, -0.2, 0.1), Vec3::new(-0.15, 0.1, -0.05), Vec3::ZERO] {
            let target = Pose { translation: start.translation + way, ..start };
            let mut status = Status::Moving;
            let mut furthest = f64::INFINITY;
            for _ in 0..(8.0 / dt) as usize {
                let step = servo.step(&q, target).unwrap();
                status = step.status;
                velocities.push(servo.joint_velocities().to_vec());
                servo.advance(&mut q);
                // No swing about the target.
                assert!(step.position_error < furthest + 2e-3, "{}", step.position_error);
                furthest = furthest.min(step.position_error);
                if status != Status::Moving {
                    break;
                }
            }
            assert_eq!(status, Status::Reached, "dt {dt}, way {way:?}: {:?}", servo.stall());
        }
        let [jerk, acceleration] = shares(&robot, &velocities, dt);
        assert!(jerk < 1.0 + 1e-6 && jerk > 0.9, "{jerk}");
        assert!(acceleration < 1.0 + 1e-9, "{acceleration}");
    }
}

/// Driven against its limits, a joint stops at them, and nothing is left.
#[test]
fn joints_stop_at_their_limits_within_the_jerk() {
    for (acceleration, jerk) in [(10.0, 20.0), (10.0, 1e4), (f64::INFINITY, 50.0), (0.5, 1.0)] {
        let limits =
            Limits { lower: -0.6, upper: 1.0, velocity: 1.5, acceleration, jerk, ..Limits::NONE };
        let dt = 2e-3;
        let mut now = JointState { position: 0.0, velocity: 0.0, acceleration: 0.0 };
        let mut fastest = 0.0_f64;
        for (way, steps) in [(1.0, 4000), (-1.0, 4000), (1.0, 300), (-1.0, 5000)] {
            for _ in 0..steps {
                let bounds = VelocityBounds::next(&limits, now, dt);
                assert!(bounds.lower <= bounds.upper, "{bounds:?} {now:?}");
                let v = if way > 0.0 { bounds.upper } else { bounds.lower };
                let a = (v - now.velocity) / dt;
                assert!((a - now.acceleration).abs() <= jerk * dt * (1.0 + 1e-6), "{now:?} {v}");
                assert!(a.abs() <= acceleration * (1.0 + 1e-9) && v.abs() <= 1.5, "{now:?} {v}");
                now = JointState { position: now.position + dt * v, velocity: v, acceleration: a };
                assert!(now.position <= 1.0 && now.position >= -0.6, "{now:?}");
                fastest = fastest.max(v.abs());
            }
        }
        assert!(now.position < -0.6 + 1e-6 && now.velocity.abs() < 1e-9, "{now:?}");
        assert!(fastest > if jerk > 10.0 { 0.9 } else { 0.3 }, "{fastest}");
    }
}

/// A joint that a push leaves too near to its limit stops there, whatever its jerk.
#[test]
fn positions_take_precedence_after_a_push() {
    let limits = Limits {
        lower: -1.0,
        upper: 1.0,
        velocity: 1.5,
        acceleration: 5.0,
        jerk: 10.0,
        ..Limits::NONE
    };
    for (position, velocity) in [(0.999, 1.0), (-0.9999, -1.2), (1.001, 0.4), (1.0, 0.0)] {
        let dt = 1e-3;
        let mut now = JointState { position, velocity, acceleration: 0.0 };
        for _ in 0..2000 {
            let bounds = VelocityBounds::next(&limits, now, dt);
            assert!(bounds.lower <= bounds.upper, "{bounds:?} {now:?}");
            let v = bounds.clamp(now.velocity);
            let outside = (now.position.abs() - 1.0).max(0.0);
            let next = now.position + dt * v;
            assert!((next.abs() - 1.0).max(0.0) <= outside, "{now:?} {v}");
            let a = (v - now.velocity) / dt;
            let is_jump = (a - now.acceleration).abs() > 10.0 * dt * (1.0 + 1e-6);
            now = JointState {
                position: next,
                velocity: v,
                acceleration: if is_jump { 0.0 } else { a },
            };
        }
    }
}

/// Many tasks, with bodies that keep their distance.
#[test]
fn many_tasks_keep_jerks() {
    let robot = panda();
    let mut q = vec![0.3, -0.4, 0.1, -2.0, 0.2, 1.7, 0.5];
    let start = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
    let target = Pose { translation: start.translation + Vec3::new(0.1, -0.2, 0.1), ..start };
    let objective = TaskObjective::Frame {
        end_effector: robot.tool().into(),
        components: Task::POSE,
        target: target.into(),
    };
    let options = TaskServoOptions::new(&robot);
    let dt = options.dt;
    let mut servo =
        TaskServo::new(&robot, vec![MotionTask::new("tool", objective)], options).unwrap();
    let mut velocities = Vec::new();
    let mut status = Status::Moving;
    while status == Status::Moving && velocities.len() < 8000 {
        status = servo.step(&q).unwrap();
        velocities.push(servo.joint_velocities().to_vec());
        servo.advance(&mut q);
    }
    assert_eq!(status, Status::Reached, "{:?}", servo.reports());
    let [jerk, acceleration] = shares(&robot, &velocities, dt);
    assert!(jerk < 1.0 + 1e-6 && jerk > 0.9, "{jerk}");
    assert!(acceleration < 1.0 + 1e-9, "{acceleration}");
}

/// Drives of closed chains keep their jerks; passive joints have none.
#[test]
fn drives_of_closed_chains_keep_jerks() {
    for (name, way) in [("stewart", Vec3::Z * 0.05), ("five-bar", Vec3::X * 0.1)] {
        let robot = cylindroid::load(name).unwrap();
        let (dt, jerk) = (1e-3, 20.0);
        let mut servo = servo(&robot, |o| {
            (o.dt, o.jerk, o.acceleration) = (dt, jerk, Some(5.0));
            if name == "five-bar" {
                o.task = Task::POSITION;
            }
        });
        let mut q = robot.home().to_vec();
        let start = robot.state(&q).unwrap().pose(robot.reference()).unwrap();
        let target = Pose { translation: start.translation + way, ..start };
        let mut last = [vec![0.0; robot.n()], vec![0.0; robot.n()]];
        let (mut status, mut steps, mut most) = (Status::Moving, 0, 0.0_f64);
        while status == Status::Moving && steps < 8000 {
            status = servo.step(&q, target).unwrap().status;
            let now = servo.joint_velocities().to_vec();
            for i in robot.actuated() {
                let bend = now[i] - 2.0 * last[1][i] + last[0][i];
                most = most.max(bend.abs() / (dt * dt));
            }
            last = [std::mem::take(&mut last[1]), now];
            servo.advance(&mut q);
            steps += 1;
        }
        assert_eq!(status, Status::Reached, "{name}: {:?}", servo.stall());
        assert!(most < jerk * (1.0 + 1e-6) && most > 0.5 * jerk, "{name}: {most}");
    }
}

/// Mirrored, in other units of length and of time: the same bounds.
#[test]
fn bounds_do_not_depend_on_units_and_signs() {
    let mut random = Random(5);
    for _ in 0..2000 {
        let mut next = |from: f64, to: f64| random.within(from, to);
        let limits = Limits {
            lower: next(-2.0, -0.1),
            upper: next(0.1, 2.0),
            velocity: next(0.2, 3.0),
            acceleration: next(0.5, 20.0),
            jerk: next(1.0, 400.0),
            ..Limits::NONE
        };
        let dt = 0.002;
        let now = JointState {
            position: next(0.9 * limits.lower, 0.9 * limits.upper),
            velocity: next(-0.05, 0.05),
            acceleration: next(-0.1, 0.1),
        };
        let own = VelocityBounds::next(&limits, now, dt);
        assert!(own.lower < own.upper, "{own:?}");
        for (size, time) in [(1.0, 1.0), (-1.0, 1.0), (1e3, 1.0), (-0.01, 1.0), (1.0, 60.0)] {
            let [v, a, j] = [1, 2, 3].map(|k| size / f64::powi(time, k));
            let ends = [size * limits.lower, size * limits.upper];
            let there = Limits {
                lower: ends[0].min(ends[1]),
                upper: ends[0].max(ends[1]),
                velocity: limits.velocity * v.abs(),
                acceleration: limits.acceleration * a.abs(),
                jerk: limits.jerk * j.abs(),
                ..Limits::NONE
            };
            let now = JointState {
                position: size * now.position,
                velocity: v * now.velocity,
                acceleration: a * now.acceleration,
            };
            let found = VelocityBounds::next(&there, now, time * dt);
            let ends = [found.lower / v, found.upper / v];
            let [lower, upper] = [ends[0].min(ends[1]), ends[0].max(ends[1])];
            let most = 1e-8 * limits.velocity;
            assert!((lower - own.lower).abs() < most, "{own:?} {found:?} {size} {time}");
            assert!((upper - own.upper).abs() < most, "{own:?} {found:?} {size} {time}");
        }
    }
}
