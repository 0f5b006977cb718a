//! Braking without contact: what is looked at before a velocity is commanded.

use std::f64::consts::PI;

use cylindroid::collision::{CollisionModel, CollisionOptions, NearPair};
use cylindroid::control::{
    CollisionAvoidance, MotionTask, StoppedBy, Task, TaskObjective, TaskServo, TaskServoOptions,
};
use cylindroid::model::{Collision, Geometry, JointKind, JointSpec, Limits, Link, LoopJointSpec};
use cylindroid::{Mechanism, Pose, Rotation, Vec3};

/// A ball of 5 cm on two slides, x and y, of unequal drives.
fn slides(accelerations: [f64; 2]) -> Mechanism {
    let mut builder = Mechanism::builder("slides");
    let ball = Geometry::Sphere { radius: 0.05 };
    let shape = Collision { geometry: ball, ..Collision::default() };
    builder.link(Link { collisions: vec![shape], ..Link::named("ball") });
    for (i, (name, ends)) in
        [("x", ["base", "beam"]), ("y", ["beam", "ball"])].into_iter().enumerate()
    {
        let mut joint = JointSpec::new(name, JointKind::Prismatic, ends[0], ends[1]);
        joint.axis = [Vec3::X, Vec3::Y][i];
        let acceleration = accelerations[i];
        joint.limits =
            Limits { lower: -2.0, upper: 2.0, velocity: 3.0, acceleration, ..Limits::NONE };
        builder.joint(joint);
    }
    builder.build().unwrap()
}

/// The task that brings the tool to a pose; the unit of length is `1 / size` metres.
fn towards(robot: &Mechanism, components: Task, goal: Pose, size: f64) -> MotionTask {
    let objective =
        TaskObjective::Frame { end_effector: robot.tool().into(), components, target: goal.into() };
    let mut task = MotionTask { gain: 20.0, ..MotionTask::new("tool", objective) };
    task.tolerance.position *= size;
    task
}

/// A wedge of two walls of which the upper one is met late: the way along the lower one is ended in
/// time. Without braking in mind the ball enters the wedge too fast for the slow slide.
#[test]
fn a_wedge_is_entered_no_faster_than_braking_ends() {
    for (accelerations, slope) in [([1.0, 30.0], 0.3_f64), ([0.5, 2.0], 0.15), ([4.0, 0.3], 0.5)] {
        let robot = slides(accelerations);
        let mut model = CollisionModel::new(&robot, &CollisionOptions::default()).unwrap();
        let wall = Geometry::Box { size: Vec3::new(6.0, 0.1, 1.0) };
        for (name, sign) in [("below", -1.0), ("above", 1.0)] {
            let turn = Rotation::exp(Vec3::Z * (-sign * slope));
            let middle = Vec3::new(1.0, 0.0, 0.0) + turn * Vec3::new(-3.0, sign * 0.05, 0.0);
            let pose = Pose { rotation: turn, translation: middle };
            model.add_obstacle(name, &wall, pose).unwrap();
        }
        let mut options = TaskServoOptions::new(&robot);
        options.dt = 2e-3;
        let gap = 0.002;
        options.collisions = Some(CollisionAvoidance { model: model.clone(), gap, margin: 0.1 });
        let goal = Pose::from_translation(Vec3::new(1.5, 0.0, 0.0));
        let task = towards(&robot, Task::POSITION, goal, 1.0);
        let mut servo = TaskServo::new(&robot, vec![task], options).unwrap();
        let mut q = vec![-1.9, 0.1];
        let mut near: Vec<NearPair> = Vec::new();
        for step in 0..5000 {
            servo.step(&q).unwrap();
            servo.advance(&mut q);
            model.near(&robot.state(&q).unwrap(), 1.0, &mut near).unwrap();
            let least = near.iter().map(|near| near.distance).fold(f64::INFINITY, f64::min);
            assert!(least > 0.0, "{accelerations:?}: step {step}, {least} m at {q:?}");
        }
        let stop = servo.reports()[0].stopped_by;
        assert!(matches!(stop, Some(StoppedBy::Distance { .. })), "{stop:?}");
        // At rest in the wedge, near both walls.
        assert!(near.iter().all(|near| near.distance < 0.01), "{near:?} at {q:?}");
        assert!(servo.joint_velocities().iter().all(|v| v.abs() < 1e-3));
    }
}

