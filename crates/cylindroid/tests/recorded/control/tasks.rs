//! Servos of many tasks: all objectives and options, reports step by step.

use cylindroid::control::{
    MotionTask, PoseTolerance, StoppedBy, Target, TaskMotionResult, TaskObjective, TaskReport,
    TaskServo, TaskServoOptions, goals_of,
};
use cylindroid::{EndEffector, Mechanism, Pose, Twist, Vec3};

use super::closed::four_bar;
use super::servo::{plant, target, task};
use super::world::{Curve, obstacles, walls};
use super::{Watch, any_robot, fail, mixed_robot, of_limits, sum};
use crate::record::{Record, check};
use crate::robots::{Random, five_bar, of_catalogue, robot, spatial_loop};

fn end_effector(robot: &Mechanism, random: &mut Random<'_>) -> EndEffector {
    let all = robot.frames();
    let frame = robot.frame(&all[random.below(all.len())].name).unwrap();
    match random.below(3) {
        0 => EndEffector { frame_from_tool: random.pose(0.1 * robot.reach()), ..frame.into() },
        1 if !robot.is_closed() => robot.tool().into(),
        _ => frame.into(),
    }
}

fn velocities(robot: &Mechanism, random: &mut Random<'_>) -> Vec<f64> {
    (0..robot.n()).map(|_| random.within(-1.0, 1.0)).collect()
}

fn objective(robot: &Mechanism, q: &[f64], random: &mut Random<'_>) -> TaskObjective {
    let end_effector = end_effector(robot, random);
    let components = task(random);
    let size = robot.reach();
    match random.below(14) {
        0 => TaskObjective::Gaze { end_effector, point: random.vec3(3.0 * size) },
        1 => TaskObjective::Posture { q: random.configuration(robot) },
        2 => TaskObjective::JointVelocities { velocities: velocities(robot, random) },
        3 if robot.check_masses().is_ok() => TaskObjective::CenterOfMass {
            axes: std::array::from_fn(|_| random.once_in(2)),
            target: random.vec3(0.5 * size),
            velocity: random.vec3(0.1 * size),
        },
        4 => TaskObjective::RelativeFrame {
            end_effector,
            reference: robot.tool().into(),
            components,
            target: random.pose(0.3 * size),
        },
        5 if !robot.is_closed() => TaskObjective::Manipulability { end_effector, components },
        6 => TaskObjective::LimitAvoidance { margin: random.within(0.05, 0.5) },
        7 => TaskObjective::Custom(Box::new(Curve {
            rows: 1 + random.below(3),
            level: random.within(-1.0, 1.0),
        })),
        _ => {
            let pose = target(robot, q, random);
            let twist = Twist { linear: random.vec3(0.2 * size), angular: random.vec3(0.3) };
            let feed_forward = if random.once_in(3) { twist } else { Twist::ZERO };
            let target = Target { pose, feed_forward };
            TaskObjective::Frame { end_effector, components, target }
        }
    }
}

fn tasks(robot: &Mechanism, q: &[f64], dt: f64, random: &mut Random<'_>) -> Vec<MotionTask> {
    let one = |i: usize, random: &mut Random<'_>| {
        let size = random.power(-4.0, -1.0);
        MotionTask {
            weight: [1.0, random.power(-2.0, 2.0)][random.below(2)],
            gain: [0.0, 1.0, 1.0, 1.0][random.below(4)] * random.power(-1.3, 0.0) / dt,
            tolerance: PoseTolerance { position: size, orientation: size },
            ..MotionTask::new(&format!("{i}"), objective(robot, q, random))
        }
        .at_level(random.below(3))
    };
    (0..1 + random.below(5)).map(|i| one(i, random)).collect()
}

fn options(robot: &Mechanism, random: &mut Random<'_>) -> TaskServoOptions {
    let mut options = TaskServoOptions::new(robot);
    options.dt = random.power(-2.5, -1.3);
    options.length *= random.power(-0.5, 0.5);
    options.acceleration = [f64::INFINITY, random.power(-0.5, 2.0)][random.below(2)];
    if random.once_in(4) {
        options.jerk = random.power(0.5, 3.5);
    }
    if random.once_in(3) {
        options.joint_weights = (0..robot.n()).map(|_| random.power(-1.5, 1.5)).collect();
    }
    options.keep_directions = random.once_in(2);
    if random.once_in(3) {
        options.eps = random.power(-4.0, -0.5);
    }
    options
}

fn stopped_by(stop: Option<StoppedBy>) -> String {
    match stop {
        None => "-".to_owned(),
        Some(StoppedBy::Limit { coordinate, kind }) => format!("{coordinate}{}", &kind.name()[..1]),
        Some(StoppedBy::Distance { pair }) => format!("d{pair}"),
        Some(StoppedBy::HalfSpace { index }) => format!("h{index}"),
        Some(StoppedBy::TypeII) => "t".to_owned(),
    }
}

