//! Maps: reports, files, pictures, bad input.

use std::fs;
#[cfg(target_os = "linux")]
use std::process::{Command, Stdio};
#[cfg(target_os = "linux")]
use std::thread::sleep;
#[cfg(target_os = "linux")]
use std::time::Duration;

use serde_json::Value;

use crate::{json, numbers, refused, text};

const OVER: [&str; 6] = ["map", "five-bar", "--over", "x=-1.03:3:21", "--over", "y=-1.01:3:21"];

/// The curves of the report, the rows of both files, and the picture belong to one map.
#[test]
fn a_five_bar() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (csv, file, svg) = (at("map.csv"), at("map.json"), at("map.svg"));
    let report = json(&[&OVER[..], &["--out", &csv, "--plot", &svg]].concat(), 0);
    assert_eq!((&report["cells"], &report["free_motions"]), (&441.into(), &0.into()));
    assert_eq!(report["frame"], "reference");
    let modes = report["modes"].as_array().unwrap();
    let loci = report["loci"].as_array().unwrap();
    assert!(modes.len() == 4 && !loci.is_empty());
    let kinds: Vec<&str> = loci.iter().map(|l| l["kind"].as_str().unwrap()).collect();
    assert!(kinds.contains(&"type I") && kinds.contains(&"passive"), "{kinds:?}");
    for point in loci.iter().flat_map(|l| l["points"].as_array().unwrap()) {
        let [x, y] = numbers(point)[..] else { panic!() };
        let (left, right, root) = (x.hypot(y), (x - 2.0).hypot(y), 2.0_f64.sqrt());
        let near = [left - 1.0, left - 3.0, right - root + 1.0, right - root - 1.0];
        assert!(near.iter().any(|d| d.abs() < 1e-8), "{x} {y}");
    }
    let reached: u64 = modes.iter().map(|m| m["cells"].as_u64().unwrap()).sum();
    let lines = fs::read_to_string(&csv).unwrap();
    let first = "mode,x,y,q1,q2,q3,q4,type_one,type_two,limit_distance";
    assert_eq!(lines.lines().next(), Some(first));
    assert_eq!(lines.lines().count() as u64, reached + 1);
    text(&[&OVER[..], &["--out", &file]].concat());
    let whole: Value = serde_json::from_str(&fs::read_to_string(&file).unwrap()).unwrap();
    assert_eq!(whole["loci"], report["loci"]);
    assert_eq!(whole["rows"].as_array().unwrap().len() as u64, reached);
    assert_eq!(whole["columns"][9], "limit_distance");
    let svg = fs::read_to_string(&svg).unwrap();
    assert!(svg.contains("mode 4") && svg.contains("type I") && svg.contains("x [m]"));
    assert_eq!(json(&[&OVER[..], &["--no-loci"]].concat(), 0)["loci"], Value::Array(Vec::new()));
    assert!(text(&OVER).contains("working modes"));
}

/// What all modes reach together, and the disc about the second pivot, which none reaches.
#[test]
fn the_workspace_and_its_hole() {
    let over = ["map", "five-bar", "--over", "x=-1.03:3.51:61", "--over", "y=-2.61:2.57:61"];
    let report = json(&[&over[..], &["--no-loci"]].concat(), 0);
    assert_eq!(
        (&report["size_unit"], &report["workspace"]["is_cut"]),
        (&"m^2".into(), &false.into())
    );
    let [hole] = &report["workspace"]["holes"].as_array().unwrap()[..] else { panic!("{report}") };
    let center = numbers(&hole["center"]);
    assert!((center[0] - 2.0).hypot(center[1]) < 0.03, "{center:?}");
    let disc = std::f64::consts::PI * (2.0_f64.sqrt() - 1.0).powi(2);
    assert!((hole["size"].as_f64().unwrap() / disc - 1.0).abs() < 0.05, "{hole}");
    let of_mode = &report["modes"][0];
    assert!(of_mode["size"].as_f64() <= report["workspace"]["size"].as_f64());
    let shown = text(&[&over[..], &["--no-loci"]].concat());
    assert!(shown.contains("\nany ") && shown.contains("A hole of 0.5"), "{shown}");
    assert!(text(&OVER).contains("ends at the border of the grid"));
}

/// Other drives: the one on the ground closes the loop, and has type II nevertheless.
#[test]
fn other_drives() {
    let command = [&OVER[..], &["--actuated", "q1,q5"]].concat();
    let report = json(&command, 0);
    let kinds: Vec<&Value> =
        report["loci"].as_array().unwrap().iter().map(|l| &l["kind"]).collect();
    // Its legs have links of equal lengths: where one folds, its end is on a joint of the ground.
    assert!(kinds.contains(&&"type II".into()), "{kinds:?}");
}

