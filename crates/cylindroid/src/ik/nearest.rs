//! The closest solution: along the self-motion of every solution, and for arms with one redundant
//! joint over all branches of its closed form.
//!
//! Method   one restart from the preferred configuration; then the locked joint of the closed form
//!          is sampled outwards from its preferred value, until its own displacement exceeds the
//!          distance of the best solution, and more finely where branches end. Solutions that are closer than their neighbours on the
//!          same branch, and points between ends of branches (`branches.rs`), are corrected by a few
//!          Newton steps and are the start of a descent along the self-motion, in the order of
//!          their distance, as long as it can come closer than the best: the distance changes by
//!          no more than the configuration.
//! Valid    branches and gaps shorter than a sampling step may be missed
//! Why so   the samples cover all branches for the price of a few random restarts, which reach some
//!          branches rarely
//! Checked  tests in this file (against 1000 random restarts), tests/it/ik.rs

use std::f64::consts::PI;

use super::branches::{Place, STEP, Sample, Samples, index_of};
use super::closed_form::ClosedForm;
use super::convergence::is_reached;
use super::goal::{Goal, target_of};
use super::self_motion::Aim;
use super::solution::{Candidate, FoundBy};
use super::solve::{ITERATIONS_PER_RESTART, Solver};
use crate::error::Result;
use crate::scalar::clamp;
use crate::spatial::Pose;

/// Solutions outside the limits by less are clamped to them and corrected [rad].
const NEARLY_WITHIN: f64 = 0.3;
/// Gaps between values with different numbers of solutions are halved down to this [rad]: branches
/// end there, and swing by the root of what is left.
const FINEST: f64 = 0.01;
/// Steps from a sample to a solution: it may be beside a branch, or outside of half-spaces.
const CORRECTIONS: usize = 12;
/// Largest number of descents.
const MAX_DESCENTS: usize = 40;

impl Solver {
    /// If the closest solution or that of a criterion is requested: moves along the self-motion
    /// towards it, unless no squared distance below `bound` is expected.
    pub(super) fn approach_preferred(&mut self, q: &mut [f64], bound: f64) {
        let Self { descent, problem, options, preferred, ascent, .. } = self;
        if let Some(ascent) = ascent {
            ascent.wrap_angles(problem, q);
            descent.run(problem, (q, Aim::Criterion(ascent)), options, f64::INFINITY);
        } else if options.nearest {
            descent.run(problem, (q, Aim::Closest(preferred)), options, bound);
        }
    }

    /// What the best solution makes smallest at `q`: the distance, or the cost of the criterion.
    pub(super) fn cost(&mut self, q: &[f64]) -> f64 {
        match &mut self.ascent {
            Some(ascent) => ascent.cost(&self.problem, q),
            None => self.distance(q),
        }
    }

    /// If the closest solution is requested: full turns of joints that permit them, towards the
    /// initial guess.
    pub(super) fn wrap_angles(&self, q: &mut [f64]) {
        if !self.options.nearest {
            return;
        }
        for i in 0..self.problem.coordinates.len() {
            let c = self.problem.coordinates[i];
            let turns = ((self.preferred[c] - q[c]) / (2.0 * PI)).round();
            let turned = q[c] + 2.0 * PI * turns;
            let within = (self.problem.lower[i]..=self.problem.upper[i]).contains(&turned);
            let can = self.problem.turns[i] && !self.problem.fixed[i] && within;
            if can && turns != 0.0 {
                q[c] = turned;
            }
        }
    }

    pub(super) fn distance(&self, q: &[f64]) -> f64 {
        self.problem.squared_distance(q, &self.preferred).sqrt()
    }

    /// The closest solutions of all branches of the self-motion of an arm with one redundant joint;
    /// returns the number of evaluations of the closed form, `most` at most, 0 for other arms.
    pub(super) fn sample_branches(
        &mut self,
        goals: &[Goal],
        most: usize,
        solutions: &mut Vec<Candidate>,
    ) -> Result<usize> {
        let Some(target) = target_of(goals) else { return Ok(0) };
        let Some(mut formulas) = self.formulas.take() else { return Ok(0) };
        let calls = self.sample_self_motion(&mut formulas, (target, most), solutions);
        self.formulas = Some(formulas);
        calls
    }

    /// The closest solution on the branch to which the iteration leads from the initial guess;
    /// returns its distance, infinite without one.
    fn first_restart(&mut self, q: &mut [f64], solutions: &mut Vec<Candidate>) -> Result<f64> {
        let (errors, _) = self.problem.run(q, &self.options, ITERATIONS_PER_RESTART);
        if !self.options.nearest || !is_reached(errors, &self.options) {
            return Ok(f64::INFINITY);
        }
        self.wrap_angles(q);
        self.approach_preferred(q, f64::INFINITY);
        let is_added = self.add(solutions, q, FoundBy::Numerical)?;
        Ok(if is_added { self.distance(q) } else { f64::INFINITY })
    }

