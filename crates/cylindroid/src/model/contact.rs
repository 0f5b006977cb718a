//! Contacts between links: their kinds, their frames, their specification for the builder.
//!
//! Source   Bicchi & Prattichizzo 1998, table 1
//! Checked  tests/it/graph.rs::held_by_contacts

use std::collections::BTreeMap;

use super::dimension::Dimension;
use super::loop_joint::ends;
use crate::error::{Error, Result};
use crate::spatial::Pose;

/// What two touching bodies hold of each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ContactKind {
    /// A point that slides: the normal velocity.
    PointFrictionless,
    /// A point with friction: the velocity of the point.
    HardFinger,
    /// A soft point: the velocity of the point and the turn about the normal.
    SoftFinger,
    /// A line along x that slides: the normal velocity and the tilt about y.
    LineFrictionless,
    /// A line along x with friction: all but the roll about the line.
    LineFriction,
    /// A face that slides: the normal velocity and both tilts. Spatial only.
    PlaneFrictionless,
    /// A firm grasp: everything.
    Complete,
}

impl ContactKind {
    /// All kinds.
    pub const ALL: [Self; 7] = [
        Self::PointFrictionless,
        Self::HardFinger,
        Self::SoftFinger,
        Self::LineFrictionless,
        Self::LineFriction,
        Self::PlaneFrictionless,
        Self::Complete,
    ];

    /// The word for it, as in files and tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::PointFrictionless => "point_frictionless",
            Self::HardFinger => "hard_finger",
            Self::SoftFinger => "soft_finger",
            Self::LineFrictionless => "line_frictionless",
            Self::LineFriction => "line_friction",
            Self::PlaneFrictionless => "plane_frictionless",
            Self::Complete => "complete",
        }
    }

    /// The kind of a word.
    ///
    /// # Errors
    /// [`Error::UnknownName`] with the nearest kinds.
    pub fn parse(name: &str) -> Result<Self> {
        let found = Self::ALL.into_iter().find(|k| k.name() == name);
        found.ok_or_else(|| Error::unknown("contact type", name, Self::ALL.map(Self::name)))
    }
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
    ) -> std::result::Result<Contact, String> {
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
