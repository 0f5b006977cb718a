//! `move`.

use crate::{cylindroid, difference, json, numbers, refused, text};

#[test]
fn the_command_of_the_readme_reaches() {
    let report = json(&["move", "panda", "--to", "0.45,0.15,0.35", "--rpy", "3.1416,0,0.6"], 0);
    assert_eq!((&report["reached"], &report["reason"]), (&true.into(), &"reached".into()));
    assert!(report["position_error"].as_f64().unwrap() <= 1e-6);
    assert!(report["orientation_error"].as_f64().unwrap() <= 1e-6);
    assert_eq!(report["joint_names"][6], "panda_joint7");
    let q = numbers(&report["q"]).iter().map(f64::to_string).collect::<Vec<_>>().join(",");
    let fk = json(&["fk", "panda", "--q", &q], 0);
    let position = |value: &serde_json::Value| numbers(&value["pose"]["position"]);
    assert!(difference(&position(&fk), &position(&report)) < 1e-15);
    assert!((numbers(&fk["pose"]["position"])[0] - 0.45).abs() < 1e-6);
    assert!(report["steps"].as_u64().unwrap() > 0 && report["time"].as_f64().unwrap() > 0.0);
    assert!(report["min_singular_ratio"].as_f64().unwrap() > 0.0);
    assert!(report["limits_hit"].as_array().unwrap().iter().all(|l| l["kind"].is_string()));
    assert_eq!(report["largest_lag"], 0.0);
}

#[test]
fn the_default_ramp_is_named_and_can_be_switched_off() {
    assert!(text(&["info", "ur5e"]).contains("default ramp of 20"));
    assert!(text(&["info", "stewart"]).contains("45.4302 m/s^2 of slides"));
    assert!(!text(&["info", "panda"]).contains("default ramp"));
    let time = |more: &[&str]| {
        let report = json(&[&["move", "ur5e", "--to", "0.4,0.2,0.5"], more].concat(), 0);
        report["time"].as_f64().unwrap()
    };
    let (ramp, weak, off) =
        (time(&[]), time(&["--acceleration", "1"]), time(&["--acceleration", "inf"]));
    assert!(ramp < weak && off < weak && (off - ramp).abs() > 1e-9, "{off} {ramp} {weak}");
    // A reconfiguration, whose joint motion has bounds of its own.
    let command = ["move", "puma560", "--to", "-0.5,0.2,0.3", "--acceleration", "inf"];
    assert_eq!(json(&command, 0)["reached"], true);
}

#[test]
fn without_an_orientation_only_the_position_is_controlled() {
    let report = json(&["move", "panda", "--to", "-0.3, 0.1,", "0.2"], 0);
    assert_eq!(report["task"], serde_json::json!(["x", "y", "z"]));
    assert!(text(&["move", "panda", "--to", "4e-1,0,0.4"]).contains("position only"));
}

#[test]
fn a_target_out_of_reach_is_a_negative_answer() {
    let report = json(&["move", "panda", "--to", "2,0,0.3"], 1);
    assert_eq!((&report["reached"], &report["reason"]), (&false.into(), &"out-of-reach".into()));
    assert!(report["explanation"].as_str().unwrap().contains("Bring the target nearer"));
}

#[test]
fn too_few_joints_name_what_remains() {
    let command = ["move", "youbot", "--to", "0.3,0.1,0.3", "--rpy", "0.3,1.5,0.2"];
    assert_eq!(json(&command, 1)["reason"], "too-few-joints");
    let output = cylindroid(&command);
    assert!(String::from_utf8_lossy(&output.stdout).contains("not reached"));
}

#[test]
fn time_limit_is_a_negative_answer() {
    let report = json(&["move", "panda", "--to", "0.4,0.1,0.4", "--time-limit", "0.1"], 1);
    assert_eq!(report["reason"], "time-limit");
    assert!(report["time"].as_f64().unwrap() < 0.102);
}

