//! The comparison with other libraries: installs them in a folder of its own, from PyPI, crates.io
//! and Debian's packages, then `benches/peers/compare.py` runs all and writes `docs/benchmarks.*`.
//!
//! A peer that cannot be installed is a row with the reason, never a failure of the whole.

use std::fmt::Write as _;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::SystemTime;

use anyhow::{Context, Result, bail};

use crate::models;
use crate::python::{environment, pip};
use crate::shell::{captured, cargo, root, run};

const SOURCES: &str = "benches/peers";
/// Every version is pinned: a comparison can be repeated.
const PINOCCHIO: &[&str] = &["pin==4.1.0"];
const EIGEN: &str = "cmeel-eigen==3.4.1";
const CPPAD: &[&str] = &["cmeel-cppad==20250000.2", "cmeel-cppadcodegen==2.4.3"];
const KDL: [&str; 2] = ["liborocos-kdl-dev", "liborocos-kdl1.5"];
/// What Pinocchio's own build defines, without its compiled parts: all is instantiated here, for
/// this processor.
const PINOCCHIO_FLAGS: [&str; 6] = [
    "-w",
    "-DNDEBUG",
    "-DBOOST_MPL_LIMIT_LIST_SIZE=30",
    "-DBOOST_MPL_LIMIT_VECTOR_SIZE=30",
    "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS",
    "-DBOOST_FUSION_INVOKE_MAX_ARITY=12",
];
const NATIVE: [&str; 2] = ["-O3", "-march=native"];
/// The robots whose code is generated: `ARMS` of robots.py.
const GENERATED: [&str; 4] = ["panda", "ur5", "iiwa14", "g1_arm"];

/// Where the peers live.
struct Peers {
    folder: PathBuf,
    python: PathBuf,
    /// Python packages of the environment.
    packages: PathBuf,
}

/// A peer that was installed: its version and how its program is started.
struct Installed {
    version: String,
    command: Vec<PathBuf>,
}

/// Installs, compares, writes; `arguments` are those of `compare.py` (`--quick`, `--only`).
pub(crate) fn compare(arguments: &[String]) -> Result<()> {
    let robots = models::fetch()?;
    let folder = root().join("target/bench-peers");
    fs::create_dir_all(folder.join("build"))?;
    let python = environment(&folder.join("venv"))?;
    pip(&python, &["numpy", "rtb-data==2.0.0", EIGEN])?;
    let packages = captured(
        Command::new(&python)
            .args(["-c", "import sysconfig; print(sysconfig.get_path('purelib'))"]),
    )?;
    let peers = Peers { folder, python, packages: packages.into() };

    let mut lines = String::new();
    let ours = peers.rust("cylindroid", "", env!("CARGO_PKG_VERSION").to_owned())?;
    peers.add(&mut lines, "cylindroid", "cylindroid", Ok(ours))?;
    peers.add(&mut lines, "pinocchio", "Pinocchio, C++", peers.pinocchio())?;
    peers.add(&mut lines, "generated", "Pinocchio, generated C", peers.generated(&robots))?;
    peers.add(&mut lines, "mujoco", "MuJoCo, C", peers.mujoco())?;
    peers.add(&mut lines, "kdl", "KDL, C++", peers.kdl())?;
    for name in ["k", "dynibo"] {
        let built = locked(name).and_then(|v| peers.rust(name, "-C target-cpu=native", v));
        peers.add(&mut lines, name, &format!("{name}, Rust"), built)?;
    }
    for (name, label, package, version) in [
        ("optik", "OptIK, from Python", "optik-py", "0.5.0"),
        ("rtb", "Robotics Toolbox, from Python", "roboticstoolbox-python", "1.5.0"),
        ("tracik", "TRAC-IK, from Python", "pytracik", "0.0.3"),
        ("eaik", "EAIK, from Python", "EAIK", "1.2.2"),
    ] {
        peers.add(&mut lines, name, label, peers.through_python(name, package, version))?;
    }
    fs::write(peers.folder.join("installed.tsv"), lines)?;

    let quick = arguments.iter().any(|a| a == "--quick");
    let out = if quick { peers.folder.join("quick") } else { root().join("docs") };
    fs::create_dir_all(&out)?;
    run(Command::new(&peers.python)
        .arg(format!("{SOURCES}/compare.py"))
        .arg(&peers.folder)
        .arg("--robots")
        .arg(robots)
        .arg("--rtb")
        .arg(peers.packages.join("rtbdata"))
        .arg("--out")
        .arg(&out)
        .args(["--commit", &commit()?, "--compilers", &compilers()?])
        .args(arguments))?;
    println!("{}", out.join("benchmarks.md").display());
    Ok(())
}

