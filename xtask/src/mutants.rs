//! Mutants of the mathematics: one operator, sign, number or function of the library is changed,
//! and the tests must fail.
//!
//! Formula  Wilson interval of the share p = c / n that is caught, z = 1.96:
//!          (p + z^2 / 2n +- z sqrt(p (1 - p) / n + z^2 / 4n^2)) / (1 + z^2 / n)
//! Valid    expressions of one line outside of constants, patterns and macros. A mutant that is missed
//!          is a question for a person: those that are equivalent (a wrong step that is only slower)
//!          are listed with the reason (`equivalent`) and do not count
//! Why so   all mutants are compiled once into a copy of the library, each behind a test of the
//!          variable CYLINDROID_MUTANT; one build for each mutant would take a hundred times as long.
//!          The tests without a mutant note which mutants each of them reaches, and only those run

mod equivalent;
mod mutant;
mod run;
mod sites;

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail};

use self::equivalent::Equivalent;
use self::mutant::{BUILD, Mutant};
use crate::models;
use crate::shell::{cargo, root, run as shell_run};

/// Folders of the mathematics, below `crates/cylindroid/src`.
const FOLDERS: [&str; 11] = [
    "closure",
    "collision",
    "control",
    "ik",
    "inverse",
    "kinematics",
    "linalg",
    "manipulability",
    "scalar",
    "screws",
    "spatial",
];

/// `--sample N` mutants (40) of `--folder F` (all), drawn with `--seed S` (1), within `--minutes M`;
/// or one of each line `--at FILE:LINE`.
///
/// # Errors
/// Tests that fail without a mutant; a copy that does not build; a line without mutants.
pub(crate) fn task(arguments: &[String]) -> Result<()> {
    let (mut sample, mut seed, mut minutes) = (40_usize, 1_u64, f64::INFINITY);
    let (mut folders, mut lines) = (Vec::new(), Vec::new());
    for pair in arguments.chunks(2) {
        match pair {
            [flag, value] if flag == "--sample" => sample = value.parse().context("--sample")?,
            [flag, value] if flag == "--seed" => seed = value.parse().context("--seed")?,
            [flag, value] if flag == "--minutes" => minutes = value.parse().context("--minutes")?,
            [flag, value] if flag == "--folder" => folders.push(value.as_str()),
            [flag, line] if flag == "--at" => lines.push(line.as_str()),
            _ => bail!(
                "mutants has the options --sample N, --seed S, --minutes M, --folder F and \
                 --at FILE:LINE"
            ),
        }
    }
    if let Some(unknown) = folders.iter().find(|folder| !FOLDERS.contains(folder)) {
        bail!("--folder {unknown}: one of {}", FOLDERS.join(", "));
    }
    if folders.is_empty() {
        folders = FOLDERS.to_vec();
    }
    let equivalent = Equivalent::load()?;
    let robots = models::fetch()?;
    let copy = root().join("target/mutants");
    let library = copied(&copy)?;
    let mut sites = Vec::new();
    for folder in folders {
        sites::find(&library.join("src"), folder, &mut sites)?;
    }
    let all = sites.len();
    if !lines.is_empty() {
        sites = sites::at(sites, &lines)?;
        sample = sites.len();
    }
    let mut mutants = sites::drawn(sites, sample, seed);
    println!("{} of {all} mutants", mutants.len());
    build(&library, &mut mutants)?;
    let report = run::all(&copy, &library, &robots, (&mutants, &equivalent), minutes)?;
    let (caught, tried) = (report.caught, report.caught + report.missed.len());
    let [lower, upper] = wilson(caught, tried);
    for mutant in &report.missed {
        println!("missed  {}:{}: {} -> {}", mutant.file, mutant.line, mutant.old, mutant.new);
    }
    if report.equivalent > 0 {
        println!("{} equivalent ones apart", report.equivalent);
    }
    println!(
        "{caught} of {tried} caught: {:.0} %, {:.0} to {:.0} % with a probability of 95 %",
        100.0 * caught as f64 / tried.max(1) as f64,
        100.0 * lower,
        100.0 * upper
    );
    Ok(())
}

/// The limits of the share of `caught` in `tried`.
fn wilson(caught: usize, tried: usize) -> [f64; 2] {
    let (n, z) = (tried.max(1) as f64, 1.96_f64);
    let p = caught as f64 / n;
    let middle = p + z * z / (2.0 * n);
    let half = z * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt();
    [middle - half, middle + half].map(|x| x / (1.0 + z * z / n))
}

