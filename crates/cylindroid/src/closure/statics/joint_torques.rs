//! Joint torques in equilibrium with a wrench on the object.
//!
//! Formula  tau of least norm with tau^T q_a + w^T u = 0 for every motion (q_a, u) of the relation
//! Shapes   w: d, tau: q_a
//! Units    of the constraint; without a metric the norm is that of the scaled torques
//! Frame    w acts on the object, at the point and in the axes of its twist
//! Valid    any constraint. The part of the wrench that no torque can balance is returned: it acts
//!          along motions of the object that the actuated joints do not control
//! Source   Bicchi & Prattichizzo 1998, eq. 12; virtual work
//! Checked  tests/it/closure/statics.rs::torques_balance_the_wrench

use crate::closure::mobility::relation::{DualRelation, Relation};
use crate::error::{Error, Result};
use crate::linalg::{Metric, Qr, dot};
use crate::tolerance::MAX_MAGNITUDE;

/// Joint torques in equilibrium with a wrench.
#[derive(Debug, Clone, PartialEq)]
pub struct JointTorques {
    /// The torques of least norm, one for each actuated joint. Any combination of the internal
    /// torques of the mobility report may be added.
    pub torques: Vec<f64>,
    /// The part of the wrench that is balanced by the structure without torques: along the
    /// zero-torque wrenches, orthogonal to all others in units scaled by the characteristic length.
    pub structural: Vec<f64>,
    /// The part of the wrench that neither torques nor the structure can balance: zero, or along
    /// motions of the object that the actuated joints do not control. The torques balance the
    /// remaining part.
    pub unbalanced: Vec<f64>,
}

/// The joint torques of least norm that balance the external wrench `wrench` on the object; in
/// `metric`, or scaled by the characteristic length without one.
///
/// ```text
/// tau . qd_a + w . u = 0 for all (qd_a, u) of the relation,   min |tau|
/// ```
///
/// `wrench` has d entries (N, N m; at the object's reference point, world axes), the torques q_a
/// entries (N m, N). The part of the wrench that the structure carries, and the part that nothing
/// balances, are reported with them. Source: Bicchi & Prattichizzo 1998, eq. 12.
///
/// ```
/// use cylindroid::Matrix;
/// use cylindroid::closure::{Constraint, MotionSpace, joint_torques};
///
/// // An arm of one joint with a lever of 2 m: tau = -J^T w.
/// let arm = Constraint::serial(&Matrix::from_rows(&[[2.0]]).unwrap())?;
/// let found = joint_torques(&MotionSpace::of(&arm).relation(), &[3.0], None)?;
/// assert!((found.torques[0] + 6.0).abs() < 1e-12);
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// # Errors
/// A wrench or metric of the wrong size, or with non-finite entries.
pub fn joint_torques(
    relation: &Relation,
    wrench: &[f64],
    metric: Option<&Metric>,
) -> Result<JointTorques> {
    Error::check_len("wrench", relation.object(), wrench.len())?;
    Error::check_within("wrench", wrench, MAX_MAGNITUDE)?;
    let DualRelation { mut torques, structural, unbalanced } = relation.balance(wrench);
    if let Some(metric) = metric {
        Error::check_len("torque metric", relation.joints(), metric.len())?;
        let mut internal = relation.forces().zero;
        metric.whiten_rows(&mut internal);
        metric.whiten(&mut torques);
        let basis = Qr::plain(internal).basis();
        for j in 0..basis.cols() {
            let along = dot(basis.column(j), &torques);
            torques.iter_mut().zip(basis.column(j)).for_each(|(t, b)| *t -= along * b);
        }
        metric.unwhiten(&mut torques);
    }
    Ok(JointTorques { torques, structural, unbalanced })
}
