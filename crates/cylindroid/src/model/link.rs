//! Links, with the shapes and masses of the file (kept as data: kinematics does not use them, `collision` does).

use std::path::PathBuf;

use super::magnitude;
use crate::spatial::{Mat3, Pose, Vec3};

/// A rigid body of a mechanism.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Link {
    /// Its name.
    pub name: String,
    /// Shapes for display.
    pub visuals: Vec<Visual>,
    /// Shapes for collision.
    pub collisions: Vec<Collision>,
    /// Its mass, if the file gives one.
    pub inertial: Option<Inertial>,
}

impl Link {
    /// A link with a name only.
    #[must_use]
    pub fn named(name: &str) -> Self {
        Self { name: name.to_owned(), ..Self::default() }
    }

    /// Why no mechanism has such a link.
    pub(super) fn fault(&self) -> Option<String> {
        if self.name.is_empty() {
            return Some("a link has no name; give every link one".into());
        }
        let Inertial { mass, link_from_inertia, inertia } = self.inertial.as_ref()?;
        let name = &self.name;
        if *mass < 0.0 {
            return Some(format!("the mass of link '{name}' is {mass} kg; a mass is not negative"));
        }
        let numbers = [&[*mass], inertia.to_rows().as_flattened()].concat();
        let fault = magnitude::fault(&numbers).or_else(|| magnitude::pose_fault(link_from_inertia));
        Some(format!("the mass, inertia or pose of the inertia of link '{name}' {}", fault?))
    }
}

/// A shape fixed to a link; by default a sphere without extent.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Visual {
    /// Its name, often empty.
    pub name: String,
    /// Its pose on the link.
    pub link_from_shape: Pose,
    /// The shape.
    pub geometry: Geometry,
    /// Colour red, green, blue, alpha in [0, 1], if the file gives one.
    pub rgba: Option<[f64; 4]>,
}

/// A shape of a link for distances and collisions. Two shapes can collide if the category of either
/// is in the mask of the other.
#[derive(Debug, Clone, PartialEq)]
pub struct Collision {
    /// Its name, often empty.
    pub name: String,
    /// Its pose on the link.
    pub link_from_shape: Pose,
    /// The shape.
    pub geometry: Geometry,
    /// Bits of its categories (`contype` of MJCF); 1 by default.
    pub category: u32,
    /// Bits of the categories that it collides with (`conaffinity` of MJCF); 1 by default.
    pub mask: u32,
}

impl Default for Collision {
    fn default() -> Self {
        Visual::default().into()
    }
}

impl From<Visual> for Collision {
    fn from(shape: Visual) -> Self {
        let Visual { name, link_from_shape, geometry, rgba: _ } = shape;
        Self { name, link_from_shape, geometry, category: 1, mask: 1 }
    }
}

/// A shape.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Geometry {
    /// A box with these edges (m).
    Box {
        /// Edges along x, y, z.
        size: Vec3,
    },
    /// A cylinder along z, centred (m).
    Cylinder {
        /// Radius.
        radius: f64,
        /// Length along z.
        length: f64,
    },
    /// A cylinder along z with hemispherical ends (m).
    Capsule {
        /// Radius.
        radius: f64,
        /// Length of the cylinder alone.
        length: f64,
    },
    /// A sphere (m).
    Sphere {
        /// Radius.
        radius: f64,
    },
    /// An ellipsoid (m).
    Ellipsoid {
        /// Semi-axes along x, y, z.
        radii: Vec3,
    },
    /// The half-space z <= 0, whose surface is the plane z = 0.
    HalfSpace,
    /// The convex hull of points.
    ConvexHull {
        /// The points (m).
        points: Vec<Vec3>,
    },
    /// A mesh in a file of its own.
    Mesh {
        /// The name in the model file (`package://...`).
        uri: String,
        /// The file, if it was found.
        path: Option<PathBuf>,
        /// Scale along x, y, z.
        scale: Vec3,
    },
}

impl Default for Geometry {
    fn default() -> Self {
        Self::Sphere { radius: 0.0 }
    }
}

/// Mass and moments of inertia of a link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inertial {
    /// Mass (kg).
    pub mass: f64,
    /// Centre of mass, and the axes in which the inertia is given.
    pub link_from_inertia: Pose,
    /// Inertia about the centre of mass [kg m^2].
    pub inertia: Mat3,
}
