//! The closest solution: along the self-motion, and over all branches of a closed form.

use std::f64::consts::PI;

use cylindroid::collision::{CollisionModel, CollisionOptions};
use cylindroid::ik::{Budget, Goal, HalfSpace, IkOptions, Solver, Task, solve};
use cylindroid::model::{Geometry, JointKind, JointLimits, Limits};
use cylindroid::{Mechanism, Pose, catalogue};

use super::arms::{chain, general, seven};
use super::{beside, note, options};
use crate::record::check;
use crate::robots::Random;

/// A Panda or an iiwa, with narrower limits in a few cases.
fn known(random: &mut Random<'_>) -> Mechanism {
    let robot = catalogue::load(["panda", "iiwa14"][random.below(2)]).unwrap();
    if random.once_in(3) { narrowed(random, &robot, 0.4) } else { robot }
}

/// Limits that leave out a share of the range at both ends, at most this.
fn narrowed(random: &mut Random<'_>, robot: &Mechanism, most: f64) -> Mechanism {
    let limits: Vec<(String, JointLimits)> = robot
        .coordinates()
        .iter()
        .map(|c| {
            let room = c.limits.upper - c.limits.lower;
            let lower = Some(c.limits.lower + random.within(0.5 * most, most) * room);
            let upper = Some(c.limits.upper - random.within(0.5 * most, most) * room);
            (c.name.clone(), JointLimits { lower, upper, ..JointLimits::default() })
        })
        .collect();
    robot.with_limits(&limits).unwrap()
}

/// Limits just beside a configuration, of three joints.
fn about(random: &mut Random<'_>, robot: &Mechanism, q: &[f64]) -> Mechanism {
    let mut limits = Vec::new();
    for _ in 0..3 {
        let i = random.below(7);
        let c = &robot.coordinates()[i];
        let lower = (q[i] - random.power(-4.0, -1.5)).max(c.limits.lower);
        let upper = (q[i] + random.power(-4.0, -1.5)).min(c.limits.upper);
        let own = JointLimits { lower: Some(lower), upper: Some(upper), ..JointLimits::default() };
        limits.push((c.name.clone(), own));
    }
    robot.with_limits(&limits).unwrap_or_else(|_| robot.clone())
}

/// A configuration with joints at limits, and next to singularities.
fn hard(random: &mut Random<'_>, robot: &Mechanism) -> Vec<f64> {
    let q = random.configuration(robot);
    let mut one = |(x, l): (&f64, &Limits)| {
        let near = random.within(-0.05, 0.05);
        if random.once_in(4) && l.lower < near && near < l.upper { near } else { *x }
    };
    q.iter().zip(robot.coordinates()).map(|(x, c)| one((x, &c.limits))).collect()
}

/// Options of the closest solution: few steps beyond a tolerance show the way of a descent.
fn closest(random: &mut Random<'_>, robot: &Mechanism, size: f64) -> IkOptions {
    let exact = random.once_in(3);
    let mut tolerance = || if exact { 1e-6 } else { random.power(-4.0, -1.5) };
    let (position_tolerance, orientation_tolerance) = (size * tolerance(), tolerance());
    let start = random.configuration(robot);
    let posture = random.once_in(4).then(|| random.configuration(robot));
    let iterations = if random.once_in(5) { 1 + random.below(60) } else { 4000 };
    IkOptions {
        position_tolerance,
        orientation_tolerance,
        nearest: posture.is_none(),
        initial_guess: Some(start),
        posture,
        seed: random.below(1000) as u64,
        budget: Budget { iterations, time: None },
        ..IkOptions::default()
    }
}

