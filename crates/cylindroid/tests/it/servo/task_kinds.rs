//! Tasks and inequalities of a servo of many tasks: gradients, velocities of the centre of mass,
//! half-spaces and boxes.

use cylindroid::control::{
    HalfSpace, MotionTask, StoppedBy, TaskObjective, TaskServo, TaskServoOptions,
};
use cylindroid::kinematics::MassMatrix;

use super::*;

fn hand(robot: &Mechanism, components: Task, target: Pose) -> MotionTask {
    let end_effector = robot.tool().into();
    MotionTask::new(
        "hand",
        TaskObjective::Frame { end_effector, components, target: target.into() },
    )
}

/// With the hand at its pose, manipulability grows and joints move away from their limits.
#[test]
fn gradients_climb() {
    let robot = catalogue::load("panda").unwrap();
    let q = vec![0.4, -0.4, 0.3, -2.0, 0.9, 1.2, 2.7];
    let pose = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
    let volume = |q: &[f64]| {
        let j = robot
            .state(q)
            .unwrap()
            .jacobian(robot.tool(), ReferenceFrame::LocalWorldAligned)
            .unwrap();
        Svd::of(&j).values().product::<f64>()
    };
    let nearest_limit = |q: &[f64]| {
        let all = q.iter().zip(robot.coordinates());
        let part = |x: f64, l: &Limits| (l.upper - x).min(x - l.lower) / (l.upper - l.lower);
        all.map(|(x, c)| part(*x, &c.limits)).fold(f64::INFINITY, f64::min)
    };
    let gradients = [
        TaskObjective::Manipulability { end_effector: robot.tool().into(), components: Task::POSE },
        TaskObjective::LimitAvoidance { margin: 0.2 },
    ];
    for (kind, gradient) in gradients.into_iter().enumerate() {
        let tasks = vec![hand(&robot, Task::POSE, pose), MotionTask::new("gradient", gradient)];
        let mut options = TaskServoOptions::new(&robot);
        options.length = 1.0;
        let mut servo = TaskServo::new(&robot, tasks, options).unwrap();
        let mut moved = q.clone();
        for _ in 0..3000 {
            servo.step(&moved).unwrap();
            servo.advance(&mut moved);
        }
        let error = robot.state(&moved).unwrap().pose(robot.tool()).unwrap().error_to(pose);
        assert!(error.linear.norm() < 1e-5 && error.angular.norm() < 1e-5);
        let (before, after) = match kind {
            0 => (volume(&q), volume(&moved)),
            _ => (nearest_limit(&q), nearest_limit(&moved)),
        };
        assert!(after > 1.03 * before, "{kind}: {before} {after}");
        let report = servo.reports()[1];
        assert!(report.scale == 1.0 && report.stopped_by.is_none());
    }
}

/// Gradients of the manipulability of closed chains are those of the cut tree, and refused.
#[test]
fn gradients_of_loops_are_refused() {
    let mechanism = catalogue::load("two-arm").unwrap();
    let end_effector = ServoOptions::new(&mechanism).end_effector;
    let objective = TaskObjective::Manipulability { end_effector, components: Task::POSE };
    let tasks = vec![MotionTask::new("gradient", objective)];
    let error = TaskServo::new(&mechanism, tasks, TaskServoOptions::new(&mechanism)).unwrap_err();
    assert!(error.to_string().contains("loops"), "{error}");
}

/// With a gain of zero the centre of mass and a frame have the velocities of their feed-forward.
#[test]
fn a_gain_of_zero_leaves_the_velocity() {
    let robot = super::tasks::two_armed();
    let mut masses = MassMatrix::new(&robot);
    let mut center = |q: &[f64]| {
        let state = robot.state(q).unwrap();
        masses.center_of_mass(&state, &mut Matrix::zeros(3, robot.n())).unwrap().1
    };
    let mut q: Vec<f64> = (0..robot.n()).map(|i| 0.6 * f64::from(1 - 2 * (i as i32 % 2))).collect();
    let start = center(&q);
    let velocity = Vec3::new(0.02, -0.01, 0.015);
    let objective =
        TaskObjective::CenterOfMass { axes: [true; 3], target: Vec3::X * 100.0, velocity };
    let task = MotionTask { gain: 0.0, ..MotionTask::new("center", objective) };
    let mut options = TaskServoOptions::new(&robot);
    options.dt = 1e-3;
    let mut servo = TaskServo::new(&robot, vec![task], options).unwrap();
    for _ in 0..500 {
        servo.step(&q).unwrap();
        servo.advance(&mut q);
    }
    let way = center(&q) - start;
    assert!((way - velocity * 0.5).norm() < 1e-4, "{way:?}");
}

