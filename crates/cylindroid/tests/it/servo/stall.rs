//! Why a servo stops.

use super::*;

#[test]
fn stall_out_of_reach_is_proved_by_the_length() {
    let robot = planar(3);
    let mut servo = servo(&robot, |o| o.task = Task::POSITION);
    let far = Pose::from_translation(Vec3::new(2.0, 3.0, 0.0));
    let outcome = run_checked(&robot, &mut servo, &[0.1, 0.4, 0.3], far);
    assert!(!outcome.reached);
    let Some(Stall::OutOfReach { distance, length }) = outcome.stall else {
        panic!("{:?}", outcome.stall)
    };
    assert!((distance - 13.0_f64.sqrt()).abs() < 1e-12 && (length - 3.0).abs() < 1e-12);
    // As near as it can get, at rest.
    assert!((outcome.last.position_error - (distance - 3.0)).abs() < 1e-2);
}

#[test]
fn stall_at_a_limit_names_the_joint() {
    let robot = planar(2);
    let mut servo = servo(&robot, |o| o.task = Task::POSITION);
    // Reached only with q1 beyond its limit of 3 rad (elbow on this side).
    let q: [f64; 2] = [2.8, 0.5];
    let reach = |a: f64, b: f64| Vec3::new(a.cos() + (a + b).cos(), a.sin() + (a + b).sin(), 0.0);
    let outcome = run_checked(&robot, &mut servo, &q, Pose::from_translation(reach(3.3, 0.5)));
    assert!(!outcome.reached);
    assert_eq!(outcome.stall, Some(Stall::Limits { coordinates: vec![0] }));
    assert!(outcome.limits_hit.contains(&(0, LimitKind::Position)));
}

#[test]
fn stall_in_a_singular_pose_names_the_direction() {
    let robot = planar(2);
    let mut servo = servo(&robot, |o| o.task = Task::POSITION);
    // Stretched along x, target on the same line: no joint can start the motion.
    let outcome = run(&mut servo, &[0.0, 0.0], Pose::from_translation(Vec3::new(1.5, 0.0, 0.0)));
    let Some(Stall::Singular { ratio, direction }) = outcome.stall else {
        panic!("{:?}", outcome.stall)
    };
    assert!(ratio < 1e-12 && (direction[0].abs() - 1.0).abs() < 1e-9);
}

#[test]
fn stall_with_too_few_joints_says_so() {
    let robot = planar(2);
    let mut servo = servo(&robot, |o| o.task = Task::POSE);
    let q = [0.3, 0.9];
    let start = robot.state(&q).unwrap().pose(robot.tool());
    let up = Pose { translation: start.translation + Vec3::Z * 0.1, ..start };
    let outcome = run(&mut servo, &q, up);
    let Some(Stall::TooFewJoints { rank, task, direction }) = outcome.stall else {
        panic!("{:?}", outcome.stall)
    };
    assert_eq!((rank, task), (2, 6));
    assert!((direction[2] - 1.0).abs() < 1e-9);
}

/// An arm of the youBot's kind points only in the vertical plane of its first joint: joint 5 does
/// nothing for a pointing task, in no posture, so this is no singular pose.
#[test]
fn stall_of_a_five_joint_arm_is_not_called_singular() {
    let robot = catalogue::load("youbot").unwrap();
    let mut servo = servo(&robot, |o| o.task = Task::POINTING);
    let start = robot.state(robot.home()).unwrap().pose(robot.tool());
    let target = Pose { translation: start.translation + Vec3::new(0.0, 0.1, 0.0), ..start };
    let outcome = run(&mut servo, robot.home(), target);
    let Some(Stall::TooFewJoints { rank, task, .. }) = outcome.stall else {
        panic!("{:?}", outcome.stall)
    };
    assert_eq!((rank, task), (4, 5));
}
