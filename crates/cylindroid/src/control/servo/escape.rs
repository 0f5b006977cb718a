//! Escape from configurations in which the linearised task makes no progress although a finite motion
//! would: stretched arms and other singularities, joints at limits.
//!
//! Formula  E = |e|^2 / 2, its gradient in the joints -g = -J^T e and its Hessian H = J^T J - e . dJ/dq,
//!          for the joints that limits do not block. An eigenvalue below -`OPEN` |e|: a saddle, not a
//!          minimum. Then q' = gain * sum_k v_k (g . v_k) / |l_k| over the eigenvectors v_k of H, along
//!          the most negative l at least the motion after which the curvature has consumed the error,
//!          |e| sqrt(2 / |l|)
//! Shapes   J: m x n, H: n x n, e: m      Units    scaled task coordinates
//! Valid    trees, orthogonal projections. After `PATIENCE` without progress; until the linearised
//!          task alone progresses again. The side is that of the gradient, where it has one, then that
//!          of the last motion, then the one with more room to the position limits
//! Why so   first-order laws are at rest on a saddle of E for good, and a truncated inverse already
//!          near it. A random push would leave it too, but not the same way twice; the inverse alone
//!          with |l| in place of l is a step of descent everywhere
//!          The linearised task itself folds a stretched arm to the side on which it happens to stand:
//!          where that side has little room to the limits the escape takes the other one at once
//! Source   Nocedal & Wright, Numerical Optimization, 2006, sections 3.4, 6.3 (directions of negative
//!          curvature); Dauphin et al. 2014, Identifying and attacking the saddle point problem
//! Checked  tests/it/servo/escape.rs

use super::edge::Edge;
use crate::control::solver::bounds::{LimitKind, VelocityBounds};
use crate::control::solver::saturation::Curvature;
use crate::inverse::Method;
use crate::linalg::{Matrix, Svd, dot, norm};

/// Share of the motion that the gain asks for, below which there is no progress [-], and above which
/// an escape ends.
const STUCK: f64 = 0.01;
const FREED: f64 = 0.05;

/// Time constant of the mean share (s): the share of an arm that comes to rest is below `STUCK` after
/// 4.6 times this.
const PATIENCE: f64 = 0.05;

/// Eigenvalues of H below this times -|e| open a way [-].
const OPEN: f64 = 0.02;

/// Singular values above this share of the largest are those of directions that are not lost [-].
const WEAK: f64 = 0.05;

/// Largest motion of the joints that the second derivatives describe (scaled) [-].
const QUADRATIC: f64 = 1.0;

/// Share of the least motion along the most negative curvature from which the gradient names a side
/// [-].
const DECISIVE: f64 = 1e-3;

/// Ratio of singular values below which an arm is stretched [-].
pub(super) const FOLD: f64 = 0.02;

/// An arm folds to the other side if it has more than so many times the room to its limits [-].
const ROOMIER: f64 = 2.0;

/// Joints slower than this share of the fastest one take no part in a motion [-].
const SHARE: f64 = 0.1;

/// Progress of the linearised task, and workspace.
#[derive(Debug, Clone)]
pub(super) struct Escape {
    mean_share: f64,
    /// True from the time without progress until the linearised task progresses.
    pub(super) is_active: bool,
    hessian: Matrix,
    free: Matrix,
    eigen: Svd,
    /// The desired motion over the gain, scaled.
    pub(super) error: Vec<f64>,
    gradient: Vec<f64>,
    is_free: Vec<bool>,
    /// The result: velocities in scaled coordinates.
    pub(super) rates: Vec<f64>,
}

/// The linearised task of this step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Linearised<'a> {
    pub(super) j: &'a Matrix,
    pub(super) svd: &'a Svd,
    pub(super) bounds: &'a [VelocityBounds],
    /// Velocities of the last step.
    pub(super) last: &'a [f64],
    pub(super) gain: f64,
    pub(super) method: Method,
    /// Size of the commanded twist.
    pub(super) size: f64,
}

impl Linearised<'_> {
    /// The largest velocities of all joints that the inverse promises, and of each.
    fn most(&self) -> (f64, f64) {
        let largest = self.svd.value(0);
        let gain = match self.method {
            Method::Truncated { eps } => 1.0 / (eps * largest),
            Method::Damped { damping } => 0.5 / damping,
            Method::VariableDamping { onset, damping }
            | Method::NumericalFiltering { onset, damping, .. } => {
                (0.5 / damping).max(1.0 / (onset * largest))
            }
            Method::SingularValueFiltering { floor, .. } => 1.0 / floor,
            Method::SelectivelyDamped { max_joint_velocity } => {
                return (f64::INFINITY, max_joint_velocity);
            }
        };
        (gain * self.size, f64::INFINITY)
    }
}

