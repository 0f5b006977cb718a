//! Servos of one task: all options, twists, moving targets, robots that lag.

use cylindroid::control::{
    CartesianBounds, CartesianMove, CartesianPath, KinematicBounds, Plant, PoseTolerance,
    SecondaryNullSpace, SecondaryTask, ServoGains, SpeedLimit, Target, Task, TwistStep, simulate,
    simulate_twist,
};
use cylindroid::model::JointLimits;
use cylindroid::{EndEffector, Mechanism, Pose, ReferenceFrame, Servo, ServoOptions, Twist, Vec3};

use super::laws::{method, projection};
use super::{
    Watch, any_robot, fail, few_joints, of_limits, of_pose, of_result, of_stall, of_twist,
    singular, sum, tool_at,
};
use crate::record::{Record, check};
use crate::robots::{Random, of_catalogue, robot};

/// Components of a task, in the axes of the tool or of the world.
pub(super) fn task(random: &mut Random<'_>) -> Task {
    let axes = [ReferenceFrame::Local, ReferenceFrame::LocalWorldAligned][random.below(2)];
    let components = match random.below(6) {
        0 => [true, true, true, false, false, false],
        1 => [true, true, false, false, false, true],
        2 => std::array::from_fn(|_| random.once_in(2)),
        _ => [true; 6],
    };
    Task { components, axes }
}

pub(super) fn secondary(robot: &Mechanism, random: &mut Random<'_>) -> Vec<SecondaryTask> {
    let all = SecondaryTask::all(&random.configuration(robot));
    let mut chosen = Vec::new();
    for task in all {
        if random.once_in(2) {
            let task = task.with("gain", random.within(-3.0, 6.0)).unwrap();
            let margin = random.within(0.05, 0.6);
            chosen.push(task.clone().with("margin", margin).unwrap_or(task));
        }
    }
    chosen
}

pub(super) fn plant(dt: f64, random: &mut Random<'_>) -> Plant {
    let delay = [0.0, dt, 0.4 * dt, dt * random.within(0.0, 5.0)][random.below(4)];
    let time_constant = [0.0, dt * random.power(-1.0, 1.5)][random.below(2)];
    let noise = [0.0, random.power(-5.0, -2.0)][random.below(2)];
    Plant { delay, time_constant, noise }
}

/// Options of any kind; a step takes 5 to 50 ms, so that a few steps show much.
pub(super) fn options(robot: &Mechanism, random: &mut Random<'_>) -> ServoOptions {
    let mut options = ServoOptions::new(robot);
    options.dt = random.power(-2.3, -1.3);
    let gain = random.power(-1.2, 0.0) / options.dt;
    options.gain = ServoGains { position: gain, orientation: gain };
    if random.once_in(3) {
        options.gain.orientation = random.power(-1.2, 0.0) / options.dt;
    }
    let size = random.power(-4.0, -1.0);
    options.tolerance = PoseTolerance { position: size, orientation: 2.0 * size };
    options.method = method(random);
    options.length *= random.power(-0.6, 0.6);
    options.acceleration = Some([f64::INFINITY, 20.0, random.power(-0.5, 2.0)][random.below(3)]);
    if random.once_in(4) {
        options.jerk = random.power(0.5, 3.5);
    }
    if random.once_in(3) {
        options.joint_weights = (0..robot.n()).map(|_| random.power(-1.5, 1.5)).collect();
    } else if random.once_in(6) && robot.check_masses().is_ok() {
        options.inertia_weights = true;
    }
    if random.once_in(4) {
        options.speed =
            SpeedLimit { linear: random.power(-1.5, 0.5), angular: random.power(-1.5, 0.5) };
    }
    if random.once_in(4) {
        options.null_space = SecondaryNullSpace::Retained;
    }
    options
}

/// Besides: another tool point, parts of poses, secondary tasks.
fn more_options(robot: &Mechanism, random: &mut Random<'_>) -> ServoOptions {
    let mut options = options(robot, random);
    if random.once_in(2) {
        options.task = task(random);
        options.end_effector = EndEffector {
            frame_from_tool: random.pose(0.2 * robot.reach()),
            ..options.end_effector
        };
    }
    if random.once_in(2) {
        options.secondary = secondary(robot, random);
    }
    options
}