/// As `sweep` has them, and without a difference.
#[test]
fn threads() {
    let by = |count: &str| text(&[&OVER[..], &["--json", "--threads", count]].concat());
    assert_eq!(by("1"), by("3"));
    let message = refused(&[&OVER[..], &["--threads", "0"]].concat());
    assert!(message.contains("--threads"), "{message}");
}

/// Ctrl-C ends a map in order, without a file.
#[cfg(target_os = "linux")]
#[test]
fn interrupted() {
    let folder = tempfile::tempdir().unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_cylindroid"))
        .args(["map", "five-bar", "--over", "x=-1.03:3:700", "--over", "y=-1.01:3:700"])
        .args(["--out", "map.csv", "--plot", "map.svg"])
        .current_dir(folder.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // As soon as it listens to the signal.
    let status = format!("/proc/{}/status", child.id());
    let listens = || {
        let text = fs::read_to_string(&status).unwrap();
        let caught = text.lines().find_map(|line| line.strip_prefix("SigCgt:")).unwrap();
        u64::from_str_radix(caught.trim(), 16).unwrap() & 2 != 0
    };
    while !listens() {
        assert_eq!(child.try_wait().unwrap(), None);
        sleep(Duration::from_millis(1));
    }
    sleep(Duration::from_millis(200));
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    // No bar where stderr is no terminal.
    assert_eq!((output.stdout, output.stderr), (Vec::new(), b"interrupted\n".to_vec()));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

/// Held, free and given components.
#[test]
fn components() {
    let over = ["map", "stewart", "--over", "x=-0.1:0.1:3", "--starts", "4", "--seed", "2"];
    let report = json(&over, 0);
    let held: Vec<&str> =
        report["held"].as_array().unwrap().iter().map(|h| h["name"].as_str().unwrap()).collect();
    assert_eq!(held, ["y", "z", "yaw", "pitch", "roll"]);
    let more = [&over[..], &["--at", "z=1.05", "--free", "yaw", "--q", "home"]].concat();
    let report = json(&more, 0);
    assert_eq!(report["free_motions"], 1);
    assert_eq!(report["held"][0]["value"], 1.05);
    assert!(text(&more).contains("not distinguished"));
    let tool = [&over[..], &["--frame", "platform", "--tool", "0,0,0.1"]].concat();
    assert_eq!(json(&tool, 0)["tool"][2], 0.1);
    // Nowhere.
    let far = ["map", "five-bar", "--over", "x=20:21:3"];
    assert_eq!(json(&far, 1)["modes"], Value::Array(Vec::new()));
}

#[test]
fn what_is_wrong_is_named() {
    let message = refused(&["map", "five-bar", "--over", "z=0:1:3"]);
    assert!(message.contains("z") && message.contains("rz"), "{message}");
    let message = refused(&["map", "five-bar", "--over", "x=1:0:3"]);
    assert!(message.contains("--over") && message.contains("smaller"), "{message}");
    for held in [&["--over", "x=0:1:3", "--free", "x"][..], &["--at", "x=0", "--free", "x"]] {
        let message = refused(&[&["map", "five-bar", "--over", "y=0:1:3"], held].concat());
        assert!(message.contains("--free = x"), "{message}");
    }
    let twice = ["map", "five-bar", "--actuated", "q1,q5,q1", "--over", "x=0:1:3"];
    let message = refused(&twice);
    assert!(message.contains("--actuated = q1") && message.contains("twice"), "{message}");
    let message = refused(&["map", "five-bar", "--over", "x=0:1:3", "--at", "x=1"]);
    assert!(message.contains("once"), "{message}");
    let message = refused(&["map", "five-bar", "--over", "x=0:1:3", "--plot", "map.svg"]);
    assert!(message.contains("two or three axes"), "{message}");
    let message = refused(&[&OVER[..], &["--out", "map.txt"]].concat());
    assert!(message.contains(".csv or .json"), "{message}");
    let message = refused(&["map", "five-bar", "--over", "x=0:1:1e9", "--over", "y=0:1:1e9"]);
    assert!(message.contains("cells"), "{message}");
    let message = refused(&["map", "five-bar", "--over", "x=0:1:3", "--at", "y"]);
    assert!(message.contains("a name, = and a number"), "{message}");
}

const SPACE: [&str; 8] = [
    "map",
    "3rrr",
    "--over",
    "x=-0.31:0.29:7",
    "--over",
    "y=-0.29:0.33:7",
    "--over",
    "rz=-1.57:1.53:9",
];

/// Vertices and triangles of the file are those of the report, in groups of the modes.
#[test]
fn surfaces_of_three_axes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("locus.obj");
    let mesh = ["--mesh", path.to_str().unwrap()];
    let report = json(&[&SPACE[..], &mesh].concat(), 0);
    let surfaces = report["surfaces"].as_array().unwrap();
    assert!(!surfaces.is_empty() && report["loci"] == Value::Array(Vec::new()));
    let file = fs::read_to_string(&path).unwrap();
    assert!(file.contains("\n# v x [m], y [m], rz [rad]\n"), "{file:.300}");
    let (mut vertices, mut faces, mut groups) = (Vec::new(), Vec::new(), Vec::new());
    for line in file.lines() {
        let mut words = line.split(' ');
        match words.next() {
            Some("v") => vertices.push(words.map(|x| x.parse().unwrap()).collect::<Vec<f64>>()),
            Some("f") => faces.push(words.map(|x| x.parse().unwrap()).collect::<Vec<usize>>()),
            Some("g") => groups.push(line.to_owned()),
            other => assert_eq!(other, Some("#")),
        }
    }
    let (mut first, mut from, mut modes) = (0, 0, Vec::new());
    for surface in surfaces {
        let own = surface["vertices"].as_array().unwrap();
        for (written, vertex) in vertices[first..].iter().zip(own) {
            assert_eq!(*written, numbers(vertex));
        }
        let triangles = surface["triangles"].as_array().unwrap();
        for (written, triangle) in faces[from..].iter().zip(triangles) {
            let places: Vec<usize> =
                numbers(triangle).iter().map(|v| first + 1 + *v as usize).collect();
            assert_eq!(*written, places);
        }
        (first, from) = (first + own.len(), from + triangles.len());
        modes.push(format!("g mode_{}", 1 + surface["mode"].as_u64().unwrap()));
    }
    modes.dedup();
    assert_eq!((vertices.len(), faces.len(), groups), (first, from, modes));
    let shown = text(&SPACE);
    assert!(shown.contains("surfaces") && shown.contains("triangles"), "{shown}");
    assert!(!text(&[&SPACE[..], &["--no-loci"]].concat()).contains("triangles"));
}

/// Slices along the third axis, of three modes at most.
#[test]
fn slices_of_three_axes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map.svg");
    let report = json(&[&SPACE[..], &["--plot", path.to_str().unwrap()]].concat(), 0);
    let drawn = fs::read_to_string(&path).unwrap();
    let modes = report["modes"].as_array().unwrap().len();
    for mode in 1..=modes {
        assert_eq!(drawn.contains(&format!("mode {mode}: rz = ")), mode <= 3, "{mode}");
    }
    let titles = drawn.lines().filter(|line| line.starts_with("mode ")).count();
    assert_eq!(titles, 4 * modes.min(3));
    for rz in [&report["axes"][2]["from"], &report["axes"][2]["to"]] {
        assert!(drawn.contains(&format!("mode 1: rz = {rz} rad")), "{rz}");
    }
    assert!(drawn.contains("type II") && drawn.contains("x [m]"));
    let bare = [&SPACE[..], &["--no-loci", "--plot", path.to_str().unwrap()]].concat();
    json(&bare, 0);
    assert!(fs::read_to_string(&path).unwrap().len() < drawn.len());
}

