//! Exact laws of distances: symmetry, frames, scale, translation along the normal, equal shapes
//! written in different ways.

use cylindroid::collision::{Separation, distance};
use cylindroid::model::Geometry;
use cylindroid::{Pose, Vec3};

use crate::shapes::{KINDS, scaled, shape};
use crate::support::Random;

/// Both shapes, their poses and their separation, for all kinds, apart and overlapping.
fn each_pair(mut f: impl FnMut([(&Geometry, Pose); 2], Separation, f64)) {
    let mut random = Random(11);
    for kind_a in 0..KINDS {
        for kind_b in 0..KINDS {
            if kind_a.min(kind_b) == 6 {
                continue;
            }
            for round in 0..40 {
                let (a, b) = (shape(&mut random, kind_a), shape(&mut random, kind_b));
                let spread = if round % 4 == 0 { 0.2 } else { 0.8 };
                let mut pose =
                    || Pose { rotation: random.rotation(), translation: random.vec3(spread) };
                let pair = [(&a, pose()), (&b, pose())];
                // The depth of curved cores, cylinders and ellipsoids, is found to 1e-8.
                let it = distance(pair[0], pair[1]).unwrap();
                let curved = |k| k == 3 || k == 4;
                let deep = it.distance < 0.0 && (curved(kind_a) || curved(kind_b));
                f(pair, it, if deep { 1e-7 } else { 1e-12 });
            }
        }
    }
}

#[test]
fn points_normal_and_distance_agree() {
    let (mut apart, mut overlapping) = (0, 0);
    each_pair(|_, it, _| {
        assert!((it.normal.norm() - 1.0).abs() < 1e-12);
        let gap = it.point_b - it.point_a - it.normal * it.distance;
        assert!(gap.norm() < 1e-12, "{it:?}");
        apart += usize::from(it.distance > 0.0);
        overlapping += usize::from(it.distance < 0.0);
    });
    assert!(apart > 500 && overlapping > 300, "{apart} {overlapping}");
}

#[test]
fn order_does_not_matter() {
    each_pair(|[a, b], it, tolerance| {
        let other = distance(b, a).unwrap();
        assert!((it.distance - other.distance).abs() < tolerance, "{it:?} {other:?}");
    });
}

#[test]
fn frames_do_not_matter() {
    let mut random = Random(5);
    each_pair(|[a, b], it, tolerance| {
        let moved = random.pose();
        let there = distance((a.0, moved * a.1), (b.0, moved * b.1)).unwrap();
        assert!((it.distance - there.distance).abs() < tolerance, "{a:?} {b:?} {it:?} {there:?}");
    });
}

#[test]
fn distances_scale_with_the_lengths() {
    each_pair(|[a, b], it, tolerance| {
        for by in [1e-3, 50.0] {
            let (first, second) = (scaled(a.0, by), scaled(b.0, by));
            let far = |p: Pose| Pose { translation: p.translation * by, ..p };
            let there = distance((&first, far(a.1)), (&second, far(b.1))).unwrap();
            let error = (it.distance * by - there.distance).abs();
            assert!(error < tolerance * by, "{a:?} {b:?} {it:?} {there:?}");
        }
    });
}

/// The plane at the closest point separates the shapes: translation of b along the normal increases the
/// distance by its length, from penetration to beyond. This certifies the distance.
#[test]
fn translation_along_the_normal_adds_to_the_distance() {
    each_pair(|[a, b], it, tolerance| {
        for length in [0.1, 0.7] {
            let step = it.normal * (length - it.distance.min(0.0));
            let moved = Pose { translation: b.1.translation + step, ..b.1 };
            let there = distance(a, (b.0, moved)).unwrap();
            let expected = length + it.distance.max(0.0);
            let error = (there.distance - expected).abs();
            assert!(error < 10.0 * tolerance, "{a:?} {b:?} {it:?} {there:?}");
        }
    });
}

