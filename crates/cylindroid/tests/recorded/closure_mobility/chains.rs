//! Closed chains: published linkages from any side and at any size, and random ones.

use std::cell::Cell;
use std::path::Path;

use cylindroid::model::{
    Builder, ContactKind, ContactSpec, Dimension, JointKind, JointSpec, Limits, LoopJointSpec,
    Mimic,
};
use cylindroid::spatial::Rotation;
use cylindroid::{Mechanism, Pose, Vec3};

use crate::robots::Random;

/// A linkage of the test data, or a mechanism of the catalogue.
fn linkage(name: &str) -> Mechanism {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data");
    let path = ["linkages", "mechanisms"].map(|kind| format!("{folder}/{kind}/{name}.toml"));
    let file = path.iter().find(|p| Path::new(p).exists());
    cylindroid::load(file.map_or(name, |p| p)).unwrap()
}

/// The same closed chain turned, moved and enlarged; in the plane, within it.
pub(super) fn seen_from_elsewhere(m: &Mechanism, random: &mut Random<'_>) -> Mechanism {
    let scale = random.power(-1.0, 1.0);
    let mut view = random.pose(2.0 * scale);
    if m.dimension() == Dimension::Planar {
        let turn = Rotation::exp(Vec3::Z * random.within(-3.0, 3.0));
        view = Pose { rotation: turn, ..view };
        view.translation.z = 0.0;
    }
    moved(m, scale, view)
}

fn moved(m: &Mechanism, scale: f64, view: Pose) -> Mechanism {
    let links = m.links();
    let ground = (0..links.len()).find(|&i| m.joints().iter().all(|j| j.child != i)).unwrap();
    let large = |pose: Pose| Pose { translation: pose.translation * scale, ..pose };
    let on = |link: usize, pose: Pose| {
        if link == ground { view * large(pose) } else { large(pose) }
    };
    let of = |kind: JointKind| match kind {
        JointKind::Helical { pitch } => JointKind::Helical { pitch: scale * pitch },
        _ => kind,
    };
    let mut b = Mechanism::builder(m.name());
    b.dimension(m.dimension());
    links.iter().for_each(|l| _ = b.link(l.clone()));
    for j in m.joints() {
        b.joint(JointSpec {
            parent_from_joint: on(j.parent, j.parent_from_joint),
            joint_from_child: large(j.joint_from_child),
            axis: j.axis,
            reversed: j.reversed,
            mimic: j.mimic.clone(),
            actuated: j.actuated,
            ..JointSpec::new(&j.name, of(j.kind), &links[j.parent].name, &links[j.child].name)
        });
    }
    for l in m.loops() {
        b.loop_joint(LoopJointSpec {
            link_a_from_joint: on(l.a, l.link_a_from_joint),
            link_b_from_joint: on(l.b, l.link_b_from_joint),
            axis: l.axis,
            actuated: l.actuated,
            ..LoopJointSpec::new(&l.name, of(l.kind), &links[l.a].name, &links[l.b].name)
        });
    }
    for c in m.contacts() {
        b.contact(ContactSpec {
            link_a_from_contact: on(c.a, c.link_a_from_contact),
            link_b_from_contact: on(c.b, c.link_b_from_contact),
            ..ContactSpec::new(&c.name, c.kind, &links[c.a].name, &links[c.b].name)
        });
    }
    for frame in &m.frames()[links.len()..] {
        b.frame(&frame.name, &links[frame.link].name, on(frame.link, frame.link_from_frame));
    }
    b.reference(&m.frame_of(m.reference()).name);
    let size = |i: usize| if m.coordinates()[i].kind.unit() == "m" { scale } else { 1.0 };
    // Rotation vectors of free joints have as many entries as velocities.
    b.home(&m.home().iter().enumerate().map(|(i, x)| x * size(i)).collect::<Vec<_>>());
    b.build().unwrap()
}

/// Some joints and loop joints, by name.
pub(super) fn with_other_actuators(m: &Mechanism, random: &mut Random<'_>) -> Mechanism {
    let moving = m.joints().iter().filter(|j| j.kind.dof() > 0 && j.mimic.is_none());
    let loops = m.loops().iter().filter(|l| l.kind.dof() == 1);
    let names = moving.map(|j| &j.name).chain(loops.map(|l| &l.name));
    let share = 2 + random.below(4);
    let chosen: Vec<&String> = names.filter(|_| random.once_in(share)).collect();
    m.with_actuated(&chosen).unwrap()
}

fn kind(random: &mut Random<'_>) -> JointKind {
    match random.below(16) {
        0 => JointKind::Prismatic,
        1 => JointKind::Helical { pitch: random.within(-0.2, 0.2) },
        2 => JointKind::Cylindrical,
        3 => JointKind::Universal { second: random.vec3(1.0) },
        4 => JointKind::Spherical,
        5 => JointKind::Planar,
        6 => JointKind::Continuous,
        _ => JointKind::Revolute,
    }
}

fn limits(kind: JointKind) -> Limits {
    if kind.takes_position_limits() {
        Limits { lower: -3.0, upper: 3.0, velocity: 2.0, ..Limits::NONE }
    } else {
        Limits::NONE
    }
}

/// A way of joints from the ground: its end at zero.
struct Way {
    last: String,
    world_from_last: Pose,
    freedoms: usize,
}

