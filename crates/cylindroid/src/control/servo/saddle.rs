//! The way out of a saddle of the error, and the progress that shows one.
//!
//! Formula  E = |e|^2 / 2, its gradient in the joints -g = -J^T e and its Hessian H, for the joints that
//!          limits do not block. An eigenvalue below -`OPEN` |e|: a saddle, not a minimum. Then
//!          q' = gain * sum_k v_k (g . v_k) / |l_k| over the eigenvectors v_k of H, along the most
//!          negative l at least the motion after which the curvature has consumed the error,
//!          |e| sqrt(2 / |l|)
//! Shapes   H: n x n, g: n      Units    scaled task coordinates
//! Valid    after `PATIENCE` without progress; until the linearised task alone progresses again. The
//!          side is that of the gradient, where it has one, then that of the last motion, then the one
//!          with more room to the position limits
//! Why so   first-order laws are at rest on a saddle of E for good. A random push would leave it too,
//!          but not the same way twice
//! Source   Nocedal & Wright, Numerical Optimization, 2006, sections 3.4, 6.3 (directions of negative
//!          curvature); Dauphin et al. 2014, Identifying and attacking the saddle point problem
//! Checked  tests/it/servo/escape.rs, tests/it/servo/task_edges.rs

use crate::control::solver::bounds::{LimitKind, VelocityBounds};
use crate::linalg::{Matrix, Svd, dot, norm};
use crate::model::Limits;

/// Share of the motion that the gain asks for, below which there is no progress [-], and above which
/// an escape ends.
const STUCK: f64 = 0.01;
const FREED: f64 = 0.05;

/// Time constant of the mean share (s): the share of an arm that comes to rest is below `STUCK` after
/// 4.6 times this.
const PATIENCE: f64 = 0.05;

/// Eigenvalues of H below this times -|e| open a way [-].
pub(super) const OPEN: f64 = 0.02;

/// Largest motion of the joints that the second derivatives describe (scaled) [-].
pub(super) const QUADRATIC: f64 = 1.0;

/// Share of the least motion along the most negative curvature from which the gradient names a side
/// [-].
const DECISIVE: f64 = 1e-3;

/// Gradients below this share of the error press no joint against its limit [-].
const PULL: f64 = 1e-6;

/// Motion to a position limit below which a side has no room [-].
const NO_ROOM: f64 = 0.01;

/// Joints slower than this share of the fastest one take no part in a motion [-].
const SHARE: f64 = 0.1;

/// Velocities of all joints below this are those of rest (scaled) [1/s].
pub(in crate::control) const AT_REST: f64 = 1e-3;

/// Velocity up to which a joint is at rest at its limit (scaled) [1/s].
const BLOCKED: f64 = 1e-3;

/// The share of its motion that a linearised task achieves, over time.
#[derive(Debug, Clone)]
pub(in crate::control) struct Progress {
    mean_share: f64,
    /// True from the time without progress until the linearised task progresses.
    pub(in crate::control) is_lost: bool,
}

impl Progress {
    pub(in crate::control) const fn new() -> Self {
        Self { mean_share: 1.0, is_lost: false }
    }

    /// The linearised task progresses.
    pub(in crate::control) const fn reset(&mut self) {
        (self.mean_share, self.is_lost) = (1.0, false);
    }

    /// Records the share of the desired motion that the linearised task achieves in a step of `dt`
    /// seconds.
    pub(in crate::control) fn record(&mut self, share: f64, dt: f64) {
        self.mean_share += (share.min(1.0) - self.mean_share) * (dt / (PATIENCE + dt));
        self.is_lost = if self.is_lost { share < FREED } else { self.mean_share < STUCK };
        if !self.is_lost && share >= FREED {
            self.mean_share = self.mean_share.max(share.min(1.0));
        }
    }
}

/// The joints about a configuration.
#[derive(Debug, Clone, Copy)]
pub(in crate::control) struct Surroundings<'a> {
    /// Joint velocities for scaled ones of 1.
    pub(in crate::control) columns: &'a [f64],
    pub(in crate::control) limits: &'a [Limits],
    pub(in crate::control) q: &'a [f64],
    /// Of the scaled velocities.
    pub(in crate::control) bounds: &'a [VelocityBounds],
    /// Scaled velocities of the last step.
    pub(in crate::control) last: &'a [f64],
    pub(in crate::control) gain: f64,
    /// The largest velocities of all joints, and of each (scaled).
    pub(in crate::control) fastest: (f64, f64),
}

