//! Guesses at random for configurations, the same on every run.
//!
//! Units    distances without unit: lengths over the reach
//! Valid    any mechanism; guesses keep position limits, not loops
//! Source   Shoemake 1992 for rotations
//! Checked  tests/it/closure/modes.rs, tests/it/closure/diagnosis.rs

use std::f64::consts::{PI, TAU};

use super::coordinates::{moved, within_limits};
use crate::model::{CoordinateKind, Mechanism, NodeKind};
use crate::scalar::uniform;
use crate::spatial::Quaternion;

/// Every coordinate of `q` changed by up to `far`.
pub(crate) fn near(mechanism: &Mechanism, q: &[f64], far: f64, random: &mut u64) -> Vec<f64> {
    let all: Vec<usize> = (0..mechanism.n()).collect();
    let change: Vec<f64> = all.iter().map(|_| far * (2.0 * uniform(random) - 1.0)).collect();
    within_limits(mechanism, moved(mechanism, q, &all, &change), &all)
}

/// Angles in (-pi, pi], slides in the reach, rotations evenly among all, within the limits.
pub(crate) fn anywhere(
    mechanism: &Mechanism,
    guess: &[f64],
    free: &[usize],
    random: &mut u64,
) -> Vec<f64> {
    let mut q = guess.to_vec();
    for &i in free {
        let coordinate = &mechanism.coordinates()[i];
        let span = match coordinate.kind {
            CoordinateKind::Angle => PI,
            CoordinateKind::Length | CoordinateKind::Position => mechanism.reach(),
            CoordinateKind::RotationVector => continue,
        };
        // Limits beyond one turn are cut to it, wherever they are.
        let l = &coordinate.limits;
        let lower = l.lower.max((-span).min(l.upper - 2.0 * span));
        let upper = l.upper.min(span.max(l.lower + 2.0 * span));
        q[i] = upper - (upper - lower) * uniform(random);
    }
    for node in mechanism.nodes() {
        let at = match node.kind {
            NodeKind::Spherical => node.coordinate,
            NodeKind::Free => node.coordinate + 3,
            _ => continue,
        };
        if free.contains(&at) {
            q[at..at + 3].copy_from_slice(&rotation_at_random(random));
        }
    }
    q
}

/// A rotation vector, all rotations alike (Shoemake 1992).
fn rotation_at_random(random: &mut u64) -> [f64; 3] {
    let (share, a, b) = (uniform(random), TAU * uniform(random), TAU * uniform(random));
    let (first, second) = ((1.0 - share).sqrt(), share.sqrt());
    let quaternion = Quaternion {
        w: first * a.cos(),
        x: first * a.sin(),
        y: second * b.cos(),
        z: second * b.sin(),
    };
    quaternion.rotation().map_or([0.0; 3], |r| r.log().to_array())
}
