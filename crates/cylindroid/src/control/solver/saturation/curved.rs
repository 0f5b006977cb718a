//! A changed direction where a part of the task is out of reach: the curvature of what is left of the
//! error takes the place of a scalar damping, and the motion slows down early enough to stop there.
//!
//! Formula  min |J y - s x|^2 + y^T C y within the bounds, C = P(- e_l . dJ/dq) + d, P the part with
//!          positive eigenvalues, e_l the error that the bounds leave; near the best pose y is s gain
//!          times the Newton step to it, (J^T J + C)^-1 J^T e; s lets every joint stop within that
//! Straight where the way w to the nearest pose, with the error e*, is known: y = s k (w + t J^T e), k its
//!          gain, t >= 0 the least with which |e|^2 / 2 falls at first by f, its fall on the whole way: a
//!          path along which it is convex does so; |t J^T e| is at most `ASIDE` |w|. Not where w climbs by
//!          more than `WINDING` f: the way winds; of trees only those with self-motions, m < n
//! Shapes   J: m x n, C: n x n, w: n
//! Valid    e_l is at most as large as the error
//! Why so   |J y - x|^2 alone ends with full speed at the edge of reach, and a scalar damping that
//!          prevents it slows weak directions that are not at an edge. Far from the edge the Newton step
//!          is many times as long as the way, mainly self-motions, which swing and hold up the rest
//! Source   Nocedal & Wright, Numerical Optimization, 2006, section 10.1 (Newton's method for least
//!          squares)
//! Checked  tests/it/servo/edge.rs, tests/it/servo/closed_edges.rs

use super::newton_step::NewtonStep;
use super::problem::{FED_FORWARD, Problem};
use crate::control::solver::active_set::{ActiveSet, Level, Precision};
use crate::control::solver::bounds::LimitKind;
use crate::linalg::{Matrix, dot, norm};
use crate::scalar::clamp;

/// Joint velocities below this share of all are roundings of zero [-].
const ROUNDING: f64 = 1e-9;

/// Share of its fall by which the error may rise at first on a way that is taken straight [-]. Found by
/// experiment: 3RRR robots pass type II singularities on ways that wind, two arms rise by less.
const WINDING: f64 = 0.3;

/// The largest motion along the gradient that is added to a way, as a share of its length [-]: near the edge,
/// where the gradient ceases, a longer one leads to and fro (found by experiment with a panda).
const ASIDE: f64 = 0.5;

/// Velocities below this share of those of the way come to rest where they lead away from it [-]: turned to
/// the task, joints were off the way again and chattered, one step on and one back (found by experiment with
/// a panda, steps of 2 ms).
const NEARLY_AT_REST: f64 = 0.05;

/// The way to the nearest pose.
#[derive(Debug, Clone, Copy)]
pub(in crate::control) struct KnownWay<'a> {
    /// In the unknowns.
    pub(in crate::control) way: &'a [f64],
    /// The squared error there.
    pub(in crate::control) far: f64,
}

/// The second derivatives of a task, and the limits of its joints.
pub(in crate::control) trait Curvature {
    /// `out = - left . dJ/dq`, symmetric, n x n, in the coordinates of the task and its unknowns.
    fn load(&mut self, left: &[f64], out: &mut Matrix);

    /// The share of `rates` from which every joint can stop within `way`; `gradient` is that of the
    /// task along the unknowns.
    fn share(&mut self, way: &[f64], rates: &[f64], gradient: &[f64]) -> f64;

    /// The way to the nearest pose, once it is found.
    fn known_way(&self) -> Option<KnownWay<'_>>;

    /// Velocities for a way of 1 where it may be taken straight [1/s].
    fn gain_of_way(&self) -> Option<f64>;
}

/// The path of a task.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::control) enum Path {
    /// Straight as long as the bounds permit.
    Straight,
    /// Towards the nearest pose from the start: the target is out of reach.
    Curved,
}

/// Workspace.
#[derive(Debug, Clone)]
pub(super) struct Curved {
    left: Vec<f64>,
    newton: NewtonStep,
    /// The same problem as n rows.
    level: Level,
    way: Vec<f64>,
    rates: Vec<f64>,
    /// J^T x, x the task.
    gradient: Vec<f64>,
    /// J^T e
    descent: Vec<f64>,
}

impl Curved {
    pub(super) fn new(m: usize, n: usize) -> Self {
        Self {
            left: vec![0.0; m],
            newton: NewtonStep::new(m, n),
            level: Level::new(n, n),
            way: vec![0.0; n],
            rates: vec![0.0; n],
            gradient: vec![0.0; n],
            descent: vec![0.0; n],
        }
    }

