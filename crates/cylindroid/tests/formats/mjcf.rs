//! MJCF: poses against MuJoCo, loops, couplings, defaults, includes, what is noted and refused.

use std::fs;
use std::path::{Path, PathBuf};

use cylindroid::model::{Geometry, Joint, JointKind, Visual, formats};
use cylindroid::spatial::Quaternion;
use cylindroid::{Mechanism, Pose, Result, Vec3};
use serde_json::Value;

use crate::fk::{assert_close, closed_at_home, frame, tool};
use crate::{pointed_at, refused, report};

const ZOO: &str = include_str!("../data/zoo.xml");
pub(crate) const LOOPS: &str = include_str!("../data/loops.xml");
pub(crate) const TENDONS: &str = include_str!("../data/tendons.xml");

pub(crate) fn read_mjcf(text: &str) -> Result<Mechanism> {
    formats::mjcf::parse(text, Path::new("robots/test.xml"))
}

pub(crate) fn read(text: &str) -> Mechanism {
    read_mjcf(text).unwrap()
}

#[track_caller]
pub(crate) fn check(text: &str, at: &str, says: &str) {
    let error = refused(text, read_mjcf(text));
    let all = format!("{} ({})", error.message, error.help);
    assert!(all.contains(says), "'{says}' not in: {all}");
    assert!(pointed_at(text, &error).starts_with(at), "{all}: {:?}", pointed_at(text, &error));
}

/// A model with this in its world.
pub(crate) fn world(inside: &str) -> String {
    format!("<mujoco><compiler angle='radian'/><worldbody>{inside}</worldbody></mujoco>")
}

pub(crate) fn robosuite() -> PathBuf {
    let models = crate::robots().join("../../../../robosuite/models/assets");
    assert!(models.is_dir(), "no MJCF files in {}: run `cargo xtask setup`", models.display());
    models
}

pub(crate) fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

fn rotation(quaternion: &[f64]) -> cylindroid::Rotation {
    let [w, x, y, z] = quaternion.try_into().unwrap();
    Quaternion { w, x, y, z }.rotation().unwrap()
}

