//! Joints that accelerate slowly brake in time for the tasks of a servo.

use cylindroid::control::{
    LimitKind, MotionTask, StoppedBy, TaskObjective, TaskServo, TaskServoOptions,
};

use super::closed_edges::weakened;
use super::escape::within;
use super::*;

/// A servo of the pose of the tool.
fn of_pose(
    robot: &Mechanism,
    target: impl Into<Target>,
    adapt: impl FnOnce(&mut TaskServoOptions),
) -> TaskServo {
    let objective = TaskObjective::Frame {
        end_effector: robot.tool().into(),
        components: Task::POSE,
        target: target.into(),
    };
    let mut options = TaskServoOptions { dt: 4e-3, ..TaskServoOptions::new(robot) };
    adapt(&mut options);
    TaskServo::new(robot, vec![MotionTask::new("hand", objective)], options).unwrap()
}

/// Time to the target (s), and by how much the scaled error rises on the way.
fn arrival(servo: &mut TaskServo, start: &[f64], length: f64) -> [f64; 2] {
    let (mut q, mut least, mut rise) = (start.to_vec(), f64::INFINITY, 0.0_f64);
    for i in 0..(20.0 / servo.dt()) as usize {
        let status = servo.step(&q).unwrap();
        servo.advance(&mut q);
        let report = servo.reports()[0];
        let error = (report.position_error / length).hypot(report.orientation_error);
        least = least.min(error);
        rise = rise.max(error - least);
        if status == Status::Reached {
            return [i as f64 * servo.dt(), rise];
        }
    }
    [f64::INFINITY, rise]
}

/// Weak joints stop at their target. Without braking in time the error rose by up to 0.6 on the way, with
/// limits of the jerk by 0.9, and half of these did not arrive in 20 s.
#[test]
fn weak_joints_arrive() {
    for (name, keep_directions) in [("panda", true), ("ur5e", false), ("iiwa14", true)] {
        for (acceleration, jerk, most, seconds) in [
            (0.5, f64::INFINITY, 1e-3, 12.0),
            (2.0, f64::INFINITY, 1e-3, 8.0),
            (f64::INFINITY, 30.0, 0.02, 10.0),
            (2.0, 5.0, 0.02, 20.0),
        ] {
            let robot = weakened(name, acceleration);
            let mut random = Random(73);
            for _ in 0..6 {
                let start = within(&robot, &mut random);
                let end = within(&robot, &mut random);
                let end: Vec<f64> =
                    start.iter().zip(&end).map(|(a, b)| a + 0.15 * (b - a)).collect();
                let target = robot.state(&end).unwrap().pose(robot.tool()).unwrap();
                let mut servo = of_pose(&robot, target, |o| {
                    (o.jerk, o.keep_directions) = (jerk, keep_directions)
                });
                let [time, rise] =
                    arrival(&mut servo, &start, TaskServoOptions::new(&robot).length);
                let case = format!("{name} {acceleration} {jerk}: {time:.2} s, rise {rise:.1e}");
                println!("{case}");
                assert!(time < seconds && rise < most, "{case}");
            }
        }
    }
}

/// The share of the velocity that is left, and what brakes.
#[test]
fn braking_is_reported() {
    let mut builder = Mechanism::builder("slide");
    builder.joint(JointSpec {
        limits: Limits { acceleration: 0.2, ..Limits::NONE },
        ..JointSpec::new("x", JointKind::Prismatic, "base", "carriage")
    });
    let robot = builder.build().unwrap();
    let objective = TaskObjective::Frame {
        end_effector: robot.frame("carriage").unwrap().into(),
        components: Task { components: [false, false, true, false, false, false], ..Task::POSE },
        target: Pose::from_translation(Vec3::Z * 0.5).into(),
    };
    let options = TaskServoOptions { dt: 4e-3, ..TaskServoOptions::new(&robot) };
    let mut servo =
        TaskServo::new(&robot, vec![MotionTask::new("tool", objective)], options).unwrap();
    let (mut q, mut last, mut braked) = (vec![0.0], 0.0, 0);
    for _ in 0..2000 {
        let asked = 5.0 * (0.5 - q[0]);
        servo.step(&q).unwrap();
        servo.advance(&mut q);
        let (rate, report) = (servo.joint_velocities()[0], servo.reports()[0]);
        if rate < last && rate < asked && report.stopped_by.is_some() {
            let expected = StoppedBy::Limit { coordinate: 0, kind: LimitKind::Acceleration };
            assert_eq!(report.stopped_by, Some(expected));
            assert!((report.scale - rate / asked).abs() < 1e-9, "{report:?} {rate} {asked}");
            braked += 1;
        }
        last = rate;
    }
    assert!(braked > 100 && (q[0] - 0.5).abs() < 1e-6, "{braked} {q:?}");
}

/// The weight of a task that is alone says nothing.
#[test]
fn braking_does_not_depend_on_the_weight_of_the_only_task() {
    let robot = weakened("panda", 1.0);
    let tool = robot.tool();
    let target = robot.state(&[0.8, 0.2, -0.3, -1.2, 0.2, 2.0, 0.3]).unwrap().pose(tool).unwrap();
    let length = TaskServoOptions::new(&robot).length;
    let [time, _] = arrival(&mut of_pose(&robot, target, |_| ()), robot.home(), length);
    assert!(time.is_finite());
    for weight in [1e-6, 1e-2, 1e2, 1e6] {
        let objective = TaskObjective::Frame {
            end_effector: tool.into(),
            components: Task::POSE,
            target: target.into(),
        };
        let task = MotionTask { weight, ..MotionTask::new("hand", objective) };
        let options = TaskServoOptions { dt: 4e-3, ..TaskServoOptions::new(&robot) };
        let mut servo = TaskServo::new(&robot, vec![task], options).unwrap();
        let [other, _] = arrival(&mut servo, robot.home(), length);
        assert_eq!(other, time, "{weight}");
    }
}

