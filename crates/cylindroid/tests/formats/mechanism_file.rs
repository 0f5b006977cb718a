//! The mechanism file: joints in world axes at q = 0.

use std::f64::consts::FRAC_PI_2;

use cylindroid::model::JointKind;
use cylindroid::{Pose, Rotation, Vec3};

use crate::fk::{assert_close, frame, tool};
use crate::{ARM_TOML, pointed_at, read_toml, refused};

#[track_caller]
pub(crate) fn check(text: &str, at: &str, says: &str) {
    let error = refused(text, read_toml(text));
    let all = format!("{} ({})", error.message, error.help);
    assert!(all.contains(says), "'{says}' not in: {all}");
    assert!(pointed_at(text, &error).starts_with(at), "{all}: {:?}", pointed_at(text, &error));
}

pub(crate) fn joint(name: &str, kind: &str, between: [&str; 2], rest: &str) -> String {
    let [a, b] = between;
    format!(
        "[[joint]]\nname = \"{name}\"\ntype = \"{kind}\"\nbetween = [\"{a}\", \"{b}\"]\n{rest}\n"
    )
}

#[test]
fn frames_have_world_axes_at_zero_and_sit_at_their_joint() {
    let m = read_toml(ARM_TOML).unwrap();
    let at = |x, y, z| Pose::from_translation(Vec3::new(x, y, z));
    assert_close(frame(&m, &[0.0, 0.0], "link"), at(0.0, 0.0, 0.3), 1e-15);
    assert_close(frame(&m, &[0.0, 0.0], "hand"), at(0.5, 0.0, 0.3), 1e-15);
    assert_eq!(m.frame_of(m.tool()).name, "reference");
    assert_close(tool(&m, &[0.0, 0.0]), at(1.0, 0.2, 0.3), 1e-15);
    let tip = Pose { rotation: Rotation::about_z(1.5), translation: Vec3::new(0.6, 0.0, 0.3) };
    assert_close(frame(&m, &[0.0, 0.0], "tip"), tip, 1e-15);
    assert_eq!(m.home(), [0.1, 0.2]);
    assert_eq!(m.report().source, "none, a test file");
    let actuated: Vec<bool> = m.joints().iter().map(|j| j.actuated).collect();
    assert_eq!(actuated, [true, false]);
    assert_eq!(m.joints()[0].limits.acceleration, 10.0);
}

#[test]
fn a_helical_joint_advances_by_its_pitch() {
    let m = read_toml(ARM_TOML).unwrap();
    assert_eq!(m.joints()[1].kind, JointKind::Helical { pitch: 0.01 });
    let hand = frame(&m, &[0.0, 2.0], "hand");
    assert!((hand.translation - Vec3::new(0.5, 0.02, 0.3)).norm() < 1e-15);
}

#[test]
fn a_planar_arm_is_three_numbers_short() {
    let text = format!(
        "dimension = 2\nreference = \"b\"\nreference_point = [2, 0]\n{}{}{}",
        joint("r", "revolute", ["ground", "a"], "origin = [0, 0]"),
        joint("s", "revolute", ["a", "b"], "origin = [1, 0]\naxis = [0, 0, -1]"),
        joint("p", "prismatic", ["b", "c"], "axis = [0, 2]"),
    );
    let m = read_toml(&text).unwrap();
    let t = tool(&m, &[FRAC_PI_2, FRAC_PI_2, 0.0]).translation;
    assert!((t - Vec3::new(1.0, 1.0, 0.0)).norm() < 1e-15);
    // Without an origin a slider sits where its parent sits.
    let c = frame(&m, &[0.0, 0.0, 0.5], "c").translation;
    assert!((c - Vec3::new(1.0, 0.5, 0.0)).norm() < 1e-15);
    for (from, to, says) in [
        ("origin = [1, 0]", "origin = [1, 0, 2]", "leaves the plane"),
        ("origin = [1, 0]", "origin = [1]", "has 1 numbers, expected 2"),
        ("[0, 0, -1]", "[0, 1, 0]", "leaves z"),
        ("\"prismatic\"", "\"spherical\"", "leaves the plane"),
        ("dimension = 2", "dimension = 4", "dimension = 4"),
    ] {
        let changed = text.replace(from, to);
        let error = refused(&changed, read_toml(&changed));
        assert!(error.message.contains(says), "{error}");
    }
}