/// What MuJoCo says about a model.
pub(crate) fn vectors(name: &str) -> Value {
    let path = format!("{}/tests/vectors/mujoco/{name}.json", env!("CARGO_MANIFEST_DIR"));
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

/// The joints of the file: one that follows several is read as several, of which the first has its
/// name.
pub(crate) fn moving(m: &Mechanism) -> impl Iterator<Item = &Joint> {
    m.joints().iter().filter(|j| j.kind.dof() > 0 && !j.name.contains('+'))
}

/// Our `q` of MuJoCo's qpos, joint by joint.
pub(crate) fn coordinates(m: &Mechanism, qpos: &Value) -> Vec<f64> {
    let mut q = vec![0.0; m.n()];
    for (joint, given) in moving(m).zip(qpos.as_array().unwrap()) {
        if joint.mimic.is_some() {
            continue;
        }
        let given = numbers(given);
        let own = match joint.kind {
            JointKind::Spherical => rotation(&given).log().to_array().to_vec(),
            JointKind::Free => [&given[..3], &rotation(&given[3..]).log().to_array()].concat(),
            _ => given,
        };
        q[joint.coordinates.clone()].copy_from_slice(&own);
    }
    q
}

/// Poses of bodies and sites at three configurations, limits and loops, as MuJoCo says.
pub(crate) fn against_mujoco(name: &str, m: &Mechanism) {
    let vectors = vectors(name);
    for case in vectors["cases"].as_array().unwrap() {
        let q = coordinates(m, &case["q"]);
        let mut compared = 0;
        for (frame_name, pose) in case["frames"].as_object().unwrap() {
            let pose = numbers(pose);
            let expected = Pose {
                translation: Vec3::new(pose[0], pose[1], pose[2]),
                rotation: rotation(&pose[3..]),
            };
            assert_close(frame(m, &q, frame_name), expected, 1e-9);
            compared += 1;
        }
        assert!(compared > 2, "{name}");
    }
    for (joint, range) in vectors["limits"].as_object().unwrap() {
        let limits = m.joints().iter().find(|j| j.name == *joint).unwrap().limits;
        let range = numbers(range);
        assert!((limits.lower - range[0]).abs() < 1e-12, "{name} {joint}: {limits:?}");
        assert!((limits.upper - range[1]).abs() < 1e-12, "{name} {joint}: {limits:?}");
    }
    assert_eq!(m.loops().len(), vectors["loops"].as_u64().unwrap() as usize, "{name}");
}

#[test]
fn poses_are_those_of_mujoco() {
    against_mujoco("zoo", &read(ZOO));
    against_mujoco("loops", &read(LOOPS));
    against_mujoco("tendons", &read(TENDONS));
}

#[test]
fn poses_of_real_models_are_those_of_mujoco() {
    let robots = [
        "baxter", "gr1", "iiwa", "jaco", "kinova3", "panda", "sawyer", "spot", "spot_arm", "tiago",
        "ur5e", "xarm7",
    ];
    let grippers = [
        "inspire_left_hand",
        "jaco_three_finger_gripper",
        "panda_gripper",
        "robotiq_gripper_140",
        "robotiq_gripper_85",
        "robotiq_gripper_s",
        "xarm7_gripper",
    ];
    let robots = robots.map(|name| (name, format!("robots/{name}/robot.xml")));
    let grippers = grippers.map(|name| (name, format!("grippers/{name}.xml")));
    for (name, path) in robots.into_iter().chain(grippers) {
        let m = cylindroid::load_file(&robosuite().join(path)).unwrap();
        assert_eq!(m.report().format, "MJCF");
        against_mujoco(name, &m);
        assert!(m.actuated().next().is_some() || name == "xarm7_gripper", "{name}");
    }
}

/// Every other file of the package loads or says why not.
#[test]
fn real_models_are_read_or_refused_in_words() {
    let mut stack = vec![robosuite()];
    let mut loaded = 0;
    while let Some(folder) = stack.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                stack.push(path);
            } else if path.extension().is_some_and(|e| e == "xml")
                && fs::read_to_string(&path).unwrap().contains("<mujoco")
            {
                match cylindroid::load_file(&path) {
                    Ok(m) => {
                        closed_at_home(&m, 1e-9);
                        loaded += 1;
                    }
                    Err(error) => panic!("{}: {error}", path.display()),
                }
            }
        }
    }
    assert!(loaded > 40, "{loaded}");
}

#[test]
fn grippers_with_loops() {
    let m = cylindroid::load_file(&robosuite().join("grippers/xarm7_gripper.xml")).unwrap();
    assert_eq!((m.n(), m.loops().len()), (5, 2));
    assert!(m.loops().iter().all(|l| l.kind == JointKind::Spherical));
    closed_at_home(&m, 1e-12);
    let left = m.joints().iter().find(|j| j.name == "left_driver_joint").unwrap();
    let mimic = left.mimic.as_ref().unwrap();
    assert_eq!(
        (mimic.joint.as_str(), mimic.multiplier, mimic.offset),
        ("right_driver_joint", 1.0, 0.0)
    );
    // The actuator pulls a tendon: no joint is actuated alone, and the report says so.
    assert_eq!(m.actuated().count(), 0);
    assert!(report(&m).contains("<general> at a tendon"), "{}", report(&m));
}

/// Fixed tendons over two joints: their coupling is what MuJoCo's vectors have in them.
#[test]
fn grippers_with_tendons() {
    for (name, joints, free) in [
        ("robotiq_gripper_140", 6, 2),
        ("robotiq_gripper_s", 11, 4),
        ("jaco_three_finger_gripper", 6, 3),
    ] {
        let m = cylindroid::load_file(&robosuite().join(format!("grippers/{name}.xml"))).unwrap();
        let moving = m.joints().iter().filter(|j| j.kind.dof() > 0).count();
        assert_eq!((moving, m.n(), m.actuated().count()), (joints, free, free), "{name}");
    }
    let m = cylindroid::load_file(&robosuite().join("grippers/robotiq_gripper_140.xml")).unwrap();
    let inner = m.joints().iter().find(|j| j.name == "left_inner_finger_joint").unwrap();
    assert!((inner.mimic.as_ref().unwrap().multiplier + 1.0 / 1.5).abs() < 1e-15);
}

