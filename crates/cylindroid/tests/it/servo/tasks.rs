//! Many tasks at once: contraction of every error, strict priorities, limits, collisions.

use cylindroid::collision::{CollisionModel, CollisionOptions};
use cylindroid::control::{
    CollisionAvoidance, CustomTask, MotionTask, StoppedBy, TaskObjective, TaskServo,
    TaskServoOptions,
};
use cylindroid::kinematics::{MassMatrix, State};
use cylindroid::model::{Geometry, Inertial, Link, Visual};
use cylindroid::spatial::Mat3;

use super::*;

/// A torso with two arms of seven joints and a head, with masses.
pub(crate) fn two_armed() -> Mechanism {
    let mut builder = Mechanism::builder("two-armed");
    let inertial = |mass: f64| Inertial {
        mass,
        link_from_inertia: Pose::from_translation(Vec3::new(0.05, -0.02, 0.1)),
        inertia: Mat3::ZERO,
    };
    let mut add = |name: &str, parent: &str, axis: Vec3, at: Vec3| {
        let link = format!("{name}_link");
        builder.link(Link { inertial: Some(inertial(2.0)), ..Link::named(&link) });
        let mut joint = JointSpec::new(name, JointKind::Revolute, parent, &link);
        joint.axis = axis;
        joint.parent_from_joint = Pose::from_translation(at);
        joint.limits =
            Limits { lower: -2.6, upper: 2.6, velocity: 2.0, acceleration: 20.0, ..Limits::NONE };
        builder.joint(joint);
        link
    };
    let torso = add("torso", "world", Vec3::Z, Vec3::Z * 0.5);
    for (side, sign) in [("left", 1.0), ("right", -1.0)] {
        let mut parent = torso.clone();
        let axes = [Vec3::Y, Vec3::X, Vec3::Z, Vec3::Y, Vec3::Z, Vec3::Y, Vec3::X];
        for (i, axis) in axes.into_iter().enumerate() {
            let at = if i == 0 { Vec3::new(0.0, 0.2 * sign, 0.4) } else { Vec3::X * 0.12 };
            parent = add(&format!("{side}_{i}"), &parent, axis, at);
        }
    }
    let neck = add("neck", &torso, Vec3::Y, Vec3::Z * 0.6);
    add("pan", &neck, Vec3::X, Vec3::Z * 0.1);
    builder.build().unwrap()
}

/// A configuration away from singular ones.
fn bent(robot: &Mechanism, random: &mut Random) -> Vec<f64> {
    (0..robot.n())
        .map(|i| 0.6 * f64::from(1 - 2 * (i as i32 % 2)) + 0.3 * random.within(-1.0, 1.0))
        .collect()
}

fn options(robot: &Mechanism) -> TaskServoOptions {
    TaskServoOptions::new(robot)
}

fn frame(robot: &Mechanism, name: &str, components: Task, target: Pose) -> TaskObjective {
    let end_effector = robot.frame(name).unwrap().into();
    TaskObjective::Frame { end_effector, components, target: target.into() }
}

/// One joint to an angle.
#[derive(Debug, Clone)]
struct Angle(usize, f64);

impl CustomTask for Angle {
    fn rows(&self) -> usize {
        1
    }

    fn evaluate(
        &mut self,
        state: &State,
        error: &mut [f64],
        jacobian: &mut Matrix,
    ) -> Result<(), Error> {
        error[0] = self.1 - state.q()[self.0];
        jacobian.as_mut_slice().fill(0.0);
        jacobian[(0, self.0)] = 1.0;
        Ok(())
    }

    fn boxed(&self) -> Box<dyn CustomTask> {
        Box::new(self.clone())
    }
}

fn objectives(robot: &Mechanism, q: &[f64], random: &mut Random) -> Vec<TaskObjective> {
    let state = robot.state(q).unwrap();
    let [left, right, head] =
        ["left_6_link", "right_6_link", "pan_link"].map(|name| robot.frame(name).unwrap());
    let mut near = |scale: f64| {
        let mut v = || scale * random.within(-1.0, 1.0);
        Twist { linear: Vec3::new(v(), v(), v()), angular: Vec3::new(v(), v(), v()) }
    };
    let beside = |pose: Pose, by: Twist| Pose {
        translation: pose.translation + by.linear,
        rotation: pose.rotation * Rotation::exp(by.angular),
    };
    let mut masses = MassMatrix::new(robot);
    let center = masses.center_of_mass(&state, &mut Matrix::zeros(3, robot.n())).unwrap().1;
    let relative = state.pose(right).unwrap().inverse() * state.pose(left).unwrap();
    vec![
        frame(robot, "left_6_link", Task::POSE, beside(state.pose(left).unwrap(), near(0.05))),
        frame(robot, "left_6_link", Task::POINTING, beside(state.pose(left).unwrap(), near(0.05))),
        TaskObjective::RelativeFrame {
            end_effector: left.into(),
            reference: right.into(),
            components: Task::POSE,
            target: beside(relative, near(0.05)),
        },
        TaskObjective::CenterOfMass {
            axes: [true, true, false],
            target: center + near(0.02).linear,
            velocity: Vec3::ZERO,
        },
        TaskObjective::Gaze {
            end_effector: head.into(),
            point: state.pose(head).unwrap() * (Vec3::Z * 2.0) + near(0.2).linear,
        },
        TaskObjective::Custom(Box::new(Angle(3, q[3] + 0.1))),
    ]
}

