//! `manipulability`: metrics, tasks, indices, polytopes, gradients.

use std::fs;

use crate::{difference, json, numbers, refused, text};

const FIVE_BAR: [&str; 4] = ["manipulability", "five-bar", "--actuated", "q1,q5"];

fn with<'a>(more: &[&'a str]) -> Vec<&'a str> {
    [&FIVE_BAR[..], more].concat()
}

/// Redundancy adds a zero where rates are given, structure an infinite one where a wrench is.
#[test]
fn six_indices() {
    let report = json(&with(&[]), 0);
    let root = 41_f64.sqrt();
    let (large, small) = (7.0 + root, 7.0 - root);
    let indices = &report["indices"];
    for key in ["kinematic", "active_kinematic", "passive_kinematic"] {
        assert!(difference(&numbers(&indices[key]), &[large, small]) < 1e-11, "{key}");
    }
    assert!(difference(&numbers(&indices["active_force"]), &[1.0 / small, 1.0 / large]) < 1e-11);
    assert_eq!(indices["passive_force"].as_array().unwrap().len(), 3);
    assert!(indices["passive_force"][0].is_null());
    let measures = &report["measures"]["kinematic"];
    assert!((measures["volume"].as_f64().unwrap() - 8_f64.sqrt()).abs() < 1e-11);
    assert!((measures["anisotropy"].as_f64().unwrap() - large / small).abs() < 1e-9);
    assert_eq!(json(&["manipulability", "panda"], 0)["indices"]["active_kinematic"][6], 0.0);
    let table = text(&with(&[]));
    assert!(table.contains("passive-force") && table.contains("infinite, 1.67539"), "{table}");
}

/// Weights scale: four times the weight of all twists, four times the efficiency of motion and a
/// quarter of that of force; a metric of wrenches of its own cuts the tie.
#[test]
fn metrics_of_the_user() {
    let plain = numbers(&json(&with(&[]), 0)["kinematic"]["finite"]);
    let four: Vec<f64> = plain.iter().map(|e| 4.0 * e).collect();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("wu.csv");
    fs::write(&file, "x,y,rz\n4,0,0\n0,4,0\n0,0,4\n").unwrap();
    for weights in ["4,4,4", file.to_str().unwrap()] {
        let report = json(&with(&["--wu", weights]), 0);
        assert!(difference(&numbers(&report["kinematic"]["finite"]), &four) < 1e-11);
        let force = numbers(&report["active_force"]["finite"]);
        assert!((force[0] * four[1] - 1.0).abs() < 1e-11);
        assert_eq!(report["own_metrics"], serde_json::json!(["wu"]));
    }
    let own = json(&with(&["--wq", "1,1", "--ww", "9,9,9", "--wtau", "1,1"]), 0);
    let force = numbers(&own["active_force"]["finite"]);
    assert!((force[0] * plain[1] - 9.0).abs() < 1e-10);

    let text = refused(&with(&["--wu", "1,1"]));
    assert!(text.contains("--wu has 2 entries, expected 3") && text.contains("x, y, rz"), "{text}");
    let text = refused(&with(&["--wq", "1,1,1"]));
    assert!(text.contains("--wq has 3 entries, expected 2") && text.contains("q1, q5"), "{text}");
    assert!(refused(&with(&["--wtau", "1,-1"])).contains("positive"));
    fs::write(&file, "1,2,0\n0,1,0\n0,0,1\n").unwrap();
    assert!(refused(&with(&["--wu", file.to_str().unwrap()])).contains("symmetric"));
    fs::write(&file, "1,0\n0,1\n").unwrap();
    assert!(refused(&with(&["--wu", file.to_str().unwrap()])).contains("not 3"));
    assert!(refused(&with(&["--wu", "nowhere.csv"])).contains("nowhere.csv"));
}

/// Components of the task, and the same as a map of its own.
#[test]
fn tasks() {
    let report = json(&with(&["--task", "x,y"]), 0);
    assert_eq!(report["components"], serde_json::json!(["x", "y"]));
    assert_eq!(report["kinematic"]["directions"][0]["object"].as_array().unwrap().len(), 2);
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("task.json");
    fs::write(&file, "[[1, 0, 0], [0, 1, 0]]").unwrap();
    let map = json(&with(&["--task-map", file.to_str().unwrap()]), 0);
    assert_eq!(map["kinematic"], report["kinematic"]);
    // Of the arm at its singular pose the lost direction is left out.
    let arm =
        json(&["manipulability", "3r", "--q", "0,0,0", "--task", "y,z", "--metric", "length"], 0);
    assert_eq!(arm["kinematic"]["finite"].as_array().unwrap().len(), 2);
    assert!(refused(&with(&["--task", "z"])).contains("component"));
    fs::write(&file, "[[1, 0, 0], [2, 0, 0]]").unwrap();
    assert!(refused(&with(&["--task-map", file.to_str().unwrap()])).contains("independent"));
}

