//! Licences, duplicates, sources and advisories of dependencies, by cargo-deny and `deny.toml`;
//! licences of npm and Python packages by `licences.py`.

use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};

use crate::python;
use crate::shell::{cargo, root, run};

const VERSION: &str = "0.20.2";

/// The packages of the viewer and of the book.
const LOCK_FILES: [&str; 2] = ["viewer/package-lock.json", "xtask/book/package-lock.json"];

/// Checks the dependencies of all crates, and the licences of npm and Python packages.
///
/// # Errors
/// A licence that is not allowed, a duplicate without a reason, a source that is not crates.io; no
/// way to crates.io or PyPI for the first installation.
pub(crate) fn check() -> Result<()> {
    with(&["bans", "licenses", "sources"])?;
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
    let tools = root().join("target/tools");
    let program = tools.join("bin").join(format!("cargo-deny{}", std::env::consts::EXE_SUFFIX));
    let version = Command::new(&program).arg("--version").stderr(Stdio::null()).output();
    let is_there = version.is_ok_and(|v| String::from_utf8_lossy(&v.stdout).contains(VERSION));
    if !is_there {
        println!("installing cargo-deny {VERSION} in target/tools (some minutes, once)");
        let mut install = cargo(&["install", "--quiet", "--locked", "--debug", "--force"]);
        install.args(["--no-default-features", "--version", VERSION, "--root"]).arg(&tools);
        run(install.arg("cargo-deny")).context("cargo-deny needs a way to crates.io")?;
    }
    run(Command::new(program).args(["--workspace", "--locked", "check"]).args(checks))
}
