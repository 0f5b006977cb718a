//! SRDF on mechanisms: groups, states, end effectors.

use std::path::Path;

use cylindroid::model::formats::srdf::{self, Srdf};
use cylindroid::{Mechanism, ReferenceFrame};

use crate::robots;

fn read(text: &str) -> Srdf {
    srdf::parse(text, Path::new("robot.srdf")).unwrap()
}

fn of_panda(inner: &str) -> (Mechanism, Srdf) {
    let text = format!("<robot name=\"panda\">{inner}</robot>");
    (cylindroid::load("panda").unwrap(), read(&text))
}

/// The Panda of example-robot-data with its groups: the fingers are fixed where they are.
#[test]
fn the_arm_of_a_panda_moves_alone() {
    let folder = robots().join("panda_description");
    let robot = cylindroid::load_file(&folder.join("urdf/panda.urdf")).unwrap();
    let srdf = srdf::load(&folder.join("srdf/panda.srdf")).unwrap();
    let names: Vec<&str> = srdf.groups.iter().map(|g| g.name.as_str()).collect();
    assert_eq!(names, ["arm", "hand", "arm_and_hand"]);
    assert_eq!(srdf.joints_of("hand", &robot).unwrap(), ["panda_finger_joint1"]);
    assert_eq!(srdf.joints_of("arm_and_hand", &robot).unwrap().len(), 8);

    let q = srdf.configuration("default", &robot, robot.home()).unwrap();
    assert_eq!(srdf.configuration("arm_and_hand/default", &robot, robot.home()).unwrap(), q);
    assert_eq!((q[3], q[7]), (-2.35619, 0.001));
    let arm = srdf.group("arm", &robot, &q).unwrap();
    assert_eq!((arm.n(), arm.home()), (7, &q[..7]));
    assert_eq!(arm.frame_of(arm.tool()).name, "panda_hand_tcp");
    // Poses of all frames and columns of the Jacobian are those of the whole robot.
    let (own, whole) = (arm.state(arm.home()).unwrap(), robot.state(&q).unwrap());
    for (a, b) in arm.frame_ids().zip(robot.frame_ids()) {
        assert_eq!(arm.frame_of(a).name, robot.frame_of(b).name);
        let way = own.pose(a).unwrap().error_to(whole.pose(b).unwrap());
        assert!(way.linear.norm() + way.angular.norm() < 1e-14);
        let [j, k] = [
            own.jacobian(a, ReferenceFrame::Local).unwrap(),
            whole.jacobian(b, ReferenceFrame::Local).unwrap(),
        ];
        for column in 0..7 {
            for row in 0..6 {
                assert!((j[(row, column)] - k[(row, column)]).abs() < 1e-14);
            }
        }
    }
    let hand = srdf.group("hand", &robot, &q).unwrap();
    assert_eq!(hand.n(), 1);
}

/// Every SRDF of example-robot-data, on the robots of its folder: its groups move, or it names what
/// the robot does not have.
#[test]
fn groups_of_real_robots_move() {
    let mut checked = 0;
    for (folder, robot, file) in [
        ("panda_description", "urdf/panda.urdf", "srdf/panda.srdf"),
        ("ur_description", "urdf/ur5_robot.urdf", "srdf/ur5.srdf"),
        ("ur_description", "urdf/ur5_gripper.urdf", "srdf/ur5_gripper.srdf"),
        ("baxter_description", "urdf/baxter.urdf", "srdf/baxter_manipulation.srdf"),
        ("talos_data", "robots/talos_full_v2.urdf", "srdf/talos.srdf"),
        ("pr2_description", "urdf/pr2.urdf", "srdf/pr2.srdf"),
        ("xarm_description", "urdf/xarm7.urdf", "srdf/xarm7.srdf"),
        ("z1_description", "urdf/z1.urdf", "srdf/z1.srdf"),
        ("romeo_description", "urdf/romeo.urdf", "srdf/romeo_moveit.srdf"),
    ] {
        let folder = robots().join(folder);
        let robot = cylindroid::load_file(&folder.join(robot)).unwrap();
        let srdf = srdf::load(&folder.join(file)).unwrap();
        for group in &srdf.groups {
            let own = match srdf.joints_of(&group.name, &robot) {
                Ok(own) => own,
                Err(error) => {
                    let text = error.to_string();
                    assert!(
                        text.contains("no joint named") || text.contains("no frame named"),
                        "{text}"
                    );
                    continue;
                }
            };
            let reduced = srdf.group(&group.name, &robot, robot.home()).unwrap();
            let of_own = |name: &&str| robot.joints().iter().find(|j| j.name == **name).unwrap();
            let n: usize = own.iter().map(|name| of_own(name).coordinates.len()).sum();
            assert_eq!(reduced.n(), n, "{} of {file}", group.name);
            checked += 1;
        }
    }
    assert!(checked >= 25, "{checked}");
}

