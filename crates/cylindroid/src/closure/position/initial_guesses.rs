//! Initial guesses: random restarts for assembly, reproducible on every run.
//!
//! Units    distances have none: lengths are divided by the reach
//! Valid    any mechanism; guesses respect position limits, their loops are open
//! Source   Shoemake 1992 for rotations
//! Checked  tests/it/closure/modes.rs, tests/it/closure/diagnosis.rs

use std::f64::consts::{PI, TAU};

use super::coordinates::{moved, within_limits};
use crate::model::{CoordinateKind, Mechanism, NodeKind};
use crate::scalar::uniform;
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

/// A random configuration within the limits: angles uniform in (-pi, pi], lengths up to the reach,
/// rotations uniform.
pub(crate) fn random(
    mechanism: &Mechanism,
    guess: &[f64],
    free: &[usize],
    seed: &mut u64,
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
        q[i] = upper - (upper - lower) * uniform(seed);
    }
    for node in mechanism.nodes() {
        let at = match node.kind {
            NodeKind::Spherical => node.coordinate,
            NodeKind::Free => node.coordinate + 3,
            _ => continue,
        };
        if free.contains(&at) {
            q[at..at + 3].copy_from_slice(&random_rotation(seed));
        }
    }
    q
}

/// A uniformly distributed rotation, as a rotation vector (Shoemake 1992).
fn random_rotation(seed: &mut u64) -> [f64; 3] {
    let (share, a, b) = (uniform(seed), TAU * uniform(seed), TAU * uniform(seed));
    let (first, second) = ((1.0 - share).sqrt(), share.sqrt());
    let quaternion = Quaternion {
        w: first * a.cos(),
        x: first * a.sin(),
        y: second * b.cos(),
        z: second * b.sin(),
    };
    quaternion.rotation().map_or([0.0; 3], |r| r.log().to_array())
}
