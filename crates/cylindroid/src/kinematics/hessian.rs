//! The kinematic Hessian: the derivative of the Jacobian with respect to each coordinate.
//!
//! Formula  dJ_i/dq_k = ad(J_k) J_i where joint k carries joint i (or is i), else 0, in world;
//!          the other reference frames as in `jacobian.rs`
//! Shapes   n matrices of 6 x n: `hessian[k]` is dJ/dq_k
//! Units    those of J for each unit of q_k
//! Valid    spherical and free joints: derivative along their unit rates (child axes)
//! Source   Haviland & Corke 2020 (arXiv 2010.08686), in screw form
//! Checked  tests/it/kinematics.rs::hessian_* (the sum of `hessian[k] * rates[k]` is dJ/dt)

use super::jacobian::{MovingFrame, ReferenceFrame, Tip, add};
use crate::linalg::Matrix;
use crate::spatial::{Twist, Vec3};

impl Tip<'_> {
    /// dJ/dq_k over n coordinates (n matrices of 6 x n).
    pub(crate) fn hessian(&self, reference: ReferenceFrame, n: usize) -> Vec<Matrix> {
        let mut out = vec![Matrix::zeros(6, n); n];
        self.hessian_into(reference, &mut out);
        out
    }

    /// Writes dJ/dq_k into `out[k]` (n matrices of 6 x n).
    pub(crate) fn hessian_into(&self, reference: ReferenceFrame, out: &mut [Matrix]) {
        out.iter_mut().for_each(|m| m.as_mut_slice().fill(0.0));
        self.for_each_column(Vec3::ZERO, |depth_k, k, moving| {
            let frame = MovingFrame { tip: self.world_from_tip, twist: moving };
            self.for_each_column(Vec3::ZERO, |depth_i, i, column| {
                let rate = if depth_k >= depth_i { moving.bracket(column) } else { Twist::ZERO };
                add(out[k].column_mut(i), frame.rate_in(reference, column, rate));
            });
        });
    }
}
