//! Capability maps of the command line, and pictures of sweeps.

use std::fs;

use serde_json::Value;

use crate::{json, refused, text};

fn column<'a>(report: &'a Value, name: &str) -> &'a Value {
    report["columns"].as_array().unwrap().iter().find(|c| c["name"] == name).unwrap()
}

const MAP: [&str; 8] =
    ["sweep", "ur5e", "--reach", "x=0.2:1.2:6", "--reach", "z=0:0.6:4", "--directions", "12"];

/// Statistics, CSV and folder have the same numbers; a picture has the cells that are reached.
#[test]
fn a_map_in_all_forms() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let more = ["--rolls", "4", "--quantities", "limit_distance"];
    let map = [&MAP[..], &more].concat();
    let report = json(&map, 0);
    assert_eq!(report["configurations"], "6 x 4 points, 12 directions x 4 rolls");
    assert_eq!(report["rows"], 24);
    let share = column(&report, "reachability");
    assert_eq!(share["smallest"], 0.0, "1.2 m are out of reach");
    let unreached = column(&report, "best_limit_distance")["not_finite"].as_u64().unwrap();
    assert!(unreached > 0 && unreached < 24);
    assert!(text(&map).contains("orientation_share"));

    let (csv, svg) = (at("map.csv"), at("map.svg"));
    json(&[&map[..], &["--out", &csv, "--plot", &svg]].concat(), 0);
    let lines = fs::read_to_string(&csv).unwrap();
    let mut lines = lines.lines();
    let names =
        "index,x,y,z,directions,orientations,reachability,orientation_share,best_limit_distance";
    assert_eq!(lines.next(), Some(names));
    let rows: Vec<Vec<f64>> =
        lines.map(|line| line.split(',').map(|x| x.parse().unwrap()).collect()).collect();
    assert_eq!(rows.len(), 24);
    let mean = rows.iter().map(|row| row[6]).sum::<f64>() / 24.0;
    assert!((mean - share["mean"].as_f64().unwrap()).abs() < 1e-15);
    let reached = rows.iter().filter(|row| row[4] > 0.0).count();
    assert_eq!(reached as u64, 24 - unreached);
    for row in &rows {
        assert_eq!(row[6], row[4] / 12.0);
        assert!((row[7] - row[5] / 48.0).abs() < 1e-15 && row[5] <= 4.0 * row[4]);
    }

    let parts = at("parts");
    let out = [&map[..], &["--out", &parts, "--part-rows", "5"]].concat();
    assert_eq!(json(&out, 0)["out"]["parts"], 5);
    let resumed = json(&[&out[..], &["--resume"]].concat(), 0);
    assert_eq!(resumed["out"]["computed"], 0);
    let other = [&MAP[..], &["--rolls", "5", "--quantities", "limit_distance"]].concat();
    let other = [&other[..], &["--out", &parts, "--part-rows", "5", "--resume"]].concat();
    let message = refused(&other);
    assert!(message.contains("configurations.rolls is 4 there and 5 now"), "{message}");
    let again = at("again.svg");
    json(&[&out[..], &["--resume", "--plot", &again]].concat(), 0);
    let picture = fs::read_to_string(&svg).unwrap();
    assert_eq!(picture, fs::read_to_string(&again).unwrap());
    assert!(picture.contains("reachability") && picture.contains("x [m]"), "{picture}");
    assert!(picture.contains("z [m]") && !picture.contains("y [m]"));
}

/// Another placement, positions alone, designs; what is refused.
#[test]
fn options_of_maps() {
    let arm = ["sweep", "3r", "--reach", "x=-0.75:0.75:5", "--reach", "y=0:0:1"];
    let report =
        json(&[&arm[..], &["--directions", "0", "--reach-from", "0,0,0.4,0,0,0"]].concat(), 0);
    assert_eq!(report["configurations"], "5 x 1 points, any orientation");
    // At the height of the shoulder, 0.8 m of links; the elbow does not fold to the shoulder itself.
    assert_eq!(column(&report, "reachability")["mean"], 0.8);
    let above = [&arm[..], &["--directions", "0", "--reach-from", "0,0,1.1,0,0,0"]].concat();
    let reached = column(&json(&above, 0), "reachability")["mean"].as_f64().unwrap();
    assert!((reached - 0.6).abs() < 1e-15, "not the outer ones: {reached}");
    let message = refused(&arm);
    assert!(message.contains("0 asks for positions alone"), "{message}");
    let message = refused(&[&MAP[..], &["--samples", "3"]].concat());
    assert!(message.contains("--samples"), "{message}");
    let message = refused(&[&MAP[..], &["--over", "elbow_joint=0:1:2"]].concat());
    assert!(message.contains("reach"), "{message}");
    let message = refused(&[&MAP[..], &["--quantities", "pose"]].concat());
    assert!(message.contains("best value of yoshikawa"), "{message}");
    let message = refused(&[&MAP[..6], &["--directions", "0", "--rolls", "4"]].concat());
    assert!(message.contains("--rolls are rotations about --directions"), "{message}");
    let message = refused(&["sweep", "ur5e", "--samples", "3", "--rolls", "3"]);
    assert!(message.contains("--reach"), "{message}");
}

