//! Steps of least squares up to the first row in the way, and the release of rows.
//!
//! Formula  A^T (b - A y) = F^T m + G_W^T l, l >= 0 at the solution. With G_W^T = Q T on the motions
//!          outside F, an error of size d in the left side changes l_k by up to |e_k^T T^-1| d:
//!          multipliers up to that are zero, since nearly dependent rows share large ones of rounding.
//!          The part of the left side on the free motions is such an error too: rounding, and what is
//!          left along weak directions, which take no part in steps; no row is needed for it
//! Valid    where the working rows leave free motions: at a corner nothing is left on them, and a row that
//!          a weak direction needs is held. A level that ends after the most rounds keeps more rows. Rows
//!          that depend on higher levels but for `DEPENDENT` stop long motions short of the optimum
//! Source   Nocedal & Wright, Numerical Optimization, 2006, 16.5
//! Checked  src/control/solver/hierarchy/tests.rs::levels_are_the_optima_of_clarabel,
//!          src/control/solver/hierarchy/findings.rs::findings_stay_mended,
//!          src/control/solver/hierarchy/findings.rs::weak_directions_hold_no_bounds,
//!          src/control/solver/hierarchy/findings.rs::dependent_rows_keep_their_bounds

use super::{
    ActiveSet, BEYOND, DEPENDENT, Objective, Precision, ROUNDING, ROUNDS, STILL, Use,
    solve_triangle,
};
use crate::linalg::{dot, norm};

impl ActiveSet {
    /// Minimises the objective on the motions that the levels before leave free.
    pub(in crate::control) fn minimise(
        &mut self,
        mut objective: Objective<'_>,
        precision: Precision,
    ) {
        let most = ROUNDS * (self.y.len() + self.inequalities.len()) + 10;
        let mut standing = 0;
        // Columns of the basis that are projected out of the rows.
        let mut projected = 0;
        for _ in 0..most {
            #[cfg(test)]
            {
                self.rounds += 1;
            }
            self.load_direction(&mut objective, precision, &mut projected);
            let mut blocked = self.advance();
            if let Some((share, ..)) = blocked {
                standing = if share > 0.0 { 0 } else { standing + 1 };
            }
            // At rounds without progress the first row is as good as the most promising one.
            let cautious = standing > self.y.len();
            if let Some((_, row, sign)) = blocked
                && self.uses[row] == Use::Dependent
            {
                projected = 0;
                if !cautious && self.exchange(row, sign) {
                    continue;
                }
                blocked = None;
            }
            let Some((_, row, sign)) = blocked else {
                let least = self.load_gradient(&mut objective, precision);
                if !self.release(least, cautious) {
                    break;
                }
                projected = 0;
                continue;
            };
            if !self.add(row, sign) {
                self.uses[row] = Use::Dependent;
            }
        }
    }

    /// The step to the minimum on the free motions.
    fn load_direction(
        &mut self,
        objective: &mut Objective<'_>,
        precision: Precision,
        projected: &mut usize,
    ) {
        let columns = self.fixed + self.working.len();
        match objective {
            Objective::Nearest(desired) => {
                for ((d, goal), y) in self.direction.iter_mut().zip(*desired).zip(&self.y) {
                    *d = goal - y;
                }
                self.basis.project_out(columns, &mut self.direction);
                self.basis.project_out(columns, &mut self.direction);
            }
            Objective::Rows(level) => {
                let scale = level.scale;
                level.load_residual(&self.y);
                self.direction.fill(0.0);
                if columns == self.y.len() || scale == 0.0 {
                    return;
                }
                let m = level.rows.rows();
                if self.load_rows(level, columns, m, precision.rank) {
                    level.along.copy_from_slice(&level.residual);
                    level.add_least_motion(&self.basis, columns, m, &mut self.direction);
                    // Rows that depend on the columns before leave a part along them.
                    self.basis.project_out(columns, &mut self.direction);
                    return;
                }
                level.project_on(&self.basis, *projected..columns);
                *projected = columns;
                if !level.least_squares(precision.rank, &mut self.direction) {
                    level.load_gains(precision.rank);
                    level.svd.apply_gains_into(&level.residual, &level.gains, &mut self.direction);
                }
                self.basis.project_out(columns, &mut self.direction);
            }
            Objective::Damped(level, damping) => {
                // y = y_w + z, y_w in the span of the basis, P the rows on the free motions:
                // z = P^T (P P^T + d)^-1 (b - A y_w)
                self.normal.copy_from_slice(&self.y);
                self.basis.project_out(columns, &mut self.normal);
                self.basis.project_out(columns, &mut self.normal);
                self.direction.fill(0.0);
                if columns < self.y.len() {
                    level.load_residual(&self.y);
                    level.rows.mul_vec_into(&self.normal, &mut level.along);
                    level.residual.iter_mut().zip(&level.along).for_each(|(r, a)| *r += a);
                    level.project_on(&self.basis, *projected..columns);
                    *projected = columns;
                    level.damped_least_squares(*damping, &mut self.direction);
                    self.basis.project_out(columns, &mut self.direction);
                }
                self.direction.iter_mut().zip(&self.normal).for_each(|(d, z)| *d -= z);
            }
        }
    }