/// A pose of the tool at another configuration, near the present one, out of reach, or the same.
pub(super) fn target(robot: &Mechanism, q: &[f64], random: &mut Random<'_>) -> Pose {
    let here = tool_at(robot, q);
    match random.below(8) {
        0 if !robot.is_closed() => tool_at(robot, &random.configuration(robot)),
        1 => Pose { translation: here.translation * 5.0 + Vec3::X * robot.reach(), ..here },
        2 if random.once_in(3) => here,
        3 => here * random.pose(0.1 * robot.reach()),
        4 => Pose { translation: here.translation * random.within(1.0, 1.8), ..here },
        5 => {
            // About as far as the arm reaches.
            let way = random.vec3(1.0);
            let size = robot.reach() * random.within(0.8, 1.3);
            Pose { translation: way * (size / way.norm()), ..here }
        }
        _ => {
            let turn = Pose { translation: Vec3::ZERO, ..random.pose(0.0) };
            let way = random.vec3(0.3 * robot.reach());
            let moved = Pose { translation: here.translation + way, ..here };
            if random.once_in(2) { moved } else { moved * turn }
        }
    }
}

/// A servo, or the word why there is none.
pub(super) fn servo_of(
    robot: &Mechanism,
    options: ServoOptions,
    record: &mut Record,
) -> Option<Servo> {
    match Servo::new(robot, options) {
        Ok(servo) => Some(servo),
        Err(error) => {
            fail(record, &error);
            None
        }
    }
}

/// Towards a pose, with velocities for the null space in some steps.
fn towards(robot: &Mechanism, options: ServoOptions, random: &mut Random<'_>, record: &mut Record) {
    let Some(mut servo) = servo_of(robot, options, record) else { return };
    let mut q = match random.below(4) {
        0 => singular(robot, random),
        _ => random.configuration(robot),
    };
    let mut goal = target(robot, &q, random);
    let push: Vec<f64> = q.iter().map(|_| random.within(-1.0, 1.0)).collect();
    let mut watch = Watch::new(servo.options().dt);
    for step in 0..33 {
        if step == 12 && random.once_in(2) {
            goal = target(robot, &q, random);
        }
        if step == 20 && random.once_in(4) {
            servo.reset();
        }
        let more = if step % 8 < 3 { &push[..] } else { &[] };
        let now = match servo.step_with(&q, goal, more) {
            Ok(now) => now,
            Err(error) => return fail(record, &error),
        };
        let limits = of_limits(servo.active_limits());
        let lost = now.saturation.direction_lost;
        let word = format!("{}.{}.{lost}.{}", now.status.name(), now.rank, limits);
        let errors = [now.position_error, now.orientation_error, now.singular_ratio];
        let all = [sum(servo.joint_velocities()), sum(&errors), now.saturation.scale];
        watch.note(record, &word, &all);
        servo.advance(&mut q);
    }
    record.number(sum(servo.configuration()));
    of_stall(record, &servo.stall());
    watch.end(record);
}

#[test]
fn options_of_random_robots() {
    check("control_servo_random", 90, |random, record| {
        let robot = any_robot(random);
        let options = more_options(&robot, random);
        towards(&robot, options, random, record);
    });
}

#[test]
fn options_of_arms() {
    check("control_servo_arms", 60, |random, record| {
        let robot = of_catalogue(random, false);
        let options = more_options(&robot, random);
        towards(&robot, options, random, record);
    });
}