impl Escape {
    /// For tasks of m components and n joints.
    pub(super) fn new(m: usize, n: usize) -> Self {
        Self {
            mean_share: 1.0,
            is_active: false,
            hessian: Matrix::zeros(n, n),
            free: Matrix::zeros(n, n),
            eigen: Svd::workspace(n, n),
            error: vec![0.0; m],
            gradient: vec![0.0; n],
            is_free: vec![true; n],
            rates: vec![0.0; n],
        }
    }

    /// The linearised task progresses.
    pub(super) fn reset(&mut self) {
        (self.mean_share, self.is_active) = (1.0, false);
    }

    /// Records the share of the desired motion that the linearised task achieves in a step of `dt`
    /// seconds.
    pub(super) fn record(&mut self, share: f64, dt: f64) {
        self.mean_share += (share.min(1.0) - self.mean_share) * (dt / (PATIENCE + dt));
        self.is_active = if self.is_active { share < FREED } else { self.mean_share < STUCK };
        if !self.is_active && share >= FREED {
            self.mean_share = self.mean_share.max(share.min(1.0));
        }
    }

    /// True at the edge of reach where the error leads back inside and the linearised task would fold
    /// the arm to a side with little room to the position limits, although the other one has more.
    pub(super) fn folds_at_limit(&mut self, task: Linearised<'_>, edge: &mut Edge<'_>) -> bool {
        let Some(k) = task.svd.len().checked_sub(1) else { return false };
        if !(task.svd.value(k) < FOLD * task.svd.value(0)) {
            return false;
        }
        let (way, along) = (task.svd.v(k), dot(task.svd.u(k), &self.error));
        let (forwards, backwards) = room(way, edge);
        let (own, other) = if along > 0.0 { (forwards, backwards) } else { (backwards, forwards) };
        if !(ROOMIER * own < other && own < QUADRATIC) {
            return false;
        }
        edge.load(&self.error, &mut self.hessian);
        self.hessian.mul_vec_into(way, &mut self.gradient);
        let curvature = dot(way, &self.gradient) + task.svd.value(k).powi(2);
        curvature < -OPEN * along.abs()
    }

    /// Computes the velocities of an escape, or, where the arm `folds`, of the other side; false if no
    /// joint motion opens a way.
    pub(super) fn solve(&mut self, task: Linearised<'_>, edge: &mut Edge<'_>, folds: bool) -> bool {
        let n = self.rates.len();
        let size = norm(&self.error);
        if !folds {
            edge.load(&self.error, &mut self.hessian); // otherwise loaded already
        }
        for i in 0..n {
            self.gradient[i] = dot(task.j.column(i), &self.error);
            for k in 0..n {
                self.hessian[(i, k)] += dot(task.j.column(i), task.j.column(k));
            }
        }
        for i in 0..n {
            let blocked = blocks(&task.bounds[i], self.gradient[i]);
            self.is_free[i] = edge.space.columns[i] != 0.0 && !blocked;
        }
        // A task that a weak inverse slows down is not lost.
        let along = |u: &[f64]| dot(u, &self.error).powi(2);
        let strong = (0..task.svd.len()).filter(|i| task.svd.value(*i) > WEAK * task.svd.value(0));
        let strong: f64 = strong.map(|i| along(task.svd.u(i))).sum();
        let all_free = task.bounds.iter().zip(&self.gradient).all(|(b, g)| !blocks(b, *g));
        if !folds && all_free && strong > 0.5 * size * size {
            return false;
        }
        // Every pass blocks a joint more.
        for _ in 0..=n {
            if !self.solve_free(task, edge, size, folds) {
                return false;
            }
            let mut clear = true;
            for ((free, rate), bound) in self.is_free.iter_mut().zip(&self.rates).zip(task.bounds) {
                if *free && blocks(bound, *rate) {
                    (*free, clear) = (false, false);
                }
            }
            if clear {
                self.slow_down(task, edge);
                return true;
            }
        }
        false
    }

