//! Branches of closed configurations through a configuration where not every first-order motion is
//! finite.
//!
//! Method   on the sphere |x| = h of first-order motions, zeros of the reduced equation g (see
//!          `lyapunov_schmidt.rs`) are searched by damped Gauss-Newton from random starts. A zero
//!          whose own motions are finite lies on a branch; it is continued inwards, to both sides
//!          of the configuration, and the motions there yield the tangent of the branch
//! Shapes   x: k, a tangent: k x dimension
//! Units    none (scaled)
//! Valid    branches of dimension k - 1 are found reliably, thin ones among many motions perhaps
//!          not; the caller reports this. If g is one function with a Hessian of full rank, its
//!          zeros are those of the quadric (Morse lemma), and the count is proved
//! Why so   zeros of the quadratic part alone would include branches that third-order terms destroy
//! Checked  tests/it/closure/finite.rs

use super::lyapunov_schmidt::{LyapunovSchmidt, ReducedPoint};
use crate::error::Result;
use crate::inverse::damp;
use crate::linalg::{ColumnSpace, Matrix, Svd, Threshold, dot, norm};
use crate::model::Mechanism;
use crate::tolerance::{
    BRANCH_RANK, BRANCH_SPREAD, BRANCH_TURN, CLOSURE_RANK, SAME_BRANCH, TRACKED, TRACKED_AT_LEAST,
};

/// Maximum number of steps of a search.
const MAX_STEPS: usize = 60;
/// Distance at which the tangent is taken, relative to the sphere.
const INWARDS: f64 = 1.0 / 64.0;
/// More tangents of one dimension than this belong to a cone.
const MAX_TANGENTS: usize = 3;

/// A branch in coordinates of the motions to first order.
pub(crate) struct Tangent {
    pub(crate) dimension: usize,
    /// Orthonormal columns; more than the dimension if the branch is a cone.
    pub(crate) directions: Matrix,
    /// Closed configurations on it, on both sides.
    pub(crate) configurations: Vec<Vec<f64>>,
    /// Closed configurations on it a finite way off, and their distance.
    pub(crate) far: Vec<Vec<f64>>,
    pub(crate) tracked: f64,
    /// Threshold for ranks there: on a branch that is shaky all along, positions are known to the
    /// root of rounding only.
    pub(crate) rank: f64,
}

/// The result of a search.
pub(crate) struct Found {
    pub(crate) tangents: Vec<Tangent>,
    /// True if the search is proved to be complete.
    pub(crate) complete: bool,
}

fn times(x: &[f64], factor: f64) -> Vec<f64> {
    x.iter().map(|x| factor * x).collect()
}

/// Distance at which the rank of a configuration on a branch is above the error of its position.
fn resolved(reduction: &LyapunovSchmidt<'_>) -> f64 {
    (reduction.tolerance() / BRANCH_RANK).sqrt()
}

/// The branches through the configuration of `reduction`, searched at the distance `h` or beyond.
pub(crate) fn branches(
    mechanism: &Mechanism,
    length: f64,
    reduction: &LyapunovSchmidt<'_>,
    h: f64,
) -> Result<Found> {
    let k = reduction.motions();
    let h = h.max(4.0 * resolved(reduction));
    let starts = (0..(16 + 8 * k as u64).min(64)).map(|number| reduction.direction(number));
    let mut tangents: Vec<Tangent> = Vec::new();
    let mut sound = true;
    for start in starts {
        let Some((x, near)) = zero(reduction, &times(&start, h), h)? else { continue };
        let Some(here) = Here::of(mechanism, &near.q, length, h)? else {
            sound = false;
            continue;
        };
        sound &= here.clear;
        if here.motions.cols() == 0 {
            continue;
        }
        let Some(mut tangent) = tangent(mechanism, length, reduction, (&x, h), &here)? else {
            sound = false;
            continue;
        };
        if tangents.iter().any(|t| same(t, &tangent)) {
            continue;
        }
        if here.clear {
            let out = &here.motions.transpose() * &(reduction.kernel() * &column(&x));
            let Some((q, tracked)) = outwards(mechanism, length, &near.q, &here, out, h)? else {
                sound = false;
                continue;
            };
            (tangent.far, tangent.tracked) = (vec![q], tracked);
            sound &= tracked >= TRACKED_AT_LEAST;
        } else {
            (tangent.far, tangent.tracked, tangent.rank) = (vec![near.q], h, BRANCH_RANK * h);
        }
        tangents.push(tangent);
    }
    let tangents = merged(tangents, k);
    let largest = tangents.first().map_or(0, |t| t.dimension);
    let proved = morse(reduction, h)? == Some(largest);
    Ok(Found { tangents, complete: sound && proved })
}

/// The motions of a branch at one of its configurations, scaled.
struct Here {
    motions: Matrix,
    /// True if they are all first-order motions.
    clear: bool,
}

