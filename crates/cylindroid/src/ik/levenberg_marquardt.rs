//! Levenberg-Marquardt iteration: damped least squares from an initial guess to the goals, within
//! the position limits.
//!
//! Formula  d minimises |A d - e|^2 + l |d|^2 with q + d within the limits, l = DAMPING |e|^2;
//!          e the errors of all goals, positions over the characteristic length, A their Jacobian;
//!          long slides far from the goals in larger units (`stretch` in `convergence.rs`)
//! Shapes   A: m x n by columns, m components of all goals, n coordinates that move them
//! Valid    any tree. Joints at a limit that would leave it are clamped, the step is truncated at
//!          the others. Orientation errors are rotation vectors in the world, whose rate near the
//!          goal is the angular velocity
//! Why so   damping that decreases with the squared error gives Newton's method near the goal and
//!          small steps far from it, without parameters; every step is accepted, since abandoning
//!          an unsuccessful restart costs less than rescuing it
//! Source   Sugihara 2011 (damping by the error); projected Newton steps: Bertsekas 1982
//! Checked  tests/it/ik.rs, tests in this file

use super::convergence::{
    DAMPING, Errors, MAX_STAGNATION, MAX_STEP, MIN_DAMPING, is_reached, stretch,
};
use super::goal::Goal;
use super::goal_rows::GoalRows;
use super::half_space_rows::HalfSpaceRows;
use super::options::IkOptions;
use super::parallel_restarts::{BatchedProblem, MAX_COORDINATES};
use crate::error::{Error, Result};
use crate::kinematics::{Chain, State};
use crate::linalg::{Damped, DampedProblem, max_abs};
use crate::model::{CoordinateKind, Mechanism, NodeKind};
use crate::scalar::{clamp, nearest_turn};
use crate::task::HalfSpace;

/// The goals of a mechanism, with workspace.
#[derive(Debug, Clone)]
pub(super) struct Problem {
    pub(super) mechanism: Mechanism,
    goals: Vec<GoalRows>,
    pub(super) half_spaces: HalfSpaceRows,
    /// For goals other than frames, and for half-spaces.
    pub(super) state: Option<State>,
    pub(super) length: f64,
    /// The coordinates that move the goals: indices in `q`, ascending.
    pub(super) coordinates: Vec<usize>,
    /// Limits of these coordinates.
    pub(super) lower: Vec<f64>,
    pub(super) upper: Vec<f64>,
    /// Their travel (m), infinite without limits; 0 for angles and for those that keep their values.
    pub(super) travel: Vec<f64>,
    /// True if a slide may travel farther than one step of 1 m units.
    pub(super) has_long_slides: bool,
    /// True for those that return to the same pose after a full turn.
    pub(super) turns: Vec<bool>,
    /// True if all are angles and lengths.
    simple: bool,
    pub(super) m: usize,
    pub(super) a: Vec<f64>,
    e: Vec<f64>,
    pub(super) d: Vec<f64>,
    /// Coordinates that keep their values, and those that a step clamps at a limit as well.
    pub(super) fixed: Vec<bool>,
    pub(super) clamped: Vec<bool>,
    rates: Vec<f64>,
    pub(super) damped: Damped,
}

