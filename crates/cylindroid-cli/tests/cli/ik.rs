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
fn the_best_by_a_criterion() {
    let target = ["ik", "panda", "--to", "0.45,0.15,0.35", "--rpy", "3.1416,0,0.6"];
    let command = [&target[..], &["--maximise", "manipulability"]].concat();
    let report = json(&command, 0);
    assert_eq!(report["criterion"]["name"], "manipulability");
    let best = report["criterion"]["value"].as_f64().unwrap();
    let all = json(&[&command[..], &["--all", "50"]].concat(), 0);
    assert_eq!(all["q"], report["q"]);
    assert!(all["solutions"].as_array().unwrap().len() > 1);
    assert!(json(&target, 0).get("criterion").is_none());
    let away = [&target[..], &["--maximise", "limit-avoidance"]].concat();
    assert!(best > 0.0 && json(&away, 0)["criterion"]["value"].as_f64().unwrap() <= 0.0);
    let table = text(&[&command[..], &["--all", "50"]].concat());
    assert!(table.contains("that of the largest manipulability first"), "{table}");
    assert!(text(&command).contains("manipulability"), "{table}");
    let wrong = [&target[..], &["--maximise", "manipulabilty"]].concat();
    assert!(refused(&wrong).contains("nearest: manipulability"));
    let goals = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/goals.toml");
    let posture = ["ik", "panda", "--tasks", goals, "--maximise", "manipulability"];
    assert!(refused(&posture).contains("posture"));
    let loops = ["ik", "stewart", "--to", "0,0,1", "--maximise", "limit-avoidance"];
    assert!(refused(&loops).contains("criterion"));
}

/// The loops are closed with the target; the frame is the reference.
#[test]
fn working_modes_of_a_closed_chain() {
    let command = ["ik", "five-bar", "--to", "1,1.5,0", "--all", "8"];
    let report = json(&command, 0);
    let solutions = report["solutions"].as_array().unwrap();
    assert_eq!((solutions.len(), &report["frame"]), (4, &"reference".into()));
    for q in solutions {
        let q: Vec<String> = numbers(q).iter().map(ToString::to_string).collect();
        let fk = json(&["fk", "five-bar", "--q", &q.join(","), "--frame", "reference"], 0);
        assert!(difference(&numbers(&fk["pose"]["position"]), &[1.0, 1.5, 0.0]) < 1e-9);
    }
    assert!(text(&command).contains("reached by 4 configurations"));
    let far = json(&["ik", "stewart", "--to", "0,0,1.9", "--rpy", "0,0,0"], 1);
    assert_eq!(far["reason"]["kind"], "limits");
    let message = refused(&["ik", "five-bar", "--to", "1,1.5,0", "--avoid"]);
    assert!(message.contains("--avoid"), "{message}");
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
    assert_eq!(far["reason"]["kind"], "out of reach");
    let platform = json(&["ik", "stewart", "--to", "0,0,1"], 0);
    assert_eq!(platform["success"], true);
}

#[test]
fn several_frames_at_once() {
    let command = ["ik", "panda", "--task", "hand_tcp=0.4,0.1,0.5", "--task", "link4=0.1,0,0.6"];
    let report = json(&command[..4], 0);
    assert!(report.get("goals").is_none() && report.get("reason").is_none());
    let report = json(&command, 1);
    assert_eq!(report["goals"][1]["frame"], "link4");
    assert_eq!(report["goals"][0]["components"][2], "z");
    assert!(["limits", "not proven"].contains(&report["reason"]["kind"].as_str().unwrap()));
    let pose = ["ik", "panda", "--to", "0.4,0.1,0.5", "--task", "link2=0,0,0.333"];
    assert_eq!(json(&pose, 0)["goals"].as_array().unwrap().len(), 2);
    let frame = [&command[..], &["--frame", "link3"]].concat();
    assert!(refused(&frame).contains("no target for it"));
}

