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
//! Cost     at most `ROUNDS` (n + r) rounds of one m x n orthogonalisation, of a decomposition where
//!          ranks are not clear; one to three in a control loop, where the rows of the last step come
//!          first. No allocation
//! Why so   inequalities stand above all levels, so that each level starts from a feasible point:
//!          a limit is never traded against a task, and stopping early is safe
//! Source   Nocedal & Wright, Numerical Optimization, 2006, 16.5; Goldfarb & Idnani 1983 (start);
//!          Escande, Mansard & Wieber 2014 (rows with positive multipliers stay for lower levels)
//! Checked  src/control/solver/hierarchy/tests.rs (against Clarabel)

mod clamping;
mod damped_level;
mod feasible;
mod free;
mod keep;
mod level;
mod minimise;

use std::ops::Range;

use super::inequalities::Inequalities;
use crate::linalg::{Basis, Matrix, dot, norm};

pub(in crate::control) use damped_level::DampedLevel;
pub(in crate::control) use free::Whole;
pub(in crate::control) use level::Level;

/// Most rounds of a level for each unknown and row, four times as many for the start [-]; then the
/// feasible point reached counts.
const ROUNDS: usize = 4;

/// A row whose part outside others is smaller than this share of it depends on them [-].
pub(in crate::control::solver) const DEPENDENT: f64 = 1e-10;

/// Rounding of a multiplier, relative to the terms that it is the difference of [-].
const ROUNDING: f64 = 1e-13;

/// Rates of rows along a direction below this share of the largest possible one are roundings of
/// zero [-].
const STILL: f64 = 1e-13;

/// Descents towards a bound below this share of the largest possible one are roundings of zero [-].
const PULL: f64 = 1e-9;

/// Values of rows beyond their bounds by less than this, relative to the length of the row plus the bound,
/// are within them [-].
pub(in crate::control) const FEASIBLE: f64 = 1e-11;

/// Rows that depend on others may end beyond their bounds by this many times what a start may leave.
const BEYOND: f64 = 10.0;

/// Which decisions of a level count as zero, relative to its size.
#[derive(Debug, Clone, Copy)]
pub(in crate::control) struct Precision {
    /// Singular values of the rows below this share of their norm take no part in steps.
    pub(in crate::control) rank: f64,
    /// Multipliers below this share of the possible release no row and hold none.
    pub(in crate::control) release: f64,
}

impl Precision {
    /// Of tasks: singular values that may be needed to keep the direction of a scaled one; the bounds
    /// limit the velocities there.
    pub(in crate::control) const STRAIGHT: Self = Self { rank: 1e-6, release: 1e-9 };

    /// Near rounding. A level moves along nothing that it does not keep: a singular value s of m rows leaves
    /// the keeping of rows one at least as long as s / sqrt(m), which is above `DEPENDENT`.
    #[cfg(any(test, fuzzing))]
    pub(in crate::control) const EXACT: Self = Self { rank: 1e-9, release: 1e-11 };
}

/// Weak directions of a level.
#[derive(Debug, Clone, Copy)]
pub(in crate::control) struct Weak {
    /// Singular values below this share of the norm of the rows are those of weak directions, and below
    /// the other one of none [-].
    pub(in crate::control) below: f64,
    pub(in crate::control) none: f64,
    /// Damping for each unit of the error, and at least [-].
    pub(in crate::control) curvature: f64,
    pub(in crate::control) least: f64,
}

impl Weak {
    /// The damping for an error of this size.
    pub(in crate::control) fn damping(&self, error: f64) -> f64 {
        (self.curvature * error).max(self.least)
    }
}