fn of_reports(reports: &[TaskReport]) -> (String, [f64; 2]) {
    let word = |r: &TaskReport| format!("{}{}", &r.status.name()[..1], stopped_by(r.stopped_by));
    let words: Vec<String> = reports.iter().map(word).collect();
    let shares: Vec<f64> = reports.iter().flat_map(|r| [r.scale, r.left_out]).collect();
    let errors: Vec<f64> =
        reports.iter().flat_map(|r| [r.position_error, r.orientation_error]).collect();
    (words.join("."), [sum(&shares), sum(&errors)])
}

pub(super) fn note(servo: &TaskServo, watch: &mut Watch, record: &mut Record) {
    let (word, [shares, errors]) = of_reports(servo.reports());
    let limits = of_limits(servo.active_limits());
    let near: Vec<f64> = servo.near().iter().map(|n| n.distance).collect();
    let word = format!("{}.{word}.{}.{}", &servo.status().name()[..1], limits, near.len());
    watch.note(record, &word, &[sum(servo.joint_velocities()), shares, errors, sum(&near)]);
}

pub(super) fn servo_of(
    robot: &Mechanism,
    tasks: Vec<MotionTask>,
    options: TaskServoOptions,
    record: &mut Record,
) -> Option<TaskServo> {
    match TaskServo::new(robot, tasks, options) {
        Ok(servo) => Some(servo),
        Err(error) => {
            fail(record, &error);
            None
        }
    }
}

/// Moves the targets of all tasks that have one.
pub(super) fn move_targets(servo: &mut TaskServo, way: Vec3, q: &[f64]) {
    for i in 0..servo.tasks().len() {
        match servo.objective_mut(&format!("{i}")).unwrap() {
            TaskObjective::Frame { target, .. } => target.pose.translation += way,
            TaskObjective::RelativeFrame { target, .. } => target.translation += way,
            TaskObjective::CenterOfMass { target, .. } => *target += way,
            TaskObjective::Gaze { point, .. } => *point += way,
            TaskObjective::Posture { q: posture } => posture.copy_from_slice(q),
            _ => {}
        }
    }
}

/// Steps in which targets jump or move on, the servo is reset, and the robot is pushed.
fn steps(mut servo: TaskServo, mut q: Vec<f64>, random: &mut Random<'_>, record: &mut Record) {
    let (way, every) = (random.vec3(0.02), [1, 7, 100][random.below(3)]);
    let place = random.pose(0.5);
    let mut watch = Watch::new(servo.dt());
    for step in 1..33 {
        if step % every == 0 {
            move_targets(&mut servo, way, &q);
        }
        if step == 21 && random.once_in(4) {
            servo.reset();
        }
        if step == 12 && random.once_in(5) && !servo.mechanism().is_closed() {
            q.iter_mut().for_each(|x| *x += random.within(-0.05, 0.05));
        }
        if let Some(model) = servo.collision_model_mut().filter(|_| step == 5 && every == 7) {
            model.move_obstacle("o0", place).unwrap();
        }
        if let Err(error) = servo.step(&q) {
            return fail(record, &error);
        }
        note(&servo, &mut watch, record);
        servo.advance(&mut q);
    }
    record.number(sum(&q));
    watch.end(record);
}

#[test]
fn objectives() {
    check("control_tasks", 120, |random, record| {
        let robot = any_robot(random);
        let q = random.configuration(&robot);
        let options = options(&robot, random);
        let tasks = tasks(&robot, &q, options.dt, random);
        let Some(servo) = servo_of(&robot, tasks, options, record) else { return };
        steps(servo, q, random, record);
    });
}

#[test]
fn half_spaces() {
    check("control_tasks_walls", 60, |random, record| {
        let robot = any_robot(random);
        let q = random.configuration(&robot);
        let mut options = options(&robot, random);
        options.half_spaces = walls(&robot, &q, random);
        let tasks = tasks(&robot, &q, options.dt, random);
        let Some(servo) = servo_of(&robot, tasks, options, record) else { return };
        record.word(&servo.half_spaces().len());
        steps(servo, q, random, record);
    });
}

#[test]
fn distances() {
    check("control_tasks_distances", 60, |random, record| {
        let robot = robot(random, true);
        let q = random.configuration(&robot);
        let mut options = options(&robot, random);
        let collisions = obstacles(&robot, &q, random);
        options.collisions = Some(collisions);
        let tasks = tasks(&robot, &q, options.dt, random);
        let Some(servo) = servo_of(&robot, tasks, options, record) else { return };
        steps(servo, q, random, record);
    });
}

fn of_simulation(record: &mut Record, result: &TaskMotionResult) {
    let (word, shares) = of_reports(&result.reports);
    let nearest = result.nearest.map_or(0.0, |near| near.distance);
    record.number(sum(&[result.time, sum(&shares), sum(&result.q), nearest]));
    record.word(&(result.status.name(), word));
    record.word(&of_limits(result.limits_hit.iter().copied()));
}

