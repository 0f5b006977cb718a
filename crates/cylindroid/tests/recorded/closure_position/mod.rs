//! Closed chains: constraints, assemblies, modes, paths, maps and zones, forces and grasps of random
//! mechanisms (see `mechanisms`) and of the catalogue.

mod assemblies;
mod constraints;
mod elasticity;
mod fingers;
mod grasps;
mod loading;
mod maps;
mod mechanisms;
mod paths;
mod platforms;
mod statics;
mod zones;

use cylindroid::closure::LoopClosureError;
use cylindroid::{Error, Mechanism};

use crate::record::Record;
use crate::robots::Random;

/// A sum in which an exchange of two numbers shows.
fn weighted(numbers: &[f64]) -> f64 {
    numbers.iter().enumerate().map(|(i, x)| x / (i as f64 + 1.3)).sum()
}

/// The same of numbers whose common sign is arbitrary.
fn weighted_up_to_sign(numbers: &[f64]) -> f64 {
    weighted(numbers).abs()
}

/// A mechanism with loops, random or of the catalogue.
fn some_chain(random: &mut Random<'_>) -> Mechanism {
    if random.once_in(4) {
        crate::robots::of_catalogue(random, true)
    } else {
        mechanisms::closed_chain(random)
    }
}

/// A configuration at some distance from home.
fn near_home(random: &mut Random<'_>, mechanism: &Mechanism, farthest: f64) -> Vec<f64> {
    let distance = random.power(-3.0, farthest);
    let mut change = |i: usize| {
        let is_length = mechanism.coordinates()[i].kind.unit() == "m";
        let unit = if is_length { mechanism.reach() } else { 1.0 };
        unit * random.within(-distance, distance)
    };
    mechanism.home().iter().enumerate().map(|(i, x)| x + change(i)).collect()
}

/// Some coordinates, each with this probability.
fn some_of(random: &mut Random<'_>, count: usize, once_in: usize) -> Vec<usize> {
    (0..count).filter(|_| random.once_in(once_in)).collect()
}

/// All coordinates of the joints of some of them, with few exceptions, which are refused.
fn whole_joints(
    random: &mut Random<'_>,
    mechanism: &Mechanism,
    mut some: Vec<usize>,
) -> Vec<usize> {
    if random.once_in(30) {
        some.push(random.below(mechanism.n() + 1));
        return some;
    }
    let joint = |i: usize| mechanism.coordinates()[i].joint;
    let chosen = |i: &usize| some.iter().any(|&s| joint(s) == joint(*i));
    (0..mechanism.n()).filter(chosen).collect()
}

/// Numbers of either sign.
fn vector(random: &mut Random<'_>, count: usize, size: f64) -> Vec<f64> {
    (0..count).map(|_| random.within(-size, size)).collect()
}

fn record_closure_error(record: &mut Record, error: LoopClosureError) {
    record.numbers(&[error.distance, error.angle]);
}

/// The beginning of its message, and the numbers in it.
fn record_error(record: &mut Record, error: &Error) {
    let message = error.to_string();
    let letters = message.chars().filter(|c| c.is_alphabetic());
    record.word(&letters.take(28).collect::<String>());
    for word in message.split_whitespace() {
        let number = word.trim_matches(['[', ']', '(', ')', ',', ';', ':', '\'']);
        match number.parse::<f64>() {
            Ok(x) if x.is_finite() && number.contains('.') => record.number(x),
            Ok(_) => record.word(&number),
            Err(_) => {}
        }
    }
}
