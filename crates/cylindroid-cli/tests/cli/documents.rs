//! The documents against the binary: examples run as they stand, and JSON has the keys it promises.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

use crate::closed::robots;
use crate::distance::CELL;
use crate::sweep::TWO_ARMS;
use crate::text;

pub(crate) const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
const GRASP: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/grasp.toml");
const GOALS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/goals.toml");
const DESIGNS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/designs.toml");
const TASKS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/tasks.toml");

/// All commands, as the help lists them.
pub(crate) fn commands() -> Vec<String> {
    let help = text(&["--help"]);
    let list = help.split("\nCommands:\n").nth(1).and_then(|rest| rest.split("\n\n").next());
    let entries = list.unwrap().lines().filter_map(|line| line.strip_prefix("  "));
    let names =
        entries.filter(|entry| !entry.starts_with(' ')).map(|entry| entry.split(' ').next());
    names.flatten().filter(|name| *name != "help").map(str::to_owned).collect()
}

fn document(name: &str) -> String {
    fs::read_to_string(Path::new(ROOT).join(name)).unwrap()
}

/// What a reader would type: lines and code of a text that begin with the binary or its `cargo
/// run`, without their descriptions.
pub(crate) fn examples(document: &str, commands: &[String]) -> Vec<String> {
    let lines = document.lines().chain(document.split('`'));
    let typed = lines.filter_map(|line| {
        let line = line.trim();
        let command = line
            .strip_prefix("cylindroid ")
            .or_else(|| line.strip_prefix("cargo run --release -- "))?;
        let is_command = commands.iter().any(|name| command.split(' ').next() == Some(name));
        let alone = is_command && !command.contains('\n');
        alone.then(|| command.split("  ").next().unwrap_or(command).to_owned())
    });
    typed.collect::<BTreeSet<_>>().into_iter().collect()
}

/// Of the README, and of every help text.
#[test]
fn examples_run_as_they_stand() {
    let folder = tempfile::tempdir().unwrap();
    let docs = folder.path().join("docs");
    fs::create_dir(&docs).unwrap();
    fs::copy(GRASP, docs.join("grasp.toml")).unwrap();
    fs::copy(CELL, docs.join("cell.toml")).unwrap();
    fs::copy(TASKS, docs.join("tasks.toml")).unwrap();
    fs::copy(GOALS, docs.join("goals.toml")).unwrap();
    fs::copy(DESIGNS, docs.join("designs.toml")).unwrap();
    fs::copy(TWO_ARMS, docs.join("two-arms.toml")).unwrap();
    fs::write(folder.path().join("axes.csv"), "0,0,0,0,0,1\n0,0,-0.2,1,0,0\n").unwrap();
    let home = ["0"; 21].join(",");
    fs::write(folder.path().join("configurations.csv"), format!("{home}\n{home}\n")).unwrap();
    fs::write(folder.path().join("poses.csv"), "x,y,z,qw,qx,qy,qz\n0.4,0,0.4,0,1,0,0\n").unwrap();
    let urdf = robots().join("ur_description/urdf/ur5_robot.urdf");
    let mut pages = vec![document("README.md"), text(&["--help"])];
    let commands = commands();
    pages.extend(commands.iter().map(|command| text(&[command, "--help"])));
    let found: Vec<Vec<String>> = pages.iter().map(|page| examples(page, &commands)).collect();
    let counts: Vec<usize> = found.iter().map(Vec::len).collect();
    // The first four commands speak for themselves.
    let all = counts[6..].iter().all(|n| *n > 1);
    assert!(commands.len() > 11 && counts[0] > 8 && counts[1] > 3 && all, "{counts:?}");
    for example in found.iter().flatten() {
        let mut words = example.replace("path/to/ur5_robot.urdf", &urdf.to_string_lossy());
        // It serves until it is stopped; --check stops it when it could.
        if words.starts_with("view ") && !words.contains("--check") {
            words.push_str(" --check");
        }
        let output = Command::new(env!("CARGO_BIN_EXE_cylindroid"))
            .args(words.split(' '))
            .current_dir(folder.path())
            .output()
            .unwrap();
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{example}: {stderr}");
    }
}

