//! Force closure and the quality of grasps.

use cylindroid::closure::{
    ContactProperties, EpsilonQuality, FingerContact, Friction, GraspMetric, GraspQuality,
    WrenchSpace, grasp_contacts, grasp_quality,
};
use cylindroid::model::{
    ContactCurvature, ContactKind, ContactSpec, Dimension, JointKind, JointSpec,
};
use cylindroid::spatial::{Pose, Rotation, Vec3};
use cylindroid::tolerance::GRASP_QUALITY;
use cylindroid::{Error, Mechanism};

use crate::support::Random;

pub(super) const PLANE: WrenchSpace = WrenchSpace { point: Vec3::ZERO, length: 1.0, planar: true };
pub(super) const SPACE: WrenchSpace = WrenchSpace { point: Vec3::ZERO, length: 1.0, planar: false };

pub(super) fn finger(point: [f64; 3], normal: [f64; 3], friction: Friction) -> FingerContact {
    let vec3 = |v: [f64; 3]| Vec3::new(v[0], v[1], v[2]);
    let curvature = ContactCurvature::default();
    FingerContact { point: vec3(point), normal: vec3(normal), friction, strength: 1.0, curvature }
}

pub(super) fn quality(contacts: &[FingerContact], space: WrenchSpace) -> GraspQuality {
    grasp_quality(contacts, space, GraspMetric::L1).unwrap()
}

#[track_caller]
fn assert_exact(found: &GraspQuality, epsilon: f64) {
    let EpsilonQuality { lower, upper } = found.epsilon;
    assert!((lower - epsilon).abs() < 1e-12 && (upper - epsilon).abs() < 1e-12, "{found:?}");
    assert!(found.closed);
}

/// Four fingers without friction on a square: the wrenches are the corners of a tetrahedron, its
/// faces at a / sqrt(1 + 4 a^2).
#[test]
fn four_frictionless_fingers() {
    for a in [0.05, 0.3, 0.9] {
        let contacts = [
            finger([1.0, a, 0.0], [-1.0, 0.0, 0.0], Friction::None),
            finger([-1.0, -a, 0.0], [1.0, 0.0, 0.0], Friction::None),
            finger([a, 1.0, 0.0], [0.0, -1.0, 0.0], Friction::None),
            finger([-a, -1.0, 0.0], [0.0, 1.0, 0.0], Friction::None),
        ];
        assert_exact(&quality(&contacts, PLANE), a / (1.0 + 4.0 * a * a).sqrt());
        // Moments over another length.
        let half = WrenchSpace { length: 0.5, ..PLANE };
        let b = 2.0 * a;
        assert_exact(&quality(&contacts, half), b / (1.0 + 4.0 * b * b).sqrt());
        // Through the middle no contact resists a moment.
        let middle = contacts.map(|c| FingerContact { point: c.normal * -1.0, ..c });
        let open = quality(&middle, PLANE);
        assert!(!open.closed && (open.epsilon.lower, open.epsilon.upper) == (0.0, 0.0));
        assert!((open.weakest[2].abs() - 1.0).abs() < 1e-12, "{open:?}");
    }
}

/// Two fingers with friction in the plane: mu / sqrt(2 + mu^2).
#[test]
fn two_fingers_with_friction() {
    for mu in [0.1, 0.5, 1.5] {
        let friction = Friction::Hard { mu };
        let contacts = [
            finger([1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], friction),
            finger([-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], friction),
        ];
        assert_exact(&quality(&contacts, PLANE), mu / (2.0 + mu * mu).sqrt());
    }
}

/// In space two hard fingers resist no moment about the line through them, two soft ones do.
#[test]
fn soft_fingers_hold_a_moment_about_their_line() {
    let pair = |friction| {
        [
            finger([1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], friction),
            finger([-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], friction),
        ]
    };
    let hard = quality(&pair(Friction::Hard { mu: 0.5 }), SPACE);
    assert!(!hard.closed);
    assert!((hard.weakest[3].abs() - 1.0).abs() < 1e-12, "{hard:?}");
    let soft = quality(&pair(Friction::Soft { mu: 0.5, torsion: 0.1 }), SPACE);
    assert!(soft.closed && soft.epsilon.lower > 0.01, "{soft:?}");
    // The moment about the line is the weakest: 0.1, a little less with what else moves along.
    assert!(soft.epsilon.upper < 0.1 + 1e-3);
}

