//! Random closed chains: joints and closing joints of all kinds, contacts, in space and in the plane,
//! of any size and at any place.

use std::f64::consts::{FRAC_PI_2, TAU};

use cylindroid::model::{
    Builder, ContactCurvature, ContactKind, ContactSpec, Dimension, JointKind, JointSpec, Limits,
    LoopJointSpec, Mimic, SurfaceCurvature,
};
use cylindroid::spatial::Rotation;
use cylindroid::{Mechanism, Pose, Vec3};

use crate::robots::Random;

/// A mechanism that is drawn.
struct Sketch<'r, 'b> {
    random: &'r mut Random<'b>,
    builder: Builder,
    planar: bool,
    size: f64,
    /// The joints of one coordinate, and whether it is an angle.
    scalar: Vec<(String, bool)>,
    /// Coordinates so far.
    count: usize,
    /// 1 if joints have the prefix of those of a platform.
    planned: usize,
}

/// The constraint between two links.
enum Closing {
    Joint(JointKind),
    Contact(ContactKind),
}

/// Closed at home.
pub(super) fn closed_chain(random: &mut Random<'_>) -> Mechanism {
    let planar = random.once_in(4);
    let size = if random.once_in(3) { 1.0 } else { random.power(-2.0, 2.0) };
    let builder = Mechanism::builder("chain");
    let planned = usize::from(random.once_in(6));
    let scalar = Vec::new();
    let mut sketch = Sketch { random, builder, planar, size, scalar, count: 0, planned };
    if planar {
        sketch.builder.dimension(Dimension::Planar);
    }
    let legs = 2 + usize::from(sketch.random.once_in(4));
    let closings: Vec<Closing> = (1..legs).map(|_| sketch.closing()).collect();
    let constraints: usize = closings.iter().map(|c| sketch.constraints(c)).sum();
    let freedom = sketch.random.below(4);
    let place = if sketch.random.once_in(3) { Pose::IDENTITY } else { sketch.pose(3.0) };
    let mut lengths = vec![0; legs];
    while sketch.count < constraints + freedom || lengths.contains(&0) {
        let leg = (0..legs).min_by_key(|&leg| lengths[leg]).unwrap_or(0);
        lengths[leg] += 1;
        sketch.joint(leg, lengths[leg], place);
    }
    let links: Vec<String> = (0..legs).map(|leg| link(leg, lengths[leg])).collect();
    let last = links.last().unwrap();
    let tip = sketch.pose(0.3);
    sketch.builder.frame("tip", last, tip).tool("tip");
    if sketch.random.once_in(2) {
        sketch.builder.reference("tip");
    }
    let open = sketch.builder.clone().build().unwrap();
    for (i, closing) in closings.into_iter().enumerate() {
        sketch.close(&open, closing, i, [&links[i], &links[i + 1]]);
    }
    sketch.builder.build().unwrap()
}

/// The link of a leg after some joints.
fn link(leg: usize, joints: usize) -> String {
    if joints == 0 { "base".to_owned() } else { format!("link{leg}{joints}") }
}

impl Sketch<'_, '_> {
    fn kind(&mut self) -> JointKind {
        let pitch = self.size * self.random.within(-0.2, 0.2);
        let second = self.random.vec3(1.0);
        let draw = self.random.below(if self.planar { 9 } else { 19 });
        match draw {
            0..5 => JointKind::Revolute,
            5 | 6 => JointKind::Prismatic,
            7 => JointKind::Continuous,
            8 => JointKind::Planar,
            9 | 10 => JointKind::Helical { pitch },
            11 | 12 => JointKind::Cylindrical,
            13 | 14 => JointKind::Universal { second },
            15 | 16 => JointKind::Spherical,
            17 => JointKind::Fixed,
            _ => JointKind::Free,
        }
    }

    fn closing(&mut self) -> Closing {
        if self.random.once_in(3) {
            let kind = ContactKind::ALL[self.random.below(7)];
            let leaves = self.planar && kind == ContactKind::PlaneFrictionless;
            return Closing::Contact(if leaves { ContactKind::Complete } else { kind });
        }
        Closing::Joint(self.kind())
    }

