//! `mobility` and `manipulability`.

use crate::{cylindroid, difference, json, numbers, text};

#[test]
fn mobility_counts() {
    let stewart = json(&["mobility", "stewart"], 0);
    assert_eq!((&stewart["dof"], &stewart["grubler"]), (&6.into(), &6.into()));
    assert_eq!(stewart["actuated"].as_array().unwrap().len(), 6);
    assert_eq!(stewart["joints"].as_array().unwrap().len(), 21);
    let five_bar = json(&["mobility", "five-bar", "--actuated", "q1,q2,q3,q4,q5"], 0);
    for (key, count) in
        [("dof", 2), ("internal", 3), ("zero_torque", 1), ("hyperstatic", 0), ("idle", 0)]
    {
        assert_eq!(five_bar[key], count, "{key}");
    }
    assert!(five_bar["gap"]["distance"].as_f64().unwrap() < 1e-12);
    assert!(text(&["mobility", "two-arm"]).contains("torques of driven joints that balance"));
    // Opened by hand: said, not hidden.
    let open = text(&["mobility", "five-bar", "--q", "0.3,0,0,0"]);
    assert!(open.contains("loops are open by"), "{open}");
    // A serial arm is an ordinary case.
    assert_eq!(json(&["mobility", "panda"], 0)["redundancy"], 1);
}

/// 7 +- sqrt 41, and forces the inverses: Bicchi & Prattichizzo's case a, corrected.
#[test]
fn manipulability_of_the_five_bar() {
    let report = json(&["manipulability", "five-bar", "--actuated", "q1,q5"], 0);
    let root = 41_f64.sqrt();
    let (large, small) = (7.0 + root, 7.0 - root);
    assert!(difference(&numbers(&report["kinematic"]["finite"]), &[large, small]) < 1e-11);
    let force = [1.0 / small, 1.0 / large];
    assert!(difference(&numbers(&report["active_force"]["finite"]), &force) < 1e-11);
    assert!(difference(&numbers(&report["passive_force"]["finite"]), &force) < 1e-11);
    assert_eq!(report["passive_force"]["infinite"], 1);
    assert_eq!(report["components"], serde_json::json!(["x", "y", "rz"]));
    let text = text(&["manipulability", "five-bar", "--actuated", "q1,q5"]);
    assert!(text.contains("13.4031") && text.contains("infinite"), "{text}");
    let limits = json(&["manipulability", "panda", "--metric", "limits"], 0);
    assert_eq!(limits["kinematic"]["zeros"], 1);
}

#[test]
fn loops_are_closed_from_a_guess() {
    let command = ["assemble", "five-bar", "--q", "0.2,-0.1,0,0", "--hold", "q1"];
    let report = json(&command, 0);
    assert_eq!((&report["closed"], &report["q"][0]), (&true.into(), &0.2.into()));
    assert!(report["gap"]["distance"].as_f64().unwrap() < 1e-9);
    // The line q is an argument of other commands.
    let text = text(&command);
    let q = text.lines().find_map(|l| l.strip_prefix("q ")).unwrap().trim().to_owned();
    let mobility = json(&["mobility", "five-bar", "--q", &q], 0);
    assert!(mobility["gap"]["distance"].as_f64().unwrap() < 1e-9);
    // Too far apart: a negative answer.
    let far = json(&["assemble", "five-bar", "--q", "1.5708,0,0,0", "--hold", "q1"], 1);
    assert_eq!(far["closed"], false);
    let output = cylindroid(&["assemble", "five-bar", "--hold", "q9"]);
    assert_eq!(output.status.code(), Some(2));
}

/// Two circles meet in two points; a Stewart platform has mirror pairs; motions are said.
#[test]
fn modes_are_listed() {
    let report = json(&["assemble", "five-bar", "--hold", "q1,q2", "--modes", "20"], 0);
    let modes = report["modes"].as_array().unwrap();
    assert_eq!((modes.len(), &report["closed_starts"]), (2, &20.into()));
    assert!(difference(&numbers(&modes[0]["q"]), &[0.0; 4]) < 1e-12);
    assert_eq!(modes[0]["found"].as_u64().unwrap() + modes[1]["found"].as_u64().unwrap(), 20);
    assert_eq!((&report["continuum"], &report["chance_of_more"]), (&0.into(), &0.0.into()));
    let command = ["assemble", "stewart", "--hold", "driven", "--modes", "40"];
    let legs = json(&command, 0);
    assert!(legs["modes"].as_array().unwrap().len().is_multiple_of(2) && legs["held"][5] == "leg6");
    // The same seed, the same answer; another, other starts.
    assert_eq!(legs, json(&command, 0));
    let seeded = [&command[..], &["--seed", "9"]].concat();
    assert_ne!(legs["modes"][0]["found"], json(&seeded, 0)["modes"][0]["found"]);
    let free = text(&["assemble", "four-bar", "--modes", "4"]);
    assert!(free.contains("1 degree of freedom"), "{free}");
    let none = ["assemble", "five-bar", "--q", "1.5708,0,0,0", "--hold", "q1", "--modes", "4"];
    let none = json(&none, 1);
    assert!(none["closed"] == false && none["guess_gap"]["distance"].as_f64().unwrap() > 0.1);
    let table = text(&["assemble", "five-bar", "--hold", "q1,q2", "--modes", "20"]);
    assert!(table.contains("2 modes from 20") && table.contains("q of mode 2"), "{table}");
}

