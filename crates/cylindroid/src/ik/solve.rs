//! Inverse kinematics: closed form where possible, otherwise random restarts from an initial guess.
//!
//! Method   the closed form first, if the geometry of the arm permits it. Otherwise, or if further
//!          solutions may exist, a numerical solver with random restarts: the first starts at the
//!          initial guess, the others at random configurations (`sampling.rs`), identical in every
//!          run, four at once if possible (`parallel_restarts.rs`). A
//!          result is a solution if it is within the limits, and within tolerance by forward
//!          kinematics. The search ends with the budget; earlier if the closed form leaves no
//!          solution, or its samples for seven joints leave none but on short branches
//! Valid    any tree. Failure to find a solution is not a proof that none exists, except when the
//!          target is farther from the first joint than the length of the chain
//! Source   random restarts: Beeson & Ames 2015 (TRAC-IK)
//! Checked  tests/it/ik.rs

use std::time::Instant;

use super::analytic::Analytic;
use super::ascent::Ascent;
use super::avoidance::Avoidance;
use super::closed_chain::solve_closed;
use super::closed_form::{ClosedForm, REDUNDANCY_SAMPLES, Remaining};
use super::convergence::{Errors, is_reached};
use super::goal::{Goal, check_all, target_of};
use super::levenberg_marquardt::Problem;
use super::options::IkOptions;
use super::parallel_restarts::{BatchedProblem, LANES, MAX_COORDINATES, Restart, solve_batched};
use super::self_motion::Descent;
use super::solution::{Candidate, FoundBy, Solution};
use crate::closure::check_coordinates;
use crate::error::Result;
use crate::model::Mechanism;

/// Iteration limit of one restart.
pub(crate) const ITERATIONS_PER_RESTART: usize = 60;
/// Restarts after the first solution if the closest one is requested.
const MAX_RESTARTS_AFTER_FIRST: usize = 48;
/// Restarts without a solution before all branches of the closed form of a redundant arm are
/// sampled.
const RESTARTS_BEFORE_SAMPLES: usize = 64;

/// A solver of inverse kinematics for one mechanism and its end effectors, to be reused in a loop:
/// restarts do not allocate; further calls allocate only the solutions and the workspace for the
/// closest one.
///
/// ```
/// use cylindroid::Vec3;
/// use cylindroid::ik::{Goal, IkOptions, Solver};
///
/// // Points on a line, each solution the initial guess of the next.
/// let robot = cylindroid::load("panda")?;
/// let mut q = vec![0.3, -0.4, 0.1, -2.0, 0.2, 1.7, 0.5];
/// let mut target = robot.state(&q)?.pose(robot.tool())?;
/// let goal = Goal::pose(robot.tool(), target);
/// let mut solver = Solver::new(&robot, &[goal], &IkOptions::default())?;
/// for _ in 0..5 {
///     target.translation = target.translation + Vec3::Z * 0.01;
///     solver.set_initial_guess(&q)?;
///     let found = solver.solve(&[Goal::pose(robot.tool(), target)])?;
///     assert!(found.success);
///     q = found.q;
/// }
/// # Ok::<(), cylindroid::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Solver {
    pub(super) problem: Problem,
    pub(super) formulas: Option<ClosedForm>,
    pub(super) options: IkOptions,
    pub(super) start: Vec<f64>,
    /// The configuration from which distances are measured: the initial guess, or the posture.
    pub(super) preferred: Vec<f64>,
    /// Distance of the targets of the current search from their frames at the initial guess (m), 0
    /// where no slide is long.
    pub(super) from_goals: f64,
    pub(super) descent: Descent,
    pub(super) ascent: Option<Ascent>,
    pub(super) avoidance: Option<Avoidance>,
}

