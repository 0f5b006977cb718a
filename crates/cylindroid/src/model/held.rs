//! What joints and contacts hold: their constraint selectors, written as unit wrenches.
//!
//! Formula  a row is a wrench [f; m] at the origin of the joint (contact) frame, in its axes; the
//!          pair holds f . v + m . w = 0 for the twist (v, w) of its second body relative to its
//!          first. A pair transmits exactly the sums of its rows
//! Shapes   (6 - freedoms) rows in space, (3 - freedoms) in the plane; forces before moments
//! Valid    joints: z is the axis. Contacts: x tangent (the line), y binormal, z normal. In the
//!          plane, joints lie in x-y of their frame, contacts in x-z of theirs
//! Why so   a helical joint couples a force with a moment, which selectors of separate linear and
//!          angular components cannot say; a wrench can, and power is the only product needed
//! Source   Bicchi & Prattichizzo 1998, tables 1 and 2 (FS, MS are the linear and angular parts;
//!          their "2D spherical" is the spatial spherical joint)
//! Checked  tests/it/graph.rs::held_*

use super::joint::JointKind;
use crate::error::{Error, Result};
use crate::spatial::{Rotation, Vec3, Wrench};
use crate::tolerance::ZERO_AXIS;

/// Where a mechanism moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Dimension {
    /// In the plane x-y of the world: two translations and the turn about z.
    Planar,
    /// In space.
    #[default]
    Spatial,
}

impl Dimension {
    /// 2 or 3, as in files.
    #[must_use]
    pub const fn number(self) -> usize {
        match self {
            Self::Planar => 2,
            Self::Spatial => 3,
        }
    }

    /// The components of a twist `[v; w]` or wrench `[f; m]` that a body has: in the plane x, y and
    /// the turn about z.
    #[must_use]
    pub const fn components(self) -> &'static [usize] {
        match self {
            Self::Planar => &[0, 1, 5],
            Self::Spatial => &[0, 1, 2, 3, 4, 5],
        }
    }

    /// Freedoms of a body: 3 in the plane, 6 in space.
    #[must_use]
    pub const fn freedoms(self) -> usize {
        self.components().len()
    }
}

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

    /// What the contact holds (table 1), in the contact frame.
    ///
    /// In the plane a soft finger is a hard finger, and a line with friction is complete.
    #[must_use]
    pub fn held(self, dimension: Dimension) -> Vec<Wrench> {
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
    /// What a joint of this kind about (or along) `axis` holds (table 2), in the joint frame.
    ///
    /// The rows hold where the joint is at zero. Away from it those of one-axis kinds and of
    /// planar and spherical joints are fixed in both bodies; the moment of a universal joint is
    /// normal to the first axis in its first body and the second axis in its second body.
    #[must_use]
    pub fn held(self, axis: Vec3, dimension: Dimension) -> Vec<Wrench> {
        let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
        let along = axis.unit(ZERO_AXIS).unwrap_or(z);
        if dimension == Dimension::Planar {
            return match self {
                Self::Fixed => rows(&[x, y], &[z]),
                Self::Prismatic => rows(&[z.cross(along)], &[z]),
                Self::Planar | Self::Free => Vec::new(),
                // Those that leave the plane hold in it what a revolute joint holds.
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
                let mut held = rows(&across, &across);
                held.push(Wrench { force: along, moment: along * -pitch });
                held
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
