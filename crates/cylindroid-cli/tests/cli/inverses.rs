//! Matrices of inverses: `screws --h`, `jacobian --twist`.

use std::fs;

use serde_json::Value;

use crate::{difference, json, numbers, refused, text};

const BELOW: &str = "0.4,0.6,0.9,0.5,0.2";
const DOWN: &str = "0.4,0.6,0.9,1.641592653589793,0.2";
const TWIST: &str = "0.05,0.02,0,0.2,0.1,0.1";

fn rows(value: &Value) -> Vec<Vec<f64>> {
    value.as_array().unwrap().iter().map(numbers).collect()
}

fn times(matrix: &[Vec<f64>], x: &[f64]) -> Vec<f64> {
    matrix.iter().map(|row| row.iter().zip(x).map(|(a, b)| a * b).sum()).collect()
}

/// Donelan & Selig, examples 1 and 4, as printed (angular first) and corrected: det = h,
/// Phi_h = -9 (80 h^2 + 64 h - 25) / (1600 h).
#[test]
fn examples_1_and_4() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("j.csv").to_str().unwrap().to_owned();
    fs::write(&path, "1,0,0,0,-1,0.5\n0,0,1,0,0,0\n0,0,1,-2,1,0\n").unwrap();
    let s = "0,0.6,0.8,1,-0.8,0.6";
    let command = ["screws", &path, "--angular-first", "--twist", s, "--h", "1", "--h", "-1"];
    let report = json(&[&command[..], &["--h", "0"]].concat(), 0);
    assert_eq!(numbers(&report["twist"]["twist"]), [1.0, -0.8, 0.6, 0.0, 0.6, 0.8]);
    let zeros = numbers(&report["twist"]["error_form_zeros"]["pitches"]);
    let root = 3.0 * 21_f64.sqrt();
    assert!(difference(&zeros, &[(-8.0 + root) / 20.0, (-8.0 - root) / 20.0]) < 1e-13);
    for at in &report["inverses"].as_array().unwrap()[..2] {
        let h = at["h"].as_f64().unwrap();
        assert!((at["gram_determinant"].as_f64().unwrap() - h).abs() < 1e-14);
        let found = &at["velocities"];
        let expected =
            [-48.0 * h, -48.0 * h * h + 160.0 * h - 45.0, 48.0 * h * h - 32.0 * h - 15.0];
        let expected = expected.map(|x| x / (160.0 * h));
        assert!(difference(&numbers(&found["joint_velocities"]), &expected) < 1e-13);
        let phi = -9.0 * (80.0 * h * h + 64.0 * h - 25.0) / (1600.0 * h);
        assert!((found["error_form"].as_f64().unwrap() - phi).abs() < 1e-13);
        // The corrected entry: angular first (3, 2), here the column of wy.
        let entry = rows(&at["inverse"])[2][4];
        assert!((entry - (16.0 * h * h + 16.0 * h - 1.0) / (32.0 * h)).abs() < 1e-13);
        assert_eq!(at["reciprocal"].as_array().unwrap().len(), 3);
        let (p, wrenches) = (rows(&at["projector"]), rows(&at["constraint_projector"]));
        for i in 0..6 {
            for k in 0..6 {
                let unit = f64::from(u8::from(i == k));
                assert!((wrenches[i][k] - unit + p[k][i]).abs() < 1e-13);
            }
        }
        let realised = times(&p, &[1.0, -0.8, 0.6, 0.0, 0.6, 0.8]);
        assert!(difference(&numbers(&found["realised"]), &realised) < 1e-13);
    }
    let none = &report["inverses"][2];
    assert!(none["inverse"].is_null() && none["projector"].is_null());
    assert!(none["velocities"].is_null() && none["reason"].is_string());
    let shown = text(&command);
    for part in ["J^{+h} at h = 1 m/rad", "P*_h at h = -1 m/rad", "0.287386, -1.08739", "det("] {
        assert!(shown.contains(part), "{part}: {shown}");
    }
}

