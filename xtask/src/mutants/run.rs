//! The tests that reach a mutant, the fastest first, until one of them fails.

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::mpsc;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};

use super::equivalent::Equivalent;
use super::mutant::{BUILD, Mutant};
use crate::shell::{cargo, root};

/// Test programs of the library; `lib` are the tests in its sources.
const PROGRAMS: [&str; 10] =
    ["recorded", "it", "motion", "collision", "formats", "sweep", "map", "sizes", "limits", "lib"];

/// Time for tests with a mutant, beside five times that without one.
const PATIENCE: Duration = Duration::from_secs(10);

/// Tests together in a process: as many as take this long [s].
const TOGETHER: f64 = 1.0;

pub(super) struct Report {
    pub(super) caught: usize,
    pub(super) missed: Vec<Mutant>,
    /// Missed ones that the list has.
    pub(super) equivalent: usize,
}

/// A test, and what it reaches.
struct Test {
    /// Index of the program.
    program: usize,
    name: String,
    seconds: f64,
    /// Numbers of mutants.
    reached: Vec<usize>,
}

struct Tests<'a> {
    programs: Vec<PathBuf>,
    library: &'a Path,
    robots: &'a Path,
    all: Vec<Test>,
}

impl<'a> Tests<'a> {
    /// Builds the programs and runs each test alone.
    fn new(copy: &Path, library: &'a Path, robots: &'a Path) -> Result<Self> {
        let mut tests = Self { programs: programs(copy)?, library, robots, all: Vec::new() };
        println!("built");
        let notes = copy.join("reached");
        for program in 0..tests.programs.len() {
            for name in tests.names(program)? {
                fs::write(&notes, "")?;
                let start = Instant::now();
                let mut command = tests.command(program, &[&name]);
                command.env("CYLINDROID_MUTANTS_REACHED", &notes);
                if let Some(test) = first_failure(command, Duration::MAX)? {
                    bail!("{test} fails without a mutant");
                }
                let seconds = start.elapsed().as_secs_f64();
                let numbers = fs::read_to_string(&notes)?;
                let reached = numbers.lines().map(str::parse).collect::<Result<_, _>>()?;
                tests.all.push(Test { program, name, seconds, reached });
            }
        }
        tests.all.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
        Ok(tests)
    }

    fn names(&self, program: usize) -> Result<Vec<String>> {
        let mut command = Command::new(&self.programs[program]);
        command.args(["--list", "--format", "terse"]).current_dir(self.library);
        let output = String::from_utf8(command.output()?.stdout)?;
        let names = output.lines().filter_map(|line| line.strip_suffix(": test"));
        // They start the program again in other forms.
        Ok(names.filter(|name| !name.starts_with("simd::")).map(str::to_owned).collect())
    }

    fn command(&self, program: usize, names: &[&str]) -> Command {
        let mut command = Command::new(&self.programs[program]);
        command.arg("--exact").args(names).current_dir(self.library);
        command.env("CYLINDROID_TEST_ROBOTS", self.robots).env("RUST_BACKTRACE", "0");
        command
    }

    /// The tests that reach a mutant, in the order in which they are run.
    fn reaching(&self, number: usize) -> Vec<&Test> {
        self.all.iter().filter(|test| test.reached.contains(&number)).collect()
    }

    /// The first test that fails with a mutant, or why its program ended; `None` if all pass.
    fn failure(&self, number: usize) -> Result<Option<String>> {
        let tests = self.reaching(number);
        let mut rest = tests.as_slice();
        while !rest.is_empty() {
            let mut seconds = 0.0;
            let together = rest.iter().take_while(|test| {
                let is_early = seconds < TOGETHER;
                seconds += test.seconds;
                is_early
            });
            let (now, later) = rest.split_at(together.count());
            rest = later;
            for program in 0..self.programs.len() {
                let own = now.iter().filter(|test| test.program == program);
                let names: Vec<&str> = own.clone().map(|test| test.name.as_str()).collect();
                if names.is_empty() {
                    continue;
                }
                let usual = Duration::from_secs_f64(own.map(|test| test.seconds).sum());
                let mut command = self.command(program, &names);
                command.env("CYLINDROID_MUTANT", number.to_string());
                let failure = first_failure(command, 5 * usual + PATIENCE)?;
                if failure.is_some() {
                    return Ok(failure);
                }
            }
        }
        Ok(None)
    }
}

/// The first test of a run that fails, or why the program ended; `None` if all pass.
fn first_failure(mut command: Command, limit: Duration) -> Result<Option<String>> {
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

/// Runs the mutants in turn, for so many minutes.
pub(super) fn all(
    copy: &Path,
    library: &Path,
    robots: &Path,
    (mutants, equivalent): (&[Mutant], &Equivalent),
    minutes: f64,
) -> Result<Report> {
    let tests = Tests::new(copy, library, robots)?;
    let seconds: f64 = tests.all.iter().map(|test| test.seconds).sum();
    println!("{} tests, one after the other, take {seconds:.0} s", tests.all.len());
    let start = Instant::now();
    let mut report = Report { caught: 0, missed: Vec::new(), equivalent: 0 };
    for &number in &in_turn(mutants.len()) {
        if start.elapsed().as_secs_f64() > 60.0 * minutes {
            break;
        }
        let mutant = &mutants[number];
        let place = format!("{}:{}: {} -> {}", mutant.file, mutant.line, mutant.old, mutant.new);
        let reaching = tests.reaching(number).len();
        match tests.failure(number)? {
            Some(test) => {
                println!("caught  {place} ({test})");
                report.caught += 1;
            }
            None if equivalent.contains(mutant) => report.equivalent += 1,
            None => {
                println!("missed  {place} (by {reaching} tests that reach it)");
                report.missed.push(mutant.clone());
            }
        }
    }
    Ok(report)
}

/// All numbers below `n`, spread, so that the first ones are a sample of all files.
fn in_turn(n: usize) -> Vec<usize> {
    let prime = 7919;
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by_key(|i| (i * prime) % 10_007);
    order
}

/// Builds the test programs of the copy.
fn programs(copy: &Path) -> Result<Vec<PathBuf>> {
    let mut arguments = vec!["test", "--package", "cylindroid", "--no-run"];
    for name in PROGRAMS {
        match name {
            "lib" => arguments.push("--lib"),
            name => arguments.extend(["--test", name]),
        }
    }
    let output =
        cargo(&arguments).current_dir(copy).env("CARGO_TARGET_DIR", root().join(BUILD)).output()?;
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    if !output.status.success() {
        bail!("the tests of the copy do not build:\n{text}");
    }
    let mut found = Vec::new();
    for name in PROGRAMS {
        let source = if name == "lib" { "src/lib.rs".to_owned() } else { format!("tests/{name}/") };
        let line = text.lines().find(|l| l.contains("Executable") && l.contains(&source));
        let program = line.and_then(|line| line.rsplit('(').next()?.strip_suffix(')'));
        let program = Path::new(program.with_context(|| format!("no program of {source}"))?);
        found.push(if program.is_absolute() { program.to_owned() } else { copy.join(program) });
    }
    Ok(found)
}
