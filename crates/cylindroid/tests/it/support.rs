//! Random numbers that are the same on every run, comparisons that print the difference, and
//! small mechanisms.

use cylindroid::model::{JointKind, JointSpec, Limits, Mimic};
use cylindroid::spatial::{Mat3, Pose, Rotation, Twist, Vec3};
use cylindroid::{Matrix, Mechanism};

/// SplitMix64: a generator that fits in a line and never changes.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next_u64(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [lower, upper).
    pub(crate) fn within(&mut self, lower: f64, upper: f64) -> f64 {
        lower + (upper - lower) * (self.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(crate) fn vec3(&mut self, size: f64) -> Vec3 {
        Vec3::new(self.within(-size, size), self.within(-size, size), self.within(-size, size))
    }

    pub(crate) fn rotation(&mut self) -> Rotation {
        Rotation::exp(self.vec3(3.0))
    }

    pub(crate) fn pose(&mut self) -> Pose {
        Pose { rotation: self.rotation(), translation: self.vec3(2.0) }
    }

    pub(crate) fn twist(&mut self) -> Twist {
        Twist { linear: self.vec3(1.0), angular: self.vec3(1.0) }
    }

    pub(crate) fn vector(&mut self, n: usize) -> Vec<f64> {
        (0..n).map(|_| self.within(-1.0, 1.0)).collect()
    }

    pub(crate) fn matrix(&mut self, m: usize, n: usize) -> Matrix {
        Matrix::from_fn(m, n, |_, _| self.within(-1.0, 1.0))
    }

    /// A product of small integer matrices: exactly rank-deficient.
    pub(crate) fn integer_product(&mut self, m: usize, n: usize, rank: usize) -> Matrix {
        let mut integers = |r, c| Matrix::from_fn(r, c, |_, _| (self.next_u64() % 7) as f64 - 3.0);
        let (a, b) = (integers(m, rank), integers(rank, n));
        &a * &b
    }

    /// Within the limits; within pi (or 1 m) where there are none.
    pub(crate) fn q(&mut self, mechanism: &Mechanism) -> Vec<f64> {
        mechanism
            .coordinates()
            .iter()
            .map(|c| {
                let span = if c.kind.unit() == "m" { 1.0 } else { 3.0 };
                self.within(c.limits.lower.max(-span), c.limits.upper.min(span))
            })
            .collect()
    }
}

/// The serial robots of the catalogue.
pub(crate) fn robots() -> Vec<Mechanism> {
    let all = cylindroid::catalogue::names().iter();
    all.map(|name| cylindroid::catalogue::load(name).unwrap()).filter(|m| !m.is_closed()).collect()
}

#[track_caller]
pub(crate) fn assert_close(what: &str, got: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(got.len(), expected.len(), "{what}: sizes differ");
    for (i, (g, e)) in got.iter().zip(expected).enumerate() {
        let difference = (g - e).abs();
        assert!(
            difference <= tolerance,
            "{what}[{i}]: {g} instead of {e}, difference {difference:.3e} > {tolerance:.1e}"
        );
    }
}

#[track_caller]
pub(crate) fn assert_matrix(what: &str, got: &Matrix, expected: &Matrix, tolerance: f64) {
    assert_eq!((got.rows(), got.cols()), (expected.rows(), expected.cols()), "{what}: shape");
    assert_close(what, got.as_slice(), expected.as_slice(), tolerance);
}

pub(crate) fn entries(m: Mat3) -> Vec<f64> {
    m.to_rows().as_flattened().to_vec()
}

pub(crate) fn pose_entries(p: Pose) -> Vec<f64> {
    p.to_matrix().as_flattened().to_vec()
}

/// A mechanism with one joint of every kind, a branch, a mimic joint and a fixed link.
pub(crate) fn zoo() -> Mechanism {
    animals("zoo", false)
}

/// The same with every joint of these kinds reversed.
pub(crate) fn reversed_zoo() -> Mechanism {
    animals("reversed zoo", true)
}

fn animals(name: &str, reversed: bool) -> Mechanism {
    let mut random = Random(7);
    let mut b = Mechanism::builder(name);
    let kinds = [
        JointKind::Revolute,
        JointKind::Prismatic,
        JointKind::Helical { pitch: 0.07 },
        JointKind::Fixed,
        JointKind::Spherical,
        JointKind::Universal { second: Vec3::new(0.3, 0.1, -0.8) },
        JointKind::Continuous,
        JointKind::Cylindrical,
        JointKind::Planar,
        JointKind::Free,
        JointKind::Revolute,
    ];
    for (i, kind) in kinds.into_iter().enumerate() {
        b.joint(JointSpec {
            parent_from_joint: Pose { rotation: random.rotation(), translation: random.vec3(0.4) },
            axis: random.vec3(1.0),
            reversed,
            ..JointSpec::new(&format!("j{i}"), kind, &format!("l{i}"), &format!("l{}", i + 1))
        });
    }
    b.joint(JointSpec {
        mimic: Some(Mimic { joint: "j0".into(), multiplier: -1.7, offset: 0.2 }),
        axis: random.vec3(1.0),
        parent_from_joint: random.pose(),
        ..JointSpec::new("follower", JointKind::Revolute, "l11", "tip")
    });
    b.joint(JointSpec::new("branch", JointKind::Prismatic, "l2", "side"));
    b.build().unwrap()
}

/// A planar arm of `n` joints about z, links of 1 m along x.
pub(crate) fn planar(n: usize) -> Mechanism {
    let mut b = Mechanism::builder(&format!("{n}r"));
    for i in 0..n {
        b.joint(JointSpec {
            parent_from_joint: Pose::from_translation(if i == 0 { Vec3::ZERO } else { Vec3::X }),
            limits: Limits { lower: -3.0, upper: 3.0, velocity: 2.0, ..Limits::NONE },
            ..JointSpec::new(
                &format!("q{}", i + 1),
                JointKind::Revolute,
                &format!("link{i}"),
                &format!("link{}", i + 1),
            )
        });
    }
    b.frame("tip", &format!("link{n}"), Pose::from_translation(Vec3::X));
    b.tool("tip");
    b.build().unwrap()
}

/// The same mechanism without any limits.
pub(crate) fn unlimited(mechanism: &Mechanism) -> Mechanism {
    let mut b = Mechanism::builder(mechanism.name());
    let links = mechanism.links();
    for link in links {
        b.link(link.clone());
    }
    for joint in mechanism.joints() {
        b.joint(JointSpec {
            parent_from_joint: joint.parent_from_joint,
            axis: joint.axis,
            mimic: joint.mimic.clone(),
            ..JointSpec::new(
                &joint.name,
                joint.kind,
                &links[joint.parent].name,
                &links[joint.child].name,
            )
        });
    }
    for frame in &mechanism.frames()[links.len()..] {
        b.frame(&frame.name, &links[frame.link].name, frame.link_from_frame);
    }
    b.tool(&mechanism.frame_of(mechanism.tool()).name).home(mechanism.home());
    b.build().unwrap()
}

/// Six joints and a follower, with every kind of odd limit.
pub(crate) fn odd_arm() -> Mechanism {
    let limits = |lower, upper| Limits { lower, upper, velocity: 1.5, ..Limits::NONE };
    let (turn, screw) = (JointKind::Revolute, JointKind::Helical { pitch: 0.1 });
    let joints = [
        ("base", turn, Vec3::Z, limits(-3.0, 3.0)),
        ("still", turn, Vec3::Y, Limits { velocity: 0.0, ..limits(-1.0, 1.0) }),
        ("shoulder", turn, Vec3::Y, Limits { acceleration: 3.0, ..limits(-2.0, 2.0) }),
        ("locked", turn, Vec3::X, limits(0.4, 0.4)),
        ("screw", screw, Vec3::Z, limits(-2.0, 4.0)),
        ("stiff", turn, Vec3::Y, Limits { acceleration: 0.0, ..limits(-1.0, 1.0) }),
        ("slide", JointKind::Prismatic, Vec3::X, limits(0.0, 0.5)),
        ("wrist", JointKind::Continuous, Vec3::Y, Limits::NONE),
        ("follower", turn, Vec3::Z, limits(-0.5, 0.5)),
    ];
    let mut b = Mechanism::builder("odd");
    for (i, (name, kind, axis, limits)) in joints.into_iter().enumerate() {
        let leader = Mimic { joint: "shoulder".into(), multiplier: -0.7, offset: 0.2 };
        b.joint(JointSpec {
            parent_from_joint: Pose::from_translation(Vec3::new(0.2, 0.0, 0.1)),
            axis,
            limits,
            mimic: (name == "follower").then_some(leader),
            ..JointSpec::new(name, kind, &format!("l{i}"), &format!("l{}", i + 1))
        });
    }
    b.build().unwrap()
}