impl Surroundings<'_> {
    /// True if a joint is at a position limit and would move beyond it.
    fn blocks(&self, joint: usize, rate: f64) -> bool {
        let bound = &self.bounds[joint];
        let limit = |bound: f64, cause| bound <= BLOCKED && cause == LimitKind::Position;
        if rate > 0.0 {
            limit(bound.upper, bound.upper_cause)
        } else {
            rate < 0.0 && limit(-bound.lower, bound.lower_cause)
        }
    }

    /// Size of these velocities without those that press joints against their limits.
    pub(in crate::control) fn free_size(&self, rates: &[f64]) -> f64 {
        let free = rates.iter().enumerate().filter(|(i, rate)| !self.blocks(*i, **rate));
        free.map(|(_, rate)| rate * rate).sum::<f64>().sqrt()
    }

    /// True if no joint is at a limit against which these velocities press it.
    pub(in crate::control) fn are_free(&self, rates: &[f64]) -> bool {
        !rates.iter().enumerate().any(|(i, rate)| self.blocks(i, *rate))
    }

    /// The motion along `way`, and against it, to the first position limit of the joints that take a
    /// share in it.
    pub(in crate::control) fn room(&self, way: &[f64]) -> (f64, f64) {
        let speeds = || way.iter().zip(self.columns).map(|(v, column)| v * column);
        let fastest = speeds().fold(0.0, |m: f64, speed| m.max(speed.abs()));
        let (mut forwards, mut backwards) = (f64::INFINITY, f64::INFINITY);
        for ((speed, limits), q) in speeds().zip(self.limits).zip(self.q) {
            if speed.abs() > SHARE * fastest {
                let (up, down) = ((limits.upper - q) / speed, (limits.lower - q) / speed);
                forwards = forwards.min(up.max(down));
                backwards = backwards.min(-up.min(down));
            }
        }
        (forwards, backwards)
    }
}

/// The error about a configuration, and workspace.
#[derive(Debug, Clone)]
pub(in crate::control) struct Saddle {
    /// H
    pub(in crate::control) hessian: Matrix,
    /// g
    pub(in crate::control) gradient: Vec<f64>,
    free: Matrix,
    eigen: Svd,
    is_free: Vec<bool>,
    /// The result: scaled velocities.
    pub(in crate::control) rates: Vec<f64>,
}

impl Saddle {
    /// For n joints.
    pub(in crate::control) fn new(n: usize) -> Self {
        Self {
            hessian: Matrix::zeros(n, n),
            gradient: vec![0.0; n],
            free: Matrix::zeros(n, n),
            eigen: Svd::workspace(n, n),
            is_free: vec![true; n],
            rates: vec![0.0; n],
        }
    }

    /// Computes the velocities of the way out, for a gradient and a Hessian of the error, of this size,
    /// that are loaded; false if no joint motion opens one. Where the arm `folds`, it is on the other
    /// side.
    pub(in crate::control) fn leave(
        &mut self,
        around: &Surroundings<'_>,
        size: f64,
        folds: bool,
    ) -> bool {
        for i in 0..self.rates.len() {
            let pulls = self.gradient[i].abs() > PULL * size;
            let blocked = pulls && around.blocks(i, self.gradient[i]);
            self.is_free[i] = around.columns[i] != 0.0 && !blocked;
        }
        // Every pass blocks a joint more.
        for _ in 0..=self.rates.len() {
            if !self.solve_free(around, size, folds) {
                return false;
            }
            let mut clear = true;
            for (i, (free, rate)) in self.is_free.iter_mut().zip(&self.rates).enumerate() {
                if *free && around.blocks(i, *rate) {
                    (*free, clear) = (false, false);
                }
            }
            if clear {
                self.slow_down(around);
                return true;
            }
        }
        false
    }

