//! The stack of levels: each task is scaled along its direction; where no scale is feasible, or
//! directions are not to be kept, its direction is changed, on what the others of its level leave.
//!
//! Formula  `solver/hierarchy.rs`; directions changed, of all such tasks of a level at once:
//!          min |A y - b|^2 + d |y|^2, d = k |error| of the task with the largest error, k from
//!          `linear_range.rs` and the least d from `solver/saturation.rs`; for least squares + y^T P(C) y, C
//!          the curvature (`frame_curvature.rs`, k |error| |A_j| for other tasks) of the part of the
//!          errors that limits leave, or of all of it beyond the range of the linearised tasks
//! Valid    a level that higher levels fix in part cannot be scaled as a whole: its direction is
//!          changed where a limit stops the rest
//! Checked  tests in this file, tests/it/servo/tasks.rs, tests/it/servo/task_edges.rs

use super::levels::{Member, Stack, USUAL_GAIN};
use super::linear_range::LinearRange;
use super::options::StoppedBy;
use super::task_servo::TaskServo;
use crate::collision::NearPair;
use crate::control::solver::active_set::{DampedLevel, FEASIBLE, Level, Precision, Weak, Whole};
use crate::control::solver::bounds::{LimitKind, VelocityBounds};
use crate::control::solver::hierarchy::ScaledLevel;
use crate::control::solver::saturation::{LEAST_DAMPING, MIN_SCALE};
use crate::linalg::{dot, norm};

/// Tasks that miss less than this share of their velocity are realised as a whole [-].
const WHOLE: f64 = 1e-9;

/// Largest weight of the rows of a task beside those of a task that asks for more [-].
const MOST_WEIGHT: f64 = 1e3;

/// Scaled errors up to this bend nothing [-]: with weights and lengths of one a thousandth of the least
/// damping.
const STRAIGHT_WAY: f64 = 1e-3 * LEAST_DAMPING;

/// Halvings of the interval of velocities by which distances give way: to a millionth.
const RELAXATIONS: usize = 20;

impl TaskServo {
    /// The stack, level by level; if no scaling of a level is feasible, its direction is changed and
    /// the stack is solved again.
    pub(super) fn solve(&mut self) {
        let mut rounds = 1;
        for member in self.stacks.iter_mut().flat_map(|s| &mut s.members) {
            member.direction_changed = !self.options.keep_directions;
            (member.stopped_by, member.is_curved) = (None, false);
            rounds += 1;
        }
        for round in 0..rounds {
            if !self.start() {
                // Limits contradict one another.
                for stack in &mut self.stacks {
                    stack.left_out = 0.0;
                    stack.members.iter_mut().for_each(|m| (m.scale, m.stopped_by) = (0.0, None));
                }
                self.last.fill(0.0);
                self.lowest_stopped_by = None;
                return;
            }
            if self.solve_levels(round == 0) {
                break;
            }
        }
        self.set.approach(&self.desired, Precision::STRAIGHT);
        let causes = (&self.bounds[..], self.options.half_spaces.len(), &self.near[..]);
        let mut stop = None;
        self.set.stopping().for_each(|row| {
            note(&mut stop, cause(row, causes));
        });
        self.lowest_stopped_by = stop;
        self.last.copy_from_slice(self.set.point());
    }

    /// Starts within all inequalities; where limits and distances contradict one another, distances give
    /// way alike, as little as the limits permit. False if limits alone contradict one another.
    pub(super) fn start(&mut self) -> bool {
        if self.set.start(&self.last) {
            return true;
        }
        let first = self.limits.len();
        let inequalities = &mut self.set.inequalities;
        self.strict.copy_from_slice(&inequalities.lower[first..]);
        self.rest.fill(0.0);
        inequalities.clamp_to_box(&mut self.rest);
        let excess = |i: usize, strict: &f64| {
            let row = first + i;
            let length = inequalities.length(row);
            if length > 0.0 { (strict - inequalities.value(row, &self.rest)) / length } else { 0.0 }
        };
        let all = self.strict.iter().enumerate();
        // At rest, as far as the limits permit it, distances are violated by this.
        let mut more = all.map(|(i, strict)| excess(i, strict)).fold(0.0, f64::max);
        let mut less = 0.0;
        for _ in 0..RELAXATIONS {
            let middle = 0.5 * (less + more);
            if self.start_relaxed(middle) {
                more = middle;
            } else {
                less = middle;
            }
        }
        self.start_relaxed(more)
    }

    /// Starts with distances that fall faster by `excess`, of rows of unit length.
    fn start_relaxed(&mut self, excess: f64) -> bool {
        let first = self.limits.len();
        for (i, strict) in self.strict.iter().enumerate() {
            let length = self.set.inequalities.length(first + i);
            self.set.inequalities.lower[first + i] = strict - excess * (1.0 + FEASIBLE) * length;
        }
        self.set.start(&self.last)
    }

