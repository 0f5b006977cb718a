//! The space that the columns of a matrix span, and its orthogonal complement.
//!
//! Formula  A = Q R P^T, R = U S V^T; the first r columns of Q U span the columns of A, the others
//!          what is orthogonal to them. Where the pivots end in rounding, U is left out.
//! Shapes   A: m x n, basis: m x r, complement: m x (m - r)
//! Units    those of A; rows and columns of mixed units are to be scaled first
//! Valid    any matrix of finite numbers; a kernel is the complement of the transpose
//! Fails    numbers that are not finite give rank 0
//! Why so   both bases come orthonormal to rounding whatever the rank, where right singular
//!          vectors of values near zero do not; a third of the time of a Jacobi decomposition
//!          alone on 24 x 18
//! Checked  tests/it/subspaces.rs::column_space_*

use super::matrix::Matrix;
use super::qr::Qr;
use super::singular_values::singular_values;
use super::svd::{Rank, Svd};
use crate::tolerance::{AMBIGUOUS, MACHINE_RANK};

/// What counts as zero among singular values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Threshold {
    /// At most this times the largest: for a matrix of any size.
    Relative(f64),
    /// At most this: for blocks of a matrix with orthonormal columns, where a largest value may
    /// itself be rounding.
    Absolute(f64),
}

/// A rank with the two numbers it was cut between.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cut {
    /// The rank, its threshold, its gap.
    pub rank: Rank,
    /// Smallest value that counts (infinite when none does).
    pub kept: f64,
    /// Largest value that does not (zero when all do).
    pub dropped: f64,
}

impl Cut {
    /// Of values in falling order at an absolute threshold.
    #[must_use]
    pub fn of(values: &[f64], threshold: f64) -> Self {
        let rank = values.iter().take_while(|&&s| s > threshold).count();
        let kept = if rank == 0 { f64::INFINITY } else { values[rank - 1] };
        let dropped = values.get(rank).copied().unwrap_or(0.0);
        let gap = if dropped == 0.0 { f64::INFINITY } else { kept / dropped };
        Self { rank: Rank { rank, threshold, gap }, kept, dropped }
    }

    /// True where the rank is a matter of taste: a small gap, a kept value near the threshold, or
    /// nothing kept and a dropped value near it.
    #[must_use]
    pub fn is_doubtful(&self) -> bool {
        let nothing_kept = self.rank.rank == 0;
        self.rank.gap < AMBIGUOUS
            || self.kept < AMBIGUOUS * self.rank.threshold
            || (nothing_kept && self.dropped * AMBIGUOUS > self.rank.threshold)
    }
}

/// The space of the columns of a matrix.
#[derive(Debug, Clone)]
pub struct ColumnSpace {
    rows: usize,
    qr: Qr,
    /// Of R; none where the pivots alone tell the space: the columns of Q that they name.
    svd: Option<Svd>,
    values: Vec<f64>,
    cut: Cut,
}

impl ColumnSpace {
    /// Of the columns of `a`, singular values at or below the threshold counting as zero.
    #[must_use]
    pub fn of(a: &Matrix, threshold: Threshold) -> Self {
        let largest = a.max_abs();
        let scale = if largest > 0.0 && largest.is_finite() { largest } else { 1.0 };
        let mut scaled = a.clone();
        scaled.as_mut_slice().iter_mut().for_each(|x| *x /= scale);
        let qr = Qr::pivoted(scaled);
        let machine = MACHINE_RANK * a.rows().max(a.cols()) as f64;
        let dust = match threshold {
            Threshold::Relative(_) => machine * qr.first_pivot(),
            Threshold::Absolute(_) => machine / scale,
        };
        let r = qr.r();
        let (svd, mut values) = match clear_values(&r, dust) {
            Some(values) => (None, values),
            None => {
                let svd = Svd::of(&r);
                let values = svd.values().collect();
                (Some(svd), values)
            }
        };
        values.iter_mut().for_each(|s| *s *= scale);
        let first = values.first().copied().unwrap_or(0.0);
        let threshold = match threshold {
            Threshold::Relative(eps) => eps.max(machine) * first,
            Threshold::Absolute(t) => t.max(machine * first),
        };
        let cut = Cut::of(&values, threshold);
        if svd.is_none() && cut.dropped > dust * scale {
            // The cut goes through values that are no rounding: their directions are needed.
            let svd = Svd::of(&r);
            let values: Vec<f64> = svd.values().map(|s| s * scale).collect();
            let cut = Cut::of(&values, threshold);
            return Self { rows: a.rows(), qr, svd: Some(svd), values, cut };
        }
        Self { rows: a.rows(), qr, svd, values, cut }
    }

    /// Dimension of the space.
    #[must_use]
    pub fn rank(&self) -> usize {
        self.cut.rank.rank
    }

    /// The rank and what it was cut between.
    #[must_use]
    pub fn cut(&self) -> Cut {
        self.cut
    }

    /// All singular values, largest first; those that are rounding may be given as one.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// An orthonormal basis of the space, m x r.
    #[must_use]
    pub fn basis(&self) -> Matrix {
        self.columns(0, self.rank())
    }

    /// An orthonormal basis of what is orthogonal to all columns, m x (m - r).
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
            self.qr.apply(column);
        }
        basis
    }
}

/// The singular values where all that comes after some pivot is rounding, with that rounding as
/// one value: the first columns of Q then span the columns, to rounding.
fn clear_values(r: &Matrix, dust: f64) -> Option<Vec<f64>> {
    let k = r.rows();
    let mut rank = k;
    let mut rest = 0.0;
    while rank > 0 {
        let row = (rank - 1..r.cols()).map(|j| r[(rank - 1, j)].powi(2)).sum::<f64>();
        if !(rest + row <= dust * dust) {
            break;
        }
        rest += row;
        rank -= 1;
    }
    let regular = Matrix::from_fn(r.cols(), rank, |j, i| r[(i, j)]);
    let mut values = singular_values(regular)?;
    if rank < k && values.last().is_some_and(|&s| s <= dust) {
        return None;
    }
    values.extend((rank..k).map(|i| if i == rank { rest.sqrt() } else { 0.0 }));
    Some(values)
}