/// A configuration that reaches all `goals`.
///
/// ```
/// use cylindroid::ik::{Goal, IkOptions, solve};
/// use cylindroid::{Pose, Vec3};
///
/// // A target out of reach: the closest configuration, and the proof.
/// let robot = cylindroid::load("ur5e")?;
/// let far = Pose::from_translation(Vec3::X * 10.0);
/// let found = solve(&robot, &[Goal::pose(robot.tool(), far)], &IkOptions::default())?;
/// assert!(!found.success && found.out_of_reach.is_some());
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// # Errors
/// No goals, frames of another mechanism, non-finite values; for a mechanism with loops several
/// goals or one that is no frame, half-spaces, a criterion, an orientation of which one component
/// is given.
#[doc(alias = "random restart")]
pub fn solve(mechanism: &Mechanism, goals: &[Goal], options: &IkOptions) -> Result<Solution> {
    if mechanism.is_closed() {
        return Ok(solve_closed(mechanism, goals, options, 1)?.swap_remove(0));
    }
    Solver::new(mechanism, goals, options)?.solve(goals)
}

/// Up to `count` distinct configurations that reach all `goals`, the closest to the initial guess
/// first; fewer if no more are found within the budget. A redundant arm has infinitely many
/// solutions, of which some are returned.
///
/// ```
/// use cylindroid::ik::{Goal, IkOptions, solve_distinct};
///
/// // Elbow up and down, shoulder left and right, wrist flipped or not.
/// let robot = cylindroid::load("ur5e")?;
/// let target = robot.state(&[0.3, -1.1, 1.4, 0.2, 1.0, 0.4])?.pose(robot.tool())?;
/// let goals = [Goal::pose(robot.tool(), target)];
/// assert_eq!(solve_distinct(&robot, &goals, &IkOptions::default(), 8)?.len(), 8);
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// # Errors
/// As [`solve`].
pub fn solve_distinct(
    mechanism: &Mechanism,
    goals: &[Goal],
    options: &IkOptions,
    count: usize,
) -> Result<Vec<Solution>> {
    if mechanism.is_closed() {
        let mut found = solve_closed(mechanism, goals, options, count)?;
        found.retain(|s| s.success);
        return Ok(found);
    }
    Solver::new(mechanism, goals, options)?.solve_distinct(goals, count)
}

impl Solver {
    /// A solver for goals with these end effectors and tasks; their targets may change.
    ///
    /// # Errors
    /// As [`solve`].
    pub fn new(mechanism: &Mechanism, goals: &[Goal], options: &IkOptions) -> Result<Self> {
        options.check(mechanism)?;
        check_all(mechanism, goals)?;
        let problem = Problem::new(mechanism, goals, options)?;
        check_coordinates("mechanism of inverse kinematics", problem.coordinates.len())?;
        let start = options.initial_guess.clone().unwrap_or_else(|| mechanism.home().to_vec());
        let formulas = ClosedForm::of(mechanism, goals, options);
        let descent = Descent::new(&problem);
        let ascent = options.criterion.map(|c| Ascent::new(mechanism, c, problem.length));
        let nearest = options.nearest || options.posture.is_some();
        let mut solver = Self {
            problem,
            formulas,
            options: IkOptions { nearest, ..options.clone() },
            preferred: start.clone(),
            start,
            from_goals: 0.0,
            descent,
            ascent,
            avoidance: None,
        };
        solver.load_start();
        Ok(solver)
    }

    /// Clamps the initial guess to the limits; the configuration from which distances are measured
    /// follows.
    fn load_start(&mut self) {
        if let Some(posture) = &self.options.posture {
            for (c, x) in self.start.iter_mut().enumerate() {
                let is_free = !self.options.fixed.contains(&c);
                if is_free && self.problem.coordinates.binary_search(&c).is_err() {
                    *x = posture[c];
                }
            }
        }
        self.problem.clamp(&mut self.start);
        self.preferred.copy_from_slice(self.options.posture.as_ref().unwrap_or(&self.start));
        self.problem.clamp(&mut self.preferred);
    }

