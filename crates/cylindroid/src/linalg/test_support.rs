//! Random matrices that are the same on every run, and comparisons that print the difference.

use super::matrix::Matrix;
use crate::scalar::uniform;

/// A seed.
pub(super) struct Random(pub(super) u64);

impl Random {
    /// In [lower, upper).
    pub(super) fn within(&mut self, lower: f64, upper: f64) -> f64 {
        lower + (upper - lower) * uniform(&mut self.0)
    }

    pub(super) fn vector(&mut self, n: usize) -> Vec<f64> {
        (0..n).map(|_| self.within(-1.0, 1.0)).collect()
    }

    pub(super) fn matrix(&mut self, m: usize, n: usize) -> Matrix {
        Matrix::from_fn(m, n, |_, _| self.within(-1.0, 1.0))
    }
}

#[track_caller]
pub(super) fn assert_close(what: &str, got: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(got.len(), expected.len(), "{what}: sizes differ");
    for (i, (g, e)) in got.iter().zip(expected).enumerate() {
        let difference = (g - e).abs();
        assert!(
            difference <= tolerance,
            "{what}[{i}]: {g} instead of {e}, difference {difference:.3e} > {tolerance:.1e}"
        );
    }
}

#[track_caller]
pub(super) fn assert_matrix(what: &str, got: &Matrix, expected: &Matrix, tolerance: f64) {
    assert_eq!((got.rows(), got.cols()), (expected.rows(), expected.cols()), "{what}: shape");
    assert_close(what, got.as_slice(), expected.as_slice(), tolerance);
}
