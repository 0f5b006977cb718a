//! Saturation: enforces joint velocity bounds. The task velocity is scaled down first; if no
//! scaling is feasible, its direction is changed (bounded least squares, BVLS).
//!
//! Formula  scaled: the largest s in [0, 1] with J q' = s x within the bounds; joints at a bound
//!          are clamped one by one while the others can still perform the task; direction changed:
//!          the bounded least-squares solution, min |J q' - x| within the bounds
//! Shapes   J: m x n, x: m, bounds: n
//! Cost     at most 4 n decompositions of m x n; none when no bound is met
//! Why so   scaling preserves the direction, which users of straight-line paths rely on; the
//!          direction is changed only when no scaled motion is feasible
//! Source   Flacco, De Luca & Khatib 2015, algorithm 1 (saturation in the null space); Stark &
//!          Parker 1995 (bounded-variable least squares)
//! Checked  tests/it/servo/limits.rs::saturation_*, tests in this file (optimality conditions)

use super::bounds::{LimitKind, VelocityBounds};
use crate::inverse::{Method, is_kept};
use crate::linalg::{Matrix, Svd, dot, norm};
use crate::scalar::clamp;

/// Below this scale the direction counts as infeasible and is changed [-].
pub(in crate::control) const MIN_SCALE: f64 = 0.05;

/// A clamped joint is released when its gradient exceeds this share of the largest possible one
/// [-]: the residual along directions cut by the inverse must not release any joint.
pub(in crate::control) const RELEASE: f64 = 1e-3;

/// Saturation: the share of a task that the velocity bounds of the joints permit.
///
/// ```text
/// scaled              the largest s in [0, 1] with J q' = s x,  lower <= q' <= upper
/// direction changed   min |J q' - x|,  lower <= q' <= upper   (bounded least squares, BVLS)
/// ```
///
/// Joints at a bound are clamped one by one while the others can still perform the task. The
/// direction changes only if no scaled motion is feasible.
///
/// Source: Flacco, De Luca & Khatib 2015, algorithm 1 (saturation in the null space); Stark &
/// Parker 1995 (bounded-variable least squares).
#[doc(alias = "BVLS")]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Saturation {
    /// Scale of the realised task twist; 1 when no limit is active.
    pub scale: f64,
    /// True if the direction was changed because no scaled motion was feasible.
    pub direction_lost: bool,
}

impl Saturation {
    /// No limit is active.
    pub(in crate::control) const NONE: Self = Self { scale: 1.0, direction_lost: false };
}

/// Workspace for the decompositions.
#[derive(Debug, Clone)]
pub(in crate::control) struct Saturator {
    svd: Svd,
    reduced: Matrix,
    gains: Vec<f64>,
    clamped: Vec<bool>,
    clamped_rates: Vec<f64>,
    particular: Vec<f64>,
    direction: Vec<f64>,
    rest: Vec<f64>,
    best: Vec<f64>,
}

/// The task and its inverse.
#[derive(Debug, Clone, Copy)]
pub(in crate::control) struct Problem<'a> {
    pub(in crate::control) j: &'a Matrix,
    pub(in crate::control) x: &'a [f64],
    pub(in crate::control) method: &'a Method,
    pub(in crate::control) bounds: &'a [VelocityBounds],
}

impl Saturator {
    pub(in crate::control) fn new(m: usize, n: usize) -> Self {
        Self {
            svd: Svd::workspace(m, n),
            reduced: Matrix::zeros(m, n),
            gains: vec![0.0; m.min(n)],
            clamped: vec![false; n],
            clamped_rates: vec![0.0; n],
            particular: vec![0.0; n],
            direction: vec![0.0; n],
            rest: vec![0.0; m],
            best: vec![0.0; n],
        }
    }

    /// Bounds `rates` (primary plus `secondary`). On input `rates` is the primary motion that
    /// solves the task without limits.
    pub(in crate::control) fn apply(
        &mut self,
        problem: Problem<'_>,
        secondary: &[f64],
        rates: &mut [f64],
    ) -> Saturation {
        let bounds = problem.bounds;
        // The secondary motion is reduced first.
        if let Some(span) = interval(rates, secondary, bounds) {
            for ((rate, z), bound) in rates.iter_mut().zip(secondary).zip(bounds) {
                *rate = bound.clamp(*rate + span.most * z);
            }
            return Saturation::NONE;
        }
        // While joints accelerate, the twist is scaled and grows from step to step; only persistent
        // limits justify another distribution of the motion over the joints.
        self.particular.fill(0.0);
        if let Some(span) = interval(&self.particular, rates, bounds)
            && span.most > 0.0
            && span.cause == LimitKind::Acceleration
        {
            for (rate, bound) in rates.iter_mut().zip(bounds) {
                *rate = bound.clamp(*rate * span.most);
            }
            return Saturation { scale: span.most, direction_lost: false };
        }
        let (scale, cause) = self.scaled(problem);
        if scale >= MIN_SCALE || (scale > 0.0 && cause != LimitKind::Position) {
            rates.copy_from_slice(&self.best);
            return Saturation { scale, direction_lost: false };
        }
        self.bounded_least_squares(problem, rates);
        Saturation { scale: 0.0, direction_lost: true }
    }