#[test]
fn home_is_the_key_frame_named_home() {
    let m = read(ZOO);
    let at = |name: &str| {
        let joint = m.joints().iter().find(|j| j.name == name).unwrap();
        m.home()[joint.coordinates.clone()].to_vec()
    };
    assert_eq!((at("lift"), at("slip"), at("turn")), (vec![0.2], vec![0.05], vec![0.4]));
    // Half of a third of a turn about (1, 1, 1).
    let third = 2.0 * std::f64::consts::PI / 3.0 / 3f64.sqrt();
    assert!(at("wrist").iter().all(|x| (x - third).abs() < 1e-14));
    assert_eq!(at("box"), [1.0, 2.0, 3.0, 0.0, 0.0, 0.0]);
    let wrong = ZOO.replace("0.2 0.1 0.05 0.3", "0.2 0.1 0.05");
    check(&wrong, "0.2 0.1 0.05", "qpos has 17 numbers, the joints have 18");
    // Without it, home is qpos0, where the loops close.
    let plain = ZOO
        .replace("name=\"home\"", "name=\"ready\"")
        .replace("tied\" site1", "tied\" active=\"false\" site1");
    let m = read(&plain.replace("relpose=\"0.1 0.2 0.3 0.5 0.5 0.5 0.5\"", ""));
    assert_eq!(m.loops().len(), 3);
    closed_at_home(&m, 1e-12);
    assert!((m.home()[0] - 15f64.to_radians()).abs() < 1e-15);
}

#[test]
fn equality_constraints_are_loops_and_couplings() {
    let m = read(ZOO);
    let find = |name: &str| m.loops().iter().find(|l| l.name == name).unwrap();
    assert_eq!((find("pin").kind, find("hold").kind), (JointKind::Spherical, JointKind::Fixed));
    let pose = find("pose");
    assert_eq!(pose.link_a_from_joint.translation, Vec3::new(0.1, 0.2, 0.3));
    assert_eq!(m.links()[pose.b].name, "world");
    assert_eq!(find("tied").link_a_from_joint.translation, Vec3::new(0.1, 0.0, 0.0));
    let follow = m.joints().iter().find(|j| j.name == "follow").unwrap();
    let mimic = follow.mimic.as_ref().unwrap();
    assert_eq!((mimic.joint.as_str(), mimic.multiplier), ("turn", -0.5));
    assert!((mimic.offset - (0.1 + 5f64.to_radians())).abs() < 1e-15);
    let crank = m.links().iter().find(|l| l.name == "crank").unwrap();
    let is_ellipsoid = |v: &Visual| matches!(v.geometry, Geometry::Ellipsoid { .. });
    assert!(crank.visuals.iter().any(is_ellipsoid), "{:?}", crank.visuals);
    assert_eq!(m.links()[0].visuals[0].geometry, Geometry::HalfSpace);
    let said = report(&m);
    for what in [
        "<joint> in <equality> (bent): only linear couplings",
        "<weld> that is not active (off)",
        "<general> at a tendon (m3)",
        "<fixed> in <tendon> (cable): it is not read",
        "attribute 'damping' of <joint>: springs",
        "<key> (other)",
        "<option>",
        "range of a ball joint (wrist)",
    ] {
        assert!(said.contains(what), "'{what}' not in\n{said}");
    }
}

#[test]
fn actuators_give_actuated_joints_and_effort_limits() {
    let m = read(ZOO);
    let actuated: Vec<&str> = m.actuated().map(|i| m.coordinates()[i].name.as_str()).collect();
    // A motor at a joint that follows actuators the one that leads.
    assert_eq!(actuated, ["lift", "turn"]);
    assert_eq!(m.coordinates()[0].limits.effort, 30.0);
    let without = world("<body><joint name='a'/><body><joint name='b' type='ball'/></body></body>");
    assert_eq!(read(&without).actuated().collect::<Vec<_>>(), [0]);
}

