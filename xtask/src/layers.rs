//! The modules of the library form one line: each imports only those before it.

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

/// Checks every `use crate::...` and `crate::...` path of the library, and the length of files.
///
/// # Errors
/// A module that imports one to its right, or is missing from the line; a file that is too long.
pub(crate) fn check() -> Result<()> {
    let source = crate::steps::root().join("crates/cylindroid/src");
    let mut faults = Vec::new();
    for file in rust_files(&source)? {
        let text = fs::read_to_string(&file).with_context(|| file.display().to_string())?;
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
        let lines = text.lines().count();
        if lines > LONGEST_FILE {
            faults.push(format!("{}: {lines} lines, at most {LONGEST_FILE}", short.display()));
        }
    }
    if faults.is_empty() {
        return Ok(());
    }
    bail!("the library's line of modules is broken:\n  {}", faults.join("\n  "))
}

fn place(module: &str) -> Option<usize> {
    LINE.iter().position(|m| *m == module)
}

fn rust_files(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            files.extend(rust_files(&path)?);
        } else if path.extension().is_some_and(|e| e == "rs") {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}
