//! The book against the binary: every command of a page runs and prints what the page shows, and
//! links lead somewhere.
//!
//! A ```` ```sh ```` block may be followed by a ```` ```text ```` block, which is what its commands
//! print. A comment `# exit code 1` at the end of a command announces a negative answer, and
//! `| head -n N` or `| tail -n N` keeps the first or last lines. A block that begins with the comment `# NAME.toml` or
//! `<!-- NAME.urdf -->` is a file that commands read. `cargo xtask book --outputs` writes what
//! commands print into the pages.

mod linkages;
mod programs;

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::closed::robots;
use crate::documents::ROOT;

/// Set by `cargo xtask book --outputs`.
const WRITE: &str = "CYLINDROID_WRITE_BOOK";
/// Stands for any URDF.
const URDF: &str = "path/to/ur5_robot.urdf";
/// Numbers below this are rounding, which differs from processor to processor.
const ROUNDING: f64 = 1e-9;
const DIGITS: f64 = 1e-4;

/// A fenced block: the lines between its fences, first and one past the last.
struct Block {
    language: String,
    lines: (usize, usize),
}

fn blocks(page: &[&str]) -> Vec<Block> {
    let (mut found, mut open) = (Vec::new(), None::<(String, String, usize)>);
    for (number, line) in page.iter().enumerate() {
        let fence: String = line.chars().take_while(|&c| c == '`').collect();
        match &open {
            None if fence.len() > 2 => {
                open = Some((fence.clone(), line[fence.len()..].trim().to_owned(), number + 1));
            }
            Some((begin, language, first)) if line.trim_end() == begin => {
                found.push(Block { language: language.clone(), lines: (*first, number) });
                open = None;
            }
            _ => {}
        }
    }
    assert!(open.is_none(), "a block is not closed");
    found
}

fn markdown_in(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            markdown_in(&path, found);
        } else if path.extension().is_some_and(|e| e == "md") {
            found.push(path);
        }
    }
}

/// The README and the pages of the book.
fn pages() -> Vec<PathBuf> {
    let root = Path::new(ROOT).canonicalize().unwrap();
    let mut found = vec![root.join("README.md")];
    markdown_in(&root.join("docs"), &mut found);
    found.sort();
    found
}

/// The name of the file that a block is, by its first line.
fn file_name(first: &str) -> Option<&str> {
    let comment = first
        .strip_prefix("# ")
        .or_else(|| first.strip_prefix("<!-- ").and_then(|rest| rest.strip_suffix(" -->")))?;
    let is_name = comment.contains('.') && !comment.contains([' ', '/']) && !comment.ends_with('.');
    is_name.then_some(comment)
}

struct Line<'a> {
    arguments: &'a str,
    code: i32,
    /// `| head -n N` or `| tail -n N`.
    kept: Kept,
}

enum Kept {
    All,
    Head(usize),
    Tail(usize),
}

fn command(line: &str) -> Option<Line<'_>> {
    let typed = line.strip_prefix("cylindroid ")?;
    let (typed, comment) = typed.split_once("  #").unwrap_or((typed, ""));
    let (arguments, pipe) = typed.split_once(" | ").unwrap_or((typed, ""));
    let kept = match pipe.trim().split_once(" -n ") {
        None => Kept::All,
        Some(("head", n)) => Kept::Head(n.parse().unwrap()),
        Some((end, n)) => {
            assert_eq!(end, "tail", "{line}: | head -n N or | tail -n N");
            Kept::Tail(n.parse().unwrap())
        }
    };
    let code = i32::from(comment.contains("exit code 1"));
    Some(Line { arguments: arguments.trim(), code, kept })
}

