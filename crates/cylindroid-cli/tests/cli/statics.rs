//! `statics` and `grasp`.

use std::fs;

use crate::{cylindroid, difference, json, numbers, refused, text};

const GRASP: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/grasp.toml");

/// tau = -J^T w.
#[test]
fn torques_of_an_arm() {
    let wrench = [1.0, -2.0, -10.0, 0.3, 0.1, -0.2];
    let report = json(&["statics", "panda", "--wrench", "1,-2,-10,0.3,0.1,-0.2"], 0);
    let jacobian = json(&["jacobian", "panda"], 0);
    let rows: Vec<Vec<f64>> = jacobian["matrix"].as_array().unwrap().iter().map(numbers).collect();
    let expected: Vec<f64> =
        (0..7).map(|j| -(0..6).map(|i| rows[i][j] * wrench[i]).sum::<f64>()).collect();
    assert!(difference(&numbers(&report["torques"]), &expected) < 1e-12);
    assert!(difference(&numbers(&report["unbalanced"]), &[0.0; 6]) < 1e-12);
    assert!(report["forces"].as_array().unwrap().is_empty());
    // Stretched out, a pull along the arm is resisted by its links.
    let pull = json(&["statics", "3r", "--q", "0,0,0", "--wrench", "5,0,0,0,0,0"], 0);
    assert!(difference(&numbers(&pull["torques"]), &[0.0; 3]) < 1e-12);
    assert!(difference(&numbers(&pull["structural"]), &[5.0, 0.0, 0.0, 0.0, 0.0, 0.0]) < 1e-12);
}

/// A wrench, the torques, and every motion: no power; the rod of the five-bar carries a force
/// along itself.
#[test]
fn statics_of_the_five_bar() {
    let command = ["statics", "five-bar", "--actuated", "q1,q5", "--wrench", "3,-1,0.2"];
    let report = json(&command, 0);
    let force = numbers(&report["forces"][0]["force"]);
    assert_eq!(report["forces"][0]["name"], "q5");
    assert!((force[0] + force[1]).abs() < 1e-12 && force[0].abs() > 0.5, "{force:?}");
    assert_eq!(report["zero_torque_basis"].as_array().unwrap().len(), 1);
    let mobility = json(&["mobility", "five-bar", "--actuated", "q1,q5"], 0);
    let torques = numbers(&report["torques"]);
    for motion in mobility["dof_basis"].as_array().unwrap() {
        let motion = numbers(motion);
        let (q, u) = (&motion[..2], &motion[motion.len() - 3..]);
        let power: f64 = torques.iter().zip(q).map(|(t, q)| t * q).sum::<f64>()
            + [3.0, -1.0, 0.2].iter().zip(u).map(|(w, u)| w * u).sum::<f64>();
        assert!(power.abs() < 1e-12);
    }
    // All five actuated: three internal torques, each with the forces it brings; the least torques
    // follow the metric.
    let all = ["statics", "five-bar", "--actuated", "q1,q2,q3,q4,q5", "--wrench", "3,-1,0.2"];
    let report = json(&all, 0);
    assert_eq!(report["internal"].as_array().unwrap().len(), 3);
    let size = |r: &serde_json::Value| numbers(&r["torques"]).iter().map(|t| t * t).sum::<f64>();
    let other = json(&[&all[..], &["--wtau", "1,100,1,1,1"]].concat(), 0);
    assert!(size(&other) > size(&report) + 1e-3);
    assert!(numbers(&other["torques"])[1].abs() < numbers(&report["torques"])[1].abs());
    let table = text(&command);
    assert!(table.contains("least forces"), "{table}");
    let row = table.lines().find_map(|l| l.strip_prefix("q1 ")).unwrap();
    assert!((row.trim().parse::<f64>().unwrap() - torques[0]).abs() < 1e-5, "{table}");
}

