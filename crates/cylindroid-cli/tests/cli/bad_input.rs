//! Bad input: one clear message on stderr, nothing on stdout, exit code 2.

use std::process::{Command, Stdio};

use crate::cylindroid;

fn refused(arguments: &[&str], message: &str) {
    let stderr = crate::refused(arguments);
    assert!(stderr.contains(message), "{arguments:?}: {stderr}");
}

const TO: [&str; 4] = ["move", "panda", "--to", "0.4,0.1,0.4"];

fn refused_move(more: &[&str], message: &str) {
    refused(&[&TO, more].concat(), message);
}

#[test]
fn unknown_names_offer_the_nearest() {
    refused(&["info", "pandas"], "nearest: panda");
    refused(
        &["fk", "panda", "--frame", "hand"],
        "--frame: no frame named 'hand'; nearest: hand_tcp",
    );
    refused(&["fk", "panda", "--q", "panda_joint9=1"], "--q: no joint named 'panda_joint9'");
    refused_move(&["--inverse", "damp"], "--inverse: no inverse named 'damp'; nearest: damped");
    refused_move(&["--secondary", "center"], "nearest: centring");
    refused_move(&["--task", "x,y,yaw"], "no task or task component named 'yaw'");
}

#[test]
fn configurations_must_fit() {
    refused(&["fk", "panda", "--q", "0,0"], "--q has 2 entries, expected 7");
    refused(&["fk", "panda", "--q", "0,0,nan,0,0,0,0"], "[2] (panda_joint3) is not finite");
    refused(&["fk", "panda", "--q", "0,0,x,0,0,0,0"], "'x' is not a number");
    refused_move(&["--q", "panda_joint1=4"], "panda_joint1 at 4 rad");
    refused(&["move", "panda", "--joint-to", "zero"], "panda_joint4 at 0 rad");
}

#[test]
fn targets_must_be_finite_and_complete() {
    refused(&["move", "panda"], "no target");
    refused(&["move", "panda", "--to", "nan,0,0"], "--to[0] is not finite");
    refused(&["move", "panda", "--to", "0.1,0.2"], "2 numbers given, 3 expected");
    refused(&["move", "panda", "--quaternion", "0,0,0,0"], "it must be finite and not zero");
    refused_move(&["--rpy", "0,0,inf"], "--rpy[2] is not finite");
    refused_move(&["--rpy", "0,0,0", "--rotation-vector", "0,0,0"], "cannot be used with");
    refused_move(&["--line", "--via", "0,0,1"], "cannot be used with");
    let twist = ["move", "ur5e", "--twist", "1e308,0,0,0,0,0"];
    let plane = ["move", "five-bar", "--twist", "0,0.1,-5,0,0,0"];
    refused(&plane, "the task has no z, but x, y, rz");
    let position = ["move", "panda", "--task", "position", "--twist", "0,0,0.1,0,0,1"];
    refused(&position, "rz = 1 cannot be used: the task has no rz");
    let to = ["move", "five-bar", "--to", "0.1,0.4,5"];
    refused(&to, "--to = z = 5 m cannot be used: 'five-bar' moves in the plane z = 0 m");
    refused(&twist, "--twist[0] = 1e308 is out of range: magnitudes up to 1e120 are accepted");
}

#[test]
fn servo_options_must_make_a_controller() {
    refused_move(&["--gain", "3000"], "gain * dt = 3 must be below 2");
    refused_move(&["--gain", "5,0"], "--gain (orientation) = 0");
    refused_move(&["--dt", "-1e-3"], "--dt = -0.001");
    refused_move(&["--length", "nan"], "--length = NaN");
    refused_move(&["--time-limit", "0"], "--time-limit = 0");
    refused_move(&["--tolerance-position", "0"], "--tolerance-position = 0");
    refused_move(&["--speed", "0"], "--speed (linear) = 0");
    refused_move(&["--damping", "0.1"], "the inverse 'truncated' has no such parameter but eps");
    refused_move(&["--eps", "1"], "--eps = 1 cannot be used");
    refused_move(&["--acceleration-linear", "0", "--line"], "--acceleration-linear = 0");
}

#[test]
fn files_must_have_a_known_name() {
    refused_move(&["--out", "way.txt"], "must end in .csv or .json");
    refused_move(&["--plot", "way.png"], "must end in .svg");
    refused_move(&["--out", "/no/such/folder/way.csv"], "cannot write /no/such/folder/way.csv");
    refused(&["info", "no_such.urdf"], "cannot read no_such.urdf");
}

/// Of every command that draws; what was found is not printed either.
#[test]
fn pictures_that_cannot_be_written() {
    for command in [&["manipulability", "five-bar"][..], &["screws", "youbot"], &TO] {
        let command = [command, &["--plot", "/no/such/folder/e.svg"]].concat();
        refused(&command, "cannot write /no/such/folder/e.svg");
    }
}

