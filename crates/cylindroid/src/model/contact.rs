//! Contacts between links: their kinds, their frames, their specification for the builder.
//!
//! Source   Bicchi & Prattichizzo 1998, table 1
//! Checked  tests/it/graph.rs::held_by_contacts

use std::collections::BTreeMap;

use super::curvature::ContactCurvature;
use super::dimension::Dimension;
use super::loop_joint::ends;
use super::magnitude;
use crate::error::{Error, Result};
use crate::spatial::{Pose, Vec3};

/// The kind of a contact: the relative motions that it constrains.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ContactKind {
    /// A frictionless point: the normal velocity.
    PointFrictionless,
    /// A point with friction: the velocity of the point.
    HardFinger,
    /// A soft point: the velocity of the point and the rotation about the normal.
    SoftFinger,
    /// A frictionless line along x: the normal velocity and the rotation about y.
    LineFrictionless,
    /// A line along x with friction: all but the rotation about the line.
    LineFriction,
    /// A frictionless face: the normal velocity and the rotations about x and y. Spatial only.
    PlaneFrictionless,
    /// A firm grasp: all motions.
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

    /// The name in files and tables.
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

    /// True for contacts in a point.
    pub(crate) const fn is_point(self) -> bool {
        matches!(self, Self::PointFrictionless | Self::HardFinger | Self::SoftFinger)
    }

    /// The kind of a name.
    ///
    /// ```
    /// use cylindroid::model::ContactKind;
    ///
    /// assert_eq!(ContactKind::parse("soft_finger").ok(), Some(ContactKind::SoftFinger));
    /// assert!(ContactKind::parse("finger").is_err());
    /// ```
    ///
    /// # Errors
    /// [`Error::UnknownName`] with the nearest kinds.
    pub fn parse(name: &str) -> Result<Self> {
        let found = Self::ALL.into_iter().find(|k| k.name() == name);
        found.ok_or_else(|| Error::unknown("contact type", name, Self::ALL.map(Self::name)))
    }
}

/// A contact of two links.
#[derive(Debug, Clone, PartialEq)]
pub struct Contact {
    /// Its name.
    pub name: String,
    /// Its kind.
    pub kind: ContactKind,
    /// Index of the first link, a finger.
    pub a: usize,
    /// Index of the second link, the object.
    pub b: usize,
    /// The contact frame on the first link: origin at the point, x tangent, y binormal, z normal.
    /// By convention the normal points into the second link, so that pushing is positive.
    pub link_a_from_contact: Pose,
    /// The contact frame on the second link; the two frames coincide at the contact.
    pub link_b_from_contact: Pose,
    /// Coefficient of friction [-], where the file gives one.
    pub friction: Option<f64>,
    /// Curvature of both links, in the axes of the contact frame, where the file gives it.
    pub curvature: Option<ContactCurvature>,
}

/// The specification of a contact for the builder; links by name.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactSpec {
    /// Its name.
    pub name: String,
    /// Its kind.
    pub kind: ContactKind,
    /// Name of the first link, a finger.
    pub a: String,
    /// Name of the second link, the object.
    pub b: String,
    /// The contact frame on the first link: x tangent, y binormal, z normal.
    pub link_a_from_contact: Pose,
    /// The contact frame on the second link.
    pub link_b_from_contact: Pose,
    /// Coefficient of friction [-], not negative.
    pub friction: Option<f64>,
    /// Curvature of both links (of the first one as the finger), in the axes of the contact frame;
    /// for point contacts.
    pub curvature: Option<ContactCurvature>,
}

impl ContactSpec {
    /// A contact at the origins of both links, with its normal along z, without a coefficient
    /// of friction and without curvature.
    ///
    /// ```
    /// use cylindroid::Mechanism;
    /// use cylindroid::model::{ContactKind, ContactSpec, JointKind, JointSpec};
    ///
    /// let mut builder = Mechanism::builder("a finger on a free object");
    /// builder.joint(JointSpec::new("slide", JointKind::Prismatic, "base", "finger"));
    /// builder.joint(JointSpec::new("float", JointKind::Free, "base", "object"));
    /// builder.contact(ContactSpec::new("touch", ContactKind::HardFinger, "finger", "object"));
    /// assert_eq!(builder.build()?.contacts()[0].kind, ContactKind::HardFinger);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
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
            curvature: None,
        }
    }

    pub(super) fn resolve(
        &self,
        links: &BTreeMap<String, usize>,
        dimension: Dimension,
    ) -> std::result::Result<Contact, String> {
        let name = self.name.as_str();
        let (a, b) = ends("contact", name, [&self.a, &self.b], links)?;
        let places = [&self.link_a_from_contact, &self.link_b_from_contact];
        if let Some(fault) = places.into_iter().find_map(magnitude::pose_fault) {
            return Err(format!("the place of contact '{name}' {fault}"));
        }
        if self.friction.is_some_and(|mu| !(mu >= 0.0 && mu.is_finite())) {
            return Err(format!(
                "the friction of contact '{name}' must be finite and not negative"
            ));
        }
        if let Some(curvature) = self.curvature {
            if !self.kind.is_point() {
                return Err(format!(
                    "contact '{name}' is {}: only a point contact (point_frictionless, \
                     hard_finger, soft_finger) has a curvature; leave it out",
                    self.kind.name()
                ));
            }
            // In the plane, directions do not count.
            let planar = dimension == Dimension::Planar;
            curvature
                .check(if planar { Vec3::Y } else { Vec3::Z }, planar)
                .map_err(|message| format!("contact '{name}': {message}"))?;
        }
        if dimension == Dimension::Planar && self.kind == ContactKind::PlaneFrictionless {
            return Err(format!(
                "contact '{name}' is plane_frictionless, which the plane x-y does not have; \
                 use line_frictionless, which constrains the same motions there"
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
            curvature: self.curvature,
        })
    }
}
