//! The configuration of the nearest pose to a target beyond reach: there the joints must stop.
//!
//! Formula  q <- q + (J^T J + P(C))^-1 J^T e within the limits, e the error at q, C = - e . dJ/dq
//!          (`edge.rs`), P the positive part; halved while |e| grows. A few steps in each step of the
//!          servo, from the result of the last one
//! Shapes   J: m x n, e: m
//! Units    scaled as in `task_space.rs`
//! Valid    trees of joints with one coordinate; a local minimum of |e|, that to which the present
//!          configuration descends
//! Why so   the curvature at the present configuration gives the way that is left only near its end.
//!          Joints with small acceleration limits must brake from far away
//! Checked  tests/it/servo/edge.rs, tests/it/servo/just_beyond.rs

use super::edge::Edge;
use super::task_space::TaskSpace;
use crate::control::solver::saturation::{Curvature, KnownWay, NewtonStep};
use crate::kinematics::Chain;
use crate::linalg::{Matrix, dot};
use crate::model::{Limits, Mechanism};
use crate::scalar::clamp;
use crate::spatial::Pose;
use crate::task::Task;

/// Newton steps in a step of the servo.
pub(super) const STEPS: usize = 3;
/// Largest change of a joint in one of them [rad, or characteristic lengths].
pub(super) const LONGEST: f64 = 0.4;
/// Halvings of a step.
pub(super) const HALVINGS: usize = 6;
/// A step below this share of the way that is left has arrived [-].
pub(super) const ARRIVED: f64 = 0.02;
/// Coordinates without limits start within a turn to both sides, or so many characteristic lengths [-].
const FREE: f64 = std::f64::consts::PI;
/// A step below this has arrived as well [rad, or characteristic lengths].
pub(super) const SHORT: f64 = 1e-6;

/// Times the usual gain with which joints approach a nearest pose that is known [-]: at the usual one they
/// reach limits later than those of a linearised task, which are stopped there. Found by experiment.
const FASTER: f64 = 2.0;

/// A pose towards which a motion ends.
#[derive(Debug, Clone, Copy)]
pub(super) struct EdgeAim {
    pub(super) pose: Pose,
    /// Velocity for an error of 1 [1/s].
    pub(super) gain: f64,
    /// True where no configuration reaches it.
    pub(super) is_out_of_reach: bool,
    /// True for a pose ahead of a twist, at which no motion ends.
    pub(super) is_ahead: bool,
}

impl EdgeAim {
    /// The gain on the way to the nearest pose; `None` for a pose ahead of a twist, at which no motion ends.
    pub(super) fn gain_of_way(&self, dt: f64) -> Option<f64> {
        (!self.is_ahead).then(|| (FASTER * self.gain).min(1.0 / dt))
    }
}

/// The task, its limits, and memory of the servo.
pub(super) struct Surroundings<'a> {
    pub(super) task: Task,
    pub(super) space: &'a mut TaskSpace,
    pub(super) limits: &'a [Limits],
    pub(super) hessian: &'a mut [Matrix],
}

/// The configuration, and workspace.
#[derive(Debug, Clone)]
pub(super) struct NearestPose {
    chain: Chain,
    /// Unit of the steps of each coordinate of the chain: 1 for angles, the characteristic length.
    sizes: Vec<f64>,
    /// All coordinates.
    q: Vec<f64>,
    start: Vec<f64>,
    is_known: bool,
    /// Squared error at the nearest pose.
    far: f64,
    jacobian: Matrix,
    error: Vec<f64>,
    newton: NewtonStep,
    step: Vec<f64>,
    /// From the present configuration, scaled.
    way: Vec<f64>,
    has_way: bool,
    has_arrived: bool,
}

impl NearestPose {
    /// For a task of m components and this characteristic length; `None` where joints have several
    /// coordinates.
    pub(super) fn new(mechanism: &Mechanism, chain: &Chain, m: usize, length: f64) -> Option<Self> {
        let n = chain.n();
        let all = mechanism.coordinates();
        let size = |&c: &usize| if all[c].kind.is_length() { length } else { 1.0 };
        chain.turns_and_slides().then(|| Self {
            sizes: chain.coordinates().iter().map(size).collect(),
            chain: chain.clone(),
            q: vec![0.0; all.len()],
            start: vec![0.0; all.len()],
            is_known: false,
            far: 0.0,
            jacobian: Matrix::zeros(m, n),
            error: vec![0.0; m],
            newton: NewtonStep::new(m, n),
            step: vec![0.0; n],
            way: vec![0.0; n],
            has_way: false,
            has_arrived: false,
        })
    }

    /// Number of joints.
    pub(super) fn joints(&self) -> usize {
        self.chain.n()
    }

    /// Forgets the last result.
    pub(super) const fn reset(&mut self) {
        self.is_known = false;
    }

