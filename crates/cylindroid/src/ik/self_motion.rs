//! Descent along the self-motion of a redundant mechanism: from one solution to the best one that
//! is connected with it, the closest to a configuration or that of a criterion.
//!
//! Formula  d = -(1 - A+ A) grad c, joints clamped at a limit that d would leave; c the cost, half
//!          of the squared distance or that of `ascent.rs`;
//!          q <- q + s d, then back to the goals by Levenberg-Marquardt steps;
//!          s = |dq|^2 / <dq, dd> with the changes of q and -d in the last step
//! Shapes   A: m x n by columns, d: n
//! Valid    any tree; a local minimum of the cost. Every step decreases it
//! Why so   with one redundant joint s is the step of the secant method: a handful of steps, where
//!          a projected gradient takes thirty
//! Source   Barzilai & Borwein 1988
//! Checked  tests/it/ik.rs::the_nearest_answer, src/ik/nearest.rs, tests/it/ik_criteria.rs

use super::ascent::Ascent;
use super::convergence::{is_reached, stretch};
use super::levenberg_marquardt::Problem;
use super::options::IkOptions;
use crate::linalg::{DampedProblem, dot};
use crate::scalar::clamp;

/// Largest number of steps.
const STEPS: usize = 60;
/// Damping of the projection, relative to the squared norm of A.
const DAMPING: f64 = 1e-9;
/// First step length.
const FIRST_SHARE: f64 = 0.5;
/// Range of the step length, and the factor after a step that does not decrease the cost.
const SHARES: (f64, f64) = (1e-3, 8.0);
const SHORTER: f64 = 0.25;
/// Largest change of a coordinate per step [rad, or m; of long slides a share of their travel].
const LONGEST: f64 = 0.6;
/// The descent ends where |d|^2 is below this share of the squared distance; of a criterion, of 1.
const FLAT: f64 = 1e-9;
/// A configuration is at the boundary of a half-space within this multiple of the tolerance [-].
const BOUNDARY: f64 = 10.0;
/// Levenberg-Marquardt steps per step along the self-motion.
const CORRECTIONS: usize = 8;
/// A descent this close to a known minimum leads there [rad, or lengths].
const NEAR: f64 = 0.05;

/// What a descent makes smaller.
#[derive(Debug)]
pub(super) enum Aim<'a> {
    /// The distance from a configuration.
    Closest(&'a [f64]),
    /// The cost of a criterion.
    Criterion(&'a mut Ascent),
}

impl Aim<'_> {
    /// Twice the cost at `q`: the squared distance.
    fn twice_cost(&mut self, problem: &Problem, q: &[f64]) -> f64 {
        match self {
            Self::Closest(start) => problem.squared_distance(q, start),
            Self::Criterion(ascent) => 2.0 * ascent.cost(problem, q),
        }
    }

    /// Minus the gradient of the cost at `q`, over the coordinates of the problem.
    fn descent_into(&mut self, problem: &Problem, q: &[f64], out: &mut [f64]) {
        match self {
            Self::Closest(start) => {
                for (out, &c) in out.iter_mut().zip(&problem.coordinates) {
                    *out = start[c] - q[c];
                }
            }
            Self::Criterion(ascent) => ascent.gradient(problem, q, out),
        }
    }
}

/// Workspace of the descent.
#[derive(Debug, Clone)]
pub(super) struct Descent {
    next: Vec<f64>,
    last_q: Vec<f64>,
    last_d: Vec<f64>,
    done: Vec<f64>,
    free_part: Vec<f64>,
    desired: Vec<f64>,
    /// Half-spaces that the projection keeps.
    bounding: Vec<bool>,
    /// Minima of the distance that descents found, if they are collected.
    minima: Option<Vec<Vec<f64>>>,
}

impl Descent {
    pub(super) fn new(problem: &Problem) -> Self {
        let n = problem.coordinates.len();
        Self {
            next: vec![0.0; problem.mechanism.n()],
            last_q: vec![0.0; n],
            last_d: vec![0.0; n],
            done: vec![0.0; problem.m],
            free_part: vec![0.0; n],
            desired: vec![0.0; n],
            bounding: Vec::new(),
            minima: None,
        }
    }

    /// From here on descents end where they come near the minimum of another one.
    pub(super) fn collect_minima(&mut self) {
        self.minima.get_or_insert_default().clear();
    }

    /// Descents run to their own ends again.
    pub(super) fn end_collection(&mut self) {
        self.minima = None;
    }

    /// True if a known minimum is near.
    fn leads_to_minimum(&self, problem: &Problem, q: &[f64]) -> bool {
        let minima = self.minima.as_deref().unwrap_or_default();
        minima.iter().any(|known| problem.squared_distance(q, known) < NEAR * NEAR)
    }