    /// Scales the velocities to the limits of the joints and to the bound of the inverse.
    fn slow_down(&mut self, around: &Surroundings<'_>) {
        let (all, each) = around.fastest;
        let mut scale = (all / norm(&self.rates)).min(1.0);
        let own = self.rates.iter().zip(around.columns).zip(around.limits);
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
    fn solve_free(&mut self, around: &Surroundings<'_>, size: f64, folds: bool) -> bool {
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
                    let (forwards, backwards) = around.room(way);
                    step = if forwards > backwards { whole } else { -whole };
                } else if step.abs() < DECISIVE * whole {
                    step = whole.copysign(self.side(around));
                }
                step = step.signum() * step.abs().max(whole).min(QUADRATIC);
            }
            for ((rate, v), free) in self.rates.iter_mut().zip(way).zip(&self.is_free) {
                if *free {
                    *rate += step * v;
                }
            }
        }
        let scale = around.gain * (QUADRATIC / norm(&self.rates)).min(1.0);
        self.rates.iter_mut().for_each(|rate| *rate *= scale);
        true
    }

    /// The side of the most negative curvature where the gradient names none, as a sign.
    fn side(&self, around: &Surroundings<'_>) -> f64 {
        let way = self.eigen.v(self.rates.len() - 1);
        let (forwards, backwards) = around.room(way);
        let more = forwards - backwards;
        let onwards = dot(way, around.last);
        if onwards != 0.0 && !(forwards.min(backwards) < NO_ROOM) {
            return onwards;
        }
        if more != 0.0 && !more.is_nan() {
            return more;
        }
        if onwards != 0.0 {
            return onwards;
        }
        let largest = way.iter().fold(0.0, |m: f64, v| if v.abs() > m.abs() { *v } else { m });
        1.0_f64.copysign(largest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps of no progress until it is lost.
    fn patience(progress: &mut Progress) -> usize {
        for step in 1..1000 {
            progress.record(0.0, 1e-3);
            if progress.is_lost {
                return step;
            }
        }
        panic!("{progress:?}")
    }

    /// A task that progresses again has the patience that its share gives it; more than all of its
    /// motion counts as all.
    #[test]
    fn patience_begins_anew_where_a_task_is_freed() {
        let whole = patience(&mut Progress::new());
        assert!((0.2..0.25).contains(&(whole as f64 * 1e-3)), "{whole} steps");
        for (share, expected) in [(1.0, whole), (3.0, whole)] {
            let mut progress = Progress::new();
            patience(&mut progress);
            progress.record(share, 1e-3);
            assert!(!progress.is_lost);
            assert_eq!(patience(&mut progress), expected, "{share}");
        }
        let mut progress = Progress::new();
        patience(&mut progress);
        progress.record(0.04, 1e-3);
        assert!(progress.is_lost);
        progress.record(0.1, 1e-3);
        let own = patience(&mut progress) as f64 * 1e-3;
        // The time in which 0.1 falls to `STUCK`.
        assert!((own - PATIENCE * 10.0_f64.ln()).abs() < 5e-3, "{own} s");
    }

    /// What a saddle of two joints does, of which the first at 0 is between these limits and had this
    /// velocity last.
    fn with_two_joints<T>(
        [lower, upper]: [f64; 2],
        last: f64,
        work: impl FnOnce(&mut Saddle, &Surroundings<'_>) -> T,
    ) -> T {
        let around = Surroundings {
            columns: &[1.0; 2],
            limits: &[Limits { lower, upper, ..Limits::NONE }, Limits::NONE],
            q: &[0.0; 2],
            bounds: &[VelocityBounds::NONE; 2],
            last: &[last, 0.0],
            gain: 1.0,
            fastest: (f64::INFINITY, f64::INFINITY),
        };
        work(&mut Saddle::new(2), &around)
    }

    /// The side on which the first joint leaves it.
    fn side(limits: [f64; 2], last: f64) -> f64 {
        with_two_joints(limits, last, |saddle, around| {
            (saddle.free[(0, 0)], saddle.free[(1, 1)]) = (1.0, 2.0);
            saddle.eigen.decompose(&saddle.free);
            (saddle.side(around) * saddle.eigen.v(1)[0]).signum()
        })
    }

    /// A gradient whose step is a thousandth of the way out names the side, a smaller one does not; a
    /// longer step is taken.
    #[test]
    fn a_gradient_names_the_side() {
        let size = 0.1;
        let whole = size * 2.0_f64.sqrt();
        for (share, expected) in [(3000.0, -3.0), (-3000.0, 3.0), (2.0, -1.0), (0.5, 1.0)] {
            let rate = with_two_joints([-1.0, 2.0], 0.0, |saddle, around| {
                (saddle.hessian[(0, 0)], saddle.hessian[(1, 1)]) = (-1.0, 1.0);
                saddle.gradient[0] = -share * DECISIVE * whole;
                assert!(saddle.leave(around, size, false));
                saddle.rates[0]
            });
            assert!((rate - expected * whole).abs() < 1e-12, "{share}: {rate}");
        }
    }

    /// The last motion, then the room to the limits, then the names of the joints choose a side.
    #[test]
    fn a_side_is_always_named() {
        let endless = [-f64::INFINITY, f64::INFINITY];
        for (limits, last, expected) in [
            (endless, 0.1, 1.0),
            (endless, -0.1, -1.0),
            (endless, 0.0, 1.0),
            ([-1.0, 1.0], 0.0, 1.0),
            ([-1.0, 2.0], 0.0, 1.0),
            ([-2.0, 1.0], 0.0, -1.0),
            ([-2.0, 1.0], 0.1, 1.0),
            ([-0.005, 1.0], -0.1, 1.0),
            ([-1.0, 0.005], 0.1, -1.0),
            ([-0.005, 0.005], -0.1, -1.0),
            ([-0.005, 0.005], 0.1, 1.0),
        ] {
            assert_eq!(side(limits, last), expected, "{limits:?} {last}");
        }
    }
}
