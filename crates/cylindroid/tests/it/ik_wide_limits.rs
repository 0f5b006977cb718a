//! Inverse kinematics inside limits that stand for none.

use std::path::Path;

use cylindroid::ik::{Goal, IkOptions, solve};

use crate::support::Random;

/// Seven hinges like those of a panda, on a link, with changed limits.
fn arm(link: &str, limits: impl Fn([f64; 2]) -> [f64; 2]) -> String {
    let joints = [
        ("0, 0, 0.33", "0, 0, 1", [-2.9, 2.9]),
        ("0, 0, 0.33", "0, 1, 0", [-1.76, 1.76]),
        ("0, 0, 0.65", "0, 0, 1", [-2.9, 2.9]),
        ("0.08, 0, 0.65", "0, -1, 0", [-3.07, -0.07]),
        ("0, 0, 1.03", "0, 0, 1", [-2.9, 2.9]),
        ("0, 0, 1.03", "0, -1, 0", [-0.0175, 3.75]),
        ("0.09, 0, 1.03", "0, 0, -1", [-2.9, 2.9]),
    ];
    let mut text = String::new();
    let mut parent = link.to_owned();
    for (i, (origin, axis, own)) in joints.into_iter().enumerate() {
        let [lower, upper] = limits(own);
        text.push_str(&format!(
            "[[joint]]\nname = \"q{i}\"\ntype = \"revolute\"\nbetween = [\"{parent}\", \"l{i}\"]\n\
             origin = [{origin}]\naxis = [{axis}]\n\
             limits = {{ lower = {lower:?}, upper = {upper:?} }}\n"
        ));
        parent = format!("l{i}");
    }
    text
}

/// An arm on a base with limits of a million metres: random restarts far away find nothing, and a
/// configuration that the last refinement brings to the target is a success.
#[test]
fn wide_limits_stand_for_none() {
    let slide = |name: &str, parent: &str, axis: &str| {
        format!(
            "[[joint]]\nname = \"{name}\"\ntype = \"prismatic\"\n\
             between = [\"{parent}\", \"{name}_link\"]\naxis = [{axis}]\n\
             limits = {{ lower = -999999.0, upper = 999999.0 }}\n"
        )
    };
    let mut text = format!("name = \"mobile\"\n{}", slide("x", "ground", "1, 0, 0"));
    text.push_str(&slide("y", "x_link", "0, 1, 0"));
    text.push_str(&arm("y_link", |limits| limits));
    let robot = cylindroid::load_text(&text, Path::new("mobile.toml")).unwrap();
    let mut random = Random(3);
    let mut options = IkOptions::default();
    options.budget.iterations = 500;
    for round in 0..100 {
        let target = robot.state(&random.q(&robot)).unwrap().pose(robot.tool()).unwrap();
        let found = solve(&robot, &[Goal::pose(robot.tool(), target)], &options).unwrap();
        assert!(found.success, "{round}: {found:?}");
        assert_eq!(robot.outside_limits(&found.q).next(), None);
    }
}

/// Joints that may turn several times: the nearest configuration is that beside the preferred one, also
/// turns away from zero.
#[test]
fn the_nearest_configuration_may_be_turns_away_from_zero() {
    let text = format!("name = \"turns\"\n{}", arm("ground", |_| [-10.0, 10.0]));
    let robot = cylindroid::load_text(&text, Path::new("turns.toml")).unwrap();
    let mut random = Random(5);
    for round in 0..40 {
        let start: Vec<f64> = (0..robot.n()).map(|_| random.within(-9.5, 9.5)).collect();
        let beside: Vec<f64> = start.iter().map(|x| x + random.within(-0.02, 0.02)).collect();
        let target = robot.state(&beside).unwrap().pose(robot.tool()).unwrap();
        let options =
            IkOptions { initial_guess: Some(start.clone()), nearest: true, ..IkOptions::default() };
        let found = solve(&robot, &[Goal::pose(robot.tool(), target)], &options).unwrap();
        let from_start =
            |q: &[f64]| q.iter().zip(&start).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
        assert!(found.success, "{round}: {found:?}");
        let (known, least) = (from_start(&beside), from_start(&found.q));
        assert!(least <= known + 1e-6, "{round}: {least} {known} {start:?}");
    }
}
