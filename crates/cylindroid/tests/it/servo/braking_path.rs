//! Braking without contact: what is looked at before a velocity is commanded.

use cylindroid::collision::{CollisionModel, CollisionOptions, NearPair};
use cylindroid::control::{
    CollisionAvoidance, MotionTask, StoppedBy, Task, TaskObjective, TaskServo, TaskServoOptions,
};
use cylindroid::model::{Collision, Geometry, JointKind, JointSpec, Limits, Link};
use cylindroid::{Mechanism, Pose, Vec3};

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

/// A wedge of two walls of which the upper one is met late: the way along the lower one is ended in
/// time. Without braking in mind the ball enters the wedge too fast for the slow slide.
#[test]
fn a_wedge_is_entered_no_faster_than_braking_ends() {
    for (accelerations, slope) in [([1.0, 30.0], 0.3_f64), ([0.5, 2.0], 0.15), ([4.0, 0.3], 0.5)] {
        let robot = slides(accelerations);
        let mut model = CollisionModel::new(&robot, &CollisionOptions::default()).unwrap();
        let wall = Geometry::Box { size: Vec3::new(6.0, 0.1, 1.0) };
        for (name, sign) in [("below", -1.0), ("above", 1.0)] {
            let turn = cylindroid::Rotation::exp(Vec3::Z * (-sign * slope));
            let middle = Vec3::new(1.0, 0.0, 0.0) + turn * Vec3::new(-3.0, sign * 0.05, 0.0);
            let pose = Pose { rotation: turn, translation: middle };
            model.add_obstacle(name, &wall, pose).unwrap();
        }
        let mut options = TaskServoOptions::new(&robot);
        options.dt = 2e-3;
        let gap = 0.002;
        options.collisions = Some(CollisionAvoidance { model: model.clone(), gap, margin: 0.1 });
        let goal = Pose::from_translation(Vec3::new(1.5, 0.0, 0.0));
        let objective = TaskObjective::Frame {
            end_effector: robot.tool().into(),
            components: Task::POSITION,
            target: goal.into(),
        };
        let task = MotionTask { gain: 20.0, ..MotionTask::new("ball", objective) };
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
