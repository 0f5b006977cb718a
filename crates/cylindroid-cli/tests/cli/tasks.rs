//! `move` with several tasks, and at a distance from other bodies.

use std::fs;

use serde_json::{Value, json as object};

use crate::distance::CELL;
use crate::{json, numbers, refused, text};

const TASKS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/tasks.toml");

fn position(model: &str, q: &Value, frame: &str) -> Vec<f64> {
    let q = numbers(q).iter().map(f64::to_string).collect::<Vec<_>>().join(",");
    numbers(&json(&["fk", model, "--q", &q, "--frame", frame], 0)["pose"]["position"])
}

fn file(content: &str) -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tasks.toml");
    fs::write(&path, content).unwrap();
    let path = path.to_str().unwrap().to_owned();
    (folder, path)
}

#[test]
fn frames_as_arguments() {
    let command =
        ["move", "panda", "--task", "hand_tcp=0.36,0.1,0.5", "--task", "link4=0.05,0.05,0.65"];
    let report = json(&command, 1);
    assert_eq!((&report["reached"], &report["tasks"][0]["level"]), (&false.into(), &0.into()));
    assert_eq!(report["tasks"][1]["name"], "link4");
    // One of them alone is reached.
    let report = json(&command[..4], 0);
    assert_eq!((&report["reason"], &report["explanation"]), (&"reached".into(), &"".into()));
    let at = position("panda", &report["q"], "hand_tcp");
    for (x, expected) in at.iter().zip([0.36, 0.1, 0.5]) {
        assert!((x - expected).abs() < 2e-6, "{at:?}");
    }
    // Beside --to, and with an orientation.
    let both = ["move", "panda", "--to", "0.4,0,0.5", "--task", "link4=0,0,0.66,0,0,0"];
    let report = json(&[&both[..], &["--time-limit", "0.1"]].concat(), 1);
    assert_eq!(
        (&report["reason"], &report["tasks"][0]["name"]),
        (&"time-limit".into(), &"hand_tcp".into())
    );
    assert!(report["tasks"][1]["orientation_error"].as_f64().unwrap() > 0.1);
}

