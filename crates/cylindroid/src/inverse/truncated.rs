//! Truncated pseudoinverse (Moore-Penrose): singular values at or below a relative threshold are
//! cut.
//!
//! Formula  gain_i = 1 / s_i if s_i > eps s_1, else 0
//! Shapes   m x n -> n x m          Units  eps [-]
//! Valid    any rank; the gain is at most 1 / (eps s_1). Jumps where a value crosses the threshold.
//! Why so   the rule of numpy.linalg.pinv(J, eps); an absolute cut, as some libraries have, calls
//!          diag(1e-7, 1e-8) zero
//! Source   course notes on Cartesian control, 7.3 (every value under the threshold is cut, not
//!          the smallest alone)
//! Checked  tests/it/inverse.rs::truncated_*, ::penrose*

use crate::linalg::{Matrix, Svd};

pub(super) fn gains(svd: &Svd, eps: f64, out: &mut [f64]) -> f64 {
    let rank = svd.rank(eps);
    for ((i, gain), s) in out.iter_mut().enumerate().zip(svd.values()) {
        *gain = if i < rank.rank { 1.0 / s } else { 0.0 };
    }
    rank.threshold
}

/// The bare matrix, for use inside the library where the report is not needed.
pub(crate) fn of(a: &Matrix, eps: f64) -> Matrix {
    let svd = Svd::of(a);
    let mut g = vec![0.0; svd.len()];
    gains(&svd, eps, &mut g);
    super::report::assemble(&svd, &g)
}
