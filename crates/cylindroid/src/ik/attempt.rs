//! One run of the numerical solver, for searches with initial guesses of their own.
//!
//! Why so   a search over many poses knows good initial guesses, the solutions of poses nearby, and
//!          needs no reason for each miss, which costs ten runs
//! Checked  tests/sweep/capability.rs

use super::convergence::{is_admissible, is_reached};
use super::goal::Goal;
use super::solve::{ITERATIONS_PER_RESTART, Solver};
use crate::error::Result;

impl Solver {
    /// One run from `q`, clamped to the limits, to goals of the same end effectors and tasks as those
    /// of [`Solver::new`]. True if `q` reaches them then, within the limits.
    pub(crate) fn attempt(&mut self, goals: &[Goal], q: &mut [f64]) -> Result<bool> {
        self.problem.set_goals(goals)?;
        self.problem.clamp(q);
        let (errors, _) = self.problem.run(q, &self.options, ITERATIONS_PER_RESTART);
        let may_be = is_admissible(&self.problem.mechanism, q);
        Ok(is_reached(errors, &self.options) && may_be)
    }

    /// The configuration of the next call's initial guess.
    pub(crate) fn initial_guess(&self) -> &[f64] {
        &self.start
    }

    /// The next of a sequence of random configurations within the limits, whatever was searched
    /// before.
    pub(crate) fn random_configuration(&self, q: &mut [f64], random: &mut u64) {
        self.sample_at_distance(q, false, 0.0, random);
    }

    /// True if a goal is farther from the first joint of its chain than the length of the chain: a
    /// proof that no configuration reaches it.
    pub(crate) fn is_out_of_reach(&mut self, goals: &[Goal]) -> Result<bool> {
        self.problem.set_goals(goals)?;
        Ok(self.problem.out_of_reach().is_some())
    }
}
