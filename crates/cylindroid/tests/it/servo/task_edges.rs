//! Many tasks at the edge of reach: the robot comes to rest there, and comes back.

use cylindroid::control::{
    LimitKind, MotionTask, StoppedBy, TaskObjective, TaskServo, TaskServoOptions,
};

use super::escape::within;
use super::*;

const DT: f64 = 4e-3;

/// A servo of the pose of the tool.
fn of_pose(robot: &Mechanism, target: Pose, gain: f64, keep_directions: bool) -> TaskServo {
    let objective = TaskObjective::Frame {
        end_effector: robot.tool().into(),
        components: Task::POSE,
        target: target.into(),
    };
    let task = MotionTask { gain, ..MotionTask::new("hand", objective) };
    let options = TaskServoOptions { dt: DT, keep_directions, ..TaskServoOptions::new(robot) };
    TaskServo::new(robot, vec![task], options).unwrap()
}

/// The target of the task.
fn aim(servo: &mut TaskServo, pose: Pose) {
    if let TaskObjective::Frame { target, .. } = servo.objective_mut("hand").unwrap() {
        *target = pose.into();
    }
}

/// The largest change of a joint velocity from step to step in the half second before the end of a stay at
/// the edge, and the error after the way back.
fn out_and_back(servo: &mut TaskServo, q: &mut [f64], pose: Pose, direction: Vec3) -> (f64, f64) {
    let (mut jump, mut last) = (0.0_f64, Vec::new());
    for i in 0..(11.0 / DT) as usize {
        let time = i as f64 * DT;
        let way =
            if time < 5.0 { (time / 2.0).min(1.0) } else { (1.0 - (time - 5.0) / 2.0).max(0.0) };
        aim(servo, Pose { translation: pose.translation + direction * way, ..pose });
        servo.step(q).unwrap();
        servo.advance(q);
        if (4.5..5.0).contains(&time) {
            let pairs = servo.joint_velocities().iter().zip(&last);
            jump = pairs
                .fold(jump, |most, (rate, before): (&f64, &f64)| most.max((rate - before).abs()));
            last = servo.joint_velocities().to_vec();
        }
    }
    (jump, servo.reports()[0].position_error)
}

/// A target leaves reach by a metre along every axis, waits and comes back, with gains from the usual one
/// to the whole error in each step: at the edge no joint swings, and from there almost all return. Those
/// that do not are at limits, which the report names.
fn rests_and_returns(name: &str, least: [usize; 2], quietest: [f64; 2]) {
    let robot = catalogue::load(name).unwrap();
    for ((gain, least), quietest) in [5.0, 1.0 / DT].into_iter().zip(least).zip(quietest) {
        for keep_directions in [true, false] {
            let mut random = Random(191);
            let (mut returned, mut at_limit) = (0, 0);
            let (mut jumps, mut worst) = (0.0_f64, 0.0_f64);
            for _ in 0..5 {
                let start = within(&robot, &mut random);
                let pose = robot.state(&start).unwrap().pose(robot.tool()).unwrap();
                for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
                    for direction in [axis, -axis] {
                        let mut servo = of_pose(&robot, pose, gain, keep_directions);
                        let mut q = start.clone();
                        let (jump, error) = out_and_back(&mut servo, &mut q, pose, direction);
                        let stop = servo.reports()[0].stopped_by;
                        let at_one = matches!(
                            stop,
                            Some(StoppedBy::Limit { kind: LimitKind::Position, .. })
                        );
                        returned += usize::from(error < 1e-3);
                        at_limit += usize::from(error >= 1e-3 && at_one);
                        (jumps, worst) = (jumps.max(jump), worst.max(error));
                    }
                }
            }
            println!(
                "{name}, gain {gain}, {keep_directions}: {returned} of 30, {at_limit} at limits, \
                 {worst:.3} m, {jumps:.3} rad/s"
            );
            assert!(returned >= least, "{name}, gain {gain}, {keep_directions}: {returned} of 30");
            // The curvature of the task takes least squares to the edge.
            let most = if keep_directions { quietest } else { 0.1 };
            assert!(jumps < most, "{name}, gain {gain}, {keep_directions}: {jumps} rad/s");
        }
    }
}

#[test]
fn panda_rests_and_returns() {
    rests_and_returns("panda", [22, 17], [0.1, 0.1]);
}

#[test]
fn ur5e_rests_and_returns() {
    rests_and_returns("ur5e", [29, 28], [0.5, 0.1]);
}

#[test]
fn iiwa14_rests_and_returns() {
    rests_and_returns("iiwa14", [29, 28], [0.1, 0.1]);
}