fn run(line: &Line<'_>, folder: &Path, page: &Path) -> String {
    let mut words = line.arguments.to_owned();
    if words.contains(URDF) {
        let urdf = robots().join("ur_description/urdf/ur5_robot.urdf");
        words = words.replace(URDF, &urdf.to_string_lossy());
    }
    // It serves until it is stopped; --check stops it when it could.
    if words.starts_with("view ") && !words.contains("--check") {
        words.push_str(" --check");
    }
    let output = Command::new(env!("CARGO_BIN_EXE_cylindroid"))
        .args(words.split_whitespace())
        .current_dir(folder)
        .output()
        .unwrap();
    let place = format!("{}: cylindroid {}", page.display(), line.arguments);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(line.code), "{place}: {stderr}");
    let printed = String::from_utf8(output.stdout).unwrap();
    let lines: Vec<&str> = printed.lines().collect();
    let lines = match line.kept {
        Kept::All => &lines[..],
        Kept::Head(n) => &lines[..n.min(lines.len())],
        Kept::Tail(n) => &lines[lines.len().saturating_sub(n)..],
    };
    let mut kept = String::new();
    for line in lines {
        writeln!(kept, "{}", line.trim_end()).unwrap();
    }
    kept
}

/// Words of a text; lines of tables are drawn as wide as their columns and are none.
fn words(text: &str) -> Vec<&str> {
    text.split_whitespace().filter(|word| !word.trim_matches('-').is_empty()).collect()
}

/// Equal, or lists of numbers that differ by rounding.
fn alike(shown: &str, printed: &str) -> bool {
    let same = |(a, b): (&str, &str)| {
        let number = |word: &str| word.trim_matches([';', '(', ')']).parse::<f64>();
        match (number(a), number(b)) {
            (Ok(x), Ok(y)) => (x - y).abs() <= (DIGITS * x.abs().max(y.abs())).max(ROUNDING),
            _ => false,
        }
    };
    shown == printed
        || (shown.split(',').count() == printed.split(',').count()
            && shown.split(',').zip(printed.split(',')).all(|(a, b)| a == b || same((a, b))))
}

fn differ(shown: &str, printed: &str) -> Option<String> {
    let (shown, printed) = (words(shown), words(printed));
    if shown.len() != printed.len() {
        return Some(format!("{} words, not {}", printed.len(), shown.len()));
    }
    let odd = shown.iter().zip(&printed).find(|(a, b)| !alike(a, b))?;
    Some(format!("'{}', not '{}'", odd.1, odd.0))
}

#[test]
fn commands_run_and_print_what_the_pages_show() {
    let mut count = 0;
    for path in pages() {
        let text = fs::read_to_string(&path).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("docs")).unwrap();
        for entry in fs::read_dir(Path::new(ROOT).join("docs")).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|e| e == "toml") {
                let copy = folder.path().join("docs").join(path.file_name().unwrap());
                fs::copy(&path, copy).unwrap();
            }
        }
        let found = blocks(&lines);
        let mut written = Vec::new();
        for (i, block) in found.iter().enumerate() {
            let (first, end) = block.lines;
            if let Some(name) = lines.get(first).and_then(|line| file_name(line)) {
                let body = lines[first..end].join("\n") + "\n";
                fs::write(folder.path().join(name), body).unwrap();
            }
            if block.language != "sh" {
                continue;
            }
            let mut printed = String::new();
            for line in lines[first..end].iter().filter_map(|line| command(line)) {
                printed += &run(&line, folder.path(), &path);
                count += 1;
            }
            let Some(next) = found.get(i + 1).filter(|next| next.language == "text") else {
                continue;
            };
            // One empty line between them.
            if next.lines.0 != end + 3 || printed.is_empty() {
                continue;
            }
            let shown = lines[next.lines.0..next.lines.1].join("\n");
            if let Some(how) = differ(&shown, &printed) {
                let place = format!("{}, line {}", path.display(), next.lines.0);
                assert!(
                    std::env::var_os(WRITE).is_some(),
                    "{place}: the command prints {how}; \
                    'cargo xtask book --outputs' writes what it prints into the page"
                );
                written.push((next.lines, printed));
            }
        }
        if !written.is_empty() {
            fs::write(&path, with_outputs(&lines, &written)).unwrap();
        }
    }
    assert!(count > 60, "{count} commands");
}

