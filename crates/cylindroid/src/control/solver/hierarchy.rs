//! Hierarchical least squares within inequalities: level after level, scaled along its direction
//! before the direction is changed.
//!
//! Formula  y_k = argmin |A_k y - b_k| over the minima of the levels before, l <= G y <= u for all.
//!          Scaled: of all y with A_k y parallel to b_k the one with the largest scale s <= 1,
//!          A_k y = s b_k; as two levels, (1 - p p^T) A_k y = 0 and p^T A_k y = |b_k|, p = b_k / |b_k|;
//!          of several tasks in a level each has its own p and s
//!          A task is reflected so that p becomes its first axis: the rows across are independent
//!          where those of the task are
//! Shapes   A_k: m_k x n
//! Valid    any rank; a direction that cannot be kept exactly is reported
//! Source   Escande, Mansard & Wieber 2014; Flacco, De Luca & Khatib 2015 (scaling)
//! Checked  src/control/solver/hierarchy/tests.rs

use super::active_set::{ActiveSet, Level, Objective, Precision, Whole};
use crate::linalg::{dot, norm};

/// A level of tasks whose directions are preserved first.
#[derive(Debug, Clone)]
pub(in crate::control) struct ScaledLevel {
    /// Rows and target of the whole level.
    pub(in crate::control) whole: Level,
    /// The first row of each task, and the number of rows at the end.
    first: Vec<usize>,
    /// Tasks that take no part in this solution.
    pub(in crate::control) left_aside: Vec<bool>,
    /// s of each task in the last solution; 1 for those without a target.
    pub(in crate::control) scales: Vec<f64>,
    /// False for tasks that could not be kept along their targets.
    pub(in crate::control) are_straight: Vec<bool>,
    /// The rows across the targets, zeros after the last one, and the row along each target.
    across: Level,
    along: Level,
    /// The first row across the target of each task, and their number at the end.
    first_across: Vec<usize>,
}

/// Parts across the target below this share of it are roundings [-].
const ACROSS: f64 = 1e-9;

impl ScaledLevel {
    /// For tasks that begin at these rows, and m rows in all.
    pub(in crate::control) fn new(mut first: Vec<usize>, m: usize, n: usize) -> Self {
        let tasks = first.len();
        first.push(m);
        Self {
            whole: Level::new(m, n),
            first,
            left_aside: vec![false; tasks],
            scales: vec![1.0; tasks],
            are_straight: vec![true; tasks],
            across: Level::new(m, n),
            along: Level::new(tasks, n),
            first_across: vec![0; tasks + 1],
        }
    }

    /// Forgets the last solution.
    pub(in crate::control) fn reset(&mut self) {
        for level in [&mut self.whole, &mut self.across, &mut self.along] {
            level.reset();
        }
    }

    /// Splits each task; returns the largest of the targets.
    fn split(&mut self) -> f64 {
        let Self { whole, first, left_aside, across, along, first_across, .. } = self;
        whole.scale = whole.rows.frobenius_norm();
        (across.scale, along.scale) = (whole.scale, whole.scale);
        let (mut largest, mut place) = (0.0_f64, 0);
        for (k, ends) in first.windows(2).enumerate() {
            let rows = ends[0]..ends[1];
            let target = &whole.target[rows.clone()];
            let size = if left_aside[k] { 0.0 } else { norm(target) };
            largest = largest.max(size);
            along.target[k] = size;
            first_across[k] = place;
            // The reflection 1 - v v^T / (v_0 sign), v = p + sign e_1, takes p to -sign e_1.
            let sign = 1_f64.copysign(target.first().copied().unwrap_or(0.0));
            let count = match size {
                _ if left_aside[k] => 0,
                // Without a target a task is to rest: all of it is across.
                0.0 => rows.len(),
                _ => rows.len() - 1,
            };
            for j in 0..whole.rows.cols() {
                let column = &whole.rows.column(j)[rows.clone()];
                let share = if size > 0.0 { dot(column, target) / size } else { 0.0 };
                along.rows[(k, j)] = share;
                let parts = across.rows.column_mut(j)[place..place + count].iter_mut();
                if size > 0.0 {
                    let part = (share + sign * column[0]) / (target[0].abs() + size);
                    let rest = column.iter().zip(target).skip(1);
                    parts.zip(rest).for_each(|(x, (a, b))| *x = a - part * b);
                } else {
                    parts.zip(column).for_each(|(x, a)| *x = *a);
                }
            }
            place += count;
        }
        first_across[first.len() - 1] = place;
        for j in 0..whole.rows.cols() {
            across.rows.column_mut(j)[place..].fill(0.0);
        }
        largest
    }