#[test]
fn puma560_rests_and_returns() {
    rests_and_returns("puma560", [27, 27], [0.5, 0.5]);
}

#[test]
fn youbot_rests_and_returns() {
    rests_and_returns("youbot", [27, 25], [0.2, 0.5]);
}

#[test]
fn arm_3r_rests_and_returns() {
    rests_and_returns("3r", [29, 29], [0.1, 0.1]);
}

/// Beyond reach least squares command the same velocities wherever the robot stands.
#[test]
fn least_squares_do_not_depend_on_the_foundation() {
    let arm = catalogue::load("ur5e").unwrap();
    let mut random = Random(7);
    for _ in 0..20 {
        let foundation = random.pose();
        let mut builder = Mechanism::builder("turned");
        for joint in arm.joints() {
            let [parent, child] = [joint.parent, joint.child].map(|l| &arm.links()[l].name);
            let own = joint.parent_from_joint;
            let is_first = joint.parent == 0;
            builder.joint(JointSpec {
                axis: joint.axis,
                limits: joint.limits,
                parent_from_joint: if is_first { foundation * own } else { own },
                ..JointSpec::new(&joint.name, joint.kind, parent, child)
            });
        }
        let turned = builder.build().unwrap();
        let q = within(&arm, &mut random);
        let link = &arm.links().last().unwrap().name;
        let [rates, others] =
            [(&arm, Pose::IDENTITY), (&turned, foundation)].map(|(robot, base)| {
                let frame = robot.frame(link).unwrap();
                let mut target = arm.state(&q).unwrap().pose(arm.frame(link).unwrap()).unwrap();
                target.translation = target.translation * 2.5;
                let objective = TaskObjective::Frame {
                    end_effector: frame.into(),
                    components: Task::POSE,
                    target: (base * target).into(),
                };
                let options = TaskServoOptions {
                    dt: DT,
                    keep_directions: false,
                    length: 0.8,
                    ..TaskServoOptions::new(robot)
                };
                let tasks = vec![MotionTask::new("hand", objective)];
                let mut servo = TaskServo::new(robot, tasks, options).unwrap();
                servo.step(&q).unwrap();
                servo.joint_velocities().to_vec()
            });
        assert!(rates.iter().any(|rate| rate.abs() > 1e-3));
        for (a, b) in rates.iter().zip(&others) {
            assert!((a - b).abs() < 1e-7, "{rates:?} {others:?}");
        }
    }
}

/// An arm without limits that is almost straight: its target is inside, where the curvature of the task is
/// negative and the linear task asks for hundreds of rad/s.
#[test]
fn straight_arms_without_limits_are_calm() {
    let mut builder = Mechanism::builder("arm");
    for (name, parent, link, x) in
        [("shoulder", "world", "upper", 0.0), ("elbow", "upper", "fore", 0.5)]
    {
        builder.joint(JointSpec {
            parent_from_joint: Pose::from_translation(Vec3::X * x),
            ..JointSpec::new(name, JointKind::Revolute, parent, link)
        });
    }
    builder.frame("tip", "fore", Pose::from_translation(Vec3::X * 0.5));
    builder.tool("tip");
    let robot = builder.build().unwrap();
    for elbow in [0.1, 0.01, 1e-3, 1e-6] {
        for keep_directions in [true, false] {
            let mut q = vec![0.2, elbow];
            let now = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
            let objective = TaskObjective::Frame {
                end_effector: robot.tool().into(),
                components: Task::POSITION,
                target: Pose { translation: now.translation * 0.7, ..now }.into(),
            };
            let options =
                TaskServoOptions { dt: DT, keep_directions, ..TaskServoOptions::new(&robot) };
            let tasks = vec![MotionTask::new("hand", objective)];
            let mut servo = TaskServo::new(&robot, tasks, options).unwrap();
            let mut fastest = 0.0_f64;
            for _ in 0..(20.0 / DT) as usize {
                servo.step(&q).unwrap();
                let rates = servo.joint_velocities().iter();
                fastest = rates.fold(fastest, |most, rate| most.max(rate.abs()));
                servo.advance(&mut q);
            }
            let error = servo.reports()[0].position_error;
            println!("elbow {elbow}, {keep_directions}: {fastest} rad/s, {error} m");
            assert!(fastest < 20.0, "{elbow}, {keep_directions}: {fastest} rad/s");
            assert!(error < 1e-3, "{elbow}, {keep_directions}: {error} m");
        }
    }
}

