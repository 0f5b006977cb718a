//! Why a servo stops.

use cylindroid::control::TwistStatus;

use super::plant::{Drives, PLANTS};
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

/// Whether a limit blocks a motion is a matter of directions: the joint is named however little the
/// target lies beyond it.
#[test]
fn stall_at_a_limit_names_the_joint_for_small_errors_too() {
    let robot = planar(2);
    for beyond in [1e-2, 1e-4, 1e-6] {
        let mut servo = servo(&robot, |o| {
            o.task = Task::POSITION;
            o.tolerance.position = 1e-3 * beyond;
        });
        let (a, b): (f64, f64) = (3.0 + beyond, 0.5);
        let at = Vec3::new(a.cos() + (a + b).cos(), a.sin() + (a + b).sin(), 0.0);
        let outcome = run_checked(&robot, &mut servo, &[2.9, 0.5], Pose::from_translation(at));
        assert!(!outcome.reached, "{beyond}");
        assert_eq!(outcome.stall, Some(Stall::Limits { coordinates: vec![0] }), "{beyond}");
    }
}

/// Folded, with the target in the hole of the workspace: no joint can start the motion, and none of
/// second order leads there.
#[test]
fn stall_in_a_singular_pose_names_the_direction() {
    let mut b = Mechanism::builder("2r");
    for (i, length) in [0.0, 1.0].into_iter().enumerate() {
        b.joint(JointSpec {
            parent_from_joint: Pose::from_translation(Vec3::X * length),
            ..JointSpec::new(
                &format!("q{i}"),
                JointKind::Revolute,
                &format!("l{i}"),
                &format!("l{}", i + 1),
            )
        });
    }
    b.frame("tip", "l2", Pose::from_translation(Vec3::X * 0.5)).tool("tip");
    let robot = b.build().unwrap();
    let mut servo = servo(&robot, |o| o.task = Task::POSITION);
    let start = [0.0, std::f64::consts::PI];
    let outcome = run(&mut servo, &start, Pose::from_translation(Vec3::new(0.3, 0.0, 0.0)));
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
    let start = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
    let up = Pose { translation: start.translation + Vec3::Z * 0.1, ..start };
    let outcome = run(&mut servo, &q, up);
    let Some(Stall::TooFewJoints { rank, task, direction }) = outcome.stall else {
        panic!("{:?}", outcome.stall)
    };
    assert_eq!((rank, task), (2, 6));
    assert!((direction[2] - 1.0).abs() < 1e-9);
}

/// An arm of the youBot's kind points only in the vertical plane of its first joint: joint 5 does
/// nothing for a pointing task, in no configuration, so this one is not singular.
#[test]
fn stall_of_a_five_joint_arm_is_not_called_singular() {
    let robot = catalogue::load("youbot").unwrap();
    let mut servo = servo(&robot, |o| o.task = Task::POINTING);
    let start = robot.state(robot.home()).unwrap().pose(robot.tool()).unwrap();
    let target = Pose { translation: start.translation + Vec3::new(0.0, 0.1, 0.0), ..start };
    let outcome = run(&mut servo, robot.home(), target);
    let Some(Stall::TooFewJoints { rank, task, .. }) = outcome.stall else {
        panic!("{:?}", outcome.stall)
    };
    assert_eq!((rank, task), (4, 5));
}

/// A weak inverse is slow, not singular: the home of the arm is a regular configuration.
#[test]
fn stall_of_a_weak_inverse_is_slow() {
    let robot = catalogue::load("panda").unwrap();
    let start = robot.state(robot.home()).unwrap().pose(robot.tool()).unwrap();
    let target = Pose { translation: start.translation + Vec3::new(0.05, 0.1, -0.1), ..start };
    for method in
        [Method::Damped { damping: 200.0 }, Method::SelectivelyDamped { max_joint_velocity: 1e-4 }]
    {
        let mut servo = servo(&robot, |o| o.method = method);
        let outcome = run(&mut servo, robot.home(), target);
        assert_eq!(outcome.stall, Some(Stall::Slow), "{}", method.name());
    }
}

