//! Default tools of real files, of small copies of others, and references at sites.

use std::path::Path;

use cylindroid::Mechanism;
use cylindroid::model::{JointKind, JointSpec, LoopJointSpec, ToolChoice, formats};

use crate::{read_toml, robots};

fn tool(m: &Mechanism) -> (&str, ToolChoice) {
    (&m.frame_of(m.tool()).name, m.tool_choice())
}

/// A chain of these links, each moved by a hinge, and branches on them.
fn chain(links: &[&str], branches: &[(&str, &str, JointKind)]) -> Mechanism {
    let mut b = Mechanism::builder("test");
    for pair in links.windows(2) {
        b.joint(JointSpec::new(&format!("to {}", pair[1]), JointKind::Revolute, pair[0], pair[1]));
    }
    for (parent, child, kind) in branches {
        b.joint(JointSpec::new(&format!("to {child}"), *kind, parent, child));
    }
    b.build().unwrap()
}

/// The last link of these files is a finger, an IMU or the rod of a linkage.
#[test]
fn tools_of_real_files_are_those_that_are_meant() {
    use ToolChoice::{LongestChain, Word};
    for (file, expected, why) in [
        ("pr2_description/urdf/pr2.urdf", "l_gripper_tool_frame", Word("tool")),
        ("xarm_description/urdf/xarm7.urdf", "link_eef", Word("eef")),
        ("kinova_description/robots/kinova.urdf", "j2s6s200_end_effector", Word("effector")),
        ("panda_description/urdf/panda.urdf", "panda_hand_tcp", Word("tcp")),
        ("ur_description/urdf/ur5_robot.urdf", "tool0", Word("tool")),
        ("baxter_description/urdf/baxter.urdf", "right_gripper", Word("gripper")),
        ("so_arm_description/urdf/so101.urdf", "gripper_frame_link", Word("gripper")),
        ("tiago_description/robots/tiago.urdf", "hand_grasping_frame", Word("grasping")),
        ("talos_data/robots/talos_full_v2.urdf", "gripper_right_base_link", Word("gripper")),
        ("z1_description/urdf/z1.urdf", "gripperStator", Word("gripper")),
        ("cassie_description/robots/cassie.sdf", "right-foot", Word("foot")),
        ("cassie_description/robots/cassie_reduced.sdf", "right-foot", Word("foot")),
        ("solo_description/robots/solo12.urdf", "HR_FOOT", Word("foot")),
        ("romeo_description/urdf/romeo_laas_small.urdf", "RArm_effector", Word("effector")),
        ("simple_humanoid_description/urdf/simple_humanoid.urdf", "r_wrist", LongestChain(10)),
        ("allegro_hand_description/urdf/allegro_left_hand.urdf", "link_15.0_tip", LongestChain(4)),
    ] {
        let m = cylindroid::load_file(&robots().join(file)).unwrap();
        assert_eq!(tool(&m), (expected, why), "{file}");
    }
}

/// xArm7 of MuJoCo Menagerie, without its meshes: the site of the tool beside fingers.
#[test]
fn a_site_is_preferred_to_the_last_body() {
    let links: String =
        (1..8).map(|i| format!("<body name='link{i}'><joint/><geom size='1'/>")).collect();
    let xarm7 = |inside: &str| {
        let ends = "</body>".repeat(7);
        format!("<mujoco model='xarm7'><worldbody>{links}{inside}{ends}</worldbody></mujoco>")
    };
    let hand = "<body name='xarm_gripper_base_link'>
        <site name='link_tcp' pos='0 0 .172'/>
        <body name='left_outer_knuckle'><joint/><geom size='1'/>
            <body name='left_finger'><joint/><geom size='1'/></body></body>
        <body name='right_outer_knuckle'><joint/><geom size='1'/>
            <body name='right_finger'><joint/><geom size='1'/></body></body></body>";
    for (inside, expected) in [
        (hand, ("link_tcp", ToolChoice::Word("tcp"))),
        ("<site name='attachment_site'/>", ("attachment_site", ToolChoice::Word("attachment"))),
        (
            "<site name='imu'/><site name='eye_in_hand_camera'/>",
            ("link7", ToolChoice::OnlyChain(7)),
        ),
    ] {
        let m = formats::mjcf::parse(&xarm7(inside), Path::new("xarm7.xml")).unwrap();
        assert_eq!(tool(&m), expected);
    }
}

