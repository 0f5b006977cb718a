//! The loop: convergence, feed-forward, any number of joints, bad input.

use super::*;

#[test]
fn reaches_a_pose_with_every_inverse() {
    for name in ["panda", "ur5e", "iiwa14", "puma560"] {
        let robot = catalogue::load(name).unwrap();
        let start = robot.state(robot.home()).unwrap().pose(robot.tool()).unwrap();
        let target = Pose {
            rotation: Rpy { roll: 0.1, pitch: -0.15, yaw: 0.2 }.rotation() * start.rotation,
            translation: start.translation + Vec3::new(-0.05, 0.08, -0.06),
        };
        for method in Method::ALL {
            let mut servo = servo(&robot, |o| o.method = method);
            let outcome = run_checked(&robot, &mut servo, robot.home(), target);
            assert!(outcome.reached, "{name} {}: {outcome:?}", method.name());
            let end = robot.state(&outcome.q).unwrap().pose(robot.tool()).unwrap();
            assert!((end.translation - target.translation).norm() <= 1e-6);
            assert!(end.rotation.angle_to(target.rotation) <= 1e-6);
        }
    }
}

/// In a regular pose the error contracts by (1 - p dt) a step.
#[test]
fn the_error_contracts_as_the_theory_says() {
    let robot = catalogue::load("panda").unwrap();
    let start = robot.state(robot.home()).unwrap().pose(robot.tool()).unwrap();
    let target = Pose { translation: start.translation + Vec3::new(1e-5, -2e-5, 1e-5), ..start };
    let mut servo = servo(&robot, |o| {
        o.dt = 1e-2;
        o.gain = ServoGains { position: 20.0, orientation: 20.0 };
        o.tolerance = PoseTolerance { position: 1e-12, orientation: 1e-12 };
    });
    let mut q = robot.home().to_vec();
    let mut last = None;
    for _ in 0..10 {
        let step = servo.step(&q, target).unwrap();
        if let Some(last) = last {
            let ratio: f64 = step.position_error / last;
            assert!((ratio - 0.8).abs() < 1e-3, "contracts by {ratio}");
        }
        last = Some(step.position_error);
        servo.advance(&mut q);
    }
}

#[test]
fn gain_times_dt_of_two_is_refused_with_both_numbers() {
    let robot = catalogue::load("panda").unwrap();
    let mut options = ServoOptions::new(&robot);
    options.dt = 0.1;
    options.gain.position = 20.0;
    let error = Servo::new(&robot, options.clone()).unwrap_err().to_string();
    assert!(error.contains("20") && error.contains("0.1") && error.contains("below 2"), "{error}");
    options.gain.position = 19.9;
    assert!(Servo::new(&robot, options).is_ok());
}

/// Moves right through the wrist singularity of a UR arm, in both directions of joint 5.
#[test]
fn goes_through_the_wrist_singularity() {
    let robot = catalogue::load("ur5e").unwrap();
    let (mut from, mut to) = (robot.home().to_vec(), robot.home().to_vec());
    (from[4], to[4]) = (-0.3, 0.3);
    let target = robot.state(&to).unwrap().pose(robot.tool()).unwrap();
    for method in [Method::Damped { damping: 0.05 }, Method::ALL[2], Method::ALL[3]] {
        let mut servo = servo(&robot, |o| o.method = method);
        let outcome = run_checked(&robot, &mut servo, &from, target);
        assert!(outcome.reached, "{}: {outcome:?}", method.name());
    }
}

/// One to seven joints and thirty: the same code, position reached where it can be.
#[test]
fn any_number_of_joints() {
    for n in [2, 3, 4, 5, 6, 7, 30] {
        let robot = planar(n);
        let q: Vec<f64> = (0..n).map(|i| 0.3 - 0.05 * i as f64).collect();
        let goal: Vec<f64> = q.iter().map(|x| x + 0.1).collect();
        let mut servo = servo(&robot, |o| o.task = Task::POSITION);
        let target = robot.state(&goal).unwrap().pose(robot.tool()).unwrap();
        let outcome = run_checked(&robot, &mut servo, &q, target);
        assert!(outcome.reached, "{n} joints: {outcome:?}");
    }
    // One joint: along its own circle.
    let robot = planar(1);
    let mut one = servo(&robot, |_| {});
    let target = robot.state(&[1.2]).unwrap().pose(robot.tool()).unwrap();
    assert!(run_checked(&robot, &mut one, &[0.1], target).reached);
    let mut nothing = ServoOptions::new(&robot);
    nothing.end_effector = robot.frame("link0").unwrap().into();
    assert!(Servo::new(&robot, nothing).unwrap_err().to_string().contains("no joint moves"));
}