/// The support along any direction is at least the lower bound, and along the weakest at
/// most the upper.
#[test]
fn bounds_hold_in_space() {
    let mut random = Random(76);
    for round in 0..6 {
        let friction = if round % 2 == 0 {
            Friction::Hard { mu: 0.6 }
        } else {
            Friction::Soft { mu: 0.6, torsion: 0.2 }
        };
        let contacts: Vec<FingerContact> = (0..3 + round % 2)
            .map(|i| {
                let angle = f64::from(i) * 2.1 + random.within(-0.3, 0.3);
                let normal = [-angle.cos(), -angle.sin(), 0.0];
                let point = [angle.cos(), angle.sin(), random.within(-0.2, 0.2)];
                finger(point, normal, friction)
            })
            .collect();
        for metric in [GraspMetric::L1, GraspMetric::LInf] {
            let found = grasp_quality(&contacts, SPACE, metric).unwrap();
            let EpsilonQuality { lower, upper } = found.epsilon;
            assert!(found.closed && lower <= upper && upper < lower + 0.02, "{found:?}");
            let support = |n: &[f64]| support(&contacts, metric, n);
            assert!((support(&found.weakest) - upper).abs() < 1e-9, "{found:?}");
            for _ in 0..2000 {
                let n = random.vector(6);
                let size = n.iter().map(|x| x * x).sum::<f64>().sqrt();
                let n: Vec<f64> = n.iter().map(|x| x / size).collect();
                assert!(support(&n) >= lower - 1e-12);
            }
        }
    }
}

/// Soft fingers of torsion 0.4 and more on opposite sides are equally weak in a ring of directions:
/// the worst wrench pushes one finger away and shears both.
#[test]
fn two_soft_fingers_that_twist_well() {
    for (torsion, epsilon) in [(0.3, 0.3), (0.4, 1.0 / 3.0), (0.5, 1.0 / 3.0), (0.8, 1.0 / 3.0)] {
        let friction = Friction::Soft { mu: 0.5, torsion };
        let contacts = [
            finger([1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], friction),
            finger([-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], friction),
        ];
        let found = quality(&contacts, SPACE);
        let EpsilonQuality { lower, upper } = found.epsilon;
        assert!(found.closed && lower <= epsilon && epsilon <= upper + 1e-12, "{found:?}");
        assert!(upper - lower < 1.3 * GRASP_QUALITY, "{found:?}");
    }
}

/// Pairs and triples about an object: the bounds are finite and as close as promised, and enclose
/// the smallest value that a search over directions by the geometry of the cones finds.
#[test]
fn random_pairs_and_triples() {
    let mut random = Random(916);
    for round in 0..60 {
        let contacts = opposed(&mut random, 2 + round % 2);
        for metric in [GraspMetric::L1, GraspMetric::LInf] {
            let found = grasp_quality(&contacts, SPACE, metric).unwrap();
            let EpsilonQuality { lower, upper } = found.epsilon;
            assert!(lower <= upper && upper - lower < promised(&contacts, metric), "{found:?}");
            assert!((support(&contacts, metric, &found.weakest) - upper).abs() < 1e-9, "{found:?}");
            let smallest = descended(&mut random, &contacts, metric);
            assert!(lower <= smallest + 1e-12, "{smallest} {found:?}");
            assert!(upper - promised(&contacts, metric) <= smallest, "{smallest} {found:?}");
            if found.closed {
                assert!(lower > 0.0, "{found:?}");
            } else {
                assert!(upper < 1e-9, "{found:?}");
            }
        }
    }
}

/// Qualities by Clarabel and Qhull (`xtask/vectors/grasp_vectors.py`).
#[test]
fn qualities_of_other_solvers() {
    let text = include_str!("../../vectors/grasps/quality.json");
    let file: serde_json::Value = serde_json::from_str(text).unwrap();
    let number = |v: &serde_json::Value| v.as_f64().unwrap();
    let vec3 = |v: &serde_json::Value| Vec3::new(number(&v[0]), number(&v[1]), number(&v[2]));
    let mut count = [0, 0];
    for case in file["cases"].as_array().unwrap() {
        let contacts: Vec<FingerContact> = case["contacts"]
            .as_array()
            .unwrap()
            .iter()
            .map(|c| {
                let mu = number(&c["mu"]);
                FingerContact {
                    point: vec3(&c["point"]),
                    normal: vec3(&c["normal"]),
                    friction: match c["torsion"].as_f64() {
                        Some(torsion) => Friction::Soft { mu, torsion },
                        None => Friction::Hard { mu },
                    },
                    strength: number(&c["strength"]),
                    curvature: ContactCurvature::default(),
                }
            })
            .collect();
        let metric = if case["bound"] == "l1" { GraspMetric::L1 } else { GraspMetric::LInf };
        let space = if case["planar"] == true { PLANE } else { SPACE };
        let found = grasp_quality(&contacts, space, metric).unwrap();
        let EpsilonQuality { lower, upper } = found.epsilon;
        let what = format!("{case} {found:?}");
        let closed = case["closed"] == true;
        assert_eq!(found.closed, closed, "{what}");
        count[usize::from(closed)] += 1;
        if let (true, Some(epsilon)) = (closed, case["epsilon"].as_f64()) {
            // Solvers stop at 1e-9.
            assert!(lower <= epsilon + 1e-8 && epsilon <= upper + 1e-8, "{what}");
            if space.planar {
                assert!((upper - epsilon).abs() < 1e-9 && (lower - epsilon).abs() < 1e-9, "{what}");
            }
        }
        if let (true, Some(inner)) = (closed, case["inner"].as_f64()) {
            assert!(inner <= upper + 1e-9, "{what}");
            assert!(lower <= number(&case["outer"]) + 1e-9, "{what}");
        }
    }
    assert!(count[0] >= 4 && count[1] >= 20, "{count:?}");
}

