//! Active-set method: one least-squares problem after another within linear inequalities, each on
//! the motions that the ones before leave free.
//!
//! Formula  min |A y - b|^2 with l <= G y <= u and F y as it is, F the rows of higher levels. Steps
//!          of the least-squares solution on ker [F; G_W], W the working rows at their bounds, up to
//!          the first row that blocks; a working row is released if its multiplier is negative:
//!          A^T (b - A y) = F^T m + G_W^T l, l >= 0 at the solution
//! Shapes   A: m x n, G: r x n
//! Valid    any rank of A, F and G, infinite and equal bounds. `start` finds the point of the
//!          polyhedron nearest to a guess, or says that there is none
//! Cost     at most `ROUNDS` (n + r) rounds of one m x n decomposition; one to three in a control
//!          loop, where the rows of the last step come first. No allocation
//! Why so   inequalities stand above all levels, so that each level starts from a feasible point:
//!          a limit is never traded against a task, and stopping early is safe
//! Source   Nocedal & Wright, Numerical Optimization, 2006, 16.5; Goldfarb & Idnani 1983 (start);
//!          Escande, Mansard & Wieber 2014 (rows with positive multipliers stay for lower levels)
//! Checked  tests of `hierarchy.rs` (against Clarabel)

use super::inequalities::Inequalities;
use crate::linalg::{Matrix, Svd, dot, norm};

/// Most rounds for each unknown and row [-]; then the feasible point reached counts.
const ROUNDS: usize = 4;

/// A row whose part outside others is smaller than this share of it depends on them [-].
const DEPENDENT: f64 = 1e-10;

/// Rounding of a multiplier, relative to the terms that it is the difference of [-].
const ROUNDING: f64 = 1e-13;

/// Rates of rows below this share of the largest possible one are roundings of zero [-].
const STILL: f64 = 1e-13;

/// Values of rows beyond their bounds by less than this, relative to one plus the bound, are within
/// them [-].
pub(in crate::control) const FEASIBLE: f64 = 1e-11;

/// Which decisions of a level count as zero, relative to its size.
#[derive(Debug, Clone, Copy)]
pub(in crate::control) struct Precision {
    /// Singular values of the rows below this share of their norm take no part in steps.
    pub(in crate::control) rank: f64,
    /// Multipliers below this share of the possible release no row and hold none.
    pub(in crate::control) release: f64,
}

impl Precision {
    /// Up to rounding.
    #[cfg(test)]
    pub(in crate::control) const EXACT: Self = Self { rank: 1e-11, release: 1e-11 };
}

/// The rows of a level, their targets and the memory to solve it.
#[derive(Debug, Clone)]
pub(in crate::control) struct Level {
    /// A, m x n.
    pub(in crate::control) rows: Matrix,
    /// b
    pub(in crate::control) target: Vec<f64>,
    /// Norm of the rows, or of those that they are a part of: what is small beside it is rounding.
    pub(super) scale: f64,
    /// A on the free motions.
    projected: Matrix,
    svd: Svd,
    residual: Vec<f64>,
    /// Of the rows along a direction.
    along: Vec<f64>,
    gains: Vec<f64>,
}

impl Level {
    pub(in crate::control) fn new(m: usize, n: usize) -> Self {
        Self {
            rows: Matrix::zeros(m, n),
            target: vec![0.0; m],
            scale: 0.0,
            projected: Matrix::zeros(m, n),
            svd: Svd::workspace(m, n),
            residual: vec![0.0; m],
            along: vec![0.0; m],
            gains: vec![0.0; m.min(n)],
        }
    }
}

/// The objective of a level.
#[derive(Debug)]
pub(in crate::control) enum Objective<'a> {
    /// min |A y - b|^2
    Rows(&'a mut Level),
    /// min |y - desired|^2
    Nearest(&'a [f64]),
}

/// A row at a bound.
#[derive(Debug, Clone, Copy)]
struct Working {
    row: usize,
    /// 1 at the upper bound, -1 at the lower one.
    sign: f64,
}

/// Use of a row in the present problem.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Use {
    Free,
    Working,
    /// Held by a higher level.
    Fixed,
    /// Constant while the working rows are.
    Dependent,
}

