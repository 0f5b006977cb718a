//! The examples in C and C++, compiled by the compilers of the machine and run.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // a test that fails

use std::path::{Path, PathBuf};
use std::process::Command;

use cylindroid_c as _;

/// The static library, beside this test.
fn library() -> PathBuf {
    let own = std::env::current_exe().unwrap();
    let folders = [own.parent().unwrap(), own.parent().unwrap().parent().unwrap()];
    let files = folders.iter().flat_map(|f| std::fs::read_dir(f).unwrap().flatten());
    let is_library = |p: &PathBuf| {
        let name = p.file_name().unwrap().to_string_lossy().into_owned();
        name.starts_with("libcylindroid_c") && name.ends_with(".a")
    };
    let found = files.map(|f| f.path()).filter(is_library);
    let newest = found.max_by_key(|p| p.metadata().and_then(|m| m.modified()).unwrap());
    newest.expect("cargo builds the static library with the tests")
}

fn output(command: &mut Command) -> String {
    let done = command.output().unwrap_or_else(|e| panic!("{command:?}: {e}"));
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let (out, err) = (text(&done.stdout), text(&done.stderr));
    assert!(done.status.success(), "{command:?}: {out}{err}");
    out
}

fn is_there(program: &str) -> bool {
    Command::new(program).arg("--version").output().is_ok()
}

fn build(compiler: &str, standard: &str, source: &str, folder: &Path) -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let program = folder.join(format!("{compiler}-{source}"));
    let mut command = Command::new(compiler);
    command.args([standard, "-O2", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-I"]);
    command.arg(here.join("include")).arg(here.join("examples").join(source));
    command.arg(library()).args(["-lpthread", "-ldl", "-lm", "-o"]).arg(&program);
    output(&mut command);
    program
}

/// Everything that the header declares is called, errors as well.
#[test]
fn programs_in_c_and_cpp_run() {
    let folder = tempfile::tempdir().unwrap();
    let mut compilers = 0;
    for (c, cpp) in [("gcc", "g++"), ("clang", "clang++")] {
        if !is_there(c) || !is_there(cpp) {
            continue;
        }
        compilers += 1;
        let program = build(c, "-std=c11", "servo.c", folder.path());
        let text = output(&mut Command::new(program));
        assert!(text.contains("panda: reached") && text.contains("stewart: reached"), "{text}");
        for standard in ["-std=c++17", "-std=c++20"] {
            let program = build(cpp, standard, "loop.cpp", folder.path());
            let text = output(&mut Command::new(program));
            assert!(text.contains("median") && text.contains("refused"), "{text}");
        }
    }
    assert!(compilers > 0, "neither gcc nor clang is installed");
}

/// The controller of ros2_control, compiled with stubs of the headers of ROS 2 and run.
#[test]
fn the_controller_of_ros2_control_follows_twists() {
    let folder = tempfile::tempdir().unwrap();
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let example = here.join("examples/ros2_control");
    for compiler in ["g++", "clang++"].into_iter().filter(|compiler| is_there(compiler)) {
        let program = folder.path().join(compiler);
        let mut command = Command::new(compiler);
        command.args(["-std=c++17", "-O2", "-Wall", "-Wextra", "-Wpedantic", "-Werror"]);
        for include in [here.join("include"), example.join("stubs")] {
            command.arg("-I").arg(include);
        }
        command.args(["servo_controller.cpp", "stubs/manager.cpp"].map(|f| example.join(f)));
        command.arg(library()).args(["-lpthread", "-ldl", "-lm", "-o"]).arg(&program);
        output(&mut command);
        let text = output(&mut Command::new(program));
        assert!(text.contains("moved by") && text.contains("stopped"), "{text}");
    }
}

/// No memory is read or written that belongs to nobody, and none is left; where valgrind is installed.
#[test]
fn programs_leave_no_memory() {
    if !is_there("valgrind") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let program = build("gcc", "-std=c11", "servo.c", folder.path());
    let mut command = Command::new("valgrind");
    command.args(["--leak-check=full", "--show-leak-kinds=definite", "--error-exitcode=9"]);
    output(command.args(["--errors-for-leak-kinds=definite", "-q"]).arg(program));
}

/// Every function of the header is called by the example in C.
#[test]
fn the_example_calls_every_function() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let read = |path: &str| std::fs::read_to_string(here.join(path)).unwrap();
    let (header, example) = (read("include/cylindroid.h"), read("examples/servo.c"));
    let mut count = 0;
    for word in header.split(|c: char| !c.is_alphanumeric() && c != '_') {
        if word.starts_with("cyl_") && header.contains(&format!("{word}(")) {
            assert!(example.contains(&format!("{word}(")), "{word} is not called");
            count += 1;
        }
    }
    assert!(count > 20, "{count}");
}
