//! What makes a graph of a tree: joints that close loops, and contacts.
//!
//! A closing joint has no coordinate in `q`. It is at zero where its two frames coincide, and
//! holds what its kind holds ([`JointKind::held`]) wherever the tree goes.

use std::collections::BTreeMap;

use super::held::{ContactKind, Dimension};
use super::joint::{JointKind, Limits};
use super::spec;
use crate::error::Error;
use crate::spatial::{Pose, Vec3};
use crate::tolerance::ZERO_AXIS;

/// A joint that closes a loop of the tree.
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
    /// The joint frame on the second link; both coincide where the joint is closed and at zero.
    pub link_b_from_joint: Pose,
    /// Unit axis in the joint frame (z where the kind has none); the second one of a universal
    /// joint stands in its kind.
    pub axis: Vec3,
    /// Limits as in the file; those of a joint with several coordinates hold for each.
    pub limits: Limits,
    /// True if a motor drives it.
    pub actuated: bool,
}

/// Two links that touch.
#[derive(Debug, Clone, PartialEq)]
pub struct Contact {
    /// Its name.
    pub name: String,
    /// What it holds.
    pub kind: ContactKind,
    /// Index of the link that touches.
    pub a: usize,
    /// Index of the link that is touched: the object.
    pub b: usize,
    /// The contact frame on the first link: origin at the point, x tangent, y binormal, z normal.
    /// By convention the normal points into the second link, so that pushing is positive.
    pub link_a_from_contact: Pose,
    /// The contact frame on the second link; both coincide where the links touch.
    pub link_b_from_contact: Pose,
    /// Coefficient of friction [-], where the file gives one.
    pub friction: Option<f64>,
}

/// A closing joint as the builder takes it; links by name.
#[derive(Debug, Clone, PartialEq)]
pub struct LoopSpec {
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
    /// True if a motor drives it.
    pub actuated: bool,
}

impl LoopSpec {
    /// A passive joint about (or along) z at the origins of both links, without limits.
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
        if !(self.link_a_from_joint.is_finite() && self.link_b_from_joint.is_finite()) {
            return Err(format!("the place of joint '{name}' is not finite"));
        }
        if let Some(fault) = spec::fault(name, self.kind, self.axis, &self.limits, dimension) {
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

/// A contact as the builder takes it; links by name.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactSpec {
    /// Its name.
    pub name: String,
    /// What it holds.
    pub kind: ContactKind,
    /// Name of the link that touches.
    pub a: String,
    /// Name of the link that is touched.
    pub b: String,
    /// The contact frame on the first link: x tangent, y binormal, z normal.
    pub link_a_from_contact: Pose,
    /// The contact frame on the second link.
    pub link_b_from_contact: Pose,
    /// Coefficient of friction [-], not negative.
    pub friction: Option<f64>,
}

impl ContactSpec {
    /// A contact at the origins of both links, its normal along z, friction not given.
    #[must_use]
    pub fn new(name: &str, kind: ContactKind, a: &str, b: &str) -> Self {
        Self {
            name: name.to_owned(),
            kind,
            a: a.to_owned(),
            b: b.to_owned(),
            link_a_from_contact: Pose::IDENTITY,
            link_b_from_contact: Pose::IDENTITY,
            friction: None,
        }
    }

    pub(super) fn resolve(
        &self,
        links: &BTreeMap<String, usize>,
        dimension: Dimension,
    ) -> Result<Contact, String> {
        let name = self.name.as_str();
        let (a, b) = ends("contact", name, [&self.a, &self.b], links)?;
        if !(self.link_a_from_contact.is_finite() && self.link_b_from_contact.is_finite()) {
            return Err(format!("the place of contact '{name}' is not finite"));
        }
        if self.friction.is_some_and(|mu| !(mu >= 0.0 && mu.is_finite())) {
            return Err(format!("the friction of contact '{name}' is not a number from 0 on"));
        }
        if dimension == Dimension::Planar && self.kind == ContactKind::PlaneFrictionless {
            return Err(format!(
                "contact '{name}' is plane_frictionless, which the plane x-y does not have; \
                 line_frictionless holds the same there"
            ));
        }
        Ok(Contact {
            name: self.name.clone(),
            kind: self.kind,
            a,
            b,
            link_a_from_contact: self.link_a_from_contact,
            link_b_from_contact: self.link_b_from_contact,
            friction: self.friction,
        })
    }
}

/// The indices of two different links.
fn ends(
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
