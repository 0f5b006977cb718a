//! A joint that closes a loop keeps its limits, whichever joint of the loop that is.

use std::path::Path;

use cylindroid::closure::{ClosedChain, MobilityCounts, MotionSpace, assemble};
use cylindroid::control::Target;
use cylindroid::model::formats;
use cylindroid::{Mechanism, Pose, Servo, ServoOptions, Vec3};

/// Joints of a four-bar with the crank first, their kinds and places.
const JOINTS: [(&str, &str, &str); 4] = [
    ("crank", "[\"ground\", \"left\"]", "[0.0, 0.0]"),
    ("elbow", "[\"left\", \"coupler\"]", "[0.0, 1.0]"),
    ("rocker", "[\"coupler\", \"right\"]", "[2.0, 1.5]"),
    ("pivot", "[\"right\", \"ground\"]", "[2.0, 0.0]"),
];

fn read(text: &str) -> Mechanism {
    formats::toml::parse(text, Path::new("four-bar.toml")).unwrap()
}

/// The four-bar with limits of these joints, its tables from `first` on.
fn four_bar(limits: &[(&str, &str)], first: usize) -> Mechanism {
    let mut text = "dimension = 2\nreference = \"coupler\"\n".to_owned();
    for i in 0..JOINTS.len() {
        let (name, between, origin) = JOINTS[(first + i) % JOINTS.len()];
        text += &format!(
            "[[joint]]\nname = \"{name}\"\ntype = \"revolute\"\nbetween = {between}\norigin = {origin}\n\
             actuated = {}\n",
            name == "crank"
        );
        if let Some((_, limits)) = limits.iter().find(|l| l.0 == name) {
            text += &format!("limits = {limits}\n");
        }
    }
    read(&text)
}

/// Mobility counts (but the rank, to which coordinates of a cut link add), degrees of freedom,
/// the Gruebler-Kutzbach count, hyperstaticity.
fn counts(mechanism: &Mechanism) -> (MobilityCounts, usize, i64, usize) {
    let state = mechanism.state(mechanism.home()).unwrap();
    let chain = ClosedChain::of(&state, None, None).unwrap();
    let motions = MotionSpace::of(&chain.constraint);
    let counts = MobilityCounts { rank: 0, ..MobilityCounts::of(&motions, &motions.relation()) };
    (counts, motions.dof(), motions.gruebler_kutzbach(), motions.hyperstatic())
}

/// The range of the joint while the crank goes round as far as it can, by the servo.
fn range(mechanism: &Mechanism, joint: &str) -> [f64; 2] {
    let place = mechanism.coordinates().iter().position(|c| c.name == joint).unwrap();
    let mut range = [f64::INFINITY, f64::NEG_INFINITY];
    for side in [-1.0, 1.0] {
        let mut options = ServoOptions::new(mechanism);
        options.dt = 0.01;
        let mut servo = Servo::new(mechanism, options).unwrap();
        let mut q = mechanism.home().to_vec();
        let end_effector = servo.options().end_effector;
        for _ in 0..600 {
            let now = mechanism.state(&q).unwrap().pose(end_effector).unwrap();
            // Ahead of the coupler on its way round the crank's pivot.
            let away = Vec3::new(now.translation.y, -now.translation.x, 0.0) * (0.2 * side);
            let target = Pose { translation: now.translation + away, ..now };
            servo.step(&q, Target::from(target)).unwrap();
            servo.advance(&mut q);
            range = [range[0].min(q[place]), range[1].max(q[place])];
            for (coordinate, q) in mechanism.coordinates().iter().zip(&q) {
                let l = coordinate.limits;
                let is_within = *q >= l.lower - 1e-9 && *q <= l.upper + 1e-9;
                assert!(is_within, "{} at {q}", coordinate.name);
            }
        }
    }
    range
}

/// Limits of each joint in turn hold, and neither the order of the tables nor the joint that closes
/// the loop matters.
#[test]
fn limits_of_every_joint_of_a_loop_hold() {
    for (joint, _, _) in JOINTS {
        let free = four_bar(&[(joint, "{ velocity = 10 }")], 0);
        assert!(free.coordinates().iter().any(|c| c.name == joint), "{joint}");
        let wide = range(&free, joint);
        assert!(wide[1] - wide[0] > 0.3, "{joint}: {wide:?}");
        for first in 0..JOINTS.len() {
            let limits = "{ lower = -0.05, upper = 0.1, velocity = 10 }";
            let bounded = four_bar(&[(joint, limits)], first);
            let narrow = range(&bounded, joint);
            assert!(narrow[0] >= -0.05 - 1e-9 && narrow[1] <= 0.1 + 1e-9, "{joint}: {narrow:?}");
            assert!(narrow[0] < -0.04 && narrow[1] > 0.09, "{joint}: {narrow:?}");
        }
    }
}

