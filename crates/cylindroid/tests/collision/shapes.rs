//! Random shapes, and robots made of them.

use cylindroid::model::{Builder, Collision, Geometry, JointKind, JointSpec, Limits, Link};
use cylindroid::{Mechanism, Pose, Vec3};

use crate::support::Random;

pub(crate) const KINDS: usize = 7;

/// A shape of the k-th kind, some decimetres large.
pub(crate) fn shape(random: &mut Random, kind: usize) -> Geometry {
    let mut length = || random.within(0.05, 0.3);
    match kind {
        0 => Geometry::Sphere { radius: length() },
        1 => Geometry::Capsule { radius: length(), length: 2.0 * length() },
        2 => Geometry::Box { size: Vec3::new(length(), length(), length()) },
        3 => Geometry::Cylinder { radius: length(), length: length() },
        4 => Geometry::Ellipsoid { radii: Vec3::new(length(), length(), length()) },
        5 => Geometry::ConvexHull { points: (0..60).map(|_| random.vec3(0.2)).collect() },
        _ => Geometry::HalfSpace,
    }
}

/// The shape with all lengths times a factor.
pub(crate) fn scaled(shape: &Geometry, by: f64) -> Geometry {
    match shape.clone() {
        Geometry::Sphere { radius } => Geometry::Sphere { radius: radius * by },
        Geometry::Capsule { radius, length } => {
            Geometry::Capsule { radius: radius * by, length: length * by }
        }
        Geometry::Box { size } => Geometry::Box { size: size * by },
        Geometry::Cylinder { radius, length } => {
            Geometry::Cylinder { radius: radius * by, length: length * by }
        }
        Geometry::Ellipsoid { radii } => Geometry::Ellipsoid { radii: radii * by },
        Geometry::ConvexHull { points } => {
            Geometry::ConvexHull { points: points.into_iter().map(|p| p * by).collect() }
        }
        other => other,
    }
}

/// An arm of n revolute joints, with one shape of each link and an obstacle's worth of kinds.
pub(crate) fn arm(random: &mut Random, kinds: &[usize]) -> Mechanism {
    let mut builder: Builder = Mechanism::builder("arm");
    let mut parent = "base".to_owned();
    for (i, kind) in kinds.iter().enumerate() {
        let name = format!("link{i}");
        let geometry = scaled(&shape(random, *kind), 0.5);
        let visual = Collision { link_from_shape: random.pose(), geometry, ..Collision::default() };
        let at = Pose {
            translation: visual.link_from_shape.translation * 0.05,
            ..visual.link_from_shape
        };
        let visual = Collision { link_from_shape: at, ..visual };
        builder.link(Link { collisions: vec![visual], ..Link::named(&name) });
        let joint = JointSpec::new(&format!("j{i}"), JointKind::Revolute, &parent, &name);
        builder.joint(JointSpec {
            parent_from_joint: Pose {
                rotation: random.rotation(),
                translation: random.vec3(1.0) * 0.4,
            },
            axis: Vec3::Z,
            limits: Limits { lower: -2.0, upper: 2.0, ..Limits::NONE },
            ..joint
        });
        parent = name;
    }
    builder.build().unwrap()
}