    /// The largest feasible scale, with its velocities in `best`, and the limiting kind; 0 if none.
    fn scaled(&mut self, p: Problem<'_>) -> (f64, LimitKind) {
        let n = p.bounds.len();
        self.clamped.fill(false);
        self.clamped_rates.fill(0.0);
        let mut best = 0.0;
        let mut cause = LimitKind::Position;
        let mut possible = 0;
        for round in 0..n {
            let rank = self.decompose_free(&p);
            if round == 0 {
                possible = rank;
            } else if rank < possible {
                break; // the rest can no longer do the task
            }
            // rates(s) = particular + s direction
            self.rest.fill(0.0);
            p.j.mul_vec_into(&self.clamped_rates, &mut self.rest);
            self.rest.iter_mut().for_each(|r| *r = -*r);
            solve(&self.svd, p.method, &mut self.gains, &self.rest, &mut self.particular);
            solve(&self.svd, p.method, &mut self.gains, p.x, &mut self.direction);
            for (a, h) in self.particular.iter_mut().zip(&self.clamped_rates) {
                *a += h;
            }
            if let Some(span) = interval(&self.particular, &self.direction, p.bounds)
                && span.most > best
            {
                let s = span.most;
                (best, cause) = (s, span.cause);
                for ((b, a), d) in self.best.iter_mut().zip(&self.particular).zip(&self.direction) {
                    *b = a + s * d;
                }
                for (b, bound) in self.best.iter_mut().zip(p.bounds) {
                    *b = bound.clamp(*b); // rounding at the critical joint
                }
            }
            if best >= 1.0 {
                break;
            }
            // Clamp the joint that exceeds its bounds most at full scale.
            let mut worst = (0.0, None);
            for i in 0..n {
                let rate = self.particular[i] + self.direction[i];
                let excess = (rate - p.bounds[i].clamp(rate)).abs();
                if !self.clamped[i] && excess > worst.0 {
                    worst = (excess, Some((i, p.bounds[i].clamp(rate))));
                }
            }
            let Some((i, rate)) = worst.1 else { break };
            self.clamped[i] = true;
            self.clamped_rates[i] = rate;
        }
        (best, cause)
    }

    /// Bounded least squares by an active set: clamp joints that reach a bound, release those whose
    /// gradient points inwards, until neither happens.
    fn bounded_least_squares(&mut self, p: Problem<'_>, rates: &mut [f64]) {
        let n = p.bounds.len();
        for (i, rate) in rates.iter_mut().enumerate() {
            let clamped = p.bounds[i].clamp(*rate);
            self.clamped[i] = clamped != *rate;
            *rate = clamped;
        }
        for _ in 0..3 * n {
            self.decompose_free(&p);
            self.load_residual(&p, rates, true);
            solve(&self.svd, p.method, &mut self.gains, &self.rest, &mut self.direction);
            if self.move_to_first_bound(p.bounds, rates) {
                continue;
            }
            self.load_residual(&p, rates, false);
            if !self.release_one(&p, rates) {
                break;
            }
        }
        for (rate, bound) in rates.iter_mut().zip(p.bounds) {
            *rate = bound.clamp(*rate);
        }
    }

    /// `rest = x - J rates`, over the clamped joints or over all.
    fn load_residual(&mut self, p: &Problem<'_>, rates: &[f64], clamped_alone: bool) {
        self.rest.copy_from_slice(p.x);
        for (j, rate) in rates.iter().enumerate() {
            if self.clamped[j] || !clamped_alone {
                for (r, a) in self.rest.iter_mut().zip(p.j.column(j)) {
                    *r -= a * rate;
                }
            }
        }
    }

    /// Moves the free joints towards `direction` until one reaches a bound and is clamped (true),
    /// or the whole way (false).
    fn move_to_first_bound(&mut self, bounds: &[VelocityBounds], rates: &mut [f64]) -> bool {
        let mut first = (1.0, None);
        for (i, bound) in bounds.iter().enumerate() {
            let way = self.direction[i] - rates[i];
            if self.clamped[i] || bound.contains(self.direction[i]) {
                continue;
            }
            let end = if way > 0.0 { bound.upper } else { bound.lower };
            let share = clamp((end - rates[i]) / way, 0.0, 1.0);
            if share < first.0 || first.1.is_none() {
                first = (share, Some((i, end)));
            }
        }
        for (i, rate) in rates.iter_mut().enumerate() {
            if !self.clamped[i] {
                *rate += first.0 * (self.direction[i] - *rate);
            }
        }
        let Some((i, end)) = first.1 else { return false };
        rates[i] = end;
        self.clamped[i] = true;
        true
    }

