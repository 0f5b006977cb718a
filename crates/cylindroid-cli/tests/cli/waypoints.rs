//! Files of `move --waypoints`, and options of `move` that a motion would not use.

use std::fs;

use crate::{json, numbers, refused};

/// The error of a file, which it names.
fn refused_file(text: &str, more: &[&str]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("way.csv");
    fs::write(&file, text).unwrap();
    let command = ["move", "panda", "--waypoints", file.to_str().unwrap()];
    let error = refused(&[&command[..], more].concat());
    assert!(
        error.contains("way.csv") || error.contains("--speed has no effect"),
        "{text}: {error}"
    );
    error
}

/// The report of a motion that reaches the last row.
fn reached(text: &str, more: &[&str]) -> serde_json::Value {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("way.csv");
    fs::write(&file, text).unwrap();
    let command = ["move", "panda", "--waypoints", file.to_str().unwrap()];
    let report = json(&[&command[..], more].concat(), 0);
    assert_eq!(report["reached"], true, "{text}");
    report
}

fn duration(report: &serde_json::Value) -> f64 {
    report["law_duration"].as_f64().unwrap()
}

#[test]
fn bad_rows_are_named_with_their_column() {
    for (text, expected) in [
        ("0.4,0.1,O.5\n0.4,-0.1,0.5", "line 1, column 3: 'O.5' is not a number; a first line of"),
        ("0.4,0.1,abc", "line 1, column 3: 'abc'"),
        ("0.4,0.1,0.5\n0.4,-O.1,0.5", "line 2, column 2: '-O.1' is not a number"),
        ("x,y,z\n0.4,0.1,0.5\n0.4,0.1,5z", "line 3, column 3: '5z' is not a number"),
        ("# mm\n\n0.4,0.1,0.5\n0.4,0.1,nan", "line 4, column 3 (z): NaN is not finite"),
        ("z,x,y\n0.5,inf,0.1", "line 2, column 2 (x): inf is not finite"),
        ("0.4,0.1,0.5,1,0,0,0\n0.4,0.1,0.5,0,0,0,0", "line 2: quaternion = (0, 0, 0, 0)"),
        ("3,0.4,0.1,0.5\n1,0.4,-0.1,0.5", "line 2: the time 1 s must be after that of the row"),
        ("y,time,x,z\n0,-1,0.4,0.5", "line 2: the time -1 s must be after that of the start, 0 s"),
        ("0.4,0.1,0.5\n0.4,0.1", "line 2 has 2 numbers; rows have 3"),
        ("t,x,y,z\n1,0.4,0.1", "line 2 has 3 numbers; the header names 4 (t,x,y,z)"),
        ("0.4,0.1,0.5,1,0,0", "line 1 has 6 numbers; rows have 3"),
        ("0.4;0.1;0.5\n0.4;0.1;0.5", "line 2, column 1: '0.4;0.1;0.5' is not a number"),
        ("x,y,z\n", "no rows"),
        ("x,y,z,speed\n0.4,0.1,0.5,0.1\n0.4,0,0.5,0", "line 3, column 4 (speed): 0 m/s must be"),
        ("speed,x,y,z\n-0.2,0.4,0.1,0.5", "line 2, column 1 (speed): -0.2 m/s must be positive"),
        ("x,y,z,speed\n0.4,0.1,0.5,inf", "line 2, column 4 (speed): inf is not finite"),
        ("x,y,z,speed\n0.4,0.1,0.5", "line 2 has 3 numbers; the header names 4 (x,y,z,speed)"),
        ("0.001,0.4,0.1,0.5", "times of the waypoints 0 s to 0.001 s: it is too short"),
    ] {
        let error = refused_file(text, &[]);
        assert!(error.contains(expected), "'{expected}' not in: {error}");
    }
}

#[test]
fn headers_are_obeyed_or_refused() {
    let plain = reached("0.4,0.1,0.5\n0.4,-0.1,0.5", &[]);
    let place = |report: &serde_json::Value| numbers(&report["target"]["position"]);
    for text in ["z,y,x\n0.5,0.1,0.4\n0.5,-0.1,0.4", "\u{feff}Y,X,Z\n0.1,0.4,0.5\n-0.1,0.4,0.5"] {
        let named = reached(text, &[]);
        assert_eq!((place(&named), &named["q"]), (place(&plain), &plain["q"]), "{text}");
    }
    let timed = reached("x,y,z,t\n0.4,0.1,0.5,1\n0.4,-0.1,0.5,3", &[]);
    assert!((duration(&timed) - 3.0).abs() < 1e-9);
    // Half a turn about x, as a quaternion, in radians and in degrees.
    let turned = reached("0.4,0.1,0.5,0,1,0,0", &[]);
    for (text, more) in [
        ("qw,qx,qy,qz,x,y,z\n0,1,0,0,0.4,0.1,0.5", &[][..]),
        ("yaw,roll,pitch,x,y,z\n0,3.141592653589793,0,0.4,0.1,0.5", &[]),
        ("x,y,z,roll,pitch,yaw\n0.4,0.1,0.5,180,0,0", &["--degrees"]),
    ] {
        let named = reached(text, more);
        assert_eq!(named["task"].as_array().unwrap().len(), 6);
        let (a, b) = (numbers(&named["q"]), numbers(&turned["q"]));
        assert!(crate::difference(&a, &b) < 1e-5, "{text}: {a:?} {b:?}");
    }
    for (header, expected) in [
        ("x,y,z,speeds", "header, column 4: 'speeds' is none of time, x, y, z, qw,"),
        ("x,y,z,speeds", "'speed' is that on the way to a row"),
        ("t,x,y,z,speed", "header: give time or speed, not both"),
        ("x,y,z,speed,Speed", "header, column 5: 'speed' is given twice"),
        ("x,y,,z", "header, column 3: '' is none of"),
        ("x,y,z,X", "header, column 4: 'x' is given twice"),
        ("x,z,time,qw", "header: y is missing beside others of x, y, z"),
        ("x,y,z,qw", "header: qx is missing beside others of qw, qx, qy, qz"),
        ("t,roll,pitch,yaw", "header: x, y and z are missing"),
        ("x,y,z,qw,qx,qy,qz,roll,pitch,yaw", "not both"),
    ] {
        let error = refused_file(&format!("{header}\n1,2,3,4\n"), &[]);
        assert!(error.contains(expected), "'{expected}' not in: {error}");
    }
}

