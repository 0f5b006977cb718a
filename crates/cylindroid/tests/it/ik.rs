//! Inverse kinematics against forward kinematics.

use cylindroid::ik::{
    Budget, FoundBy, Goal, IkOptions, Objective, Solution, Solver, Task, solve, solve_distinct,
};
use cylindroid::model::Mechanism;
use cylindroid::{Pose, ReferenceFrame, Vec3, catalogue};

use crate::support::{Random, robots};

fn from_text(text: &str) -> Mechanism {
    cylindroid::model::formats::toml::parse(text, std::path::Path::new("text.toml")).unwrap()
}

/// What is claimed is true: within the limits, and as near by forward kinematics.
fn checked(robot: &Mechanism, goals: &[Goal], options: &IkOptions, found: &Solution) {
    assert_eq!(robot.outside_limits(&found.q).next(), None, "{}: {found:?}", robot.name());
    let state = robot.state(&found.q).unwrap();
    let (mut position, mut orientation) = (0.0_f64, 0.0_f64);
    for goal in goals {
        let Objective::Frame { end_effector, components: task, target } = goal.objective else {
            panic!("{goal:?}")
        };
        let pose = state.pose(end_effector).unwrap();
        let error = pose.error_to(target);
        let seen = |v: Vec3| match task.axes {
            ReferenceFrame::Local => pose.rotation.inverse() * v,
            _ => v,
        };
        let kept = |v: Vec3, keep: &[bool]| -> f64 {
            let parts = seen(v).to_array().into_iter().zip(keep).filter(|(_, keep)| **keep);
            parts.map(|(x, _)| x * x).sum::<f64>().sqrt()
        };
        position = position.max(kept(error.linear, &task.components[..3]));
        orientation = orientation.max(kept(error.angular, &task.components[3..]));
    }
    assert!((position - found.position_error).abs() < 1e-12);
    assert!((orientation - found.orientation_error).abs() < 1e-12);
    let within =
        position <= options.position_tolerance && orientation <= options.orientation_tolerance;
    assert_eq!(found.success, within);
}

/// Every reachable pose of every arm of the catalogue is found, from anywhere, at both tolerances;
/// also by the search alone, which a goal that is said twice keeps from formulas.
#[test]
fn reachable_poses_are_reached() {
    let mut random = Random(61);
    for robot in robots() {
        for tolerance in [1e-5, 1e-9] {
            let mut options = IkOptions {
                position_tolerance: tolerance,
                orientation_tolerance: tolerance,
                ..IkOptions::default()
            };
            for _ in 0..200 {
                let target = robot.state(&random.q(&robot)).unwrap().pose(robot.tool()).unwrap();
                options.initial_guess = Some(random.q(&robot));
                let goals = [Goal::pose(robot.tool(), target)];
                let found = solve(&robot, &goals, &options).unwrap();
                checked(&robot, &goals, &options, &found);
                assert!(found.success, "{} at {tolerance}: {found:?}", robot.name());
                assert_eq!(found, solve(&robot, &goals, &options).unwrap());
                let twice = [goals[0], goals[0]];
                let found = solve(&robot, &twice, &options).unwrap();
                checked(&robot, &twice, &options, &found);
                assert!(found.success && found.found_by == FoundBy::Numerical, "{found:?}");
            }
        }
    }
}

/// Singular targets, limits of the joints themselves among them, are ordinary ones.
#[test]
fn singular_and_extreme_poses_are_reached() {
    for robot in robots() {
        let zero = vec![0.0; robot.n()];
        let end = |pick: fn(&cylindroid::model::Limits) -> f64| -> Vec<f64> {
            robot.coordinates().iter().map(|c| pick(&c.limits).max(-3.0).min(3.0)).collect()
        };
        for q in [zero, end(|l| l.lower), end(|l| l.upper), robot.home().to_vec()] {
            if robot.outside_limits(&q).next().is_some() {
                continue;
            }
            let target = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
            let goals = [Goal::pose(robot.tool(), target)];
            let start: Vec<f64> = q.iter().map(|x| x + 0.4).collect();
            let options = IkOptions { initial_guess: Some(start), ..IkOptions::default() };
            let found = solve(&robot, &goals, &options).unwrap();
            checked(&robot, &goals, &options, &found);
            assert!(found.success, "{}: {found:?}", robot.name());
        }
    }
}

