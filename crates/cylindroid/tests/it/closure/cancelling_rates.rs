//! Loops around which all rates cancel: hinges on one axis, parallel slides. Tilted, rounding is what
//! remains of them.

use std::path::Path;

use cylindroid::closure::{
    ActuationMap, ContinuationOptions, FiniteMobility, ModeOptions, PathEnd, assemble,
    assembly_modes, operation_modes, track_path,
};
use cylindroid::spatial::Vec3;
use cylindroid::{Mechanism, Servo, ServoOptions, Twist};

use crate::support::Random;

const ROUNDS: usize = 50;

/// Joints along one axis: name, kind, links, place.
type Joint = (String, &'static str, [&'static str; 2], Vec3);

fn mechanism(axis: Vec3, reference: &str, joints: &[Joint]) -> Mechanism {
    let list = |v: Vec3| format!("[{:?}, {:?}, {:?}]", v.x, v.y, v.z);
    let mut text = format!("reference = \"{reference}\"\nreference_point = [0.3, 0.5, -0.2]\n");
    for (i, (name, kind, [a, b], place)) in joints.iter().enumerate() {
        text += &format!(
            "[[joint]]\nname = \"{name}\"\ntype = \"{kind}\"\nbetween = [\"{a}\", \"{b}\"]\n\
             origin = {}\naxis = {}\nactuated = {}\n",
            list(*place),
            list(axis),
            i == 0
        );
    }
    cylindroid::load_text(&text, Path::new("cancelling.toml")).unwrap()
}

/// Rigid joints would remain, were rounding no zero: all functions see `dof` motions, one of them
/// actuated.
fn check(what: &str, m: &Mechanism, dof: usize, twist: Twist) {
    let state = m.state(m.home()).unwrap();
    let found = FiniteMobility::of(&state, None).unwrap();
    assert_eq!((found.infinitesimal, found.finite), (dof, Some(dof)), "{what}");
    assert!(found.certain && found.shaky.cols() == 0, "{what}");
    let map = ActuationMap::of(&state, &[], &[]).unwrap();
    assert_eq!((map.motions.cols(), map.uncontrolled.cols()), (1, dof - 1), "{what}");
    assert!(map.correction.iter().all(|x| x.abs() < 1e-9), "{what}: {:?}", map.correction);

    let options = ModeOptions { starts: 4, ..ModeOptions::default() };
    let modes = operation_modes(m, m.home(), None, options).unwrap();
    let dimensions: Vec<usize> = modes.modes.iter().map(|mode| mode.dimension).collect();
    assert_eq!((dimensions, modes.undecided, modes.closed), (vec![dof], 0, 4), "{what}");
    let modes = assembly_modes(m, m.home(), &[], options).unwrap();
    assert_eq!((modes.modes.len(), modes.self_motion_dof()), (1, dof), "{what}");
    let guess: Vec<f64> = m.home().iter().map(|x| x + 0.3).collect();
    let assembly = assemble(m, &guess, &[]).unwrap();
    let apart = assembly.q.iter().zip(&guess).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(assembly.closed && apart < 1e-9, "{what}: {apart:e}");
    let actuated: Vec<usize> = m.actuated().collect();
    let options = ContinuationOptions::default();
    let path = track_path(m, m.home(), &actuated, &[0.4], options).unwrap();
    assert!(matches!(path.end, PathEnd::Reached), "{what}: {:?}", path.end);

    let mut servo = Servo::new(m, ServoOptions::new(m)).unwrap();
    let step = servo.step_twist(m.home(), Some(twist)).unwrap();
    let size = |t: Twist| t.linear.norm() + t.angular.norm();
    assert!(size(step.achieved) > 1e-6 * size(twist), "{what}: {step:?}");
}

#[test]
fn hinges_on_one_axis_are_one_hinge() {
    let mut random = Random(61);
    for round in 0..ROUNDS {
        for count in 2..=5 {
            let axis = random.rotation() * Vec3::Z;
            let place = random.vec3(1.0);
            let joints: Vec<Joint> = (0..count)
                .map(|i| {
                    let at = place + axis * random.within(-1.0, 1.0);
                    (format!("hinge{i}"), "revolute", ["ground", "door"], at)
                })
                .collect();
            let m = mechanism(axis, "door", &joints);
            let point = Vec3::new(0.3, 0.5, -0.2);
            let twist = Twist { linear: axis.cross(point - place), angular: axis };
            check(&format!("{count} hinges, round {round}"), &m, 1, twist);
        }
    }
}

#[test]
fn parallel_slides_are_one_slide() {
    let mut random = Random(62);
    for round in 0..ROUNDS {
        for count in 2..=3 {
            let axis = random.rotation() * Vec3::Z;
            let joints: Vec<Joint> = (0..count)
                .map(|i| {
                    let links = ["ground", "carriage"];
                    (format!("rail{i}"), "prismatic", links, random.vec3(1.0))
                })
                .collect();
            let m = mechanism(axis, "carriage", &joints);
            let twist = Twist { linear: axis, angular: Vec3::ZERO };
            check(&format!("{count} slides, round {round}"), &m, 1, twist);
        }
    }
}

/// The inner link turns by itself as well.
#[test]
fn hinges_and_a_cylindrical_joint_on_one_axis() {
    let mut random = Random(63);
    for round in 0..ROUNDS {
        let axis = random.rotation() * Vec3::Z;
        let place = random.vec3(1.0);
        let mut at = || place + axis * random.within(-1.0, 1.0);
        let joints: Vec<Joint> = vec![
            ("q1".to_owned(), "revolute", ["ground", "a"], at()),
            ("q2".to_owned(), "cylindrical", ["a", "b"], at()),
            ("q3".to_owned(), "revolute", ["b", "ground"], at()),
        ];
        let m = mechanism(axis, "a", &joints);
        let point = Vec3::new(0.3, 0.5, -0.2);
        let twist = Twist { linear: axis.cross(point - place), angular: axis };
        check(&format!("round {round}"), &m, 2, twist);
    }
}
