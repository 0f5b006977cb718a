//! Weighted pseudoinverses: any method in the metrics of joints and task.
//!
//! Formula  J_w = L_x^T J L_q^-T with W = L L^T; J+ = L_q^-T J_w+ L_x^T
//! Shapes   W_q: n x n, W_x: m x m, both positive definite
//! Units    the whitened joint velocities L_q^T qd and task L_x^T x have one unit each
//! Valid    any rank. For the truncated inverse: of all joint velocities that minimise |J qd - x|
//!          in W_x, the smallest in W_q.
//! Source   Whitney 1969; Ben-Israel & Greville 2003, section 3.3
//! Checked  tests/it/inverse.rs::weighted_*

use crate::error::{Error, Result};
use crate::linalg::{Matrix, Metric};

/// Metrics of joint velocities and of task motions; `None` is the identity.
#[doc(alias = "weighted pseudoinverse")]
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Weights {
    /// n x n: a large weight keeps a joint at rest.
    pub joint: Option<Metric>,
    /// m x m: a large weight keeps a task direction exact.
    pub task: Option<Metric>,
}

impl Weights {
    /// No weights.
    pub const NONE: Self = Self { joint: None, task: None };

    pub(super) fn apply(&self, j: &Matrix) -> Result<Matrix> {
        let mut weighted = j.clone();
        if let Some(metric) = &self.task {
            Error::check_len("task weights", j.rows(), metric.len())?;
            metric.whiten_rows(&mut weighted);
        }
        if let Some(metric) = &self.joint {
            Error::check_len("joint weights", j.cols(), metric.len())?;
            metric.solve_right(&mut weighted);
        }
        Ok(weighted)
    }

    /// `L_q^-T a L_x^T` for the inverse `a` of the weighted matrix.
    pub(super) fn unapply(&self, mut a: Matrix) -> Matrix {
        if let Some(metric) = &self.joint {
            for j in 0..a.cols() {
                metric.unwhiten(a.column_mut(j));
            }
        }
        if let Some(metric) = &self.task {
            // whitening the rows of the identity gives L_x^T itself
            let l_transposed = {
                let mut id = Matrix::identity(metric.len());
                metric.whiten_rows(&mut id);
                id
            };
            a = &a * &l_transposed;
        }
        a
    }
}