/// MuJoCo normalises the quaternions of key frames, zero to the identity.
#[test]
fn home_may_have_quaternions_of_zero() {
    let text =
        world("<body><freejoint name='f'/><body><joint name='b' type='ball'/></body></body>");
    let key = "<keyframe><key name='home' qpos='1 2 3 0 0 0 0 0 0 0 0'/></keyframe></mujoco>";
    let m = read(&text.replace("</mujoco>", key));
    assert_eq!(m.home(), [1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
}

/// MuJoCo refuses them.
#[test]
fn shapes_of_one_name_are_noted() {
    let two = "<body><joint/><geom name='g' size='1'/><geom name='g' size='2'/></body>";
    let m = read(&world(two));
    assert_eq!(m.links()[1].visuals.len(), 2);
    let note = &m.report().ignored[0];
    assert!(note.what.starts_with("name of a <geom>") && note.what.contains('g'), "{note:?}");
    assert!(note.why.contains("MuJoCo refuses"), "{note:?}");
    let one = "<body><joint/><geom name='g' size='1'/><geom size='2'/><geom size='2'/></body>";
    assert_eq!(read(&world(one)).report().ignored, []);
}

#[test]
fn shapes_have_whole_sizes() {
    use cylindroid::model::Geometry;
    let m = read(ZOO);
    let link = |name: &str| m.links().iter().find(|l| l.name == name).unwrap();
    let Geometry::Box { size } = link("base").visuals[0].geometry else { panic!("no box") };
    assert_eq!(size, Vec3::new(0.2, 0.4, 0.1));
    let capsule = &link("upper").collisions[0];
    assert_eq!(capsule.geometry, Geometry::Capsule { radius: 0.03, length: 0.3 });
    assert_eq!(capsule.link_from_shape.translation, Vec3::new(0.15, 0.0, 0.0));
    assert!(link("fore").collisions.is_empty() && link("fore").visuals.len() == 1);
    assert_eq!(link("base").visuals[0].rgba, Some([0.1, 0.2, 0.3, 1.0]));
    assert_eq!(link("base").inertial.unwrap().mass, 2.0);
}

#[test]
fn names_that_are_missing_or_shared_are_made() {
    let text = world(
        "<body><joint/><site name='world'/><body><joint/><joint type='slide'/></body></body>",
    );
    let m = read(&text);
    let links: Vec<&str> = m.links().iter().map(|l| l.name.as_str()).collect();
    assert_eq!(links[0], "world");
    assert_eq!((links.len(), m.n()), (4, 3));
    assert!(m.frame("site:world").is_ok());
    check(&world("<body name='a'/><body name='a'/>"), "a", "two bodies are named 'a'");
    let twice = world("<body name='a'><joint name='j'/><joint name='j'/></body>");
    check(&twice, "j", "two joints are named 'j'");
}

#[test]
fn includes_are_found_from_the_folder_of_the_model() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        fs::write(&path, text).unwrap();
        path
    };
    let load = |path: &Path| cylindroid::load_file(path);
    write(
        "arm.xml",
        "<mujoco><worldbody><body name='a'><include file='hand.xml'/></body></worldbody></mujoco>",
    );
    write(
        "hand.xml",
        "<mujocoinclude><joint name='j'/><body name='b' pos='0 0 1'><jont/></body></mujocoinclude>",
    );
    let main = write("main.xml", "<mujoco><include file='./arm.xml'/></mujoco>");
    let m = load(&main).unwrap();
    assert_eq!((m.n(), tool(&m, m.home()).translation), (1, Vec3::Z));
    let said = report(&m);
    assert!(said.contains("hand.xml") && said.contains("1: <jont>"), "{said}");
    // An error in an included file points there.
    write("hand.xml", "<mujocoinclude>\n<joint name='j' axis='0 0'/></mujocoinclude>");
    let error = load(&main).unwrap_err().to_string();
    assert!(error.contains("hand.xml:2:23: axis of <joint> has 2 numbers"), "{error}");
    // A file is found from the folder of the main file, otherwise from that of the including one.
    fs::create_dir_all(folder.path().join("parts/deep")).unwrap();
    write("parts/deep/leaf.xml", "<mujocoinclude><body name='leaf' pos='0 0 2'/></mujocoinclude>");
    let absolute = folder.path().join("parts/deep/leaf.xml").to_string_lossy().into_owned();
    write("parts/own.xml", "<mujocoinclude><include file='deep/leaf.xml'/></mujocoinclude>");
    let up = write(
        "parts/main.xml",
        "<mujoco><worldbody><include file='../parts/own.xml'/></worldbody></mujoco>",
    );
    let whole = format!("<mujoco><worldbody><include file='{absolute}'/></worldbody></mujoco>");
    for path in [up, write("whole.xml", &whole)] {
        let m = load(&path).unwrap();
        assert_eq!(tool(&m, m.home()).translation, Vec3::Z * 2.0);
    }
    for (file, says) in [
        ("../none/arm.xml", "cannot read"),
        ("/dev/zero", "not a regular file"),
        ("none.xml", "cannot read"),
        ("main.xml", "included twice"),
    ] {
        let path = write("main.xml", &format!("<mujoco><include file='{file}'/></mujoco>"));
        let error = load(&path).unwrap_err().to_string();
        assert!(error.contains(says), "{error}");
    }
}

