//! The acceptance of solutions: within limits and tolerances, apart from other bodies, new.
//!
//! Checked  tests/it/ik.rs, tests/it/ik_misses.rs

use super::avoidance::Avoidance;
use super::convergence::{Errors, is_admissible, is_reached};
use super::solution::{Candidate, FoundBy};
use super::solve::{ITERATIONS_PER_RESTART, Solver};
use crate::collision::CollisionModel;
use crate::error::Result;
use crate::scalar::nearest_turn;

/// Solutions whose coordinates differ by less than this, up to full turns, are one [rad, lengths].
const SAME_CONFIGURATION: f64 = 1e-3;

impl Solver {
    /// Accepts only solutions at which all pairs of bodies that `model` watches are at least `gap`
    /// apart (m): of the links with each other and with obstacles. A redundant mechanism moves
    /// along its self-motion to make room; the search goes on from other initial guesses until it
    /// finds a solution or ends. [`IkOptions::nearest`](super::IkOptions::nearest) then gives the
    /// closest one found.
    ///
    /// ```
    /// use cylindroid::collision::{CollisionModel, CollisionOptions};
    /// use cylindroid::ik::{Goal, IkOptions, MissReason, Solver};
    /// use cylindroid::model::Geometry;
    ///
    /// let robot = cylindroid::load("panda")?;
    /// let target = robot.state(robot.home())?.pose(robot.tool())?;
    /// let goals = [Goal::pose(robot.tool(), target)];
    /// let mut model = CollisionModel::new(&robot, &CollisionOptions::default())?;
    /// model.add_obstacle("ball", &Geometry::Sphere { radius: 0.05 }, target)?;
    /// let mut solver = Solver::new(&robot, &goals, &IkOptions::default())?;
    /// solver.avoid(model, 0.01)?;
    /// let found = solver.solve(&goals)?;
    /// # let has_bodies = !robot.links().iter().all(|l| l.collisions.is_empty());
    /// # if has_bodies {
    /// // The hand is inside the ball in every solution.
    /// assert!(matches!(found.reason, Some(MissReason::Collision { .. })));
    /// # }
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// The shapes of another mechanism, a negative or non-finite gap.
    pub fn avoid(&mut self, model: CollisionModel, gap: f64) -> Result<()> {
        self.avoidance = Some(Avoidance::new(&self.problem.mechanism, model, gap)?);
        Ok(())
    }

    /// The bodies of [`Solver::avoid`]: their obstacles may move between calls.
    #[must_use]
    pub fn collision_model_mut(&mut self) -> Option<&mut CollisionModel> {
        self.avoidance.as_mut().map(|avoidance| &mut avoidance.model)
    }

    /// Adds a solution unless it is already known; false if it is none. The only way to success:
    /// all coordinates finite and within their limits, all errors within tolerance, all bodies
    /// apart.
    pub(super) fn add(
        &mut self,
        solutions: &mut Vec<Candidate>,
        q: &mut [f64],
        found_by: FoundBy,
    ) -> Result<bool> {
        let mut errors = self.solution_errors(q);
        if errors.is_none() && !self.problem.half_spaces.is_empty() {
            // Outside of half-spaces: along the self-motion there may be one inside.
            self.problem.run(q, &self.options, ITERATIONS_PER_RESTART);
            errors = self.solution_errors(q);
        }
        if errors.is_some()
            && let Some(mut avoidance) = self.avoidance.take()
        {
            let free = avoidance.make_free(&mut self.problem, &mut self.descent, q, &self.options);
            self.avoidance = Some(avoidance);
            errors = if free? { self.solution_errors(q) } else { None };
        }
        let Some(errors) = errors else { return Ok(false) };
        if !solutions.iter().any(|other| self.is_same(&other.q, q)) {
            let cost = self.cost(q);
            solutions.push(Candidate { cost, q: q.to_vec(), errors, found_by });
        }
        Ok(true)
    }

    /// The errors of a solution; `None` if it is none.
    fn solution_errors(&mut self, q: &[f64]) -> Option<Errors> {
        if !is_admissible(&self.problem.mechanism, q) {
            return None;
        }
        let errors = self.problem.evaluate(q);
        is_reached(errors, &self.options).then_some(errors)
    }

    fn is_same(&self, a: &[f64], b: &[f64]) -> bool {
        let mut all = self.problem.coordinates.iter().zip(&self.problem.turns);
        all.all(|(&c, turns)| {
            let apart = a[c] - b[c];
            let apart = if *turns { nearest_turn(apart, 0.0) } else { apart };
            apart.abs() < SAME_CONFIGURATION
        })
    }
}
