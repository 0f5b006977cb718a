//! Posture task: towards a preferred configuration.
//!
//! Formula  s k (q_0 - q), s the largest share at which all joints can stop there (`approach.rs`); of
//!          rotation vectors and free bodies log(R^T R_0) and R^T (p_0 - p) in place of q_0 - q,
//!          velocities in the axes of the child; log(R_0 R^T) of reversed joints
//! Shapes   velocities of the n coordinates that move the end effector
//! Units    k in 1/s
//! Valid    any coordinates
//! Why so   k (q_0 - q) alone asks weak joints for more than they can brake: they swing about the posture.
//!          One s for all: beside a task the joints rest where they would without
//! Source   Liegeois 1977
//! Checked  tests/it/servo/secondary.rs::secondary_tasks_do_what_they_say, tests/it/servo/weak_postures.rs

use super::Context;
use crate::model::{CoordinateKind, Mechanism};
use crate::spatial::{Rotation, Vec3};

/// Adds the velocities towards `q` (all coordinates of the mechanism) to `out`.
pub(super) fn add(context: &Context<'_>, q: &[f64], gain: f64, out: &mut [f64]) {
    let mut share = 1.0_f64;
    ways_of_chain(context, q, |i, way| share = share.min(context.share_of_gain(i, way, gain)));
    ways_of_chain(context, q, |i, way| out[i] += share * gain * way);
}

/// Calls `each` with every coordinate of the chain and its way to `q`.
fn ways_of_chain(context: &Context<'_>, q: &[f64], mut each: impl FnMut(usize, f64)) {
    let chain = context.chain;
    if context.task.turns_and_slides {
        let here = chain.coordinates().iter().zip(chain.q()).enumerate();
        here.for_each(|(i, (&c, here))| each(i, q[c] - here));
        return;
    }
    let mut i = 0;
    while i < chain.n() {
        let kind = (context.coordinate(i).kind, context.is_reversed(i));
        let (here, there) = (&chain.q()[i..], &q[chain.coordinates()[i]..]);
        i += ways_of_joint(kind, here, there, |k, way| each(i + k, way));
    }
}

/// Calls `each` with every coordinate of a mechanism and its way from one configuration to another.
pub(in crate::control) fn ways(
    mechanism: &Mechanism,
    here: &[f64],
    there: &[f64],
    mut each: impl FnMut(usize, f64),
) {
    let mut i = 0;
    while i < mechanism.n() {
        let coordinate = &mechanism.coordinates()[i];
        let reversed = mechanism.joints()[coordinate.joint].reversed;
        let kind = (coordinate.kind, reversed);
        i += ways_of_joint(kind, &here[i..], &there[i..], |k, way| each(i + k, way));
    }
}

/// The same of the joint that the first coordinate belongs to; returns the number of its coordinates.
fn ways_of_joint(
    (kind, reversed): (CoordinateKind, bool),
    here: &[f64],
    there: &[f64],
    mut each: impl FnMut(usize, f64),
) -> usize {
    let vector = |x: &[f64], i: usize| Vec3::new(x[i], x[i + 1], x[i + 2]);
    let mut all = |i: usize, way: Vec3| {
        way.to_array().into_iter().enumerate().for_each(|(k, x)| each(i + k, x));
    };
    let rotation = |i: usize| {
        let back = Rotation::exp(vector(here, i)).inverse();
        let there = Rotation::exp(vector(there, i));
        (back, if reversed { there * back } else { back * there }.log())
    };
    match kind {
        CoordinateKind::Angle | CoordinateKind::Length => {
            each(0, there[0] - here[0]);
            1
        }
        CoordinateKind::RotationVector => {
            all(0, rotation(0).1);
            3
        }
        // A free body: its position, then its rotation vector.
        CoordinateKind::Position => {
            let (back, turned) = rotation(3);
            all(0, back * (vector(there, 0) - vector(here, 0)));
            all(3, turned);
            6
        }
    }
}
