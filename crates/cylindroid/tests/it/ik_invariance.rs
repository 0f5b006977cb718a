//! The nearest configuration for a pose, with the arm elsewhere, turned and in other units of length.

use cylindroid::Vec3;
use cylindroid::ik::{Goal, IkOptions, solve};
use cylindroid::model::{JointKind, JointSpec, Limits, Link, Mechanism};
use cylindroid::spatial::{Pose, Rotation};

use crate::support::Random;

/// Rows of Craig's table: twist of the axis before [rad], its length and offset [m]; limits [rad].
type Row = [f64; 5];

const RIGHT: f64 = std::f64::consts::FRAC_PI_2;

/// The Panda: closed solutions for a locked joint.
const PANDA: [Row; 7] = [
    [0.0, 0.0, 0.333, -2.8973, 2.8973],
    [-RIGHT, 0.0, 0.0, -1.7628, 1.7628],
    [RIGHT, 0.0, 0.316, -2.8973, 2.8973],
    [RIGHT, 0.0825, 0.0, -3.0718, -0.0698],
    [-RIGHT, -0.0825, 0.384, -2.8973, 2.8973],
    [RIGHT, 0.0, 0.0, -0.0175, 3.7525],
    [RIGHT, 0.088, 0.0, -2.8973, 2.8973],
];

/// An arm of seven hinges in general position: the search alone.
const GENERAL: [Row; 7] = [
    [0.0, 0.0, 0.3, -2.9, 2.9],
    [-1.4, 0.05, 0.1, -1.9, 1.9],
    [1.5, 0.04, 0.35, -2.9, 2.9],
    [1.3, 0.1, -0.05, -2.6, 2.6],
    [-1.6, -0.07, 0.3, -2.9, 2.9],
    [1.2, 0.03, 0.06, -2.2, 2.2],
    [1.4, 0.09, 0.1, -2.9, 2.9],
];

/// Six hinges.
const UR5E: [Row; 6] = [
    [0.0, 0.0, 0.1625, -6.2, 6.2],
    [RIGHT, 0.0, 0.0, -6.2, 6.2],
    [0.0, -0.425, 0.0, -3.0, 3.0],
    [0.0, -0.3922, 0.1333, -6.2, 6.2],
    [RIGHT, 0.0, 0.0997, -6.2, 6.2],
    [-RIGHT, 0.0, 0.0996, -6.2, 6.2],
];

/// The arm at a place of the world, `size` new units of length in a metre.
fn arm(rows: &[Row], world: Pose, size: f64) -> Mechanism {
    let mut builder = Mechanism::builder("arm");
    let mut parent = "world".to_owned();
    for (i, [twist, length, offset, lower, upper]) in rows.iter().copied().enumerate() {
        let link = format!("link{i}");
        builder.link(Link::named(&link));
        let mut joint = JointSpec::new(&format!("joint{i}"), JointKind::Revolute, &parent, &link);
        let bent = Pose {
            rotation: Rotation::exp(Vec3::X * twist),
            translation: Vec3::X * (length * size),
        };
        let before = if i == 0 { world } else { Pose::IDENTITY };
        joint.parent_from_joint = before * bent * Pose::from_translation(Vec3::Z * (offset * size));
        joint.axis = Vec3::Z;
        joint.limits = Limits { lower, upper, ..Limits::NONE };
        builder.joint(joint);
        parent = link;
    }
    builder.build().unwrap()
}

#[test]
fn the_nearest_answer_in_other_frames_and_units() {
    let mut random = Random(73);
    for rows in [&PANDA[..], &GENERAL, &UR5E] {
        let own = arm(rows, Pose::IDENTITY, 1.0);
        for (round, size) in [1.0, 1e-3, 39.37, 1000.0].into_iter().cycle().take(24).enumerate() {
            let world = random.pose();
            let world = Pose { translation: world.translation * size, ..world };
            let other = arm(rows, world, size);
            let known = random.q(&own);
            let start: Vec<f64> = known.iter().map(|x| x + random.within(-0.5, 0.5)).collect();
            let nearest = |robot: &Mechanism, size: f64| {
                let target = robot.state(&known).unwrap().pose(robot.tool()).unwrap();
                let default = IkOptions::default();
                let options = IkOptions {
                    initial_guess: Some(start.clone()),
                    nearest: true,
                    position_tolerance: 1e-9 * size,
                    orientation_tolerance: 1e-9,
                    ..default
                };
                solve(robot, &[Goal::pose(robot.tool(), target)], &options).unwrap()
            };
            let (here, there) = (nearest(&own, 1.0), nearest(&other, size));
            assert!(here.success && there.success, "{round}: {here:?} {there:?}");
            for (a, b) in here.q.iter().zip(&there.q) {
                assert!((a - b).abs() < 1e-5, "{round} {size}: {:?} {:?}", here.q, there.q);
            }
        }
    }
}
