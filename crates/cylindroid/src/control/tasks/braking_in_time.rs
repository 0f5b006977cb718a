//! The end of a motion: joints that accelerate slowly brake before the tasks turn back.
//!
//! Formula  all joints brake together: from velocities v they rest at q + w v, w = T / 2 + dt, T the
//!          longest of their stopping times. The motion along what the tasks of a level ask for,
//!          u = K e + feed-forward, is g = u . J v, now and where they rest, with targets that have moved
//!          on for w. If it changes its sign on the way, the tasks come back by about
//!          w g_rest^2 / (2 (g - g_rest) |u|), by w |g + g_rest| / (2 |u|) if both are negative. Where this
//!          is more than `NEGLIGIBLE_WAY_BACK`, and less after braking, v lies between the braked
//!          velocities of the last step and those of the solver, as near to these as it may
//! Shapes   v: n, in a closed chain the velocities that follow its drives; u: the rows of the level
//! Units    lengths over the characteristic length, roots of the weights over the largest
//! Valid    acceleration or jerk limits; the first level with an error, without custom tasks
//! Cost     one evaluation of the tasks of the level while the joints move, some more while they brake
//! Why so   a step knows the tasks where it is: K e alone asks for more than weak joints can brake, and
//!          at the edge of reach they pass the place where nothing more can be gained, and swing
//! Checked  tests/it/servo/task_braking.rs, tests/allocation/main.rs

use super::levels::Stack;
use super::motions::JerkBounds;
use super::objective::{Rows, TaskObjective};
use super::options::StoppedBy;
use super::task_servo::TaskServo;
use super::turning_back::{Along, TurningBack};
use crate::control::servo::{NEGLIGIBLE_WAY_BACK, SHARE_HALVINGS, stopping_time};
use crate::control::solver::active_set::Precision;
use crate::control::solver::bounds::LimitKind;
use crate::control::solver::saturation::brake;
use crate::error::Result;
use crate::linalg::norm;
use crate::scalar::{clamp, largest};

/// Braking that carries the tasks back so many times as far as going on is no help [-]: what turns back
/// cannot be stopped in time, and the other joints come nearer. With limits of the jerk once, for their
/// braking is felt late.
const WORSE: f64 = 4.0;

impl TaskServo {
    /// Slows the velocities of the step such that the joints can stop in time. True if they had to be
    /// slowed or move the tasks back: they say nothing about a lost level then.
    pub(super) fn brake_in_time(&mut self) -> Result<bool> {
        let Some(mut rest) = self.turning_back.take() else { return Ok(false) };
        let slows = self.slow_down(&mut rest);
        self.turning_back = Some(rest);
        slows
    }

    fn slow_down(&mut self, rest: &mut TurningBack) -> Result<bool> {
        let Some(level) = self.open_level() else { return Ok(false) };
        rest.solved.copy_from_slice(&self.last);
        rest.mix(1.0);
        let now = self.part(level, rest);
        let back = self.way_back(level, rest, now)?;
        if back <= NEGLIGIBLE_WAY_BACK {
            return Ok(false);
        }
        self.load_braked(rest);
        self.solve_within_limits(Self::solve_aim);
        rest.braked.copy_from_slice(&self.last);
        rest.mix(0.0);
        let then = self.part(level, rest);
        let has_jerks = self.desired_rates.is_some();
        let worse = if has_jerks { 1.0 } else { WORSE };
        let share = if self.way_back(level, rest, then)? >= worse * back {
            1.0
        } else {
            let mut failed = Ok(());
            let share = largest(0.0, 1.0, SHARE_HALVINGS, |share| {
                rest.mix(share);
                let part = then + share * (now - then);
                if part <= 0.0 && !has_jerks {
                    return true;
                }
                self.way_back(level, rest, part).map_or_else(
                    |error| {
                        failed = Err(error);
                        false
                    },
                    |back| back <= NEGLIGIBLE_WAY_BACK,
                )
            });
            failed?;
            share
        };
        rest.mix(share);
        self.aim.copy_from_slice(&rest.trial);
        if has_jerks {
            self.load_bounds(JerkBounds::All);
        }
        self.solve_aim();
        if share < 1.0 {
            rest.trial.copy_from_slice(&self.last);
            self.motions.rates_of(&rest.trial, &mut rest.rates);
            self.note_slower(rest);
        }
        Ok(true)
    }

    /// Reports that the slowest joint brakes all tasks, and what is left of their velocities.
    fn note_slower(&mut self, rest: &TurningBack) {
        let all = rest.rates.iter().zip(&self.limits).enumerate();
        let all = all.filter(|(i, _)| self.motions.is_driven(*i));
        let times = all.map(|(i, (rate, limits))| (i, stopping_time(rate.abs(), limits)));
        let slowest = times.max_by(|a, b| a.1.total_cmp(&b.1));
        let stop = slowest
            .map(|(coordinate, _)| StoppedBy::Limit { coordinate, kind: LimitKind::Acceleration });
        for member in self.stacks.iter_mut().flat_map(|s| &mut s.members) {
            let of_task = (&self.tasks[member.task], &self.rows[member.task]);
            let mut along = Along::default();
            along.add(of_task, |j| rest.rates[j], (1.0, 0.0, self.options.length));
            if along.square > 0.0 {
                member.scale = clamp(along.part / along.square, 0.0, 1.0);
            }
            member.stopped_by = member.stopped_by.or(stop);
        }
    }

