//! Goals of inverse kinematics beside frames: relative frames, the centre of mass, gaze; postures.

use cylindroid::control::{MotionTask, TaskGoals, TaskObjective, goals_of};
use cylindroid::ik::{
    Criterion, Goal, HalfSpace, IkOptions, MissReason, Objective, Solution, Solver, Task, solve,
};
use cylindroid::kinematics::{MassMatrix, State};
use cylindroid::model::{Inclusion, Mechanism};
use cylindroid::{Matrix, Pose, Vec3, catalogue};

use crate::servo::two_armed;
use crate::support::Random;

fn from_text(text: &str) -> Mechanism {
    cylindroid::model::formats::toml::parse(text, std::path::Path::new("text.toml")).unwrap()
}

fn center(state: &State) -> Vec3 {
    let mechanism = state.mechanism();
    let mut jacobian = Matrix::zeros(3, mechanism.n());
    MassMatrix::new(mechanism).center_of_mass(state, &mut jacobian).unwrap().1
}

/// Errors of position and orientation at a state, from poses alone.
fn errors(goal: &Goal, state: &State) -> (f64, f64) {
    let of = |error: cylindroid::Twist| (error.linear.norm(), error.angular.norm());
    match goal.objective {
        Objective::Frame { end_effector, components, target } => {
            of(components.error(state.pose(end_effector).unwrap(), target))
        }
        Objective::RelativeFrame { end_effector, reference, components, target } => {
            let seen = state.pose(reference).unwrap().inverse() * state.pose(end_effector).unwrap();
            of(components.error(seen, target))
        }
        Objective::CenterOfMass { axes, target } => {
            let way = (target - center(state)).to_array();
            let squares = way.iter().zip(axes).map(|(x, on)| if on { x * x } else { 0.0 });
            (squares.sum::<f64>().sqrt(), 0.0)
        }
        Objective::Gaze { end_effector, point } => {
            let pose = state.pose(end_effector).unwrap();
            let (z, way) = (pose.rotation.z_axis(), point - pose.translation);
            (0.0, z.cross(way).norm().atan2(z.dot(way)))
        }
        _ => panic!("{goal:?}"),
    }
}

/// Success is claimed if, and only if, all goals are reached within the limits.
fn checked(robot: &Mechanism, goals: &[Goal], options: &IkOptions, found: &Solution) {
    assert_eq!(robot.outside_limits(&found.q).next(), None, "{found:?}");
    let state = robot.state(&found.q).unwrap();
    let all: Vec<_> = goals.iter().map(|goal| errors(goal, &state)).collect();
    let position = all.iter().fold(0.0, |m: f64, e| m.max(e.0));
    let orientation = all.iter().fold(0.0, |m: f64, e| m.max(e.1));
    assert!((position - found.position_error).abs() < 1e-9, "{position} {found:?}");
    assert!((orientation - found.orientation_error).abs() < 1e-7, "{orientation} {found:?}");
    let within = found.position_error <= options.position_tolerance
        && found.orientation_error <= options.orientation_tolerance;
    assert_eq!(found.success, within);
    assert_eq!(found.success, found.reason.is_none());
}

/// The goals of a configuration: both hands, one seen from the other, the centre, the head.
fn goals_at(robot: &Mechanism, q: &[f64], distance: f64) -> [Goal; 5] {
    let state = robot.state(q).unwrap();
    let [left, right, head] =
        ["left_6_link", "right_6_link", "pan_link"].map(|name| robot.frame(name).unwrap());
    let [a, b, c] = [left, right, head].map(|frame| state.pose(frame).unwrap());
    let center = Objective::CenterOfMass { axes: [true, true, false], target: center(&state) };
    [
        Goal::frame(left, Task::POSITION, a),
        Goal::frame(right, Task::POSITION, b),
        Goal::relative(left, right, b.inverse() * a),
        Goal::from(center),
        Goal::gaze(head, c * (Vec3::Z * distance)),
    ]
}

/// Alone and together, from the same initial guess.
#[test]
fn goals_of_a_configuration_are_reached() {
    let robot = two_armed();
    let (mut random, options) = (Random(4), IkOptions::default());
    for _ in 0..20 {
        let q: Vec<f64> = (0..robot.n()).map(|_| random.within(-1.3, 1.3)).collect();
        let [left, right, relative, center, gaze] = goals_at(&robot, &q, 1.5);
        for goals in [
            &[relative][..],
            &[center],
            &[gaze],
            &[left, relative],
            &[center, gaze],
            &[left, right, center, gaze],
            &[left, relative, center.with_weight(3.0), gaze.with_weight(0.2)],
        ] {
            let found = solve(&robot, goals, &options).unwrap();
            checked(&robot, goals, &options, &found);
            assert!(found.success, "{goals:?}: {found:?}");
        }
    }
}

