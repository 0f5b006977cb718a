//! The report that comes with every inverse.

use crate::linalg::{Matrix, Rank, Svd};
use crate::screws::NoInverse;

/// An inverse with its report.
#[derive(Debug, Clone, PartialEq)]
pub struct Inverse {
    /// The inverse, n x m: joint velocities = matrix * task.
    pub matrix: Matrix,
    /// The singular values of the (weighted) Jacobian, largest first.
    pub singular_values: Vec<f64>,
    /// Number of directions of which at least one half is realised.
    pub rank: usize,
    /// Smallest singular value of these over the largest that was dropped: near 1 the rank is
    /// numerically ambiguous, below 1 where the method dropped a larger one than it kept, infinite
    /// when no non-zero value was dropped.
    pub gap: f64,
    /// The singular value below which a direction counts as dropped; with numerical filtering that
    /// of the weakest direction, with selectively damped least squares, which truncate by the joint
    /// velocities that a direction would need, that of the rank at machine precision.
    pub threshold: f64,
    /// The truncated directions, with their filter factors.
    pub dropped: Vec<TruncatedDirection>,
    /// False where the method has no inverse for this Jacobian; the entries of `matrix` are then
    /// NaN.
    pub exists: bool,
    /// The reason if there is none.
    pub reason: Option<NoInverse>,
}

/// A task direction that the inverse suppresses by more than half.
#[doc(alias = "lost direction")]
#[doc(alias = "dropped")]
#[derive(Debug, Clone, PartialEq)]
pub struct TruncatedDirection {
    /// Its singular value.
    pub singular_value: f64,
    /// Unit vector in the (weighted) task space, m entries (zero in a tall matrix where the
    /// singular value is exactly zero: its direction is not determined).
    pub direction: Vec<f64>,
    /// Filter factor: the fraction of a motion along it that is realised, in [0, 1/2).
    pub filter_factor: f64,
}

/// Number of kept directions, with threshold and gap. They need not be the first ones: selectively
/// damped least squares truncate by joint velocities.
pub(super) fn rank(svd: &Svd, gains: &[f64], threshold: f64) -> Rank {
    let (mut rank, mut last_kept, mut largest_lost) = (0, None, 0.0_f64);
    for (value, gain) in svd.values().zip(gains) {
        if is_kept(gain * value) {
            (rank, last_kept) = (rank + 1, Some(value));
        } else {
            largest_lost = largest_lost.max(value);
        }
    }
    let gap = match last_kept {
        Some(value) if largest_lost > 0.0 => value / largest_lost,
        _ => f64::INFINITY,
    };
    Rank { rank, threshold, gap }
}

/// A direction counts as kept when at least half of a motion along it is realised.
pub(crate) fn is_kept(share: f64) -> bool {
    share >= 0.5
}

/// `V diag(gains) U^T`.
pub(crate) fn assemble(svd: &Svd, gains: &[f64]) -> Matrix {
    let mut matrix = Matrix::zeros(svd.cols(), svd.rows());
    for (i, gain) in gains.iter().enumerate() {
        for (j, u) in svd.u(i).iter().enumerate() {
            for (x, v) in matrix.column_mut(j).iter_mut().zip(svd.v(i)) {
                *x += gain * u * v;
            }
        }
    }
    matrix
}
