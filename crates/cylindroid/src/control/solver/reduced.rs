//! Saturation of coupled joints: the task velocity is scaled down first; if no scaling is feasible,
//! its direction is changed.
//!
//! Formula  scaled: the largest s in [0, 1] with M y(s) + s_0 within the bounds, velocities at a
//!          bound clamped one by one while the others can still perform the task; direction
//!          changed: descent from rest (or from the last velocities, slowed as far as the bounds
//!          permit) towards the task, along active bounds
//! Shapes   M: velocities x a, y: a, J M: m x a, bounds: one for each velocity
//! Valid    any M. Without loops M is the identity, and scaled results equal those of `direct.rs`;
//!          with a changed direction the result is a descent, not the least-squares optimum
//! Source   Flacco, De Luca & Khatib 2015, algorithm 1, for bounds on combinations of velocities
//! Checked  src/control/servo/coupled.rs (against `direct.rs`), tests/it/servo/object.rs

use super::bounds::{LimitKind, VelocityBounds};
use super::direct::{MIN_SCALE, Saturation, Span, interval, solve};
use crate::inverse::{Method, is_kept};
use crate::linalg::{Matrix, RowSpace, Svd, norm};
use crate::scalar::clamp;
use crate::tolerance::CLAMPED_ROWS;

/// The task in y, and the bounds of the velocities.
#[derive(Debug, Clone, Copy)]
pub(in crate::control) struct ReducedProblem<'a> {
    /// J M
    pub(in crate::control) j: &'a Matrix,
    pub(in crate::control) x: &'a [f64],
    pub(in crate::control) method: &'a Method,
    pub(in crate::control) bounds: &'a [VelocityBounds],
    /// Velocities of the last step.
    pub(in crate::control) rates: &'a [f64],
    /// Their actuation.
    pub(in crate::control) last: &'a [f64],
}

/// The solver for coupled joints: velocities = M y + s_0.
#[derive(Debug, Clone)]
pub(in crate::control) struct ReducedSolver {
    /// M in weighted velocities, a columns.
    pub(in crate::control) motions: Matrix,
    /// s_0 in weighted velocities.
    pub(in crate::control) correction: Vec<f64>,
    /// The actuation y of the primary task, of the secondary ones, and of the result.
    pub(in crate::control) primary: Vec<f64>,
    pub(in crate::control) secondary: Vec<f64>,
    pub(in crate::control) actuation: Vec<f64>,
}

impl ReducedSolver {
    /// For this number of velocities and actuated joints, at rest.
    pub(in crate::control) fn new(rates: usize, actuated: usize) -> Self {
        Self {
            motions: Matrix::zeros(rates, actuated),
            correction: vec![0.0; rates],
            primary: vec![0.0; actuated],
            secondary: vec![0.0; actuated],
            actuation: vec![0.0; actuated],
        }
    }

    /// `rates = M y`, without the loop-closure correction.
    pub(in crate::control) fn expand(&self, y: &[f64], rates: &mut [f64]) {
        self.motions.mul_vec_into(y, rates);
    }

    /// Row `joint` of M times `pull`.
    pub(in crate::control) fn along(&self, joint: usize, pull: &[f64]) -> f64 {
        (0..self.motions.cols()).map(|j| self.motions[(joint, j)] * pull[j]).sum()
    }

    /// Bounds the primary and secondary velocities; writes weighted velocities to `out`.
    pub(in crate::control) fn saturate(
        &mut self,
        p: ReducedProblem<'_>,
        out: &mut [f64],
    ) -> Saturation {
        let n = out.len();
        let clamped = |a: &[f64], b: &[f64], s: f64, out: &mut [f64]| {
            for (((o, a), b), bound) in out.iter_mut().zip(a).zip(b).zip(p.bounds) {
                *o = bound.clamp(a + s * b);
            }
        };
        let (mut direct, mut secondary) = (vec![0.0; n], vec![0.0; n]);
        self.expand(&self.primary, &mut direct);
        self.expand(&self.secondary, &mut secondary);
        // At a limit the loop-closure correction ends, too. Acceleration bounds that exclude rest
        // are left to the motion: a correction that met them would open the loops.
        for (x, bound) in self.correction.iter_mut().zip(p.bounds) {
            *x = x.max(bound.lower.min(0.0)).min(bound.upper.max(0.0));
        }
        let start = self.correction.clone();
        let both: Vec<f64> = start.iter().zip(&direct).map(|(a, b)| a + b).collect();
        if let Some(span) = interval(&both, &secondary, p.bounds) {
            clamped(&both, &secondary, span.most, out);
            self.set_actuation(span.most, 1.0);
            return Saturation { scale: 1.0, direction_lost: false };
        }
        if let Some(span) = interval(&start, &direct, p.bounds)
            && span.most > 0.0
            && span.cause == LimitKind::Acceleration
        {
            clamped(&start, &direct, span.most, out);
            self.set_actuation(0.0, span.most);
            return Saturation { scale: span.most, direction_lost: false };
        }
        let (scale, cause) = self.scaled(&p, out);
        if scale >= MIN_SCALE || (scale > 0.0 && cause != LimitKind::Position) {
            return Saturation { scale, direction_lost: false };
        }
        if !self.descend(&p, out) {
            self.brake(&p, out);
        }
        Saturation { scale: 0.0, direction_lost: true }
    }

