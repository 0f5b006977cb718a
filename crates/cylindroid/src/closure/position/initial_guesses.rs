//! Initial guesses: random restarts for assembly, reproducible on every run.
//!
//! Units    distances have none: lengths are divided by the characteristic length
//! Valid    any mechanism; guesses respect position limits, their loops are open. Random numbers
//!          are drawn one after the other (`random`) or belong to the names of the coordinates, so
//!          that the order of the joints does not change them (`random_by_name`)
//! Source   Shoemake 1992 for rotations
//! Checked  tests/it/closure/modes.rs, tests/it/closure/diagnosis.rs

use std::f64::consts::{PI, TAU};

use super::coordinates::{moved, within_limits};
use crate::model::{CoordinateKind, Mechanism, NodeKind};
use crate::scalar::{fnv1a, uniform};
use crate::spatial::Quaternion;

/// `q` with a random perturbation of every coordinate by up to `amplitude`.
pub(crate) fn perturbed(
    mechanism: &Mechanism,
    q: &[f64],
    amplitude: f64,
    seed: &mut u64,
) -> Vec<f64> {
    let all: Vec<usize> = (0..mechanism.n()).collect();
    let change: Vec<f64> = all.iter().map(|_| amplitude * (2.0 * uniform(seed) - 1.0)).collect();
    within_limits(mechanism, moved(mechanism, q, &all, &change), &all)
}

/// A random configuration within the limits: angles uniform in (-pi, pi], lengths up to the
/// characteristic length, rotations uniform.
pub(crate) fn random(
    mechanism: &Mechanism,
    guess: &[f64],
    free: &[usize],
    seed: &mut u64,
) -> Vec<f64> {
    drawn(mechanism, guess, free, |_| uniform(seed))
}

/// The same with random numbers that belong to the names of the coordinates. `restart`: the seed of
/// the search and the number of the restart.
pub(crate) fn random_by_name(
    mechanism: &Mechanism,
    guess: &[f64],
    free: &[usize],
    restart: [u64; 2],
) -> Vec<f64> {
    let number = restart[0].wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(restart[1]);
    let coordinates = mechanism.coordinates();
    drawn(mechanism, guess, free, |i| 0.5 + 0.5 * by_name(&coordinates[i].name, number))
}

/// `share`: a random number in (0, 1) for a coordinate.
fn drawn(
    mechanism: &Mechanism,
    guess: &[f64],
    free: &[usize],
    mut share: impl FnMut(usize) -> f64,
) -> Vec<f64> {
    let mut q = guess.to_vec();
    for &i in free {
        let coordinate = &mechanism.coordinates()[i];
        let span = match coordinate.kind {
            CoordinateKind::Angle => PI,
            CoordinateKind::Length | CoordinateKind::Position => mechanism.reach(),
            CoordinateKind::RotationVector => continue,
        };
        // Limits wider than one turn are cut to one turn.
        let l = &coordinate.limits;
        let lower = l.lower.max((-span).min(l.upper - 2.0 * span));
        let upper = l.upper.min(span.max(l.lower + 2.0 * span));
        q[i] = upper - (upper - lower) * share(i);
    }
    for node in mechanism.nodes() {
        let at = match node.kind {
            NodeKind::Spherical => node.coordinate,
            NodeKind::Free => node.coordinate + 3,
            _ => continue,
        };
        if free.contains(&at) {
            q[at..at + 3].copy_from_slice(&rotation([share(at), share(at + 1), share(at + 2)]));
        }
    }
    q
}

/// A uniformly distributed rotation, as a rotation vector, from three numbers uniform in
/// (0, 1) (Shoemake 1992).
fn rotation([share, a, b]: [f64; 3]) -> [f64; 3] {
    let (a, b) = (TAU * a, TAU * b);
    let (first, second) = ((1.0 - share).sqrt(), share.sqrt());
    let quaternion = Quaternion {
        w: first * a.cos(),
        x: first * a.sin(),
        y: second * b.cos(),
        z: second * b.sin(),
    };
    quaternion.rotation().map_or([0.0; 3], |r| r.log().to_array())
}

/// A random number in (-1, 1) that belongs to a name.
pub(crate) fn by_name(name: &str, number: u64) -> f64 {
    let mut seed = fnv1a(name.bytes()) ^ number.wrapping_mul(0x9e37);
    2.0 * uniform(&mut seed) - 1.0
}
