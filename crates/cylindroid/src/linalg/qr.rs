//! QR decomposition by Householder reflections, with or without column pivoting.
//!
//! Formula  A P = Q R, Q^T Q = 1, R upper triangular with a descending diagonal
//! Shapes   A: m x n, Q: m x m (kept as reflections), R: k x n, k = min(m, n)
//! Valid    any finite matrix whose squares neither overflow nor underflow
//! Why so   it reduces an m x n matrix to k x n with the same singular values, whose Jacobi
//!          decomposition needs three or four sweeps instead of eight, and gives a basis of the
//!          orthogonal complement at no cost. Norms of the remaining columns are recomputed at each
//!          step: the usual update loses its digits where it matters. A library (faer) was slower
//!          on the sizes used: see ARCHITECTURE.md
//! Source   Golub & Van Loan, Matrix Computations, 4th ed., sections 5.2 and 5.4.2; as first step
//!          of a Jacobi decomposition Drmac & Veselic 2008
//! Checked  tests/it/subspaces.rs::qr_*

use super::matrix::Matrix;
use super::vector::dot_unrolled as dot;

/// A QR decomposition `A P = Q R` by Householder reflections, with or without column pivoting, for
/// orthonormal bases and complements of twists and wrenches.
///
/// A: m x n, Q: m x m orthogonal (stored as reflections below the diagonal of R), R: k x n upper
/// triangular, k = min(m, n), with a descending diagonal if pivoted. `benches/peers` compares it
/// with faer.
///
/// Source: Golub & Van Loan, Matrix Computations, 4th ed., sections 5.2 and 5.4.2.
#[derive(Debug, Clone)]
pub struct Qr {
    packed: Matrix,
    /// Reflection j is `1 - factors[j] v v^T`, v = (1, entries below the diagonal of column j).
    factors: Vec<f64>,
    order: Vec<usize>,
}

impl Qr {
    /// With column pivoting: the largest remaining column first.
    ///
    /// ```
    /// use cylindroid::Matrix;
    /// use cylindroid::linalg::Qr;
    ///
    /// let a = Matrix::from_rows(&[[1.0, 3.0], [0.0, 4.0]]).unwrap();
    /// let qr = Qr::pivoted(a);
    /// assert_eq!(qr.order(), [1, 0]); // the longest column first
    /// assert!((qr.first_pivot() - 5.0).abs() < 1e-15);
    /// ```
    #[must_use]
    pub fn pivoted(a: Matrix) -> Self {
        Self::decompose(a, true)
    }

    /// Without pivoting: columns in their order.
    ///
    /// ```
    /// use cylindroid::Matrix;
    /// use cylindroid::linalg::Qr;
    ///
    /// // The wrenches that do no work on two twists.
    /// let twists = Matrix::from_fn(6, 2, |i, j| f64::from(u8::from(i == 2 + j)));
    /// let qr = Qr::plain(twists);
    /// assert_eq!((qr.basis().cols(), qr.complement().cols()), (2, 4));
    /// let mut x = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0];
    /// qr.apply_transposed(&mut x); // in the span: the last entries of Q^T x vanish
    /// assert!(x[2..].iter().all(|x| x.abs() < 1e-15));
    /// qr.apply(&mut x);
    /// assert!((x[2] - 1.0).abs() < 1e-15);
    /// ```
    #[must_use]
    pub fn plain(a: Matrix) -> Self {
        Self::decompose(a, false)
    }

    fn decompose(mut a: Matrix, pivot: bool) -> Self {
        let n = a.cols();
        let k = a.rows().min(n);
        let mut factors = vec![0.0; k];
        let mut order: Vec<usize> = (0..n).collect();
        let mut sizes: Vec<f64> =
            if pivot { (0..n).map(|j| square(a.column(j))).collect() } else { Vec::new() };
        for j in 0..k {
            if pivot {
                let largest =
                    (j..n).fold(j, |best, l| if sizes[l] > sizes[best] { l } else { best });
                if largest != j {
                    a.swap_columns(j, largest);
                    sizes.swap(j, largest);
                    order.swap(j, largest);
                }
            }
            let norm = if pivot { sizes[j] } else { square(&a.column(j)[j..]) }.sqrt();
            if norm == 0.0 {
                continue;
            }
            factors[j] = reflect_rest(&mut a, n, j, norm, |l, rest| {
                if pivot {
                    sizes[l] = square(rest);
                }
            });
        }
        Self { packed: a, factors, order }
    }

    /// R with its columns in pivoted order: k x n.
    #[must_use]
    pub fn r(&self) -> Matrix {
        let k = self.factors.len();
        let mut r = Matrix::zeros(k, self.packed.cols());
        for j in 0..r.cols() {
            let rows = k.min(j + 1);
            r.column_mut(j)[..rows].copy_from_slice(&self.packed.column(j)[..rows]);
        }
        r
    }

    /// The first `rows` rows of R, transposed.
    pub(super) fn r_transposed(&self, rows: usize) -> Matrix {
        let n = self.packed.cols();
        let mut t = Matrix::zeros(n, rows);
        for i in 0..rows {
            for (j, x) in t.column_mut(i).iter_mut().enumerate().skip(i) {
                *x = self.packed[(i, j)];
            }
        }
        t
    }

