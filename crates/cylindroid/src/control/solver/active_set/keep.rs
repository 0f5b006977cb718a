//! Levels after a level: its rows are kept, with the inequalities that stop it.
//!
//! Source   Escande, Mansard & Wieber 2014
//! Checked  src/control/solver/hierarchy/tests.rs::levels_are_the_optima_of_clarabel

use std::ops::Range;

use super::{ActiveSet, DEPENDENT, DampedLevel, Level, Objective, Precision, Use, Weak};
use crate::linalg::{dot, norm};

impl ActiveSet {
    /// Reduces the target of a level to the motions that the levels before leave it, weak directions of
    /// it damped: what remains can be scaled. `error` is that of the tasks of a direction of its rows;
    /// rows of a large weight are changed little for weak directions, while what rows contradict is shared
    /// by all alike. Returns the size of the part left out.
    ///
    /// ```text
    /// of the residual r = b - A y_w:  sum_i f_i u_i (u_i . r),  f_i = s_i^2 / (s_i^2 + d_i)
    /// ```
    ///
    /// y_w are the motions of the levels before, d_i is the damping for the error in u_i; f_i = 1 where
    /// s_i is above `weak.below` of the norm of the rows.
    pub(in crate::control) fn reduce_target(
        &mut self,
        level: &mut Level,
        weak: Weak,
        error: impl Fn(&[f64]) -> f64,
        weights: impl Iterator<Item = (Range<usize>, f64)> + Clone,
    ) -> f64 {
        level.scale = level.rows.frobenius_norm();
        self.normal.copy_from_slice(&self.y);
        self.basis.project_out(self.fixed, &mut self.normal);
        self.basis.project_out(self.fixed, &mut self.normal);
        // What the levels before do to its rows.
        self.direction.copy_from_slice(&self.y);
        self.direction.iter_mut().zip(&self.normal).for_each(|(y, z)| *y -= z);
        level.load_residual(&self.direction);
        level.project(&self.basis, self.fixed);
        let (edge, none) = (weak.below * level.scale, weak.none * level.scale);
        let damped = |s: f64, u: &[f64]| match s {
            s if s > edge => 1.0,
            s if s > none => s * s / (s * s + weak.damping(error(u))),
            _ => 0.0,
        };
        let mut weighted = weights.filter(|(_, weight)| *weight != 1.0);
        let Some(first) = weighted.next() else {
            level.svd.decompose_warm(&level.projected);
            return level.filter_target(damped).sqrt();
        };
        let weighted = std::iter::once(first).chain(weighted);
        let contradicted = level.remove_contradiction(none).unwrap_or_else(|| {
            level.svd.decompose_warm(&level.projected);
            let size = level.filter_target(|s, _| if s > none { 1.0 } else { 0.0 });
            level.residual.copy_from_slice(&level.along);
            size
        });
        for (rows, weight) in weighted.clone() {
            for j in 0..level.projected.cols() {
                let column = &mut level.projected.column_mut(j)[rows.clone()];
                column.iter_mut().for_each(|x| *x *= weight);
            }
            level.residual[rows].iter_mut().for_each(|x| *x *= weight);
        }
        level.svd.decompose_warm(&level.projected);
        level.filter_residual(damped);
        for (rows, weight) in weighted {
            level.residual[rows.clone()].iter_mut().for_each(|x| *x /= weight);
            level.along[rows].iter_mut().for_each(|x| *x /= weight);
        }
        (contradicted + level.replace_residual()).sqrt()
    }

    /// Minimises a damped level, then keeps its rows alone: the inequalities that stop it hold the
    /// damped motion, and the levels after it may leave them with its rows as they are.
    pub(in crate::control) fn solve_damped(
        &mut self,
        damped: &mut DampedLevel,
        precision: Precision,
        stops: impl FnMut((usize, f64)),
    ) {
        let DampedLevel { level, damping, is_curved, stacked, .. } = damped;
        level.scale = level.rows.frobenius_norm();
        let objective = if *is_curved {
            stacked.scale = stacked.rows.frobenius_norm();
            stacked
        } else {
            &mut *level
        };
        self.minimise(Objective::Damped(objective, *damping), precision);
        self.stopping().for_each(stops);
        self.keep_rows(level);
    }

