//! The point of a singularity locus, or of a limit, nearest to a centre in some coordinates.
//!
//! Formula  min |e|, e_i = (q_i - c_i) / w_i over the chosen coordinates, on r = 0, g = 0
//!          (singular_curve.rs). With P the projector on the kernel of A = [J; grad g], E the rows of
//!          the chosen coordinates and G = E P E^T, a change y of e in the range of G costs
//!          dx = P E^T G+ y. Ball: y = -G G+ e, the way to the point of the tangent plane nearest to
//!          the centre. Box: the y with c . y = 0, c the normal, and |y_i| <= radius of trust that
//!          makes the largest |e_i + y_i| smallest. Back on the locus by Newton's method of least norm;
//!          steps are halved until |e| falls
//! Shapes   e: k, G: k x k of rank k - 1 where the locus bounds the coordinates
//! Units    none: e in multiples of the scales w
//! Valid    local minima: which one depends on the seed. A step never leads to a larger |e|
//! Why so   the tangent step needs no second derivatives of g, and converges linearly, by the curvature
//!          of the locus times |e|; |e| at the point found has the square of its error
//! Source   Hasofer & Lind 1974 and Rackwitz & Fiessler 1978 for the step; Li, Gosselin & Richard 2007
//!          for singularity-free zones
//! Checked  tests/map/zone.rs

use super::coordinates::{largest_change, moved};
use super::singular_curve::{CurvePoint, CurveTracer};
use crate::error::Result;
use crate::linalg::{Matrix, Svd, dot, max_abs, norm};

/// Maximum number of steps.
const MAX_STEPS: usize = 200;
/// Largest change of a coordinate in a step [rad, or characteristic lengths].
const LONGEST: f64 = 0.3;
/// Share of the predicted gain that a step has at least.
const GAIN: f64 = 0.1;
/// Relative gain at which the search ends.
const CONVERGED: f64 = 1e-13;
/// Rank of G, relative.
const RANK: f64 = 1e-9;

/// Distances from a centre in some coordinates.
#[derive(Debug, Clone)]
pub(crate) struct CentredNorm {
    /// The coordinates, their centre and scales (m or rad).
    pub(crate) places: Vec<usize>,
    pub(crate) centre: Vec<f64>,
    pub(crate) scales: Vec<f64>,
    /// The largest of the |e_i| instead of their Euclidean norm.
    pub(crate) largest: bool,
}

impl CentredNorm {
    /// e of a configuration.
    pub(crate) fn offset(&self, q: &[f64]) -> Vec<f64> {
        let all = self.places.iter().zip(&self.centre).zip(&self.scales);
        all.map(|((&i, c), w)| (q[i] - c) / w).collect()
    }

    pub(crate) fn size(&self, offset: &[f64]) -> f64 {
        if self.largest { max_abs(offset) } else { norm(offset) }
    }
}

impl CurveTracer {
    /// A local minimum of the distance on the locus from a seed near it: configuration and distance.
    pub(crate) fn nearest(
        &mut self,
        seed: &[f64],
        about: &CentredNorm,
    ) -> Result<Option<(Vec<f64>, f64)>> {
        let Some(mut here) = self.corrected(seed.to_vec(), false)? else { return Ok(None) };
        let mut size = about.size(&about.offset(&here.q));
        let mut trust = f64::INFINITY;
        for _ in 0..MAX_STEPS {
            let e = about.offset(&here.q);
            let plane = TangentPlane::of(self, &here, about);
            let trusted = if trust.is_finite() { trust } else { 2.0 * size };
            let y = if about.largest { plane.of_box(&e, trusted) } else { plane.of_ball(&e) };
            let there: Vec<f64> = e.iter().zip(&y).map(|(e, y)| e + y).collect();
            let gain = size - about.size(&there);
            if !(gain > CONVERGED * size) {
                break;
            }
            let full = plane.change(&y);
            let most = largest_change(self.mechanism(), self.unknown(), &full);
            let mut share = (LONGEST / most.max(f64::MIN_POSITIVE)).min(1.0);
            let mut next = None;
            while share > 1e-7 {
                let change: Vec<f64> = full.iter().map(|x| share * x).collect();
                let guess = moved(self.mechanism(), &here.q, self.unknown(), &change);
                if let Some(point) = self.corrected(guess, false)? {
                    let now = about.size(&about.offset(&point.q));
                    if now < size - GAIN * share * gain {
                        next = Some((point, now));
                        break;
                    }
                }
                share *= 0.5;
            }
            let moved_by = share * max_abs(&y);
            trust = if share < 1.0 { moved_by } else { 2.0 * moved_by };
            let Some((point, now)) = next else { break };
            (here, size) = (point, now);
        }
        Ok(Some((here.q, size)))
    }
}

