//! `distance`: obstacles, SRDF, exit codes, bad input.

use std::fs;

use crate::{json, numbers, refused, text};

pub(crate) const CELL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/cell.toml");

#[test]
fn obstacles_and_gradients() {
    let ball = "ball=sphere:0.1@0.5,0,0.4";
    let free = json(&["distance", CELL, "--obstacle", ball, "--margin", "inf"], 0);
    assert_eq!((&free["shapes"], &free["free"]), (&6.into(), &true.into()));
    let near = free["near"].as_array().unwrap();
    assert_eq!(near.len(), free["pairs"].as_u64().unwrap() as usize);
    let first = near.iter().find(|n| n["b"] == "ball" && n["a"] == "flange").unwrap();
    assert_eq!(first["shape_a"], "hand");
    assert_eq!(numbers(&first["gradient"]).len(), 7);
    let distances: Vec<f64> = near.iter().map(|n| n["distance"].as_f64().unwrap()).collect();
    assert!(distances.is_sorted());
    let [a, b, n] = ["point_a", "point_b", "normal"].map(|key| numbers(&first[key]));
    for i in 0..3 {
        let gap = b[i] - a[i] - first["distance"].as_f64().unwrap() * n[i];
        assert!(gap.abs() < 1e-12);
    }
    // Into the hand.
    let hit = json(&["distance", CELL, "--obstacle", "ball=sphere:0.1@0.3,0,0.55"], 1);
    assert_eq!(hit["free"], false);
    assert!(hit["near"][0]["distance"].as_f64().unwrap() < 0.0);
    let table = text(&["distance", CELL, "--obstacle", ball, "--margin", "0.5"]);
    assert!(table.contains("flange") && table.contains("collision-free"), "{table}");
    assert!(text(&["distance", "panda"]).contains("no link has a collision shape"));
}

#[test]
fn an_srdf_disables_pairs() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("cell.srdf");
    let pair = |a: &str, b: &str| format!("<disable_collisions link1=\"{a}\" link2=\"{b}\"/>");
    let all = pair("ground", "flange") + &pair("link1", "flange") + &pair("link1", "hand");
    fs::write(&file, format!("<robot name=\"cell\">{all}</robot>")).unwrap();
    let keep = ["distance", CELL, "--margin", "inf", "--samples", "0"];
    let without = json(&keep, 0);
    let with = json(&[&keep[..], &["--srdf", file.to_str().unwrap()]].concat(), 0);
    let count = |value: &serde_json::Value| value["pairs"].as_u64().unwrap();
    assert_eq!(count(&without) - count(&with), 2);
    assert!(with["ignored"][0]["why"].as_str().unwrap().contains("hand"), "{with}");
    fs::write(&file, "<robot><disable_collisions link1=\"a\"/></robot>").unwrap();
    let error = refused(&["distance", CELL, "--srdf", file.to_str().unwrap()]);
    assert!(error.contains("link2"), "{error}");
}

#[test]
fn obstacles_without_sense_are_refused() {
    for (obstacle, word) in [
        ("ball", "NAME=SHAPE"),
        ("ball=round:1@0,0,0", "sphere:RADIUS"),
        ("ball=sphere:-1@0,0,0", "negative"),
        ("ball=mesh:none.stl@0,0,0", "none.stl"),
    ] {
        let error = refused(&["distance", CELL, "--obstacle", obstacle]);
        assert!(error.contains(word), "{error}");
    }
    let ball = "ball=sphere:1@0,0,9";
    let error = refused(&["distance", CELL, "--obstacle", ball, "--obstacle", ball]);
    assert!(error.contains("one of this name"), "{error}");
}