/// A target that moves: with its twist as feed-forward the lag vanishes.
#[test]
fn feed_forward_removes_the_lag() {
    let robot = catalogue::load("panda").unwrap();
    let start = robot.state(robot.home()).unwrap().pose(robot.tool()).unwrap();
    let velocity = Vec3::new(0.0, 0.1, -0.05);
    let lag = |feed_forward: bool| {
        let mut servo = servo(&robot, |_| {});
        let outcome = simulate(
            &mut servo,
            robot.home(),
            1.0,
            |t| {
                let pose = Pose { translation: start.translation + velocity * t, ..start };
                let twist = Twist { linear: velocity, angular: Vec3::ZERO };
                let feed_forward = if feed_forward { twist } else { Twist::ZERO };
                (Target { pose, feed_forward }, false)
            },
            |_| {},
        );
        outcome.unwrap().last.position_error
    };
    assert!(lag(true) < 1e-4, "{}", lag(true));
    assert!(lag(false) > 1e-2);
}

#[test]
fn bad_input_is_refused_and_leaves_the_servo() {
    let robot = catalogue::load("panda").unwrap();
    let mut servo = servo(&robot, |_| {});
    let pose = robot.state(robot.home()).unwrap().pose(robot.tool()).unwrap();
    let target = Pose { translation: pose.translation + Vec3::X * 0.01, ..pose };
    servo.step(robot.home(), target).unwrap();
    let rates = servo.joint_velocities().to_vec();
    let mut q = robot.home().to_vec();
    q[2] = f64::INFINITY;
    assert!(matches!(servo.step(&q, target), Err(Error::NotFinite { .. })));
    assert!(matches!(servo.step(&q[..6], target), Err(Error::Dimension { .. })));
    let nan = Pose { translation: Vec3::new(0.0, f64::NAN, 0.0), ..pose };
    let error = servo.step(robot.home(), nan).unwrap_err().to_string();
    assert!(error.contains("target position[1]"), "{error}");
    assert_eq!(servo.joint_velocities(), rates);
    for (change, word) in [
        ((|o| o.dt = 0.0) as fn(&mut ServoOptions), "dt"),
        (|o| o.length = f64::NAN, "length"),
        (|o| o.speed.linear = -1.0, "linear speed"),
        (|o| o.task.components = [false; 6], "task"),
        (|o| o.joint_weights = vec![1.0; 3], "joint weights"),
        (|o| o.method = Method::Damped { damping: -1.0 }, "damping"),
        (|o| o.secondary = vec![SecondaryTask::Posture { q: vec![0.0], gain: 1.0 }], "posture"),
        (|o| o.tolerance.position = 0.0, "position tolerance"),
    ] {
        let mut options = ServoOptions::new(&robot);
        change(&mut options);
        let error = Servo::new(&robot, options).unwrap_err().to_string();
        assert!(error.contains(word), "{error}");
    }
}

#[test]
fn status_is_reached_at_the_target() {
    let robot = catalogue::load("panda").unwrap();
    let mut servo = servo(&robot, |_| {});
    let pose = robot.state(robot.home()).unwrap().pose(robot.tool()).unwrap();
    let step = servo.step(robot.home(), pose).unwrap();
    assert_eq!(step.status, Status::Reached);
    assert!(servo.joint_velocities().iter().all(|r| r.abs() < 1e-12));
}

/// A duration that is NaN ends the motion, it does not make it endless.
#[test]
fn a_duration_of_nan_ends() {
    let robot = planar(2);
    let mut servo = servo(&robot, |o| o.task = Task::POSITION);
    let target = Target::from(Pose::from_translation(Vec3::Y));
    let outcome = simulate(&mut servo, &[0.1, 0.2], f64::NAN, |_| (target, false), |_| {}).unwrap();
    assert_eq!((outcome.steps, outcome.reached, outcome.stall), (0, false, None));
}

