//! Posture task: towards a preferred configuration.
//!
//! Formula  k (q_0 - q); of rotation vectors and free bodies k log(R^T R_0) and k R^T (p_0 - p),
//!          velocities in the axes of the child; k log(R_0 R^T) of reversed joints
//! Shapes   velocities of the n coordinates that move the end effector
//! Units    k in 1/s
//! Valid    any coordinates
//! Source   Liegeois 1977
//! Checked  tests/it/servo/secondary.rs::secondary_tasks_do_what_they_say

use super::Context;
use crate::model::{CoordinateKind, Mechanism};
use crate::spatial::{Rotation, Vec3};

/// Adds the velocities towards `q` (all coordinates of the mechanism) to `out`.
pub(super) fn add(context: &Context<'_>, q: &[f64], gain: f64, out: &mut [f64]) {
    let chain = context.chain;
    if context.task.turns_and_slides {
        let here = chain.coordinates().iter().zip(chain.q());
        for (velocity, (&c, here)) in out.iter_mut().zip(here) {
            *velocity += gain * (q[c] - here);
        }
        return;
    }
    let mut i = 0;
    while i < out.len() {
        let kind = (context.coordinate(i).kind, context.is_reversed(i));
        let (here, there) = (&chain.q()[i..], &q[chain.coordinates()[i]..]);
        i += add_joint(kind, here, there, gain, &mut out[i..]);
    }
}

/// Adds the velocities from one configuration of a mechanism to another to `out`.
pub(in crate::control) fn add_all(
    mechanism: &Mechanism,
    here: &[f64],
    there: &[f64],
    gain: f64,
    out: &mut [f64],
) {
    let mut i = 0;
    while i < out.len() {
        let coordinate = &mechanism.coordinates()[i];
        let reversed = mechanism.joints()[coordinate.joint].reversed;
        i += add_joint((coordinate.kind, reversed), &here[i..], &there[i..], gain, &mut out[i..]);
    }
}

/// Adds the velocities from one configuration to another of the joint that the first coordinate
/// belongs to; returns the number of its coordinates.
fn add_joint(
    (kind, reversed): (CoordinateKind, bool),
    here: &[f64],
    there: &[f64],
    gain: f64,
    out: &mut [f64],
) -> usize {
    let vector = |x: &[f64], i: usize| Vec3::new(x[i], x[i + 1], x[i + 2]);
    let mut add = |i: usize, v: Vec3| {
        out[i..].iter_mut().zip(v.to_array()).for_each(|(velocity, x)| *velocity += gain * x);
    };
    let rotation = |i: usize| {
        let back = Rotation::exp(vector(here, i)).inverse();
        let there = Rotation::exp(vector(there, i));
        (back, if reversed { there * back } else { back * there }.log())
    };
    match kind {
        CoordinateKind::Angle | CoordinateKind::Length => {
            out[0] += gain * (there[0] - here[0]);
            1
        }
        CoordinateKind::RotationVector => {
            add(0, rotation(0).1);
            3
        }
        // A free body: its position, then its rotation vector.
        CoordinateKind::Position => {
            let (back, turned) = rotation(3);
            add(0, back * (vector(there, 0) - vector(here, 0)));
            add(3, turned);
            6
        }
    }
}