/// A bar on two slides and a hinge, with limits of all jerks, and two walls that form a wedge. Lengths
/// are `size` times those in metres, and all of it stands at `world`.
fn bar_in_a_wedge(world: Pose, size: f64) -> (Mechanism, CollisionModel) {
    let mut builder = Mechanism::builder("bar in a wedge");
    let bar = Geometry::Box { size: Vec3::new(0.3, 0.06, 0.06) * size };
    builder.link(Link {
        collisions: vec![Collision { geometry: bar, ..Collision::default() }],
        ..Link::named("bar")
    });
    for (i, (name, ends)) in
        [("x", ["base", "beam"]), ("y", ["beam", "cart"]), ("turn", ["cart", "bar"])]
            .into_iter()
            .enumerate()
    {
        let kind = [JointKind::Prismatic, JointKind::Prismatic, JointKind::Revolute][i];
        let length = if kind == JointKind::Prismatic { size } else { 1.0 };
        let limits = Limits {
            lower: -2.0 * length,
            upper: 2.0 * length,
            velocity: 2.0 * length,
            acceleration: [3.0, 1.0, 2.0][i] * length,
            jerk: [40.0, 8.0, 15.0][i] * length,
            ..Limits::NONE
        };
        builder.joint(JointSpec {
            axis: [Vec3::X, Vec3::Y, Vec3::Z][i],
            parent_from_joint: if i == 0 { world } else { Pose::IDENTITY },
            limits,
            ..JointSpec::new(name, kind, ends[0], ends[1])
        });
    }
    let robot = builder.build().unwrap();
    let mut model = CollisionModel::new(&robot, &CollisionOptions::default()).unwrap();
    let wall = Geometry::Box { size: Vec3::new(6.0, 0.1, 1.0) * size };
    for (name, sign) in [("below", -1.0), ("above", 1.0)] {
        let turn = Rotation::exp(Vec3::Z * (-sign * 0.3));
        let middle = Vec3::X + turn * Vec3::new(-3.0, sign * 0.05, 0.0);
        let pose = Pose { rotation: turn, translation: middle * size };
        model.add_obstacle(name, &wall, world * pose).unwrap();
    }
    (robot, model)
}

/// The way into the wedge, step by step, in angles and metres.
fn way_into_the_wedge(world: Pose, size: f64) -> Vec<Vec<f64>> {
    let (robot, mut model) = bar_in_a_wedge(world, size);
    let mut options = TaskServoOptions::new(&robot);
    options.dt = 4e-3;
    options.length = size;
    // The slides cost as much in every unit.
    options.joint_weights = vec![1.0 / (size * size), 1.0 / (size * size), 1.0];
    let (gap, margin) = (0.002 * size, 0.1 * size);
    options.collisions = Some(CollisionAvoidance { model: model.clone(), gap, margin });
    let goal = Pose {
        rotation: Rotation::exp(Vec3::Z * 1.2),
        translation: Vec3::new(1.5, 0.0, 0.0) * size,
    };
    let task = towards(&robot, Task::POSE, world * goal, size);
    let mut servo = TaskServo::new(&robot, vec![task], options).unwrap();
    let mut q = vec![-1.5 * size, 0.1 * size, -0.4];
    let mut near = Vec::new();
    let mut way = Vec::new();
    for _ in 0..1000 {
        servo.step(&q).unwrap();
        servo.advance(&mut q);
        model.near(&robot.state(&q).unwrap(), size, &mut near).unwrap();
        assert!(near.iter().all(|near| near.distance > 0.0), "{near:?} at {q:?}");
        way.push(vec![q[0] / size, q[1] / size, q[2]]);
    }
    let stop = servo.reports()[0].stopped_by;
    assert!(matches!(stop, Some(StoppedBy::Distance { .. })), "{stop:?}");
    way
}

/// The same way, in angles and metres, in other frames and units of length.
fn assert_same_everywhere(own: &[Vec<f64>], way: impl Fn(Pose, f64) -> Vec<Vec<f64>>) {
    let elsewhere = Pose {
        rotation: Rotation::exp(Vec3::new(0.4, -1.1, 0.7)),
        translation: Vec3::new(0.3, -0.2, 0.5),
    };
    for (world, size) in [(elsewhere, 1.0), (Pose::IDENTITY, 1e-3), (elsewhere, 40.0)] {
        let other = way(world, size);
        for (step, (a, b)) in own.iter().zip(&other).enumerate() {
            let apart = a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(apart < 1e-6, "step {step} at {size}: {apart:e}");
        }
    }
}

/// Bodies are stopped at the same places in every frame and unit of length.
#[test]
fn the_way_into_a_wedge_depends_on_no_frame_and_no_unit() {
    let own = way_into_the_wedge(Pose::IDENTITY, 1.0);
    assert_same_everywhere(&own, way_into_the_wedge);
}

