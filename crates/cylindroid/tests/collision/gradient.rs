//! The gradient of distances against finite differences, and the laws of a model of all pairs.

use cylindroid::collision::{CollisionModel, CollisionOptions};
use cylindroid::model::Geometry;
use cylindroid::{Mechanism, Pose, Vec3};

use crate::shapes::{KINDS, arm, shape};
use crate::support::Random;

fn model(robot: &Mechanism, random: &mut Random) -> CollisionModel {
    let options = CollisionOptions { samples: 0, ..CollisionOptions::default() };
    let mut model = CollisionModel::new(robot, &options).unwrap();
    for kind in 0..KINDS {
        let obstacle = shape(random, kind);
        let pose = Pose { translation: random.vec3(1.0), rotation: random.rotation() };
        model.add_obstacle(&format!("obstacle {kind}"), &obstacle, pose).unwrap();
    }
    model
}

#[test]
fn gradients_agree_with_finite_differences() {
    let mut random = Random(3);
    let (mut compared, mut close) = (0, 0);
    for round in 0..12 {
        let kinds: Vec<usize> = (0..6).map(|i| (i + round) % 6).collect();
        let robot = arm(&mut random, &kinds);
        let mut model = model(&robot, &mut random);
        for _ in 0..6 {
            let q = random.q(&robot);
            let mut state = robot.state(&q).unwrap();
            let mut near = Vec::new();
            model.near(&state, f64::INFINITY, &mut near).unwrap();
            assert_eq!(near.len(), model.pairs().len());
            for pair in near {
                state.set(&q).unwrap();
                let row = model.gradient(&state, &pair);
                let mut at = |x: f64, j: usize| {
                    let mut moved = q.clone();
                    moved[j] += x;
                    let mut found = Vec::new();
                    state.set(&moved).unwrap();
                    model.near(&state, f64::INFINITY, &mut found).unwrap();
                    found[pair.pair]
                };
                for (j, slope) in row.into_iter().enumerate() {
                    let step = 1e-5;
                    let (low, high) = (at(-step, j), at(step, j));
                    // At a kink the normal jumps.
                    if (low.normal - high.normal).norm() > 1e-2 {
                        continue;
                    }
                    let difference = (high.distance - low.distance) / (2.0 * step);
                    // The distance of curved shapes is known to 5e-8 of itself.
                    assert!((difference - slope).abs() < 2e-2, "{pair:?} {j} {slope} {difference}");
                    compared += 1;
                    close += usize::from((difference - slope).abs() < 1e-6);
                }
            }
        }
    }
    assert!(compared > 10_000 && close * 10 > 9 * compared, "{compared} {close}");
}

#[test]
fn obstacles_come_move_and_go() {
    let mut random = Random(8);
    let robot = arm(&mut random, &[0, 1, 2, 3]);
    let options = CollisionOptions { samples: 0, ..CollisionOptions::default() };
    let mut model = CollisionModel::new(&robot, &options).unwrap();
    let own = model.pairs().len();
    let state = robot.state(&random.q(&robot)).unwrap();
    let all = |model: &mut CollisionModel| {
        let mut near = Vec::new();
        model.near(&state, f64::INFINITY, &mut near).unwrap();
        near
    };
    let before = all(&mut model);
    let ball = Geometry::Sphere { radius: 0.1 };
    let hull = Geometry::ConvexHull {
        points: (0..30).map(|_| random.vec3(0.1) + Vec3::X * 5.0).collect(),
    };
    model.add_obstacle("first", &ball, Pose::IDENTITY).unwrap();
    model.add_obstacle("second", &hull, Pose::IDENTITY).unwrap();
    assert_eq!(model.obstacles().collect::<Vec<_>>(), ["first", "second"]);
    assert_eq!(model.pairs().len(), own + 8);
    assert!(model.add_obstacle("first", &ball, Pose::IDENTITY).is_err());
    let moved = random.pose();
    model.move_obstacle("second", moved).unwrap();
    let there = all(&mut model);

    let mut fresh = CollisionModel::new(&robot, &options).unwrap();
    fresh.add_obstacle("second", &hull, moved).unwrap();
    model.remove_obstacle("first").unwrap();
    assert_eq!(model.pairs(), fresh.pairs());
    assert_eq!(all(&mut model), all(&mut fresh));
    assert_eq!(all(&mut model)[own..].len(), 4);
    for (x, y) in all(&mut model)[own..].iter().zip(&there[own + 4..]) {
        assert_eq!(x.distance, y.distance);
    }
    assert_eq!(model.names(own), ["link0", "second"]);
    model.remove_obstacle("second").unwrap();
    assert_eq!(all(&mut model), before);
    let error = model.move_obstacle("secnd", moved).unwrap_err().to_string();
    assert!(error.contains("obstacle"), "{error}");
    assert!(model.remove_obstacle("second").is_err());
}

/// The margin selects among all pairs, and drops none that is nearer.
#[test]
fn near_pairs_are_those_within_the_margin() {
    let mut random = Random(17);
    let robot = arm(&mut random, &[0, 1, 2, 3, 4, 5]);
    let mut model = model(&robot, &mut random);
    for _ in 0..50 {
        let state = robot.state(&random.q(&robot)).unwrap();
        let (mut all, mut near) = (Vec::new(), Vec::new());
        model.near(&state, f64::INFINITY, &mut all).unwrap();
        for margin in [-0.05, 0.0, 0.1, 0.5] {
            model.near(&state, margin, &mut near).unwrap();
            let expected: Vec<_> = all.iter().copied().filter(|p| p.distance <= margin).collect();
            assert_eq!(near, expected);
        }
    }
    let other = cylindroid::load("panda").unwrap();
    let state = other.state(other.home()).unwrap();
    assert!(model.near(&state, 0.1, &mut Vec::new()).is_err());
    let state = robot.state(robot.home()).unwrap();
    assert!(model.near(&state, f64::NAN, &mut Vec::new()).is_err());
}