    /// False if tasks were found whose directions must change; in the first round none was yet.
    fn solve_levels(&mut self, is_first: bool) -> bool {
        let (length, dt) = (self.options.length, self.options.dt);
        for stack in &mut self.stacks {
            let gains = stack.members.iter().map(|m| self.tasks[m.task].gain);
            let mut linear = LinearRange::new(gains.fold(0.0, f64::max), dt);
            let Stack { members, level, turned, asked, left_out } = stack;
            let whole = &mut level.whole;
            for member in &mut *members {
                let (task, rows) = (&self.tasks[member.task], &self.rows[member.task]);
                let root = member.weight.sqrt();
                let mut error = 0.0;
                let scale = |r: usize| root * rows.unit(r, length);
                for (r, target) in whole.target[member.rows.clone()].iter_mut().enumerate() {
                    error += (scale(r) * rows.error[r]).powi(2);
                    *target = scale(r) * (task.gain * rows.error[r] + rows.feed_forward[r]);
                }
                for j in 0..whole.rows.cols() {
                    let column = &mut whole.rows.column_mut(j)[member.rows.clone()];
                    self.motions.load_column(&rows.jacobian, j, column);
                    column.iter_mut().enumerate().for_each(|(r, x)| *x *= scale(r));
                }
                member.error = error.sqrt();
                let gain = if task.gain > 0.0 { task.gain } else { USUAL_GAIN };
                member.way = norm(&whole.target[member.rows.clone()]) / gain;
            }
            let is_whole = is_first || members.iter().all(|m| !m.direction_changed);
            let ended = match is_whole {
                true => self.set.solve_freely(whole, self.options.eps),
                false if self.set.is_clear(whole, self.options.eps) => Whole::Stopped,
                false => Whole::Unclear,
            };
            *left_out = 0.0;
            asked.copy_from_slice(&whole.target);
            match ended {
                Whole::Performed => {
                    members.iter_mut().for_each(|m| (m.scale, m.stopped_by) = (1.0, None));
                    if linear.is_left_by(whole, members, self.set.point()) {
                        return false;
                    }
                    continue;
                }
                Whole::Stopped => {}
                Whole::Unclear => {
                    let size = norm(&whole.target);
                    let weak = Weak {
                        below: self.options.eps,
                        none: Precision::STRAIGHT.rank,
                        curvature: linear.curvature,
                        least: LEAST_DAMPING,
                    };
                    let error = |u: &[f64]| {
                        let part = |m: &Member| (norm(&u[m.rows.clone()]) * m.way).powi(2);
                        members.iter().map(part).sum::<f64>().sqrt()
                    };
                    // What a task leaves out must not disturb one that asks for less.
                    let farthest = members.iter().map(|m| m.way).fold(0.0, f64::max);
                    let weights =
                        members.iter().map(|m| (m.rows.clone(), weight_beside(m.way, farthest)));
                    let missing = self.set.reduce_target(whole, weak, error, weights);
                    *left_out = if size > 0.0 { missing / size } else { 0.0 };
                    linear.is_reduced = *left_out > 0.0;
                }
            }
            let causes = (&self.bounds[..], self.options.half_spaces.len(), &self.near[..]);
            let mut stop = None;
            // Tasks that keep their directions come first.
            for (aside, member) in level.left_aside.iter_mut().zip(&*members) {
                *aside = member.direction_changed;
            }
            if level.left_aside.contains(&false) {
                let is_stopped = self.set.solve_scaled(level, Precision::STRAIGHT, |row, sign| {
                    note(&mut stop, cause((row, sign), causes))
                });
                let y = self.set.point();
                if level.change_directions(members, (stop, is_stopped), y, linear) {
                    return false;
                }
            }
            if members.iter().all(|m| !m.direction_changed) {
                continue;
            }
            // The others share by their weights what is left: none of them comes first.
            load_turned(&mut turned.level, members, &level.whole);
            let is_curved = members.iter().any(|m| m.is_curved);
            if self.options.keep_directions {
                let errors = members.iter().filter(|m| m.direction_changed).map(|m| m.error);
                let error = errors.fold(0.0, f64::max);
                turned.damp_alike((linear.curvature * error).max(LEAST_DAMPING));
            } else {
                // Weak directions are damped by what bends them, instead of left out.
                turned.level.target.copy_from_slice(asked);
                let DampedLevel { level: own, curvature, .. } = &mut *turned;
                let left = self.set.least_left(own, Precision::STRAIGHT);
                curvature.as_mut_slice().fill(0.0);
                for member in members.iter_mut().filter(|m| m.direction_changed) {
                    let rows = member.rows.clone();
                    let (asked, left) = (&asked[rows.clone()], &left[rows]);
                    let task = &self.tasks[member.task];
                    member.load_left(task.gain, if member.is_curved { asked } else { left });
                    if norm(&member.left) <= STRAIGHT_WAY {
                        continue;
                    }
                    let of_other = (&level.whole, linear.curvature);
                    member.add_curvature(task, self.state.q(), of_other, curvature);
                }
                turned.damp(LEAST_DAMPING, is_curved);
            }
            self.stops.clear();
            self.set.solve_damped(turned, Precision::STRAIGHT, |row| self.stops.push(row));
            let turned = &mut turned.level;
            turned.left(self.set.point());
            for member in members.iter_mut().filter(|m| m.direction_changed) {
                let (mut stop, rows) = (None, member.rows.clone());
                for &(row, sign) in &self.stops {
                    if self.set.pulls(turned, rows.clone(), (row, sign)) {
                        note(&mut stop, cause((row, sign), causes));
                    }
                }
                // Inequalities across the target stop only this solution.
                member.stopped_by = stop.or(member.stopped_by);
            }
            if !self.options.keep_directions {
                let y = self.set.point();
                if !is_curved && linear.is_left_by(&level.whole, members, y) {
                    return false;
                }
                asked.copy_from_slice(&level.whole.target);
                let left = level.whole.left(y);
                for member in &mut *members {
                    let rows = member.rows.clone();
                    member.scale = share(&asked[rows.clone()], &left[rows]);
                }
            }
        }
        true
    }
}

