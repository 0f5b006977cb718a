//! The screw systems of limbs.

use cylindroid::closure::{ClosedChain, LimbScrews};
use cylindroid::model::{JointKind, JointSpec, Mimic};
use cylindroid::screws::{ScrewOptions, ScrewSystem};
use cylindroid::{Mechanism, Pose, Vec3, catalogue};

fn linkage(name: &str) -> Mechanism {
    let file = format!("{}/tests/data/linkages/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    cylindroid::load(&file).unwrap()
}

fn screws(m: &Mechanism) -> LimbScrews {
    LimbScrews::of(&m.state(m.home()).unwrap(), None, None).unwrap()
}

/// The limbs together permit what the whole mechanism does.
#[test]
fn twists_of_the_platform_are_those_of_the_closed_chain() {
    let mut all: Vec<Mechanism> =
        catalogue::names().iter().map(|name| catalogue::load(name).unwrap()).collect();
    for folder in ["tests/data/linkages", "tests/data/mechanisms"] {
        let path = format!("{}/{folder}", env!("CARGO_MANIFEST_DIR"));
        for file in std::fs::read_dir(path).unwrap().map(|f| f.unwrap().path()) {
            if file.extension().is_some_and(|e| e == "toml") {
                all.push(cylindroid::load(file.to_str().unwrap()).unwrap());
            }
        }
    }
    assert!(all.len() > 50);
    let mut with_limbs = 0;
    for m in &all {
        let state = m.state(m.home()).unwrap();
        let found = screws(m);
        let twists = ClosedChain::of(&state, None, None).unwrap().reference_twists(&state);
        let options = ScrewOptions { noise: 1e-9, ..ScrewOptions::with_length(m.reach()) };
        let whole = ScrewSystem::of(&twists, &options).unwrap();
        let what = format!("{}: {} limbs", m.name(), found.limbs.len());
        assert_eq!(found.twists.order(), whole.order(), "{what}");
        for twist in whole.basis() {
            assert!(found.twists.sine_to(twist) < 1e-6, "{what}: {}", found.twists.sine_to(twist));
        }
        with_limbs += usize::from(found.limbs.len() > 1);
        let planar = m.dimension() == cylindroid::model::Dimension::Planar;
        let d = if planar { 3 } else { 6 };
        for limb in &found.limbs {
            assert_eq!(limb.twists.order() + limb.constraint.order(), d, "{what}");
            for twist in limb.twists.basis() {
                for wrench in limb.constraint.basis() {
                    // Reciprocal: linear part with force, angular part with moment.
                    let power = twist.linear.dot(wrench.angular) + twist.angular.dot(wrench.linear);
                    assert!(power.abs() < 1e-8, "{what} {power}");
                }
            }
        }
    }
    assert!(with_limbs > 30, "{with_limbs}");
}

/// Name, number of limbs, serial, connectivity, constraint wrenches and couples among them,
/// actuation wrenches, freedoms of the platform.
#[test]
fn limbs_of_published_mechanisms() {
    for (name, limbs, serial, connectivity, constraints, couples, actuation, freedoms) in [
        ("orthoglide", 3, false, 4, 2, 2, 1, 3),
        ("upu_tsai", 3, true, 5, 1, 1, 1, 3),
        ("delta_pa", 3, false, 4, 2, 2, 1, 3),
        ("agile_eye_home", 3, true, 3, 3, 0, 1, 3),
        ("rrr_regular", 3, true, 3, 0, 0, 1, 3),
        ("fichter_1.200", 6, true, 6, 0, 0, 1, 6),
        ("fichter_1.571", 6, true, 6, 0, 0, 1, 6),
    ] {
        let m = linkage(name);
        let found = screws(&m);
        assert_eq!(found.limbs.len(), limbs, "{name}");
        assert_eq!(found.twists.order(), freedoms, "{name}");
        for limb in &found.limbs {
            let what = format!("{name}: {:?}", limb.joints);
            assert_eq!(limb.serial, serial, "{what}");
            assert_eq!(limb.twists.order(), connectivity, "{what}");
            assert_eq!(limb.constraint.order(), constraints, "{what}");
            assert_eq!(limb.actuation.order(), actuation, "{what}");
            let all = limb.constraint.basis();
            let still = all.iter().filter(|w| w.angular.norm() < 1e-9 * w.linear.norm()).count();
            assert_eq!(still, couples, "{what}");
        }
    }
    // All that is left to the orthoglide and the delta are translations.
    for name in ["orthoglide", "delta_pa", "upu_tsai"] {
        let found = screws(&linkage(name));
        let turns = found.twists.basis().iter().any(|t| t.angular.norm() > 1e-9);
        assert!(!turns, "{name}");
    }
    // The two limbs of a Sarrus linkage: planar motions in two planes.
    let sarrus = screws(&linkage("sarrus"));
    assert_eq!(sarrus.limbs.len(), 2);
    for limb in &sarrus.limbs {
        assert_eq!((limb.twists.order(), limb.constraint.order()), (3, 3));
        assert_eq!(limb.twists.class(), limb.constraint.class());
    }
    assert_eq!((sarrus.twists.order(), sarrus.constraint.order()), (1, 5));
    // A Tricept: three legs without constraint, and a passive one with three.
    let tricept = screws(&linkage("tricept"));
    let mut orders: Vec<usize> = tricept.limbs.iter().map(|l| l.constraint.order()).collect();
    orders.sort_unstable();
    assert_eq!(orders, [0, 0, 0, 3]);
}

#[test]
fn a_serial_arm_is_one_limb() {
    let arm = catalogue::load("ur5e").unwrap();
    let found = LimbScrews::of(&arm.state(&[0.1, -0.9, 0.7, 0.4, 1.0, 0.2]).unwrap(), None, None);
    let found = found.unwrap();
    assert_eq!(found.limbs.len(), 1);
    assert!(found.limbs[0].serial && found.limbs[0].joints.len() == 6);
    assert_eq!((found.twists.order(), found.constraint.order()), (6, 0));
    assert_eq!(found.limbs[0].actuation.order(), 6);
}

/// A finger beyond the platform that follows a joint of the limb belongs to it: no path from the
/// ground to the platform has all of its joints. Without the coupling the limb is that path.
#[test]
fn a_limb_with_a_finger_that_follows_its_joint_is_no_path() {
    let arm = |follows: bool| {
        let mut builder = Mechanism::builder("arm with a finger");
        for (name, parent, child) in
            [("a", "base", "l1"), ("b", "l1", "hand"), ("f", "hand", "finger")]
        {
            let mimic = Mimic { joint: "b".to_owned(), multiplier: 0.5, offset: 0.0 };
            builder.joint(JointSpec {
                parent_from_joint: Pose::from_translation(Vec3::X * 0.3),
                mimic: (follows && name == "f").then_some(mimic),
                ..JointSpec::new(name, JointKind::Revolute, parent, child)
            });
        }
        builder.frame("palm", "hand", Pose::IDENTITY).reference("palm");
        builder.build().unwrap()
    };
    for (follows, joints) in [(false, &["a", "b"][..]), (true, &["a", "b", "f"])] {
        let found = screws(&arm(follows));
        assert_eq!(found.limbs.len(), 1);
        assert_eq!(found.limbs[0].serial, !follows);
        assert_eq!(found.limbs[0].joints, joints);
        assert_eq!(found.twists.order(), 2);
    }
}

/// A joint that closes a loop and is actuated has a weld in a link, on a side that the order of its
/// links chooses: the screws of its limb do not depend on it.
#[test]
fn welds_of_cut_links_are_no_joints_of_limbs() {
    let limbs = |links: &str| {
        let text = format!(
            "dimension = 2\nreference = \"p\"\nreference_point = [0, 1]\n\
             [[joint]]\nname = \"q1\"\ntype = \"revolute\"\nbetween = [\"ground\", \"p\"]\n\
             origin = [0, 0]\nactuated = true\n\
             [[joint]]\nname = \"q2\"\ntype = \"revolute\"\nbetween = {links}\n\
             origin = [2, 0]\nactuated = true\n"
        );
        let m = cylindroid::load_text(&text, "two-hinges.toml".as_ref()).unwrap();
        assert!(m.loops()[0].name.ends_with(".weld"));
        screws(&m).limbs
    };
    for links in ["[\"ground\", \"p\"]", "[\"p\", \"ground\"]"] {
        let found = limbs(links);
        for (limb, name) in found.iter().zip(["q1", "q2"]) {
            assert_eq!(limb.joints, [name], "{links}");
            assert!(limb.serial && limb.constraint.order() == 2 && limb.actuation.order() == 1);
            // A couple: the angular velocity of its screw is a force.
            let force = limb.actuation.basis()[0].angular.norm();
            assert!(force < 1e-9, "{links}, {name}: {force}");
        }
    }
}
