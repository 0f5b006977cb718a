//! Distances between the links of robots against Coal (of Pinocchio), with primitives and meshes.
//!
//! The vectors were written by `xtask/vectors/collision_vectors.py` (`cargo xtask vectors`).

use std::path::{Path, PathBuf};

use cylindroid::collision::{CollisionModel, CollisionOptions};
use cylindroid::{Mechanism, Vec3};
use serde_json::Value;

fn robots_folder() -> PathBuf {
    let folder = std::env::var_os("CYLINDROID_TEST_ROBOTS").map_or_else(
        || {
            Path::new(env!("CARGO_MANIFEST_DIR"))
                .join("../../target/test-data/models/cmeel.prefix/share/example-robot-data/robots")
        },
        PathBuf::from,
    );
    assert!(folder.is_dir(), "no robot files in {}: run `cargo xtask setup`", folder.display());
    folder
}

#[test]
fn distances_agree_with_coal() {
    let vectors = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/vectors/collision");
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(vectors).unwrap().map(|e| e.unwrap().path()).collect();
    files.sort();
    assert!(files.len() >= 7, "{} robots", files.len());
    for file in files {
        let data: Value = serde_json::from_str(&std::fs::read_to_string(&file).unwrap()).unwrap();
        let urdf = robots_folder().join(data["urdf"].as_str().unwrap());
        check(&cylindroid::load_file(&urdf).unwrap(), &data);
    }
}

fn check(robot: &Mechanism, data: &Value) {
    let name = data["robot"].as_str().unwrap();
    let options = CollisionOptions { samples: 0, ..CollisionOptions::default() };
    let mut model = CollisionModel::new(robot, &options).unwrap();
    assert!(model.ignored().is_empty(), "{name}: {:?}", model.ignored());
    assert_eq!(model.bodies().len(), data["shapes"].as_u64().unwrap() as usize, "{name}");
    assert_eq!(model.pairs().len(), data["pairs"].as_u64().unwrap() as usize, "{name}");
    let place = |joint: &Value| {
        let joint = joint.as_str().unwrap();
        robot.coordinates().iter().position(|c| c.name == joint).unwrap()
    };
    let places: Vec<usize> = data["joints"].as_array().unwrap().iter().map(place).collect();
    let configurations = data["configurations"].as_array().unwrap();
    assert!(configurations.len() >= 20);
    let (mut near, mut compared, mut deep, mut longer) = (Vec::new(), 0, 0, 0);
    for configuration in configurations {
        let mut q = robot.home().to_vec();
        for (x, &place) in configuration["q"].as_array().unwrap().iter().zip(&places) {
            q[place] = x.as_f64().unwrap();
        }
        model.near(&robot.state(&q).unwrap(), f64::INFINITY, &mut near).unwrap();
        for pair in configuration["pairs"].as_array().unwrap() {
            let body = |end: &Value| {
                let (link, number) = (end[0].as_str().unwrap(), end[1].as_u64().unwrap());
                let first = model.bodies().iter().position(|b| b.name == link).unwrap();
                first + number as usize
            };
            let (a, b) = (body(&pair["a"]), body(&pair["b"]));
            let ours = near.iter().find(|n| {
                let p = model.pairs()[n.pair];
                (p.a, p.b) == (a, b) || (p.a, p.b) == (b, a)
            });
            let ours = ours.unwrap_or_else(|| panic!("{name}: {pair} is not watched"));
            let theirs = pair["distance"].as_f64().unwrap();
            let error = (ours.distance - theirs).abs();
            if theirs > 0.0 {
                assert!(error < 1e-7, "{name}: {pair} {ours:?}");
            } else {
                // Coal's expanding polytope ends on some cylinders before the shortest translation;
                // that ours separates is a law of its own (`laws.rs`).
                assert!(ours.distance > theirs - 2e-6, "{name}: {pair} {ours:?}");
                deep += 1;
                longer += usize::from(error > 2e-6);
            }
            if let Some(n) = pair["normal"].as_array() {
                let n = Vec3::new(
                    n[0].as_f64().unwrap(),
                    n[1].as_f64().unwrap(),
                    n[2].as_f64().unwrap(),
                );
                let side = if model.pairs()[ours.pair].a == a { 1.0 } else { -1.0 };
                assert!((ours.normal * side - n).norm() < 1e-3, "{name}: {pair} {ours:?}");
            }
            compared += 1;
        }
    }
    assert!(compared > 50, "{name}: {compared}");
    assert!(10 * longer <= deep, "{name}: {longer} of {deep}");
}
