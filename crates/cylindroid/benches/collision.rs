//! How long distances between links take: `cargo bench -p cylindroid --bench collision`.
#![allow(missing_docs, clippy::unwrap_used)]

use cylindroid::collision::{CollisionModel, CollisionOptions, distance};
use cylindroid::model::{Collision, Geometry, Inclusion};
use cylindroid::{Mechanism, Pose, Rotation, Vec3, catalogue};
use divan::{Bencher, black_box};

fn main() {
    divan::main();
}

/// A panda with four spheres on each of its eight links.
fn panda_of_spheres() -> Mechanism {
    let panda = catalogue::load("panda").unwrap();
    let mut builder = Mechanism::builder("panda of spheres");
    let how = Inclusion {
        name: "",
        parent: &panda.links()[0].name,
        parent_from_root: Pose::IDENTITY,
        free: false,
        start: panda.home(),
    };
    builder.include(&panda, how).unwrap();
    for link in &panda.links()[..8] {
        for k in 0..4 {
            let at = Vec3::new(0.0, 0.02 * f64::from(k), -0.05 * f64::from(k));
            let geometry = Geometry::Sphere { radius: 0.05 };
            let link_from_shape = Pose::from_translation(at);
            builder.collision(
                &link.name,
                Collision { geometry, link_from_shape, ..Collision::default() },
            );
        }
    }
    builder.build().unwrap()
}

/// Spheres in the workspace, so that there are some 500 pairs.
fn scene(robot: &Mechanism, obstacles: usize) -> CollisionModel {
    let options = CollisionOptions { samples: 0, ..CollisionOptions::default() };
    let mut model = CollisionModel::new(robot, &options).unwrap();
    for k in 0..obstacles {
        let turn = Rotation::about_z(k as f64);
        let pose = Pose::from_translation(turn * Vec3::new(0.6, 0.0, 0.1 * k as f64));
        let ball = Geometry::Sphere { radius: 0.05 };
        model.add_obstacle(&format!("ball {k}"), &ball, pose).unwrap();
    }
    model
}

/// Distances and gradients of the pairs within a margin: 0.1 m, and all.
#[divan::bench(args = [0.1, f64::INFINITY])]
fn panda_of_32_spheres_and_6_obstacles(bencher: Bencher<'_, '_>, margin: f64) {
    let robot = panda_of_spheres();
    let mut model = scene(&robot, 6);
    assert!((450..550).contains(&model.pairs().len()), "{}", model.pairs().len());
    let mut state = robot.state(robot.home()).unwrap();
    let home = robot.home().to_vec();
    let near: Vec<f64> = home.iter().map(|x| x + 1e-3).collect();
    let (mut found, mut row) = (Vec::new(), vec![0.0; robot.n()]);
    let mut i = 0;
    bencher.bench_local(|| {
        i ^= 1;
        state.set(if i == 0 { &home } else { &near }).unwrap();
        model.near(&state, margin, &mut found).unwrap();
        for pair in &found {
            model.gradient_into(&state, pair, &mut row);
            black_box(&row);
        }
    });
}

/// One pair of shapes, apart or with overlapping cores.
#[divan::bench(args = ["capsules", "boxes", "cylinders", "hulls", "boxes inside", "hulls inside"])]
fn pair(bencher: Bencher<'_, '_>, kind: &str) {
    let hull = || {
        let point = |k: usize| {
            let (turn, tilt) = (Rotation::about_z(0.7 * k as f64), 0.1 * k as f64);
            turn * Vec3::new(0.2 * tilt.cos(), 0.0, 0.3 * tilt.sin())
        };
        Geometry::ConvexHull { points: (0..200).map(point).collect() }
    };
    let shape = match kind.split(' ').next() {
        Some("capsules") => Geometry::Capsule { radius: 0.1, length: 0.5 },
        Some("boxes") => Geometry::Box { size: Vec3::new(0.3, 0.4, 0.5) },
        Some("cylinders") => Geometry::Cylinder { radius: 0.2, length: 0.5 },
        _ => hull(),
    };
    let away = if kind.ends_with("inside") { 0.2 } else { 1.0 };
    let pose = Pose {
        rotation: Rotation::exp(Vec3::new(0.3, -0.5, 0.8)),
        translation: Vec3::new(away, 0.1, -0.1),
    };
    let mut builder = Mechanism::builder("one body");
    builder.collision("body", Collision { geometry: shape.clone(), ..Collision::default() });
    let kind = cylindroid::model::JointKind::Prismatic;
    builder.joint(cylindroid::model::JointSpec::new("x", kind, "world", "body"));
    let robot = builder.build().unwrap();
    let mut model = scene(&robot, 0);
    model.add_obstacle("other", &shape, pose).unwrap();
    assert!(distance((&shape, pose), (&shape, Pose::IDENTITY)).is_ok());
    let state = robot.state(&[0.0]).unwrap();
    let mut found = Vec::new();
    bencher.bench_local(|| {
        model.near(&state, 10.0, &mut found).unwrap();
        black_box(&found);
    });
}