impl Problem {
    pub(super) fn new(mechanism: &Mechanism, goals: &[Goal], options: &IkOptions) -> Result<Self> {
        let length = options.length.unwrap_or_else(|| mechanism.reach());
        let of_half_space =
            |h: &HalfSpace| Chain::of(mechanism, h.end_effector).coordinates().to_vec();
        let mut goals: Vec<GoalRows> =
            goals.iter().map(|goal| GoalRows::new(mechanism, goal, length)).collect();
        let mut coordinates: Vec<usize> = goals
            .iter()
            .flat_map(GoalRows::coordinates)
            .chain(options.half_spaces.iter().flat_map(of_half_space))
            .chain(options.criterion.iter().flat_map(|c| c.coordinates(mechanism)))
            .collect();
        coordinates.sort_unstable();
        coordinates.dedup();
        goals.iter_mut().for_each(|goal| goal.place(&coordinates));
        let half_spaces = HalfSpaceRows::new(mechanism, &options.half_spaces);
        let needs_state = goals.iter().any(GoalRows::needs_state) || !half_spaces.is_empty();
        let state = needs_state.then(|| mechanism.state(mechanism.home())).transpose()?;
        let m = goals.iter().map(|g| g.rows.len()).sum::<usize>() + half_spaces.all.len();
        let n = coordinates.len();
        let all = mechanism.coordinates();
        let simple =
            |&c: &usize| matches!(all[c].kind, CoordinateKind::Angle | CoordinateKind::Length);
        let travel = |c: &usize| {
            let is_free_slide = all[*c].kind.is_length() && !options.fixed.contains(c);
            if is_free_slide { all[*c].limits.upper - all[*c].limits.lower } else { 0.0 }
        };
        let travel: Vec<f64> = coordinates.iter().map(travel).collect();
        Ok(Self {
            has_long_slides: travel.iter().any(|travel| *travel > MAX_STEP),
            travel,
            simple: coordinates.iter().all(simple),
            turns: coordinates.iter().map(|&c| is_back_after_a_turn(mechanism, c)).collect(),
            lower: coordinates.iter().map(|&c| all[c].limits.lower).collect(),
            upper: coordinates.iter().map(|&c| all[c].limits.upper).collect(),
            a: vec![0.0; m * n],
            e: vec![0.0; m],
            d: vec![0.0; n],
            fixed: coordinates.iter().map(|c| options.fixed.contains(c)).collect(),
            clamped: vec![false; n],
            rates: vec![0.0; mechanism.n()],
            damped: Damped::new(m, n),
            mechanism: mechanism.clone(),
            goals,
            half_spaces,
            state,
            length,
            coordinates,
            m,
        })
    }

    /// Sets other targets of the same objectives.
    pub(super) fn set_goals(&mut self, goals: &[Goal]) -> Result<()> {
        Error::check_len("goals", self.goals.len(), goals.len())?;
        for (i, (own, goal)) in self.goals.iter_mut().zip(goals).enumerate() {
            if !own.goal.objective.is_as(&goal.objective) {
                return Err(Error::InvalidOption {
                    option: "goals",
                    value: format!("goal {i} of another end effector or task"),
                    reason: "a solver is made for its end effectors and tasks; make another"
                        .to_owned(),
                });
            }
            own.set(goal);
        }
        Ok(())
    }

    /// The value `x` of coordinate i, wrapped towards the middle of its range if it permits full turns.
    pub(super) fn turned_to_middle(&self, i: usize, x: f64) -> f64 {
        let middle = 0.5 * (self.lower[i] + self.upper[i]);
        let may_turn = self.turns[i] && !self.fixed[i] && middle.is_finite();
        if may_turn { nearest_turn(x, middle) } else { x }
    }

    /// Forward kinematics at `q`; computes the scaled errors.
    pub(super) fn evaluate(&mut self, q: &[f64]) -> Errors {
        let mut errors = Errors { position: 0.0, orientation: 0.0, squared: 0.0 };
        if let Some(state) = &mut self.state
            && state.set(q).is_err()
        {
            self.e.fill(0.0);
            return Errors { position: f64::NAN, orientation: f64::NAN, squared: f64::NAN };
        }
        let mut row = 0;
        for goal in &mut self.goals {
            let error = goal.error(q, self.state.as_ref());
            errors.position = errors.position.max(error.linear.norm());
            errors.orientation = errors.orientation.max(error.angular.norm());
            let error = error.to_array();
            for &(i, scale) in &goal.rows {
                self.e[row] = error[i] * scale;
                errors.squared += self.e[row] * self.e[row];
                row += 1;
            }
        }
        if let Some(state) = &self.state {
            self.half_spaces.evaluate(state);
            for room in &self.half_spaces.rooms {
                let outside = (-room).max(0.0);
                errors.position = errors.position.max(outside);
                self.e[row] = outside / self.length;
                errors.squared += self.e[row] * self.e[row];
                row += 1;
            }
        }
        errors
    }