/// The tip of a group: of MoveIt's `parent_group`, of the group that carries the end effector, of its
/// chain.
#[test]
fn the_tool_is_the_tip_of_the_group() {
    let tool = |inner: &str, group: &str| {
        let (panda, srdf) = of_panda(inner);
        let reduced = srdf.group(group, &panda, panda.home()).unwrap();
        reduced.frame_of(reduced.tool()).name.clone()
    };
    let chain = r#"<group name="arm"><chain base_link="base" tip_link="link6"/></group>"#;
    assert_eq!(tool(chain, "arm"), "link6");
    let carried = r#"<group name="arm"><chain base_link="base" tip_link="flange"/></group>
        <group name="hand"><link name="flange"/></group>
        <end_effector name="grip" parent_link="link7" group="hand" parent_group="arm"/>"#;
    assert_eq!(tool(carried, "arm"), "link7");
    assert_eq!(tool(&carried.replace(" parent_group=\"arm\"", ""), "arm"), "link7");
    let lower = r#"<group name="lower"><joint name="panda_joint1"/><joint name="panda_joint2"/></group>
        <end_effector name="grip" parent_link="link7" group="hand"/>"#;
    assert_eq!(tool(lower, "lower"), "hand_tcp");
}

#[test]
fn groups_that_do_not_exist_are_refused() {
    let inner = r#"<group name="a"><group name="b"/></group><group name="b"><group name="a"/></group>
        <group name="c"><joint name="joint9"/></group>
        <group name="d"><chain base_link="link5" tip_link="link2"/></group>
        <group name="e"><joint name="panda_joint1"/></group>
        <group_state name="up" group="e"><joint name="panda_joint1" value="0 1"/></group_state>
        <group_state name="off" group="e"><joint name="joint12" value="1"/></group_state>"#;
    let (panda, srdf) = of_panda(inner);
    let refused = |group: &str| srdf.group(group, &panda, panda.home()).unwrap_err().to_string();
    assert!(refused("a").contains("contains itself"), "{}", refused("a"));
    assert!(refused("c").contains("no joint named 'joint9'"));
    assert!(refused("d").contains("'link5' does not carry"), "{}", refused("d"));
    assert!(refused("arm").contains("no group named 'arm'"));
    let state =
        |name: &str| srdf.configuration(name, &panda, panda.home()).unwrap_err().to_string();
    assert!(state("up").contains("joint 'panda_joint1' of state 'up'"), "{}", state("up"));
    assert!(state("off").contains("joint12") && state("ready").contains("no state named"));
    let broken = |text: &str| {
        let text = format!("<robot name=\"r\">{text}</robot>");
        srdf::parse(&text, Path::new("r.srdf")).unwrap_err().to_string()
    };
    assert!(broken("<group/>").contains("<group> has no name"));
    assert!(broken("<group name='a'><chain base_link='b'/></group>").contains("tip_link"));
    assert!(broken("<group_state name='a'><joint name='c'/></group_state>").contains("value"));
    let word = "<group_state name='a' group='b'><joint name='c' value='x'/></group_state>";
    assert!(broken(word).contains("'x' is not a number"));
    assert!(broken("<end_effector name='a' group='b'/>").contains("parent_link"));
}

#[test]
fn bytes_that_are_not_utf8_are_noted() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("panda.srdf");
    let bytes = b"<robot name='panda'>\n<group name='gr\xfcn'><joint name='panda_joint1'/></group>\n</robot>";
    std::fs::write(&path, bytes).unwrap();
    let srdf = srdf::load(&path).unwrap();
    assert_eq!(srdf.groups[0].name, "gr\u{fffd}n");
    let note = &srdf.report.ignored[0];
    assert_eq!((note.line, note.what.as_str()), (2, "bytes that are not UTF-8"));
    std::fs::write(&path, bytes.map(|b| if b == 0xfc { b'u' } else { b })).unwrap();
    assert!(srdf::load(&path).unwrap().report.ignored.is_empty());
}
