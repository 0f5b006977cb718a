//! The closest solution: along the self-motion of every solution, and for arms with one redundant
//! joint over all branches of its closed form.
//!
//! Method   restarts from the preferred configuration and beside it; then the locked joint of the
//!          closed form is sampled outwards from its preferred value, until its own displacement
//!          exceeds the distance of the best solution, and more finely where branches begin or end.
//!          Solutions that are closer than their neighbours on the same branch, and points of swings
//!          and between ends of branches (`branches.rs`), are corrected by a few Newton steps and are
//!          the start of a descent along the self-motion, in the order of their distance, as long as it
//!          can come closer than the best (the distance changes by no more than the configuration) and
//!          until it comes near the end of another one
//! Valid    up to the tolerances of solutions, which next to a singularity let joints move by 1e-3;
//!          a branch that begins and ends between two samples, on the same side of the condition
//!          that it violates there, is found where the samples around foretell it
//! Why so   the samples cover all branches for the price of a few random restarts, which reach some
//!          branches rarely
//! Checked  tests in this file (against 1000 random restarts), tests/it/ik.rs

use super::branches::{Place, STEP, Sample, Samples, index_of};
use super::closed_form::ClosedForm;
use super::convergence::is_reached;
use super::goal::{Goal, target_of};
use super::parallel_restarts::{LANES, MAX_COORDINATES, Restart};
use super::self_motion::Aim;
use super::solution::{Candidate, FoundBy};
use super::solve::Solver;
use crate::error::Result;
use crate::scalar::{clamp, nearest_turn};
use crate::spatial::Pose;

