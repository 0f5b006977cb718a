//! The Nelder-Mead method in the unit cube, restarted until new simplices improve nothing.
//!
//! Formula  coordinates outside [0, 1] are reflected at its ends, so that an optimum at an end is one
//!          of the method too; coefficients 1, 1 + 2/n, 1/2, 1 - 1/n for n parameters
//! Shapes   n numbers of [0, 1]
//! Valid    any function, infinite where a design has no index; finite at the start
//! Why so   indices have kinks where singular values meet, which is where the best designs are, so no
//!          derivatives are taken. A simplex can collapse before it is at an optimum: the method starts
//!          anew around its end, with simplices of different sizes, until two of them in turn improve
//!          nothing. The method is that of the crate argmin; it is deterministic
//! Source   Nelder & Mead 1965; Gao & Han 2012 (coefficients); Kelley 1999 (restarts)
//! Checked  tests in this file, tests/sweep/optimise.rs

use std::cell::RefCell;

use argmin::core::{
    CostFunction, Error as ArgminError, Executor, IterState, KV, Problem, Solver, State,
    TerminationReason, TerminationStatus,
};
use argmin::solver::neldermead::NelderMead;

use crate::tolerance::{OPTIMUM_AT_END, OPTIMUM_IMPROVED};

/// Edges of the simplices, of the cube, in turn.
const EDGES: [f64; 5] = [0.1, 0.02, 0.3, 1e-3, 1e-5];
/// Simplices that improve nothing, in turn, at the end.
const IDLE: usize = 2;
/// Iterations of a simplex without a better point, for each of its vertices.
const STALLED: u64 = 25;

type Point = Vec<f64>;
type Iteration = IterState<Point, (), (), (), (), f64>;

/// The end of a refinement.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Minimum {
    pub(super) x: Point,
    pub(super) cost: f64,
    pub(super) evaluations: u64,
    pub(super) converged: bool,
}

/// A function with its best point and a number of evaluations that is left.
struct Budgeted<'a> {
    of: &'a dyn Fn(&[f64]) -> f64,
    best: RefCell<Minimum>,
    most: u64,
}

impl Budgeted<'_> {
    fn spent(&self) -> bool {
        self.best.borrow().evaluations >= self.most
    }

    fn value(&self, x: &[f64]) -> f64 {
        if self.spent() {
            return f64::INFINITY;
        }
        let x: Point = x.iter().map(|x| reflected(*x)).collect();
        let cost = (self.of)(&x);
        let mut best = self.best.borrow_mut();
        best.evaluations += 1;
        if cost < best.cost {
            (best.x, best.cost) = (x, cost);
        }
        if cost.is_nan() { f64::INFINITY } else { cost }
    }
}

impl CostFunction for &Budgeted<'_> {
    type Param = Point;
    type Output = f64;

    fn cost(&self, x: &Point) -> Result<f64, ArgminError> {
        Ok(self.value(x))
    }
}

/// Into [0, 1], at whose ends the line is folded.
fn reflected(x: f64) -> f64 {
    let x = x.rem_euclid(2.0);
    if x > 1.0 { 2.0 - x } else { x }
}

/// The method, ended where its best point stays.
struct Ended<'a> {
    method: NelderMead<Point, f64>,
    cost: &'a Budgeted<'a>,
    stalled: u64,
}

impl<'a> Solver<&'a Budgeted<'a>, Iteration> for Ended<'a> {
    fn name(&self) -> &'static str {
        "Nelder-Mead"
    }

    fn init(
        &mut self,
        problem: &mut Problem<&'a Budgeted<'a>>,
        state: Iteration,
    ) -> Result<(Iteration, Option<KV>), ArgminError> {
        self.method.init(problem, state)
    }

    fn next_iter(
        &mut self,
        problem: &mut Problem<&'a Budgeted<'a>>,
        state: Iteration,
    ) -> Result<(Iteration, Option<KV>), ArgminError> {
        self.method.next_iter(problem, state)
    }

    fn terminate(&mut self, state: &Iteration) -> TerminationStatus {
        let stays = state.get_iter().saturating_sub(state.get_last_best_iter());
        if self.cost.spent() || stays > self.stalled {
            return TerminationStatus::Terminated(TerminationReason::SolverConverged);
        }
        TerminationStatus::NotTerminated
    }
}

/// The minimum around a start, with `most` evaluations at most; `stop` ends it early.
pub(super) fn minimise(
    of: &dyn Fn(&[f64]) -> f64,
    (start, cost): (&[f64], f64),
    most: u64,
    stop: &dyn Fn() -> bool,
) -> Minimum {
    let n = start.len();
    let begin = Minimum { x: start.to_vec(), cost, evaluations: 0, converged: false };
    let function = Budgeted { of, best: RefCell::new(begin), most };
    let mut idle = 0;
    for edge in EDGES.iter().cycle() {
        let before = function.best.borrow().clone();
        if idle == IDLE || function.spent() || stop() {
            break;
        }
        run(&function, simplex(&before.x, *edge), n);
        let after = function.best.borrow().cost;
        let size = before.cost.abs().max(cost.abs());
        idle = if before.cost - after > OPTIMUM_IMPROVED * size { 0 } else { idle + 1 };
    }
    to_ends(&function);
    let mut end = function.best.into_inner();
    end.converged = idle == IDLE;
    end
}

