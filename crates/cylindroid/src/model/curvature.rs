//! Curvature of the two bodies at a contact point.
//!
//! Formula  in the contact frame (z: the normal into the object) the finger is z = -1/2 x^T K_f x,
//!          the object z = 1/2 x^T K_o x; the eigenvalues of K are the principal curvatures
//! Shapes   K: 2 x 2 in space, a number in the plane
//! Units    1/m: positive for a convex body, negative for a concave one, zero for a flat one,
//!          infinite for a sharp point or edge
//! Frame    the direction of the first principal curvature in any axes, those of the normal
//! Valid    K_f + K_o positive definite: otherwise the bodies overlap, or touch along a line.
//!          Without data, a finger is a sharp point and an object is flat
//! Why so   principal curvatures instead of a matrix: those of sharp edges are infinite
//! Source   Rimon & Burdick 1998, part I, section III
//! Checked  tests/it/closure/grasp_mobility/mod.rs::curvatures_*

use crate::spatial::{Rotation, Vec3};
use crate::tolerance::{CONFORMING, ZERO_AXIS};

/// The curvature of a body at a contact point (1/m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceCurvature {
    /// Principal curvatures (1/m): positive for a convex body, zero for a flat one, infinite for a
    /// sharp point or edge. In the plane only the first one counts.
    pub principal: [f64; 2],
    /// The direction of the first principal curvature; its component along the normal does not
    /// count, and none of it for equal curvatures.
    pub direction: Vec3,
}

impl SurfaceCurvature {
    /// A flat face.
    pub const FLAT: Self = Self::uniform(0.0);
    /// A sharp point.
    pub const POINT: Self = Self::uniform(f64::INFINITY);

    /// The same curvature in all directions (1/m): a ball of radius `1 / curvature`.
    ///
    /// ```
    /// use cylindroid::model::SurfaceCurvature;
    ///
    /// assert_eq!(SurfaceCurvature::uniform(0.0), SurfaceCurvature::FLAT);
    /// assert_eq!(SurfaceCurvature::uniform(20.0).principal, [20.0, 20.0]);
    /// ```
    #[must_use]
    pub const fn uniform(curvature: f64) -> Self {
        Self { principal: [curvature; 2], direction: Vec3::ZERO }
    }

    /// The body in axes rotated by `rotation`.
    #[must_use]
    pub fn rotated(self, rotation: Rotation) -> Self {
        Self { direction: rotation * self.direction, ..self }
    }

    /// Principal directions (unit vectors in the tangent plane) and curvatures: one in the plane,
    /// two in space. None if the direction is along the normal.
    pub(crate) fn along(self, normal: Vec3, planar: bool) -> Option<Vec<(Vec3, f64)>> {
        let [first, second] = self.principal;
        if planar {
            return Some(vec![(Vec3::new(normal.y, -normal.x, 0.0), first)]);
        }
        let tangent = if first == second {
            Rotation::z_to(normal)?.x_axis()
        } else {
            (self.direction - normal * normal.dot(self.direction)).unit(ZERO_AXIS)?
        };
        Some(vec![(tangent, first), (normal.cross(tangent), second)])
    }
}

/// The curvature of both bodies at a contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactCurvature {
    /// Of the finger: the first link of a contact.
    pub finger: SurfaceCurvature,
    /// Of the object: the second link of a contact.
    pub object: SurfaceCurvature,
}

impl Default for ContactCurvature {
    /// A sharp finger on a flat face of the object.
    fn default() -> Self {
        Self { finger: SurfaceCurvature::POINT, object: SurfaceCurvature::FLAT }
    }
}

impl ContactCurvature {
    /// The same contact with finger and object exchanged.
    #[must_use]
    pub fn exchanged(self) -> Self {
        Self { finger: self.object, object: self.finger }
    }

    /// The bodies in axes rotated by `rotation`.
    #[must_use]
    pub fn rotated(self, rotation: Rotation) -> Self {
        Self { finger: self.finger.rotated(rotation), object: self.object.rotated(rotation) }
    }

    /// Refuses bodies that do not touch in an isolated point with a normal.
    pub(crate) fn check(self, normal: Vec3, planar: bool) -> Result<(), String> {
        let mut bodies = Vec::new();
        for (body, name) in [(self.finger, "first"), (self.object, "second")] {
            let used = if planar { &body.principal[..1] } else { &body.principal[..] };
            if let Some(k) = used.iter().find(|k| k.is_nan() || **k == f64::NEG_INFINITY) {
                return Err(format!(
                    "the curvature of the {name} body is {k}; give a number [1/m], or inf for a \
                     sharp point or edge"
                ));
            }
            bodies.push(body.along(normal, planar).ok_or_else(|| {
                format!(
                    "the direction of the {name} body's curvature is along the normal or zero; \
                     give a direction in the tangent plane"
                )
            })?);
        }
        let sharp: Vec<Vec3> =
            bodies.iter().flatten().filter(|(_, k)| k.is_infinite()).map(|(d, _)| *d).collect();
        let sharp_of = |body: &[(Vec3, f64)]| body.iter().filter(|(_, k)| k.is_infinite()).count();
        let each = [sharp_of(&bodies[0]), sharp_of(&bodies[1])];
        let n = bodies[0].len();
        let crossed = each == [1, 1] && n == 2 && sharp[0].cross(sharp[1]).norm() > ZERO_AXIS;
        if sharp.len() > n || (each[0].min(each[1]) > 0 && !crossed) {
            return Err("both bodies are sharp, which determines no normal; give one of them a \
                        finite curvature"
                .to_owned());
        }
        let finite = bodies.iter().flatten().filter(|(_, k)| k.is_finite());
        let size: f64 = finite.map(|(_, k)| k.abs()).sum();
        let least = least_sum(&bodies[0], &bodies[1], normal);
        if least > CONFORMING * size {
            return Ok(());
        }
        let alternative = if planar { "line_frictionless" } else { "a line or plane contact" };
        Err(format!(
            "its curvatures sum to {least} 1/m: a positive sum is needed in all directions, \
             otherwise the bodies overlap or touch along a line (for which there is {alternative})"
        ))
    }
}

/// Smallest sum of both curvatures over the tangent directions in which both are finite; infinite
/// if there are none.
fn least_sum(a: &[(Vec3, f64)], b: &[(Vec3, f64)], normal: Vec3) -> f64 {
    let along = |body: &[(Vec3, f64)], u: Vec3, v: Vec3| -> f64 {
        let finite = body.iter().filter(|(_, k)| k.is_finite());
        finite.map(|(d, k)| k * d.dot(u) * d.dot(v)).sum()
    };
    let sum = |u: Vec3, v: Vec3| along(a, u, v) + along(b, u, v);
    let sharp: Vec<Vec3> =
        a.iter().chain(b).filter(|(_, k)| k.is_infinite()).map(|(d, _)| *d).collect();
    match (a.len() - sharp.len().min(a.len()), a.len()) {
        (0, _) => f64::INFINITY,
        (1, 1) => sum(a[0].0, a[0].0),
        (1, _) => {
            let free = normal.cross(sharp[0]);
            sum(free, free)
        }
        _ => {
            let (u, v) = (a[0].0, a[1].0);
            let (p, q, r) = (sum(u, u), sum(u, v), sum(v, v));
            0.5 * (p + r) - (0.5 * (p - r)).hypot(q)
        }
    }
}
