//! `move`: the largest speed of the tool, and the jerk of joints.

use crate::{cylindroid, json};

/// A path keeps --speed where the tool falls behind at a singularity and catches up: its speed was 1.27 m/s.
#[test]
fn a_path_keeps_the_speed_of_the_tool() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("path.csv");
    let out = path.to_str().unwrap();
    for (command, speed) in [
        (&["move", "puma560", "--to=-0.5,0.2,0.3", "--line", "--speed", "0.05"][..], 0.05),
        (&["move", "ur5e", "--to", "0.4,0.2,0.5", "--line"], 0.25),
        (&["move", "panda", "--to", "0.4,-0.3,0.4", "--via", "0.5,0,0.6", "--speed", "0.1"], 0.1),
    ] {
        cylindroid(&[command, &["--out", out]].concat());
        let mut reader = csv::Reader::from_path(&path).unwrap();
        let header = reader.headers().unwrap().clone();
        let place = |name: &str| header.iter().position(|column| column == name).unwrap();
        let places = ["time", "x", "y", "z"].map(place);
        let rows: Vec<[f64; 4]> = reader
            .records()
            .map(|row| places.map(|i| row.as_ref().unwrap()[i].parse().unwrap()))
            .collect();
        let most = rows
            .windows(2)
            .map(|pair| {
                let [dt, x, y, z] = std::array::from_fn(|i| pair[1][i] - pair[0][i]);
                x.hypot(y).hypot(z) / dt
            })
            .fold(0.0, f64::max);
        assert!(most <= 1.01 * speed, "{command:?} {most}");
    }
}

/// --jerk bounds joints on straight motions as well: it took 1.47 s.
#[test]
fn straight_motions_of_joints_keep_the_jerk() {
    let joints = ["move", "ur5e", "--joint-to=0.1,-0.5,0.2,-2,0.3,1.7"];
    let time = |more: &[&str]| json(&[&joints[..], more].concat(), 0)["time"].as_f64().unwrap();
    let free = time(&[]);
    let smooth = time(&["--jerk", "1"]);
    // Of rest-to-rest motions within a jerk alone, the largest displacement s takes (32 s / J)^(1/3).
    assert!(free < 2.0 && smooth > 3.0, "{free} {smooth}");
    assert!((time(&["--jerk", "0.125"]) / smooth - 2.0).abs() < 1e-3);
    assert_eq!(time(&["--jerk", "1", "--law", "jerk-limited"]), smooth);
}