#[test]
fn every_joint_type_is_read() {
    let o = "origin = [0, 0, 1]";
    let axis = "origin = [0, 0, 1]\naxis = [0, 1, 0]";
    let second = Vec3::X;
    for (kind, rest, expected) in [
        ("revolute", axis, JointKind::Revolute),
        ("continuous", axis, JointKind::Continuous),
        ("prismatic", axis, JointKind::Prismatic),
        ("cylindrical", axis, JointKind::Cylindrical),
        ("planar", axis, JointKind::Planar),
        ("spherical", o, JointKind::Spherical),
        ("fixed", "", JointKind::Fixed),
        ("free", "", JointKind::Free),
        (
            "universal",
            "origin = [0, 0, 1]\naxis = [0, 1, 0]\naxis2 = [1, 0, 0]",
            JointKind::Universal { second },
        ),
    ] {
        let m = read_toml(&joint("j", kind, ["ground", "a"], rest)).unwrap();
        assert_eq!(m.joints()[0].kind, expected);
    }
    let text = joint(
        "j",
        "universal",
        ["ground", "a"],
        "origin = [0, 0, 1]\naxis = [0, 1, 0]\naxis2 = [1, 0, 0]",
    );
    let m = read_toml(&text).unwrap();
    let turned = Rotation::about(Vec3::Y, 0.3).unwrap() * Rotation::about(Vec3::X, 0.4).unwrap();
    let expected = Pose { rotation: turned, translation: Vec3::Z };
    assert_close(frame(&m, &[0.3, 0.4], "a"), expected, 1e-15);
}

/// q is the motion of the second link of `between` relative to the first, in either order.
#[test]
fn a_reversed_joint_keeps_the_sign_of_its_coordinate() {
    let axis = "origin = [0.5, 0.2, 0]\naxis = [0, 0, 1]\n";
    for (kind, rest, q) in [
        ("revolute", axis.to_owned(), vec![0.7]),
        ("prismatic", axis.to_owned(), vec![0.7]),
        ("helical", format!("{axis}pitch = 0.3"), vec![0.7]),
        ("cylindrical", axis.to_owned(), vec![0.7, 0.4]),
        ("fixed", axis.to_owned(), vec![]),
        ("universal", format!("{axis}axis2 = [0.1, 1, 0.2]"), vec![0.7, 0.4]),
        ("spherical", axis.to_owned(), vec![0.7, 0.4, -1.2]),
        ("planar", axis.replace("0, 0, 1", "1, 2, 3"), vec![0.7, 0.4, -1.2]),
        ("free", axis.to_owned(), vec![0.3, -0.2, 0.9, 0.7, 0.4, -1.2]),
    ] {
        let forward = read_toml(&joint("j", kind, ["ground", "a"], &rest)).unwrap();
        let reversed = read_toml(&joint("j", kind, ["a", "ground"], &rest)).unwrap();
        let origin = Pose::from_translation(Vec3::new(0.5, 0.2, 0.0));
        // Motion of a relative to ground, both seen at the joint.
        let of = |m| origin.inverse() * frame(m, &q, "a");
        assert_close(of(&reversed), of(&forward).inverse(), 1e-15);
        for m in [&forward, &reversed] {
            let by_nodes = m.state(&q).unwrap().pose(m.frame("a").unwrap()).unwrap();
            assert_close(by_nodes, frame(m, &q, "a"), 1e-15);
        }
    }
}

#[test]
fn joints_may_come_in_any_sequence() {
    let text = format!(
        "{}{}{}",
        joint("three", "revolute", ["c", "b"], "origin = [2, 0, 0]\naxis = [0, 0, 1]"),
        joint("two", "revolute", ["a", "b"], "origin = [1, 0, 0]\naxis = [0, 0, 1]"),
        joint("one", "revolute", ["ground", "a"], "origin = [0, 0, 0]\naxis = [0, 0, 1]"),
    );
    let m = read_toml(&text).unwrap();
    let names: Vec<&str> = m.joints().iter().map(|j| j.name.as_str()).collect();
    assert_eq!(names, ["one", "two", "three"]);
    let c = frame(&m, &[0.0, 0.0, 0.0], "c");
    assert_close(c, Pose::from_translation(Vec3::new(2.0, 0.0, 0.0)), 1e-15);
}

#[test]
fn mimics_are_read() {
    let text = format!(
        "{}{}",
        joint("p", "prismatic", ["ground", "a"], "axis = [1, 0, 0]"),
        joint(
            "m",
            "prismatic",
            ["ground", "b"],
            "axis = [0, 1, 0]\nmimic = { joint = \"p\", multiplier = -2, offset = 1 }"
        ),
    );
    let m = read_toml(&text).unwrap();
    assert_eq!(m.n(), 1);
    assert_eq!(frame(&m, &[0.25], "b").translation, Vec3::new(0.0, 0.5, 0.0));
}

