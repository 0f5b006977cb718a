//! The Python package: its wheel built, installed and tested in environments of their own.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::shell::{root, run};
use crate::{models, viewer};

const REQUIREMENTS: &str = "crates/cylindroid-py/requirements-test.txt";
const TESTS: &str = "crates/cylindroid-py/tests";
const BENCH: &str = "crates/cylindroid-py/benches/overhead.py";

/// The Python of a virtual environment.
fn python(venv: &Path) -> PathBuf {
    if cfg!(windows) { venv.join("Scripts/python.exe") } else { venv.join("bin/python") }
}

/// A virtual environment.
pub(crate) fn environment(venv: &Path) -> Result<PathBuf> {
    let python = python(venv);
    if !python.exists() {
        run(Command::new("python3").args(["-m", "venv"]).arg(venv))
            .context("the Python package needs Python 3.11 or later with venv and pip")?;
    }
    Ok(python)
}

pub(crate) fn pip(python: &Path, arguments: &[&str]) -> Result<()> {
    let quiet = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
    run(Command::new(python).args(quiet).args(arguments))
}

/// An environment with these requirements, installed once.
fn with_requirements(venv: &Path) -> Result<PathBuf> {
    let python = environment(venv)?;
    let wanted = fs::read_to_string(root().join(REQUIREMENTS)).context(REQUIREMENTS)?;
    let stamp = venv.join("requirements.txt");
    if fs::read_to_string(&stamp).is_ok_and(|got| got == wanted) {
        return Ok(python);
    }
    println!("fetching what the tests of the Python package need (2.2 GB installed, once)");
    pip(&python, &["-r", REQUIREMENTS]).context("pip needs a way to PyPI")?;
    fs::write(stamp, wanted)?;
    Ok(python)
}

/// Builds the wheel as `pip install .` would, and returns it.
pub(crate) fn wheel(python: &Path) -> Result<PathBuf> {
    let folder = root().join("target/python-wheels");
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    let build = ["-m", "maturin", "build", "--release", "--quiet", "--out"];
    run(Command::new(python).args(build).arg(&folder))?;
    only_file(&folder)
}

/// The source distribution, as it would be uploaded.
pub(crate) fn source_distribution() -> Result<PathBuf> {
    let folder = root().join("target/python-sdist");
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    let python = with_maturin()?;
    run(Command::new(python).args(["-m", "maturin", "sdist", "--out"]).arg(&folder))?;
    only_file(&folder)
}

/// A Python that has maturin.
pub(crate) fn with_maturin() -> Result<PathBuf> {
    let python = environment(&root().join("target/maturin-venv"))?;
    let wanted = fs::read_to_string(root().join(REQUIREMENTS)).context(REQUIREMENTS)?;
    let maturin = wanted.lines().find(|line| line.starts_with("maturin"));
    pip(&python, &[maturin.with_context(|| format!("{REQUIREMENTS} lacks maturin"))?])?;
    Ok(python)
}

/// The one file of a folder.
fn only_file(folder: &Path) -> Result<PathBuf> {
    let mut files = fs::read_dir(folder)?.filter_map(|e| Some(e.ok()?.path()));
    match (files.next(), files.next()) {
        (Some(file), None) => Ok(file),
        _ => bail!("{} should hold one file", folder.display()),
    }
}

/// A Python that has what the tests of the package need.
pub(crate) fn for_tests() -> Result<PathBuf> {
    with_requirements(&root().join("target/python-venv"))
}

/// A Python that has the package and what its tests need, and the wheel, which carries the page of
/// the viewer.
fn installed() -> Result<(PathBuf, PathBuf)> {
    viewer::build()?;
    let python = for_tests()?;
    let wheel = wheel(&python)?;
    pip(&python, &["--force-reinstall", "--no-deps", &wheel.to_string_lossy()])?;
    Ok((python, wheel))
}

/// What calls from Python cost.
pub(crate) fn bench() -> Result<()> {
    let (python, _) = installed()?;
    run(Command::new(python).arg(BENCH))
}

/// Draws the figures of the book that the command line does not draw.
pub(crate) fn figures() -> Result<()> {
    let (python, _) = installed()?;
    let script = ["xtask/book/figures.py", "docs/figures", "docs/grasp.toml"];
    run(Command::new(python).args(script))
}

/// Writes what the Python of the book prints into its pages, and the notebooks of the tutorials.
pub(crate) fn write_outputs() -> Result<()> {
    let (python, _) = installed()?;
    let pytest = ["-m", "pytest", "-q", "-p", "no:cacheprovider"];
    let writers = ["book", "tutorials"].map(|name| format!("{TESTS}/test_{name}.py"));
    run(Command::new(python).args(pytest).args(writers).env("CYLINDROID_WRITE_BOOK", "1"))
}

/// Calls with random arguments for so many seconds, from this seed on.
pub(crate) fn fuzz(seconds: f64, seed: u64) -> Result<()> {
    let (python, _) = installed()?;
    let pytest = ["-m", "pytest", "-q", "-p", "no:cacheprovider"];
    run(Command::new(python)
        .args(pytest)
        .arg(format!("{TESTS}/test_fuzz.py"))
        .env("CYLINDROID_FUZZ_SECONDS", seconds.to_string())
        .env("CYLINDROID_FUZZ_SEED", seed.to_string()))
}

/// Builds, installs and tests the package: pytest, the stubs, the tutorials' examples, pages that
/// follow a program; then the wheel in an environment that has nothing but numpy.
pub(crate) fn test() -> Result<()> {
    let (python, wheel) = installed()?;
    let robots = models::fetch()?;
    let pytest = ["-m", "pytest", "-q", "-p", "no:cacheprovider", TESTS];
    run(Command::new(&python).args(pytest).env("CYLINDROID_TEST_ROBOTS", robots))?;
    run(Command::new(&python).args(["-m", "mypy.stubtest", "--concise", "cylindroid"]))?;
    viewer::follow(&python)?;
    use_alone(&wheel)
}

/// Installs a wheel or a source distribution where nothing else is, and uses it.
pub(crate) fn use_alone(package: &Path) -> Result<()> {
    let bare = root().join("target/python-bare-venv");
    if bare.exists() {
        fs::remove_dir_all(&bare)?;
    }
    let python = environment(&bare)?;
    pip(&python, &[&package.to_string_lossy()])?;
    run(Command::new(&python).args([format!("{TESTS}/bare.py")]))
}
