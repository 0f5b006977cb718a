//! Transmitted wrenches of loop joints and contacts, from the forces of their rows.
//!
//! Formula  wrench of a joint or contact = sum of t_i h_i over its rows h_i, moved to its point
//! Shapes   t: one force for each row of the [`ClosedChain`] (the last rows are the wrench on the
//!          object itself and belong to no joint)
//! Units    N and N m; compliances m/N, for moments divided by the square of the characteristic
//!          length
//! Frame    at the origin of the joint (contact) on the second link, world axes; the wrench exerted
//!          by the first link on the second. The normal of a contact points into the second link,
//!          so that pushing is positive
//! Valid    forces of [`contact_forces`] at the same configuration. Joints of the spanning tree are
//!          not among them: the constraint is written without their forces
//! Checked  tests/it/closure/statics.rs::transmitted_*
//!
//! [`contact_forces`]: crate::closure::contact_forces

use crate::closure::constraint::closed_chain::ClosedChain;
use crate::closure::constraint::constraint_rows::{ConstraintRow, constraint_rows};
use crate::closure::constraint::velocity_constraint::Unit;
use crate::error::{Error, Result};
use crate::kinematics::State;
use crate::linalg::Metric;
use crate::spatial::{Vec3, Wrench};
use crate::tolerance::MAX_MAGNITUDE;

/// The wrench transmitted by a loop joint or a contact.
#[derive(Debug, Clone, PartialEq)]
pub struct TransmittedWrench {
    /// Name of the joint or contact.
    pub name: String,
    /// Its position (m).
    pub point: Vec3,
    /// Exerted by the first link on the second, at the point.
    pub wrench: Wrench,
    /// For contacts: the force along the normal (N), positive for pushing.
    pub normal: Option<f64>,
}

impl TransmittedWrench {
    /// Norm of the tangential force (N), for contacts.
    #[must_use]
    pub fn tangential(&self) -> Option<f64> {
        let normal = self.normal?;
        let force = self.wrench.force.norm();
        Some(((force - normal.abs()) * (force + normal.abs())).max(0.0).sqrt())
    }
}

/// The wrenches of all loop joints, then of all contacts, from the forces of the rows.
///
/// ```text
/// wrench of a joint or contact = sum_i t_i h_i over its rows h_i, at its point
/// ```
///
/// `forces` has an entry t_i for each row of the chain
/// ([`contact_forces`](crate::closure::contact_forces) at the same state), in N and N m; wrenches
/// are in world axes, exerted by the first link on the second.
///
/// ```
/// use cylindroid::closure::{
///     ClosedChain, MotionSpace, StaticLoad, contact_forces, joint_torques, row_compliance,
///     transmitted_wrenches,
/// };
///
/// // A wrench on the coupler of a four-bar: the force in the joint that closes the loop.
/// let four_bar = cylindroid::load("four-bar")?;
/// let state = four_bar.state(four_bar.home())?;
/// let chain = ClosedChain::of(&state, None, None)?;
/// let motions = MotionSpace::of(&chain.constraint);
/// let wrench = [0.0, -10.0, 0.0];
/// let torques = joint_torques(&motions.relation(), &wrench, None)?.torques;
/// let load = StaticLoad { torques: &torques, wrench: &wrench };
/// let compliance = row_compliance(&state, &chain, &[1e-6])?;
/// let found = contact_forces(&chain.constraint, &motions, load, Some(&compliance))?;
/// let joints = transmitted_wrenches(&state, &chain, &found.forces)?;
/// assert!(joints[0].wrench.force.norm() > 0.0 && joints[0].normal.is_none());
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// # Errors
/// The wrong number of forces, or non-finite values.
pub fn transmitted_wrenches(
    state: &State,
    chain: &ClosedChain,
    forces: &[f64],
) -> Result<Vec<TransmittedWrench>> {
    Error::check_len("contact forces", chain.constraint.rows(), forces.len())?;
    Error::check_within("contact forces", forces, MAX_MAGNITUDE)?;
    let mechanism = state.mechanism();
    let rows = pairs(state, chain)?;
    let pose = |link: usize| state.link_pose(link);
    let sum = |place: usize, point: Vec3| {
        let own = rows.iter().zip(forces).filter(|(row, _)| row.pair == place);
        own.fold(Wrench::ZERO, |sum, (row, t)| sum + row.wrench.at_point(point - row.point) * *t)
    };
    let mut all = Vec::new();
    for joint in mechanism.loops() {
        let point = (pose(joint.b) * joint.link_b_from_joint).translation;
        let wrench = sum(all.len(), point);
        all.push(TransmittedWrench { name: joint.name.clone(), point, wrench, normal: None });
    }
    for contact in mechanism.contacts() {
        let point = (pose(contact.b) * contact.link_b_from_contact).translation;
        let axes = (pose(contact.a) * contact.link_a_from_contact).rotation;
        let wrench = sum(all.len(), point);
        let normal = axes.z_axis().dot(wrench.force);
        all.push(TransmittedWrench {
            name: contact.name.clone(),
            point,
            wrench,
            normal: Some(normal),
        });
    }
    Ok(all)
}

/// The compliance of the rows: `compliances` (m/N) of all loop joints, then of all contacts, to
/// forces, and divided by the square of the characteristic length to moments (rad/(N m)).
///
/// # Errors
/// The wrong number of compliances, or values that are not positive and finite.
pub fn row_compliance(state: &State, chain: &ClosedChain, compliances: &[f64]) -> Result<Metric> {
    let mechanism = state.mechanism();
    let pairs_there = mechanism.loops().len() + mechanism.contacts().len();
    Error::check_len("compliances", pairs_there, compliances.len())?;
    let length = chain.constraint.length();
    let rows = pairs(state, chain)?;
    let mut weights: Vec<f64> = rows
        .iter()
        .map(|row| match row.unit {
            Unit::Length => compliances[row.pair],
            Unit::Angle => compliances[row.pair] / (length * length),
        })
        .collect();
    // The wrench on the object is given: the compliance of its rows has no influence.
    weights.resize(chain.constraint.rows(), 1.0);
    Metric::diagonal("compliance", &weights)
}

/// The rows of loop joints and contacts.
fn pairs(state: &State, chain: &ClosedChain) -> Result<Vec<ConstraintRow>> {
    let (rows, ..) = constraint_rows(state)?;
    let expected = chain.constraint.rows() - chain.constraint.object();
    Error::check_len("rows of the closed chain (is it of another state?)", rows.len(), expected)?;
    Ok(rows)
}
