//! The model loaders: what is read, what is noted, what is refused and where.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests stop where tests do

mod ablation;
mod broken;
mod carried_robots;
mod catalogue;
mod closed_file;
mod closing_limits;
mod closures;
mod contact_curvature;
mod corpus;
mod dh;
mod elasticity;
mod fk;
mod joint_limits;
mod large_models;
mod lax;
mod limits;
mod load;
mod magnitudes;
mod mechanism_file;
mod mesh_masses;
mod mjcf;
mod mjcf_copies;
mod mjcf_strict;
mod mujoco;
mod mutated_files;
mod mutation;
mod mutations;
mod order;
mod parameters;
mod real_chains;
mod sdf;
mod srdf;
mod tool;
mod urdf;
mod use_of_files;

use std::path::{Path, PathBuf};

use cylindroid::closure::{ClosedChain, MotionSpace};
use cylindroid::model::formats;
use cylindroid::{Error, FileError, Matrix, Mechanism, Result};

const ARM_URDF: &str = include_str!("../data/arm.urdf");
const ARM_TOML: &str = include_str!("../data/arm.toml");

fn read_urdf(text: &str) -> Result<Mechanism> {
    formats::urdf::parse(text, Path::new("robots/test.urdf"))
}

fn read_toml(text: &str) -> Result<Mechanism> {
    cylindroid::load_text(text, Path::new("robots/test.toml"))
}

/// The robots of example-robot-data, fetched by `cargo xtask setup`.
fn robots() -> PathBuf {
    let fetched = "../../target/test-data/models/cmeel.prefix/share/example-robot-data/robots";
    let folder = std::env::var_os("CYLINDROID_TEST_ROBOTS")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join(fetched), PathBuf::from);
    assert!(folder.is_dir(), "no robot files in {}: run `cargo xtask setup`", folder.display());
    folder
}

/// The file error of a refused text; its span must be the place it prints.
#[track_caller]
fn refused(text: &str, result: Result<Mechanism>) -> FileError {
    match result {
        Err(Error::File(error)) => {
            let before = &text[..error.span.start];
            assert_eq!(error.line, before.matches('\n').count() + 1, "{error}");
            let column = before.rsplit('\n').next().unwrap().chars().count() + 1;
            assert_eq!(error.column, column, "{error}");
            *error
        }
        other => panic!("expected an error with a place, got {other:?}"),
    }
}

/// The text that an error points at.
fn pointed_at<'t>(text: &'t str, error: &FileError) -> &'t str {
    &text[error.span.clone()]
}

/// The rates of these coordinates in all motions that a constraint leaves, a column each.
fn motions_of(chain: &ClosedChain, names: &[&str]) -> Matrix {
    let basis = MotionSpace::of(&chain.constraint).basis();
    let all: Vec<&String> = chain.actuated.iter().chain(&chain.passive).collect();
    let row = |name: &&str| all.iter().position(|n| n == name).unwrap();
    let rows: Vec<usize> = names.iter().map(row).collect();
    Matrix::from_fn(rows.len(), basis.cols(), |i, j| basis[(rows[i], j)])
}

/// The report, one line for each entry.
fn report(m: &Mechanism) -> String {
    let line = |i: &cylindroid::model::Ignored| format!("{}: {}: {}\n", i.line, i.what, i.why);
    m.report().ignored.iter().map(line).collect()
}