/// The changes of e that stay on the locus to first order.
struct TangentPlane {
    /// P E^T.
    columns: Matrix,
    svd: Svd,
    rank: usize,
}

impl TangentPlane {
    fn of(tracer: &CurveTracer, at: &CurvePoint, about: &CentredNorm) -> Self {
        let (unknown, k) = (tracer.unknown(), about.places.len());
        let mut columns = Matrix::zeros(unknown.len(), k);
        let mut rows = Vec::with_capacity(k);
        for (j, (place, scale)) in about.places.iter().zip(&about.scales).enumerate() {
            let mut row = vec![0.0; unknown.len()];
            if let Some(own) = unknown.iter().position(|i| i == place) {
                row[own] = tracer.unit(*place) / scale;
            }
            columns.column_mut(j).copy_from_slice(&tracer.projected(at, &row));
            rows.push(row);
        }
        let g = Matrix::from_fn(k, k, |i, j| dot(&rows[i], columns.column(j)));
        let most = rows.iter().map(|row| norm(row)).fold(0.0, f64::max);
        let svd = Svd::of(&g);
        let least = RANK * most * most;
        let rank = svd.values().take_while(|x| *x > least).count().min(k.saturating_sub(1));
        Self { columns, svd, rank }
    }

    /// The part of a vector in the range of G.
    fn within(&self, e: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; e.len()];
        for l in 0..self.rank {
            let u = self.svd.u(l);
            let along = dot(u, e);
            y.iter_mut().zip(u).for_each(|(y, u)| *y += along * u);
        }
        y
    }

    fn of_ball(&self, e: &[f64]) -> Vec<f64> {
        self.within(e).iter().map(|x| -x).collect()
    }

    /// The change with the smallest largest |e_i + y_i|, by bisection: what each component may
    /// change for a size is an interval, and the normal must meet zero in the sum of them.
    fn of_box(&self, e: &[f64], trust: f64) -> Vec<f64> {
        let k = e.len();
        if self.rank + 1 < k {
            // No single normal: the way of the ball.
            return self.of_ball(e);
        }
        let normal = self.svd.u(k - 1).to_vec();
        let ends = |size: f64| -> Option<[Vec<f64>; 2]> {
            let (mut low, mut high) = (vec![0.0; k], vec![0.0; k]);
            for i in 0..k {
                let (from, to) = ((-size - e[i]).max(-trust), (size - e[i]).min(trust));
                if from > to {
                    return None;
                }
                (low[i], high[i]) = if normal[i] >= 0.0 { (from, to) } else { (to, from) };
            }
            (dot(&normal, &low) <= 0.0 && dot(&normal, &high) >= 0.0).then_some([low, high])
        };
        let largest = max_abs(e);
        let (mut below, mut above) = (0.0, largest);
        let mut best = vec![0.0; k];
        for _ in 0..60 {
            let middle = 0.5 * (below + above);
            match ends(middle) {
                None => below = middle,
                Some([low, high]) => {
                    above = middle;
                    let (a, b) = (dot(&normal, &low), dot(&normal, &high));
                    let share = if b > a { -a / (b - a) } else { 0.0 };
                    for i in 0..k {
                        best[i] = low[i] + share * (high[i] - low[i]);
                    }
                }
            }
        }
        self.within(&best)
    }

    /// dx of a change in the range of G.
    fn change(&self, y: &[f64]) -> Vec<f64> {
        let z = self.svd.solve(y, self.rank);
        self.columns.mul_vec(&z)
    }
}
