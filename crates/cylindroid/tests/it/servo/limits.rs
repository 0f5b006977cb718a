//! Limits, saturation and singular poses: what rates may be.

use super::*;

/// Into the limit with full acceleration limits: never left, and the twist keeps its direction
/// while it is only scaled.
#[test]
fn limits_scale_before_they_bend() {
    let robot = planar(2);
    let mut servo = servo(&robot, |o| {
        o.task = Task::POSITION;
        o.acceleration = Some(f64::INFINITY); // the first step is compared
        o.gain = ServoGains { position: 200.0, orientation: 1.0 };
    });
    let q = [0.4, 0.9];
    let state = robot.state(&q).unwrap();
    let start = state.pose(robot.tool()).unwrap();
    let target = Pose { translation: start.translation + Vec3::new(-0.3, 0.2, 0.0), ..start };
    let step = servo.step(&q, target).unwrap();
    assert!(step.saturation.scale < 1.0 && !step.saturation.direction_lost);
    let v = state
        .jacobian(robot.tool(), ReferenceFrame::LocalWorldAligned)
        .unwrap()
        .mul_vec(servo.joint_velocities());
    let cross = v[0] * 0.2 - v[1] * -0.3;
    assert!(cross.abs() < 1e-12 * v[0].hypot(v[1]), "direction lost: {v:?}");
    let largest = servo.joint_velocities().iter().fold(0.0_f64, |m, r| m.max(r.abs()));
    assert!((largest - 2.0).abs() < 1e-12, "the fastest joint goes at its limit: {largest}");
    assert!(servo.active_limits().any(|(_, kind)| kind == LimitKind::Velocity));
}

/// A redundant arm with a blocked joint does the task with the others, unscaled.
#[test]
fn saturation_uses_the_other_joints() {
    let mut b = Mechanism::builder("4r");
    for i in 0..4 {
        b.joint(JointSpec {
            parent_from_joint: Pose::from_translation(Vec3::X * f64::from(u8::from(i > 0))),
            limits: Limits { velocity: if i == 0 { 1e-3 } else { 3.0 }, ..Limits::NONE },
            ..JointSpec::new(
                &format!("q{i}"),
                JointKind::Revolute,
                &format!("l{i}"),
                &format!("l{}", i + 1),
            )
        });
    }
    b.frame("tip", "l4", Pose::from_translation(Vec3::X)).tool("tip");
    let robot = b.build().unwrap();
    let mut servo = servo(&robot, |o| {
        o.task = Task::POSITION;
        o.acceleration = Some(f64::INFINITY); // the first step is compared
        o.gain = ServoGains { position: 1.0, orientation: 1.0 };
    });
    let q = [0.3, 0.8, -0.5, 0.9];
    let state = robot.state(&q).unwrap();
    let start = state.pose(robot.tool()).unwrap();
    let way = Vec3::new(-0.2, 0.3, 0.0);
    let step = servo.step(&q, Pose { translation: start.translation + way, ..start }).unwrap();
    assert_eq!((step.saturation.scale, step.saturation.direction_lost), (1.0, false));
    let v = state
        .jacobian(robot.tool(), ReferenceFrame::LocalWorldAligned)
        .unwrap()
        .mul_vec(servo.joint_velocities());
    assert!((v[0] - way.x).abs() < 1e-12 && (v[1] - way.y).abs() < 1e-12, "{v:?}");
    assert!(servo.joint_velocities()[0].abs() <= 1e-3);
}

#[test]
fn speed_is_saturated_as_a_whole() {
    let robot = catalogue::load("ur5e").unwrap();
    let state = robot.state(robot.home()).unwrap();
    let start = state.pose(robot.tool()).unwrap();
    let target = Pose {
        translation: start.translation + Vec3::new(-0.1, 0.2, 0.1),
        rotation: Rotation::exp(Vec3::new(0.2, 0.1, 0.0)) * start.rotation,
    };
    let mut servo = servo(&robot, |o| o.speed = SpeedLimit { linear: 0.05, angular: 0.1 });
    servo.step(robot.home(), target).unwrap();
    let twist = state
        .twist(servo.joint_velocities(), robot.tool(), ReferenceFrame::LocalWorldAligned)
        .unwrap();
    assert!(
        twist.linear.norm() <= 0.05 * (1.0 + 1e-9) && twist.angular.norm() <= 0.1 * (1.0 + 1e-9)
    );
    let ratio = twist.linear.norm() / twist.angular.norm();
    let expected = Vec3::new(-0.1, 0.2, 0.1).norm() / Vec3::new(0.2, 0.1, 0.0).norm();
    assert!((ratio - expected).abs() < 1e-6 * expected);
}

