//! Thin shapes: hulls of meshes that are nearly flat, or flat.

use std::f64::consts::TAU;
use std::fmt::Write;
use std::fs;

use cylindroid::collision::distance;
use cylindroid::model::Geometry;
use cylindroid::{Pose, Vec3};

use crate::support::Random;

/// The farthest of points along a direction.
fn reach(points: &[Vec3], n: Vec3) -> f64 {
    points.iter().map(|p| p.dot(n)).fold(f64::NEG_INFINITY, f64::max)
}

/// The hull of points extends along directions as far as they do.
fn check_extents(points: &[Vec3], directions: &[Vec3]) {
    let hull = Geometry::ConvexHull { points: points.to_vec() };
    let size = points.iter().map(|p| p.norm()).fold(0.0, f64::max);
    for n in directions {
        // A half-space whose inner side is where n points to.
        let rotation = cylindroid::Rotation::z_to(-*n).unwrap();
        let beyond = Pose { rotation, translation: Vec3::ZERO };
        let it = distance((&hull, Pose::IDENTITY), (&Geometry::HalfSpace, beyond)).unwrap();
        assert!((it.distance + reach(points, *n)).abs() < 4e-12 * size, "{it:?} {n:?}");
    }
}

#[test]
fn a_shallow_pyramid_of_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pyramid.obj");
    let text = "v -1 -1 0\nv -1 1 0\nv 1 -1 0\nv 1 1 0\nv 0 0 -0.001\n\
                f 1 2 5\nf 2 4 5\nf 4 3 5\nf 3 1 5\n";
    fs::write(&path, text).unwrap();
    let scale = Vec3::new(1.0, 1.0, 1.0);
    let mesh = Geometry::Mesh { uri: "pyramid.obj".into(), path: Some(path), scale };
    let below = Pose::from_translation(Vec3::Z * -0.0005);
    let it = distance((&mesh, Pose::IDENTITY), (&Geometry::HalfSpace, below)).unwrap();
    assert!((it.distance + 0.0005).abs() < 1e-15, "{it:?}");
}

#[test]
fn hulls_extend_as_far_as_their_points() {
    let mut random = Random(31);
    let some: Vec<Vec3> = (0..30).map(|_| random.rotation() * Vec3::Z).collect();
    for thickness in [0.0, 1e-13, 1e-9, 1e-6, 1e-4, 1e-3, 0.1] {
        let turned = random.rotation();
        let mut directions = some.clone();
        directions.extend([Vec3::X, Vec3::Y, Vec3::Z].into_iter().flat_map(|axis| {
            let axis = turned * axis;
            [axis, -axis]
        }));
        let flat = |p: Vec3| turned * Vec3::new(p.x, p.y, thickness * p.z);
        let thin = |p: Vec3| turned * Vec3::new(p.x, thickness * p.y, thickness * p.z);
        for count in [6, 40, 500] {
            let cube: Vec<Vec3> = (0..count).map(|_| random.vec3(1.0)).collect();
            let ball: Vec<Vec3> = (0..count).map(|_| random.rotation() * Vec3::Z).collect();
            for points in [cube, ball] {
                check_extents(&points.iter().map(|p| flat(*p)).collect::<Vec<_>>(), &directions);
                check_extents(&points.iter().map(|p| thin(*p)).collect::<Vec<_>>(), &directions);
            }
        }
    }
}

/// A plate of 2 m with rounded corners, of 40 000 points, and a spike of 100 mm.
#[test]
fn a_plate_with_a_spike() {
    let mut points = Vec::new();
    for i in 0..200 {
        for j in 0..200 {
            let at = |k: i32| f64::from(k) / 99.5 - 1.0;
            points.push(Vec3::new(at(i), at(j), 0.0));
        }
    }
    points.extend((0..100).map(|i| {
        let (y, x) = (TAU * f64::from(i) / 100.0).sin_cos();
        Vec3::new(x, y, 0.0) * 1.2
    }));
    points.push(Vec3::new(0.3, 0.2, 0.1));
    let mut directions = vec![Vec3::Z, -Vec3::Z, Vec3::X];
    directions.push(Vec3::new(0.3, 0.1, 0.7).unit(1e-9).unwrap());
    check_extents(&points, &directions);
    let turned = Random(3).rotation();
    let points: Vec<Vec3> = points.iter().map(|p| turned * *p).collect();
    check_extents(&points, &directions.iter().map(|d| turned * *d).collect::<Vec<_>>());
}

/// The solid of a thin convex mesh in MJCF weighs what its volume does.
#[test]
fn the_mass_of_a_shallow_pyramid() {
    let folder = tempfile::tempdir().unwrap();
    let mut text = String::new();
    for p in ["-1 -1 0", "-1 1 0", "1 -1 0", "1 1 0", "0 0 -0.001"] {
        writeln!(text, "v {p}").unwrap();
    }
    text += "f 1 2 5\nf 2 4 5\nf 4 3 5\nf 3 1 5\nf 1 3 4\nf 1 4 2\n";
    fs::write(folder.path().join("pyramid.obj"), text).unwrap();
    let file = folder.path().join("pyramid.xml");
    let model = r#"<mujoco><asset><mesh name="m" file="pyramid.obj" inertia="convex"/></asset>
        <worldbody><body name="b"><freejoint/><geom type="mesh" mesh="m" density="3000"/></body>
        </worldbody></mujoco>"#;
    fs::write(&file, model).unwrap();
    let model = cylindroid::load_file(&file).unwrap();
    let link = model.links().iter().find(|link| link.name == "b").unwrap();
    let mass = link.inertial.unwrap().mass;
    assert!((mass - 3000.0 * 4.0 * 0.001 / 3.0).abs() < 1e-9, "{mass}");
}

/// The touching point is on both bodies.
#[test]
fn a_ball_at_a_flat_mesh() {
    let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)];
    let points = corners.map(|(x, y)| Vec3::new(x, y, 0.0)).to_vec();
    let square = Geometry::ConvexHull { points };
    let ball = Geometry::Sphere { radius: 0.1 };
    for z in [0.0, 1e-9, -1e-9, 1e-14] {
        let center = Vec3::new(0.9, 0.8, z);
        let it = distance((&square, Pose::IDENTITY), (&ball, Pose::from_translation(center)));
        let it = it.unwrap();
        assert!((it.distance - z.abs() + 0.1).abs() < 1e-12, "{it:?}");
        let below = Vec3::new(0.9, 0.8, 0.0);
        assert!((it.point_a - below).norm() < 1e-12, "{it:?}");
        assert!(((it.point_b - center).norm() - 0.1).abs() < 1e-12, "{it:?}");
        assert!((it.point_b - it.point_a - it.normal * it.distance).norm() < 1e-12, "{it:?}");
    }
}
