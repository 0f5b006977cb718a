//! Many tasks at once beside other libraries, and robots simulated by MuJoCo: installs them in a
//! folder of its own, from PyPI, and runs the programs of `benches/control`.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, Result};

use crate::python::{environment, pip, wheel};
use crate::shell::{captured, root, run};

const SOURCES: &str = "benches/control";
/// Libraries and the robots of example-robot-data; maturin builds the wheel.
const REQUIREMENTS: &str = "benches/control/requirements.txt";
/// Packages of which the robot files alone are used.
const FILES: [&str; 2] = ["gymnasium-robotics==1.4.2", "robosuite==1.5.2"];
const UNPACK: &str = "
import pathlib, sys, zipfile
source, target = map(pathlib.Path, sys.argv[1:])
for wheel in sorted(source.glob('*.whl')):
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(target, [n for n in archive.namelist() if '/assets/' in n])
";

/// The folder, its Python and the folder with the robots of example-robot-data.
struct Installed {
    folder: PathBuf,
    python: PathBuf,
    robots: PathBuf,
}

/// `cargo xtask bench-control`: many tasks beside mink, pink and PlaCo.
pub(crate) fn compare(arguments: &[String]) -> Result<()> {
    start("compare.py", "control-benchmarks.md", arguments)
}

/// `cargo xtask plants`: robots simulated by MuJoCo.
pub(crate) fn plants(arguments: &[String]) -> Result<()> {
    start("plants.py", "plants.md", arguments)
}

fn start(program: &str, page: &str, arguments: &[String]) -> Result<()> {
    let Installed { folder, python, robots } = install()?;
    let quick = arguments.iter().any(|a| a == "--quick");
    let out = if quick { folder.join("quick") } else { root().join("docs") };
    let files = folder.join("files");
    let commit = captured(Command::new("git").args(["rev-parse", "--short", "HEAD"]))?;
    run(Command::new(python)
        .arg(root().join(SOURCES).join(program))
        .arg(folder.join("models"))
        .arg("--robots")
        .arg(robots)
        .arg("--hand")
        .arg(files.join("gymnasium_robotics/envs/assets/hand"))
        .arg("--arms")
        .arg(files.join("robosuite/models/assets/robots"))
        .arg("--out")
        .arg(&out)
        .args(["--commit", &commit])
        .args(arguments)
        // MuJoCo writes its log into the current folder.
        .current_dir(&folder))?;
    println!("{}", out.join(page).display());
    Ok(())
}

fn install() -> Result<Installed> {
    let folder = root().join("target/bench-control");
    fs::create_dir_all(&folder)?;
    let python = environment(&folder.join("venv"))?;
    let stamp = folder.join("stamp");
    let needed = fs::read_to_string(root().join(REQUIREMENTS)).context(REQUIREMENTS)?;
    if !fs::read_to_string(&stamp).is_ok_and(|got| got == needed) {
        println!("fetching libraries and robot files (500 MB, once)");
        pip(&python, &["-r", REQUIREMENTS]).context("pip needs a way to PyPI")?;
        let wheels = folder.join("wheels");
        let mut download = Command::new(&python);
        download
            .args(["-m", "pip", "download", "--quiet", "--disable-pip-version-check", "--no-deps"])
            .arg("--dest")
            .arg(&wheels)
            .args(FILES);
        run(&mut download)?;
        run(Command::new(&python).args(["-c", UNPACK]).arg(&wheels).arg(folder.join("files")))?;
        fs::remove_dir_all(&wheels)?;
        fs::write(&stamp, needed)?;
    }
    let wheel = wheel(&python)?;
    pip(&python, &["--force-reinstall", "--no-deps", &wheel.to_string_lossy()])?;
    let packages = captured(
        Command::new(&python)
            .args(["-c", "import sysconfig; print(sysconfig.get_path('purelib'))"]),
    )?;
    let robots = PathBuf::from(packages).join("cmeel.prefix/share/example-robot-data/robots");
    Ok(Installed { folder, python, robots })
}
