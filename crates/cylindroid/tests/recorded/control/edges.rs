//! Servos of many tasks in steps so long that they stall after a few: at the edge of reach, at saddles,
//! at limits, and on the way back.

use cylindroid::control::{MotionTask, PoseTolerance, TaskObjective, TaskServo, TaskServoOptions};
use cylindroid::{Mechanism, Pose, Twist};

use super::servo::task;
use super::tasks::{move_targets, note};
use super::world::obstacles;
use super::{Watch, any_robot, fail, few_joints, of_twist, singular, sum};
use crate::record::{Record, check};
use crate::robots::{Random, of_catalogue, robot};

fn options(robot: &Mechanism, random: &mut Random<'_>) -> TaskServoOptions {
    let mut options = TaskServoOptions::new(robot);
    options.dt = random.within(0.03, 0.08);
    options.acceleration = [f64::INFINITY, random.power(0.0, 1.5)][random.below(2)];
    if random.once_in(3) {
        options.jerk = random.power(1.0, 2.5);
    }
    options.keep_directions = random.once_in(2);
    options
}

/// Poses of the tool, or parts of them, that may be out of reach.
fn frames(robot: &Mechanism, q: &[f64], dt: f64, random: &mut Random<'_>) -> Vec<MotionTask> {
    let pose = robot.state(q).unwrap().pose(robot.tool()).unwrap();
    let size = robot.reach() * random.power(-1.5, 0.5);
    let tolerance = 10.0_f64.powi(-2 - random.below(2) as i32);
    let one = |i: usize, random: &mut Random<'_>| {
        let away = Pose { translation: random.vec3(size), ..random.pose(1.0) };
        let target = match random.below(3) {
            0 => Pose { translation: pose.translation + away.translation, ..pose },
            1 => Pose { rotation: away.rotation * pose.rotation, ..pose },
            _ => Pose { rotation: away.rotation, translation: pose.translation + away.translation },
        };
        let objective = TaskObjective::Frame {
            end_effector: robot.tool().into(),
            components: task(random),
            target: target.into(),
        };
        MotionTask {
            gain: random.within(0.1, 0.8) / dt,
            tolerance: PoseTolerance { position: tolerance, orientation: tolerance },
            ..MotionTask::new(&format!("{i}"), objective)
        }
        .at_level(i / 2)
    };
    (0..1 + random.below(3)).map(|i| one(i, random)).collect()
}

fn until_at_rest(robot: &Mechanism, random: &mut Random<'_>, record: &mut Record) {
    let q = if random.once_in(2) { singular(robot, random) } else { random.configuration(robot) };
    let options = options(robot, random);
    let tasks = frames(robot, &q, options.dt, random);
    let mut servo = match TaskServo::new(robot, tasks, options) {
        Ok(servo) => servo,
        Err(error) => return fail(record, &error),
    };
    let back = random.vec3(0.3 * robot.reach());
    let mut watch = Watch::new(servo.dt());
    let mut q = q;
    for step in 1..=81 {
        if step == 55 {
            move_targets(&mut servo, back, &q);
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
fn edges_of_arms() {
    check("control_edges_arms", 40, |random, record| {
        let robot = of_catalogue(random, false);
        until_at_rest(&robot, random, record);
    });
}

#[test]
fn edges_of_few_joints() {
    check("control_edges_few", 60, |random, record| {
        let robot = few_joints(random);
        until_at_rest(&robot, random, record);
    });
}

#[test]
fn edges_of_random_robots() {
    check("control_edges_random", 40, |random, record| {
        let robot = any_robot(random);
        until_at_rest(&robot, random, record);
    });
}

/// Twists that tasks follow, with new ones from time to time, to the end of the last.
#[test]
fn twists_of_tasks() {
    check("control_edges_twists", 50, |random, record| {
        let robot = any_robot(random);
        let q = random.configuration(&robot);
        let options = options(&robot, random);
        let (dt, reach) = (options.dt, robot.reach());
        let tasks = frames(&robot, &q, dt, random);
        let count = tasks.len();
        let mut servo = match TaskServo::new(&robot, tasks, options) {
            Ok(servo) => servo,
            Err(error) => return fail(record, &error),
        };
        let (mut watch, mut q) = (Watch::new(dt), q);
        for step in 0..54 {
            if step % 9 == 0 && step < 36 {
                let name = random.below(count).to_string();
                let twist = Twist { linear: random.vec3(reach), angular: random.vec3(1.0) };
                let timeout = dt * [1.0, 7.5, 20.0, f64::INFINITY][random.below(4)];
                servo.command_twist(&name, twist, timeout).unwrap();
            }
            if let Err(error) = servo.step(&q) {
                return fail(record, &error);
            }
            let commands = (0..count).map(|i| servo.commanded_twist(&i.to_string()).unwrap());
            record.number(commands.flatten().map(of_twist).sum());
            note(&servo, &mut watch, record);
            servo.advance(&mut q);
        }
        record.number(sum(&q));
        watch.end(record);
    });
}

/// Fast bodies that slide along others, with jerks so small that retreats take time.
#[test]
fn slow_retreats() {
    check("control_edges_retreats", 50, |random, record| {
        let robot = robot(random, true);
        let q = random.configuration(&robot);
        let mut options = options(&robot, random);
        options.jerk = random.power(0.5, 2.0);
        options.collisions = Some(obstacles(&robot, &q, random));
        let dt = options.dt;
        let mut tasks = frames(&robot, &q, dt, random);
        tasks.iter_mut().for_each(|task| task.gain = 0.9 / dt);
        let mut servo = match TaskServo::new(&robot, tasks, options) {
            Ok(servo) => servo,
            Err(error) => return fail(record, &error),
        };
        let (mut watch, mut q) = (Watch::new(dt), q);
        let way = random.vec3(0.1 * robot.reach());
        for step in 0..54 {
            if step % 13 == 12 {
                move_targets(&mut servo, way, &q);
            }
            if let Err(error) = servo.step(&q) {
                return fail(record, &error);
            }
            note(&servo, &mut watch, record);
            servo.advance(&mut q);
        }
        record.number(sum(&q));
        watch.end(record);
    });
}
