//! Constraint wrenches of joints and contacts: the wrenches that they transmit, and along which
//! they constrain motion.
//!
//! Formula  a row is a wrench [f; m] at the origin of the joint (contact) frame, in its axes; the
//!          pair constrains f . v + m . w = 0 for the twist (v, w) of its second body relative to
//!          its first. A pair transmits exactly the linear combinations of its rows
//! Shapes   (6 - freedoms) rows in space, (3 - freedoms) in the plane; forces before moments
//! Valid    joints: z is the axis. Contacts: x tangent (the line), y binormal, z normal. In the
//!          plane, joints lie in x-y of their frame, contacts in x-z of theirs
//! Why so   a helical joint couples a force with a moment, which selectors of separate linear and
//!          angular components cannot express; a wrench can, and power is the only product needed
//! Source   Bicchi & Prattichizzo 1998, tables 1 and 2 (FS, MS are the linear and angular parts;
//!          their "2D spherical" is the spatial spherical joint)
//! Checked  tests/it/graph.rs

use super::contact::ContactKind;
use super::dimension::Dimension;
use super::joint::JointKind;
use crate::spatial::{Rotation, Vec3, Wrench};
use crate::tolerance::ZERO_AXIS;

impl ContactKind {
    /// The constraint wrenches of the contact (table 1), in the contact frame.
    ///
    /// In the plane a soft finger is a hard finger, and a line with friction is complete.
    ///
    /// ```
    /// use cylindroid::model::{ContactKind, Dimension};
    ///
    /// let rows = |kind: ContactKind| kind.constraint_wrenches(Dimension::Spatial).len();
    /// assert_eq!((rows(ContactKind::HardFinger), rows(ContactKind::SoftFinger)), (3, 4));
    /// ```
    #[must_use]
    pub fn constraint_wrenches(self, dimension: Dimension) -> Vec<Wrench> {
        let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
        let (linear, angular): (&[Vec3], &[Vec3]) = match self {
            Self::PointFrictionless => (&[z], &[]),
            Self::HardFinger => (&[x, y, z], &[]),
            Self::SoftFinger => (&[x, y, z], &[z]),
            Self::LineFrictionless => (&[z], &[y]),
            Self::LineFriction => (&[x, y, z], &[y, z]),
            Self::PlaneFrictionless => (&[z], &[x, y]),
            Self::Complete => (&[x, y, z], &[x, y, z]),
        };
        let kept = |row: &Wrench| match dimension {
            Dimension::Spatial => true,
            // The plane is x-z: forces in it, moments about y.
            Dimension::Planar => [row.force.y, row.moment.x, row.moment.z] == [0.0; 3],
        };
        rows(linear, angular).into_iter().filter(kept).collect()
    }
}

impl JointKind {
    /// The constraint wrenches of a joint of this kind about (or along) `axis` (table 2), in the
    /// joint frame.
    ///
    /// ```
    /// use cylindroid::Vec3;
    /// use cylindroid::model::{Dimension, JointKind};
    ///
    /// assert_eq!(JointKind::Revolute.constraint_wrenches(Vec3::Z, Dimension::Spatial).len(), 5);
    /// ```
    ///
    /// They are valid at the zero of the joint. Away from it, those of one-axis kinds and of planar
    /// and spherical joints are fixed in both bodies; the moment of a universal joint is normal to
    /// the first axis in its first body and to the second axis in its second body.
    #[must_use]
    pub fn constraint_wrenches(self, axis: Vec3, dimension: Dimension) -> Vec<Wrench> {
        let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
        let along = axis.unit(ZERO_AXIS).unwrap_or(z);
        if dimension == Dimension::Planar {
            return match self {
                Self::Fixed => rows(&[x, y], &[z]),
                Self::Prismatic => rows(&[z.cross(along)], &[z]),
                Self::Planar | Self::Free => Vec::new(),
                // Kinds that leave the plane constrain in it what a revolute joint constrains.
                _ => rows(&[x, y], &[]),
            };
        }
        let frame = Rotation::z_to(along).unwrap_or(Rotation::IDENTITY);
        let across = [frame.x_axis(), frame.y_axis()];
        match self {
            Self::Fixed => rows(&[x, y, z], &[x, y, z]),
            Self::Revolute | Self::Continuous => rows(&[x, y, z], &across),
            Self::Prismatic => rows(&across, &[x, y, z]),
            Self::Helical { pitch } => {
                let mut wrenches = rows(&across, &across);
                wrenches.push(Wrench { force: along, moment: along * -pitch });
                wrenches
            }
            Self::Cylindrical => rows(&across, &across),
            Self::Universal { second } => {
                let normal = along.cross(second).unit(ZERO_AXIS).unwrap_or(frame.x_axis());
                rows(&[x, y, z], &[normal])
            }
            Self::Spherical => rows(&[x, y, z], &[]),
            Self::Planar => rows(&[along], &across),
            Self::Free => Vec::new(),
        }
    }
}

fn rows(linear: &[Vec3], angular: &[Vec3]) -> Vec<Wrench> {
    let force = |f: &Vec3| Wrench { force: *f, moment: Vec3::ZERO };
    let moment = |m: &Vec3| Wrench { force: Vec3::ZERO, moment: *m };
    linear.iter().map(force).chain(angular.iter().map(moment)).collect()
}
