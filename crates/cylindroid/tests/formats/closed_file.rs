//! Mechanism files with loops, contacts, objects and robots of other files.

use std::collections::BTreeSet;
use std::fs;

use cylindroid::closure::ClosedChain;
use cylindroid::model::{ContactKind, Dimension, JointKind};
use cylindroid::{Mechanism, Pose, Rotation, Vec3};

use crate::fk::{assert_close, closed_at_home, frame};
use crate::mechanism_file::{check, joint};
use crate::{pointed_at, read_toml, refused};

/// Loop joint and contacts coincide at home on both of their links.
#[track_caller]
fn read(text: &str) -> Mechanism {
    let m = read_toml(text).unwrap();
    closed_at_home(&m, 1e-12);
    m
}

fn bar(name: &str, between: [&str; 2], origin: [f64; 2], actuated: bool) -> String {
    joint(name, "revolute", between, &format!("origin = {origin:?}\nactuated = {actuated}"))
}

/// Five bars, actuated where `actuated` says.
fn five_bar(actuated: [bool; 5]) -> String {
    let links = ["ground", "a", "b", "c", "d", "ground"];
    let origins = [[0.0, 0.0], [0.0, 2.0], [1.0, 2.0], [2.0, 1.0], [2.0, 0.0]];
    let joints = (0..5).map(|i| {
        let name = format!("q{}", i + 1);
        bar(&name, [links[i], links[i + 1]], origins[i], actuated[i])
    });
    format!("dimension = 2\nreference = \"b\"\n{}", joints.collect::<String>())
}

fn names<'m>(joints: impl Iterator<Item = &'m String>) -> Vec<&'m str> {
    joints.map(String::as_str).collect()
}

#[test]
fn a_joint_between_connected_links_closes_a_loop() {
    let m = read(&five_bar([true, true, false, false, false]));
    assert_eq!(names(m.joints().iter().map(|j| &j.name)), ["q1", "q2", "q3", "q4"]);
    let q5 = &m.loops()[0];
    assert_eq!((q5.name.as_str(), q5.kind, q5.actuated), ("q5", JointKind::Revolute, false));
    assert_eq!([q5.a, q5.b].map(|i| m.links()[i].name.as_str()), ["d", "ground"]);
    // The frame of d is at q4; q5 is 1 m below it.
    assert_close(q5.link_a_from_joint, Pose::from_translation(-Vec3::Y), 1e-15);
    assert_close(q5.link_b_from_joint, Pose::from_translation(Vec3::X * 2.0), 1e-15);
    assert_eq!(m.dimension(), Dimension::Planar);
    // Without a point the reference is taken at the link's first joint.
    assert_eq!(m.frame_of(m.reference()).name, "b");
    assert_eq!(frame(&m, m.home(), "b").translation, Vec3::Y * 2.0);
}

#[test]
fn the_reference_point_is_the_joint_of_the_link_whose_name_comes_first() {
    // Not q2, which leads to ground.
    let text = format!(
        "dimension = 2\nreference = \"b\"\n{}{}{}",
        bar("q2", ["a", "b"], [0.0, 2.0], false),
        bar("p3", ["b", "c"], [1.0, 2.0], false),
        bar("q1", ["ground", "a"], [0.0, 0.0], true)
    );
    let m = read(&text);
    let reference = m.frame_of(m.reference());
    assert_eq!(
        (reference.name.as_str(), m.links()[reference.link].name.as_str()),
        ("reference", "b")
    );
    assert_eq!(frame(&m, m.home(), "reference").translation, Vec3::new(1.0, 2.0, 0.0));
}