/// No joints, one joint, six, closed chains, and no inverse for any h.
#[test]
fn every_system_has_an_answer() {
    let at = |arguments: &[&str], twists: usize, exists: bool| {
        let flags = ["--h", "0.3", "--h", "inf", "--twist", TWIST];
        let report = json(&[arguments, &flags].concat(), 0);
        let first = report["inverses"][0].clone();
        assert_eq!(first["exists"], exists, "{arguments:?}");
        if exists {
            let shape = rows(&first["inverse"]);
            assert_eq!(shape.len(), twists, "{arguments:?}");
            let v = numbers(&first["velocities"]["joint_velocities"]);
            assert_eq!(v.len(), twists);
            let mut sum = [0.0; 6];
            for (twist, v) in rows(&report["twists"]).iter().zip(&v) {
                sum.iter_mut().zip(twist).for_each(|(s, t)| *s += v * t);
            }
            let realised = numbers(&first["velocities"]["realised"]);
            assert!(difference(&sum, &realised) < 1e-9, "{arguments:?}");
        }
        text(&[arguments, &flags].concat());
        report
    };
    let none = at(&["screws", "youbot", "--frame", "ground"], 0, true);
    assert_eq!(none["inverses"][0]["gram_determinant"], 1.0);
    // The twist itself is the error: of pitch v . w / w . w.
    let pitch = numbers(&none["twist"]["error_form_zeros"]["pitches"]);
    assert!(difference(&pitch, &[0.2]) < 1e-12, "{pitch:?}");
    at(&["screws", "youbot", "--frame", "arm_link_1"], 1, true);
    let six = at(&["screws", "ur5e"], 6, true);
    assert_eq!(six["twist"]["error_form_zeros"]["everywhere"], true);
    at(&["screws", "stewart"], 6, true);
    let delta = at(&["screws", "delta"], 3, false);
    assert_eq!(delta["twist"]["error_form_zeros"]["defined"], false);
    assert!(delta["inverses"][0]["reason"].as_str().unwrap().contains("for any h"));
    let shown = text(&["screws", "delta", "--h", "0.1", "--twist", TWIST]);
    assert!(shown.contains("there is no inverse for any h"), "{shown}");
    at(&["screws", "youbot", "--q", DOWN], 5, false);
    assert!(refused(&["screws", "youbot", "--twist", "0,0,nan,0,0,1"]).contains("--twist"));
}

