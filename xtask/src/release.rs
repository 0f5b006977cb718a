//! A release, up to the upload: the crates and the source distribution of the Python package, with
//! the page of the viewer inside, are made, listed with their sizes, and built from their files, with
//! the wheel and the library for C and C++ of this platform; the public interface is compared with that
//! of a commit.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use anyhow::{Context, Result, bail, ensure};

use crate::shell::{captured, cargo, copy_folder, root, run};
use crate::tools::tool;
use crate::{c_install, python, viewer};

const VERSION: &str = env!("CARGO_PKG_VERSION");
/// The page inside the crate of the command line.
const PAGE: &str = "crates/cylindroid-cli/page";
const SEMVER_CHECKS: &str = "0.51.0";
/// Larger crates are refused by crates.io (bytes).
const LARGEST_CRATE: u64 = 10_000_000;
/// The library first.
const CRATES: [&str; 3] = ["cylindroid", "cylindroid-cli", "cylindroid-ros2"];
/// What a program that depends on the library does.
const USE: &str = r#"fn main() -> Result<(), cylindroid::Error> {
    let panda = cylindroid::load("panda")?;
    let state = panda.state(panda.home())?;
    assert!(state.pose(panda.tool())?.translation.x > 0.1);
    Ok(())
}
"#;

/// A folder that goes when it is dropped.
struct Passing(PathBuf);