/// A moving target whose velocity is known is followed by joints that need longer to stop than the gain
/// takes: nothing turns back there, for the target moves on.
#[test]
fn moving_targets_are_not_braked_for() {
    let robot = weakened("ur5e", 0.5);
    let start = [0.4, -1.2, 1.4, -1.0, 1.2, 0.3];
    let home = robot.state(&start).unwrap().pose(robot.tool()).unwrap();
    let speed = Vec3::new(0.1, -0.05, 0.04);
    let moved = |time: f64| Target {
        pose: Pose { translation: home.translation + speed * time, ..home },
        feed_forward: Twist { linear: speed, angular: Vec3::ZERO },
    };
    let mut servo = of_pose(&robot, moved(0.0), |_| ());
    let mut q = start.to_vec();
    for i in 0..1000 {
        let time = i as f64 * servo.dt();
        if let TaskObjective::Frame { target, .. } = servo.objective_mut("hand").unwrap() {
            *target = moved(time);
        }
        servo.step(&q).unwrap();
        servo.advance(&mut q);
        let report = servo.reports()[0];
        assert!(time < 2.0 || report.scale == 1.0, "{time}: {report:?}");
        assert!(time < 3.0 || report.position_error < 1e-4, "{time}: {report:?}");
    }
}

/// Pushed outwards by a twist, weak arms come to rest at the edge and do not swing.
#[test]
fn twists_outwards_end_at_the_edge() {
    for name in ["ur5e", "panda"] {
        for acceleration in [0.5, 2.0] {
            let robot = weakened(name, acceleration);
            let home = robot.state(robot.home()).unwrap().pose(robot.tool()).unwrap();
            let mut servo = of_pose(&robot, home, |_| ());
            let speed = Vec3::new(0.48, -0.36, 0.8) * (0.1 * robot.reach());
            let (mut q, mut farthest, mut back) = (robot.home().to_vec(), 0.0_f64, 0.0_f64);
            for _ in 0..(30.0 / servo.dt()) as usize {
                let twist = Twist { linear: speed, angular: Vec3::ZERO };
                servo.command_twist("hand", twist, 0.1).unwrap();
                servo.step(&q).unwrap();
                servo.advance(&mut q);
                let at = robot.state(&q).unwrap().pose(robot.tool()).unwrap().translation;
                let way = (at - home.translation).dot(speed.unit(1e-9).unwrap()) / robot.reach();
                farthest = farthest.max(way);
                back = back.max(farthest - way);
            }
            let case = format!("{name} {acceleration}: {farthest:.4}, back {back:.1e}");
            println!("{case}");
            assert!(farthest > 0.1 && back < 1e-3, "{case}");
        }
    }
}

/// How far the tool of a closed chain moves back on its way to a target beyond reach, of its reach, and
/// when it is named as stalled (s).
fn back_of_closed_chain(name: &str, acceleration: f64, direction: Vec3) -> [f64; 2] {
    let robot = weakened(name, acceleration);
    let mut q = cylindroid::closure::assemble(&robot, robot.home(), &[]).unwrap().q;
    let home = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
    let target = Pose { translation: home.translation + direction * (2.0 * robot.reach()), ..home };
    let objective = TaskObjective::Frame {
        end_effector: robot.tool().into(),
        components: Task::POSITION,
        target: target.into(),
    };
    let options = TaskServoOptions { dt: 1e-2, ..TaskServoOptions::new(&robot) };
    let tasks = vec![MotionTask::new("tool", objective)];
    let mut servo = TaskServo::new(&robot, tasks, options).unwrap();
    let (mut least, mut back, mut named) = (f64::INFINITY, 0.0_f64, f64::INFINITY);
    for i in 0..2000 {
        let status = servo.step(&q).unwrap();
        servo.advance(&mut q);
        let error = servo.reports()[0].position_error;
        least = least.min(error);
        back = back.max((error - least) / robot.reach());
        if status == Status::Stalled {
            named = named.min(i as f64 * servo.dt());
        } else {
            named = f64::INFINITY;
        }
    }
    [back, named]
}

/// Drives of closed chains stop at the edge of the workspace. They moved back by 0.05 of reach.
#[test]
fn closed_chains_rest_at_the_edge() {
    for name in ["five-bar", "3rrr", "delta", "stewart"] {
        for acceleration in [0.5, 5.0] {
            let [back, named] = back_of_closed_chain(name, acceleration, Vec3::X);
            assert!(back < 2e-3 && named < 20.0, "{name} {acceleration}: {back:.4}, {named} s");
        }
    }
}

#[test]
#[ignore = "a table"]
fn table_of_closed_chains_of_tasks_at_the_edge() {
    for name in ["five-bar", "3rrr", "delta", "stewart"] {
        for acceleration in [0.5, 2.0, 5.0, 40.0] {
            let (mut back, mut named) = (0.0_f64, 0.0_f64);
            for direction in [Vec3::X, Vec3::Y, -Vec3::Y, -Vec3::X, Vec3::new(0.5, 0.4, 0.7)] {
                let own = back_of_closed_chain(name, acceleration, direction);
                (back, named) = (back.max(own[0]), named.max(own[1]));
            }
            println!("{name} at {acceleration}: back by {back:.4} of reach, named after {named} s");
        }
    }
}
