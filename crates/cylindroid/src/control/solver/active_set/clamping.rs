//! Scaling with the least motion: joints at their bounds are clamped one by one.
//!
//! Formula  y(s) = particular + s direction, the particular solution with the clamped rows at their
//!          bounds and A y = 0; the largest s in [0, 1] within all rows
//! Source   Flacco, De Luca & Khatib 2015, algorithm 1, for rows in place of joints
//! Checked  src/control/solver/saturation/tests.rs, tests/it/servo/limits.rs::saturation_*

use super::{ActiveSet, Level, Precision, STILL, Use, Working};
use crate::linalg::norm;

impl ActiveSet {
    /// The largest scale of a level along its target with the least motion: rows that a motion of
    /// full scale would leave are clamped one by one while the others can perform the task. `None`
    /// if no scale above zero was found; otherwise the scale, and the row that stops it with the sign
    /// of its bound. The point is then [`ActiveSet::point`].
    ///
    /// Of the largest scales that exist it finds those near the unbounded motion: greater ones use
    /// self-motions that later bounds no longer permit.
    pub(in crate::control) fn clamp_one_by_one(
        &mut self,
        level: &mut Level,
        precision: Precision,
    ) -> Option<(f64, Option<(usize, f64)>)> {
        self.forget();
        level.scale = level.rows.frobenius_norm();
        let mut best: Option<(f64, Option<(usize, f64)>)> = None;
        let mut possible = 0;
        for round in 0..self.y.len() {
            let (columns, m) = (self.working.len(), level.rows.rows());
            if columns + possible > self.y.len() {
                break; // the rest can no longer do the task
            }
            let is_clear = self.load_rows(level, columns, m, precision.rank);
            let rank = if is_clear {
                m
            } else {
                level.project(&self.basis, columns);
                level.load_gains(precision.rank)
            };
            if round == 0 {
                possible = rank;
            } else if rank < possible {
                break;
            }
            // y(s) = particular + s direction
            self.load_clamped();
            level.residual.fill(0.0);
            level.rows.mul_vec_into(&self.normal, &mut level.residual);
            level.residual.iter_mut().for_each(|r| *r = -*r);
            if is_clear {
                level.along.copy_from_slice(&level.residual);
                level.add_least_motion(&self.basis, columns, m, &mut self.normal);
                level.along.copy_from_slice(&level.target);
                self.direction.fill(0.0);
                level.add_least_motion(&self.basis, columns, m, &mut self.direction);
            } else {
                level.svd.apply_gains_into(&level.residual, &level.gains, &mut self.gradient);
                self.normal.iter_mut().zip(&self.gradient).for_each(|(p, g)| *p += g);
                level.svd.apply_gains_into(&level.target, &level.gains, &mut self.direction);
            }
            let size = norm(&self.direction);
            let (mut least, mut most) = (0.0_f64, (1.0, None));
            let mut worst: Option<(f64, usize, f64)> = None;
            for i in (0..self.inequalities.len()).filter(|&i| self.uses[i] == Use::Free) {
                let a = self.inequalities.value(i, &self.normal);
                let b = self.inequalities.value(i, &self.direction);
                let (lower, upper) = (self.inequalities.lower[i], self.inequalities.upper[i]);
                let (excess, sign) = self.inequalities.excess(i, a + b);
                if excess > worst.map_or(0.0, |w| w.0) {
                    worst = Some((excess, i, sign));
                }
                if b.abs() <= STILL * self.inequalities.length(i) * size {
                    let bound = self.inequalities.bound(i, self.inequalities.excess(i, a).1);
                    if self.inequalities.excess(i, a).0 > self.slack(i, bound) {
                        least = f64::INFINITY;
                    }
                    continue;
                }
                let (l, u) = ((lower - a) / b, (upper - a) / b);
                least = least.max(l.min(u));
                if l.max(u) < most.0 {
                    most = (l.max(u), Some((i, 1_f64.copysign(b))));
                }
            }
            if least <= most.0 && most.0 > best.map_or(0.0, |b| b.0) {
                best = Some(most);
                let parts = self.y.iter_mut().zip(&self.normal).zip(&self.direction);
                parts.for_each(|((y, p), d)| *y = p + most.0 * d);
            }
            if best.is_some_and(|b| b.0 >= 1.0) {
                break;
            }
            let Some((_, row, sign)) = worst else { break };
            if !self.add(row, sign) {
                break;
            }
        }
        best
    }

    /// The least point with the working rows at their bounds, into `normal`.
    fn load_clamped(&mut self) {
        let w = self.working.len();
        for k in 0..w {
            let Working { row, sign } = self.working[k];
            let mut rest = sign * self.inequalities.bound(row, sign);
            for l in 0..k {
                rest -= self.triangle[(l, k)] * self.gradient[l];
            }
            self.gradient[k] = rest / self.triangle[(k, k)];
        }
        self.normal.fill(0.0);
        for k in 0..w {
            let column = self.basis.column(k);
            self.normal.iter_mut().zip(column).for_each(|(n, q)| *n += self.gradient[k] * q);
        }
    }
}
