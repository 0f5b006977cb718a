//! A joint of an SDF file, before the spanning tree is known.

use roxmltree::Node;

use crate::model::{JointKind, Limits, Mimic};
use crate::spatial::{Pose, Vec3};

/// A joint as read from the file; poses are relative to the outermost model.
#[derive(Debug)]
pub(super) struct JointEntry<'d> {
    pub(super) node: Node<'d, 'd>,
    pub(super) name: String,
    pub(super) kind: JointKind,
    /// Parent and child link.
    pub(super) between: [String; 2],
    pub(super) model_from_joint: Pose,
    pub(super) axis: Vec3,
    pub(super) limits: Limits,
    pub(super) mimic: Option<Mimic>,
}
