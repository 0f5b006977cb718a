//! Servos of many tasks.

use cylindroid::closure::assemble;
use cylindroid::collision::{CollisionModel, CollisionOptions};
use cylindroid::control::{
    CollisionAvoidance, HalfSpace, MotionTask, ServoOptions, Task, TaskObjective, TaskServo,
    TaskServoOptions,
};
use cylindroid::model::{Geometry, JointSpec, Link, Visual};
use cylindroid::{Mechanism, Pose, Twist, Vec3, catalogue};

use super::{count, frame};

/// Many tasks, with limits that bite and an obstacle in the way.
#[test]
fn many_tasks_allocate_nothing() {
    let both = [true, false];
    let all = ["panda", "ur5e", "youbot"].into_iter().flat_map(|name| both.map(|b| (name, b)));
    for (name, keep_directions) in all {
        let mut builder = Mechanism::builder(name);
        let robot = catalogue::load(name).unwrap();
        for link in robot.links() {
            let shape = Visual { geometry: Geometry::Sphere { radius: 0.05 }, ..Visual::default() };
            builder.link(Link { collisions: vec![shape.into()], ..link.clone() });
        }
        for joint in robot.joints() {
            let [parent, child] = [joint.parent, joint.child].map(|l| &robot.links()[l].name);
            builder.joint(JointSpec {
                axis: joint.axis,
                parent_from_joint: joint.parent_from_joint,
                limits: joint.limits,
                ..JointSpec::new(&joint.name, joint.kind, parent, child)
            });
        }
        let robot = builder.build().unwrap();
        let mut q = robot.home().to_vec();
        let state = robot.state(&q).unwrap();
        let last = robot.frame(&robot.links().last().unwrap().name).unwrap();
        let mut pose = state.pose(last).unwrap();
        pose.translation.x += 0.3;
        let middle = robot.frame(&robot.links()[4].name).unwrap();
        let mut model = CollisionModel::new(&robot, &CollisionOptions::default()).unwrap();
        let between = Pose::from_translation(pose.translation + Vec3::new(-0.1, 0.0, 0.05));
        model.add_obstacle("ball", &Geometry::Sphere { radius: 0.05 }, between).unwrap();
        let tasks = vec![
            MotionTask::new("hand", frame(last.into(), Task::POSITION, pose)),
            MotionTask::new("middle", frame(middle.into(), Task::POSE, pose)).at_level(1),
            MotionTask::new("posture", TaskObjective::Posture { q: q.clone() }),
        ];
        let mut options = TaskServoOptions::new(&robot);
        options.acceleration = 5.0;
        options.keep_directions = keep_directions;
        options.collisions = Some(CollisionAvoidance { model, gap: 0.01, margin: 0.2 });
        let mut servo = TaskServo::new(&robot, tasks, options).unwrap();
        servo.step(&q).unwrap();
        let mut stopped = 0;
        let counted = count(|| {
            for _ in 0..500 {
                servo.step(&q).unwrap();
                servo.advance(&mut q);
                stopped += usize::from(servo.reports()[0].stopped_by.is_some());
            }
        });
        assert_eq!(counted, 0, "{name}");
        assert!(stopped > 0, "{name}: nothing stopped it");
    }
}

/// A straight arm whose target lies inside: the escape looks for a way and takes it.
#[test]
fn escapes_of_tasks_allocate_nothing() {
    let robot = catalogue::load("3r").unwrap();
    let mut q = vec![0.3, 0.0, 0.0];
    let pose = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
    let target = Pose { translation: pose.translation * 0.7, ..pose };
    let task = MotionTask::new("hand", frame(robot.tool().into(), Task::POSITION, target));
    let options = TaskServoOptions { dt: 4e-3, ..TaskServoOptions::new(&robot) };
    let mut servo = TaskServo::new(&robot, vec![task], options).unwrap();
    servo.step(&q).unwrap();
    let counted = count(|| {
        for _ in 0..1000 {
            servo.step(&q).unwrap();
            servo.advance(&mut q);
        }
    });
    assert_eq!(counted, 0);
    assert!(servo.reports()[0].position_error < 1e-3, "{:?}", servo.reports());
    // Along a twist.
    let twist = Twist { linear: Vec3::Y * 0.1, angular: Vec3::ZERO };
    let counted = count(|| {
        for round in 0..200 {
            if round < 100 {
                servo.command_twist("hand", twist, 0.1).unwrap();
            }
            servo.step(&q).unwrap();
            servo.advance(&mut q);
        }
    });
    assert_eq!(counted, 0);
}

/// Many tasks of every closed chain, with a half-space: away from type II singularities.
#[test]
fn tasks_of_closed_chains_allocate_nothing() {
    for name in catalogue::names() {
        let mechanism = catalogue::load(name).unwrap();
        if !mechanism.is_closed() {
            continue;
        }
        let q = assemble(&mechanism, mechanism.home(), &[]).unwrap().q;
        let defaults = ServoOptions::new(&mechanism);
        let end_effector = defaults.end_effector;
        let pose = mechanism.state(&q).unwrap().pose(end_effector).unwrap();
        // A 3-RPS rises and does not shift.
        let along = if *name == "3rps" { Vec3::Z } else { Vec3::X };
        let way = along * (0.02 * mechanism.reach());
        let target = Pose { translation: pose.translation + way, ..pose };
        let objective = frame(end_effector, defaults.task, target);
        let posture = TaskObjective::Posture { q: q.clone() };
        let mut options =
            TaskServoOptions { acceleration: 5.0, ..TaskServoOptions::new(&mechanism) };
        options.half_spaces = vec![HalfSpace {
            name: "wall".to_owned(),
            end_effector,
            point: target.translation,
            normal: Vec3::ZERO - Vec3::X,
        }];
        let tasks = vec![MotionTask::new("a", objective), MotionTask::new("b", posture)];
        let mut servo = TaskServo::new(&mechanism, tasks, options).unwrap();
        servo.step(&q).unwrap();
        let (mut at, mut counted) = (q, 0);
        for _ in 0..300 {
            counted += count(|| _ = servo.step(&at).unwrap());
            servo.advance(&mut at);
        }
        assert_eq!(counted, 0, "{name}");
    }
}
