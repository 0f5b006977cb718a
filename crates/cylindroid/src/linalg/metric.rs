//! Positive definite metrics and their Cholesky factor: weighted norms and whitening.
//!
//! Formula  |x|^2 = x^T M x = |L^T x|^2 with M = L L^T
//! Shapes   M: n x n
//! Fails    `Error::InvalidOption` when M is not square, not symmetric or not positive definite
//! Checked  tests/it/inverse.rs::weighted_*, tests/it/subspaces.rs::dual_metric,
//!          tests/it/manipulability/metrics.rs::metrics_of_tasks

use super::matrix::Matrix;
use super::qr::Qr;
use crate::error::{Error, Result};
use crate::scalar::power_of_two;

/// A positive definite quadratic form, stored as its lower Cholesky factor L.
#[doc(alias = "Cholesky")]
#[derive(Debug, Clone, PartialEq)]
pub struct Metric {
    l: Matrix,
}

impl Metric {
    /// The metric of the positive weights `w`: `sum w_i x_i^2`.
    ///
    /// # Errors
    /// A weight that is non-positive or non-finite.
    pub fn diagonal(name: &'static str, weights: &[f64]) -> Result<Self> {
        for &w in weights {
            if !(w.is_finite() && w > 0.0) {
                return Err(Error::InvalidOption {
                    option: name,
                    value: w.to_string(),
                    reason: "weights must be finite and positive".to_owned(),
                });
            }
        }
        let roots: Vec<f64> = weights.iter().map(|w| w.sqrt()).collect();
        Ok(Self { l: Matrix::diagonal(&roots) })
    }

    /// The metric of the symmetric positive definite matrix `m`.
    ///
    /// ```
    /// use cylindroid::Matrix;
    /// use cylindroid::linalg::Metric;
    ///
    /// let metric = Metric::new("M", &Matrix::diagonal(&[4.0, 1.0]))?;
    /// let mut x = [1.0, 2.0];
    /// metric.whiten(&mut x);
    /// assert_eq!(x, [2.0, 2.0]); // |x|^2 = 4 + 4
    /// assert!(Metric::new("M", &Matrix::diagonal(&[1.0, 0.0])).is_err());
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// A matrix that is not square, finite, symmetric and positive definite.
    pub fn new(name: &'static str, m: &Matrix) -> Result<Self> {
        let refuse = |reason: &str| Error::InvalidOption {
            option: name,
            value: format!("{} x {} matrix", m.rows(), m.cols()),
            reason: reason.to_owned(),
        };
        let n = m.rows();
        if n != m.cols() || !m.is_finite() {
            return Err(refuse("a metric must be a square matrix of finite numbers"));
        }
        if !m.is_symmetric() {
            return Err(refuse("a metric must be symmetric; use (M + M^T) / 2"));
        }
        let mut l = Matrix::zeros(n, n);
        for j in 0..n {
            for i in j..n {
                let sum: f64 = (0..j).map(|k| l[(i, k)] * l[(j, k)]).sum();
                let rest = m[(i, j)] - sum;
                if i == j {
                    if !(rest > 0.0) {
                        return Err(refuse(
                            "a metric must be positive definite; add a small multiple of the identity \
                             if a direction has no cost",
                        ));
                    }
                    l[(j, j)] = rest.sqrt();
                } else {
                    l[(i, j)] = rest / l[(j, j)];
                }
            }
        }
        Ok(Self { l })
    }

    /// The dual metric `M^-1` of forces, where M is the metric of motions: power is then at most
    /// the product of the two norms.
    #[must_use]
    pub fn dual(&self) -> Self {
        // M^-1 = (L^-1)^T L^-1, and L^-1 = Q R makes it R^T R.
        let n = self.len();
        let mut inverse = Matrix::identity(n);
        for j in 0..n {
            let x = inverse.column_mut(j);
            for i in j..n {
                let sum: f64 = (j..i).map(|k| self.l[(i, k)] * x[k]).sum();
                x[i] = (x[i] - sum) / self.l[(i, i)];
            }
        }
        Self::of_square_root(inverse)
    }

    /// `B^T M B`: the metric of coordinates y of a subspace, `x = B y`.
    ///
    /// # Errors
    /// A basis without n rows, with non-finite entries, or with dependent columns.
    pub fn restricted(&self, name: &'static str, basis: &Matrix) -> Result<Self> {
        Error::check_len(name, self.len(), basis.rows())?;
        let refuse = |reason: &str| Error::InvalidOption {
            option: name,
            value: format!("{} x {} matrix", basis.rows(), basis.cols()),
            reason: reason.to_owned(),
        };
        if !basis.is_finite() {
            return Err(refuse("its entries must be finite"));
        }
        if basis.cols() > basis.rows() {
            return Err(refuse("it has more columns than can be independent"));
        }
        let mut whitened = basis.clone();
        self.whiten_rows(&mut whitened);
        let metric = Self::of_square_root(whitened);
        if (0..metric.len()).any(|i| !(metric.l[(i, i)] > 0.0)) {
            return Err(refuse("its columns are dependent; remove the redundant ones"));
        }
        Ok(metric)
    }

