//! Distance of two convex shapes: closest points, signed distance, unit normal.
//!
//! Formula  distance = (distance of the cores) - r_a - r_b;
//!          point_b - point_a = distance * normal
//! Units    m
//! Frame    world
//! Valid    all pairs of shapes but two half-spaces; negative: the length of the shortest
//!          translation that separates the shapes. The normal jumps where that translation is not
//!          unique
//! Checked  tests/collision/laws.rs, tests/collision/coal.rs

use super::closed_form;
use super::convex::{Core, Placed};
use super::gjk::Gjk;
use super::separation::Separation;
use crate::error::{Error, Result};
use crate::model::Geometry;
use crate::spatial::Pose;

/// The separation of two shapes at their poses in the world.
///
/// ```
/// use cylindroid::collision::distance;
/// use cylindroid::model::Geometry;
/// use cylindroid::{Pose, Vec3};
///
/// let ball = Geometry::Sphere { radius: 0.1 };
/// let table = Geometry::Box { size: Vec3::new(1.0, 1.0, 0.2) };
/// let above = Pose::from_translation(Vec3::Z * 0.5);
/// let it = distance((&ball, above), (&table, Pose::IDENTITY))?;
/// assert!((it.distance - 0.3).abs() < 1e-15);
/// assert_eq!(it.normal, -Vec3::Z);
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// # Errors
/// [`Error::InvalidOption`] for a shape without extent, a mesh that cannot be read, or two
/// half-spaces; [`Error::NotFinite`] for a pose.
pub fn distance(a: (&Geometry, Pose), b: (&Geometry, Pose)) -> Result<Separation> {
    let convex = |(geometry, pose): (&Geometry, Pose), what: &str| {
        Error::check_finite(what, pose.to_matrix().as_flattened())?;
        let (shape, center) = super::body::convex(geometry, Default::default())
            .map_err(|reason| super::body::refused("shape", what, reason))?;
        Ok::<_, Error>((shape, pose * center))
    };
    let (first, second) = (convex(a, "pose of a")?, convex(b, "pose of b")?);
    if matches!((&first.0.core, &second.0.core), (Core::HalfSpace, Core::HalfSpace)) {
        return Err(super::body::refused("shape", "b", "two half-spaces have no distance".into()));
    }
    let a = Placed { shape: &first.0, world_from_shape: &first.1 };
    let b = Placed { shape: &second.0, world_from_shape: &second.1 };
    Ok(separation(a, b, &mut Gjk::default()))
}

/// The separation of two shapes, of which at most one is a half-space.
#[inline]
pub(super) fn separation(a: Placed<'_>, b: Placed<'_>, gjk: &mut Gjk) -> Separation {
    let cores = if closed_form::is_reversed(a, b) {
        closed_form::separation(b, a).map(Separation::reversed)
    } else {
        closed_form::separation(a, b)
    };
    let cores = cores.unwrap_or_else(|| gjk.separation(a, b));
    let (r, s, n) = (a.shape.radius, b.shape.radius, cores.normal);
    Separation {
        distance: cores.distance - r - s,
        point_a: cores.point_a + n * r,
        point_b: cores.point_b - n * s,
        normal: n,
    }
}
