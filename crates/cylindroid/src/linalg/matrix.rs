//! Dense matrix of f64 in column-major order: a column of a Jacobian is a twist.
//!
//! Checked  tests/it/subspaces.rs, tests/it/inverse.rs

use std::fmt;
use std::ops::{Index, IndexMut, Mul};

use super::vector::{dot, dot_unrolled, max_abs};
use crate::error::all_finite;
use crate::tolerance::SYMMETRIC;

/// Squares of numbers between these neither overflow nor vanish, many of them together.
const PLAIN: std::ops::Range<f64> = 1e-140..1e140;

/// A dense `rows x cols` matrix, stored by columns.
#[derive(Clone, PartialEq, Default)]
pub struct Matrix {
    rows: usize,
    cols: usize,
    data: Vec<f64>,
}

impl Matrix {
    /// The zero matrix.
    #[must_use]
    pub fn zeros(rows: usize, cols: usize) -> Self {
        Self { rows, cols, data: vec![0.0; rows * cols] }
    }

    /// Zeros of another shape, which allocates only for more of them than ever before.
    pub(crate) fn reshape(&mut self, rows: usize, cols: usize) {
        (self.rows, self.cols) = (rows, cols);
        self.data.clear();
        self.data.resize(rows * cols, 0.0);
    }

    /// The identity of size `n`.
    #[must_use]
    pub fn identity(n: usize) -> Self {
        Self::from_fn(n, n, |i, j| f64::from(u8::from(i == j)))
    }

    /// The matrix with the entries `f(row, column)`.
    #[must_use]
    pub fn from_fn(rows: usize, cols: usize, mut f: impl FnMut(usize, usize) -> f64) -> Self {
        let mut m = Self::zeros(rows, cols);
        for j in 0..cols {
            for i in 0..rows {
                m[(i, j)] = f(i, j);
            }
        }
        m
    }

    /// The matrix with these rows; `None` when their lengths differ.
    ///
    /// ```
    /// use cylindroid::Matrix;
    ///
    /// let a = Matrix::from_rows(&[[1.0, 2.0], [3.0, 4.0]]).unwrap();
    /// assert_eq!(a.column(1), [2.0, 4.0]);
    /// assert!(Matrix::from_rows(&[vec![1.0], vec![2.0, 3.0]]).is_none());
    /// ```
    #[must_use]
    pub fn from_rows<R: AsRef<[f64]>>(rows: &[R]) -> Option<Self> {
        let cols = rows.first().map_or(0, |r| r.as_ref().len());
        rows.iter()
            .all(|r| r.as_ref().len() == cols)
            .then(|| Self::from_fn(rows.len(), cols, |i, j| rows[i].as_ref()[j]))
    }

    /// The diagonal matrix of these entries.
    #[must_use]
    pub fn diagonal(entries: &[f64]) -> Self {
        Self::from_fn(entries.len(), entries.len(), |i, j| if i == j { entries[i] } else { 0.0 })
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    #[must_use]
    pub fn cols(&self) -> usize {
        self.cols
    }

    /// Column `j`.
    ///
    /// # Panics
    /// If there is no such column.
    #[must_use]
    pub fn column(&self, j: usize) -> &[f64] {
        &self.data[j * self.rows..(j + 1) * self.rows]
    }

    /// Column `j`, mutable.
    ///
    /// # Panics
    /// If there is no such column.
    pub fn column_mut(&mut self, j: usize) -> &mut [f64] {
        &mut self.data[j * self.rows..(j + 1) * self.rows]
    }

    /// All entries, column by column.
    #[must_use]
    pub fn as_slice(&self) -> &[f64] {
        &self.data
    }

    /// All entries, column by column, mutable.
    pub fn as_mut_slice(&mut self) -> &mut [f64] {
        &mut self.data
    }

    /// The rows, for printing and for JSON.
    #[must_use]
    pub fn to_rows(&self) -> Vec<Vec<f64>> {
        (0..self.rows).map(|i| (0..self.cols).map(|j| self[(i, j)]).collect()).collect()
    }

    /// Rows `from..to`.
    ///
    /// # Panics
    /// If there are fewer rows.
    #[must_use]
    pub fn rows_between(&self, from: usize, to: usize) -> Self {
        assert!(to <= self.rows, "rows {from} to {to} of {self:?}");
        let mut part = Self::zeros(to - from, self.cols);
        for j in 0..self.cols {
            part.column_mut(j).copy_from_slice(&self.column(j)[from..to]);
        }
        part
    }

    /// Columns `from..to`.
    ///
    /// # Panics
    /// If there are fewer columns.
    #[must_use]
    pub fn columns_between(&self, from: usize, to: usize) -> Self {
        let data = self.data[from * self.rows..to * self.rows].to_vec();
        Self { rows: self.rows, cols: to - from, data }
    }

    /// The blocks side by side: their columns in order.
    ///
    /// ```
    /// use cylindroid::Matrix;
    ///
    /// let (a, b) = (Matrix::identity(2), Matrix::zeros(2, 1));
    /// assert_eq!(Matrix::hstack(2, &[&a, &b]).cols(), 3);
    /// assert_eq!(Matrix::vstack(2, &[&a, &a]).rows(), 4);
    /// ```
    ///
    /// # Panics
    /// If a block has another number of rows.
    #[must_use]
    pub fn hstack(rows: usize, blocks: &[&Self]) -> Self {
        let mut data = Vec::with_capacity(rows * blocks.iter().map(|b| b.cols).sum::<usize>());
        for block in blocks {
            assert_eq!(block.rows, rows, "{block:?} next to matrices of {rows} rows");
            data.extend_from_slice(&block.data);
        }
        Self { rows, cols: blocks.iter().map(|b| b.cols).sum(), data }
    }

    /// The rows of all blocks one below the other.
    ///
    /// # Panics
    /// If a block has another number of columns.
    #[doc(alias = "concatenate")]
    #[must_use]
    pub fn vstack(cols: usize, blocks: &[&Self]) -> Self {
        let rows = blocks.iter().map(|b| b.rows).sum();
        let mut stack = Self::zeros(rows, cols);
        let mut from = 0;
        for block in blocks {
            assert_eq!(block.cols, cols, "{block:?} above matrices of {cols} columns");
            for j in 0..cols {
                stack.column_mut(j)[from..from + block.rows].copy_from_slice(block.column(j));
            }
            from += block.rows;
        }
        stack
    }

    /// Exchanges two columns.
    pub(crate) fn swap_columns(&mut self, i: usize, j: usize) {
        let (i, j) = (i.min(j), i.max(j));
        if i < j {
            let (head, tail) = self.data.split_at_mut(j * self.rows);
            head[i * self.rows..(i + 1) * self.rows].swap_with_slice(&mut tail[..self.rows]);
        }
    }

    /// Makes column `j` orthogonal to the columns `others` of length one (or zero), twice as
    /// rounding asks.
    pub(crate) fn orthogonalise(&mut self, j: usize, others: std::ops::Range<usize>) {
        for _ in 0..2 {
            for l in others.clone().filter(|&l| l != j) {
                let (own, other) = (self.column(j), self.column(l));
                let along = dot(own, other);
                for i in 0..self.rows {
                    self[(i, j)] -= along * self[(i, l)];
                }
            }
        }
    }

    /// The transpose.
    #[must_use]
    pub fn transpose(&self) -> Self {
        Self::from_fn(self.cols, self.rows, |i, j| self[(j, i)])
    }

    /// `self * x`; entries of `x` beyond the columns are ignored, missing ones count as zero.
    #[must_use]
    pub fn mul_vec(&self, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; self.rows];
        self.mul_vec_into(x, &mut y);
        y
    }