/// A five-bar of drives of unequal accelerations, and two posts that its links meet on their
/// way. Lengths are `size` times those in metres, and all of it stands at `world`.
fn five_bar_between_posts(world: Pose, size: f64) -> (Mechanism, CollisionModel) {
    let mut builder = Mechanism::builder("five-bar between posts");
    let (lower, upper, width, meeting) = (0.4_f64, 0.5_f64, 0.6, Vec3::new(0.3, 0.7, 0.0));
    let (mut home, mut ends) = (Vec::new(), Vec::new());
    for (leg, x, side, acceleration) in [("a", 0.0, 1.0, 8.0), ("b", width, -1.0, 2.0)] {
        let base = Vec3::new(x, 0.0, 0.0);
        let way = meeting - base;
        let far = way.norm();
        let shoulder = ((far * far + lower * lower - upper * upper) / (2.0 * far * lower)).acos();
        let elbow = ((lower * lower + upper * upper - far * far) / (2.0 * lower * upper)).acos();
        home.extend([way.y.atan2(way.x) + side * shoulder, side * (elbow - PI)]);
        let links = [format!("{leg}1"), format!("{leg}2")];
        for (i, (length, at)) in [(lower, base), (upper, Vec3::X * lower)].into_iter().enumerate() {
            let place = Pose::from_translation(at * size);
            let limits = Limits { velocity: 4.0, acceleration, ..Limits::NONE };
            builder.joint(JointSpec {
                parent_from_joint: if i == 0 { world * place } else { place },
                limits: if i == 0 { limits } else { Limits::NONE },
                actuated: i == 0,
                ..JointSpec::new(
                    &format!("q_{}", links[i]),
                    JointKind::Revolute,
                    if i == 0 { "base" } else { &links[0] },
                    &links[i],
                )
            });
            let bar = Geometry::Box { size: Vec3::new(0.7 * length, 0.04, 0.04) * size };
            builder.link(Link {
                collisions: vec![Collision {
                    geometry: bar,
                    link_from_shape: Pose::from_translation(Vec3::X * (0.5 * length * size)),
                    ..Collision::default()
                }],
                ..Link::named(&links[i])
            });
        }
        ends.push(Pose::from_translation(Vec3::X * (upper * size)));
    }
    builder.loop_joint(LoopJointSpec {
        link_a_from_joint: ends[0],
        link_b_from_joint: ends[1],
        ..LoopJointSpec::new("meeting", JointKind::Revolute, "a2", "b2")
    });
    builder.frame("tip", "a2", ends[0]).tool("tip").reference("tip").home(&home);
    let robot = builder.build().unwrap();
    let mut model = CollisionModel::new(&robot, &CollisionOptions::default()).unwrap();
    for (name, x, y, radius) in [("high", 0.52, 0.42, 0.04), ("low", 0.3, 0.35, 0.05)] {
        let post = Geometry::Cylinder { radius: radius * size, length: size };
        let place = Pose::from_translation(Vec3::new(x, y, 0.0) * size);
        model.add_obstacle(name, &post, world * place).unwrap();
    }
    (robot, model)
}

/// The way of the five-bar towards a point behind the posts, step by step, in angles; and the nearest
/// bodies on it, with their distance in units of `size`.
fn way_between_posts(world: Pose, size: f64) -> (Vec<Vec<f64>>, f64, [String; 2]) {
    let (robot, mut model) = five_bar_between_posts(world, size);
    let mut options = TaskServoOptions::new(&robot);
    options.dt = 2e-3;
    options.length = size;
    let (gap, margin) = (0.002 * size, 0.1 * size);
    options.collisions = Some(CollisionAvoidance { model: model.clone(), gap, margin });
    let goal = Pose::from_translation(Vec3::new(0.7, 0.35, 0.0) * size);
    let task = towards(&robot, Task::POSITION, world * goal, size);
    let mut servo = TaskServo::new(&robot, vec![task], options).unwrap();
    let mut q = robot.home().to_vec();
    let (mut near, mut way) = (Vec::new(), Vec::new());
    let (mut least, mut names) = (f64::INFINITY, [String::new(), String::new()]);
    for _ in 0..1500 {
        servo.step(&q).unwrap();
        servo.advance(&mut q);
        model.near(&robot.state(&q).unwrap(), size, &mut near).unwrap();
        for near in &near {
            if near.distance < least * size {
                least = near.distance / size;
                names = model.names(near.pair).map(str::to_owned);
            }
        }
        assert!(least > 0.0, "{names:?}: {least} at {q:?}");
        way.push(q.clone());
    }
    (way, least, names)
}

/// The links of a closed chain are stopped at the same places in every frame and unit of length.
#[test]
fn the_way_of_a_closed_chain_between_posts_depends_on_no_frame_and_no_unit() {
    let (own, least, names) = way_between_posts(Pose::IDENTITY, 1.0);
    // A link that no drive moves alone came as near as it may.
    assert!(least < 0.0025 && names.contains(&"b2".to_owned()), "{names:?}: {least}");
    assert_same_everywhere(&own, |world, size| way_between_posts(world, size).0);
}
