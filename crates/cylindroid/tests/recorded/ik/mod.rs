//! Inverse kinematics: the solutions, what they cost, and the reasons where there are none.
//!
//! Why so   tolerances are wide in most cases, so that the last step of a search shows the way to it

mod analytic;
mod arms;
mod avoidance;
mod closed;
mod criteria;
mod nearest;
mod refusals;
mod search;

use std::time::Duration;

use cylindroid::ik::{Budget, IkOptions, MissReason, Solution};
use cylindroid::model::Limits;
use cylindroid::{Mechanism, Result};

use crate::record::Record;
use crate::robots::{ClampTo, Random};

/// A sum in which the order of the numbers counts.
fn sum(numbers: &[f64]) -> f64 {
    numbers.iter().enumerate().map(|(i, x)| x / (i as f64 + 1.3)).sum()
}

/// A solution: how it was found, or why not; counts; a sum of the configuration and of errors, those of
/// positions over the size of the mechanism.
fn note(record: &mut Record, found: &Solution, size: f64) {
    assert_eq!(found.success, found.reason.is_none());
    let name = found.reason.as_ref().map_or(found.found_by.name(), MissReason::name);
    record.word(&name);
    record.word(&found.restarts);
    record.word(&found.iterations);
    match &found.reason {
        Some(MissReason::Limits { joints }) => record.word(&joints.concat()),
        Some(MissReason::HalfSpaces { names }) => record.word(&names.concat()),
        Some(MissReason::OutOfReach { distance, length }) => {
            record.numbers(&[distance / size, length / size]);
        }
        Some(MissReason::Collision { between, distance }) => {
            record.word(&between.concat());
            record.number(distance / size);
        }
        _ => {}
    }
    let (distance, length) = found.out_of_reach.unwrap_or_default();
    let errors = [found.position_error, distance, length].map(|x| x / size);
    record.number(sum(&errors) + 0.7 * found.orientation_error + sum(&found.q));
    if let Some(value) = found.criterion {
        record.number(if value > 0.0 { value.ln() } else { value });
    }
}

/// Several solutions: their number, the first one, and a sum of the others.
fn note_all(record: &mut Record, all: &[Solution], size: f64) {
    record.word(&all.len());
    let Some((first, others)) = all.split_first() else { return };
    note(record, first, size);
    let one = |found: &Solution| {
        let analytic = f64::from(u8::from(found.found_by.name() == "analytic"));
        sum(&found.q) + analytic + found.criterion.unwrap_or_default()
    };
    if !others.is_empty() {
        record.number(sum(&others.iter().map(one).collect::<Vec<_>>()));
    }
}

fn note_result(record: &mut Record, result: Result<Solution>, size: f64) {
    match result {
        Ok(found) => note(record, &found, size),
        Err(error) => record.word(&error.to_string()),
    }
}

/// Limits of all kinds: none, of several turns, beyond half a turn, narrow, at one side.
fn limits(random: &mut Random<'_>) -> Limits {
    let (lower, upper) = match random.below(10) {
        0 => (f64::NEG_INFINITY, f64::INFINITY),
        1 => (f64::NEG_INFINITY, random.within(0.5, 3.0)),
        2 => (random.within(-12.0, -6.0), random.within(6.0, 12.0)),
        3 => (random.within(1.0, 4.0), random.within(5.0, 10.0)),
        4 => (random.within(-0.3, 0.0), random.within(0.1, 0.4)),
        _ => (random.within(-3.0, -1.0), random.within(1.0, 3.0)),
    };
    Limits { lower, upper, ..Limits::NONE }
}

/// Tolerances for lengths of this size, a guess, a budget, a seed, in a few cases a characteristic
/// length and coordinates that keep their values.
fn options(random: &mut Random<'_>, robot: &Mechanism, size: f64) -> IkOptions {
    let wide = !random.once_in(4);
    let mut tolerance = || if wide { random.power(-2.5, -0.5) } else { 1e-6 };
    let (position_tolerance, orientation_tolerance) = (size * tolerance(), tolerance());
    let iterations = [1, 2, 3, 7, 30, 60, 120, 250, 500][random.below(9)];
    let time = [None, None, None, Some(Duration::from_secs(1000)), Some(Duration::ZERO)];
    let time = time[random.below(if iterations > 30 { 5 } else { 4 })];
    IkOptions {
        position_tolerance,
        orientation_tolerance,
        initial_guess: (!random.once_in(3)).then(|| random.configuration(robot)),
        fixed: if random.once_in(5) { vec![random.below(robot.n())] } else { Vec::new() },
        seed: random.below(1000) as u64,
        budget: Budget { iterations, time },
        length: random.once_in(4).then(|| size * random.power(-1.0, 1.0)),
        ..IkOptions::default()
    }
}

/// A configuration beside another one, within the limits.
fn beside(random: &mut Random<'_>, robot: &Mechanism, q: &[f64], far: f64) -> Vec<f64> {
    let limits = robot.coordinates().iter().map(|c| &c.limits);
    let all = q.iter().zip(limits);
    all.map(|(x, l)| (x + random.within(-far, far)).clamp_to(l.lower, l.upper)).collect()
}
