//! One branch of the configurations in which the loops are closed, followed in small steps while
//! the held coordinates move.
//!
//! Formula  r(h, f) = 0, h(s) = h0 + s d given: predictor J_f f' = -J_h d, corrector J_f df = -r
//!          with h at s + ds, both of least norm at the rank that the branch has in general
//! Shapes   J_f: held rows x free coordinates, J_h: the columns of the held ones
//! Units    none: lengths over the reach (`assembly.rs`)
//! Valid    a step is taken if |J_f' - J_f| <= (s + s') / 2, s the smallest singular value that
//!          counts, and the corrector moved less than half as far as the predictor. By Weyl's
//!          inequality s then stays above a quarter of s + s' between the two points where J_f
//!          changes evenly: no singular pose is stepped over, and by Newton and Kantorovich the
//!          solution is the one of this branch
//! Why so   a sign change of det J_f shows a crossing too, but needs J_f square and misses two at
//!          once; following by arc length would go round the fold onto the other branch, which no
//!          drive does
//! Source   Allgower & Georg 1990, chapters 3 and 6
//! Checked  tests/it/closure/continuation.rs

use super::assembly::assemble;
use super::coordinates::{columns, moved, unit_of, within_limits};
use super::initial_guesses::near;
use super::loop_closure::LoopClosure;
use crate::error::Result;
use crate::linalg::{Matrix, Svd, norm};
use crate::model::{Mechanism, NodeKind};
use crate::spatial::{Pose, Rotation, Vec3, log};
use crate::tolerance::{
    CLOSURE_RANK, CONTRADICTION, CORRECTION_ROUNDING, LIMIT_MET, LOOP_ROUNDING,
};

/// Corrections at most: three are usual.
const MOST_CORRECTIONS: usize = 12;
/// Neighbours that are asked for their rank, and how far away they are [rad, or reaches].
const NEIGHBOURS: usize = 3;
const NEAR: f64 = 0.05;

/// A configuration with closed loops.
#[derive(Debug)]
pub(crate) struct Point {
    pub(crate) closure: LoopClosure,
    /// J_f and its decomposition.
    by_free: Matrix,
    svd: Svd,
}

/// The coordinates, and where the held ones go.
#[derive(Debug, Clone)]
pub(crate) struct PathTracker<'a> {
    mechanism: &'a Mechanism,
    held: &'a [usize],
    free: Vec<usize>,
    from: Vec<f64>,
    goal: &'a [f64],
    /// d, of the held coordinates.
    direction: Vec<f64>,
    /// Rank of J_f where nothing is singular.
    rank: usize,
}

/// A step direction the tracker.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TrackerStep {
    /// Its length, as a fraction of the tracker.
    pub(crate) step: f64,
    /// Where it ends, 0 to 1.
    pub(crate) to: f64,
    /// Distance to singularities that it keeps.
    pub(crate) least: f64,
}

/// Why a step was not taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum StepRejected {
    /// The point is nearer to a singularity than allowed.
    Singular,
    /// A coordinate would leave its limits.
    Limit(usize),
    /// Too far for the corrector, or for its result to be certain.
    Far,
}

impl<'a> PathTracker<'a> {
    /// From an assembly, whose held coordinates go to `goal`.
    pub(crate) fn from(
        mechanism: &'a Mechanism,
        q: &[f64],
        (held, free): (&'a [usize], Vec<usize>),
        goal: &'a [f64],
    ) -> Result<Self> {
        let direction = displacement(mechanism, q, held, goal);
        let mut tracker =
            Self { mechanism, held, free, from: q.to_vec(), goal, direction, rank: 0 };
        tracker.rank = tracker.generic_rank()?;
        Ok(tracker)
    }

    pub(crate) fn mechanism(&self) -> &'a Mechanism {
        self.mechanism
    }