    /// Computes A at the configuration evaluated last, with the rows of half-spaces that it
    /// violates.
    pub(super) fn load_jacobian(&mut self) {
        self.load_goals();
        for i in 0..self.half_spaces.rooms.len() {
            if self.half_spaces.rooms[i] < 0.0 {
                self.load_half_space(i);
            }
        }
    }

    /// Computes the rows of the goals in A; those of half-spaces are zero.
    pub(super) fn load_goals(&mut self) {
        if self.goals.len() > 1 || self.state.is_some() {
            self.a.fill(0.0);
        }
        let mut first = 0;
        for goal in &mut self.goals {
            goal.load_jacobian(self.state.as_ref(), (self.m, first), &mut self.a);
            first += goal.rows.len();
        }
    }

    /// Computes the row of half-space i in A.
    pub(super) fn load_half_space(&mut self, i: usize) {
        let Some(state) = &self.state else { return };
        let row = self.m - self.half_spaces.rooms.len() + i;
        let gradient = self.half_spaces.gradient(i, state);
        for (j, &c) in self.coordinates.iter().enumerate() {
            self.a[j * self.m + row] = gradient[c] / self.length;
        }
    }

    /// One step from `q`, which was evaluated with these errors; `squared` sets the damping.
    fn step(&mut self, q: &mut [f64], Errors { position, squared, .. }: Errors) {
        self.load_jacobian();
        if self.has_long_slides {
            for (column, travel) in self.a.chunks_exact_mut(self.m.max(1)).zip(&self.travel) {
                let unit = stretch(*travel, position);
                column.iter_mut().for_each(|x| *x *= unit);
            }
        }
        let size = self.a.iter().map(|x| x * x).sum::<f64>();
        let damping = DAMPING * squared + MIN_DAMPING * size;
        self.clamped.copy_from_slice(&self.fixed);
        for _ in 0..=self.coordinates.len() {
            let problem = DampedProblem { a: &self.a, e: &self.e, clamped: &self.clamped, damping };
            if !self.damped.solve(problem, &mut self.d) {
                self.d.fill(0.0);
                return;
            }
            if !self.clamp_at_limits(q) {
                break;
            }
        }
        let most = max_abs(&self.d);
        let cut = if most > MAX_STEP { MAX_STEP / most } else { 1.0 };
        for (d, travel) in self.d.iter_mut().zip(&self.travel) {
            *d *= cut * stretch(*travel, position);
        }
        self.advance(q);
    }

    /// Clamps joints at a limit that the step would leave; true if there were any.
    pub(super) fn clamp_at_limits(&mut self, q: &[f64]) -> bool {
        let mut any = false;
        for (i, &c) in self.coordinates.iter().enumerate() {
            let out = (q[c] <= self.lower[i] && self.d[i] < 0.0)
                || (q[c] >= self.upper[i] && self.d[i] > 0.0);
            if out && !self.clamped[i] {
                self.clamped[i] = true;
                any = true;
            }
        }
        any
    }

    /// Moves `q` by the step `d`, as far as the limits permit.
    pub(super) fn advance(&mut self, q: &mut [f64]) {
        if self.simple {
            for (i, &c) in self.coordinates.iter().enumerate() {
                q[c] = clamp(q[c] + self.d[i], self.lower[i], self.upper[i]);
            }
            return;
        }
        self.rates.fill(0.0);
        for (&c, d) in self.coordinates.iter().zip(&self.d) {
            self.rates[c] = *d;
        }
        self.mechanism.integrate_in_place(q, &self.rates, 1.0);
        self.clamp(q);
    }

    /// Clamps `q` to the limits.
    pub(super) fn clamp(&self, q: &mut [f64]) {
        // Also coordinates that do not move the end effectors: the configuration has all of them.
        for (x, c) in q.iter_mut().zip(self.mechanism.coordinates()) {
            *x = clamp(*x, c.limits.lower, c.limits.upper);
        }
        for (i, &c) in self.coordinates.iter().enumerate() {
            q[c] = clamp(q[c], self.lower[i], self.upper[i]);
        }
    }

