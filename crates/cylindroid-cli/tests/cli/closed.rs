//! `mobility`, `manipulability`, `assemble`.

use std::path::{Path, PathBuf};

use crate::{cylindroid, difference, json, numbers, refused, text};

#[test]
fn mobility_counts() {
    let stewart = json(&["mobility", "stewart"], 0);
    assert_eq!((&stewart["dof"], &stewart["gruebler_kutzbach"]), (&6.into(), &6.into()));
    assert_eq!(stewart["actuated"].as_array().unwrap().len(), 6);
    assert_eq!(stewart["joints"].as_array().unwrap().len(), 21);
    let five_bar = json(&["mobility", "five-bar", "--actuated", "q1,q2,q3,q4,q5"], 0);
    for (key, count) in
        [("dof", 2), ("internal", 3), ("zero_torque", 1), ("hyperstatic", 0), ("idle", 0)]
    {
        assert_eq!(five_bar[key], count, "{key}");
    }
    assert!(five_bar["closure_error"]["distance"].as_f64().unwrap() < 1e-12);
    // Two arms of seven joints: one elbow each, and all they can do to each other.
    let table = text(&["mobility", "two-arm"]);
    let count = |kind: &str| {
        let row = table.lines().find_map(|l| l.strip_prefix(kind)).unwrap();
        row.split_whitespace().next().unwrap().to_owned()
    };
    assert_eq!((count("redundancy"), count("internal")), ("2".to_owned(), "6".to_owned()));
    // Opened by hand: said, not hidden.
    let open = text(&["mobility", "five-bar", "--q", "0.3,0,0,0"]);
    assert!(open.contains("loops are open by"), "{open}");
    // So are limits that a configuration leaves, in every command that looks at one.
    for command in [&["mobility", "panda"][..], &["statics", "panda", "--wrench", "0,0,1,0,0,0"]] {
        let command = [command, &["--q", "zero"]].concat();
        assert_eq!(json(&command, 0)["outside_limits"], serde_json::json!(["panda_joint4"]));
        assert!(text(&command).contains("outside the position limits: panda_joint4"));
    }
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
    assert!(report["closure_error"]["distance"].as_f64().unwrap() < 1e-9);
    // The line q is an argument of other commands.
    let text = text(&command);
    let q = text.lines().find_map(|l| l.strip_prefix("q ")).unwrap().trim().to_owned();
    assert!(text.contains("closed: 1 loop and 0 contacts"), "{text}");
    let mobility = json(&["mobility", "five-bar", "--q", &q], 0);
    assert!(mobility["closure_error"]["distance"].as_f64().unwrap() < 1e-9);
    // Too far apart: a negative answer.
    let far = json(&["assemble", "five-bar", "--q", "1.5708,0,0,0", "--hold", "q1"], 1);
    assert_eq!(far["closed"], false);
    let output = cylindroid(&["assemble", "five-bar", "--hold", "q9"]);
    assert_eq!(output.status.code(), Some(2));
}

/// The object is actuated through the actuators, loops closed; its pose is that of `fk`.
#[test]
fn objects_are_moved() {
    let command = ["move", "stewart", "--to", "0.1,0.05,1.1", "--rpy", "0,0,0.1"];
    let report = json(&command, 0);
    assert_eq!(report["reached"], true);
    assert_eq!(report["actuated"].as_array().unwrap().len(), 6);
    assert!(report["closure_error"]["distance"].as_f64().unwrap() < 1e-9);
    assert!(report["closure_error"]["angle"].as_f64().unwrap() < 1e-9);
    let q: Vec<String> = numbers(&report["q"]).iter().map(ToString::to_string).collect();
    let fk = json(&["fk", "stewart", "--q", &q.join(",")], 0);
    let at = numbers(&fk["pose"]["position"]);
    assert!(difference(&at, &[0.1, 0.05, 1.1]) < 1e-5, "{at:?}");

    let text = text(&["move", "five-bar", "--actuated", "q1,q5", "--to", "1.2,1.8,0"]);
    assert!(text.contains("q1, q5") && text.contains("loops open by at most"), "{text}");
    // Down to where its links are in line.
    let report = json(&["move", "five-bar", "--actuated", "q1,q5", "--to", "1.2,-1,0"], 1);
    assert_eq!(report["reason"], "type-ii");
    assert!(report["explanation"].as_str().unwrap().contains("type II"));
}