/// Points above, below, behind: also opposite to the initial direction.
#[test]
fn gaze_looks_everywhere() {
    let panda = catalogue::load("panda").unwrap();
    let (mut random, options) = (Random(6), IkOptions::default());
    for round in 0..50 {
        let hand = panda.state(panda.home()).unwrap().pose(panda.tool()).unwrap();
        let point = if round == 0 { hand * (Vec3::Z * -0.4) } else { random.vec3(2.0) };
        let goals = [Goal::gaze(panda.tool(), point)];
        let found = solve(&panda, &goals, &options).unwrap();
        checked(&panda, &goals, &options, &found);
        assert!(found.success, "{point:?}: {found:?}");
    }
    // A point at the eye is looked at in every direction.
    let eye = panda.state(panda.home()).unwrap().pose(panda.tool()).unwrap().translation;
    let goals = [Goal::gaze(panda.tool(), eye)];
    assert_eq!(solve(&panda, &goals, &options).unwrap().q, panda.home());
}

/// A target of one solver after the other.
#[test]
fn targets_change() {
    let robot = two_armed();
    let mut random = Random(9);
    let start = vec![0.1; robot.n()];
    let goals = goals_at(&robot, &start, 2.0);
    let options = IkOptions { initial_guess: Some(start), ..IkOptions::default() };
    let mut solver = Solver::new(&robot, &goals, &options).unwrap();
    for _ in 0..5 {
        let q: Vec<f64> = (0..robot.n()).map(|_| random.within(-1.0, 1.0)).collect();
        let goals = goals_at(&robot, &q, 2.0);
        let found = solver.solve(&goals).unwrap();
        checked(&robot, &goals, &options, &found);
        assert!(found.success, "{found:?}");
        assert_eq!(found, solve(&robot, &goals, &options).unwrap());
    }
    let [left, right, relative, center, gaze] = goals;
    for other in [
        [right, left, relative, center, gaze],
        [left, right, relative, Goal::center_of_mass(Vec3::ZERO), gaze],
        [left, right, relative, gaze, center],
    ] {
        let error = solver.solve(&other).unwrap_err().to_string();
        assert!(error.contains("another end effector or task"), "{error}");
    }
}

const HEAD: &str = r#"
    name = "head"
    tool = "eye"
    [[joint]]
    name = "pan"
    type = "revolute"
    between = ["ground", "neck"]
    origin = [0.0, 0.0, 0.0]
    axis = [0.0, 1.0, 0.0]
    limits = { lower = -1.0, upper = 1.0 }
    [[joint]]
    name = "slide"
    type = "prismatic"
    between = ["neck", "eye"]
    origin = [0.0, 0.0, 0.0]
    axis = [0.0, 0.0, 1.0]
    limits = { lower = 0.0, upper = 0.5 }
    "#;

/// The reason of a miss, and the weighted compromise.
#[test]
fn misses_have_a_reason() {
    let head = from_text(HEAD);
    let options = IkOptions { initial_guess: Some(vec![0.0, 0.2]), ..IkOptions::default() };
    let sought = |goals: &[Goal]| {
        let found = solve(&head, goals, &options).unwrap();
        checked(&head, goals, &options, &found);
        found
    };
    assert!(sought(&[Goal::gaze(head.tool(), Vec3::new(1.0, 0.0, 1.0))]).success);
    // It would turn by 1.6 rad.
    let side = Vec3::new(1.6_f64.sin(), 0.0, 1.6_f64.cos()) * 3.0;
    let goals = [Goal::gaze(head.tool(), side)];
    let found = solve(&head, &goals, &IkOptions { fixed: vec![1], ..options.clone() }).unwrap();
    checked(&head, &goals, &options, &found);
    assert_eq!(found.reason, Some(MissReason::Limits { joints: vec!["pan".to_owned()] }));
    assert!((found.q[0] - 1.0).abs() < 1e-9, "{found:?}");
    // A point beside the plane in which it turns.
    let found = sought(&[Goal::gaze(head.tool(), Vec3::new(0.0, 1.0, 3.0))]);
    assert_eq!(found.reason, Some(MissReason::NotProven));
    // Two frames that cannot be so far apart.
    let neck = head.frame("neck").unwrap();
    let apart = |x: f64| Goal::relative(head.tool(), neck, Pose::from_translation(Vec3::Z * x));
    assert!(sought(&[apart(0.3)]).success);
    assert_eq!(
        sought(&[apart(0.8)]).reason,
        Some(MissReason::Limits { joints: vec!["slide".to_owned()] })
    );
    // Goals that contradict one another: the squares of the weights count, 9 to 1.
    let found = sought(&[apart(0.1), apart(0.2).with_weight(3.0)]);
    assert!(!found.success && (found.q[1] - 0.19).abs() < 1e-6, "{found:?}");
}