/// The flag that was typed, whatever the library calls its value.
#[test]
fn errors_name_the_flag() {
    let wrench = ["statics", "stewart", "--wrench", "0,0,1,0,0,0"];
    let statics = |more: &[&str], message: &str| refused(&[&wrench, more].concat(), message);
    statics(&["--stiffness", "-5"], "--stiffness = -5 cannot be used: it must be positive");
    statics(&["--compliance", "-1"], "--compliance = -1");
    refused(&["statics", "stewart", "--wrench", "0,nan,1,0,0,0"], "--wrench[1] is not finite");
    refused(&["manipulability", "five-bar", "--task", ".."], "--task: no component named '..'");
    refused(&["manipulability", "five-bar", "--task", "x,x"], "--task = 2 x 3 map of rank 1");
    let limits = ["manipulability", "five-bar", "--polytope", "--velocity-limits", "1"];
    refused(&limits, "--velocity-limits has 1 entries, expected 2");
    refused(&["jacobian", "ur5e", "--velocities", "1,2"], "--velocities has 2 entries");
    refused(&["jacobian", "youbot", "--inverse", "hyperbolic"], "--h is missing: the inverse");
    refused(
        &["jacobian", "youbot", "--inverse", "hyperbolic-damped", "--h", "1"],
        "--mu is missing",
    );
    refused(
        &["jacobian", "youbot", "--inverse", "hyperbolic", "--h", "0.1", "--eps", "0.1"],
        "--eps = 0.1",
    );
    refused_move(&["--line", "--jerk-linear", "2"], "add --law jerk-limited");
    refused_move(&["--jerk-angular", "2"], "--jerk-angular = 2");
    refused(&["assemble", "five-bar", "--modes", "0"], "--modes = 0");
    refused(&["screws", "youbot", "--center", "nan,0,0"], "--center[0] is not finite");
    refused_move(&["--joint-weights", "1,1"], "--joint-weights has 2 entries");
    refused_move(&["--line", "--acceleration-angular", "-1"], "--acceleration-angular = -1");
    refused_move(&["--secondary", "foo=1"], "--secondary: no secondary task named 'foo'");
}

/// Options that would do nothing, and lists with nothing in them.
#[test]
fn nothing_is_ignored_in_silence() {
    refused_move(&["--actuated", "panda_joint1"], "'panda' has no loops or contacts");
    let no_target = crate::refused(&["ik", "panda"]);
    assert!(no_target.contains("no target") && !no_target.contains("--joint-to"), "{no_target}");
    refused(&["ik", "panda", "--to", "0.4,0,0.4", "--all", "0"], "'0' for '--all <N>'");
    refused(&["ik", "panda", "--to", "0.4,0,0.4", "--all", "-1"], "'-1' for '--all <N>'");
    refused(&["assemble", "five-bar", "--to", "q2=nan"], "--to[1] (q2) is not finite");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("task.csv");
    std::fs::write(&path, "").unwrap();
    let path = path.to_str().unwrap();
    refused(&["manipulability", "panda", "--task-map", path], "has no rows");
}

#[test]
fn an_error_without_a_reader_is_an_error() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_cylindroid"))
        .args(["info", "pandas"])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stderr.take());
    assert_eq!(child.wait().unwrap().code(), Some(2));
}

#[test]
fn a_broken_file_is_shown_with_its_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("broken.urdf");
    let text = "<robot name=\"r\">\n  <link name=\"a\"/>\n  <joint name=\"j\" type=\"hinge\">\n    \
                <parent link=\"a\"/><child link=\"b\"/>\n  </joint>\n  <link name=\"b\"/>\n</robot>\n";
    std::fs::write(&path, text).unwrap();
    let output = cylindroid(&["info", path.to_str().unwrap()]);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    assert!(stderr.contains("broken.urdf:3:"), "{stderr}");
    assert!(stderr.contains("type=\"hinge\""), "the source line: {stderr}");
}

#[cfg(unix)]
#[test]
fn devices_and_arguments_that_are_not_utf_8_are_told() {
    use std::os::unix::ffi::OsStrExt as _;
    refused(&["info", "/dev/zero"], "not a regular file");
    refused(&["info", "/tmp"], "it is a folder");
    let map = |path| ["manipulability", "panda", "--task-map", path];
    refused(&map("/dev/zero"), "not a regular file");
    refused(&map("/tmp"), "it is a folder");
    let word = std::ffi::OsStr::from_bytes(b"a\xff.urdf");
    let output = Command::new(env!("CARGO_BIN_EXE_cylindroid")).arg("info").arg(word).output();
    let output = output.unwrap();
    assert_eq!(output.status.code(), Some(2));
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(stderr.contains("the argument \"a\\xFF.urdf\" is not UTF-8"), "{stderr}");
}