#[test]
fn operation_modes_are_listed() {
    let report = json(&["mobility", "five-bar", "--modes", "6"], 0);
    let mode = &report["modes"][0];
    assert_eq!((&mode["dimension"], &mode["found"]), (&2.into(), &6.into()));
    assert_eq!((&mode["class"], &mode["through"]), (&"IIB".into(), &true.into()));
    assert_eq!(report["meetings"].as_array().unwrap().len(), 0);
    let table = text(&["mobility", "five-bar", "--modes", "6"]);
    assert!(table.contains("1 operation mode from 6 of 6 starts"), "{table}");
}

/// Two circles meet in two points; a Stewart platform has mirror pairs; motions are said.
#[test]
fn modes_are_listed() {
    let report = json(&["assemble", "five-bar", "--hold", "q1,q2", "--modes", "20"], 0);
    let modes = report["modes"].as_array().unwrap();
    assert_eq!((modes.len(), &report["closed_starts"]), (2, &20.into()));
    assert!(difference(&numbers(&modes[0]["q"]), &[0.0; 4]) < 1e-12);
    assert_eq!(modes[0]["found"].as_u64().unwrap() + modes[1]["found"].as_u64().unwrap(), 20);
    assert_eq!(
        (&report["self_motion_dof"], &report["unseen_probability"]),
        (&0.into(), &0.0.into())
    );
    let command = ["assemble", "stewart", "--hold", "actuated", "--modes", "40"];
    let legs = json(&command, 0);
    assert!(
        legs["modes"].as_array().unwrap().len().is_multiple_of(2)
            && legs["prescribed"][5] == "leg6"
    );
    // The same seed, the same answer; another, other starts.
    assert_eq!(legs, json(&command, 0));
    let seeded = [&command[..], &["--seed", "9"]].concat();
    assert_ne!(legs["modes"][0]["found"], json(&seeded, 0)["modes"][0]["found"]);
    let free = text(&["assemble", "four-bar", "--modes", "4"]);
    assert!(free.contains("1 degree of freedom"), "{free}");
    let none = ["assemble", "five-bar", "--q", "1.5708,0,0,0", "--hold", "q1", "--modes", "4"];
    let none = json(&none, 1);
    assert!(
        none["closed"] == false && none["guess_closure_error"]["distance"].as_f64().unwrap() > 0.1
    );
    let table = text(&["assemble", "five-bar", "--hold", "q1,q2", "--modes", "20"]);
    assert!(table.contains("2 modes from 20") && table.contains("q of mode 2"), "{table}");
    // Rounding is not spelt out.
    assert!(table.contains("q of mode 1  0,0,0,0"), "{table}");
}

