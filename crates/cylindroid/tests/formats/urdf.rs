//! What a good URDF gives.

use std::f64::consts::FRAC_PI_2;

use cylindroid::model::{Geometry, JointKind, Limits};
use cylindroid::spatial::Rpy;
use cylindroid::{Pose, Rotation, Vec3};

use crate::fk::{assert_close, frame};
use crate::{ARM_URDF, read_urdf, report};

/// Two links and a joint between them.
pub(crate) fn one_joint(kind: &str, inside: &str) -> String {
    format!(
        "<robot name='r'><link name='a'/><link name='b'/><joint name='j' type='{kind}'>\
         <parent link='a'/><child link='b'/>{inside}</joint></robot>"
    )
}

#[test]
fn names_limits_and_order_come_from_the_file() {
    let m = read_urdf(ARM_URDF).unwrap();
    assert_eq!(m.name(), "arm");
    let names: Vec<&str> = m.coordinates().iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["lift", "elbow", "finger_left"]);
    let elbow = m.coordinates()[1].limits;
    let acceleration = f64::INFINITY;
    let jerk = f64::INFINITY;
    let expected =
        Limits { lower: -2.0, upper: 1.5, velocity: 3.0, acceleration, jerk, effort: 20.0 };
    assert_eq!(elbow, expected);
    assert_eq!(m.frame_of(m.tool()).name, "hand");
    assert!(m.joints().iter().filter(|j| j.mimic.is_none()).all(|j| j.actuated));
    assert_eq!(m.report().format, "URDF");
}

#[test]
fn origins_fixed_joints_and_mimics_compose() {
    let m = read_urdf(ARM_URDF).unwrap();
    let (lift, elbow, finger) = (0.2, 0.6, 0.03);
    // Written out by hand: elbow about its x, which is the world's x.
    let world_from_fore = Pose {
        rotation: Rotation::about(Vec3::X, FRAC_PI_2 + elbow).unwrap(),
        translation: Vec3::new(0.4, 0.0, 0.1 + lift),
    };
    let fore_from_hand =
        Pose { rotation: Rotation::about_z(0.7), translation: Vec3::new(0.0, 0.3, 0.0) };
    let q = [lift, elbow, finger];
    assert_close(frame(&m, &q, "hand"), world_from_fore * fore_from_hand, 1e-15);
    let hand_from_left = Pose::from_translation(Vec3::new(0.0, finger, 0.05));
    let hand_from_right = Pose::from_translation(Vec3::new(0.0, -finger, 0.05));
    let world_from_hand = frame(&m, &q, "hand");
    assert_close(frame(&m, &q, "left"), world_from_hand * hand_from_left, 1e-15);
    assert_close(frame(&m, &q, "right"), world_from_hand * hand_from_right, 1e-15);
}

#[test]
fn every_joint_type_is_read() {
    let kinds = [
        ("revolute", JointKind::Revolute, 1),
        ("continuous", JointKind::Continuous, 1),
        ("prismatic", JointKind::Prismatic, 1),
        ("fixed", JointKind::Fixed, 0),
        ("floating", JointKind::Free, 6),
        ("planar", JointKind::Planar, 3),
    ];
    for (word, kind, dof) in kinds {
        let m = read_urdf(&one_joint(word, "<origin xyz='1 2 3' rpy='0.1 0.2 0.3'/>")).unwrap();
        assert_eq!((m.joints()[0].kind, m.n()), (kind, dof), "{word}");
        let rotation = Rpy { roll: 0.1, pitch: 0.2, yaw: 0.3 }.rotation();
        let origin = Pose { rotation, translation: Vec3::new(1.0, 2.0, 3.0) };
        assert_close(frame(&m, &vec![0.0; dof], "b"), origin, 1e-15);
    }
}

#[test]
fn the_axis_is_x_unless_given() {
    let m = read_urdf(&one_joint("revolute", "")).unwrap();
    assert_eq!(m.joints()[0].axis, Vec3::X);
    let m = read_urdf(&one_joint("revolute", "<axis xyz='0 3 4'/>")).unwrap();
    assert!((m.joints()[0].axis - Vec3::new(0.0, 0.6, 0.8)).norm() < 1e-15);
}

#[test]
fn rpy_turns_about_fixed_axes_in_this_order() {
    let text = one_joint("fixed", "<origin rpy='1.5707963267948966 0 1.5707963267948966'/>");
    let b = frame(&read_urdf(&text).unwrap(), &[], "b");
    // Roll takes y to z, then yaw takes x to y.
    assert!((b.rotation.x_axis() - Vec3::Y).norm() < 1e-15);
    assert!((b.rotation.y_axis() - Vec3::Z).norm() < 1e-15);
}

