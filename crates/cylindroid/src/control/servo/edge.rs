//! The edge of the workspace: how the task of a step bends, and how fast its joints may approach a
//! pose that is the nearest one.
//!
//! Formula  C_ij = -sum_k e_k r_k (dJ_kj/dq_i + dJ_ki/dq_j) / 2 c_i c_j, with the scales r of rows and
//!          c of columns (`task_space.rs`)
//! Shapes   n x n
//! Valid    trees
//! Checked  tests/it/servo/edge.rs

use super::approach;
use super::task_space::TaskSpace;
use crate::control::solver::saturation::Curvature;
use crate::kinematics::Chain;
use crate::linalg::Matrix;
use crate::model::Limits;

/// The present step.
#[derive(Debug)]
pub(super) struct Edge<'a> {
    pub(super) chain: &'a Chain,
    pub(super) space: &'a TaskSpace,
    pub(super) limits: &'a [Limits],
    pub(super) dt: f64,
    /// Memory for the derivatives of the Jacobian, 6 x n for each coordinate.
    pub(super) hessian: &'a mut [Matrix],
}

impl Curvature for Edge<'_> {
    fn load(&mut self, left: &[f64], out: &mut Matrix) {
        self.chain.hessian_into(self.space.axes, self.hessian);
        let columns = &self.space.columns;
        for (i, h) in self.hessian.iter().enumerate() {
            for (j, x) in out.column_mut(i).iter_mut().enumerate() {
                let column = h.column(j);
                let parts = left.iter().zip(&self.space.rows);
                let sum: f64 = parts.map(|(e, &(row, scale))| e * scale * column[row]).sum();
                *x = -sum * columns[i] * columns[j];
            }
        }
        for i in 0..out.rows() {
            for j in 0..i {
                let mean = 0.5 * (out[(i, j)] + out[(j, i)]);
                (out[(i, j)], out[(j, i)]) = (mean, mean);
            }
        }
    }

    fn share(&self, way: &[f64], rates: &[f64]) -> f64 {
        approach::scale(way, rates, &self.space.columns, self.limits, self.dt)
    }
}