    /// Moves the solution `q` along the solutions to a minimum of the cost; gives up as soon as a
    /// twofold cost below `bound` is not expected.
    pub(super) fn run(
        &mut self,
        problem: &mut Problem,
        (q, mut aim): (&mut [f64], Aim<'_>),
        options: &IkOptions,
        bound: f64,
    ) {
        let mut far = aim.twice_cost(problem, q);
        let mut share = FIRST_SHARE;
        problem.evaluate(q);
        for step in 0..STEPS {
            if self.leads_to_minimum(problem, q) {
                return;
            }
            aim.descent_into(problem, q, &mut self.desired);
            if !self.project(problem, q, options) {
                return;
            }
            let slope = dot(&problem.d, &problem.d);
            let scale = if matches!(aim, Aim::Closest(_)) { far } else { 1.0 };
            if slope <= FLAT * scale {
                if let Some(minima) = &mut self.minima {
                    minima.push(q.to_vec());
                }
                return;
            }
            if step > 0 {
                share = self.next_share(problem, q, share);
                // Four times what a parabola promises.
                if far - 4.0 * share * slope > bound {
                    return;
                }
            }
            let most = problem.largest_change();
            share = share.min(LONGEST / most);
            self.last_d.copy_from_slice(&problem.d);
            for (last, &c) in self.last_q.iter_mut().zip(&problem.coordinates) {
                *last = q[c];
            }
            loop {
                problem.d.iter_mut().zip(&self.last_d).for_each(|(d, last)| *d = share * last);
                self.next.copy_from_slice(q);
                problem.advance(&mut self.next);
                let (errors, _) = problem.run(&mut self.next, options, CORRECTIONS);
                let then = aim.twice_cost(problem, &self.next);
                if is_reached(errors, options) && then < far {
                    far = then;
                    break;
                }
                share *= SHORTER;
                if share < SHARES.0 {
                    return;
                }
            }
            q.copy_from_slice(&self.next);
        }
    }

    /// The step length from the last step.
    fn next_share(&self, problem: &Problem, q: &[f64], share: f64) -> f64 {
        let (mut squared, mut product) = (0.0, 0.0);
        for (i, &c) in problem.coordinates.iter().enumerate() {
            let moved = q[c] - self.last_q[i];
            squared += moved * moved;
            product += moved * (self.last_d[i] - problem.d[i]);
        }
        let next = if product > 0.0 { squared / product } else { 2.0 * share };
        clamp(next, SHARES.0, SHARES.1)
    }

    /// The part of a motion `desired` of the problem's coordinates that keeps the goals, into the
    /// step of the problem; returns its product with a gradient over all coordinates. `None` if
    /// there is none.
    pub(super) fn along_solutions(
        &mut self,
        problem: &mut Problem,
        q: &[f64],
        (desired, gradient): (&[f64], &[f64]),
        options: &IkOptions,
    ) -> Option<f64> {
        problem.evaluate(q);
        self.desired.copy_from_slice(desired);
        self.project(problem, q, options).then(|| {
            problem.coordinates.iter().zip(&problem.d).map(|(&c, d)| gradient[c] * d).sum()
        })
    }

    /// Null-space projection d = (1 - A+ A) desired at the configuration evaluated last; false if it
    /// fails.
    fn project(&mut self, problem: &mut Problem, q: &[f64], options: &IkOptions) -> bool {
        problem.load_goals();
        let (m, n) = (problem.m, problem.coordinates.len());
        let half_spaces = problem.half_spaces.all.len();
        self.bounding.clear();
        self.bounding.resize(half_spaces, false);
        let damping = DAMPING * dot(&problem.a, &problem.a);
        problem.clamped.copy_from_slice(&problem.fixed);
        for _ in 0..=n + half_spaces {
            self.done.fill(0.0);
            for (i, desired) in self.desired.iter().enumerate() {
                let desired = if problem.clamped[i] { 0.0 } else { *desired };
                self.free_part[i] = desired;
                for (done, a) in self.done.iter_mut().zip(&problem.a[i * m..]) {
                    *done += a * desired;
                }
            }
            let (a, e, clamped) = (&problem.a, &self.done, &problem.clamped);
            let step = DampedProblem { a, e, clamped, damping };
            if !problem.damped.solve(step, &mut problem.d) {
                return false;
            }
            problem.d.iter_mut().zip(&self.free_part).for_each(|(d, free)| *d = free - *d);
            let is_clamped = problem.clamp_at_limits(q);
            if !self.add_half_spaces(problem, options) && !is_clamped {
                break;
            }
        }
        true
    }

    /// Adds the rows of half-spaces at whose boundary the configuration is, and which the step would
    /// leave; true if there were any.
    fn add_half_spaces(&mut self, problem: &mut Problem, options: &IkOptions) -> bool {
        let mut any = false;
        for i in 0..self.bounding.len() {
            let is_near = problem.half_spaces.rooms[i] < BOUNDARY * options.position_tolerance;
            if self.bounding[i] || !is_near {
                continue;
            }
            let Some(state) = &problem.state else { continue };
            let gradient = problem.half_spaces.gradient(i, state);
            let moves = problem.coordinates.iter().zip(&problem.d);
            if moves.map(|(&c, d)| gradient[c] * d).sum::<f64>() < 0.0 {
                problem.load_half_space(i);
                self.bounding[i] = true;
                any = true;
            }
        }
        any
    }
}

impl Problem {
    /// The largest change of a coordinate in the step `d` [rad, or m], that of a long slide divided by
    /// its travel in steps, of one without limits 0: the distance that other coordinates make up for
    /// bounds it.
    pub(super) fn largest_change(&self) -> f64 {
        let changes = self.d.iter().zip(&self.travel);
        changes.fold(0.0, |most, (d, t)| most.max(d.abs() / stretch(*t, f64::INFINITY)))
    }

    /// Squared distance of two configurations over the coordinates that move the end effectors.
    pub(super) fn squared_distance(&self, a: &[f64], b: &[f64]) -> f64 {
        self.coordinates.iter().map(|&c| (a[c] - b[c]).powi(2)).sum()
    }
}