    /// Iterates from `q` until the goals are reached, progress stagnates or `most` steps are taken.
    pub(super) fn run(
        &mut self,
        q: &mut [f64],
        options: &IkOptions,
        most: usize,
    ) -> (Errors, usize) {
        let mut errors = self.evaluate(q);
        let (mut best_error, mut stagnation) = (errors.squared, 0);
        for steps in 0..most {
            if is_reached(errors, options) {
                return (errors, steps);
            }
            self.step(q, errors);
            errors = self.evaluate(q);
            stagnation += 1;
            if errors.squared < 0.25 * best_error {
                (best_error, stagnation) = (errors.squared, 0);
            } else if stagnation >= MAX_STAGNATION || !errors.squared.is_finite() {
                return (errors, steps + 1);
            }
        }
        (errors, most)
    }

    /// The problem of batched restarts, if the goals permit them.
    pub(super) fn batched<'a>(&'a self, options: &'a IkOptions) -> Option<BatchedProblem<'a>> {
        let ([goal], n) = (&self.goals[..], self.coordinates.len()) else { return None };
        let (chain, task, target) = goal.frame().filter(|_| self.half_spaces.is_empty())?;
        let serial = chain.serial().filter(|s| s.has_one_for_each(n))?;
        (self.simple && self.m > 0 && (self.m..=MAX_COORDINATES).contains(&n)).then_some(
            BatchedProblem {
                serial,
                task,
                target,
                rows: &goal.rows,
                lower: &self.lower,
                upper: &self.upper,
                travel: &self.travel,
                has_long_slides: self.has_long_slides,
                fixed: &self.fixed,
                options,
                max_steps: 0,
                until_all_end: false,
            },
        )
    }

    /// A frame that is farther from the first joint of its chain than the length of the chain: both
    /// (m).
    pub(super) fn out_of_reach(&self) -> Option<(f64, f64)> {
        self.goals.iter().find_map(|goal| goal.out_of_reach(&self.mechanism))
    }

    /// Refines `q` towards the goals: steps that reduce the error are accepted, otherwise the
    /// damping is increased.
    pub(super) fn refine(&mut self, q: &mut [f64], most: usize) -> Errors {
        let mut errors = self.evaluate(q);
        let (mut next, mut extra) = (q.to_vec(), 1.0);
        for _ in 0..most {
            next.copy_from_slice(q);
            self.step(&mut next, Errors { squared: extra * errors.squared, ..errors });
            let then = self.evaluate(&next);
            if then.squared < errors.squared {
                let little = then.squared > errors.squared * (1.0 - 1e-12);
                q.copy_from_slice(&next);
                (errors, extra) = (then, 0.3 * extra);
                if little {
                    break;
                }
            } else {
                extra *= 10.0;
                if extra > 1e12 {
                    break;
                }
            }
            self.evaluate(q);
        }
        self.evaluate(q)
    }
}

/// True if a full turn of the coordinate changes no pose: false for helical joints, and for joints
/// coupled to it by a non-integer ratio.
fn is_back_after_a_turn(mechanism: &Mechanism, coordinate: usize) -> bool {
    let nodes = mechanism.nodes().iter();
    let range = |start: usize, kind: NodeKind| start..start + kind.dof();
    let mut own = nodes.filter(|n| range(n.coordinate, n.kind).contains(&coordinate));
    own.all(|n| n.kind == NodeKind::Revolute && n.multiplier.fract() == 0.0)
}

#[cfg(test)]
mod tests {
    use super::super::parallel_restarts::{LANES, Restart, solve_batched, solve_with};
    use super::*;
    use crate::kinematics::{ReferenceFrame, serial_batched};
    use crate::model::catalogue;
    use crate::scalar::{Array, uniform};
    use crate::task::Task;