impl Drop for Passing {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// A process that ends when it is dropped.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// `cargo xtask release [--build] [--since COMMIT]`.
pub(crate) fn task(arguments: &[String]) -> Result<()> {
    let (mut is_built, mut since) = (false, None);
    let mut words = arguments.iter().map(String::as_str);
    while let Some(word) = words.next() {
        match word {
            "--build" => is_built = true,
            "--since" => {
                let commit = words.next().filter(|word| !word.starts_with('-'));
                since = Some(commit.context("--since needs a commit")?);
            }
            other => bail!("release has the options --build and --since COMMIT, not '{other}'"),
        }
    }
    if let Some(commit) = since {
        compare(commit)?;
    }
    let changed = captured(Command::new("git").args(["status", "--porcelain"]))?;
    let (crates, distribution) = packages()?;
    println!("what would be uploaded, version {VERSION}:");
    let mut files: Vec<&PathBuf> = crates.iter().chain([&distribution]).collect();
    list(&files)?;
    for file in &crates {
        let is_small = fs::metadata(file)?.len() < LARGEST_CRATE;
        ensure!(is_small, "{}: crates.io refuses crates of more than 10 MB", file.display());
    }
    if !changed.is_empty() {
        println!("\nnot in the last commit, and yet in the packages:\n{changed}");
    }
    if is_built {
        let built = build(&crates, &distribution)?;
        println!("\nwhat would be uploaded, version {VERSION}:");
        files.extend(&built);
        list(&files)?;
    }
    Ok(())
}

/// Prints files with their sizes.
fn list(files: &[&PathBuf]) -> Result<()> {
    for file in files {
        let size = fs::metadata(file)?.len();
        println!("{:>8.2} MB  {}", size as f64 / 1e6, file.display());
    }
    Ok(())
}

/// Fails if the public interface of the library changed since a commit by more than the version
/// allows; the other crates are programs.
fn compare(commit: &str) -> Result<()> {
    let program = tool("cargo-semver-checks", SEMVER_CHECKS, &[])?;
    let check = ["semver-checks", "--package", CRATES[0], "--baseline-rev", commit];
    run(Command::new(program).args(check))
}

/// The crates for crates.io and the source distribution for PyPI.
fn packages() -> Result<(Vec<PathBuf>, PathBuf)> {
    viewer::build()?;
    let page = Passing(root().join(PAGE));
    copy_folder(&root().join("viewer/dist"), &page.0)?;
    let packages = CRATES.iter().flat_map(|name| ["--package", name]);
    // The page is in no commit.
    run(cargo(&["package", "--quiet", "--no-verify", "--allow-dirty"]).args(packages))?;
    let file = |name: &str| root().join("target/package").join(format!("{name}-{VERSION}.crate"));
    Ok((CRATES.map(file).to_vec(), python::source_distribution()?))
}

/// Builds each package from its file alone, in a folder outside the workspace, and does its main
/// job. Gives what is for this platform: the library for C and C++, and the wheel.
fn build(crates: &[PathBuf], distribution: &Path) -> Result<[PathBuf; 2]> {
    let folder = Passing(std::env::temp_dir().join(format!("cylindroid-{}", std::process::id())));
    let _ = fs::remove_dir_all(&folder.0);
    fs::create_dir_all(&folder.0)?;
    for file in crates {
        let tar = ["--extract", "--gzip", "--directory"];
        run(Command::new("tar").args(tar).arg(&folder.0).arg("--file").arg(file))?;
    }
    let unpacked = |name: &str| folder.0.join(format!("{name}-{VERSION}"));
    // A crate of this version is not on crates.io yet.
    let library = format!("patch.crates-io.cylindroid.path={:?}", unpacked("cylindroid"));
    let target = folder.0.join("target");

    println!("\na program that depends on {}", crates[0].display());
    let program = folder.0.join("program");
    fs::create_dir_all(program.join("src"))?;
    let manifest = format!(
        "[package]\nname = \"program\"\nedition = \"2024\"\n\n[dependencies]\ncylindroid = \
         \"{VERSION}\"\n"
    );
    fs::write(program.join("Cargo.toml"), manifest)?;
    fs::write(program.join("src/main.rs"), USE)?;
    let arguments = ["run", "--release", "--quiet", "--config", &library, "--manifest-path"];
    run(cargo(&arguments).arg(program.join("Cargo.toml")).env("CARGO_TARGET_DIR", &target))?;

    let installed = folder.0.join("installed");
    for (name, file) in CRATES.iter().zip(crates).skip(1) {
        println!("\nthe programs of {}", file.display());
        let arguments = ["install", "--quiet", "--config", &library, "--path"];
        run(cargo(&arguments)
            .arg(unpacked(name))
            .arg("--root")
            .arg(&installed)
            .env("CARGO_TARGET_DIR", &target))?;
    }
    let program = |name: &str| installed.join("bin").join(name);
    run(Command::new(program("cylindroid")).args(["mobility", "stewart"]))?;
    serves_its_page(&program("cylindroid"))?;
    run(Command::new(program("cylindroid-ros2")).arg("--version"))?;

    println!("\nthe library for C and C++");
    let name = format!("cylindroid-c-{VERSION}");
    let prefix = folder.0.join(&name);
    c_install::install(&prefix)?;
    c_install::use_installed(&prefix, &folder.0)?;
    let (arch, os) = (std::env::consts::ARCH, std::env::consts::OS);
    let archive = root().join(format!("target/package/{name}-{arch}-{os}.tar.gz"));
    let tar = ["--create", "--gzip", "--file"];
    run(Command::new("tar").args(tar).arg(&archive).arg("--directory").arg(&folder.0).arg(&name))?;

    println!("\nthe Python package of {}", distribution.display());
    python::use_alone(distribution)?;
    Ok([archive, python::wheel(&python::with_maturin()?)?])
}

/// The page comes from the binary: there is no workspace beside it.
fn serves_its_page(program: &Path) -> Result<()> {
    let arguments = ["view", "panda", "--port", "0"];
    let mut server = Running(
        Command::new(program)
            .args(arguments)
            .stdout(Stdio::piped())
            .spawn()
            .with_context(|| program.display().to_string())?,
    );
    let output = server.0.stdout.take().context("the server prints its address")?;
    for line in BufReader::new(output).lines() {
        let line = line?;
        let Some((_, address)) = line.split_once("http://") else { continue };
        let address = address.trim_end_matches('/');
        let mut stream = TcpStream::connect(address).with_context(|| address.to_owned())?;
        write!(stream, "GET / HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\n\r\n")?;
        let mut page = String::new();
        stream.read_to_string(&mut page)?;
        ensure!(page.contains("<div id=\"app\""), "{address} serves no page:\n{page}");
        println!("serves the page of the viewer, {} bytes", page.len());
        return Ok(());
    }
    bail!("`cylindroid view` prints no address")
}
