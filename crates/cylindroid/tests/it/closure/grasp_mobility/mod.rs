//! Immobilisation of grasped objects to second order: published grasps, and the distances of real
//! bodies.

mod bodies;
mod equilibria;
mod published;

use cylindroid::Error;
use cylindroid::closure::{
    FingerContact, Friction, GraspMobility, Immobilisation, WrenchSpace, grasp_mobility,
};
use cylindroid::model::{ContactCurvature, SurfaceCurvature};
use cylindroid::spatial::{Pose, Vec3};

use self::bodies::{Surface, Touch, displacement};
use crate::support::Random;

const PLANE: WrenchSpace = WrenchSpace { point: Vec3::ZERO, length: 1.0, planar: true };
const SPACE: WrenchSpace = WrenchSpace { point: Vec3::ZERO, length: 1.0, planar: false };
const POINT: Surface = Surface::Ball(0.0);

fn mobility(touches: &[Touch], space: WrenchSpace) -> GraspMobility {
    let contacts: Vec<FingerContact> = touches.iter().map(Touch::contact).collect();
    grasp_mobility(&contacts, space).unwrap()
}

/// Fingers at the ends of these outward vectors, which are normal to the object.
fn around(outward: &[Vec3], finger: Surface, object: Surface) -> Vec<Touch> {
    let touch = |&p: &Vec3| Touch { point: p, normal: p * (-1.0 / p.norm()), finger, object };
    outward.iter().map(touch).collect()
}

fn in_plane(degrees: &[f64], radius: f64) -> Vec<Vec3> {
    let at = |d: &f64| Vec3::new(d.to_radians().cos(), d.to_radians().sin(), 0.0) * radius;
    degrees.iter().map(at).collect()
}

#[track_caller]
fn assert_found(found: &GraspMobility, verdict: Immobilisation, mobilities: (usize, usize)) {
    assert_eq!(found.immobilisation, verdict, "{found:?}");
    let (first, second) = mobilities;
    assert_eq!(found.first_order_mobility, first, "{found:?}");
    assert_eq!(found.second_order_mobility, Some(second), "{found:?}");
    assert!(!found.ambiguous, "{found:?}");
}

/// The escape of a mobile object opens all gaps of the bodies.
#[track_caller]
fn assert_escapes(touches: &[Touch], found: &GraspMobility, space: WrenchSpace) {
    let escape = found.escape.as_ref().unwrap();
    let opens = |t: f64| {
        let pairs = escape.velocity.iter().zip(&escape.acceleration);
        let twist: Vec<f64> = pairs.map(|(v, a)| t * v + 0.5 * t * t * a).collect();
        touches.iter().all(|c| c.gap(displacement(&twist, space.point)) > 0.0)
    };
    let size =
        escape.velocity.iter().chain(&escape.acceleration).fold(1.0, |a: f64, b| a.max(b.abs()));
    let steps = [1e-3, 3e-4, 1e-4].map(|t| t / size);
    assert!(steps.iter().any(|&t| opens(t)), "{touches:?} {found:?}");
}

/// Pairs of opposite contacts in space: the eigenvalues are the second differences of the mean gap
/// of balls, cylinders, edges, hollows and faces, along all free motions and between them.
#[test]
fn gaps_of_bodies() {
    let mut random = Random(1998);
    for round in 0..200 {
        let pose = random.pose();
        let scale = 10_f64.powf(random.within(-2.0, 2.0));
        let touches: Vec<Touch> = [Vec3::X, -Vec3::X]
            .iter()
            .map(|&side| {
                let normal = pose.rotation * -side;
                let axis = |random: &mut Random| {
                    let v = normal.cross(random.vec3(1.0));
                    v * (1.0 / v.norm())
                };
                let radius = scale * random.within(0.1, 2.0);
                let small = if round % 3 == 0 { 0.0 } else { 0.3 * radius };
                let (finger, object) = match random.next_u64() % 7 {
                    0 => (Surface::Ball(small), Surface::Flat),
                    1 => (Surface::Flat, Surface::Ball(small)),
                    2 => (Surface::Ball(small), Surface::Ball(-radius)),
                    3 => (Surface::Ball(small), Surface::Cylinder(-radius, axis(&mut random))),
                    4 => (
                        Surface::Cylinder(radius, axis(&mut random)),
                        Surface::Cylinder(small, axis(&mut random)),
                    ),
                    5 => (Surface::Cylinder(-radius, axis(&mut random)), Surface::Ball(small)),
                    _ => (Surface::Ball(small), Surface::Ball(radius)),
                };
                Touch { point: pose * (side * scale), normal, finger, object }
            })
            .collect();
        let space = WrenchSpace { point: random.vec3(3.0 * scale), length: scale, planar: false };
        let found = mobility(&touches, space);
        assert_eq!((found.first_order_mobility, found.curvatures.len()), (5, 5), "{touches:?}");
        let mean = |twist: &[f64]| -> f64 {
            let gaps = touches.iter().zip(&found.forces);
            gaps.map(|(c, f)| f * c.gap(displacement(twist, space.point))).sum()
        };
        let second = |twist: &[f64]| {
            let at = |h: f64| {
                let along = |s: f64| twist.iter().map(|x| s * x).collect::<Vec<f64>>();
                (mean(&along(h)) + mean(&along(-h)) - 2.0 * mean(&along(0.0))) / (h * h)
            };
            let h = 1e-3 * scale;
            (4.0 * at(0.5 * h) - at(h)) / 3.0
        };
        for i in 0..5 {
            for j in 0..=i {
                let (a, b) = (found.free_motions.column(i), found.free_motions.column(j));
                let both: Vec<f64> = a.iter().zip(b).map(|(a, b)| 0.5 * (a + b)).collect();
                let expected = if i == j {
                    found.curvatures[i]
                } else {
                    0.25 * (found.curvatures[i] + found.curvatures[j])
                };
                let got = second(&both);
                let size = 1.0 / scale + expected.abs();
                assert!((got - expected).abs() < 1e-6 * size, "{got} {expected} {touches:?}");
            }
        }
    }
}