/// The inequalities, the present point and the rows at their bounds.
#[derive(Debug, Clone)]
pub(in crate::control) struct ActiveSet {
    pub(in crate::control) inequalities: Inequalities,
    y: Vec<f64>,
    /// Orthonormal: of the rows of higher levels first, then of the working rows.
    basis: Matrix,
    fixed: usize,
    working: Vec<Working>,
    /// Working rows in the basis: a column each, upper triangular after `fixed`.
    triangle: Matrix,
    uses: Vec<Use>,
    multipliers: Vec<f64>,
    direction: Vec<f64>,
    gradient: Vec<f64>,
    normal: Vec<f64>,
    /// The sign of the bound at which each row stood in the last solution; 0 if at none.
    last: Vec<f64>,
    rounds: usize,
}

impl ActiveSet {
    /// Memory for the unknowns of these inequalities.
    pub(in crate::control) fn new(n: usize, inequalities: Inequalities) -> Self {
        let r = inequalities.len();
        Self {
            inequalities,
            y: vec![0.0; n],
            basis: Matrix::zeros(n, n),
            fixed: 0,
            working: Vec::with_capacity(n),
            triangle: Matrix::zeros(n, n),
            uses: vec![Use::Free; r],
            multipliers: vec![0.0; n],
            direction: vec![0.0; n],
            gradient: vec![0.0; n],
            normal: vec![0.0; n],
            last: vec![0.0; r],
            rounds: 0,
        }
    }

    /// The present point: feasible after [`ActiveSet::start`] returned true.
    pub(in crate::control) fn point(&self) -> &[f64] {
        &self.y
    }

    /// Rounds since the start.
    #[cfg(test)]
    pub(in crate::control) fn rounds(&self) -> usize {
        self.rounds
    }

    /// The rows that stop the last minimised level, with the signs of their bounds.
    pub(super) fn stopping(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let all = self.working.iter().zip(&self.multipliers);
        all.filter(|(_, multiplier)| **multiplier > 0.0).map(|(w, _)| (w.row, w.sign))
    }

    /// Goes to the feasible point nearest to `guess` and forgets all levels; false if there is
    /// none. Rows of the last solution that bound the guess come first.
    pub(in crate::control) fn start(&mut self, guess: &[f64]) -> bool {
        self.y.copy_from_slice(guess);
        self.forget();
        for i in 0..self.inequalities.boxed() {
            let value = self.y[i];
            let (excess, sign) = self.inequalities.excess(i, value);
            if excess > 0.0 {
                self.y[i] = self.inequalities.bound(i, sign);
            }
            if self.inequalities.is_equality(i) {
                self.y[i] = self.inequalities.lower[i];
                self.inequalities.write(i, 1.0, &mut self.normal);
                if self.append(self.fixed, None) {
                    self.fixed += 1;
                }
                self.uses[i] = Use::Fixed;
            }
        }
        (self.worst().is_none() || self.project(guess)) && {
            // Equal bounds hold from the start; then the rows of the last solution.
            for i in self.inequalities.boxed()..self.inequalities.len() {
                if self.inequalities.is_equality(i) && self.uses[i] == Use::Free {
                    self.add(i, 1.0);
                }
            }
            for i in 0..self.inequalities.len() {
                let sign = self.last[i];
                let bound = self.inequalities.bound(i, sign);
                if sign != 0.0
                    && self.uses[i] == Use::Free
                    && (self.inequalities.value(i, &self.y) - bound).abs()
                        <= FEASIBLE * (1.0 + bound.abs())
                {
                    self.add(i, sign);
                }
            }
            true
        }
    }

