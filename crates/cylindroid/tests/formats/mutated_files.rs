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

use cylindroid::collision::{CollisionModel, CollisionOptions, distance};
use cylindroid::model::Geometry;
use cylindroid::model::formats::srdf;
use cylindroid::{Mechanism, Pose, Vec3, load_file};

use crate::robots;

/// Mutations of each format without `CYLINDROID_FUZZ_SECONDS`.
const FEW: u64 = 2000;

/// Larger files (bytes) are not mutated: they take longer and have the same parts.
const LARGEST: u64 = 24_000;

/// Words that mean something to a reader.
const WORDS: [&str; 36] = [
    "nan",
    "inf",
    "-inf",
    "1e308",
    "-1e308",
    "1e-320",
    "1e120",
    "0",
    "-0.0",
    "18446744073709551616",
    "-1",
    "\"",
    "'",
    "<",
    ">",
    "/>",
    "<!--",
    "-->",
    "<![CDATA[",
    "]]>",
    "<?",
    "&#0;",
    "&lt;",
    "\0",
    "\u{fffd}",
    "\u{feff}",
    "name=\"\"",
    "<a>",
    "</a>",
    "[[joint]]\n",
    "[dh]\n",
    "= [",
    "]",
    "{",
    "\r\n",
    "\u{202e}",
];

struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Below `n`; 0 for 0.
    fn below(&mut self, n: usize) -> usize {
        (self.next() % n.max(1) as u64) as usize
    }

    /// A range of at most `longest`, more often a short one.
    fn range(&mut self, length: usize, longest: usize) -> std::ops::Range<usize> {
        let start = self.below(length + 1);
        let longest = 1 + self.below(longest);
        start..(start + self.below(longest + 1)).min(length)
    }
}

/// One to four changes: bytes, numbers, words, and parts removed, doubled, moved or taken from
/// another file.
fn mutate(bytes: &mut Vec<u8>, other: &[u8], random: &mut Random) {
    for _ in 0..=random.below(4) {
        let part = random.range(bytes.len(), 300);
        match random.below(9) {
            0 if !bytes.is_empty() => {
                let at = random.below(bytes.len());
                bytes[at] ^= 1 << random.below(8);
            }
            1 if !bytes.is_empty() => {
                let at = random.below(bytes.len());
                bytes[at] = random.next() as u8;
            }
            2 => {
                let word = WORDS[random.below(WORDS.len())];
                bytes.splice(part.start..part.start, word.bytes());
            }
            // A number becomes a word.
            3 => {
                let is_number = |b: &u8| b.is_ascii_digit() || b"+-.eE".contains(b);
                let from = bytes[part.start..].iter().position(u8::is_ascii_digit);
                let Some(from) = from.map(|i| part.start + i) else { continue };
                let length = bytes[from..].iter().take_while(|b| is_number(b)).count();
                let word = WORDS[random.below(WORDS.len())];
                bytes.splice(from..from + length, word.bytes());
            }
            4 => drop(bytes.drain(part)),
            5 => {
                let copy = bytes[part.clone()].repeat(1 + random.below(3));
                bytes.splice(part.end..part.end, copy);
            }
            6 => {
                let moved: Vec<u8> = bytes.drain(part).collect();
                let to = random.below(bytes.len() + 1);
                bytes.splice(to..to, moved);
            }
            7 => {
                let from = random.range(other.len(), 300);
                bytes.splice(part, other[from].iter().copied());
            }
            _ => bytes.truncate(bytes.len() - random.below(bytes.len().min(300))),
        }
    }
}

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

/// Loads a model and uses it.
fn model(path: &Path) -> bool {
    match load_file(path) {
        Ok(robot) => {
            exercise(&robot);
            true
        }
        Err(error) => {
            let message = error.to_string();
            assert!(!message.is_empty() && message.len() < 5000, "{message}");
            false
        }
    }
}

fn exercise(robot: &Mechanism) {
    assert!(robot.home().iter().all(|x| x.is_finite()));
    let state = robot.state(robot.home()).unwrap();
    let tool = robot.tool();
    let pose = state.pose(tool);
    assert!(pose.translation.is_finite(), "{pose:?}");
    let moved = robot.integrate(robot.home(), &vec![0.1; robot.n()], 0.1).unwrap();
    assert!(robot.state(&moved).unwrap().pose(tool).translation.is_finite());
    let _ = cylindroid::ik::Analytic::of(robot, tool);
    let options = CollisionOptions { samples: 0, ..CollisionOptions::default() };
    if let Ok(mut model) = CollisionModel::new(robot, &options) {
        let _ = model.near(&state, 0.1, &mut Vec::new());
    }
}

fn own(folder: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)
}

/// Files that made a reader or a solver fail once.
#[test]
fn findings_stay_mended() {
    let mut sources = Vec::new();
    files(&own("tests/data/findings"), &["toml", "urdf", "sdf", "xml"], &mut sources);
    let read: Vec<bool> = sources.iter().map(|path| model(path)).collect();
    assert!(read.contains(&true) && read.contains(&false), "{sources:?} {read:?}");
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
    feed(&[robots()], &["srdf"], |path| match srdf::load(path) {
        Ok(srdf) => {
            let _ = srdf.pairs(&panda);
            true
        }
        Err(_) => false,
    });
}

#[test]
fn mutated_meshes() {
    let folder = tempfile::tempdir().unwrap();
    let corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1/1/1 2/2/2 4/4/4\n";
    fs::write(folder.path().join("a.obj"), corners.repeat(5)).unwrap();
    let ascii = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1.5 0 0\nvertex 0 -2 1\n\
                 endloop\nendfacet\n";
    fs::write(folder.path().join("b.stl"), format!("solid b\n{}endsolid", ascii.repeat(6)))
        .unwrap();
    let dae = r##"<COLLADA><asset><unit meter="0.001"/></asset><library_geometries>
        <geometry id="g"><mesh><source id="p"><float_array count="12">0 0 0 1 2 3 4 0 1 0 5 1
        </float_array><technique_common><accessor source="#f" count="4" stride="3"/>
        </technique_common></source><vertices><input semantic="POSITION" source="#p"/></vertices>
        </mesh></geometry></library_geometries><library_visual_scenes><visual_scene>
        <node><matrix>1 0 0 1 0 1 0 2 0 0 1 3 0 0 0 1</matrix><node><rotate>0 0 1 90</rotate>
        <instance_geometry url="#g"/></node></node></visual_scene></library_visual_scenes>
        </COLLADA>"##;
    fs::write(folder.path().join("c.dae"), dae).unwrap();
    let ball = Geometry::Sphere { radius: 0.1 };
    let away = Pose::from_translation(Vec3::new(3.0, 0.2, 0.1));
    feed(&[folder.path().to_owned(), robots()], &["stl", "dae", "obj"], |path| {
        let scale = Vec3::new(1.0, 1.0, 1.0);
        let mesh = Geometry::Mesh { uri: String::new(), path: Some(path.to_owned()), scale };
        match distance((&mesh, Pose::IDENTITY), (&ball, away)) {
            Ok(found) => {
                assert!(found.distance.is_finite() && found.normal.is_finite(), "{found:?}");
                true
            }
            Err(_) => false,
        }
    });
}