#[test]
fn every_inverse_and_secondary_task_reaches() {
    for inverse in [
        "truncated",
        "damped",
        "variable-damping",
        "numerical-filtering",
        "selectively-damped",
        "singular-value-filtering",
    ] {
        let report = json(&["move", "panda", "--to", "0.4,0.1,0.4", "--inverse", inverse], 0);
        assert_eq!(report["inverse"], inverse);
    }
    for secondary in
        ["posture", "centring=0.5", "limit-avoidance,margin=0.2", "manipulability=2", "none"]
    {
        let report = json(&["move", "panda", "--to", "0.4,0.1,0.4", "--secondary", secondary], 0);
        let count = report["secondary"].as_array().unwrap().len();
        assert_eq!(count, usize::from(secondary != "none"), "{secondary}");
    }
}

#[test]
fn a_line_stays_straight() {
    let command = ["move", "panda", "--to", "0.45,0.15,0.35", "--rpy", "3.1416,0,0.6", "--line"];
    for law in ["trapezoidal", "jerk-limited"] {
        let report = json(&[&command[..], &["--law", law]].concat(), 0);
        assert!(report["path_deviation"]["position"].as_f64().unwrap() < 1e-4, "{law}");
        assert!(report["path_deviation"]["orientation"].as_f64().unwrap() < 1e-4, "{law}");
        assert!(report["time"].as_f64().unwrap() >= report["law_duration"].as_f64().unwrap());
    }
}

#[test]
fn an_arc_goes_through_its_point() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("arc.json");
    let path = file.to_str().unwrap();
    let command = ["move", "panda", "--to", "0.4,-0.3,0.4", "--via", "0.5,0,0.6", "--out", path];
    json(&command, 0);
    let way: serde_json::Value = serde_json::from_slice(&std::fs::read(&file).unwrap()).unwrap();
    let nearest = way["samples"].as_array().unwrap().iter().map(|sample| {
        let p = numbers(&sample["position"]);
        ((p[0] - 0.5).powi(2) + p[1].powi(2) + (p[2] - 0.6).powi(2)).sqrt()
    });
    assert!(nearest.fold(f64::INFINITY, f64::min) < 1e-3);
}

#[test]
fn joints_go_straight_and_end_together() {
    let report = json(&["move", "panda", "--joint-to", "panda_joint1=30", "--degrees"], 0);
    let q = numbers(&report["q"]);
    assert!((q[0] - std::f64::consts::FRAC_PI_6).abs() < 1e-15);
    assert_eq!(q[1..], numbers(&report["start"])[1..]);
}

#[test]
fn files_hold_every_step() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (csv, svg) = (file("way.csv"), file("way.svg"));
    let target = ["move", "ur5e", "--to", "0.4,0.2,0.5"];
    let report = json(&[&target[..], &["--out", &csv, "--plot", &svg]].concat(), 0);

    let mut reader = csv::Reader::from_path(&csv).unwrap();
    let header: Vec<String> = reader.headers().unwrap().iter().map(str::to_owned).collect();
    assert_eq!(header[..2], ["time", "q.shoulder_pan_joint"]);
    assert_eq!(
        header[13..],
        [
            "x",
            "y",
            "z",
            "qw",
            "qx",
            "qy",
            "qz",
            "position_error",
            "orientation_error",
            "singular_ratio",
            "limits",
        ]
    );
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    assert_eq!(rows.len() as u64, report["steps"].as_u64().unwrap() + 1);
    let numbers_of = |row: &csv::StringRecord| -> Vec<f64> {
        row.iter().take(row.len() - 1).map(|x| x.parse().unwrap()).collect()
    };
    let last = numbers_of(rows.last().unwrap());
    assert!(difference(&last[1..7], &numbers(&report["q"])) < 2e-15, "full precision");
    let mut limits: Vec<String> = rows
        .iter()
        .flat_map(|row| row[23].split("; ").map(str::to_owned).collect::<Vec<_>>())
        .filter(|limit| !limit.is_empty())
        .collect();
    limits.sort();
    limits.dedup();
    let hit = report["limits_hit"].as_array().unwrap().iter().map(|limit| {
        format!("{} {}", limit["joint"].as_str().unwrap(), limit["kind"].as_str().unwrap())
    });
    let mut hit: Vec<String> = hit.collect();
    hit.sort();
    assert!(!hit.is_empty() && limits == hit, "{limits:?} {hit:?}");

    let drawing = std::fs::read_to_string(&svg).unwrap();
    assert!(drawing.starts_with("<svg") && drawing.trim_end().ends_with("</svg>"));
    for words in ["shoulder_pan_joint", "time [s]", "error [m, rad]", "joints [rad]"] {
        assert!(drawing.contains(words), "{words}");
    }
}