    fn set_actuation(&mut self, secondary: f64, primary: f64) {
        for ((y, p), w) in self.actuation.iter_mut().zip(&self.primary).zip(&self.secondary) {
            *y = primary * p + secondary * w;
        }
    }

    /// The largest feasible scale, its velocities and actuation, and the limiting kind.
    fn scaled(&mut self, p: &ReducedProblem<'_>, out: &mut [f64]) -> (f64, LimitKind) {
        let n = out.len();
        let mut clamped = Clamped::default();
        let (mut best, mut cause) = (0.0, LimitKind::Position);
        let mut possible = 0;
        for round in 0..n {
            let Some(free) = self.solve_free(&clamped, p) else { break };
            if round == 0 {
                possible = free.rank;
            } else if free.rank < possible {
                break; // the rest can no longer do the task
            }
            let done = p.j.mul_vec(&free.actuation);
            let rest: Vec<f64> = done.iter().map(|d| -d).collect();
            let (mut particular, direction) = (free.solve(p, &rest), free.solve(p, p.x));
            particular.iter_mut().zip(&free.actuation).for_each(|(a, h)| *a += h);
            let (mut a, mut b) = (vec![0.0; n], vec![0.0; n]);
            self.expand(&particular, &mut a);
            a.iter_mut().zip(&self.correction).for_each(|(a, c)| *a += c);
            self.expand(&direction, &mut b);
            for &(i, rate) in &clamped.rows {
                (a[i], b[i]) = (rate, 0.0);
            }
            if let Some(span) = interval(&a, &b, p.bounds)
                && span.most > best
            {
                (best, cause) = (span.most, span.cause);
                for (((o, a), b), bound) in out.iter_mut().zip(&a).zip(&b).zip(p.bounds) {
                    *o = bound.clamp(a + best * b);
                }
                for ((y, a), b) in self.actuation.iter_mut().zip(&particular).zip(&direction) {
                    *y = a + best * b;
                }
            }
            if best >= 1.0 {
                break;
            }
            let excess = |i: usize| {
                let rate = a[i] + b[i];
                (rate - p.bounds[i].clamp(rate)).abs()
            };
            let worst = (0..n).filter(|&i| !clamped.has(i)).map(|i| (excess(i), i));
            let worst = worst.max_by(|a, b| a.0.total_cmp(&b.0));
            let Some((_, i)) = worst.filter(|(e, _)| *e > 0.0) else { break };
            clamped.rows.push((i, p.bounds[i].clamp(a[i] + b[i])));
        }
        (best, cause)
    }

