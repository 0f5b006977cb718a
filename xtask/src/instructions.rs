//! Instructions of the kernels, counted by callgrind: a check of speed that does not depend on the
//! mood of the machine.
//!
//! Valgrind runs the AVX2 paths where the processor has them, never AVX-512. A count is exact for
//! one compiler and one set of dependencies; the tolerance is for others.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::shell::{captured, cargo, root, run};

const FILE: &str = "crates/cylindroid/benches/instructions.toml";
/// A kernel may grow by this share before it is an error.
const TOLERANCE: f64 = 0.03;
/// Calls before those that are counted: memory and caches of tables settle.
const WARM: usize = 3;
const CALLS: usize = 10;

/// Compares with the file, or writes it.
pub(crate) fn check(write: bool) -> Result<()> {
    valgrind()?;
    let program = build()?;
    let names = captured(&mut Command::new(&program))?;
    let known = read()?;
    let mut text = String::from(
        "# Instructions of one call of each kernel of instructions.rs, counted by callgrind with \
         AVX2.\n# `cargo xtask instructions` compares, `cargo xtask instructions --write` writes \
         this file.\n\n[instructions]\n",
    );
    let mut grown = Vec::new();
    for name in names.lines() {
        let few = count(&program, name, WARM)?;
        let many = count(&program, name, WARM + CALLS)?;
        let now = (many - few) / CALLS as u64;
        writeln!(text, "{name} = {now}")?;
        match known.get(name) {
            None => println!("{name:24} {now:>10}  new"),
            Some(&before) => {
                let change = now as f64 / before as f64 - 1.0;
                println!("{name:24} {now:>10}  {:+.1} %", 100.0 * change);
                if change > TOLERANCE {
                    grown.push(format!("{name}: {before} -> {now} ({:+.1} %)", 100.0 * change));
                }
            }
        }
    }
    if write {
        return fs::write(root().join(FILE), text).context(FILE);
    }
    if !grown.is_empty() {
        bail!(
            "kernels take more instructions than {FILE} says: {}; if that is wanted, run \
             `cargo xtask instructions --write` and say why in the commit",
            grown.join(", ")
        );
    }
    Ok(())
}

/// Valgrind, from Debian's packages where it is missing.
fn valgrind() -> Result<()> {
    let is_there = || Command::new("valgrind").arg("--version").output().is_ok();
    if !is_there() {
        let install = ["install", "--yes", "--no-install-recommends", "valgrind"];
        run(Command::new("apt-get").args(install)).context("valgrind is missing: install it")?;
    }
    Ok(())
}

/// The program, built as benchmarks are.
fn build() -> Result<PathBuf> {
    let arguments = ["--package", "cylindroid", "--bench", "instructions", "--no-run"];
    let messages = ["--message-format", "json-render-diagnostics"];
    let text = captured(cargo(&["bench", "--quiet"]).args(arguments).args(messages))?;
    // The last artefact is the program: `"executable":"..."`.
    let path = text.rsplit("\"executable\":\"").next().and_then(|t| t.split('"').next());
    path.filter(|p| p.contains("instructions")).map(PathBuf::from).context("cargo built no program")
}

/// Instructions of the whole program.
fn count(program: &PathBuf, kernel: &str, calls: usize) -> Result<u64> {
    let mut command = Command::new("valgrind");
    command.args(["--tool=callgrind", "--callgrind-out-file=/dev/null"]).arg(program);
    let output = command.args([kernel, &calls.to_string()]).output()?;
    let log = String::from_utf8_lossy(&output.stderr);
    if !output.status.success() {
        bail!("{kernel}: {}", log.trim());
    }
    let total = log.lines().find_map(|l| l.split("Collected : ").nth(1));
    let total = total.with_context(|| format!("valgrind gave no count for {kernel}"))?;
    Ok(total.trim().parse()?)
}

/// Counts of the file; none where it is not there.
fn read() -> Result<BTreeMap<String, u64>> {
    let text = fs::read_to_string(root().join(FILE)).unwrap_or_default();
    let pairs = text.lines().filter_map(|l| l.split_once(" = "));
    pairs
        .map(|(name, count)| {
            let count = count.parse().with_context(|| format!("{FILE}: {name} = {count}"))?;
            Ok((name.to_owned(), count))
        })
        .collect()
}
