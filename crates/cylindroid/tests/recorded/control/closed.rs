//! Servos of closed chains: drives alone, more sensors, noise, twists, drives in loops.

use cylindroid::control::{SecondaryTask, Task, simulate};
use cylindroid::model::{CoordinateKind, Dimension, JointKind, JointSpec, Limits, LoopJointSpec};
use cylindroid::{Mechanism, Pose, Servo, ServoOptions, Twist, Vec3};

use super::servo::{plant, servo_of, task};
use super::{Watch, fail, of_limits, of_result, of_stall, of_twist, sum, tool_at};
use crate::record::{Record, check};
use crate::robots::{Random, five_bar, of_catalogue, spatial_loop};

/// A four-bar that closes at zero, driven at its first joint or in its loop.
pub(super) fn four_bar(random: &mut Random<'_>) -> Mechanism {
    let size = random.power(-1.5, 1.0);
    let corners = [0; 4].map(|_| random.vec3(0.3 * size));
    let places = [Vec3::ZERO, Vec3::Y, Vec3::X + Vec3::Y, Vec3::X];
    let at: Vec<Vec3> =
        places.iter().zip(corners).map(|(p, c)| *p * size + Vec3 { z: 0.0, ..c }).collect();
    let in_loop = random.once_in(2);
    let limits = Limits {
        velocity: random.power(-0.5, 0.5),
        acceleration: random.power(0.0, 1.5),
        ..Limits::NONE
    };
    let mut builder = Mechanism::builder("four-bar");
    for i in 0..3 {
        let before = if i == 0 { Vec3::ZERO } else { at[i - 1] };
        let actuated = i == 0 && !in_loop;
        builder.joint(JointSpec {
            parent_from_joint: Pose::from_translation(at[i] - before),
            limits: if actuated { limits } else { Limits::NONE },
            actuated,
            ..JointSpec::new(
                &format!("q{i}"),
                JointKind::Revolute,
                &format!("l{i}"),
                &format!("l{}", i + 1),
            )
        });
    }
    builder.loop_joint(LoopJointSpec {
        link_a_from_joint: Pose::from_translation(at[3] - at[2]),
        link_b_from_joint: Pose::from_translation(at[3]),
        limits: if in_loop { limits } else { Limits::NONE },
        actuated: in_loop,
        ..LoopJointSpec::new("last", JointKind::Revolute, "l3", "l0")
    });
    builder.frame("tip", "l2", Pose::from_translation(Vec3::X * (0.5 * size))).tool("tip");
    builder.reference("tip").dimension(Dimension::Planar);
    builder.build().unwrap()
}

fn closed_chain(random: &mut Random<'_>) -> Mechanism {
    match random.below(6) {
        0 => five_bar(random),
        1 => spatial_loop(random),
        2 => four_bar(random),
        _ => of_catalogue(random, true),
    }
}

fn options(robot: &Mechanism, random: &mut Random<'_>) -> ServoOptions {
    let mut options = ServoOptions::new(robot);
    options.dt = random.power(-2.5, -1.5);
    let gain = random.power(-1.2, 0.0) / options.dt;
    (options.gain.position, options.gain.orientation) = (gain, gain);
    if random.once_in(4) {
        options.gain.orientation *= 0.5;
    }
    options.method = super::laws::method(random);
    options.length *= random.power(-0.5, 0.5);
    options.acceleration = Some([f64::INFINITY, random.power(-0.3, 1.5)][random.below(2)]);
    if random.once_in(4) {
        options.jerk = random.power(1.0, 3.0);
    }
    if random.once_in(3) {
        options.joint_weights = (0..robot.n()).map(|_| random.power(-1.0, 1.0)).collect();
    } else if random.once_in(3) && robot.check_masses().is_ok() {
        options.inertia_weights = true;
    }
    if random.once_in(3) {
        options.task = task(random);
    }
    if random.once_in(2) {
        let all = SecondaryTask::all(robot.home());
        options.secondary =
            all.into_iter().filter(|task| task.name() != "manipulability").collect();
    }
    options
}

/// Near the home pose, or far away.
fn target(robot: &Mechanism, random: &mut Random<'_>) -> Pose {
    let here = tool_at(robot, robot.home());
    let size = robot.reach() * [0.02, 0.2, 3.0][random.below(3)];
    let turn = Pose { translation: Vec3::ZERO, ..random.pose(0.0) };
    let moved = Pose { translation: here.translation + random.vec3(size), ..here };
    if random.once_in(4) { moved * turn } else { moved }
}

#[test]
fn targets() {
    check("control_closed", 50, |random, record| {
        let robot = closed_chain(random);
        let mut options = options(&robot, random);
        if random.once_in(3) {
            options.plant = plant(options.dt, random);
        }
        let goal = target(&robot, random);
        let Some(mut servo) = servo_of(&robot, options, record) else { return };
        let mut watch = Watch::new(servo.options().dt);
        let duration = 81.0 * servo.options().dt;
        let result = simulate(
            &mut servo,
            robot.home(),
            duration,
            |_| (goal.into(), true),
            |sample| watch.sample(record, &sample),
        );
        match result {
            Ok(result) => of_result(record, &result),
            Err(error) => fail(record, &error),
        }
        watch.end(record);
    });
}