/// Words that are set as code.
fn coded(text: &str) -> BTreeSet<&str> {
    let code = text.split('`').skip(1).step_by(2);
    let words = code.flat_map(|c| c.split(|x: char| !x.is_alphanumeric() && x != '_'));
    words.filter(|word| !word.is_empty()).collect()
}

/// All keys of an object and of what is in it.
pub(crate) fn keys<'a>(value: &'a Value, found: &mut BTreeSet<&'a str>) {
    match value {
        Value::Object(map) => {
            found.extend(map.keys().map(String::as_str));
            map.values().for_each(|v| keys(v, found));
        }
        Value::Array(list) => list.iter().for_each(|v| keys(v, found)),
        _ => {}
    }
}

/// Commands that print every key that there is.
fn printing(command: &str) -> Vec<Vec<&'static str>> {
    const UP: [&str; 4] = ["--to", "0.45,0.15,0.35", "--rpy", "3.1416,0,0.6"];
    const SLIDING: &str = "../cylindroid/tests/data/mechanisms/stewart-turned.toml";
    const PARAMETERS: &str = "../cylindroid/tests/data/five_bar_parameters.toml";
    let with = |first: &[&'static str], more: &[&'static str]| [first, more].concat();
    let all = match command {
        "info" => vec![vec!["panda"], vec!["two-arm"], vec!["stewart"], vec![PARAMETERS]],
        "fk" => vec![vec!["panda"], vec!["panda", "--all"]],
        "jacobian" => vec![
            vec!["ur5e", "--velocities", "shoulder_pan_joint=0.1"],
            vec!["ur5e", "--analytical", "zyz"],
            vec!["panda", "--relative-to", "link4"],
            vec!["youbot", "--twist", "x", "--eps", "1e-6"],
        ],
        "ik" => vec![
            with(&["panda"], &UP),
            vec!["panda", "--to", "2,0,0.5"],
            vec![CELL, "--task", "hand_tcp=0.4,0,0.4", "--task", "link4=0,0.1,0.65", "--avoid"],
            vec!["panda", "--tasks", GOALS],
            with(&["panda", "--maximise", "manipulability"], &UP),
        ],
        "move" => vec![
            with(&["panda", "--line"], &UP),
            vec!["ur5e", "--twist", "0,0,0.1,0,0,0"],
            vec!["puma560", "--to", "-0.5,0.2,0.3"],
            vec!["puma560", "--to", "-0.5,0.2,0.3", "--no-reconfigure"],
            vec!["five-bar", "--to", "1.2,1.8,0"],
            vec![CELL, "--to", "0.3,0,0.4", "--avoid"],
            vec![
                "youbot",
                "--q",
                "0.4,0.6,0.9,1.641592653589793,0.2",
                "--to",
                "0.2350376,0.0993723,0.04",
                "--task",
                "pose",
                "--inverse",
                "hyperbolic",
                "--h",
                "0.1",
                "--fallback",
                "truncated",
            ],
        ],
        "screws" => {
            vec![
                vec!["youbot", "--h", "0.1", "--point", "0.4,0.2,0.2", "--direction", "0,0,1"],
                vec!["youbot", "--h", "0.1", "--twist", "0,0,1,0,1,0"],
                vec!["delta"],
            ]
        }
        "distance" => vec![vec![CELL, "--margin", "0.5"]],
        "assemble" => vec![
            vec!["five-bar"],
            vec!["five-bar", "--modes", "2"],
            vec!["five-bar", "--to", "q1=1", "--hold", "q1"],
        ],
        "mobility" => {
            vec![vec!["stewart"], vec![SLIDING], vec!["five-bar", "--modes", "2"]]
        }
        "manipulability" => vec![
            vec!["five-bar", "--polytope", "--gradient", "volume"],
            vec!["five-bar", "--configurations", "tests/data/five-bar.csv"],
            vec!["five-bar", "--plot", concat!(env!("CARGO_TARGET_TMPDIR"), "/documents.svg")],
        ],
        "statics" => vec![
            vec![GRASP, "--wrench", "0,0,-9,0,0,0"],
            vec!["five-bar", "--actuated", "q1,q2,q3,q4,q5", "--wrench", "3,-1,0.2"],
        ],
        "view" => vec![vec!["panda", "--check"]],
        "sweep" => {
            const FILE: &str = concat!(env!("CARGO_TARGET_TMPDIR"), "/documents.csv");
            let some = ["youbot", "--samples", "50"];
            vec![
                with(&some, &["--quantities", "pose,gibson_hunt"]),
                with(&some, &["--out", FILE]),
                vec!["panda", "--samples", "9", "--relative-to", "link4"],
            ]
        }
        "optimise" => {
            let vary = ["--vary", "crank=0.3:0.8", "--minimise", "anisotropy", "--designs", "9"];
            let workspace = ["--over", "point_x=0:0.1:2", "--starts", "1", "--evaluations", "20"];
            const ARM: &str = concat!(env!("CARGO_TARGET_TMPDIR"), "/three-links.toml");
            std::fs::write(ARM, crate::optimise::THREE_LINKS).unwrap();
            let of_arm = ["--vary", "b=0.2:2", "--minimise", "condition", "--relative-to", "upper"];
            let short = ["--designs", "3", "--starts", "1", "--evaluations", "20"];
            vec![
                with(&[DESIGNS], &[vary, workspace].concat()),
                [&[ARM], &of_arm[..], &short].concat(),
            ]
        }
        // A limit that ends a mode has a key of its own.
        "map" => vec![
            vec!["five-bar", "--over", "x=0:2:5", "--over", "y=0.5:2.5:5"],
            vec!["stewart", "--over", "x=-1:1:9", "--over", "y=-1:1:9"],
        ],
        // One with a limit, and one with a component that is held.
        "zone" => vec![
            vec!["five-bar", "--components", "x,y", "--rays", "4"],
            vec!["stewart", "--components", "x,y", "--rays", "2"],
        ],
        "grasp" => vec![vec![GRASP, "--torsion", "0.01"]],
        "completions" => vec![vec!["bash"]],
        "man" => vec![vec![concat!(env!("CARGO_TARGET_TMPDIR"), "/man1")]],
        _ => vec![vec![]],
    };
    all.into_iter().map(|more| with(&[], &more)).collect()
}