/// The five-bar driven at q1 and q2 moves its reference as a serial arm: corners by hand.
#[test]
fn polytopes() {
    let report = json(&["manipulability", "five-bar", "--polytope"], 0);
    let velocity = &report["polytope"]["velocity"];
    assert_eq!(velocity["limits"], serde_json::json!([[-2.0, 2.0], [-2.0, 2.0]]));
    // Reference (1, 2): q1 moves it by (-2, 1), q2 by (0, 1), both turn it.
    let mut corners: Vec<Vec<f64>> =
        velocity["vertices"].as_array().unwrap().iter().map(numbers).collect();
    corners.sort_by_key(|c| (c[0].round() as i64, c[1].round() as i64));
    let expected = [[-4.0, 0.0, 0.0], [-4.0, 4.0, 4.0], [4.0, -4.0, -4.0], [4.0, 0.0, 0.0]];
    assert_eq!(corners.len(), 4);
    for (c, e) in corners.iter().zip(&expected) {
        assert!(difference(c, e) < 1e-12, "{corners:?}");
    }
    assert!(difference(&numbers(&velocity["range"][0]), &[-4.0, 4.0]) < 1e-12);
    // The structure resists a wrench: no limit along it.
    let force = &report["polytope"]["force"];
    assert_eq!(force["unbounded"].as_array().unwrap().len(), 1);
    assert!(force["range"][1][0].is_null());
    // Limits that differ both ways; those of the other kind are missing, and that is said.
    let one = json(&with(&["--velocity-limits", "1,0:2"]), 0);
    assert_eq!(one["polytope"]["velocity"]["limits"][1], serde_json::json!([0.0, 2.0]));
    assert!(one["polytope"]["force"].is_null());
    assert!(one["polytope"]["notes"][0].as_str().unwrap().contains("'q5' has no effort limit"));
    let both = refused(&with(&["--polytope"]));
    assert!(both.contains("--velocity-limits") && both.contains("--torque-limits"), "{both}");
    assert!(
        refused(&with(&["--velocity-limits", "1"])).contains("--velocity-limits has 1 entries")
    );
    assert!(refused(&with(&["--velocity-limits", "1,2:3"])).contains("zero must lie between them"));
    // In space: ranges, and corners of a task.
    let panda = json(&["manipulability", "panda", "--polytope"], 0);
    assert!(panda["polytope"]["velocity"]["vertices"].is_null());
    assert_eq!(panda["polytope"]["velocity"]["range"].as_array().unwrap().len(), 6);
    let task = json(&["manipulability", "panda", "--polytope", "--task", "x,y,z"], 0);
    // At home joints 2, 4, 6 move the tool in x-z, the others across: a prism over a hexagon.
    assert_eq!(task["polytope"]["velocity"]["vertices"].as_array().unwrap().len(), 12);
    let table = text(&["manipulability", "five-bar", "--polytope"]);
    assert!(table.contains("corner, twist") && table.contains("no limit"), "{table}");
}

/// Against the volume at both ends of a small step; of closed chains too.
#[test]
fn gradients() {
    let report = json(&["manipulability", "panda", "--gradient", "volume"], 0);
    let gradient = &report["gradient"];
    assert_eq!((&gradient["exists"], &gradient["error"]), (&true.into(), &0.0.into()));
    assert_eq!(gradient["value"], report["measures"]["kinematic"]["volume"]);
    let slope = numbers(&gradient["gradient"]);
    // A step of 1e-5 along joint 4 changes the volume by that much.
    let q = numbers(&report["q"]);
    let volume = |h: f64| {
        let moved: Vec<String> = q
            .iter()
            .enumerate()
            .map(|(i, x)| (x + if i == 3 { h } else { 0.0 }).to_string())
            .collect();
        let report = json(&["manipulability", "panda", "--q", &moved.join(",")], 0);
        report["measures"]["kinematic"]["volume"].as_f64().unwrap()
    };
    let difference = (volume(1e-5) - volume(-1e-5)) / 2e-5;
    assert!((difference - slope[3]).abs() < 1e-8, "{difference} {}", slope[3]);
    // Of the five-bar along the motion of q1, the passive joints following.
    let report = json(&with(&["--gradient", "smallest"]), 0);
    let slope = numbers(&report["gradient"]["gradient"]);
    let at = |q1: &str| {
        let command = ["assemble", "five-bar", "--q", q1, "--hold", "q1,q2"];
        let q = numbers(&json(&command, 0)["q"]);
        let words: Vec<String> = q.iter().map(ToString::to_string).collect();
        let report = json(&with(&["--q", &words.join(",")]), 0);
        (q, report["measures"]["kinematic"]["smallest"].as_f64().unwrap())
    };
    let ((q_up, up), (q_down, down)) = (at("q1=1e-4"), at("q1=-1e-4"));
    let expected: f64 =
        slope.iter().zip(q_up.iter().zip(&q_down)).map(|(s, (a, b))| s * (a - b)).sum();
    assert!((up - down - expected).abs() < 1e-9 && expected.abs() > 1e-5, "{expected}");
    let table = text(&["manipulability", "stewart", "--gradient", "smallest"]);
    assert!(table.contains("gradient of the smallest of motion, 0.240124"), "{table}");
}