/// Drives of a plane five-bar towards points that it reaches beyond singularities of type II, or not.
#[test]
fn singularities() {
    check("control_closed_singular", 30, |random, record| {
        let robot = five_bar(random);
        let mut options = ServoOptions::new(&robot);
        options.dt = random.within(0.02, 0.05);
        options.task = [Task::POSITION, Task::PLANAR][random.below(2)];
        options.acceleration = Some([f64::INFINITY, random.power(0.0, 1.5)][random.below(2)]);
        let here = tool_at(&robot, robot.home());
        let way = Vec3 { z: 0.0, ..random.vec3(1.5) };
        let goal = Pose { translation: here.translation + way, ..here };
        let Some(mut servo) = servo_of(&robot, options, record) else { return };
        let mut watch = Watch::new(servo.options().dt);
        let to_goal = |_| (goal.into(), true);
        match simulate(&mut servo, robot.home(), 4.0, to_goal, |s| watch.sample(record, &s)) {
            Ok(result) => of_result(record, &result),
            Err(error) => fail(record, &error),
        }
        watch.end(record);
    });
}

/// Positions of passive coordinates, with small errors; now and then of none.
fn sensors(robot: &Mechanism, q: &[f64], random: &mut Random<'_>) -> Vec<(usize, f64)> {
    let passive = (0..robot.n()).filter(|&i| {
        let c = &robot.coordinates()[i];
        !c.actuated && matches!(c.kind, CoordinateKind::Angle | CoordinateKind::Length)
    });
    let mut chosen: Vec<(usize, f64)> = Vec::new();
    for i in passive {
        if random.once_in(3) {
            chosen.push((i, q[i] + 1e-3 * random.within(-1.0, 1.0)));
        }
    }
    if random.once_in(150) {
        chosen.push((robot.n(), 0.0));
    }
    chosen
}

fn of_step(watch: &mut Watch, servo: &Servo, errors: f64, name: &str, record: &mut Record) {
    let limits = of_limits(servo.active_limits());
    let all = [sum(servo.joint_velocities()), sum(servo.loop_closure_velocities())];
    let word = format!("{name}.{}", limits);
    watch.note(record, &word, &[sum(&all), errors, sum(servo.configuration())]);
}

#[test]
fn measured_positions() {
    check("control_closed_sensors", 40, |random, record| {
        let robot = closed_chain(random);
        let options = options(&robot, random);
        let (goal, with_sensors) = (target(&robot, random), random.once_in(2));
        let Some(mut servo) = servo_of(&robot, options, record) else { return };
        let mut q = robot.home().to_vec();
        if let Err(error) = servo.start_from(&q) {
            fail(record, &error);
        }
        let mut watch = Watch::new(servo.options().dt);
        for _ in 0..20 {
            let drives: Vec<f64> =
                robot.actuated().map(|i| q[i] + 1e-4 * random.within(-1.0, 1.0)).collect();
            let more = if with_sensors { sensors(&robot, &q, random) } else { Vec::new() };
            let now = match servo.step_measured(&drives, &more, goal) {
                Ok(now) => now,
                Err(error) => return fail(record, &error),
            };
            let errors = sum(&[now.position_error, now.orientation_error, now.singular_ratio]);
            of_step(&mut watch, &servo, errors, now.status.name(), record);
            servo.advance(&mut q);
        }
        of_stall(record, &servo.stall());
        watch.end(record);
    });
}

/// All coordinates with errors that open the loops.
#[test]
fn open_loops() {
    check("control_closed_open", 20, |random, record| {
        let robot = closed_chain(random);
        let options = options(&robot, random);
        let goal = target(&robot, random);
        let Some(mut servo) = servo_of(&robot, options, record) else { return };
        let mut q = robot.home().to_vec();
        let off = random.power(-6.0, -1.5);
        let mut watch = Watch::new(servo.options().dt);
        for _ in 0..10 {
            let measured: Vec<f64> = q.iter().map(|x| x + off * random.within(-1.0, 1.0)).collect();
            let now = match servo.step(&measured, goal) {
                Ok(now) => now,
                Err(error) => return fail(record, &error),
            };
            let errors = sum(&[now.position_error, now.orientation_error, now.saturation.scale]);
            of_step(&mut watch, &servo, errors, now.status.name(), record);
            servo.advance(&mut q);
        }
        record.number(sum(&q));
        watch.end(record);
    });
}

#[test]
fn twists() {
    check("control_closed_twists", 30, |random, record| {
        let robot = closed_chain(random);
        let mut options = options(&robot, random);
        options.command_timeout = 5.0 * options.dt;
        let Some(mut servo) = servo_of(&robot, options, record) else { return };
        let mut q = robot.home().to_vec();
        let size = robot.reach() * random.power(-1.5, 1.0);
        let twist = Twist { linear: random.vec3(size), angular: random.vec3(1.0) };
        let mut watch = Watch::new(servo.options().dt);
        for step in 0..33 {
            let command = (step < 20).then_some(twist);
            let now = match servo.step_twist(&q, command) {
                Ok(now) => now,
                Err(error) => return fail(record, &error),
            };
            let errors = sum(&[of_twist(now.achieved), now.step.saturation.scale]);
            of_step(&mut watch, &servo, errors, now.status.name(), record);
            servo.advance(&mut q);
        }
        of_stall(record, &servo.stall());
        watch.end(record);
    });
}
