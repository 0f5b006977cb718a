//! The feasible point nearest to a guess, by the dual method: rows are added as they are violated.
//!
//! Formula  min |y - g|^2 with l <= G y <= u
//! Fails    says so where no point satisfies all rows
//! Source   Goldfarb & Idnani 1983
//! Checked  src/control/solver/hierarchy/tests.rs::the_start_is_the_nearest_feasible_point

use super::{ActiveSet, DEPENDENT, ROUNDS, Use, solve_triangle};
use crate::linalg::dot;

impl ActiveSet {
    /// The row that is violated most.
    pub(super) fn worst(&self) -> Option<(usize, f64, f64)> {
        let mut worst: Option<(usize, f64, f64)> = None;
        for i in 0..self.inequalities.len() {
            let (excess, sign) = self.inequalities.excess(i, self.inequalities.value(i, &self.y));
            let bound = self.inequalities.bound(i, sign);
            let length = self.inequalities.length(i).max(f64::MIN_POSITIVE);
            let share = excess / length;
            if excess > self.slack(i, bound) && worst.is_none_or(|w| share > w.1) {
                worst = Some((i, share, sign));
            }
        }
        worst
    }

    /// The point nearest to `guess` by the dual method: rows are added as they are violated.
    pub(super) fn project(&mut self, guess: &[f64]) -> bool {
        // Fixed unknowns keep their values; the others start from the guess.
        for (i, x) in guess.iter().enumerate() {
            if i >= self.inequalities.boxed() || self.uses[i] == Use::Free {
                self.y[i] = *x;
            }
        }
        let most = ROUNDS * 4 * (self.y.len() + self.inequalities.len());
        let mut rounds = 0;
        while let Some((row, _, sign)) = self.worst() {
            if self.inequalities.is_empty(row) {
                return false;
            }
            let mut own = 0.0;
            loop {
                rounds += 1;
                if rounds > most {
                    return false;
                }
                self.inequalities.write(row, sign, &mut self.normal);
                let length = self.inequalities.length(row);
                self.load_multipliers_of_normal();
                self.direction.copy_from_slice(&self.normal);
                let columns = self.fixed + self.working.len();
                self.basis.project_out(columns, &mut self.direction);
                self.basis.project_out(columns, &mut self.direction);
                let outside = dot(&self.direction, &self.direction);
                let excess = sign * self.inequalities.value(row, &self.y)
                    - sign * self.inequalities.bound(row, sign);
                let full = if outside.sqrt() > DEPENDENT * length && columns < self.y.len() {
                    excess.max(0.0) / outside
                } else {
                    f64::INFINITY
                };
                let mut first = (f64::INFINITY, None);
                for (k, w) in self.working.iter().enumerate() {
                    let rate = self.gradient[k];
                    if rate > DEPENDENT && !self.inequalities.is_equality(w.row) {
                        let t = self.multipliers[k] / rate;
                        if t < first.0 {
                            first = (t, Some(k));
                        }
                    }
                }
                let t = full.min(first.0);
                if t == f64::INFINITY {
                    return false;
                }
                own += t;
                for k in 0..self.working.len() {
                    self.multipliers[k] -= t * self.gradient[k];
                }
                if full < f64::INFINITY {
                    self.y.iter_mut().zip(&self.direction).for_each(|(y, d)| *y -= t * d);
                }
                if full <= first.0 {
                    if self.add(row, sign) {
                        let last = self.working.len() - 1;
                        self.multipliers[last] = own;
                    }
                    break;
                }
                let Some(k) = first.1 else { break };
                self.remove(k);
            }
        }
        true
    }

    /// The coefficients of `normal` in the working rows, into `gradient`.
    pub(super) fn load_multipliers_of_normal(&mut self) {
        for k in 0..self.working.len() {
            self.gradient[k] = dot(self.basis.column(self.fixed + k), &self.normal);
        }
        let w = self.working.len();
        solve_triangle(&self.triangle, w, &mut self.gradient);
    }
}
