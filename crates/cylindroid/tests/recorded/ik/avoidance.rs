//! Solutions among other bodies.

use cylindroid::collision::{CollisionModel, CollisionOptions};
use cylindroid::ik::{Goal, Solver, Task};
use cylindroid::model::Geometry;
use cylindroid::{Mechanism, Pose};

use super::{beside, note, options};
use crate::record::check;
use crate::robots::{Random, robot};

/// Balls about the links of a configuration.
fn obstacles(random: &mut Random<'_>, robot: &Mechanism, q: &[f64]) -> CollisionModel {
    let options = CollisionOptions { samples: 0, ..CollisionOptions::default() };
    let mut model = CollisionModel::new(robot, &options).unwrap();
    let state = robot.state(q).unwrap();
    for i in 0..1 + random.below(2) {
        let link = robot.frame(&format!("l{}", 1 + random.below(robot.n()))).unwrap();
        let at = state.pose(link).unwrap().translation + random.vec3(0.12);
        let geometry = Geometry::Sphere { radius: random.within(0.02, 0.07) };
        model.add_obstacle(&format!("ball {i}"), &geometry, Pose::from_translation(at)).unwrap();
    }
    model
}

#[test]
fn among_balls() {
    check("ik_avoidance", 160, |random, record| {
        let robot = robot(random, true);
        let q = random.configuration(&robot);
        let model = obstacles(random, &robot, &q);
        let target = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
        let components = [Task::POSITION, Task::ORIENTATION, Task::POINTING][random.below(3)];
        let goals = [Goal::frame(robot.tool(), components, target)];
        let mut options = options(random, &robot, 0.5);
        options.nearest = random.once_in(3);
        options.budget.iterations = options.budget.iterations.min(120);
        if random.once_in(2) {
            options.initial_guess = Some(beside(random, &robot, &q, 0.1));
        }
        let mut solver = Solver::new(&robot, &goals, &options).unwrap();
        solver.avoid(model, random.within(0.0, 0.06)).unwrap();
        let found = solver.solve(&goals).unwrap();
        note(record, &found, 0.1);
        if random.once_in(4) {
            record.word(&found.reason.map(|reason| reason.to_string()));
        }
        let model = solver.collision_model_mut().unwrap();
        let away = Pose::from_translation(random.vec3(0.3));
        model.move_obstacle("ball 0", away).unwrap();
        note(record, &solver.solve(&goals).unwrap(), 0.1);
    });
}

#[test]
fn gaps() {
    check("ik_gaps", 1, |random, record| {
        let arm = robot(random, true);
        let q = random.configuration(&arm);
        let goals = [Goal::pose(arm.tool(), arm.state(&q).unwrap().pose(arm.tool()).unwrap())];
        let options = options(random, &arm, 0.5);
        let mut solver = Solver::new(&arm, &goals, &options).unwrap();
        for gap in [0.0, 0.1, -1e-9, -1.0, f64::NAN, f64::INFINITY] {
            let model = obstacles(random, &arm, &q);
            record.word(&solver.avoid(model, gap).map_err(|error| error.to_string()));
        }
    });
}