/// As many actuated joints as possible are in the tree; the rest goes by name. All of them have
/// coordinates: where all are actuated, the loop is cut in a link.
#[test]
fn spanning_trees_contain_the_actuated_joints() {
    for bits in 0..32_u32 {
        let actuated: [bool; 5] = std::array::from_fn(|i| bits >> i & 1 == 1);
        let m = read(&five_bar(actuated));
        let count = actuated.iter().filter(|d| **d).count();
        assert_eq!((m.n(), m.loops().len()), (count.max(4), 1));
        assert_eq!(m.actuated().count(), count, "{actuated:?}");
        let closing = match (0..5).rev().find(|&i| !actuated[i]) {
            Some(i) => format!("q{}", i + 1),
            None => "ground.q5.weld".to_owned(),
        };
        assert_eq!(m.loops()[0].name, closing, "{actuated:?}");
        assert!(!m.loops()[0].actuated);
    }
}

#[test]
fn spanning_trees_hold_mimic_joints_and_whom_they_follow() {
    let text = five_bar([true, true, true, false, false]).replace(
        "origin = [2.0, 0.0]\nactuated = false",
        "origin = [2.0, 0.0]\nmimic = { joint = \"q4\" }",
    );
    let m = read(&text);
    // q4, which q5 follows, and the actuated ones; the loop is cut behind q3.
    assert_eq!(m.loops()[0].name, "c.q3.weld");
    assert_eq!(m.n(), 4);
}

#[test]
fn several_loops_and_all_spatial_kinds_close() {
    let place = "origin = [1, 0.5, 0.25]\n";
    let axis = format!("{place}axis = [0, 1, 1]\n");
    let kinds = [
        ("revolute", axis.clone()),
        ("continuous", axis.clone()),
        ("prismatic", axis.clone()),
        ("helical", format!("{axis}pitch = 0.1\n")),
        ("cylindrical", axis.clone()),
        ("planar", axis.clone()),
        ("universal", format!("{axis}axis2 = [1, 0, 0]\n")),
        ("spherical", place.to_owned()),
        ("fixed", String::new()),
        ("free", String::new()),
    ];
    let place = "origin = [0, 0, 0]\naxis = [0, 0, 1]\nactuated = true";
    let tree = joint("q", "revolute", ["ground", "arm"], place);
    let closing: String = kinds
        .iter()
        .enumerate()
        .map(|(i, (kind, rest))| joint(&format!("l{i}"), kind, ["arm", "ground"], rest))
        .collect();
    let m = read(&format!("{tree}{closing}"));
    let words: Vec<&str> = m.loops().iter().map(|l| l.kind.name()).collect();
    assert_eq!(words, kinds.map(|k| k.0));
    assert!(m.loops().iter().all(|l| (l.axis.norm() - 1.0).abs() < 1e-15));
}

