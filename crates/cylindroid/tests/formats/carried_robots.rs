//! Robots of a mechanism file on links that its own joints move.

use cylindroid::Vec3;

use crate::read_toml;

const RAIL: &str = r#"
name = "cell"
reference = "arm/tool0"

[[joint]]
name = "rail"
type = "prismatic"
between = ["ground", "carriage"]
origin = [0.0, 0.0, 0.2]
axis = [1, 0, 0]
limits = { lower = -1, upper = 1 }
actuated = true

[[robot]]
name = "arm"
model = "ur5e"
link = "carriage"
base = { xyz = [0.0, 0.1, 0.3] }
"#;

#[test]
fn a_robot_on_a_carriage_moves_with_it() {
    let cell = read_toml(RAIL).unwrap();
    let alone = cylindroid::load("ur5e").unwrap();
    assert_eq!(cell.n(), 7);
    assert_eq!(cell.coordinates()[0].name, "rail");
    let mut q = vec![0.4];
    q.extend(alone.home());
    let there = cell.state(&q).unwrap().pose(cell.frame("arm/tool0").unwrap()).unwrap();
    let here = alone.state(alone.home()).unwrap().pose(alone.frame("tool0").unwrap()).unwrap();
    let carried = here.translation + Vec3::new(0.4, 0.1, 0.5);
    assert!((there.translation - carried).norm() < 1e-14, "{there:?}");
    assert!((there.rotation.log() - here.rotation.log()).norm() < 1e-14);
}

/// A second robot on a link of the first, a loop among the own joints, and a joint to a robot that
/// comes later.
#[test]
fn other_joints_keep_their_places() {
    let text = format!(
        r#"{RAIL}
[[robot]]
name = "hand"
model = "ur5e"
link = "arm/link6"

[[joint]]
name = "brace"
type = "spherical"
between = ["carriage", "hand/link4"]
origin = [0.0, 0.0, 1.0]

[[joint]]
name = "second rail"
type = "prismatic"
between = ["ground", "carriage"]
axis = [1, 0, 0]
"#
    );
    let cell = read_toml(&text).unwrap();
    assert_eq!(cell.n(), 13);
    let mut loops: Vec<&str> = cell.loops().iter().map(|l| l.name.as_str()).collect();
    loops.sort_unstable();
    assert_eq!(loops, ["brace", "second rail"]);
}

#[test]
fn a_link_of_no_joint_is_unknown() {
    let error = read_toml(&RAIL.replace("link = \"carriage\"", "link = \"carrige\"")).unwrap_err();
    let message = error.to_string();
    assert!(message.contains("no link named 'carrige'"), "{message}");
}
