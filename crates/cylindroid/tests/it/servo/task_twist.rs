//! Velocity mode of a servo of many tasks: a frame follows a twist while the others hold.

use cylindroid::control::{MotionTask, TaskObjective, TaskServo, TaskServoOptions};

use super::*;

const DT: f64 = 2e-3;

fn servo_of_hands(robot: &Mechanism, q: &[f64]) -> TaskServo {
    let state = robot.state(q).unwrap();
    let hand = |name: &str| {
        let frame = robot.frame(name).unwrap();
        let target = state.pose(frame).unwrap().into();
        let objective =
            TaskObjective::Frame { end_effector: frame.into(), components: Task::POSE, target };
        MotionTask::new(name, objective)
    };
    let posture = MotionTask::new("posture", TaskObjective::Posture { q: q.to_vec() });
    let tasks = vec![hand("right_6_link"), hand("left_6_link").at_level(1), posture];
    TaskServo::new(robot, tasks, TaskServoOptions { dt: DT, ..TaskServoOptions::new(robot) })
        .unwrap()
}

fn bent(robot: &Mechanism) -> Vec<f64> {
    (0..robot.n()).map(|i| 0.6 * f64::from(1 - 2 * (i as i32 % 2))).collect()
}

fn pose(robot: &Mechanism, q: &[f64], name: &str) -> Pose {
    robot.state(q).unwrap().pose(robot.frame(name).unwrap()).unwrap()
}

/// The left hand follows, the right one stays, and the left one rests when the commands cease.
#[test]
fn a_hand_follows_a_twist_while_the_other_stays() {
    let robot = two_armed();
    let mut q = bent(&robot);
    let mut servo = servo_of_hands(&robot, &q);
    let twist = Twist { linear: Vec3::new(0.02, -0.01, 0.03), angular: Vec3::new(0.0, 0.05, 0.1) };
    assert_eq!(servo.commanded_twist("left_6_link").unwrap(), None);
    let [left, right] = ["left_6_link", "right_6_link"].map(|name| pose(&robot, &q, name));
    let mut status = Status::Reached;
    for step in 0..300 {
        if step % 10 == 0 {
            servo.command_twist("left_6_link", twist, 0.05).unwrap();
        }
        let before = pose(&robot, &q, "left_6_link");
        status = servo.step(&q).unwrap();
        servo.advance(&mut q);
        let rate = before.error_to(pose(&robot, &q, "left_6_link")) * (1.0 / DT);
        if step > 20 {
            let off = rate - twist;
            assert!(off.linear.norm() + off.angular.norm() < 1e-3, "{step}: {off:?}");
        }
    }
    assert_eq!(status, Status::Moving);
    assert_eq!(servo.reports()[1].scale, 1.0);
    let off = right.error_to(pose(&robot, &q, "right_6_link"));
    // The curvature of a step, against a gain of 5/s.
    assert!(off.linear.norm() + off.angular.norm() < 1e-5, "{off:?}");
    let moved = left.error_to(pose(&robot, &q, "left_6_link")).linear - twist.linear * (300.0 * DT);
    assert!(moved.norm() < 1e-3, "{moved:?}");

    // 0.05 s are 25 steps after that of the command.
    let followed = |servo: &TaskServo| servo.commanded_twist("left_6_link").unwrap().unwrap();
    for step in 10..300 {
        assert_eq!(followed(&servo) == Twist::ZERO, step > 25, "{step}");
        status = servo.step(&q).unwrap();
        servo.advance(&mut q);
    }
    assert_eq!(status, Status::Reached);
    let at = pose(&robot, &q, "left_6_link");
    servo.step(&q).unwrap();
    servo.advance(&mut q);
    let off = at.error_to(pose(&robot, &q, "left_6_link"));
    assert!(off.linear.norm() + off.angular.norm() < 1e-9, "{off:?}");

    // A target ends it, and a reset.
    let Ok(TaskObjective::Frame { target, .. }) = servo.objective_mut("left_6_link") else {
        unreachable!("the task of a frame")
    };
    *target = left.into();
    assert_eq!(servo.commanded_twist("left_6_link").unwrap(), None);
    for _ in 0..3000 {
        status = servo.step(&q).unwrap();
        servo.advance(&mut q);
    }
    assert_eq!(status, Status::Reached);
    let off = left.error_to(pose(&robot, &q, "left_6_link"));
    assert!(off.linear.norm() < 1e-5, "{off:?}");
    servo.command_twist("left_6_link", twist, f64::INFINITY).unwrap();
    servo.reset();
    assert_eq!(servo.commanded_twist("left_6_link").unwrap(), None);
}

/// Pushed out of its reach the hand stalls, and the other one stays.
#[test]
fn pushed_outwards_a_task_stalls() {
    let robot = two_armed();
    let mut q = bent(&robot);
    let mut servo = servo_of_hands(&robot, &q);
    let right = pose(&robot, &q, "right_6_link");
    let out = Twist { linear: Vec3::new(0.4, 0.4, 0.0), angular: Vec3::ZERO };
    for _ in 0..6000 {
        servo.command_twist("left_6_link", out, 0.1).unwrap();
        servo.step(&q).unwrap();
        servo.advance(&mut q);
    }
    assert_eq!(servo.reports()[1].status, Status::Stalled, "{:?}", servo.reports()[1]);
    let off = right.error_to(pose(&robot, &q, "right_6_link"));
    assert!(off.linear.norm() + off.angular.norm() < 1e-5, "{off:?}");
}

#[test]
fn commands_without_an_answer_are_named() {
    let robot = two_armed();
    let q = bent(&robot);
    let mut servo = servo_of_hands(&robot, &q);
    let twist = Twist { linear: Vec3::X * 0.1, angular: Vec3::ZERO };
    for (name, twist, timeout, expected) in [
        ("left_5_link", twist, 0.1, "left_6_link"),
        ("posture", twist, 0.1, "no task of a frame"),
        ("left_6_link", twist * f64::NAN, 0.1, "commanded twist"),
        ("left_6_link", twist, 0.0, "timeout"),
        ("left_6_link", twist, f64::NAN, "timeout"),
    ] {
        let error = servo.command_twist(name, twist, timeout).unwrap_err().to_string();
        assert!(error.contains(expected), "'{expected}' not in: {error}");
    }
    assert!(servo.commanded_twist("left").is_err());
    assert_eq!(servo.commanded_twist("left_6_link").unwrap(), None);
}