/// With limits of all joints one of them closes the loop; it has a coordinate, and all counts are
/// those of the mechanism without limits.
#[test]
fn mobility_is_that_without_limits() {
    let plain = four_bar(&[], 0);
    let limits = "{ lower = -0.5, upper = 0.5 }";
    let all = JOINTS.map(|(joint, _, _)| (joint, limits));
    let bounded = four_bar(&all, 0);
    assert_eq!((plain.n(), bounded.n()), (3, 4));
    let names: Vec<&str> = bounded.coordinates().iter().map(|c| c.name.as_str()).collect();
    assert!(JOINTS.iter().all(|(joint, _, _)| names.contains(joint)), "{names:?}");
    assert_eq!(counts(&plain), counts(&bounded));
    let crank = names.iter().position(|n| *n == "crank").unwrap();
    // An angle of the crank at which another joint would leave its limits.
    let mut guess = vec![0.0; 4];
    guess[crank] = 0.5;
    let assembly = assemble(&bounded, &guess, &[crank]).unwrap();
    let within = assembly.q.iter().all(|q| (-0.5..=0.5).contains(q));
    assert!(within, "{:?}", assembly.q);
    let near = assemble(&bounded, &[0.05; 4], &[crank]).unwrap();
    assert!(near.closed && near.q.iter().all(|q| q.abs() < 0.5), "{near:?}");
}

/// Without a name for it, the tool is on the same link whichever link of a joint is written first, and
/// whether all joints are actuated or one.
#[test]
fn the_default_tool_does_not_depend_on_the_joint_that_closes() {
    for (swapped, _, _) in JOINTS {
        for all_actuated in [false, true] {
            let mut text = "dimension = 2\n".to_owned();
            for (name, between, origin) in JOINTS {
                let [a, b] = between[1..between.len() - 1].split_once(", ").unwrap().into();
                let [a, b] = if name == swapped { [b, a] } else { [a, b] };
                let actuated = all_actuated || name == "crank";
                text += &format!(
                    "[[joint]]\nname = \"{name}\"\ntype = \"revolute\"\nbetween = [{a}, {b}]\n\
                     origin = {origin}\nactuated = {actuated}\n",
                );
            }
            let mechanism = read(&text);
            assert_eq!(mechanism.n(), if all_actuated { 4 } else { 3 });
            assert_eq!(mechanism.frame_of(mechanism.tool()).name, "coupler", "{text}");
        }
    }
}

/// Loops of spatial joints with limits: the ball of a strut.
#[test]
fn loops_in_space_are_cut_in_a_link() {
    let strut = |limits: &str| {
        read(&format!(
            "reference = \"plate\"\n\
             [[joint]]\nname = \"base\"\ntype = \"universal\"\nbetween = [\"ground\", \"plate\"]\n\
             origin = [0, 0, 1]\naxis = [1, 0, 0]\naxis2 = [0, 1, 0]\n\
             [[joint]]\nname = \"foot\"\ntype = \"universal\"\nbetween = [\"ground\", \"rod\"]\n\
             origin = [0.5, 0, 0]\naxis = [1, 0, 0]\naxis2 = [0, 1, 0]\n{limits}\
             [[joint]]\nname = \"slide\"\ntype = \"prismatic\"\nbetween = [\"rod\", \"piston\"]\n\
             axis = [0, 0, 1]\nactuated = true\n{limits}\
             [[joint]]\nname = \"turn\"\ntype = \"revolute\"\nbetween = [\"piston\", \"fork\"]\n\
             axis = [0, 0, 1]\norigin = [0.5, 0, 0.5]\n{limits}\
             [[joint]]\nname = \"top\"\ntype = \"universal\"\nbetween = [\"fork\", \"plate\"]\n\
             origin = [0.5, 0, 1]\naxis = [1, 0, 0]\naxis2 = [0, 1, 0]\n{limits}"
        ))
    };
    let plain = strut("");
    let bounded = strut("limits = { lower = -0.4, upper = 0.4 }\n");
    assert!(bounded.n() > plain.n());
    assert_eq!(counts(&plain), counts(&bounded));
    let length = |m: &Mechanism| m.reach();
    assert!((length(&plain) - length(&bounded)).abs() < 1e-12);
}
