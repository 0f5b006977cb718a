//! Folders: the same bytes whatever the threads and interruptions; clear refusals.

use std::fs;
use std::path::Path;

use cylindroid::sweep::{
    Quantity, Source, Sweep, SweepOptions, WriteOptions, parquet_columns, parquet_configurations,
};
use serde_json::Value;

/// 5000 rows in 20 parts.
fn sweep(model: &str, seed: u64) -> Sweep {
    let options = SweepOptions {
        source: Source::Samples { count: 5000, seed },
        quantities: vec![Quantity::Pose, Quantity::Yoshikawa, Quantity::GibsonHunt],
        part_rows: 257,
        ..Default::default()
    };
    Sweep::new(&cylindroid::load(model).unwrap(), options).unwrap()
}

fn threads(count: usize) -> WriteOptions {
    WriteOptions { threads: count.try_into().ok(), resume: false }
}

const RESUME: WriteOptions = WriteOptions { threads: None, resume: true };

/// All bytes of all parts and the manifest.
fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut all: Vec<(String, Vec<u8>)> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .map(|path| (path.file_name().unwrap().to_str().unwrap().to_owned(), path))
        .filter(|(name, _)| name != ".lock")
        .map(|(name, path)| (name, fs::read(path).unwrap()))
        .collect();
    all.sort();
    all
}

#[test]
fn threads_change_nothing() {
    let sweep = sweep("youbot", 0);
    let folder = tempfile::tempdir().unwrap();
    let mut all = Vec::new();
    for count in [1, 2, 8] {
        let own = folder.path().join(count.to_string());
        let summary = sweep.write(&own, &threads(count), |_| true).unwrap();
        assert!(summary.complete && summary.computed == 5000 && summary.parts == 20);
        all.push(contents(&own));
    }
    assert_eq!(all[0].len(), 21);
    assert!(all[0] == all[1] && all[1] == all[2]);
}

/// A run that is stopped again and again ends with the bytes of one that is not.
#[test]
fn stopped_runs_are_resumed() {
    let sweep = sweep("youbot", 1);
    let folder = tempfile::tempdir().unwrap();
    let (whole, own) = (folder.path().join("whole"), folder.path().join("own"));
    sweep.write(&whole, &threads(2), |_| true).unwrap();
    let mut before = 0;
    for run in 0..40 {
        let mut calls = 0;
        let options = WriteOptions { threads: 1.try_into().ok(), resume: run > 0 };
        let go_on = |_: &cylindroid::sweep::Progress| {
            calls += 1;
            calls < 12 + run
        };
        let summary = sweep.write(&own, &options, go_on).unwrap();
        if summary.complete {
            break;
        }
        assert!(summary.parts >= before || summary.computed == 0);
        before = summary.parts;
        let manifest: Value =
            serde_json::from_slice(&fs::read(own.join("manifest.json")).unwrap()).unwrap();
        assert_eq!(manifest["complete"], false);
    }
    assert!(contents(&own) == contents(&whole));
    let again = sweep.write(&own, &RESUME, |_| true).unwrap();
    assert!(again.complete && again.computed == 0);
}

/// Damaged, missing and half-written files are computed again.
#[test]
fn damage_is_found() {
    let sweep = sweep("youbot", 2);
    let folder = tempfile::tempdir().unwrap();
    let own = folder.path().join("own");
    sweep.write(&own, &threads(2), |_| true).unwrap();
    let whole = contents(&own);
    let mut bytes = fs::read(own.join("part-000003.parquet")).unwrap();
    bytes[1000] ^= 1;
    fs::write(own.join("part-000003.parquet"), bytes).unwrap();
    fs::remove_file(own.join("part-000007.parquet")).unwrap();
    fs::write(own.join("part-000011.parquet"), b"PAR1").unwrap();
    fs::write(own.join(".part-000012.parquet.tmp"), b"half").unwrap();
    let summary = sweep.write(&own, &RESUME, |_| true).unwrap();
    assert_eq!((summary.computed, summary.complete), (3 * 257, true));
    assert!(contents(&own) == whole);
}

