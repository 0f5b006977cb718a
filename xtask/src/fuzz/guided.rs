//! Coverage-guided fuzzing: builds the crate `fuzz` with the instrumentation that stable Rust has,
//! and runs one target after another.
//!
//! Why so   the flags of cargo-fuzz without a sanitizer: `-Cpasses=sancov-module` is no option of
//!          nightly alone. Processor time and memory are bounded in the targets and by libFuzzer

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

use anyhow::{Context, Result, bail};

use super::dictionary;
use super::seeds::{self, TARGETS, Target};
use crate::models;
use crate::shell::{captured, cargo, root, run};

/// Counters of edges, a table of their places, and compared values.
const FLAGS: &str = "-Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 \
                     -Cllvm-args=-sanitizer-coverage-inline-8bit-counters \
                     -Cllvm-args=-sanitizer-coverage-pc-table \
                     -Cllvm-args=-sanitizer-coverage-trace-compares --cfg fuzzing";

/// Findings of a target, after which its turn is over.
const MOST_FINDINGS: usize = 5;

/// All targets, or the named ones, for equal shares of the time.
///
/// # Errors
/// A target that does not exist; inputs that made one fail, whose files are named.
pub(super) fn task(minutes: f64, seed: u64, only: &[String]) -> Result<()> {
    if let Some(unknown) = only.iter().find(|name| TARGETS.iter().all(|t| t.name != **name)) {
        let names: Vec<&str> = TARGETS.iter().map(|t| t.name).collect();
        bail!("no target '{unknown}': {}", names.join(", "));
    }
    let chosen: Vec<&Target> =
        TARGETS.iter().filter(|t| only.is_empty() || only.iter().any(|o| o == t.name)).collect();
    let robots = models::fetch()?;
    let program = build()?;
    let share = 60.0 * minutes / chosen.len() as f64;
    let mut findings = Vec::new();
    for target in chosen {
        let folder = root().join("target/fuzz").join(target.name);
        fs::create_dir_all(folder.join("corpus"))?;
        fs::create_dir_all(folder.join("findings"))?;
        seeds::write(target, &robots, &folder.join("seeds"))?;
        dictionary::write(&root(), target.words, &folder.join("words.dict"))?;
        findings.extend(feed(target, &program, &folder, share, seed)?);
    }
    if !findings.is_empty() {
        bail!("inputs that failed:\n  {}", findings.join("\n  "));
    }
    Ok(())
}

/// The instrumented program.
fn build() -> Result<PathBuf> {
    let version = captured(Command::new("rustc").arg("-vV"))?;
    let host = version.lines().find_map(|line| line.strip_prefix("host: ")).context("rustc -vV")?;
    let folder = root().join("target/fuzz-build");
    // Build scripts, which are not instrumented, are told apart by a named target.
    run(cargo(&["build", "--release", "--manifest-path", "fuzz/Cargo.toml", "--target", host])
        .env("CARGO_TARGET_DIR", &folder)
        .env("RUSTFLAGS", FLAGS))?;
    Ok(folder.join(host).join("release/fuzz"))
}

