//! The range of linearised tasks: where a step along weak directions is bent by the curvature of a task
//! more than it performs of it.
//!
//! Formula  of the velocities y with A y = b the part z in the space of the rows; sensible if
//!          |A z|^2 > k w |z|^2, w = |b| / gain the error, k the curvature: Gauss-Newton steps contract
//!          where s^2 > k |error|
//! Valid    k of stretched arms; steps of the whole error need more of it. A whole target whose motions
//!          are short is in range wherever it leads
//! Source   Nocedal & Wright, Numerical Optimization, 2006, 10.3 (Gauss-Newton with large residuals)
//! Checked  tests/it/servo/task_edges.rs

use super::levels::Member;
use crate::control::solver::active_set::Level;
use crate::control::solver::saturation::CURVATURE;
use crate::linalg::{dot, norm};

/// Curvature for each unit of gain times dt [-]: steps of the whole error overshoot with less. Found by
/// experiment with arms at the edge of their reach.
const STEPPED: f64 = 1.5;

/// Motions of the joints that are short [-].
const SHORT: f64 = 0.2;

/// Rows whose part outside others is smaller than this share of all depend on them [-].
const DEPENDENT: f64 = 1e-6;

/// What bounds the range of the tasks of a level.
#[derive(Debug, Clone, Copy)]
pub(super) struct LinearRange {
    /// The largest gain of its tasks [1/s].
    gain: f64,
    /// k
    pub(super) curvature: f64,
    /// True if a part of the target was left out.
    pub(super) is_reduced: bool,
}

impl LinearRange {
    /// For steps of `dt` seconds.
    pub(super) fn new(gain: f64, dt: f64) -> Self {
        Self { gain, curvature: CURVATURE.max(STEPPED * dt * gain), is_reduced: false }
    }

    /// Notes the tasks whose range y, which performs all of them, leaves: their directions must change. True
    /// if there is a new one.
    pub(super) fn is_left_by(&self, whole: &Level, members: &mut [Member], y: &[f64]) -> bool {
        let mut found = false;
        for member in members.iter_mut().filter(|m| !m.is_curved) {
            member.scale = 1.0;
            if !self.holds(whole, member, y) {
                (member.is_curved, member.direction_changed, found) = (true, true, true);
            }
        }
        found
    }

    /// True if y, which performs the scaled task, is in its range without the scale.
    pub(super) fn holds(&self, whole: &Level, member: &mut Member, y: &[f64]) -> bool {
        let short = if self.is_reduced { 0.0 } else { SHORT * self.gain * member.scale };
        if norm(y) <= short {
            return true;
        }
        let least = DEPENDENT * whole.rows.frobenius_norm();
        let (mut rank, mut size, mut moved) = (0, 0.0, 0.0);
        for r in member.rows.clone() {
            let mut along = 0.0;
            for (j, (x, y)) in member.row.iter_mut().zip(y).enumerate() {
                *x = whole.rows[(r, j)];
                along += *x * y;
            }
            moved += along * along;
            if rank == y.len() {
                continue;
            }
            member.basis.project_out(rank, &mut member.row);
            member.basis.project_out(rank, &mut member.row);
            let length = norm(&member.row);
            if length > least {
                member.row.iter_mut().for_each(|x| *x /= length);
                member.basis.column_mut(rank).copy_from_slice(&member.row);
                size += dot(&member.row, y).powi(2);
                rank += 1;
            }
        }
        // Where the target is whole, straight ways count more than the last steps.
        let curvature = if self.is_reduced { self.curvature } else { CURVATURE };
        size.sqrt() <= short || moved > curvature * member.way * size
    }
}
