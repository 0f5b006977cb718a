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
use crate::control::solver::bounds::{LimitKind, VelocityBounds};
use crate::control::solver::saturation::{CURVATURE, LEAST_DAMPING, MIN_SCALE, STRAIGHT};
use crate::linalg::norm;

impl TaskServo {
    /// The stack, level by level; if no scaling of a level is feasible, its direction is changed and
    /// the stack is solved again.
    pub(super) fn solve(&mut self) {
        self.stacks.iter_mut().for_each(|s| s.direction_changed = false);
        for _ in 0..=self.stacks.len() {
            if !self.set.start(&self.last) {
                // Limits and distances contradict one another.
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
        let mut stop = None;
        self.set.stopping().for_each(|row| {
            note(&mut stop, cause(row, &self.bounds, &self.near));
        });
        self.lowest_stopped_by = stop;
        self.last.copy_from_slice(self.set.point());
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
                    for (j, column) in self.columns.iter().enumerate() {
                        whole.rows[(first + r, j)] = scale * column * rows.jacobian[(r, j)];
                    }
                }
            }
            let size = norm(&whole.target);
            let left_out = self.set.reduce_target(whole, self.options.eps);
            stack.left_out = if size > 0.0 { left_out / size } else { 0.0 };
            let (near, bounds) = (&self.near, &self.bounds);
            let mut stop = None;
            if stack.direction_changed {
                let damping = (CURVATURE * f64::sqrt(error)).max(LEAST_DAMPING);
                self.set.solve_damped(whole, damping, STRAIGHT, |row| {
                    note(&mut stop, cause(row, bounds, near));
                });
                // Inequalities across the target stop only this solution.
                stack.stopped_by = stop.or(stack.stopped_by);
                continue;
            }
            let share = self.set.solve_scaled(&mut stack.level, STRAIGHT, |row, sign| {
                note(&mut stop, cause((row, sign), bounds, near))
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

/// The inequality of a row, and true if it ends the motion for good: a position or a distance.
fn cause(
    (row, sign): (usize, f64),
    bounds: &[VelocityBounds],
    near: &[NearPair],
) -> (StoppedBy, bool) {
    let Some(bound) = bounds.get(row) else {
        let pair = near.get(row - bounds.len()).map_or(0, |near| near.pair);
        return (StoppedBy::Distance { pair }, true);
    };
    let kind = if sign > 0.0 { bound.upper_cause } else { bound.lower_cause };
    (StoppedBy::Limit { coordinate: row, kind }, kind == LimitKind::Position)
}