/// A point and its neighbours along the axes, inwards.
fn simplex(x: &[f64], edge: f64) -> Vec<Point> {
    let vertex = |i: usize| {
        let mut vertex = x.to_vec();
        vertex[i] += if x[i] + edge <= 1.0 { edge } else { -edge };
        vertex
    };
    std::iter::once(x.to_vec()).chain((0..x.len()).map(vertex)).collect()
}

fn run(function: &Budgeted<'_>, vertices: Vec<Point>, n: usize) {
    // One parameter has the coefficients of two.
    let dimension = n.max(2) as f64;
    let method = NelderMead::new(vertices)
        .with_gamma(1.0 + 2.0 / dimension)
        .and_then(|method| method.with_sigma(1.0 - 1.0 / dimension));
    // The coefficients are valid for every dimension.
    let Ok(method) = method else { return };
    let method = Ended { method, cost: function, stalled: STALLED * (n as u64 + 1) };
    // Neither the function nor the method fails; the best point is the function's.
    let _ = Executor::new(function, method).timer(false).run();
}

/// Coordinates next to an end of [0, 1] are moved onto it where this makes nothing worse.
fn to_ends(function: &Budgeted<'_>) {
    let (mut x, cost) = {
        let best = function.best.borrow();
        (best.x.clone(), best.cost)
    };
    let mut best = cost;
    for i in 0..x.len() {
        let end = x[i].round();
        if x[i] == end || (x[i] - end).abs() > OPTIMUM_AT_END {
            continue;
        }
        let before = std::mem::replace(&mut x[i], end);
        let moved = (function.of)(&x);
        function.best.borrow_mut().evaluations += 1;
        if moved <= best {
            best = moved;
            let mut own = function.best.borrow_mut();
            (own.x, own.cost) = (x.clone(), moved);
        } else {
            x[i] = before;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(f: &dyn Fn(&[f64]) -> f64, start: &[f64]) -> Minimum {
        minimise(f, (start, f(start)), 20_000, &|| false)
    }

    /// Smooth, with a kink, at an end, at a corner with a constraint.
    #[test]
    fn minima_are_found() {
        let rosenbrock = |x: &[f64]| {
            let (x, y) = (4.0 * x[0] - 2.0, 4.0 * x[1] - 2.0);
            (1.0 - x).powi(2) + 100.0 * (y - x * x).powi(2)
        };
        let found = of(&rosenbrock, &[0.1, 0.9]);
        assert!(found.x.iter().all(|x| (x - 0.75).abs() < 1e-7) && found.converged, "{found:?}");

        let kink = |x: &[f64]| (x[0] - 0.3).abs().max(3.0 * (x[1] - 0.6 - x[0]).abs()) + 2.0;
        let found = of(&kink, &[0.9, 0.1]);
        assert!((found.x[0] - 0.3).abs() < 1e-9 && (found.x[1] - 0.9).abs() < 1e-9, "{found:?}");

        let slope = |x: &[f64]| x[0] - 2.0 * x[1] + x[2] * x[2];
        assert_eq!(of(&slope, &[0.5, 0.5, 0.5]).x, [0.0, 1.0, 0.0]);

        let corner = |x: &[f64]| if x[0] + x[1] > 0.8 { x[0] + 2.0 * x[1] } else { f64::INFINITY };
        let found = of(&corner, &[0.7, 0.7]);
        assert!((found.x[0] - 0.8).abs() < 1e-6 && found.x[1] < 1e-6, "{found:?}");

        let one = |x: &[f64]| (x[0] - 0.123).powi(2) + 1.0;
        assert!((of(&one, &[0.9]).x[0] - 0.123).abs() < 1e-7);
    }

    #[test]
    fn budgets_and_flat_functions_end() {
        let bowl = |x: &[f64]| x.iter().map(|x| (x - 0.3).powi(2)).sum::<f64>();
        let found = minimise(&bowl, (&[0.9, 0.9], bowl(&[0.9, 0.9])), 17, &|| false);
        assert!(found.evaluations == 17 && !found.converged && found.cost < bowl(&[0.9, 0.9]));
        let found = minimise(&bowl, (&[0.9, 0.9], 1.0), 0, &|| false);
        assert_eq!((found.x, found.evaluations), (vec![0.9, 0.9], 0));
        let flat = of(&|_| 1.0, &[0.4, 0.5]);
        assert!(flat.converged && flat.x == [0.4, 0.5]);
        let stopped = minimise(&bowl, (&[0.9, 0.9], 1.0), 100, &|| true);
        assert_eq!(stopped.evaluations, 0);
    }
}
