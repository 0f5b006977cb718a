//! Control laws beside the servo: twists and joint velocities from measured forces and from an
//! operator, for a servo to carry out.
//!
//! Read `admittance` (a twist from a wrench), `hybrid` (motion and force control in complementary
//! subspaces), `shared` and `operator_share` (robot and operator on one tool), then `internal_force`
//! (the squeeze on a grasped object). No law reads the servo or another wing but the solver's result.

mod admittance;
mod hybrid;
mod internal_force;
mod operator_share;
mod shared;

pub use admittance::{Admittance, AdmittanceGain};
pub use hybrid::{HybridCommand, HybridInput, HybridLaw};
pub use internal_force::{InternalForceCommand, InternalForceLaw};
pub use operator_share::{OperatorShare, ShareTimes};
pub use shared::{SharedCommand, SharedInput, SharedLaw};
