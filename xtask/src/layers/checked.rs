//! The `Checked` entry of a file's header names the tests that hold it, and they exist.
//!
//! ```text
//! //! Checked  tests/it/penrose.rs::damped_*, ::rank_*, tests/it/servo/, tests/vectors/*.rs (note),
//! //!          examples/03_plane.rs, tests in this file, tests::agrees_with_std
//! ```
//! Places are separated by commas; `*` stands for any letters; `::name` alone belongs to the file
//! before it; `tests::name` is a test in the file itself. Notes stand in parentheses.

use std::path::Path;

use anyhow::Result;
use syn::visit::{self, Visit};

use super::source::{below, files, text_of};

/// Longer files that compute or decide need a `Checked` entry.
const SHORT_ENOUGH: usize = 80;

/// Files of a crate, tests apart, without a `Checked` entry that need one, and entries that name no
/// test.
///
/// # Errors
/// Files that cannot be read or parsed.
pub(super) fn faults(root: &Path, crate_folder: &Path) -> Result<Vec<String>> {
    let mut faults = Vec::new();
    for file in files(&crate_folder.join("src"), &["rs"])? {
        let text = text_of(&file)?;
        let name = below(root, &file);
        match entry(&text) {
            Some(entry) => faults.extend(
                dangling(crate_folder, &text, &entry)?
                    .into_iter()
                    .map(|fault| format!("{name}: Checked names {fault}")),
            ),
            None if !name.ends_with("/tests.rs") && needs_entry(&text)? => {
                faults.push(format!("{name}: no `Checked` entry"))
            }
            None => {}
        }
    }
    Ok(faults)
}

/// The text of the entry, its lines joined.
fn entry(text: &str) -> Option<String> {
    let mut header = text.lines().take_while(|line| line.starts_with("//!"));
    let first = header.find_map(|line| line.strip_prefix("//! Checked "))?;
    let more = header.map_while(|line| line.strip_prefix("//!   "));
    Some(std::iter::once(first).chain(more).map(str::trim).collect::<Vec<_>>().join(" "))
}

/// Places of an entry where there is no test, each with the reason.
fn dangling(crate_folder: &Path, text: &str, entry: &str) -> Result<Vec<String>> {
    let mut faults = Vec::new();
    let mut path_before = String::new();
    for place in without_notes(entry).split(',').map(|place| place.trim().trim_matches('`')) {
        let (path, pattern) = place.split_once("::").unwrap_or((place, "*"));
        if place == "tests in this file" || path == "tests" {
            if !tests(text).any(|test| matches(pattern, test)) {
                faults.push(format!("'{place}', but no such test is in the file"));
            }
            continue;
        }
        if !path.is_empty() {
            path.clone_into(&mut path_before);
        }
        let looks_so = ["/", ".rs"].iter().any(|end| path_before.ends_with(end));
        if !looks_so || path_before.contains(' ') || pattern.contains(' ') || pattern.is_empty() {
            faults.push(format!("'{place}', which is not a file, a folder/ or file::test"));
            continue;
        }
        let named = named_files(crate_folder, &path_before)?;
        if named.is_empty() {
            faults.push(format!("'{path_before}', which does not exist"));
            continue;
        }
        let mut found = false;
        for file in named {
            let text = text_of(&file)?;
            let is_example = path_before.starts_with("examples/") && pattern == "*";
            found |= is_example || tests(&text).any(|test| matches(pattern, test));
        }
        if !found {
            faults.push(format!("'{path_before}::{pattern}', but no such test is there"));
        }
    }
    Ok(faults)
}

fn without_notes(entry: &str) -> String {
    let mut depth = 0_usize;
    let outside = entry.chars().filter(|c| {
        if *c == '(' {
            depth += 1;
        }
        let is_outside = depth == 0;
        if *c == ')' {
            depth = depth.saturating_sub(1);
        }
        is_outside
    });
    outside.collect()
}

/// The files that a path with `*` means, or all below a path that ends with `/`.
fn named_files(crate_folder: &Path, path: &str) -> Result<Vec<std::path::PathBuf>> {
    let folder = crate_folder.join(path.rsplit_once('/').map_or("", |(folder, _)| folder));
    if !folder.is_dir() {
        return Ok(Vec::new());
    }
    let all = files(&folder, &["rs"])?.into_iter();
    Ok(all
        .filter(|file| {
            let name = below(crate_folder, file);
            path.ends_with('/') || matches(path, &name)
        })
        .collect())
}

/// Names of functions that follow `#[test]`, also inside macros.
fn tests(text: &str) -> impl Iterator<Item = &str> {
    let mut after_attribute = false;
    text.lines().map(str::trim).filter_map(move |line| {
        if line.starts_with("#[test]") {
            after_attribute = true;
        }
        let (_, name) = line.split_once("fn ").filter(|_| after_attribute)?;
        after_attribute = false;
        name.split(|c: char| !c.is_alphanumeric() && c != '_').next()
    })
}

