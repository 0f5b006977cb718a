//! Crossings: singular configurations of a branch, found on walks along it. Other branches may
//! cross it there.
//!
//! Formula  the r-th singular value s of the loop Jacobian, r its generic rank, over the largest,
//!          with a sign that changes where it vanishes, is analytic along a curve on the branch. A
//!          crossing is the zero of the polynomial through eight samples of s, four on either side,
//!          and its configuration the value of the polynomials through those of the samples
//! Units    of the walk: rad, or characteristic lengths
//! Valid    any branch of closed configurations of dimension one or more. Crossings may be missed:
//!          walks meet those of codimension one that lie across their way, no others. The samples
//!          stay clear of the crossing, where configurations are accurate to the root of rounding
//!          at best; interpolation yields them to ten digits and more
//! Why so   Newton's method for singular points of closed configurations needs second derivatives,
//!          and a start
//! Checked  tests/it/linkages/modes.rs

use crate::closure::mobility::lyapunov_schmidt::LyapunovSchmidt;
use crate::closure::position::loop_closure::LoopClosure;
use crate::error::Result;
use crate::linalg::{Svd, norm};
use crate::model::Mechanism;
use crate::tolerance::{CLOSURE_RANK, CROSSED};

/// Number of walks from a configuration, each to both sides.
const WALKS: u64 = 2;
/// Windows of a walk: each begins in the middle of the one before.
const WINDOWS: usize = 16;
/// Points of a window, and the distance from one to the next.
const COARSE: (usize, f64) = (8, 0.05);
/// The same where a window is searched.
const FINE: (usize, f64) = (56, 0.01);
/// Samples on either side of a crossing.
const SIDE: usize = 4;
/// A minimum is searched if it is below this fraction of the largest value in its window.
const LOW: f64 = 0.5;

/// A point of a curve on the branch.
#[derive(Clone)]
struct Sample {
    /// Distance along the curve.
    at: f64,
    q: Vec<f64>,
    /// The r-th singular value over the largest.
    value: f64,
}

/// The crossings on walks from the closed configuration `q`, which is not singular on its branch.
pub(super) fn crossings(mechanism: &Mechanism, q: &[f64], length: f64) -> Result<Vec<Vec<f64>>> {
    let mut found = Vec::new();
    let start = LyapunovSchmidt::of(mechanism, q, length, CLOSURE_RANK)?;
    let rank = mechanism.n() - start.motions();
    if start.motions() == 0 || rank == 0 || !start.is_closed() {
        return Ok(found);
    }
    let walk = Walk { mechanism, length, rank };
    for number in 0..WALKS {
        let direction = start.direction(number);
        for side in [1.0, -1.0] {
            let direction: Vec<f64> = direction.iter().map(|x| side * x).collect();
            walk.along(q, start.kernel().mul_vec(&direction), &mut found)?;
        }
    }
    Ok(found)
}

struct Walk<'a> {
    mechanism: &'a Mechanism,
    length: f64,
    /// The generic rank of the loop Jacobian.
    rank: usize,
}

