//! CS decomposition: the angles between a space and two orthogonal coordinate spaces.
//!
//! Formula  [A; B] = [X diag(c); Y diag(s)] Z^T, c_j^2 + s_j^2 = 1, s falling
//! Shapes   A: m x k, B: n x k, [A; B] with orthonormal columns; X: m x k, Y: n x k, Z: k x k
//! Units    none: the rows of both blocks are of one unit
//! Valid    any such matrix, blocks without rows too. Every c and s is right to rounding times 1;
//!          a column of X (Y) whose c (s) is exactly zero is zero: nothing determines it.
//! Why so   one decomposition of B would give c = sqrt(1 - s^2), of which half the digits are
//!          lost near s = 1; so where s^2 > 1/2 the rows of A are decomposed again, in the space
//!          of these columns alone. The full bidiagonal method would be ten times this file.
//! Source   Van Loan 1985; Golub & Van Loan, Matrix Computations, 4th ed., section 2.5.4
//! Checked  tests/it/subspaces.rs::cs_*

use std::f64::consts::FRAC_1_SQRT_2;

use super::column_space::Cut;
use super::matrix::Matrix;
use super::svd::Svd;

/// Which of the two blocks a direction lives in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PairKind {
    /// s is zero: the direction lives in the first block.
    Zero,
    /// Neither is zero.
    Finite,
    /// c is zero: the direction lives in the second block.
    Infinite,
}

/// A CS decomposition.
#[derive(Debug, Clone)]
pub struct CosineSine {
    /// Share of each direction in the first block, rising.
    pub cosines: Vec<f64>,
    /// Share of each direction in the second block, falling.
    pub sines: Vec<f64>,
    /// Directions in the first block, a column each.
    pub x: Matrix,
    /// Directions in the second block, a column each.
    pub y: Matrix,
    /// The same directions in the coordinates of the given basis.
    pub z: Matrix,
}

impl CosineSine {
    /// Of a matrix with orthonormal columns, split after `split` rows.
    ///
    /// # Panics
    /// If the matrix has fewer rows than `split`.
    #[must_use]
    pub fn of(basis: &Matrix, split: usize) -> Self {
        let (rows, k) = (basis.rows(), basis.cols());
        assert!(split <= rows, "a matrix of {rows} rows split after {split}");
        let (a, b) = (basis.rows_between(0, split), basis.rows_between(split, rows));
        let outer = tall(&b);
        let large = outer.values().take_while(|&s| s > FRAC_1_SQRT_2).count();
        let mut z = Matrix::from_fn(k, k, |i, j| outer.v(j)[i]);
        let mut ax = &a * &z;
        // What the small sines leave in the first block is large: normalised, these columns of X
        // are sure, and the others are kept orthogonal to them.
        let mut cosines: Vec<f64> = vec![0.0; k];
        for (j, cosine) in cosines.iter_mut().enumerate().skip(large) {
            *cosine = normalise(ax.column_mut(j));
        }
        for j in 0..large {
            ax.orthogonalise(j, large..k);
        }
        let inner = tall(&ax.columns_between(0, large));
        // Largest cosine last.
        let turn = Matrix::from_fn(large, large, |i, j| inner.v(large - 1 - j)[i]);
        let turned = &z.columns_between(0, large) * &turn;
        for (j, cosine) in cosines.iter_mut().enumerate().take(large) {
            z.column_mut(j).copy_from_slice(turned.column(j));
            *cosine = inner.value(large - 1 - j);
            ax.column_mut(j).copy_from_slice(&inner.u(large - 1 - j)[..split]);
        }
        let mut y = Matrix::from_fn(rows - split, k, |i, j| outer.u(j)[i]);
        let by = &b * &turned;
        let mut sines: Vec<f64> = outer.values().collect();
        for (j, sine) in sines.iter_mut().enumerate().take(large) {
            y.column_mut(j).copy_from_slice(by.column(j));
            *sine = normalise(y.column_mut(j));
        }
        for j in large..k {
            // Changes a small sine times its direction by rounding only.
            y.orthogonalise(j, 0..large);
            normalise(y.column_mut(j));
        }
        for (c, s) in cosines.iter_mut().zip(&mut sines) {
            let norm = c.hypot(*s);
            debug_assert!((norm - 1.0).abs() < 1e-9, "columns of the split are not orthonormal");
            (*c, *s) = (*c / norm, *s / norm);
        }
        Self { cosines, sines, x: ax, y, z }
    }

    /// Number of directions.
    #[must_use]
    pub fn len(&self) -> usize {
        self.sines.len()
    }

    /// True for a space of no dimension.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.sines.is_empty()
    }

    /// The kind of each direction: a cosine or sine at or below `tolerance` (absolute, since the
    /// columns have length one) is zero.
    #[must_use]
    pub fn kind(&self, j: usize, tolerance: f64) -> PairKind {
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
    pub fn first_rank(&self, tolerance: f64) -> Cut {
        let falling: Vec<f64> = self.cosines.iter().rev().copied().collect();
        Cut::of(&falling, tolerance)
    }

    /// Rank of the second block.
    #[must_use]
    pub fn second_rank(&self, tolerance: f64) -> Cut {
        Cut::of(&self.sines, tolerance)
    }
}

/// The decomposition of `a` below which rows of zeros were added until it is tall: only then are
/// all right vectors there, orthonormal whatever the rank.
fn tall(a: &Matrix) -> Svd {
    let rows = a.rows().max(a.cols() + 1);
    Svd::of(&Matrix::from_fn(rows, a.cols(), |i, j| if i < a.rows() { a[(i, j)] } else { 0.0 }))
}

/// Scales a vector to length one and returns its length; a zero vector stays.
fn normalise(x: &mut [f64]) -> f64 {
    let norm = x.iter().map(|a| a * a).sum::<f64>().sqrt();
    if norm > 0.0 {
        x.iter_mut().for_each(|a| *a /= norm);
    }
    norm
}