#[test]
fn what_is_not_known_is_refused_with_the_nearest_name() {
    check(&ARM_TOML.replace("acceleration", "acceleraton"), "acceleraton", "nearest: acceleration");
    check(&ARM_TOML.replace("pitch =", "pich ="), "pich", "no key named 'pich'; nearest: pitch");
    check(&ARM_TOML.replace("home =", "hom ="), "hom", "nearest: home");
    check(
        &ARM_TOML.replace("\"helical\"", "\"screw\""),
        "\"screw\"",
        "no joint type named 'screw'",
    );
    check(&ARM_TOML.replace("link = \"hand\"", "link = \"hnd\""), "\"hnd\"", "nearest: hand");
    check(
        &ARM_TOML.replace("reference = \"hand\"", "reference = \"x\""),
        "\"x\"",
        "no link or frame named",
    );
    let tool = format!("tool = \"tp\"\n{ARM_TOML}");
    check(&tool, "\"tp\"", "no frame named 'tp'; nearest: tip");
    let ring = ARM_TOML.replace("pitch = 0.01", "pitch = 0.01\nmimic = { joint = \"swin\" }");
    check(&ring, "\"screw\"", "no joint named 'swin'; nearest: swing");
}

#[test]
fn wrong_values_are_pointed_at() {
    check(
        &ARM_TOML.replace("0.0, 0.0, 0.3", "0.0, 0.0"),
        "[0.0, 0.0]",
        "has 2 numbers, expected 3",
    );
    check(&ARM_TOML.replace("[0, 0, 1]", "[0, 0, \"1\"]"), "\"1\"", "not a finite number");
    check(&ARM_TOML.replace("[0, 0, 1]", "[0, 0, nan]"), "nan", "not a finite number");
    check(&ARM_TOML.replace("[0, 0, 1]", "[0, 0, 0]"), "[0, 0, 0]", "no direction");
    check(&ARM_TOML.replace("actuated = true", "actuated = 1"), "1", "is an integer");
    check(&ARM_TOML.replace("lower = -3", "lower = 4"), "\"swing\"", "above its upper limit");
    check(&ARM_TOML.replace("lower = -3", "lower = nan"), "nan", "give a number");
    check(&ARM_TOML.replace("home = [0.1, 0.2]", "home = [0.1]"), "[0.1]", "home has 1 entries");
    check(&ARM_TOML.replace("name = \"tip\"", "name = \"hand\""), "\"hand\"", "names two frames");
    check(&ARM_TOML.replace("pitch = 0.01", ""), "[[joint]]", "[[joint]] has no pitch");
    check(&ARM_TOML.replace("axis = [0, 0, 1]", ""), "[[joint]]", "has no axis");
    check(&ARM_TOML.replace("origin = [0.0, 0.0, 0.3]", ""), "[[joint]]", "has no origin");
    check(&ARM_TOML.replace("[\"link\", \"hand\"]", "[\"link\"]"), "[\"link\"]", "two links");
    check(&ARM_TOML.replace("\"revolute\"", "\"revolute\"\npitch = 1"), "1", "has no pitch");
    check(&ARM_TOML.replace("reference = \"hand\"\n", ""), "[1.0", "needs a reference");
    check("", "", "the file has no joints");
    check("name = [", "", "broken TOML");
    let text = "a = 1\nb = = 2";
    let error = refused(text, read_toml(text));
    assert_eq!((error.line, error.column), (2, 5), "{error}");
}

#[test]
fn joints_that_hold_nothing_up_are_refused() {
    let own = ARM_TOML.replace("[\"link\", \"hand\"]", "[\"link\", \"link\"]");
    check(&own, "[\"link\", \"link\"]", "connects link 'link' with itself");
    let loose = joint("loose", "revolute", ["x", "y"], "origin = [1, 0, 0]\naxis = [0, 0, 1]");
    check(&format!("{ARM_TOML}\n{loose}"), "[\"x\", \"y\"]", "'loose' hangs in the air");
    check(&loose, "[\"x\", \"y\"]", "name the fixed link ground");
}

/// Nothing could keep them, so they are dropped, and said to be.
#[test]
fn position_limits_of_a_free_joint_are_noted_and_dropped() {
    for (kind, rest) in [("spherical", "origin = [0, 0, 1]"), ("free", "")] {
        let rest = format!("{rest}\nlimits = {{ lower = -1, upper = 1, velocity = 2 }}");
        let m = read_toml(&joint("ball", kind, ["ground", "a"], &rest)).unwrap();
        let limits = m.coordinates()[0].limits;
        assert_eq!((limits.lower, limits.upper), (f64::NEG_INFINITY, f64::INFINITY));
        assert_eq!(limits.velocity, 2.0);
        let note = &m.report().ignored[0];
        assert!(note.what.contains("position limits") && note.what.contains("ball"), "{note:?}");
        assert!(note.line > 0 && note.why.contains("dropped"), "{note:?}");
    }
}
