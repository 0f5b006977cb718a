//! Column space and orthogonal complement of a matrix, with its numerical rank.
//!
//! Formula  A = Q R P^T, R = U S V^T; the first r columns of Q U span the columns of A, the others
//!          the orthogonal complement. Where the pivots end in rounding, U is left out.
//! Shapes   A: m x n, basis: m x r, complement: m x (m - r)
//! Units    those of A; rows and columns of mixed units must be scaled first
//! Valid    any finite matrix; the null space is the complement of the transpose
//! Fails    non-finite entries give rank 0
//! Why so   both bases are orthonormal to rounding whatever the rank, while right singular vectors
//!          of values near zero are not; a third of the time of a Jacobi decomposition alone on 24
//!          x 18
//! Checked  tests/it/subspaces.rs::column_space_*

use super::matrix::Matrix;
use super::qr::Qr;
use super::singular_values::{extreme_singular_values, singular_values};
use super::svd::{Rank, Svd};
use crate::tolerance::{AMBIGUOUS, MACHINE_RANK};

/// Threshold below which singular values count as zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Threshold {
    /// Relative to the largest singular value.
    Relative(f64),
    /// Absolute: for blocks of a matrix with orthonormal columns, whose largest value may itself be
    /// rounding.
    Absolute(f64),
}

/// A rank with the two singular values next to the cut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cut {
    /// The rank, its threshold, its gap.
    pub rank: Rank,
    /// Smallest kept singular value (infinite when none is kept).
    pub kept: f64,
    /// Largest dropped singular value (zero when none is dropped).
    pub dropped: f64,
}

impl Cut {
    /// The cut of descending values at an absolute threshold.
    ///
    /// ```
    /// use cylindroid::linalg::Cut;
    ///
    /// let cut = Cut::of(&[2.0, 1.0, 1e-12], 1e-9);
    /// assert_eq!((cut.rank.rank, cut.kept, cut.dropped), (2, 1.0, 1e-12));
    /// assert!(!cut.is_ambiguous());
    /// ```
    #[must_use]
    pub fn of(values: &[f64], threshold: f64) -> Self {
        let rank = values.iter().take_while(|&&s| s > threshold).count();
        let kept = if rank == 0 { f64::INFINITY } else { values[rank - 1] };
        let dropped = values.get(rank).copied().unwrap_or(0.0);
        let gap = if dropped == 0.0 { f64::INFINITY } else { kept / dropped };
        Self { rank: Rank { rank, threshold, gap }, kept, dropped }
    }

    /// True where the rank is numerically ambiguous: a small gap, a kept value near the threshold,
    /// or nothing kept and a dropped value near it.
    #[must_use]
    pub fn is_ambiguous(&self) -> bool {
        let nothing_kept = self.rank.rank == 0;
        self.rank.gap < AMBIGUOUS
            || self.kept < AMBIGUOUS * self.rank.threshold
            || (nothing_kept && self.dropped * AMBIGUOUS > self.rank.threshold)
    }
}

/// The column space (range) of a matrix: a rank with its gap, an orthonormal basis and its
/// complement.
///
/// ```text
/// A = Q R P^T,  R = U S V^T:   Q U = [basis | complement],   m x r and m x (m - r)
/// ```
///
/// Rows and columns of mixed units must be scaled first. The null space of A is the complement of
/// the column space of A^T. Non-finite entries give rank 0.
#[doc(alias = "range")]
#[derive(Debug, Clone)]
pub struct ColumnSpace {
    rows: usize,
    qr: Qr,
    /// Of R; `None` where the pivots alone determine the space: the leading columns of Q.
    svd: Option<Svd>,
    values: Vec<f64>,
    cut: Cut,
}

impl ColumnSpace {
    /// The column space of `a`; singular values at or below the threshold count as zero.
    ///
    /// ```
    /// use cylindroid::Matrix;
    /// use cylindroid::linalg::{ColumnSpace, Threshold};
    ///
    /// let a = Matrix::from_rows(&[[1.0, 2.0], [1.0, 2.0], [0.0, 0.0]]).unwrap();
    /// let space = ColumnSpace::of(&a, Threshold::Relative(1e-9));
    /// assert_eq!((space.rank(), space.complement().cols()), (1, 2));
    /// ```
    #[must_use]
    pub fn of(a: &Matrix, threshold: Threshold) -> Self {
        Self::decompose(a.clone(), threshold, 0.0, true)
    }

    /// [`ColumnSpace::of`] with only the cut and the largest singular value: those between may be
    /// missing. A third of the time.
    pub(crate) fn cut_of(a: Matrix, threshold: Threshold) -> Self {
        Self::decompose(a, threshold, 0.0, false)
    }

    /// The same relative to the largest singular value, or to `size` if that is larger: where all
    /// entries may be differences of numbers of this size.
    pub(crate) fn cut_beside(a: Matrix, eps: f64, size: f64) -> Self {
        Self::decompose(a, Threshold::Relative(eps), size, false)
    }

