//! The map from actuated joints to all joints, in full and by partitioning of the coordinates.

use cylindroid::Servo;
use cylindroid::closure::{ActuationMap, LoopClosureError};
use cylindroid::control::Task;
use cylindroid::model::JointLimits;
use cylindroid::spatial::Twist;
use cylindroid::{Mechanism, ServoOptions};

use super::aligned::{flat_ring, planar_loops};
use super::chains::{LINKAGES, Names, ROBOTS, platform, seen_from_elsewhere, with_other_actuators};
use super::digest::{Digests, entries, span, sum};
use crate::record::{Record, check};
use crate::robots::Random;

fn closed_chain(random: &mut Random<'_>, names: &Names<'_>) -> Mechanism {
    let known = names.take(random);
    let m = match random.below(6) {
        0 => seen_from_elsewhere(&known, random),
        1 => platform(random),
        2 => flat_ring(random),
        _ => planar_loops(random),
    };
    if random.below(3) > 0 { m } else { with_other_actuators(&m, random) }
}

/// Of all coordinates, or none.
fn weights(random: &mut Random<'_>, n: usize) -> Vec<f64> {
    if random.once_in(2) { Vec::new() } else { (0..n).map(|_| random.power(-2.0, 2.0)).collect() }
}

fn actuation_map(random: &mut Random<'_>, record: &mut Record, map: &ActuationMap) {
    let m = &map.motions;
    record.counts(&[m.rows(), m.cols(), map.uncontrolled.cols()]);
    record.number(sum(map.shares.iter().copied()));
    record.number(sum([span(m), span(&map.uncontrolled), span(&map.directions)]));
    let LoopClosureError { distance, angle } = map.closure_error;
    record.numbers(&[1e3 * distance, 1e3 * angle]);
    record.number(1e3 * sum(map.correction.iter().copied()));
    let desired: Vec<f64> = (0..m.rows()).map(|_| random.within(-1.0, 1.0)).collect();
    let y = map.project(&desired);
    record.number(sum(map.joint_velocities(&y)));
    record.number(sum(y.iter().map(|x| x * x)));
    record.numbers(&[entries(m), entries(&map.uncontrolled), entries(&map.directions)]);
}

#[test]
fn actuation_maps() {
    let all = [&LINKAGES[..], &ROBOTS[..]].concat();
    let names = Names::of(&all);
    check("mobility_actuation_maps", 90, |random, record| {
        let m = closed_chain(random, &names);
        let n = m.n();
        let noise = if random.once_in(3) { random.power(-6.0, -2.0) } else { 0.0 };
        let q: Vec<f64> = m.home().iter().map(|x| x + noise * random.within(-1.0, 1.0)).collect();
        let (more, beyond) = (random.below(16) / 15, random.below(8) / 7);
        let mut weights = weights(random, n + more);
        if random.once_in(16) {
            weights = vec![0.0; n];
        }
        let count = random.below(3);
        let locked: Vec<usize> = (0..count).map(|_| random.below(n + beyond)).collect();
        match ActuationMap::of(&m.state(&q).unwrap(), &weights, &locked) {
            Ok(map) => actuation_map(random, record, &map),
            Err(error) => record.text(error),
        }
    });
}

/// Limits of some coordinates, of which a few do not move.
fn limited(random: &mut Random<'_>, m: &Mechanism) -> Mechanism {
    let mut all: Vec<(&str, JointLimits)> = Vec::new();
    for c in m.coordinates() {
        let velocity = match random.below(10) {
            0 => Some(0.0),
            1 | 2 => Some(random.power(-1.0, 1.0)),
            _ => None,
        };
        all.push((&c.name, JointLimits { velocity, ..JointLimits::default() }));
    }
    m.with_limits(&all).unwrap_or_else(|_| m.clone())
}

fn servo(random: &mut Random<'_>, record: &mut Record, m: &Mechanism) {
    let mut options = ServoOptions::new(m);
    options.dt = 1e-3;
    options.task = [Task::POSE, Task::POSITION][random.below(2)];
    options.joint_weights = weights(random, m.n());
    if random.once_in(2) {
        options.acceleration = Some(random.power(-1.0, 2.0));
    }
    let mut servo = match Servo::new(m, options) {
        Ok(servo) => servo,
        Err(error) => return record.text(error),
    };
    let mut q = m.home().to_vec();
    let speed = random.power(-1.0, 1.0);
    let command = Twist { linear: random.vec3(speed * m.reach()), angular: random.vec3(speed) };
    let noise = if random.once_in(3) { 0.0 } else { random.power(-5.0, -2.0) };
    for _ in 0..3 {
        let measured: Vec<f64> = q.iter().map(|x| x + noise * random.within(-1.0, 1.0)).collect();
        match servo.step_twist(&measured, Some(command)) {
            Err(error) => return record.text(error),
            Ok(step) => record.word(&step.step.rank),
        }
        let all = [servo.joint_velocities(), servo.loop_closure_velocities()].map(<[f64]>::to_vec);
        record.numbers(&all.map(sum));
        record.number(1e3 * sum(servo.configuration().iter().zip(&q).map(|(a, b)| a - b)));
        servo.advance(&mut q);
        record.number(1e3 * sum(q.iter().zip(m.home()).map(|(a, b)| a - b)));
    }
}

#[test]
fn servos() {
    let all = [&LINKAGES[..], &ROBOTS[..]].concat();
    let names = Names::of(&all);
    check("mobility_servos", 90, |random, record| {
        let m = closed_chain(random, &names);
        let m = limited(random, &m);
        servo(random, record, &m);
    });
}
