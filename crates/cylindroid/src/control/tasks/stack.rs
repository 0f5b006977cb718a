//! The stack of levels: each is scaled along its direction; where no scale is feasible, its
//! direction is changed.
//!
//! Formula  `solver/hierarchy.rs`; direction changed: min |A y - b|^2 + d |y|^2, d = k |error|, k and
//!          its least value from `solver/saturation.rs`
//! Valid    a level that higher levels fix in part cannot be scaled as a whole: its direction is
//!          changed where a limit stops the rest
//! Checked  tests/it/servo/tasks.rs

use super::options::StoppedBy;
use super::task_servo::TaskServo;
use crate::collision::NearPair;
use crate::control::solver::active_set::FEASIBLE;
use crate::control::solver::bounds::{LimitKind, VelocityBounds};
use crate::control::solver::saturation::{CURVATURE, LEAST_DAMPING, MIN_SCALE, STRAIGHT};
use crate::linalg::norm;

/// Halvings of the interval of velocities by which distances give way: to a millionth.
const RELAXATIONS: usize = 20;

impl TaskServo {
    /// The stack, level by level; if no scaling of a level is feasible, its direction is changed and
    /// the stack is solved again.
    pub(super) fn solve(&mut self) {
        self.stacks.iter_mut().for_each(|s| s.direction_changed = false);
        for _ in 0..=self.stacks.len() {
            if !self.start() {
                // Limits contradict one another.
                for stack in &mut self.stacks {
                    (stack.scale, stack.left_out, stack.stopped_by) = (0.0, 0.0, None);
                }
                self.last.fill(0.0);
                self.lowest_stopped_by = None;
                return;
            }
            if self.solve_levels() {
                break;
            }
        }
        self.set.approach(&self.desired, STRAIGHT);
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
    fn start(&mut self) -> bool {
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

    /// False if a level was found whose direction must change.
    fn solve_levels(&mut self) -> bool {
        let length = self.options.length;
        for stack in &mut self.stacks {
            let whole = &mut stack.level.whole;
            let mut error = 0.0;
            for &(i, first) in &stack.members {
                let (task, rows) = (&self.tasks[i], &self.rows[i]);
                let root = task.weight.sqrt();
                for r in 0..rows.error.len() {
                    let scale = root * if task.objective.is_length(r) { 1.0 / length } else { 1.0 };
                    error += (scale * rows.error[r]).powi(2);
                    whole.target[first + r] =
                        scale * (task.gain * rows.error[r] + rows.feed_forward[r]);
                    for j in 0..whole.rows.cols() {
                        let entry = self.motions.entry(|i| rows.jacobian[(r, i)], j);
                        whole.rows[(first + r, j)] = scale * entry;
                    }
                }
            }
            if !stack.direction_changed && self.set.solve_freely(whole, self.options.eps) {
                (stack.scale, stack.left_out, stack.stopped_by) = (1.0, 0.0, None);
                continue;
            }
            let size = norm(&whole.target);
            let left_out = self.set.reduce_target(whole, self.options.eps);
            stack.left_out = if size > 0.0 { left_out / size } else { 0.0 };
            let causes = (&self.bounds[..], self.options.half_spaces.len(), &self.near[..]);
            let mut stop = None;
            if stack.direction_changed {
                let damping = (CURVATURE * f64::sqrt(error)).max(LEAST_DAMPING);
                self.set.solve_damped(whole, damping, STRAIGHT, |row| {
                    note(&mut stop, cause(row, causes));
                });
                // Inequalities across the target stop only this solution.
                stack.stopped_by = stop.or(stack.stopped_by);
                continue;
            }
            let share = self.set.solve_scaled(&mut stack.level, STRAIGHT, |row, sign| {
                note(&mut stop, cause((row, sign), causes))
            });
            stack.stopped_by = stop;
            stack.scale = share.scale.min(1.0);
            let large = stack.scale >= MIN_SCALE || (stack.scale > 0.0 && !share.is_stopped);
            if !(share.is_straight && large) {
                stack.direction_changed = true;
                stack.scale = 0.0;
                return false;
            }
        }
        true
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