impl Peers {
    /// A line of `installed.tsv`: name, label, version, why not, command.
    fn add(
        &self,
        lines: &mut String,
        name: &str,
        label: &str,
        installed: Result<Installed>,
    ) -> Result<()> {
        let (version, reason, command) = match installed {
            Ok(peer) => (peer.version, String::new(), peer.command),
            Err(error) => {
                let reason = format!("{error:#}").replace(['\n', '\t'], " ");
                println!("{label} is not installed: {reason}");
                (String::new(), reason, Vec::new())
            }
        };
        write!(lines, "{name}\t{label}\t{version}\t{reason}")?;
        for word in command {
            write!(lines, "\t{}", word.display())?;
        }
        writeln!(lines)?;
        Ok(())
    }

    fn built(&self, name: &str) -> PathBuf {
        self.folder.join("build").join(name)
    }

    fn prefix(&self) -> PathBuf {
        self.packages.join("cmeel.prefix")
    }

    /// Compiles `output` unless it is newer than what it is made of; messages go to a log.
    fn compile(&self, name: &str, sources: &[&str], flags: &[String]) -> Result<PathBuf> {
        let output = self.built(name);
        let sources: Vec<PathBuf> = sources.iter().map(|s| root().join(SOURCES).join(s)).collect();
        let made = modified(&output);
        if made.is_some() && sources.iter().all(|s| modified(s) < made) {
            return Ok(output);
        }
        println!("compiling {name}");
        let mut command = Command::new(compiler());
        command.arg("-std=c++17").arg(&sources[0]).args(flags).arg("-o").arg(&output);
        self.quietly(name, &mut command)?;
        Ok(output)
    }

    /// Runs a command with its output in a log; the first line about an error is the reason.
    fn quietly(&self, name: &str, command: &mut Command) -> Result<()> {
        let path = self.built(&format!("{name}.log"));
        let log = File::create(&path)?;
        let status = command
            .current_dir(root())
            .stdout(log.try_clone()?)
            .stderr(log)
            .status()
            .with_context(|| format!("{} is missing", command.get_program().to_string_lossy()))?;
        if !status.success() {
            let text = fs::read_to_string(&path).unwrap_or_default();
            let line = text.lines().find(|l| l.contains("error")).unwrap_or("see the log");
            let line: String = line.chars().take(200).collect();
            bail!("{line}");
        }
        Ok(())
    }

    fn pip(&self, name: &str, requirements: &[&str]) -> Result<()> {
        let quiet = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
        self.quietly(name, Command::new(&self.python).args(quiet).args(requirements))
    }

    fn eigen(&self) -> String {
        format!("-I{}", self.prefix().join("include/eigen3").display())
    }

    fn pinocchio_flags(&self) -> Vec<String> {
        let include = format!("-I{}", self.prefix().join("include").display());
        let mut flags: Vec<String> = PINOCCHIO_FLAGS.map(str::to_owned).to_vec();
        flags.extend([include, self.eigen()]);
        flags
    }

    fn pinocchio(&self) -> Result<Installed> {
        self.pip("pinocchio", PINOCCHIO)?;
        let flags = [NATIVE.map(str::to_owned).to_vec(), self.pinocchio_flags()].concat();
        let sources = ["pinocchio.cpp", "pinocchio_model.hpp", "common.hpp"];
        let program = self.compile("pinocchio", &sources, &flags)?;
        Ok(Installed { version: version(PINOCCHIO[0]), command: vec![program] })
    }

    /// C code for each robot by `generate.cpp`, compiled into one program.
    fn generated(&self, robots: &Path) -> Result<Installed> {
        self.pip("generate", &[PINOCCHIO, CPPAD].concat())?;
        let library = self.prefix().join("lib");
        let mut flags = self.pinocchio_flags();
        flags.extend(["-O1".to_owned(), format!("-L{}", library.display())]);
        flags.extend(["-lcppad_lib".to_owned(), format!("-Wl,-rpath,{}", library.display())]);
        let sources = ["generate.cpp", "pinocchio_model.hpp", "common.hpp"];
        let generator = self.compile("generate", &sources, &flags)?;

        let data = self.folder.join("data");
        let mut write = Command::new(&self.python);
        write.arg(format!("{SOURCES}/robots.py")).args([robots, &self.packages.join("rtbdata")]);
        self.quietly("robots", write.arg(&data))?;
        let mut flags = NATIVE.map(str::to_owned).to_vec();
        for robot in GENERATED {
            let (code, object) =
                (self.built(&format!("{robot}.c")), self.built(&format!("{robot}.o")));
            let text = captured(Command::new(&generator).arg(&data).arg(robot))?;
            fs::write(&code, text)?;
            let mut compile = Command::new(compiler());
            compile.args(["-x", "c"]).args(NATIVE).arg("-c").arg(&code).arg("-o").arg(&object);
            self.quietly(robot, &mut compile)?;
            flags.push(object.display().to_string());
        }
        let program = self.compile("generated", &["generated.cpp", "common.hpp"], &flags)?;
        let with = format!("{}, CppADCodeGen {}", version(PINOCCHIO[0]), version(CPPAD[1]));
        Ok(Installed { version: with, command: vec![program] })
    }

