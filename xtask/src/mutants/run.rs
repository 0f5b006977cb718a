//! The tests that reach a mutant, the fastest first, until one of them fails; as many mutants at a
//! time as there are processors.

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;
use std::thread::{self, available_parallelism};
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
        let mut names = Vec::new();
        for program in 0..tests.programs.len() {
            names.extend(tests.names(program)?.into_iter().map(|name| (program, name)));
        }
        tests.all = in_parallel(names.len(), |i| {
            let (program, name) = &names[i];
            tests.alone(*program, name, &copy.join(format!("reached-{i}")))
        })?;
        tests.all.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
        Ok(tests)
    }

    /// Runs a test without a mutant.
    fn alone(&self, program: usize, name: &str, notes: &Path) -> Result<Test> {
        fs::write(notes, "")?;
        let start = Instant::now();
        let mut command = self.command(program, &[name]);
        command.env("CYLINDROID_MUTANTS_REACHED", notes);
        if let Some(test) = first_failure(command, Duration::MAX)? {
            bail!("{test} fails without a mutant");
        }
        let seconds = start.elapsed().as_secs_f64();
        let numbers = fs::read_to_string(notes)?;
        let reached = numbers.lines().map(str::parse).collect::<Result<_, _>>()?;
        Ok(Test { program, name: name.to_owned(), seconds, reached })
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
        // The other mutants have the other processors.
        command.args(["--exact", "--test-threads", "1"]).args(names).current_dir(self.library);
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
    let order = in_turn(mutants.len());
    let verdicts = in_parallel(order.len(), |i| {
        if start.elapsed().as_secs_f64() > 60.0 * minutes {
            return Ok(Verdict::NotTried);
        }
        let number = order[i];
        let mutant = &mutants[number];
        let place = format!("{}:{}: {} -> {}", mutant.file, mutant.line, mutant.old, mutant.new);
        Ok(match tests.failure(number)? {
            Some(test) => {
                println!("caught  {place} ({test})");
                Verdict::Caught
            }
            None if equivalent.contains(mutant) => Verdict::Equivalent,
            None => {
                let reaching = tests.reaching(number).len();
                println!("missed  {place} (by {reaching} tests that reach it)");
                Verdict::Missed
            }
        })
    })?;
    let mut report = Report { caught: 0, missed: Vec::new(), equivalent: 0 };
    for (verdict, &number) in verdicts.into_iter().zip(&order) {
        match verdict {
            Verdict::Caught => report.caught += 1,
            Verdict::Missed => report.missed.push(mutants[number].clone()),
            Verdict::Equivalent => report.equivalent += 1,
            Verdict::NotTried => {}
        }
    }
    Ok(report)
}

enum Verdict {
    Caught,
    Missed,
    Equivalent,
    /// For want of time.
    NotTried,
}

/// The results of `work` for all numbers below `n`, by as many threads as there are processors.
///
/// # Errors
/// The first error of `work`, after which nothing more is begun.
fn in_parallel<T: Send>(n: usize, work: impl Fn(usize) -> Result<T> + Sync) -> Result<Vec<T>> {
    let next = AtomicUsize::new(0);
    let worker = || {
        let mut own = Vec::new();
        loop {
            let i = next.fetch_add(1, Ordering::Relaxed);
            if i >= n {
                return Ok(own);
            }
            let result = work(i).inspect_err(|_| next.store(n, Ordering::Relaxed))?;
            own.push((i, result));
        }
    };
    let threads = available_parallelism().map_or(1, usize::from).min(n);
    let parts: Result<Vec<Vec<_>>> = thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(worker)).collect();
        let joined = workers.into_iter().map(|worker| worker.join());
        joined
            .map(|part| part.unwrap_or_else(|_| bail!("a thread that ran tests panicked")))
            .collect()
    });
    let mut all: Vec<_> = parts?.into_iter().flatten().collect();
    all.sort_by_key(|(i, _)| *i);
    Ok(all.into_iter().map(|(_, result)| result).collect())
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

#[cfg(test)]
mod tests {
    use anyhow::bail;

    use super::in_parallel;

    #[test]
    fn results_are_in_order_and_an_error_ends_the_work() {
        assert_eq!(
            in_parallel(50, |i| Ok(i * i)).unwrap(),
            (0..50).map(|i| i * i).collect::<Vec<_>>()
        );
        assert_eq!(in_parallel(0, Ok).unwrap(), []);
        let error =
            in_parallel(9, |i| if i == 4 { bail!("the fifth") } else { Ok(i) }).unwrap_err();
        assert_eq!(error.to_string(), "the fifth");
    }
}