    /// Each equals the single restart up to rounding, which some amplify: its solutions are within
    /// the limits, and nearly all end at the same configuration.
    #[test]
    fn runners_are_single_attempts() {
        let mut random = 5;
        for (name, task) in [
            ("panda", Task::POSE),
            ("panda", Task::POSITION),
            ("iiwa14", Task { axes: ReferenceFrame::Local, ..Task::POSE }),
            ("ur5e", Task::POSE),
            ("3r", Task::PLANAR),
        ] {
            let robot = catalogue::load(name).unwrap();
            let options = IkOptions::default();
            let limits = |c: usize| robot.coordinates()[c].limits;
            let mut draw = || -> Vec<f64> {
                let mut spread = |(l, u): (f64, f64)| l + (u - l) * uniform(&mut random);
                (0..robot.n())
                    .map(|c| spread((limits(c).lower.max(-3.0), limits(c).upper.min(3.0))))
                    .collect()
            };
            let (mut same, mut reached, mut total) = (0, 0, 0);
            for round in 0..40 {
                let target = robot.state(&draw()).unwrap().pose_of(robot.tool());
                let goal = Goal::frame(robot.tool(), task, target);
                let mut problem = Problem::new(&robot, &[goal], &options).unwrap();
                let seeds: [Vec<f64>; LANES] = std::array::from_fn(|_| draw());
                let all = round % 2 == 0;
                let mut restarts = seeds.each_ref().map(|seed| {
                    let mut q = [0.0; MAX_COORDINATES];
                    q[..seed.len()].copy_from_slice(seed);
                    Restart::at(q)
                });
                let batched = BatchedProblem {
                    max_steps: 60,
                    until_all_end: all,
                    ..problem.batched(&options).unwrap()
                };
                if round % 4 < 2 {
                    solve_batched(&batched, &mut restarts);
                } else {
                    solve_with::<Array<LANES>>(
                        (),
                        &batched,
                        &mut restarts,
                        serial_batched::forward,
                    );
                }
                assert!(!all || restarts.iter().all(Restart::has_ended));
                for (mut q, restart) in seeds.into_iter().zip(&restarts) {
                    if !restart.has_ended() {
                        continue;
                    }
                    let (errors, steps) = problem.run(&mut q, &options, 60);
                    let there = &restart.q[..robot.n()];
                    let is_there = is_reached(errors, &options);
                    let apart = q.iter().zip(there).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
                    let is_same =
                        steps == restart.steps && is_there == restart.has_reached(&options);
                    same += usize::from(is_same && (apart < 1e-6 || !is_there));
                    total += 1;
                    if restart.has_reached(&options) {
                        let errors = problem.evaluate(there);
                        assert!(errors.position < 1.001 * options.position_tolerance, "{name}");
                        assert!(
                            errors.orientation < 1.001 * options.orientation_tolerance,
                            "{name}"
                        );
                        assert!(robot.outside_limits(there).next().is_none());
                        reached += 1;
                    }
                }
            }
            assert!(
                10 * same >= 9 * total && 4 * reached > total,
                "{name}: {same} {reached} {total}"
            );
        }
    }

    /// Coordinates that keep their values keep them.
    #[test]
    fn fixed_coordinates_rest() {
        let robot = catalogue::load("panda").unwrap();
        let options = IkOptions { fixed: vec![2], ..IkOptions::default() };
        let mut q = robot.home().to_vec();
        q[2] = 0.3;
        q[3] -= 0.4;
        let goal = Goal::pose(robot.tool(), robot.state(&q).unwrap().pose_of(robot.tool()));
        let problem = Problem::new(&robot, &[goal], &options).unwrap();
        let mut start = [0.0; MAX_COORDINATES];
        start[..7].copy_from_slice(robot.home());
        start[2] = 0.3;
        let mut restarts = [Restart::at(start); LANES];
        solve_batched(
            &BatchedProblem {
                max_steps: 60,
                until_all_end: true,
                ..problem.batched(&options).unwrap()
            },
            &mut restarts,
        );
        assert!(restarts.iter().all(|r| r.q[2] == 0.3 && r.has_reached(&options)));
    }
}
