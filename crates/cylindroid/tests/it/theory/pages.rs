//! The chapters of docs/theory name tests that exist, and label every erratum that they list.
//!
//! Places are written as in the `Checked` entries of the sources: `tests/it/file.rs::name`, with
//! `*` for any letters, `tests/it/file.rs` or `tests/it/folder/`.

use std::fs;
use std::path::{Path, PathBuf};

const CRATE: &str = env!("CARGO_MANIFEST_DIR");

fn chapters() -> Vec<(PathBuf, String)> {
    let folder = Path::new(CRATE).join("../../docs/theory");
    let mut pages: Vec<PathBuf> = fs::read_dir(&folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|end| end == "md"))
        .collect();
    pages.sort();
    pages.into_iter().map(|path| (path.clone(), fs::read_to_string(path).unwrap())).collect()
}

/// Places between backticks, each with its line.
fn places(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let lines = text.lines().enumerate();
    lines.flat_map(|(i, line)| {
        let quoted = line.split('`').skip(1).step_by(2);
        quoted.filter(|q| q.starts_with("tests/")).map(move |place| (i + 1, place))
    })
}

/// Whether a name fits a pattern with `*`.
fn matches(pattern: &str, name: &str) -> bool {
    match pattern.split_once('*') {
        None => pattern == name,
        Some((before, after)) => name.strip_prefix(before).is_some_and(|rest| {
            rest.char_indices()
                .map(|(start, _)| start)
                .chain([rest.len()])
                .any(|start| matches(after, &rest[start..]))
        }),
    }
}

/// Names of functions that follow `#[test]`.
fn tests_in(text: &str) -> Vec<&str> {
    let mut follows = false;
    let mut names = Vec::new();
    for line in text.lines().map(str::trim) {
        if line == "#[test]" {
            follows = true;
        } else if let Some(rest) = line.strip_prefix("fn ").filter(|_| follows) {
            names.extend(rest.split(|c: char| !c.is_alphanumeric() && c != '_').next());
            follows = false;
        }
    }
    names
}

fn has_tests(folder: &Path) -> bool {
    fs::read_dir(folder).is_ok_and(|entries| {
        entries.map(|entry| entry.unwrap().path()).any(|path| {
            path.is_dir() && has_tests(&path)
                || fs::read_to_string(&path).is_ok_and(|text| !tests_in(&text).is_empty())
        })
    })
}

/// Why there is no such test; `None` if there is one.
fn fault(place: &str) -> Option<String> {
    let (path, pattern) = place.split_once("::").unwrap_or((place, "*"));
    let file = Path::new(CRATE).join(path);
    if path.ends_with('/') {
        return (!has_tests(&file)).then(|| format!("no folder {path} with tests"));
    }
    let Ok(text) = fs::read_to_string(&file) else {
        return Some(format!("no file {path}"));
    };
    let found = tests_in(&text).into_iter().any(|name| matches(pattern, name));
    (!found).then(|| format!("no test {pattern} in {path}"))
}

#[test]
fn tests_named_in_the_chapters_exist() {
    let mut faults = Vec::new();
    let mut named = 0;
    for (path, text) in chapters() {
        for (line, place) in places(&text) {
            named += 1;
            let page = path.file_name().unwrap().display();
            faults.extend(fault(place).map(|why| format!("docs/theory/{page}:{line}: {why}")));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(named > 40, "the chapters name only {named} tests");
}

/// Labels such as S9 or C3, at the start of a paragraph in bold and at the start of a row.
#[test]
fn every_erratum_has_a_row_and_every_row_a_test() {
    for (path, text) in chapters() {
        let label = |rest: &str| {
            let end = rest.find(|c: char| !c.is_ascii_alphanumeric()).unwrap_or(0);
            let found = &rest[..end];
            let is_label = found.starts_with(|c: char| c.is_ascii_uppercase())
                && found[1..].starts_with(|c: char| c.is_ascii_digit());
            is_label.then(|| found.to_owned())
        };
        let starting = |start: &str| -> Vec<String> {
            let lines = text.lines().filter_map(|line| line.strip_prefix(start));
            let mut labels: Vec<String> = lines.filter_map(label).collect();
            labels.sort();
            labels
        };
        assert_eq!(starting("**"), starting("| "), "{}", path.display());
        for line in text.lines().filter(|line| line.strip_prefix("| ").and_then(label).is_some()) {
            assert!(places(line).next().is_some(), "{}: no test in {line}", path.display());
        }
    }
}

/// The other way round: a test of an erratum belongs to a chapter.
#[test]
fn every_test_of_an_erratum_is_named_in_a_chapter() {
    let chapters: String = chapters().into_iter().map(|(_, text)| text).collect();
    for entry in fs::read_dir(Path::new(CRATE).join("tests/it/theory")).unwrap() {
        let path = entry.unwrap().path();
        let text = fs::read_to_string(&path).unwrap();
        let file = path.file_name().unwrap().to_str().unwrap();
        for name in tests_in(&text).into_iter().filter(|name| name.starts_with("erratum_")) {
            let place = format!("tests/it/theory/{file}::{name}`");
            assert!(chapters.contains(&place), "no chapter names `{place}");
        }
    }
}

#[test]
fn places_that_dangle_are_told() {
    assert_eq!(fault("tests/it/theory/pages.rs::places_that_*_told"), None);
    assert_eq!(fault("tests/it/theory/"), None);
    for place in ["tests/it/theory/pages.rs::gone", "tests/it/gone.rs", "tests/gone/"] {
        assert!(fault(place).is_some(), "{place}");
    }
    let text = "a `tests/a.rs` b\n`x` `tests/b.rs::c`";
    assert_eq!(places(text).collect::<Vec<_>>(), [(1, "tests/a.rs"), (2, "tests/b.rs::c")]);
    assert_eq!(tests_in("#[test]\nfn a() {}\nfn b() {}\n"), ["a"]);
    assert!(matches("a_*_c", "a_b_c") && !matches("a_*_c", "a_b_d"));
}