/// Arms with few joints, whose projections choose what they miss.
#[test]
fn projections() {
    check("control_servo_projections", 70, |random, record| {
        let robot = if random.once_in(3) { any_robot(random) } else { few_joints(random) };
        let mut options = options(&robot, random);
        options.task.axes = task(random).axes;
        if random.once_in(2) {
            options.dt = 0.05;
            (options.gain.position, options.gain.orientation) = (5.0, 5.0);
        }
        let missing = 6_usize.saturating_sub(robot.n());
        options.projection = projection(missing, random);
        options.fallback = random.once_in(2).then(|| projection(missing, random));
        if random.once_in(2) {
            options.largest_projection = random.power(0.0, 1.5);
        }
        let Some(mut servo) = servo_of(&robot, options, record) else { return };
        let q = random.configuration(&robot);
        let goal = target(&robot, &q, random);
        let mut watch = Watch::new(servo.options().dt);
        let duration = 40.0 * servo.options().dt;
        let result = simulate(
            &mut servo,
            &q,
            duration,
            |_| (goal.into(), true),
            |sample| watch.sample(record, &sample),
        );
        match result {
            Ok(result) => of_result(record, &result),
            Err(error) => return fail(record, &error),
        }
        record.word(&(servo.is_stopped(), servo.no_inverse().is_some()));
        watch.end(record);
    });
}

/// A twist in steps, with pauses, then none.
fn commands(random: &mut Random<'_>) -> Vec<Option<Twist>> {
    let size = random.power(-1.5, 0.7);
    let mut now = Some(Twist { linear: random.vec3(size), angular: random.vec3(size) });
    let mut all = Vec::new();
    for _ in 0..54 {
        match random.below(12) {
            0 => now = Some(Twist { linear: random.vec3(size), angular: random.vec3(size) }),
            1 => now = Some(Twist { linear: random.vec3(size), angular: Vec3::ZERO }),
            2 => now = Some(Twist::ZERO),
            3..6 => now = None,
            _ => {}
        }
        all.push(now);
    }
    all
}

fn of_twist_step(watch: &mut Watch, servo: &Servo, now: &TwistStep, record: &mut Record) {
    let limits = of_limits(servo.active_limits());
    let (lost, out) = (now.step.saturation.direction_lost, now.timed_out);
    let word = format!("{}.{out}.{}.{lost}.{}", now.status.name(), now.step.rank, limits);
    let achieved = sum(&[of_twist(now.achieved), of_twist(now.desired)]);
    let pose = sum(&[of_pose(now.step.pose, 10.0), now.step.saturation.scale]);
    watch.note(record, &word, &[sum(servo.joint_velocities()), achieved, pose, now.step.lag]);
}

#[test]
fn twists() {
    check("control_servo_twists", 70, |random, record| {
        let robot = any_robot(random);
        let mut options = more_options(&robot, random);
        options.command_timeout =
            options.dt * [0.5, 3.0, 1e9, random.within(1.0, 6.0)][random.below(4)];
        if random.once_in(3) {
            options.plant = plant(options.dt, random);
        }
        let Some(mut servo) = servo_of(&robot, options, record) else { return };
        let mut q = random.configuration(&robot);
        let mut watch = Watch::new(servo.options().dt);
        for command in commands(random) {
            match servo.step_twist(&q, command) {
                Ok(now) => of_twist_step(&mut watch, &servo, &now, record),
                Err(error) => return fail(record, &error),
            }
            servo.advance(&mut q);
        }
        of_stall(record, &servo.stall());
        watch.end(record);
    });
}

/// A twist for some time, to the end of the motion.
#[test]
fn twists_until_rest() {
    check("control_servo_rest", 45, |random, record| {
        let robot = if random.once_in(3) { any_robot(random) } else { of_catalogue(random, false) };
        let mut options = more_options(&robot, random);
        if random.once_in(2) {
            options.plant = plant(options.dt, random);
        }
        let Some(mut servo) = servo_of(&robot, options, record) else { return };
        let q = random.configuration(&robot);
        let end = servo.options().dt * random.within(2.0, 30.0);
        let twist = Twist { linear: random.vec3(1.0), angular: random.vec3(1.0) };
        let mut watch = Watch::new(servo.options().dt);
        let command = |time: f64, _: &[f64]| Ok((time < end).then_some(twist));
        let duration = servo.options().dt * 50.0;
        let result =
            simulate_twist(&mut servo, &q, duration, command, |s| watch.sample(record, &s));
        match result {
            Ok(result) => of_result(record, &result),
            Err(error) => fail(record, &error),
        }
        watch.end(record);
    });
}

