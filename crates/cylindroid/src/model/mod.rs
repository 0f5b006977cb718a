//! Mechanisms: an immutable graph of links, joints and contacts, its builder, its file formats.
//!
//! Formats are loaders, never classes: whatever the file, the result is one [`Mechanism`].

mod assembly;
mod builder;
pub mod catalogue;
mod closing;
pub mod formats;
mod held;
mod include;
mod joint;
mod link;
mod mechanism;
mod mimic;
mod motion;
mod node;
mod report;
mod spec;

pub use builder::Builder;
pub use closing::{Contact, ContactSpec, LoopJoint, LoopSpec};
pub use formats::load;
pub use held::{ContactKind, Dimension};
pub use include::Inclusion;
pub use joint::{Joint, JointKind, Limits, Mimic};
pub use link::{Geometry, Inertial, Link, Visual};
pub use mechanism::{Coordinate, CoordinateKind, Frame, FrameId, Mechanism};
pub(crate) use node::{Motion, Node};
pub use report::{Ignored, LoadReport};
pub use spec::JointSpec;