/// Moved, rotated, scaled or reordered, a grasp has bounds of the same number.
#[test]
fn quality_does_not_depend_on_the_frame() {
    let mut random = Random(917);
    for round in 0..30 {
        let contacts = opposed(&mut random, 2 + round % 2);
        let metric = [GraspMetric::L1, GraspMetric::LInf][round % 2];
        let found = grasp_quality(&contacts, SPACE, metric).unwrap();
        let pose =
            Pose { rotation: random.rotation(), translation: random.vec3(100.0 / 3_f64.sqrt()) };
        let scale = 10_f64.powf(random.within(-3.0, 3.0));
        let mut there: Vec<FingerContact> = contacts
            .iter()
            .map(|c| FingerContact {
                point: (pose * c.point) * scale,
                normal: pose.rotation * c.normal,
                friction: match c.friction {
                    Friction::Soft { mu, torsion } => {
                        Friction::Soft { mu, torsion: torsion * scale }
                    }
                    other => other,
                },
                ..*c
            })
            .collect();
        there.reverse();
        let space = WrenchSpace { point: pose.translation * scale, length: scale, planar: false };
        let moved = grasp_quality(&there, space, metric).unwrap();
        assert_eq!(found.closed, moved.closed, "{found:?} {moved:?}");
        let (a, b) = (found.epsilon, moved.epsilon);
        assert!(a.lower <= b.upper + 1e-9 && b.lower <= a.upper + 1e-9, "{found:?} {moved:?}");
        assert!((a.upper - b.upper).abs() < promised(&contacts, metric), "{found:?} {moved:?}");
    }
}

/// Fingers on the unit sphere that press inwards, the first two nearly opposite.
fn opposed(random: &mut Random, count: usize) -> Vec<FingerContact> {
    let mut unit = |size: f64, about: Vec3| {
        let v = about + random.vec3(size);
        v * (1.0 / v.norm())
    };
    let first = unit(1.0, Vec3::X * 1e-3);
    let points: Vec<(Vec3, Vec3)> = (0..count)
        .map(|i| {
            let point = match i {
                0 => first,
                1 => unit(0.2, -first),
                _ => unit(1.0, Vec3::Y * 1e-3),
            };
            (point, unit(0.15, -point))
        })
        .collect();
    let friction = Friction::Soft { mu: random.within(0.2, 1.0), torsion: random.within(0.0, 1.0) };
    let curvature = ContactCurvature::default();
    let contact =
        |(point, normal)| FingerContact { point, normal, friction, strength: 1.0, curvature };
    points.into_iter().map(contact).collect()
}

/// The distance of the bounds that is promised: relative to the largest difference of two wrenches
/// of fingers on the unit sphere, whose moments are of length `mu` and `torsion`.
fn promised(contacts: &[FingerContact], metric: GraspMetric) -> f64 {
    let largest = contacts.iter().map(|c| match c.friction {
        Friction::Soft { mu, torsion } => 1.0 + 2.0 * mu + torsion,
        _ => 2.0,
    });
    2.0 * GRASP_QUALITY
        * match metric {
            GraspMetric::L1 => largest.fold(0.0, f64::max),
            GraspMetric::LInf => largest.sum(),
        }
}

fn support(contacts: &[FingerContact], metric: GraspMetric, n: &[f64]) -> f64 {
    let each = contacts.iter().map(|c| support_of(c, n));
    match metric {
        GraspMetric::L1 => each.fold(f64::NEG_INFINITY, f64::max),
        GraspMetric::LInf => each.map(|h| h.max(0.0)).sum(),
    }
}

