//! CS decomposition: the principal angles between a space and two orthogonal coordinate spaces.
//!
//! Formula  [A; B] = [X diag(c); Y diag(s)] Z^T, c_j^2 + s_j^2 = 1, s descending
//! Shapes   A: m x k, B: n x k, [A; B] with orthonormal columns; X: m x k, Y: n x k, Z: k x k
//! Units    none: the rows of both blocks have one unit
//! Valid    any such matrix, blocks without rows too. Every c and s has an absolute error of one
//!          rounding; a column of X (Y) whose c (s) is exactly zero is zero, since it is
//!          undetermined.
//! Why so   a single decomposition of B would give c = sqrt(1 - s^2), which loses half the digits
//!          near s = 1; so where s^2 > 1/2 the rows of A are decomposed again, in the space of
//!          these columns alone. The full bidiagonal method would be ten times this file.
//! Source   Van Loan 1985; Golub & Van Loan, Matrix Computations, 4th ed., section 2.5.4
//! Checked  src/linalg/cs_decomposition/tests.rs

use std::f64::consts::FRAC_1_SQRT_2;

use super::column_space::Cut;
use super::matrix::Matrix;
use super::qr::Qr;
use super::svd::Svd;
use super::vector::norm;

/// The block that contains a direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PairKind {
    /// s is zero: the direction lies in the first block.
    Zero,
    /// Neither is zero.
    Finite,
    /// c is zero: the direction lies in the second block.
    Infinite,
}

/// A CS decomposition.
#[derive(Debug, Clone)]
pub(crate) struct CsDecomposition {
    /// Share of each direction in the first block, ascending.
    pub(crate) cosines: Vec<f64>,
    /// Share of each direction in the second block, descending.
    pub(crate) sines: Vec<f64>,
    /// Directions in the first block, a column each.
    pub(crate) x: Matrix,
    /// Directions in the second block, a column each.
    pub(crate) y: Matrix,
    /// The same directions in the coordinates of the given basis.
    pub(crate) z: Matrix,
}

impl CsDecomposition {
    /// The decomposition of a matrix with orthonormal columns, split after `split` rows.
    ///
    /// # Panics
    /// If the matrix has fewer rows than `split`; in debug builds if its columns are not
    /// orthonormal.
    #[must_use]
    pub(crate) fn of(basis: &Matrix, split: usize) -> Self {
        let (rows, k) = (basis.rows(), basis.cols());
        assert!(split <= rows, "a matrix of {rows} rows split after {split}");
        let (a, b) = (basis.rows_between(0, split), basis.rows_between(split, rows));
        let Complete { values: mut sines, mut y, mut z } = Complete::of(&b);
        let large = sines.iter().take_while(|&&s| s > FRAC_1_SQRT_2).count();
        let mut x = &a * &z;
        // What the small sines leave in the first block is large: normalised, these columns of X
        // are sure, and the others are made orthogonal to them.
        let mut cosines: Vec<f64> = vec![0.0; k];
        for (j, cosine) in cosines.iter_mut().enumerate().skip(large) {
            *cosine = normalise(x.column_mut(j));
        }
        if large > 0 {
            let inner = Complete::of(&x.columns_between(0, large));
            // Largest cosine last.
            let turn = Matrix::from_fn(large, large, |i, j| inner.z[(i, large - 1 - j)]);
            let turned = &z.columns_between(0, large) * &turn;
            for j in 0..large {
                cosines[j] = inner.values[large - 1 - j];
                x.column_mut(j).copy_from_slice(inner.y.column(large - 1 - j));
                z.column_mut(j).copy_from_slice(turned.column(j));
                b.mul_vec_into(turned.column(j), y.column_mut(j));
                sines[j] = normalise(y.column_mut(j));
            }
        }
        // Both change a small cosine or sine times its direction by rounding only.
        for j in 0..large {
            x.orthogonalise(j, large..k);
            normalise(x.column_mut(j));
        }
        for j in large..k {
            y.orthogonalise(j, 0..large);
            normalise(y.column_mut(j));
        }
        for (c, s) in cosines.iter_mut().zip(&mut sines) {
            let norm = (*c * *c + *s * *s).sqrt();
            debug_assert!((norm - 1.0).abs() < 1e-9, "columns of the split are not orthonormal");
            (*c, *s) = (*c / norm, *s / norm);
        }
        Self { cosines, sines, x, y, z }
    }

    /// Number of directions.
    #[must_use]
    pub(crate) fn len(&self) -> usize {
        self.sines.len()
    }

    /// The kind of each direction: a cosine or sine at or below `tolerance` (absolute, since the
    /// columns have length one) is zero.
    #[must_use]
    pub(crate) fn kind(&self, j: usize, tolerance: f64) -> PairKind {
        if self.cosines[j] <= tolerance {
            PairKind::Infinite
        } else if self.sines[j] <= tolerance {
            PairKind::Zero
        } else {
            PairKind::Finite
        }
    }

    /// Rank of the first block.
    #[must_use]
    pub(crate) fn first_rank(&self, tolerance: f64) -> Cut {
        let falling: Vec<f64> = self.cosines.iter().rev().copied().collect();
        Cut::of(&falling, tolerance)
    }

    /// Rank of the second block.
    #[must_use]
    pub(crate) fn second_rank(&self, tolerance: f64) -> Cut {
        Cut::of(&self.sines, tolerance)
    }
}

/// A decomposition `B = Y diag(values) Z^T` of an m x k matrix with all k right vectors,
/// orthonormal whatever the rank: those of a wide matrix alone would lack some.
struct Complete {
    /// k of them, largest first.
    values: Vec<f64>,
    /// m x k, zero where the value is.
    y: Matrix,
    /// k x k.
    z: Matrix,
}

impl Complete {
    fn of(b: &Matrix) -> Self {
        let (m, k) = (b.rows(), b.cols());
        if m >= k {
            // A row of zeros makes a square matrix tall: its right vectors are then all there.
            let svd = if m > k {
                Svd::of(b)
            } else {
                Svd::of(&Matrix::vstack(k, &[b, &Matrix::zeros(1, k)]))
            };
            return Self {
                values: svd.values().collect(),
                y: Matrix::from_fn(m, k, |i, j| svd.u(j)[i]),
                z: Matrix::from_fn(k, k, |i, j| svd.v(j)[i]),
            };
        }
        // B^T P = Q R and R = U S V^T, U square: Z = Q blockdiag(U, 1), Y = P V.
        let qr = Qr::pivoted(b.transpose());
        let svd = Svd::of(&qr.r());
        let mut all = Self { values: vec![0.0; k], y: Matrix::zeros(m, k), z: Matrix::zeros(k, k) };
        for j in 0..k {
            let z = all.z.column_mut(j);
            if j < svd.len() {
                all.values[j] = svd.value(j);
                z[..svd.len()].copy_from_slice(svd.u(j));
                let y = all.y.column_mut(j);
                for (&i, &v) in qr.order().iter().zip(svd.v(j)) {
                    y[i] = v;
                }
            } else {
                z[j] = 1.0;
            }
            qr.apply(z);
        }
        all
    }
}

/// Scales a vector to length one and returns its length; a zero vector stays.
fn normalise(x: &mut [f64]) -> f64 {
    let size = norm(x);
    if size > 0.0 {
        x.iter_mut().for_each(|a| *a /= size);
    }
    size
}

#[cfg(test)]
mod tests;