/// Alone, without limits, every error falls by the factor 1 - gain * dt in a step, to second order:
/// its Jacobian is the derivative of its error.
#[test]
fn jacobians_are_derivatives_of_errors() {
    let robot = unlimited(&two_armed());
    let mut random = Random(3);
    for _ in 0..20 {
        let q = bent(&robot, &mut random);
        for objective in objectives(&robot, &q, &mut random) {
            let name = format!("{objective:?}");
            let task = MotionTask { gain: 1.0, ..MotionTask::new("task", objective) };
            let mut options = options(&robot);
            options.dt = 1e-3;
            let mut servo = TaskServo::new(&robot, vec![task], options).unwrap();
            let size = |servo: &TaskServo| {
                let report = servo.reports()[0];
                report.position_error.hypot(report.orientation_error)
            };
            let mut q = q.clone();
            servo.step(&q).unwrap();
            let before = size(&servo);
            servo.advance(&mut q);
            servo.step(&q).unwrap();
            let fallen = (before - size(&servo)) / before;
            assert!((fallen - 1e-3).abs() < 2e-5, "{fallen} of {name}");
        }
    }
}

/// The tasks of a hand on level 0, and others below it.
fn hand_above(robot: &Mechanism, start: &[f64], random: &mut Random) -> Vec<MotionTask> {
    let mut all = objectives(robot, start, random);
    let gaze = all.remove(4);
    let center = all.remove(3);
    vec![
        MotionTask::new("center", center).at_level(1),
        MotionTask::new("hand", all.remove(0)),
        MotionTask::new("gaze", gaze).at_level(2),
        MotionTask::new("posture", TaskObjective::Posture { q: vec![0.1; robot.n()] }),
    ]
}

/// A level never disturbs the ones before it. Without limits the twist of the hand is its gain times
/// its error in every step, and with the others below it its path is that of the hand alone.
#[test]
fn lower_levels_do_not_disturb_higher_ones() {
    let robot = unlimited(&two_armed());
    let mut random = Random(8);
    for round in 0..5 {
        let start = bent(&robot, &mut random);
        let both = hand_above(&robot, &start, &mut random);
        let alone = vec![both[1].clone()];
        let TaskObjective::Frame { end_effector, target, .. } = both[1].objective else {
            panic!("a frame")
        };
        let gain = both[1].gain;
        let mut paths = [alone, both].map(|tasks| {
            let mut servo = TaskServo::new(&robot, tasks, options(&robot)).unwrap();
            let mut q = start.clone();
            let mut path = Vec::new();
            for step in 0..1500 {
                servo.step(&q).unwrap();
                let state = robot.state(&q).unwrap();
                let pose = state.pose(end_effector).unwrap();
                let jacobian =
                    state.jacobian(end_effector, ReferenceFrame::LocalWorldAligned).unwrap();
                let twist = jacobian.mul_vec(servo.joint_velocities());
                let error = pose.error_to(target.pose).to_array();
                let difference = twist.iter().zip(error).map(|(v, e)| (v - gain * e).abs());
                let largest = difference.fold(0.0, f64::max);
                assert!(largest < 1e-9, "round {round}, step {step}: {largest}");
                path.push(pose);
                servo.advance(&mut q);
            }
            path
        });
        let [alone, both] = &mut paths;
        for (step, (a, b)) in alone.iter().zip(both).enumerate() {
            let apart = (a.translation - b.translation).norm();
            assert!(apart < 1e-4, "round {round}, step {step}: {apart} m apart");
        }
    }
}

