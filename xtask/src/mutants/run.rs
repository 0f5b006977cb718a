//! The tests, once for each mutant until one of them fails.

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::mpsc;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};

use super::mutant::{BUILD, Mutant};
use crate::shell::{cargo, root};

/// Test programs of the library, those of the mathematics first.
const PROGRAMS: [&str; 4] = ["it", "motion", "collision", "lib"];

/// Time for a mutant, beside three times that of the tests without one.
const PATIENCE: Duration = Duration::from_secs(60);

pub(super) struct Report {
    pub(super) caught: usize,
    pub(super) missed: Vec<Mutant>,
}

struct Tests<'a> {
    programs: Vec<PathBuf>,
    library: &'a Path,
    robots: &'a Path,
}

impl Tests<'_> {
    /// The first test that fails with a mutant, or why the program ended; `None` if all pass.
    fn first_failure(
        &self,
        program: &Path,
        filter: &str,
        mutant: Option<usize>,
        limit: Duration,
    ) -> Result<Option<String>> {
        let mut command = Command::new(program);
        command.args(Some(filter).filter(|f| !f.is_empty())).current_dir(self.library);
        // Documents and formats of other languages say nothing about mathematics.
        command.args(["--skip", "simd::"]);
        command.env("CYLINDROID_TEST_ROBOTS", self.robots).env("RUST_BACKTRACE", "0");
        if let Some(number) = mutant {
            command.env("CYLINDROID_MUTANT", number.to_string());
        }
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn()?;
        let output = child.stdout.take().context("the output of the tests")?;
        let (send, lines) = mpsc::channel();
        let reader = std::thread::spawn(move || {
            let lines = BufReader::new(output).lines().map_while(Result::ok);
            lines.take_while(|line| send.send(line.clone()).is_ok()).count()
        });
        let start = Instant::now();
        let failure = loop {
            match lines.recv_timeout(limit.saturating_sub(start.elapsed())) {
                Ok(line) if line.ends_with("... FAILED") => {
                    break Some(line.replace("test ", "").replace(" ... FAILED", ""));
                }
                Ok(_) => {}
                Err(mpsc::RecvTimeoutError::Timeout) => break Some("no end".to_owned()),
                Err(mpsc::RecvTimeoutError::Disconnected) => {
                    let status = child.wait()?;
                    break (!status.success()).then(|| status.to_string());
                }
            }
        };
        drop(lines);
        let _ = child.kill();
        child.wait()?;
        let _ = reader.join();
        Ok(failure)
    }
}

/// Runs the mutants in turn, for so many minutes.
pub(super) fn all(
    copy: &Path,
    library: &Path,
    robots: &Path,
    mutants: &[Mutant],
    minutes: f64,
) -> Result<Report> {
    let tests = Tests { programs: programs(copy)?, library, robots };
    let start = Instant::now();
    for program in &tests.programs {
        if let Some(test) = tests.first_failure(program, "", None, Duration::MAX)? {
            bail!("{test} fails without a mutant");
        }
    }
    let limit = 3 * start.elapsed() + PATIENCE;
    println!("the tests take {:.0} s", start.elapsed().as_secs_f64());
    let start = Instant::now();
    let mut report = Report { caught: 0, missed: Vec::new() };
    for (number, mutant) in mutants.iter().enumerate() {
        if start.elapsed().as_secs_f64() > 60.0 * minutes {
            break;
        }
        // Tests of the same name are the likeliest to fail.
        let folder = mutant.file.split('/').next().unwrap_or_default();
        let mut runs = vec![(&tests.programs[0], folder)];
        runs.extend(tests.programs.iter().map(|program| (program, "")));
        let mut failure = None;
        for (program, filter) in runs {
            failure = tests.first_failure(program, filter, Some(number), limit)?;
            if failure.is_some() {
                break;
            }
        }
        let place = format!("{}:{}: {} -> {}", mutant.file, mutant.line, mutant.old, mutant.new);
        match failure {
            Some(test) => {
                println!("caught  {place} ({test})");
                report.caught += 1;
            }
            None => {
                println!("missed  {place}");
                report.missed.push(mutant.clone());
            }
        }
    }
    Ok(report)
}

/// Builds the test programs of the copy.
fn programs(copy: &Path) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    for name in PROGRAMS {
        let which = if name == "lib" { vec!["--lib"] } else { vec!["--test", name] };
        let output =
            cargo(&[&["test", "--package", "cylindroid", "--no-run"], &which[..]].concat())
                .current_dir(copy)
                .env("CARGO_TARGET_DIR", root().join(BUILD))
                .output()?;
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        let line = text.lines().find(|line| line.contains("Executable"));
        let program = line.and_then(|line| line.split('(').nth(1)?.strip_suffix(')'));
        let Some(program) = program.filter(|_| output.status.success()) else {
            bail!("the tests of the copy do not build:\n{text}");
        };
        let program = Path::new(program);
        found.push(if program.is_absolute() { program.to_owned() } else { copy.join(program) });
    }
    Ok(found)
}