#[test]
fn speeds_of_waypoints() {
    let rows = "0.3,0.2,0.5\n0.3,-0.2,0.5";
    let fast = duration(&reached(rows, &["--speed", "inf"]));
    let bounded = duration(&reached(rows, &["--speed", "1e300,1e300"]));
    assert!((fast / bounded - 1.0).abs() < 0.3 && fast > 0.5, "{fast} {bounded}");
    let error = refused_file("1,0.3,0.2,0.5\n2,0.3,-0.2,0.5", &["--speed", "0.05"]);
    assert!(error.contains("--speed has no effect on --waypoints with times"), "{error}");
}

/// The speed of a row is that on the way to it; --speed bounds all if it is given.
#[test]
fn rows_have_speeds() {
    let rows = |first: &str, second: &str| {
        format!("x,y,z,speed\n0.3,0.2,0.5,{first}\n0.3,-0.2,0.5,{second}")
    };
    // 0.4 m at 0.05 instead of 0.4 m/s takes 7 s longer, give or take the ramps.
    let fast = duration(&reached(&rows("0.4", "0.4"), &[]));
    let slow = duration(&reached(&rows("0.4", "0.05"), &[]));
    assert!((slow - fast - 7.0).abs() < 0.5, "{fast} {slow}");
    let capped = duration(&reached(&rows("0.4", "0.4"), &["--speed", "0.1"]));
    let same = duration(&reached("0.3,0.2,0.5\n0.3,-0.2,0.5", &["--speed", "0.1"]));
    assert!((capped - same).abs() < 1e-9, "{capped} {same}");
}

/// No motion uses them: each names what it needs.
#[test]
fn options_without_an_effect_are_refused() {
    let to = ["move", "panda", "--to", "0.45,0.15,0.35"];
    let joints = ["move", "panda", "--joint-to", "panda_joint1=0.5"];
    let twist = ["move", "panda", "--twist", "0,0,-0.1,0,0,0"];
    let tasks = ["move", "panda", "--task", "hand_tcp=0.45,0.15,0.35"];
    for (command, option, expected) in [
        (to, &["--duration", "3"][..], "--duration has no effect without --twist"),
        (joints, &["--duration", "3"], "--duration"),
        (to, &["--law", "jerk-limited"], "--law has no effect without --line, --via or --joint-to"),
        (to, &["--acceleration-linear", "1"], "--acceleration-linear has no effect without --line"),
        (twist, &["--acceleration-angular", "1"], "--acceleration-angular has no effect without"),
        (tasks, &["--acceleration-linear", "1"], "--acceleration-linear belongs to the servo of"),
        (joints, &["--speed", "0.1"], "--speed has no effect on --joint-to"),
        (joints, &["--delay", "0.5"], "--delay has no effect on --joint-to"),
        (joints, &["--time-constant", "0.5"], "--time-constant has no effect on --joint-to"),
        (joints, &["--noise", "0.01"], "--noise has no effect on --joint-to"),
        (joints, &["--gain", "3"], "--gain has no effect on --joint-to"),
        (joints, &["--secondary", "none"], "--secondary has no effect on --joint-to"),
        (joints, &["--inverse", "damped"], "--inverse has no effect on --joint-to"),
        (joints, &["--tolerance-position", "1e-3"], "--tolerance-position has no effect on"),
    ] {
        let error = refused(&[&command[..], option].concat());
        assert!(error.contains(expected), "'{expected}' not in: {error}");
    }
    json(&[&joints[..], &["--delay", "0", "--acceleration-angular", "2"]].concat(), 0);
}

/// A robot with noise reaches what the servo reaches with it, before and after a reconfiguration.
#[test]
fn a_reconfiguration_ends_with_the_same_plant() {
    let noisy = ["move", "panda", "--to", "0.45,0.15,0.35", "--noise", "1e-4"];
    let report = json(&noisy, 1);
    assert_eq!((&report["reached"], &report["reason"]), (&false.into(), &"slow".into()));
    assert!(report["position_error"].as_f64().unwrap() > 1e-6, "{report}");
    let why = report["explanation"].as_str().unwrap();
    assert!(why.contains("--noise") && why.contains("--tolerance-position"), "{why}");
    json(&[&noisy[..], &["--tolerance-position", "1e-3"]].concat(), 0);

    let round = ["move", "puma560", "--to", "-0.5,0.2,0.3"];
    let late = ["--delay", "0.02", "--time-constant", "0.06"];
    let report = json(&[&round[..], &late].concat(), 0);
    assert_eq!(report["reconfigured"], true);
    let why = report["explanation"].as_str().unwrap();
    assert!(why.contains("is that of an ideal robot"), "{why}");
    let ideal = json(&round, 0);
    assert!(!ideal["explanation"].as_str().unwrap().contains("ideal robot"));
    assert!(report["time"].as_f64() > ideal["time"].as_f64());
}