/// Whatever the options and the limits (equal ends, velocity or acceleration 0, a screw, a follower):
/// slow and fast loops, weak and strong joints, weights, targets anywhere.
#[test]
fn limits_hold_for_any_options() {
    let mut random = Random(81);
    let mut robots: Vec<Mechanism> = crate::support::robots();
    robots.push(odd_arm());
    for round in 0..1000 {
        let robot = &robots[round % robots.len()];
        let mut power = |lower: f64, upper: f64| 10_f64.powf(random.within(lower, upper));
        let dt = power(-4.0, -1.3);
        let (gain, acceleration, max_joint_velocity) =
            (power(-1.0, 0.28) / dt, power(-2.0, 4.0), power(-2.0, 1.0));
        let weights: Vec<f64> = (0..robot.n()).map(|_| power(-3.0, 3.0)).collect();
        let mut servo = servo(robot, |o| {
            o.dt = dt;
            o.gain = ServoGains { position: gain, orientation: gain };
            o.acceleration = Some(acceleration);
            o.method = Method::ALL[round % Method::ALL.len()];
            if let Method::SelectivelyDamped { max_joint_velocity: rate } = &mut o.method {
                *rate = max_joint_velocity;
            }
            if round % 2 == 0 {
                o.joint_weights = weights;
            }
            if round % 3 == 0 {
                let fast = |task: SecondaryTask| task.with("gain", 5.0).unwrap();
                o.secondary = SecondaryTask::all(robot.home()).map(fast).to_vec();
            }
            if round % 5 == 0 {
                o.task = Task::POSITION;
            }
        });
        // At a limit every other time.
        let mut q = random.q(robot);
        let upper = robot.coordinates()[round % robot.n()].limits.upper;
        if round % 2 == 0 && upper.is_finite() {
            q[round % robot.n()] = upper;
        }
        let mut target = random.pose();
        if round % 7 == 0 {
            target.translation = random.vec3(1e6);
        }
        run_checked_for(400.0 * dt, robot, &mut servo, &q, target);
    }
}

/// At and through singular poses rates stay within the bound that each inverse promises, with no
/// limit of any joint to help: a gain times the task twist.
#[test]
fn singular_poses_keep_rates_bounded() {
    let panda = catalogue::load("panda").unwrap();
    let mut stretched = panda.home().to_vec();
    stretched[3] = panda.coordinates()[3].limits.upper; // as straight as the elbow goes
    let mut wrist = panda.home().to_vec();
    wrist[5] = 0.0;
    let panda = unlimited(&panda);
    let ur5e = unlimited(&catalogue::load("ur5e").unwrap());
    let cases: Vec<(&Mechanism, Vec<f64>)> = vec![
        (&panda, stretched),
        (&panda, wrist),
        (&ur5e, vec![0.0, -1.2, 0.0, -0.4, 1.2, 0.3]), // elbow stretched
        (&ur5e, vec![0.3, -1.2, 1.4, -0.4, 0.0, 0.3]), // wrist aligned
        (&ur5e, vec![0.0; 6]),                         // both
    ];
    let mut fastest = [0.0_f64; Method::ALL.len()];
    for (robot, q) in cases {
        let start = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
        for (k, method) in Method::ALL.into_iter().enumerate() {
            for direction in [Vec3::X, Vec3::Y, Vec3::Z] {
                for sign in [1.0, -1.0] {
                    let target = Pose {
                        translation: start.translation + direction * (0.1 * sign),
                        rotation: Rotation::exp(direction * (0.3 * sign)) * start.rotation,
                    };
                    let mut servo = servo(robot, |o| {
                        (o.method, o.acceleration) = (method, Some(f64::INFINITY));
                    });
                    let (gain, length) = (servo.options().gain, servo.options().length);
                    let check = |sample: cylindroid::control::TrajectorySample<'_>| {
                        let size =
                            sample.joint_velocities.iter().map(|r| r * r).sum::<f64>().sqrt();
                        let twist = (sample.step.position_error * gain.position / length)
                            .hypot(sample.step.orientation_error * gain.orientation);
                        let largest = || {
                            let state = robot.state(sample.q).unwrap();
                            let mut j = state
                                .jacobian(robot.tool(), ReferenceFrame::LocalWorldAligned)
                                .unwrap();
                            for c in 0..robot.n() {
                                j.column_mut(c)[..3].iter_mut().for_each(|x| *x /= length);
                            }
                            Svd::of(&j).value(0)
                        };
                        let most = bound(method, largest, twist);
                        let name = method.name();
                        assert!(size <= most * (1.0 + 1e-9), "{name}: {size} over {most} rad/s");
                        fastest[k] = fastest[k].max(size);
                    };
                    simulate(&mut servo, &q, 2.0, |_| (target.into(), true), check).unwrap();
                }
            }
        }
    }
    // The poses are singular enough to matter: far above what the joints of these arms can do.
    for (k, method) in Method::ALL.into_iter().enumerate() {
        let slow = matches!(method, Method::SelectivelyDamped { .. });
        assert!(fastest[k] > 5.0 || slow, "{}: {} rad/s", method.name(), fastest[k]);
    }
}

