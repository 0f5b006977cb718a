//! Bodies whose distance is known in closed form: the referee of the gaps.

use cylindroid::closure::{FingerContact, Friction};
use cylindroid::model::{ContactCurvature, SurfaceCurvature};
use cylindroid::spatial::{Pose, Rotation, Vec3};

/// The surface of a body at a contact; radii are negative for hollows.
#[derive(Debug, Clone, Copy)]
pub(super) enum Surface {
    Flat,
    /// A ball (in the plane a disc), a point for radius zero.
    Ball(f64),
    /// A cylinder about the axis, an edge for radius zero.
    Cylinder(f64, Vec3),
}

impl Surface {
    pub(super) fn curvature(self, normal: Vec3) -> SurfaceCurvature {
        match self {
            Self::Flat => SurfaceCurvature::FLAT,
            Self::Ball(radius) => SurfaceCurvature::uniform(1.0 / radius),
            Self::Cylinder(radius, axis) => {
                SurfaceCurvature { principal: [1.0 / radius, 0.0], direction: normal.cross(axis) }
            }
        }
    }
}

/// A finger and an object that touch.
#[derive(Debug, Clone, Copy)]
pub(super) struct Touch {
    pub(super) point: Vec3,
    pub(super) normal: Vec3,
    pub(super) finger: Surface,
    pub(super) object: Surface,
}

impl Touch {
    pub(super) fn contact(&self) -> FingerContact {
        FingerContact {
            point: self.point,
            normal: self.normal,
            friction: Friction::None,
            strength: 1.0,
            curvature: ContactCurvature {
                finger: self.finger.curvature(self.normal),
                object: self.object.curvature(self.normal),
            },
        }
    }

    /// The distance of the bodies, negative if they overlap, after a displacement of the object.
    pub(super) fn gap(&self, displaced: Pose) -> f64 {
        let (p, n) = (self.point, self.normal);
        let here = |x: Vec3| displaced * x;
        let turned = |x: Vec3| displaced.rotation * x;
        // Centres of curvature: of the finger behind the normal, of the object before it.
        let (f, o) = (|r: f64| p - n * r, |r: f64| here(p + n * r));
        let signed = |distance: f64, sum: f64| (distance - sum.abs()) * sum.signum();
        match (self.finger, self.object) {
            (Surface::Flat, Surface::Ball(r)) => n.dot(o(r) - p) - r,
            (Surface::Ball(r), Surface::Flat) => turned(n).dot(here(p) - f(r)) - r,
            (Surface::Ball(a), Surface::Ball(b)) if a + b != 0.0 => {
                signed((o(b) - f(a)).norm(), a + b)
            }
            (Surface::Ball(a), Surface::Cylinder(b, axis)) => {
                let (arm, axis) = (f(a) - o(b), turned(axis));
                signed((arm - axis * axis.dot(arm)).norm(), a + b)
            }
            (Surface::Cylinder(a, axis), Surface::Ball(b)) => {
                let arm = o(b) - f(a);
                signed((arm - axis * axis.dot(arm)).norm(), a + b)
            }
            (Surface::Cylinder(a, first), Surface::Cylinder(b, second)) => {
                let common = first.cross(turned(second));
                let common = common * (common.dot(n).signum() / common.norm());
                common.dot(o(b) - f(a)) - a - b
            }
            (finger, object) => panic!("{finger:?} and {object:?}"),
        }
    }
}

/// exp of a twist (in the plane three components) in world axes at `point`.
pub(super) fn displacement(twist: &[f64], point: Vec3) -> Pose {
    let (v, w) = match *twist {
        [x, y, w] => (Vec3::new(x, y, 0.0), Vec3::new(0.0, 0.0, w)),
        [x, y, z, a, b, c] => (Vec3::new(x, y, z), Vec3::new(a, b, c)),
        _ => panic!("{twist:?}"),
    };
    let angle = w.norm();
    // Chasles' integral of the velocity over the motion, by its series.
    let (s, c) = if angle < 1e-2 {
        let t = angle * angle;
        (1.0 / 6.0 - t / 120.0 + t * t / 5040.0, 0.5 - t / 24.0 + t * t / 720.0)
    } else {
        ((angle - angle.sin()) / angle.powi(3), (1.0 - angle.cos()) / (angle * angle))
    };
    let moved = v + w.cross(v) * c + w.cross(w.cross(v)) * s;
    let rotation = Rotation::exp(w);
    Pose { rotation, translation: point + moved - rotation * point }
}