    /// The shares that y has of the targets.
    fn load_shares(&mut self, y: &[f64], cut: f64, largest: f64) {
        let left = self.across.left(y);
        for (k, ends) in self.first_across.windows(2).enumerate() {
            let size = self.along.target[k];
            let rest = norm(&left[ends[0]..ends[1]]);
            self.are_straight[k] = rest <= ACROSS * largest + cut;
            let along = (0..y.len()).map(|j| self.along.rows[(k, j)] * y[j]).sum::<f64>();
            self.scales[k] = if size > 0.0 { along / size } else { 1.0 };
        }
    }
}

impl ActiveSet {
    /// The least-squares solution of a level within what the levels before leave.
    #[cfg(any(test, fuzzing))]
    pub(in crate::control) fn solve(&mut self, level: &mut Level, precision: Precision) {
        level.scale = level.rows.frobenius_norm();
        self.minimise(Objective::Rows(level), precision);
        self.keep(level, precision);
    }

    /// The size of what the least squares of a level leave of its target; the point stays there, and
    /// nothing is kept.
    pub(in crate::control) fn least_residual(
        &mut self,
        level: &mut Level,
        precision: Precision,
    ) -> f64 {
        level.scale = level.rows.frobenius_norm();
        self.minimise(Objective::Rows(level), precision);
        level.residual(self.point())
    }

    /// What the least squares of a level leave of its target; the point and the working rows stay as
    /// they are.
    pub(in crate::control) fn least_left<'a>(
        &mut self,
        level: &'a mut Level,
        precision: Precision,
    ) -> &'a [f64] {
        self.hold();
        self.least_residual(level, precision);
        let left = level.left(self.point());
        self.restore();
        left
    }

    /// The point nearest to `desired` within what the levels before leave.
    pub(in crate::control) fn approach(&mut self, desired: &[f64], precision: Precision) {
        self.minimise(Objective::Nearest(desired), precision);
    }

    /// The largest shares of the tasks of a level along their directions, in the sense of least
    /// squares, into `level`; `stops` are the inequalities (row and sign of the bound) to report. True
    /// if one of them ends a motion.
    pub(in crate::control) fn solve_scaled(
        &mut self,
        level: &mut ScaledLevel,
        precision: Precision,
        mut stops: impl FnMut(usize, f64) -> bool,
    ) -> bool {
        let largest = level.split();
        let rows = level.first_across[level.first.len() - 1];
        if self.perform(&mut level.across, rows, 0.0) != Whole::Performed {
            self.minimise(Objective::Rows(&mut level.across), precision);
            self.keep(&mut level.across, precision);
        }
        let cut = precision.rank * level.whole.scale * norm(self.point());
        self.minimise(Objective::Rows(&mut level.along), precision);
        let mut is_stopped = false;
        for (row, sign) in self.stopping() {
            is_stopped |= stops(row, sign);
        }
        self.keep(&mut level.along, precision);
        level.load_shares(self.point(), cut, largest);
        is_stopped
    }
}

#[cfg(test)]
mod findings;
#[cfg(any(test, fuzzing))]
pub(in crate::control) mod optimality;
#[cfg(any(test, fuzzing))]
mod problem;
#[cfg(test)]
mod tests;
