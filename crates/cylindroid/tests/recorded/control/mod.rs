//! Motions, laws, servos of one task and of many: what they compute for random mechanisms, targets and
//! options.

mod bounds;
mod closed;
mod edges;
mod laws;
mod motion;
mod names;
mod paths;
mod servo;
mod stalls;
mod tasks;
mod world;

use cylindroid::control::{LimitKind, MotionResult, Stall, TrajectorySample};
use cylindroid::model::{JointKind, JointSpec, Limits};
use cylindroid::{Error, Mechanism, Pose, Twist, Vec3, catalogue};

use crate::record::Record;
use crate::robots::{Random, of_catalogue, robot};

/// A sum in which the order counts; infinite numbers and NaN count as other ones.
fn sum(values: &[f64]) -> f64 {
    let counted = |x: f64| match x {
        x if x.is_nan() => 0.7,
        x if x.is_infinite() => 7.0 * x.signum(),
        x => x,
    };
    let parts = values.iter().enumerate().map(|(i, x)| counted(*x) / (i as f64 + 1.3));
    parts.sum()
}

/// The same of a pose, with lengths over `size`.
fn of_pose(pose: Pose, size: f64) -> f64 {
    let turned = pose.rotation.matrix().to_rows();
    let place = pose.translation * (1.0 / size);
    sum(&[&place.to_array()[..], turned.as_flattened()].concat())
}

/// The same of a twist.
fn of_twist(twist: Twist) -> f64 {
    sum(&twist.to_array())
}

/// The words of an error, then its numbers.
fn fail(record: &mut Record, error: &Error) {
    of_text(record, &error.to_string());
}

fn of_text(record: &mut Record, message: &str) {
    let ends = |c: char| c.is_whitespace() || "(){}[],;:='".contains(c);
    let (mut words, mut numbers) = (String::new(), Vec::new());
    for part in message.split(ends).filter(|part| !part.is_empty()) {
        match part.trim_end_matches('.').parse::<f64>() {
            Ok(number) => numbers.push(number),
            Err(_) => words = format!("{words}-{part}"),
        }
    }
    let first: String = words.chars().skip(1).take(16).collect();
    record.word(&format!("{first}{}", hash(0, &words) >> 16));
    match numbers.len() {
        0..4 => record.numbers(&numbers),
        _ => record.number(sum(&numbers)),
    }
}

/// A number for words.
fn hash(before: u32, words: &str) -> u32 {
    let add = |sum: u32, byte: u8| (sum ^ u32::from(byte)).wrapping_mul(0x0100_0193);
    words.bytes().fold(before, add)
}

/// What a run shows: the sum of all numbers so far after 1, 3, 9, 27, ... steps, the first number of
/// some of them, and at the end a number for the words up to each of these steps.
#[derive(Default)]
struct Watch {
    /// Of its first numbers, which are velocities and change with the gain.
    scale: f64,
    steps: u32,
    total: f64,
    words: u32,
    seen: Vec<u32>,
}

impl Watch {
    /// For steps of `dt` seconds.
    fn new(dt: f64) -> Self {
        Self { scale: 10.0 * dt, ..Self::default() }
    }

    fn note(&mut self, record: &mut Record, word: &str, numbers: &[f64]) {
        let velocities = self.scale * numbers[0];
        self.steps += 1;
        self.total += velocities + sum(&numbers[1..]);
        self.words = hash(self.words, word);
        let power = (1..).map(|i| 3_u32.pow(i - 1)).find(|power| *power >= self.steps);
        if power == Some(self.steps) {
            if matches!(self.steps, 1 | 9) {
                record.number(velocities);
            }
            record.number(self.total);
            self.seen.push(self.words);
        }
    }

    /// Words come last: rounding decides which limits count as met.
    fn end(&self, record: &mut Record) {
        self.seen.iter().for_each(|words| record.word(&(words >> 16)));
    }

    fn sample(&mut self, record: &mut Record, sample: &TrajectorySample<'_>) {
        let step = sample.step;
        let limits = of_limits(sample.limits.iter().copied());
        let lost = step.saturation.direction_lost;
        let word = format!("{}.{}.{lost}.{limits}", step.status.name(), step.rank);
        let errors = [step.position_error, step.orientation_error, step.lag];
        let shares = [
            step.singular_ratio,
            step.saturation.scale,
            of_pose(step.pose, 1.0 + step.pose.translation.norm()),
        ];
        let all = [sum(sample.joint_velocities), sum(&errors), sum(&shares)];
        self.note(record, &word, &all);
    }
}

fn of_stall(record: &mut Record, stall: &Stall) {
    record.word(&stall.name());
    match stall {
        Stall::OutOfReach { distance, length } => record.numbers(&[*distance, *length]),
        Stall::Limits { coordinates } => record.word(coordinates),
        Stall::Singular { ratio, direction } => record.numbers(&[*ratio, sum(direction)]),
        Stall::TooFewJoints { rank, task, direction } => {
            record.word(&(rank, task));
            record.number(sum(direction));
        }
        Stall::Projected { direction } => record.number(sum(direction)),
        Stall::TypeII { share, direction } => record.numbers(&[*share, sum(direction)]),
        Stall::NoInverse(_) | Stall::Slow => {}
    }
}

