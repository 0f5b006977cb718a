//! Targets beyond reach: an arm comes to rest at the nearest pose, and says so.

use cylindroid::control::{Stall, Status, Task};
use cylindroid::inverse::Method;
use cylindroid::model::{JointKind, JointSpec, Limits};
use cylindroid::{Mechanism, Pose, Rotation, Servo, ServoOptions, Twist, Vec3, catalogue};

/// A motion to the edge of reach.
#[derive(Debug)]
struct ToTheEdge {
    /// Time until the stall is named (s).
    time: f64,
    /// Motion of the tool away from the target (m).
    back: f64,
    /// Error left, angles times the characteristic length (m).
    left: f64,
    stall: Option<Stall>,
}

/// From home towards a target 1.5 m away in this direction, at most a minute.
fn to_the_edge(name: &str, direction: Vec3, acceleration: f64, dt: f64) -> ToTheEdge {
    let robot = catalogue::load(name).unwrap();
    let options =
        ServoOptions { acceleration: Some(acceleration), dt, ..ServoOptions::new(&robot) };
    to_the_edge_with(&robot, direction, options)
}

fn to_the_edge_with(robot: &Mechanism, direction: Vec3, options: ServoOptions) -> ToTheEdge {
    let (dt, length) = (options.dt, options.length);
    let mut servo = Servo::new(robot, options).unwrap();
    let mut q = robot.home().to_vec();
    let mut target = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
    target.translation += direction * 1.5;
    let mut last = f64::INFINITY;
    let mut motion = ToTheEdge { time: f64::INFINITY, back: 0.0, left: 0.0, stall: None };
    let mut time = 0.0;
    while time < 60.0 {
        let step = servo.step(&q, target).unwrap();
        servo.advance(&mut q);
        motion.back += (step.position_error - last).max(0.0);
        last = step.position_error;
        motion.left = last.hypot(length * step.orientation_error);
        time += dt;
        if step.status == Status::Stalled {
            motion.time = time;
            motion.stall = Some(servo.stall());
            break;
        }
    }
    motion
}

/// Without a millimetre of motion backwards; weak arms moved back by up to 15 mm on their way.
#[test]
fn arms_come_to_rest_at_the_edge_of_their_reach() {
    let directions = [Vec3::X, Vec3::Y, Vec3::new(0.6, 0.0, 0.8)];
    let arms = ["ur5e", "iiwa14", "puma560"];
    for (name, direction) in arms.iter().flat_map(|n| directions.map(|d| (n, d))) {
        let ideal = to_the_edge(name, direction, f64::INFINITY, 1e-2);
        let cases = [(0.5, 1e-2), (1.0, 1e-2), (2.0, 1e-2), (5.0, 2e-3), (5.0, 1e-2)];
        let strong = [(10.0, 1e-2), (20.0, 5e-3), (40.0, 1e-2)];
        for (acceleration, dt) in cases.into_iter().chain(strong) {
            let motion = to_the_edge(name, direction, acceleration, dt);
            let case =
                format!("{name} {direction:?} at {acceleration} rad/s^2, {dt} s: {motion:?}");
            println!("{case}");
            assert!(matches!(motion.stall, Some(Stall::OutOfReach { .. })), "{case}");
            assert!(motion.left < ideal.left + 0.005, "{case}, {ideal:?}");
            let time = if acceleration < 5.0 { 20.0 } else { 8.0 };
            assert!(motion.back < 1e-3 && motion.time < time, "{case}, {ideal:?}");
        }
    }
}

/// The same with every inverse.
#[test]
fn all_inverses_come_to_rest_at_the_edge() {
    let robot = catalogue::load("ur5e").unwrap();
    for (method, acceleration) in Method::ALL.into_iter().flat_map(|m| [2.0, 10.0].map(|a| (m, a)))
    {
        for direction in [Vec3::X, Vec3::new(-0.6, 0.64, 0.48)] {
            let options = ServoOptions {
                acceleration: Some(acceleration),
                dt: 1e-2,
                method,
                ..ServoOptions::new(&robot)
            };
            let motion = to_the_edge_with(&robot, direction, options);
            let case =
                format!("{} {direction:?} at {acceleration} rad/s^2: {motion:?}", method.name());
            println!("{case}");
            assert!(matches!(motion.stall, Some(Stall::OutOfReach { .. })), "{case}");
            assert!(motion.back < 1e-3 && motion.time < 20.0, "{case}");
        }
    }
}