/// Runs a target for so many seconds and prints a line; the inputs that failed.
fn feed(
    target: &Target,
    program: &Path,
    folder: &Path,
    seconds: f64,
    seed: u64,
) -> Result<Vec<String>> {
    let place = |name: &str| folder.join(name);
    let temporary = place("temporary");
    fs::create_dir_all(&temporary)?;
    let start = Instant::now();
    let (mut inputs, mut coverage, mut of) = (0, 0, 0);
    let mut found = Vec::new();
    for round in 0..MOST_FINDINGS as u64 {
        let left = (seconds - start.elapsed().as_secs_f64()).max(1.0);
        let log = place("log.txt");
        let output = fs::File::create(&log)?;
        let status = Command::new(program)
            .current_dir(root())
            .env("CYLINDROID_FUZZ_TARGET", target.name)
            .env("TMPDIR", &temporary)
            .arg(format!("-seed={}", (seed % 1_000_000) * 100 + round + 1))
            .arg(format!("-max_total_time={left:.0}"))
            .arg(format!("-max_len={}", target.longest))
            .arg(format!("-dict={}", place("words.dict").display()))
            .arg(format!("-artifact_prefix={}/", place("findings").display()))
            .args([
                "-rss_limit_mb=1500",
                "-malloc_limit_mb=500",
                "-timeout=1200",
                "-len_control=100",
                // The targets bound the processor time; time on the clock depends on the machine.
                "-report_slow_units=3600",
            ])
            .arg("-print_final_stats=1")
            .args([place("corpus"), place("seeds")])
            .stdout(Stdio::null())
            .stderr(output)
            .status()
            .with_context(|| program.display().to_string())?;
        let log = fs::read_to_string(log)?;
        inputs += number_after(&log, "stat::number_of_executed_units:").unwrap_or(0);
        coverage = coverage.max(number_after(&log, " cov: ").unwrap_or(0));
        of = number_after(&log, "Loaded 1 modules   (").unwrap_or(of);
        if status.success() {
            break;
        }
        found.push(failure(target.name, &log));
        if start.elapsed().as_secs_f64() > seconds {
            break;
        }
    }
    fs::remove_dir_all(temporary)?;
    let spent = start.elapsed().as_secs_f64();
    println!(
        "{:<10} {inputs:>9} inputs in {spent:>5.0} s, {:>6.0} a second; {coverage:>6} of {of} edges, \
         {} inputs kept; {} findings",
        target.name,
        inputs as f64 / spent,
        names(&place("corpus"))?.len(),
        found.len()
    );
    found.dedup();
    Ok(found)
}

/// What ended a run that did not succeed: its finding, new or found again, or the end of its log.
fn failure(target: &str, log: &str) -> String {
    let written = log.rsplit_once("Test unit written to ").map(|(_, rest)| rest);
    match written.and_then(|rest| rest.lines().next()) {
        Some(path) => path.trim().to_owned(),
        None => {
            let last: Vec<&str> = log.lines().rev().take(5).collect();
            let last: Vec<&str> = last.into_iter().rev().collect();
            format!("{target} ended without a finding: {}", last.join(" / "))
        }
    }
}

/// The last number after a word.
fn number_after(log: &str, word: &str) -> Option<u64> {
    let (_, rest) = log.rsplit_once(word)?;
    let rest = rest.trim_start();
    let end = rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len());
    rest[..end].parse().ok()
}

/// The files of a folder.
fn names(folder: &Path) -> Result<Vec<String>> {
    let entries = fs::read_dir(folder)?;
    entries.map(|entry| Ok(entry?.path().display().to_string())).collect()
}

#[cfg(test)]
mod tests {
    use super::{failure, number_after};

    #[test]
    fn numbers_of_the_log() {
        let log =
            "#2\tINITED cov: 8 ft: 8\n#9\tDONE   cov: 10 ft: 12\nstat::average_exec_per_sec: 7";
        assert_eq!(number_after(log, " cov: "), Some(10));
        assert_eq!(number_after(log, "stat::average_exec_per_sec:"), Some(7));
        assert_eq!(number_after(log, "missing"), None);
    }

    /// Also a finding that is there already, and a program that ends by itself.
    #[test]
    fn every_run_that_fails_is_told() {
        let log = "==7== ERROR\nartifact_prefix='f/'; Test unit written to f/crash-1\nBase64: AA==";
        assert_eq!(failure("urdf", log), "f/crash-1");
        let log = "INFO: Seed: 3\nCYLINDROID_FUZZ_TARGET=\"x\" is no target";
        assert!(failure("x", log).ends_with("Seed: 3 / CYLINDROID_FUZZ_TARGET=\"x\" is no target"));
    }
}
