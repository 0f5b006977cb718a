//! Inverse kinematics with a criterion: manipulability, distance from joint limits.

use std::f64::consts::PI;

use cylindroid::ik::{
    Criterion, Goal, HalfSpace, IkOptions, Solution, Task, solve, solve_distinct,
};
use cylindroid::linalg::Svd;
use cylindroid::model::{JointKind, JointSpec, Limits, Mechanism};
use cylindroid::{Matrix, Pose, ReferenceFrame, Rotation, Vec3, catalogue};

use crate::support::Random;

fn with(criterion: Criterion) -> IkOptions {
    IkOptions { criterion: Some(criterion), ..IkOptions::default() }
}

fn manipulability(robot: &Mechanism, components: Task) -> Criterion {
    Criterion::Manipulability { end_effector: robot.tool().into(), components }
}

/// The product of the singular values, from the Jacobian of the state.
fn yoshikawa(robot: &Mechanism, q: &[f64], components: Task) -> f64 {
    let state = robot.state(q).unwrap();
    let mut j = state.jacobian(robot.tool(), ReferenceFrame::LocalWorldAligned).unwrap();
    for column in 0..j.cols() {
        for row in 0..3 {
            j[(row, column)] /= robot.reach();
        }
    }
    let rows: Vec<usize> = (0..6).filter(|&i| components.components[i]).collect();
    let mut scaled = Matrix::zeros(rows.len(), j.cols());
    for column in 0..j.cols() {
        for (row, &i) in rows.iter().enumerate() {
            scaled[(row, column)] = j[(i, column)];
        }
    }
    Svd::of(&scaled).values().product()
}

/// As documented, from the limits.
fn limit_avoidance(robot: &Mechanism, q: &[f64], margin: f64) -> f64 {
    let all = robot.coordinates().iter().zip(q).map(|(c, q)| {
        let near = margin * (c.limits.upper - c.limits.lower);
        let push = |distance: f64| (1.0 - distance / near).max(0.0);
        push(q - c.limits.lower).powi(2) + push(c.limits.upper - q).powi(2)
    });
    -0.5 * all.sum::<f64>()
}

fn reached(found: &Solution) {
    assert!(found.success, "{found:?}");
    assert!(found.position_error < 1e-5 && found.orientation_error < 1e-4, "{found:?}");
}

/// No solution among many random ones is better, for arms with and without redundant joints.
#[test]
fn none_is_better() {
    let mut random = Random(1);
    for name in ["panda", "iiwa14", "ur5e"] {
        let robot = catalogue::load(name).unwrap();
        for _ in 0..4 {
            let q = random.q(&robot);
            let goals =
                [Goal::pose(robot.tool(), robot.state(&q).unwrap().pose(robot.tool()).unwrap())];
            let best = solve(&robot, &goals, &with(manipulability(&robot, Task::POSE))).unwrap();
            reached(&best);
            let margin = 0.4;
            let away = Criterion::LimitAvoidance { margin };
            let far = solve(&robot, &goals, &with(away)).unwrap();
            reached(&far);
            let w = yoshikawa(&robot, &best.q, Task::POSE);
            let h = limit_avoidance(&robot, &far.q, margin);
            assert!((best.criterion.unwrap() - w).abs() < 1e-12 * w.max(1e-3), "{name}");
            assert!((far.criterion.unwrap() - h).abs() < 1e-12, "{name}: {far:?}, {h}");
            let others = solve_distinct(&robot, &goals, &IkOptions::default(), 200).unwrap();
            for other in others.iter().map(|other| &other.q).chain([&q]) {
                assert!(yoshikawa(&robot, other, Task::POSE) <= w * (1.0 + 1e-6), "{name}");
                assert!(limit_avoidance(&robot, other, margin) <= h + 1e-6, "{name}");
            }
        }
    }
}

/// A planar arm of three links, 0.5, 0.4 and 0.3 times `size`, from `base`.
fn three_links(base: Pose, size: f64) -> Mechanism {
    let mut b = Mechanism::builder("3r");
    let names = ["ground", "upper", "fore", "hand"];
    for (i, length) in [0.0, 0.5, 0.4].into_iter().enumerate() {
        let after = Pose::from_translation(Vec3::X * (length * size));
        b.joint(JointSpec {
            parent_from_joint: if i == 0 { base } else { after },
            limits: Limits { lower: -3.0, upper: 3.0, ..Limits::NONE },
            ..JointSpec::new(&format!("q{i}"), JointKind::Revolute, names[i], names[i + 1])
        });
    }
    b.frame("tip", "hand", Pose::from_translation(Vec3::X * (0.3 * size)));
    b.tool("tip");
    b.build().unwrap()
}

const PLANE: Task = Task {
    components: [true, true, false, false, false, false],
    axes: ReferenceFrame::LocalWorldAligned,
};

