//! Programs of crates.io that tasks run, installed once in `target/tools`.

use std::path::PathBuf;
use std::process::{Command, Stdio};

use anyhow::{Context, Result};

use crate::shell::{cargo, root, run};

/// A program of this name and version, installed with these options of `cargo install`.
///
/// # Errors
/// No way to crates.io for the first installation.
pub(crate) fn tool(name: &str, version: &str, options: &[&str]) -> Result<PathBuf> {
    let tools = root().join("target/tools");
    let program = tools.join("bin").join(format!("{name}{}", std::env::consts::EXE_SUFFIX));
    // Subcommands of cargo expect their own name.
    let words = [name.trim_start_matches("cargo-"), "--version"];
    let asked = Command::new(&program).args(words).stderr(Stdio::null()).output();
    let is_there = asked.is_ok_and(|v| String::from_utf8_lossy(&v.stdout).contains(version));
    if !is_there {
        println!("installing {name} {version} in target/tools (some minutes, once)");
        let mut install = cargo(&["install", "--quiet", "--locked", "--debug", "--force"]);
        install.args(options).args(["--version", version, "--root"]).arg(&tools).arg(name);
        run(&mut install).with_context(|| format!("{name} needs a way to crates.io"))?;
    }
    Ok(program)
}
