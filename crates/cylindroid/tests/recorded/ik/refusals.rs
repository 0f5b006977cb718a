//! Requests that are refused, in words.

use cylindroid::ik::{
    Analytic, Budget, Criterion, Goal, HalfSpace, IkOptions, MissReason, Objective, Solver, Task,
    solve,
};
use cylindroid::{EndEffector, Mechanism, Pose, ReferenceFrame, Rotation, Vec3, catalogue};

use crate::record::{Record, check};

fn options() -> Vec<IkOptions> {
    let of = IkOptions::default;
    let mut all = Vec::new();
    for x in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-300] {
        all.push(IkOptions { position_tolerance: x, ..of() });
        all.push(IkOptions { orientation_tolerance: x, ..of() });
        all.push(IkOptions { length: Some(x), ..of() });
        all.push(IkOptions { criterion: Some(Criterion::LimitAvoidance { margin: x }), ..of() });
    }
    for margin in [0.5, 0.500_001, 1e-9] {
        let criterion = Some(Criterion::LimitAvoidance { margin });
        all.push(IkOptions { criterion, ..of() });
        all.push(IkOptions { criterion, nearest: true, ..of() });
        all.push(IkOptions { criterion, posture: Some(vec![0.1; 6]), ..of() });
    }
    for q in [vec![0.1; 6], vec![0.1; 5], vec![f64::NAN; 6]] {
        all.push(IkOptions { initial_guess: Some(q.clone()), ..of() });
        all.push(IkOptions { posture: Some(q), ..of() });
    }
    for fixed in [vec![0, 5], vec![2, 6], vec![7]] {
        all.push(IkOptions { fixed, ..of() });
    }
    for iterations in [0, 1] {
        all.push(IkOptions { budget: Budget { iterations, time: None }, ..of() });
    }
    all
}

fn note(record: &mut Record, robot: &Mechanism, goals: &[Goal], options: &IkOptions) {
    match solve(robot, goals, options) {
        Ok(found) => {
            record.word(&found.success);
            record.word(&found.reason.as_ref().map(MissReason::to_string));
        }
        Err(error) => record.word(&error.to_string()),
    }
}

#[test]
fn of_options() {
    let robot = catalogue::load("ur5e").unwrap();
    let state = robot.state(&[0.3, -1.1, 1.4, 0.2, 1.0, 0.4]).unwrap();
    let goals = [Goal::pose(robot.tool(), state.pose(robot.tool()).unwrap())];
    check("ik_refused_options", 1, |_, record| {
        for options in options() {
            note(record, &robot, &goals, &options);
        }
        for normal in [Vec3::ZERO, Vec3::new(0.0, f64::NAN, 0.0), Vec3::X * 1e-9] {
            let own = HalfSpace {
                name: "wall".to_owned(),
                end_effector: robot.tool().into(),
                point: Vec3::X * -9.0,
                normal,
            };
            let half_spaces = vec![own];
            note(record, &robot, &goals, &IkOptions { half_spaces, ..IkOptions::default() });
        }
    });
}

fn goals(tool: EndEffector) -> Vec<Goal> {
    let none = Task { components: [false; 6], ..Task::POSE };
    let world = Task { axes: ReferenceFrame::World, ..Task::POSE };
    let nan = Pose::from_translation(Vec3::X * f64::NAN);
    let turned = Pose { rotation: Rotation::exp(Vec3::X * f64::NAN), ..Pose::IDENTITY };
    let odd = EndEffector { frame_from_tool: nan, ..tool };
    let here = Pose::IDENTITY;
    let mut all = vec![
        Goal::pose(tool, nan),
        Goal::pose(tool, turned),
        Goal::pose(odd, here),
        Goal::frame(tool, none, here),
        Goal::frame(tool, world, here),
        Goal::relative(tool, tool, nan),
        Goal::relative(tool, odd, here),
        Goal::gaze(tool, Vec3::X * f64::NAN),
        Goal::gaze(odd, Vec3::X),
        Goal::center_of_mass(Vec3::X * f64::NAN),
        Goal::center_of_mass(Vec3::X * 0.2),
        Objective::CenterOfMass { axes: [false; 3], target: Vec3::X }.into(),
        Objective::CenterOfMass { axes: [false, false, true], target: Vec3::Z * 0.3 }.into(),
    ];
    all.extend([0.0, -1.0, f64::NAN].map(|weight| Goal::pose(tool, here).with_weight(weight)));
    all
}

