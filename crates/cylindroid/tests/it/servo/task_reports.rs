//! Reports of many tasks: postures and desired velocities, stops, simulation.

use cylindroid::control::{
    MotionTask, StoppedBy, TaskObjective, TaskReport, TaskServo, TaskServoOptions,
};

use super::*;

/// Two slides along x and y.
fn table(limits: [Limits; 2]) -> Mechanism {
    let mut builder = Mechanism::builder("table");
    let axes = [Vec3::X, Vec3::Y];
    let names = ["rail", "x", "y"];
    for i in 0..2 {
        let mut joint = JointSpec::new(names[i + 1], JointKind::Prismatic, names[i], names[i + 1]);
        (joint.axis, joint.limits) = (axes[i], limits[i]);
        builder.joint(joint);
    }
    builder.build().unwrap()
}

fn limits(acceleration: f64) -> Limits {
    Limits { lower: -1.0, upper: 1.0, velocity: 1.0, acceleration, ..Limits::NONE }
}

fn at(robot: &Mechanism, x: f64, y: f64) -> TaskObjective {
    TaskObjective::Frame {
        end_effector: robot.frame("y").unwrap().into(),
        components: Task::POSITION,
        target: Pose::from_translation(Vec3::new(x, y, 0.0)).into(),
    }
}

fn of_tasks(robot: &Mechanism, tasks: Vec<MotionTask>) -> TaskServo {
    TaskServo::new(robot, tasks, TaskServoOptions::new(robot)).unwrap()
}

fn posture(q: &[f64]) -> MotionTask {
    MotionTask::new("posture", TaskObjective::Posture { q: q.to_vec() })
}

#[test]
fn a_posture_alone_is_reached() {
    let robot = table([limits(5.0); 2]);
    let mut servo = of_tasks(&robot, vec![posture(&[0.3, -0.4])]);
    assert_eq!(servo.step(&[0.0, 0.0]).unwrap(), Status::Moving);
    assert!((servo.reports()[0].position_error - 0.5).abs() < 1e-15);
    assert_eq!(servo.reports()[0].orientation_error, 0.0);
    servo.reset();
    let mut times = Vec::new();
    let result = servo.simulate(&[0.0, 0.0], 10.0, |time, _, _| times.push(time)).unwrap();
    assert_eq!((result.status, times.len()), (Status::Reached, result.steps + 1));
    assert!((result.q[0] - 0.3).hypot(result.q[1] + 0.4) <= 1e-6);
    assert!(result.limits_hit.contains(&(0, LimitKind::Acceleration)));
    assert_eq!(result.nearest, None);
}

/// On their ways the position comes on while the orientation that had arrived gives way, so that the sum of
/// both errors rises for seconds.
#[test]
fn a_sum_of_errors_that_rises_is_no_stall() {
    let from = [-1.76, 0.93, -0.79, -0.98, 2.45, 0.27, 0.87];
    let iiwa14 = ("iiwa14", from, [-1.94, -0.72, -2.41, -1.76, 1.60, 0.12, -0.79], None);
    let from = [1.43, 1.27, -2.25, -0.38, 2.09, 0.43, -2.49];
    let panda = ("panda", from, [2.43, -1.29, 0.34, -2.07, 2.24, 0.33, -1.88], Some(1.05));
    for (name, from, to, reaches) in [iiwa14, panda] {
        let robot = catalogue::load(name).unwrap();
        let mut target = robot.state(&to).unwrap().pose(robot.tool()).unwrap();
        if let Some(reaches) = reaches {
            let far = reaches * robot.reach() / target.translation.norm();
            target.translation = target.translation * far;
        }
        let end_effector = robot.tool().into();
        let objective =
            TaskObjective::Frame { end_effector, components: Task::POSE, target: target.into() };
        let mut servo = of_tasks(&robot, vec![MotionTask::new("hand", objective)]);
        let result = servo.simulate(&from, 20.0, |_, _, _| ()).unwrap();
        assert_eq!(result.status, Status::Reached, "{name}");
    }
}