#[test]
fn solutions_among_obstacles() {
    let cell = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/cell.toml");
    let command = ["ik", cell, "--to", "0.4,0,0.4", "--obstacle", "ball=sphere:0.1@0.4,0.1,0.3"];
    let report = json(&command, 0);
    assert_eq!(report["gap"], 0.01);
    let q = numbers(&report["q"]).iter().map(f64::to_string).collect::<Vec<_>>().join(",");
    let obstacle = &command[4..];
    let near = json(&[&["distance", cell, "--q", &q, "--margin", "0.01"], obstacle].concat(), 0);
    assert_eq!(near["near"].as_array().unwrap().len(), 0, "{near}");
    // A ball around the target is in the way of every solution.
    let closed = ["ik", cell, "--to", "0.4,0,0.4", "--iterations", "2000"];
    let closed = [&closed[..], &["--obstacle", "ball=sphere:0.3@0.4,0,0.4"]].concat();
    let report = json(&closed, 1);
    assert_eq!(report["reason"]["kind"], "collision");
    assert!(report["reason"]["distance"].as_f64().unwrap() < 0.01);
    assert!(refused(&["ik", cell, "--to", "0.4,0,0.4", "--gap", "0.1"]).contains("no effect"));
}

fn file(folder: &tempfile::TempDir, text: &str) -> String {
    let path = folder.path().join("goals.toml");
    std::fs::write(&path, text).unwrap();
    path.to_string_lossy().into_owned()
}

#[test]
fn goals_of_a_file() {
    let goals = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/goals.toml");
    let report = json(&["ik", "panda", "--tasks", goals], 0);
    assert!(report.get("frame").is_none() && report.get("target").is_none());
    assert_eq!(report["goals"][0]["type"], "gaze");
    assert_eq!(numbers(&report["goals"][0]["point"]), [0.55, 0.1, 0.0]);
    assert_eq!(report["goals"][1]["components"][0], "z");
    assert_eq!(report["half_spaces"][1], "box of hand_tcp +x");
    assert_eq!(numbers(&report["posture"])[3], -2.0);
    // By forward kinematics: the height, the box, the direction.
    let q = numbers(&report["q"]).iter().map(f64::to_string).collect::<Vec<_>>().join(",");
    let pose = json(&["fk", "panda", "--q", &q], 0);
    let at = numbers(&pose["pose"]["position"]);
    assert!((at[2] - 0.35).abs() < 2e-6, "{at:?}");
    for (x, (middle, side)) in at.iter().zip([(0.5, 0.2), (0.1, 0.3), (0.3, 0.3)]) {
        assert!((x - middle).abs() <= 0.5 * side + 2e-6, "{at:?}");
    }
    let table = text(&["ik", "panda", "--tasks", goals]);
    assert!(table.contains("hand_tcp: gaze; hand_tcp: z"), "{table}");
    // With a target beside it.
    let both = ["ik", "panda", "--frame", "link4", "--to", "0,0.1,0.65", "--task", "y"];
    let report = json(&[&both[..], &["--tasks", goals]].concat(), 0);
    assert_eq!(report["frame"], "link4");
    assert_eq!(report["goals"].as_array().unwrap().len(), 3);
}

#[test]
fn files_of_goals_are_checked() {
    let folder = tempfile::tempdir().unwrap();
    let wall = "[[half_space]]\nframe = 'hand_tcp'\npoint = [0.9, 0, 0]\nnormal = [1, 0, 0]";
    let wall = file(&folder, wall);
    let report = json(&["ik", "panda", "--to", "0.4,0,0.4", "--tasks", &wall], 1);
    assert_eq!(report["reason"]["kind"], "half-space");
    assert_eq!(report["reason"]["half_spaces"][0], "half-space of hand_tcp");
    assert!(refused(&["ik", "panda", "--tasks", &wall]).contains("neither a frame"));
    let relative = "[[task]]\ntype = 'relative_frame'\nframe = 'hand_tcp'\n\
                    reference = 'link4'\nxyz = [0.0, 0.0, 0.1]\ncomponents = 'z'";
    let report = json(&["ik", "panda", "--tasks", &file(&folder, relative)], 0);
    assert_eq!(report["goals"][0]["reference"], "link4");
    let center = "[[task]]\ntype = 'center_of_mass'\nxyz = [0, 0, 0.4]";
    assert!(refused(&["ik", "panda", "--tasks", &file(&folder, center)]).contains("mass"));
    let gradient = file(&folder, "[[task]]\ntype = 'limit_avoidance'\nmargin = 0.3");
    assert!(refused(&["ik", "panda", "--tasks", &gradient]).contains("neither a frame"));
    let command = ["ik", "panda", "--to", "0.4,0,0.4", "--tasks", &gradient];
    assert_eq!(json(&command, 0)["criterion"]["name"], "limit-avoidance");
    let twice = [&command[..], &["--maximise", "manipulability"]].concat();
    assert!(refused(&twice).contains("the file of tasks has a criterion"));
}
