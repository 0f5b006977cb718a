//! Pairs that always touch or never touch, by random configurations and local descent.
//!
//! Formula  always: the pair touches in each of N configurations, uniform within the limits. Never:
//!          in none of them, and from the nearest one a descent along the gradient, within the
//!          limits, ends above the margin
//! Units    m
//! Valid    joints without limits turn once around and slide by the reach. Pairs of
//!          bodies that a free joint moves relative to one another are kept. Not a proof: a pair that
//!          is dropped may touch where neither samples nor descent came
//! Why so   samples alone drop pairs that touch in one configuration of a thousand, which is often;
//!          the descent finds most of them. Loops are left open: what never touches on the tree does
//!          not on the loops either
//! Source   the samples: MoveIt Setup Assistant, self-collision matrix
//! Checked  tests/collision/pairs.rs

use std::f64::consts::PI;

use super::gradient::gradient_into;
use super::options::CollisionOptions;
use super::scene::{NearPair, Scene};
use crate::error::{Error, Result};
use crate::kinematics::State;
use crate::linalg::max_abs;
use crate::model::{CoordinateKind, JointKind, Mechanism};
use crate::scalar::{clamp, uniform};

/// Steps of the descent of a pair at most.
const STEPS: usize = 60;

/// Change of a coordinate in a step, the first and the last (rad or m).
const STEP: [f64; 2] = [0.3, 3e-4];

/// Removes the pairs that always or never touch.
pub(super) fn drop_constant(
    mechanism: &Mechanism,
    scene: &mut Scene,
    options: &CollisionOptions,
) -> Result<()> {
    if !options.never_margin.is_finite() {
        return Err(Error::InvalidOption {
            option: "never_margin",
            value: options.never_margin.to_string(),
            reason: "give a distance in metres".to_owned(),
        });
    }
    if options.samples == 0 || scene.pairs.is_empty() {
        return Ok(());
    }
    let mut state = mechanism.state(mechanism.home())?;
    let bounds: Vec<(f64, f64)> = bounds(mechanism);
    let mut seed = options.seed;
    let count = scene.pairs.len();
    let mut always = vec![true; count];
    // The nearest sample of each pair and its distance.
    let mut nearest = vec![(f64::INFINITY, 0); count];
    let mut samples: Vec<Vec<f64>> = Vec::new();
    for sample in 0..options.samples {
        let q: Vec<f64> = bounds.iter().map(|(l, u)| l + (u - l) * uniform(&mut seed)).collect();
        state.set(&q)?;
        scene.place(&state);
        for pair in 0..count {
            // Once known to touch and to part, a pair is kept.
            if !always[pair] && nearest[pair].0 <= options.never_margin {
                continue;
            }
            let bound = scene.gap_between_bounds(pair);
            always[pair] &= bound <= 0.0;
            if bound > nearest[pair].0 {
                continue;
            }
            if let Some(near) = scene.evaluate(pair) {
                always[pair] &= near.distance <= 0.0;
                if near.distance < nearest[pair].0 {
                    nearest[pair] = (near.distance, sample);
                }
            }
        }
        samples.push(q);
    }
    let mut keep = vec![true; count];
    for pair in 0..count {
        let (distance, sample) = nearest[pair];
        keep[pair] = !always[pair]
            && (distance <= options.never_margin
                || is_free(mechanism, scene, pair)
                || descend(scene, &mut state, pair, &samples[sample], &bounds)?
                    <= options.never_margin);
    }
    let mut kept = keep.into_iter();
    scene.pairs.retain(|_| kept.next().unwrap_or(true));
    Ok(())
}

/// The ranges of the samples.
fn bounds(mechanism: &Mechanism) -> Vec<(f64, f64)> {
    let length = if mechanism.reach() > 0.0 { mechanism.reach() } else { 1.0 };
    let range = |c: &crate::model::Coordinate| {
        let most = if c.kind.is_length() { length } else { PI };
        let (l, u) = (c.limits.lower, c.limits.upper);
        match (l.is_finite(), u.is_finite()) {
            (true, true) => (l, u),
            (true, false) => (l, l + 2.0 * most),
            (false, true) => (u - 2.0 * most, u),
            (false, false) => (-most, most),
        }
    };
    mechanism.coordinates().iter().map(range).collect()
}

/// True if a joint without bounds moves one of the bodies relative to the other.
fn is_free(mechanism: &Mechanism, scene: &Scene, pair: usize) -> bool {
    let pair = scene.pairs[pair];
    let path = |link: Option<usize>| {
        let mut above = Vec::new();
        let mut at = link;
        while let Some(link) = at {
            let joint = mechanism.joints().iter().position(|j| j.child == link);
            above.extend(joint);
            at = joint.map(|j| mechanism.joints()[j].parent);
        }
        above
    };
    let (a, b) = (path(scene.bodies[pair.a].link), path(scene.bodies[pair.b].link));
    let unbounded = |j: &usize| {
        let joint = &mechanism.joints()[*j];
        let slides = mechanism.coordinates()[joint.coordinates.clone()].iter().any(|c| {
            c.kind.is_length() && !(c.limits.lower.is_finite() && c.limits.upper.is_finite())
        });
        slides || joint.kind == JointKind::Free
    };
    let only_in =
        |of: &[usize], other: &[usize]| of.iter().filter(|j| !other.contains(j)).any(unbounded);
    only_in(&a, &b) || only_in(&b, &a)
}

/// The distance at the end of a descent from `start`.
fn descend(
    scene: &mut Scene,
    state: &mut State,
    pair: usize,
    start: &[f64],
    bounds: &[(f64, f64)],
) -> Result<f64> {
    let mechanism = state.mechanism().clone();
    let mut row = vec![0.0; start.len()];
    let mut at = |state: &mut State, q: &[f64]| -> Result<Option<NearPair>> {
        state.set(q)?;
        scene.place(state);
        Ok(scene.evaluate(pair))
    };
    let mut q = start.to_vec();
    let Some(mut best) = at(state, &q)? else { return Ok(f64::INFINITY) };
    let mut largest = STEP[0];
    for _ in 0..STEPS {
        if best.distance <= 0.0 {
            break;
        }
        state.set(&q)?;
        gradient_into(state, &best, &mut row);
        for ((slope, x), (lower, upper)) in row.iter_mut().zip(&q).zip(bounds) {
            // At a limit the descent goes along it.
            if (*slope > 0.0 && x <= lower) || (*slope < 0.0 && x >= upper) {
                *slope = 0.0;
            }
        }
        let square: f64 = row.iter().map(|x| x * x).sum();
        let steepest = max_abs(&row);
        if !(steepest > 0.0) {
            break;
        }
        let step = (best.distance / square).min(largest / steepest);
        let velocity: Vec<f64> = row.iter().map(|x| -step * x).collect();
        let mut next = mechanism.integrate(&q, &velocity, 1.0)?;
        for ((x, (lower, upper)), c) in next.iter_mut().zip(bounds).zip(mechanism.coordinates()) {
            if c.kind != CoordinateKind::RotationVector {
                *x = clamp(*x, *lower, *upper);
            }
        }
        match at(state, &next)? {
            Some(near) if near.distance < best.distance => (q, best) = (next, near),
            _ => {
                largest *= 0.25;
                if largest < STEP[1] {
                    break;
                }
            }
        }
    }
    Ok(best.distance)
}