/// Aloha of MuJoCo Menagerie in short: two arms, each with a site between its fingers.
#[test]
fn of_two_arms_it_is_a_gripper_and_no_finger() {
    let arm = |side: &str| {
        let links: String =
            (1..7).map(|i| format!("<body name='{side}/{i}'><joint/><geom size='1'/>")).collect();
        let fingers: String = ["left", "right"]
            .map(|f| format!("<body name='{side}/{f}_finger_link'><joint type='slide'/><geom size='1'/></body>"))
            .concat();
        format!(
            "{links}<body name='{side}/gripper_base'><site name='{side}/gripper'/>{fingers}</body>{}",
            "</body>".repeat(6)
        )
    };
    let text = format!(
        "<mujoco><worldbody>{}{}<body name='tool_box'><freejoint/><geom size='1'/></body>
         </worldbody></mujoco>",
        arm("left"),
        arm("right")
    );
    let m = formats::mjcf::parse(&text, Path::new("aloha.xml")).unwrap();
    assert_eq!(tool(&m), ("right/gripper", ToolChoice::Word("gripper")));
}

/// A leg of Cassie of MuJoCo Menagerie in short, on a floating pelvis: it is no thigh.
#[test]
fn a_floating_base_is_no_chain() {
    let leg = ["pelvis", "hip", "thigh", "knee", "shin", "tarsus", "foot"];
    let m = chain(
        &leg,
        &[
            ("world", "pelvis", JointKind::Free),
            ("thigh", "rod", JointKind::Spherical),
            ("pelvis", "imu", JointKind::Fixed),
        ],
    );
    assert_eq!(tool(&m), ("foot", ToolChoice::Word("foot")));
    let body = chain(&["world"], &[("world", "body", JointKind::Free)]);
    assert_eq!(tool(&body), ("body", ToolChoice::OnlyChain(1)));
}

#[test]
fn without_a_name_it_is_the_end_of_the_longest_chain() {
    use JointKind::{Fixed, Revolute};
    // A torso with a short and a long arm; a hand with fingers ends the long one.
    let arm = ["base", "torso", "a", "b", "c", "d"];
    let fingers = [("d", "e", Revolute), ("d", "f", Revolute)];
    let rest = [("torso", "x", Revolute), ("d", "cap", Fixed), ("cap", "wrist_camera", Fixed)];
    let m = chain(&arm, &[&fingers[..], &rest].concat());
    assert_eq!(tool(&m), ("cap", ToolChoice::LongestChain(5)));
    // Names of sensors, fingers and of parts near the root do not count.
    let m = chain(&["tool_rack", "hand_camera", "gripper", "b", "c", "d"], &[]);
    assert_eq!(tool(&m), ("d", ToolChoice::OnlyChain(5)));
    assert_eq!(m.tool_choice().to_string(), "end of the only chain, 5 joints");
    let m = chain(&["base", "a", "hand", "finger"], &[]);
    assert_eq!(tool(&m), ("hand", ToolChoice::Word("hand")));
    assert_eq!(m.tool_choice().to_string(), "its name contains 'hand'");
}