impl Here {
    /// At `q`, at the distance `h` from the crossing of branches; none if no step converges.
    fn of(mechanism: &Mechanism, q: &[f64], length: f64, h: f64) -> Result<Option<Self>> {
        let at = LyapunovSchmidt::of(mechanism, q, length, BRANCH_RANK * h)?;
        match followed(&at, h * BRANCH_RANK.sqrt())? {
            None => Ok(None),
            Some(true) => Ok(Some(Self { motions: at.kernel().clone(), clear: true })),
            Some(false) => {
                // Shaky along the whole branch: the steps that converge span its motions.
                let (k, h) = (at.motions(), 0.25 * h);
                let mut found = Matrix::zeros(k, 0);
                for number in 0..4 * k as u64 + 4 {
                    let start = times(&at.direction(number), h);
                    if let Some((x, _)) = zero(&at, &start, h)? {
                        found = Matrix::hstack(k, &[&found, &column(&times(&x, 1.0 / h))]);
                    }
                }
                let space = ColumnSpace::of(&found, Threshold::Absolute(BRANCH_SPREAD));
                Ok(Some(Self { motions: at.kernel() * &space.basis(), clear: false }))
            }
        }
    }
}

fn column(x: &[f64]) -> Matrix {
    Matrix::from_fn(x.len(), 1, |i, _| x[i])
}

/// Whether steps along all motions are finite; none if Newton's method fails.
fn followed(reduction: &LyapunovSchmidt<'_>, h: f64) -> Result<Option<bool>> {
    if reduction.dependent() == 0 {
        return Ok(Some(true));
    }
    for number in 0..2 * reduction.motions() as u64 {
        let Some(near) = reduction.step(&times(&reduction.direction(number), h))? else {
            return Ok(None);
        };
        if near.error() > reduction.tolerance() {
            return Ok(Some(false));
        }
    }
    Ok(Some(true))
}

/// A zero of g at the distance `h`, from `start`.
fn zero(
    reduction: &LyapunovSchmidt<'_>,
    start: &[f64],
    h: f64,
) -> Result<Option<(Vec<f64>, ReducedPoint)>> {
    let mut x = start.to_vec();
    let Some(mut now) = reduction.step(&x)? else { return Ok(None) };
    let mut damping = 1e-3;
    for _ in 0..MAX_STEPS {
        // On the sphere: without the component along x.
        let k = x.len();
        let outwards = now.rates.mul_vec(&x);
        let rates = Matrix::from_fn(now.rates.rows(), k, |i, j| {
            now.rates[(i, j)] - outwards[i] * x[j] / (h * h)
        });
        let svd = Svd::of(&rates);
        if svd.is_empty() || !(svd.value(0) > 0.0) || damping > 1e6 {
            break;
        }
        let l = damping * svd.value(0);
        let step = svd.apply_gains(&now.residual, |_, s| damp(s, l));
        let next: Vec<f64> = x.iter().zip(&step).map(|(x, d)| x - d).collect();
        let next = times(&next, h / norm(&next));
        match reduction.step(&next)? {
            Some(near) if near.error() < now.error() => {
                let little = near.error() > 0.5 * now.error();
                (x, now) = (next, near);
                damping *= 0.1;
                if little && now.error() <= reduction.tolerance() {
                    break; // rounding
                }
            }
            _ if now.error() <= reduction.tolerance() => break,
            _ => damping = 10.0 * damping.max(1e-6),
        }
    }
    Ok((now.error() <= reduction.tolerance()).then_some((x, now)))
}

/// The tangent of a branch at the configuration, from configurations on both sides of it.
fn tangent(
    mechanism: &Mechanism,
    length: f64,
    reduction: &LyapunovSchmidt<'_>,
    (x, h): (&[f64], f64),
    there: &Here,
) -> Result<Option<Tangent>> {
    let inwards = if there.clear { INWARDS.max(resolved(reduction) / h) } else { 0.25 };
    let small = h * inwards;
    let mut sides = Vec::new();
    let mut configurations = Vec::new();
    for side in [inwards, -inwards] {
        let Some((near_x, near)) = zero(reduction, &times(x, side), small)? else { continue };
        let along = dot(&near_x, x);
        if along * side.signum() < BRANCH_TURN * small * h {
            continue;
        }
        let Some(here) = Here::of(mechanism, &near.q, length, small)? else { continue };
        if here.motions.cols() == there.motions.cols() {
            sides.push(&reduction.kernel().transpose() * &here.motions);
            configurations.push(near.q);
        }
    }
    if sides.is_empty() {
        return Ok(None);
    }
    let dimension = there.motions.cols();
    let both = Matrix::hstack(x.len(), &sides.iter().collect::<Vec<_>>());
    let svd = Svd::of(&both);
    let directions = Matrix::from_fn(x.len(), dimension, |i, j| svd.u(j)[i]);
    let (far, tracked, rank) = (Vec::new(), 0.0, CLOSURE_RANK);
    Ok(Some(Tangent { dimension, directions, configurations, far, tracked, rank }))
}