    /// The way there from the last configuration (scaled), once it is found.
    pub(super) fn known_way(&self) -> Option<KnownWay<'_>> {
        self.has_way.then_some(KnownWay { way: &self.way, far: self.far })
    }

    /// True once the search moves no more.
    pub(super) fn has_arrived(&self) -> bool {
        self.has_arrived
    }

    /// The error that is left at the nearest pose.
    pub(super) fn left(&self) -> f64 {
        self.far.sqrt()
    }

    /// Moves on towards the nearest pose from the present configuration `q`, whose squared error is
    /// `present`. Errors up to `met` are those of poses in reach: there it ends at once.
    pub(super) fn search(
        &mut self,
        q: &[f64],
        target: Pose,
        (present, met): (f64, f64),
        around: &mut Surroundings<'_>,
    ) {
        let mut far = if self.is_known { self.load(target, around) } else { f64::INFINITY };
        // The servo has found a better one.
        if !(far <= present) {
            self.q.copy_from_slice(q);
            far = self.load(target, around);
        }
        self.is_known = true;
        let moved = self.descend(target, (far, met), around);
        let mut left = 0.0_f64;
        for (i, (way, &c)) in self.way.iter_mut().zip(self.chain.coordinates()).enumerate() {
            let change = self.q[c] - q[c];
            left = left.max(change.abs() / self.sizes[i]);
            *way = around.space.scaled_rate(i, change);
        }
        self.has_way = moved <= SHORT.max(ARRIVED * left);
    }

    /// True if joints at these velocities do not stop within the way from `q`: its length is below that in
    /// which all brake.
    pub(super) fn is_overrun(&self, q: &[f64], rates: &[f64], limits: &[Limits]) -> bool {
        let places = self.chain.coordinates().iter().zip(limits).zip(&self.sizes);
        let (mut stops, mut way) = (0.0, 0.0);
        for ((&c, limits), size) in places {
            stops += (0.5 * rates[c] * rates[c] / limits.acceleration / size).powi(2);
            way += ((self.q[c] - q[c]) / size).powi(2);
        }
        stops >= way
    }

    /// Starts elsewhere, at coordinates that are drawn between two numbers.
    pub(super) fn start(&mut self, limits: &[Limits], mut draw: impl FnMut([f64; 2]) -> f64) {
        let places = self.chain.coordinates().iter().zip(limits).zip(&self.sizes);
        for ((&c, limits), size) in places {
            let free = FREE * size;
            let lower = if limits.lower.is_finite() { limits.lower } else { -free };
            let upper = if limits.upper.is_finite() { limits.upper } else { free };
            self.q[c] = draw([lower, upper]);
        }
        self.is_known = true;
    }

    /// Moves on from the last configuration of the search; errors up to `met` are those of poses in reach.
    pub(super) fn move_on(&mut self, target: Pose, met: f64, around: &mut Surroundings<'_>) {
        let far = self.load(target, around);
        self.descend(target, (far, met), around);
    }

    /// Some steps from a configuration with the squared error `far`; the largest change of a joint in the
    /// last one.
    fn descend(
        &mut self,
        target: Pose,
        (mut far, met): (f64, f64),
        around: &mut Surroundings<'_>,
    ) -> f64 {
        let mut moved = f64::INFINITY;
        for _ in 0..STEPS {
            if moved <= SHORT || far <= met * met {
                break;
            }
            moved = self.advance(target, &mut far, around);
        }
        self.far = far;
        self.has_arrived = moved <= SHORT;
        moved
    }

    /// One step; the largest change of a joint.
    fn advance(&mut self, target: Pose, far: &mut f64, around: &mut Surroundings<'_>) -> f64 {
        around.space.load(&self.chain, &mut self.jacobian);
        let mut edge = Edge {
            chain: &self.chain,
            space: around.space,
            limits: around.limits,
            dt: 0.0,
            hessian: around.hessian,
            way: None,
            gain_of_way: None,
        };
        edge.load(&self.error, &mut self.newton.curvature);
        // A joint at a limit that would reduce the error beyond it rests.
        for (i, (limits, &c)) in around.limits.iter().zip(self.chain.coordinates()).enumerate() {
            let pull = dot(self.jacobian.column(i), &self.error);
            let q = self.q[c];
            if (pull > 0.0 && q >= limits.upper) || (pull < 0.0 && q <= limits.lower) {
                self.jacobian.column_mut(i).fill(0.0);
                for j in 0..self.chain.n() {
                    self.newton.curvature[(i, j)] = 0.0;
                    self.newton.curvature[(j, i)] = 0.0;
                }
            }
        }
        self.newton.decompose(&self.jacobian, &[&self.error]);
        self.newton.solution_into(0, &mut self.step);
        let moves = self.step.iter_mut().zip(&around.space.columns).zip(&self.sizes);
        let most = moves.fold(0.0_f64, |most, ((x, column), size)| {
            *x *= column;
            most.max(x.abs() / size)
        });
        let mut share = if most > LONGEST { LONGEST / most } else { 1.0 };
        self.start.copy_from_slice(&self.q);
        for _ in 0..HALVINGS {
            let moves = self.step.iter().zip(around.limits).zip(self.chain.coordinates());
            for ((x, limits), &c) in moves {
                self.q[c] = clamp(self.start[c] + share * x, limits.lower, limits.upper);
            }
            let then = self.load(target, around);
            if then <= *far {
                *far = then;
                return share * most;
            }
            share *= 0.5;
        }
        self.q.copy_from_slice(&self.start);
        *far = self.load(target, around);
        0.0
    }

    /// Evaluates the error at the configuration; its square.
    fn load(&mut self, target: Pose, around: &Surroundings<'_>) -> f64 {
        let pose = self.chain.set(&self.q);
        around.space.scale(around.task.seen(pose, pose.error_to(target)), &mut self.error);
        dot(&self.error, &self.error)
    }
}
