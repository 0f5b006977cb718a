//! Predictor-corrector path tracking on one branch of the closed configurations, while the
//! prescribed coordinates move.
//!
//! Formula  r(h, f) = 0 with the path h(s) = h0 + s d of the prescribed coordinates: predictor J_f
//!          f' = -J_h d, corrector (Newton) J_f df = -r at h(s + ds), both of least norm at the
//!          generic rank of the branch
//! Shapes   J_f: loop-closure rows x free coordinates, J_h: the columns of the prescribed ones
//! Units    none: lengths are divided by the characteristic length (`loop_closure.rs`)
//! Valid    a step is accepted if |J_f' - J_f| <= (s + s') / 2, with s and s' the smallest generic
//!          singular values at its ends, and if the corrector moved less than half as far as the
//!          predictor. By Weyl's inequality, s stays above a quarter of s + s' between the two
//!          points where J_f varies linearly: no singular configuration is stepped over, and by
//!          Newton-Kantorovich the solution lies on the same branch
//! Why so   a sign change of det J_f detects a crossing too, but needs a square J_f and misses
//!          double crossings; arc-length continuation would follow the fold onto the other branch,
//!          which no actuator can do
//! Source   Allgower & Georg 1990, chapters 3 and 6
//! Checked  tests/it/closure/continuation.rs

use super::assembly::assemble;
use super::coordinates::{columns, largest_change, moved, unit_of, within_limits};
use super::initial_guesses::perturbed;
use super::loop_closure::LoopClosure;
use crate::closure::constraint::rate_rank::rate_rank;
use crate::error::{Result, all_finite};
use crate::linalg::{Matrix, Svd, norm};
use crate::model::{Mechanism, NodeKind};
use crate::spatial::{Pose, Rotation, Vec3, log};
use crate::tolerance::{CLOSURE_RANK, CONTRADICTION, CORRECTION_ROUNDING, LOOP_ROUNDING};

/// Maximum number of corrector steps: three are usual.
const MAX_CORRECTIONS: usize = 12;
/// Neighbours whose rank is computed, and their distance [rad, or characteristic lengths].
const NEIGHBOURS: u64 = 3;
const NEIGHBOUR_DISTANCE: f64 = 0.05;

/// A configuration with closed loops.
#[derive(Debug)]
pub(crate) struct Point {
    pub(crate) closure: LoopClosure,
    /// J_f and its decomposition.
    by_free: Matrix,
    svd: Svd,
}

/// Tracks a path of the prescribed coordinates.
#[derive(Debug, Clone)]
pub(crate) struct PathTracker<'a> {
    mechanism: &'a Mechanism,
    prescribed: &'a [usize],
    free: Vec<usize>,
    from: Vec<f64>,
    goal: &'a [f64],
    /// d, of the prescribed coordinates.
    direction: Vec<f64>,
    /// Generic rank of J_f.
    rank: usize,
}

/// A step of the tracker.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TrackerStep {
    /// Its length, as a fraction of the path.
    pub(crate) step: f64,
    /// The path parameter at its end, 0 to 1.
    pub(crate) to: f64,
    /// Smallest accepted distance to singularities.
    pub(crate) least: f64,
}

/// The reason why a step was rejected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum StepRejected {
    /// The end is nearer to a singularity than allowed.
    Singular,
    /// A coordinate would leave its limits.
    Limit(usize),
    /// The step is too long for the corrector, or for a certified result.
    Far,
}

impl<'a> PathTracker<'a> {
    /// From an assembly, with the prescribed coordinates on a straight path to `goal`.
    pub(crate) fn from(
        mechanism: &'a Mechanism,
        q: &[f64],
        (prescribed, free): (&'a [usize], Vec<usize>),
        goal: &'a [f64],
    ) -> Result<Self> {
        let direction = displacement(mechanism, q, prescribed, goal);
        let mut tracker =
            Self { mechanism, prescribed, free, from: q.to_vec(), goal, direction, rank: 0 };
        tracker.rank = tracker.generic_rank()?;
        Ok(tracker)
    }

    pub(crate) fn mechanism(&self) -> &'a Mechanism {
        self.mechanism
    }