    /// Moves along the direction to its end or to the first row in the way: the share of the
    /// motion, that row and the sign of its bound. Rows that depend on others but for
    /// `DEPENDENT` still move with long motions: they are in the way once beyond their bounds.
    pub(super) fn advance(&mut self) -> Option<(f64, usize, f64)> {
        let size = norm(&self.direction);
        let mut first: Option<(f64, usize, f64)> = None;
        for i in 0..self.inequalities.len() {
            let is_free = self.uses[i] == Use::Free;
            if !is_free && self.uses[i] != Use::Dependent {
                continue;
            }
            let rate = self.inequalities.value(i, &self.direction);
            if rate.abs() <= STILL * self.inequalities.length(i) * size {
                continue;
            }
            let sign = 1_f64.copysign(rate);
            let bound = self.inequalities.bound(i, sign);
            if bound.is_infinite() {
                continue;
            }
            let slack = if is_free { 0.0 } else { sign * BEYOND * self.slack(i, bound) };
            let room = (bound + slack - self.inequalities.value(i, &self.y)) / rate;
            if room < first.map_or(1.0, |f| f.0) {
                first = Some((room.max(0.0), i, sign));
            }
        }
        let share = first.map_or(1.0, |f| f.0);
        self.y.iter_mut().zip(&self.direction).for_each(|(y, d)| *y += share * d);
        if let Some((_, row, sign)) = first
            && row < self.inequalities.boxed()
            && self.uses[row] == Use::Free
        {
            self.y[row] = self.inequalities.bound(row, sign);
        }
        first
    }

    /// Takes a row in the way that depends on others into the place of the working one of which it has the
    /// largest share: that one leaves its bound inwards while the row stays. False, without a change, if
    /// it has a share of none that may leave: of higher levels, equal bounds and opposed rows alone.
    fn exchange(&mut self, row: usize, sign: f64) -> bool {
        self.inequalities.write(row, sign, &mut self.normal);
        self.load_multipliers_of_normal();
        let least = DEPENDENT * self.inequalities.length(row);
        let mut largest: (f64, Option<usize>) = (least, None);
        for (k, w) in self.working.iter().enumerate() {
            let share = self.gradient[k] * self.inequalities.length(w.row);
            if share > largest.0 && !self.inequalities.is_equality(w.row) {
                largest = (share, Some(k));
            }
        }
        let Some(k) = largest.1 else { return false };
        let out = self.working[k];
        self.remove(k);
        if self.add(row, sign) {
            self.free_dependents();
            return true;
        }
        self.add(out.row, out.sign);
        false
    }

    /// The gradient of the objective, and the multipliers of the working rows; returns the
    /// multiplier below which one counts as zero.
    pub(super) fn load_gradient(
        &mut self,
        objective: &mut Objective<'_>,
        precision: Precision,
    ) -> f64 {
        let moved = norm(&self.y);
        let (size, rounding) = match objective {
            Objective::Nearest(desired) => {
                for ((g, goal), y) in self.gradient.iter_mut().zip(*desired).zip(&self.y) {
                    *g = goal - y;
                }
                (norm(&self.gradient), ROUNDING * (norm(desired) + moved))
            }
            Objective::Rows(level) | Objective::Damped(level, _) => {
                level.load_residual(&self.y);
                level.rows.tr_mul_vec_into(&level.residual, &mut self.gradient);
                let reached = norm(&level.target) + level.scale * moved;
                (level.scale * norm(&level.residual), level.scale * ROUNDING * reached)
            }
        };
        if let Objective::Damped(_, damping) = objective {
            self.gradient.iter_mut().zip(&self.y).for_each(|(g, y)| *g -= *damping * y);
        }
        let w = self.working.len();
        for k in 0..w {
            self.multipliers[k] = dot(self.basis.column(self.fixed + k), &self.gradient);
        }
        solve_triangle(&self.triangle, w, &mut self.multipliers);
        let least = precision.release * size + rounding;
        let mut error = None;
        for k in 0..w {
            let multiplier = self.multipliers[k].abs();
            if multiplier * self.inequalities.length(self.working[k].row) > least {
                let error = *error.get_or_insert_with(|| rounding + self.free_gradient());
                if multiplier <= error * self.amplification(k) {
                    self.multipliers[k] = 0.0;
                }
            }
        }
        self.least = least;
        least
    }

    /// The size of the gradient on the motions that the basis leaves; overwrites `direction`.
    fn free_gradient(&mut self) -> f64 {
        self.direction.copy_from_slice(&self.gradient);
        self.basis.project_out(self.fixed + self.working.len(), &mut self.direction);
        norm(&self.direction)
    }

    /// The norm of the k-th row of the inverse of the triangle, by which errors of a gradient grow in
    /// the multiplier of the k-th working row; overwrites `normal`.
    fn amplification(&mut self, k: usize) -> f64 {
        let (w, mut sum) = (self.working.len(), 0.0);
        for j in k..w {
            let before: f64 = (k..j).map(|i| self.normal[i] * self.triangle[(i, j)]).sum();
            let unit = if j == k { 1.0 } else { 0.0 };
            self.normal[j] = (unit - before) / self.triangle[(j, j)];
            sum += self.normal[j] * self.normal[j];
        }
        sum.sqrt()
    }

    /// Releases the working row with the most negative multiplier; false if none is below `-least`.
    pub(super) fn release(&mut self, least: f64, cautious: bool) -> bool {
        let mut best: Option<(f64, usize)> = None;
        for (k, w) in self.working.iter().enumerate() {
            let pull = -self.multipliers[k] * self.inequalities.length(w.row);
            let better = match best {
                None => true,
                Some((_, b)) if cautious => w.row < self.working[b].row,
                Some((most, _)) => pull > most,
            };
            if pull > least && !self.inequalities.is_equality(w.row) && better {
                best = Some((pull, k));
            }
        }
        let Some((_, k)) = best else { return false };
        self.remove(k);
        self.free_dependents();
        true
    }

    /// After a working row has left, others may no longer depend on those that stay.
    fn free_dependents(&mut self) {
        for use_of_row in &mut self.uses {
            if *use_of_row == Use::Dependent {
                *use_of_row = Use::Free;
            }
        }
    }
}
