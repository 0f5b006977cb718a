//! Configurations in which the linearised task is lost, or joints at limits block it, and a finite
//! motion is not.

use super::*;

/// The target leaves reach and comes back within 8 s: 0.99 m out along `direction`, and back.
pub(super) fn out_and_back(
    servo: &mut Servo,
    q: &mut [f64],
    pose: Pose,
    direction: Vec3,
    mut after_step: impl FnMut(&Servo),
) -> (bool, Stall) {
    let dt = servo.options().dt;
    let mut step = None;
    for i in 0..(16.0 / dt) as usize {
        let time = i as f64 * dt;
        let way = 0.99 * (1.0 - (std::f64::consts::TAU * time.min(8.0) / 8.0).cos()) / 2.0;
        let target = Pose { translation: pose.translation + direction * way, ..pose };
        let now = servo.step(q, target).unwrap();
        servo.advance(q);
        after_step(servo);
        step = Some(now);
        if time > 8.1 && now.status != Status::Moving {
            break;
        }
    }
    let step = step.unwrap();
    (step.position_error < 1e-3 && step.orientation_error < 1e-2, servo.stall())
}

/// A random configuration with a tenth of the range to every limit.
pub(super) fn within(robot: &Mechanism, random: &mut Random) -> Vec<f64> {
    let mut q = random.q(robot);
    for (q, c) in q.iter_mut().zip(robot.coordinates()) {
        let centre = 0.5 * (c.limits.lower + c.limits.upper);
        *q = centre + 0.8 * (*q - centre);
    }
    q
}

/// From random starts (none of them at a limit), along every axis; at least this many of ten return,
/// none of those that stay away is singular, and for each of them another configuration is found.
fn returns(name: &str, least: usize) {
    let robot = catalogue::load(name).unwrap();
    let mut options = ServoOptions { dt: 4e-3, ..ServoOptions::new(&robot) };
    options.secondary = options.default_secondary(&robot).unwrap();
    let mut random = Random(191);
    let (mut returned, mut runs) = (0, 0);
    let mut causes = std::collections::BTreeMap::new();
    for _ in 0..10 {
        let start = within(&robot, &mut random);
        let pose = robot.state(&start).unwrap().pose(robot.tool()).unwrap();
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            for direction in [axis, -axis] {
                let mut servo = Servo::new(&robot, options.clone()).unwrap();
                let mut q = start.clone();
                let (is_back, stall) = out_and_back(&mut servo, &mut q, pose, direction, |_| ());
                runs += 1;
                returned += usize::from(is_back);
                if !is_back {
                    *causes.entry(stall.name()).or_insert(0) += 1;
                    let found = find_reachable_configuration(&servo, &q, pose, 200).unwrap();
                    let found = found.unwrap_or_else(|| panic!("{name} {q:?}: none found"));
                    let there = robot.state(&found.q).unwrap().pose(robot.tool()).unwrap();
                    let left = there.error_to(pose);
                    assert!(left.linear.norm() < 1e-6 && left.angular.norm() < 1e-6);
                    assert_eq!(robot.outside_limits(&found.q).count(), 0);
                    assert!(!matches!(stall, Stall::Singular { .. }), "{name} {q:?}: {stall:?}");
                }
            }
        }
    }
    println!("{name}: {returned} of {runs} returned; stalled: {causes:?}");
    assert!(10 * returned >= least * runs, "{name}: {returned} of {runs}");
}

#[test]
fn out_and_back_panda() {
    returns("panda", 8);
}

#[test]
fn out_and_back_ur5e() {
    returns("ur5e", 10);
}

#[test]
fn out_and_back_iiwa14() {
    returns("iiwa14", 9);
}

#[test]
fn out_and_back_puma560() {
    returns("puma560", 9);
}

#[test]
fn out_and_back_youbot() {
    returns("youbot", 10);
}

/// Arms that came back to the side with little room rattled where it ceased to be little, 0.3 to 13 cm
/// away; they fold to the other side and arrive.
#[test]
fn an_arm_that_folds_goes_on() {
    for (name, seed, direction, dt) in [
        ("puma560", 1117, Vec3::X, 4e-3),
        ("youbot", 1095, Vec3::Z, 4e-3),
        ("panda", 1002, Vec3::Z, 2e-3),
    ] {
        let robot = catalogue::load(name).unwrap();
        let mut options = ServoOptions { dt, ..ServoOptions::new(&robot) };
        options.secondary = options.default_secondary(&robot).unwrap();
        let mut q = within(&robot, &mut Random(seed));
        let pose = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
        let mut servo = Servo::new(&robot, options).unwrap();
        let (is_back, stall) = out_and_back(&mut servo, &mut q, pose, direction, |_| ());
        assert!(is_back, "{name}: {stall:?}");
    }
}

