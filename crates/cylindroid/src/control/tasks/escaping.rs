//! Steps of a servo of many tasks in which its first level may be lost: the search for a way out of
//! there, and the way.
//!
//! Formula  `escape.rs`
//! Checked  tests/it/servo/task_edges.rs

use std::mem;

use super::escape::{Achieved, Escape, Phase};
use super::levels::USUAL_GAIN;
use super::options::StoppedBy;
use super::task_servo::TaskServo;
use super::turning_back::Along;
use crate::control::servo::{AT_REST, Surroundings};
use crate::control::solver::bounds::VelocityBounds;
use crate::error::Result;
use crate::linalg::{dot, norm};

/// Columns of the Hessian in a step.
const COLUMNS: usize = 2;

/// Step of the differences [rad or m].
const DIFFERENCE: f64 = 1e-6;

/// Gradients above this share of the error, scaled by the Jacobian, are those of tasks that joints can
/// perform [-].
const WEAK: f64 = 0.05;

/// Longest way out of a saddle (s), and more by so many times the time of its gain [-].
const LONGEST: f64 = 1.0;
const TIMES: f64 = 3.0;

/// Share by which the error of a level at rest falls before it is looked at again [-].
const FALLEN: f64 = 0.05;

impl TaskServo {
    /// Replaces the velocities of a first level that makes no progress, if a motion of the joints opens
    /// a way. The share that its linearised tasks achieve, if they ask for more than their tolerances.
    pub(super) fn escape(&mut self) -> Result<Option<Achieved>> {
        let achieved = self.achieved();
        let Some(escape) = &mut self.escape else { return Ok(None) };
        let Some(Achieved { error, .. }) = achieved else {
            escape.reset();
            return Ok(None);
        };
        match escape.phase {
            _ if !escape.progress.is_lost => escape.phase = Phase::Watching,
            // Joints that come to rest make no progress either.
            Phase::Watching if norm(&self.last) < AT_REST => escape.phase = Phase::Probing(0),
            Phase::Watching => {}
            Phase::Resting(then) if error < (1.0 - FALLEN) * then => escape.reset(),
            Phase::Resting(_) => {}
            Phase::Probing(column) => {
                self.probe(column)?;
                self.decide(column, error);
            }
            Phase::Leaving { time, left } => {
                self.solve_within_limits(Self::solve_escape);
                let (gain, dt) = (self.first_gain(), self.options.dt);
                if let Some(escape) = &mut self.escape {
                    let way = &escape.saddle.rates;
                    let left = left - dt * dot(&self.last, way) / norm(way);
                    let time = time + dt;
                    let is_over = left <= 0.0 || time > LONGEST + TIMES / gain;
                    escape.phase =
                        if is_over { Phase::Resting(error) } else { Phase::Leaving { time, left } };
                }
            }
        }
        Ok(achieved)
    }

    /// True on the way out.
    pub(super) fn leaves(&self) -> bool {
        let phase = self.escape.as_ref().map(|escape| escape.phase);
        matches!(phase, Some(Phase::Leaving { .. }))
    }

    /// Records the progress of a step, unless joints accelerate or brake in it.
    pub(super) fn record_progress(&mut self, achieved: Option<Achieved>, is_on_the_way: bool) {
        if let (Some(escape), Some(Achieved { share, .. })) = (&mut self.escape, achieved)
            && !is_on_the_way
        {
            escape.progress.record(share, self.options.dt);
        }
    }

    /// The least gain of the first level.
    fn first_gain(&self) -> f64 {
        let members = self.stacks.first().map_or(&[][..], |s| &s.members);
        let gains = members.iter().map(|m| self.tasks[m.task].gain).filter(|gain| *gain > 0.0);
        gains.reduce(f64::min).unwrap_or(USUAL_GAIN)
    }

    /// What the velocities of this step do for the first level.
    fn achieved(&self) -> Option<Achieved> {
        let (escape, first) = (self.escape.as_ref()?, self.stacks.first()?);
        let (mut along, mut size, mut is_open) = (Along::default(), 0.0, false);
        let length = self.options.length;
        for member in &first.members {
            let (task, rows) = (&self.tasks[member.task], &self.rows[member.task]);
            let stop = member.stopped_by;
            if matches!(stop, Some(StoppedBy::HalfSpace { .. } | StoppedBy::Distance { .. })) {
                return None;
            }
            if !escape.counts(member.task, &task.objective) {
                continue;
            }
            let velocity = |j: usize| escape.columns[j] * self.last[j];
            along.add((task, rows), velocity, (member.weight, 0.0, length));
            for (r, error) in rows.error.iter().enumerate() {
                size += member.weight * (error * rows.unit(r, length)).powi(2);
            }
            is_open |= rows.exceeds(task.tolerance);
        }
        let share = if along.square > 0.0 { along.part / along.square } else { 1.0 };
        is_open.then(|| Achieved { share, error: size.sqrt() })
    }