#[test]
fn joint_velocities_of_a_jacobian() {
    let report = json(&["jacobian", "ur5e", "--twist", TWIST, "--eps", "1e-3"], 0);
    let inverse = &report["inverse"];
    assert_eq!((&inverse["name"], &inverse["rank"]), (&"truncated".into(), &6.into()));
    let twist = [0.05, 0.02, 0.0, 0.2, 0.1, 0.1];
    assert!(difference(&numbers(&inverse["realised"]), &twist) < 1e-12);
    let velocities = times(&rows(&inverse["matrix"]), &twist);
    assert!(difference(&numbers(&inverse["joint_velocities"]), &velocities) < 1e-12);
    let shown = text(&["jacobian", "ur5e", "--twist", "x"]);
    assert!(shown.contains("Joint velocities for the twist"), "{shown}");
    // All parameters in effect, defaults too.
    assert!(shown.contains("parameters  eps 0.001"), "{shown}");
    let filtering = ["jacobian", "ur5e", "--inverse", "numerical-filtering", "--damping", "0.5"];
    let report = json(&filtering, 0);
    assert_eq!(report["inverse"]["parameters"]["damping"], 0.5);
    let shown = text(&filtering);
    for name in ["onset", "filter"] {
        assert!(report["inverse"]["parameters"][name].is_f64(), "{report}");
        assert!(shown.contains(&format!("{name} ")), "{shown}");
    }

    // Of five joints the joint velocities depend on the length; the hyperbolic ones do not.
    let youbot = ["jacobian", "youbot", "--q", BELOW, "--twist", TWIST];
    let of = |more: &[&str]| {
        let report = json(&[&youbot[..], more].concat(), 0);
        numbers(&report["inverse"]["joint_velocities"])
    };
    assert!(difference(&of(&["--length", "0.2"]), &of(&["--length", "2"])) > 1e-2);
    let hyperbolic = ["--inverse", "hyperbolic", "--h", "0.1", "--length"];
    let [a, b] = ["0.2", "2"].map(|length| of(&[&hyperbolic[..], &[length]].concat()));
    assert!(difference(&a, &b) < 1e-9);
    let world = ["--reference", "world", "--inverse", "hyperbolic", "--h", "0.1"];
    let screws = json(&["screws", "youbot", "--q", BELOW, "--h", "0.1", "--twist", TWIST], 0);
    let same = numbers(&screws["inverses"][0]["velocities"]["joint_velocities"]);
    assert!(difference(&of(&world), &same) < 1e-9);
    assert_eq!(json(&["jacobian", "youbot", "--length", "0.2"], 0)["length"], 0.2);

    let principal = [&youbot[..], &["--inverse", "hyperbolic", "--h", "0"]].concat();
    let none = json(&principal, 1);
    assert_eq!(none["inverse"]["exists"], false);
    assert!(none["inverse"]["matrix"].is_null() && none["inverse"]["realised"].is_null());
    let shown = String::from_utf8(crate::cylindroid(&principal).stdout).unwrap();
    assert!(shown.contains("no: h is the principal pitch 0 m/rad"), "{shown}");
    let refuse = |more: &[&str]| refused(&[&youbot[..], more].concat());
    assert!(refuse(&["--inverse", "hyperbolic"]).contains("here --h"));
    assert!(refuse(&["--inverse", "damped", "--eps", "0.1"]).contains("--eps"));
    assert!(refuse(&["--length", "0"]).contains("--length"));
    assert!(refuse(&["--give-up", "x"]).contains("--give-up"));
    assert!(refused(&["jacobian", "ur5e", "--analytical", "rpy", "--eps", "0.1"]).contains("task"));
    let relative = ["jacobian", "panda", "--relative-to", "link4"];
    let message = refused(&[&relative[..], &["--eps", "0.1"]].concat());
    assert!(message.contains("--relative-to = link4"), "{message}");
    refused(&[&relative[..], &["--twist", "x"]].concat());
}

/// The joint velocities of a closed chain keep its loops closed.
#[test]
fn joint_velocities_of_closed_chains() {
    for (name, rank) in [("stewart", 6), ("five-bar", 2), ("delta", 3)] {
        let report = json(&["jacobian", name, "--twist", "x"], 0);
        assert_eq!(report["inverse"]["rank"], rank, "{name}");
        let n = report["joint_names"].as_array().unwrap().len();
        assert_eq!(numbers(&report["inverse"]["joint_velocities"]).len(), n, "{name}");
    }
    // A frame that no joint moves.
    let fixed = json(&["jacobian", "youbot", "--frame", "ground", "--twist", "x"], 0);
    assert_eq!(fixed["inverse"]["rank"], 0);
    assert!(numbers(&fixed["inverse"]["realised"]).iter().all(|x| *x == 0.0));
}

/// Example 1 of Donelan and Selig, class IB0 with the principal pitch zero: one square of each sign
/// and one that changes its own.
#[test]
fn hyperbolic_singular_values_of_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("example1.csv");
    fs::write(&file, "1,0,0,0,-1,0.5\n0,0,1,0,0,0\n0,0,1,-2,1,0\n").unwrap();
    let arguments = ["--angular-first", "--h", "-0.3", "--h", "0", "--h", "0.3", "--h", "inf"];
    let all = [&["screws", file.to_str().unwrap()][..], &arguments].concat();
    let found = json(&all, 0);
    let at = |i: usize| &found["inverses"][i]["hyperbolic_svd"];
    assert_eq!(at(0)["signature"], serde_json::json!([2, 1, 0]));
    assert_eq!((&at(1)["polar"], &at(1)["squares"][1]), (&"none".into(), &0.0.into()));
    assert_eq!(at(2)["signature"], serde_json::json!([1, 2, 0]));
    assert_eq!(at(2)["polar"], "signed");
    let product: f64 =
        at(2)["squares"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).product();
    assert!((product - 0.3).abs() < 1e-12); // det J^T Q_h J = h
    assert!(at(3).is_null());
}
