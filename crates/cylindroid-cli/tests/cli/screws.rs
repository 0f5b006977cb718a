//! `screws`.

use std::fs;

use crate::{cylindroid, difference, json, numbers, text};

const BELOW: &str = "0.4,0.6,0.9,0.5,0.2";
const DOWN: &str = "0.4,0.6,0.9,1.641592653589793,0.2";

#[test]
fn a_five_joint_arm() {
    let report =
        json(&["screws", "youbot", "--q", BELOW, "--h", "0.1", "--h", "0", "--h", "inf"], 0);
    assert_eq!((&report["rank"], &report["gibson_hunt"]), (&5.into(), &"h".into()));
    assert_eq!(numbers(&report["principal_pitches"]).len(), 1);
    assert!(numbers(&report["principal_pitches"])[0].abs() < 1e-12);
    assert_eq!((&report["ambiguous"], &report["invertible"]), (&false.into(), &true.into()));
    let exists: Vec<bool> =
        report["inverses"].as_array().unwrap().iter().map(|e| e["exists"] == true).collect();
    assert_eq!(exists, [true, false, true]);
    assert!(report["inverses"][1]["reason"].as_str().unwrap().contains("principal pitch 0 m/rad"));
    // The horizontal line parallel to the pitch axes, through the crossing of axes 1 and 5.
    let reciprocal = &report["reciprocal"][0];
    assert!(numbers(&reciprocal["point"])[..2].iter().all(|x| x.abs() < 1e-12));
    assert!(numbers(&reciprocal["direction"])[2].abs() < 1e-12);
    let involution = &report["involution"];
    assert_eq!((&involution["lines"], &involution["in_involution"]), (&5.into(), &true.into()));
    assert_eq!(involution["transversals"]["lines"].as_array().unwrap().len(), 1);
    assert_eq!(report["names"][4], "arm_joint_5");
}

#[test]
fn straight_down_there_is_never_an_inverse() {
    let report = json(&["screws", "youbot", "--q", DOWN], 0);
    assert_eq!((&report["gibson_hunt"], &report["invertible"]), (&"inf".into(), &false.into()));
    let text = text(&["screws", "youbot", "--q", DOWN]);
    assert!(text.contains("never: a 5-system whose reciprocal is of class inf"), "{text}");
    assert!(text.contains("one line at infinity"), "{text}");
}

#[test]
fn the_frame_and_the_tool_change_no_verdict() {
    let a = json(&["screws", "3r", "--q", "0.2,0.5,-1"], 0);
    let b = json(&["screws", "3r", "--q", "0.2,0.5,-1", "--tool", "0.1,2,-3"], 0);
    for key in ["rank", "gibson_hunt", "principal_pitches", "twists", "choice"] {
        assert_eq!(a[key], b[key], "{key}");
    }
    assert_eq!(a["gibson_hunt"], "IB0");
}

/// The platform of a closed chain has the motions that all legs permit.
#[test]
fn closed_chains_have_the_screws_of_their_platform() {
    for (name, rank, class) in [("delta", 3, "IID"), ("stewart", 6, "6"), ("five-bar", 2, "")] {
        let report = json(&["screws", name], 0);
        assert_eq!(report["rank"], rank, "{name}");
        assert_eq!(report["names"].as_array().unwrap().len(), rank, "{name}");
        assert!(report["closure_error"]["distance"].as_f64().unwrap() < 1e-9, "{name}");
        assert!(report["involution"].is_null(), "{name}");
        assert!(report["gibson_hunt"].as_str().unwrap().ends_with(class), "{name}");
    }
    let shown = text(&["screws", "delta"]);
    assert!(shown.contains("that the loops permit"), "{shown}");
    let open = text(&["screws", "five-bar", "--q", "0.3,0,0,0"]);
    assert!(open.contains("loops are open by"), "{open}");
    let point = ["screws", "delta", "--point", "0,0,0", "--direction", "0,0,1"];
    assert!(crate::refused(&point).contains("loops couple its joint velocities"));
}