/// Names of axes, couplings and changers in the middle of an arm name no tool.
#[test]
fn beyond_a_tool_moves_nothing_but_a_gripper() {
    use JointKind::{Fixed, Revolute};
    for name in ["flange1", "tool_changer_axis", "tool0", "hand"] {
        let m = chain(&["base", "a", name, "b"], &[]);
        assert_eq!(tool(&m), ("b", ToolChoice::OnlyChain(3)), "{name}");
        let fixed = [("b", name, Fixed), ("b", "c", Revolute), ("c", "wrist_camera", Fixed)];
        let m = chain(&["base", "a", "b"], &fixed);
        assert_eq!(tool(&m), ("c", ToolChoice::OnlyChain(3)), "{name}");
        let m = chain(&["base", "a", name, "b", "ee"], &[]);
        assert_eq!(tool(&m), ("ee", ToolChoice::Word("ee")), "{name}");
        // Two branches as long as the arm before them are no hand.
        let arms = [(name, "b", Revolute), ("b", "c", Revolute), (name, "d", Revolute)];
        let m = chain(&["base", "a", name], &arms);
        assert_eq!(tool(&m).0, "c", "{name}");
        // Branches of a hand, one finger, toes and the motor of a gripper.
        let m = chain(&["base", "a", name], &[(name, "b", Revolute), (name, "c", Revolute)]);
        assert_eq!(tool(&m).0, name);
        for end in ["moving_jaw", "left_finger", "toe_claw_finger"] {
            let m = chain(&["base", "a", name, end], &[]);
            assert_eq!(tool(&m).0, name, "{end}");
        }
        for (joint, expected) in [("gripper_joint", name), ("gripper_roll", "gripper")] {
            let mut b = Mechanism::builder("test");
            b.joint(JointSpec::new("1", Revolute, "base", "a"));
            b.joint(JointSpec::new("2", Revolute, "a", name));
            b.joint(JointSpec::new(joint, Revolute, name, "gripper"));
            // A hand and a flange are less than a gripper.
            let less = !name.starts_with("tool");
            let expected = if less { "gripper" } else { expected };
            assert_eq!(tool(&b.build().unwrap()).0, expected, "{name} {joint}");
        }
    }
    let m = chain(&["base", "hip", "shin", "left_foot", "left_toe_roll"], &[]);
    assert_eq!(tool(&m), ("left_foot", ToolChoice::Word("foot")));
}

/// The tree of a closed chain continues beyond its tool.
#[test]
fn the_rest_of_a_loop_is_not_beyond_the_tool() {
    let closed = |a: &str, b: &str| {
        let mut builder = Mechanism::builder("test");
        for pair in ["base", "crank", "tool", "rocker", "rod"].windows(2) {
            builder.joint(JointSpec::new(pair[1], JointKind::Revolute, pair[0], pair[1]));
        }
        builder.loop_joint(LoopJointSpec::new("loop", JointKind::Revolute, a, b));
        builder.build().unwrap()
    };
    for (a, b) in [("rod", "base"), ("crank", "rocker")] {
        assert_eq!(tool(&closed(a, b)), ("tool", ToolChoice::Word("tool")));
    }
    // A loop beyond the frame.
    for (a, b) in [("tool", "rod"), ("rod", "rocker")] {
        assert_eq!(tool(&closed(a, b)), ("rod", ToolChoice::OnlyChain(4)));
    }
}

/// A frame of the file, or a site of a robot in it, is a reference as well as a link.
#[test]
fn a_reference_may_be_a_frame() {
    let text = "
        reference = \"tip\"
        [[joint]]
        name = \"q1\"
        type = \"revolute\"
        between = [\"ground\", \"a\"]
        origin = [0, 0, 0]
        axis = [0, 0, 1]
        [[frame]]
        name = \"tip\"
        link = \"a\"
        xyz = [1, 0, 0]
    ";
    let m = read_toml(text).unwrap();
    assert_eq!((m.reference(), tool(&m)), (m.tool(), ("tip", ToolChoice::Named)));
    assert_eq!(m.state(&[0.0]).unwrap().pose(m.reference()).unwrap().translation.x, 1.0);
    let both = text.replace("reference =", "reference_point = [0, 0, 1]\nreference =");
    let error = read_toml(&both).unwrap_err().to_string();
    assert!(error.contains("'tip' is a frame"), "{error}");
    let unknown = text.replace("reference = \"tip\"", "reference = \"tp\"");
    let error = read_toml(&unknown).unwrap_err().to_string();
    assert!(error.contains("nearest: tip"), "{error}");
    let m = read_toml("reference = \"arm/hand_tcp\"\n[[robot]]\nname = \"arm\"\nmodel = \"panda\"");
    assert_eq!(tool(&m.unwrap()).0, "arm/hand_tcp");
}