/// Files of numbers have limits too.
#[test]
fn files_of_numbers_are_bounded() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.csv", "a.json"] {
        let path = folder.path().join(name);
        let file = std::fs::File::create(&path).unwrap();
        let path = path.to_str().unwrap();
        file.set_len((128 << 20) + 1).unwrap();
        refused(&["manipulability", "panda", "--task-map", path], "larger than 128 MiB");
    }
    for (name, row) in [("a.csv", "1\n"), ("a.json", "[],")] {
        let path = folder.path().join(name);
        std::fs::write(&path, row.repeat(5_000_100)).unwrap();
        let command = ["manipulability", "panda", "--task-map", path.to_str().unwrap()];
        refused(&command, "more than 5000000 rows");
    }
}

/// A line of a megabyte is not printed, and a chain of links is not indented without end.
#[test]
fn large_files_do_not_print_without_end() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("long.toml");
    std::fs::write(&path, format!("name = [{}", "1,".repeat(500_000))).unwrap();
    let stderr = crate::refused(&["info", &path.to_string_lossy()]);
    assert!(stderr.len() < 1000, "{} bytes", stderr.len());
    let links: String = (0..3000).map(|i| format!("<link name='l{i}'/>")).collect();
    let joint = |i: usize| {
        let from = i - 1;
        format!(
            "<joint name='j{i}' type='fixed'><parent link='l{from}'/><child link='l{i}'/></joint>"
        )
    };
    let joints: String = (1..3000).map(joint).collect();
    let path = folder.path().join("chain.urdf");
    std::fs::write(&path, format!("<robot name='chain'>{links}{joints}</robot>")).unwrap();
    let out = cylindroid(&["info", &path.to_string_lossy()]);
    assert!(out.stdout.len() < 1_000_000, "{} bytes", out.stdout.len());
}

/// Ten thousand joints are an ordinary robot, within half a gigabyte.
#[test]
#[cfg(unix)]
fn ten_thousand_joints_are_a_size() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("long.urdf");
    let joint = |i: usize| {
        let child = i + 1;
        format!(
            "<link name='l{child}'/><joint name='j{i}' type='revolute'><parent link='l{i}'/>\
             <child link='l{child}'/><origin xyz='0.001 0 0'/><axis xyz='0 0 1'/>\
             <limit lower='-1' upper='1' velocity='1' effort='1'/></joint>"
        )
    };
    let joints: String = (0..10_000).map(joint).collect();
    std::fs::write(&path, format!("<robot name='long'><link name='l0'/>{joints}</robot>")).unwrap();
    let commands =
        [("info", "j9999"), ("fk", "10, 0, 0"), ("jacobian", "j9999"), ("screws", "j9999")];
    for (command, end) in commands {
        let limited = "ulimit -v 500000; exec \"$0\" \"$@\"";
        let output = Command::new("sh")
            .args(["-c", limited, env!("CARGO_BIN_EXE_cylindroid"), command])
            .arg(&path)
            // Each thread reserves addresses.
            .env("RAYON_NUM_THREADS", "2")
            .output()
            .unwrap();
        let [out, err] = [output.stdout, output.stderr].map(|x| String::from_utf8(x).unwrap());
        assert!(output.status.success(), "{command}: {err}");
        assert!(out.contains(end), "{command}: {}", out.chars().take(500).collect::<String>());
    }
}

/// Without joints, every command gives an answer or one error.
#[test]
fn zero_joints_are_a_size() {
    let folder = tempfile::tempdir().unwrap();
    let joint = "<link name=\"b\"/><joint name=\"j\" type=\"fixed\"><parent link=\"a\"/>\
                 <child link=\"b\"/></joint>";
    for more in ["", joint] {
        let path = folder.path().join("still.urdf");
        std::fs::write(&path, format!("<robot name=\"r\"><link name=\"a\"/>{more}</robot>"))
            .unwrap();
        let model = path.to_str().unwrap();
        for (command, code) in [
            ("info", 0),
            ("fk --all", 0),
            ("jacobian --twist x", 0),
            ("ik --to 0,0,0", 0),
            ("ik --to 1,0,0", 1),
            ("move --to 0,0,0", 2),
            ("move --joint-to zero", 2),
            ("screws --h 0.1", 0),
            ("mobility", 0),
            ("manipulability --polytope", 0),
            ("manipulability --gradient volume", 0),
            ("assemble", 0),
            ("statics --wrench 0,0,1,0,0,0", 0),
            ("statics --wrench 0,0,1,0,0,0 --stiffness 5", 2),
            ("grasp", 2),
        ] {
            let mut words: Vec<&str> = command.split(' ').collect();
            words.insert(1, model);
            let output = cylindroid(&words);
            let stderr = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(code), "{command}: {stderr}");
            assert!(!stderr.contains("panicked"), "{command}: {stderr}");
        }
    }
}