/// Robots that lag, until nothing moves.
#[test]
fn simulations() {
    check("control_tasks_lag", 60, |random, record| {
        let robot = if random.once_in(4) { mixed_robot(random) } else { any_robot(random) };
        let q = random.configuration(&robot);
        let mut options = options(&robot, random);
        options.dt = random.within(0.02, 0.05);
        if !random.once_in(3) {
            options.plant = plant(options.dt, random);
        }
        let duration = 60.0 * options.dt;
        let tasks = tasks(&robot, &q, options.dt, random);
        let Some(mut servo) = servo_of(&robot, tasks, options, record) else { return };
        let mut watch = Watch::new(servo.dt());
        match servo.simulate(&q, duration, |_, _, servo| note(servo, &mut watch, record)) {
            Ok(result) => of_simulation(record, &result),
            Err(error) => fail(record, &error),
        }
        watch.end(record);
    });
}

pub(super) fn closed_chain(random: &mut Random<'_>) -> Mechanism {
    match random.below(5) {
        0 => five_bar(random),
        1 => spatial_loop(random),
        2 => four_bar(random),
        _ => of_catalogue(random, true),
    }
}

#[test]
fn closed_chains() {
    check("control_tasks_closed", 40, |random, record| {
        let robot = closed_chain(random);
        let q = robot.home().to_vec();
        let mut options = options(&robot, random);
        if robot.name() == "five-bar" || robot.name() == "loop" {
            let collisions = obstacles(&robot, &q, random);
            options.collisions = Some(collisions);
        }
        match random.below(4) {
            0 => options.half_spaces = walls(&robot, &q, random),
            1 => options.plant = plant(options.dt, random),
            _ => {}
        }
        let tasks = tasks(&robot, &q, options.dt, random);
        let Some(servo) = servo_of(&robot, tasks, options, record) else { return };
        steps(servo, q, random, record);
    });
}

/// Changes one thing to a value at the border of what is permitted, or beyond.
fn break_something(
    tasks: &mut [MotionTask],
    options: &mut TaskServoOptions,
    random: &mut Random<'_>,
) {
    let bad = [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-3][random.below(5)];
    let (i, dt) = (random.below(tasks.len()), options.dt);
    match random.below(14) {
        0 => options.dt = bad,
        1 => options.length = bad,
        2 => options.acceleration = bad,
        3 => options.jerk = bad,
        4 => options.eps = [bad, 1.0, 0.999][random.below(3)],
        5 => options.plant.delay = [999.5 * dt, 1000.5 * dt][random.below(2)],
        6 => options.joint_weights = vec![bad; 3],
        7 => tasks[i].weight = bad,
        8 => tasks[i].gain = [bad, 1.99 / dt, 2.0 / dt, 2.01 / dt][random.below(4)],
        9 => tasks[i].name = "0".to_owned(),
        10 => {
            let rows = [0, 1000, 1001][random.below(3)];
            tasks[i].objective = TaskObjective::Custom(Box::new(Curve { rows, level: bad }));
        }
        11 => tasks[i].objective = TaskObjective::Posture { q: vec![bad] },
        12 => tasks[i].objective = TaskObjective::LimitAvoidance { margin: bad },
        _ => {
            if let TaskObjective::Frame { target, .. } = &mut tasks[i].objective {
                target.pose.translation.x = bad;
            }
        }
    }
}

#[test]
fn options_are_checked() {
    check("control_tasks_options", 50, |random, record| {
        let robot = robot(random, false);
        let q = random.configuration(&robot);
        let mut options = options(&robot, random);
        let mut tasks = tasks(&robot, &q, options.dt, random);
        break_something(&mut tasks, &mut options, random);
        if random.once_in(2) {
            let is_goal = |task: &MotionTask| {
                use TaskObjective::{Custom, JointVelocities};
                !matches!(task.objective, JointVelocities { .. } | Custom(_))
            };
            tasks.retain(is_goal);
        }
        match goals_of(&tasks) {
            Ok(goals) => {
                record.word(&(
                    goals.goals.len(),
                    goals.posture.is_some(),
                    goals.criterion.is_some(),
                ));
            }
            Err(error) => fail(record, &error),
        }
        let Some(mut servo) = servo_of(&robot, tasks, options, record) else { return };
        if random.once_in(6) {
            // Of a servo that was made without masses, or for another number of rows.
            let (target, velocity) = (Vec3::X, Vec3::ZERO);
            let center = TaskObjective::CenterOfMass { axes: [true; 3], target, velocity };
            *servo.objective_mut("0").unwrap() = center;
        }
        match servo.step(&q) {
            Ok(status) => {
                record.word(&status);
                record.number(sum(servo.joint_velocities()));
            }
            Err(error) => fail(record, &error),
        }
    });
}

/// A target that the first step finds far beyond all numbers of robots.
#[test]
fn far_targets() {
    check("control_tasks_far", 16, |random, record| {
        let robot = of_catalogue(random, false);
        let q = random.configuration(&robot);
        let options = options(&robot, random);
        let pose = Pose { translation: random.vec3(1e3), ..random.pose(1.0) };
        let frame = |components| TaskObjective::Frame {
            end_effector: robot.tool().into(),
            components,
            target: pose.into(),
        };
        let tasks =
            (0..2).map(|i| MotionTask::new(&format!("{i}"), frame(task(random))).at_level(i));
        let tasks = tasks.collect();
        let Some(servo) = servo_of(&robot, tasks, options, record) else { return };
        steps(servo, q, random, record);
    });
}
