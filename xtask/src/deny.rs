//! Licences, duplicates, sources and advisories of dependencies, by cargo-deny and `deny.toml`;
//! licences of npm and Python packages by `licences.py`, their advisories by npm and pip-audit.

use std::fs;
use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::python;
use crate::shell::{captured, cargo, root, run};
use crate::tools::tool;

const VERSION: &str = "0.20.2";
const PIP_AUDIT: &str = "pip-audit==2.10.1";

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

/// The check, or `--advisories` alone.
pub(crate) fn task(argument: Option<&str>) -> Result<()> {
    match argument {
        None => check(),
        Some("--advisories") => advisories(),
        Some(other) => bail!("deny has no option '{other}', only --advisories"),
    }
}

/// Known vulnerabilities of crates, npm packages and the Python packages of the tests; all are asked,
/// whichever fail.
fn advisories() -> Result<()> {
    let npm = |lock: &str| {
        let folder = root().join(lock);
        let mut audit = Command::new("npm");
        audit.args(["audit", "--package-lock-only", "--prefix"]).arg(folder.with_file_name(""));
        run(&mut audit)
    };
    let answers = [
        ("crates", with(&["advisories"])),
        ("npm packages of the viewer", npm(LOCK_FILES[0])),
        ("npm packages of the book", npm(LOCK_FILES[1])),
        ("Python packages", audit_python()),
    ];
    let failed: Vec<String> = answers
        .into_iter()
        .filter_map(|(what, answer)| Some(format!("{what}: {:#}", answer.err()?)))
        .collect();
    if !failed.is_empty() {
        bail!("vulnerabilities, or lists of them that cannot be read:\n  {}", failed.join("\n  "));
    }
    Ok(())
}

/// Those that the tests install, with all that they depend on.
fn audit_python() -> Result<()> {
    let own = python::environment(&root().join("target/tools/pip-audit"))?;
    python::pip(&own, &[PIP_AUDIT]).context("pip needs a way to PyPI")?;
    let freeze = ["-m", "pip", "freeze", "--exclude", "cylindroid"];
    let packages = captured(Command::new(python::for_tests()?).args(freeze))?;
    let list = root().join("target/tools/python-packages.txt");
    fs::write(&list, packages)?;
    // Strict: a package that is not found there was not looked at.
    let audit = ["-m", "pip_audit", "--strict", "--no-deps", "--disable-pip", "-r"];
    run(Command::new(own).args(audit).arg(list))
}

fn with(checks: &[&str]) -> Result<()> {
    let program = tool("cargo-deny", VERSION, &["--no-default-features"])?;
    run(Command::new(program).args(["--workspace", "--locked", "check"]).args(checks))
}