#[test]
fn of_goals() {
    let robot = catalogue::load("ur5e").unwrap();
    let other = catalogue::load("panda").unwrap();
    let default = IkOptions::default();
    check("ik_refused_goals", 1, |_, record| {
        note(record, &robot, &[], &default);
        let all = goals(robot.tool().into());
        for goal in &all {
            note(record, &robot, &[*goal], &default);
        }
        note(record, &other, &[Goal::pose(other.tool(), Pose::IDENTITY)], &default);
        let goal = Goal::pose(robot.tool(), Pose::IDENTITY);
        let mut solver = Solver::new(&robot, &[goal], &default).unwrap();
        for goal in &all {
            record.word(
                &solver.solve(&[*goal]).map(|found| found.success).map_err(|e| e.to_string()),
            );
        }
        record.word(&solver.solve(&[goal, goal]).map_err(|e| e.to_string()).map(|f| f.success));
        record.word(&solver.set_initial_guess(&[0.0; 5]).map_err(|e| e.to_string()));
        let mut ik = Analytic::of(&robot, robot.tool()).unwrap();
        let nan = Pose::from_translation(Vec3::X * f64::NAN);
        let turned = Pose { rotation: Rotation::exp(Vec3::X * f64::NAN), ..Pose::IDENTITY };
        for (target, start) in [
            (Pose::IDENTITY, vec![0.0; 5]),
            (Pose::IDENTITY, vec![f64::NAN; 6]),
            (nan, vec![0.0; 6]),
            (turned, vec![0.0; 6]),
        ] {
            record.word(&ik.solve(target, &start).map(|all| all.len()).map_err(|e| e.to_string()));
        }
    });
}

/// Closed chains refuse more: several goals, other goals, half-spaces, criteria, one rotation.
#[test]
fn of_closed_chains() {
    let default = IkOptions::default();
    check("ik_refused_closed", 1, |_, record| {
        for name in ["stewart", "five-bar", "delta"] {
            let robot = catalogue::load(name).unwrap();
            let frame = robot.reference();
            let pose = robot.state(robot.home()).unwrap().pose(frame).unwrap();
            let goal = Goal::pose(frame, pose);
            note(record, &robot, &[goal, goal], &default);
            note(record, &robot, &[Goal::gaze(frame, Vec3::X)], &default);
            note(record, &robot, &[Goal::relative(frame, frame, pose)], &default);
            let plane = HalfSpace {
                name: "wall".to_owned(),
                end_effector: frame.into(),
                point: Vec3::ZERO,
                normal: Vec3::X,
            };
            let half_spaces = vec![plane];
            note(record, &robot, &[goal], &IkOptions { half_spaces, ..default.clone() });
            let criterion = Some(Criterion::LimitAvoidance { margin: 0.2 });
            note(record, &robot, &[goal], &IkOptions { criterion, ..default.clone() });
            for lone in 3..6 {
                let mut components = [true, true, true, false, false, false];
                components[lone] = true;
                let goal = Goal::frame(frame, Task { components, ..Task::POSE }, pose);
                note(record, &robot, &[goal], &default);
            }
            record.word(&Solver::new(&robot, &[goal], &default).map_err(|e| e.to_string()).is_ok());
            let reason = Analytic::of(&robot, frame).map_err(|reason| reason.to_string());
            record.word(&reason.err());
        }
    });
}
