//! Mutated command lines: an exit code of 0, 1 or 2, one message with 2, JSON with `--json`, within
//! a time and 4 GB.
#![cfg(unix)]

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use super::{Random, TEXTS, mutate_text, seeds};
use crate::documents::{ROOT, commands, examples};

/// Command lines without `CYLINDROID_FUZZ_SECONDS`.
const FEW: u64 = 100;

const LONGEST: Duration = Duration::from_secs(60);

/// Files that the examples read.
const FILES: [&str; 4] =
    ["docs/grasp.toml", "docs/cell.toml", "docs/tasks.toml", "docs/goals.toml"];

/// Flags of a command, as its help lists them.
fn flags(help: &str) -> Vec<String> {
    let words = help.split(|c: char| c.is_whitespace() || ",[]=".contains(c));
    let flags: BTreeSet<&str> =
        words.filter(|word| word.len() > 3 && word.starts_with("--")).collect();
    flags.into_iter().map(str::to_owned).collect()
}

/// Runs it in `folder` with bounded memory, and stops it after [`LONGEST`].
fn run(folder: &Path, words: &[String]) -> Option<Output> {
    let limited = "ulimit -v 4000000; exec \"$0\" \"$@\"";
    let (out, err) = (folder.join("stdout"), folder.join("stderr"));
    let mut child = Command::new("sh")
        .args(["-c", limited, env!("CARGO_BIN_EXE_cylindroid")])
        .args(words)
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(fs::File::create(&out).unwrap())
        .stderr(fs::File::create(&err).unwrap())
        .spawn()
        .unwrap();
    let start = Instant::now();
    while start.elapsed() < LONGEST {
        if let Some(status) = child.try_wait().unwrap() {
            let [stdout, stderr] = [out, err].map(|path| fs::read(path).unwrap());
            return Some(Output { status, stdout, stderr });
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    None
}

fn mutate(words: &mut Vec<String>, other: &[String], flags: &[String], random: &mut Random) {
    let at = random.below(words.len() + 1);
    match random.below(8) {
        0 if at < words.len() => drop(words.remove(at)),
        1 if at < words.len() => words[at] = TEXTS[random.below(TEXTS.len())].to_owned(),
        2 if at < words.len() => words[at] = mutate_text(&words[at], random),
        3 => words.insert(at, flags[random.below(flags.len())].clone()),
        4 => {
            let value = TEXTS[random.below(TEXTS.len())].to_owned();
            words.splice(at..at, [flags[random.below(flags.len())].clone(), value]);
        }
        5 => words.push("--json".to_owned()),
        // One number of a list.
        6 if at < words.len() => {
            let mut numbers: Vec<&str> = words[at].split(',').collect();
            let (i, value) = (random.below(numbers.len()), TEXTS[random.below(TEXTS.len())]);
            numbers[i] = value;
            words[at] = numbers.join(",");
        }
        _ => {
            let from = random.below(other.len() + 1);
            let count = random.below(3);
            words.splice(at..at, other[from..].iter().take(count).cloned());
        }
    }
}

#[test]
fn mutated_command_lines() {
    let commands: Vec<String> = commands();
    let mut pages = vec![fs::read_to_string(format!("{ROOT}/README.md")).unwrap()];
    pages.push(fs::read_to_string(format!("{ROOT}/docs/command-line.md")).unwrap());
    let helps: Vec<String> = commands.iter().map(|c| crate::text(&[c, "--help"])).collect();
    pages.extend(helps.clone());
    let lines: BTreeSet<String> = pages.iter().flat_map(|page| examples(page, &commands)).collect();
    let lines: Vec<Vec<String>> = lines
        .iter()
        .map(|line| line.split_whitespace().map(str::to_owned).collect::<Vec<_>>())
        // It serves until it is stopped; `view::fuzz` has its messages.
        .filter(|words| words[0] != "view")
        .collect();
    assert!(lines.len() > 30, "{lines:?}");
    let folder = tempfile::tempdir().unwrap();
    let mut codes = [0_u64; 3];
    for seed in seeds(FEW) {
        let work = tempfile::tempdir_in(&folder).unwrap();
        fs::create_dir(work.path().join("docs")).unwrap();
        for file in FILES {
            fs::copy(Path::new(ROOT).join(file), work.path().join(file)).unwrap();
        }
        let mut random = Random(seed);
        let mut words = lines[random.below(lines.len())].clone();
        let other = &lines[random.below(lines.len())];
        let place = commands.iter().position(|c| *c == words[0]).unwrap();
        let flags =
            flags(&helps[if random.below(8) > 0 { place } else { random.below(helps.len()) }]);
        for _ in 0..=random.below(3) {
            mutate(&mut words, other, &flags, &mut random);
        }
        words.retain(|word| !word.contains('\0'));
        if words.first().is_some_and(|word| word == "view") {
            continue;
        }
        let Some(output) = run(work.path(), &words) else {
            panic!("seed {seed}: {words:?} takes longer than {LONGEST:?}");
        };
        let stderr = String::from_utf8_lossy(&output.stderr);
        let what = format!("seed {seed}: {words:?}: {} {stderr}", output.status);
        assert!(!stderr.contains("panicked"), "{what}");
        let Some(code @ 0..=2) = output.status.code() else { panic!("{what}") };
        assert_eq!(code == 2, !stderr.is_empty() && output.stdout.is_empty(), "{what}");
        let is_json = words.iter().any(|word| word == "--json");
        let asks = |word: &String| {
            word.starts_with("-h")
                || word.starts_with("-V")
                || word == "help"
                || ["--help", "--version"].contains(&word.as_str())
        };
        if code < 2 && is_json && !words.iter().any(asks) {
            let value = serde_json::from_slice::<serde_json::Value>(&output.stdout);
            assert!(value.is_ok(), "{what}");
        }
        codes[code as usize] += 1;
    }
    // Negative answers are rare: a hundred lines may have none.
    assert!(codes[0] > 0 && codes[2] > 0, "{codes:?}");
}
