//! The steps of the tasks: each a command that a person could type.

use std::path::Path;
use std::process::Command;
use std::time::Instant;

use anyhow::{Context, Result};

use crate::shell::{cargo, documentation, root, run};
use crate::{book, deny, layers, models, python, python_names, ros2, small_sizes, viewer};

fn step(name: &str, work: impl FnOnce() -> Result<()>) -> Result<()> {
    println!("== {name}");
    let start = Instant::now();
    work().with_context(|| format!("step '{name}'"))?;
    println!("== {name}: {:.0} s", start.elapsed().as_secs_f64());
    Ok(())
}

/// Formatting, layers, names in Python, calls of small sizes, lints.
pub(crate) fn quick() -> Result<()> {
    step("format", || run(&mut cargo(&["fmt", "--all", "--check"])))?;
    step("layers", layers::check)?;
    step("names in Python", python_names::check)?;
    step("calls of small sizes", small_sizes::check)?;
    step("library without features", || {
        let library = ["clippy", "--quiet", "--package", "cylindroid", "--no-default-features"];
        run(cargo(&library).args(["--", "-D", "warnings"]))
    })?;
    step("lints", || {
        run(&mut cargo(&[
            "clippy",
            "--quiet",
            "--workspace",
            "--all-targets",
            "--",
            "-D",
            "warnings",
        ]))
    })
}

/// Everything: this is the whole CI.
pub(crate) fn test() -> Result<()> {
    let robots = models::fetch()?;
    // Before anything is compiled: the command line embeds the page.
    step("viewer page", viewer::build)?;
    quick()?;
    step("dependencies", deny::check)?;
    step("documentation", documentation)?;
    step("book", book::build)?;
    step("tests", || {
        run(cargo(&["test", "--quiet", "--workspace"]).env("CYLINDROID_TEST_ROBOTS", &robots))
    })?;
    step("forms of the kernels", || in_all_forms(&robots, &OF_KERNELS))?;
    step("ROS 2 over DDS", ros2::test)?;
    step("viewer in a browser", viewer::test)?;
    step("Python package", python::test)
}

/// Tests of laws that every form of the kernels must keep, by the beginning of their names.
const OF_ALL_FORMS: [&str; 16] = [
    "analytic::",
    "batch::",
    "closure::",
    "graph::",
    "ik::",
    "ik_goals::",
    "inverse::",
    "inverse_batch::",
    "kinematics::",
    "manipulability::",
    "mass_matrix::",
    "pinocchio::",
    "screws::",
    "servo::",
    "svd::",
    "symmetric_eigen::",
];

/// Those of them that call the kernels of many configurations directly: seconds.
const OF_KERNELS: [&str; 7] = [
    "batch::",
    "inverse_batch::",
    "kinematics::",
    "manipulability::batch::",
    "pinocchio::",
    "svd::",
    "symmetric_eigen::",
];

/// All chosen tests with each form of the kernels.
pub(crate) fn simd(robots: &Path) -> Result<()> {
    in_all_forms(robots, &OF_ALL_FORMS)
}

/// These tests with each form of the kernels but the best that the processor has, with which all
/// tests run: without registers, and with those of AVX2.
fn in_all_forms(robots: &Path, chosen: &[&str]) -> Result<()> {
    let mut forms = vec!["scalar"];
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx512f") {
        forms.push("avx2");
    }
    for form in forms {
        println!("CYLINDROID_SIMD={form}");
        // Of the workspace: of one package cargo would build the dependencies with other features.
        let tests = ["test", "--quiet", "--workspace", "--test", "it", "--"];
        run(cargo(&[&tests[..], chosen].concat())
            .env("CYLINDROID_TEST_ROBOTS", robots)
            .env("CYLINDROID_SIMD", form))?;
    }
    Ok(())
}

/// Writes the records of results (`tests/recorded`), and cuts them where results differ without
/// registers.
pub(crate) fn record() -> Result<()> {
    for (form, purpose) in [("", "write"), ("scalar", "shorten")] {
        let tests = ["test", "--quiet", "--workspace", "--test", "recorded"];
        run(cargo(&tests).env("CYLINDROID_SIMD", form).env("CYLINDROID_RECORD", purpose))?;
    }
    Ok(())
}

/// Systems and processors that the code is checked for besides Linux on x86-64.
const PLATFORMS: [&str; 3] =
    ["x86_64-pc-windows-gnu", "aarch64-apple-darwin", "aarch64-unknown-linux-gnu"];

/// Checks the types of the library and the programs for other systems and processors.
pub(crate) fn platforms() -> Result<()> {
    for target in PLATFORMS {
        run(Command::new("rustup").args(["target", "add", target]))
            .context("the standard library of another system comes from rustup")?;
        step(target, || {
            let check = ["check", "--quiet", "--workspace", "--exclude", "xtask", "--target"];
            run(cargo(&check).arg(target))
        })?;
    }
    Ok(())
}

/// The models whose vectors MuJoCo makes.
const MUJOCO_ROBOTS: [&str; 12] = [
    "baxter", "gr1", "iiwa", "jaco", "kinova3", "panda", "sawyer", "spot", "spot_arm", "tiago",
    "ur5e", "xarm7",
];
const MUJOCO_GRIPPERS: [&str; 7] = [
    "inspire_left_hand",
    "jaco_three_finger_gripper",
    "panda_gripper",
    "robotiq_gripper_140",
    "robotiq_gripper_85",
    "robotiq_gripper_s",
    "xarm7_gripper",
];

