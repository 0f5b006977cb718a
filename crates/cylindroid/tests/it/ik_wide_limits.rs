//! Inverse kinematics inside limits that stand for none.

use std::path::Path;

use cylindroid::ik::{Goal, IkOptions, solve};

use crate::support::Random;

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
    let arm = [
        ("0, 0, 0.33", "0, 0, 1", -2.9, 2.9),
        ("0, 0, 0.33", "0, 1, 0", -1.76, 1.76),
        ("0, 0, 0.65", "0, 0, 1", -2.9, 2.9),
        ("0.08, 0, 0.65", "0, -1, 0", -3.07, -0.07),
        ("0, 0, 1.03", "0, 0, 1", -2.9, 2.9),
        ("0, 0, 1.03", "0, -1, 0", -0.0175, 3.75),
        ("0.09, 0, 1.03", "0, 0, -1", -2.9, 2.9),
    ];
    let mut text = format!("name = \"mobile\"\n{}", slide("x", "ground", "1, 0, 0"));
    text.push_str(&slide("y", "x_link", "0, 1, 0"));
    let mut parent = "y_link".to_owned();
    for (i, (origin, axis, lower, upper)) in arm.into_iter().enumerate() {
        text.push_str(&format!(
            "[[joint]]\nname = \"q{i}\"\ntype = \"revolute\"\nbetween = [\"{parent}\", \"l{i}\"]\n\
             origin = [{origin}]\naxis = [{axis}]\n\
             limits = {{ lower = {lower:?}, upper = {upper:?} }}\n"
        ));
        parent = format!("l{i}");
    }
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
