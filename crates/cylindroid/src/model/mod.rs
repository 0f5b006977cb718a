//! Mechanisms: an immutable graph of links and joints, its builder, its file formats.
//!
//! Formats are loaders, never classes: whatever the file, the result is one [`Mechanism`].

mod assembly;
mod builder;
pub mod catalogue;
pub mod formats;
mod joint;
mod link;
mod mechanism;
mod node;
mod report;
mod spec;

pub use builder::Builder;
pub use formats::load;
pub use joint::{Joint, JointKind, Limits, Mimic};
pub use link::{Geometry, Inertial, Link, Visual};
pub use mechanism::{Coordinate, CoordinateKind, Frame, FrameId, Mechanism};
pub(crate) use node::{Motion, Node};
pub use report::{Ignored, LoadReport};
pub use spec::JointSpec;