/// Inside limits the hand arrives, and so do those below it that it leaves room for.
#[test]
fn levels_arrive_inside_limits() {
    let robot = two_armed();
    let mut random = Random(8);
    for round in 0..10 {
        let start = bent(&robot, &mut random);
        let tasks = hand_above(&robot, &start, &mut random);
        let mut servo = TaskServo::new(&robot, tasks, options(&robot)).unwrap();
        let mut q = start.clone();
        for step in 0..1500 {
            servo.step(&q).unwrap();
            let hand = servo.reports()[1];
            assert!(hand.scale > 0.0, "round {round}, step {step}: {hand:?}");
            servo.advance(&mut q);
        }
        let last = servo.reports();
        assert!(last[1].position_error < 1e-4, "round {round}: {last:?}");
        assert!(last[1].orientation_error < 1e-3, "round {round}: {last:?}");
        // What the hand leaves free suffices for the other two.
        assert!(last[0].position_error < 1e-3, "round {round}: {last:?}");
    }
}

/// Two tasks of one level that contradict each other meet where their weights say.
#[test]
fn weights_share_a_level() {
    let robot = unlimited(&two_armed());
    let [heavy, light] = [(9.0, 0.4), (1.0, 0.0)].map(|(weight, angle)| MotionTask {
        weight,
        ..MotionTask::new(&format!("{weight}"), TaskObjective::Custom(Box::new(Angle(3, angle))))
    });
    let mut servo = TaskServo::new(&robot, vec![heavy, light], options(&robot)).unwrap();
    let mut q = vec![0.0; robot.n()];
    for _ in 0..4000 {
        servo.step(&q).unwrap();
        servo.advance(&mut q);
    }
    assert!((q[3] - 0.36).abs() < 1e-6, "{}", q[3]);
}

/// The weight of a posture or of velocities is beside the others of their kind, not a gain.
#[test]
fn weights_are_no_gains() {
    let robot = unlimited(&two_armed());
    let wanted: Vec<f64> = (0..robot.n()).map(|i| 0.01 * i as f64).collect();
    let velocities =
        |velocities: &[f64]| TaskObjective::JointVelocities { velocities: velocities.to_vec() };
    let task = |weight, name: &str, v: &[f64]| MotionTask {
        weight,
        ..MotionTask::new(name, velocities(v))
    };
    let q = vec![0.1; robot.n()];
    let alone = vec![task(1000.0, "a", &wanted)];
    let mut servo = TaskServo::new(&robot, alone, options(&robot)).unwrap();
    servo.step(&q).unwrap();
    let close = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
    assert!(close(servo.joint_velocities(), &wanted));
    let both = vec![task(3.0, "a", &wanted), task(1.0, "b", &vec![0.0; robot.n()])];
    let mut servo = TaskServo::new(&robot, both, options(&robot)).unwrap();
    servo.step(&q).unwrap();
    let mean: Vec<f64> = wanted.iter().map(|v| 0.75 * v).collect();
    assert!(close(servo.joint_velocities(), &mean));
}

/// A custom task of the wrong shape or size is an error, and the servo stays as it was.
#[test]
fn wrong_custom_tasks_are_errors() {
    #[derive(Debug, Clone)]
    struct Wrong(usize);
    impl CustomTask for Wrong {
        fn rows(&self) -> usize {
            1
        }

        fn evaluate(
            &mut self,
            state: &State,
            error: &mut [f64],
            jacobian: &mut Matrix,
        ) -> Result<(), Error> {
            error[0] = if self.0 == 3 { 1e200 } else { 0.1 };
            match self.0 {
                0 => *jacobian = Matrix::zeros(1, 1),
                1 => jacobian[(0, 0)] = f64::NAN,
                2 | 3 => jacobian.as_mut_slice().fill(1e200),
                _ => error[0] = state.q()[0] + 1e300,
            }
            Ok(())
        }

        fn boxed(&self) -> Box<dyn CustomTask> {
            Box::new(self.clone())
        }
    }
    let robot = two_armed();
    for kind in 0..5 {
        let task = MotionTask::new("wrong", TaskObjective::Custom(Box::new(Wrong(kind))));
        let mut servo = TaskServo::new(&robot, vec![task], options(&robot)).unwrap();
        let error = servo.step(&vec![0.0; robot.n()]).unwrap_err().to_string();
        assert!(error.contains("of the task 'wrong'"), "{kind}: {error}");
        assert!(servo.joint_velocities().iter().all(|v| *v == 0.0));
    }
}

