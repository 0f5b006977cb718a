//! Forward kinematics, Jacobians in three frames, their derivatives.
//!
//! [`State`] is all frames of a mechanism at one `q`; that it exists proves that forward kinematics
//! ran; [`MassMatrix`] is their inertia. [`Chain`] is the short way for a control loop: only the
//! joints that move one end effector.

mod analytical;
mod batch;
mod chain;
mod conversion;
mod forward;
mod hessian;
mod jacobian;
mod joint_axes;
mod joint_screws;
mod mass_matrix;
mod serial;
pub(crate) mod serial_batched;
mod serial_single;
mod state;
pub(crate) mod tree_batched;

pub use analytical::{AnalyticalJacobian, OrientationRates};
pub use batch::KinematicsBatch;
pub use chain::Chain;
pub use conversion::velocity_conversion;
pub use jacobian::ReferenceFrame;
pub(crate) use jacobian::Tip;
pub use joint_axes::JointAxis;
pub use mass_matrix::MassMatrix;
pub(crate) use serial::Serial;
pub use state::{EndEffector, State};
