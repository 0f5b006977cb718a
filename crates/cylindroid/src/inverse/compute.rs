//! Computes an inverse: decomposition, gains of the method, report.
//!
//! Formula  V diag(gains) U^T of the weighted Jacobian U diag(s) V^T
//! Shapes   m x n -> n x m
//! Fails    non-finite entries; parameters outside their domains; metrics of the wrong size
//! Checked  tests/it/inverse.rs

use super::method::Method;
use super::report::{self, Inverse, TruncatedDirection};
use super::weighted::Weights;
use crate::error::{Error, Result};
use crate::linalg::{Matrix, Rank, Svd};

impl Method {
    /// The inverse of `j` (m x n) with its report. The gains of selectively damped least squares
    /// depend on the motion: here they hold for unit motions along every direction, see
    /// [`selectively_damped`](super::selectively_damped) for a given one.
    ///
    /// ```
    /// use cylindroid::{Matrix, Method};
    ///
    /// let j = Matrix::from_rows(&[[2.0, 0.0], [0.0, 0.0]]).unwrap();
    /// let inverse = Method::Damped { damping: 0.1 }.inverse(&j)?;
    /// assert!((inverse.matrix[(0, 0)] - 2.0 / 4.01).abs() < 1e-15);
    /// assert_eq!(inverse.dropped.len(), 1); // the second row is lost
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// A matrix with non-finite entries; parameters outside their domains.
    #[doc(alias = "pseudoinverse")]
    #[doc(alias = "Moore-Penrose")]
    pub fn inverse(&self, j: &Matrix) -> Result<Inverse> {
        compute(*self, j, &[], &Weights::NONE)
    }
}

/// An inverse by its method, in the metrics of joints and task; `task` (m entries) is the motion to
/// be inverted where the gains depend on it, otherwise empty.
pub(super) fn compute(
    method: Method,
    j: &Matrix,
    task: &[f64],
    weights: &Weights,
) -> Result<Inverse> {
    method.check()?;
    if !j.is_finite() {
        let i = j.as_slice().iter().position(|x| !x.is_finite()).unwrap_or(0);
        return Err(Error::NotFinite {
            what: format!("matrix entry ({}, {})", i % j.rows(), i / j.rows()),
            value: j.as_slice()[i],
        });
    }
    let svd = Svd::of(&weights.apply(j)?);
    let mut gains = vec![0.0; svd.len()];
    let threshold = method.gains(&svd, task, &mut gains);
    let Rank { rank, threshold, gap } = report::rank(&svd, &gains, threshold);
    let share = |i: usize| gains[i] * svd.value(i);
    let dropped = (0..svd.len())
        .filter(|&i| !report::is_kept(share(i)))
        .map(|i| TruncatedDirection {
            singular_value: svd.value(i),
            direction: svd.u(i).to_vec(),
            filter_factor: share(i),
        })
        .collect();
    Ok(Inverse {
        matrix: weights.unapply(report::assemble(&svd, &gains)),
        singular_values: svd.values().collect(),
        rank,
        gap,
        threshold,
        dropped,
        exists: true,
        reason: None,
    })
}
