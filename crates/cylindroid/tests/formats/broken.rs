//! Broken URDFs: every error says where, what, and what would be right.

use crate::urdf::one_joint;
use crate::{ARM_URDF, pointed_at, read_urdf, refused};

/// Refuses the text, pointing at `at`, with words that contain `says`.
#[track_caller]
fn check(text: &str, at: &str, says: &str) {
    let error = refused(text, read_urdf(text));
    let all = format!("{} ({})", error.message, error.help);
    assert!(all.contains(says), "'{says}' not in: {all}");
    assert_eq!(pointed_at(text, &error), at, "{all}");
}

#[test]
fn broken_xml_has_line_and_column() {
    let text = "<robot name='r'>\n  <link name='a'/>\n  <link name='b'></joint>\n</robot>";
    let error = refused(text, read_urdf(text));
    assert_eq!((error.line, error.column), (3, 18), "{error}");
    assert!(error.to_string().starts_with("robots/test.urdf:3:18: broken XML: "), "{error}");
    for text in ["", "hello", "<robot", "<robot>", "<robot name='a' name='b'/>", "<a:robot/>"] {
        assert!(refused(text, read_urdf(text)).message.contains("broken XML"), "{text}");
    }
}

#[test]
fn bad_numbers_are_pointed_at() {
    let joint = |inside: &str| one_joint("revolute", inside);
    check(&joint("<origin xyz='0 0'/>"), "0 0", "has 2 numbers, expected 3");
    check(&joint("<origin xyz='0 0 1 2'/>"), "0 0 1 2", "has 4 numbers, expected 3");
    check(&joint("<origin rpy='0 0 x'/>"), "0 0 x", "'x' is not a number");
    check(&joint("<origin rpy='0 0 nan'/>"), "0 0 nan", "'nan' is not a number");
    check(&joint("<origin xyz='0 0 inf'/>"), "0 0 inf", "not finite");
    check(&joint("<origin xyz='0,0,1'/>"), "0,0,1", "'0,0,1' is not a number");
    check(&joint("<axis xyz='1'/>"), "1", "expected 3");
    check(&joint("<limit lower='low'/>"), "low", "'low' is not a number");
    check(&joint("<limit velocity='-1'/>"), "-1", "must not be negative");
    check(&joint("<mimic joint='j' multiplier=''/>"), "", "has 0 numbers, expected 1");
    check(&joint("<origin xyz='${x} 0 0'/>"), "${x} 0 0", "pip install xacro");
    let shape = ARM_URDF.replace("0.2 0.2 0.1", "0.2 0.2");
    check(&shape, "0.2 0.2", "size of <box> has 2 numbers");
    let mass = ARM_URDF.replace("<mass value=\"2\"", "<mass value=\"heavy\"");
    check(&mass, "heavy", "value of <mass>");
}

#[test]
fn an_axis_without_direction_is_refused() {
    check(&one_joint("revolute", "<axis xyz='0 0 0'/>"), "0 0 0", "joint 'j' has no direction");
    check(&one_joint("planar", "<axis xyz='0 0 0'/>"), "0 0 0", "1 0 0");
}

#[test]
fn exchanged_limits_are_refused() {
    let text = one_joint("revolute", "<limit lower='2' upper='-1' velocity='1' effort='1'/>");
    check(&text, "2", "lower limit 2 above its upper limit -1");
    let text = one_joint("revolute", "<limit upper='-1' velocity='1' effort='1'/>");
    check(&text, "-1", "a limit that is missing is 0");
}

#[test]
fn joints_name_two_declared_links() {
    let text = one_joint("revolute", "");
    check(&text.replace("<parent link='a'/>", ""), "<joint", "joint 'j' has no <parent>");
    check(&text.replace("<child link='b'/>", ""), "<joint", "add <child link=");
    check(&text.replace("<child link='b'/>", "<child/>"), "<child", "<child> has no link");
    let text = ARM_URDF.replace("<parent link=\"fore\"", "<parent link=\"for\"");
    check(&text, "for", "no link named 'for'; nearest: fore");
}