    fn decompose(mut a: Matrix, threshold: Threshold, size: f64, all: bool) -> Self {
        let (rows, longest) = (a.rows(), a.rows().max(a.cols()));
        let largest = a.max_abs();
        let scale = if largest > 0.0 && largest.is_finite() { largest } else { 1.0 };
        a.as_mut_slice().iter_mut().for_each(|x| *x /= scale);
        let qr = Qr::pivoted(a);
        let machine = MACHINE_RANK * longest as f64;
        let dust = match threshold {
            Threshold::Relative(_) => machine * qr.first_pivot().max(size / scale),
            Threshold::Absolute(_) => machine / scale,
        };
        let absolute = |first: f64| match threshold {
            Threshold::Relative(eps) => eps.max(machine) * first.max(size),
            Threshold::Absolute(t) => t.max(machine * first),
        };
        let (regular, rest) = regular_rows(&qr, dust);
        if !all
            && let Some([first, last]) = extreme_singular_values(qr.r_transposed(regular))
            && last > dust
            && last * scale > absolute(first * scale)
        {
            let (first, kept, dropped) = (first * scale, last * scale, rest * scale);
            let gap = kept / dropped; // what is kept is positive
            let rank = Rank { rank: regular, threshold: absolute(first), gap };
            let cut = Cut { rank, kept, dropped };
            return Self { rows, qr, svd: None, values: vec![first, kept], cut };
        }
        let r = qr.r();
        let (svd, mut values) = match clear_values(&qr, regular, rest, dust) {
            Some(values) => (None, values),
            None => {
                let svd = Svd::of(&r);
                let values = svd.values().collect();
                (Some(svd), values)
            }
        };
        values.iter_mut().for_each(|s| *s *= scale);
        let threshold = absolute(values.first().copied().unwrap_or(0.0));
        let cut = Cut::of(&values, threshold);
        if svd.is_none() && cut.dropped > dust * scale {
            // The cut is between values above rounding: their directions are needed.
            let svd = Svd::of(&r);
            let values: Vec<f64> = svd.values().map(|s| s * scale).collect();
            let cut = Cut::of(&values, threshold);
            return Self { rows, qr, svd: Some(svd), values, cut };
        }
        Self { rows, qr, svd, values, cut }
    }

    /// The largest singular value, 0 for a matrix without entries.
    pub(crate) fn largest(&self) -> f64 {
        self.values.first().copied().unwrap_or(0.0)
    }

    /// Dimension of the space.
    #[must_use]
    pub fn rank(&self) -> usize {
        self.cut.rank.rank
    }

    /// The rank and the two singular values next to the cut.
    #[must_use]
    pub fn cut(&self) -> Cut {
        self.cut
    }

    /// All singular values, largest first; those at rounding level may be merged into one.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// An orthonormal basis of the space, m x r.
    #[must_use]
    pub fn basis(&self) -> Matrix {
        self.columns(0, self.rank())
    }

    /// An orthonormal basis of the orthogonal complement, m x (m - r).
    ///
    /// ```
    /// use cylindroid::Matrix;
    /// use cylindroid::linalg::{ColumnSpace, Threshold};
    ///
    /// // The null space of A is the complement of the column space of its transpose.
    /// let a = Matrix::from_rows(&[[1.0, 1.0, 0.0]]).unwrap();
    /// let kernel = ColumnSpace::of(&a.transpose(), Threshold::Relative(1e-9)).complement();
    /// assert_eq!((kernel.rows(), kernel.cols()), (3, 2));
    /// assert!((0..2).all(|j| a.mul_vec(kernel.column(j))[0].abs() < 1e-15));
    /// ```
    #[must_use]
    pub fn complement(&self) -> Matrix {
        self.columns(self.rank(), self.rows)
    }

    /// Columns `from..to` of Q blockdiag(U, 1).
    fn columns(&self, from: usize, to: usize) -> Matrix {
        let mut basis = Matrix::zeros(self.rows, to - from);
        for j in from..to {
            let column = basis.column_mut(j - from);
            match &self.svd {
                Some(svd) if j < svd.len() => {
                    let u = svd.u(j);
                    column[..u.len()].copy_from_slice(u);
                }
                _ => column[j] = 1.0,
            }
        }
        self.qr.apply_to_columns(&mut basis);
        basis
    }
}

/// The number of rows of R before those that are all rounding, and the size of these.
fn regular_rows(qr: &Qr, dust: f64) -> (usize, f64) {
    let mut rank = qr.len();
    let mut rest = 0.0;
    while rank > 0 {
        let row = qr.square_of_row(rank - 1);
        if !(rest + row <= dust * dust) {
            break;
        }
        rest += row;
        rank -= 1;
    }
    (rank, rest.sqrt())
}

/// The singular values where all that comes after some pivot is rounding, with that rounding as
/// one value: the first columns of Q then span the columns, to rounding.
fn clear_values(qr: &Qr, regular: usize, rest: f64, dust: f64) -> Option<Vec<f64>> {
    let mut values = singular_values(qr.r_transposed(regular))?;
    if regular < qr.len() && values.last().is_some_and(|&s| s <= dust) {
        return None;
    }
    values.extend((regular..qr.len()).map(|i| if i == regular { rest } else { 0.0 }));
    Some(values)
}