    /// The square of the length of row `i` of R.
    pub(super) fn square_of_row(&self, i: usize) -> f64 {
        (i..self.packed.cols()).map(|j| self.packed[(i, j)].powi(2)).sum()
    }

    /// The first k columns of Q: for independent columns of A an orthonormal basis of their span.
    #[must_use]
    pub fn basis(&self) -> Matrix {
        self.columns(0, self.factors.len())
    }

    /// The other columns of Q: for independent columns of A an orthonormal basis of the orthogonal
    /// complement.
    #[must_use]
    pub fn complement(&self) -> Matrix {
        self.columns(self.factors.len(), self.packed.rows())
    }

    fn columns(&self, from: usize, to: usize) -> Matrix {
        let mut basis = Matrix::zeros(self.packed.rows(), to - from);
        for j in from..to {
            basis.column_mut(j - from)[j] = 1.0;
        }
        self.apply_to_columns(&mut basis);
        basis
    }

    /// `A <- Q A`, m rows.
    pub(super) fn apply_to_columns(&self, a: &mut Matrix) {
        // Column after column under one reflection: they are independent.
        for j in (0..self.factors.len()).rev() {
            for l in 0..a.cols() {
                self.reflect(j, a.column_mut(l));
            }
        }
    }

    /// Number k of reflections.
    pub(crate) fn len(&self) -> usize {
        self.factors.len()
    }

    /// Size of the first entry of the diagonal: with pivots, the size of the largest column.
    #[must_use]
    pub fn first_pivot(&self) -> f64 {
        if self.factors.is_empty() { 0.0 } else { self.packed[(0, 0)].abs() }
    }

    /// `order()[j]` is the column of A in place `j` after pivoting.
    #[must_use]
    pub fn order(&self) -> &[usize] {
        &self.order
    }

    /// `A^-1 B` for a regular square A decomposed without pivots.
    pub(crate) fn solve(&self, mut b: Matrix) -> Matrix {
        let r = self.r();
        for j in 0..b.cols() {
            self.apply_transposed(b.column_mut(j));
            let x = solve_upper(&r, b.column(j));
            b.column_mut(j).copy_from_slice(&x);
        }
        b
    }

    /// `x <- Q x`, m entries.
    ///
    /// # Panics
    /// If `x` has another size than the columns.
    pub fn apply(&self, x: &mut [f64]) {
        for j in (0..self.factors.len()).rev() {
            self.reflect(j, x);
        }
    }

    /// `x <- Q^T x`, m entries.
    ///
    /// # Panics
    /// If `x` has another size than the columns.
    pub fn apply_transposed(&self, x: &mut [f64]) {
        for j in 0..self.factors.len() {
            self.reflect(j, x);
        }
    }

    #[inline]
    fn reflect(&self, j: usize, x: &mut [f64]) {
        reflect(&self.packed, j, self.factors[j], x);
    }
}

/// Reflects column `j` of `a`, `norm` its length from row `j` on, to a multiple of e_j, and the
/// columns after it, of the first `columns`; `f` gets each of these with its remainder below row `j`. Returns the factor of
/// the reflection; its vector is kept below the diagonal.
#[inline]
pub(super) fn reflect_rest(
    a: &mut Matrix,
    columns: usize,
    j: usize,
    norm: f64,
    mut f: impl FnMut(usize, &[f64]),
) -> f64 {
    let m = a.rows();
    let data = a.as_mut_slice();
    let (head, rest) = data.split_at_mut((j + 1) * m);
    let v = &mut head[j * m + j..];
    // The sign without cancellation in v_0.
    let diagonal = -norm.copysign(v[0]);
    let first = v[0] - diagonal;
    let factor = -first / diagonal;
    v[0] = diagonal;
    v[1..].iter_mut().for_each(|x| *x /= first);
    let below = &v[1..];
    for (l, column) in rest.chunks_exact_mut(m).take(columns - j - 1).enumerate() {
        let (top, bottom) = column[j..].split_at_mut(1);
        let along = factor * (top[0] + dot(below, bottom));
        top[0] -= along;
        bottom.iter_mut().zip(below).for_each(|(x, y)| *x -= along * y);
        f(j + 1 + l, bottom);
    }
    factor
}

/// `x <- (1 - factor v v^T) x`, v below the diagonal of column `j` of `packed`.
#[inline]
pub(super) fn reflect(packed: &Matrix, j: usize, factor: f64, x: &mut [f64]) {
    let below = &packed.column(j)[j + 1..];
    let (top, bottom) = x[j..].split_at_mut(1);
    let along = factor * (top[0] + dot(below, bottom));
    top[0] -= along;
    bottom.iter_mut().zip(below).for_each(|(x, v)| *x -= along * v);
}

/// `R^-1 y` for the leading square block of an upper triangular matrix.
pub(crate) fn solve_upper(r: &Matrix, y: &[f64]) -> Vec<f64> {
    let mut x = y.to_vec();
    for i in (0..x.len()).rev() {
        let sum: f64 = (i + 1..x.len()).map(|k| r[(i, k)] * x[k]).sum();
        x[i] = (x[i] - sum) / r[(i, i)];
    }
    x
}

pub(super) fn square(a: &[f64]) -> f64 {
    dot(a, a)
}
