//! The binary as users meet it: exit codes, messages, JSON, files.

#![allow(clippy::unwrap_used)]

mod bad_input;
mod book;
mod capability;
mod closed;
mod distance;
mod documents;
mod flags;
mod fuzz;
mod ik;
mod inverses;
mod manual;
mod map;
mod measured;
mod motion;
mod motion_limits;
mod optimise;
mod other_programs;
mod output_files;
mod parameters;
mod pictures;
mod scales;
mod screws;
mod shape;
mod srdf;
mod statics;
mod sweep;
mod tasks;
mod view;
mod waypoints;
mod xacro;
mod zone;

use std::process::{Command, Output};

/// Runs the binary.
fn cylindroid(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_cylindroid")).args(arguments).output().unwrap()
}

/// Runs it with `--json` and expects this exit code.
fn json(arguments: &[&str], code: i32) -> serde_json::Value {
    let output = cylindroid(&[arguments, &["--json"]].concat());
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {stderr}");
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Runs it, expects success, returns what it printed.
fn text(arguments: &[&str]) -> String {
    let output = cylindroid(arguments);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}");
    String::from_utf8(output.stdout).unwrap()
}

/// Runs it, expects an error, one message and nothing else, and returns it.
fn refused(arguments: &[&str]) -> String {
    let output = cylindroid(arguments);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {stderr}");
    assert!(output.stdout.is_empty(), "{arguments:?}");
    assert!(!stderr.contains("panicked"), "{stderr}");
    stderr
}

/// Largest difference of two lists (the JSON reader of the tests is off by one rounding).
fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()))
}

/// The numbers of a JSON array.
fn numbers(value: &serde_json::Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}