    /// Releases the clamped joint that would reduce the error most by leaving its bound inwards.
    fn release_one(&mut self, p: &Problem<'_>, rates: &[f64]) -> bool {
        let size = norm(&self.rest);
        let least = RELEASE * self.svd.value(0) * size;
        let mut best = (least, None);
        for (i, bound) in p.bounds.iter().enumerate() {
            if !self.clamped[i] || bound.lower == bound.upper {
                continue;
            }
            let pull = dot(p.j.column(i), &self.rest);
            let inwards = if rates[i] >= bound.upper { -pull } else { pull };
            if inwards > best.0 {
                best = (inwards, Some(i));
            }
        }
        let Some(i) = best.1 else { return false };
        self.clamped[i] = false;
        true
    }

    /// Decomposes J without the columns of clamped joints; returns the number of feasible
    /// directions.
    fn decompose_free(&mut self, p: &Problem<'_>) -> usize {
        self.reduced.as_mut_slice().copy_from_slice(p.j.as_slice());
        for (i, clamped) in self.clamped.iter().enumerate() {
            if *clamped {
                self.reduced.column_mut(i).fill(0.0);
            }
        }
        self.svd.decompose(&self.reduced);
        p.method.gains(&self.svd, p.x, &mut self.gains);
        let values = self.svd.values();
        self.gains.iter().zip(values).filter(|(g, s)| is_kept(*g * s)).count()
    }
}

/// `out = V diag(gains) U^T x`
pub(in crate::control) fn solve(
    svd: &Svd,
    method: &Method,
    gains: &mut [f64],
    x: &[f64],
    out: &mut [f64],
) {
    method.gains(svd, x, gains);
    svd.apply_gains_into(x, gains, out);
}

/// The range of s in which `a + s b` is within the bounds.
#[derive(Debug, Clone, Copy)]
pub(in crate::control) struct Span {
    /// The largest s in [0, 1].
    pub(in crate::control) most: f64,
    /// The limit that sets it; velocity if none.
    pub(in crate::control) cause: LimitKind,
}

/// The largest s in [0, 1] for which `a + s b` is within the bounds; `None` if there is none.
pub(in crate::control) fn interval(
    a: &[f64],
    b: &[f64],
    bounds: &[VelocityBounds],
) -> Option<Span> {
    let mut least = 0.0_f64;
    let mut span = Span { most: 1.0, cause: LimitKind::Velocity };
    for ((a, b), bound) in a.iter().zip(b).zip(bounds) {
        if *b == 0.0 {
            if !bound.contains(*a) {
                return None;
            }
            continue;
        }
        let (lower, upper) = ((bound.lower - a) / b, (bound.upper - a) / b);
        let (enter, leave, cause) = if *b > 0.0 {
            (lower, upper, bound.upper_cause)
        } else {
            (upper, lower, bound.lower_cause)
        };
        least = least.max(enter);
        if leave < span.most {
            span = Span { most: leave, cause };
        }
    }
    (least <= span.most).then_some(span)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The next number in [-1, 1) of a fixed sequence.
    fn next(state: &mut u64) -> f64 {
        2.0 * crate::scalar::uniform(state) - 1.0
    }

    /// The solution satisfies the conditions of Karush, Kuhn and Tucker for min |J r - x|^2 in a
    /// box: zero gradient for joints between their bounds, none pointing inwards for the others
    /// (above `RELEASE`).
    #[test]
    fn bent_rates_are_the_bounded_least_squares_solution() {
        let mut state = 7;
        let method = Method::Truncated { eps: 1e-9 };
        for round in 0..2000 {
            let (m, n) = [(6, 7), (6, 6), (3, 7), (2, 3), (6, 4), (3, 2)][round % 6];
            let j = Matrix::from_fn(m, n, |_, _| next(&mut state));
            let x: Vec<f64> = (0..m).map(|_| 3.0 * next(&mut state)).collect();
            let bounds: Vec<VelocityBounds> = (0..n)
                .map(|i| VelocityBounds {
                    lower: -next(&mut state).abs() * f64::from(u8::from(i % 3 > 0)),
                    upper: next(&mut state).abs(),
                    ..VelocityBounds::NONE
                })
                .collect();
            let mut saturator = Saturator::new(m, n);
            let mut rates = vec![0.0; n];
            solve(&Svd::of(&j), &method, &mut vec![0.0; m.min(n)], &x, &mut rates);
            let problem = Problem { j: &j, x: &x, method: &method, bounds: &bounds };
            saturator.bounded_least_squares(problem, &mut rates);

            let rest: Vec<f64> = j.mul_vec(&rates).iter().zip(&x).map(|(y, x)| x - y).collect();
            let size = rest.iter().map(|r| r * r).sum::<f64>().sqrt();
            let slack = RELEASE * Svd::of(&j).value(0) * size;
            let pulls = j.transpose().mul_vec(&rest);
            for ((rate, bound), pull) in rates.iter().zip(&bounds).zip(pulls) {
                assert!(bound.contains(*rate), "round {round}: {rate} in {bound:?}");
                let (up, down) = (*rate < bound.upper, *rate > bound.lower);
                if up && down {
                    assert!(pull.abs() < 1e-9, "round {round}: {pull} between {bound:?}");
                }
                assert!(!up || pull <= slack + 1e-9, "round {round}: {pull} up, {slack}");
                assert!(!down || pull >= -slack - 1e-9, "round {round}: {pull} down, {slack}");
            }
        }
    }
}