/// Actuated by nothing the five-bar gives way: the wrench is left over, and that is said.
#[test]
fn wrenches_that_nothing_holds() {
    let command = ["statics", "five-bar", "--actuated", "q1", "--wrench", "0,0,1"];
    let report = json(&command, 0);
    assert!(numbers(&report["unbalanced"]).iter().any(|x| x.abs() > 0.1));
    assert!(text(&command).contains("gives way"));
}

/// A weight on three fingers: a third each, or by how far they give way.
#[test]
fn forces_at_contacts() {
    let command = ["statics", GRASP, "--wrench", "0,0,-9,0,0,0"];
    let share = |r: &serde_json::Value| -> Vec<f64> {
        r["forces"].as_array().unwrap().iter().map(|f| numbers(&f["force"])[2]).collect()
    };
    let least = json(&command, 0);
    assert_eq!((&least["elastic"], &least["forces"][0]["normal"]), (&false.into(), &0.0.into()));
    assert!(difference(&share(&least), &[3.0; 3]) < 1e-12);
    assert!(!least["hyperstatic"].as_array().unwrap().is_empty());
    let soft = json(&[&command[..], &["--compliance", "1e-6,tip1=1e-5"]].concat(), 0);
    let shares = share(&soft);
    assert_eq!(soft["elastic"], true);
    assert!(shares[0] < 2.5 && (shares.iter().sum::<f64>() - 9.0).abs() < 1e-9, "{shares:?}");
    assert!(refused(&[&command[..], &["--compliance", "tip1=1e-5"]].concat()).contains("tip2"));
    assert!(refused(&[&command[..], &["--compliance", "1,tip9=2"]].concat()).contains("tip9"));
    assert!(refused(&[&command[..], &["--compliance", "0"]].concat()).contains("positive"));
}

#[test]
fn wrenches_of_the_wrong_size() {
    let text = refused(&["statics", "five-bar", "--wrench", "1,2"]);
    assert!(text.contains("--wrench has 2 entries, expected 3") && text.contains("fx, fy, mz"));
    let text = refused(&["statics", "panda", "--wrench", "1,2,3"]);
    assert!(text.contains("expected 6"), "{text}");
    assert!(refused(&["statics", "panda", "--wrench", "1,2,3,4,5,nan"]).contains("not finite"));
}

#[test]
fn force_closure() {
    let report = json(&["grasp", GRASP, "--torsion", "0.01"], 0);
    let bounds = [&report["epsilon"]["lower"], &report["epsilon"]["upper"]];
    let [lower, upper] = bounds.map(|b| b.as_f64().unwrap());
    assert!(report["closed"] == true && 0.3 < lower && lower <= upper && upper < 0.35);
    assert_eq!((&report["metric"], &report["length"]), (&"l1".into(), &0.05.into()));
    assert_eq!(report["contacts"][0]["mu"], 0.5);
    let size: f64 = numbers(&report["weakest"]).iter().map(|x| x * x).sum();
    assert!((size - 1.0).abs() < 1e-12);
    // Two fingers as strong resist twice as much.
    let of = |strength: &str| {
        let command = ["grasp", GRASP, "--torsion", "0.01", "--strength", strength];
        json(&command, 0)["epsilon"]["lower"].as_f64().unwrap()
    };
    assert!((of("20") / of("10") - 2.0).abs() < 1e-9);
    // Slippery fingers resist no weight: a negative answer.
    let open = json(&["grasp", GRASP, "--torsion", "0", "--mu", "0"], 1);
    assert_eq!(open["closed"], false);
    let output = cylindroid(&["grasp", GRASP, "--torsion", "0", "--mu", "0"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&output.stdout).contains("open"));
}

