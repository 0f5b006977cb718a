//! Public functions of the module.

use super::prelude::*;

calls! {
    ik::Analytic::coordinates;
    ik::Analytic::geometry;
    ik::Analytic::is_exact;
    ik::Analytic::locked;
    ik::Analytic::of = |m: &'static Mechanism, of: EndEffector| Analytic::of(m, of).ok();
    ik::Analytic::solve;
    ik::Analytic::with_full_turns;
    ik::Analytic::with_locked = |m: &'static Mechanism, of: EndEffector, locked: &'static [usize]| Analytic::with_locked(m, of, locked).ok();
    ik::AnalyticSolutions::is_open;
    ik::Criterion::by_name = |name: &'static str, of: EndEffector, task: Task| ik::Criterion::by_name(name, of, task);
    ik::Criterion::name;
    ik::FoundBy::name;
    ik::Goal::center_of_mass;
    ik::Goal::frame = |of: EndEffector, task: Task, target: Pose| ik::Goal::frame(of, task, target);
    ik::Goal::gaze = |of: EndEffector, point: Vec3| ik::Goal::gaze(of, point);
    ik::Goal::pose = |of: EndEffector, target: Pose| ik::Goal::pose(of, target);
    ik::Goal::relative = |a: EndEffector, b: EndEffector, target: Pose| ik::Goal::relative(a, b, target);
    ik::Goal::with_weight;
    ik::MissReason::name;
    ik::Solver::analytic;
    ik::Solver::avoid;
    ik::Solver::collision_model_mut;
    ik::Solver::new;
    ik::Solver::set_initial_guess;
    ik::Solver::solve;
    ik::Solver::solve_distinct;
    ik::solve;
    ik::solve_distinct;
}