/// Components that do not matter are left free.
#[test]
fn parts_of_poses() {
    let panda = catalogue::load("panda").unwrap();
    let mut random = Random(62);
    let options = IkOptions::default();
    for task in [Task::POSITION, Task::ORIENTATION, Task::POINTING] {
        for _ in 0..50 {
            let target = panda.state(&random.q(&panda)).unwrap().pose(panda.tool()).unwrap();
            let goals = [Goal::frame(panda.tool(), task, target)];
            let found = solve(&panda, &goals, &options).unwrap();
            assert!(found.success, "{task:?}");
            checked(&panda, &goals, &options, &found);
            let pose = panda.state(&found.q).unwrap().pose(panda.tool()).unwrap();
            if task == Task::POINTING {
                let z = |p: Pose| p.rotation.matrix().cols[2];
                assert!((z(pose) - z(target)).norm() < 1e-5, "{pose:?}");
                assert!((pose.translation - target.translation).norm() < 1e-5);
            }
            if task == Task::ORIENTATION {
                assert!(pose.rotation.angle_to(target.rotation) < 1e-5);
            }
        }
    }
}

/// Two arms on one base, each with a goal; then a goal that both arms share a joint for.
#[test]
fn several_end_effectors() {
    let text = r#"
name = "pair"
[[robot]]
name = "left"
model = "panda"
[[robot]]
name = "right"
model = "ur5e"
base = { xyz = [0.0, 1.0, 0.0] }
"#;
    let pair = from_text(text);
    let tools = ["left/hand_tcp", "right/tool0"].map(|name| pair.frame(name).unwrap());
    let mut random = Random(63);
    let options = IkOptions::default();
    for _ in 0..30 {
        let state = pair.state(&random.q(&pair)).unwrap();
        let goals = tools.map(|tool| Goal::pose(tool, state.pose(tool).unwrap()));
        let found = solve(&pair, &goals, &options).unwrap();
        checked(&pair, &goals, &options, &found);
        assert!(found.success);
    }
    // Two points of one arm.
    let panda = catalogue::load("panda").unwrap();
    for _ in 0..30 {
        let state = panda.state(&random.q(&panda)).unwrap();
        let goals = ["link4", "hand_tcp"].map(|name| {
            let frame = panda.frame(name).unwrap();
            Goal::frame(frame, Task::POSITION, state.pose(frame).unwrap())
        });
        let found = solve(&panda, &goals, &options).unwrap();
        checked(&panda, &goals, &options, &found);
        assert!(found.success);
    }
}

/// Beyond reach: said with the proof, and the closest configuration: no small change of the
/// joints within the limits comes nearer.
#[test]
fn out_of_reach_ends_with_the_nearest_pose() {
    let panda = catalogue::load("panda").unwrap();
    let mut target = panda.state(panda.home()).unwrap().pose(panda.tool()).unwrap();
    target.translation = Vec3::new(1.4, 0.5, 0.6);
    let goals = [Goal::frame(panda.tool(), Task::POSITION, target)];
    let options = IkOptions::default();
    let found = solve(&panda, &goals, &options).unwrap();
    checked(&panda, &goals, &options, &found);
    let (distance, length) = found.out_of_reach.unwrap();
    assert!(!found.success && distance > length && found.iterations < 20_000);
    let far = |q: &[f64]| {
        (panda.state(q).unwrap().pose(panda.tool()).unwrap().translation - target.translation)
            .norm()
    };
    for i in 0..panda.n() {
        for step in [-1e-3, 1e-3] {
            let mut q = found.q.clone();
            q[i] += step;
            let l = panda.coordinates()[i].limits;
            q[i] = q[i].max(l.lower).min(l.upper);
            assert!(far(&q) >= found.position_error - 1e-9, "joint {i}: {}", far(&q));
        }
    }
    // Within the sphere, but not within the limits: no proof, the budget ends it.
    target.translation = Vec3::new(0.0, 0.0, 0.34);
    let goals = [Goal::pose(panda.tool(), target)];
    let budget = Budget { iterations: 500, time: None };
    let found = solve(&panda, &goals, &IkOptions { budget, ..options }).unwrap();
    assert!(!found.success && found.out_of_reach.is_none() && found.iterations <= 510);
    assert!(found.position_error < 0.3, "{found:?}");
}