    /// The closed form used by this solver, if any; of seven joints it locks one, whose value is
    /// sampled.
    ///
    /// ```
    /// use cylindroid::ik::{Goal, IkOptions, Solver};
    ///
    /// // The wrist of a UR5e is not spherical, but three of its axes are parallel.
    /// let robot = cylindroid::load("ur5e")?;
    /// let goal = Goal::pose(robot.tool(), robot.state(robot.home())?.pose(robot.tool())?);
    /// assert!(Solver::new(&robot, &[goal], &IkOptions::default())?.analytic().is_some());
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[must_use]
    pub fn analytic(&self) -> Option<&Analytic> {
        self.formulas.as_ref().map(|f| &f.analytic)
    }

    /// Sets the initial guess of the next call, clamped to the limits; see [`Solver`].
    ///
    /// # Errors
    /// A `q` of the wrong size or non-finite.
    pub fn set_initial_guess(&mut self, q: &[f64]) -> Result<()> {
        self.problem.mechanism.check_q("initial guess", q)?;
        self.start.copy_from_slice(q);
        self.load_start();
        Ok(())
    }

    /// A configuration that reaches `goals`, with the same end effectors and tasks as those of
    /// [`Solver::new`]: the closest one if [`IkOptions::nearest`], the best one found if there is a
    /// [`IkOptions::criterion`], otherwise the first one found.
    ///
    /// # Errors
    /// Goals of another number, end effector or task; non-finite values.
    pub fn solve(&mut self, goals: &[Goal]) -> Result<Solution> {
        let is_compared = self.options.nearest || self.ascent.is_some();
        let (after_first, most) = if is_compared {
            (MAX_RESTARTS_AFTER_FIRST, MAX_RESTARTS_AFTER_FIRST)
        } else {
            (usize::MAX, 1)
        };
        let mut found = self.search(goals, after_first, |solutions| solutions >= most)?;
        Ok(found.swap_remove(0))
    }

    /// Up to `count` distinct solutions, the closest to the initial guess first, or the best by the
    /// criterion: see [`solve_distinct`].
    ///
    /// ```
    /// use cylindroid::ik::{Goal, IkOptions, Solver};
    ///
    /// let robot = cylindroid::load("ur5e")?;
    /// let target = robot.state(&[0.3, -1.1, 1.4, 0.2, 1.0, 0.4])?.pose(robot.tool())?;
    /// let goals = [Goal::pose(robot.tool(), target)];
    /// let mut solver = Solver::new(&robot, &goals, &IkOptions::default())?;
    /// assert_eq!(solver.solve_distinct(&goals, 100)?.len(), 8);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Solver::solve`].
    pub fn solve_distinct(&mut self, goals: &[Goal], count: usize) -> Result<Vec<Solution>> {
        let mut found = match self.ascent {
            Some(_) => self.search(goals, MAX_RESTARTS_AFTER_FIRST, |_| false)?,
            None => self.search(goals, usize::MAX, |solutions| solutions >= count)?,
        };
        found.retain(|s| s.success);
        found.truncate(count);
        Ok(found)
    }

