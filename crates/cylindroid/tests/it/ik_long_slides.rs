//! Inverse kinematics of slides that travel far.

use std::path::Path;

use cylindroid::Vec3;
use cylindroid::ik::{Goal, IkOptions, Solution, Task, solve};
use cylindroid::model::{JointKind, JointSpec, Limits, Link, Mechanism};
use cylindroid::spatial::{Pose, Rotation};

use crate::support::Random;

/// A slide of a mechanism file, with these limits (m) or none.
fn slide([name, parent, axis]: [&str; 3], limits: Option<[f64; 2]>) -> String {
    let limits = limits.map_or(String::new(), |[lower, upper]| {
        format!("limits = {{ lower = {lower:?}, upper = {upper:?} }}\n")
    });
    format!(
        "[[joint]]\nname = \"{name}\"\ntype = \"prismatic\"\n\
         between = [\"{parent}\", \"{name}_link\"]\naxis = [{axis}]\nactuated = true\n{limits}"
    )
}

/// A UR5e on a slide along x.
fn rail(limits: Option<[f64; 2]>) -> Mechanism {
    let slide = slide(["x", "ground", "1, 0, 0"], limits);
    let text = format!("name = \"rail\"\n{slide}[[robot]]\nmodel = \"ur5e\"\nlink = \"x_link\"\n");
    cylindroid::load_text(&text, Path::new("rail.toml")).unwrap()
}

fn reached(robot: &Mechanism, goal: Goal, options: &IkOptions) -> Solution {
    let found = solve(robot, &[goal], options).unwrap();
    assert!(found.success, "{found:?}");
    assert_eq!(robot.outside_limits(&found.q).next(), None);
    found
}

/// A target hundreds of metres along a rail is found at once, as one nearby is.
#[test]
fn a_target_far_along_a_rail() {
    let rotation = Rotation::exp(Vec3::X * 3.0);
    for upper in [1000.0, 1100.0, 1e5, 1e8] {
        for x in [3.0, 30.0, 500.0, 900.0] {
            for limits in [Some([0.0, upper]), Some([-upper, upper]), None] {
                let robot = rail(limits);
                let target = Pose { rotation, translation: Vec3::new(x, 0.2, 0.5) };
                let goal = Goal::pose(robot.tool(), target);
                let found = reached(&robot, goal, &IkOptions::default());
                // The closed form with the slide locked takes 16 samples before.
                assert!(found.restarts <= 16 + 9, "{upper} {x} {limits:?}: {found:?}");
            }
        }
    }
}

/// The closest configuration to a guess far away is beside the target, too.
#[test]
fn the_closest_one_far_along_a_rail() {
    let robot = rail(Some([0.0, 1100.0]));
    let known = [900.0, 0.3, -1.1, 1.4, 0.2, 1.0, 0.4];
    let target = robot.state(&known).unwrap().pose(robot.tool()).unwrap();
    let options = IkOptions {
        nearest: true,
        initial_guess: Some(vec![0.0, 0.3, -1.1, 1.4, 0.2, 1.0, 0.4]),
        ..IkOptions::default()
    };
    let found = reached(&robot, Goal::pose(robot.tool(), target), &options);
    assert!(found.q[0] <= 900.0 + 1e-6, "{found:?}");
}

/// Slides alone are a linear problem, of any size.
#[test]
fn slides_alone_are_found_at_once() {
    for size in [1.0, 1e3, 1e6, 1e9] {
        for limits in [Some([0.0, size]), Some([-size, size]), None] {
            let text = format!(
                "name = \"table\"\n{}{}",
                slide(["x", "ground", "1, 0, 0"], limits),
                slide(["y", "x_link", "0, 1, 0"], limits)
            );
            let robot = cylindroid::load_text(&text, Path::new("table.toml")).unwrap();
            let target = Pose::from_translation(Vec3::new(0.9, 0.9, 0.0) * size);
            let goal = Goal::frame(robot.tool(), Task::POSITION, target);
            let found = reached(&robot, goal, &IkOptions::default());
            assert!(found.restarts == 1 && found.iterations <= 30, "{size}: {found:?}");
        }
    }
}

/// The shape of a UR5e on two slides, a thousand units of length to the metre.
#[test]
fn an_arm_of_a_thousand_units_on_slides() {
    let right = std::f64::consts::FRAC_PI_2;
    let rows = [
        [0.0, 0.0, 162.5],
        [right, 0.0, 0.0],
        [0.0, -425.0, 0.0],
        [0.0, -392.2, 133.3],
        [right, 0.0, 99.7],
        [-right, 0.0, 99.6],
    ];
    let mut builder = Mechanism::builder("thousand");
    let mut parent = "world".to_owned();
    let mut add = |name: String, kind: JointKind, at: Pose, axis: Vec3, limits: [f64; 2]| {
        let mut joint = JointSpec::new(&name, kind, &parent, &format!("{name} link"));
        builder.link(Link::named(&format!("{name} link")));
        parent = format!("{name} link");
        (joint.parent_from_joint, joint.axis) = (at, axis);
        joint.limits = Limits { lower: limits[0], upper: limits[1], ..Limits::NONE };
        builder.joint(joint);
    };
    for (name, axis) in [("x", Vec3::X), ("y", Vec3::Y)] {
        add(name.to_owned(), JointKind::Prismatic, Pose::IDENTITY, axis, [-20_000.0, 20_000.0]);
    }
    for (i, [twist, length, offset]) in rows.into_iter().enumerate() {
        let rotation = Rotation::exp(Vec3::X * twist);
        let bent = Pose { rotation, translation: Vec3::X * length };
        let at = bent * Pose::from_translation(Vec3::Z * offset);
        add(format!("q{i}"), JointKind::Revolute, at, Vec3::Z, [-6.2, 6.2]);
    }
    let robot = builder.build().unwrap();
    let (mut random, mut total) = (Random(11), 0);
    for round in 0..60 {
        let known = random.q(&robot);
        let target = robot.state(&known).unwrap().pose(robot.tool()).unwrap();
        let found = reached(&robot, Goal::pose(robot.tool(), target), &IkOptions::default());
        assert!(found.restarts <= 20, "{round}: {found:?}");
        total += found.restarts;
    }
    assert!(total <= 300, "{total}");
}