/// Random grasps by three and four discs with a common centre, and antipodal pairs: an object that
/// is immobile has no position nearby without overlap, a mobile one escapes.
#[test]
fn verdicts_agree_with_finite_motions() {
    let mut random = Random(1875);
    let mut count = [0, 0];
    for round in 0..90 {
        let degrees: Vec<f64> = match round % 3 {
            0 => vec![
                random.within(0.0, 60.0),
                random.within(130.0, 170.0),
                random.within(250.0, 300.0),
            ],
            1 => vec![20.0, 200.0, random.within(80.0, 120.0), random.within(240.0, 300.0)],
            _ => vec![33.0, 213.0],
        };
        let touches: Vec<Touch> = degrees
            .iter()
            .map(|&degrees| {
                let outward = in_plane(&[degrees], 1.0)[0];
                let object = match random.next_u64() % 3 {
                    0 => Surface::Flat,
                    1 => Surface::Ball(random.within(0.3, 3.0)),
                    _ => Surface::Ball(-random.within(0.5, 3.0)),
                };
                let point = outward * random.within(0.5, 1.5);
                let finger = Surface::Ball(random.within(0.0, 0.3));
                Touch { point, normal: -outward, finger, object }
            })
            .collect();
        let found = mobility(&touches, PLANE);
        let Some(&largest) = found.curvatures.first() else {
            assert_escapes(&touches, &found, PLANE);
            continue;
        };
        match found.immobilisation {
            Immobilisation::SecondOrder if largest < -0.2 => {
                let free = widest(&touches, 0.02);
                assert!(free < 0.0, "{free} {touches:?} {found:?}");
                count[0] += 1;
            }
            Immobilisation::Mobile => {
                assert_escapes(&touches, &found, PLANE);
                count[1] += 1;
            }
            _ => {}
        }
    }
    assert!(count[0] > 10 && count[1] > 10, "{count:?}");
}

/// The largest smallest gap of all displacements of this size: a grid, then smaller steps.
fn widest(touches: &[Touch], size: f64) -> f64 {
    let at = |latitude: f64, longitude: f64| {
        let (s, c) = latitude.sin_cos();
        let twist = [size * c * longitude.cos(), size * c * longitude.sin(), size * s];
        let displaced = displacement(&twist, Vec3::ZERO);
        touches.iter().map(|t| t.gap(displaced)).fold(f64::INFINITY, f64::min)
    };
    let mut best = (f64::NEG_INFINITY, 0.0, 0.0);
    for i in -90..=90 {
        for j in 0..360 {
            let (a, b) = (f64::from(i).to_radians(), f64::from(j).to_radians());
            let gap = at(a, b);
            if gap > best.0 {
                best = (gap, a, b);
            }
        }
    }
    let mut step = 0.01;
    while step > 1e-7 {
        let (_, a, b) = best;
        for (i, j) in [
            (1.0, 0.0),
            (-1.0, 0.0),
            (0.0, 1.0),
            (0.0, -1.0),
            (1.0, 1.0),
            (-1.0, 1.0),
            (1.0, -1.0),
            (-1.0, -1.0),
        ] {
            let (a, b) = (a + i * step, b + j * step);
            if at(a, b) > best.0 {
                best = (at(a, b), a, b);
            }
        }
        if (best.1, best.2) == (a, b) {
            step *= 0.5;
        }
    }
    best.0
}

