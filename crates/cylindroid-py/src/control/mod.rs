//! Control laws for tools in contact, and for tools that a person moves as well: the twist (or the
//! joint velocities) to command. A servo carries it out.

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