/// Every key that is printed is in the command's section (what is inside of others: somewhere on
/// the page), and every key of its tables is printed.
#[test]
fn json_has_the_keys_of_its_page() {
    let page = document("docs/json.md");
    let sections: Vec<&str> = page.split("\n## ").collect();
    let anywhere = coded(&page);
    for command in &commands() {
        let section = sections.iter().find(|s| s.lines().next() == Some(command.as_str()));
        let section = section.unwrap_or_else(|| panic!("no section on {command}"));
        let named = coded(section);
        let rows = section.lines().filter(|l| l.starts_with("| `"));
        let promised: BTreeSet<&str> =
            rows.flat_map(|row| coded(row.split('|').nth(1).unwrap_or_default())).collect();
        let mut printed = BTreeSet::new();
        for arguments in printing(command) {
            let output =
                crate::cylindroid(&[&[command.as_str()][..], &arguments, &["--json"]].concat());
            let value: Value = serde_json::from_slice(&output.stdout).unwrap();
            let mut inner = BTreeSet::new();
            keys(&value, &mut inner);
            let unnamed: Vec<_> = inner.difference(&anywhere).collect();
            assert!(unnamed.is_empty(), "{command} {arguments:?} prints {unnamed:?}: not named");
            printed.extend(value.as_object().unwrap().keys().cloned());
        }
        let unnamed: Vec<_> = printed.iter().filter(|key| !named.contains(key.as_str())).collect();
        assert!(unnamed.is_empty(), "{command} prints {unnamed:?}: not named in its section");
        let missing: Vec<_> = promised.iter().filter(|key| !printed.contains(**key)).collect();
        assert!(missing.is_empty(), "{command} does not print {missing:?}: promised");
    }
}