pub(crate) const FINGERS: &str = "\
dimension = 2
reference = \"box\"
reference_point = [0.5, 1]
[[joint]]
name = \"left\"
type = \"revolute\"
between = [\"ground\", \"l\"]
origin = [0, 0]
actuated = true
[[joint]]
name = \"right\"
type = \"revolute\"
between = [\"ground\", \"r\"]
origin = [1, 0]
actuated = true
[[contact]]
name = \"cl\"
type = \"hard_finger\"
between = [\"l\", \"box\"]
point = [0, 1]
normal = [1, 0]
friction = 0.6
[[contact]]
name = \"cr\"
type = \"point_frictionless\"
between = [\"r\", \"box\"]
point = [1, 1]
normal = [-1, 0]
";

/// An object that only contacts hold is a free body, placed at the reference point.
#[test]
fn contacts_hold_objects() {
    let m = read(FINGERS);
    assert_eq!(m.contacts().len(), 2);
    let c = &m.contacts()[0];
    assert_eq!((c.name.as_str(), c.kind, c.friction), ("cl", ContactKind::HardFinger, Some(0.6)));
    assert_eq!([c.a, c.b].map(|i| m.links()[i].name.as_str()), ["l", "box"]);
    let object = m.joints().iter().find(|j| j.name == "box").unwrap();
    assert_eq!(m.coordinates().last().unwrap().name, "box.angle", "objects come last");
    assert_eq!((object.kind, object.actuated), (JointKind::Planar, false));
    assert_eq!(frame(&m, m.home(), "box").translation, Vec3::new(0.5, 1.0, 0.0));
    // The normal is z, the tangent lies in the plane, (tangent, normal) is right-handed there.
    let axes = c.link_a_from_contact.rotation;
    assert_eq!((axes.z_axis(), axes.x_axis()), (Vec3::X, -Vec3::Y));
    assert_eq!(m.contacts()[1].friction, None);

    let spatial = FINGERS
        .replace("dimension = 2\n", "")
        .replace("[0, 0]", "[0, 0, 0]\naxis = [0, 0, 1]")
        .replace("[1, 0]\na", "[1, 0, 0]\naxis = [0, 0, 1]\na")
        .replace("[0.5, 1]", "[0.5, 1, 0]")
        .replace("[0, 1]\n", "[0, 1, 0]\n")
        .replace("[1, 1]\n", "[1, 1, 0]\n")
        .replace("[1, 0]\nf", "[1, 0, 0]\nf")
        .replace("[-1, 0]\n", "[-1, 0, 0]\n");
    let m = read(&spatial);
    assert_eq!(m.joints().iter().find(|j| j.name == "box").unwrap().kind, JointKind::Free);
    assert_eq!(m.n(), 8);
}

#[test]
fn contacts_between_objects_and_with_jointed_objects() {
    // A second box on the first, a lid hinged to it: two free bodies, one hinge.
    let text = format!(
        "{FINGERS}{}[[contact]]\nname = \"stack\"\ntype = \"complete\"\nbetween = [\"box\", \"top\"]\npoint = [0.5, 2]\n",
        bar("hinge", ["top", "lid"], [0.6, 2.5], false)
    );
    let m = read(&text);
    let free: BTreeSet<&str> = m
        .joints()
        .iter()
        .filter(|j| j.kind == JointKind::Planar)
        .map(|j| j.name.as_str())
        .collect();
    assert_eq!(free, BTreeSet::from(["box", "top"]));
    assert_eq!(m.n(), 2 + 3 + 3 + 1);
}

#[test]
fn contacts_of_all_kinds_are_read() {
    for kind in ContactKind::ALL {
        let text = format!(
            "{}[[contact]]\nname = \"c\"\ntype = \"{}\"\nbetween = [\"arm\", \"box\"]\n\
             point = [1, 0, 0]\nnormal = [0, 0, 2]\ntangent = [0, 3, 1]\n",
            joint("q", "revolute", ["ground", "arm"], "origin = [0, 0, 0]\naxis = [0, 0, 1]"),
            kind.name()
        );
        let m = read(&text);
        let contact = &m.contacts()[0];
        assert_eq!(contact.kind, kind);
        let axes = contact.link_b_from_contact.rotation;
        assert_eq!((axes.x_axis(), axes.y_axis(), axes.z_axis()), (Vec3::Y, -Vec3::X, Vec3::Z));
        let bare = text.replace("normal = [0, 0, 2]\n", "").replace("tangent = [0, 3, 1]\n", "");
        let firm = matches!(kind, ContactKind::HardFinger | ContactKind::Complete);
        assert_eq!(read_toml(&bare).is_ok(), firm, "{kind:?}");
    }
}

#[test]
fn contacts_that_cannot_be_are_pointed_at() {
    check(
        &FINGERS.replace("[\"l\", \"box\"]", "[\"ll\", \"box\"]"),
        "[\"ll\"",
        "no link named 'll'",
    );
    check(&FINGERS.replace("[\"l\", \"box\"]", "[\"box\", \"box\"]"), "[\"box\"", "with itself");
    check(&FINGERS.replace("hard_finger", "hard_fingr"), "\"hard_fingr\"", "nearest: hard_finger");
    check(&FINGERS.replace("point = [0, 1]\n", ""), "[[contact]]", "has no point");
    check(&FINGERS.replace("normal = [-1, 0]\n", ""), "[[contact]]", "has no normal");
    check(&FINGERS.replace("normal = [-1, 0]", "normal = [0, 0]"), "[0, 0]", "no direction");
    check(
        &FINGERS.replace("[1, 0]\nf", "[1, 0]\ntangent = [2, 0]\nf"),
        "[2, 0]",
        "along the normal",
    );
    check(
        &FINGERS.replace("friction = 0.6", "friction = -1"),
        "\"cl\"",
        "friction of contact 'cl'",
    );
    check(&FINGERS.replace("hard_finger", "plane_frictionless"), "\"cl\"", "line_frictionless");
    check(&FINGERS.replace("\"cr\"", "\"left\""), "\"left\"", "named 'left'");
    let missing = FINGERS.replace("reference = \"box\"", "reference = \"bx\"");
    check(&missing, "\"bx\"", "no link or frame named 'bx'; nearest: box");
}

#[test]
fn what_cannot_close_is_pointed_at() {
    let mimic = five_bar([true; 5]).replace(
        "origin = [2.0, 0.0]\nactuated = true",
        "origin = [2.0, 0.0]\nmimic = { joint = \"q1\" }",
    );
    assert!(read_toml(&mimic).is_ok(), "another joint closes the loop");
    let both = "[[joint]]\nname = \"p\"\ntype = \"prismatic\"\nbetween = [\"ground\", \"a\"]\naxis = [1, 0, 0]\n";
    let text = format!("{both}{}mimic = {{ joint = \"p\" }}\n", both.replace("\"p\"", "\"m\""));
    check(&text, "{ joint", "cannot follow another joint");
    let twice = five_bar([false; 5]).replace("\"q5\"", "\"q1\"");
    let error = refused(&twice, read_toml(&twice));
    assert_eq!(pointed_at(&twice, &error), "\"q1\"");
    assert!(error.message.contains("named 'q1'"), "{error}");
}

fn robot(rest: &str) -> String {
    format!("[[robot]]\n{rest}\n")
}

#[test]
fn robots_start_where_they_are_told() {
    let text = robot(
        "name = \"left\"\nmodel = \"ur5e\"\nbase = { xyz = [1, 0, 0.5], rpy = [0, 0, 1.5] }\n\
         start = { elbow_joint = 0.3, wrist_1_joint = 0.1 }",
    ) + &robot(
        "name = \"right\"\nmodel = \"3r\"\nstart = [0.1, 0.2, 0.3]\nlink = \"left/flange\"",
    );
    let m = read(&text);
    assert_eq!(m.n(), 9);
    let alone = cylindroid::load("ur5e").unwrap();
    let mut q = alone.home().to_vec();
    (q[2], q[3]) = (0.3, 0.1);
    let base = Pose { rotation: Rotation::about_z(1.5), translation: Vec3::new(1.0, 0.0, 0.5) };
    let tool = base * frame(&alone, &q, "tool0");
    assert_close(frame(&m, m.home(), "left/tool0"), tool, 1e-14);
    let other = cylindroid::load("3r").unwrap();
    let flange = tool * frame(&other, &[0.1, 0.2, 0.3], "flange");
    assert_close(frame(&m, m.home(), "right/flange"), flange, 1e-14);
    assert_eq!(m.actuated().count(), 9);
    let limits = |m: &Mechanism, i: usize| m.coordinates()[i].limits;
    assert_eq!(limits(&m, 2), limits(&alone, 2));
}

#[test]
fn robots_hold_an_object_and_take_joints_at_home() {
    let text = "reference = \"box\"\nreference_point = [0.5, 0, 0.6]\n".to_owned()
        + &robot("name = \"l\"\nmodel = \"panda\"")
        + &robot(
            "name = \"r\"\nmodel = \"panda\"\nbase = { xyz = [1, 0, 0], rpy = [0, 0, 3.141592653589793] }",
        )
        + "[[contact]]\nname = \"a\"\ntype = \"complete\"\nbetween = [\"l/flange\", \"box\"]\npoint = [0.4, 0, 0.6]\n"
        + "[[contact]]\nname = \"b\"\ntype = \"soft_finger\"\nbetween = [\"r/flange\", \"box\"]\npoint = [0.6, 0, 0.6]\nnormal = [-1, 0, 0]\n"
        + &joint("rod", "spherical", ["l/link4", "bar"], "origin = [0.1, 0.1, 0.5]")
        + &joint("end", "spherical", ["bar", "ground"], "origin = [0.1, 0.4, 0]");
    let m = read(&text);
    assert_eq!((m.n(), m.loops().len(), m.contacts().len()), (7 + 7 + 6 + 3, 1, 2));
    let bar = frame(&m, m.home(), "bar");
    // Both joints of the bar are alike: end, the first by name, is in the tree.
    assert_eq!(m.loops()[0].name, "rod");
    assert_close(bar, Pose::from_translation(Vec3::new(0.1, 0.4, 0.0)), 1e-14);
}

/// A robot without a name keeps its names: a URDF gets passive joints, loops and contacts.
#[test]
fn robots_of_files_and_their_passive_joints() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("arm.urdf"), crate::ARM_URDF).unwrap();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        fs::write(&path, text).unwrap();
        cylindroid::load(&path.to_string_lossy())
    };
    let alone = cylindroid::load(&folder.path().join("arm.urdf").to_string_lossy()).unwrap();
    let first = alone.coordinates()[0].name.clone();
    let text = robot(&format!("model = \"arm.urdf\"\npassive = [\"{first}\"]"))
        + &joint("brace", "spherical", ["hand", "ground"], "origin = [0.1, 0, 0]");
    let m = write("closed.toml", &text).unwrap();
    closed_at_home(&m, 1e-12);
    assert_eq!((m.n(), m.loops()[0].name.as_str()), (alone.n(), "brace"));
    assert!(!m.coordinates()[0].actuated);
    assert_eq!(m.actuated().count(), alone.actuated().count() - 1);
    let only = text.replace("passive", "actuated");
    let m = write("only.toml", &only).unwrap();
    assert_eq!(m.actuated().collect::<Vec<_>>(), [0]);
    // What the URDF's loader ignored is still reported.
    assert_eq!(m.report().ignored.len(), alone.report().ignored.len());
    // A mechanism file inside another, loops and all.
    let nested = robot("name = \"cell\"\nmodel = \"closed.toml\"");
    let m = write("nested.toml", &nested).unwrap();
    assert_eq!(m.loops()[0].name, "cell/brace");
    closed_at_home(&m, 1e-12);
    // A ring of files is answered.
    let error = write("ring.toml", &robot("name = \"r\"\nmodel = \"ring.toml\"")).unwrap_err();
    assert!(error.to_string().contains("included by 8 files"), "{error}");
    let broken = write("broken.toml", "[[robot]]\nmodel = \"no.urdf\"").unwrap_err();
    assert!(broken.to_string().contains("broken.toml:2:9: cannot read"), "{broken}");
}

/// Masses stand in world axes at home; links keep their order and the rest of the file its meaning.
#[test]
fn links_have_masses() {
    let plain = five_bar([true, true, false, false, false]);
    let mass = "[[link]]\nname = \"c\"\nmass = 2\ncenter = [1.5, 1.5]\ninertia = 0.3\n";
    let m = read(&format!("{plain}{mass}"));
    let root = m.links().iter().position(|l| l.name == "ground").unwrap();
    assert!(m.joints().iter().all(|j| j.child != root));
    let link = m.links().iter().find(|l| l.name == "c").unwrap();
    let inertial = link.inertial.unwrap();
    // The frame of c is at q3, (1, 2).
    let center = Pose::from_translation(Vec3::new(0.5, -0.5, 0.0));
    assert_close(inertial.link_from_inertia, center, 1e-15);
    assert_eq!((inertial.mass, inertial.inertia.cols[2].z), (2.0, 0.3));
    assert!(m.links().iter().filter(|l| l.name != "c").all(|l| l.inertial.is_none()));
    let spatial = "[[joint]]\nname = \"q\"\ntype = \"revolute\"\nbetween = [\"ground\", \"a\"]\n\
                   origin = [0, 0, 1]\naxis = [0, 0, 1]\n[[link]]\nname = \"a\"\nmass = 1\n\
                   center = [1, 0, 1]\ninertia = [1, 2, 3, 0.1, 0.2, 0.3]\n";
    let m = read(spatial);
    let inertial = m.links().iter().find(|l| l.name == "a").unwrap().inertial.unwrap();
    let rows = [[1.0, 0.1, 0.2], [0.1, 2.0, 0.3], [0.2, 0.3, 3.0]];
    assert_eq!(inertial.inertia.to_rows(), rows);
    for (text, at, message) in [
        (mass.replace("\"c\"", "\"z\""), "\"z\"", "no link named 'z'"),
        (mass.replace("mass = 2", "mass = -2"), "-2", "mass = -2"),
        (mass.replace("mass = 2\n", ""), "[[link]]", "no mass"),
        (mass.replace("center = [1.5, 1.5]\n", ""), "[[link]]", "no center"),
        (mass.replace("0.3", "-0.3"), "-0.3", "negative"),
    ] {
        let text = format!("{plain}{text}");
        let error = refused(&text, read_toml(&text));
        assert!(error.message.contains(message), "{}", error.message);
        let place = text.rfind(at).unwrap();
        assert!(error.span.start <= place + at.len() && place <= error.span.end, "{message}");
    }
}

/// A robot may have a joint of the name that its own base joint would get.
#[test]
fn robots_may_have_a_joint_called_base() {
    let folder = tempfile::tempdir().unwrap();
    let arm = "[[joint]]\nname = 'base'\ntype = 'revolute'\nbetween = ['ground', 'arm']\n\
               origin = [0, 0, 0]\naxis = [0, 0, 1]";
    fs::write(folder.path().join("arm.toml"), arm).unwrap();
    let two =
        "[[robot]]\nname = 'l'\nmodel = 'arm.toml'\n[[robot]]\nname = 'r'\nmodel = 'arm.toml'";
    let path = folder.path().join("two.toml");
    fs::write(&path, two).unwrap();
    let m = cylindroid::load_file(&path).unwrap();
    let joints = names(m.joints().iter().map(|j| &j.name));
    assert_eq!(joints, ["l/base.2", "l/base", "r/base.2", "r/base"]);
}

#[test]
fn robots_that_cannot_be_are_pointed_at() {
    check(&robot("name = \"r\"\nmodel = \"pandda\""), "\"pandda\"", "nearest: panda");
    check(&robot("name = \"r\""), "[[robot]]", "has no model");
    let twice = robot("model = \"3r\"") + &robot("model = \"3r\"");
    check(&twice, "[[robot]]", "two robots have no name");
    let twice = robot("name = \"r\"\nmodel = \"3r\"").repeat(2);
    check(&twice, "\"r\"", "two robots are named 'r'");
    check(&robot("name = \"a/b\"\nmodel = \"3r\""), "\"a/b\"", "has a slash");
    let r = "name = \"r\"\nmodel = \"3r\"\n";
    check(&robot(&format!("{r}start = [0, 0]")), "[0, 0]", "start has 2 entries, expected 3");
    check(&robot(&format!("{r}start = {{ joint9 = 1 }}")), "joint9", "no joint named 'joint9'");
    check(&robot(&format!("{r}start = {{ joint1 = true }}")), "true", "not a finite number");
    check(&robot(&format!("{r}passive = [\"joint9\"]")), "[\"joint9\"]", "no joint named 'joint9'");
    check(&robot(&format!("{r}passive = [1]")), "1", "not a name");
    check(&robot(&format!("{r}link = \"grond\"")), "\"grond\"", "nearest: ground");
    check(&format!("dimension = 2\n{}", robot(r)), "\"3r\"", "moves in space");
    let youbot = robot("model = \"youbot\"\nbase = { xyz = [1, 0, 0] }");
    check(&youbot, "{ xyz", "called 'ground' too");
    assert_eq!(read_toml(&robot("model = \"youbot\"")).unwrap().n(), 5);
    let dh = "[dh]\nconvention = \"standard\"\nrows = [{ name = \"j\", a = 1 }]\n";
    check(&format!("{dh}{}", robot(r)), "\"3r\"", "a file of its own");
    let touch = "[[contact]]\nname = \"c\"\ntype = \"complete\"\npoint = [1, 0, 0]\nbetween = [\"flange\", \"ground\"]\n";
    check(&format!("{dh}{touch}"), "[\"flange\"", "its root is 'base'");
    assert!(read_toml(&format!("{dh}{}", touch.replace("ground", "base"))).is_ok());
}

/// Two robots that nobody here wrote hold one object.
#[test]
fn robots_of_real_files_hold_an_object() {
    let robots = crate::robots();
    let urdf = robots.join("ur_description/urdf/ur5_robot.urdf");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cell.toml");
    let one = |name: &str, x: f64| {
        robot(&format!(
            "name = \"{name}\"\nmodel = {:?}\nbase = {{ xyz = [{x}, 0, 0] }}\n\
             start = {{ elbow_joint = 1.2, shoulder_lift_joint = -1.0 }}",
            urdf.to_string_lossy()
        ))
    };
    let touch = |name: &str, x: f64| {
        format!(
            "[[contact]]\nname = \"{name}\"\ntype = \"soft_finger\"\nfriction = 0.8\n\
             between = [\"{name}/tool0\", \"tray\"]\npoint = [{x}, 0, 0.5]\nnormal = [0, 0, 1]\n"
        )
    };
    let text = one("l", 0.0) + &one("r", 1.0) + &touch("l", 0.4) + &touch("r", 0.6);
    fs::write(&path, text).unwrap();
    let m = cylindroid::load(&path.to_string_lossy()).unwrap();
    closed_at_home(&m, 1e-12);
    assert_eq!((m.n(), m.contacts().len(), m.actuated().count()), (18, 2, 12));
    let elbow = m.coordinates().iter().position(|c| c.name == "r/elbow_joint").unwrap();
    assert_eq!(m.home()[elbow], 1.2);
}

/// Every example of the page on mechanism files is one.
#[test]
fn the_page_on_mechanism_files_is_true() {
    let page = fs::read_to_string(
        std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/mechanism-file.md"),
    )
    .unwrap();
    let examples: Vec<&str> =
        page.split("```toml\n").skip(1).map(|e| e.split("```").next().unwrap()).collect();
    assert!(examples.len() > 2);
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("arm.urdf"), crate::ARM_URDF).unwrap();
    let five_bar = include_str!("../data/five_bar.urdf");
    fs::write(folder.path().join("five_bar.urdf"), five_bar).unwrap();
    for example in examples {
        let path = folder.path().join("example.toml");
        fs::write(&path, example).unwrap();
        let m = cylindroid::load(&path.to_string_lossy()).unwrap();
        if example.contains("[[closure]]") {
            // Frames that share a point differ in their directions.
            let chain = ClosedChain::of(&m.state(m.home()).unwrap(), None, None).unwrap();
            assert!(chain.closure_error.is_closed(1e-3), "{:?}", chain.closure_error);
        } else {
            closed_at_home(&m, 1e-12);
        }
    }
}
