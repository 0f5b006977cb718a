//! Forward kinematics, Jacobians in three frames, their derivatives.
//!
//! [`State`] is all frames of a mechanism at one `q`; that it exists proves that forward kinematics
//! ran. [`Chain`] is the short way for a control loop: only the joints that move one end effector.

mod along;
mod analytical;
mod batch;
mod chain;
mod conversion;
mod forward;
mod hessian;
mod jacobian;
mod joint_screws;
mod lanes;
mod serial;
mod several;
mod state;

pub use analytical::{AnalyticalJacobian, OrientationRates};
pub use batch::Batch;
pub use chain::Chain;
pub use conversion::velocity_conversion;
pub use jacobian::ReferenceFrame;
#[cfg(target_arch = "x86_64")]
pub(crate) use lanes::along_avx2;
pub(crate) use lanes::{
    Turned, Turns, along as along_several, jacobian as jacobian_of_several, whole_way,
};
pub(crate) use serial::Serial;
pub(crate) use several::{Frame, forward as forward_several};
pub use state::{EndEffector, State};