    /// The largest rank of J_f here and nearby.
    fn generic_rank(&self) -> Result<usize> {
        let rank = |q: &[f64]| -> Result<usize> { Ok(self.at(q)?.svd.rank(CLOSURE_RANK).rank) };
        let mut most = rank(&self.from)?;
        let mut random = 0;
        for _ in 0..NEIGHBOURS {
            let guess = near(self.mechanism, &self.from, NEAR, &mut random);
            let near = assemble(self.mechanism, &guess, &[])?;
            if near.closed {
                most = most.max(rank(&near.q)?);
            }
        }
        Ok(most)
    }

    pub(crate) fn at(&self, q: &[f64]) -> Result<Point> {
        let closure = LoopClosure::of(self.mechanism, q)?;
        let by_free = columns(&closure.jacobian, &self.free);
        let svd = Svd::of(&by_free);
        Ok(Point { closure, by_free, svd })
    }

    /// Smallest singular value that counts over the largest: zero at a singularity, infinite where
    /// nothing can be lost.
    pub(crate) fn distance(&self, point: &Point) -> f64 {
        match self.rank {
            0 => f64::INFINITY,
            // All zero: as singular as can be.
            _ => (self.smallest(point) / point.svd.value(0).max(f64::MIN_POSITIVE)).min(1.0),
        }
    }

    fn smallest(&self, point: &Point) -> f64 {
        if self.rank == 0 { f64::INFINITY } else { point.svd.value(self.rank - 1) }
    }

    /// The motion, of all coordinates and without unit, that is nearest to leaving the loops closed
    /// with the held ones at rest, and how much of what it would break the held ones could take up,
    /// relative to the largest singular value. `None` where nothing can be lost.
    pub(crate) fn nearly_free(&self, point: &Point) -> Option<(Vec<f64>, f64)> {
        let last = self.rank.checked_sub(1)?;
        let mut motion = vec![0.0; self.mechanism.n()];
        for (&i, v) in self.free.iter().zip(point.svd.v(last)) {
            motion[i] = *v;
        }
        let by_held = columns(&point.closure.jacobian, self.held);
        let taken = by_held.transpose().mul_vec(point.svd.u(last));
        Some((motion, norm(&taken) / point.svd.value(0).max(f64::MIN_POSITIVE)))
    }

    /// f', and true if the free coordinates can follow the held ones at all.
    pub(crate) fn tangent(&self, point: &Point) -> (Vec<f64>, bool) {
        let opened = columns(&point.closure.jacobian, self.held).mul_vec(&self.direction);
        let follow = self.back(point, &opened);
        let left: Vec<f64> =
            point.by_free.mul_vec(&follow).iter().zip(&opened).map(|(a, b)| a + b).collect();
        let possible = norm(&left) <= CONTRADICTION * norm(&opened).max(CONTRADICTION);
        (follow, possible)
    }

    /// The largest change of any coordinate, for the whole way at this rate.
    pub(crate) fn speed(&self, tangent: &[f64]) -> f64 {
        self.direction.iter().chain(tangent).fold(0.0, |m: f64, x| m.max(x.abs()))
    }

    /// The point at the end of a stride.
    pub(crate) fn step(
        &self,
        here: &Point,
        tangent: &[f64],
        TrackerStep { step, to, least }: TrackerStep,
    ) -> Result<std::result::Result<Point, StepRejected>> {
        let change: Vec<f64> = tangent.iter().map(|x| step * x).collect();
        let mut guess = moved(self.mechanism, &here.closure.q, &self.free, &change);
        self.put_held(&mut guess, to);
        let Some((there, corrected)) = self.corrected(guess)? else {
            return Ok(Err(StepRejected::Far));
        };
        let predicted = norm(&change) + step * norm(&self.direction);
        let (rows, columns) = (here.by_free.rows(), here.by_free.cols());
        let turned = Svd::of(&Matrix::from_fn(rows, columns, |i, j| {
            there.by_free[(i, j)] - here.by_free[(i, j)]
        }));
        let turned = turned.values().next().unwrap_or(0.0);
        if corrected > 0.5 * predicted + CORRECTION_ROUNDING
            || turned > 0.5 * (self.smallest(here) + self.smallest(&there))
        {
            return Ok(Err(StepRejected::Far));
        }
        if self.distance(&there) < least {
            return Ok(Err(StepRejected::Singular));
        }
        if let Some(i) = self.outside(&there.closure.q) {
            return Ok(Err(StepRejected::Limit(i)));
        }
        // Beyond a limit by rounding is at it.
        let beyond: Vec<usize> = self.mechanism.outside_limits(&there.closure.q).collect();
        if beyond.is_empty() {
            return Ok(Ok(there));
        }
        Ok(Ok(self.at(&within_limits(self.mechanism, there.closure.q, &beyond))?))
    }

