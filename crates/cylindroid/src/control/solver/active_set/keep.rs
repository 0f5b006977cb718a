//! Levels after a level: its rows are kept, with the inequalities that stop it.
//!
//! Source   Escande, Mansard & Wieber 2014
//! Checked  src/control/solver/hierarchy/tests.rs::levels_are_the_optima_of_clarabel

use super::{ActiveSet, DEPENDENT, Level, Objective, Precision, Use};
use crate::linalg::{dot, norm};

impl ActiveSet {
    /// Reduces the target of a level to the motions that the levels before leave it, without
    /// directions whose singular values are below `eps` of the norm of its rows: what remains can be
    /// scaled. Returns the size of the part left out.
    pub(in crate::control) fn reduce_target(&mut self, level: &mut Level, eps: f64) -> f64 {
        level.scale = level.rows.frobenius_norm();
        level.load_residual(&self.y);
        level.project(&self.basis, self.fixed);
        level.svd.decompose_warm(&level.projected);
        level.along.fill(0.0);
        for i in 0..level.svd.len() {
            if level.svd.value(i) > eps * level.scale {
                let u = level.svd.u(i);
                let share = dot(u, &level.residual);
                level.along.iter_mut().zip(u).for_each(|(a, u)| *a += share * u);
            }
        }
        let mut left_out = 0.0;
        let parts = level.target.iter_mut().zip(&level.residual).zip(&level.along);
        for ((b, r), a) in parts {
            left_out += (r - a) * (r - a);
            *b += a - r;
        }
        f64::sqrt(left_out)
    }

    /// Minimises a damped level, then keeps its rows.
    pub(in crate::control) fn solve_damped(
        &mut self,
        level: &mut Level,
        damping: f64,
        precision: Precision,
        stops: impl FnMut((usize, f64)),
    ) {
        level.scale = level.rows.frobenius_norm();
        self.minimise(Objective::Damped(level, damping), precision);
        self.stopping().for_each(stops);
        self.keep(level, precision);
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
        // Then the rows of the level, the largest remainder first.
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