#[test]
fn grasps_that_are_none() {
    assert!(refused(&["grasp", GRASP]).contains("soft finger"));
    assert!(refused(&["grasp", GRASP, "--torsion", "0.01", "--mu", "tip9=1"]).contains("tip9"));
    assert!(refused(&["grasp", GRASP, "--torsion", "0.01", "--mu=-1"]).contains("mu"));
    assert!(
        refused(&["grasp", GRASP, "--torsion", "0.01", "--strength", "tip1=3"]).contains("tip2")
    );
    assert!(refused(&["grasp", GRASP, "--frame", "finger9"]).contains("frame"));
    let ground = refused(&["grasp", GRASP, "--frame", "ground", "--torsion", "0.01"]);
    assert!(ground.contains("no contact touches link 'ground'"), "{ground}");
    assert!(refused(&["grasp", "five-bar"]).contains("has no contacts"));
    assert!(refused(&["grasp", "two-arm"]).contains("is complete"));
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("plain.toml");
    let plain = fs::read_to_string(GRASP).unwrap().replace("friction = 0.5", "");
    fs::write(&file, plain).unwrap();
    let text = refused(&["grasp", file.to_str().unwrap(), "--torsion", "0.01"]);
    assert!(text.contains("no coefficient of friction"), "{text}");
}

/// Force closure of many fingers, whose mobility without friction is not analysed.
#[test]
fn many_fingers_are_closed() {
    let mut text = "dimension = 2\nreference = \"ball\"\n".to_owned();
    for i in 0..65 {
        let (s, c) = (f64::from(i) * 0.1).sin_cos();
        text += &format!(
            "[[contact]]\nname = \"c{i}\"\ntype = \"hard_finger\"\nbetween = [\"ground\", \"ball\"]\n\
             point = [{c}, {s}]\nnormal = [{}, {}]\nfriction = 0.3\n",
            -c, -s
        );
    }
    let file = tempfile::Builder::new().suffix(".toml").tempfile().unwrap();
    std::fs::write(file.path(), text).unwrap();
    let path = file.path().to_str().unwrap();
    let report = json(&["grasp", path], 0);
    assert!(report["closed"] == true && report["immobilisation"].is_null(), "{report}");
    assert!(report["not_analysed"].as_str().unwrap().contains("at most 64 contacts"), "{report}");
    assert!(crate::text(&["grasp", path]).contains("not analysed: at most 64 contacts"));
}

/// A triangle between three fingers: flat edges, a disc, and an object that overlaps.
#[test]
fn immobilisation() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("plate.toml");
    let contact = |name: &str, degrees: f64, curvature: &str| {
        let (s, c) = degrees.to_radians().sin_cos();
        format!(
            "[[contact]]\nname = \"{name}\"\ntype = \"point_frictionless\"\n\
             between = [\"ground\", \"plate\"]\npoint = [{c}, {s}]\nnormal = [{}, {}]\n{curvature}\n",
            -c, -s
        )
    };
    let write = |curvature: &str| {
        let contacts = [("a", 30.0), ("b", 150.0), ("c", 270.0)]
            .map(|(name, degrees)| contact(name, degrees, curvature));
        let head = "dimension = 2\nreference = \"plate\"\nreference_point = [0, 0]\n";
        fs::write(&file, head.to_owned() + &contacts.concat()).unwrap();
        file.to_str().unwrap()
    };
    for (curvature, verdict, value) in [
        ("", "immobile to second order", -1.0),
        ("curvature = [inf, 0]", "immobile to second order", -1.0),
        ("curvature = [2, 0]", "immobile to second order", -1.5),
        ("curvature = [4.0, 1.0]", "undecided: higher order", 0.0),
        ("curvature = [inf, 3]", "mobile", 2.0),
    ] {
        let report = &json(&["grasp", write(curvature)], 1)["immobilisation"];
        assert_eq!(report["verdict"], verdict, "{curvature}");
        assert_eq!(report["first_order_mobility"], 1);
        assert!((numbers(&report["curvatures"])[0] - value).abs() < 1e-12, "{report}");
        assert_eq!(report["escape"].is_object(), verdict == "mobile");
    }
    let output = cylindroid(&["grasp", write("curvature = [inf, 0.5]")]);
    let table = String::from_utf8_lossy(&output.stdout);
    assert!(table.contains("immobile to second order") && table.contains("sharp"), "{table}");
    let text = refused(&["grasp", write("curvature = [1, -2]")]);
    assert!(text.contains("sum to -1 1/m") && text.contains("line_frictionless"), "{text}");
}