    /// `(T M^-1 T^T)^-1`: the metric of images `y = T x`, the norm of the smallest x with that
    /// image.
    ///
    /// # Errors
    /// A map without n columns, with non-finite entries, or with dependent rows.
    pub fn of_images(&self, name: &'static str, map: &Matrix) -> Result<Self> {
        Ok(self.dual().restricted(name, &map.transpose())?.dual())
    }

    /// The metric `A^T A`, scaled meanwhile so that squares neither overflow nor vanish.
    fn of_square_root(mut a: Matrix) -> Self {
        let scale = power_of_two(a.max_abs());
        a.as_mut_slice().iter_mut().for_each(|x| *x /= scale);
        let r = Qr::plain(a).r();
        let entry = |i: usize, j: usize| {
            if i >= j { scale * (r[(j, i)] * r[(j, j)].signum()) } else { 0.0 }
        };
        Self { l: Matrix::from_fn(r.cols(), r.cols(), entry) }
    }

    /// Largest over smallest diagonal entry of the factor: a lower bound of its condition, at least
    /// 1.
    #[must_use]
    pub fn diagonal_ratio(&self) -> f64 {
        let diagonal = (0..self.len()).map(|i| self.l[(i, i)]);
        let smallest = diagonal.clone().fold(f64::INFINITY, f64::min);
        (diagonal.fold(0.0, f64::max) / smallest).max(1.0)
    }

    /// The lower triangular factor L, with positive diagonal.
    #[must_use]
    pub fn lower(&self) -> &Matrix {
        &self.l
    }

    /// Size n of the metric.
    #[must_use]
    pub fn len(&self) -> usize {
        self.l.rows()
    }

    /// True for the metric of a space of no dimension.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// `y <- M y`.
    ///
    /// # Panics
    /// If `y` is shorter than the metric.
    pub fn apply(&self, y: &mut [f64]) {
        self.whiten(y);
        for i in (0..self.len()).rev() {
            y[i] = (0..=i).map(|k| self.l[(i, k)] * y[k]).sum();
        }
    }

    /// `y <- L^T y`: to coordinates in which the metric is the identity.
    ///
    /// # Panics
    /// If `y` is shorter than the metric.
    pub fn whiten(&self, y: &mut [f64]) {
        let n = self.len();
        for i in 0..n {
            y[i] = (i..n).map(|k| self.l[(k, i)] * y[k]).sum();
        }
    }

    /// `y <- L^-T y`: back from coordinates in which the metric is the identity.
    ///
    /// # Panics
    /// If `y` is shorter than the metric.
    pub fn unwhiten(&self, y: &mut [f64]) {
        let n = self.len();
        for i in (0..n).rev() {
            let sum: f64 = (i + 1..n).map(|k| self.l[(k, i)] * y[k]).sum();
            y[i] = (y[i] - sum) / self.l[(i, i)];
        }
    }

    /// `y <- L y`: a force from the coordinates of whitened motions ([`Metric::whiten`]) back to
    /// its own.
    ///
    /// # Panics
    /// If `y` is shorter than the metric.
    pub fn unwhiten_dual(&self, y: &mut [f64]) {
        for i in (0..self.len()).rev() {
            y[i] = (0..=i).map(|k| self.l[(i, k)] * y[k]).sum();
        }
    }

    /// `a <- A L^-T` : the columns of A measured in whitened joint coordinates.
    ///
    /// # Panics
    /// If `a` has another number of columns than the metric.
    pub fn solve_right(&self, a: &mut Matrix) {
        // Row r of A L^-T solves L z = row^T.
        let n = self.len();
        for r in 0..a.rows() {
            for i in 0..n {
                let sum: f64 = (0..i).map(|k| self.l[(i, k)] * a[(r, k)]).sum();
                a[(r, i)] = (a[(r, i)] - sum) / self.l[(i, i)];
            }
        }
    }

    /// `a <- L^T A`: the rows of A measured in whitened task coordinates.
    ///
    /// # Panics
    /// If `a` has another number of rows than the metric.
    pub fn whiten_rows(&self, a: &mut Matrix) {
        for j in 0..a.cols() {
            self.whiten(a.column_mut(j));
        }
    }
}