/// Selectively damped least squares turn the tool first, and turn it away again while the position
/// comes on: the sum of both errors rises for seconds. No stall is named of which the error falls by a tenth
/// afterwards.
#[test]
fn stall_is_none_while_the_error_falls() {
    let method = Method::SelectivelyDamped { max_joint_velocity: std::f64::consts::FRAC_PI_4 };
    for (name, seeds) in [
        ("panda", [5005, 5011, 5013, 5008]),
        ("ur5e", [5005, 5010, 5012, 5020]),
        ("puma560", [5002, 5011, 5013, 5020]),
        ("youbot", [5004, 5010, 5015, 5016]),
        ("3r", [5012, 5014, 5017, 5003]),
    ] {
        let robot = catalogue::load(name).unwrap();
        for (seed, reach) in seeds.into_iter().flat_map(|seed| [(seed, 0.9), (seed, 1.05)]) {
            let mut random = Random(seed);
            let mut q = super::escape::within(&robot, &mut random);
            let pose = robot.state(&random.q(&robot)).unwrap().pose(robot.tool()).unwrap();
            let far = reach * robot.reach() / pose.translation.norm();
            let target = Pose { translation: pose.translation * far, ..pose };
            let mut servo = servo(&robot, |o| {
                (o.dt, o.method) = (4e-3, method);
                o.secondary = o.default_secondary(&robot).unwrap();
            });
            let length = servo.options().length;
            let (mut verdict, mut least) = (None, f64::INFINITY);
            for _ in 0..4000 {
                let step = servo.step(&q, target).unwrap();
                servo.advance(&mut q);
                let error = (step.position_error / length).hypot(step.orientation_error);
                least = least.min(error);
                if step.status == Status::Stalled && verdict.is_none() {
                    verdict = Some((error, servo.stall()));
                }
            }
            // Below a tenth of a millimetre self-motions hold it up; what is proved is true at once.
            let Some((error, stall)) = verdict.filter(|(error, _)| *error > 1e-4) else { continue };
            if matches!(stall, Stall::OutOfReach { .. }) {
                continue;
            }
            assert!(least > 0.9 * error, "{name} {seed} {reach}: {stall:?}, {error} to {least}");
        }
    }
}

/// Only what stands in the way is named: not a joint that stands at its limit and would leave it,
/// nor one whose two limits are equal.
#[test]
fn stall_names_only_the_joints_in_the_way() {
    let arm = |limits: [(f64, f64); 3]| {
        let mut b = Mechanism::builder("3r");
        for (i, (lower, upper)) in limits.into_iter().enumerate() {
            b.joint(JointSpec {
                parent_from_joint: Pose::from_translation(Vec3::X * f64::from(u8::from(i > 0))),
                limits: Limits { lower, upper, velocity: 2.0, ..Limits::NONE },
                ..JointSpec::new(
                    &format!("q{i}"),
                    JointKind::Revolute,
                    &format!("l{i}"),
                    &format!("l{}", i + 1),
                )
            });
        }
        b.frame("tip", "l3", Pose::from_translation(Vec3::X)).tool("tip");
        b.build().unwrap()
    };
    let tip = |q: [f64; 3]| {
        let mut p = Vec3::ZERO;
        let mut angle = 0.0;
        for q in q {
            angle += q;
            p += Vec3::new(angle.cos(), angle.sin(), 0.0);
        }
        Pose::from_translation(p)
    };
    // The first two joints cannot bend further; the third, locked, stands at both its limits.
    let robot = arm([(-0.5, 0.3), (-0.5, 0.2), (0.4, 0.4)]);
    let mut servo = servo(&robot, |o| o.task = Task::POSITION);
    let outcome = run_checked(&robot, &mut servo, &[0.1, 0.0, 0.4], tip([0.8, 0.6, 0.4]));
    assert_eq!(outcome.stall, Some(Stall::Limits { coordinates: vec![0, 1] }));
    assert!(outcome.limits_hit.iter().all(|(c, _)| *c != 2), "{:?}", outcome.limits_hit);
}

