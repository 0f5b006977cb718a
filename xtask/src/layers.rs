//! The modules of the library form one line: each imports only those before it. No file is longer
//! than a newcomer reads.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

/// The line. A module that is not written yet keeps its place.
const LINE: [&str; 15] = [
    "error",
    "tolerance",
    "scalar",
    "linalg",
    "spatial",
    "screws",
    "inverse",
    "model",
    "kinematics",
    "closure",
    "manipulability",
    "ik",
    "control",
    "sweep",
    "lib",
];

/// More lines than this and a newcomer no longer finds the room.
const LONGEST_FILE: usize = 500;
/// Where files are so short, tests and benchmarks among them.
const SHORT: [&str; 5] = ["crates", "xtask/src", "benches", "viewer/src", "viewer/tests"];

/// Checks every `use crate::...` and `crate::...` path of the library, and the length of files.
///
/// # Errors
/// A module that imports one to its right, or is missing from the line; a file that is too long.
pub(crate) fn check() -> Result<()> {
    let mut faults = line_faults()?;
    for folder in SHORT {
        faults.extend(length_faults(&crate::steps::root().join(folder))?);
    }
    if faults.is_empty() {
        return Ok(());
    }
    bail!("files are not where they belong, or too long:\n  {}", faults.join("\n  "))
}

/// Files that are too long.
fn length_faults(folder: &Path) -> Result<Vec<String>> {
    let mut faults = Vec::new();
    for file in files(folder, &["rs", "py", "ts", "mjs", "cpp", "hpp"])? {
        let lines = text_of(&file)?.lines().count();
        if lines > LONGEST_FILE {
            let short = file.strip_prefix(crate::steps::root()).unwrap_or(&file).display();
            faults.push(format!("{short}: {lines} lines, at most {LONGEST_FILE}"));
        }
    }
    Ok(faults)
}

/// Imports of the library that break the line.
fn line_faults() -> Result<Vec<String>> {
    let source = crate::steps::root().join("crates/cylindroid/src");
    let mut faults = Vec::new();
    for file in files(&source, &["rs"])? {
        let text = text_of(&file)?;
        let short = file.strip_prefix(&source).unwrap_or(&file);
        let first = short.iter().next().map(|s| s.to_string_lossy().into_owned());
        let module = first.unwrap_or_default().trim_end_matches(".rs").to_owned();
        let Some(place) = place(&module) else {
            faults.push(format!("{}: module '{module}' is not in the line", short.display()));
            continue;
        };
        for (number, line) in text.lines().enumerate() {
            // Documentation may point anywhere.
            let code = line.split("//").next().unwrap_or_default();
            for imported in code.split("crate::").skip(1) {
                let name: String =
                    imported.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
                // Names re-exported at the root are for users; inside, modules are named.
                match self::place(&name) {
                    Some(other) if other <= place => {}
                    Some(_) => faults.push(format!(
                        "{}:{}: '{module}' imports '{name}', which stands after it",
                        short.display(),
                        number + 1
                    )),
                    None if imported.starts_with('{') => faults.push(format!(
                        "{}:{}: write one `use` for each module",
                        short.display(),
                        number + 1
                    )),
                    None => faults.push(format!(
                        "{}:{}: '{module}' imports crate::{name}, which is not a module",
                        short.display(),
                        number + 1
                    )),
                }
            }
        }
    }
    Ok(faults)
}

fn text_of(file: &Path) -> Result<String> {
    fs::read_to_string(file).with_context(|| file.display().to_string())
}

fn place(module: &str) -> Option<usize> {
    LINE.iter().position(|m| *m == module)
}

/// Files with one of these endings, in a folder and those below it; what tools put there is not
/// ours.
fn files(folder: &Path, endings: &[&str]) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            let built = path.file_name().is_some_and(|n| n == "target" || n == "node_modules");
            if !built {
                found.extend(files(&path, endings)?);
            }
        } else if path.extension().is_some_and(|e| endings.iter().any(|ending| e == *ending)) {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}