    fn forget(&mut self) {
        self.working.iter().for_each(|w| self.last[w.row] = w.sign);
        for (last, use_of_row) in self.last.iter_mut().zip(&self.uses) {
            if matches!(use_of_row, Use::Free | Use::Dependent) {
                *last = 0.0;
            }
        }
        self.fixed = 0;
        self.rounds = 0;
        self.working.clear();
        self.uses.fill(Use::Free);
    }

    /// The row that is violated most.
    fn worst(&self) -> Option<(usize, f64, f64)> {
        let mut worst: Option<(usize, f64, f64)> = None;
        for i in 0..self.inequalities.len() {
            let (excess, sign) = self.inequalities.excess(i, self.inequalities.value(i, &self.y));
            let bound = self.inequalities.bound(i, sign);
            let excess = excess / self.inequalities.length(i).max(f64::MIN_POSITIVE);
            let slack = FEASIBLE * (1.0 + bound.abs());
            if excess > slack && worst.is_none_or(|w| excess > w.1) {
                worst = Some((i, excess, sign));
            }
        }
        worst
    }

    /// The point nearest to `guess` by the dual method: rows are added as they are violated.
    fn project(&mut self, guess: &[f64]) -> bool {
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
                project_out(&self.basis, columns, &mut self.direction);
                project_out(&self.basis, columns, &mut self.direction);
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
    fn load_multipliers_of_normal(&mut self) {
        for k in 0..self.working.len() {
            self.gradient[k] = dot(self.basis.column(self.fixed + k), &self.normal);
        }
        let w = self.working.len();
        solve_triangle(&self.triangle, w, &mut self.gradient);
    }

    /// Adds `normal` to the basis at `place`, and its coefficients after `fixed` to the triangle;
    /// false if it depends on the others.
    fn append(&mut self, place: usize, column: Option<usize>) -> bool {
        if place >= self.y.len() {
            return false;
        }
        let length = norm(&self.normal);
        self.direction.copy_from_slice(&self.normal);
        project_out(&self.basis, place, &mut self.direction);
        let once = norm(&self.direction);
        if !(once > DEPENDENT * length) {
            return false;
        }
        project_out(&self.basis, place, &mut self.direction);
        let size = norm(&self.direction);
        if !(size > 0.5 * DEPENDENT * length) {
            return false;
        }
        self.direction.iter_mut().for_each(|x| *x /= size);
        self.basis.column_mut(place).copy_from_slice(&self.direction);
        if let Some(column) = column {
            for k in 0..=column {
                self.triangle[(k, column)] = dot(self.basis.column(self.fixed + k), &self.normal);
            }
        }
        true
    }

    /// Adds a row to the working ones; false if it depends on them.
    fn add(&mut self, row: usize, sign: f64) -> bool {
        self.inequalities.write(row, sign, &mut self.normal);
        let column = self.working.len();
        if !self.append(self.fixed + column, Some(column)) {
            return false;
        }
        self.multipliers[column] = 0.0;
        self.working.push(Working { row, sign });
        self.uses[row] = Use::Working;
        true
    }

    /// Removes the working row at `place`; the later ones stay with their multipliers.
    fn remove(&mut self, place: usize) {
        let row = self.working[place].row;
        self.uses[row] = Use::Free;
        self.working.remove(place);
        for k in place..self.working.len() {
            self.multipliers[k] = self.multipliers[k + 1];
        }
        self.rebuild(place);
    }

    /// Computes basis and triangle again from the working row at `place` on.
    fn rebuild(&mut self, place: usize) {
        let mut k = place;
        while k < self.working.len() {
            let Working { row, sign } = self.working[k];
            self.inequalities.write(row, sign, &mut self.normal);
            if self.append(self.fixed + k, Some(k)) {
                k += 1;
            } else {
                self.uses[row] = Use::Free;
                self.working.remove(k);
                for l in k..self.working.len() {
                    self.multipliers[l] = self.multipliers[l + 1];
                }
            }
        }
    }

    /// Minimises the objective on the motions that the levels before leave free.
    pub(in crate::control) fn minimise(
        &mut self,
        mut objective: Objective<'_>,
        precision: Precision,
    ) {
        let most = ROUNDS * (self.y.len() + self.inequalities.len()) + 10;
        let mut standing = 0;
        for _ in 0..most {
            self.rounds += 1;
            self.load_direction(&mut objective, precision);
            let blocked = self.advance();
            let Some((share, row, sign)) = blocked else {
                let least = self.load_gradient(&mut objective, precision);
                // At rounds without progress the first row is as good as the most promising one.
                let cautious = standing > self.y.len();
                if !self.release(least, cautious) {
                    break;
                }
                continue;
            };
            standing = if share > 0.0 { 0 } else { standing + 1 };
            if !self.add(row, sign) {
                self.uses[row] = Use::Dependent;
            }
        }
    }

    /// The step to the minimum on the free motions.
    fn load_direction(&mut self, objective: &mut Objective<'_>, precision: Precision) {
        let columns = self.fixed + self.working.len();
        match objective {
            Objective::Nearest(desired) => {
                for ((d, goal), y) in self.direction.iter_mut().zip(*desired).zip(&self.y) {
                    *d = goal - y;
                }
                project_out(&self.basis, columns, &mut self.direction);
                project_out(&self.basis, columns, &mut self.direction);
            }
            Objective::Rows(level) => {
                let scale = level.scale;
                level.load_residual(&self.y);
                self.direction.fill(0.0);
                if columns == self.y.len() || scale == 0.0 {
                    return;
                }
                level.project(&self.basis, columns);
                level.svd.decompose(&level.projected);
                for (gain, s) in level.gains.iter_mut().zip(level.svd.values()) {
                    *gain = if s > precision.rank * scale { 1.0 / s } else { 0.0 };
                }
                level.svd.apply_gains_into(&level.residual, &level.gains, &mut self.direction);
                project_out(&self.basis, columns, &mut self.direction);
            }
        }
    }

    /// Moves along the direction to its end or to the first row in the way: the share of the
    /// motion, that row and the sign of its bound.
    fn advance(&mut self) -> Option<(f64, usize, f64)> {
        let size = norm(&self.direction);
        let mut first: Option<(f64, usize, f64)> = None;
        for i in 0..self.inequalities.len() {
            if self.uses[i] != Use::Free {
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
            let room = (bound - self.inequalities.value(i, &self.y)) / rate;
            if room < first.map_or(1.0, |f| f.0) {
                first = Some((room.max(0.0), i, sign));
            }
        }
        let share = first.map_or(1.0, |f| f.0);
        self.y.iter_mut().zip(&self.direction).for_each(|(y, d)| *y += share * d);
        if let Some((_, row, sign)) = first
            && row < self.inequalities.boxed()
        {
            self.y[row] = self.inequalities.bound(row, sign);
        }
        first
    }

    /// The gradient of the objective, and the multipliers of the working rows; returns the
    /// multiplier below which one counts as zero.
    fn load_gradient(&mut self, objective: &mut Objective<'_>, precision: Precision) -> f64 {
        let moved = norm(&self.y);
        let least = match objective {
            Objective::Nearest(desired) => {
                for ((g, goal), y) in self.gradient.iter_mut().zip(*desired).zip(&self.y) {
                    *g = goal - y;
                }
                precision.release * norm(&self.gradient) + ROUNDING * (norm(desired) + moved)
            }
            Objective::Rows(level) => {
                level.load_residual(&self.y);
                level.rows.tr_mul_vec_into(&level.residual, &mut self.gradient);
                let reached = norm(&level.target) + level.scale * moved;
                let size = precision.release * norm(&level.residual) + ROUNDING * reached;
                level.scale * size
            }
        };
        let w = self.working.len();
        for k in 0..w {
            self.multipliers[k] = dot(self.basis.column(self.fixed + k), &self.gradient);
        }
        solve_triangle(&self.triangle, w, &mut self.multipliers);
        least
    }

    /// Releases the working row with the most negative multiplier; false if none is below `-least`.
    fn release(&mut self, least: f64, cautious: bool) -> bool {
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
        for use_of_row in &mut self.uses {
            if *use_of_row == Use::Dependent {
                *use_of_row = Use::Free;
            }
        }
        true
    }

    /// The largest scale of a level along its target with the least motion: rows that a motion of
    /// full scale would leave are clamped one by one while the others can perform the task. `None`
    /// if no scale above zero was found; otherwise the scale, the row that stops it with the sign of
    /// its bound, and the point.
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
            let columns = self.working.len();
            level.project(&self.basis, columns);
            level.svd.decompose(&level.projected);
            let mut rank = 0;
            for (gain, s) in level.gains.iter_mut().zip(level.svd.values()) {
                let is_kept = s > precision.rank * level.scale;
                *gain = if is_kept { 1.0 / s } else { 0.0 };
                rank += usize::from(is_kept);
            }
            if round == 0 {
                possible = rank;
            } else if rank < possible {
                break; // the rest can no longer do the task
            }
            // y(s) = particular + s direction
            self.load_clamped();
            level.residual.fill(0.0);
            level.rows.mul_vec_into(&self.normal, &mut level.residual);
            level.residual.iter_mut().for_each(|r| *r = -*r);
            level.svd.apply_gains_into(&level.residual, &level.gains, &mut self.gradient);
            self.normal.iter_mut().zip(&self.gradient).for_each(|(p, g)| *p += g);
            level.svd.apply_gains_into(&level.target, &level.gains, &mut self.direction);
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
                if b.abs() <= STILL * self.inequalities.length(i) {
                    if self.inequalities.excess(i, a).0 > FEASIBLE {
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
            project_out(&self.basis, self.fixed, &mut self.normal);
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
    /// `residual = b - A y`
    fn load_residual(&mut self, y: &[f64]) {
        self.residual.copy_from_slice(&self.target);
        for (j, y) in y.iter().enumerate() {
            for (r, a) in self.residual.iter_mut().zip(self.rows.column(j)) {
                *r -= a * y;
            }
        }
    }

    /// |A y - b| at the point of the last step.
    pub(in crate::control) fn residual(&mut self, y: &[f64]) -> f64 {
        self.load_residual(y);
        norm(&self.residual)
    }

    /// `projected = A (1 - Q Q^T)` with the first columns of Q.
    fn project(&mut self, basis: &Matrix, columns: usize) {
        self.projected.as_mut_slice().copy_from_slice(self.rows.as_slice());
        for k in 0..columns {
            self.remove_direction(basis.column(k));
        }
    }

    /// `projected (1 - v v^T)`
    fn remove_direction(&mut self, v: &[f64]) {
        self.projected.mul_vec_into(v, &mut self.along);
        for (j, v) in v.iter().enumerate() {
            if *v != 0.0 {
                for (p, r) in self.projected.column_mut(j).iter_mut().zip(&self.along) {
                    *p -= r * v;
                }
            }
        }
    }
}

/// Removes the first columns of an orthonormal basis from x.
fn project_out(basis: &Matrix, columns: usize, x: &mut [f64]) {
    for k in 0..columns {
        let column = basis.column(k);
        let along = dot(column, x);
        x.iter_mut().zip(column).for_each(|(x, b)| *x -= along * b);
    }
}

/// Solves the upper triangular system of the first `size` unknowns in place.
fn solve_triangle(triangle: &Matrix, size: usize, x: &mut [f64]) {
    for k in (0..size).rev() {
        x[k] /= triangle[(k, k)];
        for l in 0..k {
            x[l] -= triangle[(l, k)] * x[k];
        }
    }
}