/// Where a target is at a time.
struct Course {
    kind: usize,
    start: Pose,
    way: Vec3,
    turn: Vec3,
    line: Option<CartesianMove>,
    dt: f64,
}

impl Course {
    fn new(robot: &Mechanism, start: Pose, dt: f64, random: &mut Random<'_>) -> Self {
        let size = robot.reach();
        let (way, turn) = (random.vec3(2.0 * size), random.vec3(1.0));
        let one = |size: f64| KinematicBounds {
            velocity: size,
            acceleration: 4.0 * size,
            jerk: 40.0 * size,
        };
        let limits = CartesianBounds { linear: one(size), angular: one(1.0) };
        let end = start * random.pose(0.4 * size);
        let line =
            CartesianPath::line(start, end).and_then(|path| CartesianMove::new(path, limits));
        Self { kind: random.below(5), start, way, turn, line: line.ok(), dt }
    }

    fn at(&self, time: f64) -> Target {
        let moved = |s: f64| Pose {
            translation: self.start.translation + self.way * s,
            rotation: cylindroid::Rotation::exp(self.turn * s) * self.start.rotation,
        };
        let there_and_back = if time < 0.5 { time } else { 1.0 - time };
        match (self.kind, &self.line) {
            // With its twist, which it loses after some time; without; beyond reach and back; by
            // jumps; along a line.
            (0, _) if time < 0.4 => {
                let feed_forward = Twist { linear: self.way, angular: self.turn };
                Target { pose: moved(time), feed_forward }
            }
            (0, _) => moved(0.4).into(),
            (1, _) => moved(time.min(1.8)).into(),
            (2, _) => moved(5.0 * there_and_back).into(),
            (3, _) => moved(0.2 * (8.0 * time).floor()).into(),
            (_, Some(line)) => line.target(time, self.dt),
            _ => self.start.into(),
        }
    }
}

fn follow(robot: &Mechanism, options: ServoOptions, random: &mut Random<'_>, record: &mut Record) {
    let Some(mut servo) = servo_of(robot, options, record) else { return };
    let q = if robot.is_closed() { robot.home().to_vec() } else { random.configuration(robot) };
    let start = tool_at(robot, &q) * random.pose(0.03 * robot.reach());
    let course = Course::new(robot, start, servo.options().dt, random);
    let ends = random.within(0.3, 2.0);
    let mut watch = Watch::new(servo.options().dt);
    let duration = 81.0 * servo.options().dt;
    let target = |time: f64| (course.at(time), time > ends);
    match simulate(&mut servo, &q, duration, target, |s| watch.sample(record, &s)) {
        Ok(result) => of_result(record, &result),
        Err(error) => fail(record, &error),
    }
    watch.end(record);
}

#[test]
fn moving_targets() {
    check("control_servo_moving", 80, |random, record| {
        let robot = any_robot(random);
        let mut options = more_options(&robot, random);
        options.dt = random.power(-1.7, -1.3);
        follow(&robot, options, random, record);
    });
}

#[test]
fn robots_that_lag() {
    check("control_servo_lag", 75, |random, record| {
        let robot = if random.once_in(2) { robot(random, false) } else { any_robot(random) };
        let mut options = more_options(&robot, random);
        options.plant = plant(options.dt, random);
        follow(&robot, options, random, record);
    });
}

/// Limits of joints that overrule those of the options.
#[test]
fn limits_of_single_joints() {
    check("control_servo_limits", 50, |random, record| {
        let robot = of_catalogue(random, false);
        let limits = robot.coordinates().iter().map(|c| {
            let some = |random: &mut Random<'_>, x: f64| random.once_in(2).then_some(x);
            let (jerk, acceleration) = (random.power(1.0, 3.5), random.power(-0.5, 1.5));
            let velocity = random.power(-1.5, 0.5);
            let limits = JointLimits {
                jerk: some(random, jerk),
                acceleration: some(random, acceleration),
                velocity: some(random, velocity),
                ..JointLimits::default()
            };
            (c.name.as_str(), limits)
        });
        let limits: Vec<_> = limits.collect();
        let robot = robot.with_limits(&limits).unwrap();
        let options = options(&robot, random);
        towards(&robot, options, random, record);
    });
}
