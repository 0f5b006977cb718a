//! The reason why inverse kinematics found no solution.
//!
//! Method   in this order: the distance of the target exceeds the length of the chain, which proves
//!          it; solutions were found, but bodies are too close in all of them; without half-spaces,
//!          or without position limits there is a solution, from the closest configuration or a few
//!          random ones; none of these
//! Checked  tests/it/ik_misses.rs

use super::convergence::{Errors, is_reached};
use super::levenberg_marquardt::Problem;
use super::reason::MissReason;
use super::solution::{Candidate, FoundBy};
use super::solve::{ITERATIONS_PER_RESTART, Solver};
use crate::error::{Result, all_finite};

/// Iterations that refine the closest failure.
const REFINEMENT_ITERATIONS: usize = 200;
/// Random initial guesses of the search without limits.
const RESTARTS: u64 = 8;

impl Solver {
    /// The failure to return, with its reason, from the closest configuration; a solution after all
    /// is added.
    pub(super) fn closest_miss(
        &mut self,
        best: Option<(Vec<f64>, Errors)>,
        out_of_reach: Option<(f64, f64)>,
        solutions: &mut Vec<Candidate>,
    ) -> Result<(Candidate, MissReason)> {
        let miss = |q: Vec<f64>, errors: Errors, reason: MissReason| {
            (Candidate { cost: 0.0, q, errors, found_by: FoundBy::Numerical }, reason)
        };
        let mut q = best.map_or_else(|| self.start.clone(), |(q, _)| q);
        let mut errors = self.problem.refine(&mut q, REFINEMENT_ITERATIONS);
        if is_reached(errors, &self.options) {
            self.add(solutions, &mut q, FoundBy::Numerical)?;
        }
        if let Some((q, _, reason)) = self.avoidance.as_mut().and_then(|a| a.best.take()) {
            let errors = self.problem.evaluate(&q);
            return Ok(miss(q, errors, reason));
        }
        if let Some((distance, length)) = out_of_reach {
            return Ok(miss(q, errors, MissReason::OutOfReach { distance, length }));
        }
        if let Some(names) = self.solve_outside_half_spaces(&q) {
            errors = self.problem.evaluate(&q);
            return Ok(miss(q, errors, MissReason::HalfSpaces { names }));
        }
        let beyond = self.solve_without_limits(&q);
        let reason = self.reason_by_limits(beyond.as_deref());
        if let (Some(mut beyond), MissReason::NotProven) = (beyond, &reason) {
            self.add(solutions, &mut beyond, FoundBy::Numerical)?;
        }
        errors = self.problem.evaluate(&q);
        Ok(miss(q, errors, reason))
    }

    /// The half-spaces outside of which the goals can be reached within the limits: from `q`, then
    /// from random configurations.
    fn solve_outside_half_spaces(&mut self, q: &[f64]) -> Option<Vec<String>> {
        if self.problem.half_spaces.is_empty() {
            return None;
        }
        let ignore = |problem: &mut Problem, ignored: bool| problem.half_spaces.ignored = ignored;
        let found = self.solve_relaxed(q, |p| ignore(p, true), |p| ignore(p, false))?;
        self.problem.evaluate(&found);
        let state = self.problem.state.as_ref()?;
        let names = self.problem.half_spaces.violated(state, self.options.position_tolerance);
        (!names.is_empty()).then_some(names)
    }

    /// A configuration that reaches the goals with or without position limits: from `q`, then from
    /// random configurations.
    fn solve_without_limits(&mut self, q: &[f64]) -> Option<Vec<f64>> {
        let n = self.problem.coordinates.len();
        let limits = (self.problem.lower.clone(), self.problem.upper.clone());
        let mut found = self.solve_relaxed(
            q,
            |p| (p.lower, p.upper) = (vec![f64::NEG_INFINITY; n], vec![f64::INFINITY; n]),
            |p| (p.lower, p.upper) = limits.clone(),
        )?;
        let Problem { coordinates, lower, upper, .. } = &self.problem;
        for (i, &c) in coordinates.iter().enumerate() {
            if found[c] < lower[i] || found[c] > upper[i] {
                found[c] = self.problem.turned_to_middle(i, found[c]);
            }
        }
        Some(found)
    }

    /// A configuration that reaches the goals while the problem is relaxed: from `q`, then from random
    /// configurations.
    fn solve_relaxed(
        &mut self,
        q: &[f64],
        relax: impl Fn(&mut Problem),
        restore: impl Fn(&mut Problem),
    ) -> Option<Vec<f64>> {
        (0..=RESTARTS).find_map(|restart| {
            let mut next = q.to_vec();
            if restart > 0 {
                let mut random = self.options.seed.wrapping_add(restart);
                self.sample_configuration(&mut next, false, &mut random);
            }
            relax(&mut self.problem);
            let (errors, _) = self.problem.run(&mut next, &self.options, ITERATIONS_PER_RESTART);
            restore(&mut self.problem);
            let reached = is_reached(errors, &self.options) && all_finite(&next);
            reached.then_some(next)
        })
    }

    /// The reason for a miss that neither distance nor collisions explain; `beyond` reaches the
    /// goals without limits.
    fn reason_by_limits(&self, beyond: Option<&[f64]>) -> MissReason {
        let mechanism = &self.problem.mechanism;
        let Some(beyond) = beyond else { return MissReason::NotProven };
        let joints: Vec<String> = mechanism
            .outside_limits(beyond)
            .map(|c| mechanism.coordinates()[c].name.clone())
            .collect();
        if joints.is_empty() { MissReason::NotProven } else { MissReason::Limits { joints } }
    }
}