/// No other translation of the length of the depth separates the shapes.
#[test]
fn no_shorter_translation_separates() {
    let mut random = Random(9);
    each_pair(|[a, b], it, _| {
        if it.distance >= 0.0 || matches!(b.0, Geometry::HalfSpace) {
            return;
        }
        for _ in 0..10 {
            let step = random.rotation() * Vec3::X * (-it.distance * 0.999);
            let moved = Pose { translation: b.1.translation + step, ..b.1 };
            assert!(distance(a, (b.0, moved)).unwrap().distance < 0.0, "{a:?} {b:?} {it:?}");
        }
    });
}

/// Closed forms against the iterative algorithms, on the same shapes written as hulls.
#[test]
fn hulls_of_corners_are_boxes_and_segments() {
    let mut random = Random(21);
    for _ in 0..300 {
        let size = Vec3::new(random.within(0.1, 1.0), random.within(0.1, 1.0), 0.3);
        let sign = |i: usize, bit: usize| if i >> bit & 1 == 0 { -0.5 } else { 0.5 };
        let corner = |i| Vec3::new(size.x * sign(i, 0), size.y * sign(i, 1), size.z * sign(i, 2));
        let hull = Geometry::ConvexHull { points: (0..8).map(corner).collect() };
        let block = Geometry::Box { size };
        let line = Geometry::Capsule { radius: 0.0, length: 0.6 };
        let ends = Geometry::ConvexHull { points: vec![Vec3::Z * 0.3, Vec3::Z * -0.3] };
        let point = Geometry::Sphere { radius: 0.0 };
        let (p, q) = (random.pose(), random.pose());
        for (a, b, c, d) in [
            (&point, &block, &point, &hull),
            (&line, &block, &ends, &hull),
            (&block, &block, &hull, &hull),
            (&line, &line, &ends, &ends),
            (&point, &line, &point, &ends),
        ] {
            let (first, second) =
                (distance((a, p), (b, q)).unwrap(), distance((c, p), (d, q)).unwrap());
            assert!((first.distance - second.distance).abs() < 1e-12, "{first:?} {second:?}");
        }
    }
}

#[test]
fn special_positions() {
    let at = |x, y, z| Pose::from_translation(Vec3::new(x, y, z));
    let ball = Geometry::Sphere { radius: 0.1 };
    let rod = Geometry::Capsule { radius: 0.1, length: 1.0 };
    let block = Geometry::Box { size: Vec3::new(1.0, 1.0, 1.0) };
    let drum = Geometry::Cylinder { radius: 0.5, length: 1.0 };
    let ground = Geometry::HalfSpace;
    let turned = Pose {
        rotation: cylindroid::Rotation::about(Vec3::X, std::f64::consts::FRAC_PI_2).unwrap(),
        translation: Vec3::ZERO,
    };
    for (a, b, expected) in [
        // At one place.
        ((&ball, at(0.0, 0.0, 0.0)), (&ball, at(0.0, 0.0, 0.0)), -0.2),
        ((&rod, at(0.0, 0.0, 0.0)), (&rod, at(0.0, 0.0, 0.0)), -0.2),
        ((&rod, at(0.0, 0.0, 0.0)), (&rod, turned), -0.2),
        ((&ball, at(0.0, 0.0, 0.0)), (&block, at(0.0, 0.0, 0.0)), -0.6),
        ((&ball, at(0.0, 0.0, 0.0)), (&drum, at(0.0, 0.0, 0.0)), -0.6),
        ((&block, at(0.0, 0.0, 0.0)), (&block, at(0.0, 0.0, 0.0)), -1.0),
        // Parallel, side by side and one after the other.
        ((&rod, at(0.0, 0.0, 0.0)), (&rod, at(1.0, 0.0, 0.4)), 0.8),
        ((&rod, at(0.0, 0.0, 0.0)), (&rod, at(0.0, 0.0, 2.0)), 0.8),
        // Touching.
        ((&block, at(0.0, 0.0, 0.0)), (&block, at(1.0, 0.0, 0.0)), 0.0),
        ((&ball, at(0.0, 0.0, 0.6)), (&block, at(0.0, 0.0, 0.0)), 0.0),
        ((&block, at(0.0, 0.0, 0.5)), (&ground, at(0.0, 0.0, 0.0)), 0.0),
        // Above and below the ground.
        ((&ground, at(0.0, 0.0, 0.0)), (&rod, at(3.0, 0.0, 1.0)), 0.4),
        ((&rod, at(3.0, 0.0, -1.0)), (&ground, at(0.0, 0.0, 0.0)), -1.6),
        ((&drum, turned), (&ground, at(0.0, 0.0, -2.0)), 1.5),
        // Faces and edges.
        ((&block, at(0.0, 0.0, 0.0)), (&block, at(2.0, 0.3, -0.2)), 1.0),
        ((&drum, at(0.0, 0.0, 0.0)), (&drum, at(0.0, 0.0, 3.0)), 2.0),
        ((&ball, at(1.5, 0.0, 0.0)), (&drum, at(0.0, 0.0, 0.0)), 0.9),
    ] {
        for it in [distance(a, b).unwrap(), distance(b, a).unwrap()] {
            assert!((it.distance - expected).abs() < 1e-9, "{a:?} {b:?} {it:?}");
            assert!((it.normal.norm() - 1.0).abs() < 1e-12);
            assert!((it.point_b - it.point_a - it.normal * it.distance).norm() < 1e-9, "{it:?}");
        }
    }
}