/// An elbow that is exactly straight, or folded, has no first-order motion towards the shoulder, and
/// two equal ones of second order.
#[test]
fn a_straight_elbow_opens() {
    let robot = planar(2);
    let target = Pose::from_translation(Vec3::new(1.5, 0.0, 0.0));
    for method in Method::ALL {
        let mut servo = servo(&robot, |o| (o.task, o.method) = (Task::POSITION, method));
        let outcome = run_checked(&robot, &mut servo, &[0.0, 0.0], target);
        assert!(outcome.reached, "{}: {outcome:?}", method.name());
        // Selectively damped least squares promises the slowest joints, and escapes as slowly.
        let most = if matches!(method, Method::SelectivelyDamped { .. }) { 12.0 } else { 10.0 };
        assert!(outcome.time < most, "{}: {outcome:?}", method.name());
    }
}

/// Two links of this length (m), the elbow within limits.
fn arm(link: f64, lower: f64, upper: f64) -> Mechanism {
    let mut b = Mechanism::builder("2r");
    for (i, (lower, upper)) in [(-3.0, 3.0), (lower, upper)].into_iter().enumerate() {
        b.joint(JointSpec {
            parent_from_joint: Pose::from_translation(Vec3::X * link * i as f64),
            limits: Limits { lower, upper, velocity: 2.0, ..Limits::NONE },
            ..JointSpec::new(
                &format!("q{i}"),
                JointKind::Revolute,
                &format!("l{i}"),
                &format!("l{}", i + 1),
            )
        });
    }
    b.frame("tip", "l2", Pose::from_translation(Vec3::X * link)).tool("tip");
    b.build().unwrap()
}

/// Of two equal motions, the elbow takes the one with more room to its limits.
#[test]
fn the_elbow_opens_where_its_limits_leave_room() {
    let target = Pose::from_translation(Vec3::new(1.5, 0.0, 0.0));
    for (lower, upper) in [(-2.5, 0.5), (-0.5, 2.5), (0.0, 2.5), (-2.5, 0.0)] {
        let robot = arm(1.0, lower, upper);
        let mut servo = servo(&robot, |o| o.task = Task::POSITION);
        let outcome = run_checked(&robot, &mut servo, &[0.0, 0.0], target);
        assert!(outcome.reached, "{lower} {upper}: {outcome:?}");
        assert_eq!(outcome.q[1] > 0.0, upper > -lower);
    }
    // With room on neither side it stalls at its limits.
    let robot = arm(1.0, -0.1, 0.1);
    let mut servo = servo(&robot, |o| o.task = Task::POSITION);
    let outcome = run_checked(&robot, &mut servo, &[0.0, 0.0], target);
    assert_eq!(outcome.stall, Some(Stall::Limits { coordinates: vec![1] }), "{outcome:?}");
}

/// An arm that stands just beyond straight, on the side where a limit is near, folds to the other one
/// when its target comes back inside: whatever its size, its direction and its hand.
#[test]
fn a_stretched_arm_folds_to_the_side_with_room() {
    for (link, turn, hand) in [(1.0, 0.0, 1.0), (0.2, 2.0, 1.0), (5.0, -1.0, -1.0)] {
        let robot = if hand > 0.0 { arm(link, -2.5, 0.3) } else { arm(link, -0.3, 2.5) };
        let way = Rotation::exp(Vec3::Z * turn) * Vec3::new(1.5, 0.2 * hand, 0.0);
        let target = Pose::from_translation(way * link);
        for method in Method::ALL {
            for start in [1e-4, 1e-3, 5e-3, 0.01].map(|x| hand * x) {
                let mut servo = servo(&robot, |o| (o.task, o.method) = (Task::POSITION, method));
                let q = [turn - start / 2.0, start];
                let outcome = run_checked(&robot, &mut servo, &q, target);
                assert!(outcome.reached, "{link} {} from {start}: {outcome:?}", method.name());
                assert!(outcome.q[1] * hand < 0.0);
            }
        }
    }
}

/// A twist out of a straight configuration is followed as well.
#[test]
fn a_twist_opens_the_elbow() {
    let robot = planar(2);
    for acceleration in [f64::INFINITY, 20.0] {
        let mut servo =
            servo(&robot, |o| (o.task, o.acceleration) = (Task::POSITION, Some(acceleration)));
        let mut q = vec![0.0, 0.0];
        let back = Twist { linear: Vec3::X * -0.2, angular: Vec3::ZERO };
        for _ in 0..3000 {
            servo.step_twist(&q, Some(back)).unwrap();
            servo.advance(&mut q);
        }
        let x = robot.state(&q).unwrap().pose(robot.tool()).unwrap().translation.x;
        assert!((1.35..1.6).contains(&x), "{acceleration}: {x} at {q:?}");
    }
}