    fn constraints(&self, closing: &Closing) -> usize {
        let dimension = if self.planar { Dimension::Planar } else { Dimension::Spatial };
        match closing {
            Closing::Joint(kind) => kind.constraint_wrenches(Vec3::Z, dimension).len(),
            Closing::Contact(kind) => kind.constraint_wrenches(dimension).len(),
        }
    }

    /// In the plane about z.
    fn pose(&mut self, size: f64) -> Pose {
        let pose = self.random.pose(size * self.size);
        let Vec3 { x, y, .. } = pose.translation;
        if self.planar {
            let rotation = Rotation::about_z(self.random.within(-3.0, 3.0));
            Pose { rotation, translation: Vec3::new(x, y, 0.0) }
        } else {
            pose
        }
    }

    fn axis(&mut self, kind: JointKind) -> Vec3 {
        let drawn = self.random.vec3(1.0);
        match (self.planar, kind) {
            (true, JointKind::Prismatic) => Vec3::new(drawn.x, drawn.y, 0.0),
            (true, _) => Vec3::Z * drawn.z.signum(),
            // Axes that are parallel or meet at right angles.
            _ if self.random.once_in(3) => [Vec3::X, -Vec3::Y, Vec3::Z][self.random.below(3)],
            _ => drawn,
        }
    }

    fn joint(&mut self, leg: usize, number: usize, world: Pose) {
        let kind = self.kind();
        let leg_name = [["left", "platform.leg"][self.planned], "right", "third"][leg];
        let name = format!("{leg_name}{number}");
        let unit = if kind == JointKind::Prismatic { self.size } else { 1.0 };
        let freedoms = freedoms(kind);
        let mut start: Vec<f64> =
            (0..freedoms).map(|_| unit * self.random.within(-1.0, 1.0)).collect();
        if matches!(kind, JointKind::Planar | JointKind::Free) {
            start.iter_mut().take(2).for_each(|x| *x *= self.size);
        }
        let mut place = self.pose(0.5);
        if self.random.once_in(4) {
            place.rotation = Rotation::exp(Vec3::ZERO);
        }
        if number == 1 {
            place = world * place;
        }
        let leader = self.leader(kind);
        let limits = if freedoms == 1 && kind != JointKind::Continuous {
            self.limits(start[0], unit)
        } else {
            Limits::NONE
        };
        let axis = self.axis(kind);
        let away = self.pose(0.2);
        self.builder.joint(JointSpec {
            parent_from_joint: place,
            joint_from_child: if self.random.once_in(4) { away } else { Pose::IDENTITY },
            axis,
            limits,
            reversed: self.random.once_in(4),
            actuated: self.random.once_in(3),
            mimic: leader.clone(),
            ..JointSpec::new(&name, kind, &link(leg, number - 1), &link(leg, number))
        });
        if leader.is_some() {
            return;
        }
        self.count += freedoms;
        if freedoms > 0 {
            self.builder.start(&name, &start);
        }
        if freedoms == 1 {
            self.scalar.push((name, kind != JointKind::Prismatic));
        }
    }

    /// The joint that this one follows, now and then.
    fn leader(&mut self, kind: JointKind) -> Option<Mimic> {
        let multiplier = self.random.within(-2.0, 2.0);
        let offset = 0.2 * self.random.within(-1.0, 1.0);
        let follows = kind == JointKind::Revolute && self.random.once_in(8);
        let angles = self.scalar.iter().find(|(_, is_angle)| *is_angle);
        let (joint, _) = angles.filter(|_| follows)?;
        Some(Mimic { joint: joint.clone(), multiplier, offset })
    }

    /// Around a value, which may be a bound.
    fn limits(&mut self, x: f64, unit: f64) -> Limits {
        let (lower, upper) = (self.random.power(-1.0, 0.7), self.random.power(-1.0, 0.7));
        let (lower, upper) = (x - unit * lower, x + unit * upper);
        match self.random.below(8) {
            0 => Limits::NONE,
            1 => Limits { lower: x, upper, ..Limits::NONE },
            2 => Limits { lower: f64::NEG_INFINITY, upper, ..Limits::NONE },
            // Home is beyond them, now and then.
            3 if self.random.once_in(3) => Limits { lower: x + 0.05 * unit, upper, ..Limits::NONE },
            _ => Limits { lower, upper, ..Limits::NONE },
        }
    }

