//! Loop joints (loop-closure joints): the joints that close loops of the spanning tree.
//!
//! A loop joint has no coordinate in `q`. It is at zero when its two frames coincide, and
//! constrains the relative motion of its links by its [`JointKind::constraint_wrenches`].
//!
//! Checked  tests/it/closure/graph.rs, tests/formats/closed_file.rs

use std::collections::BTreeMap;

use super::dimension::Dimension;
use super::joint::{JointKind, Limits};
use super::joint_spec;
use super::magnitude;
use crate::error::Error;
use crate::spatial::{Pose, Vec3};
use crate::tolerance::ZERO_AXIS;

/// A loop joint: it closes a loop of the spanning tree.
#[derive(Debug, Clone, PartialEq)]
pub struct LoopJoint {
    /// Its name; no joint of the tree has the same.
    pub name: String,
    /// Its kind.
    pub kind: JointKind,
    /// Index of its first link: the joint's motion is that of `b` relative to `a`.
    pub a: usize,
    /// Index of its second link.
    pub b: usize,
    /// The joint frame on the first link.
    pub link_a_from_joint: Pose,
    /// The joint frame on the second link; the two frames coincide when the loop is closed and the
    /// joint at zero.
    pub link_b_from_joint: Pose,
    /// Unit axis in the joint frame (z if the kind has none); the second axis of a universal joint
    /// is in its kind.
    pub axis: Vec3,
    /// Limits as in the file; those of a joint with several coordinates apply to each.
    pub limits: Limits,
    /// True if it is actuated.
    pub actuated: bool,
}

/// The specification of a loop joint for the builder; links by name.
#[derive(Debug, Clone, PartialEq)]
pub struct LoopJointSpec {
    /// Its name.
    pub name: String,
    /// Its kind.
    pub kind: JointKind,
    /// Name of its first link.
    pub a: String,
    /// Name of its second link.
    pub b: String,
    /// The joint frame on the first link.
    pub link_a_from_joint: Pose,
    /// The joint frame on the second link.
    pub link_b_from_joint: Pose,
    /// The axis in the joint frame, any length.
    pub axis: Vec3,
    /// Its limits.
    pub limits: Limits,
    /// True if it is actuated.
    pub actuated: bool,
}

/// The name of the weld of a half of a link (`closing_joint.rs`).
pub(super) fn weld_of(half: &str) -> String {
    format!("{half}.weld")
}

impl LoopJoint {
    /// True for the weld of a half, with the name of its first link.
    pub(crate) fn is_cut(&self, first: &str) -> bool {
        self.kind == JointKind::Fixed && self.name == weld_of(first)
    }
}

impl LoopJointSpec {
    /// A passive joint about (or along) z at the origins of both links, without limits.
    ///
    /// ```
    /// use cylindroid::model::{JointKind, JointSpec, LoopJointSpec, Mechanism};
    /// use cylindroid::{Pose, Vec3};
    ///
    /// // A parallelogram: two cranks of 0.5 m on pivots 1 m apart, and a coupler of 1 m.
    /// let hinge = |name: &str, parent: &str, child: &str, x: f64, y: f64| JointSpec {
    ///     parent_from_joint: Pose::from_translation(Vec3::new(x, y, 0.0)),
    ///     ..JointSpec::new(name, JointKind::Revolute, parent, child)
    /// };
    /// let mut builder = Mechanism::builder("parallelogram");
    /// builder.joint(hinge("crank", "base", "left", 0.0, 0.0));
    /// builder.joint(hinge("elbow", "left", "coupler", 0.0, 0.5));
    /// builder.joint(hinge("rocker", "base", "right", 1.0, 0.0));
    /// builder.loop_joint(LoopJointSpec {
    ///     link_a_from_joint: Pose::from_translation(Vec3::X),
    ///     link_b_from_joint: Pose::from_translation(Vec3::new(0.0, 0.5, 0.0)),
    ///     ..LoopJointSpec::new("closure", JointKind::Revolute, "coupler", "right")
    /// });
    /// let mechanism = builder.build()?;
    /// assert!(mechanism.is_closed() && mechanism.loops().len() == 1);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[must_use]
    pub fn new(name: &str, kind: JointKind, a: &str, b: &str) -> Self {
        Self {
            name: name.to_owned(),
            kind,
            a: a.to_owned(),
            b: b.to_owned(),
            link_a_from_joint: Pose::IDENTITY,
            link_b_from_joint: Pose::IDENTITY,
            axis: Vec3::Z,
            limits: Limits::NONE,
            actuated: false,
        }
    }

    pub(super) fn resolve(
        &self,
        links: &BTreeMap<String, usize>,
        dimension: Dimension,
    ) -> Result<LoopJoint, String> {
        let name = self.name.as_str();
        let (a, b) = ends("joint", name, [&self.a, &self.b], links)?;
        let places = [&self.link_a_from_joint, &self.link_b_from_joint];
        if let Some(fault) = places.into_iter().find_map(magnitude::pose_fault) {
            return Err(format!("the place of joint '{name}' {fault}"));
        }
        if let Some(fault) = joint_spec::fault(name, self.kind, self.axis, &self.limits, dimension)
        {
            return Err(fault);
        }
        Ok(LoopJoint {
            name: self.name.clone(),
            kind: self.kind,
            a,
            b,
            link_a_from_joint: self.link_a_from_joint,
            link_b_from_joint: self.link_b_from_joint,
            axis: self.axis.unit(ZERO_AXIS).unwrap_or(Vec3::Z),
            limits: self.limits,
            actuated: self.actuated,
        })
    }
}

/// The indices of two different links.
pub(super) fn ends(
    what: &str,
    name: &str,
    [a, b]: [&String; 2],
    links: &BTreeMap<String, usize>,
) -> Result<(usize, usize), String> {
    if a == b {
        return Err(format!("{what} '{name}' connects link '{a}' with itself"));
    }
    let index = |link: &String| {
        links.get(link).copied().ok_or_else(|| {
            let unknown = Error::unknown("link", link, links.keys());
            format!("{what} '{name}': {unknown}")
        })
    };
    Ok((index(a)?, index(b)?))
}