/// A straight arm whose elbow is at its limit, exactly or almost: its target lies inside, and no velocity
/// leads there. It folds, whatever is kept and whatever tasks are below.
#[test]
fn straight_arms_fold() {
    let mut builder = Mechanism::builder("arm");
    let mut add = |name: &str, parent: &str, link: &str, x: f64, upper: f64| {
        builder.joint(JointSpec {
            parent_from_joint: Pose::from_translation(Vec3::X * x),
            limits: Limits { lower: -2.3, upper, velocity: 2.0, ..Limits::NONE },
            ..JointSpec::new(name, JointKind::Revolute, parent, link)
        });
    };
    add("shoulder", "world", "upper", 0.0, 2.3);
    add("elbow", "upper", "fore", 0.5, 0.0);
    builder.frame("tip", "fore", Pose::from_translation(Vec3::X * 0.5));
    builder.tool("tip");
    let robot = builder.build().unwrap();
    let straight = robot.state(&[0.2, 0.0]).unwrap().pose(robot.tool()).unwrap();
    let target = Pose { translation: straight.translation * 0.7, ..straight };
    for start in [0.0, -1e-12, -1e-9, -1e-6, -1e-3] {
        for keep_directions in [true, false] {
            for has_posture in [true, false] {
                let objective = TaskObjective::Frame {
                    end_effector: robot.tool().into(),
                    components: Task::POSITION,
                    target: target.into(),
                };
                let mut tasks = vec![MotionTask::new("hand", objective)];
                if has_posture {
                    let posture = TaskObjective::Posture { q: vec![0.0, -1.0] };
                    tasks.push(MotionTask::new("rest", posture));
                }
                let options =
                    TaskServoOptions { dt: DT, keep_directions, ..TaskServoOptions::new(&robot) };
                let mut servo = TaskServo::new(&robot, tasks, options).unwrap();
                let result = servo.simulate(&[0.2, start], 10.0, |_, _, _| {}).unwrap();
                let of = format!("{start:e}, {keep_directions}, {has_posture}: {result:?}");
                assert!(result.reports[0].position_error < 1e-3, "{of}");
            }
        }
    }
}

/// Slow joints are not lost in a saddle: the tool goes straight to its target, however long it takes.
#[test]
fn slow_joints_do_not_escape() {
    let slow = Limits { velocity: 2e-3, acceleration: 1.0, ..Limits::NONE };
    let mut random = Random(192);
    let mut straight = 0;
    for _ in 0..20 {
        let mut builder = Mechanism::builder("arm");
        for i in 0..2 {
            let (parent, link) = (format!("l{i}"), format!("l{}", i + 1));
            builder.joint(JointSpec {
                parent_from_joint: Pose::from_translation(Vec3::X * f64::from(i)),
                limits: slow,
                ..JointSpec::new(&format!("q{i}"), JointKind::Revolute, &parent, &link)
            });
        }
        builder.frame("tip", "l2", Pose::from_translation(Vec3::X));
        builder.tool("tip");
        let robot = builder.build().unwrap();
        let mut q = vec![random.within(-3.0, 3.0), random.within(0.3, 2.5)];
        let end = [random.within(-3.0, 3.0), random.within(0.3, 2.5)];
        let tip = |q: &[f64]| robot.state(q).unwrap().pose(robot.tool()).unwrap();
        let target = tip(&end);
        for keep_directions in [true, false] {
            let objective = TaskObjective::Frame {
                end_effector: robot.tool().into(),
                components: Task::POSITION,
                target: target.into(),
            };
            let tasks = vec![MotionTask::new("hand", objective)];
            let options =
                TaskServoOptions { dt: DT, keep_directions, ..TaskServoOptions::new(&robot) };
            let mut servo = TaskServo::new(&robot, tasks, options).unwrap();
            let distance = |q: &[f64]| (tip(q).translation - target.translation).norm();
            let (way, mut last) = (target.translation - tip(&q).translation, distance(&q));
            for step in 0..1000 {
                servo.step(&q).unwrap();
                servo.advance(&mut q);
                let now = distance(&q);
                assert!(now < last, "{keep_directions}, step {step}: {last} to {now} m");
                last = now;
            }
            let left = target.translation - tip(&q).translation;
            let aside = way.cross(left).norm() / way.norm();
            // Long ways of bent arms leave the line on purpose: nothing is scaled then.
            if keep_directions && servo.reports()[0].scale > 0.0 {
                assert!(aside < 1e-6, "{aside} m beside the straight line");
                straight += 1;
            }
        }
    }
    assert!(straight >= 14, "{straight} of 20");
}
