//! Escape from configurations in which the linearised task makes no progress although a finite motion
//! would: stretched arms and other singularities, joints at limits.
//!
//! Formula  `saddle.rs`, with the Hessian H = J^T J - e . dJ/dq
//! Shapes   J: m x n, H: n x n, e: m      Units    scaled task coordinates
//! Valid    trees, orthogonal projections
//! Why so   a truncated inverse is at rest already near a saddle; the inverse alone with |l| in place of
//!          l is a step of descent everywhere
//!          The linearised task itself folds a stretched arm to the side on which it happens to stand:
//!          where that side has little room to the limits the escape takes the other one at once
//! Checked  tests/it/servo/escape.rs

use super::edge::Edge;
use super::saddle::{OPEN, Progress, QUADRATIC, Saddle, Surroundings};
use crate::control::solver::bounds::VelocityBounds;
use crate::control::solver::saturation::Curvature;
use crate::inverse::Method;
use crate::linalg::{Matrix, Svd, dot, norm};

/// Singular values above this share of the largest are those of directions that are not lost [-].
const WEAK: f64 = 0.05;

/// Ratio of singular values below which an arm is stretched [-].
pub(super) const FOLD: f64 = 0.02;

/// An arm folds to the other side if it has more than so many times the room to its limits [-].
const ROOMIER: f64 = 2.0;

/// Progress of the linearised task, and workspace.
#[derive(Debug, Clone)]
pub(super) struct Escape {
    pub(super) progress: Progress,
    pub(super) saddle: Saddle,
    /// The desired motion over the gain, scaled.
    pub(super) error: Vec<f64>,
    /// The motion of the joints to the side to which the arm has begun to fold; zero before.
    side: Vec<f64>,
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
    /// The joints about the configuration.
    fn around<'a>(&'a self, edge: &'a Edge<'_>) -> Surroundings<'a> {
        Surroundings {
            columns: &edge.space.columns,
            limits: edge.limits,
            q: edge.chain.q(),
            bounds: self.bounds,
            last: self.last,
            gain: self.gain,
            fastest: self.fastest(),
        }
    }

    /// The largest velocities of all joints that the inverse promises, and of each.
    fn fastest(&self) -> (f64, f64) {
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
            progress: Progress::new(),
            saddle: Saddle::new(n),
            error: vec![0.0; m],
            side: vec![0.0; n],
        }
    }

    /// The linearised task progresses.
    pub(super) fn reset(&mut self) {
        self.progress.reset();
        self.side.fill(0.0);
    }

    /// True at the edge of reach where the error leads back inside and the linearised task would fold
    /// the arm to a side with little room to the position limits, although the other one has more. An
    /// arm that has begun goes on while that side has more, and never back: it would rattle where the room
    /// ceases to be little.
    pub(super) fn folds_at_limit(&mut self, task: Linearised<'_>, edge: &mut Edge<'_>) -> bool {
        let Some(k) = task.svd.len().checked_sub(1) else { return false };
        if !(task.svd.value(k) < FOLD * task.svd.value(0)) {
            return false;
        }
        let (way, along) = (task.svd.v(k), dot(task.svd.u(k), &self.error));
        let (forwards, backwards) = task.around(edge).room(way);
        let (own, other) = if along > 0.0 { (forwards, backwards) } else { (backwards, forwards) };
        let onwards = dot(way, &self.side) * -along.signum();
        let has_little = ROOMIER * own < other && own < QUADRATIC;
        if onwards < 0.0 || !(has_little || onwards > 0.0 && own < other) {
            return false;
        }
        let Saddle { hessian, gradient, .. } = &mut self.saddle;
        edge.load(&self.error, hessian);
        hessian.mul_vec_into(way, gradient);
        let curvature = dot(way, gradient) + task.svd.value(k).powi(2);
        let folds = curvature < -OPEN * along.abs();
        let sign = if folds { -along.signum() } else { 0.0 };
        self.side.iter_mut().zip(way).for_each(|(side, v)| *side = sign * v);
        folds
    }

    /// Computes the velocities of an escape, or, where the arm `folds`, of the other side; false if no
    /// joint motion opens a way.
    pub(super) fn solve(&mut self, task: Linearised<'_>, edge: &mut Edge<'_>, folds: bool) -> bool {
        let Saddle { hessian, gradient, .. } = &mut self.saddle;
        let n = gradient.len();
        let size = norm(&self.error);
        if !folds {
            edge.load(&self.error, hessian); // otherwise loaded already
        }
        for i in 0..n {
            gradient[i] = dot(task.j.column(i), &self.error);
            for k in 0..n {
                hessian[(i, k)] += dot(task.j.column(i), task.j.column(k));
            }
        }
        // A task that a weak inverse slows down is not lost.
        let along = |u: &[f64]| dot(u, &self.error).powi(2);
        let strong = (0..task.svd.len()).filter(|i| task.svd.value(*i) > WEAK * task.svd.value(0));
        let strong: f64 = strong.map(|i| along(task.svd.u(i))).sum();
        let around = task.around(edge);
        if !folds && strong > 0.5 * size * size && around.are_free(gradient) {
            return false;
        }
        self.saddle.leave(&around, size, folds)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The largest joint velocity for a twist of size 3 and singular values of at most 2.
    #[test]
    fn escapes_are_as_fast_as_their_inverses_may_be() {
        let j = Matrix::from_fn(2, 2, |i, k| if i == k { [2.0, 0.5][i] } else { 0.0 });
        let svd = Svd::of(&j);
        let fastest = |method: Method| {
            let (bounds, last) = (&[][..], &[][..]);
            Linearised { j: &j, svd: &svd, bounds, last, gain: 5.0, method, size: 3.0 }.fastest()
        };
        let all = f64::INFINITY;
        let cases = [
            (Method::Truncated { eps: 0.01 }, (3.0 / 0.02, all)),
            (Method::Damped { damping: 0.05 }, (30.0, all)),
            (Method::VariableDamping { onset: 0.01, damping: 0.05 }, (3.0 / 0.02, all)),
            (Method::VariableDamping { onset: 0.5, damping: 0.05 }, (30.0, all)),
            (
                Method::NumericalFiltering { onset: 0.01, damping: 0.05, filter: 0.2 },
                (3.0 / 0.02, all),
            ),
            (Method::SingularValueFiltering { shape: 10.0, floor: 0.1 }, (30.0, all)),
            (Method::SelectivelyDamped { max_joint_velocity: 0.7 }, (all, 0.7)),
        ];
        for method in Method::ALL {
            assert!(cases.iter().any(|(of, _)| of.name() == method.name()), "{method:?}");
        }
        for (method, (expected, each)) in cases {
            let found = fastest(method);
            assert!((found.0 - expected).abs() < 1e-12 || found.0 == expected, "{method:?}");
            assert_eq!(found.1, each, "{method:?}");
        }
    }
}
