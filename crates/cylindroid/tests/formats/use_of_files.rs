//! What is done with a file that may be anything: it is read, and what was read is used. Tests and fuzz
//! targets share it.

use std::path::Path;

use cylindroid::collision::{CollisionModel, CollisionOptions, distance};
use cylindroid::model::Geometry;
use cylindroid::model::formats::srdf;
use cylindroid::{Mechanism, Pose, Vec3, load_file};

/// Loads a model and uses it.
pub(crate) fn model(path: &Path) -> bool {
    match load_file(path) {
        Ok(robot) => {
            exercise(&robot);
            true
        }
        Err(error) => {
            let message = error.to_string();
            assert!(!message.is_empty() && message.len() < 5000, "{message}");
            false
        }
    }
}

fn exercise(robot: &Mechanism) {
    assert!(robot.home().iter().all(|x| x.is_finite()));
    let state = robot.state(robot.home()).unwrap();
    let tool = robot.tool();
    let pose = state.pose(tool).unwrap();
    assert!(pose.translation.is_finite(), "{pose:?}");
    let moved = robot.integrate(robot.home(), &vec![0.1; robot.n()], 0.1).unwrap();
    assert!(robot.state(&moved).unwrap().pose(tool).unwrap().translation.is_finite());
    let _ = cylindroid::ik::Analytic::of(robot, tool);
    let options = CollisionOptions { samples: 0, ..CollisionOptions::default() };
    if let Ok(mut model) = CollisionModel::new(robot, &options) {
        let _ = model.near(&state, 0.1, &mut Vec::new());
    }
}

/// Reads the groups and poses of a semantic description for this robot.
pub(crate) fn semantics(path: &Path, robot: &Mechanism) -> bool {
    match srdf::load(path) {
        Ok(srdf) => {
            let _ = srdf.pairs(robot);
            true
        }
        Err(_) => false,
    }
}

/// Reads a mesh and its distance from a ball.
pub(crate) fn mesh(path: &Path) -> bool {
    let ball = Geometry::Sphere { radius: 0.1 };
    let away = Pose::from_translation(Vec3::new(3.0, 0.2, 0.1));
    let scale = Vec3::new(1.0, 1.0, 1.0);
    let mesh = Geometry::Mesh { uri: String::new(), path: Some(path.to_owned()), scale };
    match distance((&mesh, Pose::IDENTITY), (&ball, away)) {
        Ok(found) => {
            assert!(found.distance.is_finite() && found.normal.is_finite(), "{found:?}");
            true
        }
        Err(_) => false,
    }
}
