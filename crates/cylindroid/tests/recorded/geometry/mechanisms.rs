//! Trees with joints of all kinds, chains with axes of all kinds, and rings that joints of all kinds
//! close.

use cylindroid::model::{
    ContactKind, ContactSpec, Inertial, JointKind, JointSpec, Link, LoopJointSpec, Mimic,
};
use cylindroid::spatial::{Mat3, Pose, Vec3};
use cylindroid::{EndEffector, FrameId, Mechanism};

use super::{definite, direction, placement};
use crate::robots::Random;

pub(super) fn inertial(random: &mut Random<'_>) -> Inertial {
    let a = definite(random, 3);
    Inertial {
        mass: if random.once_in(6) { 0.0 } else { random.power(-1.0, 1.0) },
        link_from_inertia: random.pose(0.3),
        inertia: Mat3::from_rows([0, 1, 2].map(|i| [0, 1, 2].map(|j| 0.1 * a[(i, j)]))),
    }
}

pub(super) fn any_kind(random: &mut Random<'_>) -> JointKind {
    match random.below(12) {
        0 | 1 => JointKind::Revolute,
        2 => JointKind::Prismatic,
        3 => JointKind::Helical { pitch: random.within(-0.3, 0.3) },
        4 => JointKind::Fixed,
        5 => JointKind::Spherical,
        6 => JointKind::Universal { second: Vec3::new(0.3, 0.1, -0.8) },
        7 => JointKind::Continuous,
        8 => JointKind::Cylindrical,
        9 => JointKind::Planar,
        10 => JointKind::Free,
        _ => JointKind::Revolute,
    }
}

/// Any axis, of a universal joint one across its second.
fn axis(random: &mut Random<'_>, kind: JointKind) -> Vec3 {
    match kind {
        JointKind::Universal { .. } => Vec3::new(0.9, random.within(-0.5, 0.5), 0.2),
        _ => direction(random),
    }
}

/// A tree whose links have masses, or one of them not.
pub(super) fn tree(random: &mut Random<'_>, heavy: bool) -> Mechanism {
    let n = 2 + random.below(5);
    let size = random.power(-1.0, 1.0);
    let mut builder = Mechanism::builder("tree");
    for i in 0..n {
        let link = format!("l{}", i + 1);
        let kind = match any_kind(random) {
            kind if kind.dof() != 1 && i == 0 => JointKind::Revolute,
            kind => kind,
        };
        let leader = Mimic {
            joint: "j0".to_owned(),
            multiplier: random.within(-2.0, 2.0),
            offset: random.within(-0.2, 0.2),
        };
        let follows = i > 0 && kind.dof() == 1 && random.once_in(4);
        let parent = if i > 1 && random.once_in(4) { random.below(i) } else { i };
        builder.joint(JointSpec {
            parent_from_joint: placement(random, size),
            joint_from_child: placement(random, 0.3 * size),
            axis: axis(random, kind),
            reversed: random.once_in(4),
            mimic: follows.then_some(leader),
            armature: if random.once_in(3) { random.power(-1.0, 0.0) } else { 0.0 },
            ..JointSpec::new(&format!("j{i}"), kind, &format!("l{parent}"), &link)
        });
        let inertial = (heavy || random.once_in(2)).then(|| inertial(random));
        builder.link(Link { inertial, ..Link::named(&link) });
    }
    let last = format!("l{n}");
    builder.frame("tip", &last, placement(random, size)).tool("tip");
    builder.build().unwrap()
}

/// Up to ten joints that turn and slide about axes of their own, along those before, or anywhere.
pub(super) fn chain(random: &mut Random<'_>) -> Mechanism {
    let n = 1 + random.below(10);
    let size = random.power(-1.0, 1.0);
    let mut builder = Mechanism::builder("chain");
    for i in 0..n {
        let kind = match random.below(6) {
            0 => JointKind::Prismatic,
            1 => JointKind::Helical { pitch: random.within(-0.2, 0.2) },
            2 => JointKind::Continuous,
            _ => JointKind::Revolute,
        };
        let axis = match random.below(4) {
            0 => -Vec3::Z,
            1 => direction(random),
            _ => Vec3::Z,
        };
        let leader = Mimic {
            joint: "j0".to_owned(),
            multiplier: random.within(-2.0, 2.0),
            offset: random.within(-0.2, 0.2),
        };
        builder.joint(JointSpec {
            parent_from_joint: placement(random, size),
            axis,
            reversed: random.once_in(4),
            mimic: (i > 0 && random.once_in(8)).then_some(leader),
            ..JointSpec::new(&format!("j{i}"), kind, &format!("l{i}"), &format!("l{}", i + 1))
        });
    }
    builder.frame("tip", &format!("l{n}"), placement(random, size)).tool("tip");
    builder.build().unwrap()
}

/// A chain that a joint of any kind closes on its first link, with a contact.
pub(super) fn ring(random: &mut Random<'_>) -> Mechanism {
    let mut builder = Mechanism::builder("ring");
    let kinds = [
        JointKind::Revolute,
        JointKind::Helical { pitch: -0.2 },
        JointKind::Universal { second: Vec3::new(0.0, 1.0, 0.3) },
        JointKind::Prismatic,
        JointKind::Spherical,
    ];
    let driven = random.below(4);
    let reversed = random.once_in(2);
    for (j, kind) in kinds.into_iter().enumerate() {
        builder.joint(JointSpec {
            parent_from_joint: random.pose(0.5),
            actuated: j != 2 && j <= driven + 1,
            reversed,
            ..JointSpec::new(&format!("j{j}"), kind, &format!("l{j}"), &format!("l{}", j + 1))
        });
    }
    builder.joint(JointSpec {
        mimic: Some(Mimic { joint: "j0".into(), multiplier: 0.7, offset: 0.1 }),
        parent_from_joint: random.pose(0.5),
        ..JointSpec::new("follower", JointKind::Revolute, "l5", "l6")
    });
    let kind = any_kind(random);
    let across = [Vec3::X, Vec3::Y, Vec3::new(0.1, -0.2, 1.0)][random.below(3)];
    builder.loop_joint(LoopJointSpec {
        link_a_from_joint: random.pose(0.5),
        link_b_from_joint: random.pose(0.5),
        axis: if matches!(kind, JointKind::Universal { .. }) { Vec3::X } else { across },
        ..LoopJointSpec::new("end", kind, "l1", "l6")
    });
    if random.once_in(3) {
        builder.contact(ContactSpec {
            link_a_from_contact: random.pose(0.3),
            link_b_from_contact: random.pose(0.3),
            ..ContactSpec::new("touch", ContactKind::PointFrictionless, "l2", "l4")
        });
    }
    builder.reference("l4");
    builder.build().unwrap()
}

/// Small rotations and slides of all joints.
pub(super) fn configuration(random: &mut Random<'_>, mechanism: &Mechanism) -> Vec<f64> {
    let mut one = || match random.below(8) {
        0 => 0.0,
        _ => random.within(-2.0, 2.0),
    };
    (0..mechanism.n()).map(|_| one()).collect()
}

/// A tool on any frame.
pub(super) fn tool(random: &mut Random<'_>, mechanism: &Mechanism) -> EndEffector {
    let frames = frames(mechanism);
    let frame = frames[random.below(frames.len())];
    let frame_from_tool = if random.once_in(2) { Pose::IDENTITY } else { random.pose(0.5) };
    EndEffector { frame, frame_from_tool }
}

pub(super) fn frames(mechanism: &Mechanism) -> Vec<FrameId> {
    mechanism.frames().iter().map(|f| mechanism.frame(&f.name).unwrap()).collect()
}