/// The best of all configurations of three links that place the tip at `p`: the third link in each
/// direction of a fine grid, the elbow on both sides.
fn best_of_grid(robot: &Mechanism, p: [f64; 2], value: impl Fn(&[f64]) -> f64) -> f64 {
    let mut best = f64::NEG_INFINITY;
    let steps = 20_000;
    for k in 0..steps {
        let phi = 2.0 * PI * f64::from(k) / f64::from(steps) - PI;
        let (x, y) = (p[0] - 0.3 * phi.cos(), p[1] - 0.3 * phi.sin());
        let cosine = (x * x + y * y - 0.25 - 0.16) / (2.0 * 0.5 * 0.4);
        if cosine.abs() > 1.0 {
            continue;
        }
        for elbow in [cosine.acos(), -cosine.acos()] {
            let first = y.atan2(x) - (0.4 * elbow.sin()).atan2(0.5 + 0.4 * elbow.cos());
            let wrap = |a: f64| a - 2.0 * PI * (a / (2.0 * PI)).round();
            let q = [wrap(first), elbow, wrap(phi - first - elbow)];
            if robot.outside_limits(&q).next().is_none() {
                best = best.max(value(&q));
            }
        }
    }
    best
}

/// Against a grid of all solutions, and the same for an arm that is moved, turned and scaled.
#[test]
fn the_best_of_three_links() {
    let robot = three_links(Pose::IDENTITY, 1.0);
    let turn = Rotation::about_z(0.7);
    let base = Pose { rotation: turn, translation: Vec3::new(3.0, -2.0, 0.0) };
    let other = three_links(base, 20.0);
    for p in [[0.7, 0.2], [-0.3, 0.5], [0.4, -0.1], [0.1, -0.9]] {
        let goal = |robot: &Mechanism, at: Vec3| {
            [Goal::frame(robot.tool(), PLANE, Pose::from_translation(at))]
        };
        let at = Vec3::new(p[0], p[1], 0.0);
        for kind in ["manipulability", "limit-avoidance"] {
            let criterion = |robot: &Mechanism| match kind {
                "manipulability" => manipulability(robot, PLANE),
                _ => Criterion::LimitAvoidance { margin: 0.5 },
            };
            let found = solve(&robot, &goal(&robot, at), &with(criterion(&robot))).unwrap();
            reached(&found);
            let value = found.criterion.unwrap();
            let grid = best_of_grid(&robot, p, |q| match kind {
                "manipulability" => yoshikawa(&robot, q, PLANE),
                _ => limit_avoidance(&robot, q, 0.5),
            });
            assert!((value - grid).abs() < 1e-6, "{kind} at {p:?}: {value}, grid {grid}");
            let moved = goal(&other, base * (at * 20.0));
            let again = solve(&other, &moved, &with(criterion(&other))).unwrap();
            assert!((again.criterion.unwrap() - value).abs() < 1e-6, "{kind} at {p:?}: {again:?}");
        }
    }
}

/// The best comes first; half-spaces hold, and joints that are held stay.
#[test]
fn with_other_options() {
    let panda = catalogue::load("panda").unwrap();
    let criterion = manipulability(&panda, Task::POSE);
    let goals =
        [Goal::pose(panda.tool(), panda.state(panda.home()).unwrap().pose(panda.tool()).unwrap())];
    let found = solve_distinct(&panda, &goals, &with(criterion), 100).unwrap();
    assert!(found.len() > 1);
    assert!(found.windows(2).all(|pair| pair[0].criterion >= pair[1].criterion));
    let held = IkOptions { fixed: vec![2], ..with(criterion) };
    let kept = solve(&panda, &goals, &held).unwrap();
    reached(&kept);
    assert_eq!(kept.q[2], panda.home()[2]);
    assert!(kept.criterion <= found[0].criterion);
    let elbow = panda.frame("link4").unwrap();
    let point = panda.state(&found[0].q).unwrap().pose(elbow).unwrap().translation - Vec3::Z * 0.02;
    let below =
        HalfSpace { name: "below".to_owned(), end_effector: elbow.into(), point, normal: -Vec3::Z };
    let options = IkOptions { half_spaces: vec![below], ..with(criterion) };
    let bounded = solve(&panda, &goals, &options).unwrap();
    reached(&bounded);
    let height = panda.state(&bounded.q).unwrap().pose(elbow).unwrap().translation.z;
    assert!(height <= point.z + 1e-6 && bounded.criterion < found[0].criterion, "{bounded:?}");
}

#[test]
fn what_contradicts_a_criterion_is_named() {
    let panda = catalogue::load("panda").unwrap();
    let goals =
        [Goal::pose(panda.tool(), panda.state(panda.home()).unwrap().pose(panda.tool()).unwrap())];
    let error = |options: &IkOptions| solve(&panda, &goals, options).unwrap_err().to_string();
    let criterion = Criterion::LimitAvoidance { margin: 0.2 };
    assert!(error(&IkOptions { nearest: true, ..with(criterion) }).contains("nearest"));
    let posture = Some(panda.home().to_vec());
    assert!(error(&IkOptions { posture, ..with(criterion) }).contains("posture"));
    for margin in [0.0, 0.6, f64::NAN] {
        let told = error(&with(Criterion::LimitAvoidance { margin }));
        assert!(told.contains("share of the range"), "{told}");
    }
    let stewart = catalogue::load("stewart").unwrap();
    let pose = stewart.state(stewart.home()).unwrap().pose(stewart.tool()).unwrap();
    let told = solve(&stewart, &[Goal::pose(stewart.tool(), pose)], &with(criterion));
    assert!(told.unwrap_err().to_string().contains("criterion"));
}
