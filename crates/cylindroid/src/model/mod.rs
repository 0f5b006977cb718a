//! Mechanisms: an immutable graph of links, joints and contacts, its builder, its file formats.
//!
//! Formats are loaders, not types: the result of every file is a [`Mechanism`].

mod actuated_joints;
mod builder;
#[cfg(feature = "formats")]
pub mod catalogue;
mod characteristic_length;
#[cfg(feature = "formats")]
mod closing_joint;
#[cfg(feature = "formats")]
mod closure_frames;
#[cfg(feature = "formats")]
mod collada;
mod constraint_wrenches;
mod contact;
pub(crate) mod convex_hull;
mod coordinate_limit;
mod curvature;
mod default_tool;
mod depth_first;
mod dimension;
mod disabled_collisions;
mod elasticity;
mod elasticity_check;
mod fixed_joints;
mod flatten;
pub mod formats;
mod include;
mod joint;
mod joint_limits;
mod joint_spec;
mod joint_transform;
mod link;
mod loop_joint;
pub(crate) mod magnitude;
mod mechanism;
pub(crate) mod mesh_file;
mod mimic;
mod natural_order;
mod node;
mod parameter;
mod parameters_of_mechanism;
mod regular_file;
mod report;
mod tool_choice;
mod tree_order;

pub use builder::Builder;
#[cfg(feature = "formats")]
pub(crate) use closure_frames::CloseHome;
pub use contact::{Contact, ContactKind, ContactSpec};
pub use curvature::{ContactCurvature, SurfaceCurvature};
pub use dimension::Dimension;
pub use elasticity::{ElasticBody, ElasticElement, ElasticKind, Elasticity};
pub use include::Inclusion;
pub(crate) use joint::JointLocus;
pub use joint::{Joint, JointKind, Limits, Mimic};
pub use joint_limits::JointLimits;
pub use joint_spec::JointSpec;
pub use link::{Collision, Geometry, Inertial, Link, Visual};
pub use loop_joint::{LoopJoint, LoopJointSpec};
pub use mechanism::{Coordinate, CoordinateKind, Frame, FrameId, Mechanism};
pub(crate) use node::{Node, NodeKind};
pub use parameter::Parameter;
#[cfg(feature = "formats")]
pub(crate) use parameter::ParameterValues;
#[cfg(feature = "sweep")]
pub(crate) use regular_file::open_regular_file;
pub use regular_file::{check_output_file, files_read, read_regular_file};
pub use report::{Ignored, LoadReport};
pub use tool_choice::ToolChoice;
