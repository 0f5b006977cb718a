//! The stack of levels: each scaled along its direction, bent where no scale of it is feasible.
//!
//! Formula  `solver/hierarchy.rs`; bent: min |A y - b|^2 + d |y|^2, d as in `solver/saturation.rs`
//! Checked  tests/it/servo/tasks.rs

use super::levels::Stack;
use super::options::StoppedBy;
use super::task_servo::TaskServo;
use crate::collision::NearPair;
use crate::control::solver::active_set::{ActiveSet, Precision};
use crate::control::solver::bounds::{LimitKind, VelocityBounds};
use crate::linalg::norm;

/// Below this scale the direction of a level is changed [-].
const MIN_SCALE: f64 = 0.05;

/// Decisions of the solver.
const PRECISION: Precision = Precision { rank: 1e-6, release: 1e-9 };

/// Damping for an error of one that is out of reach [-], and the least [-].
const CURVATURE: f64 = 0.05;
const LEAST_DAMPING: f64 = 1e-6;

impl TaskServo {
    /// The stack, level by level; a level that no scale of its direction satisfies is bent, and the
    /// stack solved again.
    pub(super) fn solve(&mut self) {
        self.stacks.iter_mut().for_each(|s| s.is_bent = false);
        for _ in 0..=self.stacks.len() {
            if !self.set.start(&self.last) {
                // Limits and distances contradict one another.
                self.stacks.iter_mut().for_each(|s| s.scale = 0.0);
                self.last.fill(0.0);
                return;
            }
            if self.solve_levels() {
                break;
            }
        }
        self.set.approach(&self.desired, PRECISION);
        self.last.copy_from_slice(self.set.point());
    }

    /// False if a level was found that must be bent.
    fn solve_levels(&mut self) -> bool {
        let length = self.options.length;
        for stack in &mut self.stacks {
            let whole = &mut stack.level.whole;
            let mut gain = f64::INFINITY;
            for &(i, first) in &stack.members {
                let (task, rows) = (&self.tasks[i], &self.rows[i]);
                let root = task.weight.sqrt();
                gain = gain.min(task.gain);
                for r in 0..rows.error.len() {
                    let scale = root * if task.objective.is_length(r) { 1.0 / length } else { 1.0 };
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
            if stack.is_bent {
                bend(&mut self.set, stack, gain);
                continue;
            }
            let (near, bounds) = (&self.near, &self.bounds);
            let mut stop = None;
            let share = self.set.solve_scaled(&mut stack.level, PRECISION, |row, sign| {
                let (cause, is_end) = cause(row, sign, bounds, near);
                stop = stop.or(Some(cause));
                is_end
            });
            stack.stopped_by = stop;
            stack.scale = share.scale.min(1.0);
            let large = stack.scale >= MIN_SCALE || (stack.scale > 0.0 && !share.is_stopped);
            if !(share.is_straight && large) {
                stack.is_bent = true;
                stack.scale = 0.0;
                return false;
            }
        }
        true
    }
}

/// The damped least-squares solution of a level.
fn bend(set: &mut ActiveSet, stack: &mut Stack, gain: f64) {
    let whole = &mut stack.level.whole;
    let damping = (CURVATURE * norm(&whole.target) / gain).max(LEAST_DAMPING);
    set.solve_damped(whole, damping, PRECISION);
}

/// The inequality of a row, and true if it ends the motion for good: a position or a distance.
fn cause(row: usize, sign: f64, bounds: &[VelocityBounds], near: &[NearPair]) -> (StoppedBy, bool) {
    let Some(bound) = bounds.get(row) else {
        let pair = near.get(row - bounds.len()).map_or(0, |near| near.pair);
        return (StoppedBy::Distance { pair }, true);
    };
    let kind = if sign > 0.0 { bound.upper_cause } else { bound.lower_cause };
    (StoppedBy::Limit { coordinate: row, kind }, kind == LimitKind::Position)
}
