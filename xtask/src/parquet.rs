//! A sweep's folder in the programs that its users have: pandas, polars, DuckDB, pyarrow.

use std::fs;
use std::process::Command;

use anyhow::Result;

use crate::python::{environment, pip};
use crate::shell::{cargo, root, run};

const REQUIREMENTS: &str = "xtask/parquet/requirements.txt";
const SCRIPT: &str = "xtask/parquet/readers.py";

/// Writes a folder with the command line and reads it with each of them.
pub(crate) fn check() -> Result<()> {
    let python = environment(&root().join("target/parquet-venv"))?;
    pip(&python, &["-r", REQUIREMENTS])?;
    let folder = root().join("target/parquet-sweep");
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    let sweep = ["run", "--quiet", "-p", "cylindroid-cli", "--", "sweep", "youbot"];
    let options = ["--samples", "1e5", "--quantities", "pose,jacobian,yoshikawa,gibson_hunt"];
    run(cargo(&[&sweep[..], &options, &["--out"]].concat()).arg(&folder))?;
    run(Command::new(python).arg(SCRIPT).arg(&folder))
}