/// A hand sent through a wall, and out of a box, stops at it, names it and never passes; a task along
/// the wall goes on.
#[test]
fn half_spaces_are_not_left() {
    let mut random = Random(8);
    for (name, acceleration) in [("panda", 5.0), ("ur5e", f64::INFINITY), ("puma560", 20.0)] {
        let robot = catalogue::load(name).unwrap();
        for _ in 0..6 {
            let home: Vec<f64> =
                robot.home().iter().map(|x| x + 0.1 * random.within(-1.0, 1.0)).collect();
            let pose = robot.state(&home).unwrap().pose(robot.tool()).unwrap();
            let center = Pose {
                rotation: Rotation::exp(Vec3::new(0.3, random.within(-1.0, 1.0), 0.4)),
                translation: pose.translation,
            };
            let size = Vec3::new(0.1, 0.14, 0.2);
            let walls = HalfSpace::inside_box("box", robot.tool().into(), center, size);
            let outwards = center.rotation * Vec3::new(1.0, 0.1, 0.0);
            let target = Pose { translation: pose.translation + outwards * 0.2, ..pose };
            let mut options = TaskServoOptions::new(&robot);
            (options.dt, options.acceleration) = (2e-3, acceleration);
            options.half_spaces = walls.to_vec();
            let task = hand(&robot, Task::POSITION, target);
            let mut servo = TaskServo::new(&robot, vec![task], options).unwrap();
            let mut deepest = f64::INFINITY;
            let result = servo.simulate(&home, 30.0, |_, q, _| {
                let tool = robot.state(q).unwrap().pose(robot.tool()).unwrap().translation;
                for wall in &walls {
                    deepest = deepest.min(wall.normal.dot(tool - wall.point));
                }
            });
            let result = result.unwrap();
            // Without an acceleration limit velocities jump: what bends in that step is not seen.
            let allowed = if acceleration < f64::INFINITY { 0.0 } else { 1e-5 };
            assert!(deepest >= -allowed, "{name}: {deepest:e}");
            assert_eq!(result.status, Status::Stalled, "{name}");
            let report = result.reports[0];
            assert_eq!(report.stopped_by, Some(StoppedBy::HalfSpace { index: 1 }), "{name}");
            // Along the wall it went on: 0.15 m beyond the wall are left.
            assert!((report.position_error - 0.15).abs() < 5e-3, "{name}: {report:?}");
        }
    }
}

/// Nor with limits of the jerk: joints that speed up towards a wall go on doing so for a while.
#[test]
fn half_spaces_are_not_left_with_limits_of_the_jerk() {
    for name in ["ur5e", "panda", "puma560", "iiwa14"] {
        let robot = catalogue::load(name).unwrap();
        let home = robot.home().to_vec();
        let pose = robot.state(&home).unwrap().pose(robot.tool()).unwrap();
        for outwards in [Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Z] {
            for (jerk, keep_directions) in
                [(20.0, true), (50.0, false), (50.0, true), (500.0, true)]
            {
                let mut options = TaskServoOptions::new(&robot);
                (options.dt, options.jerk) = (2e-3, jerk);
                options.keep_directions = keep_directions;
                let wall = HalfSpace {
                    name: "wall".to_owned(),
                    end_effector: robot.tool().into(),
                    point: pose.translation + outwards * 0.1,
                    normal: -outwards,
                };
                options.half_spaces = vec![wall.clone()];
                let target = Pose { translation: pose.translation + outwards * 0.4, ..pose };
                let tasks = vec![hand(&robot, Task::POSITION, target)];
                let mut servo = TaskServo::new(&robot, tasks, options).unwrap();
                let mut deepest = f64::INFINITY;
                let result = servo.simulate(&home, 8.0, |_, q, _| {
                    let tool = robot.state(q).unwrap().pose(robot.tool()).unwrap().translation;
                    deepest = deepest.min(wall.normal.dot(tool - wall.point));
                });
                result.unwrap();
                // The Puma 560 has limits of three joints only, and passes by up to 0.47 mm.
                let allowed = if name == "puma560" { 5e-4 } else { 1e-12 };
                let case = format!("{name} {outwards:?} {jerk} {keep_directions}");
                assert!(deepest >= -allowed, "{case}: {deepest:e}");
            }
        }
    }
}

/// A start outside is not moved further out, and comes back if the task asks for it.
#[test]
fn a_start_outside_comes_back() {
    let robot = catalogue::load("panda").unwrap();
    let q = robot.home().to_vec();
    let pose = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
    let wall = HalfSpace {
        name: "wall".to_owned(),
        end_effector: robot.tool().into(),
        point: pose.translation - Vec3::X * 0.05,
        normal: Vec3::ZERO - Vec3::X * 3.0,
    };
    for (way, reached) in [(-0.1, true), (0.1, false)] {
        let target = Pose { translation: pose.translation + Vec3::X * way, ..pose };
        let mut options = TaskServoOptions::new(&robot);
        options.half_spaces = vec![wall.clone()];
        let tasks = vec![hand(&robot, Task::POSITION, target)];
        let mut servo = TaskServo::new(&robot, tasks, options).unwrap();
        let mut furthest = f64::NEG_INFINITY;
        let result = servo.simulate(&q, 20.0, |_, q, _| {
            furthest =
                furthest.max(robot.state(q).unwrap().pose(robot.tool()).unwrap().translation.x);
        });
        assert!(furthest < pose.translation.x + 1e-6);
        assert_eq!(result.unwrap().status == Status::Reached, reached);
    }
}

/// Half-spaces without a direction and of other mechanisms are refused by name.
#[test]
fn half_spaces_are_checked() {
    let robot = catalogue::load("panda").unwrap();
    let wall = HalfSpace {
        name: "wall".to_owned(),
        end_effector: robot.tool().into(),
        point: Vec3::ZERO,
        normal: Vec3::ZERO,
    };
    let mut options = TaskServoOptions::new(&robot);
    options.half_spaces = vec![wall.clone()];
    let error = TaskServo::new(&robot, Vec::new(), options.clone()).unwrap_err().to_string();
    assert!(error.contains("wall") && error.contains("normal"), "{error}");
    options.half_spaces = vec![HalfSpace { normal: Vec3::X, point: Vec3::X * f64::NAN, ..wall }];
    let error = TaskServo::new(&robot, Vec::new(), options).unwrap_err().to_string();
    assert!(error.contains("wall") && error.contains("point"), "{error}");
}
