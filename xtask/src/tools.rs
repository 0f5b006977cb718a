//! Programs of crates.io that tasks run, installed once in `target/tools`.

use std::path::{Path, PathBuf};
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
    if !is_installed(&program, name, version) {
        println!("installing {name} {version} in target/tools (some minutes, once)");
        let mut install = cargo(&["install", "--quiet", "--locked", "--debug", "--force"]);
        install.args(options).args(["--version", version, "--root"]).arg(&tools).arg(name);
        run(&mut install)
            .with_context(|| format!("{name} cannot be installed, which needs crates.io once"))?;
    }
    Ok(program)
}

/// True if the program answers with this version.
fn is_installed(program: &Path, name: &str, version: &str) -> bool {
    // Subcommands of cargo expect their own name.
    let words = [name.strip_prefix("cargo-").unwrap_or(name), "--version"];
    let asked = Command::new(program).args(words).stderr(Stdio::null()).output();
    let has_version = |text: &str| text.split_whitespace().any(|word| word == version);
    asked.is_ok_and(|answer| has_version(&String::from_utf8_lossy(&answer.stdout)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The compiler is there in its own version, in no part of it and no longer one.
    #[test]
    fn a_program_is_installed_once_for_each_version() {
        let rustc = PathBuf::from(std::env::var("RUSTC").unwrap_or_else(|_| "rustc".into()));
        let answer = Command::new(&rustc).arg("--version").output().unwrap();
        let text = String::from_utf8(answer.stdout).unwrap();
        let version = text.split_whitespace().nth(1).unwrap();
        let is_there = |version: &str| is_installed(&rustc, "rustc", version);
        assert!(is_there(version));
        assert!(!is_there(&version[..version.len() - 1]) && !is_there(&format!("{version}0")));
        assert!(!is_installed(Path::new("no such program"), "rustc", version));
    }
}