    /// Moves `set`, at its start, to the solution; `task` is the task without curvature.
    pub(super) fn solve(
        &mut self,
        set: &mut ActiveSet,
        task: &mut Level,
        (p, last): (&Problem<'_>, &[f64]),
        curvature: &mut dyn Curvature,
    ) {
        set.least_residual(task, Precision::STRAIGHT);
        self.left.copy_from_slice(task.left(set.point()));
        let (size, error) = (norm(&self.left), norm(p.error));
        let scale = if size > 0.0 { (1.0 / p.gain).min(error / size) } else { 0.0 };
        self.left.iter_mut().for_each(|x| *x *= scale);
        curvature.load(&self.left, &mut self.newton.curvature);
        self.newton.decompose(p.j, &[&task.target, p.error]);
        self.newton.solution_into(0, &mut self.rates);
        self.newton.solution_into(1, &mut self.way);
        // Joints that take no part in the task move by rounding only, and have no way.
        let rounding = ROUNDING * norm(&self.rates);
        self.rates.iter_mut().filter(|rate| rate.abs() <= rounding).for_each(|rate| *rate = 0.0);
        self.newton.rows_into(&mut self.level.rows);
        let speed = norm(&task.target);
        let share = if speed > FED_FORWARD * p.gain * error {
            1.0
        } else {
            for (j, g) in self.gradient.iter_mut().enumerate() {
                *g = dot(p.j.column(j), &task.target);
            }
            let known = curvature.known_way().zip(curvature.gain_of_way());
            let is_straight = known.is_some_and(|known| self.head_straight(p, speed, known));
            let whole = curvature.share(&self.way, &self.rates, &self.gradient);
            if is_straight {
                self.rates.iter_mut().for_each(|rate| *rate *= whole);
                self.move_together(set, last);
                return;
            }
            if self.slide_along_limits(set, (p, last)) {
                let along = curvature.share(&self.way, &self.rates, &self.gradient);
                // Joints with self-motions may leave this way: the mean swings less, and creeps less
                // (found by experiment with two arms).
                let has_self_motions = p.j.rows() < p.j.cols();
                if has_self_motions { (whole * along).sqrt() } else { along }
            } else {
                whole
            }
        };
        for (b, x) in self.level.target.iter_mut().zip(self.newton.right_side(0)) {
            *b = share * x;
        }
        set.start(last);
        set.least_residual(&mut self.level, Precision::STRAIGHT);
    }

    /// Replaces the velocities by those along the way, at most as fast as the task, whose speed is
    /// `speed`; false where it is not taken.
    fn head_straight(
        &mut self,
        p: &Problem<'_>,
        speed: f64,
        (KnownWay { way, far }, gain): (KnownWay<'_>, f64),
    ) -> bool {
        for (j, d) in self.descent.iter_mut().enumerate() {
            *d = dot(p.j.column(j), p.error);
        }
        let fall = 0.5 * (dot(p.error, p.error) - far);
        let along = dot(&self.descent, way);
        if !(along > -WINDING * fall) {
            return false;
        }
        let steepest = dot(&self.descent, &self.descent);
        let less = (fall - along).max(0.0);
        let most = ASIDE * (dot(way, way) / steepest).sqrt();
        let more = if steepest > 0.0 { (less / steepest).min(most) } else { 0.0 };
        for ((rate, d), w) in self.rates.iter_mut().zip(&self.descent).zip(way) {
            *rate = gain * (w + more * d);
        }
        p.j.mul_vec_into(&self.rates, &mut self.left);
        let scale = (speed / norm(&self.left)).min(1.0);
        self.rates.iter_mut().for_each(|rate| *rate *= scale);
        true
    }

    /// Moves `set` to the largest share of the velocities within the bounds: no joint leaves the path while
    /// others accelerate. Where the last ones are off the path, to those nearest to their part along it,
    /// and where they lead away from it, as near to the task as they can turn, or to rest if they are small.
    fn move_together(&mut self, set: &mut ActiveSet, last: &[f64]) {
        let Level { rows, target, .. } = &mut self.level;
        let within = set.inequalities.share_within(&self.rates);
        let square = dot(&self.rates, &self.rates).max(f64::MIN_POSITIVE);
        let along = dot(&self.rates, last) / square;
        let is_slow = dot(last, last) < NEARLY_AT_REST * NEARLY_AT_REST * square;
        if within.is_none() && along < 0.0 && !is_slow {
            rows.mul_vec_into(&self.rates, target);
        } else {
            let share = within.unwrap_or(clamp(along, 0.0, 1.0));
            rows.as_mut_slice().fill(0.0);
            for (j, (x, rate)) in target.iter_mut().zip(&self.rates).enumerate() {
                rows[(j, j)] = 1.0;
                *x = share * rate;
            }
        }
        set.start(last);
        set.least_residual(&mut self.level, Precision::STRAIGHT);
    }

    /// Replaces the velocities by those within the bounds of positions alone, where they leave them: a
    /// motion into a limit has no way, and would hold up the one along it. False where they are within.
    fn slide_along_limits(
        &mut self,
        set: &mut ActiveSet,
        (p, last): (&Problem<'_>, &[f64]),
    ) -> bool {
        let mut leaves = false;
        for (i, bound) in p.bounds.iter().enumerate() {
            let rate = set.inequalities.value(i, &self.rates);
            let (above, below) = (bound.upper_cause, bound.lower_cause);
            leaves |= (above == LimitKind::Position && rate > bound.upper)
                || (below == LimitKind::Position && rate < bound.lower);
        }
        if !leaves {
            return false;
        }
        let positions = |set: &mut ActiveSet, alone: bool| {
            let sides = set.inequalities.lower.iter_mut().zip(&mut set.inequalities.upper);
            for ((lower, upper), bound) in sides.zip(p.bounds) {
                let free = |cause: LimitKind| alone && cause != LimitKind::Position;
                *lower = if free(bound.lower_cause) { f64::NEG_INFINITY } else { bound.lower };
                *upper = if free(bound.upper_cause) { f64::INFINITY } else { bound.upper };
            }
        };
        positions(set, true);
        self.level.target.copy_from_slice(self.newton.right_side(0));
        if set.start(last) {
            set.least_residual(&mut self.level, Precision::STRAIGHT);
            self.rates.copy_from_slice(set.point());
        }
        positions(set, false);
        true
    }
}
