//! Optimal designs: report and table, trade-offs, exit codes, what is refused.

use serde_json::Value;

use crate::{cylindroid, json, numbers, refused, text};

const DESIGNS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/designs.toml");
const CRANK: [&str; 6] =
    ["optimise", DESIGNS, "--vary", "crank=0.3:0.8", "--minimise", "anisotropy"];

/// The isotropic five-bar of `docs/designs.toml`, in JSON and in the table.
#[test]
fn the_best_design() {
    let report = json(&CRANK, 0);
    let half = 0.6 / 2.0_f64.sqrt();
    let best = &report["designs"][0];
    let crank = numbers(&best["values"])[0];
    assert!((crank - (half - 0.3).hypot(0.8 - half)).abs() < 1e-6, "{best}");
    assert!((numbers(&best["indices"])[0] - 1.0).abs() < 1e-6 && best["refined"] == true);
    assert_eq!(report["designs"].as_array().unwrap().len(), 1);
    let refinements = report["refinements"].as_array().unwrap();
    let evaluated = refinements.iter().map(|r| r["evaluated"].as_u64().unwrap()).sum::<u64>();
    assert_eq!(report["evaluated"].as_u64().unwrap(), 64 + evaluated);
    assert_eq!(report["objectives"][0]["statistic"], "largest");
    let table = text(&CRANK);
    assert!(table.contains("best design") && table.contains("0.395751"), "{table}");
    // Two threads change nothing but the time.
    let mut one = json(&[&CRANK[..], &["--threads", "1"]].concat(), 0);
    let mut two = json(&[&CRANK[..], &["--threads", "2"]].concat(), 0);
    (one["seconds"], two["seconds"]) = (Value::Null, Value::Null);
    assert_eq!(one, two);
}

#[test]
fn trade_offs_over_a_workspace() {
    let more = ["--maximise", "type_ii:mean", "--vary", "rod=0.5:0.9", "--designs", "32"];
    let workspace = ["--over", "point_x=-0.1:0.1:3", "--evaluations", "60", "--starts", "2"];
    let command = [&CRANK[..], &more, &workspace].concat();
    let report = json(&command, 0);
    let designs = report["designs"].as_array().unwrap();
    assert!(designs.len() > 2 && report["workspace"][0]["count"] == 3);
    for pair in designs.windows(2) {
        let [a, b] = [numbers(&pair[0]["indices"]), numbers(&pair[1]["indices"])];
        assert!(a[0] < b[0] && a[1] < b[1], "{pair:?}");
    }
    assert!(report["reason"].as_str().unwrap().contains("at point_x = "), "{report}");
    assert!(text(&command).contains("Pareto front"));
}

#[test]
fn no_design_is_a_negative_answer() {
    let none = ["optimise", DESIGNS, "--vary", "rod=0.05:0.06", "--minimise", "anisotropy"];
    assert_eq!(json(&none, 1)["invalid"], 64);
    let output = cylindroid(&none);
    assert_eq!(output.status.code(), Some(1));
    let printed = String::from_utf8(output.stdout).unwrap();
    assert!(printed.contains("No design has the indices."), "{printed}");
}

#[test]
fn wrong_objectives_are_refused() {
    let refused = |more: &[&str]| refused(&[&["optimise", DESIGNS], more].concat());
    let vary = ["--vary", "crank=0.3:0.8"];
    let with = |more: &[&'static str]| [&vary[..], more].concat();
    assert!(refused(&vary).contains("--minimise"));
    assert!(refused(&["--minimise", "anisotropy"]).contains("--vary"));
    let message = refused(&with(&["--minimise", "anisotropi"]));
    assert!(message.contains("no index named 'anisotropi'"), "{message}");
    let message = refused(&with(&["--minimise", "crank"]));
    assert!(message.contains("--minimise: no index named 'crank'"), "{message}");
    let message = refused(&with(&["--maximise", "volume:most"]));
    assert!(message.contains("no statistic named 'most'"), "{message}");
    let message = refused(&with(&["--minimise", "volume", "--over", "crank=0.3:0.4:2"]));
    assert!(message.contains("not both"), "{message}");
    let message = refused(&with(&["--minimise", "volume", "--designs", "0"]));
    assert!(message.contains("--designs = 0"), "{message}");
    let message = refused(&with(&["--minimise", "volume", "--over", "left_drive=0:1:3"]));
    assert!(message.contains("loops leave no free choice"), "{message}");
}

/// The last two links of an arm as seen from the first one are isotropic at a ratio of 1/sqrt(2)
/// (Salisbury & Craig 1982), wherever the first joint stands.
#[test]
fn a_design_as_seen_from_a_moving_frame() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("arm.toml");
    std::fs::write(&path, THREE_LINKS).unwrap();
    let vary = ["optimise", path.to_str().unwrap(), "--vary", "b=0.2:2", "--minimise", "condition"];
    let bent = ["--task", "x,y", "--q", "0.3,1,2.356194490192345"];
    let seen = [&vary[..], &bent, &["--relative-to", "upper"]].concat();
    let report = json(&seen, 0);
    assert_eq!(report["relative_to"], "upper");
    let best = &report["designs"][0];
    assert!((numbers(&best["values"])[0] - 0.5_f64.sqrt()).abs() < 1e-6, "{best}");
    assert!((numbers(&best["indices"])[0] - 1.0).abs() < 1e-6, "{best}");
    assert!(text(&seen).contains("relative to     upper"));
    let world = json(&[&vary[..], &bent].concat(), 0);
    assert!(world.get("relative_to").is_none());
    assert!((numbers(&world["designs"][0]["values"])[0] - 0.5_f64.sqrt()).abs() > 0.1, "{world}");
    let unknown = refused(&[&vary[..], &["--relative-to", "uper"]].concat());
    assert!(unknown.contains("upper"), "{unknown}");
}

pub(crate) const THREE_LINKS: &str = r#"
dimension = 2
reference = "hand"
reference_point = ["2 + b", 0]

[parameters]
b = 0.9

[[joint]]
name = "shoulder"
type = "revolute"
between = ["ground", "upper"]
origin = [0, 0]

[[joint]]
name = "elbow"
type = "revolute"
between = ["upper", "lower"]
origin = [1, 0]

[[joint]]
name = "wrist"
type = "revolute"
between = ["lower", "hand"]
origin = [2, 0]
"#;
