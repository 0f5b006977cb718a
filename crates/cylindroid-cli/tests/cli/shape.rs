//! What each command prints.

use std::io::Read;
use std::process::{Command, Stdio};

use crate::{json, numbers, text};

#[test]
fn no_arguments_show_help_with_examples() {
    let help = text(&[]);
    assert!(help.contains("Examples:") && help.contains("cylindroid move panda"));
}

#[test]
fn models_lists_the_catalogue() {
    let models = json(&["models"], 0);
    let panda = models["models"].as_array().unwrap().iter().find(|m| m["name"] == "panda").unwrap();
    assert_eq!(panda["joints"], 7);
    assert!(panda["source"].as_str().unwrap().contains("Franka"));
    assert!(text(&["models"]).contains("ur5e"));
}

#[test]
fn info_has_names_limits_and_report() {
    let info = json(&["info", "panda"], 0);
    assert_eq!((&info["name"], &info["n"]), (&"panda".into(), &7.into()));
    assert_eq!(info["joint_names"][0], "panda_joint1");
    assert_eq!(info["joints"].as_array().unwrap().len(), 8, "the fixed flange too");
    assert_eq!(info["coordinates"][3]["upper"], -0.0698);
    assert_eq!(info["coordinates"][3]["unit"], "rad");
    assert_eq!(info["tool"], "hand_tcp");
    assert_eq!(numbers(&info["home"]).len(), 7);
    assert!(info["report"]["ignored"].as_array().unwrap().is_empty());
}

#[test]
fn info_shows_loops_and_contacts() {
    let info = json(&["info", "five-bar"], 0);
    assert_eq!((&info["n"], &info["dimension"]), (&4.into(), &2.into()));
    let q5 = &info["loops"][0];
    assert_eq!(
        (&q5["name"], &q5["kind"], &q5["actuated"]),
        (&"q5".into(), &"revolute".into(), &false.into())
    );
    assert_eq!((&q5["a"], &q5["b"]), (&"rocker".into(), &"ground".into()));
    assert_eq!(info["reference"]["link"], "coupler");
    assert_eq!(info["coordinates"][1]["actuated"], true);
    assert_eq!(info["coordinates"][2]["actuated"], false);
    let table = text(&["info", "five-bar"]);
    assert!(table.contains("closing joint") && table.contains("rocker, ground"), "{table}");

    let info = json(&["info", "two-arm"], 0);
    let contacts = info["contacts"].as_array().unwrap();
    assert_eq!((contacts.len(), &contacts[0]["kind"]), (2, &"complete".into()));
    assert_eq!((&contacts[1]["a"], &contacts[1]["b"]), (&"right/flange".into(), &"box".into()));
    assert!(contacts[0]["friction"].is_null());
    assert!(text(&["info", "two-arm"]).contains("left/flange, box"));
    let models = json(&["models"], 0);
    let count = |name: &str, what: &str| {
        let all = models["models"].as_array().unwrap();
        all.iter().find(|m| m["name"] == name).unwrap()[what].clone()
    };
    assert_eq!((count("stewart", "loops"), count("two-arm", "contacts")), (5.into(), 2.into()));
}

#[test]
fn info_shows_infinite_limits_as_null_and_dash() {
    // The sources of the PUMA 560 give no speeds.
    let info = json(&["info", "puma560"], 0);
    assert!(info["coordinates"][0]["acceleration"].is_null());
    let table = text(&["info", "puma560"]);
    let row = table.lines().find(|l| l.starts_with("joint1")).unwrap();
    assert!(row.split_whitespace().any(|cell| cell == "-"), "{row}");
}

#[test]
fn fk_gives_the_pose_in_four_notations() {
    let fk = json(&["fk", "panda", "--q", "home"], 0);
    let position = numbers(&fk["pose"]["position"]);
    for (i, p) in position.iter().enumerate() {
        assert_eq!(fk["pose"]["matrix"][i][3], *p);
    }
    assert!((position[0] - 0.306_891).abs() < 1e-6);
    assert_eq!(fk["frame"], "hand_tcp");
    assert!((fk["pose"]["quaternion"]["x"].as_f64().unwrap() - 1.0).abs() < 1e-12);
    assert_eq!(numbers(&fk["pose"]["rpy"]).len(), 3);
}

