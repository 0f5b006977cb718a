//! Selectively damped least squares: each direction is slowed according to its joint velocities.
//!
//! Formula  r_i = (u_i . x) / s_i v_i, the joint velocities along direction i; N_i = |u_i| = 1;
//!          M_i = sum_j |v_ji| |J_j| / s_i; g_i = min(1, N_i / M_i) max_joint_velocity;
//!          r_i scaled so that its largest entry is at most g_i, then the sum at most
//!          max_joint_velocity
//! Shapes   m x n and a task of m entries -> n x m (for this task)
//! Units    max_joint_velocity in rad/s (m/s for prismatic joints)
//! Valid    any rank; |qd| <= max_joint_velocity always. Continuous in x, and in J where its
//!          singular values differ and none is zero: where two are equal their directions are
//!          undetermined, each choice has its own clamps, and the joint velocities may jump (for
//!          motions so small that nothing is clamped they do not)
//! Why so   the original counts end-effector positions; here the task is one vector in the units
//!          of the caller's scaling, so orientation counts as well
//! Source   Buss & Kim 2005, eq. 13 to 15; rho_lj -> |J_j|
//! Checked  tests/it/inverse.rs::selectively_damped_*

use crate::linalg::{Svd, dot, max_abs};

pub(super) fn gains(svd: &Svd, max_joint_velocity: f64, task: &[f64], out: &mut [f64]) -> f64 {
    let machine = svd.machine_rank();
    for (i, gain) in out.iter_mut().enumerate() {
        *gain =
            if i < machine.rank { direction_gain(svd, i, max_joint_velocity, task) } else { 0.0 };
    }
    // The sum of the directions is limited to the largest joint velocity as well.
    let along = |i: usize| along(svd, i, task);
    let mut largest = 0.0_f64;
    for j in 0..svd.cols() {
        let rate: f64 = (0..machine.rank).map(|i| out[i] * along(i) * svd.v(i)[j]).sum();
        largest = largest.max(rate.abs());
    }
    if largest > max_joint_velocity {
        out.iter_mut().for_each(|g| *g *= max_joint_velocity / largest);
    }
    machine.threshold
}

fn direction_gain(svd: &Svd, i: usize, max_joint_velocity: f64, task: &[f64]) -> f64 {
    let (s, v) = (svd.value(i), svd.v(i));
    // |J_j|^2 = sum_l (s_l v_lj)^2: the columns of J without J, over s_i so that nothing vanishes.
    let moved: f64 = v
        .iter()
        .enumerate()
        .map(|(j, vj)| {
            let column2: f64 =
                (0..svd.len()).map(|l| (svd.value(l) / s * svd.v(l)[j]).powi(2)).sum();
            vj.abs() * column2.sqrt()
        })
        .sum::<f64>();
    let allowed = (1.0 / moved).min(1.0) * max_joint_velocity;
    // s times the largest rate along direction i
    let largest = max_abs(v) * along(svd, i, task).abs();
    if largest > allowed * s { allowed / largest } else { 1.0 / s }
}

/// The task along direction i; without a task, a unit motion along every direction.
fn along(svd: &Svd, i: usize, task: &[f64]) -> f64 {
    if task.is_empty() {
        return 1.0;
    }
    dot(svd.u(i), task)
}
