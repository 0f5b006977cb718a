//! Commands that are programs of their own: `cylindroid ros2`.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use tempfile::TempDir;

/// On the disk of the binary, so that it can be linked.
fn folder() -> TempDir {
    tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).unwrap()
}

/// The binary in a folder where there is nothing beside it.
fn alone(folder: &TempDir) -> PathBuf {
    let link = folder.path().join(format!("cylindroid{}", std::env::consts::EXE_SUFFIX));
    fs::hard_link(env!("CARGO_BIN_EXE_cylindroid"), &link).unwrap();
    link
}

fn run(binary: &Path, path: &Path, words: &[&str]) -> Output {
    Command::new(binary).args(words).env("PATH", path).output().unwrap()
}

#[test]
fn a_missing_program_says_how_to_install_it() {
    let folder = folder();
    let binary = alone(&folder);
    let output = run(&binary, folder.path(), &["ros2", "panda", "--help"]);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{message}");
    let message = message.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(message.contains("cargo install cylindroid-ros2"), "{message}");
    // Other unknown commands are not looked for.
    let output = run(&binary, folder.path(), &["ros1"]);
    assert!(String::from_utf8(output.stderr).unwrap().contains("unrecognized subcommand 'ros1'"));
}

/// Words and exit code pass as they are, whatever this program knows of them.
#[cfg(target_os = "linux")]
#[test]
fn a_program_is_found_in_the_path_and_first_beside_the_binary() {
    use std::os::unix::fs::symlink;
    let [own, other] = [folder(), folder()];
    let binary = alone(&own);
    symlink("/bin/sh", other.path().join("cylindroid-ros2")).unwrap();
    let script = "printf '%s\\n' \"$@\"; exit 7";
    let words = ["ros2", "-c", script, "sh", "my robot.urdf", "--help", "--joints", "a, b"];
    let output = run(&binary, other.path(), &words);
    assert_eq!(output.status.code(), Some(7));
    let printed = String::from_utf8(output.stdout).unwrap();
    assert_eq!(printed.lines().collect::<Vec<_>>(), words[4..]);
    symlink("/bin/false", own.path().join("cylindroid-ros2")).unwrap();
    let output = run(&binary, other.path(), &words);
    assert_eq!((output.status.code(), output.stdout.is_empty()), (Some(1), true));
}