    fn close(&mut self, open: &Mechanism, closing: Closing, number: usize, links: [&String; 2]) {
        let state = open.state(open.home()).unwrap();
        let places = links.map(|l| state.pose(open.frame(l).unwrap()).unwrap());
        let between = (places[0].translation + places[1].translation) * 0.5;
        let mut meeting = self.pose(0.3);
        meeting.translation += between;
        if self.planar {
            meeting.translation.z = 0.0;
        }
        let name = format!("closing{number}");
        match closing {
            Closing::Joint(kind) => {
                let axis = self.axis(kind);
                let several = self.random.once_in(40);
                let one = !matches!(kind, JointKind::Fixed) && freedoms(kind) == 1;
                self.builder.loop_joint(LoopJointSpec {
                    link_a_from_joint: places[0].inverse() * meeting,
                    link_b_from_joint: places[1].inverse() * meeting,
                    axis,
                    actuated: several || one && self.random.once_in(4),
                    ..LoopJointSpec::new(&name, kind, links[0], links[1])
                });
            }
            Closing::Contact(kind) => {
                if self.planar {
                    // Contacts lie in x-z of their frame.
                    meeting.rotation = Rotation::about_z(self.random.within(0.0, TAU))
                        * Rotation::exp(Vec3::X * FRAC_PI_2);
                }
                let curvature = self.curvature(kind);
                let friction = Some(self.random.within(0.1, 0.9));
                self.builder.contact(ContactSpec {
                    link_a_from_contact: places[0].inverse() * meeting,
                    link_b_from_contact: places[1].inverse() * meeting,
                    friction: friction.filter(|_| !self.random.once_in(5)),
                    curvature,
                    ..ContactSpec::new(&name, kind, links[0], links[1])
                });
            }
        }
    }

    fn curvature(&mut self, kind: ContactKind) -> Option<ContactCurvature> {
        let bent = self.random.within(0.1, 2.0) / self.size;
        let is_point = matches!(
            kind,
            ContactKind::PointFrictionless | ContactKind::HardFinger | ContactKind::SoftFinger
        );
        (is_point && self.random.once_in(2)).then(|| ContactCurvature {
            object: SurfaceCurvature::uniform(bent),
            ..ContactCurvature::default()
        })
    }
}

/// Number of coordinates.
fn freedoms(kind: JointKind) -> usize {
    match kind {
        JointKind::Fixed => 0,
        JointKind::Cylindrical | JointKind::Universal { .. } => 2,
        JointKind::Spherical | JointKind::Planar => 3,
        JointKind::Free => 6,
        _ => 1,
    }
}

/// Two hinges and a ball, closed by a universal joint whose second axis the first hinge turns.
pub(super) fn closed_by_universal_joint(random: &mut Random<'_>) -> Mechanism {
    let mut builder = Mechanism::builder("fork");
    let size = random.power(-1.0, 1.0);
    let place = Pose { translation: random.vec3(size), ..Pose::IDENTITY };
    builder.joint(JointSpec {
        parent_from_joint: place,
        ..JointSpec::new("turn", JointKind::Revolute, "base", "fork")
    });
    for (name, parent, child) in [("a", "base", "left"), ("b", "left", "right")] {
        builder.joint(JointSpec {
            parent_from_joint: random.pose(size),
            axis: random.vec3(1.0),
            actuated: name == "a",
            ..JointSpec::new(name, JointKind::Revolute, parent, child)
        });
    }
    builder.joint(JointSpec {
        parent_from_joint: random.pose(size),
        actuated: false,
        ..JointSpec::new("ball", JointKind::Spherical, "right", "end")
    });
    let open = builder.clone().build().unwrap();
    let state = open.state(open.home()).unwrap();
    let [fork, end] = ["fork", "end"].map(|l| state.pose(open.frame(l).unwrap()).unwrap());
    let meeting = fork * Pose::from_translation(Vec3::Z * size);
    builder.loop_joint(LoopJointSpec {
        link_a_from_joint: end.inverse() * meeting,
        link_b_from_joint: fork.inverse() * meeting,
        axis: Vec3::X,
        ..LoopJointSpec::new("cross", JointKind::Universal { second: Vec3::Y }, "end", "fork")
    });
    builder.reference("right");
    builder.build().unwrap()
}