/// Numbers with which nothing can be said of a robot.
#[test]
fn lengths_margins_and_twists_have_sizes() {
    for command in ["mobility", "manipulability"] {
        refused(&[command, "two-arm", "--length", "1e-300"], "--length = 1e-300");
    }
    let wrench = ["statics", "two-arm", "--wrench", "0,0,1,0,0,0", "--length", "1e-300"];
    refused(&wrench, "--length = 1e-300");
    let length = "--length = 1e99 cannot be used: that of 'five-bar' is";
    refused(&["mobility", "five-bar", "--length", "1e99"], length);
    refused(&["screws", "panda", "--length", "1e-13"], "it must be from 1e-12 to 1e120");
    refused(&["screws", "panda", "--center", "0,0,1e121"], "--center[2] = 1e121");
    refused(&["distance", "3rrr", "--margin", "nan"], "--margin = NaN");
    let twist = "0,0,1e300,0,0,1";
    refused(&["screws", "panda", "--twist", twist], "--twist[2] = 1e300");
    refused(&["jacobian", "panda", "--twist", twist], "--twist[2] = 1e300");
    refused(&["statics", "panda", "--wrench", twist], "--wrench[2] = 1e300");
    let limits = "1e-200,1e-200";
    refused(&["manipulability", "five-bar", "--velocity-limits", limits], "1e-120 to 1e120");
    let both = ["assemble", "stewart", "--modes", "5", "--least-distance", "0.1"];
    refused(&both, "cannot be used with");
}

/// What is out of range, or said twice.
#[test]
fn options_have_ranges() {
    refused(&["fk", "panda", "--tool", "1e200,0,0"], "--tool[0] = 1e200");
    refused(&["sweep", "panda", "--samples", "3", "--tool", "1e200,0,0"], "--tool[0] = 1e200");
    refused(&["fk", "3r", "--q", "joint1=1,joint1=2"], "joint1 cannot be used: it is given twice");
    refused_move(&["--time-constant", "1e14"], "it must be at most 1e6 steps");
    let folder = tempfile::tempdir().unwrap();
    let tasks = folder.path().join("tasks.toml");
    let tasks = tasks.to_str().unwrap();
    for (key, says) in [
        ("tolerance_position = -1", "it must be positive"),
        ("tolerance_position = nan", "tolerance of a task = NaN"),
        ("tolerance_orientation = 0", "it must be positive"),
    ] {
        let text = format!(
            "[[task]]\ntype = \"frame\"\nframe = \"hand_tcp\"\nxyz = [0.4, 0, 0.4]\n{key}\n"
        );
        std::fs::write(tasks, text).unwrap();
        refused(&["move", "panda", "--tasks", tasks], says);
    }
    for weight in ["1e300", "1e-300"] {
        let text = format!(
            "[[task]]\ntype = \"frame\"\nframe = \"hand_tcp\"\nxyz = [0.4, 0, 0.4]\nweight = {weight}\n"
        );
        std::fs::write(tasks, text).unwrap();
        refused(&["ik", "panda", "--tasks", tasks], "weight");
    }
    let csv = folder.path().join("q.csv");
    std::fs::write(&csv, "joint1,joint1,joint2,joint3\n1,2,3,4\n").unwrap();
    let csv = csv.to_str().unwrap();
    refused(&["sweep", "3r", "--configurations", csv], "column 'joint1' is given twice");
    let twists = folder.path().join("twists.csv");
    let rows: String = (0..2001).map(|i| format!("{i},1,2,3,4,5\n")).collect();
    std::fs::write(&twists, rows).unwrap();
    let twists = twists.to_str().unwrap();
    refused(&["screws", twists, "--h", "0.1"], "at most 2000");
}

/// Numbers that would let a command run for ever are refused at once.
#[test]
fn counts_and_steps_are_bounded() {
    refused_move(&["--dt", "1e-120"], "steps of 1e-120 s");
    refused_move(&["--dt", "1e-9"], "take a longer --dt");
    refused_move(&["--time-limit", "1e9"], "--time-limit = 1000000000 s");
    refused_move(&["--time-limit", "1e5", "--out", "way.csv"], "each is kept for --out");
    let many = "18446744073709551615";
    for line in [
        &["ik", "panda", "--to", "0.4,0,0.4", "--iterations", many][..],
        &["ik", "panda", "--to", "0.4,0,0.4", "--all", many],
        &["assemble", "stewart", "--modes", many],
        &["mobility", "stewart", "--modes", many],
        &["distance", "panda", "--samples", many],
    ] {
        refused(line, "1000000");
    }
}