/// The weight of a task that asks for `way` beside one that asks for most: 1 where none asks.
fn weight_beside(way: f64, farthest: f64) -> f64 {
    if farthest > 0.0 { (farthest / way).min(MOST_WEIGHT) } else { 1.0 }
}

/// The share of a target that is realised along it, from what is left of it.
fn share(target: &[f64], left: &[f64]) -> f64 {
    let size = dot(target, target);
    if size > 0.0 { (1.0 - dot(target, left) / size).max(0.0) } else { 1.0 }
}

/// The rows and targets of the tasks whose directions are changed, into `turned`.
fn load_turned(turned: &mut Level, members: &[Member], whole: &Level) {
    turned.rows.as_mut_slice().fill(0.0);
    turned.target.fill(0.0);
    for member in members.iter().filter(|m| m.direction_changed) {
        let rows = member.rows.clone();
        turned.target[rows.clone()].copy_from_slice(&whole.target[rows.clone()]);
        for j in 0..whole.rows.cols() {
            let column = &whole.rows.column(j)[rows.clone()];
            turned.rows.column_mut(j)[rows.clone()].copy_from_slice(column);
        }
    }
}

impl ScaledLevel {
    /// Stores the shares of the tasks; true if the direction of one of them must change.
    fn change_directions(
        &self,
        members: &mut [Member],
        (stop, is_stopped): (Option<StoppedBy>, bool),
        y: &[f64],
        linear: LinearRange,
    ) -> bool {
        let mut changed = false;
        for (k, member) in members.iter_mut().enumerate().filter(|(_, m)| !m.direction_changed) {
            member.scale = self.scales[k].min(1.0);
            let is_whole = member.scale >= 1.0 - WHOLE;
            member.stopped_by = if is_whole && self.are_straight[k] { None } else { stop };
            let large = member.scale >= MIN_SCALE || (member.scale > 0.0 && !is_stopped);
            member.is_curved |= large && !linear.holds(&self.whole, member, y);
            if !(self.are_straight[k] && large) || member.is_curved {
                (member.direction_changed, member.scale) = (true, 0.0);
                changed = true;
            }
        }
        changed
    }
}

/// Of several inequalities, the last one that ends the motion for good, otherwise the first. True if
/// this one ends it.
fn note(stop: &mut Option<StoppedBy>, (cause, is_end): (StoppedBy, bool)) -> bool {
    if is_end || stop.is_none() {
        *stop = Some(cause);
    }
    is_end
}

/// The inequality of a row, and true if it ends the motion for good: a position or a distance. Of the
/// rows those of limits come first, then the half-spaces, then the pairs.
fn cause(
    (row, sign): (usize, f64),
    (bounds, half_spaces, near): (&[VelocityBounds], usize, &[NearPair]),
) -> (StoppedBy, bool) {
    let Some(bound) = bounds.get(row) else {
        let index = row - bounds.len();
        if index < half_spaces {
            return (StoppedBy::HalfSpace { index }, true);
        }
        let pair = near.get(index - half_spaces).map_or(0, |near| near.pair);
        return (StoppedBy::Distance { pair }, true);
    };
    let kind = if sign > 0.0 { bound.upper_cause } else { bound.lower_cause };
    (StoppedBy::Limit { coordinate: row, kind }, kind == LimitKind::Position)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tasks at rest weigh more beside others, and nothing more where all of them rest.
    #[test]
    fn tasks_that_ask_for_less_weigh_more() {
        let all = [(0.5, 1.0, 2.0), (1.0, 1.0, 1.0), (0.0, 1.0, MOST_WEIGHT), (0.0, 0.0, 1.0)];
        for (way, farthest, weight) in all {
            assert_eq!(weight_beside(way, farthest), weight, "{way} {farthest}");
        }
    }
}
