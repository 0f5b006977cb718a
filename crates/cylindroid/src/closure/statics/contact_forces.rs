//! Contact forces: forces at loop joints and contacts in equilibrium with torques and a wrench.
//!
//! Formula  w = G t, tau = -J_a^T t, 0 = J_p^T t, in short M^T t = -(tau, 0, w); of all solutions t
//!          the one of least norm, or the elastic one of least t^T C t (C: compliance)
//! Shapes   w: d, tau: q_a, t: t entries; C: t x t
//! Units    of the constraint. Without a compliance, the norm is that of the scaled forces: forces
//!          are multiplied by the characteristic length
//! Frame    w acts on the object, at the point and in the axes of its twist; t is exerted by the
//!          object on the limbs, in the frames of the rows
//! Valid    any constraint. The unbalanced part of a load is returned: torques and a wrench that
//!          contradict each other. If the chain is not hyperstatic, the compliance has no influence
//! Source   Bicchi & Prattichizzo 1998, eq. 12; elastic forces by least complementary energy
//! Checked  tests/it/closure/statics.rs

use crate::closure::constraint::velocity_constraint::Constraint;
use crate::closure::mobility::motion_space::MotionSpace;
use crate::error::{Error, Result};
use crate::linalg::{Metric, Svd, dot, norm};
use crate::tolerance::MAX_MAGNITUDE;

/// A static load: joint torques and a wrench on the object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StaticLoad<'a> {
    /// An entry for each actuated joint.
    pub torques: &'a [f64],
    /// The wrench on the object.
    pub wrench: &'a [f64],
}

/// Forces at the contacts.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactForces {
    /// An entry for each row of the constraint.
    pub forces: Vec<f64>,
    /// Norm of the unbalanced part of the load over that of the load (scaled) [-]: rounding, unless
    /// torques and wrench contradict each other.
    pub unbalanced: f64,
}

/// The contact forces t under a load: the ones of least norm, or with a compliance C the elastic
/// ones.
///
/// ```text
/// G t = w,   J_a^T t = -tau,   J_p^T t = 0,   min t . C t
/// ```
///
/// An entry for each of the t rows of the constraint (N, N m), acting from the object on the limbs.
/// Any combination of the hyperstatic forces of the mobility report may be added. Source: Bicchi &
/// Prattichizzo 1998, eq. 12.
///
/// ```
/// use cylindroid::closure::{ClosedChain, MotionSpace, StaticLoad, contact_forces, joint_torques};
///
/// let five_bar = cylindroid::load("five-bar")?;
/// let chain = ClosedChain::of(&five_bar.state(five_bar.home())?, None, None)?;
/// let motions = MotionSpace::of(&chain.constraint);
/// let wrench = [3.0, -1.0, 0.0];
/// let found = joint_torques(&motions.relation(), &wrench, None)?;
/// let balanced: Vec<f64> = wrench.iter().zip(&found.unbalanced).map(|(w, u)| w - u).collect();
/// let load = StaticLoad { torques: &found.torques, wrench: &balanced };
/// assert!(contact_forces(&chain.constraint, &motions, load, None)?.unbalanced < 1e-12);
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// # Errors
/// Torques, wrench or compliance of the wrong size, or with non-finite entries.
pub fn contact_forces(
    constraint: &Constraint,
    motions: &MotionSpace,
    load: StaticLoad<'_>,
    compliance: Option<&Metric>,
) -> Result<ContactForces> {
    ContactForceSolver::of(constraint, motions, compliance)?.forces(load)
}

/// The equations of [`contact_forces`], decomposed once for any load.
pub(crate) struct ContactForceSolver<'a> {
    constraint: &'a Constraint,
    compliance: Option<&'a Metric>,
    svd: Svd,
    rank: usize,
}

impl<'a> ContactForceSolver<'a> {
    pub(crate) fn of(
        constraint: &'a Constraint,
        motions: &MotionSpace,
        compliance: Option<&'a Metric>,
    ) -> Result<Self> {
        // Unknown: the scaled forces t = D_r t', or z = L^T t with C = L L^T.
        let mut equations = constraint.scaled_transpose();
        if let Some(metric) = compliance {
            Error::check_len("compliance", constraint.rows(), metric.len())?;
            for (j, r) in constraint.row_scale().iter().enumerate() {
                equations.column_mut(j).iter_mut().for_each(|x| *x /= r);
            }
            metric.solve_right(&mut equations);
        }
        let svd = Svd::of(&equations);
        let rank = motions.cut().rank.rank.min(svd.len());
        Ok(Self { constraint, compliance, svd, rank })
    }

    pub(crate) fn forces(&self, load: StaticLoad<'_>) -> Result<ContactForces> {
        let (constraint, svd) = (self.constraint, &self.svd);
        Error::check_len("torques", constraint.actuated(), load.torques.len())?;
        Error::check_len("wrench", constraint.object(), load.wrench.len())?;
        Error::check_within("torques", load.torques, MAX_MAGNITUDE)?;
        Error::check_within("wrench", load.wrench, MAX_MAGNITUDE)?;
        // b' = -D_c (tau, 0, -w): the columns of the object carry -G^T, and G t = w.
        let (a, p) = (constraint.actuated(), constraint.passive());
        let scale = constraint.column_scale();
        let mut target = vec![0.0; a + p + constraint.object()];
        for (i, torque) in load.torques.iter().enumerate() {
            target[i] = -torque * scale[i];
        }
        for (i, w) in load.wrench.iter().enumerate() {
            target[a + p + i] = -w * scale[a + p + i];
        }
        let mut forces = svd.solve(&target, self.rank);
        let mut left = target.clone();
        for i in 0..self.rank {
            let along = dot(svd.u(i), &target);
            left.iter_mut().zip(svd.u(i)).for_each(|(l, u)| *l -= along * u);
        }
        match self.compliance {
            Some(metric) => metric.unwhiten(&mut forces),
            None => forces.iter_mut().zip(constraint.row_scale()).for_each(|(f, r)| *f *= r),
        }
        let size = norm(&target);
        Ok(ContactForces { forces, unbalanced: if size > 0.0 { norm(&left) / size } else { 0.0 } })
    }
}
