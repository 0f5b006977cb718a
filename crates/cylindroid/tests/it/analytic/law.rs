//! What every answer must keep, and every configuration that made a target.

use std::f64::consts::{PI, TAU};

use cylindroid::ik::{Analytic, AnalyticSolution};
use cylindroid::{Mechanism, Pose};

use crate::support::Random;

/// Differences modulo whole turns, the largest.
pub(super) fn apart(a: &[f64], b: &[f64]) -> f64 {
    let one = |(a, b): (&f64, &f64)| ((a - b) - TAU * ((a - b) / TAU).round()).abs();
    a.iter().zip(b).map(one).fold(0.0, f64::max)
}

/// Forward kinematics says the same, to 1e-10 in both parts.
pub(super) fn confirm(robot: &Mechanism, target: Pose, answers: &[AnalyticSolution]) {
    for answer in answers {
        let error = robot.state(&answer.q).unwrap().pose(robot.tool()).unwrap().error_to(target);
        let far = (error.linear.norm(), error.angular.norm());
        assert!(far.0 < 1e-10 * robot.reach() && far.1 < 1e-10, "{far:?} {answer:?}");
        assert!(answer.q.iter().all(|x| x.is_finite()));
    }
    for (i, a) in answers.iter().enumerate() {
        assert!(answers[..i].iter().all(|b| apart(&a.q, &b.q) > 1e-7), "{answers:?}");
    }
}

/// The smallest over the largest singular value, lengths over the reach.
pub(super) fn condition(robot: &Mechanism, q: &[f64]) -> f64 {
    let mut j = robot
        .state(q)
        .unwrap()
        .jacobian(robot.tool(), cylindroid::ReferenceFrame::LocalWorldAligned)
        .unwrap();
    for c in 0..6 {
        (0..3).for_each(|r| j[(r, c)] /= robot.reach());
    }
    let svd = cylindroid::linalg::Svd::of(&j);
    svd.value(5) / svd.value(0)
}

/// The configuration that made the target is among the answers.
pub(super) fn known_postures_are_found(
    robot: &Mechanism,
    random: &mut Random,
    count: usize,
) -> usize {
    let mut ik = Analytic::of(robot, robot.tool()).unwrap();
    let mut most = 0;
    for _ in 0..count {
        let q = random.vector(6).iter().map(|x| PI * x).collect::<Vec<_>>();
        let target = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
        let start = random.vector(6);
        let answers = ik.solve(target, &start).unwrap();
        confirm(robot, target, &answers);
        let near = answers.iter().map(|a| apart(&a.q, &q)).fold(9.0, f64::min);
        // An angle is known to the error of the pose over the conditioning.
        let condition = condition(robot, &q);
        assert!(
            near < 1e-9 + 1e-12 / condition || condition < 1e-7,
            "{}: {near:e} at {condition:e}, {answers:?}, {q:?}",
            ik.geometry()
        );
        most = most.max(answers.len());
    }
    most
}
