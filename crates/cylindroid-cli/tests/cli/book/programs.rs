//! Tests, benchmarks and examples that a page tells its reader to run.

use std::fs;
use std::path::Path;

use super::pages;
use crate::documents::ROOT;

/// What follows a flag of cargo on a line of a page: the program, and the filter of its tests.
fn named<'a>(page: &'a str, flag: &str) -> Vec<(&'a str, Option<&'a str>)> {
    let rests = page.split(flag).skip(1);
    let lines = rests.filter_map(|rest| rest.split(['`', '\n', ')']).next());
    lines
        .filter_map(|line| {
            let mut words = line.split_whitespace();
            Some((words.next()?, words.find(|word| !word.starts_with('-'))))
        })
        .collect()
}

/// `module::test` of all functions below a file or folder of tests.
fn functions(path: &Path, module: &str, found: &mut Vec<String>) {
    if path.is_dir() {
        for entry in fs::read_dir(path).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_stem().unwrap().to_string_lossy().into_owned();
            let below =
                if name == "main" { module.to_owned() } else { format!("{module}{name}::") };
            functions(&path, &below, found);
        }
    } else if path.extension().is_some_and(|e| e == "rs") {
        let text = fs::read_to_string(path).unwrap();
        let lines = text.lines().filter_map(|line| line.trim_start().strip_prefix("fn "));
        let names = lines.filter_map(|line| line.split(['(', '<']).next());
        found.extend(names.map(|name| format!("{module}{name}")));
    }
}

#[test]
fn programs_and_tests_of_pages_are_there() {
    let root = Path::new(ROOT).canonicalize().unwrap();
    let crates: Vec<_> = fs::read_dir(root.join("crates")).unwrap().map(|e| e.unwrap()).collect();
    let in_crates = |path: &str| {
        crates
            .iter()
            .map(|folder| folder.path().join(path))
            .filter(|path| path.exists())
            .collect::<Vec<_>>()
    };
    let (mut all, mut count) = (pages(), 0);
    all.extend(["ARCHITECTURE.md", "CONTRIBUTING.md"].map(|name| root.join(name)));
    for path in all {
        let (page, place) = (fs::read_to_string(&path).unwrap(), path.display());
        for (program, filter) in named(&page, "--test ") {
            let mut found = Vec::new();
            for tests in [format!("tests/{program}"), format!("tests/{program}.rs")] {
                in_crates(&tests).iter().for_each(|tests| functions(tests, "", &mut found));
            }
            assert!(!found.is_empty(), "{place} runs the tests {program}, which are not there");
            if let Some(filter) = filter {
                let is_there = found.iter().any(|name| name.contains(filter));
                assert!(is_there, "{place} runs {filter} of the tests {program}: no such test");
            }
            count += 1;
        }
        for (flag, folder) in [("--bench ", "benches"), ("--example ", "examples")] {
            for (program, _) in named(&page, flag) {
                let file = format!("{folder}/{program}.rs");
                assert!(!in_crates(&file).is_empty(), "{place} runs {file}, which is not there");
                count += 1;
            }
        }
    }
    assert!(count > 10, "{count} programs");
}