#[test]
fn meshes_that_there_are_not() {
    let message = refused(&[&OVER[..], &["--mesh", "locus.obj"]].concat());
    assert!(message.contains("--mesh") && message.contains("--over three times"), "{message}");
    let message = refused(&[&SPACE[..], &["--mesh", "locus.stl"]].concat());
    assert!(message.contains("end in .obj"), "{message}");
    let message = refused(&[&SPACE[..], &["--mesh", "locus.obj", "--no-loci"]].concat());
    assert!(message.contains("--no-loci"), "{message}");
    let arm =
        ["map", "panda", "--over", "x=0.4:0.5:2", "--over", "y=0:0.1:2", "--over", "z=0.4:0.5:2"];
    let message = refused(&[&arm[..], &["--starts", "2", "--mesh", "locus.obj"]].concat());
    assert!(message.contains("free motions") && message.contains("--at"), "{message}");
    // Refused with no other file.
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("map.json");
    let files = ["--starts", "1", "--mesh", "locus.obj", "--out", out.to_str().unwrap()];
    refused(&[&arm[..], &files].concat());
    assert!(!out.exists());
    // Before a map that would never end.
    let over =
        ["map", "3rrr", "--over", "x=-1:1:9000", "--over", "y=-1:1:9000", "--over", "rz=0:1:1"];
    let message = refused(&[&over[..], &files].concat());
    assert!(message.contains("'rz' has one value; give it two"), "{message}");
}