    /// Scales the velocities to the limits of the joints and to the bound of the inverse.
    fn slow_down(&mut self, task: Linearised<'_>, edge: &Edge<'_>) {
        let (all, each) = task.most();
        let mut scale = (all / norm(&self.rates)).min(1.0);
        let own = self.rates.iter().zip(&edge.space.columns).zip(edge.limits);
        for ((rate, column), limit) in own {
            let speed = (rate * column).abs();
            let most = limit.velocity.min(each);
            if speed * scale > most {
                scale = most / speed;
            }
        }
        self.rates.iter_mut().for_each(|rate| *rate *= scale);
    }

    /// The velocities for the joints that are free.
    fn solve_free(
        &mut self,
        task: Linearised<'_>,
        edge: &Edge<'_>,
        size: f64,
        folds: bool,
    ) -> bool {
        let n = self.rates.len();
        // Shifted: then singular values are eigenvalues.
        let shift = self.hessian.frobenius_norm().max(f64::MIN_POSITIVE);
        for i in 0..n {
            for k in 0..n {
                let both = self.is_free[i] && self.is_free[k];
                self.free[(i, k)] = if both { self.hessian[(i, k)] } else { 0.0 };
            }
            self.free[(i, i)] += if self.is_free[i] { shift } else { 2.0 * shift };
        }
        self.eigen.decompose(&self.free);
        let least = self.eigen.value(n - 1) - shift;
        if !(least < -OPEN * size) {
            return false;
        }
        self.rates.fill(0.0);
        for k in 0..n {
            let way = self.eigen.v(k);
            let masked = way.iter().zip(&self.is_free).zip(&self.gradient);
            let slope: f64 = masked.map(|((v, free), g)| if *free { v * g } else { 0.0 }).sum();
            let curvature = (self.eigen.value(k) - shift).abs().max(OPEN * size);
            let mut step = slope / curvature;
            if k == n - 1 {
                let whole = (size * (2.0 / curvature).sqrt()).min(QUADRATIC);
                if folds {
                    let (forwards, backwards) = room(way, edge);
                    step = if forwards > backwards { whole } else { -whole };
                } else if step.abs() < DECISIVE * whole {
                    step = self.side(task, edge);
                }
                step = step.signum() * step.abs().max(whole).min(QUADRATIC);
            }
            for ((rate, v), free) in self.rates.iter_mut().zip(way).zip(&self.is_free) {
                *rate += if *free { step * v } else { 0.0 };
            }
        }
        let scale = task.gain * (QUADRATIC / norm(&self.rates)).min(1.0);
        self.rates.iter_mut().for_each(|rate| *rate *= scale);
        true
    }

    /// The side of the most negative curvature where the gradient names none, as a sign.
    fn side(&self, task: Linearised<'_>, edge: &Edge<'_>) -> f64 {
        let way = self.eigen.v(self.rates.len() - 1);
        let onwards = dot(way, task.last);
        if onwards != 0.0 {
            return onwards;
        }
        let (forwards, backwards) = room(way, edge);
        if forwards != backwards && !(forwards - backwards).is_nan() {
            return forwards - backwards;
        }
        let largest = way.iter().fold(0.0, |m: f64, v| if v.abs() > m.abs() { *v } else { m });
        1.0_f64.copysign(largest)
    }
}

/// The motion along `way`, and against it, to the first position limit of the joints that take a
/// share in it.
fn room(way: &[f64], edge: &Edge<'_>) -> (f64, f64) {
    let speeds = || way.iter().zip(&edge.space.columns).map(|(v, column)| v * column);
    let fastest = speeds().fold(0.0, |m: f64, speed| m.max(speed.abs()));
    let (mut forwards, mut backwards) = (f64::INFINITY, f64::INFINITY);
    for ((speed, limits), q) in speeds().zip(edge.limits).zip(edge.chain.q()) {
        if speed.abs() > SHARE * fastest {
            let (up, down) = ((limits.upper - q) / speed, (limits.lower - q) / speed);
            forwards = forwards.min(up.max(down));
            backwards = backwards.min(-up.min(down));
        }
    }
    (forwards, backwards)
}

/// True if a joint is at a position limit and would move beyond it.
fn blocks(bound: &VelocityBounds, rate: f64) -> bool {
    let limit = |bound: f64, cause| bound <= BLOCKED && cause == LimitKind::Position;
    if rate > 0.0 {
        limit(bound.upper, bound.upper_cause)
    } else {
        rate < 0.0 && limit(-bound.lower, bound.lower_cause)
    }
}

/// Velocity up to which a joint is at rest at its limit (scaled) [1/s].
const BLOCKED: f64 = 1e-3;
