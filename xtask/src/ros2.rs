//! The ROS 2 node in a loop over DDS, with Cyclone DDS and a simulated robot on the other side, in a
//! network namespace that has only the loopback interface.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result};

use crate::python;
use crate::shell::{cargo, root, run};

const SCRIPT: &str = "crates/cylindroid-ros2/tests/dds.py";

/// `cargo xtask ros2 [SECONDS]`.
pub(crate) fn task(seconds: Option<&str>) -> Result<()> {
    match seconds {
        Some(seconds) => {
            let _: f64 = seconds.parse().context("seconds")?;
            run(&mut cargo(&["build", "--release", "--package", "cylindroid-ros2"]))?;
            script(&binary("release"), Some(seconds))
        }
        None => {
            // Of the workspace, as the tests build it.
            let build = ["test", "--quiet", "--workspace", "--test", "controller", "--no-run"];
            run(&mut cargo(&build))?;
            test()
        }
    }
}

/// The loop with the binary of the tests: ten seconds.
pub(crate) fn test() -> Result<()> {
    if !cfg!(target_os = "linux") {
        println!("skipped: network namespaces are of Linux");
        return Ok(());
    }
    script(&binary("debug"), None)
}

fn binary(profile: &str) -> PathBuf {
    root()
        .join("target")
        .join(profile)
        .join(format!("cylindroid-ros2{}", std::env::consts::EXE_SUFFIX))
}

fn script(binary: &Path, seconds: Option<&str>) -> Result<()> {
    let python = python::for_tests()?;
    let mut loopback = Command::new("unshare");
    loopback.args(["--map-root-user", "--net"]).arg(python).arg(SCRIPT).arg(binary).args(seconds);
    run(&mut loopback).context("the loop over DDS needs Linux with unshare (util-linux)")
}