/// A configuration of the branch far from the crossing, from `q` at the distance `h`, and its
/// distance; none if the loops open on the way, so that there is no branch of this dimension.
/// `out`: coefficients of the direction away from the crossing.
fn outwards(
    mechanism: &Mechanism,
    length: f64,
    q: &[f64],
    here: &Here,
    out: Matrix,
    h: f64,
) -> Result<Option<(Vec<f64>, f64)>> {
    let dimension = here.motions.cols();
    let (mut q, mut distance, mut step) = (q.to_vec(), h, 0.5 * h);
    let mut towards = &here.motions * &out;
    // Far enough, what opens with a high power has a clear rank.
    let rank = |distance: f64| if distance < 0.1 { BRANCH_RANK * distance } else { CLOSURE_RANK };
    while distance < TRACKED * (1.0 - 1e-9) {
        step = step.min(TRACKED - distance);
        let at = LyapunovSchmidt::of(mechanism, &q, length, rank(distance))?;
        if at.motions() < dimension {
            return Ok(None);
        }
        let along = at.kernel().transpose().mul_vec(towards.column(0));
        let share = norm(&along) / norm(towards.column(0));
        if !(share > BRANCH_TURN) {
            return Ok((at.motions() == dimension).then_some((q, distance)));
        }
        let x = times(&along, step / norm(&along));
        match at.step(&x)? {
            Some(near) if near.error() <= at.tolerance_at(step) => {
                towards = at.kernel() * &column(&x);
                q = near.q;
                distance = if step < TRACKED - distance { distance + step } else { TRACKED };
                step = (0.5 * distance).min(1.0 / 16.0);
            }
            // Open although the motion is one to first order: a contact, unless the step is long.
            Some(_) if step <= 0.1 * distance => return Ok(None),
            _ if step < 0.01 * distance => break,
            _ => step *= 0.5,
        }
    }
    Ok(Some((q, distance)))
}

fn same(a: &Tangent, b: &Tangent) -> bool {
    a.dimension == b.dimension && {
        let between = Svd::of(&(&a.directions.transpose() * &b.directions));
        between.value(between.len() - 1) > 1.0 - SAME_BRANCH * SAME_BRANCH
    }
}

/// Largest first; too many tangents of one dimension are merged into a cone.
fn merged(mut tangents: Vec<Tangent>, k: usize) -> Vec<Tangent> {
    let mut merged: Vec<Tangent> = Vec::new();
    for dimension in (1..=k).rev() {
        let (mut of, others): (Vec<_>, Vec<_>) =
            tangents.into_iter().partition(|t| t.dimension == dimension);
        tangents = others;
        if dimension > 1 && of.len() > MAX_TANGENTS {
            let all = Matrix::hstack(k, &of.iter().map(|t| &t.directions).collect::<Vec<_>>());
            of.truncate(1);
            of[0].directions = ColumnSpace::of(&all, Threshold::Absolute(SAME_BRANCH)).basis();
        }
        merged.extend(of);
    }
    merged
}

/// The dimension of the zeros of g if it is one function with a Hessian of full rank.
fn morse(reduction: &LyapunovSchmidt<'_>, h: f64) -> Result<Option<usize>> {
    let k = reduction.motions();
    let mut samples = Matrix::zeros(reduction.dependent(), 2 * k + 2);
    for j in 0..samples.cols() {
        let Some(near) = reduction.step(&times(&reduction.direction(j as u64), h))? else {
            return Ok(None);
        };
        samples.column_mut(j).copy_from_slice(&near.residual);
    }
    let space = ColumnSpace::of(&samples, Threshold::Absolute(reduction.tolerance()));
    if space.rank() != 1 {
        return Ok(None);
    }
    let along = space.basis();
    // Both sides of the configuration: third-order terms cancel.
    let even = |x: &[f64]| -> Result<Option<f64>> {
        let mut sum = 0.0;
        for side in [h, -h] {
            let Some(near) = reduction.step(&times(x, side))? else { return Ok(None) };
            sum += dot(&near.residual, along.column(0));
        }
        Ok(Some(sum))
    };
    // Times h^2: only its ratios count.
    let mut hessian = Matrix::zeros(k, k);
    // The diagonal first: the other entries follow from sums.
    let pairs = (0..k).map(|i| (i, i)).chain((0..k).flat_map(|i| (0..i).map(move |j| (i, j))));
    for (i, j) in pairs {
        let mut x = vec![0.0; k];
        x[i] = 1.0;
        x[j] = 1.0;
        let Some(value) = even(&x)? else { return Ok(None) };
        let off = 0.5 * (value - hessian[(i, i)] - hessian[(j, j)]);
        hessian[(i, j)] = if i == j { value } else { off };
        hessian[(j, i)] = hessian[(i, j)];
    }
    let svd = Svd::of(&hessian);
    // Accurate to h^2.
    if !(svd.value(k - 1) > h * svd.value(0)) {
        return Ok(None);
    }
    let trace: f64 = (0..k).map(|i| hessian[(i, i)]).sum();
    let definite = trace.abs() > (1.0 - 1e-6) * svd.values().sum::<f64>();
    Ok(Some(if definite { 0 } else { k - 1 }))
}