#[test]
fn inertia_measures() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("door.urdf");
    fs::write(
        &file,
        r#"<robot name="door"><link name="wall"/><link name="leaf"><inertial>
             <origin xyz="0.5 0 0"/><mass value="8"/>
             <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.2" iyz="0" izz="0.6"/>
           </inertial></link>
           <joint name="hinge" type="continuous"><parent link="wall"/><child link="leaf"/>
             <axis xyz="0 0 1"/></joint></robot>"#,
    )
    .unwrap();
    let model = file.to_str().unwrap();
    let report = json(&["manipulability", model, "--metric", "inertia"], 0);
    // 0.6 + 8 * 0.5^2 about the hinge.
    assert!(difference(&numbers(&report["kinematic"]["finite"]), &[2.6]) < 1e-12);
    let text = refused(&["manipulability", "panda", "--metric", "inertia"]);
    assert!(text.contains("has no mass"), "{text}");
}

/// Rows of a file, its columns by name and in any order, are what single calls say.
#[test]
fn many_configurations() {
    const FILE: &str = "tests/data/five-bar.csv";
    let report = json(&with(&["--configurations", FILE]), 0);
    let columns: Vec<&str> =
        report["columns"].as_array().unwrap().iter().map(|c| c.as_str().unwrap()).collect();
    let rows = report["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 2);
    for (row, q) in rows.iter().zip(["0,0,0,0", "-0.2,0.1,0,0.01"]) {
        let of = |name: &str| row[columns.iter().position(|c| *c == name).unwrap()].clone();
        let close = |name: &str, expected: &serde_json::Value| {
            let (got, expected) = (of(name).as_f64().unwrap(), expected.as_f64().unwrap());
            assert!((got - expected).abs() < 1e-12 * (1.0 + expected), "{q} {name}: {got}");
        };
        let mobility = json(&["mobility", "five-bar", "--actuated", "q1,q5", "--q", q], 0);
        for name in ["dof", "coordinate", "redundancy", "internal", "zero_torque", "idle"] {
            close(name, &mobility[name]);
        }
        close("closure_distance", &mobility["closure_error"]["distance"]);
        for name in ["type_i", "type_ii", "configuration_space", "passive"] {
            close(name, &mobility["singularity"]["distances"][name]);
        }
        let measures = &json(&with(&["--q", q]), 0)["measures"]["kinematic"];
        for name in ["volume", "largest", "smallest", "anisotropy"] {
            close(name, &measures[name]);
        }
    }
    // Of a task, whose numbers are those of its single calls too.
    let of_task =
        json(&with(&["--configurations", FILE, "--task", "x,y", "--metric", "length"]), 0);
    assert_eq!(of_task["components"], serde_json::json!(["x", "y"]));
    let single = with(&["--task", "x,y", "--metric", "length", "--q", "-0.2,0.1,0,0.01"]);
    let measures = &json(&single, 0)["measures"]["kinematic"];
    for name in ["volume", "largest", "smallest", "anisotropy"] {
        let place = columns.iter().position(|c| *c == name).unwrap();
        let got = of_task["rows"][1][place].as_f64().unwrap();
        assert!((got / measures[name].as_f64().unwrap() - 1.0).abs() < 1e-12, "{name}: {got}");
    }
    let table = text(&with(&["--configurations", FILE, "--task", "x,y"]));
    assert!(table.contains("task") && table.contains("x, y"), "{table}");
    let message = refused(&with(&["--configurations", FILE, "--task", "x,q"]));
    assert!(message.contains("no component named 'q'"), "{message}");
    let table = text(&with(&["--configurations", FILE]));
    assert!(table.contains("dof 2") && table.contains("closure_distance"), "{table}");

    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("q.csv");
    let path = file.to_str().unwrap();
    fs::write(&file, "q1,q2,q3\n0,0,0\n").unwrap();
    let message = refused(&with(&["--configurations", path]));
    assert!(message.contains("no column 'q4' among q1, q2, q3"), "{message}");
    fs::write(&file, "0,0,0,0\n0,0,0\n").unwrap();
    let message = refused(&with(&["--configurations", path]));
    assert!(message.contains("line 2 has 3 numbers, not 4"), "{message}");
    fs::write(&file, "0,0,0,0\n0,nan,0,0\n").unwrap();
    let message = refused(&with(&["--configurations", path]));
    assert!(message.contains("q[1][1] (q2) is not finite"), "{message}");
    let message = refused(&with(&["--configurations", path, "--metric", "inertia"]));
    assert!(message.contains("another one in every configuration"), "{message}");
    fs::write(&file, "").unwrap();
    assert_eq!(json(&with(&["--configurations", path]), 0)["rows"], serde_json::json!([]));
}