#[test]
fn coordinates_go_where_they_are_sent() {
    // Round once, in the same mode.
    let round = json(&["assemble", "four-bar", "--to", "q1=360", "--degrees"], 0);
    let turn = std::f64::consts::TAU;
    assert!(difference(&numbers(&round["q"]), &[turn, -turn, 0.0]) < 1e-9);
    assert_eq!((&round["end"], &round["fraction"]), (&"reached".into(), &1.0.into()));
    assert!(round["path"].as_array().unwrap().len() > 20);
    // The links of q3 and q4 stretch; the reference frame rests with the actuators.
    let stopped = json(&["assemble", "five-bar", "--to", "q1=0.5,q2=-1.2"], 1);
    assert_eq!((&stopped["end"], &stopped["reached"]), (&"singular".into(), &false.into()));
    let sight = &stopped["singularity"];
    assert_eq!((&sight["kind"], &sight["screw"]), (&"passive".into(), &serde_json::Value::Null));
    assert!((sight["distance"].as_f64().unwrap() - 1e-3).abs() < 1e-6);
    let share = stopped["fraction"].as_f64().unwrap();
    assert!((stopped["q"][0].as_f64().unwrap() - 0.5 * share).abs() < 1e-12);
    let wider = ["assemble", "five-bar", "--to", "q1=0.5,q2=-1.2", "--least-distance", "0.05"];
    assert!(json(&wider, 1)["fraction"].as_f64().unwrap() < share);
    // A limit of the leg that goes, the others prescribed.
    let limit = json(&["assemble", "stewart", "--to", "leg1=0.5", "--hold", "actuated"], 1);
    assert_eq!((&limit["end"], &limit["limit"]), (&"limit".into(), &"leg1".into()));
    assert!((limit["fraction"].as_f64().unwrap() - 0.8).abs() < 1e-9);
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
    assert!(refused(&["mobility", "five-bar", "--actuated", "q9"]).contains("q1, q2"));
    assert!(refused(&["mobility", "five-bar", "--frame", "x"]).contains("frame"));
    assert!(refused(&["mobility", "five-bar", "--length", "0"]).contains("length"));
    let text =
        refused(&["manipulability", "five-bar", "--actuated", "q1,q5", "--metric", "limits"]);
    assert!(text.contains("q5"), "{text}");
    assert!(refused(&["assemble", "five-bar", "--modes", "0"]).contains("first start"));
    assert!(refused(&["assemble", "five-bar", "--modes", "2", "--to", "q1=1"]).contains("--to"));
    assert!(refused(&["assemble", "five-bar", "--to", "1,2,3,4"]).contains("name the coordinates"));
    assert!(refused(&["assemble", "five-bar", "--to", "q9=1"]).contains("q1, q2"));
    assert!(refused(&["assemble", "five-bar", "--to", "q1=1,q1=2"]).contains("twice"));
    assert!(refused(&["assemble", "stewart", "--hold", "s1.rx"]).contains("prescribe all"));
    assert!(refused(&["assemble", "stewart", "--hold", "nobody"]).contains("coordinate"));
    let far = ["assemble", "five-bar", "--to", "q1=1", "--least-distance", "2"];
    assert!(refused(&far).contains("--least-distance"));
    let text = refused(&["move", "five-bar", "--joint-to", "0.1,0,0,0"]);
    assert!(text.contains("loops"), "{text}");
    let text = refused(&["move", "five-bar", "--actuated", "q1", "--to", "1,2,0"]);
    assert!(text.contains("actuate more joints"), "{text}");
    let text = refused(&["move", "five-bar", "--q", "0.4,0,0,0", "--to", "1,2,0"]);
    assert!(text.contains("assemble"), "{text}");
}

/// Mechanisms of the library's tests.
fn file(name: &str) -> String {
    format!("../cylindroid/tests/data/mechanisms/{name}.toml")
}

#[test]
fn singular_postures_are_named() {
    let stewart = json(&["mobility", "stewart"], 0);
    assert_eq!(
        (&stewart["finite_dof"], &stewart["singularity"]["regular"]),
        (&6.into(), &true.into())
    );
    assert!(stewart["singularity"]["compared_with"].as_u64().unwrap() >= 2);
    let page = text(&["mobility", "stewart"]);
    assert!(
        page.contains("none: the configuration is regular") && page.contains("all of it"),
        "{page}"
    );

    let turned = json(&["mobility", &file("stewart-turned")], 0);
    let gained = &turned["singularity"]["gained"][0];
    assert!(difference(&numbers(&gained["direction"]), &[0.0, 0.0, 1.0]) < 1e-9);
    let kind = turned["singularity"]["kinds"][0].as_str().unwrap();
    assert!(kind.starts_with("type II "), "{kind}");
    assert_eq!(turned["singularity"]["distances"]["type_ii"], 0.0);
    let page = text(&["mobility", &file("stewart-turned")]);
    assert!(page.contains("a screw of pitch -0.459627 m/rad"), "{page}");

    let page = text(&["mobility", &file("five-bar-dead")]);
    assert!(page.contains("a force along the line through (0, 0) m, direction (1, 0)"), "{page}");
    let page = text(&["mobility", &file("five-bar-stretched")]);
    assert!(page.contains("a rotation about the point (0, 1) m"), "{page}");
    let arm = text(&["mobility", "ur5e", "--q", "zero"]);
    assert!(arm.contains("a couple about (1, 0, 0)"), "{arm}");
}

