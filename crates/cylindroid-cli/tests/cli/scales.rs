//! Mechanisms of nanometres to millions of kilometres, and those that are too small.

use std::fs;

use crate::{json, refused};

const FIVE_BAR: &str = r#"name = "five-bar"
reference = "c"
reference_point = [2*L, 1*L, 0]
[[joint]]
name = "q1"
type = "revolute"
between = ["ground", "a"]
origin = [0, 0, 0]
axis = [0, 0, 1]
actuated = true
[[joint]]
name = "q2"
type = "revolute"
between = ["a", "b"]
origin = [0, 2*L, 0]
axis = [0, 0, 1]
[[joint]]
name = "q3"
type = "revolute"
between = ["b", "c"]
origin = [1*L, 2*L, 0]
axis = [0, 0, 1]
[[joint]]
name = "q4"
type = "revolute"
between = ["c", "d"]
origin = [2*L, 1*L, 0]
axis = [0, 0, 1]
[[joint]]
name = "q5"
type = "revolute"
between = ["d", "ground"]
origin = [2*L, 0, 0]
axis = [0, 0, 1]
actuated = true
"#;

const ARM: &str = r#"name = "arm"
[[joint]]
name = "q1"
type = "revolute"
between = ["ground", "a"]
origin = [0, 0, 0]
axis = [0, 0, 1]
[[joint]]
name = "q2"
type = "revolute"
between = ["a", "b"]
origin = [1*L, 0, 0]
axis = [0, 1, 0]
[[joint]]
name = "q3"
TYPE
between = ["b", "c"]
origin = [2*L, 0, 1*L]
axis = [0, 1, 1]
[[joint]]
name = "tip"
type = "fixed"
between = ["c", "tip"]
origin = [3*L, 0, 2*L]
"#;
/// Of the arm at 0.2, 0.1, 0.2, nearly.
const TIP: [f64; 3] = [3.2, 0.8, 1.63];
const REVOLUTE: &str = "type = \"revolute\"";
const SLIDE: &str = "type = \"prismatic\"\nlimits = { lower = -1*L, upper = 2*L }";

/// The file with lengths of this unit.
fn scaled(text: &str, unit: f64) -> String {
    let parts: Vec<&str> = text.split("*L").collect();
    let (last, others) = parts.split_last().unwrap();
    let mut all = String::new();
    for part in others {
        let start = part.rfind(|c: char| !c.is_ascii_digit() && c != '-').unwrap() + 1;
        let times: f64 = part[start..].parse().unwrap();
        all += &format!("{}{:e}", &part[..start], times * unit);
    }
    all + last
}

/// Runs a check with the file of each mechanism and a target, empty for the slide: how it moves beside
/// rotations depends on the unit.
fn with_files(unit: f64, check: impl Fn(&str, &str)) {
    let folder = tempfile::tempdir().unwrap();
    let (sin, cos) = 0.2_f64.sin_cos();
    let turns = ARM.replace("TYPE", REVOLUTE);
    for (text, target) in [
        (FIVE_BAR, Some([2.0 - sin, cos, 0.0])),
        (&turns, Some(TIP)),
        (&ARM.replace("TYPE", SLIDE), None),
    ] {
        let file = folder.path().join("model.toml");
        fs::write(&file, scaled(text, unit)).unwrap();
        let target = target.map(|at| at.map(|x| format!("{:e}", x * unit)).join(","));
        check(file.to_str().unwrap(), &target.unwrap_or_default());
    }
}

#[test]
fn mechanisms_of_all_sizes_are_alike() {
    for unit in [1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9] {
        with_files(unit, |file, target| {
            let info = json(&["info", file], 0);
            let reach = info["reach"].as_f64().unwrap() / unit;
            assert!(reach > 2.0 && reach < 4.0, "{unit}: {reach}");
            assert_eq!(json(&["jacobian", file], 0)["rank"], 3, "{unit}");
            let dof = if info["name"] == "arm" { 3 } else { 2 };
            assert_eq!(json(&["mobility", file], 0)["dof"], dof, "{unit}");
            json(&["manipulability", file], 0);
            json(&["sweep", file, "--samples", "5"], 0);
            if target.is_empty() {
                return;
            }
            let tolerance = format!("{:e}", 1e-6 * unit);
            let to = ["--to", target, "--task", "position", "--tolerance-position", &tolerance];
            let moved = json(&[&["move", file][..], &to].concat(), 0);
            assert!(moved["steps"].as_u64().unwrap() > 10, "{unit}: {moved}");
        });
    }
    // Efficiencies that differ by more than double precision end no command.
    for unit in [1e-12, 1e15, 1e18, 1e60, 1e119] {
        with_files(unit, |file, _| {
            json(&["manipulability", file], 0);
            json(&["sweep", file, "--samples", "5"], 0);
        });
    }
}

#[test]
fn mechanisms_without_a_size_are_refused_by_name() {
    for unit in [1e-13, 1e-30, 1e-160, 1e-300] {
        with_files(unit, |file, _| {
            for command in [
                &["info"][..],
                &["jacobian"],
                &["mobility"],
                &["manipulability"],
                &["sweep", "--samples", "2"],
                &["move", "--task", "position", "--to", "1,0,0"],
            ] {
                let message = refused(&[&[command[0], file], &command[1..]].concat());
                let message = message.replace("\n  │ ", " ");
                for says in ["its longest length is", "1e-12 m to 1e120 m", "unit of length"] {
                    assert!(message.contains(says), "{unit} {command:?}: {message}");
                }
            }
        });
    }
}
