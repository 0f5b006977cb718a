//! Random input for as long as one likes: files of every format, messages of the viewer, command
//! lines, calls from Python, steps of servos; or inputs that reach further code (`guided`).

mod dictionary;
mod guided;
mod seeds;

use std::time::Instant;

use anyhow::{Context, Result, bail};

use crate::shell::{cargo, run};
use crate::{models, python, steps};

/// Tests that stop after `CYLINDROID_FUZZ_SECONDS`: package, program, filter, and their number.
const TESTS: [(&str, &str, &str, u64); 2] =
    [("cylindroid", "formats", "mutated_files::mutated", 6), ("cylindroid-cli", "cli", "fuzz", 3)];

/// Steps of servos in a second of a machine with two cores, roughly.
const STEPS: f64 = 20_000.0;

/// `--minutes` in all (10) and `--seed` of the first round (0); with `--guided` by coverage, of all
/// targets or those of `--target`.
///
/// # Errors
/// A panic, a wrong exit code, an answer that does not come, a limit that is left: with the seed
/// that repeats it, or the file.
pub(crate) fn task(arguments: &[String]) -> Result<()> {
    let (mut minutes, mut seed, mut is_guided, mut targets) = (10.0, 0, false, Vec::new());
    let mut words = arguments.iter();
    while let Some(flag) = words.next() {
        if flag == "--guided" {
            is_guided = true;
            continue;
        }
        let value = words.next();
        match (flag.as_str(), value) {
            ("--minutes", Some(value)) => minutes = value.parse().context("--minutes")?,
            ("--seed", Some(value)) => seed = value.parse().context("--seed")?,
            ("--target", Some(value)) => targets.push(value.clone()),
            _ => bail!("fuzz has the options --minutes M, --seed N, --guided and --target NAME"),
        }
    }
    if !(minutes > 0.0 && f64::is_finite(minutes)) {
        bail!("--minutes = {minutes}: a positive number");
    }
    if is_guided {
        return guided::task(minutes, seed, &targets);
    }
    if !targets.is_empty() {
        bail!("--target needs --guided");
    }
    let tests: u64 = TESTS.iter().map(|test| test.3).sum();
    // Calls from Python and steps of servos take two shares.
    let share = (60.0 * minutes / (tests + 2) as f64).max(1.0);
    let robots = models::fetch()?;
    for (package, program, filter, _) in TESTS {
        let test = ["test", "--release", "--package", package, "--test", program, "--", filter];
        let options = ["--nocapture", "--test-threads", "1"];
        let start = Instant::now();
        run(cargo(&[&test[..], &options].concat())
            .env("CYLINDROID_TEST_ROBOTS", &robots)
            .env("CYLINDROID_FUZZ_SECONDS", format!("{share:.0}"))
            .env("CYLINDROID_FUZZ_SEED", seed.to_string()))?;
        println!("{package} {filter}: {:.0} s", start.elapsed().as_secs_f64());
    }
    let millions = (share * STEPS / 1e6).to_string();
    steps::limits(Some(&millions), Some(&seed.to_string()))?;
    python::fuzz(share, seed)
}