#[test]
fn what_is_broken_is_pointed_at() {
    check("<mujoco><worldbody>", "", "broken XML");
    check("<sdf/>", "<sdf", "MJCF begins with <mujoco>");
    let body = |inside: &str| world(&format!("<body name='b'>{inside}</body>"));
    check(&body("<joint type='hing'/>"), "hing", "nearest: hinge");
    check(&body("<joint axis='0 0 0'/>"), "0 0 0", "no direction");
    check(&body("<joint range='1 -1' limited='true'/>"), "1 -1", "is not below the upper end");
    check(&body("<joint range='1'/>"), "1", "has 1 numbers, expected 2");
    check(&body("<joint pos='0 0 x'/>"), "0 0 x", "'x' is not a number");
    check(&body("<joint class='none'/>"), "none", "no default class named 'none'");
    check(&body("<freejoint/><joint/>"), "<freejoint", "only one of a body of the world");
    check(&body("<body><freejoint/></body>"), "<freejoint", "only one of a body of the world");
    check(&world("<body quat='0 0 0 0'/>"), "0 0 0 0", "finite and not zero");
    check(&world("<body quat='1 0 0 0' euler='0 0 0'/>"), "0 0 0", "both quat and euler");
    check(&world("<body xyaxes='1 0 0 2 0 0'/>"), "1 0 0 2 0 0", "parallel");
    check(&world("<body zaxis='0 0 0'/>"), "0 0 0", "no direction");
    check(&world("<body axisangle='0 0 0 1'/>"), "0 0 0 1", "no direction");
    let equality = |inside: &str| {
        body("<joint name='j'/><site name='s'/>")
            .replace("</mujoco>", &format!("<equality>{inside}</equality></mujoco>"))
    };
    check(&equality("<connect body1='c' anchor='0 0 0'/>"), "c", "no body named 'c'");
    check(&equality("<connect body1='b'/>"), "<connect", "has no anchor");
    check(&equality("<weld body1='b' body2='b'/>"), "<weld", "to itself");
    check(&equality("<weld/>"), "<weld", "<weld> has no body1");
    check(&equality("<weld site1='s' site2='t'/>"), "t", "no site named 't'");
    check(&equality("<joint joint1='k' joint2='j'/>"), "k", "no joint named 'k'; nearest: j");
    check(&equality("<tendon tendon1='t'/>"), "t", "no tendon named 't'");
    let angle = world("").replace("radian", "grad");
    check(&angle, "grad", "nearest: radian");
    check("<mujoco><compiler eulerseq='xy'/></mujoco>", "xy", "three letters");
    let motor = body("").replace("</mujoco>", "<actuator><motor joint='k'/></actuator></mujoco>");
    check(&motor, "k", "no joint named 'k'");
}

