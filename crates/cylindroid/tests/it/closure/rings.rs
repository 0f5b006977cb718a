//! Single loops of revolute joints, given by their axes in one configuration.

use cylindroid::Mechanism;
use cylindroid::model::{Dimension, JointKind, JointSpec, LoopJointSpec};
use cylindroid::screws::Line;
use cylindroid::spatial::{Pose, Rotation, Vec3};

/// Links between neighbouring axes, the last axis back on the ground; the first joint is actuated.
pub(crate) fn ring(name: &str, axes: &[Line], dimension: Dimension) -> Mechanism {
    let mut b = Mechanism::builder(name);
    b.dimension(dimension);
    let link = |i: usize| if i == 0 { "ground".to_owned() } else { format!("l{i}") };
    let mut from = Vec3::ZERO;
    let last = axes.len() - 1;
    for (i, axis) in axes[..last].iter().enumerate() {
        b.joint(JointSpec {
            parent_from_joint: Pose::from_translation(axis.point - from),
            axis: axis.direction,
            actuated: i == 0,
            ..JointSpec::new(&format!("q{}", i + 1), JointKind::Revolute, &link(i), &link(i + 1))
        });
        from = axis.point;
    }
    b.loop_joint(LoopJointSpec {
        link_a_from_joint: Pose::from_translation(axes[last].point - from),
        link_b_from_joint: Pose::from_translation(axes[last].point),
        axis: axes[last].direction,
        ..LoopJointSpec::new(&format!("q{}", last + 1), JointKind::Revolute, &link(last), "ground")
    });
    b.reference(&link(last / 2 + 1));
    b.build().unwrap()
}

/// Axes along z through points on the x axis.
pub(crate) fn flat(places: &[f64]) -> Vec<Line> {
    places.iter().map(|x| Line { point: Vec3::new(*x, 0.0, 0.0), direction: Vec3::Z }).collect()
}

/// Bennett's linkage (1903): opposite links alike, a / sin alpha = b / sin beta, no offsets;
/// with the first joint at `theta`.
pub(crate) fn bennett(theta: f64) -> Vec<Line> {
    let (a, alpha, beta): (f64, f64, f64) = (1.0, 0.6, 1.1);
    let b = a * beta.sin() / alpha.sin();
    let ratio = (0.5 * (beta + alpha)).sin() / (0.5 * (beta - alpha)).sin();
    let second = 2.0 * (ratio / (0.5 * theta).tan()).atan();
    let about = |axis: Vec3, angle: f64| Rotation::about(axis, angle).unwrap();
    let mut world_from_joint = Pose::IDENTITY;
    let mut axes = Vec::new();
    for (angle, length, twist) in
        [(theta, a, alpha), (second, b, beta), (-theta, a, alpha), (-second, b, beta)]
    {
        axes.push(Line {
            point: world_from_joint.translation,
            direction: world_from_joint.rotation.z_axis(),
        });
        world_from_joint = world_from_joint
            * Pose::from_rotation(about(Vec3::Z, angle))
            * Pose::from_translation(Vec3::X * length)
            * Pose::from_rotation(about(Vec3::X, twist));
    }
    let end = world_from_joint.rotation.log().norm() + world_from_joint.translation.norm();
    assert!(end < 1e-12, "the linkage does not close: {end}");
    axes
}