/// The nearest answer is no farther than one that is known, and a redundant arm slides to it.
#[test]
fn the_nearest_answer() {
    let mut random = Random(64);
    for name in ["panda", "ur5e"] {
        let robot = catalogue::load(name).unwrap();
        for _ in 0..40 {
            let known = random.q(&robot);
            let start: Vec<f64> = known.iter().map(|x| x + random.within(-0.5, 0.5)).collect();
            let goals = [Goal::pose(
                robot.tool(),
                robot.state(&known).unwrap().pose(robot.tool()).unwrap(),
            )];
            let options = IkOptions {
                initial_guess: Some(start.clone()),
                nearest: true,
                ..IkOptions::default()
            };
            let found = solve(&robot, &goals, &options).unwrap();
            checked(&robot, &goals, &options, &found);
            // The start is moved into the limits first, which brings it nearer to all answers.
            let far = |q: &[f64]| -> f64 {
                let clamped = start.iter().zip(robot.coordinates());
                let clamped = clamped.map(|(s, c)| s.max(c.limits.lower).min(c.limits.upper));
                q.iter().zip(clamped).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
            };
            assert!(far(&found.q) <= far(&known) * (1.0 + 1e-3) + 1e-4, "{name}: {found:?}");
        }
    }
}

/// A 6R arm has up to eight configurations for a pose: distinct, true, sorted by distance.
#[test]
fn several_answers() {
    let ur5e = catalogue::load("ur5e").unwrap();
    let q = [0.3, -1.1, 1.4, 0.2, 1.0, 0.4];
    let goals = [Goal::pose(ur5e.tool(), ur5e.state(&q).unwrap().pose(ur5e.tool()).unwrap())];
    let options = IkOptions { initial_guess: Some(q.to_vec()), ..IkOptions::default() };
    let found = solve_distinct(&ur5e, &goals, &options, 20).unwrap();
    assert_eq!(found.len(), 8);
    let mut before = 0.0;
    for one in &found {
        checked(&ur5e, &goals, &options, one);
        let far = one.q.iter().zip(&q).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
        assert!(far >= before);
        before = far;
    }
}

/// A target beyond the arm by less than the tolerance is reached, and no proof says otherwise; no
/// answers are wanted, none are given.
#[test]
fn nearly_in_reach_is_reached() {
    let text = r#"
name = "slide"
[[joint]]
name = "slide"
type = "prismatic"
between = ["ground", "hand"]
axis = [1.0, 0.0, 0.0]
limits = { lower = 0.0, upper = 1.0 }
"#;
    let robot = from_text(text);
    let hand = robot.frame("hand").unwrap();
    let mut target = robot.state(&[1.0]).unwrap().pose(hand).unwrap();
    let options = IkOptions { position_tolerance: 1e-6, ..IkOptions::default() };
    target.translation.x += 5e-7;
    let found = solve(&robot, &[Goal::pose(hand, target)], &options).unwrap();
    assert!(found.success && found.out_of_reach.is_none(), "{found:?}");
    target.translation.x += 1e-3;
    let found = solve(&robot, &[Goal::pose(hand, target)], &options).unwrap();
    assert!(!found.success && found.out_of_reach.is_some(), "{found:?}");
    target.translation.x = 0.5;
    assert!(solve_distinct(&robot, &[Goal::pose(hand, target)], &options, 0).unwrap().is_empty());
}

/// A whole turn brings a hinge back to where it was, a screw not: its places are several answers.
#[test]
fn whole_turns_of_hinges_are_one_answer_and_of_screws_several() {
    let of = |kind: &str| {
        let joint = r#"
name = "jack"
[[joint]]
name = "turn"
between = ["ground", "hand"]
origin = [0.0, 0.0, 0.0]
axis = [0.0, 0.0, 1.0]
limits = { lower = -13.0, upper = 13.0 }
"#;
        from_text(&format!("{joint}{kind}"))
    };
    let hinge = of("type = \"revolute\"");
    let screw = of("type = \"helical\"\npitch = 0.01");
    for (robot, answers) in [(hinge, 1), (screw, 4)] {
        let hand = robot.frame("hand").unwrap();
        let target = robot.state(&[0.5]).unwrap().pose(hand).unwrap();
        let goals = [Goal::frame(hand, Task::ORIENTATION, target)];
        let found = solve_distinct(&robot, &goals, &IkOptions::default(), 4).unwrap();
        assert_eq!(found.len(), answers, "{}: {found:?}", robot.name());
        found.iter().for_each(|one| checked(&robot, &goals, &IkOptions::default(), one));
    }
}