/// A copy of the tracked files of the workspace; its library's folder.
fn copied(copy: &Path) -> Result<std::path::PathBuf> {
    if copy.exists() {
        fs::remove_dir_all(copy)?;
    }
    fs::create_dir_all(copy)?;
    let prefix = format!("--prefix={}/", copy.display());
    let mut checkout = std::process::Command::new("git");
    shell_run(checkout.args(["checkout-index", "--all", "--force", &prefix]))?;
    let library = copy.join("crates/cylindroid");
    let lib = library.join("src/lib.rs");
    let text = fs::read_to_string(&lib)?;
    fs::write(lib, format!("{text}\n{SWITCH}"))?;
    Ok(library)
}

/// True for the mutant whose number is in the environment. With `CYLINDROID_MUTANTS_REACHED` it notes
/// in this file the numbers that are asked for.
const SWITCH: &str = "
pub(crate) fn mutant(number: u32) -> bool {
    use std::sync::atomic::{AtomicU32, Ordering};
    static CHOSEN: AtomicU32 = AtomicU32::new(u32::MAX);
    let mut chosen = CHOSEN.load(Ordering::Relaxed);
    if chosen == u32::MAX {
        let given = std::env::var(\"CYLINDROID_MUTANT\").ok();
        let none = u32::MAX - 1 - u32::from(std::env::var_os(\"CYLINDROID_MUTANTS_REACHED\").is_some());
        chosen = given.and_then(|n| n.parse().ok()).unwrap_or(none);
        CHOSEN.store(chosen, Ordering::Relaxed);
    }
    if chosen == u32::MAX - 2 {
        note_mutant(number);
    }
    chosen == number
}

#[cold]
fn note_mutant(number: u32) {
    use std::io::Write;
    use std::sync::atomic::{AtomicBool, Ordering};
    static NOTED: [AtomicBool; 65536] = [const { AtomicBool::new(false) }; 65536];
    let noted = &NOTED[number as usize % NOTED.len()];
    if noted.load(Ordering::Relaxed) || noted.swap(true, Ordering::Relaxed) {
        return;
    }
    let path = std::env::var_os(\"CYLINDROID_MUTANTS_REACHED\").unwrap_or_default();
    let file = std::fs::OpenOptions::new().append(true).open(path);
    let _ = file.and_then(|mut file| file.write_all(format!(\"{number}\\n\").as_bytes()));
}
";

/// Writes the mutants into the copy, and leaves out those that do not compile.
fn build(library: &Path, mutants: &mut Vec<Mutant>) -> Result<()> {
    let source = library.join("src");
    let files: std::collections::BTreeSet<String> =
        mutants.iter().map(|m| m.file.clone()).collect();
    let originals: Vec<(String, String)> = files
        .into_iter()
        .map(|file| Ok((file.clone(), fs::read_to_string(source.join(&file))?)))
        .collect::<Result<_>>()?;
    for _ in 0..8 {
        for (file, original) in &originals {
            let mut text = original.clone();
            let own = mutants.iter().enumerate().filter(|(_, m)| m.file == *file);
            let mut own: Vec<(usize, &Mutant)> = own.collect();
            own.sort_by_key(|(_, m)| std::cmp::Reverse(m.range.start));
            for (number, mutant) in own {
                let Mutant { range, old, new, .. } = mutant;
                let choice = format!("(if crate::mutant({number}) {{ {new} }} else {{ {old} }})");
                text.replace_range(range.clone(), &choice);
            }
            fs::write(source.join(file), text)?;
        }
        let output = cargo(&["check", "--package", "cylindroid", "--message-format", "short"])
            .current_dir(library)
            .env("CARGO_TARGET_DIR", root().join(BUILD))
            .output()?;
        if output.status.success() {
            return Ok(());
        }
        let errors = String::from_utf8_lossy(&output.stderr).into_owned();
        let before = mutants.len();
        mutants.retain(|m| {
            let place = format!("{}:{}:", m.file, m.line);
            !errors.lines().any(|line| line.contains(": error") && line.contains(&place))
        });
        if mutants.len() == before {
            bail!("the copy does not compile:\n{errors}");
        }
    }
    bail!("the copy does not compile after eight rounds");
}

#[cfg(test)]
mod tests {
    use super::wilson;

    #[test]
    fn intervals() {
        // Brown, Cai & DasGupta 2001: 10 of 10 gives 0.722 to 1.
        let [lower, upper] = wilson(10, 10);
        assert!((lower - 0.7225).abs() < 1e-3 && (upper - 1.0).abs() < 1e-12, "{lower} {upper}");
        let [lower, upper] = wilson(0, 0);
        assert!(lower < 1e-12 && upper > 0.7, "{lower} {upper}");
    }
}
