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
    assert!(table.contains("orientation error [rad]  not driven"), "{table}");
    let other = json(&[&["ik", "panda", "--seed", "5"], &target[..]].concat(), 0);
    assert_eq!(other["success"], true);
}

#[test]
fn several_answers() {
    let command = ["ik", "ur5e", "--to", "0.3,0.4,0.5", "--rpy", "3.1416,0,0", "--all", "20"];
    let report = json(&command, 0);
    let count = report["solutions"].as_array().unwrap().len();
    assert_eq!(count, 8);
    assert!(text(&command).contains("8 postures"));
}

#[test]
fn what_cannot_be_reached() {
    let far = json(&["ik", "panda", "--to", "2,0,0.5"], 1);
    assert_eq!(far["success"], false);
    assert!(far["out_of_reach"]["distance"].as_f64() > far["out_of_reach"]["length"].as_f64());
    assert_eq!(numbers(&far["q"]).len(), 7);
    assert!(refused(&["ik", "stewart", "--to", "0,0,1"]).contains("loops"));
}