/// Numbers of MuJoCo 4.0.
#[test]
fn masses_are_those_of_the_geoms_without_an_inertial() {
    let inertial = |compiler: &str, inside: &str| {
        let m = read(&format!(
            "<mujoco><compiler angle='radian' {compiler}/><worldbody><body name='a'><joint/>\
             {inside}</body></worldbody></mujoco>"
        ));
        m.links()[1].inertial.map(|i| {
            let axes = i.link_from_inertia.rotation.matrix();
            let rows = (axes * i.inertia * axes.transpose()).to_rows();
            let centre = i.link_from_inertia.translation.to_array();
            (i.mass, centre, [rows[0][0], rows[1][1], rows[2][2]])
        })
    };
    let close = |(mass, centre, moments): (f64, [f64; 3], [f64; 3]), expected: [f64; 7]| {
        let [m, x, y, z, a, b, c] = expected;
        let pairs = [mass].into_iter().chain(centre).chain(moments).zip([m, x, y, z, a, b, c]);
        pairs
            .for_each(|(own, expected)| assert!((own - expected).abs() < 1e-6, "{own} {expected}"));
    };
    let two = "<geom type='capsule' size='.1 .2' density='500'/>\
               <geom type='ellipsoid' size='.1 .2 .3' pos='1 0 0' group='5'/>";
    let expected = [33.510321638, 0.75, 0.0, 0.0, 0.87650435, 7.00889321, 6.57430623];
    let got = inertial("", two).unwrap();
    assert!((got.0 - expected[0]).abs() < 1e-6 && (got.1[0] - 0.75).abs() < 1e-12, "{got:?}");
    let mut moments = got.2;
    moments.sort_by(f64::total_cmp);
    let sorted = [0.87650435, 6.57430623, 7.00889321];
    assert!(moments.iter().zip(sorted).all(|(a, b)| (a - b).abs() < 1e-6), "{moments:?}");
    close(
        inertial("inertiagrouprange='0 3'", two).unwrap(),
        [8.37758041, 0.0, 0.0, 0.0, 0.22305308, 0.22305308, 0.03979351],
    );
    let own = "<inertial pos='0 1 0' mass='1' diaginertia='1 2 2'/><geom size='.1'/>";
    close(inertial("", own).unwrap(), [1.0, 0.0, 1.0, 0.0, 1.0, 2.0, 2.0]);
    let ball = [4.1887902, 0.0, 0.0, 0.0, 0.01675516, 0.01675516, 0.01675516];
    close(inertial("inertiafromgeom='true'", own).unwrap(), ball);
    let half = ball.map(|x| x * 0.5 / 4.1887902047863905);
    close(inertial("inertiafromgeom='true' settotalmass='0.5'", own).unwrap(), half);
    assert_eq!(inertial("inertiafromgeom='false'", "<geom size='.1'/>"), None);
    assert_eq!(inertial("", "<geom size='.1' mass='0'/>"), None);
}

/// Joints, masses and sites stand in the frame that contains them.
#[test]
fn frames_move_all_that_they_contain() {
    let m = read(
        "<mujoco><default><default class='c'><joint damping='1' axis='1 0 0'/></default></default>\
         <worldbody><body name='a'><frame pos='1 0 0' euler='90 0 0' childclass='c'>\
         <joint name='j' pos='0 1 0' axis='0 0 1'/><joint name='k'/>\
         <inertial pos='0 1 0' mass='1' diaginertia='1 2 3'/>\
         <site name='s' type='capsule' fromto='0 0 0 0 0 2'/></frame></body></worldbody></mujoco>",
    );
    let joint = |name: &str| m.joints().iter().find(|j| j.name == name).unwrap();
    assert!((joint("j").axis + Vec3::Y).norm() < 1e-12, "{:?}", joint("j").axis);
    assert!((joint("k").axis - Vec3::X).norm() < 1e-12);
    let at = joint("j").parent_from_joint.translation;
    assert!((at - Vec3::new(1.0, 0.0, 1.0)).norm() < 1e-12, "{at:?}");
    let body = m.links().iter().find(|l| l.name == "a").unwrap();
    let centre = body.inertial.unwrap().link_from_inertia.translation;
    assert!((centre - Vec3::new(1.0, 0.0, 1.0)).norm() < 1e-12, "{centre:?}");
    let site = m.state(m.home()).unwrap().pose(m.frame("s").unwrap()).unwrap().translation;
    assert!((site - Vec3::new(1.0, -1.0, 0.0)).norm() < 1e-12, "{site:?}");
}

/// A name that the loader makes up is none that the file gives to another joint or body.
#[test]
fn made_up_names_leave_those_of_the_file() {
    let m = read(&world(
        "<body name='door'><joint/><body><joint name='door'/></body><body name='body2'/></body>",
    ));
    let names: Vec<&str> = m.joints().iter().map(|j| j.name.as_str()).collect();
    assert_eq!(names, ["door.2", "door", "body2"]);
    let links: Vec<&str> = m.links().iter().map(|l| l.name.as_str()).collect();
    assert_eq!(links, ["world", "door", "body2.2", "body2"]);
}