#[test]
fn a_file_of_tasks() {
    let report = json(&["move", "panda", "--tasks", TASKS], 0);
    let tasks = report["tasks"].as_array().unwrap();
    let names: Vec<&str> = tasks.iter().map(|t| t["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["hand", "elbow", "posture"]);
    assert_eq!((&tasks[0]["status"], &tasks[2]["level"]), (&"reached".into(), &Value::Null));
    let table = text(&["move", "panda", "--tasks", TASKS]);
    assert!(table.contains("lowest") && table.contains("elbow"), "{table}");
}

#[test]
fn every_type_of_task() {
    let (_folder, path) = file(
        "[[task]]\ntype = 'relative_frame'\nframe = 'hand_tcp'\nreference = 'link4'\n\
         [[task]]\ntype = 'gaze'\nframe = 'hand_tcp'\npoint = [0.5, 0, 0]\ntool = [0, 0, 0.1]\n\
         level = 1\nweight = 2.0\ntolerance_orientation = 0.1\n\
         [[task]]\nname = 'up'\nframe = 'link4'\ncomponents = 'z'\naxes = 'world'\nlevel = 2\n\
         [[task]]\ntype = 'joint_velocities'\nvelocities = { panda_joint1 = 0.1 }\n\
         [[task]]\ntype = 'posture'\nq = [0, -0.7, 0, -2.3, 0, 1.5, 0.7]\n\
         [[task]]\ntype = 'manipulability'\nframe = 'hand_tcp'\ngain = 0.1\n\
         [[task]]\ntype = 'limit_avoidance'\nmargin = 0.05\n\
         [[task]]\nname = 'slide'\nframe = 'hand_tcp'\ncomponents = 'y'\nvelocity = [0, 0.1, 0]\n\
         gain = 0\nlevel = 3\n",
    );
    let report = json(&["move", "panda", "--tasks", &path, "--time-limit", "0.5"], 1);
    let tasks = report["tasks"].as_array().unwrap();
    let names: Vec<&str> = tasks.iter().map(|t| t["name"].as_str().unwrap()).collect();
    let all = ["hand_tcp from link4", "gaze", "up", "joint_velocities", "posture"];
    assert_eq!(names[..5], all);
    assert_eq!(names[5..], ["manipulability", "limit_avoidance", "slide"]);
    assert_eq!(tasks[0]["status"], "reached");
    assert_eq!((&tasks[1]["level"], &tasks[1]["weight"]), (&1.into(), &2.0.into()));
}

#[test]
fn half_spaces_and_boxes() {
    let (_folder, path) = file(
        "[[task]]\nframe = 'hand_tcp'\nxyz = [0.4, 0.3, 0.4]\n\
         [[half_space]]\nframe = 'hand_tcp'\npoint = [0, 0.1, 0]\nnormal = [0, -2, 0]\nname = 'door'\n\
         [[box]]\nframe = 'hand_tcp'\ncenter = [0.4, 0, 0.4]\nsize = [1, 1, 1]\n",
    );
    let report = json(&["move", "panda", "--tasks", &path], 1);
    assert_eq!(
        (&report["reason"], &report["tasks"][0]["half_space"]),
        (&"half-space".into(), &"door".into())
    );
    assert!(report["explanation"].as_str().unwrap().contains("half-space 'door'"));
    let y = position("panda", &report["q"], "hand_tcp")[1];
    assert!((y - 0.1).abs() < 1e-6 && y <= 0.1 + 1e-12, "{y}");
    for (table, message) in [
        ("[[half_space]]\nframe = 'nose'\npoint = [0, 0, 0]\nnormal = [0, 0, 1]\n", "nose"),
        ("[[half_space]]\nframe = 'hand_tcp'\npoint = [0, 0, 0]\nnormal = [0, 0, 0]\n", "normal"),
        ("[[box]]\nframe = 'hand_tcp'\ncenter = [0, 0, 0]\nsize = [0, 1, 1]\n", "side of a box"),
        ("[[box]]\nframe = 'hand_tcp'\ncenter = [0, 0, 0]\nsizes = [1, 1, 1]\n", "sizes"),
    ] {
        let (_folder, path) = file(&format!("[[task]]\nframe = 'hand_tcp'\n{table}"));
        let error = refused(&["move", "panda", "--tasks", &path]);
        assert!(error.contains(message), "{error}");
    }
}

/// The platform of a closed chain, and priorities among its tasks.
#[test]
fn tasks_of_closed_chains() {
    let to = ["move", "stewart", "--task", "platform=0.05,0.02,1.05"];
    let report = json(&to, 0);
    let at = position("stewart", &report["q"], "platform");
    for (x, expected) in at.iter().zip([0.05, 0.02, 1.05]) {
        assert!((x - expected).abs() < 1e-5, "{at:?}");
    }
    let (_folder, path) = file(
        "[[task]]\nframe = 'platform'\nrpy = [0.1, 0, 0]\n\
         [[task]]\nname = 'height'\nframe = 'platform'\nxyz = [0, 0, 1.1]\ncomponents = 'z'\nlevel = 1\n",
    );
    let report = json(&["move", "stewart", "--tasks", &path], 0);
    assert_eq!(report["tasks"][1]["status"], "reached");
}

#[test]
fn obstacles_are_avoided() {
    let to = ["move", CELL, "--to", "0.406,0,0.337"];
    let free = json(&[&to[..], &["--avoid"]].concat(), 0);
    let nearest = &free["distances"]["nearest"];
    assert!(nearest["distance"].as_f64().unwrap() > 0.01, "{nearest}");
    let ball = ["--obstacle", "ball=sphere:0.1@0.366,0,0.287"];
    let stopped = json(&[&to[..], &ball].concat(), 1);
    assert_eq!(stopped["distances"]["obstacles"], object!(["ball"]));
    let nearest = &stopped["distances"]["nearest"];
    assert!((nearest["distance"].as_f64().unwrap() - 0.01).abs() < 1e-4, "{nearest}");
    assert_eq!(nearest["b"], "ball");
    let wide = json(&[&to[..], &ball, &["--gap", "0.015"]].concat(), 1);
    assert!(wide["distances"]["nearest"]["distance"].as_f64().unwrap() > 0.0149);
    let table = String::from_utf8(crate::cylindroid(&[&to[..], &ball].concat()).stdout).unwrap();
    assert!(table.contains("ball") && table.contains("not reached"), "{table}");
}

/// The hand of an arm whose joints are partly slow is nearer to its target after the same time.
#[test]
fn least_squares_come_nearer_than_a_kept_direction() {
    let folder = tempfile::tempdir().unwrap();
    let limits = folder.path().join("limits.toml");
    let slow = [1, 3, 5].map(|i| format!("[panda_joint{i}]\nvelocity = 0.02\n"));
    fs::write(&limits, slow.concat()).unwrap();
    let limits = ["--limits", limits.to_str().unwrap(), "--time-limit", "1"];
    let to = ["move", CELL, "--task", "hand_tcp=0.2,0.45,0.3"];
    let error = |more: &[&str]| {
        let answer = json(&[&to[..], &limits, more].concat(), 1);
        answer["tasks"][0]["position_error"].as_f64().unwrap()
    };
    let (kept, least) = (error(&[]), error(&["--least-squares"]));
    assert!(least < 0.95 * kept, "{least} {kept}");
}

#[test]
fn files_hold_every_step_of_all_tasks() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (csv, way, svg) = (file("way.csv"), file("way.json"), file("way.svg"));
    let command = ["move", CELL, "--to", "0.4,0.25,0.3", "--tasks", TASKS];
    let ball = ["--obstacle", "ball=sphere:0.08@0.4,0.25,0.3"];
    let all = [&command[..], &ball, &["--out", &csv, "--plot", &svg]].concat();
    let report = json(&all, 1);

    let mut reader = csv::Reader::from_path(&csv).unwrap();
    let header: Vec<String> = reader.headers().unwrap().iter().map(str::to_owned).collect();
    assert_eq!(header[..2], ["time", "q.panda_joint1"]);
    let pose = ["x", "y", "z", "qw", "qx", "qy", "qz"];
    let rest = ["position_error", "orientation_error", "scale"];
    let names = |task: &str, of: &[&str]| -> Vec<String> {
        of.iter().map(|part| format!("{task}.{part}")).collect()
    };
    let mut expected = names("hand_tcp", &[&pose[..], &rest].concat());
    expected.extend(names("hand", &[&pose[..], &rest].concat()));
    expected.extend(names("elbow", &[&pose[..], &rest].concat()));
    expected.extend(names("posture", &rest));
    expected.extend(["nearest", "limits"].map(str::to_owned));
    assert_eq!(header[15..], expected);
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    assert_eq!(rows.len() as u64, report["steps"].as_u64().unwrap() + 1);
    let value = |row: &csv::StringRecord, name: &str| -> f64 {
        row[header.iter().position(|h| h == name).unwrap()].parse().unwrap()
    };
    let last = rows.last().unwrap();
    let q = numbers(&report["q"]);
    assert!((value(last, "q.panda_joint3") - q[2]).abs() < 2e-15, "full precision");
    let at = position(CELL, &report["q"], "hand_tcp");
    assert!((value(last, "hand_tcp.y") - at[1]).abs() < 1e-12);
    for key in ["position_error", "orientation_error", "scale"] {
        let told = report["tasks"][0][key].as_f64().unwrap();
        assert!((value(last, &format!("hand_tcp.{key}")) - told).abs() < 1e-15, "{key}");
    }
    let nearest = rows.iter().map(|row| value(row, "nearest")).fold(f64::INFINITY, f64::min);
    // serde_json reads some numbers one rounding off.
    let told = report["distances"]["nearest"]["distance"].as_f64().unwrap();
    assert!((nearest - told).abs() < 1e-15, "{nearest} {told}");

    let drawing = fs::read_to_string(&svg).unwrap();
    assert!(drawing.starts_with("<svg") && drawing.trim_end().ends_with("</svg>"));
    for words in ["panda_joint7", "elbow [m]", "realised velocity [-]", "distance [m]"] {
        assert!(drawing.contains(words), "{words}");
    }

    json(&["move", "panda", "--tasks", TASKS, "--out", &way, "--plot", &svg], 0);
    let way: Value = serde_json::from_str(&fs::read_to_string(&way).unwrap()).unwrap();
    assert_eq!(way["tasks"], object!(["hand", "elbow", "posture"]));
    let first = &way["samples"][0];
    assert_eq!((&first["nearest"], &first["tasks"][2]["position"]), (&Value::Null, &Value::Null));
    assert_eq!(numbers(&first["tasks"][0]["quaternion"]).len(), 4);
    assert!(!fs::read_to_string(&svg).unwrap().contains("distance [m]"));
    assert!(refused(&[&command[..], &["--out", "way.txt"]].concat()).contains(".csv or .json"));
    assert!(refused(&[&command[..], &["--plot", "way.png"]].concat()).contains(".svg"));
}

#[test]
fn what_has_no_effect_is_refused() {
    for (more, message) in [
        (&["--gap", "0.1"][..], "--gap has no effect without --avoid"),
        (&["--samples", "9"], "--samples has no effect"),
        (&["--least-squares"], "--least-squares has no effect on the servo of one frame"),
        (&["--avoid", "--line"], "--line belongs to the servo of one frame"),
        (&["--avoid", "--inverse", "damped"], "--inverse belongs to"),
        (&["--avoid", "--damping", "0.1"], "--damping belongs to"),
        (&["--avoid", "--gain", "4,5"], "one gain"),
        (&["--avoid", "--gap", "0.4"], "margin"),
        (&["--task", "x", "--task", "y"], "given twice"),
        (&["--task", "link4=1,2"], "2 numbers"),
        (&["--task", "link99=1,2,3"], "nearest: link"),
        (&["--task", "hand_tcp=1,2,3"], "two tasks have this name"),
        (&["--tasks", "/dev/null"], "not a regular file"),
        (&["--tasks", "none.toml"], "none.toml"),
    ] {
        let error = refused(&[&["move", "panda", "--to", "0.4,0,0.4"], more].concat());
        assert!(error.contains(message), "{more:?}: {error}");
    }
    let folder = tempfile::tempdir().unwrap();
    let large = folder.path().join("large.toml");
    std::fs::write(&large, format!("a = [{}]", "1,".repeat(1 << 19))).unwrap();
    let error = refused(&["move", "panda", "--tasks", large.to_str().unwrap()]);
    assert!(error.contains("larger than 1 MiB"), "{error}");
    let error = refused(&["move", "panda", "--tasks", TASKS, "--frame", "link4"]);
    assert!(error.contains("--frame: there is no target"), "{error}");
    let inside = ["move", CELL, "--to", "0.4,0,0.4", "--obstacle", "ball=sphere:0.1@0.31,0,0.5"];
    assert!(refused(&inside).contains("--q: flange and ball penetrate each other"));
    let error = refused(&["move", "panda", "--task", "link4=1,2,3", "--actuated", "panda_joint1"]);
    assert!(error.contains("all joints are actuated"), "{error}");
    assert!(refused(&["move", "panda", "--avoid"]).contains("--tasks FILE.toml"));
}

#[test]
fn a_broken_file_is_shown_with_its_place() {
    for (content, words) in [
        ("", &["no [[task]]"][..]),
        ("[[task]]\nframe = 3", &["tasks.toml:2:9", "string"]),
        ("[[task]]\nfram = 'link4'", &["unknown field `fram`"]),
        ("\n[[task]]\nxyz = [0, 0, 0]", &["tasks.toml:2:1", "needs the key 'frame'"]),
        ("[[task]]\nframe = 'link99'", &["tasks.toml:1:1", "nearest: link"]),
        ("[[task]]\ntype = 'gaz'", &["nearest: gaze"]),
        ("[[task]]\ntype = 'posture'\nq = [1]\nlevel = 1", &["'level' does not belong"]),
        ("[[task]]\ntype = 'posture'\nq = { a = 1 }", &["no joint named 'a'"]),
        ("[[task]]\nframe = 'link4'\naxes = 'mine'", &["axes", "world"]),
        ("[[task]]\ntype = 'center_of_mass'\nxyz = [0, 0, 0]", &["mass"]),
        ("[[task]]\ntype = 'center_of_mass'\nxyz = [0, 0, 0]\ncomponents = 'rx'", &["x, y and z"]),
        ("[[task]]\nframe = 'link4'\ngain = 1e9", &["below 2"]),
        ("[[task]]\nframe = 'link4'\nxyz = [nan, 0, 0]", &["finite"]),
    ] {
        let (_folder, path) = file(content);
        let error = refused(&["move", "panda", "--tasks", &path]);
        for word in words {
            let flat = error.replace("\n  \u{2502} ", " ");
            assert!(flat.contains(word), "{content}: {error}");
        }
    }
}
