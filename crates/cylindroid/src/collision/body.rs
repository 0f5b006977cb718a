//! Bodies: the convex shapes of links and obstacles, made of their geometry.
//!
//! Checked  tests/collision/files.rs

use std::sync::Arc;

use super::capsule_fit;
use super::convex::{Convex, Core};
use super::hull::Hull;
use super::options::MeshShape;
use crate::error::Error;
use crate::model::{Geometry, mesh_file};
use crate::spatial::{Pose, Vec3};

/// A convex shape of a link or an obstacle.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// The name of its link or of the obstacle.
    pub name: String,
    /// The name of the shape in the file, often empty.
    pub shape: String,
    /// Index of its link; `None` for an obstacle.
    pub link: Option<usize>,
    /// Slot of the moving frame that carries it (0: ground), and its pose there.
    pub(super) slot: usize,
    pub(super) slot_from_body: Pose,
    pub(super) convex: Convex,
    /// Bits of its categories, and of those that it collides with.
    pub(super) category: u32,
    pub(super) mask: u32,
}

impl Body {
    /// Radius of the ball about its origin that contains it (m); infinite for a half-space.
    pub(super) fn bound(&self) -> f64 {
        self.convex.core.bound() + self.convex.radius
    }
}

/// An error about a shape.
pub(super) fn refused(option: &'static str, value: &str, reason: String) -> Error {
    Error::InvalidOption { option, value: value.to_owned(), reason }
}

/// The convex shape of a geometry and its pose there; the reason why there is none.
pub(super) fn convex(geometry: &Geometry, meshes: MeshShape) -> Result<(Convex, Pose), String> {
    let (shape, pose) = unbounded(geometry, meshes)?;
    let size = shape.core.bound() + shape.radius;
    if matches!(shape.core, Core::HalfSpace) || (size * size).is_finite() {
        return Ok((shape, pose));
    }
    Err("it is too large".to_owned())
}

/// [`convex`] of any size.
fn unbounded(geometry: &Geometry, meshes: MeshShape) -> Result<(Convex, Pose), String> {
    let lengths = |all: &[f64]| {
        if all.iter().all(|x| *x >= 0.0 && x.is_finite()) {
            return Ok(());
        }
        Err("a length of it is negative or not finite".to_owned())
    };
    let centered = |core, radius| Ok((Convex { core, radius }, Pose::IDENTITY));
    match geometry {
        Geometry::Sphere { radius } => {
            lengths(&[*radius])?;
            centered(Core::Point, *radius)
        }
        Geometry::Capsule { radius, length } => {
            lengths(&[*radius, *length])?;
            centered(Core::Segment { half: 0.5 * length }, *radius)
        }
        Geometry::Box { size } => {
            lengths(&size.to_array())?;
            centered(Core::Box { half: *size * 0.5 }, 0.0)
        }
        Geometry::Cylinder { radius, length } => {
            lengths(&[*radius, *length])?;
            centered(Core::Cylinder { radius: *radius, half: 0.5 * length }, 0.0)
        }
        Geometry::Ellipsoid { radii } => {
            lengths(&radii.to_array())?;
            if radii.x == radii.y && radii.y == radii.z {
                return centered(Core::Point, radii.x);
            }
            centered(Core::Ellipsoid { radii: *radii }, 0.0)
        }
        Geometry::HalfSpace => centered(Core::HalfSpace, 0.0),
        Geometry::ConvexHull { points } => {
            if points.iter().any(|p| !p.is_finite()) {
                return Err("a point of it is not finite".to_owned());
            }
            hull(points, MeshShape::ConvexHull)
        }
        Geometry::Mesh { uri, path, scale } => {
            let Some(path) = path else {
                return Err(format!("the file of mesh '{uri}' was not found"));
            };
            lengths(&scale.to_array().map(f64::abs))?;
            let scaled = |v: Vec3| Vec3::new(v.x * scale.x, v.y * scale.y, v.z * scale.z);
            let points: Vec<Vec3> =
                mesh_file::read(path)?.vertices.into_iter().map(scaled).collect();
            hull(&points, meshes)
        }
    }
}

fn hull(points: &[Vec3], meshes: MeshShape) -> Result<(Convex, Pose), String> {
    let (hull, center) = Hull::of(points).ok_or("it has no points")?;
    let at = Pose::from_translation(center);
    Ok(match meshes {
        MeshShape::ConvexHull => (Convex { core: Core::Hull(Arc::new(hull)), radius: 0.0 }, at),
        MeshShape::Capsule => {
            let capsule = capsule_fit::around(hull.vertices());
            let core = Core::Segment { half: capsule.half };
            (Convex { core, radius: capsule.radius }, at * capsule.pose)
        }
    })
}
