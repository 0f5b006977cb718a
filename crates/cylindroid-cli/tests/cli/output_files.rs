//! Files that commands write: whole, or as they were.

#![cfg(unix)]

use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::Path;
use std::process::{Command, Stdio};

use crate::refused;
use crate::sweep::limited;

/// Names of all files in a folder.
fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// Of two sweeps into one file it is that of one of them; files of other names stay.
#[test]
fn two_sweeps_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let sweep = |seed: &str, name: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_cylindroid"));
        command
            .args(["sweep", "panda", "--samples", "20000", "--quantities", "pose"])
            .args(["--seed", seed, "--out", name])
            .current_dir(folder.path())
            .stdout(Stdio::null());
        command
    };
    let read = |name: &str| fs::read(folder.path().join(name)).unwrap();
    fs::write(folder.path().join("both.csv.tmp"), "mine").unwrap();
    for seed in ["1", "2"] {
        assert!(sweep(seed, &format!("{seed}.csv")).status().unwrap().success());
    }
    let children = ["1", "2"].map(|seed| sweep(seed, "both.csv").spawn().unwrap());
    for mut child in children {
        assert!(child.wait().unwrap().success());
    }
    let both = read("both.csv");
    assert!(both == read("1.csv") || both == read("2.csv"));
    assert_eq!(read("both.csv.tmp"), b"mine");
    assert_eq!(names(folder.path()), ["1.csv", "2.csv", "both.csv", "both.csv.tmp"]);
}

/// Without room for the new file the old one stays, and nothing beside it.
#[test]
fn full_disks_keep_the_old_file() {
    let map = ["map", "five-bar", "--over", "x=-1:3:30", "--over", "y=-1:3:30", "--starts", "1"];
    let sweep = ["sweep", "panda", "--samples", "500", "--quantities", "pose"];
    let motion = ["move", "3r", "--joint-to", "joint2=2"];
    for (command, option, name) in [
        (&map[..], "--out", "old.csv"),
        (&map, "--out", "old.json"),
        (&map, "--plot", "old.svg"),
        (&sweep, "--out", "old.csv"),
        (&motion, "--out", "old.csv"),
        (&motion, "--out", "old.json"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        fs::write(&path, "old").unwrap();
        let output = limited(4, &[command, &[option, path.to_str().unwrap()]].concat());
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{command:?} {name}: {message}");
        assert!(message.contains("cannot write") && message.contains(name), "{message}");
        assert_eq!(fs::read(&path).unwrap(), b"old", "{command:?} {name}");
        assert_eq!(names(folder.path()), [name]);
    }
}

/// Links stay links, also to files that are not there yet; a file keeps its permissions.
#[test]
fn links_and_permissions_stay() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir(at("deep")).unwrap();
    fs::write(at("deep/old.csv"), "old").unwrap();
    fs::set_permissions(at("deep/old.csv"), fs::Permissions::from_mode(0o640)).unwrap();
    symlink("deep/old.csv", at("second.csv")).unwrap();
    for (link, to) in [
        ("old.csv", "second.csv"),
        ("new.csv", "deep/new.csv"),
        ("a.csv", "b.csv"),
        ("b.csv", "a.csv"),
    ] {
        symlink(to, at(link)).unwrap();
    }
    let sweep = |name: &str| {
        let out = at(name).to_str().unwrap().to_owned();
        ["sweep", "3r", "--samples", "2", "--out", &out].map(str::to_owned)
    };
    for name in ["old.csv", "new.csv", "plain.csv"] {
        crate::text(&sweep(name).each_ref().map(String::as_str));
    }
    let whole = fs::read(at("plain.csv")).unwrap();
    for name in ["deep/old.csv", "deep/new.csv"] {
        assert_eq!(fs::read(at(name)).unwrap(), whole);
        assert!(fs::symlink_metadata(at(name)).unwrap().is_file());
    }
    let mode = |name: &str| fs::metadata(at(name)).unwrap().permissions().mode() & 0o777;
    assert_eq!(mode("deep/old.csv"), 0o640);
    fs::write(at("ours"), "").unwrap();
    assert_eq!(mode("plain.csv"), mode("ours"));
    for name in ["old.csv", "second.csv", "new.csv"] {
        assert!(fs::symlink_metadata(at(name)).unwrap().is_symlink());
    }
    let message = refused(&sweep("a.csv").each_ref().map(String::as_str));
    assert!(message.contains("its links lead to one another"), "{message}");
    assert_eq!(names(&at("deep")), ["new.csv", "old.csv"]);
}

/// Before anything is computed, and with the file that was named.
#[test]
fn too_many_rows_are_refused_first() {
    for (samples, rows) in [("1000001", "1000001"), ("4e9", "4000000000")] {
        let sweep = ["sweep", "stewart", "--samples", samples, "--quantities", "pose"];
        let message = refused(&[&sweep[..], &["--out", "large.csv"]].concat());
        let says = format!("--out = large.csv cannot be used: {rows} rows are too many for CSV");
        assert!(message.contains(&says) && message.contains("name a folder"), "{message}");
    }
}
