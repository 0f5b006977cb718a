//! Real URDFs are lax: what the kinematics does not need is noted, never refused.

use cylindroid::model::{Geometry, Limits};

use crate::urdf::one_joint;
use crate::{read_urdf, report};

fn one_link(inside: &str) -> String {
    format!("<robot name='r'><link name='a'>{inside}</link></robot>")
}

#[test]
fn materials_without_name_or_colour_load() {
    let shape = "<geometry><sphere radius='1'/></geometry>";
    for material in [
        "<material/>",
        "<material name=''/>",
        "<material name='unknown'/>",
        "<material name='t'><texture/></material>",
        "<material name='t'><color/></material>",
        "<material name='t'><color rgba='red'/></material>",
    ] {
        let text = one_link(&format!("<visual>{shape}{material}</visual>"));
        let m = read_urdf(&text).unwrap();
        assert_eq!(m.links()[0].visuals[0].rgba, None, "{material}");
        assert!(report(&m).contains("<material>"), "{material}");
    }
    let text = one_link(&format!(
        "<visual>{shape}<material><color rgba='1 0 0 0.5'/><texture/></material></visual>"
    ));
    assert_eq!(read_urdf(&text).unwrap().links()[0].visuals[0].rgba, Some([1.0, 0.0, 0.0, 0.5]));
}

#[test]
fn a_material_defined_in_a_later_link_is_found() {
    let text = "<robot name='r'><link name='a'>\
        <visual><geometry><sphere radius='1'/></geometry><material name='m'/></visual>\
        <visual><geometry><sphere radius='1'/></geometry>\
        <material name='m'><color rgba='0 0 1 1'/></material></visual></link></robot>";
    let m = read_urdf(text).unwrap();
    assert_eq!(m.links()[0].visuals[0].rgba, Some([0.0, 0.0, 1.0, 1.0]));
}

#[test]
fn an_inertial_without_mass_is_noted() {
    let text = one_link("<inertial><inertia ixx='1' iyy='1' izz='1'/></inertial>");
    let m = read_urdf(&text).unwrap();
    assert_eq!(m.links()[0].inertial, None);
    assert!(report(&m).contains("<inertial> (a): it gives no mass"));
}

#[test]
fn shapes_without_geometry_are_noted() {
    let m = read_urdf(&one_link("<visual/><collision><geometry/></collision>")).unwrap();
    assert!(m.links()[0].visuals.is_empty() && m.links()[0].collisions.is_empty());
    assert!(report(&m).contains("<visual> without a shape"));
}

#[test]
fn missing_and_zero_limits_are_unlimited_and_noted() {
    for (limit, lower, upper, noted) in [
        ("", f64::NEG_INFINITY, f64::INFINITY, "<limit> missing"),
        ("<limit/>", f64::NEG_INFINITY, f64::INFINITY, "<limit> without lower and upper"),
        ("<limit lower='-1' upper='2'/>", -1.0, 2.0, "velocity limit 0 or missing"),
        ("<limit upper='2' effort='0' velocity='0'/>", 0.0, 2.0, "effort limit 0 or missing"),
        (
            "<limit lower='0' upper='0' effort='0' velocity='0'/>",
            f64::NEG_INFINITY,
            f64::INFINITY,
            "<limit> of zeros",
        ),
        ("<limit lower='-inf' upper='1'/>", f64::NEG_INFINITY, 1.0, "effort limit"),
    ] {
        let m = read_urdf(&one_joint("revolute", limit)).unwrap();
        assert_eq!(m.coordinates()[0].limits, Limits { lower, upper, ..Limits::NONE }, "{limit}");
        assert!(report(&m).contains(noted), "{limit}: {}", report(&m));
    }
    // A joint that is locked on purpose has an effort or a speed.
    let locked = one_joint("revolute", "<limit lower='0' upper='0' effort='9' velocity='0'/>");
    assert_eq!(read_urdf(&locked).unwrap().coordinates()[0].limits.upper, 0.0);
}

#[test]
fn continuous_joints_have_no_position_limits() {
    let text = one_joint("continuous", "<limit lower='-1' upper='1' velocity='2' effort='3'/>");
    let m = read_urdf(&text).unwrap();
    let limits = m.coordinates()[0].limits;
    assert_eq!(limits, Limits { velocity: 2.0, effort: 3.0, ..Limits::NONE });
    assert!(report(&m).contains("position limits of continuous joints"));
}

