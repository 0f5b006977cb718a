//! Servos of many tasks in steps so long that they stall after a few: at the edge of reach, at saddles,
//! at limits, and on the way back.

use cylindroid::control::{MotionTask, PoseTolerance, TaskObjective, TaskServo, TaskServoOptions};
use cylindroid::{Mechanism, Pose, Twist};

use super::servo::task;
use super::tasks::{closed_chain, move_targets, note, servo_of};
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

/// Poses of the tool or the reference of a closed chain, or parts of them, that may be out of reach.
fn frames(robot: &Mechanism, q: &[f64], dt: f64, random: &mut Random<'_>) -> Vec<MotionTask> {
    let frame = if robot.is_closed() { robot.reference() } else { robot.tool() };
    let pose = robot.state(q).unwrap().pose(frame).unwrap();
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
            end_effector: frame.into(),
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

/// Steps of the servo; `before` changes something before each.
fn follow(
    mut servo: TaskServo,
    mut q: Vec<f64>,
    steps: usize,
    record: &mut Record,
    mut before: impl FnMut(usize, &mut TaskServo, &[f64], &mut Record),
) {
    let mut watch = Watch::new(servo.dt());
    for step in 0..steps {
        before(step, &mut servo, &q, record);
        if let Err(error) = servo.step(&q) {
            return fail(record, &error);
        }
        note(&servo, &mut watch, record);
        servo.advance(&mut q);
    }
    record.number(sum(&q));
    watch.end(record);
}

fn until_at_rest(robot: &Mechanism, q: Vec<f64>, random: &mut Random<'_>, record: &mut Record) {
    let options = options(robot, random);
    let tasks = frames(robot, &q, options.dt, random);
    let Some(servo) = servo_of(robot, tasks, options, record) else { return };
    let back = random.vec3(0.3 * robot.reach());
    follow(servo, q, 81, record, |step, servo, q, _| {
        if step == 54 {
            move_targets(servo, back, q);
        }
    });
}

fn some_configuration(robot: &Mechanism, random: &mut Random<'_>) -> Vec<f64> {
    if random.once_in(2) { singular(robot, random) } else { random.configuration(robot) }
}

#[test]
fn edges_of_arms() {
    check("control_edges_arms", 40, |random, record| {
        let robot = of_catalogue(random, false);
        let q = some_configuration(&robot, random);
        until_at_rest(&robot, q, random, record);
    });
}

#[test]
fn edges_of_few_joints() {
    check("control_edges_few", 60, |random, record| {
        let robot = few_joints(random);
        let q = some_configuration(&robot, random);
        until_at_rest(&robot, q, random, record);
    });
}

#[test]
fn edges_of_random_robots() {
    check("control_edges_random", 40, |random, record| {
        let robot = any_robot(random);
        let q = some_configuration(&robot, random);
        until_at_rest(&robot, q, random, record);
    });
}

#[test]
fn edges_of_closed_chains() {
    check("control_edges_closed", 50, |random, record| {
        let robot = closed_chain(random);
        let q = robot.home().to_vec();
        until_at_rest(&robot, q, random, record);
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
        let Some(servo) = servo_of(&robot, tasks, options, record) else { return };
        follow(servo, q, 54, record, |step, servo, _, record| {
            if step % 9 == 0 && step < 36 {
                let name = random.below(count).to_string();
                let twist = Twist { linear: random.vec3(reach), angular: random.vec3(1.0) };
                let timeout = dt * [1.0, 7.5, 20.0, f64::INFINITY][random.below(4)];
                servo.command_twist(&name, twist, timeout).unwrap();
            }
            let commands = (0..count).map(|i| servo.commanded_twist(&i.to_string()).unwrap());
            record.number(commands.flatten().map(of_twist).sum());
        });
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
        let mut tasks = frames(&robot, &q, options.dt, random);
        tasks.iter_mut().for_each(|task| task.gain = 0.9 / options.dt);
        let Some(servo) = servo_of(&robot, tasks, options, record) else { return };
        let way = random.vec3(0.1 * robot.reach());
        follow(servo, q, 54, record, |step, servo, q, _| {
            if step % 13 == 12 {
                move_targets(servo, way, q);
            }
        });
    });
}
