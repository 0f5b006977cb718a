//! Licences, duplicates, sources and advisories of dependencies, by cargo-deny and `deny.toml`;
//! licences of npm and Python packages by `licences.py`.

use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::python;
use crate::shell::{captured, cargo, run};
use crate::tools::tool;

const VERSION: &str = "0.20.2";

/// The packages of the viewer and of the book.
const LOCK_FILES: [&str; 2] = ["viewer/package-lock.json", "xtask/book/package-lock.json"];

/// Checks the dependencies of all crates, the lock file of the fuzzing targets, and the licences of
/// npm and Python packages.
///
/// # Errors
/// A licence that is not allowed, a duplicate without a reason, a source that is not crates.io; no
/// way to crates.io or PyPI for the first installation.
pub(crate) fn check() -> Result<()> {
    with(&["bans", "licenses", "sources"])?;
    // The fuzzing targets are a workspace of their own: without this nothing would read their lock file.
    let locked = ["metadata", "--locked", "--format-version", "1", "--manifest-path"];
    captured(cargo(&locked).arg("fuzz/Cargo.toml"))
        .context("fuzz/Cargo.lock is out of date: `cargo metadata` in that folder renews it")?;
    run(Command::new(python::for_tests()?).arg("xtask/licences.py").args(LOCK_FILES))
}

/// `--advisories` alone.
pub(crate) fn task(argument: Option<&str>) -> Result<()> {
    match argument {
        None => check(),
        Some("--advisories") => with(&["advisories"]),
        Some(other) => bail!("deny has no option '{other}', only --advisories"),
    }
}

fn with(checks: &[&str]) -> Result<()> {
    let program = tool("cargo-deny", VERSION, &["--no-default-features"])?;
    run(Command::new(program).args(["--workspace", "--locked", "check"]).args(checks))
}
