//! Inverse kinematics among other bodies, and the reasons for misses.

use std::path::Path;

use cylindroid::collision::{CollisionModel, CollisionOptions};
use cylindroid::ik::{Goal, IkOptions, MissReason, Solver, Task, solve};
use cylindroid::model::{Geometry, JointLimits, Mechanism};
use cylindroid::{Pose, Rotation, Vec3};

use crate::support::{Random, unlimited};

fn from_text(text: &str) -> Mechanism {
    cylindroid::load_text(text, Path::new("robot.toml")).unwrap()
}

/// A panda with balls on elbow, wrist and hand.
fn panda() -> Mechanism {
    let ball = |link: &str, radius: f64| {
        format!("[[collision]]\nlink = \"{link}\"\nshape = \"sphere\"\nradius = {radius}\n")
    };
    let balls = [ball("link4", 0.09), ball("link6", 0.08), ball("flange", 0.06)].concat();
    from_text(&format!("name = \"panda\"\n[[robot]]\nmodel = \"panda\"\n{balls}"))
}

fn among(robot: &Mechanism, obstacles: &[(f64, Vec3)]) -> CollisionModel {
    let options = CollisionOptions { samples: 0, ..CollisionOptions::default() };
    let mut model = CollisionModel::new(robot, &options).unwrap();
    for (i, &(radius, at)) in obstacles.iter().enumerate() {
        let pose = Pose::from_translation(at);
        model.add_obstacle(&format!("ball {i}"), &Geometry::Sphere { radius }, pose).unwrap();
    }
    model
}

/// The elbow makes room for an obstacle that it would touch, the hand stays: all watched pairs are
/// at least the gap apart in every solution, also in the closest one.
#[test]
fn solutions_keep_the_gap() {
    let robot = panda();
    let gap = 0.02;
    let mut random = Random(71);
    let (mut alone, mut moved) = (0, 0);
    for nearest in [false, true] {
        for _ in 0..30 {
            let q = random.q(&robot);
            let state = robot.state(&q).unwrap();
            let goals = [Goal::pose(robot.tool(), state.pose(robot.tool()).unwrap())];
            let elbow = state.pose(robot.frame("link4").unwrap()).unwrap().translation;
            let away = Vec3::new(0.03, 0.02, -0.01);
            let model = among(&robot, &[(0.05, elbow + away)]);
            let options =
                IkOptions { nearest, initial_guess: Some(q.clone()), ..IkOptions::default() };
            let mut solver = Solver::new(&robot, &goals, &options).unwrap();
            solver.avoid(model.clone(), gap).unwrap();
            let found = solver.solve(&goals).unwrap();
            let (mut model, mut near) = (model, Vec::new());
            model.near(&robot.state(&found.q).unwrap(), gap, &mut near).unwrap();
            if found.success {
                assert!(near.is_empty() && found.reason.is_none(), "{near:?}");
                assert!(robot.outside_limits(&found.q).next().is_none());
                assert_eq!(found, solver.solve(&goals).unwrap(), "the same again");
                moved += 1;
            } else {
                let Some(MissReason::Collision { between, distance }) = &found.reason else {
                    panic!("{:?}", found.reason);
                };
                let closest = near.iter().map(|n| n.distance).fold(f64::INFINITY, f64::min);
                assert!((closest - distance).abs() < 1e-9 && *distance < gap, "{between:?}");
                alone += 1;
            }
        }
    }
    assert!(moved >= 45, "{moved} moved, {alone} misses");
}

/// A ball around the target is touched in every solution, and named.
#[test]
fn a_body_at_the_target_is_named() {
    let robot = panda();
    let target = robot.state(robot.home()).unwrap().pose(robot.tool()).unwrap();
    let goals = [Goal::pose(robot.tool(), target)];
    let mut solver = Solver::new(&robot, &goals, &IkOptions::default()).unwrap();
    solver.avoid(among(&robot, &[(0.1, target.translation)]), 0.0).unwrap();
    let found = solver.solve(&goals).unwrap();
    assert!(!found.success && found.position_error < 1e-5);
    let reason = found.reason.unwrap();
    let MissReason::Collision { between, distance } = &reason else { panic!("{reason:?}") };
    assert_eq!(between, &["flange".to_owned(), "ball 0".to_owned()]);
    assert!(*distance < 0.0 && reason.to_string().contains("flange and ball 0"), "{reason}");
    // Once the obstacle moves away, there are solutions.
    let far = Pose::from_translation(Vec3::new(0.0, 0.0, 9.0));
    solver.collision_model_mut().unwrap().move_obstacle("ball 0", far).unwrap();
    assert!(solver.solve(&goals).unwrap().success);
    assert!(solver.avoid(among(&robot, &[]), -1.0).unwrap_err().to_string().contains("gap"));
    let other = cylindroid::load("ur5e").unwrap();
    assert!(solver.avoid(among(&other, &[]), 0.0).is_err(), "shapes of another mechanism");
}

/// Beyond the limits of a joint, about an axis that no joint has, and beyond the chain.
#[test]
fn every_miss_has_its_reason() {
    let robot = from_text(
        r#"
        name = "pendulum"
        tool = "bob"
        [[joint]]
        name = "swing"
        type = "revolute"
        between = ["ground", "bob"]
        origin = [0.0, 0.0, 0.0]
        axis = [0.0, 0.0, 1.0]
        limits = { lower = -1.0, upper = 1.0 }
        "#,
    );
    let miss = |pose: Pose| {
        let found = solve(&robot, &[Goal::pose(robot.tool(), pose)], &IkOptions::default());
        let found = found.unwrap();
        assert!(!found.success && found.q[0].abs() <= 1.0);
        found.reason.unwrap()
    };
    let turned = |rotation: Rotation| Pose { rotation, translation: Vec3::ZERO };
    let reason = miss(turned(Rotation::about_z(1.5)));
    assert_eq!(reason, MissReason::Limits { joints: vec!["swing".to_owned()] });
    assert!(reason.to_string().starts_with("limits:"), "{reason}");
    let reason = miss(turned(Rotation::exp(Vec3::X * 0.5)));
    assert_eq!((&reason, reason.name()), (&MissReason::NotProven, "not proven"));
    let reason = miss(Pose::from_translation(Vec3::X));
    assert_eq!(reason, MissReason::OutOfReach { distance: 1.0, length: 0.0 });
}

