//! Forward kinematics written the long way, from the public data of a mechanism alone: what the
//! loaders wrote is checked without the kinematics of the library.

use cylindroid::model::{Joint, JointKind};
use cylindroid::{Mechanism, Pose, Rotation, Vec3};

/// Pose of a frame in the root, for this q.
pub(crate) fn frame(m: &Mechanism, q: &[f64], name: &str) -> Pose {
    let frame = m.frame_of(m.frame(name).unwrap());
    link(m, q, frame.link) * frame.link_from_frame
}

/// Loop joints and contacts coincide at home: both links put their frame at the same place.
#[track_caller]
pub(crate) fn closed_at_home(m: &Mechanism, tolerance: f64) {
    let on = |l: usize| link(m, m.home(), l);
    for l in m.loops() {
        assert_close(on(l.a) * l.link_a_from_joint, on(l.b) * l.link_b_from_joint, tolerance);
    }
    for c in m.contacts() {
        assert_close(on(c.a) * c.link_a_from_contact, on(c.b) * c.link_b_from_contact, tolerance);
    }
}

pub(crate) fn tool(m: &Mechanism, q: &[f64]) -> Pose {
    frame(m, q, &m.frame_of(m.tool()).name)
}

fn link(m: &Mechanism, q: &[f64], index: usize) -> Pose {
    match m.joints().iter().find(|j| j.child == index) {
        None => Pose::IDENTITY,
        Some(j) => {
            let motion = motion(m, j, q);
            let motion = if j.reversed { motion.inverse() } else { motion };
            link(m, q, j.parent) * j.parent_from_joint * motion * j.joint_from_child
        }
    }
}

/// The position of a joint of one coordinate, through its chain of mimics.
fn value(m: &Mechanism, joint: &Joint, q: &[f64]) -> f64 {
    match &joint.mimic {
        None => q[joint.coordinates.start],
        Some(mimic) => {
            let source = m.joints().iter().find(|j| j.name == mimic.joint).unwrap();
            mimic.multiplier * value(m, source, q) + mimic.offset
        }
    }
}

fn turn(axis: Vec3, angle: f64) -> Pose {
    Pose::from_rotation(Rotation::about(axis, angle).unwrap())
}

fn slide(axis: Vec3, length: f64) -> Pose {
    Pose::from_translation(axis * length)
}

fn motion(m: &Mechanism, joint: &Joint, q: &[f64]) -> Pose {
    let c = joint.coordinates.clone();
    let axis = joint.axis;
    match joint.kind {
        JointKind::Fixed => Pose::IDENTITY,
        JointKind::Revolute | JointKind::Continuous => turn(axis, value(m, joint, q)),
        JointKind::Prismatic => slide(axis, value(m, joint, q)),
        JointKind::Helical { pitch } => {
            let angle = value(m, joint, q);
            turn(axis, angle) * slide(axis, pitch * angle)
        }
        JointKind::Cylindrical => slide(axis, q[c.start]) * turn(axis, q[c.start + 1]),
        JointKind::Universal { second } => turn(axis, q[c.start]) * turn(second, q[c.start + 1]),
        JointKind::Planar => {
            let z = Pose::from_rotation(Rotation::z_to(axis).unwrap());
            let along = slide(Vec3::new(q[c.start], q[c.start + 1], 0.0), 1.0);
            z * along * turn(Vec3::Z, q[c.start + 2]) * z.inverse()
        }
        JointKind::Spherical => Pose::from_rotation(Rotation::exp(vector(&q[c]))),
        JointKind::Free => Pose {
            translation: vector(&q[c.start..c.start + 3]),
            rotation: Rotation::exp(vector(&q[c.start + 3..c.start + 6])),
        },
        other => panic!("no formula for {other:?}"),
    }
}

fn vector(x: &[f64]) -> Vec3 {
    Vec3::new(x[0], x[1], x[2])
}

#[track_caller]
pub(crate) fn assert_close(a: Pose, b: Pose, tolerance: f64) {
    let position = (a.translation - b.translation).norm();
    let angle = a.rotation.angle_to(b.rotation);
    assert!(
        position <= tolerance && angle <= tolerance,
        "{position:e} m, {angle:e} rad\n{a:?}\n{b:?}"
    );
}