impl Walk<'_> {
    /// Walks from `q` along the scaled motion `motion`, and on in the direction that it takes.
    fn along(&self, q: &[f64], mut motion: Vec<f64>, found: &mut Vec<Vec<f64>>) -> Result<()> {
        let mut here = q.to_vec();
        for _ in 0..WINDOWS {
            let window = LyapunovSchmidt::of(self.mechanism, &here, self.length, CLOSURE_RANK)?;
            if self.mechanism.n() - window.motions() != self.rank {
                return Ok(()); // singular, or of another branch
            }
            let x = window.kernel().transpose().mul_vec(&motion);
            let size = norm(&x);
            if !(size > 0.0) {
                return Ok(());
            }
            let direction: Vec<f64> = x.iter().map(|x| x / size).collect();
            motion = window.kernel().mul_vec(&direction);
            let coarse = self.curve(&window, &here, &direction, COARSE)?;
            if let Some(low) = lowest(&coarse) {
                let fine = self.curve(&window, &here, &direction, FINE)?;
                let near = fine.into_iter().filter(|s| s.at < coarse[low].at + 1.5 * COARSE.1);
                found.extend(self.crossing(&near.collect::<Vec<_>>())?);
            }
            // On from the middle, or beside it where it is singular.
            let middle = COARSE.0 / 2;
            let Some(next) = coarse[1..].iter().skip(middle - 1).find(|s| s.value > CROSSED) else {
                return Ok(());
            };
            here.clone_from(&next.q);
        }
        Ok(())
    }

    fn value(&self, q: &[f64]) -> Result<f64> {
        let svd = Svd::of(&LoopClosure::of(self.mechanism, q)?.jacobian);
        Ok(svd.value(self.rank - 1) / svd.value(0))
    }

    /// Samples along a direction of first-order motions. The curve passes over points that Newton's
    /// method cannot reach, and ends at limits.
    fn curve(
        &self,
        window: &LyapunovSchmidt<'_>,
        from: &[f64],
        direction: &[f64],
        (points, distance): (usize, f64),
    ) -> Result<Vec<Sample>> {
        let mut samples = vec![Sample { at: 0.0, q: from.to_vec(), value: self.value(from)? }];
        for i in 1..=points {
            let at = i as f64 * distance;
            let last = &samples[samples.len() - 1];
            let x: Vec<f64> = direction.iter().map(|d| (at - last.at) * d).collect();
            let Some(next) = window.step_from(&last.q, &x)? else { continue };
            if self.mechanism.outside_limits(&next.q).next().is_some() {
                break;
            }
            let open = LoopClosure::of(self.mechanism, &next.q)?;
            if !open.is_closed(self.length) {
                break;
            }
            let value = self.value(&next.q)?;
            samples.push(Sample { at, q: next.q, value });
        }
        Ok(samples)
    }

    /// The configuration between the samples in which the singular value vanishes.
    fn crossing(&self, samples: &[Sample]) -> Result<Option<Vec<f64>>> {
        let Some(low) = lowest(samples) else { return Ok(None) };
        // Clear of the crossing, which is within one step of the lowest sample.
        let gap = 1.5 * FINE.1;
        let clear = |s: &&Sample| (s.at - samples[low].at).abs() > gap;
        let before: Vec<&Sample> = samples[..low].iter().rev().filter(clear).take(SIDE).collect();
        let after: Vec<&Sample> = samples[low..].iter().filter(clear).take(SIDE).collect();
        if before.len() < SIDE || after.len() < SIDE {
            return Ok(None);
        }
        let mut nodes: Vec<(f64, f64, &[f64])> = Vec::new();
        nodes.extend(before.iter().map(|s| (s.at, -s.value, s.q.as_slice())));
        nodes.extend(after.iter().map(|s| (s.at, s.value, s.q.as_slice())));
        let value = |at: f64| interpolated(nodes.iter().map(|(t, v, _)| (*t, *v)), at);
        let (mut low, mut high) = (before[0].at, after[0].at);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if value(middle) < 0.0 { low = middle } else { high = middle }
        }
        let q: Vec<f64> = (0..self.mechanism.n())
            .map(|i| interpolated(nodes.iter().map(|(t, _, q)| (*t, q[i])), low))
            .collect();
        let closed = LoopClosure::of(self.mechanism, &q)?.is_closed(self.length);
        Ok((closed && self.value(&q)? < CROSSED).then_some(q))
    }
}

/// The lowest sample, if it is not at an end and clearly lower than the highest.
fn lowest(samples: &[Sample]) -> Option<usize> {
    let low = (0..samples.len()).min_by(|&a, &b| samples[a].value.total_cmp(&samples[b].value))?;
    let high = samples.iter().map(|s| s.value).fold(0.0, f64::max);
    (low > 0 && low + 1 < samples.len() && samples[low].value < LOW * high).then_some(low)
}

/// The polynomial through the nodes at `at`, by Neville's scheme.
fn interpolated(nodes: impl Iterator<Item = (f64, f64)>, at: f64) -> f64 {
    let (places, mut values): (Vec<f64>, Vec<f64>) = nodes.unzip();
    for span in 1..places.len() {
        for i in 0..places.len() - span {
            let (a, b) = (places[i], places[i + span]);
            values[i] = ((at - b) * values[i] - (at - a) * values[i + 1]) / (a - b);
        }
    }
    values[0]
}
