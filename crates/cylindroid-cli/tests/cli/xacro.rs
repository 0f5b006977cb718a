//! xacro by the program of this name, here a script that stands for it.
#![cfg(unix)]

use std::fs;
use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;
use std::process::{Command, Output};

/// `info` of a xacro file, with this script as the program xacro, or without one.
fn info(folder: &Path, script: Option<&str>) -> Output {
    let file = folder.join("arm.urdf.xacro");
    let text = "<robot xmlns:xacro='http://ros.org/wiki/xacro' name='arm'><xacro:arm/></robot>";
    fs::write(&file, text).unwrap();
    if let Some(script) = script {
        let program = folder.join("xacro");
        fs::write(&program, format!("#!/bin/sh\n{script}\n")).unwrap();
        fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
    }
    let mut command = Command::new(env!("CARGO_BIN_EXE_cylindroid"));
    command.args(["info", "--json"]).arg(file).env("PATH", folder).output().unwrap()
}

#[test]
fn a_xacro_file_is_expanded_by_the_program() {
    let folder = tempfile::tempdir().unwrap();
    let script = "printf '%s' \"<robot name='arm'><link name='of-$#'/></robot>\"";
    let output = info(folder.path(), Some(script));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((json["name"].as_str(), json["tool"].as_str()), (Some("arm"), Some("of-1")));
}

#[test]
fn a_missing_or_failing_program_is_told() {
    let folder = tempfile::tempdir().unwrap();
    for (script, says) in [
        (None, "pip install xacro"),
        (Some("echo 'undefined macro: arm' >&2; exit 2"), "xacro refuses it: undefined macro: arm"),
        (
            Some(
                "printf \"warning: old\nerror: name 'foo' is not defined \nwhen evaluating expression \
                  'foo'\nwhen processing file: u.xacro\" >&2; exit 2",
            ),
            "xacro refuses it: name 'foo' is not defined; when evaluating expression 'foo'; when \
             processing file: u.xacro",
        ),
        (
            Some(
                "printf \"No such file or directory: ./no.xacro\nwhen processing file: u\" >&2; exit 2",
            ),
            "xacro refuses it: No such file or directory: ./no.xacro; when processing file: u",
        ),
        (
            Some(
                "printf \"XML parsing error: mismatched tag\n\nCheck that:\n - it is XML\" >&2; exit 2",
            ),
            "xacro refuses it: XML parsing error: mismatched tag",
        ),
        (Some("exit 2"), "xacro refuses it: no message"),
        // It ends only because nobody reads any more.
        (Some("while :; do printf '%080000d' 0; done"), "more than 32 MiB"),
    ] {
        let output = info(folder.path(), script);
        assert_eq!(output.status.code(), Some(2));
        let stderr = String::from_utf8_lossy(&output.stderr).replace("\n  │ ", " ");
        assert!(stderr.contains(says), "{stderr}");
    }
}