/// The smallest value by random steps, from many directions.
fn descended(random: &mut Random, contacts: &[FingerContact], metric: GraspMetric) -> f64 {
    let unit = |n: Vec<f64>| -> Vec<f64> {
        let size = n.iter().map(|x| x * x).sum::<f64>().sqrt();
        n.iter().map(|x| x / size).collect()
    };
    let mut smallest = f64::INFINITY;
    for _ in 0..20 {
        let mut n = unit(random.vector(6));
        let mut value = support(contacts, metric, &n);
        let mut step = 0.5;
        while step > 1e-4 {
            let better = (0..40).find_map(|_| {
                let change = random.vector(6);
                let next = unit(n.iter().zip(&change).map(|(x, c)| x + step * c).collect());
                let found = support(contacts, metric, &next);
                (found < value).then_some((next, found))
            });
            match better {
                Some(found) => (n, value) = found,
                None => step *= 0.5,
            }
        }
        smallest = smallest.min(value);
    }
    smallest
}

/// The farthest wrench of a finger along `n`, by the geometry of its cone.
pub(super) fn support_of(contact: &FingerContact, n: &[f64]) -> f64 {
    let (f, m) = (Vec3::new(n[0], n[1], n[2]), Vec3::new(n[3], n[4], n[5]));
    // Power of a unit force at the contact along the "twist" n.
    let velocity = f + m.cross(contact.point);
    let along = velocity.dot(contact.normal);
    let slip = velocity - contact.normal * along;
    let (mu, torsion) = match contact.friction {
        Friction::None => (0.0, 0.0),
        Friction::Hard { mu } => (mu, 0.0),
        Friction::Soft { mu, torsion } => (mu, torsion),
        other => panic!("no cone for {other:?}"),
    };
    along + (mu * slip.norm()).hypot(torsion * m.dot(contact.normal))
}

/// Fingers on one side, and no fingers at all.
#[test]
fn open_grasps() {
    let friction = Friction::Hard { mu: 0.4 };
    let side = [
        finger([0.3, 1.0, 0.0], [0.0, -1.0, 0.0], friction),
        finger([-0.3, 1.0, 0.0], [0.0, -1.0, 0.0], friction),
    ];
    let open = quality(&side, PLANE);
    assert!(!open.closed && open.epsilon.upper <= 0.0, "{open:?}");
    // Nothing pushes along the weakest direction.
    assert!(open.weakest[1] > 0.5, "{open:?}");
    let each = grasp_quality(&side, PLANE, GraspMetric::LInf).unwrap();
    assert!(!each.closed && each.epsilon.lower.abs() < 1e-12, "{each:?}");
    assert!(!quality(&[], SPACE).closed);
    let one = quality(&side[..1], SPACE);
    assert!(!one.closed);
}

/// Twice as strong fingers resist twice as much.
#[test]
fn strength_scales() {
    let friction = Friction::Hard { mu: 0.5 };
    let mut contacts = [
        finger([1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], friction),
        finger([-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], friction),
    ];
    let of =
        |c: &[FingerContact]| grasp_quality(c, PLANE, GraspMetric::LInf).unwrap().epsilon.lower;
    let one = of(&contacts);
    contacts.iter_mut().for_each(|c| c.strength = 2.0);
    assert!((of(&contacts) / one - 2.0).abs() < 1e-12);
}

#[test]
fn contacts_that_are_none() {
    let good = finger([1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], Friction::Hard { mu: 0.5 });
    let error = |c: FingerContact, space| {
        grasp_quality(&[c], space, GraspMetric::LInf).unwrap_err().to_string()
    };
    let long = FingerContact { normal: good.normal * 2.0, ..good };
    assert!(error(long, SPACE).starts_with("normal = 2"));
    let slippery = FingerContact { friction: Friction::Hard { mu: -0.1 }, ..good };
    assert!(error(slippery, SPACE).starts_with("mu = -0.1"));
    let twisted = FingerContact { friction: Friction::Soft { mu: 0.1, torsion: f64::NAN }, ..good };
    assert!(error(twisted, SPACE).starts_with("torsion"));
    let weak = FingerContact { strength: 0.0, ..good };
    assert!(error(weak, SPACE).starts_with("strength = 0"));
    let nowhere = FingerContact { point: Vec3::new(0.0, f64::NAN, 0.0), ..good };
    assert!(error(nowhere, SPACE).starts_with("contact point[1]"));
    let out = FingerContact { point: Vec3::new(0.0, 0.0, 1.0), ..good };
    assert!(error(out, PLANE).contains("plane z = 0"));
    assert!(error(good, WrenchSpace { length: 0.0, ..SPACE }).starts_with("length = 0"));
}