    /// The first coordinate outside its limits by more than rounding.
    pub(crate) fn outside(&self, q: &[f64]) -> Option<usize> {
        self.mechanism.outside_limits(q).find(|&i| {
            let l = &self.mechanism.coordinates()[i].limits;
            (l.lower - q[i]).max(q[i] - l.upper) > LIMIT_MET * (1.0 + q[i].abs())
        })
    }

    /// The held coordinates as they are at a fraction of the way, the goal itself at the end.
    fn put_held(&self, q: &mut [f64], fraction: f64) {
        let change: Vec<f64> = self.direction.iter().map(|x| fraction * x).collect();
        let there = moved(self.mechanism, &self.from, self.held, &change);
        for (&i, goal) in self.held.iter().zip(self.goal) {
            q[i] = if fraction >= 1.0 { *goal } else { there[i] };
        }
    }

    /// Newton with the held coordinates at rest: the point and how far it is from the guess.
    fn corrected(&self, guess: Vec<f64>) -> Result<Option<(Point, f64)>> {
        let mut now = self.at(&guess)?;
        let mut moved_by = 0.0;
        for _ in 0..MOST_CORRECTIONS {
            if now.closure.residual_norm <= LOOP_ROUNDING {
                break;
            }
            let change = self.back(&now, &now.closure.residuals);
            let q = moved(self.mechanism, &now.closure.q, &self.free, &change);
            if q.iter().any(|x| !x.is_finite()) {
                return Ok(None);
            }
            let next = self.at(&q)?;
            if !(next.closure.residual_norm < 0.5 * now.closure.residual_norm) {
                break;
            }
            moved_by += norm(&change);
            now = next;
        }
        Ok(now.closure.is_closed(self.mechanism.reach()).then_some((now, moved_by)))
    }

    /// The least change of the free coordinates that takes `opened` back.
    fn back(&self, point: &Point, opened: &[f64]) -> Vec<f64> {
        point.svd.solve(opened, self.rank).iter().map(|change| -change).collect()
    }
}

/// What moves the held coordinates from `q` to `goal`, without unit: differences, for balls and
/// free bodies the screw in axes of the child.
fn displacement(mechanism: &Mechanism, q: &[f64], held: &[usize], goal: &[f64]) -> Vec<f64> {
    let mut target = q.to_vec();
    held.iter().zip(goal).for_each(|(&i, x)| target[i] = *x);
    let mut rates: Vec<f64> = target.iter().zip(q).map(|(a, b)| a - b).collect();
    let vector = |x: &[f64], i: usize| Vec3::new(x[i], x[i + 1], x[i + 2]);
    for node in mechanism.nodes() {
        let c = node.coordinate;
        let pose = |x: &[f64]| match node.kind {
            NodeKind::Spherical => Some(Pose::from_rotation(Rotation::exp(vector(x, c)))),
            NodeKind::Free => {
                Some(Pose { rotation: Rotation::exp(vector(x, c + 3)), translation: vector(x, c) })
            }
            _ => None,
        };
        if let (Some(here), Some(there)) = (pose(q), pose(&target)) {
            let twist = log(here.inverse() * there).to_array();
            let skip = 6 - node.kind.dof(); // balls only turn
            rates[c..c + node.kind.dof()].copy_from_slice(&twist[skip..]);
        }
    }
    held.iter().map(|&i| rates[i] / unit_of(mechanism, i)).collect()
}