#[test]
fn shapes_without_sense_are_refused() {
    let at = Pose::IDENTITY;
    let ball = Geometry::Sphere { radius: 0.1 };
    for bad in [
        Geometry::Sphere { radius: -1.0 },
        Geometry::Sphere { radius: f64::NAN },
        Geometry::Box { size: Vec3::new(1e200, 1.0, 1.0) },
        Geometry::ConvexHull { points: Vec::new() },
        Geometry::ConvexHull { points: vec![Vec3::new(f64::INFINITY, 0.0, 0.0)] },
        Geometry::Mesh { uri: "a.stl".into(), path: None, scale: Vec3::X },
    ] {
        assert!(distance((&bad, at), (&ball, at)).is_err(), "{bad:?}");
    }
    let plane = Geometry::HalfSpace;
    assert!(distance((&plane, at), (&plane, at)).unwrap_err().to_string().contains("half-spaces"));
    let lost = Pose::from_translation(Vec3::new(f64::NAN, 0.0, 0.0));
    assert!(distance((&ball, lost), (&ball, at)).is_err());
}

/// A shape whose lengths are too small for the squares of their reciprocals is a point; overlapping,
/// it is as deep as a point is.
#[test]
fn shapes_without_extent_are_points() {
    let mut random = Random(19);
    let point = Geometry::Sphere { radius: 0.0 };
    for size in [0.0, 5e-324, 1e-320, 1e-200, 1e-150, 1e-31, 1e-29, 1e-20] {
        // A half-space has no size.
        for kind in (0..KINDS).filter(|kind| *kind != 6) {
            for other in 0..KINDS {
                let (small, body) = (shape(&mut random, kind), shape(&mut random, other));
                let small = scaled(&small, size);
                for spread in [3.0, 0.02] {
                    let mut pose =
                        || Pose { rotation: random.rotation(), translation: random.vec3(spread) };
                    let (at, there) = (pose(), pose());
                    let it = distance((&small, at), (&body, there)).unwrap();
                    let wanted = distance((&point, at), (&body, there)).unwrap();
                    let unlike = format!("{it:?} instead of {wanted:?}: {small:?}, {body:?}");
                    assert!((it.distance - wanted.distance).abs() < 1e-9, "{unlike}");
                    assert!((it.normal.norm() - 1.0).abs() < 1e-12, "{unlike}");
                    assert!(it.point_a.is_finite() && it.point_b.is_finite(), "{unlike}");
                }
                let it = distance((&small, Pose::IDENTITY), (&small, Pose::IDENTITY)).unwrap();
                assert!(it.distance.abs() <= 1e-12, "{it:?}: {small:?} and itself");
            }
        }
    }
}
