//! Random robots: joints of all kinds of one coordinate, ordinary and odd limits, branches, masses
//! and shapes; and the catalogue.

use std::f64::consts::PI;

use cylindroid::model::{
    Collision, Dimension, Geometry, Inertial, JointKind, JointSpec, Limits, Link, LoopJointSpec,
    Mimic,
};
use cylindroid::spatial::{Mat3, Rotation};
use cylindroid::{Mechanism, Pose, Vec3, catalogue};

/// The bytes that are given, then SplitMix64.
pub(crate) struct Random<'b> {
    state: u64,
    bytes: &'b [u8],
    /// Numbers, from the lower end of their range on, are larger by this share.
    pub(crate) nudge: f64,
}

impl<'b> Random<'b> {
    pub(crate) fn seeded(state: u64) -> Self {
        Self { state, bytes: &[], nudge: 0.0 }
    }

    pub(crate) fn of_bytes(bytes: &'b [u8]) -> Self {
        Self { state: 0, bytes, nudge: 0.0 }
    }

    fn next(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.state ^ (self.state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Two bytes.
    fn given(&mut self) -> Option<u16> {
        let (two, rest) = self.bytes.split_first_chunk()?;
        self.bytes = rest;
        Some(u16::from_le_bytes(*two))
    }

    pub(crate) fn below(&mut self, n: usize) -> usize {
        match self.given() {
            Some(given) => usize::from(given) % n,
            None => (self.next() % n as u64) as usize,
        }
    }

    /// True once in `n` times.
    pub(crate) fn once_in(&mut self, n: usize) -> bool {
        self.below(n) == 0
    }

    pub(crate) fn within(&mut self, lower: f64, upper: f64) -> f64 {
        let (share, of) = match self.given() {
            Some(given) => (f64::from(given), f64::from(u16::MAX)),
            None => ((self.next() >> 11) as f64, (1_u64 << 53) as f64),
        };
        lower + (upper - lower) * share / of * (1.0 + self.nudge)
    }

    /// A power of ten.
    pub(crate) fn power(&mut self, lower: f64, upper: f64) -> f64 {
        10_f64.powf(self.within(lower, upper))
    }

    pub(crate) fn vec3(&mut self, size: f64) -> Vec3 {
        Vec3::new(self.within(-size, size), self.within(-size, size), self.within(-size, size))
    }

    pub(crate) fn pose(&mut self, size: f64) -> Pose {
        Pose { rotation: Rotation::exp(self.vec3(3.0)), translation: self.vec3(size) }
    }

    /// Within the limits, at a bound now and then.
    pub(crate) fn configuration(&mut self, robot: &Mechanism) -> Vec<f64> {
        let mut one = |l: &Limits| {
            let (lower, upper) = (l.lower.max(-3.0).min(l.upper), l.upper.min(3.0).max(l.lower));
            match self.below(8) {
                0 => lower,
                1 => upper,
                _ => self.within(lower, upper).clamp_to(lower, upper),
            }
        };
        robot.coordinates().iter().map(|c| one(&c.limits)).collect()
    }
}

pub(crate) trait ClampTo {
    fn clamp_to(self, lower: Self, upper: Self) -> Self;
}

impl ClampTo for f64 {
    fn clamp_to(self, lower: f64, upper: f64) -> f64 {
        self.max(lower).min(upper)
    }
}

fn limits(random: &mut Random<'_>) -> Limits {
    let mut l = Limits {
        lower: -random.power(-1.0, 0.6),
        upper: random.power(-1.0, 0.6),
        velocity: random.power(-1.0, 1.0),
        acceleration: random.power(-0.5, 2.5),
        ..Limits::NONE
    };
    match random.below(24) {
        0 => l.lower = f64::NEG_INFINITY,
        1 => (l.lower, l.upper) = (f64::NEG_INFINITY, f64::INFINITY),
        2 => l.lower = l.upper,
        3 => l.upper = l.lower + 1e-9,
        4 => l.velocity = 0.0,
        5 => l.acceleration = 0.0,
        6 => l.velocity = f64::INFINITY,
        7..11 => l.acceleration = f64::INFINITY,
        11 => (l.velocity, l.acceleration) = (1e-6, 1e3),
        12 => (l.velocity, l.acceleration) = (1e3, 1e-3),
        13 => (l.lower, l.upper) = (99_999.0, 100_001.0),
        _ => {}
    }
    l
}

/// A tree of one to nine joints; with shapes on all links, a chain of ordinary joints.
pub(crate) fn robot(random: &mut Random<'_>, with_shapes: bool) -> Mechanism {
    let n = if with_shapes { 3 + random.below(4) } else { 1 + random.below(9) };
    let mut builder = Mechanism::builder("random");
    for i in 0..n {
        let (name, link) = (format!("q{i}"), format!("l{}", i + 1));
        let kind = match random.below(if with_shapes { 8 } else { 12 }) {
            7 | 8 => JointKind::Prismatic,
            9 => JointKind::Helical { pitch: random.within(-0.2, 0.2) },
            10 => JointKind::Continuous,
            _ => JointKind::Revolute,
        };
        let branches = !with_shapes && i > 1 && random.once_in(6);
        let parent = format!("l{}", if branches { random.below(i) } else { i });
        let size = if with_shapes { 0.3 } else { random.power(-2.0, 0.3) };
        let leader = Mimic {
            joint: "q0".to_owned(),
            multiplier: random.within(-2.0, 2.0),
            offset: random.within(-0.2, 0.2),
        };
        let own = if with_shapes {
            let (velocity, acceleration) = (random.power(-0.5, 0.7), random.power(0.0, 2.0));
            Limits { lower: -2.8, upper: 2.8, velocity, acceleration, ..Limits::NONE }
        } else {
            limits(random)
        };
        let limits = match kind {
            JointKind::Continuous => {
                Limits { lower: f64::NEG_INFINITY, upper: f64::INFINITY, ..own }
            }
            _ => own,
        };
        let mimics = !with_shapes && i > 0 && kind == JointKind::Revolute && random.once_in(12);
        builder.joint(JointSpec {
            parent_from_joint: random.pose(size),
            axis: random.vec3(1.0),
            limits,
            mimic: mimics.then_some(leader),
            ..JointSpec::new(&name, kind, &parent, &link)
        });
        let mut shapes = Vec::new();
        if with_shapes {
            let radius = random.within(0.02, 0.06);
            let geometry = match random.below(4) {
                0 => Geometry::Sphere { radius },
                1 => Geometry::Box { size: Vec3::new(radius, 2.0 * radius, radius) },
                2 => Geometry::Cylinder { radius, length: 0.1 },
                _ => Geometry::Capsule { radius, length: 0.1 },
            };
            shapes.push(Collision { geometry, ..Collision::default() });
        }
        builder.link(Link {
            inertial: Some(Inertial {
                mass: random.power(-1.0, 1.0),
                link_from_inertia: Pose::from_translation(random.vec3(0.1)),
                inertia: Mat3::ZERO,
            }),
            collisions: shapes,
            ..Link::named(&link)
        });
    }
    builder.frame("tip", &format!("l{n}"), random.pose(0.2)).tool("tip");
    builder.build().unwrap_or_else(|_| catalogue::load("ur5e").unwrap())
}

/// A five-bar with shapes on all links: two legs, actuated at the base, meet in a hinge.
pub(crate) fn five_bar(random: &mut Random<'_>) -> Mechanism {
    let mut builder = Mechanism::builder("five-bar");
    let width = random.within(0.3, 1.2);
    let meeting = Vec3::new(random.within(0.2, 0.8) * width, random.within(0.5, 1.0), 0.0);
    let (mut home, mut ends) = (Vec::new(), [Pose::IDENTITY; 2]);
    for (leg, x, side) in [("a", 0.0, 1.0), ("b", width, -1.0)] {
        let base = Vec3::new(x, 0.0, 0.0);
        let way = meeting - base;
        let far = way.norm();
        let lower = random.within(0.4, 0.8);
        let upper = random.within((far - lower).abs() + 0.1, far + lower - 0.1);
        // The triangle of the leg.
        let shoulder = ((far * far + lower * lower - upper * upper) / (2.0 * far * lower)).acos();
        let elbow = ((lower * lower + upper * upper - far * far) / (2.0 * lower * upper)).acos();
        home.extend([way.y.atan2(way.x) + side * shoulder, side * (elbow - PI)]);
        let links = [format!("{leg}1"), format!("{leg}2")];
        for (i, (length, at)) in [(lower, base), (upper, Vec3::X * lower)].into_iter().enumerate() {
            let parent = if i == 0 { "base" } else { &links[0] };
            let (velocity, acceleration) = (random.power(-0.3, 0.7), random.power(0.0, 2.0));
            let limits = Limits { velocity, acceleration, ..Limits::NONE };
            builder.joint(JointSpec {
                parent_from_joint: Pose::from_translation(at),
                limits: if i == 0 { limits } else { Limits::NONE },
                actuated: i == 0,
                ..JointSpec::new(&format!("q_{}", links[i]), JointKind::Revolute, parent, &links[i])
            });
            let bar = Vec3::new(random.within(0.5, 0.8) * length, 0.04, 0.04);
            builder.link(Link {
                collisions: vec![Collision {
                    geometry: Geometry::Box { size: bar },
                    link_from_shape: Pose::from_translation(Vec3::X * (0.5 * length)),
                    ..Collision::default()
                }],
                ..Link::named(&links[i])
            });
            ends[usize::from(leg == "b")] = Pose::from_translation(Vec3::X * length);
        }
    }
    builder.loop_joint(LoopJointSpec {
        link_a_from_joint: ends[0],
        link_b_from_joint: ends[1],
        ..LoopJointSpec::new("meeting", JointKind::Revolute, "a2", "b2")
    });
    builder.frame("tip", "a2", ends[0]).tool("tip").reference("tip");
    builder.dimension(Dimension::Planar).home(&home);
    builder.build().unwrap()
}

/// A spatial loop with shapes on all links: two chains of revolute joints that a hinge, a ball or a
/// clamp closes, with as many drives as degrees of freedom, from both bases on.
pub(crate) fn spatial_loop(random: &mut Random<'_>) -> Mechanism {
    let mut builder = Mechanism::builder("loop");
    let (kind, constraints) =
        [(JointKind::Revolute, 5), (JointKind::Spherical, 3), (JointKind::Fixed, 6)]
            [random.below(3)];
    let freedom = 1 + random.below(3);
    let joints = constraints + freedom;
    let counts = [joints / 2, joints - joints / 2];
    let mut ends = [Pose::IDENTITY; 2];
    for (chain, leg) in ["a", "b"].into_iter().enumerate() {
        for i in 0..counts[chain] {
            let link = format!("{leg}{}", i + 1);
            let parent = if i == 0 { "base".to_owned() } else { format!("{leg}{i}") };
            let mut place = random.pose(0.25);
            if i == 0 {
                place.translation.x += if chain == 0 { -0.5 } else { 0.5 };
            }
            // Drives take turns: the first of one chain, the first of the other, ...
            let actuated = 2 * i + chain < freedom;
            let (velocity, acceleration) = (random.power(-0.5, 0.7), random.power(0.0, 2.0));
            let limits = Limits { velocity, acceleration, ..Limits::NONE };
            builder.joint(JointSpec {
                parent_from_joint: place,
                axis: random.vec3(1.0),
                limits: if actuated { limits } else { Limits::NONE },
                actuated,
                ..JointSpec::new(&format!("q_{link}"), JointKind::Revolute, &parent, &link)
            });
            let collision = Collision {
                geometry: Geometry::Capsule { radius: random.within(0.02, 0.05), length: 0.1 },
                ..Collision::default()
            };
            builder.link(Link { collisions: vec![collision], ..Link::named(&link) });
            ends[chain] = ends[chain] * place;
        }
    }
    // Closed where all joints are at zero.
    let meeting =
        Pose { translation: (ends[0].translation + ends[1].translation) * 0.5, ..random.pose(0.0) };
    let last = [format!("a{}", counts[0]), format!("b{}", counts[1])];
    builder.loop_joint(LoopJointSpec {
        link_a_from_joint: ends[0].inverse() * meeting,
        link_b_from_joint: ends[1].inverse() * meeting,
        ..LoopJointSpec::new("meeting", kind, &last[0], &last[1])
    });
    builder.frame("tip", &last[0], ends[0].inverse() * meeting).tool("tip").reference("tip");
    builder.build().unwrap()
}

/// A model of the catalogue, serial or with loops.
pub(crate) fn of_catalogue(random: &mut Random<'_>, closed: bool) -> Mechanism {
    let names = catalogue::names();
    loop {
        let robot = catalogue::load(names[random.below(names.len())]).unwrap();
        if robot.is_closed() == closed && robot.n() > 0 {
            return robot;
        }
    }
}
