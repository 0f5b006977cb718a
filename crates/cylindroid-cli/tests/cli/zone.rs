//! `zone`: numbers, tables, bad input.

use crate::{json, refused, text};

#[test]
fn zones_in_tables_and_json() {
    let zone = ["zone", "3r", "--components", "joint2,joint3", "--rays", "32", "--no-limits"];
    let report = json(&zone, 0);
    // The elbow is one radian from straight.
    assert!((report["size"].as_f64().unwrap() - 1.0).abs() < 1e-9);
    assert_eq!(report["shape"], "ball");
    assert_eq!(report["bounds"][0]["kind"], "type I");
    assert_eq!(report["bounds"][0]["distance"], report["size"]);
    assert_eq!(report["components"][0]["unit"], "rad");
    assert!(report["certified"].as_u64().unwrap() > 16);
    let table = text(&zone);
    assert!(table.contains("radius along") && table.contains("joint3 1 rad"), "{table}");
    let narrow = ["--shape", "box", "--scales", "0.5,0.5"];
    let boxed = json(&[&zone[..], &narrow].concat(), 0);
    assert!(boxed["size"].as_f64().unwrap() <= 2.0 + 1e-9);
    let limited = json(&["zone", "stewart", "--components", "x,y", "--rays", "2"], 0);
    assert_eq!(limited["bounds"][0]["kind"], "limit");
    assert_eq!(limited["held"][0]["name"], "z");
}

/// Of one component there are two ways, however many rays are asked for.
#[test]
fn one_component_has_two_rays() {
    for rays in ["0", "1000000"] {
        let zone = ["zone", "3r", "--components", "joint3", "--rays", rays, "--no-limits"];
        let report = json(&zone, 0);
        for count in ["confirmed", "certified"] {
            assert!(report[count].as_u64().unwrap() <= 2, "{report}");
        }
        assert!((report["size"].as_f64().unwrap() - 1.0).abs() < 1e-9, "{report}");
    }
}

#[test]
fn zones_that_do_not_exist() {
    let message = refused(&["zone", "five-bar", "--components", "x,w"]);
    assert!(message.contains("'w'") && message.contains("--components"), "{message}");
    // The joint that closes the loop has no coordinate.
    let of_drives = ["zone", "five-bar", "--actuated", "q1,q5", "--components", "q1,q5"];
    let message = refused(&of_drives);
    assert!(message.contains("--components") && !message.contains("--actuated"), "{message}");
    let message =
        refused(&["zone", "five-bar", "--components", "x", "--free", "y", "--free", "rz"]);
    assert!(message.contains("motions of the mechanism free"), "{message}");
    let message = refused(&["zone", "five-bar", "--components", "x,y", "--scales", "1"]);
    assert!(message.contains("--scales"), "{message}");
    let message = refused(&["zone", "five-bar", "--components", "x,y", "--at", "x=20"]);
    assert!(message.contains("no configuration"), "{message}");
}
