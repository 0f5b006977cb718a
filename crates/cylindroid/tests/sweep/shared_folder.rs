//! Parts that several processes write: the same bytes as those of one.

use std::fs;

use cylindroid::sweep::{Quantity, SharedFolder, Source, Sweep, SweepOptions, WriteOptions};

fn sweep(seed: u64) -> Sweep {
    let options = SweepOptions {
        source: Source::Samples { count: 1000, seed },
        quantities: vec![Quantity::Pose, Quantity::GibsonHunt],
        part_rows: 77,
        ..Default::default()
    };
    Sweep::new(&cylindroid::load("youbot").unwrap(), options).unwrap()
}

/// In another order and with parts written twice; one by one as bytes too.
#[test]
fn parts_are_those_of_one_process() {
    let sweep = sweep(3);
    let folder = tempfile::tempdir().unwrap();
    let (whole, own) = (folder.path().join("whole"), folder.path().join("own"));
    sweep.write(&whole, &WriteOptions::default(), |_| true).unwrap();
    let shared = SharedFolder::open(&sweep, &own, false).unwrap();
    let mut parts = shared.listed.clone();
    assert!(parts.len() == 13 && parts.iter().all(Option::is_none));
    for part in (0..parts.len()).rev().chain([4, 4]) {
        let (found, computed) = sweep.write_part(&own, part, parts[part].as_ref()).unwrap();
        assert_eq!(computed, parts[part].is_none());
        parts[part] = Some(found);
    }
    shared.write_manifest(&sweep, &parts).unwrap();
    let names = (0..parts.len()).map(Sweep::part_name).chain(["manifest.json".to_owned()]);
    for name in names {
        assert!(fs::read(own.join(&name)).unwrap() == fs::read(whole.join(&name)).unwrap());
    }
    for (part, written) in parts.iter().enumerate() {
        let (found, bytes) = sweep.part_file(part).unwrap();
        assert!(bytes == fs::read(whole.join(Sweep::part_name(part))).unwrap());
        assert_eq!(Some(&found), written.as_ref());
        assert_eq!(found.bytes, bytes.len() as u64);
    }
    let text = fs::read_to_string(whole.join("manifest.json")).unwrap();
    assert_eq!(sweep.manifest(&parts).unwrap(), text);
    assert_eq!(sweep.listed_parts("there", &text, true).unwrap(), parts);
}

/// A part whose file has changed since is written again.
#[test]
fn a_listed_part_is_verified() {
    let sweep = sweep(0);
    let folder = tempfile::tempdir().unwrap();
    let (part, computed) = sweep.write_part(folder.path(), 2, None).unwrap();
    assert!(computed);
    let path = folder.path().join(Sweep::part_name(2));
    let whole = fs::read(&path).unwrap();
    fs::write(&path, &whole[..100]).unwrap();
    assert_eq!(sweep.write_part(folder.path(), 2, Some(&part)).unwrap(), (part.clone(), true));
    assert!(fs::read(&path).unwrap() == whole);
    assert_eq!(sweep.write_part(folder.path(), 2, Some(&part)).unwrap(), (part, false));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn a_folder_is_opened_once_and_with_one_recipe() {
    let folder = tempfile::tempdir().unwrap();
    let own = folder.path().join("own");
    let first = SharedFolder::open(&sweep(0), &own, false).unwrap();
    let error = SharedFolder::open(&sweep(0), &own, true).unwrap_err().to_string();
    assert!(error.contains("another process is writing"), "{error}");
    drop(first);
    let error = SharedFolder::open(&sweep(0), &own, false).unwrap_err().to_string();
    assert!(error.contains("has a sweep already"), "{error}");
    let error = SharedFolder::open(&sweep(1), &own, true).unwrap_err().to_string();
    assert!(error.contains("configurations.seed is 0 there and 1 now"), "{error}");
    assert!(SharedFolder::open(&sweep(0), &own, true).is_ok());
}

/// Which of its parts are stale is not known, of the first or another, resumed or not.
#[test]
fn parts_without_a_manifest_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let own = folder.path();
    let write = |resume| {
        let options = WriteOptions { threads: None, resume };
        sweep(0).write(own, &options, |_| true)
    };
    fs::write(own.join("part-of-mine.parquet"), "mine").unwrap();
    write(false).unwrap();
    fs::remove_file(own.join("manifest.json")).unwrap();
    for first in [0, 3] {
        for part in 0..first {
            let _ = fs::remove_file(own.join(Sweep::part_name(part)));
        }
        for resume in [false, true] {
            let error = write(resume).unwrap_err().to_string();
            let says = format!("parts of a sweep ({}), but no manifest", Sweep::part_name(first));
            assert!(error.contains(&says) && error.contains("remove them"), "{error}");
        }
    }
    assert!(!own.join("manifest.json").exists());
    (3..13).for_each(|part| fs::remove_file(own.join(Sweep::part_name(part))).unwrap());
    assert!(write(true).unwrap().complete);
}

/// Pipes wait for their other end: parts and a manifest that is being written are replaced, a lock is
/// refused.
#[cfg(unix)]
#[test]
fn pipes_are_not_waited_for() {
    let folder = tempfile::tempdir().unwrap();
    let own = folder.path().join("own");
    let pipe = |name: &str| {
        let path = own.join(name);
        let _ = fs::remove_file(&path);
        assert!(std::process::Command::new("mkfifo").arg(&path).status().unwrap().success());
    };
    let resume = WriteOptions { threads: None, resume: true };
    sweep(0).write(&own, &WriteOptions::default(), |_| true).unwrap();
    pipe(&Sweep::part_name(4));
    pipe(".manifest.json.tmp");
    let summary = sweep(0).write(&own, &resume, |_| true).unwrap();
    assert!(summary.complete && summary.computed == 77);
    assert!(fs::metadata(own.join(Sweep::part_name(4))).unwrap().is_file());
    pipe(".lock");
    let error = sweep(0).write(&own, &resume, |_| true).unwrap_err().to_string();
    assert!(error.contains("its .lock is no regular file; remove it"), "{error}");
}

#[test]
fn other_manifests_are_refused() {
    let own = sweep(0);
    let refused =
        |text: &str, resume| own.listed_parts("s3://there", text, resume).unwrap_err().to_string();
    let other = sweep(1).manifest(&vec![None; 13]).unwrap();
    let error = refused(&other, true);
    assert!(error.contains("s3://there") && error.contains("seed is 1 there and 0 now"), "{error}");
    let error = refused(&own.manifest(&vec![None; 13]).unwrap(), false);
    assert!(error.contains("has a sweep already"), "{error}");
    let error = refused("half a fi", true);
    assert!(error.contains("no manifest of a sweep"), "{error}");
    assert!(own.manifest(&[]).is_err());
    assert!(own.part(13).is_err() && own.part(usize::MAX).is_err());
    assert_eq!(own.recipe_difference(&own.recipe()).unwrap(), None);
    let difference = own.recipe_difference(&sweep(1).recipe()).unwrap().unwrap();
    assert_eq!(difference, "configurations.seed is 1 there and 0 now");
}