#[test]
fn fixed_joints_may_have_an_axis_of_zeros_and_a_mimic() {
    let text = one_joint("fixed", "<axis xyz='0 0 0'/><mimic joint='nobody'/><limit/>");
    assert!(report(&read_urdf(&text).unwrap()).contains("<mimic>"));
}

#[test]
fn unknown_elements_attributes_and_prefixes_are_noted() {
    let text = "<robot name='r' xmlns:xacro='http://www.ros.org/wiki/xacro' xmlns:g='g'>\
        <link name='a' colour='red'><self_collision_checking/></link>\
        <g:link name='not a link'/><gazebo><plugin/></gazebo></robot>";
    let m = read_urdf(text).unwrap();
    assert_eq!(m.links().len(), 1);
    let text = report(&m);
    for part in ["attribute 'colour' of <link>", "<self_collision_checking> (a)", "<gazebo>: "] {
        assert!(text.contains(part), "{part} not in {text}");
    }
    assert_eq!(text.lines().count(), 4, "{text}");
}

#[test]
fn a_default_namespace_is_no_obstacle() {
    let text = one_joint("revolute", "").replacen("<robot", "<robot xmlns='http://drake'", 1);
    assert_eq!(read_urdf(&text).unwrap().n(), 1);
}

#[test]
fn second_elements_are_noted() {
    let text = one_joint("revolute", "<axis xyz='0 0 1'/><axis xyz='0 1 0'/>");
    let m = read_urdf(&text).unwrap();
    assert_eq!(m.joints()[0].axis.z, 1.0);
    assert!(report(&m).contains("second <axis> in <joint>"));
}

#[test]
fn names_and_comments_need_not_be_ascii() {
    let text =
        "<?xml version='1.0'?><!-- Größe: 3 µm --><robot name='腕'><link name='ベース'/></robot>";
    let m = read_urdf(text).unwrap();
    assert_eq!((m.name(), m.links()[0].name.as_str()), ("腕", "ベース"));

    // Latin-1 without a declaration.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("old.urdf");
    std::fs::write(&path, b"<!-- Gr\xf6\xdfe --><robot name='r'><link name='a'/></robot>").unwrap();
    assert_eq!(cylindroid::load_file(&path).unwrap().links().len(), 1);
}

#[test]
fn a_robot_without_a_name_takes_that_of_the_file() {
    let m = read_urdf("<robot><link name='a'/></robot>").unwrap();
    assert_eq!(m.name(), "test");
    assert!(report(&m).contains("attribute 'name' of <robot> missing"));
}

#[test]
fn a_doctype_is_read_over() {
    let text = "<!DOCTYPE robot SYSTEM 'robot.dtd'><robot name='r'><link name='a'/></robot>";
    assert!(read_urdf(text).is_ok());
}

#[test]
fn meshes_are_found_by_package_path_and_file_and_missed_without_harm() {
    let folder = tempfile::tempdir().unwrap();
    let package = folder.path().join("my_robot");
    for sub in ["urdf", "meshes"] {
        std::fs::create_dir_all(package.join(sub)).unwrap();
    }
    let mesh = package.join("meshes/link.stl");
    std::fs::write(&mesh, "solid").unwrap();
    let absolute = format!("file://{}", mesh.display());
    let uris = [
        ("package://my_robot/meshes/link.stl", true),
        ("package://my_robot//meshes/link.stl", true),
        ("model://my_robot/meshes/link.stl", true),
        ("../meshes/link.stl", true),
        (absolute.as_str(), true),
        ("package://other/meshes/link.stl", false),
        ("package://my_robot", false),
        ("package://", false),
        ("file://", false),
        ("", false),
        ("http://example.org/link.stl", false),
    ];
    let shape = |(uri, _): &(&str, bool)| {
        format!("<visual><geometry><mesh filename='{uri}'/></geometry></visual>")
    };
    let text = one_link(&uris.iter().map(shape).collect::<String>());
    let path = package.join("urdf/robot.urdf");
    std::fs::write(&path, &text).unwrap();
    let m = cylindroid::load(&path.to_string_lossy()).unwrap();
    for ((name, found), visual) in uris.iter().zip(&m.links()[0].visuals) {
        let Geometry::Mesh { uri, path, .. } = &visual.geometry else { panic!("not a mesh") };
        assert_eq!((uri.as_str(), path.is_some()), (*name, *found));
    }
    assert!(
        report(&m).contains("mesh (6 times: package://other/meshes/link.stl"),
        "{}",
        report(&m)
    );
    assert!(report(&m).contains("mesh not found"));
}