/// Whether a name fits a pattern with `*`.
fn matches(pattern: &str, name: &str) -> bool {
    match pattern.split_once('*') {
        None => pattern == name,
        Some((before, after)) => name.strip_prefix(before).is_some_and(|rest| {
            (0..=rest.len()).any(|start| rest.get(start..).is_some_and(|end| matches(after, end)))
        }),
    }
}

/// Whether a file computes or decides: a formula or source in its header, or more than a few lines
/// with loops, choices or arithmetic.
fn needs_entry(text: &str) -> Result<bool> {
    let mut header = text.lines().take_while(|line| line.starts_with("//!"));
    if header.any(|line| ["//! Formula ", "//! Source "].iter().any(|s| line.starts_with(s))) {
        return Ok(true);
    }
    if text.lines().count() <= SHORT_ENOUGH {
        return Ok(false);
    }
    let mut work = Work { count: 0 };
    work.visit_file(&syn::parse_file(text)?);
    Ok(work.count > MOST_WORK)
}

/// A file with no more loops, choices and operations than these only carries data.
const MOST_WORK: usize = 5;

/// Counts loops, choices and arithmetic.
struct Work {
    count: usize,
}

impl<'ast> Visit<'ast> for Work {
    fn visit_item_mod(&mut self, item: &'ast syn::ItemMod) {
        if item.ident != "tests" {
            visit::visit_item_mod(self, item);
        }
    }

    fn visit_expr(&mut self, expression: &'ast syn::Expr) {
        use syn::Expr::{Binary, ForLoop, If, Loop, Match, While};
        if matches!(expression, Binary(_) | ForLoop(_) | If(_) | Loop(_) | Match(_) | While(_)) {
            self.count += 1;
        }
        visit::visit_expr(self, expression);
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::{faults, matches};

    #[test]
    fn patterns_stand_for_letters() {
        assert!(matches("damped_*", "damped_solution"));
        assert!(matches("*", ""));
        assert!(matches("a*b*c", "a__b_bc"));
        assert!(!matches("a*b", "a_c"));
        assert!(!matches("damped", "damped_solution"));
    }

    /// The faults of a crate with one source file and one file of tests.
    fn told(source: &str) -> Vec<String> {
        let root = tempfile::tempdir().unwrap();
        let it = root.path().join("tests/it");
        fs::create_dir_all(root.path().join("src")).unwrap();
        fs::create_dir_all(&it).unwrap();
        fs::write(root.path().join("src/a.rs"), source).unwrap();
        fs::write(
            it.join("laws.rs"),
            "#[test]\nfn damped_is_right() {}\nproptest! {\n    #[test]\n    fn rank_is_kept(x in \
             0..1) {}\n}\nfn helper() {}\n",
        )
        .unwrap();
        faults(root.path(), root.path()).unwrap()
    }

    #[test]
    fn entries_that_name_tests_pass() {
        let header = "//! A.\n//! Checked  tests/it/laws.rs::damped_* (to 1e-9, all), ::rank_is_kept,\n\
                      //!          tests/it/*.rs, tests/it/\n";
        assert!(told(header).is_empty(), "{:?}", told(header));
        let own = "//! Checked  tests in this file, tests::b_*\n#[cfg(test)]\nmod tests {\n    \
                   #[test]\n    fn b_c() {}\n}\n";
        assert!(told(own).is_empty(), "{:?}", told(own));
    }

    #[test]
    fn entries_that_dangle_are_told() {
        for (entry, fault) in [
            ("tests/it/laws.rs::helper", "'tests/it/laws.rs::helper', but no such test is there"),
            ("tests/it/gone.rs", "'tests/it/gone.rs', which does not exist"),
            ("tests/gone/", "'tests/gone/', which does not exist"),
            ("tests in this file", "'tests in this file', but no such test is in the file"),
            ("below", "'below', which is not a file, a folder/ or file::test"),
        ] {
            let source = format!("//! A.\n//! Checked  {entry}\n");
            assert_eq!(told(&source), [format!("src/a.rs: Checked names {fault}")]);
        }
    }

    #[test]
    fn files_that_compute_need_an_entry() {
        assert_eq!(told("//! Formula  x\n"), ["src/a.rs: no `Checked` entry"]);
        assert!(told("//! Types.\npub struct A;\n").is_empty());
        let sums = "pub fn f(x: f64) -> f64 {\n    x * x + x * x - x * x\n}\n".repeat(30);
        assert_eq!(told(&sums), ["src/a.rs: no `Checked` entry"]);
        let types = "pub struct A;\nimpl A {\n    fn a() {}\n}\n".repeat(30);
        assert!(told(&types).is_empty());
    }
}