    /// Solutions, the one of least cost first, or one failure.
    pub(super) fn search(
        &mut self,
        goals: &[Goal],
        after_first: usize,
        enough: impl Fn(usize) -> bool,
    ) -> Result<Vec<Solution>> {
        check_all(&self.problem.mechanism, goals)?;
        self.problem.set_goals(goals)?;
        let out_of_reach = self.problem.out_of_reach();
        self.from_goals = match self.problem.has_long_slides {
            true => self.problem.evaluate(&self.start).position,
            false => 0.0,
        };
        if let Some(avoidance) = &mut self.avoidance {
            avoidance.best = None;
        }
        // The closest solution alone: descents of others may end early.
        let nearest = self.options.nearest && after_first < usize::MAX;
        let begin = Instant::now();
        let mut random = self.options.seed;
        let (mut iterations, mut since_first) = (0, 0);
        let mut solutions: Vec<Candidate> = Vec::new();
        let mut best: Option<(Vec<f64>, Errors)> = None;
        let (mut left, mut attempts) =
            self.closed_form_candidates(goals, &enough, nearest, &mut solutions)?;
        iterations += attempts;
        let first = attempts;
        let mut q = self.start.clone();
        let budget = self.options.budget;
        let in_time = |begin: Instant| budget.time.is_none_or(|most| begin.elapsed() < most);
        let found_all = !solutions.is_empty() && left != Remaining::Possible;
        while !(found_all || enough(solutions.len()) && !solutions.is_empty()) {
            let most = budget.iterations.saturating_sub(iterations);
            let begun = attempts - first;
            let all = !enough(solutions.len() + 1);
            let mut tell = |solver: &mut Self, q: &mut [f64], errors: Errors| -> Result<()> {
                if is_reached(errors, &solver.options) {
                    solver.wrap_angles(q);
                    let distances = solutions.iter().map(|s| s.cost);
                    let best = distances.fold(f64::INFINITY, f64::min);
                    solver.approach_preferred(q, if nearest { best * best } else { f64::INFINITY });
                    solver.add(&mut solutions, q, FoundBy::Numerical)?;
                } else if errors.squared.is_finite()
                    && best.as_ref().is_none_or(|(_, e)| errors.squared < e.squared)
                {
                    best = Some((q.to_vec(), errors));
                }
                Ok(())
            };
            let (of_each, steps) = match self.next_start(begun, most, &mut q, &mut random) {
                Some(mut restarts) => {
                    let steps = self.solve_batched(
                        &mut restarts,
                        (most / LANES).min(ITERATIONS_PER_RESTART),
                        all,
                    );
                    for restart in restarts.iter().filter(|r| r.has_ended()) {
                        for (x, &c) in restart.q.iter().zip(&self.problem.coordinates) {
                            q[c] = *x;
                        }
                        let mut errors = restart.errors;
                        if restart.has_reached(&self.options) {
                            // The batch evaluated it with different rounding.
                            (errors, _) =
                                self.problem.run(&mut q, &self.options, ITERATIONS_PER_RESTART);
                        }
                        tell(self, &mut q, errors)?;
                    }
                    (LANES, steps)
                }
                None => {
                    let (errors, steps) =
                        self.problem.run(&mut q, &self.options, most.min(ITERATIONS_PER_RESTART));
                    tell(self, &mut q, errors)?;
                    (1, steps)
                }
            };
            attempts += of_each;
            iterations += steps.max(of_each);
            since_first += if solutions.is_empty() { 0 } else { of_each };
            let over = iterations >= budget.iterations || !in_time(begin);
            let tried = attempts - first;
            if left == Remaining::Possible
                && solutions.is_empty()
                && tried >= RESTARTS_BEFORE_SAMPLES
            {
                let most = budget.iterations.saturating_sub(iterations);
                let calls = self.sample_branches(goals, most, &mut solutions)?;
                left = if calls > 0 { Remaining::Unlikely } else { left };
                iterations += calls;
            }
            let hopeless = match left {
                _ if out_of_reach.is_some() => tried >= MAX_RESTARTS_AFTER_FIRST,
                Remaining::None => tried >= MAX_RESTARTS_AFTER_FIRST,
                Remaining::Unlikely => tried >= budget.iterations / ITERATIONS_PER_RESTART,
                Remaining::Possible => false,
            };
            if enough(solutions.len()) || since_first > after_first || over || hopeless {
                break;
            }
        }
        let solution = |solver: &mut Self, success: bool, answer: Candidate| Solution {
            success,
            criterion: solver.ascent.as_mut().map(|a| a.value(&solver.problem, &answer.q)),
            q: answer.q,
            position_error: answer.errors.position,
            orientation_error: answer.errors.orientation,
            found_by: answer.found_by,
            iterations,
            restarts: attempts,
            // A distance within the tolerance is reached.
            out_of_reach: out_of_reach.filter(|_| !success),
            reason: None,
        };
        if solutions.is_empty() {
            let (miss, reason) = self.closest_miss(best, out_of_reach, &mut solutions)?;
            if solutions.is_empty() {
                return Ok(vec![Solution { reason: Some(reason), ..solution(self, false, miss) }]);
            }
        }
        solutions.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        Ok(solutions.into_iter().map(|answer| solution(self, true, answer)).collect())
    }

