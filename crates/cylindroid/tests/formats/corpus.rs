//! The corpus of public robot files (`cargo xtask corpus`): each file that MuJoCo or Pinocchio
//! loads is loaded and agrees with it in poses, masses and limits, or is on the list of exceptions
//! with a reason, which must be true.

use std::collections::BTreeMap;
use std::path::PathBuf;

use cylindroid::model::JointKind;
use cylindroid::spatial::Quaternion;
use cylindroid::{Mechanism, Pose, Vec3};
use serde_json::Value;

use crate::mjcf::{coordinates, numbers};

const EXCEPTIONS: &str = include_str!("../data/corpus-exceptions.txt");

/// Poses of the file and of the program differ by rounding of numbers in the file.
const POSE: f64 = 1e-6;

fn folder() -> PathBuf {
    let folder = std::env::var_os("CYLINDROID_CORPUS").map(PathBuf::from);
    folder.unwrap_or_else(|| panic!("run `cargo xtask corpus`"))
}

fn rotation(quaternion: &[f64]) -> cylindroid::Rotation {
    let [w, x, y, z] = quaternion.try_into().unwrap();
    Quaternion { w, x, y, z }.rotation().unwrap()
}

/// Our `q` of Pinocchio's, by the names of the joints; joints of several coordinates stay at home.
fn by_name(m: &Mechanism, given: &Value) -> Vec<f64> {
    let mut q = vec![0.0; m.n()];
    for (i, coordinate) in m.coordinates().iter().enumerate() {
        q[i] = given[&coordinate.name].as_f64().unwrap_or(0.0);
    }
    q
}

/// True where the report says that the mass of a mesh is unknown.
fn has_mesh_mass(m: &Mechanism) -> bool {
    m.report().ignored.iter().any(|i| i.what.starts_with("mass of a geom"))
}

/// The inertia of each body.
fn masses(m: &Mechanism, of: &Value) -> Result<(), String> {
    for (name, mass) in of["masses"].as_object().unwrap() {
        let expected = numbers(mass);
        // A body without mass has no centre. A mesh without volume is noted.
        let without = |l: &cylindroid::model::Link| l.name == *name && l.inertial.is_none();
        let unknown = has_mesh_mass(m) && m.links().iter().any(without);
        if expected[0] == 0.0 || unknown {
            continue;
        }
        let Some(link) = m.links().iter().find(|l| l.name == *name) else { continue };
        let own = link.inertial.map_or([0.0; 10], |i| {
            let axes = i.link_from_inertia.rotation;
            let rows = (axes.matrix() * i.inertia * axes.matrix().transpose()).to_rows();
            let [x, y, z] = i.link_from_inertia.translation.to_array();
            let [[xx, xy, xz], [_, yy, yz], [_, _, zz]] = rows;
            [i.mass, x, y, z, xx, xy, xz, yy, yz, zz]
        });
        let size = expected.iter().fold(1e-6, |a: f64, b| a.max(b.abs()));
        for (own, expected) in own.iter().zip(&expected) {
            if (own - expected).abs() > 1e-6 * size {
                return Err(format!("inertia of {name}: {own} instead of {expected}"));
            }
        }
    }
    Ok(())
}

/// The mass matrix with armatures, where all masses are known.
fn mass_matrix(m: &Mechanism, of: &Value) -> Result<(), String> {
    let case = of["cases"].as_array().unwrap().last().unwrap();
    let Some(rows) = case["mass_matrix"].as_array().filter(|_| !has_mesh_mass(m)) else {
        return Ok(());
    };
    let expected: Vec<Vec<f64>> = rows.iter().map(numbers).collect();
    let own = m.state(&coordinates(m, &case["q"])).unwrap().mass_matrix();
    if own.rows() != expected.len() {
        return Err(format!("mass matrix of {} rows, not {}", own.rows(), expected.len()));
    }
    let size = expected.iter().flatten().fold(0.0, |a: f64, b| a.max(b.abs()));
    for (i, row) in expected.iter().enumerate() {
        for (j, x) in row.iter().enumerate() {
            if (own[(i, j)] - x).abs() > 1e-6 * size {
                return Err(format!("mass matrix ({i}, {j}): {} instead of {x}", own[(i, j)]));
            }
        }
    }
    Ok(())
}

/// The first difference from the program of the format.
fn compare(m: &Mechanism, of: &Value) -> Result<(), String> {
    let is_mujoco = of["program"] == "MuJoCo";
    for case in of["cases"].as_array().unwrap() {
        let q = if is_mujoco { coordinates(m, &case["q"]) } else { by_name(m, &case["q"]) };
        let state = m.state(&q).map_err(|e| e.to_string())?;
        for (name, pose) in case["poses"].as_object().unwrap() {
            let pose = numbers(pose);
            let frame = m.frame(name).map_err(|e| e.to_string())?;
            let own = state.pose(frame).unwrap();
            let expected = Pose {
                translation: Vec3::new(pose[0], pose[1], pose[2]),
                rotation: rotation(&pose[3..]),
            };
            let distance = (own.translation - expected.translation).norm();
            let angle = own.rotation.angle_to(expected.rotation);
            if distance > POSE * (1.0 + expected.translation.norm()) || angle > POSE {
                return Err(format!("pose of {name}: {distance:.1e} m, {angle:.1e} rad apart"));
            }
        }
    }
    if !is_mujoco {
        return Ok(());
    }
    masses(m, of)?;
    mass_matrix(m, of)?;
    for (name, range) in of["limits"].as_object().unwrap() {
        let Some(joint) = m.joints().iter().find(|j| j.name == *name) else {
            return Err(format!("no joint {name}"));
        };
        let range = numbers(range);
        let limits = joint.limits;
        let apart = (limits.lower - range[0]).abs().max((limits.upper - range[1]).abs());
        if joint.kind != JointKind::Spherical && apart > 1e-9 {
            return Err(format!("limits of {name}: {limits:?}"));
        }
    }
    let loops = of["loops"].as_u64().unwrap() as usize;
    if m.loops().len() < loops {
        return Err(format!("{} loops instead of {loops}", m.loops().len()));
    }
    Ok(())
}

#[test]
#[ignore = "needs the files that `cargo xtask corpus` fetches"]
fn corpus_agrees_with_its_programs() {
    let folder = folder();
    let vectors = std::fs::read_to_string(folder.join("vectors.json")).unwrap();
    let vectors: BTreeMap<String, Value> = serde_json::from_str(&vectors).unwrap();
    let exceptions: BTreeMap<&str, &str> = EXCEPTIONS
        .lines()
        .filter(|l| !l.trim().is_empty() && !l.starts_with('#'))
        .map(|l| l.split_once(": ").expect("FILE: REASON"))
        .collect();
    let (mut loaded, mut agree, mut faults) = (0, 0, Vec::new());
    let candidates: Vec<_> = vectors.iter().filter(|v| v.1.get("refused").is_none()).collect();
    for (file, of) in &candidates {
        let result = match cylindroid::load_file(&folder.join("files").join(file)) {
            Ok(m) => {
                loaded += 1;
                compare(&m, of)
            }
            Err(error) => Err(format!("refused: {error}")),
        };
        agree += usize::from(result.is_ok());
        match (result, exceptions.get(file.as_str())) {
            (Ok(()), None) | (Err(_), Some(_)) => {}
            (Ok(()), Some(_)) => faults.push(format!("{file}: agrees, and is an exception")),
            (Err(message), None) => faults.push(format!("{file}: {message}")),
        }
    }
    println!("{} files, {loaded} loaded, {agree} agree", candidates.len());
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
}