/// A robot that lags arrives later; values that define none name their flag.
#[test]
fn a_robot_that_lags_arrives_later() {
    let command = ["move", "panda", "--to", "0.45,0.15,0.35", "--rpy", "3.1416,0,0.6"];
    let time = |more: &[&str]| json(&[&command, more].concat(), 0)["time"].as_f64().unwrap();
    let ideal = time(&[]);
    let plant = ["--delay", "0.02", "--time-constant", "0.06"];
    let later = time(&plant) - ideal;
    assert!(later > 0.05 && later < 2.0, "{later}");
    let noise = ["--noise", "1e-5", "--tolerance-position", "1e-3"];
    time(&[&plant[..], &noise, &["--tolerance-orientation", "1e-3"]].concat());
    for flag in ["--delay", "--time-constant", "--noise"] {
        let message = refused(&[&command[..], &[flag, "-1"]].concat());
        assert!(message.contains(flag), "{message}");
    }
}

/// A closed chain that lags stops before a type II singularity with that reason, not with an error
/// about a `q` that nobody gave.
#[test]
fn loops_that_lag_stall() {
    let command = ["move", "five-bar", "--to", "0.5,2.2,0", "--dt", "0.002"];
    for lag in ["--time-constant", "--delay"] {
        let report = json(&[&command[..], &[lag, "0.05"]].concat(), 1);
        assert!(report["explanation"].as_str().unwrap().contains("type II"), "{lag}: {report}");
    }
}

#[test]
fn a_stall_at_limits_goes_round_or_offers_another_posture() {
    let command = ["move", "puma560", "--to", "-0.5,0.2,0.3"];
    let report = json(&[&command[..], &["--no-reconfigure"]].concat(), 1);
    assert_eq!(report["reason"], "limits");
    let round = json(&command, 0);
    assert_eq!(
        (&round["reconfigured"], &round["reconfiguration_reason"]),
        (&true.into(), &"limits".into())
    );
    let q = numbers(&report["other_configuration"]).iter().map(f64::to_string).collect::<Vec<_>>();
    json(&[&command[..], &["--q", &q.join(",")]].concat(), 0);
}

/// The joint motion of a reconfiguration keeps --speed: it took 2.9 s and 0.6 s before.
#[test]
fn a_reconfiguration_keeps_the_speed_of_the_tool() {
    let report = json(&["move", "puma560", "--to", "-0.5,0.2,0.3", "--speed", "0.05"], 0);
    assert_eq!(report["reconfigured"], true);
    assert!(report["time"].as_f64().unwrap() > 20.0, "{report}");
    let crawl = ["move", "panda", "--to", "0.45,0.15,0.35", "--speed=1e-300", "--time-limit", "5"];
    let report = json(&crawl, 1);
    assert_eq!((&report["reached"], &report["reason"]), (&false.into(), &"time-limit".into()));
}

/// A pose that the youBot reaches, its tool 25 degrees below the horizontal.
const BELOW: [&str; 4] =
    ["--to", "0.416601,0.176136,0.192563", "--quaternion", "0.513313,-0.0841979,0.83917,0.158786"];
/// Six digits of a pose are reached to five.
const LOOSE: [&str; 4] = ["--tolerance-position", "1e-5", "--tolerance-orientation", "1e-5"];

fn youbot<'a>(more: &[&'a str]) -> Vec<&'a str> {
    [&["move", "youbot"], &BELOW[..], &LOOSE[..], more].concat()
}