    /// The first level with an error that counts or a motion, of tasks that may be evaluated elsewhere.
    fn open_level(&self) -> Option<usize> {
        let is_open = |stack: &Stack| {
            stack.members.iter().any(|member| {
                let (task, rows) = (&self.tasks[member.task], &self.rows[member.task]);
                let moves = rows.feed_forward.iter().any(|forward| *forward != 0.0);
                moves || rows.exceeds(task.tolerance)
            })
        };
        let level = self.stacks.iter().position(is_open)?;
        let mut members = self.stacks[level].members.iter();
        let is_custom =
            |task: usize| matches!(self.tasks[task].objective, TaskObjective::Custom(_));
        (!members.any(|member| is_custom(member.task))).then_some(level)
    }

    /// The motion with the velocities that are tried, along what a level asks for.
    fn part(&self, level: usize, rest: &mut TurningBack) -> f64 {
        self.motions.rates_of(&rest.trial, &mut rest.rates);
        let (mut along, length) = (Along::default(), self.options.length);
        for member in &self.stacks[level].members {
            let (task, rows) = (&self.tasks[member.task], &self.rows[member.task]);
            along.add((task, rows), |j| rest.rates[j], (member.weight, 0.0, length));
        }
        along.part
    }

    /// Time w of the way on which the joints with the velocities that are tried stop together, and the way
    /// [s, -]. Joints whose limited jerk lets them accelerate on have the velocities that they come to.
    fn stopping(&self, rest: &mut TurningBack) -> [f64; 2] {
        self.motions.rates_of(&rest.trial, &mut rest.rates);
        let (dt, mut longest) = (self.options.dt, 0.0_f64);
        let joints = rest.rates.iter_mut().zip(&self.rates).zip(&self.limits).enumerate();
        // Passive joints follow the others.
        for (_, ((rate, before), limits)) in joints.filter(|(i, _)| self.motions.is_driven(*i)) {
            let acceleration = (*rate - before) / dt;
            let mut ramp = 0.0;
            if limits.jerk < f64::INFINITY && acceleration * *rate > 0.0 {
                ramp = acceleration.abs() / limits.jerk;
                *rate += 0.5 * acceleration * ramp;
            }
            longest = longest.max(2.0 * ramp + stopping_time(rate.abs(), limits));
        }
        let time = 0.5 * longest + dt;
        [time, time * norm(&rest.trial)]
    }

    /// The way by which the joints, braked from the velocities that are tried, which move the level
    /// `now` along what it asks for, carry it back [-].
    fn way_back(&mut self, level: usize, rest: &mut TurningBack, now: f64) -> Result<f64> {
        let [time, way] = self.stopping(rest);
        if !(way > NEGLIGIBLE_WAY_BACK && way.is_finite()) {
            return Ok(0.0);
        }
        if !rest.go_on(&self.state, &self.limits, time)? {
            return Ok(0.0);
        }
        let (mut then, length) = (Along::default(), self.options.length);
        for member in &self.stacks[level].members {
            let (task, rows) = (&mut self.tasks[member.task], &mut rest.rows[member.task]);
            let mut written = Rows {
                error: &mut rows.error,
                feed_forward: &mut rows.feed_forward,
                jacobian: &mut rows.jacobian,
            };
            task.objective.evaluate(&task.name, &rest.state, &mut rest.scratch, &mut written)?;
            then.add((task, rows), |j| rest.rates[j], (member.weight, time, length));
        }
        if then.part >= 0.0 {
            return Ok(0.0);
        }
        // Of a part that changes evenly from `now` to that at rest.
        let back = if now > 0.0 {
            0.5 * then.part * then.part / (now - then.part)
        } else {
            -0.5 * (now + then.part)
        };
        Ok(back * time / then.square.sqrt())
    }

    /// The last velocities, slowed together; with limits of the jerk rest, towards which they brake.
    fn load_braked(&mut self, rest: &mut TurningBack) {
        if self.desired_rates.is_some() {
            self.aim.fill(0.0);
            return;
        }
        brake(&self.rates, &self.bounds, &mut rest.rates);
        self.motions.unknowns_of(&rest.rates, &mut self.aim);
    }

    /// The velocities nearest to the `aim` within all inequalities.
    pub(super) fn solve_aim(&mut self) {
        if !self.start() {
            self.last.fill(0.0);
            return;
        }
        self.set.approach(&self.aim, Precision::STRAIGHT);
        self.last.copy_from_slice(self.set.point());
    }
}