/// A preference that the pose leaves no room for stalls; the servo has reached its pose.
#[test]
fn a_posture_below_a_pose_does_not_hide_it() {
    let robot = table([limits(5.0); 2]);
    let hand = MotionTask::new("hand", at(&robot, 0.2, 0.1));
    let mut servo = of_tasks(&robot, vec![posture(&[-0.5, -0.5]), hand]);
    let result = servo.simulate(&[0.0, 0.0], 20.0, |_, _, _| ()).unwrap();
    let [posture, hand]: [TaskReport; 2] = result.reports.try_into().unwrap();
    assert_eq!((result.status, hand.status), (Status::Reached, Status::Reached));
    assert_eq!((posture.status, posture.left_out), (Status::Stalled, 1.0));
    assert!((posture.position_error - 0.7_f64.hypot(0.6)).abs() < 1e-5, "{posture:?}");
}

#[test]
fn a_posture_beyond_a_limit_names_it() {
    let robot = table([limits(5.0); 2]);
    let mut servo = of_tasks(&robot, vec![posture(&[1.5, 0.0])]);
    let result = servo.simulate(&[0.0, 0.0], 20.0, |_, _, _| ()).unwrap();
    assert_eq!(result.status, Status::Stalled);
    let expected = StoppedBy::Limit { coordinate: 0, kind: LimitKind::Position };
    assert_eq!(result.reports[0].stopped_by, Some(expected));
}

/// The error of desired velocities is the part that is not realised.
#[test]
fn desired_velocities_report_the_rest() {
    let robot = table([limits(5.0), limits(f64::INFINITY)]);
    let objective = TaskObjective::JointVelocities { velocities: vec![0.3, 2.0] };
    let mut servo = of_tasks(&robot, vec![MotionTask::new("velocities", objective)]);
    assert_eq!(servo.step(&[0.0, 0.0]).unwrap(), Status::Moving);
    let expected = (0.3 - 5.0 * 1e-3_f64).hypot(2.0 - 1.0);
    assert!((servo.reports()[0].position_error - expected).abs() < 1e-12);
    assert!(servo.reports()[0].stopped_by.is_some());
    for _ in 0..100 {
        servo.step(&[0.0, 0.0]).unwrap();
    }
    assert!((servo.reports()[0].position_error - 1.0).abs() < 1e-12);
    let TaskObjective::JointVelocities { velocities } = servo.objective_mut("velocities").unwrap()
    else {
        panic!("velocities")
    };
    velocities[1] = 1.0;
    assert_eq!(servo.step(&[0.0, 0.0]).unwrap(), Status::Reached);
}

/// A slide that still brakes across the way to a new target: the direction changes, and the limit that
/// changes it is named.
#[test]
fn a_limit_across_the_target_is_named() {
    let robot = table([limits(5.0), limits(f64::INFINITY)]);
    let mut servo = of_tasks(&robot, vec![MotionTask::new("hand", at(&robot, 0.9, 0.0))]);
    let mut q = vec![0.0, 0.0];
    for _ in 0..150 {
        servo.step(&q).unwrap();
        servo.advance(&mut q);
    }
    assert!(servo.joint_velocities()[0] > 0.5);
    let target = at(&robot, q[0], 0.1);
    *servo.objective_mut("hand").unwrap() = target;
    servo.step(&q).unwrap();
    let report = servo.reports()[0];
    let expected = StoppedBy::Limit { coordinate: 0, kind: LimitKind::Acceleration };
    assert_eq!((report.scale, report.stopped_by), (0.0, Some(expected)), "{report:?}");
    assert!(servo.joint_velocities()[1] > 0.0);
}

/// One arm is sent out of reach and stopped by its limits: the other one, at the same level, reaches
/// its target in the time that it needs alone.
#[test]
fn a_task_that_limits_stop_does_not_slow_others() {
    let robot = super::tasks::two_armed();
    let q: Vec<f64> = (0..robot.n()).map(|i| 0.6 * f64::from(1 - 2 * (i as i32 % 2))).collect();
    let state = robot.state(&q).unwrap();
    let hand = |name: &str, way: Vec3| {
        let frame = robot.frame(name).unwrap();
        let pose = state.pose(frame).unwrap();
        let target = Pose { translation: pose.translation + way, ..pose };
        let objective = TaskObjective::Frame {
            end_effector: frame.into(),
            components: Task::POSITION,
            target: target.into(),
        };
        MotionTask::new(name, objective)
    };
    let time = |tasks: Vec<MotionTask>| {
        let mut servo = TaskServo::new(&robot, tasks, TaskServoOptions::new(&robot)).unwrap();
        let mut q = q.clone();
        (0..20_000)
            .find(|_| {
                servo.step(&q).unwrap();
                servo.advance(&mut q);
                servo.reports()[0].position_error < 1e-4
            })
            .unwrap()
    };
    let near = || hand("right_6_link", Vec3::new(0.05, -0.05, 0.05));
    let alone = time(vec![near()]);
    let beside = time(vec![near(), hand("left_6_link", Vec3::new(3.0, 0.5, 0.0))]);
    assert!(beside < alone + alone / 4, "{beside} steps instead of {alone}");
}