    /// Columns of the Hessian from this one on.
    fn probe(&mut self, first_column: usize) -> Result<()> {
        let Some(mut escape) = self.escape.take() else { return Ok(()) };
        let done = self.probe_into(first_column, &mut escape);
        self.escape = Some(escape);
        done
    }

    fn probe_into(&mut self, first_column: usize, escape: &mut Escape) -> Result<()> {
        let mut gradient = mem::take(&mut escape.saddle.gradient);
        if first_column == 0 {
            escape.q.copy_from_slice(self.state.q());
            self.first_gradient_into(escape, &mut gradient);
            escape.gradient.copy_from_slice(&gradient);
        }
        // The present configuration, to return to.
        escape.last.copy_from_slice(self.state.q());
        let end = (first_column + COLUMNS).min(escape.unit.len());
        for j in first_column..end {
            escape.unit.fill(0.0);
            escape.unit[j] = escape.columns[j];
            escape.other.copy_from_slice(&escape.q);
            let mechanism = self.state.mechanism();
            mechanism.integrate_in_place(&mut escape.other, &escape.unit, DIFFERENCE);
            self.state.set(&escape.other)?;
            self.evaluate()?;
            self.first_gradient_into(escape, &mut gradient);
            let column = escape.saddle.hessian.column_mut(j).iter_mut();
            for ((x, here), there) in column.zip(&escape.gradient).zip(&gradient) {
                *x = (here - there) / DIFFERENCE;
            }
        }
        escape.saddle.gradient = gradient;
        escape.saddle.gradient.copy_from_slice(&escape.gradient);
        self.state.set(&escape.last)?;
        self.evaluate()
    }

    /// g = J^T e of the tasks of the first level that count, scaled.
    fn first_gradient_into(&self, escape: &Escape, out: &mut [f64]) {
        out.fill(0.0);
        for member in self.stacks.iter().take(1).flat_map(|first| &first.members) {
            let (task, rows) = (&self.tasks[member.task], &self.rows[member.task]);
            if !escape.counts(member.task, &task.objective) {
                continue;
            }
            for (r, error) in rows.error.iter().enumerate() {
                let scaled = member.weight * error * rows.unit(r, self.options.length).powi(2);
                for (j, (x, column)) in out.iter_mut().zip(&escape.columns).enumerate() {
                    *x += column * scaled * rows.jacobian[(r, j)];
                }
            }
        }
    }

    /// After the last column: the way out, or rest.
    fn decide(&mut self, column: usize, error: f64) {
        let gain = self.first_gain();
        let Some(escape) = &mut self.escape else { return };
        let n = escape.unit.len();
        if column + COLUMNS < n {
            escape.phase = Phase::Probing(column + COLUMNS);
            return;
        }
        let Escape { saddle, bounds, columns, last, .. } = &mut **escape;
        for i in 0..n {
            for k in 0..i {
                let mean = 0.5 * (saddle.hessian[(i, k)] + saddle.hessian[(k, i)]);
                (saddle.hessian[(i, k)], saddle.hessian[(k, i)]) = (mean, mean);
            }
            let scale = if columns[i] == 0.0 { 0.0 } else { 1.0 / columns[i] };
            let VelocityBounds { lower, upper, .. } = self.bounds[i];
            bounds[i] =
                VelocityBounds { lower: scale * lower, upper: scale * upper, ..self.bounds[i] };
            last[i] = scale * self.rates[i];
        }
        let around = Surroundings {
            columns,
            limits: &self.limits,
            q: self.state.q(),
            bounds,
            last,
            gain,
            fastest: (f64::INFINITY, f64::INFINITY),
        };
        // A task that slow joints slow down is not lost.
        let steep = WEAK * saddle.hessian.frobenius_norm().sqrt() * error;
        let leads_out =
            around.free_size(&saddle.gradient) <= steep && saddle.leave(&around, error, false);
        let left = norm(&saddle.rates) / gain;
        escape.phase =
            if leads_out { Phase::Leaving { time: 0.0, left } } else { Phase::Resting(error) };
    }

    /// The velocities of the way out within all inequalities.
    fn solve_escape(&mut self) {
        if let Some(escape) = &self.escape {
            self.aim.copy_from_slice(&escape.saddle.rates);
        }
        self.solve_aim();
        for member in self.stacks.iter_mut().flat_map(|s| &mut s.members) {
            member.scale = 0.0;
        }
    }
}
