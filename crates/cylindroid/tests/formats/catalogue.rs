//! The robots of the catalogue, against published numbers.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use cylindroid::{Pose, Rotation, Vec3, catalogue, load};

use cylindroid::Mechanism;
use cylindroid::model::{Dimension, JointKind};

use crate::fk::{assert_close, closed_at_home, frame, tool};

#[test]
fn every_model_loads_and_says_where_its_numbers_come_from() {
    let entries = catalogue::entries();
    let names: Vec<&str> = entries.iter().map(|e| e.name).collect();
    assert_eq!(names, catalogue::names());
    for entry in entries {
        let m = load(entry.name).unwrap();
        assert_eq!(m.name(), entry.name);
        assert_eq!(m.report().format, "catalogue");
        assert_eq!((m.report().source.as_str(), m.n()), (entry.source.as_str(), entry.dof));
        assert!(!entry.description.is_empty() && !entry.source.is_empty());
        assert_eq!(m.outside_limits(m.home()).count(), 0, "home of {}", entry.name);
        assert_eq!((m.loops().len(), m.contacts().len()), (entry.loops, entry.contacts));
        closed_at_home(&m, 1e-12);
        assert!(m.actuated().next().is_some());
        if m.is_closed() {
            continue; // passive joints have no stops in the sources
        }
        for c in m.coordinates() {
            assert!(c.limits.lower.is_finite() && c.limits.upper.is_finite(), "{}", c.name);
        }
        assert!(m.joints().iter().filter(|j| j.kind.dof() > 0).all(|j| j.actuated));
    }
    assert!(catalogue::load("pumma").unwrap_err().to_string().contains("nearest: puma560"));
}

fn place(rotation: [[f64; 3]; 3], translation: [f64; 3]) -> Pose {
    let [a, b, c] = rotation;
    let [x, y, z] = translation;
    Pose::from_matrix([
        [a[0], a[1], a[2], x],
        [b[0], b[1], b[2], y],
        [c[0], c[1], c[2], z],
        [0.0, 0.0, 0.0, 1.0],
    ])
    .unwrap()
}

/// The ready pose of the maker's examples puts the flange 0.3069 m before the base, turned down.
#[test]
fn panda() {
    let m = load("panda").unwrap();
    assert_eq!(m.frame_of(m.tool()).name, "hand_tcp");
    let flange = frame(&m, m.home(), "flange");
    let c = FRAC_PI_4.cos();
    let down = [[c, -c, 0.0], [-c, -c, 0.0], [0.0, 0.0, -1.0]];
    assert_close(flange, place(down, [0.306_890_566_592, 0.0, 0.590_282_052_286]), 1e-9);
    let down = [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]];
    assert_close(
        tool(&m, m.home()),
        place(down, [0.306_890_566_592, 0.0, 0.486_882_052_286]),
        1e-9,
    );
    assert_eq!(m.coordinates()[3].limits.upper, -0.0698);
    assert_eq!(m.coordinates()[1].limits.acceleration, 7.5);
}

/// Zero: arm stretched along -x, tool along -y.
#[test]
fn ur5e() {
    let m = load("ur5e").unwrap();
    let zero = [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]];
    assert_close(tool(&m, &[0.0; 6]), place(zero, [-0.8172, -0.2329, 0.0628]), 1e-15);
    let elbow = m.coordinates()[2].limits;
    assert_eq!((elbow.lower, elbow.upper, elbow.effort), (-PI, PI, 150.0));
    assert_eq!(m.coordinates()[5].limits.effort, 28.0);
}

/// The nominal pose qn of the Robotics Toolbox (Corke) and what it prints for it.
#[test]
fn puma560() {
    let m = load("puma560").unwrap();
    let qn = [0.0, FRAC_PI_4, PI, 0.0, FRAC_PI_4, 0.0];
    let rotation = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]];
    assert_close(tool(&m, &qn), place(rotation, [0.5963, -0.1501, -0.01435]), 1e-4);
    let zero =
        place([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.4521, -0.15005, 0.4318]);
    assert_close(tool(&m, &[0.0; 6]), zero, 1e-14);
}

