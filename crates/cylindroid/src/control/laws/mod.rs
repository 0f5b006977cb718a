//! Control laws around the servo: twists and joint velocities computed from measured forces and
//! from an operator, for a servo to execute.
//!
//! Read `admittance` (a twist from a wrench), `hybrid` (motion and force control in complementary
//! subspaces), `shared` and `operator_authority` (robot and operator on one tool), then
//! `internal_force` (the squeeze on a grasped object). The laws do not depend on the servo, only on
//! the solver's report.

mod admittance;
mod hybrid;
mod internal_force;
mod operator_authority;
mod shared;

pub use admittance::{Admittance, AdmittanceGain};
pub use hybrid::{HybridCommand, HybridController, HybridInput};
pub use internal_force::{InternalForceCommand, InternalForceController};
pub use operator_authority::{AuthorityTimes, OperatorAuthority};
pub use shared::{SharedCommand, SharedController, SharedInput};