#[test]
fn names_and_types_are_needed() {
    let text = one_joint("revolute", "");
    check(&text.replace("name='j' ", ""), "<joint", "<joint> has no name");
    check(&text.replace("<link name='a'/>", "<link/>"), "<link", "<link> has no name");
    check(&text.replace(" type='revolute'", ""), "<joint", "<joint> has no type");
    check(&one_joint("revolut", ""), "revolut", "no joint type named 'revolut'; nearest: revolute");
}

#[test]
fn names_given_twice_are_pointed_at() {
    let text = ARM_URDF.replace("joint name=\"flange\"", "joint name=\"lift\"");
    let error = refused(&text, read_urdf(&text));
    assert!(error.message.contains("two joints are named 'lift'"), "{error}");
    assert_eq!(error.span.start, text.rfind("name=\"lift\"").unwrap() + 6);
    check("<robot name='r'><link name='a'/><link name='a'/></robot>", "a", "two links are named");
}

#[test]
fn masses_are_not_negative() {
    let text =
        "<robot name='r'><link name='a'><inertial><mass value='-1'/></inertial></link></robot>";
    check(text, "a", "the mass of link 'a' is -1 kg; a mass is not negative");
}

const THREE: &str = "<robot name='r'><link name='a'/><link name='b'/><link name='c'/>\
    <joint name='one' type='fixed'><parent link='a'/><child link='b'/></joint>\
    <joint name='two' type='fixed'><parent link='b'/><child link='c'/></joint></robot>";

#[test]
fn the_tree_is_checked() {
    assert!(read_urdf(THREE).is_ok());
    let two_parents =
        THREE.replace("<parent link='b'/><child link='c'/>", "<parent link='a'/><child link='b'/>");
    check(&two_parents, "two", "is the child of two joints");
    let cycle = THREE.replace("<child link='b'/>", "<child link='a'/>");
    check(&cycle, "one", "connects link 'a' with itself");
    let cycle = THREE.replace(
        "</robot>",
        "<joint name='three' type='fixed'><parent link='c'/><child link='a'/></joint></robot>",
    );
    let error = refused(&cycle, read_urdf(&cycle));
    assert!(error.message.contains("form a cycle without a root"), "{error}");
    let part = THREE.replace("</robot>", "<link name='alone'/></robot>");
    check(&part, "alone", "falls into 2 parts");
    check("<robot name='r'></robot>", "<robot", "it has no links");
}

#[test]
fn mimics_follow_a_joint_that_moves_alone() {
    let text = ARM_URDF.replace("joint=\"finger_left\"", "joint=\"finger_lft\"");
    check(&text, "finger_lft", "no joint named 'finger_lft'; nearest: finger_left");
    let ring = ARM_URDF.replace("joint=\"finger_left\"", "joint=\"finger_right\"");
    check(&ring, "finger_right", "follows itself in a ring");
    check(&one_joint("floating", "<mimic joint='j'/>"), "j", "ring");
    let fixed = ARM_URDF.replace("joint=\"finger_left\"", "joint=\"flange\"");
    check(&fixed, "flange", "both must have one coordinate");
}

#[test]
fn xacro_is_refused_with_the_command_that_expands_it() {
    let declared = "<robot name='r' xmlns:xacro='http://www.ros.org/wiki/xacro'>\
        <xacro:property name='x' value='1'/></robot>";
    check(declared, "<xacro:property", "xacro file.urdf.xacro > file.urdf");
    let undeclared = "<robot name='r'><xacro:include filename='a'/></robot>";
    let error = refused(undeclared, read_urdf(undeclared));
    assert!(error.help.contains("pip install xacro"), "{error}");
    check("<robot name='r'><macro name='m'/></robot>", "<macro", "pip install xacro");
    let plain = "<robot name='r'><link name='a'/></robot>";
    let path = std::path::Path::new("r.urdf.xacro");
    let error = refused(plain, cylindroid::model::formats::urdf::parse(plain, path));
    assert!(error.message.contains("xacro"), "{error}");
}

#[test]
fn other_formats_are_named() {
    for (text, format, word) in [
        ("<mujoco model='m'/>", "MJCF", "this is MJCF"),
        ("<sdf version='1.6'/>", "SDF", "this is SDF"),
        ("<html/>", "URDF", "the root element is <html>"),
    ] {
        let error = refused(text, read_urdf(text));
        assert_eq!(error.format, format);
        assert!(error.message.contains(word) && !error.help.is_empty(), "{error}");
    }
}