/// Joints from the ground on until they have `freedoms`, the first `driven` of them actuated.
fn way(
    b: &mut Builder,
    random: &mut Random<'_>,
    (name, size): (&str, f64),
    (freedoms, driven): (usize, usize),
) -> Way {
    let mut way = Way { last: "ground".into(), world_from_last: Pose::IDENTITY, freedoms: 0 };
    let mut i = 0;
    while way.freedoms < freedoms {
        let mut own = kind(random);
        if way.freedoms + own.dof() > freedoms {
            own = JointKind::Revolute;
        }
        let child = format!("{name}{i}");
        let (place, end) = (random.pose(size), random.pose(0.2 * size));
        let end = if random.once_in(4) { end } else { Pose::IDENTITY };
        let leader = Mimic {
            joint: format!("q_{name}0"),
            multiplier: random.within(-2.0, 2.0),
            offset: 0.0,
        };
        let follows = i > 1 && own == JointKind::Revolute && random.once_in(12);
        b.joint(JointSpec {
            parent_from_joint: place,
            joint_from_child: end,
            axis: random.vec3(1.0),
            limits: limits(own),
            reversed: random.once_in(4),
            mimic: follows.then_some(leader),
            actuated: i < driven && !follows,
            ..JointSpec::new(&format!("q_{child}"), own, &way.last, &child)
        });
        way.world_from_last = way.world_from_last * place * end;
        way.last = child;
        way.freedoms += own.dof();
        i += 1;
    }
    way
}

/// A platform on several legs of joints of all kinds, closed at zero by loop joints or contacts.
pub(super) fn platform(random: &mut Random<'_>) -> Mechanism {
    let mut b = Mechanism::builder("platform");
    let size = random.power(-1.0, 1.0);
    let legs = 2 + random.below(3);
    let freedoms = 3 + random.below(4);
    let driven = 1 + random.below(2);
    let first = way(&mut b, random, ("a", size), (freedoms, driven));
    for leg in 1..legs {
        let name = ["a", "b", "c", "d"][leg];
        let others = 2 + random.below(3);
        let way = way(&mut b, random, (name, size), (others, 1));
        let place = random.pose(size);
        let (from_a, from_b) =
            (first.world_from_last.inverse() * place, way.world_from_last.inverse() * place);
        if random.once_in(5) {
            let kind = ContactKind::ALL[random.below(7)];
            b.contact(ContactSpec {
                link_a_from_contact: from_a,
                link_b_from_contact: from_b,
                ..ContactSpec::new(&format!("c_{name}"), kind, &first.last, &way.last)
            });
            continue;
        }
        let kind = match random.below(6) {
            0 => JointKind::Revolute,
            1 => JointKind::Prismatic,
            2 => JointKind::Helical { pitch: random.within(-0.2, 0.2) },
            3 => JointKind::Universal { second: random.vec3(1.0) },
            _ => JointKind::Spherical,
        };
        let kind = if random.once_in(8) { JointKind::Fixed } else { kind };
        b.loop_joint(LoopJointSpec {
            link_a_from_joint: from_a,
            link_b_from_joint: from_b,
            axis: random.vec3(1.0),
            actuated: kind.dof() == 1 && random.once_in(3),
            ..LoopJointSpec::new(&format!("l_{name}"), kind, &first.last, &way.last)
        });
    }
    let reference = random.pose(0.3 * size);
    b.frame("reference", &first.last, reference).reference("reference").tool("reference");
    b.build().unwrap()
}

/// One name after another, the same for all nudges of a case.
pub(super) struct Names<'n> {
    names: &'n [&'n str],
    next: Cell<usize>,
}

impl<'n> Names<'n> {
    pub(super) fn of(names: &'n [&'n str]) -> Self {
        Self { names, next: Cell::new(0) }
    }

    /// The linkage of the case.
    pub(super) fn take(&self, random: &Random<'_>) -> Mechanism {
        if random.nudge == 0.0 {
            self.next.set(self.next.get() + 1);
        }
        linkage(self.names[(self.next.get() - 1) % self.names.len()])
    }
}

/// Small linkages, each with a singularity or mode of its own.
pub(super) const LINKAGES: [&str; 30] = [
    "agile_eye_home",
    "bennett",
    "bricard_linesym_geo",
    "cascade0",
    "cascade2",
    "cheb_slider",
    "fb_dead_crank",
    "fb_dead_rocker",
    "five-bar-dead",
    "five-bar-stretched",
    "folded-parallelogram",
    "goldberg5r",
    "h4_par_0.1_0.2_0.1_0.2",
    "h4_par_0.1_0.3_0.3_0.1",
    "k33_conic",
    "kinematotropic_2dof",
    "kinematotropic_meet",
    "kite_ext",
    "par3_generic",
    "peaucellier",
    "rrr_IIM_all_stretched_concurrent",
    "rrr_RO_concurrent",
    "rrr_regular",
    "sarrus",
    "sarrus_folded",
    "schatz",
    "spatial-four-bar",
    "stretched-pair",
    "ups_gimbal",
    "watt_slider_0.500",
];

/// Larger ones.
pub(super) const ROBOTS: [&str; 17] = [
    "arch_similar",
    "delta_pa",
    "fichter_1.200",
    "fichter_1.571",
    "griffis_duffy_a",
    "octahedron_regular",
    "orthoglide",
    "six_parallel",
    "stewart-turned",
    "tricept",
    "upu_snu",
    "upu_tsai",
    "delta",
    "stewart",
    "two-arm",
    "3rrr",
    "watt",
];