    /// Adds the closed-form solutions; returns what remains and the number of evaluations.
    fn closed_form_candidates(
        &mut self,
        goals: &[Goal],
        enough: &impl Fn(usize) -> bool,
        nearest: bool,
        solutions: &mut Vec<Candidate>,
    ) -> Result<(Remaining, usize)> {
        if nearest {
            let most = self.options.budget.iterations;
            let calls = self.sample_branches(goals, most, solutions)?;
            if calls > 0 {
                return Ok((Remaining::Unlikely, calls));
            }
        }
        let Some(target) = target_of(goals) else { return Ok((Remaining::Possible, 0)) };
        let Some(mut formulas) = self.formulas.take() else {
            return Ok((Remaining::Possible, 0));
        };
        let (mut left, mut calls) = (Remaining::Possible, 0);
        let most = match formulas.are_all() {
            true => 1,
            // Every solution moves to the best one nearby: samples would lead to the same.
            false if self.options.nearest || self.ascent.is_some() => 0,
            false => REDUNDANCY_SAMPLES.min(self.options.budget.iterations - 1),
        };
        let mut start = self.start.clone();
        while calls < most && (calls == 0 || !enough(solutions.len())) {
            let candidates = formulas.solve(target, &mut start, calls)?;
            calls += 1;
            let mut q = start.clone();
            // The closest first: often it suffices.
            let places = formulas.analytic.coordinates();
            let far = |i: &usize| -> f64 {
                candidates[*i]
                    .q
                    .iter()
                    .zip(places)
                    .map(|(x, c)| (x - self.preferred[c]).powi(2))
                    .sum()
            };
            let mut order = [0, 1, 2, 3, 4, 5, 6, 7];
            let order = &mut order[..candidates.len()];
            order.sort_unstable_by(|a, b| far(a).total_cmp(&far(b)));
            for candidate in order.iter().map(|&i| candidates[i]) {
                if enough(solutions.len()) && !solutions.is_empty() {
                    break;
                }
                q.copy_from_slice(&start);
                for (c, angle) in places.into_iter().zip(candidate.q) {
                    q[c] = angle;
                }
                if candidate.free != [false; 6] || self.ascent.is_some() {
                    self.approach_preferred(&mut q, f64::INFINITY);
                }
                self.add(solutions, &mut q, FoundBy::Analytic)?;
            }
            if formulas.are_all() && formulas.analytic.is_exact() && !candidates.is_open() {
                left = Remaining::None;
            }
        }
        self.formulas = Some(formulas);
        Ok((left, calls))
    }

    /// Initial guesses of the next restarts: random configurations for a batch, or `q` for a single
    /// restart; the first one at the given initial guess.
    fn next_start(
        &self,
        begun: usize,
        most: usize,
        q: &mut [f64],
        random: &mut u64,
    ) -> Option<[Restart; LANES]> {
        let is_near = |attempt: usize| self.options.nearest && attempt % 2 == 1;
        if begun == 0 {
            return None;
        }
        if most < LANES || self.problem.batched(&self.options).is_none() {
            self.sample_configuration(q, is_near(begun), random);
            return None;
        }
        let mut restarts = [Restart::at([0.0; MAX_COORDINATES]); LANES];
        for (k, restart) in restarts.iter_mut().enumerate() {
            self.sample_configuration(q, is_near(begun + k), random);
            for (x, &c) in restart.q.iter_mut().zip(&self.problem.coordinates) {
                *x = q[c];
            }
        }
        Some(restarts)
    }

    /// Restarts in a batch, until one converges or all have ended; returns their iterations.
    pub(super) fn solve_batched(
        &self,
        restarts: &mut [Restart; LANES],
        most: usize,
        all: bool,
    ) -> usize {
        if let Some(batched) = self.problem.batched(&self.options) {
            solve_batched(
                &BatchedProblem { max_steps: most, until_all_end: all, ..batched },
                restarts,
            );
        }
        restarts.iter().map(|r| r.steps).sum()
    }
}
