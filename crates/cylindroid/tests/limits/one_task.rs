//! Rounds of a servo with one task: towards targets that jump, and along twists that change, cease and
//! return.

use cylindroid::control::{SecondaryTask, ServoGains, Task};
use cylindroid::inverse::Method;
use cylindroid::{Error, Mechanism, Servo, ServoOptions, Twist, Vec3};

use crate::robots::Random;
use crate::rounds::{STEPS, closed_step, measured, push, start, takes_pushes, target};
use crate::watch::{Tally, Watch};

fn options(robot: &Mechanism, random: &mut Random<'_>) -> ServoOptions {
    let mut options = ServoOptions::new(robot);
    options.dt = random.power(-4.0, -1.3);
    let gain = random.power(-1.0, 0.28) / options.dt;
    options.gain = ServoGains { position: gain, orientation: gain };
    options.acceleration = Some(random.power(-1.0, 4.0));
    options.method = Method::ALL[random.below(Method::ALL.len())];
    let closed = robot.is_closed();
    if !closed && random.once_in(2) {
        options.joint_weights = (0..robot.n()).map(|_| random.power(-3.0, 3.0)).collect();
    }
    if !closed && random.once_in(3) {
        options.secondary = SecondaryTask::all(robot.home()).to_vec();
    }
    if !closed && random.once_in(4) {
        options.task = [Task::POSITION, Task::POINTING][random.below(2)];
    }
    options
}

/// Targets that jump now and then.
pub(crate) fn follows_targets(robot: &Mechanism, noise: f64, random: &mut Random<'_>) -> Tally {
    let mut options = options(robot, random);
    options.plant.noise = noise;
    let mut goal = None;
    steps(robot, options, random, |servo, q, random| {
        let end_effector = servo.options().end_effector;
        let jumps = goal.is_none() || random.once_in(150);
        let present = goal.filter(|_| !jumps);
        let goal = goal.insert(match present {
            Some(goal) => goal,
            None => target(robot.state(q)?.pose(end_effector)?, random),
        });
        servo.step(q, *goal).map(|_| ())
    })
}

/// None, the last one for ever, one of ordinary size, and one beyond all robots.
fn command(random: &mut Random<'_>) -> Option<Twist> {
    let size = match random.below(6) {
        0 => return None,
        1 => 0.0,
        2 => 1e6,
        _ => random.power(-3.0, 0.5),
    };
    let linear = random.vec3(size);
    let angular = if random.once_in(2) { random.vec3(size) } else { Vec3::ZERO };
    Some(Twist { linear, angular })
}

/// Twists, with a watchdog.
pub(crate) fn follows_twists(robot: &Mechanism, random: &mut Random<'_>) -> Tally {
    let mut options = options(robot, random);
    options.command_timeout = random.power(-2.0, 1.0);
    let mut now = command(random);
    steps(robot, options, random, |servo, q, random| {
        if random.once_in(80) {
            now = command(random);
        }
        servo.step_twist(q, now).map(|_| ())
    })
}

/// The steps of a round, from anywhere; pushes come in between.
fn steps<'b>(
    robot: &Mechanism,
    options: ServoOptions,
    random: &mut Random<'b>,
    mut step: impl FnMut(&mut Servo, &[f64], &mut Random<'b>) -> Result<(), Error>,
) -> Tally {
    let noise = options.plant.noise;
    let mut watch = Watch::new(robot, options.dt, options.acceleration.unwrap());
    let mut tally = Tally::default();
    // Combinations that define no controller are refused, which is another test's matter.
    let Ok(mut servo) = Servo::new(robot, options) else { return tally };
    let closed = robot.is_closed();
    let mut q = if closed { robot.home().to_vec() } else { start(robot, noise, random) };
    for i in 0..STEPS {
        if !closed && random.once_in(250) && takes_pushes(robot) && noise == 0.0 {
            push(robot, &mut q, random);
            watch.push();
            tally.pushes += 1;
        }
        tally.steps += 1;
        if let Err(error) = step(&mut servo, &measured(&q, noise, random), random) {
            tally.errors += 1;
            // A loop that opened is an error; a tree has none.
            if !closed {
                tally.violations.push(format!("step {i}: {error}"));
            }
            return tally;
        }
        let before = q.clone();
        servo.advance(&mut q);
        tally.note(i, &q);
        if closed {
            closed_step(robot, servo.joint_velocities(), &q, i, &mut tally);
            continue;
        }
        match watch.step(&before, servo.joint_velocities(), &q) {
            Ok(at_limit) => tally.at_limits += u64::from(at_limit),
            Err(what) => {
                tally.violations.push(format!("step {i}: {what}"));
                return tally;
            }
        }
    }
    tally
}