/// Ball joints and free bodies turn by their own rules.
#[test]
fn ball_joints_and_free_bodies() {
    let text = r#"
name = "balls"
[[joint]]
name = "shoulder"
type = "spherical"
between = ["ground", "arm"]
origin = [0.0, 0.0, 0.0]
[[joint]]
name = "elbow"
type = "revolute"
between = ["arm", "forearm"]
origin = [0.0, 0.0, 0.5]
axis = [0.0, 1.0, 0.0]
[[joint]]
name = "wrist"
type = "spherical"
between = ["forearm", "hand"]
origin = [0.0, 0.0, 0.9]
"#;
    let robot = from_text(text);
    let hand = robot.frame("hand").unwrap();
    let mut random = Random(65);
    for _ in 0..50 {
        let q: Vec<f64> = (0..robot.n()).map(|_| random.within(-1.5, 1.5)).collect();
        let goals = [Goal::pose(hand, robot.state(&q).unwrap().pose(hand).unwrap())];
        let options = IkOptions::default();
        let found = solve(&robot, &goals, &options).unwrap();
        checked(&robot, &goals, &options, &found);
        assert!(found.success, "{found:?}");
    }
}

/// A joint of several turns is left in the turn that it is in.
#[test]
fn the_nearest_answer_does_not_unwind() {
    let ur5e = catalogue::load("ur5e").unwrap();
    let start = vec![0.3, -1.1, 1.4, 0.2, 1.0, 5.9];
    let mut target = ur5e.state(&start).unwrap().pose(ur5e.tool()).unwrap();
    target.translation.z += 0.01;
    let options =
        IkOptions { initial_guess: Some(start.clone()), nearest: true, ..IkOptions::default() };
    let found = solve(&ur5e, &[Goal::pose(ur5e.tool(), target)], &options).unwrap();
    assert!(found.success && (found.q[5] - 5.9).abs() < 0.2, "{found:?}");
}

#[test]
fn bad_requests_are_named() {
    let panda = catalogue::load("panda").unwrap();
    let goal = Goal::pose(panda.tool(), Pose::IDENTITY);
    let options = IkOptions::default();
    let refused = |goals: &[Goal], options: &IkOptions, word: &str| {
        let error = solve(&panda, goals, options).unwrap_err().to_string();
        assert!(error.contains(word), "{error}");
    };
    refused(&[], &options, "goals");
    let nan = Pose::from_translation(Vec3::new(f64::NAN, 0.0, 0.0));
    refused(&[Goal::pose(panda.tool(), nan)], &options, "target");
    refused(&[goal], &IkOptions { position_tolerance: 0.0, ..options.clone() }, "tolerance");
    refused(
        &[goal],
        &IkOptions { initial_guess: Some(vec![0.0]), ..options.clone() },
        "initial guess",
    );
    let none = Task { components: [false; 6], ..Task::POSE };
    refused(&[Goal::frame(panda.tool(), none, Pose::IDENTITY)], &options, "components");
    let mut solver = Solver::new(&panda, &[goal], &options).unwrap();
    let position = Goal::frame(panda.tool(), Task::POSITION, Pose::IDENTITY);
    let error = solver.solve(&[position]).unwrap_err().to_string();
    assert!(error.contains("task"), "{error}");
    let error = solver.solve(&[goal, goal]).unwrap_err().to_string();
    assert!(error.contains("goals"), "{error}");
    let stewart = catalogue::load("stewart").unwrap();
    let goal = Goal::pose(stewart.reference(), Pose::IDENTITY);
    let error = Solver::new(&stewart, &[goal], &options).unwrap_err().to_string();
    assert!(error.contains("loops"), "{error}");
    let error = solve(&stewart, &[goal, goal], &options).unwrap_err().to_string();
    assert!(error.contains("one frame"), "{error}");
    // A frame that nothing moves: reached where it is, else not.
    let base = panda.frame("base").unwrap();
    let here = panda.state(panda.home()).unwrap().pose(base).unwrap();
    assert!(solve(&panda, &[Goal::pose(base, here)], &options).unwrap().success);
    let there = Pose::from_translation(Vec3::new(1.0, 0.0, 0.0));
    assert!(!solve(&panda, &[Goal::pose(base, there)], &options).unwrap().success);
}