/// An arm of four hinges on a slide, with weak drives; `size` new units of length in an old one.
fn arm_on_a_slide(world: Pose, size: f64) -> Mechanism {
    let mut builder = Mechanism::builder("arm on a slide");
    let weak = Limits { lower: -2.5, upper: 2.5, velocity: 2.0, acceleration: 1.0, ..Limits::NONE };
    let mut add = |name: &str, parent: &str, axis: Vec3, at: Pose| {
        let slides = name == "slide";
        let kind = if slides { JointKind::Prismatic } else { JointKind::Revolute };
        let unit = if slides { size } else { 1.0 };
        builder.joint(JointSpec {
            axis,
            parent_from_joint: at,
            limits: Limits {
                lower: weak.lower * 0.2 * unit,
                upper: weak.upper * 0.2 * unit,
                velocity: weak.velocity * unit,
                acceleration: weak.acceleration * unit,
                ..weak
            },
            ..JointSpec::new(name, kind, parent, &format!("{name}_link"))
        });
    };
    let ahead = |x: f64| Pose::from_translation(Vec3::X * (x * size));
    let lowered = world * Pose::from_translation(Vec3::new(0.1, -0.2, 0.3) * size);
    add("slide", "base", Vec3::Y, lowered);
    add("shoulder", "slide_link", Vec3::Z, ahead(0.2));
    add("elbow", "shoulder_link", Vec3::Z, ahead(0.4));
    add("lift", "elbow_link", Vec3::Y, ahead(0.3));
    add("wrist", "lift_link", Vec3::X, ahead(0.2));
    builder.frame("tool", "wrist_link", ahead(0.1));
    builder.tool("tool");
    builder.build().unwrap()
}

/// The way to the edge before a target, or along a twist in its direction, step by step, in angles and
/// old units of length.
fn way_to_the_edge(
    (task, is_twist): (Task, bool),
    target: Vec3,
    world: Pose,
    size: f64,
) -> Vec<Vec<f64>> {
    let robot = arm_on_a_slide(world, size);
    let mut options = ServoOptions { dt: 1e-2, task, ..ServoOptions::new(&robot) };
    options.tolerance.position *= size;
    // The slide costs as much in every unit.
    options.joint_weights = vec![1.0 / (size * size), 1.0, 1.0, 1.0, 1.0];
    let mut servo = Servo::new(&robot, options).unwrap();
    let mut q = vec![0.1 * size, 0.3, -0.4, 0.2, 0.1];
    let direction = target.unit(1e-9).unwrap();
    let target = Pose {
        rotation: world.rotation * Rotation::exp(Vec3::new(0.3, 0.1, 0.4)),
        translation: world * (target * size),
    };
    let outwards = world.rotation * (direction * (0.3 * size));
    let twist = Twist { linear: outwards, angular: Vec3::ZERO };
    let mut way = Vec::new();
    let mut status = Status::Moving;
    for _ in 0..600 {
        if is_twist {
            servo.step_twist(&q, Some(twist)).unwrap();
        } else {
            status = servo.step(&q, target).unwrap().status;
        }
        servo.advance(&mut q);
        way.push(std::iter::once(q[0] / size).chain(q[1..].iter().copied()).collect());
    }
    assert_ne!(status, Status::Reached);
    way
}