/// The largest |rates| for a task twist of this size, by the numbers of the method.
fn bound(method: Method, largest: impl Fn() -> f64, twist: f64) -> f64 {
    // s / (s^2 + l^2) <= 1 / (2 l); with damping that rises below the onset e, at least l / sqrt 2
    // below e / sqrt 2, and s itself above it.
    let rising = |damping: f64, onset: f64| 2.0_f64.sqrt() * (0.5 / damping).max(1.0 / onset);
    let gain = match method {
        Method::Truncated { eps } => 1.0 / (eps * largest()),
        Method::Damped { damping } => 0.5 / damping,
        Method::VariableDamping { onset, damping } => rising(damping, onset * largest()),
        Method::NumericalFiltering { onset, damping, .. } => rising(damping, onset * largest()),
        // Each of at most seven joints on its own; the twist does not matter.
        Method::SelectivelyDamped { max_joint_velocity } => {
            return max_joint_velocity * 7.0_f64.sqrt();
        }
        // f rises from its floor for shape * floor < 2.
        Method::SingularValueFiltering { floor, .. } => 1.0 / floor,
        _ => panic!("state the bound of '{}' here", method.name()),
    };
    gain * twist
}

/// A heavy weight keeps a joint still while the others do the task.
#[test]
fn joint_weights_keep_joints_still() {
    let robot = planar(4);
    let q = [0.3, 0.8, -0.5, 0.9];
    let state = robot.state(&q).unwrap();
    let start = state.pose(robot.tool()).unwrap();
    let target = Pose { translation: start.translation + Vec3::new(0.01, -0.02, 0.0), ..start };
    let rates = |weights: Vec<f64>| {
        let mut servo = servo(&robot, |o| {
            o.task = Task::POSITION;
            o.acceleration = Some(f64::INFINITY); // the first step is compared
            o.joint_weights = weights;
        });
        servo.step(&q, target).unwrap();
        servo.joint_velocities().to_vec()
    };
    let (even, heavy) = (rates(vec![]), rates(vec![1.0, 1e8, 1.0, 1.0]));
    assert!(heavy[1].abs() < 1e-6 && even[1].abs() > 1e-3);
    let j = state.jacobian(robot.tool(), ReferenceFrame::LocalWorldAligned).unwrap();
    for rates in [even, heavy] {
        let v = j.mul_vec(&rates);
        assert!((v[0] - 0.05).abs() < 1e-10 && (v[1] + 0.1).abs() < 1e-10);
    }
}