#[test]
fn goals_that_are_none_are_refused() {
    let head = from_text(HEAD);
    let options = IkOptions::default();
    let refused = |robot: &Mechanism, goal: Goal, options: &IkOptions, word: &str| {
        let error = solve(robot, &[goal], options).unwrap_err().to_string();
        assert!(error.contains(word), "{error}");
    };
    refused(&head, Goal::center_of_mass(Vec3::ZERO), &options, "without mass");
    let robot = two_armed();
    let none = Objective::CenterOfMass { axes: [false; 3], target: Vec3::ZERO };
    refused(&robot, none.into(), &options, "axes");
    refused(&robot, Goal::center_of_mass(Vec3::X * f64::NAN), &options, "centre of mass");
    refused(&robot, Goal::gaze(head.tool(), Vec3::X), &options, "frame");
    let hand = robot.frame("left_6_link").unwrap();
    refused(&robot, Goal::gaze(hand, Vec3::X * f64::INFINITY), &options, "gaze");
    let relative = Goal::relative(hand, hand, Pose::from_translation(Vec3::X * f64::NAN));
    refused(&robot, relative, &options, "relative");
    let posture = IkOptions { posture: Some(vec![0.0]), ..options };
    refused(&robot, Goal::gaze(hand, Vec3::X), &posture, "posture");
}

/// The solution closest to a posture is that of the posture as initial guess, whatever the initial
/// guess is; joints that move no goal take the posture.
#[test]
fn postures_are_approached() {
    let mut random = Random(12);
    let panda = catalogue::load("panda").unwrap();
    for _ in 0..40 {
        let target = panda.state(&random.q(&panda)).unwrap().pose(panda.tool()).unwrap();
        let goals = [Goal::pose(panda.tool(), target)];
        let (posture, start) = (random.q(&panda), random.q(&panda));
        let nearest = |initial_guess, posture| {
            let initial_guess = Some(initial_guess);
            let options =
                IkOptions { nearest: true, initial_guess, posture, ..IkOptions::default() };
            solve(&panda, &goals, &options).unwrap()
        };
        let far = |q: &[f64]| {
            let squares = q.iter().zip(&posture).map(|(a, b)| (a - b) * (a - b));
            squares.sum::<f64>().sqrt()
        };
        let expected = far(&nearest(posture.clone(), None).q);
        let found = nearest(start, Some(posture.clone()));
        let own = far(&found.q);
        assert!(found.success && (own - expected).abs() < 1e-3, "{own} {expected} {found:?}");
    }
    let robot = two_armed();
    let posture: Vec<f64> = (0..robot.n()).map(|_| random.within(-1.0, 1.0)).collect();
    let [left, ..] = goals_at(&robot, &vec![0.5; robot.n()], 1.0);
    let options = IkOptions {
        posture: Some(posture.clone()),
        initial_guess: Some(vec![0.3; robot.n()]),
        fixed: vec![0, 9],
        ..IkOptions::default()
    };
    let found = solve(&robot, &[left], &options).unwrap();
    checked(&robot, &[left], &options, &found);
    assert!(found.success);
    for (c, x) in found.q.iter().enumerate() {
        if [0, 9].contains(&c) {
            assert!(*x == 0.3, "{c}");
        } else if c > 7 {
            assert!(*x == posture[c], "{c}");
        }
    }
}