#[test]
fn the_way_to_the_edge_depends_on_no_frame_and_no_unit() {
    let elsewhere = Pose {
        rotation: Rotation::exp(Vec3::new(0.4, -1.1, 0.7)),
        translation: Vec3::new(3.0, -2.0, 0.5),
    };
    // Farther than the arm is long, and nearer. Towards a position the arm has self-motions, and takes its
    // way straight.
    let targets = [Vec3::new(2.5, 1.0, 1.2), Vec3::new(1.35, 0.5, 0.35)];
    let tasks =
        [(Task::POSE, false), (Task::POSITION, false), (Task::POSE, true), (Task::POSITION, true)];
    for (task, target) in tasks.into_iter().flat_map(|k| targets.map(|t| (k, t))) {
        let own = way_to_the_edge(task, target, Pose::IDENTITY, 1.0);
        let moves = own[0].iter().zip(own.last().unwrap()).map(|(a, b)| (a - b).abs());
        assert!(moves.fold(0.0, f64::max) > 0.2, "it hardly moves");
        for (world, size) in [(elsewhere, 1.0), (Pose::IDENTITY, 1e-3), (elsewhere, 40.0)] {
            let other = way_to_the_edge(task, target, world, size);
            for (step, (a, b)) in own.iter().zip(&other).enumerate() {
                let apart = a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(apart < 1e-8, "{task:?} {target:?}: step {step} at {size}: {apart:e}");
            }
        }
    }
}

/// A wrist with a spherical joint, which has no way in coordinates, comes to rest too.
#[test]
fn arms_with_balls_come_to_rest_at_the_edge() {
    let mut builder = Mechanism::builder("arm with a ball");
    let limits = Limits { velocity: 2.0, acceleration: 5.0, ..Limits::NONE };
    for (name, kind, parent, x) in [
        ("pan", JointKind::Revolute, "base", 0.0),
        ("lift", JointKind::Revolute, "pan_link", 0.1),
        ("elbow", JointKind::Revolute, "lift_link", 0.4),
        ("ball", JointKind::Spherical, "elbow_link", 0.4),
    ] {
        builder.joint(JointSpec {
            axis: if name == "pan" { Vec3::Z } else { Vec3::Y },
            parent_from_joint: Pose::from_translation(Vec3::X * x),
            limits,
            ..JointSpec::new(name, kind, parent, &format!("{name}_link"))
        });
    }
    builder.frame("tool", "ball_link", Pose::from_translation(Vec3::X * 0.1));
    builder.tool("tool");
    builder.home(&[0.2, -0.5, 1.0, 0.1, 0.2, -0.1]);
    let robot = builder.build().unwrap();
    let options = ServoOptions { dt: 1e-2, ..ServoOptions::new(&robot) };
    let motion = to_the_edge_with(&robot, Vec3::X, options);
    assert!(matches!(motion.stall, Some(Stall::OutOfReach { .. })), "{motion:?}");
    assert!(motion.time < 20.0, "{motion:?}");
}

/// An arm of slides and hinges goes the same way to the same target in every unit of length, without
/// weights as well: the inverses see no length but that of the mechanism. Of units that are powers of
/// two, so that nothing is rounded in another way: the step in which a joint begins to brake would be
/// another one.
#[test]
fn the_way_of_an_arm_on_a_slide_depends_on_no_unit() {
    let way = |size: f64, method: Method| {
        let robot = arm_on_a_slide(Pose::IDENTITY, size);
        let task = Task::POSITION;
        let mut options = ServoOptions { dt: 5e-3, task, method, ..ServoOptions::new(&robot) };
        options.tolerance.position *= size;
        let mut servo = Servo::new(&robot, options).unwrap();
        let (mut q, goal) =
            ([0.1 * size, 0.3, -0.4, 0.2, 0.1], [-0.15 * size, 0.2, 0.1, -0.2, 0.35]);
        let target = robot.state(&goal).unwrap().pose(robot.tool()).unwrap();
        let mut way = Vec::new();
        for _ in 0..4000 {
            let status = servo.step(&q, target).unwrap().status;
            servo.advance(&mut q);
            way.push([q[0] / size, q[1], q[2], q[3], q[4]]);
            if status == Status::Reached {
                break;
            }
        }
        way
    };
    for method in Method::ALL {
        let (own, what) = (way(1.0, method), method.name());
        assert!(own.len() < 4000, "{what}");
        for size in [-20, -10, 5, 20].map(|k| 2.0_f64.powi(k)) {
            let other = way(size, method);
            assert_eq!(own.len(), other.len(), "{what} at {size}");
            for (step, (a, b)) in own.iter().zip(&other).enumerate() {
                let apart = a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(apart < 1e-6, "{what} at {size}: step {step}, {apart:e}");
            }
        }
    }
}