/// Upright: 360 + 420 + 400 + 126 mm.
#[test]
fn iiwa14() {
    let m = load("iiwa14").unwrap();
    let up = Pose::from_translation(Vec3::new(0.0, 0.0, 1.306));
    assert_close(tool(&m, &[0.0; 7]), up, 1e-14);
    // Joint 2 leans the arm forward, joint 4 back.
    let q = [0.0, FRAC_PI_2, 0.0, FRAC_PI_2, 0.0, 0.0, 0.0];
    assert_close(tool(&m, &q), Pose::from_translation(Vec3::new(0.42, 0.0, 0.886)), 1e-14);
}

/// The lengths 0.033, 0.155, 0.135, 0.2175 in the vertical plane, tool 25 deg below horizontal.
#[test]
fn youbot() {
    let m = load("youbot").unwrap();
    let (q2, q3) = (0.4_f64, 0.9_f64);
    let lean = FRAC_PI_2 + 25.0 * PI / 180.0;
    let lengths = [(0.155, q2), (0.135, q2 + q3), (0.2175, lean)];
    let x = 0.033 + lengths.iter().map(|(l, a)| l * a.sin()).sum::<f64>();
    let z = 0.147 + lengths.iter().map(|(l, a)| l * a.cos()).sum::<f64>();
    let (q1, q5) = (0.3, -0.8);
    let expected = Pose::from_rotation(Rotation::about_z(q1))
        * Pose {
            rotation: Rotation::about(Vec3::Y, lean).unwrap() * Rotation::about_z(q5),
            translation: Vec3::new(x, 0.0, z),
        };
    assert_close(tool(&m, &[q1, q2, q3, lean - q2 - q3, q5]), expected, 1e-14);
    // The home pose is such a pose.
    let home = tool(&m, m.home());
    let below = (-home.rotation.z_axis().z).asin();
    assert!((below - 25.0 * PI / 180.0).abs() < 1e-12);
}

/// Siciliano et al. 2009, eq. 2.66, raised by the height of the shoulder.
#[test]
fn anthropomorphic() {
    let m = load("3r").unwrap();
    let (q1, q2, q3) = (0.3_f64, 0.7_f64, -1.2_f64);
    let reach = 0.4 * q2.cos() + 0.4 * (q2 + q3).cos();
    let expected =
        Vec3::new(q1.cos() * reach, q1.sin() * reach, 0.4 + 0.4 * q2.sin() + 0.4 * (q2 + q3).sin());
    assert!((tool(&m, &[q1, q2, q3]).translation - expected).norm() < 1e-15);
}

/// What a mechanism is: joints of the tree, loops, contacts, actuated joints, and its dimension.
fn shape(m: &Mechanism) -> (usize, usize, usize, usize, Dimension) {
    (m.n(), m.loops().len(), m.contacts().len(), m.actuated().count(), m.dimension())
}

/// Where a joint is at home, of the tree or closing it.
fn origin(m: &Mechanism, name: &str) -> Vec3 {
    let on = |link: usize| frame(m, m.home(), &m.links()[link].name);
    let in_tree = m.joints().iter().find(|j| j.name == name);
    let closing = m.loops().iter().find(|l| l.name == name);
    in_tree
        .map(|j| on(j.parent) * j.parent_from_joint)
        .or_else(|| closing.map(|l| on(l.a) * l.link_a_from_joint))
        .unwrap()
        .translation
}

#[track_caller]
fn assert_lengths(m: &Mechanism, lengths: &[(&str, &str, f64)]) {
    for (a, b, length) in lengths {
        let got = (origin(m, a) - origin(m, b)).norm();
        assert!((got - length).abs() < 1e-12, "{a} to {b}: {got}");
    }
}