#[test]
fn hyperbolic_inverses_reach() {
    for inverse in [
        &["--inverse", "hyperbolic", "--h", "0.1"][..],
        &["--inverse", "hyperbolic", "--h", "inf"],
        &["--inverse", "hyperbolic-damped", "--h", "0.1", "--mu", "1e-4"],
        &["--inverse", "hyperbolic-gram", "--h", "0.1", "--lambda", "1e-4"],
        &["--inverse", "oblique", "--give-up", "rx"],
    ] {
        let report = json(&youbot(inverse), 0);
        assert_eq!(report["inverse"], inverse[1], "{inverse:?}");
        assert_eq!(report["steps_without_inverse"], 0);
    }
}

/// Straight down no hyperbolic inverse exists: said, and left to what the user named.
#[test]
fn where_no_inverse_exists_it_is_said() {
    let down = ["move", "youbot", "--q", "0.4,0.6,0.9,1.641592653589793,0.2"];
    let target = ["--to", "0.2350376,0.0993723,0.04", "--task", "pose"];
    let inverse = ["--inverse", "hyperbolic", "--h", "0.1"];
    let command = [&down[..], &target, &inverse].concat();
    let report = json(&command, 1);
    assert_eq!(report["reason"], "no-inverse");
    let why = report["explanation"].as_str().unwrap();
    assert!(why.contains("reciprocal is of class inf") && why.contains("--fallback"), "{why}");
    let command = [&command[..], &["--fallback", "truncated"]].concat();
    let report = json(&command, 0);
    assert_eq!(report["fallback"], "truncated");
    assert!(report["steps_without_inverse"].as_u64().unwrap() > 100);
    assert!(report["no_inverse"].as_str().unwrap().contains("class inf"));
    assert!(text(&command).contains("taken by the fallback"));
}

#[test]
fn the_pitch_is_asked_for_with_advice() {
    let refused = |more: &[&str]| crate::refused(&youbot(more));
    let text = refused(&["--inverse", "hyperbolic"]);
    assert!(text.contains("at the start --h"), "{text}");
    let text = refused(&["--inverse", "hyperbolic", "--h", "nan"]);
    assert!(text.contains("--h = NaN"), "{text}");
    let text = refused(&["--inverse", "damped", "--h", "0.1"]);
    assert!(text.contains("--h = 0.1") && text.contains("belongs to hyperbolic"), "{text}");
    let text = refused(&["--inverse", "damped", "--fallback", "truncated"]);
    assert!(text.contains("always exists"), "{text}");
    let text = refused(&["--inverse", "hyperbolic", "--h", "0.1", "--fallback", "oblik"]);
    assert!(text.contains("oblique"), "{text}");
    let text = refused(&["--inverse", "hyperbolic-damped", "--h", "0.1"]);
    assert!(text.contains("--mu"), "{text}");
    let text = refused(&["--inverse", "oblique", "--give-up", "1,2"]);
    assert!(text.contains("six numbers"), "{text}");
}

#[test]
fn a_twist_is_followed_for_a_time() {
    let twist = ["move", "panda", "--twist", "0,0.05,-0.1,0,0,0.2", "--duration", "1.5"];
    let report = json(&twist, 0);
    assert_eq!((&report["reached"], &report["reason"]), (&true.into(), &"reached".into()));
    assert!(report["explanation"].as_str().unwrap().contains("followed the twist"));
    // The joints accelerate within their limits: it is late by a little.
    assert!(report["position_error"].as_f64().unwrap() < 5e-3);
    assert!(report["time"].as_f64().unwrap() >= 1.5);
    assert!(text(&twist).contains("twist followed"));
    let along_the_tool = json(&[&twist[..], &["--task-axes", "local"]].concat(), 0);
    assert!(along_the_tool["position_error"].as_f64().unwrap() < 5e-3);
    let out = ["move", "panda", "--twist", "0,0,0.3,0,0,0", "--duration", "20"];
    let report = json(&out, 1);
    assert!(["singular", "limits"].contains(&report["reason"].as_str().unwrap()), "{report}");
    for (more, expected) in
        [(&["--duration", "0"][..], "--duration"), (&["--to", "0.4,0,0.4"], "cannot be used with")]
    {
        let output = cylindroid(&[&twist[..4], more].concat());
        assert_eq!(output.status.code(), Some(2));
        assert!(String::from_utf8_lossy(&output.stderr).contains(expected), "{output:?}");
    }
}