/// What overflows or is not of this robot is an error, not full speed.
#[test]
fn overflow_and_foreign_options_are_refused() {
    let robot = catalogue::load("panda").unwrap();
    let pose = robot.state(robot.home()).unwrap().pose(robot.tool()).unwrap();
    let mut servo = servo(&robot, |_| {});
    servo.step(robot.home(), pose * Pose::from_translation(Vec3::X * 0.01)).unwrap();
    let rates = servo.joint_velocities().to_vec();
    let far = Pose { translation: Vec3::X * 1e308, ..pose };
    assert!(matches!(servo.step(robot.home(), far), Err(Error::OutOfRange { .. })));
    let mut overtaken = Target::from(pose);
    overtaken.feed_forward.linear = Vec3::new(f64::MAX, f64::MAX, f64::MAX);
    assert!(matches!(servo.step(robot.home(), overtaken), Err(Error::OutOfRange { .. })));
    assert_eq!(servo.joint_velocities(), rates);

    let mut options = ServoOptions::new(&robot);
    options.end_effector.frame_from_tool.translation.y = f64::NAN;
    assert!(matches!(Servo::new(&robot, options), Err(Error::NotFinite { .. })));
    // A frame beyond those of the robot, and one whose number the robot has too.
    for name in ["3r", "youbot"] {
        let other = catalogue::load(name).unwrap();
        for (of, foreign) in [(&robot, other.tool()), (&other, robot.tool())] {
            let mut options = ServoOptions::new(of);
            options.end_effector = foreign.into();
            let error = Servo::new(of, options).unwrap_err().to_string();
            assert!(error.contains("another mechanism") && error.contains(of.name()), "{error}");
        }
    }
    // The same robot, loaded twice, has the same frames.
    let again = catalogue::load("panda").unwrap();
    assert!(again.check_frame(robot.tool()).is_ok());

    let bounds = VelocityBounds::next(
        &robot.coordinates()[0].limits,
        JointState { position: 0.0, velocity: 0.0, acceleration: 0.0 },
        1e-3,
    );
    assert!(bounds.clamp(f64::NAN).is_nan());
    assert_eq!(bounds.clamp(f64::INFINITY), bounds.upper);
}

/// Joints that can hardly brake slow down in time: they arrive, at rest, without swinging past.
#[test]
fn weak_joints_arrive() {
    let robot = planar(1);
    let target = robot.state(&[1.0]).unwrap().pose(robot.tool()).unwrap();
    for acceleration in [10.0, 1.0, 0.5, 1e-3] {
        for method in [Method::default(), Method::ALL[1], Method::ALL[4]] {
            let mut servo = servo(&robot, |o| {
                o.acceleration = Some(acceleration);
                o.method = method;
            });
            let mut most = 0.0_f64;
            let outcome = simulate(
                &mut servo,
                &[0.0],
                300.0,
                |_| (target.into(), true),
                |sample| most = most.max(sample.q[0]),
            )
            .unwrap();
            let name = method.name();
            assert!(outcome.reached, "{acceleration}, {name}: {outcome:?}");
            assert!(
                servo.joint_velocities()[0].abs() <= 5e-6 * (1.0 + 1e-9),
                "{:?}",
                servo.joint_velocities()
            );
            assert!(most <= 1.0 + 1e-6, "{acceleration}, {name}: swings to {most}");
        }
    }
    // Seven joints, each weak: the way is not straight in joint space.
    let robot = catalogue::load("panda").unwrap();
    let start = robot.state(robot.home()).unwrap().pose(robot.tool()).unwrap();
    let target = Pose { translation: start.translation + Vec3::new(-0.1, 0.2, -0.1), ..start };
    for acceleration in [10.0, 1.0, 0.5] {
        let mut servo = servo(&robot, |o| o.acceleration = Some(acceleration));
        let outcome = run_checked(&robot, &mut servo, robot.home(), target);
        assert!(outcome.reached, "{acceleration}: {outcome:?}");
    }
}

/// Passing through the target at speed is not reaching it.
#[test]
fn reached_means_at_rest() {
    let robot = planar(1);
    let target = robot.state(&[1.0]).unwrap().pose(robot.tool()).unwrap();
    let mut servo = servo(&robot, |o| o.acceleration = Some(1.0));
    // Up to speed towards a target farther on, which is then exchanged for the place passed.
    let far = robot.state(&[3.0]).unwrap().pose(robot.tool()).unwrap();
    let mut q = vec![0.0];
    while q[0] < 1.0 {
        servo.step(&q, far).unwrap();
        servo.advance(&mut q);
    }
    assert!(servo.joint_velocities()[0] > 0.5);
    assert_eq!(servo.step(&[1.0], target).unwrap().status, Status::Moving);
    let outcome = simulate(&mut servo, &q, 30.0, |_| (target.into(), true), |_| {}).unwrap();
    assert!(outcome.reached && (outcome.q[0] - 1.0).abs() <= 1e-6, "{outcome:?}");
}