    /// The largest rank of J_f at the start and nearby.
    fn generic_rank(&self) -> Result<usize> {
        let rank = |q: &[f64]| -> Result<usize> { Ok(rate_rank(&self.at(q)?.svd, CLOSURE_RANK)) };
        let mut most = rank(&self.from)?;
        for number in 0..NEIGHBOURS {
            let guess = perturbed(self.mechanism, &self.from, NEIGHBOUR_DISTANCE, number);
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

    /// Smallest generic singular value over the largest: zero at a singularity, infinite if the
    /// generic rank is zero.
    pub(crate) fn distance(&self, point: &Point) -> f64 {
        match self.rank {
            0 => f64::INFINITY,
            // All singular values zero: distance zero.
            _ => (self.smallest(point) / point.svd.value(0).max(f64::MIN_POSITIVE)).min(1.0),
        }
    }

    fn smallest(&self, point: &Point) -> f64 {
        if self.rank == 0 { f64::INFINITY } else { point.svd.value(self.rank - 1) }
    }

    /// The motion (all coordinates, scaled) that violates the loops least with the prescribed
    /// coordinates at rest, and the part of its violation that the prescribed coordinates could
    /// compensate, relative to the largest singular value. `None` if the generic rank is zero.
    pub(crate) fn nearly_free(&self, point: &Point) -> Option<(Vec<f64>, f64)> {
        let last = self.rank.checked_sub(1)?;
        let mut motion = vec![0.0; self.mechanism.n()];
        for (&i, v) in self.free.iter().zip(point.svd.v(last)) {
            motion[i] = *v;
        }
        let by_prescribed = columns(&point.closure.jacobian, self.prescribed);
        let taken = by_prescribed.transpose().mul_vec(point.svd.u(last));
        Some((motion, norm(&taken) / point.svd.value(0).max(f64::MIN_POSITIVE)))
    }

    /// f', and true if the free coordinates can follow the prescribed ones.
    pub(crate) fn tangent(&self, point: &Point) -> (Vec<f64>, bool) {
        let opened = columns(&point.closure.jacobian, self.prescribed).mul_vec(&self.direction);
        let follow = self.back(point, &opened);
        let left: Vec<f64> =
            point.by_free.mul_vec(&follow).iter().zip(&opened).map(|(a, b)| a + b).collect();
        let possible = norm(&left) <= CONTRADICTION * norm(&opened).max(CONTRADICTION);
        (follow, possible)
    }

    /// The largest change of a joint over the whole path, at this tangent.
    pub(crate) fn speed(&self, tangent: &[f64]) -> f64 {
        let prescribed = largest_change(self.mechanism, self.prescribed, &self.direction);
        prescribed.max(largest_change(self.mechanism, &self.free, tangent))
    }

    /// The point at the end of a step.
    pub(crate) fn step(
        &self,
        here: &Point,
        tangent: &[f64],
        TrackerStep { step, to, least }: TrackerStep,
    ) -> Result<std::result::Result<Point, StepRejected>> {
        let change: Vec<f64> = tangent.iter().map(|x| step * x).collect();
        let mut guess = moved(self.mechanism, &here.closure.q, &self.free, &change);
        self.set_prescribed(&mut guess, to);
        let Some((there, corrected)) = self.corrected(guess)? else {
            return Ok(Err(StepRejected::Far));
        };
        let predicted = norm(&change) + step * norm(&self.direction);
        let (rows, columns) = (here.by_free.rows(), here.by_free.cols());
        let turned = Svd::of(&Matrix::from_fn(rows, columns, |i, j| {
            there.by_free[(i, j)] - here.by_free[(i, j)]
        }))
        .largest();
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
        // Within rounding of a limit counts as at the limit.
        let beyond: Vec<usize> = self.mechanism.outside_limits(&there.closure.q).collect();
        if beyond.is_empty() {
            return Ok(Ok(there));
        }
        Ok(Ok(self.at(&within_limits(self.mechanism, there.closure.q, &beyond))?))
    }

    /// The first coordinate outside its limits by more than rounding.
    pub(crate) fn outside(&self, q: &[f64]) -> Option<usize> {
        let coordinates = self.mechanism.coordinates();
        self.mechanism.outside_limits(q).find(|&i| coordinates[i].limits.exclude(q[i]))
    }

    /// Sets the prescribed coordinates at a fraction of the path; at its end exactly to the goal.
    fn set_prescribed(&self, q: &mut [f64], fraction: f64) {
        let change: Vec<f64> = self.direction.iter().map(|x| fraction * x).collect();
        let there = moved(self.mechanism, &self.from, self.prescribed, &change);
        for (&i, goal) in self.prescribed.iter().zip(self.goal) {
            q[i] = if fraction >= 1.0 { *goal } else { there[i] };
        }
    }

    /// Newton corrector with the prescribed coordinates fixed: the point and its distance from the
    /// guess.
    fn corrected(&self, guess: Vec<f64>) -> Result<Option<(Point, f64)>> {
        let mut now = self.at(&guess)?;
        let mut moved_by = 0.0;
        for _ in 0..MAX_CORRECTIONS {
            if now.closure.residual_norm <= LOOP_ROUNDING {
                break;
            }
            let change = self.back(&now, &now.closure.residuals);
            let q = moved(self.mechanism, &now.closure.q, &self.free, &change);
            if !all_finite(&q) {
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

    /// The least-norm change of the free coordinates that compensates the violation `opened`.
    fn back(&self, point: &Point, opened: &[f64]) -> Vec<f64> {
        point.svd.solve(opened, self.rank).iter().map(|change| -change).collect()
    }
}

/// The scaled displacement of the prescribed coordinates from `q` to `goal`: differences, for
/// spherical and free joints the screw displacement in child axes.
fn displacement(mechanism: &Mechanism, q: &[f64], prescribed: &[usize], goal: &[f64]) -> Vec<f64> {
    let mut target = q.to_vec();
    prescribed.iter().zip(goal).for_each(|(&i, x)| target[i] = *x);
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
            // As `Mechanism::integrate` advances them.
            let reversed = node.multiplier < 0.0;
            let between = if reversed { there * here.inverse() } else { here.inverse() * there };
            let twist = log(between).to_array();
            let skip = 6 - node.kind.dof(); // spherical joints only rotate
            rates[c..c + node.kind.dof()].copy_from_slice(&twist[skip..]);
        }
    }
    prescribed.iter().map(|&i| rates[i] / unit_of(mechanism, i)).collect()
}
