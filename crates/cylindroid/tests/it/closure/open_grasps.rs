//! Grasps without force closure: epsilon is less the distance of their wrenches from zero.

use cylindroid::Error;
use cylindroid::closure::{
    FingerContact, Friction, GraspMetric, WrenchSpace, grasp_mobility, grasp_quality,
};
use cylindroid::spatial::{Pose, Rotation, Vec3};
use cylindroid::tolerance::GRASP_QUALITY;

use super::grasp::{PLANE, SPACE, finger, quality, support_of};
use crate::support::Random;

/// Frictionless fingers in a row push one way: the nearest wrench is that of the first one, or lies
/// between two.
#[test]
fn the_nearest_wrench_bounds_them() {
    let push = |y: f64, x: f64, z: f64| finger([0.0, y, 0.0], [x, z, 0.0], Friction::None);
    let flat = [push(-1.0, 1.0, 0.0), push(-2.0, 1.0, 0.0)];
    let whole = [flat[0], flat[1], push(-1.5, 0.8, 0.6), push(-1.2, 0.96, -0.28)];
    for contacts in [&flat[..], &whole] {
        let found = quality(contacts, PLANE);
        let (lower, upper) = (found.epsilon.lower, found.epsilon.upper);
        assert!(!found.closed && lower <= -(2.0_f64.sqrt()) + 1e-12, "{found:?}");
        assert!(upper >= -(2.0_f64.sqrt()) - 1e-12 && upper - lower < 1e-8, "{found:?}");
    }
    // Moments of both signs: the middle of an edge.
    let edge = quality(&[push(-1.0, 1.0, 0.0), push(2.0, 1.0, 0.0)], PLANE);
    assert!((edge.epsilon.lower + 1.0).abs() < 1e-12 && edge.weakest[0] < -1.0 + 1e-12, "{edge:?}");
}

/// Bounds hold in all directions, and of a grasp that was moved they meet.
#[test]
fn bounds_hold_wherever_the_grasp_is() {
    let mut random = Random(641);
    let mut open = 0;
    for number in 0..60 {
        let friction = match number % 3 {
            0 => Friction::None,
            1 => Friction::Hard { mu: 0.3 },
            _ => Friction::Soft { mu: 0.4, torsion: 0.05 },
        };
        let contacts: Vec<FingerContact> = (0..2 + number % 5)
            .map(|_| {
                let point = std::array::from_fn(|_| random.within(-1.0, 1.0));
                let push = Vec3::new(random.within(-1.0, 1.0), random.within(-1.0, 1.0), 0.7);
                finger(point, (push * push.norm().recip()).to_array(), friction)
            })
            .collect();
        let found = quality(&contacts, SPACE);
        let (lower, upper) = (found.epsilon.lower, found.epsilon.upper);
        let value = |n: &[f64]| {
            let each = contacts.iter().map(|c| support_of(c, n));
            each.fold(f64::NEG_INFINITY, f64::max)
        };
        assert!(lower <= upper && value(&found.weakest) <= upper + 1e-12, "{found:?}");
        for _ in 0..300 {
            let n: Vec<f64> = (0..6).map(|_| random.within(-1.0, 1.0)).collect();
            let size = n.iter().map(|x| x * x).sum::<f64>().sqrt();
            let n: Vec<f64> = n.iter().map(|x| x / size).collect();
            assert!(value(&n) >= lower - 1e-12, "{number}: {} {found:?}", value(&n));
        }
        open += usize::from(!found.closed);
        let pose = Pose {
            rotation: Rotation::exp(Vec3::new(0.3, -0.8, 1.9)),
            translation: Vec3::new(0.4, -2.0, 0.9),
        };
        let moved: Vec<FingerContact> = contacts
            .iter()
            .map(|c| FingerContact {
                point: pose * c.point,
                normal: pose.rotation * c.normal,
                ..*c
            })
            .collect();
        let there = WrenchSpace { point: pose * SPACE.point, ..SPACE };
        let again = quality(&moved, there);
        assert_eq!(again.closed, found.closed, "{number}");
        let apart = (again.epsilon.lower - upper).max(lower - again.epsilon.upper);
        assert!(apart <= 1e-12, "{number}: {found:?}, {again:?}");
        if !found.closed {
            assert!((again.epsilon.lower - lower).abs() < 3.0 * GRASP_QUALITY, "{number}");
        }
    }
    assert!(open > 40, "{open}");
}

/// Force closure is decided for any number of fingers, mobility without friction for some dozens; far
/// apart from each other their curvatures are none.
#[test]
fn mobility_says_what_it_does_not_take() {
    let mut contacts: Vec<FingerContact> = (0..65)
        .map(|i| {
            let (s, c) = (f64::from(i) * 0.1).sin_cos();
            finger([c, s, 0.0], [-c, -s, 0.0], Friction::Hard { mu: 0.3 })
        })
        .collect();
    assert!(grasp_quality(&contacts, PLANE, GraspMetric::L1).unwrap().closed);
    let refused = grasp_mobility(&contacts, PLANE).unwrap_err();
    assert!(matches!(refused, Error::InvalidOption { option: "contacts", .. }), "{refused}");
    contacts.truncate(3);
    for size in [1e60, 1e100, 1e119] {
        contacts[0].point = Vec3::new(size, 0.0, 0.0);
        for c in &mut contacts {
            c.curvature.finger.principal = [20.0, 10.0];
        }
        // An answer or an error.
        if let Err(error) = grasp_mobility(&contacts, PLANE) {
            let option = matches!(error, Error::InvalidOption { option: "curvature", .. });
            assert!(option, "{size:e}: {error}");
        }
    }
}