#[test]
fn coordinates_go_where_they_are_sent() {
    // Round once, in the same mode.
    let round = json(&["assemble", "four-bar", "--to", "q1=360", "--degrees"], 0);
    let turn = std::f64::consts::TAU;
    assert!(difference(&numbers(&round["q"]), &[turn, -turn, 0.0]) < 1e-9);
    assert_eq!((&round["end"], &round["share"]), (&"reached".into(), &1.0.into()));
    assert!(round["path"].as_array().unwrap().len() > 20);
    // The links of q3 and q4 stretch; the reference frame rests with the drives.
    let stopped = json(&["assemble", "five-bar", "--to", "q1=0.5,q2=-1.2"], 1);
    assert_eq!((&stopped["end"], &stopped["reached"]), (&"singular".into(), &false.into()));
    let sight = &stopped["singularity"];
    assert_eq!((&sight["kind"], &sight["screw"]), (&"passive".into(), &serde_json::Value::Null));
    assert!((sight["distance"].as_f64().unwrap() - 1e-3).abs() < 1e-6);
    let share = stopped["share"].as_f64().unwrap();
    assert!((stopped["q"][0].as_f64().unwrap() - 0.5 * share).abs() < 1e-12);
    let wider = ["assemble", "five-bar", "--to", "q1=0.5,q2=-1.2", "--least-distance", "0.05"];
    assert!(json(&wider, 1)["share"].as_f64().unwrap() < share);
    // A limit of the leg that goes, the others held.
    let limit = json(&["assemble", "stewart", "--to", "leg1=0.5", "--hold", "driven"], 1);
    assert_eq!((&limit["end"], &limit["limit"]), (&"limit".into(), &"leg1".into()));
    assert!((limit["share"].as_f64().unwrap() - 0.8).abs() < 1e-9);
    assert_eq!(limit["goal"].as_array().unwrap().len(), 6);
    let over = json(&["assemble", "five-bar", "--to", "q1=1", "--hold", "q2,q3"], 1);
    assert_eq!(over["end"], "contradiction");
    let open = json(&["assemble", "five-bar", "--q", "q1=1.5708", "--to", "q1=0"], 1);
    assert_eq!(open["end"], "open");
    let table = cylindroid(&["assemble", "five-bar", "--to", "q1=0.5,q2=-1.2"]);
    assert_eq!(table.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&table.stdout).contains("stopped before a singularity"));
    let tree = json(&["assemble", "panda", "--to", "panda_joint1=0.5"], 0);
    assert_eq!(tree["path"][0]["distance"], serde_json::Value::Null);
}

#[test]
fn bad_requests() {
    let refused = |arguments: &[&str]| {
        let output = cylindroid(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    assert!(refused(&["mobility", "five-bar", "--actuated", "q9"]).contains("q1, q2"));
    assert!(refused(&["mobility", "five-bar", "--frame", "x"]).contains("frame"));
    assert!(refused(&["mobility", "five-bar", "--length", "0"]).contains("length"));
    let text =
        refused(&["manipulability", "five-bar", "--actuated", "q1,q5", "--metric", "limits"]);
    assert!(text.contains("q5"), "{text}");
    assert!(refused(&["assemble", "five-bar", "--modes", "0"]).contains("starts"));
    assert!(refused(&["assemble", "five-bar", "--modes", "2", "--to", "q1=1"]).contains("--to"));
    assert!(refused(&["assemble", "five-bar", "--to", "1,2,3,4"]).contains("name the coordinates"));
    assert!(refused(&["assemble", "five-bar", "--to", "q9=1"]).contains("q1, q2"));
    assert!(refused(&["assemble", "five-bar", "--to", "q1=1,q1=2"]).contains("twice"));
    assert!(refused(&["assemble", "stewart", "--hold", "s1.rx"]).contains("hold all"));
    assert!(refused(&["assemble", "stewart", "--hold", "nobody"]).contains("coordinate"));
    let far = ["assemble", "five-bar", "--to", "q1=1", "--least-distance", "2"];
    assert!(refused(&far).contains("least_distance"));
    let text = refused(&["move", "five-bar", "--to", "1,2,0"]);
    assert!(text.contains("loops"), "{text}");
}
