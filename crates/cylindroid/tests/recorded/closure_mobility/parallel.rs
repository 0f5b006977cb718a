//! Parallel robots with as many drives as degrees of freedom, and chains of many joints.

use cylindroid::model::{
    Builder, ContactKind, ContactSpec, Dimension, JointKind, JointSpec, LoopJointSpec,
};
use cylindroid::spatial::Rotation;
use cylindroid::{Mechanism, Pose, Vec3};

use crate::robots::Random;

/// A parallel robot with as many drives as degrees of freedom, mostly: legs of as many freedoms as
/// the platform, or fewer, which constrain it.
pub(super) fn parallel(random: &mut Random<'_>) -> Mechanism {
    let mut b = Mechanism::builder("parallel");
    let planar = random.once_in(3);
    let (d, size) = (if planar { 3 } else { 6 }, random.power(-1.0, 1.0));
    if planar {
        b.dimension(Dimension::Planar);
    }
    let legs = if planar { 2 + random.below(2) } else { 2 + random.below(4) };
    let mut lost = random.below(legs.min(d - 1) + 1);
    let mut drives = d - lost;
    let floats = !planar && random.once_in(4);
    let meeting = place_of(random, planar, size);
    let mut first: Option<(String, Pose)> = None;
    if floats {
        let free = JointSpec::new("float", JointKind::Free, "ground", "platform");
        b.joint(JointSpec { parent_from_joint: meeting, actuated: false, ..free });
        first = Some(("platform".into(), meeting));
    }
    for leg in 0..legs {
        let left = legs - leg;
        let less = lost.div_ceil(left);
        let own = drives.div_ceil(left);
        (lost, drives) = (lost - less, drives - own);
        let name = ["a", "b", "c", "d", "e"][leg];
        let closes = first.is_some();
        let contact = closes && !planar && random.once_in(4);
        let touch = [
            (ContactKind::HardFinger, 3),
            (ContactKind::SoftFinger, 2),
            (ContactKind::PointFrictionless, 5),
            (ContactKind::LineFrictionless, 4),
            (ContactKind::PlaneFrictionless, 3),
        ][random.below(5)];
        let last = match (closes, planar) {
            (false, _) => JointKind::Fixed,
            (true, true) => JointKind::Revolute,
            _ => [JointKind::Revolute, JointKind::Spherical, JointKind::Prismatic][random.below(3)],
        };
        let last_freedoms = if contact { touch.1 } else { last.dof() };
        let freedoms = (d - less).saturating_sub(last_freedoms);
        let (end, pose) = leg_of(&mut b, random, (name, size, planar), (freedoms, own));
        let Some((platform, world_from_platform)) = &first else {
            first = Some((end, pose));
            continue;
        };
        let place = place_of(random, planar, size);
        let sides = [pose.inverse() * place, world_from_platform.inverse() * place];
        if contact {
            b.contact(ContactSpec {
                link_a_from_contact: sides[0],
                link_b_from_contact: sides[1],
                ..ContactSpec::new(&format!("c_{name}"), touch.0, &end, platform)
            });
            continue;
        }
        b.loop_joint(LoopJointSpec {
            link_a_from_joint: sides[0],
            link_b_from_joint: sides[1],
            axis: if planar { Vec3::Z } else { random.vec3(1.0) },
            ..LoopJointSpec::new(&format!("l_{name}"), last, &end, platform)
        });
    }
    let (platform, _) = first.unwrap();
    b.frame("reference", &platform, place_of(random, planar, 0.3 * size));
    b.reference("reference").tool("reference");
    b.build().unwrap()
}

fn place_of(random: &mut Random<'_>, planar: bool, size: f64) -> Pose {
    if !planar {
        return random.pose(size);
    }
    let mut translation = random.vec3(size);
    translation.z = 0.0;
    Pose { rotation: Rotation::exp(Vec3::Z * random.within(-3.0, 3.0)), translation }
}

/// The joints of a leg from the ground on, of which as many of one freedom as given are actuated.
fn leg_of(
    b: &mut Builder,
    random: &mut Random<'_>,
    (name, size, planar): (&str, f64, bool),
    (mut freedoms, mut drives): (usize, usize),
) -> (String, Pose) {
    let (mut last, mut pose) = ("ground".to_owned(), Pose::IDENTITY);
    let mut passive = random.below(2);
    let mut i = 0;
    while freedoms > 0 {
        let kind = match random.below(8) {
            0 | 1 => JointKind::Prismatic,
            5 if planar => JointKind::Prismatic,
            2 if !planar => JointKind::Helical { pitch: random.within(-0.2, 0.2) * size },
            3 if !planar && freedoms > 1 => JointKind::Universal { second: random.vec3(1.0) },
            4 if !planar && freedoms > 2 => JointKind::Spherical,
            _ => JointKind::Revolute,
        };
        let axis = match (planar, kind) {
            (true, JointKind::Prismatic) => Vec3::X,
            (true, _) => Vec3::Z,
            _ => random.vec3(1.0),
        };
        let driven = kind.dof() == 1 && drives > 0 && (passive == 0 || freedoms <= drives);
        if kind.dof() == 1 && !driven {
            passive = passive.saturating_sub(1);
        }
        drives -= usize::from(driven);
        let (place, child) = (place_of(random, planar, size), format!("{name}{i}"));
        b.joint(JointSpec {
            parent_from_joint: place,
            axis,
            actuated: driven,
            ..JointSpec::new(&format!("q_{child}"), kind, &last, &child)
        });
        (last, pose) = (child, pose * place);
        freedoms -= kind.dof();
        i += 1;
    }
    (last, pose)
}

/// An arm of many joints, straight now and then, or a loop of as many that a ball joint closes.
pub(super) fn long_chain(random: &mut Random<'_>) -> Mechanism {
    let mut b = Mechanism::builder("long");
    let n = 62 + random.below(12);
    let (closed, passive) = (random.once_in(2), 2 + random.below(3));
    let (planar, balls) = (!closed && random.once_in(2), random.once_in(3));
    let mut tip = Pose::IDENTITY;
    for i in 0..n {
        let mut place = random.pose(0.3);
        if planar {
            place = Pose { translation: Vec3::X * 0.3, ..Pose::IDENTITY };
        }
        tip = tip * place;
        let ball = balls && i % 8 == 3;
        let kind = if ball { JointKind::Spherical } else { JointKind::Revolute };
        let parent = if i == 0 { "ground".to_owned() } else { format!("l{i}") };
        b.joint(JointSpec {
            parent_from_joint: place,
            actuated: i % passive != 1,
            ..JointSpec::new(&format!("q{i}"), kind, &parent, &format!("l{}", i + 1))
        });
    }
    if closed {
        b.loop_joint(LoopJointSpec {
            link_b_from_joint: tip,
            ..LoopJointSpec::new("loop", JointKind::Spherical, &format!("l{n}"), "ground")
        });
        b.reference("l40");
    }
    b.build().unwrap()
}
