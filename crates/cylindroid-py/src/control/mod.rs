//! Control laws: admittance, hybrid, shared and internal force control. They compute the twist (or
//! the joint velocities) that a servo executes.

mod admittance;
mod hybrid;
mod internal_force;
mod operator_authority;
mod shared;

pub(crate) use admittance::PyAdmittance;
pub(crate) use hybrid::{PyHybridCommand, PyHybridController};
pub(crate) use internal_force::{PyInternalForceCommand, PyInternalForceController};
pub(crate) use operator_authority::PyOperatorAuthority;
pub(crate) use shared::{PySharedCommand, PySharedController};