#[test]
fn a_quaternion_origin_is_read() {
    let text = one_joint("fixed", "<origin quat_xyzw='0 0 1 1'/>");
    let b = frame(&read_urdf(&text).unwrap(), &[], "b");
    assert!((b.rotation.x_axis() - Vec3::Y).norm() < 1e-15);
}

#[test]
fn mimics_chain() {
    let joint = |name: &str, parent: &str, child: &str, mimic: &str| {
        format!(
            "<joint name='{name}' type='prismatic'><parent link='{parent}'/>\
             <child link='{child}'/>{mimic}</joint>"
        )
    };
    let text = format!(
        "<robot name='r'>{}{}{}{}</robot>",
        "<link name='a'/><link name='b'/><link name='c'/><link name='d'/>",
        joint("third", "c", "d", "<mimic joint='second' multiplier='-1' offset='0.5'/>"),
        joint("first", "a", "b", ""),
        joint("second", "b", "c", "<mimic joint='first' multiplier='2' offset='0.25'/>"),
    );
    let m = read_urdf(&text).unwrap();
    assert_eq!(m.n(), 1);
    let x = 0.1;
    let second = 2.0 * x + 0.25;
    let expected = x + second + (0.5 - second);
    assert!((frame(&m, &[x], "d").translation.x - expected).abs() < 1e-15);
    // The slides of all three are the first one's coordinate.
    assert!(m.joints().iter().all(|j| j.coordinates == (0..1)));
}

#[test]
fn shapes_masses_and_colours_are_kept() {
    let m = read_urdf(ARM_URDF).unwrap();
    let visual = &m.links()[0].visuals[0];
    assert_eq!(visual.geometry, Geometry::Box { size: Vec3::new(0.2, 0.2, 0.1) });
    assert_eq!(visual.rgba, Some([0.5, 0.5, 0.6, 1.0]));
    let upper = &m.links()[1];
    assert_eq!(upper.collisions[0].name, "shell");
    assert_eq!(upper.collisions[0].geometry, Geometry::Cylinder { radius: 0.05, length: 0.4 });
    let inertial = upper.inertial.unwrap();
    assert_eq!(inertial.mass, 2.0);
    let rows = [[1.0, 0.1, 0.2], [0.1, 2.0, 0.3], [0.2, 0.3, 3.0]];
    assert_eq!(inertial.inertia.to_rows(), rows);
}

#[test]
fn the_report_says_once_what_was_not_used() {
    let m = read_urdf(ARM_URDF).unwrap();
    let text = report(&m);
    assert_eq!(text.lines().count(), 3, "{text}");
    assert!(text.contains("<axis> (flange): a fixed joint does not move"), "{text}");
    assert!(text.contains("<dynamics> (elbow): friction and damping"), "{text}");
    assert!(text.contains("<transmission> (2 times): "), "{text}");
    let first = ARM_URDF.lines().position(|l| l.contains("<transmission")).unwrap() + 1;
    assert_eq!(m.report().ignored.last().unwrap().line, first);
}

/// As Drake reads them, with and without the declaration of its prefix.
#[test]
fn universal_and_ball_joints_are_read() {
    for declaration in ["", " xmlns:drake='http://drake.mit.edu'"] {
        let m = read_urdf(&format!(
            "<robot name='r'{declaration}><link name='a'/><link name='b'/><link name='c'/>\
             <drake:joint name='u' type='universal'><parent link='a'/><child link='b'/></drake:joint>\
             <drake:joint name='s' type='ball'><parent link='b'/><child link='c'/></drake:joint>\
             <drake:declare_convex/></robot>"
        ))
        .unwrap();
        let kinds: Vec<JointKind> = m.joints().iter().map(|j| j.kind).collect();
        assert_eq!(kinds, [JointKind::Universal { second: Vec3::Y }, JointKind::Spherical]);
        assert_eq!(m.joints()[0].axis, Vec3::X);
        assert_eq!(m.report().ignored.len(), 1, "{}", report(&m));
    }
}

#[test]
fn a_joint_names_the_frame_that_it_moves() {
    let m = read_urdf(ARM_URDF).unwrap();
    let joint = &m.joints()[1];
    let child = m.frame(&m.links()[joint.child].name).unwrap();
    assert_eq!(m.frame(&joint.name).unwrap(), child);
}