#[test]
fn tasks_are_goals() {
    let robot = two_armed();
    let goals = goals_at(&robot, &vec![0.4; robot.n()], 1.0);
    let mut tasks: Vec<MotionTask> = goals
        .iter()
        .enumerate()
        .map(|(i, goal)| {
            let objective = match goal.objective {
                Objective::Frame { end_effector, components, target } => {
                    TaskObjective::Frame { end_effector, components, target: target.into() }
                }
                Objective::RelativeFrame { end_effector, reference, components, target } => {
                    TaskObjective::RelativeFrame { end_effector, reference, components, target }
                }
                Objective::CenterOfMass { axes, target } => {
                    TaskObjective::CenterOfMass { axes, target, velocity: Vec3::X }
                }
                Objective::Gaze { end_effector, point } => {
                    TaskObjective::Gaze { end_effector, point }
                }
                _ => panic!("{goal:?}"),
            };
            MotionTask { weight: 2.0, ..MotionTask::new(&i.to_string(), objective) }
        })
        .collect();
    let expected: Vec<Goal> = goals.iter().map(|goal| goal.with_weight(2.0)).collect();
    let own = TaskGoals { goals: expected, ..TaskGoals::default() };
    assert_eq!(goals_of(&tasks).unwrap(), own);
    let posture = MotionTask::new("posture", TaskObjective::Posture { q: vec![0.1; robot.n()] });
    tasks.push(posture.clone());
    let with_posture = TaskGoals { posture: Some(vec![0.1; robot.n()]), ..own };
    assert_eq!(goals_of(&tasks).unwrap(), with_posture);
    tasks.push(posture);
    assert!(goals_of(&tasks).unwrap_err().to_string().contains("one posture"));
    let still = TaskObjective::JointVelocities { velocities: vec![0.0; robot.n()] };
    let error = goals_of(&[MotionTask::new("still", still)]).unwrap_err().to_string();
    assert!(error.contains("still") && error.contains("gaze"), "{error}");
    let margin = TaskObjective::LimitAvoidance { margin: 0.2 };
    let components = Task::POSE;
    let end_effector = robot.tool().into();
    let climb = TaskObjective::Manipulability { end_effector, components };
    for (objective, criterion) in [
        (margin, Criterion::LimitAvoidance { margin: 0.2 }),
        (climb, Criterion::Manipulability { end_effector, components }),
    ] {
        let mut tasks = vec![MotionTask::new("best", objective)];
        assert_eq!(goals_of(&tasks).unwrap().criterion, Some(criterion));
        tasks.push(tasks[0].clone());
        assert!(goals_of(&tasks).unwrap_err().to_string().contains("one criterion"));
    }
}

/// On a turned foundation, and with the goals in another order, the same joint positions are found.
#[test]
fn goals_are_reached_alike_on_any_foundation_and_in_any_order() {
    let panda = catalogue::load("panda").unwrap();
    let guess = [0.1, 0.3, -0.2, -1.6, 0.3, 1.5, 0.2];
    let there = panda.state(&[0.4, 0.2, 0.1, -1.8, 0.2, 1.7, 0.4]).unwrap();
    let solved = |robot: &Mechanism, foundation: Pose, reversed: bool| {
        let frame = |name: &str| robot.frame(name).unwrap();
        let own = |name: &str| there.pose(panda.frame(name).unwrap()).unwrap();
        let point = foundation * (own("flange") * (Vec3::Z * 0.7));
        let apart = own("link4").inverse() * own("flange");
        let mut goals = vec![
            Goal::frame(frame("link4"), Task::POSITION, foundation * own("link4")),
            Goal::gaze(frame("flange"), point).with_weight(0.5),
            Goal::relative(frame("flange"), frame("link4"), apart),
        ];
        if reversed {
            goals.reverse();
        }
        let half_space = HalfSpace {
            name: "wall".to_owned(),
            end_effector: frame("flange").into(),
            point: foundation * (own("flange").translation - Vec3::X * 1e-3),
            normal: foundation.rotation * Vec3::X,
        };
        let options = IkOptions {
            initial_guess: Some(guess.to_vec()),
            half_spaces: vec![half_space],
            ..IkOptions::default()
        };
        let found = solve(robot, &goals, &options).unwrap();
        assert!(found.success, "{foundation:?}: {:?}", found.reason);
        found.q
    };
    let own = solved(&panda, Pose::IDENTITY, false);
    let differs =
        |q: &[f64]| own.iter().zip(q).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
    assert!(differs(&solved(&panda, Pose::IDENTITY, true)) < 1e-8);
    let mut random = Random(6);
    for _ in 0..4 {
        let foundation = random.pose();
        let mut builder = Mechanism::builder("moved");
        let how = Inclusion {
            name: "",
            parent: "foundation",
            parent_from_root: foundation,
            free: false,
            start: panda.home(),
        };
        builder.include(&panda, how).unwrap();
        let moved = builder.build().unwrap();
        let most = differs(&solved(&moved, foundation, false));
        assert!(most < 1e-8, "{foundation:?}: {most}");
    }
}