    /// `y = self * x` without allocation.
    pub fn mul_vec_into(&self, x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        for (column, &xj) in self.data.chunks_exact(self.rows.max(1)).zip(x) {
            for (yi, &a) in y.iter_mut().zip(column) {
                *yi += a * xj;
            }
        }
    }

    /// `y = self^T * x` without allocation.
    pub fn tr_mul_vec_into(&self, x: &[f64], y: &mut [f64]) {
        for (column, yj) in self.data.chunks_exact(self.rows.max(1)).zip(y) {
            *yj = dot(column, x);
        }
    }

    /// Every row times its factor.
    pub(crate) fn scale_rows(mut self, factors: &[f64]) -> Self {
        for column in self.data.chunks_exact_mut(self.rows.max(1)) {
            column.iter_mut().zip(factors).for_each(|(x, f)| *x *= f);
        }
        self
    }

    /// The length of row `i`.
    ///
    /// # Panics
    /// If there is no such row.
    #[must_use]
    pub fn row_norm(&self, i: usize) -> f64 {
        (0..self.cols).map(|j| self[(i, j)].powi(2)).sum::<f64>().sqrt()
    }

    /// Square root of the sum of the squared entries.
    #[must_use]
    pub fn frobenius_norm(&self) -> f64 {
        let largest = self.max_abs();
        if largest == 0.0 || !largest.is_finite() {
            return largest;
        }
        if PLAIN.contains(&largest) {
            return dot_unrolled(&self.data, &self.data).sqrt();
        }
        largest * self.data.iter().map(|a| (a / largest).powi(2)).sum::<f64>().sqrt()
    }

    /// The largest absolute entry (NaN if any entry is NaN).
    #[must_use]
    pub fn max_abs(&self) -> f64 {
        max_abs(&self.data)
    }

    /// Largest absolute difference of two matrices of one shape (infinite for different shapes).
    #[must_use]
    pub fn max_difference(&self, other: &Self) -> f64 {
        if (self.rows, self.cols) != (other.rows, other.cols) {
            return f64::INFINITY;
        }
        Self {
            rows: self.rows,
            cols: self.cols,
            data: self.data.iter().zip(&other.data).map(|(a, b)| a - b).collect(),
        }
        .max_abs()
    }

    /// True if it equals its transpose to [`SYMMETRIC`] of its largest entry.
    pub(crate) fn is_symmetric(&self) -> bool {
        self.max_difference(&self.transpose()) <= SYMMETRIC * self.max_abs()
    }

    /// True if no entry is NaN or infinite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        all_finite(&self.data)
    }
}

impl Index<(usize, usize)> for Matrix {
    type Output = f64;

    fn index(&self, (i, j): (usize, usize)) -> &f64 {
        debug_assert!(i < self.rows);
        &self.data[j * self.rows + i]
    }
}

impl IndexMut<(usize, usize)> for Matrix {
    fn index_mut(&mut self, (i, j): (usize, usize)) -> &mut f64 {
        debug_assert!(i < self.rows);
        &mut self.data[j * self.rows + i]
    }
}

/// Matrix product.
///
/// # Panics
/// If the inner sizes differ.
impl Mul for &Matrix {
    type Output = Matrix;

    fn mul(self, other: &Matrix) -> Matrix {
        assert_eq!(self.cols, other.rows, "matrix product of {self:?} and {other:?}");
        let mut product = Matrix::zeros(self.rows, other.cols);
        for j in 0..other.cols {
            self.mul_vec_into(other.column(j), product.column_mut(j));
        }
        product
    }
}

impl fmt::Debug for Matrix {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "Matrix {} x {}", self.rows, self.cols)?;
        for row in self.to_rows() {
            writeln!(f, "  {row:?}")?;
        }
        Ok(())
    }
}