/// The objective of a level.
#[derive(Debug)]
pub(in crate::control) enum Objective<'a> {
    /// min |A y - b|^2
    Rows(&'a mut Level),
    /// min |A y - b|^2 + d |y|^2
    Damped(&'a mut Level, f64),
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
    basis: Basis,
    fixed: usize,
    working: Vec<Working>,
    /// Working rows in the basis: a column each, upper triangular after `fixed`.
    triangle: Matrix,
    uses: Vec<Use>,
    multipliers: Vec<f64>,
    /// Multipliers of the last level up to this size (times the length of the row) are zero.
    least: f64,
    direction: Vec<f64>,
    gradient: Vec<f64>,
    normal: Vec<f64>,
    /// The point of a level performed as a whole, while its inequalities are not known to permit it.
    candidate: Vec<f64>,
    /// The sign of the bound at which each row stood in the last solution; 0 if at none.
    last: Vec<f64>,
    /// The point, the working rows and the uses to return to.
    before: Vec<f64>,
    held: Vec<Working>,
    held_uses: Vec<Use>,
    /// Rounds since the start.
    #[cfg(test)]
    rounds: usize,
}

impl ActiveSet {
    /// Memory for the unknowns of these inequalities.
    pub(in crate::control) fn new(n: usize, inequalities: Inequalities) -> Self {
        let r = inequalities.len();
        Self {
            inequalities,
            y: vec![0.0; n],
            basis: Basis::workspace(n),
            fixed: 0,
            working: Vec::with_capacity(n),
            triangle: Matrix::zeros(n, n),
            uses: vec![Use::Free; r],
            multipliers: vec![0.0; n],
            least: 0.0,
            direction: vec![0.0; n],
            gradient: vec![0.0; n],
            normal: vec![0.0; n],
            candidate: vec![0.0; n],
            last: vec![0.0; r],
            before: vec![0.0; n],
            held: Vec::with_capacity(n),
            held_uses: vec![Use::Free; r],
            #[cfg(test)]
            rounds: 0,
        }
    }

    /// Forgets the last solution.
    pub(in crate::control) fn reset(&mut self) {
        self.forget();
        self.last.fill(0.0);
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

    /// True if rows are held at their bounds.
    #[cfg(test)]
    pub(in crate::control) fn is_at_bound(&self) -> bool {
        !self.working.is_empty()
    }

    /// The rows that stop the last minimised level, with the signs of their bounds.
    pub(in crate::control) fn stopping(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let all = self.working.iter().zip(&self.multipliers);
        all.filter(|(w, l)| **l * self.inequalities.length(w.row) > self.least)
            .map(|(w, _)| (w.row, w.sign))
    }

    /// True if these rows of a level, whose residual is loaded, would move beyond an inequality.
    pub(in crate::control) fn pulls(
        &mut self,
        level: &Level,
        rows: Range<usize>,
        (row, sign): (usize, f64),
    ) -> bool {
        self.inequalities.write(row, sign, &mut self.normal);
        let left = &level.residual[rows.clone()];
        let (mut pull, mut size) = (0.0, 0.0);
        for (j, n) in self.normal.iter().enumerate() {
            let x = dot(&level.rows.column(j)[rows.clone()], left);
            pull += n * x;
            size += x * x;
        }
        pull > PULL * size.sqrt() * self.inequalities.length(row)
    }

    /// Goes to the feasible point nearest to `guess` and forgets all levels; false if there is
    /// none. Rows of the last solution that bound the guess come first.
    pub(in crate::control) fn start(&mut self, guess: &[f64]) -> bool {
        self.y.copy_from_slice(guess);
        self.forget();
        self.inequalities.clamp_to_box(&mut self.y);
        for i in 0..self.inequalities.boxed() {
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
                    && (self.inequalities.value(i, &self.y) - bound).abs() <= self.slack(i, bound)
                {
                    self.add(i, sign);
                }
            }
            true
        }
    }

    /// Values of a row beyond a bound by less than this are within it.
    fn slack(&self, row: usize, bound: f64) -> f64 {
        FEASIBLE * (self.inequalities.length(row).max(f64::MIN_POSITIVE) + bound.abs())
    }

    fn forget(&mut self) {
        self.working.iter().for_each(|w| self.last[w.row] = w.sign);
        for (last, use_of_row) in self.last.iter_mut().zip(&self.uses) {
            if matches!(use_of_row, Use::Free | Use::Dependent) {
                *last = 0.0;
            }
        }
        self.fixed = 0;
        #[cfg(test)]
        {
            self.rounds = 0;
        }
        self.working.clear();
        self.uses.fill(Use::Free);
    }

    /// Adds `normal` to the basis at `place`, and its coefficients after `fixed` to the triangle;
    /// false if it depends on the others.
    fn append(&mut self, place: usize, column: Option<usize>) -> bool {
        if place >= self.y.len() {
            return false;
        }
        let length = norm(&self.normal);
        self.direction.copy_from_slice(&self.normal);
        self.basis.project_out(place, &mut self.direction);
        let once = norm(&self.direction);
        if !(once > DEPENDENT * length) {
            return false;
        }
        self.basis.project_out(place, &mut self.direction);
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