/// A locked joint is as none: what only it could do is not called slow, and no search frees it.
#[test]
fn stall_with_a_locked_joint() {
    let locks: [fn(&mut Limits); 3] =
        [|l| (l.lower, l.upper) = (0.9, 0.9), |l| l.velocity = 0.0, |l| l.acceleration = 0.0];
    for lock in locks {
        let mut b = Mechanism::builder("2r");
        for i in 0..2 {
            let mut limits = Limits { lower: -3.0, upper: 3.0, velocity: 2.0, ..Limits::NONE };
            if i == 1 {
                lock(&mut limits);
            }
            b.joint(JointSpec {
                parent_from_joint: Pose::from_translation(Vec3::X * f64::from(i)),
                limits,
                ..JointSpec::new(
                    &format!("q{i}"),
                    JointKind::Revolute,
                    &format!("l{i}"),
                    &format!("l{}", i + 1),
                )
            });
        }
        b.frame("tip", "l2", Pose::from_translation(Vec3::X)).tool("tip");
        let robot = b.build().unwrap();
        let mut servo = servo(&robot, |o| o.task = Task::POSITION);
        let q = [0.2, 0.9];
        let pose = |q: &[f64]| robot.state(q).unwrap().pose(robot.tool()).unwrap();
        // Round the first joint it goes.
        let outcome = run_checked(&robot, &mut servo, &q, pose(&[-0.8, 0.9]));
        assert!(outcome.reached, "{outcome:?}");
        // Nearer to it, it does not.
        let nearer = pose(&[0.2, 2.0]);
        let outcome = run_checked(&robot, &mut servo, &q, nearer);
        let Some(Stall::TooFewJoints { rank, task, .. }) = outcome.stall else {
            panic!("{:?}", outcome.stall)
        };
        assert_eq!((rank, task, outcome.q[1]), (1, 3, 0.9));
        assert_eq!(find_reachable_configuration(&servo, &q, nearer, 20).unwrap(), None);
        assert_eq!(
            find_reachable_configuration(&servo, &q, pose(&[-0.8, 0.9]), 20).unwrap().unwrap().q[1],
            0.9
        );
        assert!(matches!(
            find_reachable_configuration(&servo, &[0.2], nearer, 20),
            Err(Error::Dimension { .. })
        ));
    }
}

/// A slider that follows an endless joint in no measure stays at its offset: the chain has a length.
#[test]
fn stall_out_of_reach_with_a_follower_that_rests() {
    let mut b = Mechanism::builder("crane");
    b.joint(JointSpec::new("turn", JointKind::Continuous, "ground", "boom"));
    b.joint(JointSpec {
        axis: Vec3::X,
        mimic: Some(Mimic { joint: "turn".into(), multiplier: 0.0, offset: 0.5 }),
        ..JointSpec::new("slide", JointKind::Prismatic, "boom", "hook")
    });
    b.frame("tip", "hook", Pose::from_translation(Vec3::X)).tool("tip");
    let robot = b.build().unwrap();
    let mut servo = servo(&robot, |o| o.task = Task::POSITION);
    let outcome = run(&mut servo, &[0.3], Pose::from_translation(Vec3::X * 2.0));
    assert_eq!(outcome.stall, Some(Stall::OutOfReach { distance: 2.0, length: 1.5 }));
}