fn branches(name: &str, cases: u64, robot: impl Fn(&mut Random<'_>) -> Mechanism) {
    check(name, cases, |random, record| {
        let robot = robot(random);
        let q = hard(random, &robot);
        let target = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
        let mut options = closest(random, &robot, robot.reach());
        if random.once_in(5) {
            let far = random.power(-2.0, 0.3);
            options.initial_guess = Some(beside(random, &robot, &q, far));
        }
        let goals = [Goal::pose(robot.tool(), target)];
        let mut solver = Solver::new(&robot, &goals, &options).unwrap();
        note(record, &solver.solve(&goals).unwrap(), robot.reach());
    });
}

#[test]
fn branches_of_known_arms() {
    branches("ik_branches", 400, known);
}

#[test]
fn branches_of_random_arms() {
    branches("ik_branches_random", 360, |random| {
        let size = random.power(-1.0, 1.0);
        seven(random, size)
    });
}

/// Half-spaces in which the closest solution may not be: the descents of all places count.
#[test]
fn branches_within_half_spaces() {
    check("ik_branches_half_spaces", 100, |random, record| {
        let robot = known(random);
        let q = hard(random, &robot);
        let state = robot.state(&q).unwrap();
        let elbow = robot.frame(["link4", "link_4"][usize::from(robot.name() == "iiwa14")]);
        let end_effector = elbow.unwrap_or(robot.tool()).into();
        let normal = random.vec3(1.0);
        let point = state.pose(end_effector).unwrap().translation;
        let mut options = closest(random, &robot, robot.reach());
        options.half_spaces =
            vec![HalfSpace { name: "elbow".to_owned(), end_effector, point, normal }];
        let goals = [Goal::pose(robot.tool(), state.pose(robot.tool()).unwrap())];
        note(record, &solve(&robot, &goals, &options).unwrap(), robot.reach());
    });
}

/// Balls near the links of a configuration that reaches the target: solutions are refused.
#[test]
fn branches_among_balls() {
    check("ik_branches_balls", 160, |random, record| {
        let robot = seven(random, 1.0);
        let q = hard(random, &robot);
        let state = robot.state(&q).unwrap();
        let free = CollisionOptions { samples: 0, ..CollisionOptions::default() };
        let mut model = CollisionModel::new(&robot, &free).unwrap();
        for i in 0..1 + random.below(2) {
            let link = robot.frame(&format!("l{}", 3 + random.below(5))).unwrap();
            let at = state.pose(link).unwrap().translation + random.vec3(0.05);
            let geometry = Geometry::Sphere { radius: random.within(0.02, 0.06) };
            let pose = Pose::from_translation(at);
            model.add_obstacle(&format!("ball {i}"), &geometry, pose).unwrap();
        }
        let mut options = closest(random, &robot, 1.0);
        options.budget.iterations = options.budget.iterations.min(200);
        let goals = [Goal::pose(robot.tool(), state.pose(robot.tool()).unwrap())];
        let mut solver = Solver::new(&robot, &goals, &options).unwrap();
        solver.avoid(model, random.within(0.0, 0.03)).unwrap();
        note(record, &solver.solve(&goals).unwrap(), 0.1);
    });
}

/// Targets with few solutions within the limits, or none: branches are sampled after 64 restarts.
#[test]
fn samples_after_restarts() {
    check("ik_late_samples", 120, |random, record| {
        let robot = known(random);
        let q: Vec<f64> = (0..7).map(|_| random.within(-2.8, 2.8)).collect();
        let (robot, q) = if random.once_in(3) {
            (narrowed(random, &robot, 0.35), q)
        } else {
            let q = hard(random, &robot);
            (about(random, &robot, &q), q)
        };
        let target = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
        let mut options = closest(random, &robot, robot.reach());
        options.nearest = random.once_in(3);
        options.posture = None;
        options.position_tolerance = 1e-6;
        options.orientation_tolerance = 1e-6;
        options.budget.iterations = 3000;
        let goals = [Goal::pose(robot.tool(), target)];
        note(record, &solve(&robot, &goals, &options).unwrap(), robot.reach());
    });
}

/// Descents of general chains, without a closed form.
#[test]
fn descents() {
    check("ik_descents", 200, |random, record| {
        let (n, size) = (3 + random.below(6), random.power(-1.0, 1.0));
        let simple = !random.once_in(4);
        let robot = general(random, n, size, simple);
        let q = random.configuration(&robot);
        let far = random.power(-1.5, 0.3);
        let start = beside(random, &robot, &q, far);
        let target = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
        let components = [Task::POSITION, Task::ORIENTATION, Task::POINTING][random.below(3)];
        let mut options = options(random, &robot, size);
        (options.nearest, options.initial_guess) = (true, Some(start));
        options.posture = random.once_in(4).then(|| random.configuration(&robot));
        let goals = [Goal::frame(robot.tool(), components, target)];
        note(record, &solve(&robot, &goals, &options).unwrap(), size);
    });
}

/// A guess several turns away from zero, with limits beyond and within.
#[test]
fn turns_of_seven_hinges() {
    check("ik_branches_turned", 120, |random, record| {
        let mut axes = Vec::new();
        let panda = catalogue::load("panda").unwrap();
        let state = panda.state(&[0.0; 7]).unwrap();
        for i in 1..8 {
            let pose = state.pose(panda.frame(&format!("link{i}")).unwrap()).unwrap();
            let half = random.within(3.0, 9.0);
            let middle = random.within(-2.0, 2.0);
            let own = Limits { lower: middle - half, upper: middle + half, ..Limits::NONE };
            let kind = JointKind::Revolute;
            axes.push((pose.rotation.z_axis(), pose.translation, kind, own));
        }
        let robot = chain(&axes, random.pose(1.0), state.pose(panda.tool()).unwrap());
        let q: Vec<f64> = (0..7).map(|_| random.within(-PI, PI)).collect();
        let target = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
        let turned = q.iter().map(|x| x + random.within(-6.0, 6.0)).collect();
        let mut options = closest(random, &robot, 1.0);
        options.initial_guess = Some(turned);
        let goals = [Goal::pose(robot.tool(), target)];
        note(record, &solve(&robot, &goals, &options).unwrap(), 1.0);
    });
}