/// Where the model has no acceleration limit, the first step from rest commands no jump, unless the
/// ramp is switched off.
#[test]
fn the_first_step_is_a_ramp() {
    let ur5e = catalogue::load("ur5e").unwrap();
    let q = [0.0, -1.5, 1.5, -1.5, -1.57, 0.0];
    let mut target = ur5e.state(&q).unwrap().pose(ur5e.tool()).unwrap();
    target.translation += Vec3::new(-0.3, 0.2, 0.1);
    let fastest = |acceleration: Option<f64>| {
        let mut servo = servo(&ur5e, |o| o.acceleration = acceleration);
        servo.step(&q, target).unwrap();
        let step = servo.options().dt;
        servo.joint_velocities().iter().fold(0.0, |m: f64, v| m.max(v.abs())) / step
    };
    let ramp = cylindroid::tolerance::DEFAULT_RAMP;
    assert!((fastest(None) - ramp).abs() < 1e-9 * ramp, "{}", fastest(None));
    assert!(fastest(Some(f64::INFINITY)) > 10.0 * ramp);
}

/// So do the drives of closed chains, slides in lengths of the mechanism.
#[test]
fn the_first_step_of_drives_is_a_ramp() {
    for name in ["five-bar", "3rrr", "stewart", "delta", "3rps"] {
        let robot = catalogue::load(name).unwrap();
        let q = cylindroid::closure::assemble(&robot, robot.home(), &[]).unwrap().q;
        let mut target = robot.state(&q).unwrap().pose(robot.reference()).unwrap();
        let is_planar = robot.dimension() == cylindroid::model::Dimension::Planar;
        let up = if is_planar { 0.0 } else { 0.1 };
        target.translation += Vec3::new(0.2, 0.1, up) * robot.reach();
        let fastest = |acceleration: Option<f64>| {
            let mut servo = servo(&robot, |o| o.acceleration = acceleration);
            servo.step(&q, target).unwrap();
            let step = servo.options().dt;
            let drives = robot.coordinates().iter().zip(servo.joint_velocities());
            drives.filter(|(c, _)| c.actuated).fold(0.0, |most: f64, (c, v)| {
                let unit = if c.kind.is_length() { robot.reach() } else { 1.0 };
                let published = c.limits.acceleration.is_finite();
                most.max(if published { 0.0 } else { v.abs() / (step * unit) })
            })
        };
        let ramp = cylindroid::tolerance::DEFAULT_RAMP;
        let (with, without) = (fastest(None), fastest(Some(f64::INFINITY)));
        println!("{name}: {with} with the ramp, {without} without");
        assert!(with > 0.5 * ramp && with < ramp * (1.0 + 1e-9), "{name}: {with}");
        assert!(without > 2.0 * ramp, "{name}: {without}");
    }
}

/// The default ramp costs no targets: random motions with it and without.
#[test]
fn the_default_ramp_costs_no_targets() {
    for name in ["ur5e", "iiwa14", "puma560"] {
        let robot = catalogue::load(name).unwrap();
        let runs = 100;
        let reached = |acceleration: Option<f64>| {
            let mut random = Random(197);
            let mut servo = servo(&robot, |o| (o.dt, o.acceleration) = (4e-3, acceleration));
            let motions = (0..runs).filter(|_| {
                let (from, to) = (random.q(&robot), random.q(&robot));
                let target = robot.state(&to).unwrap().pose(robot.tool()).unwrap();
                servo.reset();
                run(&mut servo, &from, target).reached
            });
            motions.count()
        };
        let with = reached(None);
        let without = reached(Some(f64::INFINITY));
        println!("{name}: {with} of {runs} reached with the default ramp, {without} without");
        assert!(with + 3 >= without, "{name}: {with} {without}");
    }
}

/// Bounds of one sign, of a joint that must go on, are met at their values too.
#[test]
fn bounds_of_one_sign_are_met() {
    let bounds = VelocityBounds {
        lower: -2.0,
        upper: -1.0,
        lower_cause: LimitKind::Velocity,
        upper_cause: LimitKind::Position,
    };
    assert_eq!(bounds.met(-1.0), Some(LimitKind::Position));
    assert_eq!(bounds.met(-1.5), None);
    assert_eq!(bounds.met(-2.0), Some(LimitKind::Velocity));
    let (lower, upper) = (-bounds.upper, -bounds.lower);
    let mirrored = VelocityBounds { lower, upper, ..bounds };
    assert_eq!(mirrored.met(1.0), Some(LimitKind::Velocity));
    assert_eq!(mirrored.met(2.0), Some(LimitKind::Position));
}