fn of_result(record: &mut Record, result: &MotionResult) {
    let sizes = [result.time, result.largest_lag, result.min_singular_ratio, sum(&result.q)];
    record.number(sum(&sizes));
    record.word(&(result.last.status.name(), result.reached, result.steps_without_inverse));
    if let Some(stall) = &result.stall {
        of_stall(record, stall);
    }
    if let Some(reason) = &result.no_inverse {
        of_text(record, &format!("{reason:?}"));
    }
    record.word(&of_limits(result.limits_hit.iter().copied()));
}

/// Joints and the first letters of the kinds of their limits.
fn of_limits(limits: impl Iterator<Item = (usize, LimitKind)>) -> String {
    limits.map(|(i, kind)| format!("{i}{}", &kind.name()[..1])).collect()
}

/// A chain of all kinds of joints, of any size.
fn mixed_robot(random: &mut Random<'_>) -> Mechanism {
    let size = random.power(-2.0, 2.0);
    let mut builder = Mechanism::builder("mixed");
    let n = 2 + random.below(3);
    for i in 0..n {
        let kind = match random.below(8) {
            0 => JointKind::Spherical,
            1 => JointKind::Planar,
            2 => JointKind::Cylindrical,
            3 => JointKind::Universal { second: random.vec3(1.0) },
            4 => JointKind::Prismatic,
            5 if i == 0 => JointKind::Free,
            6 => JointKind::Helical { pitch: size * random.within(-0.2, 0.2) },
            _ => JointKind::Revolute,
        };
        let limits = Limits {
            velocity: random.power(-0.5, 1.0),
            acceleration: random.power(0.0, 2.0),
            ..Limits::NONE
        };
        let (parent, child) = (format!("l{i}"), format!("l{}", i + 1));
        builder.joint(JointSpec {
            parent_from_joint: random.pose(size),
            axis: random.vec3(1.0),
            limits,
            ..JointSpec::new(&format!("q{i}"), kind, &parent, &child)
        });
    }
    builder.frame("tip", &format!("l{n}"), random.pose(0.2 * size)).tool("tip");
    builder.build().unwrap_or_else(|_| catalogue::load("3r").unwrap())
}

/// A chain of up to five joints, many of whose axes are parallel, meet or are perpendicular.
fn few_joints(random: &mut Random<'_>) -> Mechanism {
    let mut builder = Mechanism::builder("few");
    let n = 1 + random.below(5);
    let place =
        |random: &mut Random<'_>| Vec3::from_array([0; 3].map(|_| random.below(3) as f64 - 1.0));
    for i in 0..n {
        let kind =
            [JointKind::Revolute, JointKind::Revolute, JointKind::Prismatic][random.below(3)];
        let mut parent_from_joint = Pose::from_translation(place(random));
        if random.once_in(8) {
            parent_from_joint = random.pose(1.0);
        }
        let (velocity, acceleration) = (random.power(-0.5, 0.7), random.power(0.0, 2.0));
        let limits = Limits { lower: -2.0, upper: 2.5, velocity, acceleration, ..Limits::NONE };
        let (parent, child) = (format!("l{i}"), format!("l{}", i + 1));
        let axis = [Vec3::X, Vec3::Y, Vec3::Z, Vec3::Z][random.below(4)];
        let new = JointSpec::new(&format!("q{i}"), kind, &parent, &child);
        builder.joint(JointSpec { parent_from_joint, axis, limits, ..new });
    }
    let tip = Pose::from_translation(place(random));
    builder.frame("tip", &format!("l{n}"), tip).tool("tip");
    builder.build().unwrap()
}

/// A configuration, some of its joints at zero or right angles, where many arms are singular.
fn singular(robot: &Mechanism, random: &mut Random<'_>) -> Vec<f64> {
    let mut q = random.configuration(robot);
    for x in &mut q {
        match random.below(4) {
            0 | 1 => *x = 0.0,
            2 => *x = std::f64::consts::FRAC_PI_2,
            _ => {}
        }
    }
    q
}

/// A tree of any kind.
fn any_robot(random: &mut Random<'_>) -> Mechanism {
    match random.below(7) {
        0 => mixed_robot(random),
        3 => few_joints(random),
        1 | 2 => of_catalogue(random, false),
        _ => robot(random, false),
    }
}

/// The pose of the tool, or of the reference of a closed chain.
fn tool_at(robot: &Mechanism, q: &[f64]) -> Pose {
    let frame = if robot.is_closed() { robot.reference() } else { robot.tool() };
    robot.state(q).unwrap().pose(frame).unwrap()
}