/// A ball between a finger and the ground; the second contact names the ball first.
fn grasped_ball(kinds: [ContactKind; 2], dimension: Dimension) -> Mechanism {
    let mut b = Mechanism::builder("grasped");
    b.dimension(dimension);
    b.joint(JointSpec {
        axis: Vec3::X,
        ..JointSpec::new("push", JointKind::Prismatic, "ground", "finger")
    });
    let free = if dimension == Dimension::Planar { JointKind::Planar } else { JointKind::Free };
    b.joint(JointSpec { actuated: false, ..JointSpec::new("ball", free, "ground", "ball") });
    let at = |x: f64| Pose {
        rotation: Rotation::z_to(Vec3::X).unwrap(),
        translation: Vec3::new(x, 0.0, 0.0),
    };
    for (name, kind, [a, b_], x) in
        [("near", kinds[0], ["finger", "ball"], -1.0), ("far", kinds[1], ["ball", "ground"], 1.0)]
    {
        b.contact(ContactSpec {
            link_a_from_contact: at(x),
            link_b_from_contact: at(x),
            friction: (name == "near").then_some(0.4),
            ..ContactSpec::new(name, kind, a, b_)
        });
    }
    b.reference("ball");
    b.build().unwrap()
}

/// Points and normals in world, into the object whichever link the file names first.
#[test]
fn fingers_of_a_mechanism() {
    let soft = ContactKind::SoftFinger;
    let m = grasped_ball([soft, ContactKind::HardFinger], Dimension::Spatial);
    let q: Vec<f64> =
        m.coordinates().iter().map(|c| f64::from(u8::from(c.name == "ball.y"))).collect();
    let state = m.state(&q).unwrap();
    let touch = ContactProperties { mu: None, torsion: Some(0.02), strength: 5.0 };
    // The second one has no coefficient in the file.
    let error = grasp_contacts(&state, m.reference(), |_| touch).unwrap_err();
    assert!(matches!(&error, Error::Model { culprit, .. } if culprit == "far"), "{error}");
    let own = |c: &cylindroid::model::Contact| ContactProperties {
        mu: (c.name == "far").then_some(0.7),
        ..touch
    };
    let fingers = grasp_contacts(&state, m.reference(), own).unwrap();
    let y = fingers[0].1.point.y;
    assert_eq!(fingers.iter().map(|f| f.0).collect::<Vec<_>>(), [0, 1]);
    assert_eq!(fingers[0].1.friction, Friction::Soft { mu: 0.4, torsion: 0.02 });
    assert_eq!(fingers[1].1.friction, Friction::Hard { mu: 0.7 });
    assert!((fingers[0].1.point - Vec3::new(-1.0, y, 0.0)).norm() < 1e-15);
    assert!((fingers[0].1.normal - Vec3::X).norm() < 1e-15);
    assert!((fingers[1].1.normal + Vec3::X).norm() < 1e-15);
    let grasp: Vec<FingerContact> = fingers.into_iter().map(|f| f.1).collect();
    let space = WrenchSpace::about(&state, m.reference(), &grasp).unwrap();
    assert_eq!((space.point, space.planar), (Vec3::new(0.0, y, 0.0), false));
    assert!((space.length - 1.0).abs() < 1e-15);
    assert!(grasp_quality(&grasp, space, GraspMetric::LInf).unwrap().closed);
    // No torsion: said. In the plane none is needed.
    let none = |_: &cylindroid::model::Contact| ContactProperties {
        mu: Some(0.3),
        torsion: None,
        strength: 1.0,
    };
    let error = grasp_contacts(&state, m.reference(), none).unwrap_err().to_string();
    assert!(error.contains("soft finger"), "{error}");
    let plane = grasped_ball([soft, soft], Dimension::Planar);
    let state = plane.state(&vec![0.0; plane.n()]).unwrap();
    let fingers = grasp_contacts(&state, plane.reference(), none).unwrap();
    assert_eq!(fingers[0].1.friction, Friction::Hard { mu: 0.3 });
    // Firm contacts are no points.
    let firm = grasped_ball([ContactKind::Complete, soft], Dimension::Spatial);
    let state = firm.state(&vec![0.0; firm.n()]).unwrap();
    let error = grasp_contacts(&state, firm.reference(), none).unwrap_err().to_string();
    assert!(error.contains("'near' is complete"), "{error}");
}
