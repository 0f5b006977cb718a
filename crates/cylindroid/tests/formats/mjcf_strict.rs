//! MJCF that MuJoCo refuses: what is malformed is refused here as well, what keeps a model from a
//! simulation alone is noted. The verdicts are those of MuJoCo 4.0.

use cylindroid::Mechanism;

use crate::mjcf::{check, read, world};
use crate::report;

/// A body with these joints and contents, and a compiler with these settings.
fn body(compiler: &str, joints: &str, inside: &str) -> String {
    format!(
        "<mujoco><compiler angle='radian' {compiler}/><worldbody><body name='b'>{joints}{inside}\
         </body></worldbody></mujoco>"
    )
}

const BALL: &str = "<geom size='.1'/>";

fn limits(m: &Mechanism) -> [f64; 2] {
    let limits = &m.coordinates()[0].limits;
    [limits.lower, limits.upper]
}

/// Attributes with more numbers than they take.
#[test]
fn surplus_numbers_are_refused() {
    for (attribute, value) in [
        ("pos", "1 2 3 4"),
        ("quat", "1 0 0 0 0"),
        ("euler", "1 2 3 4"),
        ("axisangle", "1 0 0 1 2"),
        ("xyaxes", "1 0 0 0 1 0 1"),
        ("zaxis", "0 0 1 1"),
    ] {
        let text = world(&format!("<body {attribute}='{value}'>{BALL}</body>"));
        check(&text, value, "numbers, expected");
    }
    check(&body("", "<joint ref='1 2'/>", BALL), "1 2", "has 2 numbers, expected 1");
    check(&body("", "<joint range='1 2 3'/>", BALL), "1 2 3", "has 3 numbers, expected 2");
    let four = "<geom size='1 1 1 1'/>";
    check(&body("", "<joint/>", four), "1 1 1 1", "size of <geom> has 4 numbers, at most 3");
    let with = |section: &str| {
        body("", "<joint name='j'/>", BALL).replace("</mujoco>", &format!("{section}</mujoco>"))
    };
    let gear = with("<actuator><motor joint='j' gear='1 2 3 4 5 6 7'/></actuator>");
    check(&gear, "1 2 3 4 5 6 7", "gear of <motor> has 7 numbers, at most 6");
    let coupling =
        with("<equality><joint joint1='j' joint2='j' polycoef='0 1 0 0 0 0'/></equality>");
    check(&coupling, "0 1 0 0 0 0", "polycoef of <joint> has 6 numbers, at most 5");
    // A blank attribute gives no numbers: the default counts.
    let m = read(
        "<mujoco><default><joint axis='1 0 0'/></default><worldbody><body name='b' pos=''>\
         <joint axis=' '/><geom size='.1' mass=''/></body></worldbody></mujoco>",
    );
    assert_eq!(m.joints()[0].axis.to_array(), [1.0, 0.0, 0.0]);
}

/// Only shapes with an axis lie between two points.
#[test]
fn shapes_between_two_points_have_an_axis() {
    let geom = |attributes: &str| body("", "<joint/>", &format!("<geom size='.1' {attributes}/>"));
    let ends = "fromto='0 0 0 1 0 0'";
    for kind in ["capsule", "cylinder", "box", "ellipsoid"] {
        read(&geom(&format!("type='{kind}' {ends}")));
    }
    check(&geom(ends), "0 0 0 1 0 0", "the type is sphere");
    check(&geom(&format!("type='plane' {ends}")), "0 0 0 1 0 0", "the type is plane");
    check(&geom(&format!("type='mesh' {ends}")), "0 0 0 1 0 0", "the type is mesh");
    check(&geom(&format!("type='capsule' mesh='m' {ends}")), "0 0 0 1 0 0", "place of a mesh");
    check(&geom("type='box' fromto='1 2 3 1 2 3'"), "1 2 3 1 2 3", "its two points are one");
    check(&geom("type='box' fromto='1 2 3 1 2'"), "1 2 3 1 2", "has 5 numbers, expected 6");
    let site = |kind: &str| {
        body("", "<joint/>", &format!("{BALL}<site name='s' {kind} fromto='0 0 0 1 0 0'/>"))
    };
    check(&site(""), "0 0 0 1 0 0", "fromto of <site>");
    read(&site("type='cylinder'"));
}

