//! The depth of ellipsoids, against a dense search over directions.

use cylindroid::collision::distance;
use cylindroid::model::Geometry;
use cylindroid::{Pose, Vec3};

use crate::support::Random;

/// The extent of a body along a direction.
type Extent<'a> = Box<dyn Fn(Vec3) -> f64 + 'a>;

/// The least of f over unit vectors: a search over directions, each of the best made better.
fn least(f: impl Fn(Vec3) -> f64) -> f64 {
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let count = 4000;
    let mut all: Vec<(f64, Vec3)> = (0..count)
        .map(|i| {
            let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
            let (y, x) = (golden * f64::from(i)).sin_cos();
            let r = (1.0 - z * z).sqrt();
            let n = Vec3::new(r * x, r * y, z);
            (f(n), n)
        })
        .collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let best = all.iter().take(30).map(|&(mut value, mut n)| {
        let mut step = 0.05;
        while step > 1e-9 {
            let mut moved = false;
            for d in [Vec3::X, Vec3::Y, Vec3::Z].into_iter().flat_map(|d| [d, -d]) {
                let next = (n + d * step).unit(1e-9).unwrap();
                let there = f(next);
                if there < value {
                    (value, n, moved) = (there, next, true);
                }
            }
            if !moved {
                step *= 0.5;
            }
        }
        value
    });
    best.fold(f64::INFINITY, f64::min)
}

fn extent(radii: Vec3, n: Vec3) -> f64 {
    Vec3::new(radii.x * n.x, radii.y * n.y, radii.z * n.z).norm()
}

#[test]
fn equal_radii_make_a_sphere() {
    let egg = Geometry::Ellipsoid { radii: Vec3::new(0.2, 0.2, 0.2) };
    let ball = Geometry::Sphere { radius: 0.2 };
    let mut random = Random(4);
    for _ in 0..20 {
        let (p, q) = (random.pose(), random.pose());
        let near = Pose { translation: q.translation * 0.1 + p.translation, ..q };
        for at in [q, near] {
            let it = distance((&egg, p), (&egg, at)).unwrap();
            let other = distance((&ball, p), (&ball, at)).unwrap();
            assert!((it.distance - other.distance).abs() < 1e-14, "{it:?} {other:?}");
        }
    }
}

#[test]
fn the_depth_is_least_over_all_directions() {
    let mut random = Random(8);
    let mut worst = [0.0_f64; 3];
    for round in 0..150 {
        let mut radii = || {
            let mut length = || random.within(0.1, 0.3);
            let (x, y, z) = (length(), length(), length());
            match round % 3 {
                0 => Vec3::new(x, y, z),
                1 => Vec3::new(x, x, z),
                _ => Vec3::new(x, x * (1.0 + 1e-3 * y), x * (1.0 - 1e-3 * z)),
            }
        };
        let (a, b) = (radii(), radii());
        let spread = [0.0, 1e-6, 1e-2, 0.1][round % 4];
        let mut pose = || Pose { rotation: random.rotation(), translation: random.vec3(spread) };
        let (p, q) = (pose(), pose());
        let first = Geometry::Ellipsoid { radii: a };
        let others: [(Geometry, Extent<'_>); 3] = [
            (Geometry::Ellipsoid { radii: b }, Box::new(|n| extent(b, n))),
            (
                Geometry::Box { size: b },
                Box::new(|n| 0.5 * (b.x * n.x.abs() + b.y * n.y.abs() + b.z * n.z.abs())),
            ),
            (
                Geometry::Cylinder { radius: b.x, length: b.z },
                Box::new(|n| b.x * n.x.hypot(n.y) + 0.5 * b.z * n.z.abs()),
            ),
        ];
        for (kind, (second, second_extent)) in others.iter().enumerate() {
            let h = |n: Vec3| {
                let (local_a, local_b) = (p.rotation.inverse() * n, q.rotation.inverse() * n);
                extent(a, local_a) + second_extent(local_b) + n.dot(p.translation - q.translation)
            };
            let it = distance((&first, p), (second, q)).unwrap();
            let wanted = least(h);
            worst[kind] = worst[kind].max((-it.distance - wanted) / wanted.abs());
            // No less than the extent along any direction, and as much as that along the normal.
            assert!((h(it.normal) + it.distance).abs() < 1e-12, "{it:?}");
            // The points are on the ellipsoids.
            let mut ends = vec![(p, it.point_a, a)];
            ends.extend((kind == 0).then_some((q, it.point_b, b)));
            for (at, point, radii) in ends {
                let local = at.inverse() * point;
                let x = Vec3::new(local.x / radii.x, local.y / radii.y, local.z / radii.z);
                assert!((x.norm() - 1.0).abs() < 1e-6, "{it:?} {x:?}");
            }
        }
    }
    assert!(worst.iter().all(|error| *error < 1e-8), "{worst:?}");
}