/// What a locked joint takes away for good is no singular pose: with its elbow locked straight the
/// arm turns its hand about one axis with two joints, in every configuration.
#[test]
fn stall_of_an_arm_locked_straight_is_not_called_singular() {
    let mut b = Mechanism::builder("straight");
    for (i, (lower, upper)) in [(-3.0, 3.0), (0.0, 0.0), (-3.0, 3.0)].into_iter().enumerate() {
        b.joint(JointSpec {
            // The middle joint bends; the others turn about the same line while it is straight.
            axis: if i == 1 { Vec3::X } else { Vec3::Z },
            limits: Limits { lower, upper, ..Limits::NONE },
            ..JointSpec::new(
                &format!("q{i}"),
                JointKind::Revolute,
                &format!("l{i}"),
                &format!("l{}", i + 1),
            )
        });
    }
    let robot = b.build().unwrap();
    let mut servo = servo(&robot, |o| o.task = Task::ORIENTATION);
    let target = Pose::from_rotation(Rotation::exp(Vec3::X * 0.5));
    let outcome = run(&mut servo, &[0.2, 0.0, 0.1], target);
    let Some(Stall::TooFewJoints { rank, task, .. }) = outcome.stall else {
        panic!("{:?}", outcome.stall)
    };
    assert_eq!((rank, task), (1, 3));
}

/// A lever that turns within 3 rad.
fn lever(foundation: Pose, length: f64) -> Mechanism {
    let mut builder = Mechanism::builder("lever");
    builder.joint(JointSpec {
        parent_from_joint: foundation,
        limits: Limits { lower: -3.0, upper: 3.0, velocity: 2.0, ..Limits::NONE },
        ..JointSpec::new("hinge", JointKind::Revolute, "base", "arm")
    });
    builder.frame("tip", "arm", Pose::from_translation(Vec3::X * length));
    builder.tool("tip");
    builder.build().unwrap()
}

/// A joint that is pushed against a limit is named, wherever rounding lets it rest: at both ends, at any
/// joint weight, on any foundation and at any size.
#[test]
fn stall_names_a_joint_that_rests_at_its_limit() {
    let mut random = Random(19);
    for (plant, dt) in PLANTS.into_iter().flat_map(|plant| [(plant, 0.004), (plant, 0.001)]) {
        for k in 0..36 {
            let (side, weight) = ([1.0, -1.0][k % 2], [1.0, 1e-6, 1e6][k / 2 % 3]);
            let length = [1.0, 1e-3, 1e3][k / 6 % 3];
            let foundation = if k < 18 { Pose::IDENTITY } else { random.pose() };
            let robot = lever(foundation, length);
            let mut options = ServoOptions::new(&robot);
            (options.dt, options.plant, options.task) = (dt, plant, Task::POSITION);
            options.joint_weights = vec![weight];
            let mut servo = Servo::new(&robot, options).unwrap();
            let mut drives = Drives::new(&[side * (2.5 + random.within(-0.01, 0.01))], plant);
            let mut last = TwistStatus::AtRest;
            for _ in 0..(4.0 / dt) as usize {
                let (sine, cosine) = drives.q[0].sin_cos();
                let along = Vec3::new(-sine, cosine, 0.0) * (0.2 * side * length);
                let twist = Twist { linear: foundation.rotation * along, angular: Vec3::ZERO };
                last = servo.step_twist(&drives.q, Some(twist)).unwrap().status;
                drives.pass(&robot, servo.joint_velocities(), dt);
            }
            let at = format!("{plant:?}, {dt}, {k}: {}", 3.0 * side - drives.q[0]);
            assert_eq!(last, TwistStatus::Stalled, "{at}");
            assert_eq!(servo.stall(), Stall::Limits { coordinates: vec![0] }, "{at}");
        }
    }
}