/// The reference vectors, by the script that made them, in an environment of its own.
pub(crate) fn vectors() -> Result<()> {
    let venv = root().join("target/vectors-venv");
    let python = venv.join("bin/python");
    if !python.exists() {
        run(Command::new("python3").args(["-m", "venv"]).arg(&venv))?;
    }
    run(Command::new(&python).args([
        "-m",
        "pip",
        "install",
        "--quiet",
        "-r",
        "xtask/vectors/requirements.txt",
    ]))?;
    for (script, folder) in [
        ("pinocchio", "pinocchio"),
        ("closed_chain", "closed_chains"),
        ("grasp", "grasps"),
        ("pitch_form", "pitch_forms"),
        ("collision", "collision"),
        ("mesh_mass", "mesh_masses"),
        ("sweep", "sweep"),
    ] {
        let script = format!("xtask/vectors/{script}_vectors.py");
        let folder = format!("crates/cylindroid/tests/vectors/{folder}");
        run(Command::new(&python).args([&script, "--out", &folder]))?;
    }
    models::fetch()?;
    let assets = "target/test-data/models/robosuite/models/assets";
    let mut files = ["zoo", "loops", "tendons", "copies", "attached"]
        .map(|name| format!("crates/cylindroid/tests/data/{name}.xml"))
        .to_vec();
    for robot in MUJOCO_ROBOTS {
        files.push(format!("{assets}/robots/{robot}/robot.xml"));
    }
    for gripper in MUJOCO_GRIPPERS {
        files.push(format!("{assets}/grippers/{gripper}.xml"));
    }
    let mut mujoco = Command::new(&python);
    mujoco.args(["xtask/vectors/mujoco_vectors.py", "--out"]);
    run(mujoco.arg("crates/cylindroid/tests/vectors/mujoco").args(files))
}

/// The kernels, the servo step by step, and calls from Python, on this machine.
pub(crate) fn bench() -> Result<()> {
    for bench in ["kernels", "collision", "jitter"] {
        run(&mut cargo(&["bench", "--package", "cylindroid", "--bench", bench]))?;
    }
    python::bench()
}

/// The viewer's server under load; what it prints is a measurement, not a check.
pub(crate) fn viewer_load(seconds: Option<&str>) -> Result<()> {
    let filter = ["test", "--release", "--package", "cylindroid-cli", "--test", "cli"];
    let show = ["--", "--ignored", "--exact", "--nocapture", "view::load::load"];
    let arguments = [&filter[..], &show].concat();
    run(cargo(&arguments).env("CYLINDROID_LOAD", seconds.unwrap_or("60")))
}

/// A step of the servo from C++ beside one from Rust; a measurement, not a check.
pub(crate) fn c_step() -> Result<()> {
    let filter = ["test", "--release", "--package", "cylindroid-c", "--test", "programs"];
    let show =
        ["--", "--ignored", "--exact", "--nocapture", "a_step_from_cpp_beside_one_from_rust"];
    run(&mut cargo(&[&filter[..], &show].concat()))
}

/// Millions of servo steps on random robots; fails if one leaves a limit.
pub(crate) fn limits(millions: Option<&str>, first: Option<&str>) -> Result<()> {
    let millions: f64 = millions.map_or(Ok(10.0), str::parse).context("millions of steps")?;
    let filter = ["test", "--release", "--package", "cylindroid", "--test", "limits"];
    let show = ["--", "--ignored", "--exact", "--nocapture", "no_limit_is_left"];
    let mut test = cargo(&[&filter[..], &show].concat());
    test.env("CYLINDROID_LIMIT_STEPS", format!("{:.0}", millions * 1e6));
    run(test.env("CYLINDROID_LIMIT_SEED", first.unwrap_or("0")))
}

/// The manual pages, by the command line itself.
pub(crate) fn man(folder: Option<&str>) -> Result<()> {
    let folder = folder.context("name a folder: cargo xtask man DIR")?;
    run(&mut cargo(&["run", "--quiet", "--package", "cylindroid-cli", "--", "man", folder]))
}

/// The figures of the README and the book, by the command line and the Python package.
pub(crate) fn figures() -> Result<()> {
    let [to, rpy] = ["0.45,0.15,0.35", "3.1416,0,0.6"];
    for command in [
        &["move", "panda", "--to", to, "--rpy", rpy, "--plot", "docs/move-panda.svg"][..],
        &["screws", "youbot", "--frame", "arm_link_2", "--plot", "docs/screws-youbot.svg"],
        &[
            "screws",
            "docs/three-lines.csv",
            "--length",
            "0.5",
            "--plot",
            "docs/conics-three-lines.svg",
        ],
        &[
            "manipulability",
            "five-bar",
            "--actuated",
            "q2,q4",
            "--velocity-limits",
            "1,1",
            "--torque-limits",
            "1,1",
            "--plot",
            "docs/ellipses-five-bar.svg",
        ],
        &[
            "map",
            "docs/five-bar.toml",
            "--over",
            "x=-1:3.5:120",
            "--over",
            "y=-2.6:2.6:120",
            "--plot",
            "docs/map-five-bar.svg",
        ],
        &[
            "sweep",
            "ur5e",
            "--reach",
            "x=-1:1:31",
            "--reach",
            "y=0:0.6:3",
            "--reach",
            "z=-0.8:1.2:31",
            "--rolls",
            "8",
            "--plot",
            "docs/reach-ur5e.svg",
        ],
        &[
            "sweep",
            "panda",
            "--samples",
            "1000",
            "--quantities",
            "pose,yoshikawa",
            "--plot",
            "docs/cloud-panda.svg",
        ],
    ] {
        let run_it = ["run", "--release", "--quiet", "--package", "cylindroid-cli", "--"];
        run(&mut cargo(&[&run_it, command].concat()))?;
    }
    python::figures()
}
