//! The modules of the library form one line: each imports only those before it.

use std::path::Path;

use anyhow::Result;

use super::source::{files, text_of};

/// The line. A module that is not written yet keeps its place.
const LINE: [&str; 17] = [
    "error",
    "tolerance",
    "scalar",
    "linalg",
    "spatial",
    "screws",
    "inverse",
    "model",
    "kinematics",
    "collision",
    "closure",
    "manipulability",
    "task",
    "ik",
    "control",
    "sweep",
    "lib",
];

/// Imports of the library that break the line: a module that imports one to its right, or is
/// missing from the line.
///
/// # Errors
/// A file that cannot be read.
pub(super) fn faults(root: &Path) -> Result<Vec<String>> {
    let source = root.join("crates/cylindroid/src");
    let mut faults = Vec::new();
    for file in files(&source, &["rs"])? {
        let text = text_of(&file)?;
        let short = file.strip_prefix(&source).unwrap_or(&file);
        let first = short.iter().next().map(|s| s.to_string_lossy().into_owned());
        let module = first.unwrap_or_default().trim_end_matches(".rs").to_owned();
        let Some(place) = position(&module) else {
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
                match position(&name) {
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

fn position(module: &str) -> Option<usize> {
    LINE.iter().position(|m| *m == module)
}