/// A target that moves away is no stall while the hand follows it, and one at the edge of reach.
#[test]
fn a_target_that_moves_away_is_no_stall() {
    let robot = catalogue::load("panda").unwrap();
    let mut q = robot.home().to_vec();
    let end_effector = robot.tool().into();
    let start = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
    let at = |way: f64| TaskObjective::Frame {
        end_effector,
        components: Task::POSITION,
        target: Pose { translation: start.translation + Vec3::X * way, ..start }.into(),
    };
    let mut options = TaskServoOptions::new(&robot);
    (options.dt, options.acceleration) = (4e-3, 10.0);
    let mut servo =
        TaskServo::new(&robot, vec![MotionTask::new("hand", at(0.0))], options).unwrap();
    let mut stalled = None;
    for step in 0..5000 {
        let way = 0.05 * 4e-3 * f64::from(step);
        *servo.objective_mut("hand").unwrap() = at(way);
        if servo.step(&q).unwrap() == Status::Stalled {
            stalled = stalled.or(Some(way));
        }
        servo.advance(&mut q);
    }
    // The hand reaches about 0.5 m of 1 m.
    let way = stalled.unwrap();
    assert!(way > 0.4 && way < 0.85, "{way}");
    assert_eq!(servo.status(), Status::Stalled);
}

/// Two slides, of which x is slow. A diagonal motion is shortened and stays on its line, or, with
/// least squares, is as near to the asked velocity as the limits permit; the share that is realised
/// is reported, and so is the limit.
#[test]
fn directions_are_kept_or_least_squares_taken() {
    let mut builder = Mechanism::builder("slides");
    for (name, axis, ends, velocity) in
        [("x", Vec3::X, ["base", "beam"], 0.1), ("y", Vec3::Y, ["beam", "tool"], 1.0)]
    {
        let mut joint = JointSpec::new(name, JointKind::Prismatic, ends[0], ends[1]);
        joint.axis = axis;
        joint.limits = Limits { lower: -2.0, upper: 2.0, velocity, ..Limits::NONE };
        builder.joint(joint);
    }
    let robot = builder.build().unwrap();
    let target = Pose::from_translation(Vec3::new(0.1, 0.1, 0.0));
    for (keep_directions, expected, share) in [(true, [0.1, 0.1], 0.2), (false, [0.1, 0.5], 0.6)] {
        let objective = TaskObjective::Frame {
            end_effector: robot.tool().into(),
            components: Task::POSITION,
            target: target.into(),
        };
        let task = MotionTask { gain: 5.0, ..MotionTask::new("tool", objective) };
        let options = TaskServoOptions { keep_directions, ..TaskServoOptions::new(&robot) };
        let mut servo = TaskServo::new(&robot, vec![task], options).unwrap();
        let mut q = vec![0.0; 2];
        servo.step(&q).unwrap();
        for (v, expected) in servo.joint_velocities().iter().zip(expected) {
            // The damping of motions that are bent takes a little.
            assert!((v - expected).abs() < 0.05 * expected, "{keep_directions}: {v}");
        }
        let report = servo.reports()[0];
        assert!((report.scale - share).abs() < 0.02, "{}", report.scale);
        let x = StoppedBy::Limit { coordinate: 0, kind: LimitKind::Velocity };
        assert_eq!(report.stopped_by, Some(x));
        for _ in 0..3000 {
            servo.step(&q).unwrap();
            servo.advance(&mut q);
        }
        assert!(servo.status() == Status::Reached && servo.reports()[0].stopped_by.is_none());
        assert!((servo.reports()[0].scale - 1.0).abs() < 1e-4);
    }
}

/// Before its first step a servo moves, and nothing is left out.
#[test]
fn reports_before_the_first_step() {
    let servo = of_tasks(&table([limits(5.0); 2]), vec![posture(&[0.1, 0.0])]);
    let report = &servo.reports()[0];
    assert_eq!((report.status, report.stopped_by), (Status::Moving, None));
    assert_eq!((report.scale, report.left_out), (1.0, 0.0));
    assert_eq!((report.position_error, report.orientation_error), (0.0, 0.0));
}
