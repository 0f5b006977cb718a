//! The order of the source files: the library's modules form one line, files import one another
//! without circles, no file is long, and headers name tests that exist.

mod checked;
mod graph;
mod line;
mod modules;
mod page;
mod rust;
pub(crate) mod source;

use std::path::Path;

use anyhow::{Result, bail};

use self::graph::{Circle, circles};
use self::source::{below, files, text_of};

/// The roots of the crates.
const CRATES: [&str; 6] = [
    "crates/cylindroid/src/lib.rs",
    "crates/cylindroid-c/src/lib.rs",
    "crates/cylindroid-cli/src/lib.rs",
    "crates/cylindroid-py/src/lib.rs",
    "crates/cylindroid-ros2/src/lib.rs",
    "xtask/src/main.rs",
];
/// The crate whose headers name tests.
const LIBRARY: &str = "crates/cylindroid";
/// The page's files.
const PAGE: &str = "viewer/src";
/// The most lines that a file may have.
const LONGEST_FILE: usize = 500;
/// Where files are so short, tests and benchmarks among them.
const SHORT: [&str; 6] =
    ["crates", "fuzz/src", "xtask/src", "benches", "viewer/src", "viewer/tests"];

/// Checks everything, or with `--circles` and `--checked` lists one kind of faults.
///
/// # Errors
/// Faults; each names its file.
pub(crate) fn task(flag: Option<&str>) -> Result<()> {
    let root = &crate::shell::root();
    let faults = match flag {
        None => return check(),
        Some("--circles") => all_circles(root)?.iter().map(Circle::in_full).collect(),
        Some("--checked") => checked::faults(root, &root.join(LIBRARY))?,
        Some(other) => bail!("layers takes --circles or --checked, not '{other}'"),
    };
    refuse(&faults)
}

/// Checks the line of modules, circles of files, `Checked` entries and the length of files.
///
/// # Errors
/// Faults; each names its file.
pub(crate) fn check() -> Result<()> {
    let root = &crate::shell::root();
    let mut faults = line::faults(root)?;
    faults.extend(all_circles(root)?.iter().map(ToString::to_string));
    faults.extend(checked::faults(root, &root.join(LIBRARY))?);
    for folder in SHORT {
        faults.extend(length_faults(root, folder)?);
    }
    refuse(&faults)
}

fn refuse(faults: &[String]) -> Result<()> {
    if faults.is_empty() {
        return Ok(());
    }
    bail!("{} faults in the order of the files:\n  {}", faults.len(), faults.join("\n  "))
}

/// Circles of files in all crates and in the page.
fn all_circles(root: &Path) -> Result<Vec<Circle>> {
    let mut found = Vec::new();
    for crate_root in CRATES {
        found.extend(circles(&rust::imports(root, Path::new(crate_root))?));
    }
    found.extend(circles(&page::imports(root, Path::new(PAGE))?));
    Ok(found)
}

/// Files that are too long.
fn length_faults(root: &Path, folder: &str) -> Result<Vec<String>> {
    let mut faults = Vec::new();
    for file in files(&root.join(folder), &["rs", "py", "ts", "mjs", "cpp", "hpp"])? {
        let lines = text_of(&file)?.lines().count();
        if lines > LONGEST_FILE {
            let short = below(root, &file);
            faults.push(format!("{short}: {lines} lines, at most {LONGEST_FILE}"));
        }
    }
    Ok(faults)
}