/// Beyond the speeds of the joints, or for a short time: a twist that is done in part is not followed.
#[test]
fn a_twist_beyond_the_limits_says_what_is_missing() {
    for twist in [
        &["panda", "--twist", "0,0,-5,0,0,0"][..],
        &["ur5e", "--twist", "0,0,-5,0,0,0"],
        &["stewart", "--twist", "0,0,-5,0,0,0", "--duration", "0.1"],
        &["panda", "--twist", "0,0,-0.1,0,0,0", "--speed", "0.05"],
    ] {
        let command = [&["move"], twist].concat();
        let report = json(&command, 1);
        let followed = report["followed"].as_f64().unwrap();
        assert!(report["reached"] == false && followed < 0.95, "{twist:?}: {report}");
        if report["reason"] == "slowed" {
            assert!(report["explanation"].as_str().unwrap().contains("a slower twist"), "{report}");
        }
        let table = String::from_utf8(cylindroid(&command).stdout).unwrap();
        assert!(table.contains("twist not followed"), "{table}");
    }
    // A weak arm makes up while it brakes for what it lacks while it accelerates.
    let weak = ["move", "panda", "--twist", "0,0,-0.1,0,0,0", "--acceleration", "1"];
    let report = json(&weak, 0);
    assert!((report["followed"].as_f64().unwrap() - 1.0).abs() < 0.05, "{report}");
}

#[test]
fn limits_of_a_file_bound_the_joints() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("slow.toml");
    let slow: String = (1..=3).map(|i| format!("[panda_joint{i}]\nvelocity = 0.05\n")).collect();
    std::fs::write(&file, slow + "[panda_joint4]\nupper = -1.0").unwrap();
    let file = file.to_str().unwrap();
    let info = json(&["info", "panda", "--limits", file], 0);
    assert_eq!(info["coordinates"][1]["velocity"], 0.05);
    assert_eq!(info["coordinates"][3]["upper"], -1.0);
    let to = ["--to", "0.45,0.15,0.35", "--rpy", "3.1416,0,0.6"];
    let slow = json(&[&["move", "panda", "--limits", file], &to[..]].concat(), 0);
    let fast = json(&[&["move", "panda"], &to[..]].concat(), 0);
    assert!(slow["time"].as_f64().unwrap() > 2.0 * fast["time"].as_f64().unwrap());
    assert!(numbers(&slow["q"])[3] <= -1.0);
    std::fs::write(file, "[panda_joint9]\nvelocity = 1").unwrap();
    let output = cylindroid(&["ik", "panda", "--to", "0.4,0,0.4", "--limits", file]);
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(error.contains("1:2") && error.contains("panda_joint1"), "{error}");
}

#[test]
fn waypoints_are_passed_without_stopping() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("way.csv");
    let write = |text: &str| std::fs::write(&file, text).unwrap();
    let command = ["move", "panda", "--waypoints", file.to_str().unwrap()];
    write("x,y,z\n0.45,0.0,0.55\n0.45,0.15,0.55\n0.45,0.15,0.4\n");
    let report = json(&command, 0);
    assert_eq!(
        (&report["reached"], &report["task"]),
        (&true.into(), &serde_json::json!(["x", "y", "z"]))
    );
    let end = numbers(&report["pose"]["position"]);
    assert!(difference(&end, &[0.45, 0.15, 0.4]) < 1e-6);
    assert!(report["law_duration"].as_f64().unwrap() < 4.0);
    write("2,0.45,0.0,0.55,0,1,0,0\n4,0.45,0.15,0.55,0,1,0,0.1\n");
    let report = json(&command, 0);
    assert_eq!(report["task"].as_array().unwrap().len(), 6);
    assert!((report["law_duration"].as_f64().unwrap() - 4.0).abs() < 1e-9);
    for (text, more, expected) in [
        ("0.45,0,0.55\n0.4,0.1", &[][..], "numbers; rows have 3"),
        ("0.1,0.45,0.2,0.55", &[], "too short for the accelerations"),
        ("", &[], "no rows"),
        ("0.45,0,0.55", &["--law", "jerk-limited"], "--law"),
    ] {
        write(text);
        let output = cylindroid(&[&command[..], more].concat());
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && error.contains(expected), "{error}");
    }
}