/// No limit is left and nothing is non-finite, whatever the tasks ask for.
#[test]
fn limits_hold_for_any_tasks() {
    let robot = two_armed();
    let mut random = Random(21);
    for _ in 0..6 {
        let mut q = bent(&robot, &mut random);
        let mut tasks: Vec<MotionTask> = objectives(&robot, &q, &mut random)
            .into_iter()
            .enumerate()
            .map(|(i, o)| MotionTask::new(&format!("{i}"), o).at_level(i / 2))
            .collect();
        // Far out of reach, now and then.
        if let TaskObjective::Frame { target, .. } = &mut tasks[0].objective {
            target.pose.translation += Vec3::new(
                random.within(-1.0, 1.0),
                random.within(-1.0, 1.0),
                2.0 * random.within(-1.0, 1.0),
            );
        }
        let mut servo = TaskServo::new(&robot, tasks, options(&robot)).unwrap();
        let mut before = vec![0.0; robot.n()];
        for step in 0..2000 {
            if step % 500 == 0
                && let TaskObjective::Gaze { point, .. } = servo.objective_mut("4").unwrap()
            {
                *point = Vec3::new(
                    random.within(-1.0, 1.0),
                    random.within(-1.0, 1.0),
                    random.within(-1.0, 1.0),
                );
            }
            servo.step(&q).unwrap();
            let rates = servo.joint_velocities();
            for (i, c) in robot.coordinates().iter().enumerate() {
                let l = &c.limits;
                assert!(rates[i].abs() <= l.velocity * (1.0 + 1e-12), "{}", c.name);
                let change = (rates[i] - before[i]).abs();
                assert!(change <= l.acceleration * 1e-3 * (1.0 + 1e-9), "{}: {change}", c.name);
            }
            before.copy_from_slice(rates);
            servo.advance(&mut q);
            for (x, c) in q.iter().zip(robot.coordinates()) {
                assert!(*x >= c.limits.lower && *x <= c.limits.upper, "{} at {x}", c.name);
            }
        }
    }
}

/// A target beyond reach is given up for a limit that is named, or left out as singular.
#[test]
fn a_stop_is_named() {
    let mut robot = Mechanism::builder("slide");
    let mut joint = JointSpec::new("x", JointKind::Prismatic, "rail", "cart");
    joint.limits =
        Limits { lower: -1.0, upper: 0.2, velocity: 1.0, acceleration: 5.0, ..Limits::NONE };
    robot.joint(joint);
    let robot = robot.build().unwrap();
    let target = Pose::from_translation(Vec3::Z);
    let task = MotionTask::new("cart", frame(&robot, "cart", Task::POSITION, target));
    let mut servo = TaskServo::new(&robot, vec![task], options(&robot)).unwrap();
    let mut q = vec![0.0];
    let mut status = Status::Moving;
    for _ in 0..4000 {
        status = servo.step(&q).unwrap();
        servo.advance(&mut q);
    }
    assert_eq!(status, Status::Stalled);
    assert!((q[0] - 0.2).abs() < 1e-9);
    let expected = StoppedBy::Limit { coordinate: 0, kind: LimitKind::Position };
    assert_eq!(servo.reports()[0].stopped_by, Some(expected));
}

