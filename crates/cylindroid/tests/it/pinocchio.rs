//! Forward kinematics, Jacobians and their derivatives against Pinocchio, on real robot files.
//!
//! The vectors were written by `xtask/vectors/pinocchio_vectors.py` (`cargo xtask vectors`); the
//! URDFs come from the PyPI package example-robot-data, fetched by `cargo xtask setup`.

use std::path::{Path, PathBuf};

use cylindroid::{Matrix, Mechanism, ReferenceFrame};
use serde_json::Value;

use crate::support::{assert_close, assert_matrix};

fn robots_folder() -> PathBuf {
    let folder = std::env::var_os("CYLINDROID_TEST_ROBOTS").map_or_else(
        || {
            Path::new(env!("CARGO_MANIFEST_DIR"))
                .join("../../target/test-data/models/cmeel.prefix/share/example-robot-data/robots")
        },
        PathBuf::from,
    );
    assert!(
        folder.is_dir(),
        "no robot files in {}: run `cargo xtask setup` once",
        folder.display()
    );
    folder
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

/// A 6 x n matrix whose columns are put from the order of the file into ours.
fn matrix(value: &Value, places: &[usize]) -> Matrix {
    let rows: Vec<Vec<f64>> = value.as_array().unwrap().iter().map(numbers).collect();
    let mut m = Matrix::zeros(6, places.len());
    for (k, &place) in places.iter().enumerate() {
        for i in 0..6 {
            m[(i, place)] = rows[i][k];
        }
    }
    m
}

fn permuted(values: &[f64], places: &[usize]) -> Vec<f64> {
    let mut out = vec![0.0; values.len()];
    for (k, &place) in places.iter().enumerate() {
        out[place] = values[k];
    }
    out
}

#[test]
fn every_robot_agrees_with_pinocchio() {
    let vectors = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/vectors/pinocchio");
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(vectors).unwrap().map(|e| e.unwrap().path()).collect();
    files.sort();
    assert!(files.len() >= 18, "{} robots", files.len());
    for file in files {
        let data: Value = serde_json::from_str(&std::fs::read_to_string(&file).unwrap()).unwrap();
        let urdf = robots_folder().join(data["urdf"].as_str().unwrap());
        let robot =
            cylindroid::load_file(&urdf).unwrap_or_else(|e| panic!("{}: {e}", urdf.display()));
        check(&robot, &data);
    }
}

fn check(robot: &Mechanism, data: &Value) {
    let name = data["robot"].as_str().unwrap();
    let joints: Vec<&str> =
        data["joints"].as_array().unwrap().iter().map(|j| j.as_str().unwrap()).collect();
    assert_eq!(joints.len(), robot.n(), "{name}: coordinates");
    let places: Vec<usize> = joints
        .iter()
        .map(|j| {
            let found = robot.coordinates().iter().position(|c| c.name == *j);
            found.unwrap_or_else(|| panic!("{name}: no coordinate {j}"))
        })
        .collect();
    let mut mass_matrices = 0;
    // Relative to the robot's size; rotations count 1.
    let tolerance = 1e-12 * data["reach"].as_f64().unwrap().max(1.0);
    for configuration in data["configurations"].as_array().unwrap() {
        let label = format!("{name}, {}", configuration["label"].as_str().unwrap());
        let q = permuted(&numbers(&configuration["q"]), &places);
        let rates = permuted(&numbers(&configuration["qd"]), &places);
        let state = robot.state(&q).unwrap();
        if let Some(lower) = configuration.get("mass_matrix") {
            let (lower, got) = (numbers(lower), state.mass_matrix());
            let (n, mut rest) = (places.len(), lower.iter());
            let mut expected = Matrix::zeros(n, n);
            for i in 0..n {
                for j in 0..=i {
                    let entry = *rest.next().unwrap();
                    expected[(places[i], places[j])] = entry;
                    expected[(places[j], places[i])] = entry;
                }
            }
            let what = format!("{label}, mass matrix");
            assert_matrix(&what, &got, &expected, 1e-12 * expected.max_abs().max(1.0));
            mass_matrices += 1;
        }
        for (frame, pose) in configuration["poses"].as_object().unwrap() {
            let got = state.pose(robot.frame(frame).unwrap()).unwrap().to_matrix();
            let what = format!("{label}, {frame}");
            assert_close(&what, &got.as_flattened()[..12], &numbers(pose), tolerance);
        }
        for entry in configuration["jacobians"].as_array().unwrap() {
            let frame = entry["frame"].as_str().unwrap();
            let of = robot.frame(frame).unwrap();
            for (key, reference) in ReferenceFrame::NAMES {
                let what = format!("{label}, {frame}, {key}");
                let expected = matrix(&entry[key], &places);
                assert_matrix(&what, &state.jacobian(of, reference).unwrap(), &expected, tolerance);
                if let Some(dot) = entry.get(format!("dot_{key}")) {
                    let got = state.jacobian_dot(&rates, of, reference).unwrap();
                    let size = rates.iter().map(|r| r.abs()).sum::<f64>().max(1.0);
                    assert_matrix(&what, &got, &matrix(dot, &places), tolerance * size);
                }
            }
        }
    }
    assert_eq!(mass_matrices, 1, "{name}");
}

/// Every URDF of the package loads, but for two files that are no robots; what was ignored is said.
#[test]
fn every_robot_file_loads() {
    let mut files = Vec::new();
    collect(&robots_folder(), &mut files);
    files.sort();
    assert!(files.len() > 60, "{} files", files.len());
    let mut refused = Vec::new();
    for file in &files {
        match cylindroid::load_file(file) {
            Ok(robot) => assert!(robot.state(robot.home()).is_ok()),
            Err(e) => refused.push((file.file_name().unwrap().to_string_lossy().into_owned(), e)),
        }
    }
    let names: Vec<&str> = refused.iter().map(|(n, _)| n.as_str()).collect();
    assert_eq!(names, ["alex_psyonic_hands.urdf", "ur3.urdf"], "{refused:?}");
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            collect(&path, files);
        } else if path.extension().is_some_and(|e| e == "urdf") {
            files.push(path);
        }
    }
}