/// "true" requires a lower end below the upper one; without a flag such a range limits, and another
/// one does not.
#[test]
fn ranges_limit_where_their_ends_are_in_order() {
    let free = [f64::NEG_INFINITY, f64::INFINITY];
    for kind in ["hinge", "slide"] {
        let joint = |compiler: &str, attributes: &str| {
            body(compiler, &format!("<joint name='j' type='{kind}' {attributes}/>"), BALL)
        };
        for (compiler, attributes, expected, noted) in [
            ("", "range='-1 2'", [-1.0, 2.0], false),
            ("", "range='-1 2' limited='auto'", [-1.0, 2.0], false),
            ("", "range='-1 2' limited='true'", [-1.0, 2.0], false),
            ("", "range='-1 2' limited='false'", free, false),
            ("", "range='2 -1' limited='false'", free, false),
            ("", "range='2 -1'", free, true),
            ("", "range='1 1'", free, true),
            ("", "range='0 0'", free, true),
            ("autolimits='false'", "range='-1 2' limited='true'", [-1.0, 2.0], false),
            ("autolimits='false'", "range='-1 2' limited='false'", free, false),
            ("autolimits='false'", "range='0 0'", free, true),
            ("autolimits='false'", "", free, false),
        ] {
            let m = read(&joint(compiler, attributes));
            let said = report(&m);
            assert_eq!(limits(&m), expected, "{kind} {compiler} {attributes}");
            assert_eq!(said.contains("attribute 'range'"), noted, "{attributes}: {said}");
        }
        let limited = |attributes: &str| joint("", &format!("limited='true' {attributes}"));
        check(&limited("range='1 -1'"), "1 -1", "is not below the upper end -1");
        check(&limited("range='1 1'"), "1 1", "is not below the upper end 1");
        check(&limited(""), "true", "is not below the upper end 0");
        check(&joint("", "limited='maybe'"), "maybe", "not true, false or auto");
        for attributes in ["range='-1 2'", "range='-1 2' limited='auto'"] {
            let text = joint("autolimits='false'", attributes);
            check(&text, "-1 2", "range without limited = \"true\" or \"false\"");
        }
    }
    check(&body("autolimits='maybe'", "", ""), "maybe", "not true or false");
    // A range that all joints have by default is none of a free joint.
    read(
        "<mujoco><compiler autolimits='false'/><default><joint range='0 1'/></default><worldbody>\
         <body><freejoint/><geom size='1'/></body></worldbody></mujoco>",
    );
}

/// The same of forces, of joints and of actuators.
#[test]
fn ranges_of_forces_limit_where_their_flags_say_so() {
    let effort = |compiler: &str, joint: &str, motor: &str| {
        let text = body(compiler, &format!("<joint name='j' {joint}/>"), BALL);
        let motor = format!("<actuator><motor joint='j' {motor}/></actuator></mujoco>");
        text.replace("</mujoco>", &motor)
    };
    for (joint, motor, expected) in [
        ("actuatorfrcrange='-2 3'", "", 3.0),
        ("actuatorfrcrange='-2 3' actuatorfrclimited='false'", "", f64::INFINITY),
        ("actuatorfrcrange='3 -2'", "", f64::INFINITY),
        ("", "forcerange='-2 3'", 3.0),
        ("", "forcerange='-2 3' forcelimited='false'", f64::INFINITY),
        ("", "forcerange='-2 3' forcelimited='false' ctrlrange='-1 1'", 1.0),
        ("", "ctrlrange='-2 3' ctrllimited='true'", 3.0),
        ("", "ctrlrange='-2 3' ctrllimited='false'", f64::INFINITY),
        ("", "ctrlrange='3 -2'", f64::INFINITY),
    ] {
        let m = read(&effort("", joint, motor));
        assert_eq!(m.coordinates()[0].limits.effort, expected, "{joint} {motor}");
    }
    for (joint, motor, range) in [
        ("actuatorfrcrange='-2 3'", "", "actuatorfrcrange"),
        ("", "forcerange='-2 3'", "forcerange"),
        ("", "ctrlrange='-2 3'", "ctrlrange"),
    ] {
        let text = effort("autolimits='false'", joint, motor);
        check(&text, "-2 3", &format!("has {range} without"));
    }
    let text = effort("", "", "ctrlrange='3 -2' ctrllimited='true'");
    check(&text, "3 -2", "is not below the upper end -2");
}