/// Gaps between values with different numbers of solutions are halved down to this [rad]: branches
/// end there, and swing by the root of what is left.
const FINEST: f64 = 0.01;
/// Steps from a sample to a solution: it may be beside a branch, or outside of half-spaces.
const CORRECTIONS: usize = 12;
/// Steps of the restarts: most of those that reach a solution need fewer.
const RESTART_STEPS: usize = 16;
/// Largest number of descents from solutions, and from places beside one.
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
            let turned = nearest_turn(q[c], self.preferred[c]);
            let within = (self.problem.lower[i]..=self.problem.upper[i]).contains(&turned);
            if self.problem.turns[i] && !self.problem.fixed[i] && within {
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
        self.descent.collect_minima();
        let calls = self.sample_self_motion(&mut formulas, (target, most), solutions);
        self.descent.end_collection();
        self.formulas = Some(formulas);
        calls
    }

    /// Solutions to which the iteration leads from a configuration and from random ones near it, the
    /// closest first.
    fn few_restarts(&mut self, from: &[f64]) -> Vec<Vec<f64>> {
        let mut random = self.options.seed;
        let mut starts = vec![from.to_vec(); LANES];
        for start in &mut starts[1..] {
            self.sample_configuration(start, true, &mut random);
        }
        self.correct(&mut starts, RESTART_STEPS);
        starts.retain_mut(|start| {
            let (errors, _) = self.problem.run(start, &self.options, 1);
            self.wrap_angles(start);
            is_reached(errors, &self.options)
        });
        starts.sort_by(|a, b| self.distance(a).total_cmp(&self.distance(b)));
        starts
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
        formulas.analytic.check(target, &q)?;
        let mut closest = f64::INFINITY;
        let mut restarts = match self.options.nearest {
            true => self.few_restarts(&q),
            false => Vec::new(),
        };
        if let Some(q) = restarts.first_mut() {
            closest = self.descend(q, (closest, FoundBy::Numerical), solutions)?;
        }
        q.copy_from_slice(&self.start);
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
            let sample = |(wrapped, angles): ([f64; 6], [f64; 6]), branch: u8, excluded: f64| {
                let squares =
                    angles.iter().zip(places).map(|(x, c)| (x - self.preferred[c]).powi(2));
                let far = squares.sum::<f64>() + apart * apart;
                Sample { value, angles, wrapped, branch, far, excluded }
            };
            let (first, mut count) = (samples.all.len(), 0);
            let misses =
                formulas.analytic.candidates(target, &q, |analytic, angles, (free, branch)| {
                    let (wrapped, angles, excluded) = analytic.wrapped(angles, &near);
                    let mut candidate = sample((wrapped, angles), branch, excluded);
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
                        candidate = sample((found.q, found.q), branch, 0.0);
                        if is_accepted {
                            best = best.min(candidate.far);
                        }
                    }
                    count += 1;
                    samples.all.push(candidate);
                    excluded == 0.0
                });
            samples.end_group(first, value, (count, misses));
        }
        let preferred = places.map(|c| self.preferred[c]);
        if is_accepted {
            closest = best.sqrt();
        }
        let within_limits = |angles: [f64; 6]| {
            let (_, clamped, excluded) = formulas.analytic.wrapped(angles, &near);
            (clamped, excluded)
        };
        let found = samples.places((own, &preferred), &within_limits, closest);
        for q in restarts.iter_mut().skip(1) {
            closest = self.descend(q, (closest, FoundBy::Numerical), solutions)?;
        }
        self.descend_from(&found, (locked, places), closest, solutions)?;
        Ok(calls)
    }

    /// Descents from places of the closed form that may lead closer than `closest`: from solutions,
    /// then from those beside one.
    fn descend_from(
        &mut self,
        found: &[Place],
        places: (usize, [usize; 6]),
        mut closest: f64,
        solutions: &mut Vec<Candidate>,
    ) -> Result<()> {
        let (exact, others): (Vec<&Place>, Vec<&Place>) =
            found.iter().partition(|place| place.sample.excluded == 0.0);
        for place in exact.into_iter().take(MAX_DESCENTS) {
            if place.bound < closest {
                let mut q = self.at(&place.sample, places);
                self.problem.run(&mut q, &self.options, CORRECTIONS);
                closest = self.descend(&mut q, (closest, FoundBy::Analytic), solutions)?;
            }
        }
        let mut others = others.into_iter().take(MAX_DESCENTS);
        loop {
            let batch = others.by_ref().filter(|place| place.bound < closest).take(LANES);
            let mut starts: Vec<_> = batch.map(|place| self.at(&place.sample, places)).collect();
            if starts.is_empty() {
                return Ok(());
            }
            self.correct(&mut starts, CORRECTIONS);
            for start in &mut starts {
                closest = self.descend(start, (closest, FoundBy::Analytic), solutions)?;
            }
        }
    }

    /// The initial guess with the angles of a sample.
    fn at(&self, sample: &Sample, (locked, places): (usize, [usize; 6])) -> Vec<f64> {
        let mut q = self.start.clone();
        q[locked] = sample.value;
        for (c, angle) in places.into_iter().zip(sample.angles) {
            q[c] = angle;
        }
        q
    }

    /// Moves configurations, at most [`LANES`], towards the goals by at most so many steps, in a batch
    /// if the goals permit it.
    fn correct(&mut self, starts: &mut [Vec<f64>], most: usize) {
        if self.problem.batched(&self.options).is_none() {
            for start in starts {
                self.problem.run(start, &self.options, most);
            }
            return;
        }
        // Lanes that remain repeat the last one.
        let mut restarts: [Restart; LANES] = std::array::from_fn(|i| {
            let start = &starts[i.min(starts.len() - 1)];
            let mut q = [0.0; MAX_COORDINATES];
            q.iter_mut().zip(&self.problem.coordinates).for_each(|(x, &c)| *x = start[c]);
            Restart::at(q)
        });
        self.solve_batched(&mut restarts, most, true);
        for (start, restart) in starts.iter_mut().zip(restarts) {
            for (x, &c) in restart.q.iter().zip(&self.problem.coordinates) {
                start[c] = *x;
            }
        }
    }

    /// Follows the self-motion of a solution while it may come closer than `closest`; returns the
    /// smaller distance. Nothing if it is no solution, but for the rounding of a batch.
    fn descend(
        &mut self,
        q: &mut [f64],
        (closest, found_by): (f64, FoundBy),
        solutions: &mut Vec<Candidate>,
    ) -> Result<f64> {
        let (errors, _) = self.problem.run(q, &self.options, 1);
        if !is_reached(errors, &self.options) {
            return Ok(closest);
        }
        self.approach_preferred(q, closest * closest);
        let is_added = self.add(solutions, q, found_by)?;
        Ok(if is_added { closest.min(self.distance(q)) } else { closest })
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::super::options::{Budget, IkOptions};
    use super::*;
    use crate::model::{Mechanism, catalogue};
    use crate::scalar::uniform;

    fn draw(robot: &Mechanism, random: &mut u64) -> Vec<f64> {
        let limits = robot.coordinates().iter().map(|c| c.limits);
        let ends = limits.map(|l| (l.lower.max(-PI), l.upper.min(PI)));
        ends.map(|(lower, upper)| lower + (upper - lower) * uniform(random)).collect()
    }

    /// Targets near a stretched elbow, whose closest solution is on a branch between two samples of
    /// joint 7 or has its neighbours beyond the limits of others; near a zero of joint 2, about which
    /// joints 1 and 3 swing through their limits, and of joint 6 likewise. The solutions were found by
    /// 1000 random restarts among the first 1000 targets of `benches/nearest.rs` with seeds 9, 1 and 2.
    #[test]
    fn short_branches_and_swings() {
        #[rustfmt::skip]
        let cases = [
            ("panda", [0.869917, 1.295120, -0.010994, -1.097940, -2.784762, 2.056014, -1.426901],
             [2.733211775543263, 1.036025508657276, -1.9486069904286552, -0.09711107505952776, -2.8973, 0.9982328220438617, -2.363458990184495]),
            ("panda", [1.327992, 0.248928, 2.621992, -1.024115, 1.515627, 2.829370, -1.632742],
             [1.3131269543938902, 0.3446305270417456, 2.8973, -0.18001940157011695, 2.662960053660617, 2.4638468183453113, -0.6729788949501815]),
            ("panda", [-2.650457, 1.074836, 0.595558, -0.259983, -1.890847, 1.235115, 0.964542],
             [-2.8973, 0.000258251822466678, 0.2390077531443319, -0.3636725994421155, 0.7382164952521298, 2.434291365267328, 0.1874217132850843]),
            ("panda", [-2.212107, -0.101447, -1.194594, -0.557045, 0.057192, 1.037392, 0.731117],
             [-2.8973, -0.020782665796221907, -2.5458577820731616, -1.8159928036136164, -0.7056880568151779, 2.2659738731855668, -1.4350570819255442]),
            ("iiwa14", [-0.449698, 1.461978, -0.108345, -0.556305, -2.746400, 0.203178, -2.439201],
             [-1.401472746427065, 0.8110695930632541, -0.25866152216325294, 1.2868803918269274, -2.967, 0.04126112487368467, -2.8447268136255044]),
        ];
        for (name, start, known) in cases {
            let robot = catalogue::load(name).unwrap();
            let target = robot.state(&known).unwrap().pose_of(robot.tool());
            let goals = [Goal::pose(robot.tool(), target)];
            let initial_guess = Some(start.to_vec());
            let options = IkOptions { nearest: true, initial_guess, ..IkOptions::default() };
            let mut solver = Solver::new(&robot, &goals, &options).unwrap();
            let found = solver.solve(&goals).unwrap();
            assert!(found.success, "{name} {known:?}");
            let (own, reference) = (solver.distance(&found.q), solver.distance(&known));
            assert!(own < reference + 1e-4, "{name}: {own} for {reference}, at {known:?}");
        }
    }

    /// Against 1000 random restarts after the first solution, each followed along its self-motion:
    /// never farther by 1e-3, for which the tolerances of a solution let joints move near singularities.
    /// Of 12000 others 11 are farther by more than 1e-4, by 8e-4 at most:
    /// `cargo bench -p cylindroid --bench nearest -- --compare --seed=N`, 9 and 1 to 5.
    #[test]
    fn nearest_against_1000_restarts() {
        let mut random = 11;
        for (name, targets) in [("panda", 100), ("iiwa14", 50), ("ur5e", 10)] {
            let robot = catalogue::load(name).unwrap();
            let budget = Budget { iterations: usize::MAX, time: None };
            let (mut closer, mut farther, mut few_farther, mut most) = (0, 0, 0, 0.0_f64);
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
                most = most.max(own - reference);
                few_farther += usize::from(after(48) > reference + 1e-4);
            }
            println!(
                "{name}: of {targets}, {closer} closer and {farther} farther than after 1000 \
                 restarts; {few_farther} farther after 48 restarts"
            );
            assert!(100 * farther <= targets && most < 1e-3, "{name}: {farther}, {most}");
        }
    }
}