#[test]
fn another_recipe_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let own = folder.path().join("own");
    sweep("youbot", 0).write(&own, &threads(2), |_| true).unwrap();
    let before = contents(&own);
    let refused = |sweep: &Sweep, options: &WriteOptions| {
        sweep.write(&own, options, |_| true).unwrap_err().to_string()
    };
    let same = sweep("youbot", 0);
    assert!(refused(&same, &threads(1)).contains("has a sweep already"));
    let other = refused(&sweep("youbot", 1), &RESUME);
    assert!(other.contains("configurations.seed is 0 there and 1 now"), "{other}");
    let other = refused(&sweep("panda", 0), &RESUME);
    assert!(other.contains("coordinates is ["), "{other}");
    assert!(contents(&own) == before);
}

#[cfg(unix)]
#[test]
fn folders_that_cannot_be_written_are_named() {
    let sweep = sweep("youbot", 0);
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, b"").unwrap();
    let error = sweep.write(&file, &threads(1), |_| true).unwrap_err().to_string();
    assert!(error.contains("cannot write") && error.contains("file"), "{error}");
    let error = sweep.write(Path::new("/proc/sweep"), &threads(1), |_| true).unwrap_err();
    assert!(error.to_string().contains("/proc/sweep"), "{error}");
}

/// Its rows, read by the names of the coordinates in another order.
#[test]
fn a_part_is_a_file_of_configurations() {
    let (sweep, robot) = (sweep("youbot", 5), cylindroid::load("youbot").unwrap());
    let folder = tempfile::tempdir().unwrap();
    sweep.write(folder.path(), &threads(1), |_| true).unwrap();
    let mut names: Vec<&str> = robot.coordinates().iter().map(|c| c.name.as_str()).collect();
    names.reverse();
    let path = folder.path().join("part-000001.parquet");
    let found = parquet_configurations(&path, &names).unwrap();
    let table = sweep.table(257..514).unwrap();
    let expected = crate::configurations(&robot, &table);
    assert_eq!(found.len(), 257 * names.len());
    for (found, expected) in found.chunks(names.len()).zip(&expected) {
        assert!(found.iter().rev().eq(expected));
    }
    let error = parquet_configurations(&path, &["arm_joint_9"]).unwrap_err().to_string();
    assert!(error.contains("no column 'arm_joint_9' among index"), "{error}");
    let error = parquet_configurations(&path, &["gibson_hunt"]).unwrap_err().to_string();
    assert!(error.contains("row 1, column 'gibson_hunt': no number"), "{error}");
    let broken = folder.path().join("broken.parquet");
    fs::write(&broken, b"no parquet").unwrap();
    assert!(parquet_configurations(&broken, &names).is_err());
    // Files of three rows that announce 63: as a whole, and in their only group.
    let findings = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/findings/parquet");
    let read = |file| parquet_configurations(&findings.join(file), &["q1", "q2", "q3"]);
    let expected = [0.1, 1.0, 1.0, 0.2, 2.0, 2.0, 0.3, 3.0, 3.0];
    assert_eq!(read("rows-of-file.parquet").unwrap(), expected);
    let error = read("rows-of-group.parquet").unwrap_err().to_string();
    assert!(error.contains("row 4, column 'q1': no number"), "{error}");
    // A file whose columns begin before it does.
    let first = parquet_columns(&findings.join("place-of-column.parquet"), &["q1"]);
    let error = first.unwrap_err().to_string();
    assert!(error.contains("the place of column 'q1' is negative"), "{error}");
    // A list of 2^31 numbers beyond the end of the file in the header of a page, where Parquet has a
    // number; and one of truth values in the footer.
    let error = read("end-of-file.parquet").unwrap_err().to_string();
    assert!(error.contains("the header of a page has a field of another kind"), "{error}");
    let error = read("truth-values.parquet").unwrap_err().to_string();
    assert!(error.contains("the footer "), "{error}");
    // A page in terms of a dictionary that is not there.
    let page = parquet_columns(&findings.join("page-before-dictionary.parquet"), &["q1", "q.q2"]);
    let error = page.unwrap_err().to_string();
    assert!(error.contains("a page before its dictionary"), "{error}");
    if cfg!(unix) {
        // A pipe waits for its writer.
        let pipe = folder.path().join("pipe.parquet");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let error = parquet_configurations(&pipe, &names).unwrap_err().to_string();
        assert!(error.contains("not a regular file"), "{error}");
    }
}
