//! Spaces of contact forces: those that do no work on the object, on the joints, or on both.
//!
//! Formula  internal ker G, structural ker J^T, hyperstatic ker G and ker J^T
//! Shapes   t rows, one for each row of the constraint
//! Units    N, N m; bases are orthonormal in units scaled by the characteristic length
//! Frame    those of the rows
//! Valid    any constraint. The first two depend on the joints that are written as contacts (the
//!          dimension of ker G is t - rank G); the last one does not
//! Source   Bicchi & Prattichizzo 1998, section 4; Prattichizzo & Bicchi 1998 (ref. 7 there)
//! Checked  tests/it/closure/reference.rs

use super::motion_space::MotionSpace;
use super::subspace::Subspace;
use crate::closure::constraint::velocity_constraint::Constraint;
use crate::linalg::{ColumnSpace, Matrix, Threshold};
use crate::tolerance::CLOSURE_RANK;

/// ker G: contact forces without a wrench on the object (internal forces). They require joint
/// torques unless they are hyperstatic.
///
/// ```
/// use cylindroid::closure::{ClosedChain, internal_forces, structural_forces};
///
/// // Two arms squeeze their common object; no force is without joint torques.
/// let arms = cylindroid::load("two-arm")?;
/// let chain = ClosedChain::of(&arms.state(arms.home())?, None, None)?;
/// assert!(internal_forces(&chain.constraint).dimension() > 0);
/// assert_eq!(structural_forces(&chain.constraint).dimension(), 0);
/// # Ok::<(), cylindroid::Error>(())
/// ```
#[must_use]
#[doc(alias = "squeeze forces")]
pub fn internal_forces(constraint: &Constraint) -> Subspace {
    let joints = constraint.actuated() + constraint.passive();
    kernel_of_columns(constraint, joints, joints + constraint.object())
}

/// ker J^T: contact forces without torques at any joint (structural forces, reactions).
#[must_use]
#[doc(alias = "constraint forces")]
#[doc(alias = "reactions")]
pub fn structural_forces(constraint: &Constraint) -> Subspace {
    kernel_of_columns(constraint, 0, constraint.actuated() + constraint.passive())
}

/// Contact forces that do no work on columns `from..to` of the constraint.
fn kernel_of_columns(constraint: &Constraint, from: usize, to: usize) -> Subspace {
    let columns = constraint.scaled_transpose().rows_between(from, to).transpose();
    let space = ColumnSpace::cut_of(columns, Threshold::Relative(CLOSURE_RANK));
    Subspace { basis: space.complement().scale_rows(constraint.row_scale()), cut: space.cut() }
}

/// ker G and ker J^T: contact forces that equilibrium does not determine.
pub(super) fn hyperstatic_forces(constraint: &Constraint, motions: &MotionSpace) -> Subspace {
    let basis = if motions.hyperstatic() == 0 {
        Matrix::zeros(constraint.rows(), 0)
    } else {
        let scaled = constraint.scaled_transpose().transpose();
        let space = ColumnSpace::cut_of(scaled, Threshold::Relative(motions.threshold()));
        space.complement().scale_rows(constraint.row_scale())
    };
    Subspace { basis, cut: motions.cut() }
}