/// Two arms of three links in the plane of an obstacle: no distance falls below the gap, with the
/// obstacle at rest, and the pair that stops the motion is named.
#[test]
fn bodies_keep_their_distance() {
    let mut builder = Mechanism::builder("arm");
    let mut parent = "base".to_owned();
    for i in 0..4 {
        let name = format!("link{i}");
        let capsule = Geometry::Sphere { radius: 0.05 };
        let at = |x: f64| Visual {
            geometry: capsule.clone(),
            link_from_shape: Pose::from_translation(Vec3::X * x),
            ..Visual::default()
        };
        builder.link(Link {
            collisions: vec![at(0.1).into(), at(0.2).into(), at(0.3).into()],
            ..Link::named(&name)
        });
        let mut joint = JointSpec::new(&format!("q{i}"), JointKind::Revolute, &parent, &name);
        joint.axis = if i == 1 { Vec3::Y } else { Vec3::Z };
        joint.parent_from_joint = Pose::from_translation(Vec3::X * if i == 0 { 0.0 } else { 0.3 });
        joint.limits =
            Limits { lower: -3.0, upper: 3.0, velocity: 2.0, acceleration: 10.0, ..Limits::NONE };
        builder.joint(joint);
        parent = name;
    }
    let robot = builder.build().unwrap();
    let mut random = Random(4);
    let (mut stops, mut parting) = (0, 0);
    for round in 0..12 {
        let mut model = CollisionModel::new(&robot, &CollisionOptions::default()).unwrap();
        let ball = Geometry::Sphere { radius: 0.15 };
        let angle = 0.5 + 0.1 * f64::from(round);
        let center =
            Vec3::new(0.7 * angle.cos(), 0.7 * angle.sin(), 0.1 * random.within(-1.0, 1.0));
        model.add_obstacle("ball", &ball, Pose::from_translation(center)).unwrap();
        let mut options = options(&robot);
        let gap = 0.01;
        options.collisions = Some(CollisionAvoidance { model: model.clone(), gap, margin: 0.3 });
        // On the other side of the ball.
        let goal = Vec3::new(0.9 * (2.0 * angle).cos(), 0.9 * (2.0 * angle).sin(), 0.0);
        let objective = frame(&robot, "link3", Task::POSITION, Pose::from_translation(goal));
        let tasks = vec![MotionTask::new("tip", objective)];
        let mut servo = TaskServo::new(&robot, tasks, options).unwrap();
        let mut q = vec![0.0, 0.3, 0.2, -0.3];
        let mut near = Vec::new();
        for step in 0..5000 {
            servo.step(&q).unwrap();
            if let Some(StoppedBy::Distance { pair }) = servo.reports()[0].stopped_by {
                stops += 1;
                // It is near, and comes no nearer than braking allows. It may move away where braking
                // from a faster motion would have brought it back.
                let near = servo.near().iter().find(|near| near.pair == pair).unwrap();
                let gradient = model.gradient(&robot.state(&q).unwrap(), near);
                let parts = gradient.iter().zip(servo.joint_velocities());
                let rate = parts.map(|(g, v)| g * v).sum::<f64>();
                let acceleration = 10.0 * gradient.iter().map(|g| g.abs()).sum::<f64>();
                let slowest = -(2.0 * acceleration * (near.distance - gap).max(0.0)).sqrt();
                let is_slow = rate > slowest - 1e-3;
                assert!(near.distance < 0.3 && is_slow, "round {round}: {near:?} at {rate}");
                parting += usize::from(rate > 1e-9);
            }
            servo.advance(&mut q);
            if step % 10 == 0 {
                model.near(&robot.state(&q).unwrap(), 0.3, &mut near).unwrap();
                for pair in &near {
                    let names = model.names(pair.pair);
                    assert!(
                        pair.distance >= gap - 1e-4,
                        "round {round}, step {step}: {names:?} at {}",
                        pair.distance
                    );
                }
            }
        }
    }
    assert!(stops > 100 && parting * 100 < stops, "{stops}, {parting} of them parting");
}

/// What defines no controller is refused, with its name.
#[test]
fn wrong_tasks_are_refused() {
    let robot = two_armed();
    let refused = |tasks: Vec<MotionTask>, robot: &Mechanism| {
        TaskServo::new(robot, tasks, options(robot)).unwrap_err().to_string()
    };
    let angle = || MotionTask::new("a", TaskObjective::Custom(Box::new(Angle(0, 0.1))));
    assert!(refused(vec![angle(), angle()], &robot).contains("two tasks"));
    assert!(refused(vec![MotionTask { gain: 3e3, ..angle() }], &robot).contains("below 2"));
    assert!(refused(vec![MotionTask { gain: -1.0, ..angle() }], &robot).contains("negative"));
    let passive = catalogue::load("stewart").unwrap().with_actuated::<&str>(&[]).unwrap();
    assert!(refused(vec![angle()], &passive).contains("no joint of 'stewart' is actuated"));
    let ur5e = catalogue::load("ur5e").unwrap();
    let center =
        TaskObjective::CenterOfMass { axes: [true; 3], target: Vec3::ZERO, velocity: Vec3::ZERO };
    assert!(refused(vec![MotionTask::new("c", center)], &ur5e).contains("mass"));
    let model = CollisionModel::new(&ur5e, &CollisionOptions::default()).unwrap();
    let mut other = options(&robot);
    other.collisions = Some(CollisionAvoidance { model, gap: 0.01, margin: 0.1 });
    let foreign = TaskServo::new(&robot, vec![angle()], other).unwrap_err().to_string();
    assert!(foreign.contains("is of 'ur5e'"), "{foreign}");
    let mut servo = TaskServo::new(&robot, vec![angle()], options(&robot)).unwrap();
    assert!(servo.objective_mut("b").is_err());
    let before = servo.joint_velocities().to_vec();
    assert!(servo.step(&vec![f64::NAN; robot.n()]).is_err());
    assert_eq!(servo.joint_velocities(), before);
    // No task at all: rest.
    let mut idle = TaskServo::new(&robot, Vec::new(), options(&robot)).unwrap();
    assert_eq!(idle.step(&vec![0.0; robot.n()]).unwrap(), Status::Reached);
}