#[test]
fn finite_motion_is_told_from_first_order() {
    let folded = json(&["mobility", &file("folded-parallelogram")], 0);
    assert_eq!((&folded["dof"], &folded["finite_dof"]), (&2.into(), &1.into()));
    assert_eq!(folded["finite"]["branches"].as_array().unwrap().len(), 2);
    assert_eq!(folded["finite"]["certain"], true);
    assert!(text(&["mobility", &file("folded-parallelogram")]).contains("2 branches meet"));
    let pair = json(&["mobility", &file("stretched-pair")], 0);
    assert_eq!((&pair["dof"], &pair["finite_dof"]), (&1.into(), &0.into()));
    assert!(text(&["mobility", &file("stretched-pair")]).contains("shaky"));
    let spatial = json(&["mobility", &file("spatial-four-bar")], 0);
    assert_eq!((&spatial["gruebler_kutzbach"], &spatial["finite_dof"]), (&(-2).into(), &1.into()));
    assert_eq!(
        (&spatial["hyperstatic"], &spatial["singularity"]["regular"]),
        (&3.into(), &true.into())
    );
    // Open loops: nothing is said.
    let open = json(&["mobility", "five-bar", "--q", "0.3,0,0,0"], 0);
    assert!(open["finite_dof"].is_null());
}

/// Each has an answer or one clear error.
#[test]
fn strange_mechanisms() {
    let all = json(&["mobility", "five-bar", "--actuated", "q1,q2,q3,q4,q5"], 0);
    assert_eq!(all["singularity"]["regular"], true);
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let pair = std::fs::read_to_string(file("stretched-pair")).unwrap();
    // Nothing actuated.
    let idle = json(&["mobility", &write("idle.toml", &pair.replace("actuated = true", ""))], 0);
    assert_eq!((&idle["actuated"], &idle["finite_dof"]), (&serde_json::json!([]), &0.into()));
    // A contact on a missing link.
    let contact = "\n[[contact]]\nname = \"c1\"\ntype = \"hard_finger\"\nbetween = [\"lift\", \
                   \"ground\"]\npoint = [1.0, 0.0]\nnormal = [0.0, 1.0]\n";
    let output = cylindroid(&["mobility", &write("missing.toml", &(pair + contact))]);
    assert_eq!(output.status.code(), Some(2));
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(error.contains("lift") && error.contains("left"), "{error}");
}

/// The robot files that `cargo xtask setup` fetches.
pub(crate) fn robots() -> PathBuf {
    let fetched = "../../target/test-data/models/cmeel.prefix/share/example-robot-data/robots";
    let folder = std::env::var_os("CYLINDROID_TEST_ROBOTS")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join(fetched), PathBuf::from);
    assert!(folder.is_dir(), "no robot files in {}: run `cargo xtask setup`", folder.display());
    folder
}

/// Two UR5 of a URDF hold a box; the efficiencies are those of Pinocchio's Jacobians.
#[test]
fn two_arms_of_real_files_hold_a_box() {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR")).join("../cylindroid/tests");
    let read = |path: &str| std::fs::read_to_string(tests.join(path)).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("two_ur5.toml");
    let file = read("data/two_ur5.toml").replace("ROBOTS", &robots().to_string_lossy());
    std::fs::write(&path, file).unwrap();
    let path = path.to_string_lossy();
    let mobility = json(&["mobility", &path], 0);
    for (key, count) in
        [("dof", 6), ("redundancy", 0), ("internal", 6), ("zero_torque", 0), ("hyperstatic", 0)]
    {
        assert_eq!(mobility[key], count, "{key}");
    }
    assert_eq!(mobility["actuated"].as_array().unwrap().len(), 12);
    let vectors: serde_json::Value =
        serde_json::from_str(&read("vectors/closed_chains/two_arms.json")).unwrap();
    let expected = numbers(&vectors["cases"][0]["kinematic"]);
    let report = json(&["manipulability", &path], 0);
    assert!(difference(&numbers(&report["kinematic"]["finite"]), &expected) < 1e-11);
    assert_eq!(report["active_force"]["zeros"], 6);
    let table = text(&["mobility", &path]);
    assert!(table.contains("left/shoulder_pan_joint"), "{table}");
}