    fn mujoco(&self) -> Result<Installed> {
        let package = "mujoco==4.0.0";
        self.pip("mujoco", &[package])?;
        let folder = self.packages.join("mujoco");
        let library = fs::read_dir(&folder)?
            .filter_map(|e| Some(e.ok()?.path()))
            .find(|p| p.file_name().is_some_and(|n| n.to_string_lossy().starts_with("libmujoco.")))
            .context("the wheel holds no libmujoco")?;
        let mut flags = NATIVE.map(str::to_owned).to_vec();
        flags.push(format!("-I{}", folder.join("include").display()));
        flags.push(library.display().to_string());
        flags.push(format!("-Wl,-rpath,{}", folder.display()));
        let program = self.compile("mujoco", &["mujoco.cpp", "common.hpp"], &flags)?;
        Ok(Installed { version: version(package), command: vec![program] })
    }

    /// Debian's packages, unpacked in the folder; without `-march=native`, with which Eigen would
    /// not fit what Debian compiled.
    fn kdl(&self) -> Result<Installed> {
        let debian = self.folder.join("debian");
        if !debian.join("usr/include/kdl").is_dir() {
            fs::create_dir_all(&debian)?;
            self.quietly(
                "kdl",
                Command::new("sh").arg("-c").arg(format!(
                    "cd '{}' && apt-get download {} && for d in *.deb; do dpkg-deb -x $d .; done",
                    debian.display(),
                    KDL.join(" ")
                )),
            )
            .context("Debian's packages are needed")?;
        }
        let library = captured(
            Command::new("sh")
                .arg("-c")
                .arg(format!("dirname $(find '{}' -name 'liborocos-kdl.so')", debian.display())),
        )?;
        let mut flags = ["-O3", "-DNDEBUG", "-w"].map(str::to_owned).to_vec();
        flags.extend([format!("-I{}/usr/include", debian.display()), self.eigen()]);
        flags.extend([format!("-L{library}"), "-lorocos-kdl".to_owned()]);
        flags.push(format!("-Wl,-rpath,{library}"));
        let program = self.compile("kdl", &["kdl.cpp", "common.hpp"], &flags)?;
        let name = captured(
            Command::new("sh")
                .arg("-c")
                .arg(format!("ls '{}' | grep kdl-dev | cut -d_ -f2", debian.display())),
        )?;
        Ok(Installed { version: format!("{name} (Debian)"), command: vec![program] })
    }

    /// A program of the Cargo project; peers are compiled for this processor.
    fn rust(&self, name: &str, flags: &str, version: String) -> Result<Installed> {
        println!("compiling {name}");
        let target = self.folder.join(if flags.is_empty() { "rust" } else { "rust-native" });
        let manifest = format!("{SOURCES}/rust/Cargo.toml");
        let mut build = cargo(&["build", "--release", "--locked", "--features", name]);
        build.args(["--manifest-path", &manifest, "--bin", name, "--target-dir"]).arg(&target);
        self.quietly(name, build.env("RUSTFLAGS", flags))?;
        Ok(Installed { version, command: vec![target.join("release").join(name)] })
    }

    fn through_python(&self, name: &str, package: &str, version: &str) -> Result<Installed> {
        self.pip(name, &[&format!("{package}=={version}")])?;
        let script = root().join(SOURCES).join("peers.py");
        let command = vec![self.python.clone(), script, name.into()];
        Ok(Installed { version: version.to_owned(), command })
    }
}

fn compiler() -> String {
    std::env::var("CXX").unwrap_or_else(|_| "g++".to_owned())
}

fn modified(path: &Path) -> Option<SystemTime> {
    path.metadata().ok()?.modified().ok()
}

/// The version in `package==version`.
fn version(requirement: &str) -> String {
    requirement.rsplit("==").next().unwrap_or_default().to_owned()
}

/// The version of a crate in the lock file of the Cargo project.
fn locked(name: &str) -> Result<String> {
    let text = fs::read_to_string(root().join(SOURCES).join("rust/Cargo.lock"))?;
    let after = text.split(&format!("name = \"{name}\"\nversion = \"")).nth(1);
    let version = after.and_then(|t| t.split('"').next());
    version.map(str::to_owned).with_context(|| format!("{name} is not in the lock file"))
}

fn commit() -> Result<String> {
    let hash = captured(Command::new("git").args(["rev-parse", "--short", "HEAD"]))?;
    let changes = captured(Command::new("git").args(["status", "--porcelain", "--", "crates"]))?;
    Ok(if changes.is_empty() { hash } else { format!("{hash} with changes") })
}

fn compilers() -> Result<String> {
    let cpp = captured(Command::new(compiler()).arg("--version"))?;
    let rust = captured(Command::new("rustc").arg("--version"))?;
    let rust: Vec<&str> = rust.split(' ').take(2).collect();
    Ok(format!("{}, {}", cpp.lines().next().unwrap_or_default(), rust.join(" ")))
}
