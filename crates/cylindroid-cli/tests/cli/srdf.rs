//! `--srdf`, `--group` and states of an SRDF, for all commands that take a model.

use std::fs;

use crate::{json, numbers, refused};

const TEXT: &str = r#"<robot name="panda">
  <group name="forearm"><chain base_link="link4" tip_link="link7"/></group>
  <group_state name="up" group="forearm">
    <joint name="panda_joint6" value="2.5"/><joint name="panda_joint7" value="-0.3"/>
  </group_state>
</robot>"#;

fn with_file(run: impl Fn(&str)) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("panda.srdf");
    fs::write(&file, TEXT).unwrap();
    run(file.to_str().unwrap());
}

/// The group is a robot of its own: its tool is where that of the whole robot's link is.
#[test]
fn a_group_is_a_robot_of_its_own() {
    with_file(|file| {
        let group = ["--srdf", file, "--group", "forearm"];
        let info = json(&[&["info", "panda"][..], &group].concat(), 0);
        assert_eq!((&info["n"], &info["tool"]), (&3.into(), &"link7".into()));
        let part = json(&[&["fk", "panda", "--q", "up"][..], &group].concat(), 0);
        let state = ["--srdf", file, "--frame", "link7", "--q", "up"];
        let whole = json(&[&["fk", "panda"][..], &state].concat(), 0);
        for (a, b) in
            numbers(&part["pose"]["position"]).iter().zip(numbers(&whole["pose"]["position"]))
        {
            assert!((a - b).abs() < 1e-14, "{part} {whole}");
        }
        // From that state to another one.
        let to = ["move", "panda", "--q", "up", "--joint-to", "home"];
        let moved = json(&[&to[..], &group].concat(), 0);
        assert_eq!(numbers(&moved["q"]).len(), 3);
    });
}

#[test]
fn groups_and_states_without_sense_are_refused() {
    with_file(|file| {
        let wrong = refused(&["info", "panda", "--srdf", file, "--group", "forarm"]);
        assert!(wrong.contains("nearest: forearm"), "{wrong}");
        let wrong = refused(&["fk", "panda", "--srdf", file, "--q", "upp"]);
        assert!(wrong.contains("nearest: up"), "{wrong}");
        let alone = refused(&["fk", "panda", "--q", "up"]);
        assert!(alone.contains("'up'") || alone.contains("= up"), "{alone}");
        assert!(alone.contains("--srdf"), "{alone}");
        let alone = refused(&["info", "panda", "--group", "forearm"]);
        assert!(alone.contains("--srdf"), "{alone}");
        let designs = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/designs.toml");
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out");
        let out = out.to_str().unwrap();
        let over = ["sweep", designs, "--over", "crank=0.4:0.6:2", "--out", out];
        let joints = ["left_drive", "left_elbow", "left_tip", "right_drive", "right_elbow"];
        let all = [&joints[..], &["across"]].concat();
        let joints: String = all.iter().map(|j| format!("<joint name=\"{j}\"/>")).collect();
        fs::write(file, format!("<robot><group name=\"all\">{joints}</group></robot>")).unwrap();
        let group = ["--srdf", file, "--group", "all"];
        let refused = refused(&[&over[..], &group].concat());
        assert!(refused.contains("--group"), "{refused}");
    });
}

/// An SRDF is read by every command, even if it needs nothing of it.
#[test]
fn faults_of_an_srdf_are_seen_by_all_commands() {
    let folder = tempfile::tempdir().unwrap();
    let broken = folder.path().join("broken.srdf");
    fs::write(&broken, "<robot><group></robot>").unwrap();
    let missing = folder.path().join("missing.srdf");
    let designs = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/designs.toml");
    let commands: [&[&str]; 12] = [
        &["info", "panda"],
        &["fk", "panda"],
        &["jacobian", "panda"],
        &["ik", "panda", "--to", "0.4,0,0.4"],
        &["move", "panda", "--to", "0.4,0,0.4"],
        &["mobility", "stewart"],
        &["manipulability", "stewart"],
        &["screws", "panda"],
        &["zone", "stewart", "--components", "x"],
        &["sweep", "panda", "--samples", "2"],
        &["sweep", designs, "--over", "crank=0.4:0.6:2"],
        &["map", "five-bar", "--over", "x=0:1:2", "--over", "y=0:1:2"],
    ];
    for file in [broken, missing] {
        let file = file.to_str().unwrap();
        let told = refused(&[commands[0], &["--srdf", file]].concat());
        for command in commands {
            let all = [command, &["--srdf", file]].concat();
            assert_eq!(refused(&all), told, "{command:?}");
        }
    }
    with_file(|file| {
        json(&["fk", "panda", "--srdf", file], 0);
    });
}

/// What an SRDF has and nobody reads is listed, with its line.
#[test]
fn info_lists_what_an_srdf_ignores() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("panda.srdf");
    fs::write(&file, TEXT.replace("</robot>", "<virtual_joint name=\"v\"/></robot>")).unwrap();
    let command = ["info", "panda", "--srdf", file.to_str().unwrap()];
    let ignored = json(&command, 0)["report"]["ignored_of_srdf"].clone();
    assert_eq!((&ignored[0]["line"], &ignored[0]["what"]), (&6.into(), &"<virtual_joint>".into()));
    assert!(crate::text(&command).contains("ignored of the SRDF"));
    with_file(|file| {
        let report = json(&["info", "panda", "--srdf", file], 0)["report"].clone();
        assert!(report.get("ignored_of_srdf").is_none());
    });
}