    /// Descent from rest towards the task, along active bounds; from the last velocities, slowed,
    /// if rest is infeasible within a step. False if these are infeasible, too.
    fn descend(&mut self, p: &ReducedProblem<'_>, out: &mut [f64]) -> bool {
        let n = out.len();
        let mut clamped = Clamped::default();
        let mut y = vec![0.0; self.motions.cols()];
        let mut rates = self.correction.clone();
        if !rates.iter().zip(p.bounds).all(|(r, b)| b.contains(*r)) {
            let mut moved = vec![0.0; n];
            self.expand(p.last, &mut moved);
            rates.iter_mut().zip(&moved).for_each(|(r, m)| *r += m);
            moved.iter_mut().for_each(|m| *m = -*m);
            let Some(Span { most, .. }) = interval(&rates, &moved, p.bounds) else { return false };
            rates.iter_mut().zip(&moved).for_each(|(r, m)| *r += most * m);
            y.iter_mut().zip(p.last).for_each(|(y, l)| *y = (1.0 - most) * l);
        }
        for _ in 0..n {
            let Some(free) = self.solve_free(&clamped, p) else { break };
            let done = p.j.mul_vec(&free.actuation);
            let rest: Vec<f64> = p.x.iter().zip(done).map(|(x, d)| x - d).collect();
            let mut goal = free.solve(p, &rest);
            goal.iter_mut().zip(&free.actuation).for_each(|(g, h)| *g += h);
            let way: Vec<f64> = goal.iter().zip(&y).map(|(g, y)| g - y).collect();
            let mut moved = vec![0.0; n];
            self.expand(&way, &mut moved);
            let mut first = (1.0, None);
            for i in (0..n).filter(|&i| !clamped.has(i)) {
                let bound = p.bounds[i];
                let end = if moved[i] > 0.0 { bound.upper } else { bound.lower };
                if moved[i] != 0.0 && !bound.contains(rates[i] + moved[i]) {
                    let share = clamp((end - rates[i]) / moved[i], 0.0, 1.0);
                    if share < first.0 || first.1.is_none() {
                        first = (share, Some((i, end)));
                    }
                }
            }
            y.iter_mut().zip(&way).for_each(|(y, w)| *y += first.0 * w);
            rates.iter_mut().zip(&moved).for_each(|(r, m)| *r += first.0 * m);
            let Some(row) = first.1 else { break };
            clamped.rows.push(row);
        }
        for ((o, r), bound) in out.iter_mut().zip(&rates).zip(p.bounds) {
            *o = bound.clamp(*r);
        }
        self.actuation.copy_from_slice(&y);
        true
    }

    /// The last velocities, slowed together as far as the bounds permit.
    pub(in crate::control) fn brake(&mut self, p: &ReducedProblem<'_>, out: &mut [f64]) {
        // rates (1 - s): from the last ones to rest.
        let slower: Vec<f64> = p.rates.iter().map(|r| -r).collect();
        let share = interval(p.rates, &slower, p.bounds).map_or(1.0, |span| span.most);
        for ((o, r), bound) in out.iter_mut().zip(p.rates).zip(p.bounds) {
            *o = bound.clamp(r * (1.0 - share));
        }
        self.actuation.fill(0.0);
    }

    /// The least-effort actuation that maintains the clamped velocities, and the task in the
    /// remaining freedom; `None` if they contradict one another.
    fn solve_free(&self, clamped: &Clamped, p: &ReducedProblem<'_>) -> Option<FreeMotion> {
        let row = |k: usize, j: usize| self.motions[(clamped.rows[k].0, j)];
        let rows = Matrix::from_fn(clamped.rows.len(), self.motions.cols(), row);
        let svd = Svd::of(&rows);
        let rank = svd.rank(CLAMPED_ROWS).rank;
        let asked: Vec<f64> =
            clamped.rows.iter().map(|&(i, rate)| rate - self.correction[i]).collect();
        let y = svd.solve(&asked, rank);
        let kept = rows.mul_vec(&y);
        let off = kept.iter().zip(&asked).map(|(k, a)| (k - a).abs()).fold(0.0, f64::max);
        if off > CLAMPED_ROWS * (1.0 + norm(&asked)) {
            return None;
        }
        let mut reduced = p.j.transpose();
        let space = RowSpace::first(&svd, rank);
        for i in 0..reduced.cols() {
            space.project_out(reduced.column_mut(i));
        }
        if reduced.max_abs() <= CLAMPED_ROWS * p.j.max_abs() {
            reduced.as_mut_slice().fill(0.0); // rounding is no way to do a task
        }
        let svd = Svd::of(&reduced.transpose());
        let mut gains = vec![0.0; svd.len()];
        p.method.gains(&svd, p.x, &mut gains);
        let rank = gains.iter().zip(svd.values()).filter(|(g, s)| is_kept(**g * s)).count();
        Some(FreeMotion { actuation: y, svd, rank })
    }
}

/// Velocities clamped at a bound.
#[derive(Debug, Clone, Default)]
struct Clamped {
    rows: Vec<(usize, f64)>,
}

impl Clamped {
    fn has(&self, row: usize) -> bool {
        self.rows.iter().any(|(i, _)| *i == row)
    }
}

/// The freedom that clamped velocities leave to the task.
struct FreeMotion {
    actuation: Vec<f64>,
    svd: Svd,
    rank: usize,
}

impl FreeMotion {
    fn solve(&self, p: &ReducedProblem<'_>, x: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; self.actuation.len()];
        solve(&self.svd, p.method, &mut vec![0.0; self.svd.len()], x, &mut out);
        out
    }
}