/// Escapes to first order, with any number of fingers on one side.
#[test]
fn escapes_from_fingers_on_one_side() {
    let mut random = Random(5);
    for count in 1..12 {
        let touches: Vec<Touch> = (0..count)
            .map(|_| {
                let normal = Vec3::Z + random.vec3(0.4);
                let normal = normal * (1.0 / normal.norm());
                let point = random.vec3(1.0);
                Touch { point, normal, finger: POINT, object: Surface::Ball(1.0) }
            })
            .collect();
        let found = mobility(&touches, SPACE);
        assert_eq!(found.immobilisation, Immobilisation::Mobile);
        assert_eq!((found.first_order_mobility, found.equilibria.cols()), (6, 0));
        assert_escapes(&touches, &found, SPACE);
    }
}

/// The edges of the cone of equilibrium forces balance, and cannot be decomposed.
#[test]
fn equilibria_are_extreme() {
    let mut random = Random(1953);
    let mut most = 0;
    for _ in 0..60 {
        let touches: Vec<Touch> = (0..9)
            .map(|_| {
                let outward = random.vec3(1.0);
                let normal = outward * (-1.0 / outward.norm()) + random.vec3(0.1);
                let normal = normal * (1.0 / normal.norm());
                Touch { point: outward, normal, finger: POINT, object: Surface::Flat }
            })
            .collect();
        let found = mobility(&touches, SPACE);
        most = most.max(found.equilibria.cols());
        for j in 0..found.equilibria.cols() {
            let forces = found.equilibria.column(j);
            let mut sums = [Vec3::ZERO; 2];
            for (touch, &force) in touches.iter().zip(forces) {
                sums[0] += touch.normal * force;
                sums[1] += touch.point.cross(touch.normal) * force;
            }
            assert!(sums.iter().all(|s| s.norm() < 1e-9), "{sums:?}");
            assert!((forces.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            assert!(forces.iter().all(|f| *f >= 0.0));
            assert!(forces.iter().filter(|f| **f > 0.0).count() <= 7, "{forces:?}");
        }
        let closed = found.equilibria.cols() > 0;
        assert_eq!(closed, found.second_order_mobility.is_some());
    }
    assert!(most > 3, "{most}");
}

/// Moved, rotated, scaled or reordered, a grasp has the same verdict, and curvatures in proportion.
#[test]
fn mobility_does_not_depend_on_the_frame() {
    let mut random = Random(77);
    for round in 0..80 {
        let corner = |x: f64, y: f64, z: f64| Vec3::new(x, y, z);
        let outward = match round % 4 {
            0 => vec![Vec3::X, -Vec3::X],
            1 => in_plane(&[10.0, 130.0, 260.0], 1.0),
            2 => vec![
                corner(1.0, 1.0, 1.0),
                corner(1.0, -1.0, -1.0),
                corner(-1.0, 1.0, -1.0),
                corner(-1.0, -1.0, 1.0),
            ],
            _ => vec![Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y, Vec3::Z, -Vec3::Z],
        };
        let touches: Vec<Touch> = outward
            .iter()
            .map(|&o| {
                let object = match random.next_u64() % 3 {
                    0 => Surface::Flat,
                    1 => Surface::Ball(random.within(0.5, 2.0)),
                    _ => Surface::Ball(-random.within(0.5, 2.0)),
                };
                let finger = Surface::Ball(random.within(0.0, 0.3));
                let unit = o * (1.0 / o.norm());
                Touch { point: unit * random.within(0.5, 1.5), normal: -unit, finger, object }
            })
            .collect();
        let found = mobility(&touches, SPACE);
        let pose =
            Pose { rotation: random.rotation(), translation: random.vec3(100.0 / 3_f64.sqrt()) };
        let scale = 10_f64.powf(random.within(-3.0, 3.0));
        let scaled = |s: Surface| match s {
            Surface::Ball(r) => Surface::Ball(r * scale),
            other => other,
        };
        let mut there: Vec<Touch> = touches
            .iter()
            .map(|t| Touch {
                point: (pose * t.point) * scale,
                normal: pose.rotation * t.normal,
                finger: scaled(t.finger),
                object: scaled(t.object),
            })
            .collect();
        there.reverse();
        let space = WrenchSpace { point: pose.translation * scale, length: scale, planar: false };
        let moved = mobility(&there, space);
        assert_eq!(found.immobilisation, moved.immobilisation, "{found:?} {moved:?}");
        assert_eq!(found.first_order_mobility, moved.first_order_mobility);
        assert_eq!(found.second_order_mobility, moved.second_order_mobility);
        assert_eq!(found.equilibria.cols(), moved.equilibria.cols());
        for (a, b) in found.curvatures.iter().zip(&moved.curvatures) {
            assert!((a - b * scale).abs() < 1e-9 * (1.0 + a.abs()), "{a} {} {scale}", b * scale);
        }
    }
}

/// Curvatures that are none, or of bodies that do not touch in a point.
#[test]
fn curvatures_that_are_refused() {
    let good = around(&[Vec3::X], POINT, Surface::Flat)[0].contact();
    let error = |finger: SurfaceCurvature, object: SurfaceCurvature, space: WrenchSpace| {
        let mut contact = good;
        (contact.curvature.finger, contact.curvature.object) = (finger, object);
        match grasp_mobility(&[contact], space) {
            Ok(found) => panic!("{found:?}"),
            Err(Error::InvalidOption { option: "curvature", reason, .. }) => reason,
            Err(other) => panic!("{other}"),
        }
    };
    let of = SurfaceCurvature::uniform;
    let cylinder = |k: f64, direction| SurfaceCurvature { principal: [k, 0.0], direction };
    for space in [PLANE, SPACE] {
        assert!(error(of(f64::NAN), of(0.0), space).contains("the first body is NaN"));
        assert!(error(of(1.0), of(f64::NEG_INFINITY), space).contains("the second body is -inf"));
        assert!(error(of(0.0), of(0.0), space).contains("touch along a line"));
        assert!(error(of(2.0), of(-2.5), space).contains("sum to -0.5 1/m"));
        assert!(
            error(of(f64::INFINITY), of(f64::INFINITY), space).contains("both bodies are sharp")
        );
    }
    assert!(error(of(0.0), cylinder(1.0, Vec3::Y), SPACE).contains("touch along a line"));
    assert!(error(of(0.0), cylinder(1.0, Vec3::X), SPACE).contains("along the normal"));
    let edge = cylinder(f64::INFINITY, Vec3::Y);
    assert!(error(edge, edge, SPACE).contains("both bodies are sharp"));
    assert!(error(edge, of(f64::INFINITY), SPACE).contains("both bodies are sharp"));
    assert!(error(edge, of(0.0), SPACE).contains("touch along a line"));
    // Crossed edges, and an edge on a bulge, touch in a point.
    for (finger, object) in [(edge, cylinder(f64::INFINITY, Vec3::Z)), (edge, of(1.0))] {
        let mut contact = good;
        (contact.curvature.finger, contact.curvature.object) = (finger, object);
        assert!(grasp_mobility(&[contact], SPACE).is_ok());
    }
    let many = vec![good; 65];
    assert!(grasp_mobility(&many, SPACE).unwrap_err().to_string().contains("at most 64"));
}

/// The rank of the contact normals is a matter of a few billionths of the size of the object: among
/// those that press, or among all of them, or not at all.
#[test]
fn ranks_that_rounding_decides_are_ambiguous() {
    let finger = |x: f64, y: f64, normal: Vec3| FingerContact {
        point: Vec3::new(x, y, 0.0),
        normal,
        friction: Friction::None,
        strength: 1.0,
        curvature: ContactCurvature::default(),
    };
    let is_ambiguous = |fingers: &[FingerContact]| {
        let found = grasp_mobility(fingers, PLANE).unwrap();
        assert_eq!(found.equilibria.rows(), fingers.len());
        (found.ambiguous, found)
    };
    let pair = |y: f64| [finger(-1.0, y, Vec3::X), finger(1.0, y, -Vec3::X)];
    let pushers = [finger(0.3, -1.0, Vec3::Y), finger(-0.4, -1.0, Vec3::Y)];
    // Two pairs on lines a few billionths apart; the pushers, which nothing opposes, see to it that
    // all normals together have a clear rank.
    for (apart, expected) in [(3e-8, true), (0.1, false), (0.0, false)] {
        let fingers = [&pair(0.0)[..], &pair(apart), &pushers].concat();
        let (found, report) = is_ambiguous(&fingers);
        assert_eq!(found, expected, "{apart}: {report:?}");
        let presses =
            |i: usize| (0..report.equilibria.cols()).any(|j| report.equilibria[(i, j)] > 0.0);
        assert_eq!([0, 1, 2, 3, 4, 5].map(presses), [true, true, true, true, false, false]);
    }
    // A pair, and a finger nearly on its line that does not press.
    for (height, expected) in [(3e-8, true), (0.1, false)] {
        let fingers = [&pair(0.0)[..], &[finger(-1.0, height, Vec3::X)]].concat();
        let (found, report) = is_ambiguous(&fingers);
        assert_eq!(found, expected, "{height}: {report:?}");
        let presses =
            |i: usize| (0..report.equilibria.cols()).any(|j| report.equilibria[(i, j)] > 0.0);
        assert_eq!([0, 1, 2].map(presses), [true, true, false]);
    }
    // Nothing presses.
    assert!(!is_ambiguous(&pushers).0);
    assert!(!is_ambiguous(&[]).0);
}
