//! `ik`.

use crate::{difference, json, numbers, refused, text};

#[test]
fn a_pose_is_reached_and_fk_agrees() {
    let target = ["--to", "0.45,0.15,0.35", "--rpy", "3.1416,0,0.6"];
    let report = json(&[&["ik", "panda"], &target[..]].concat(), 0);
    assert_eq!(report["success"], true);
    assert!(report["position_error"].as_f64().unwrap() <= 1e-6);
    let q: Vec<String> = numbers(&report["q"]).iter().map(ToString::to_string).collect();
    let fk = json(&["fk", "panda", "--q", &q.join(",")], 0);
    assert!(difference(&numbers(&fk["pose"]["position"]), &[0.45, 0.15, 0.35]) < 2e-6);
    assert_eq!(fk["outside_limits"].as_array().unwrap().len(), 0);
    // The same again, and another seed.
    assert_eq!(report, json(&[&["ik", "panda"], &target[..]].concat(), 0));
    let table = text(&["ik", "panda", "--to", "0.45,0.15,0.35"]);
    assert!(table.contains("orientation error [rad]  not controlled"), "{table}");
    let other = json(&[&["ik", "panda", "--seed", "5"], &target[..]].concat(), 0);
    assert_eq!(other["success"], true);
}

#[test]
fn several_answers() {
    let command = ["ik", "ur5e", "--to", "0.3,0.4,0.5", "--rpy", "3.1416,0,0", "--all", "20"];
    let report = json(&command, 0);
    let count = report["solutions"].as_array().unwrap().len();
    assert_eq!(count, 8);
    assert_eq!(report["found_by"], "analytic");
    assert_eq!(report["analytic"]["structure"], "parallel axes 2, 3 and 4, axes 5 and 6 meet");
    let table = text(&command);
    assert!(
        table.contains("8 configurations") && table.contains("closed form (parallel axes"),
        "{table}"
    );
}

#[test]
fn formulas_are_named() {
    let puma = json(&["info", "puma560"], 0);
    let words = "spherical wrist, parallel axes 2 and 3";
    assert_eq!(puma["inverse_kinematics"]["structure"], words);
    assert!(text(&["info", "puma560"]).contains(words));
    let panda = json(&["info", "panda"], 0);
    assert!(panda["inverse_kinematics"]["structure"].is_null());
    assert!(panda["inverse_kinematics"]["reason"].as_str().unwrap().contains("7 joints"));
    let report = json(&["ik", "panda", "--to", "0.45,0.15,0.35", "--rpy", "3.1416,0,0.6"], 0);
    assert_eq!(report["analytic"]["locked"][0], "panda_joint7");
    let part = json(&["ik", "ur5e", "--to", "0.3,0.4,0.5"], 0);
    assert_eq!(part["found_by"], "numerical");
    assert!(part.get("analytic").is_none());
}

#[test]
fn what_cannot_be_reached() {
    let far = json(&["ik", "panda", "--to", "2,0,0.5"], 1);
    assert_eq!(far["success"], false);
    assert!(far["out_of_reach"]["distance"].as_f64() > far["out_of_reach"]["length"].as_f64());
    assert_eq!(numbers(&far["q"]).len(), 7);
    assert!(refused(&["ik", "stewart", "--to", "0,0,1"]).contains("loops"));
}
