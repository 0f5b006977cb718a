//! Why servos stall, the condition of configurations, ways around, options that are refused.

use cylindroid::control::{
    Plant, SecondaryTask, ServoGains, SpeedLimit, Task, find_reachable_configuration, simulate,
};
use cylindroid::{Mechanism, Pose, Servo, ServoOptions, Vec3};

use super::servo::{options, secondary, servo_of, target, task};
use super::{Watch, any_robot, fail, of_result, of_twist, singular, sum, tool_at};
use crate::record::{Record, check};
use crate::robots::{Random, of_catalogue, robot};

/// Simple options and steps so long that a stall comes after a few.
fn slow_options(robot: &Mechanism, random: &mut Random<'_>) -> ServoOptions {
    let mut options = ServoOptions::new(robot);
    options.dt = random.within(0.04, 0.1);
    options.gain = ServoGains { position: 5.0, orientation: 5.0 };
    options.tolerance.position *= 10.0;
    if random.once_in(3) {
        options.task = task(random);
    }
    if random.once_in(4) {
        options.acceleration = Some(random.power(-1.0, 1.0));
    }
    options
}

fn until_the_end(robot: &Mechanism, random: &mut Random<'_>, record: &mut Record) {
    let options = slow_options(robot, random);
    let Some(mut servo) = servo_of(robot, options, record) else { return };
    let q = match random.below(2) {
        0 => singular(robot, random),
        _ => random.configuration(robot),
    };
    let goal = target(robot, &q, random);
    let mut watch = Watch::new(servo.options().dt);
    let result = simulate(
        &mut servo,
        &q,
        5.0,
        |_| (goal.into(), true),
        |sample| watch.sample(record, &sample),
    );
    match result {
        Ok(result) => of_result(record, &result),
        Err(error) => fail(record, &error),
    }
    watch.end(record);
}

#[test]
fn stalls_of_random_robots() {
    check("control_stalls_random", 70, |random, record| {
        let robot = any_robot(random);
        until_the_end(&robot, random, record);
    });
}

#[test]
fn stalls_of_arms() {
    check("control_stalls_arms", 50, |random, record| {
        let robot = of_catalogue(random, false);
        until_the_end(&robot, random, record);
    });
}

fn of_condition(servo: &mut Servo, q: &[f64], random: &mut Random<'_>, record: &mut Record) {
    record.word(&servo.redundancy());
    let report = match servo.condition(q) {
        Ok(report) => report,
        Err(error) => return fail(record, &error),
    };
    record.word(&(report.inverse.rank, report.weakest.is_some()));
    record.numbers(&[report.singular_ratio, sum(report.inverse.matrix.as_slice())]);
    let last: Vec<f64> = q.iter().map(|_| random.within(-1.0, 1.0)).collect();
    match servo.next_self_motion(q, &last) {
        Ok(next) => record.number(sum(&next.unwrap_or_default())),
        Err(error) => fail(record, &error),
    }
    let motions = servo.self_motions(q).unwrap();
    record.word(&motions.len());
    // The signs of others are those of rounding.
    if let [motion] = &motions[..] {
        record.number(sum(motion));
    }
    if let Some(weakest) = report.weakest {
        record.number(of_twist(weakest).abs());
    }
}

#[test]
fn conditions() {
    check("control_conditions", 80, |random, record| {
        let robot = if random.once_in(5) { of_catalogue(random, true) } else { any_robot(random) };
        let mut options = ServoOptions::new(&robot);
        if random.once_in(2) && !robot.is_closed() {
            options = super::servo::options(&robot, random);
            options.task = task(random);
        }
        match options.default_secondary(&robot) {
            Ok(tasks) => record.word(&tasks.len()),
            Err(error) => fail(record, &error),
        }
        let Some(mut servo) = servo_of(&robot, options, record) else { return };
        let q = if robot.is_closed() { robot.home().to_vec() } else { singular(&robot, random) };
        of_condition(&mut servo, &q, random, record);
    });
}

/// A target that another configuration reaches, or none.
#[test]
fn reconfigurations() {
    check("control_reconfigurations", 24, |random, record| {
        let robot = if random.once_in(2) { of_catalogue(random, false) } else { any_robot(random) };
        let mut options = ServoOptions::new(&robot);
        options.tolerance.position = random.power(-4.0, -2.0);
        options.length *= random.power(-0.5, 0.5);
        if random.once_in(3) {
            options.task = Task::POSITION;
        }
        let Some(servo) = servo_of(&robot, options, record) else { return };
        let q = random.configuration(&robot);
        let goal = match random.below(4) {
            0 => Pose { translation: Vec3::X * (5.0 * robot.reach()), ..tool_at(&robot, &q) },
            _ => tool_at(&robot, &random.configuration(&robot)),
        };
        match find_reachable_configuration(&servo, &q, goal, random.below(6)) {
            Ok(Some(found)) => {
                record.word(&found.restarts);
                // As near as the tolerance.
                record.word(&(robot.outside_limits(&found.q).count()));
                record.number(sum(&found.q));
            }
            Ok(None) => record.word(&"none"),
            Err(error) => fail(record, &error),
        }
    });
}

/// Changes one option to a value at the border of what is permitted, or beyond.
fn break_option(options: &mut ServoOptions, robot: &Mechanism, random: &mut Random<'_>) {
    let bad = [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-3][random.below(5)];
    let dt = options.dt;
    match random.below(18) {
        0 => options.dt = bad,
        1 => options.length = bad,
        2 => options.gain.position = bad,
        3 => options.gain.orientation = [2.0 / dt, 1.99 / dt, 2.01 / dt][random.below(3)],
        4 => options.tolerance.position = bad,
        5 => options.tolerance.orientation = bad,
        6 => options.speed = SpeedLimit { linear: bad, angular: 1.0 },
        7 => options.speed = SpeedLimit { linear: 1.0, angular: bad },
        8 => options.acceleration = Some(bad),
        9 => options.jerk = bad,
        10 => options.largest_projection = bad,
        11 => options.command_timeout = bad,
        12 => {
            options.plant =
                Plant { delay: [bad, 999.5 * dt, 1000.5 * dt][random.below(3)], ..Plant::IDEAL }
        }
        13 => options.plant = Plant { time_constant: bad, noise: 0.0, delay: 0.0 },
        14 => options.plant = Plant { noise: bad, ..Plant::IDEAL },
        15 => options.joint_weights = vec![bad; robot.n() + random.below(2)],
        16 => options.task.components = [false; 6],
        _ => {
            let posture = vec![0.0; robot.n() + random.below(2)];
            options.secondary = vec![SecondaryTask::Posture { q: posture, gain: bad }];
        }
    }
}

#[test]
fn options_are_checked() {
    check("control_options", 100, |random, record| {
        let robot = robot(random, false);
        let mut options = options(&robot, random);
        if random.once_in(4) {
            options.secondary = secondary(&robot, random);
            options.inertia_weights = random.once_in(2);
        }
        break_option(&mut options, &robot, random);
        match options.check(&robot) {
            Ok(()) => record.word(&"good"),
            Err(error) => fail(record, &error),
        }
    });
}