/// The closest configuration is near a limit of the shoulder. Without limits it goes on through this one,
/// to an angle that is within them a full turn away: the elbow alone is too narrow.
#[test]
fn limits_that_a_full_turn_keeps_are_not_named() {
    for (lower, upper, start, target) in [
        (-3.1, 3.1, 3.0, [3.25, -0.5]),
        (-3.1, 3.1, -3.0, [-3.25, 0.5]),
        (0.1, 6.2, 0.2, [-0.15, 0.5]),
        (6.4, 12.5, 12.4, [12.7, -0.5]),
    ] {
        let robot = from_text(&format!(
            r#"
            name = "arm"
            dimension = 2
            tool = "hand"
            [[joint]]
            name = "shoulder"
            type = "revolute"
            between = ["ground", "upper"]
            origin = [0.0, 0.0]
            limits = {{ lower = {lower}, upper = {upper} }}
            [[joint]]
            name = "elbow"
            type = "revolute"
            between = ["upper", "hand"]
            origin = [1.0, 0.0]
            limits = {{ lower = -0.1, upper = 0.1 }}
            "#
        ));
        let free = unlimited(&robot);
        let state = free.state(&target).unwrap();
        let goals = [Goal::pose(robot.tool(), state.pose(free.tool()).unwrap())];
        let options = IkOptions { initial_guess: Some(vec![start, 0.0]), ..IkOptions::default() };
        let found = solve(&robot, &goals, &options).unwrap();
        let elbow = MissReason::Limits { joints: vec!["elbow".to_owned()] };
        assert_eq!(found.reason, Some(elbow), "{start}");
    }
}

/// The reason "limits" is true: without limits of the named joints the target is reached. Here
/// most targets are beyond the limits, which are two fifths of those of a panda.
#[test]
fn named_limits_are_those_to_widen() {
    let panda = cylindroid::load("panda").unwrap();
    let free = unlimited(&panda);
    let limited_to = |keeps: &dyn Fn(&str) -> bool| {
        let joints = panda.coordinates().iter().filter(|c| keeps(&c.name));
        let limits = joints.map(|c| {
            let middle = 0.5 * (c.limits.lower + c.limits.upper);
            let half = 0.2 * (c.limits.upper - c.limits.lower);
            let (lower, upper) = (Some(middle - half), Some(middle + half));
            (c.name.clone(), JointLimits { lower, upper, ..JointLimits::default() })
        });
        free.with_limits(&limits.collect::<Vec<_>>()).unwrap()
    };
    let narrow = limited_to(&|_| true);
    let mut random = Random(72);
    let (mut limited, mut confirmed) = (0, 0);
    for _ in 0..40 {
        let q: Vec<f64> = (0..7).map(|_| random.within(-2.5, 2.5)).collect();
        let target = free.state(&q).unwrap().pose(free.tool()).unwrap();
        let goals = [Goal::pose(narrow.tool(), target)];
        let found = solve(&narrow, &goals, &IkOptions::default()).unwrap();
        assert_eq!(found.success, found.reason.is_none());
        let Some(MissReason::Limits { joints }) = &found.reason else { continue };
        let wider = limited_to(&|name| !joints.iter().any(|j| j == name));
        let goals = [Goal::pose(wider.tool(), target)];
        limited += 1;
        confirmed += usize::from(solve(&wider, &goals, &IkOptions::default()).unwrap().success);
    }
    assert!(limited >= 20 && confirmed == limited, "{confirmed} of {limited}");
}

/// Two goals that exclude each other: the heavier one is missed by less, and a solution of goals
/// that agree does not depend on weights.
#[test]
fn weights_decide_between_goals() {
    let robot = from_text(
        r#"
        name = "slide"
        tool = "hand"
        [[joint]]
        name = "slide"
        type = "prismatic"
        between = ["ground", "hand"]
        axis = [1.0, 0.0, 0.0]
        limits = { lower = -5.0, upper = 5.0 }
        "#,
    );
    let at = |x: f64, weight: f64| {
        let target = Pose::from_translation(Vec3::X * x);
        Goal::frame(robot.tool(), Task::POSITION, target).with_weight(weight)
    };
    let options = IkOptions::default();
    let found = solve(&robot, &[at(0.0, 1.0), at(1.0, 3.0)], &options).unwrap();
    // The squares of the weights: 9 to 1.
    assert!(!found.success && (found.q[0] - 0.9).abs() < 1e-6, "{found:?}");
    let mut solver = Solver::new(&robot, &[at(0.0, 1.0), at(1.0, 3.0)], &options).unwrap();
    let swapped = solver.solve(&[at(0.0, 3.0), at(1.0, 1.0)]).unwrap();
    assert!((swapped.q[0] - 0.1).abs() < 1e-6, "{swapped:?}");
    assert!(solve(&robot, &[at(0.5, 1.0), at(0.5, 1e-3)], &options).unwrap().success);
    let error = solve(&robot, &[at(0.5, 0.0)], &options).unwrap_err().to_string();
    assert!(error.contains("weight"), "{error}");
}
