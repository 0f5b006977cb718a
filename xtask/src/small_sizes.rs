//! Whether the test of small sizes calls every public function of the library: its lists in
//! `crates/cylindroid/tests/sizes/calls` name them all, and nothing else.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail};

use crate::python_names::{LIBRARY, library};
use crate::shell::root;

const CALLS: &str = "crates/cylindroid/tests/sizes/calls";

/// Compares the library with the lists.
///
/// # Errors
/// Functions without a line, and lines without a function.
pub(crate) fn check() -> Result<()> {
    let functions = library::public_functions(&root().join(LIBRARY))?;
    let functions = functions.iter().map(library::Function::path).collect();
    let faults = compare(&functions, &listed(&root().join(CALLS))?);
    if faults.is_empty() {
        return Ok(());
    }
    bail!("{} faults in {CALLS}:\n  {}", faults.len(), faults.join("\n  "))
}

fn compare(functions: &BTreeSet<String>, listed: &BTreeSet<String>) -> Vec<String> {
    let missing = functions.difference(listed).map(|path| format!("no line calls {path}"));
    let unknown = listed.difference(functions).map(|path| format!("no public function {path}"));
    missing.chain(unknown).collect()
}

/// The paths at the beginnings of lines: `path;` or `path = call;`.
fn listed(folder: &Path) -> Result<BTreeSet<String>> {
    let mut paths = BTreeSet::new();
    for file in fs::read_dir(folder).with_context(|| folder.display().to_string())? {
        let path = file?.path();
        if path.file_name().is_some_and(|name| name == "mod.rs") {
            continue;
        }
        paths.extend(paths_of(&fs::read_to_string(path)?));
    }
    Ok(paths)
}

fn paths_of(text: &str) -> impl Iterator<Item = String> + '_ {
    let lines = text.lines().filter_map(|line| line.strip_prefix("    "));
    lines.filter_map(|line| {
        let end = line.find(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':'))?;
        let (path, rest) = line.split_at(end);
        let is_call = rest.starts_with(';') || rest.starts_with(" =");
        (path.contains("::") && is_call).then(|| path.to_owned())
    })
}

#[cfg(test)]
mod tests {
    use super::{compare, paths_of};

    #[test]
    fn lines_and_functions_are_the_same() {
        let text = "calls! {\n    a::b;\n    a::C::d =\n        |x: f64| a::C::d(x);\n    }";
        let listed = paths_of(text).collect();
        let functions = |paths: &[&str]| paths.iter().map(|p| (*p).to_owned()).collect();
        assert!(compare(&functions(&["a::b", "a::C::d"]), &listed).is_empty());
        assert_eq!(
            compare(&functions(&["a::b", "a::e"]), &listed),
            ["no line calls a::e", "no public function a::C::d"]
        );
    }
}
