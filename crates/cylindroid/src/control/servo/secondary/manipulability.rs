//! Manipulability ascent: along the gradient of Yoshikawa's measure of the scaled task Jacobian.
//!
//! Formula  k dw/dq, w = s_1 ... s_m, dw/dq_k = w sum_i u_i^T (dJ/dq_k) v_i / s_i
//! Shapes   velocities of the n coordinates that move the end effector
//! Units    k in rad/s for each unit of dw/dq
//! Valid    trees; zero where w is zero up to rounding. The measure is that of the scaled task:
//!          linear rows over L, and with joint weights that of J W^(-1/2), so that joints which are
//!          kept still count less. Joints without weights climb the plain one
//! Source   Yoshikawa 1985; analytic gradient through the Hessian
//! Checked  tests/it/servo/secondary.rs::secondary_*

use super::Context;
use crate::manipulability::log_volume_slope;

/// Adds the velocities to `out`.
pub(super) fn add(context: &mut Context<'_>, gain: f64, out: &mut [f64]) {
    let Context { chain, svd, task, hessian, .. } = context;
    chain.hessian_into(task.axes, hessian);
    let rank = svd.machine_rank().rank;
    if rank < svd.len() || rank == 0 {
        return;
    }
    let w: f64 = svd.values().product();
    for (k, velocity) in out.iter_mut().enumerate() {
        let h = &hessian[k];
        let entry = |i: usize, j: usize| {
            let (row, scale) = task.rows[i];
            scale * h[(row, j)] * task.columns[j]
        };
        *velocity += gain * w * log_volume_slope(svd, rank, entry);
    }
}