/// Kinematics needs no masses: a body that MuJoCo cannot move is noted, if no body fixed to it has a
/// mass either.
#[test]
fn moving_bodies_without_mass_are_noted() {
    let note = "moving body without mass or inertia";
    let point = "<inertial pos='0 0 0' mass='1' diaginertia='0 0 0'/>";
    let none = "<inertial pos='0 0 0' mass='0' diaginertia='1 1 1'/>";
    let joint = "<joint/>";
    for (inside, noted) in [
        (BALL, false),
        ("", true),
        ("<geom size='.1' mass='0'/>", true),
        (point, true),
        (none, true),
        ("<inertial pos='0 0 0' mass='1'/>", true),
        ("<inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/>", false),
        ("<body><body><geom size='.1'/></body></body>", false),
        ("<body><joint/><geom size='.1'/></body>", true),
        ("<geom type='mesh' mesh='none'/>", false),
    ] {
        let said = report(&read(&body("", joint, inside)));
        assert_eq!(said.contains(note), noted, "{inside}: {said}");
        let said = report(&read(&body("", "", inside)));
        let own = inside.contains("<joint/>");
        assert!(own || !said.contains(note), "{inside}: {said}");
    }
    let bounded = "boundmass='1' boundinertia='1'";
    assert!(!report(&read(&body(bounded, joint, ""))).contains(note));
    assert!(report(&read(&body("boundmass='1'", joint, ""))).contains(note));
    // One line for all of them, with their names.
    let two = world("<body name='p'><joint/><body name='q'><joint/></body></body>");
    let said = report(&read(&two));
    assert!(said.contains(&format!("{note} (2 times: p, q)")), "{said}");
}

#[test]
fn moving_bodies_with_too_many_joints_are_noted() {
    let joints = |kinds: &[&str]| -> String {
        kinds.iter().map(|kind| format!("<joint type='{kind}'/>")).collect()
    };
    let (seven, ball) = ("more than 6 degrees of freedom", "a rotation after a ball joint");
    for (kinds, notes) in [
        (&["slide", "slide", "slide", "ball"][..], [false, false]),
        (&["ball", "slide"], [false, false]),
        (&["hinge", "ball"], [false, false]),
        (&["ball", "hinge"], [false, true]),
        (&["ball", "ball"], [false, true]),
        (&["hinge"; 7], [true, false]),
    ] {
        let said = report(&read(&body("", &joints(kinds), BALL)));
        assert_eq!([seven, ball].map(|note| said.contains(note)), notes, "{kinds:?}: {said}");
    }
}

#[test]
fn inertias_are_given_once_and_whole() {
    let of = |attributes: &str| body("", "<joint/>", &format!("<inertial {attributes}/>"));
    check(&of("mass='1' diaginertia='1 1 1'"), "<inertial", "<inertial> has no pos");
    check(&of("pos='0 0 0' diaginertia='1 1 1'"), "<inertial", "<inertial> has no mass");
    let full = "pos='0 0 0' mass='1' fullinertia='1 1 1 0 0 0'";
    read(&of(full));
    check(&of(&format!("{full} diaginertia='1 1 1'")), "1 1 1", "both fullinertia and diaginertia");
    check(&of(&format!("{full} quat='0 1 0 0'")), "0 1 0 0", "both fullinertia and quat");
    let two = "<inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/>".repeat(2);
    check(&body("", "<joint/>", &two), "<inertial", "body 'b' has two <inertial>");
    for attribute in ["mass", "density"] {
        let geom = format!("<geom size='.1' {attribute}='-1'/>");
        check(&body("", "<joint/>", &geom), "-1", &format!("{attribute} of <geom> is negative"));
    }
}