fn drawn(arguments: &[&str]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("sweep.svg");
    json(&[&["sweep"], arguments, &["--plot", file.to_str().unwrap()]].concat(), 0);
    let svg = fs::read_to_string(&file).unwrap();
    assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    svg
}

fn count(svg: &str, start: &str) -> usize {
    svg.lines().filter(|line| line.starts_with(start)).count()
}

/// Samples with poses are points in three views, in one if all is in a plane.
#[test]
fn clouds() {
    let samples = ["panda", "--samples", "700", "--quantities", "pose,condition"];
    let svg = drawn(&samples);
    assert_eq!(count(&svg, "<circle"), 3 * 700);
    assert!(svg.contains("condition") && svg.contains("z [m]"));
    let other = drawn(&[&samples[..], &["--color", "z"]].concat());
    assert_eq!(count(&other, "<circle"), 3 * 700);
    assert!(other.contains("z [m]") && !other.contains("condition"));
    let many = drawn(&["youbot", "--samples", "1e5", "--quantities", "pose"]);
    assert_eq!(count(&many, "<circle"), 3 * 4000);
}

/// A grid of two coordinates is a slice with the line on which a signed value is zero.
#[test]
fn slices_of_grids() {
    let over = ["ur5e", "--over", "elbow_joint=-3.6:3.6:13", "--over", "wrist_1_joint=-1:1:3"];
    let svg = drawn(&[&over[..], &["--quantities", "limit_distance"]].concat());
    assert!(svg.contains("elbow_joint [rad]") && svg.contains("limit_distance"), "{svg}");
    // Beyond pi on both sides: from the first to the last row of cells.
    let lines: Vec<&str> =
        svg.lines().filter(|l| l.starts_with("<polyline") && l.contains("#000000")).collect();
    let is_upright = |line: &&&str| {
        let points = line.split_once("points=\"").unwrap().1.split_once('"').unwrap().0;
        let xs: Vec<&str> =
            points.split_whitespace().map(|p| p.split_once(',').unwrap().0).collect();
        xs.len() == 2 && xs[0] == xs[1]
    };
    assert!(lines.iter().filter(is_upright).count() >= 4, "{lines:?}");
    let three =
        [&over[..], &["--over", "wrist_2_joint=0:1:2", "--quantities", "condition"]].concat();
    let svg = drawn(&three);
    assert!(svg.contains("wrist_2_joint = 0 rad") && svg.contains("wrist_2_joint = 1 rad"));
    let message = refused(&[&["sweep"], &three[..], &["--plot", "a.svg", "--color", "x"]].concat());
    assert!(message.contains("no column named 'x'"), "{message}");
    let message = refused(&[&["sweep"], &three[..], &["--plot", "a.png"]].concat());
    assert!(message.contains(".svg"), "{message}");
    let large =
        ["sweep", "ur5e", "--over", "elbow_joint=-1:1:1000", "--over", "wrist_1_joint=0:1:999"];
    let large = [&large[..], &["--quantities", "condition", "--plot", "a.svg"]].concat();
    assert!(refused(&large).contains("250 000"));
}

/// Rows without positions are histograms: as many bars as bins with rows.
#[test]
fn histograms() {
    let samples = ["panda", "--samples", "400", "--quantities", "yoshikawa,limit_distance"];
    let svg = drawn(&samples);
    assert!(svg.contains("limit_distance") && svg.contains("rows"), "{svg}");
    let bars = count(&svg, "<rect");
    let one = drawn(&[&samples[..], &["--color", "yoshikawa"]].concat());
    assert!(one.contains("yoshikawa") && !one.contains("limit_distance"));
    // 20 bins of each at most, and the background.
    let alone = count(&one, "<rect");
    assert!((10..=21).contains(&alone) && bars > alone + 9 && bars <= 41, "{alone} {bars}");
    let both = drawn(&["panda", "--samples", "400", "--quantities", "singular_values"]);
    assert!(both.contains("singular_value_1") && both.contains("singular_value_6"));
}