    fn sample_self_motion(
        &mut self,
        formulas: &mut ClosedForm,
        (target, most): (Pose, usize),
        solutions: &mut Vec<Candidate>,
    ) -> Result<usize> {
        let Some((locked, range)) = formulas.range_about(&self.preferred) else { return Ok(0) };
        let (places, is_exact) = (formulas.analytic.coordinates(), formulas.analytic.is_exact());
        let own = self.preferred[locked];
        let mut samples = Samples::default();
        let mut q = self.start.clone();
        for (&c, fixed) in self.problem.coordinates.iter().zip(&self.problem.fixed) {
            q[c] = if *fixed { q[c] } else { self.preferred[c] };
        }
        let mut closest = self.first_restart(&mut q, solutions)?;
        q.copy_from_slice(&self.start);
        formulas.analytic.check(target, &q)?;
        let (mut best, mut calls) = (closest * closest, 0);
        // Nothing but the target decides on a solution.
        let is_accepted = self.avoidance.is_none() && self.problem.half_spaces.is_empty();
        let near = places.map(|c| q[c]);
        let (mut k, mut gap) = (0, 0);
        let mut is_outward = true;
        while calls < most {
            let value = if is_outward {
                let index = index_of(k);
                let next = STEP * f64::from((k + 1) / 2);
                if next * next > best
                    || (own - next <= range[0] - STEP && own + next >= range[1] + STEP)
                {
                    is_outward = false;
                    continue;
                }
                k += 1;
                // The ends of the range are samples as well.
                let value = own + STEP * f64::from(index);
                if value <= range[0] - STEP || value >= range[1] + STEP {
                    continue;
                }
                clamp(value, range[0], range[1])
            } else {
                let Some((place, value)) = samples.fold_between(gap, FINEST) else { break };
                gap = place;
                if (value - own) * (value - own) >= best {
                    gap += 1; // no solution there is closer
                    continue;
                }
                value
            };
            let apart = value - own;
            calls += 1;
            q[locked] = value;
            let sample = |angles: [f64; 6], excluded: f64| {
                let squares =
                    angles.iter().zip(places).map(|(x, c)| (x - self.preferred[c]).powi(2));
                let far = squares.sum::<f64>() + apart * apart;
                Sample { value, angles, far, excluded }
            };
            let (first, mut count) = (samples.all.len(), 0);
            formulas.analytic.candidates(target, &q, |analytic, angles, free| {
                let (angles, excluded) = analytic.clamped(angles, &near);
                let mut candidate = sample(angles, excluded);
                if !candidate.far.is_finite() {
                    return false;
                }
                // Only the closest one is verified, as its distance bounds the search; starts of
                // descents are corrected.
                let is_closest = is_accepted && candidate.far < best;
                if excluded == 0.0 && (is_closest || !is_exact || free != [false; 6]) {
                    let Some(found) = analytic.confirmed(angles, free, &target, &near) else {
                        return false;
                    };
                    candidate = sample(found.q, 0.0);
                    if is_accepted {
                        best = best.min(candidate.far);
                    }
                }
                count += 1;
                if excluded < NEARLY_WITHIN {
                    samples.all.push(candidate);
                }
                excluded == 0.0
            });
            samples.end_group(first, value, count);
        }
        let preferred = places.map(|c| self.preferred[c]);
        if is_accepted {
            closest = best.sqrt();
        }
        let candidates = samples.places((own, &preferred), closest);
        for Place { bound, sample } in candidates.into_iter().take(MAX_DESCENTS) {
            if bound >= closest {
                continue;
            }
            q.copy_from_slice(&self.start);
            q[locked] = sample.value;
            for (c, angle) in places.into_iter().zip(sample.angles) {
                q[c] = angle;
            }
            let (errors, _) = self.problem.run(&mut q, &self.options, CORRECTIONS);
            if !is_reached(errors, &self.options) {
                continue;
            }
            self.approach_preferred(&mut q, closest * closest);
            if self.add(solutions, &mut q, FoundBy::Analytic)? {
                closest = closest.min(self.distance(&q));
            }
        }
        Ok(calls)
    }
}

#[cfg(test)]
mod tests {
    use super::super::options::{Budget, IkOptions};
    use super::*;
    use crate::model::{Mechanism, catalogue};
    use crate::scalar::uniform;

    fn draw(robot: &Mechanism, random: &mut u64) -> Vec<f64> {
        let limits = robot.coordinates().iter().map(|c| c.limits);
        let ends = limits.map(|l| (l.lower.max(-PI), l.upper.min(PI)));
        ends.map(|(lower, upper)| lower + (upper - lower) * uniform(random)).collect()
    }

    /// Against 1000 random restarts after the first solution, each followed along its self-motion:
    /// no farther for 99 of 100 targets. The others are at branches shorter than a sampling step.
    #[test]
    fn nearest_against_1000_restarts() {
        let mut random = 11;
        for (name, targets) in [("panda", 100), ("iiwa14", 50), ("ur5e", 10)] {
            let robot = catalogue::load(name).unwrap();
            let budget = Budget { iterations: usize::MAX, time: None };
            let (mut closer, mut farther, mut few_farther) = (0, 0, 0);
            for _ in 0..targets {
                let target = robot.state(&draw(&robot, &mut random)).unwrap().pose_of(robot.tool());
                let goals = [Goal::pose(robot.tool(), target)];
                let initial_guess = Some(draw(&robot, &mut random));
                let options =
                    IkOptions { nearest: true, initial_guess, budget, ..IkOptions::default() };
                let mut solver = Solver::new(&robot, &goals, &options).unwrap();
                let found = solver.solve(&goals).unwrap();
                assert!(found.success, "{name}");
                solver.formulas = None;
                let own = solver.distance(&found.q);
                let mut after = |restarts| {
                    let found = solver.search(&goals, restarts, |_| false).unwrap();
                    solver.distance(&found[0].q)
                };
                let reference = after(1000);
                closer += usize::from(own < reference - 1e-4);
                farther += usize::from(own > reference + 1e-4);
                few_farther += usize::from(after(48) > reference + 1e-4);
            }
            println!(
                "{name}: of {targets}, {closer} closer and {farther} farther than after 1000 \
                 restarts; {few_farther} farther after 48 restarts"
            );
            assert!(100 * farther <= targets, "{name}: {farther} of {targets}");
        }
    }
}