fn with_outputs(lines: &[&str], outputs: &[((usize, usize), String)]) -> String {
    let (mut text, mut next) = (String::new(), 0);
    for ((first, end), printed) in outputs {
        text.extend(lines[next..*first].iter().flat_map(|line| [line, "\n"]));
        text += printed.trim_end();
        text += "\n";
        next = *end;
    }
    text.extend(lines[next..].iter().flat_map(|line| [line, "\n"]));
    text
}

/// rustdoc takes a block without a language for Rust.
#[test]
fn blocks_name_their_language_and_rust_is_compiled() {
    let library = fs::read_to_string(Path::new(ROOT).join("crates/cylindroid/src/lib.rs")).unwrap();
    for path in pages() {
        let text = fs::read_to_string(&path).unwrap();
        let found = blocks(&text.lines().collect::<Vec<_>>());
        let unnamed = found.iter().find(|block| block.language.is_empty());
        assert!(unnamed.is_none(), "{}: {:?}", path.display(), unnamed.map(|b| b.lines.0));
        let root = Path::new(ROOT).canonicalize().unwrap();
        let name = path.strip_prefix(root).unwrap().to_string_lossy().into_owned();
        if found.iter().any(|block| block.language == "rust") {
            assert!(
                library.contains(&format!("\"../../../{name}\"")),
                "lib.rs does not include {name}"
            );
        }
    }
}

/// As GitHub and MkDocs make the anchors of headings.
fn anchor(heading: &str) -> String {
    let text = heading.replace('`', "").to_lowercase();
    let kept = text.trim().chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect()
}

/// Lines of a page that are not in blocks.
fn prose(text: &str) -> Vec<&str> {
    let lines: Vec<&str> = text.lines().collect();
    let hidden: BTreeSet<usize> =
        blocks(&lines).iter().flat_map(|block| block.lines.0 - 1..=block.lines.1).collect();
    lines.iter().enumerate().filter(|(i, _)| !hidden.contains(i)).map(|(_, line)| *line).collect()
}

fn anchors(text: &str) -> BTreeSet<String> {
    let headings = prose(text).into_iter().filter(|line| line.starts_with('#'));
    headings.map(|line| anchor(line.trim_start_matches('#'))).collect()
}

/// Targets of `[text](target)`, without those in code.
fn targets(line: &str) -> Vec<&str> {
    let outside = line.split('`').step_by(2).flat_map(|part| part.split("](").skip(1));
    let after_code = line.split("](").skip(1);
    outside.chain(after_code).filter_map(|rest| rest.split([')', ' ']).next()).collect()
}

#[test]
fn links_lead_somewhere() {
    let root = Path::new(ROOT).canonicalize().unwrap();
    let project = ["ARCHITECTURE.md", "CHANGELOG.md", "CONTRIBUTING.md", "CONVENTIONS.md"];
    let (mut all, mut count) = (pages(), 0);
    all.extend(project.map(|name| root.join(name)));
    for path in all {
        let text = fs::read_to_string(&path).unwrap();
        for target in prose(&text).into_iter().flat_map(targets) {
            if target.contains("://") || target.starts_with("mailto:") {
                continue;
            }
            let (file, to) = target.split_once('#').unwrap_or((target, ""));
            let there = if file.is_empty() { path.clone() } else { path.with_file_name(file) };
            let place = path.display();
            assert!(there.exists(), "{place} leads to {target}, which is not there");
            if !to.is_empty() {
                let found = anchors(&fs::read_to_string(&there).unwrap());
                assert!(found.contains(to), "{place} leads to {target}: no such heading");
            }
            count += 1;
        }
    }
    assert!(count > 60, "{count} links");
}
