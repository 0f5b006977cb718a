//! The targets of coverage-guided fuzzing and their first inputs: files of the repository and of the
//! tests, messages of the book, findings.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use crate::layers::source::files;
use crate::shell::root;

/// Larger files (bytes) are no seeds: they take longer and have the same parts.
const LARGEST: u64 = 16_000;

/// Byte strings of targets that are no texts.
const STRINGS: u64 = 60;

const MESHES: &str = "crates/cylindroid/src/model/mesh_file.rs";
const VIEWER: &str = "crates/cylindroid-cli/src/viewer";
const DATA: &str = "crates/cylindroid/tests/data";
const CATALOGUE: &str = "crates/cylindroid/src/model/catalogue";
/// Those of the robots that tests read.
const ROBOTS: &str = "robots";
const ROBOSUITE: &str = "robosuite";

/// A target of the crate `fuzz`.
pub(super) struct Target {
    pub(super) name: &'static str,
    /// Folders with seeds, and their extension; none for messages and byte strings.
    folders: &'static [&'static str],
    extension: &'static str,
    /// Sources whose texts are words of the inputs.
    pub(super) words: &'static [&'static str],
    /// Length of an input [bytes].
    pub(super) longest: usize,
}

const fn files_of(
    name: &'static str,
    folders: &'static [&'static str],
    extension: &'static str,
    words: &'static [&'static str],
) -> Target {
    Target { name, folders, extension, words, longest: 16_384 }
}

const fn bytes_of(name: &'static str, words: &'static [&'static str], longest: usize) -> Target {
    Target { name, folders: &[], extension: "", words, longest }
}

pub(super) const TARGETS: [Target; 15] = [
    files_of("urdf", &[DATA, ROBOTS], "urdf", &["crates/cylindroid/src/model/formats/urdf"]),
    files_of("mjcf", &[DATA, ROBOSUITE], "xml", &["crates/cylindroid/src/model/formats/mjcf"]),
    files_of("sdf", &[DATA, ROBOTS], "sdf", &["crates/cylindroid/src/model/formats/sdf"]),
    files_of(
        "mechanism",
        &[DATA, CATALOGUE, "docs"],
        "toml",
        &["crates/cylindroid/src/model/formats/toml"],
    ),
    files_of("srdf", &[DATA, ROBOTS], "srdf", &["crates/cylindroid/src/model/formats/srdf"]),
    files_of("obj", &[DATA, "fuzz/seeds"], "obj", &[MESHES]),
    files_of("stl", &[DATA, "fuzz/seeds"], "stl", &[MESHES]),
    files_of("dae", &[DATA, "fuzz/seeds"], "dae", &["crates/cylindroid/src/model/collada.rs"]),
    files_of("csv", &["docs", "crates/cylindroid-cli/tests/data", "fuzz/seeds"], "csv", &[]),
    files_of("json", &["fuzz/seeds"], "json", &[]),
    files_of("parquet", &["fuzz/seeds"], "parquet", &[]),
    files_of("tasks", &["docs"], "toml", &["crates/cylindroid-cli/src/commands/move_to/tasks"]),
    bytes_of("messages", &[VIEWER], 4096),
    bytes_of("solver", &[], 600),
    bytes_of("servo", &[], 1200),
];

/// Writes the first inputs of a target into a folder, and nothing else.
///
/// # Errors
/// Files that cannot be read or written.
pub(super) fn write(target: &Target, robots: &Path, to: &Path) -> Result<()> {
    if to.exists() {
        fs::remove_dir_all(to)?;
    }
    fs::create_dir_all(to)?;
    let mut inputs: Vec<Vec<u8>> = match target.name {
        "messages" => messages()?,
        "solver" | "servo" => (0..STRINGS).map(byte_string).collect(),
        _ => Vec::new(),
    };
    let folder = |name: &str| match name {
        ROBOTS => robots.to_owned(),
        ROBOSUITE => robots.join("../../../../robosuite/models/assets"),
        name => root().join(name),
    };
    let mut sources: Vec<PathBuf> = Vec::new();
    for name in target.folders {
        sources.extend(files(&folder(name), &[target.extension])?);
    }
    // What was found for targets without files of their own.
    let findings = root().join(DATA).join("findings").join(target.name);
    if findings.is_dir() {
        for entry in fs::read_dir(findings)? {
            sources.push(entry?.path());
        }
    }
    for path in sources {
        if path.metadata()?.len() <= LARGEST {
            inputs.push(fs::read(path)?);
        }
    }
    for (i, input) in inputs.iter().enumerate() {
        fs::write(to.join(format!("{i:04}")), input)?;
    }
    Ok(())
}

/// The examples of the protocol, for each of the two models: each alone, and a few together.
fn messages() -> Result<Vec<Vec<u8>>> {
    let page = fs::read_to_string(root().join("docs/viewer.md"))?;
    let (_, page) = page.split_once("## Messages of the client").context("docs/viewer.md")?;
    let (page, _) = page.split_once("## Messages of the server").context("docs/viewer.md")?;
    let examples: Vec<&str> = page.lines().filter(|l| l.starts_with("{\"type\"")).collect();
    let groups = examples.chunks(1).chain(examples.chunks(6));
    let both = groups.flat_map(|group| ["0", "1"].map(|model| (model, group.join("\n"))));
    Ok(both.map(|(model, text)| format!("{model}{text}").into_bytes()).collect())
}

/// Bytes of `SplitMix64`.
fn byte_string(seed: u64) -> Vec<u8> {
    let mut state = seed;
    let one = |_| {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z >> 56) as u8
    };
    (0..16 * (1 + seed)).map(one).collect()
}