/// A chain along an axis, or between parallel ones, with a ball or a free body, closed at its end.
pub(super) fn aligned_chain(random: &mut Random<'_>) -> Mechanism {
    let mut builder = Mechanism::builder("aligned");
    let size = random.power(-1.0, 1.0);
    let is_one_line = random.once_in(2);
    let world = if random.once_in(2) { Pose::IDENTITY } else { random.pose(size) };
    let mut places = Vec::new();
    for i in 0..3 {
        let aside = if is_one_line { 0.0 } else { size * random.within(0.1, 1.0) };
        places.push(Pose::from_translation(Vec3::new(aside, 0.0, 0.3 * size * f64::from(i))));
    }
    places[0] = world * places[0];
    let ball = if random.once_in(3) { JointKind::Free } else { JointKind::Spherical };
    let slide = if random.once_in(2) { JointKind::Prismatic } else { JointKind::Revolute };
    let at = random.below(3);
    let kinds: [JointKind; 3] = std::array::from_fn(|i| match i {
        _ if i == at => ball,
        0 => slide,
        _ => JointKind::Revolute,
    });
    for (i, kind) in kinds.into_iter().enumerate() {
        let name = ["b", "c", "a"][i];
        let link = |i: usize| if i == 0 { "base".to_owned() } else { format!("link{i}") };
        builder.joint(JointSpec {
            parent_from_joint: places[i],
            actuated: i == 0,
            ..JointSpec::new(name, kind, &link(i), &link(i + 1))
        });
    }
    let open = builder.clone().build().unwrap();
    let state = open.state(open.home()).unwrap();
    let [base, end] = ["base", "link3"].map(|l| state.pose(open.frame(l).unwrap()).unwrap());
    let aside = if is_one_line { Vec3::ZERO } else { random.vec3(0.2 * size) };
    let meeting = end * Pose::from_translation(aside + Vec3::Z * (0.2 * size));
    let kind = [JointKind::Spherical, JointKind::Revolute, JointKind::Cylindrical][random.below(3)];
    builder.loop_joint(LoopJointSpec {
        link_a_from_joint: end.inverse() * meeting,
        link_b_from_joint: base.inverse() * meeting,
        ..LoopJointSpec::new("tie", kind, "link3", "base")
    });
    builder.reference("link3");
    builder.build().unwrap()
}

/// A planar platform on three legs of variable length with limits.
pub(super) fn three_legs(random: &mut Random<'_>) -> Mechanism {
    let mut builder = Mechanism::builder("three legs");
    builder.dimension(Dimension::Planar);
    let mut platform = Pose::IDENTITY;
    for i in 0..3 {
        let turn = TAU * f64::from(i) / 3.0 + random.within(-0.4, 0.4);
        let out = Vec3::new(turn.cos(), turn.sin(), 0.0);
        let (base, end) = (out * random.within(1.0, 1.4), out * random.within(0.3, 0.5));
        let end = Rotation::about_z(random.within(0.2, 0.6)) * end;
        let [foot, rod] = ["foot", "rod"].map(|link| format!("{link}{i}"));
        let (hinge, slide) = (format!("a{i}"), format!("leg{i}"));
        builder.joint(JointSpec {
            parent_from_joint: Pose::from_translation(base),
            actuated: false,
            ..JointSpec::new(&hinge, JointKind::Revolute, "base", &foot)
        });
        let long = random.within(0.1, 0.5);
        builder.joint(JointSpec {
            parent_from_joint: Pose::from_translation(end - base),
            axis: end - base,
            limits: Limits { lower: -long, upper: 1.5 * long, ..Limits::NONE },
            ..JointSpec::new(&slide, JointKind::Prismatic, &foot, &rod)
        });
        if i == 0 {
            builder.joint(JointSpec {
                actuated: false,
                ..JointSpec::new("b0", JointKind::Revolute, &rod, "platform")
            });
            platform = Pose::from_translation(end);
        } else {
            builder.loop_joint(LoopJointSpec {
                link_b_from_joint: Pose::from_translation(end - platform.translation),
                ..LoopJointSpec::new(&format!("b{i}"), JointKind::Revolute, &rod, "platform")
            });
        }
    }
    builder.frame("center", "platform", platform.inverse()).reference("center");
    builder.build().unwrap()
}
