//! Real files, mutated at random with fixed seeds: every reader gives a model, or an error; what was
//! read can be used.
//!
//! Without `CYLINDROID_FUZZ_SECONDS` a few mutations of each format; with it as many as the time
//! allows, from `CYLINDROID_FUZZ_SEED` on. `cargo xtask fuzz` sets both. A file that panics is
//! written to the folder of temporary files of the tests; once mended, it belongs to
//! `tests/data/findings`, whose files are read by every run.

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::mutation::{Random, mutate};
use crate::robots;
use crate::use_of_files::{mesh, model, semantics};

/// Mutations of each format without `CYLINDROID_FUZZ_SECONDS`.
const FEW: u64 = 2000;

/// Larger files (bytes) are not mutated: they take longer and have the same parts.
const LARGEST: u64 = 24_000;

/// The files below a folder with one of these extensions, small ones, in a fixed order.
fn files(folder: &Path, extensions: &[&str], found: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> =
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        if path.is_dir() {
            files(&path, extensions, found);
        } else if extension.is_some_and(|e| extensions.contains(&e.as_str()))
            && path.metadata().unwrap().len() <= LARGEST
        {
            found.push(path);
        }
    }
}

/// The seeds of a run.
fn seeds() -> impl Iterator<Item = u64> {
    let number = |name: &str| std::env::var(name).ok().map(|text| text.parse::<u64>().unwrap());
    let seconds = number("CYLINDROID_FUZZ_SECONDS");
    let first = number("CYLINDROID_FUZZ_SEED").unwrap_or(0);
    let start = Instant::now();
    (first..).take_while(move |seed| match seconds {
        None => seed - first < FEW,
        Some(seconds) => start.elapsed() < Duration::from_secs(seconds),
    })
}

/// Reads mutations of the files below the folders with `read`, as files of the same extension.
fn feed(folders: &[PathBuf], extensions: &[&str], read: impl Fn(&Path) -> bool) {
    let mut sources = Vec::new();
    folders.iter().for_each(|folder| files(folder, extensions, &mut sources));
    assert!(sources.len() >= 3, "{} files in {folders:?}", sources.len());
    let texts: Vec<Vec<u8>> = sources.iter().map(|path| fs::read(path).unwrap()).collect();
    let folder = tempfile::tempdir().unwrap();
    let (mut accepted, mut rounds) = (0, 0);
    for seed in seeds() {
        rounds += 1;
        let mut random = Random(seed);
        let (i, k) = (random.below(sources.len()), random.below(sources.len()));
        let mut bytes = texts[i].clone();
        mutate(&mut bytes, &texts[k], &mut random);
        let name = format!("mutated.{}", sources[i].extension().unwrap().to_string_lossy());
        let path = folder.path().join(name);
        fs::write(&path, &bytes).unwrap();
        match catch_unwind(AssertUnwindSafe(|| read(&path))) {
            Ok(is_read) => accepted += u64::from(is_read),
            Err(_) => {
                let finding =
                    format!("finding-{seed}-{}", sources[i].file_name().unwrap().display());
                let finding = Path::new(env!("CARGO_TARGET_TMPDIR")).join(finding);
                fs::write(&finding, &bytes).unwrap();
                panic!("seed {seed} of {}: {} panics", sources[i].display(), finding.display());
            }
        }
    }
    println!("{rounds} mutations of {extensions:?}, {accepted} were read");
    // Both ways were taken.
    assert!(accepted > rounds / 100 && accepted < rounds, "{accepted} of {rounds} were read");
}

fn own(folder: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)
}

/// Files that made a reader or a solver fail once.
#[test]
fn findings_stay_mended() {
    let findings = own("tests/data/findings");
    let panda = cylindroid::catalogue::load("panda").unwrap();
    let found = |extensions: &[&str], read: &dyn Fn(&Path) -> bool| {
        let mut sources = Vec::new();
        files(&findings, extensions, &mut sources);
        sources.iter().map(|path| read(path)).collect::<Vec<bool>>()
    };
    let models = found(&["toml", "urdf", "sdf", "xml"], &model);
    assert!(models.contains(&true) && models.contains(&false), "{models:?}");
    found(&["srdf"], &|path| semantics(path, &panda));
    let meshes = found(&["obj", "stl", "dae"], &mesh);
    assert!(meshes.contains(&true), "{meshes:?}");
}

#[test]
fn mutated_urdfs() {
    feed(&[robots()], &["urdf"], model);
}

#[test]
fn mutated_mjcf() {
    let robosuite = robots().join("../../../../robosuite/models/assets");
    feed(&[robosuite, own("tests/data")], &["xml"], model);
}

#[test]
fn mutated_sdf() {
    // The extension decides nothing: the root element does.
    feed(&[robots(), own("tests/data")], &["sdf", "toml", "urdf"], model);
}

#[test]
fn mutated_mechanism_files() {
    feed(&[own("src/model/catalogue"), own("tests/data")], &["toml"], model);
}

#[test]
fn mutated_srdf() {
    let panda = cylindroid::catalogue::load("panda").unwrap();
    feed(&[robots()], &["srdf"], |path| semantics(path, &panda));
}

#[test]
fn mutated_meshes() {
    feed(&[own("../../fuzz/seeds"), robots()], &["stl", "dae", "obj"], mesh);
}
