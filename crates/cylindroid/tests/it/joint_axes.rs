//! Where joints and contacts stand in the world.

use cylindroid::model::JointKind;
use cylindroid::spatial::{Rotation, Twist, Vec3};
use cylindroid::{Matrix, catalogue};

use crate::kinematics::robots;
use crate::support::{Random, assert_close};

/// Where a joint moves its child, its twist is that of its axis: from the child's side as from the
/// parent's, also behind frames of their own and for joints that are written backwards.
#[test]
fn joint_axes_are_those_of_the_joint_twists() {
    let mut random = Random(38);
    let mut seen = 0;
    for robot in robots() {
        let state = robot.state(&random.q(&robot)).unwrap();
        let mut twists = Matrix::zeros(6, robot.n());
        state.joint_twists_into(&mut twists).unwrap();
        for (joint, axis) in robot.joints().iter().zip(state.joint_axes()) {
            let sides = [axis.on_parent, axis.on_child];
            let single = joint.mimic.is_none() && joint.coordinates.len() == 1;
            for line in sides.into_iter().filter(|_| single) {
                assert!((line.direction.norm() - 1.0).abs() < 1e-14);
                let column: [f64; 6] = twists.column(joint.coordinates.start).try_into().unwrap();
                let twist = Twist::from_array(column);
                let expected = match joint.kind {
                    JointKind::Revolute => line.twist(),
                    JointKind::Prismatic => Twist { linear: line.direction, angular: Vec3::ZERO },
                    _ => continue,
                };
                assert_close(&joint.name, &twist.to_array(), &expected.to_array(), 1e-12);
                seen += 1;
            }
        }
    }
    assert!(seen > 100, "{seen}");
}

/// Loop joints stand where the file puts them; on both links where the loop is closed.
#[test]
fn joint_axes_of_loops() {
    let expected = [("five-bar", [2.0, 0.0, 0.0]), ("four-bar", [2.0, 0.0, 0.0])];
    for (name, point) in expected {
        let robot = catalogue::load(name).unwrap();
        let axes = robot.state(robot.home()).unwrap().loop_joint_axes();
        assert_eq!(axes.len(), 1);
        for line in [axes[0].on_parent, axes[0].on_child] {
            let line_point = line.point.to_array();
            assert_close(name, &line_point, &point, 1e-12);
            assert_eq!(line.direction, Vec3::Z);
        }
    }
}

/// The points of a contact are the origins of its frame on both links: where the file puts them at
/// home, apart by what an arm moves away from the object.
#[test]
fn contact_points_are_on_both_links() {
    let arms = catalogue::load("two-arm").unwrap();
    let home = arms.state(arms.home()).unwrap().contact_points();
    let expected = [
        [0.6493270295546051, 0.08286898348524677, 0.4299287984986484],
        [0.6303848612170696, 0.10087677428332403, 0.44362934996003023],
    ];
    assert_eq!(home.len(), 2);
    for (points, expected) in home.iter().zip(expected) {
        for point in points {
            assert_close("two-arm", &point.to_array(), &expected, 1e-12);
        }
    }
    let mut q = arms.home().to_vec();
    q[0] += 0.3;
    let moved = arms.state(&q).unwrap().contact_points();
    let turned = Rotation::about_z(0.3) * home[0][0];
    assert_close("left arm", &moved[0][0].to_array(), &turned.to_array(), 1e-12);
    assert_close("box", &moved[0][1].to_array(), &expected[0], 1e-12);
    assert!(
        catalogue::load("panda").unwrap().state(&[0.0; 7]).unwrap().contact_points().is_empty()
    );
}
