//! Mechanisms with some joints fixed.

use cylindroid::closure::{ClosedChain, Mobility, assemble};
use cylindroid::{Mechanism, ReferenceFrame};

use crate::support::Random;

/// Poses of all frames agree.
fn assert_alike(full: &Mechanism, q: &[f64], reduced: &Mechanism, p: &[f64], place: &str) {
    let (full_state, own) = (full.state(q).unwrap(), reduced.state(p).unwrap());
    for frame in full.frames() {
        let pose =
            |m: &Mechanism, s: &cylindroid::State| s.pose(m.frame(&frame.name).unwrap()).unwrap();
        let way = pose(full, &full_state).error_to(pose(reduced, &own));
        let (linear, angular) = (way.linear.norm(), way.angular.norm());
        assert!(linear + angular < 1e-12 * (1.0 + full.reach()), "{place} {}", frame.name);
    }
}

/// Whatever joint of a robot is fixed wherever, the others move the frames as before.
#[test]
fn the_other_joints_move_frames_as_before() {
    let mut random = Random(7);
    for model in ["panda", "ur5e", "youbot", "puma560", "3r"] {
        let robot = cylindroid::load(model).unwrap();
        for joint in robot.joints().iter().filter(|j| j.mimic.is_none() && j.kind.dof() > 0) {
            let q: Vec<f64> = (0..robot.n()).map(|_| random.within(-1.0, 1.0)).collect();
            let reduced = robot.with_fixed_joints(&[&joint.name], &q).unwrap();
            let keep: Vec<usize> =
                (0..robot.n()).filter(|i| !joint.coordinates.contains(i)).collect();
            let p: Vec<f64> = keep.iter().map(|&i| q[i]).collect();
            assert_eq!(reduced.home(), p);
            let place = format!("{model} without {}", joint.name);
            assert_alike(&robot, &q, &reduced, &p, &place);
            let names: Vec<&str> = reduced.coordinates().iter().map(|c| c.name.as_str()).collect();
            let expected: Vec<&str> =
                keep.iter().map(|&i| robot.coordinates()[i].name.as_str()).collect();
            assert_eq!(names, expected, "{place}");
            let tool = |m: &Mechanism| m.frame_of(m.tool()).name.clone();
            assert_eq!(tool(&reduced), tool(&robot));
            // Elsewhere too, and the Jacobian has the same columns.
            let mut other = q.clone();
            keep.iter().for_each(|&i| other[i] = random.within(-1.0, 1.0));
            let p: Vec<f64> = keep.iter().map(|&i| other[i]).collect();
            assert_alike(&robot, &other, &reduced, &p, &place);
            let jacobian = |m: &Mechanism, q: &[f64]| {
                m.state(q).unwrap().jacobian(m.tool(), ReferenceFrame::LocalWorldAligned).unwrap()
            };
            let (own, full) = (jacobian(&reduced, &p), jacobian(&robot, &other));
            for (column, &i) in keep.iter().enumerate() {
                for row in 0..6 {
                    assert!((own[(row, column)] - full[(row, i)]).abs() < 1e-12, "{place}");
                }
            }
        }
    }
}

/// A joint of every kind, written from either end.
#[test]
fn joints_of_every_kind_can_be_fixed() {
    let mut random = Random(8);
    let kinds = [
        ("revolute", ""),
        ("prismatic", ""),
        ("helical", "pitch = 0.1"),
        ("cylindrical", ""),
        ("universal", "axis2 = [1, 0, 0.5]"),
        ("spherical", ""),
        ("planar", ""),
        ("free", ""),
    ];
    for (kind, more) in kinds {
        for between in ["[\"ground\", \"a\"]", "[\"a\", \"ground\"]"] {
            let axis =
                if matches!(kind, "spherical" | "free") { "" } else { "axis = [0, 0.6, 0.8]" };
            let text = format!(
                "name = \"m\"\n[[joint]]\nname = \"q1\"\ntype = \"{kind}\"\nbetween = {between}\n\
                 origin = [0.1, 0.2, 0.3]\n{axis}\n{more}\n[[joint]]\nname = \"q2\"\n\
                 type = \"revolute\"\nbetween = [\"a\", \"b\"]\norigin = [0.5, 0, 0.3]\naxis = [1, 0, 0]\n"
            );
            let robot = cylindroid::load_text(&text, "m.toml".as_ref()).unwrap();
            let q: Vec<f64> = (0..robot.n()).map(|_| random.within(-1.0, 1.0)).collect();
            let reduced = robot.with_fixed_joints(&["q1"], &q).unwrap();
            assert_alike(&robot, &q, &reduced, &q[q.len() - 1..], kind);
        }
    }
}

/// A five-bar with one crank fixed has one degree of freedom less, and its loop stays closed.
#[test]
fn a_drive_of_a_closed_chain_can_be_fixed() {
    let five_bar = cylindroid::load("five-bar").unwrap();
    let mobility = |m: &Mechanism, q: &[f64]| {
        let state = m.state(q).unwrap();
        let chain = ClosedChain::of(&state, None, None).unwrap();
        Mobility::of(&chain.constraint).dof.dimension()
    };
    let mut q = five_bar.home().to_vec();
    q[0] += 0.3;
    let q = assemble(&five_bar, &q, &[0]).unwrap().q;
    let fixed = five_bar.with_fixed_joints(&["q1"], &q).unwrap();
    assert_eq!(fixed.n(), five_bar.n() - 1);
    assert_eq!(mobility(&fixed, fixed.home()) + 1, mobility(&five_bar, &q));
    assert_alike(&five_bar, &q, &fixed, fixed.home(), "five-bar");
    let refused = |name: &str| five_bar.with_fixed_joints(&[name], &q).unwrap_err().to_string();
    assert!(refused("q5").contains("closes a loop"));
    assert!(refused("q9").contains("no joint named 'q9'"));
    assert!(five_bar.with_fixed_joints(&["q1"], &q[1..]).is_err());
}

/// Joints that follow a fixed joint are fixed with it.
#[test]
fn followers_are_fixed_with_their_leader() {
    let text = r#"<robot name="gripper"><link name="base"/><link name="a"/><link name="b"/><link name="c"/>
        <joint name="left" type="prismatic"><parent link="base"/><child link="a"/><axis xyz="0 1 0"/>
            <limit lower="0" upper="0.1" velocity="1" effort="1"/></joint>
        <joint name="right" type="prismatic"><parent link="base"/><child link="b"/><axis xyz="0 -1 0"/>
            <limit lower="-1" upper="1" velocity="1" effort="1"/>
            <mimic joint="left" multiplier="2" offset="0.01"/></joint>
        <joint name="turn" type="continuous"><parent link="b"/><child link="c"/></joint></robot>"#;
    let path = std::path::Path::new("gripper.urdf");
    let robot = cylindroid::model::formats::urdf::parse(text, path).unwrap();
    let reduced = robot.with_fixed_joints(&["left"], &[0.05, 0.4]).unwrap();
    assert_eq!((reduced.n(), reduced.home()), (1, &[0.4][..]));
    assert_alike(&robot, &[0.05, 1.0], &reduced, &[1.0], "gripper");
    let error = robot.with_fixed_joints(&["right"], &[0.0, 0.0]).unwrap_err().to_string();
    assert!(error.contains("it follows 'left'"), "{error}");
}
