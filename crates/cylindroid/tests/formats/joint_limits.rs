//! Limits in place of those of the model, by name and from files.

use std::path::Path;

use cylindroid::model::formats::toml::{with_limits_of_file, with_limits_of_text};
use cylindroid::model::{JointKind, JointLimits, JointSpec, Limits, Mimic};
use cylindroid::{Mechanism, Result};

fn arm() -> Mechanism {
    let mut b = Mechanism::builder("arm");
    let limits = Limits { lower: -2.0, upper: 2.0, ..Limits::NONE };
    b.joint(JointSpec { limits, ..JointSpec::new("shoulder", JointKind::Revolute, "base", "a") });
    b.joint(JointSpec::new(
        "wrist",
        JointKind::Universal { second: cylindroid::Vec3::X },
        "a",
        "b",
    ));
    b.joint(JointSpec {
        mimic: Some(Mimic { joint: "shoulder".into(), multiplier: 2.0, offset: 0.0 }),
        limits: Limits { velocity: 3.0, ..Limits::NONE },
        ..JointSpec::new("follower", JointKind::Revolute, "b", "c")
    });
    b.joint(JointSpec::new("flange", JointKind::Fixed, "c", "d"));
    b.build().unwrap()
}

fn read(text: &str) -> Result<Mechanism> {
    with_limits_of_text(&arm(), text, Path::new("limits.toml"))
}

#[test]
fn limits_replace_those_of_the_model() {
    let text = "
        [shoulder]
        lower = 0.5
        velocity = 9
        acceleration = 10.0
        [wrist]
        acceleration = 20
    ";
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("limits.toml");
    std::fs::write(&path, text).unwrap();
    let m = with_limits_of_file(&arm(), &path).unwrap();
    let of = |name: &str| m.limits_of(name).unwrap();
    // The follower moves twice as fast, and may do 3 rad/s.
    let shoulder = Limits { lower: 0.5, upper: 2.0, velocity: 1.5, ..Limits::NONE };
    assert_eq!(of("shoulder"), Limits { acceleration: 10.0, ..shoulder });
    for c in &m.coordinates()[1..] {
        assert_eq!(c.limits, Limits { acceleration: 20.0, ..Limits::NONE });
    }
    assert_eq!((m.home()[0], arm().home()[0]), (0.5, 0.0));
    // One coordinate of a joint, and limits that are taken away.
    let of_one = &m.coordinates()[2].name;
    let limits = JointLimits::default().with("acceleration", f64::INFINITY).unwrap();
    let m = m.with_limits(&[(of_one, limits)]).unwrap();
    assert_eq!(m.coordinates()[1].limits.acceleration, 20.0);
    assert_eq!(m.coordinates()[2].limits, Limits::NONE);
    // Joints that close loops have limits too.
    let five_bar = cylindroid::load("five-bar").unwrap();
    let slow = JointLimits { velocity: Some(0.25), ..JointLimits::default() };
    let five_bar = five_bar.with_limits(&[("q5", slow)]).unwrap();
    assert_eq!(five_bar.limits_of("q5").unwrap().velocity, 0.25);
}

#[test]
fn wrong_limits_are_refused_where_they_stand() {
    for (text, expected) in [
        ("[sholder]\nvelocity = 1", "1:2: no joint named 'sholder'; nearest: shoulder"),
        ("[shoulder]\nspeed = 1", "2:1: no key named 'speed'"),
        ("[shoulder]\nlower = -3", "1:2: shoulder: its position limits are -2 and 2; they can be"),
        ("[shoulder]\nvelocity = -1", "it must not be negative"),
        ("[shoulder]\nlower = 1\nupper = 0", "lower limit 1 above its upper limit 0"),
        ("[shoulder]\nvelocity = \"fast\"", "2:12: velocity in limits is a string"),
        ("[follower]\nvelocity = 1", "1:2: follower: it follows 'shoulder'"),
        ("[flange]\nvelocity = 1", "it is fixed"),
        ("shoulder = 1", "1:12: this is no table of limits"),
        ("[shoulder", "broken TOML"),
    ] {
        let error = read(text).unwrap_err().to_string();
        assert!(error.contains(expected), "'{expected}' not in: {error}");
    }
    let error = JointLimits::default().with("velocty", 1.0).unwrap_err().to_string();
    assert!(error.contains("nearest: velocity"), "{error}");
    assert!(with_limits_of_file(&arm(), Path::new("missing.toml")).is_err());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("limits.toml");
    std::fs::write(&path, b"[shoulder]\nvelocity = 1 # gr\xfcn\n").unwrap();
    let error = with_limits_of_file(&arm(), &path).unwrap_err().to_string();
    assert!(
        error.contains("limits.toml:2:18: this is not UTF-8, which a file of limits"),
        "{error}"
    );
}
