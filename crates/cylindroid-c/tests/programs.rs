//! The examples in C and C++, compiled by the compilers of the machine and run.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // a test that fails

use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use cylindroid::control::{ServoGains, Target};
use cylindroid::{Pose, Twist, Vec3};
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

/// The folder of Eigen's headers where `CYLINDROID_EIGEN` or `pkg-config` names one.
fn eigen() -> Option<PathBuf> {
    let named = std::env::var_os("CYLINDROID_EIGEN").map(PathBuf::from);
    named.or_else(|| {
        let asked = Command::new("pkg-config").args(["--cflags-only-I", "eigen3"]).output().ok()?;
        let text = String::from_utf8(asked.stdout).ok()?;
        text.trim().strip_prefix("-I").map(PathBuf::from)
    })
}

fn build(compiler: &str, standard: &str, source: &str, folder: &Path) -> PathBuf {
    build_with(None, compiler, standard, source, folder)
}

fn build_with(
    eigen: Option<&Path>,
    compiler: &str,
    standard: &str,
    source: &str,
    folder: &Path,
) -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let program = folder.join(format!("{compiler}-{source}"));
    let mut command = Command::new(compiler);
    eigen.iter().for_each(|folder| {
        command.arg("-isystem").arg(folder);
    });
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
    if eigen().is_none() {
        println!("without Eigen: neither CYLINDROID_EIGEN nor pkg-config names its headers");
    }
    for (c, cpp) in [("gcc", "g++"), ("clang", "clang++")] {
        if !is_there(c) || !is_there(cpp) {
            continue;
        }
        compilers += 1;
        let program = build(c, "-std=c11", "servo.c", folder.path());
        let text = output(&mut Command::new(program));
        assert!(text.contains("panda: reached") && text.contains("stewart: reached"), "{text}");
        let standards = ["-std=c++17", "-std=c++20"].map(|standard| (standard, None));
        let with_eigen = eigen().map(|folder| ("-std=c++17", Some(folder)));
        for (standard, eigen) in standards.into_iter().chain(with_eigen) {
            let program = build_with(eigen.as_deref(), cpp, standard, "loop.cpp", folder.path());
            let text = output(&mut Command::new(&program));
            assert!(text.contains("median") && text.contains("refused"), "{text}");
            let text = output(Command::new(program).args(["50", "1"]));
            assert!(text.contains("every 1 ms"), "{text}");
        }
    }
    assert!(compilers > 0, "neither gcc nor clang is installed");
}

/// The loop of the example in C++: the median time of a step [us], whose target is a pose already or, as in
/// C++, a matrix that is to be checked, like the pose that comes back.
fn median_step(steps: usize, of_matrix: bool) -> f64 {
    let robot = cylindroid::catalogue::load("panda").unwrap();
    let mut q = vec![0.3, -0.4, 0.1, -2.0, 0.2, 1.7, 0.5];
    let start = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
    let mut options = cylindroid::ServoOptions::new(&robot);
    options.gain = ServoGains { position: 20.0, orientation: 20.0 };
    let mut servo = cylindroid::Servo::new(&robot, options.clone()).unwrap();
    let mut velocities = vec![0.0; robot.n()];
    let (w, r) = (2.0, 0.05);
    let mut times: Vec<u128> = (0..steps)
        .map(|k| {
            let t = k as f64 * options.dt;
            let ramp = t.min(1.0);
            let ((sin, cos), growth) = ((w * t).sin_cos(), if t < 1.0 { r } else { 0.0 });
            let way = Vec3::new(ramp * r * (cos - 1.0), ramp * r * sin, 0.0);
            let pose = Pose { translation: start.translation + way, ..start };
            let along = Vec3::new(
                growth * (cos - 1.0) - ramp * r * w * sin,
                growth * sin + ramp * r * w * cos,
                0.0,
            );
            let feed_forward = Twist { linear: along, angular: Vec3::ZERO };
            let rows = black_box(pose.to_matrix());
            let before = Instant::now();
            if of_matrix {
                let pose = Pose::from_matrix(rows).unwrap();
                let step = servo.step(&q, Target { pose, feed_forward }).unwrap();
                black_box(step.pose.to_matrix());
            } else {
                servo.step(&q, Target { pose, feed_forward }).unwrap();
            }
            velocities.copy_from_slice(servo.joint_velocities());
            let time = before.elapsed().as_nanos();
            servo.advance(&mut q);
            time
        })
        .collect();
    times.sort_unstable();
    times[steps / 2] as f64 * 1e-3
}

/// `cargo xtask c-step`: a step of the servo from C++ beside one from Rust, in turn, and its loop at
/// 1 kHz for 20 s.
#[test]
#[ignore = "a measurement"]
fn a_step_from_cpp_beside_one_from_rust() {
    let folder = tempfile::tempdir().unwrap();
    let program = build("g++", "-std=c++17", "loop.cpp", folder.path());
    for _ in 0..5 {
        let text = output(Command::new(&program).arg("200000"));
        let cpp = text.strip_prefix("median ").and_then(|rest| rest.split_once(" us"));
        let cpp: f64 = cpp.unwrap().0.parse().unwrap();
        let [rust, matrix] = [false, true].map(|of_matrix| median_step(200_000, of_matrix));
        let [more, border] = [rust, matrix].map(|rust| 1e3 * (cpp - rust));
        println!(
            "panda, us a step: C++ {cpp:.3}; Rust {rust:.3}: {more:+.0} ns; Rust with matrices \
             {matrix:.3}: {border:+.0} ns"
        );
    }
    let text = output(Command::new(&program).args(["20000", "1"]));
    println!("{}", text.lines().take(2).collect::<Vec<_>>().join("\n"));
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