/// Limits whose arithmetic overflows are no success with NaN, and those beyond the range of models
/// are refused.
#[test]
fn limits_that_overflow_are_no_success() {
    let text = r#"
        name = "arm"
        reference = "hand"
        reference_point = [1.0, 0.2, 0.3]
        [[joint]]
        name = "swing"
        type = "revolute"
        between = ["ground", "link"]
        origin = [0.0, 0.0, 0.3]
        axis = [0, 0, 1]
        limits = { lower = -3.0, upper = 3.0 }
        [[joint]]
        name = "screw"
        type = "helical"
        between = ["link", "hand"]
        origin = [0.5, 0.0, 0.3]
        axis = [0, 1, 0]
        pitch = 0.01
        limits = { lower = 1e120 }
        "#;
    let robot = from_text(text);
    let beyond = text.replace("1e120", "1e308");
    let refused =
        cylindroid::load_text(&beyond, std::path::Path::new("arm.toml")).unwrap_err().to_string();
    assert!(refused.contains("lower is 1e308, out of range"), "{refused}");
    let at = Pose::from_translation(Vec3::new(0.9, 0.3, 0.3));
    for task in [Task::POSITION, Task::POSE] {
        let goal = Goal::frame(robot.tool(), task, at);
        let found = solve(&robot, &[goal], &IkOptions::default()).unwrap();
        assert!(!found.success && found.q.iter().all(|x| x.is_finite()), "{found:?}");
    }
}

/// Joints that do not move the end effector are within their limits too.
#[test]
fn other_joints_are_within_their_limits() {
    let robot = from_text(
        r#"
        name = "two arms"
        tool = "hand"
        home = [0.0, 0.0]
        [[joint]]
        name = "arm"
        type = "revolute"
        between = ["ground", "hand"]
        origin = [0, 0, 0]
        axis = [0, 0, 1]
        limits = { lower = -1.0, upper = 1.0 }
        [[joint]]
        name = "other"
        type = "revolute"
        between = ["ground", "finger"]
        origin = [0, 0, 0]
        axis = [0, 0, 1]
        limits = { lower = 0.5, upper = 1.0 }
        "#,
    );
    let pose = robot.state(&[0.3, 0.7]).unwrap().pose(robot.tool()).unwrap();
    let found = solve(&robot, &[Goal::pose(robot.tool(), pose)], &IkOptions::default()).unwrap();
    assert!(found.success && robot.outside_limits(&found.q).next().is_none(), "{found:?}");
}

/// Full turns towards the initial guess are for joints that rotate, and only within their limits: a
/// slide of the same numbers stays where it is.
#[test]
fn full_turns_leave_slides_and_limits_alone() {
    for (upper, expected) in [(4.5, -2.3 + 2.0 * std::f64::consts::PI), (3.9, -2.3)] {
        let text = format!(
            r#"
            name = "crane"
            reference = "hook"
            [[joint]]
            name = "slide"
            type = "prismatic"
            between = ["ground", "cart"]
            origin = [0, 0, 0]
            axis = [0, 0, 1]
            limits = {{ lower = -20, upper = 20 }}
            [[joint]]
            name = "turn"
            type = "revolute"
            between = ["cart", "hook"]
            origin = [0, 0, 0]
            axis = [0, 0, 1]
            limits = {{ lower = -4.5, upper = {upper} }}
            "#
        );
        let robot = from_text(&text);
        let target = robot.state(&[1.0, -2.3]).unwrap().pose(robot.tool()).unwrap();
        let initial_guess = Some(vec![9.0, 3.8]);
        let options = IkOptions { initial_guess, nearest: true, ..IkOptions::default() };
        let found = solve(&robot, &[Goal::pose(robot.tool(), target)], &options).unwrap();
        assert!(found.success, "{found:?}");
        let error = (found.q[0] - 1.0).abs().max((found.q[1] - expected).abs());
        assert!(error < 1e-5, "{:?} for 1 and {expected}", found.q);
    }
}