/// Also of an actuated joint that closes a loop, which has no coordinate; and what `move` writes,
/// `sweep` reads.
#[test]
fn limits_of_all_velocities_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (csv, js) = (file("m.csv"), file("m.json"));
    let target = ["--actuated", "q1,q5", "--task", "coupler=1.05,1.95,0", "--acceleration", "1"];
    for out in [&csv, &js] {
        // Singular at last: the limits on the way count.
        json(&[&["move", "five-bar"], &target[..], &["--out", out]].concat(), 1);
    }
    let whole: serde_json::Value = serde_json::from_slice(&std::fs::read(&js).unwrap()).unwrap();
    let samples = whole["samples"].as_array().unwrap();
    let limits = samples.iter().flat_map(|s| s["limits"].as_array().unwrap().clone());
    let joints: std::collections::BTreeSet<String> =
        limits.map(|limit| limit["joint"].as_str().unwrap().to_owned()).collect();
    assert!(joints.contains("q5") && !joints.contains(""), "{joints:?}");
    assert!(std::fs::read_to_string(&csv).unwrap().contains("q5 acceleration"));
    let panda = file("p.csv");
    json(&["move", "panda", "--to", "0.4,0.1,0.4", "--out", &panda], 0);
    for (robot, path) in [("panda", &panda), ("five-bar", &csv)] {
        let rows = std::fs::read_to_string(path).unwrap().lines().count() - 1;
        let swept = json(&["sweep", robot, "--configurations", path, "--quantities", "pose"], 0);
        assert_eq!(swept["rows"].as_u64().unwrap_or(0), rows as u64, "{swept}");
    }
    let broken = file("b.csv");
    std::fs::write(&broken, "q.a,limits,q.b\n0,x,0\n0,,none\n").unwrap();
    let stderr =
        crate::refused(&["sweep", "panda", "--configurations", &broken, "--quantities", "pose"]);
    assert!(stderr.contains("no column 'panda_joint1'"), "{stderr}");
}

/// A pipe would wait for its reader, and a folder is no file.
#[cfg(unix)]
#[test]
fn outputs_are_regular_files_or_new_ones() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let moves = ["move", "3r", "--joint-to", "joint2=0.1"];
    let map = ["map", "five-bar", "--over", "x=0.5:1:2", "--over", "y=1:1.3:2"];
    for (command, option, end) in [
        (&moves[..], "--out", "csv"),
        (&moves, "--out", "json"),
        (&moves, "--plot", "svg"),
        (&["sweep", "3r", "--samples", "2"], "--out", "csv"),
        (&map, "--out", "csv"),
        (&map, "--out", "json"),
    ] {
        let (pipe, taken) = (path(&format!("pipe.{end}")), path(&format!("folder.{end}")));
        if !std::fs::exists(&pipe).unwrap() {
            assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        }
        let _ = std::fs::create_dir(&taken);
        for (file, says) in [(pipe, "device, pipe or socket"), (taken, "it is a folder")] {
            let message = refused(&[command, &[option, &file]].concat());
            assert!(message.contains(says), "{command:?} {option} {file}: {message}");
        }
        // A file is replaced.
        let file = path(&format!("file.{end}"));
        std::fs::write(&file, "old").unwrap();
        json(&[command, &[option, &file]].concat(), 0);
        assert!(std::fs::metadata(&file).unwrap().len() > 3);
    }
}