/// A slide near its limit is at it by the same share of the arm's length in every unit of length.
#[test]
fn stall_at_a_slide_depends_on_no_unit() {
    let verdict = |size: f64, gap: f64| {
        let mut builder = Mechanism::builder("slide");
        let (lower, upper, acceleration) = (-0.5 * size, 0.2 * size, 20.0 * size);
        let slide = Limits { lower, upper, acceleration, ..Limits::NONE };
        for (name, kind, parent, x, limits) in [
            ("pan", JointKind::Revolute, "base", 0.0, Limits::NONE),
            ("slide", JointKind::Prismatic, "pan_link", 0.4, slide),
        ] {
            builder.joint(JointSpec {
                axis: if name == "pan" { Vec3::Z } else { Vec3::X },
                parent_from_joint: Pose::from_translation(Vec3::X * (x * size)),
                limits,
                ..JointSpec::new(name, kind, parent, &format!("{name}_link"))
            });
        }
        builder.frame("tool", "slide_link", Pose::from_translation(Vec3::X * (0.3 * size)));
        builder.tool("tool");
        let robot = builder.build().unwrap();
        let mut servo = servo(&robot, |o| {
            o.task = Task::named("x,y", &robot).unwrap();
            (o.dt, o.joint_weights) = (1e-5, vec![1.0, 1.0 / (size * size)]);
        });
        let q = [0.3, (0.2 - gap) * size];
        let target = Vec3::new(0.3_f64.cos(), 0.3_f64.sin(), 0.0) * (1.1 * size);
        servo.step(&q, Pose::from_translation(target)).unwrap();
        servo.stall()
    };
    for size in [1e-3, 1.0, 1e3] {
        assert_eq!(verdict(size, 1e-8), Stall::Limits { coordinates: vec![1] }, "{size}");
        assert_eq!(verdict(size, 5e-4), Stall::Slow, "{size}");
    }
}

/// Of joints at their limits those are in the way that would realise a thousandth of the remaining error or
/// more, at every weight of the joints and for errors of every size.
#[test]
fn stall_names_joints_by_their_share_of_the_error() {
    let mut builder = Mechanism::builder("gantry");
    for (name, axis, parent) in [("x", Vec3::X, "base"), ("y", Vec3::Y, "x_link")] {
        builder.joint(JointSpec {
            axis,
            limits: Limits { lower: -1.0, upper: 0.0, ..Limits::NONE },
            ..JointSpec::new(name, JointKind::Prismatic, parent, &format!("{name}_link"))
        });
    }
    builder.frame("tool", "y_link", Pose::from_translation(Vec3::X)).tool("tool");
    let robot = builder.build().unwrap();
    for weight in [1e-6, 1.0, 1e6] {
        let mut servo = servo(&robot, |o| {
            o.task = Task::named("x,y", &robot).unwrap();
            o.joint_weights = vec![weight; 2];
        });
        for beyond in [1e-6, 1e-3, 1.0] {
            for (share, named) in [(5e-3, vec![0, 1]), (2e-4, vec![0])] {
                servo.reset();
                let target = Vec3::new(1.0 + beyond, share * beyond, 0.0);
                servo.step(&[0.0, 0.0], Pose::from_translation(target)).unwrap();
                let expected = Stall::Limits { coordinates: named };
                assert_eq!(servo.stall(), expected, "{weight} {beyond} {share}");
            }
        }
    }
}

/// A Panda beside a pose that it does not reach: it swung about the nearest one with 2 rad/s for ever.
#[test]
fn a_swing_about_the_nearest_pose_dies_out() {
    let panda = catalogue::load("panda").unwrap();
    let mut q = vec![1.0451, -0.4457, -1.0394, -1.3155, 0.6218, 1.2399, -0.3026];
    let rotation = panda.state(&q).unwrap().pose(panda.tool()).unwrap().rotation;
    let target = Pose { rotation, translation: Vec3::new(0.53, 0.0045, 0.8003) };
    let mut servo = servo(&panda, |o| o.dt = 2e-3);
    for i in 0..10_000 {
        let step = servo.step(&q, target).unwrap();
        servo.advance(&mut q);
        let fastest = servo.joint_velocities().iter().fold(0.0, |m: f64, rate| m.max(rate.abs()));
        assert!(
            i < 9000 || step.status == Status::Stalled && fastest < 0.2,
            "{i}: {fastest} rad/s"
        );
    }
}
