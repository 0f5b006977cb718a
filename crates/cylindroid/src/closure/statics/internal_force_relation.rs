//! The relation between torques of the actuated joints and the internal contact forces that they
//! cause.
//!
//! Formula  the kernel of [G; J_p^T] (scaled) as t, over tau = -J_a^T t
//! Shapes   q_a torques, t forces
//! Units    scaled by the characteristic length inside, those of the constraint outside
//! Valid    any constraint; t without torques are the hyperstatic forces
//! Source   Bicchi & Prattichizzo 1998, eq. 12
//! Checked  tests/it/manipulability/internal_force.rs

use crate::closure::constraint::velocity_constraint::{Constraint, kernel_tolerance};
use crate::closure::mobility::relation::{ObjectScale, Relation};
use crate::linalg::{ColumnSpace, Matrix, Threshold};
use crate::tolerance::CLOSURE_RANK;

/// Torques (as joints) and internal contact forces (as object).
pub(crate) fn internal_force_relation(constraint: &Constraint) -> Relation {
    let (a, t) = (constraint.actuated(), constraint.rows());
    // D_c M^T D_r: forces are columns, joints and object rows.
    let all = constraint.scaled_transpose();
    let balanced = all.rows_between(a, all.rows()).transpose();
    let space = ColumnSpace::cut_of(balanced, Threshold::Relative(CLOSURE_RANK));
    let forces = space.complement();
    let torques = &all.rows_between(0, a) * &forces;
    let torques = Matrix::from_fn(a, torques.cols(), |i, j| -torques[(i, j)]);
    let joint_scale = constraint.column_scale()[..a].iter().map(|s| 1.0 / s).collect();
    let scale: Vec<f64> = constraint.row_scale()[..t].to_vec();
    Relation::from_scaled(
        Matrix::vstack(forces.cols(), &[&torques, &forces]),
        joint_scale,
        ObjectScale::diagonal(&scale),
        kernel_tolerance(&space),
    )
}