#[test]
fn fk_of_all_frames() {
    let fk = json(&["fk", "ur5e", "--all"], 0);
    assert!(fk["frames"].as_array().unwrap().len() > 6);
    assert_eq!(fk["frames"][0]["pose"]["matrix"][3][3], 1.0);
}

#[test]
fn q_may_be_named_and_in_degrees() {
    let named = json(&["fk", "panda", "--q", "panda_joint1=90, panda_joint4=-90", "--degrees"], 0);
    let q = numbers(&named["q"]);
    assert!((q[0] - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
    assert!((q[3] + std::f64::consts::FRAC_PI_2).abs() < 1e-15);
    assert!((q[5] - std::f64::consts::FRAC_PI_2).abs() < 1e-15, "home is not converted");
    let zero = json(&["fk", "panda", "--q", "zero"], 0);
    assert_eq!(zero["outside_limits"][0], "panda_joint4");
}

#[test]
fn jacobian_names_its_reference_and_length() {
    let report = json(&["jacobian", "panda", "--reference", "local"], 0);
    assert_eq!(report["reference"], "local");
    assert_eq!(report["matrix"].as_array().unwrap().len(), 6);
    assert_eq!(numbers(&report["matrix"][0]).len(), 7);
    assert_eq!(numbers(&report["singular_values"]).len(), 6);
    assert_eq!(report["rank"], 6);
    assert!(report["gap"].is_null(), "nothing was left out");
    assert_eq!(report["length"], json(&["info", "panda"], 0)["reach"]);
}

#[test]
fn jacobian_of_a_tool_point_is_the_moved_one() {
    // v_tool = v + w x r; at home the axes of the Panda's tool are (x, -y, -z).
    let at = |tool: &str| json(&["jacobian", "panda", "--tool", tool], 0)["matrix"].clone();
    let (here, there) = (at("0,0,0"), at("0,0,0.1"));
    let (w, v) = (numbers(&here[4]), numbers(&here[0]));
    for (i, x) in numbers(&there[0]).iter().enumerate() {
        assert!((x - (v[i] - 0.1 * w[i])).abs() < 1e-12);
    }
}

#[test]
fn jacobian_has_a_derivative_and_analytical_rates() {
    let report = json(&["jacobian", "ur5e", "--velocities", "shoulder_pan_joint=0.1"], 0);
    assert_eq!(report["derivative"].as_array().unwrap().len(), 6);
    assert_eq!(report["joint_velocities"][0], 0.1);
    let report = json(&["jacobian", "ur5e", "--analytical", "rotation-vector"], 0);
    assert_eq!(report["analytical"]["exists"], true);
    let gimbal_lock = json(&["jacobian", "panda", "--analytical", "zyz"], 0);
    assert_eq!(gimbal_lock["analytical"]["exists"], false, "the tool points straight down");
    // Four joints carry both.
    let relative = json(&["jacobian", "panda", "--relative-to", "link4"], 0);
    assert_eq!(
        (&relative["reference"], &relative["relative_to"]),
        (&"relative".into(), &"link4".into())
    );
    for row in relative["matrix"].as_array().unwrap() {
        assert_eq!(numbers(row)[..4], [0.0; 4]);
    }
    assert_eq!(relative["rank"], 3);
    let shown = text(&["jacobian", "panda", "--relative-to", "link4"]);
    assert!(shown.contains("relative to 'link4', in its axes, at the frame's origin"), "{shown}");
}

#[test]
fn a_closed_pipe_is_a_success() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_cylindroid"))
        .args(["info", "panda", "--json"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let mut stderr = String::new();
    child.stderr.take().unwrap().read_to_string(&mut stderr).unwrap();
    assert_eq!((child.wait().unwrap().code(), stderr.as_str()), (Some(0), ""));
}