    /// Keeps the rows of a minimised level, and the inequalities that stop it, for the next levels.
    pub(in crate::control) fn keep(&mut self, level: &mut Level, precision: Precision) {
        let least = self.load_gradient(&mut Objective::Rows(level), precision);
        // Strong rows first: they hold for good.
        let mut strong = 0;
        for k in 0..self.working.len() {
            let row = self.working[k].row;
            if self.multipliers[k] * self.inequalities.length(row) > least {
                self.working.swap(strong, k);
                self.multipliers.swap(strong, k);
                strong += 1;
            }
        }
        self.rebuild(0);
        let strong = strong.min(self.working.len());
        for w in &self.working[..strong] {
            self.uses[w.row] = Use::Fixed;
            self.last[w.row] = w.sign;
        }
        self.fixed += strong;
        self.working.drain(..strong);
        self.keep_rows(level);
    }

    /// True if a row is held for the next levels.
    #[cfg(any(test, fuzzing))]
    pub(in crate::control::solver) fn holds(&self, row: usize) -> bool {
        self.uses[row] == Use::Fixed
    }

    /// Notes the point, the working rows and the uses of all rows.
    pub(in crate::control::solver) fn hold(&mut self) {
        self.before.copy_from_slice(&self.y);
        self.held.clear();
        self.held.extend_from_slice(&self.working);
        self.held_uses.copy_from_slice(&self.uses);
    }

    /// Returns to what [`ActiveSet::hold`] noted in the same level.
    pub(in crate::control::solver) fn restore(&mut self) {
        self.y.copy_from_slice(&self.before);
        self.uses.copy_from_slice(&self.held_uses);
        self.working.clear();
        self.working.extend_from_slice(&self.held);
        self.multipliers[..self.working.len()].fill(0.0);
        self.rebuild(0);
    }

    /// Keeps the rows of a level, the largest remainder first where they are not clearly independent.
    fn keep_rows(&mut self, level: &mut Level) {
        // Rows of zeros at the end are none.
        let m = (0..level.rows.rows()).rev().find(|&i| level.rows.row_norm(i) > 0.0);
        let m = m.map_or(0, |last| last + 1);
        // Twice: orthogonal to a rounding, for levels with larger motions than their own.
        if self.load_rows(level, self.fixed, m, 0.0)
            && self.basis.orthonormalise(self.fixed, m, DEPENDENT, &mut level.lower)
        {
            self.fixed += m;
            self.rebuild(0);
            return;
        }
        level.project(&self.basis, self.fixed);
        let scale = level.scale;
        for _ in 0..level.rows.rows() {
            if self.fixed == self.y.len() {
                break;
            }
            let largest = (0..level.rows.rows())
                .map(|i| (level.projected.row_norm(i), i))
                .max_by(|a, b| a.0.total_cmp(&b.0));
            let Some((length, i)) = largest.filter(|(length, _)| *length > DEPENDENT * scale)
            else {
                break;
            };
            for (j, x) in self.normal.iter_mut().enumerate() {
                *x = level.projected[(i, j)] / length;
            }
            self.basis.project_out(self.fixed, &mut self.normal);
            let length = norm(&self.normal);
            if length < 0.5 {
                break; // rounding alone
            }
            self.normal.iter_mut().for_each(|x| *x /= length);
            self.basis.column_mut(self.fixed).copy_from_slice(&self.normal);
            self.fixed += 1;
            level.remove_direction(&self.normal);
        }
        self.rebuild(0);
    }
}

impl Level {
    /// `along` becomes the residual on the motions of the decomposed rows, each by its share.
    fn filter_residual(&mut self, share: impl Fn(f64, &[f64]) -> f64) {
        self.along.fill(0.0);
        for i in 0..self.svd.len() {
            let u = self.svd.u(i);
            let part = share(self.svd.value(i), u) * dot(u, &self.residual);
            self.along.iter_mut().zip(u).for_each(|(a, u)| *a += part * u);
        }
    }

    /// Replaces the residual in the target by `along`; returns the square of the difference.
    fn replace_residual(&mut self) -> f64 {
        let parts = self.target.iter_mut().zip(&self.residual).zip(&self.along);
        let change = |((b, r), a): ((&mut f64, &f64), &f64)| {
            *b += a - r;
            (r - a) * (r - a)
        };
        parts.map(change).sum()
    }

    fn filter_target(&mut self, share: impl Fn(f64, &[f64]) -> f64) -> f64 {
        self.filter_residual(share);
        self.replace_residual()
    }
}