#[test]
fn files_of_twists() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let csv = path("two.csv");
    fs::write(&csv, "# two lines\nvx, vy, vz, wx, wy, wz\n0,0,0,0,0,1\n0,0,-0.2,1,0,0\n").unwrap();
    let report = json(&["screws", &csv], 0);
    assert_eq!(report["gibson_hunt"], "IA");
    assert!(difference(&numbers(&report["principal_pitches"]), &[0.1, -0.1]) < 1e-15);
    assert_eq!(report["names"], serde_json::json!(["1", "2"]));
    let list = path("two.json");
    fs::write(&list, "[[0,0,1,0,0,0],[1,0,0,0,0,-0.2]]").unwrap();
    let same = json(&["screws", &list, "--angular-first"], 0);
    assert_eq!(same["principal_pitches"], report["principal_pitches"]);
    // In millimetres, with the length in millimetres.
    fs::write(&csv, "0,0,0,0,0,1\n0,0,-200,1,0,0\n").unwrap();
    let millimetres = json(&["screws", &csv, "--length", "1000"], 0);
    assert!(difference(&numbers(&millimetres["principal_pitches"]), &[100.0, -100.0]) < 1e-12);

    let plot = path("two.svg");
    text(&["screws", &csv, "--length", "1000", "--plot", &plot]);
    let svg = fs::read_to_string(&plot).unwrap();
    assert!(svg.contains("det(J^T Q_h J)") && svg.contains("canonical frame"), "no cylindroid");

    let refused = |content: &str, more: &[&str]| {
        fs::write(&csv, content).unwrap();
        crate::refused(&[&["screws", csv.as_str()], more].concat())
    };
    assert!(refused("1,2\n", &[]).contains("line 1 has 2 numbers"));
    assert!(refused("0,0,0,0,0,1\n0,0,x,1,0,0\n", &[]).contains("line 2"));
    assert!(refused("0,0,nan,0,0,1\n", &[]).contains("twist 1[2] is not finite"));
    assert!(refused("0,0,0,0,0,1\n", &["--length", "0"]).contains("length"));
    assert!(refused("0,0,0,0,0,1\n", &["--noise", "-1"]).contains("noise"));
    assert!(refused("0,0,0,0,0,1\n", &["--h", "nan"]).contains("--h"));
    assert!(refused("0,0,0,0,0,1\n", &["--tool", "0,0,1"]).contains("no frames"));
    assert!(refused("0,0,0,0,0,1\n", &["--plot", "x.png"]).contains(".svg"));
    // Nothing, and nothing that moves, are systems of order zero.
    fs::write(&csv, "0,0,0,0,0,0\n").unwrap();
    let zero = json(&["screws", &csv], 0);
    assert_eq!((&zero["rank"], &zero["screws"][0]), (&0.into(), &serde_json::Value::Null));
    fs::write(&csv, "").unwrap();
    assert_eq!(json(&["screws", &csv], 0)["rank"], 0);
    let output = cylindroid(&["screws", &path("none.csv")]);
    assert_eq!(output.status.code(), Some(2));
}

/// All rates that move a point along a line: one way, and what leaves the point at rest.
#[test]
fn rates_of_a_point() {
    let command = ["screws", "youbot", "--q", BELOW, "--point", "0.4,0.2,0.2", "--direction"];
    let report = json(&[&command[..], &["0,0,1"]].concat(), 0);
    assert_eq!(numbers(&report["point"]["along"]).len(), 5);
    assert_eq!(report["point"]["still"].as_array().unwrap().len(), 2);
    let one = ["screws", "youbot", "--frame", "arm_link_1", "--point", "0.4,0,0", "--direction"];
    let none = json(&[&one[..], &["1,0,0"]].concat(), 0);
    assert!(none["point"]["along"].is_null());
    assert!(text(&[&one[..], &["1,0,0"]].concat()).contains("No joint velocities move the point"));
    let output = cylindroid(&[&one[..], &["0,0,0"]].concat());
    assert_eq!(output.status.code(), Some(2));
}

/// Entries of a sweep that are nowhere finite have no smallest one: the table counts them.
#[test]
fn pitches_that_are_nowhere_finite_are_counted() {
    let text = text(&["sweep", "3r", "--samples", "5", "--quantities", "gibson_hunt"]);
    let line = text.lines().find(|l| l.starts_with("principal_pitch_2")).unwrap();
    assert_eq!(line.split_whitespace().collect::<Vec<_>>(), ["principal_pitch_2", "m/rad", "5"]);
    assert!(!text.contains("NaN"), "{text}");
}
