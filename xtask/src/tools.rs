//! Programs of crates.io that tasks run, installed once in `target/tools`.

use std::path::PathBuf;
use std::process::{Command, Stdio};

use anyhow::{Context, Result};

use crate::shell::{cargo, root, run};

/// A program of this name and version, installed with these options of `cargo install`.
///
/// # Errors
/// It cannot be installed, which needs crates.io once.
pub(crate) fn tool(name: &str, version: &str, options: &[&str]) -> Result<PathBuf> {
    let tools = root().join("target/tools");
    let program = tools.join("bin").join(format!("{name}{}", std::env::consts::EXE_SUFFIX));
    // Subcommands of cargo expect their own name.
    let words = [name.strip_prefix("cargo-").unwrap_or(name), "--version"];
    let asked = Command::new(&program).args(words).stderr(Stdio::null()).output();
    let is_version = |text: &str| text.split_whitespace().any(|word| word == version);
    let is_there = asked.is_ok_and(|v| is_version(&String::from_utf8_lossy(&v.stdout)));
    if !is_there {
        println!("installing {name} {version} in target/tools (some minutes, once)");
        let mut install = cargo(&["install", "--quiet", "--locked", "--debug", "--force"]);
        install.args(options).args(["--version", version, "--root"]).arg(&tools).arg(name);
        run(&mut install)
            .with_context(|| format!("{name} cannot be installed, which needs crates.io once"))?;
    }
    Ok(program)
}