#[test]
fn planar_closed_chains() {
    let m = load("four-bar").unwrap();
    assert_eq!(shape(&m), (3, 1, 0, 1, Dimension::Planar));
    assert_lengths(
        &m,
        &[("q1", "q2", 1.0), ("q2", "q3", 1.8), ("q3", "q4", 1.3), ("q4", "q1", 2.0)],
    );

    let m = load("five-bar").unwrap();
    assert_eq!(shape(&m), (4, 1, 0, 2, Dimension::Planar));
    let corners = [[0.0, 0.0], [0.0, 2.0], [1.0, 2.0], [2.0, 1.0], [2.0, 0.0]];
    for (i, [x, y]) in corners.into_iter().enumerate() {
        assert_eq!(origin(&m, &format!("q{}", i + 1)), Vec3::new(x, y, 0.0));
    }
    let reference = m.frame_of(m.reference());
    assert_eq!(m.links()[reference.link].name, "coupler");
    assert_eq!(tool(&m, m.home()).translation, Vec3::new(1.0, 2.0, 0.0));

    let m = load("3rrr").unwrap();
    assert_eq!(shape(&m), (7, 2, 0, 3, Dimension::Planar));
    assert_lengths(&m, &[("a1", "b1", 0.6), ("b2", "p2", 0.55), ("a3", "b3", 0.6)]);

    let m = load("watt").unwrap();
    assert_eq!(shape(&m), (5, 2, 0, 1, Dimension::Planar));
    assert_lengths(
        &m,
        &[("q1", "a", 1.0), ("a", "b", 1.9), ("b", "q4", 1.2), ("c", "e", 1.6), ("d", "e", 1.3)],
    );
}

#[test]
fn stewart() {
    let m = load("stewart").unwrap();
    // Six universal joints and slides, one ball in the tree; five balls close it.
    assert_eq!(shape(&m), (6 * 3 + 3, 5, 0, 6, Dimension::Spatial));
    assert!(m.loops().iter().all(|l| l.kind == JointKind::Spherical && !l.actuated));
    for i in 1..=6 {
        let (u, s) = (origin(&m, &format!("u{i}")), origin(&m, &format!("s{i}")));
        // Joints on circles of 1 and 0.6, 40 degrees apart, 1 m above one another.
        let length = (1.0 + 1.0 + 0.36 - 1.2 * (2.0 * PI / 9.0).cos()).sqrt();
        assert!(((u - s).norm() - length).abs() < 1e-12, "{}", (u - s).norm());
        let slide = m.joints().iter().find(|j| j.name == format!("leg{i}")).unwrap();
        assert!(slide.axis.cross(s - u).norm() < 1e-12);
    }
    assert_close(tool(&m, m.home()), Pose::from_translation(Vec3::Z), 1e-14);
}

#[test]
fn three_rps() {
    let m = load("3rps").unwrap();
    // Three revolute joints and slides, one ball in the tree; two balls close it.
    assert_eq!(shape(&m), (3 * 2 + 3, 2, 0, 3, Dimension::Spatial));
    for i in 1..=3 {
        let (r, s) = (origin(&m, &format!("r{i}")), origin(&m, &format!("s{i}")));
        // Joints on circles of 1 and 0.5, 1 m above one another, in a plane with the axis of the robot.
        assert!((r.norm() - 1.0).abs() < 1e-12 && ((s - r).norm() - 1.25_f64.sqrt()).abs() < 1e-12);
        let joint = m.joints().iter().find(|j| j.name == format!("r{i}")).unwrap();
        assert!(joint.axis.dot(r).abs() < 1e-12 && joint.axis.dot(s).abs() < 1e-12);
    }
    assert_close(tool(&m, m.home()), Pose::from_translation(Vec3::Z), 1e-14);
}

#[test]
fn delta() {
    let m = load("delta").unwrap();
    // Three arms, six universal joints, one ball; five balls close it.
    assert_eq!(shape(&m), (3 + 12 + 3, 5, 0, 3, Dimension::Spatial));
    for i in 1..=3 {
        for w in ["a", "b"] {
            assert_lengths(&m, &[(&format!("u{i}{w}"), &format!("s{i}{w}"), 0.5)]);
        }
        let elbow = (origin(&m, &format!("u{i}a")) + origin(&m, &format!("u{i}b"))) * 0.5;
        assert!(((elbow - origin(&m, &format!("arm{i}"))).norm() - 0.3).abs() < 1e-12);
    }
}

/// The grasp points of the reference set are the flanges of our panda in the same configurations.
#[test]
fn two_arm() {
    let m = load("two-arm").unwrap();
    assert_eq!(shape(&m), (7 + 7 + 6, 0, 2, 14, Dimension::Spatial));
    for contact in m.contacts() {
        assert!(contact.link_a_from_contact.translation.norm() < 1e-12);
        assert_eq!(m.links()[contact.b].name, "box");
    }
    assert_eq!(m.frame_of(m.reference()).name, "box");
    let alone = load("panda").unwrap();
    let flange = frame(&alone, &m.home()[..7], "flange");
    assert_close(frame(&m, m.home(), "left/flange"), flange, 1e-14);
}
