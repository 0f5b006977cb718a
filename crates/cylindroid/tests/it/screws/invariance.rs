//! Rates of arms of fewer than six joints, seen from several frames and in two units.

use cylindroid::inverse::{self, HyperbolicOptions};
use cylindroid::linalg::Svd;
use cylindroid::screws::{ScrewOptions, ScrewSystem};
use cylindroid::spatial::{Pose, Twist, Vec3};
use cylindroid::{Matrix, ReferenceFrame, catalogue};

use super::laws::adjoint_matrix;
use super::sample::matrix;
use crate::support::Random;

/// Twists of a frame seen from another, in units of 1 / `unit` m.
struct View {
    name: &'static str,
    there_from_base: Pose,
    unit: f64,
}

impl View {
    fn see(&self, columns: &Matrix) -> Matrix {
        let moved = &adjoint_matrix(self.there_from_base) * columns;
        let unit = |i: usize| if i < 3 { self.unit } else { 1.0 };
        Matrix::from_fn(6, moved.cols(), |i, j| moved[(i, j)] * unit(i))
    }
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|a| a * a).sum::<f64>().sqrt()
}

/// |a - b| / |b|
fn difference(a: &[f64], b: &[f64]) -> f64 {
    norm(&a.iter().zip(b).map(|(x, y)| x - y).collect::<Vec<_>>()) / norm(b)
}

/// The hyperbolic rates are the same in all views, with h the same length; those of Moore and
/// Penrose are not, by what is printed.
fn seen_from_everywhere(arm: &str, h: f64) {
    let robot = catalogue::load(arm).unwrap();
    let mut random = Random(2024);
    let (mut existing, mut worst) = (0, 0.0_f64);
    let mut changes: Vec<(&str, Vec<f64>)> = vec![];
    for _ in 0..100 {
        let state = robot.state(&random.q(&robot)).unwrap();
        let base = state.jacobian(robot.tool(), ReferenceFrame::World).unwrap();
        let twist = matrix(&[random.twist()]);
        let options = ScrewOptions::with_length(robot.reach());
        let system = ScrewSystem::of_columns(&base, &options).unwrap();
        let outside = Twist::from_array(std::array::from_fn(|i| twist[(i, 0)]));
        assert!(!system.contains(outside));
        let tool = state.pose(robot.tool()).unwrap().inverse();
        let away = Pose { rotation: random.rotation(), translation: random.vec3(10.0) };
        let views = [
            View { name: "base, m", there_from_base: Pose::IDENTITY, unit: 1.0 },
            View { name: "base, mm", there_from_base: Pose::IDENTITY, unit: 1e3 },
            View { name: "tool, m", there_from_base: tool, unit: 1.0 },
            View { name: "tool, mm", there_from_base: tool, unit: 1e3 },
            View { name: "10 m away, m", there_from_base: away, unit: 1.0 },
            View { name: "10 m away, mm", there_from_base: away, unit: 1e3 },
        ];
        let rates = |view: &View, hyperbolic: bool| {
            let (j, s) = (view.see(&base), view.see(&twist));
            let found = if hyperbolic {
                let scale = ScrewOptions::with_length(robot.reach() * view.unit);
                let options = HyperbolicOptions { scale, ..HyperbolicOptions::default() };
                inverse::hyperbolic_with(&j, h * view.unit, &options).unwrap()
            } else {
                inverse::truncated(&j, 1e-9).unwrap()
            };
            found.exists.then(|| found.matrix.mul_vec(s.column(0)))
        };
        let (reference, plain) = (rates(&views[0], true), rates(&views[0], false).unwrap());
        existing += usize::from(reference.is_some());
        for (v, view) in views.iter().enumerate().skip(1) {
            match (&reference, rates(view, true)) {
                (Some(expected), Some(got)) => {
                    let change = difference(&got, expected);
                    worst = worst.max(change);
                    assert!(change < 1e-9, "{arm}, {}: {change:e}", view.name);
                }
                (None, None) => {}
                other => panic!("{arm}, {}: exists or not? {other:?}", view.name),
            }
            if changes.len() < v {
                changes.push((view.name, vec![]));
            }
            changes[v - 1].1.push(difference(&rates(view, false).unwrap(), &plain));
        }
    }
    println!("{arm}, h = {h} m: exists in {existing} of 100 poses, rates differ by {worst:.0e}");
    assert!(existing >= 95, "{existing}");
    for (name, mut percent) in changes {
        percent.sort_by(f64::total_cmp);
        let [least, median, most] = [0, 50, 99].map(|i| 100.0 * percent[i]);
        println!("  Moore-Penrose, {name}: {least:.2} to {most:.0} %, median {median:.0} %");
        assert!(median > 1.0, "{arm}, {name}: {median} %");
    }
}

#[test]
fn youbot() {
    seen_from_everywhere("youbot", 0.1);
}

#[test]
fn three_joints() {
    seen_from_everywhere("3r", 0.1);
}

/// A twist that the joints can carry out leaves nothing to choose: all inverses agree.
#[test]
fn within_the_span_all_agree() {
    let mut random = Random(7);
    for arm in ["youbot", "3r"] {
        let robot = catalogue::load(arm).unwrap();
        for _ in 0..50 {
            let state = robot.state(&random.q(&robot)).unwrap();
            let j = state.jacobian(robot.tool(), ReferenceFrame::World).unwrap();
            let rates = random.vector(robot.n());
            let s = j.mul_vec(&rates);
            let found = inverse::hyperbolic(&j, 0.1).unwrap();
            if found.exists {
                assert!(difference(&found.matrix.mul_vec(&s), &rates) < 1e-9);
            }
            let there = Pose::from_translation(Vec3::new(3.0, -2.0, 5.0));
            let moved = View { name: "", there_from_base: there, unit: 1e3 };
            let far = moved.see(&j);
            let plain = inverse::truncated(&far, 1e-9).unwrap().matrix;
            let seen = moved.see(&Matrix::from_fn(6, 1, |i, _| s[i]));
            // What rounding leaves: one posture here has a condition of 3e7.
            let values: Vec<f64> = Svd::of(&far).values().collect();
            let rounding = 10.0 * f64::EPSILON * values[0] / values[values.len() - 1];
            assert!(difference(&plain.mul_vec(seen.column(0)), &rates) < rounding);
        }
    }
}

/// Six independent axes span all of space, from wherever they are seen.
#[test]
fn order_six_from_far_away() {
    let mut random = Random(2031);
    for name in ["panda", "ur5e"] {
        let robot = catalogue::load(name).unwrap();
        let options = ScrewOptions::with_length(robot.reach());
        for round in 0..40 {
            let state = robot.state(&random.q(&robot)).unwrap();
            let base = state.jacobian(robot.tool(), ReferenceFrame::World).unwrap();
            let here = ScrewSystem::of_columns(&base, &options).unwrap();
            let away = random.vec3(1.0) * [3.0, 9.0, 11.0, 1e3, 1e4][round % 5];
            let away = Pose { rotation: random.rotation(), translation: away };
            let there = &adjoint_matrix(away) * &base;
            let there = ScrewSystem::of_columns(&there, &options).unwrap();
            assert_eq!(here.order(), 6, "{name} {round}");
            assert_eq!(there.order(), 6, "{name} {round}: {away:?}");
            assert_eq!(here.class(), there.class());
        }
    }
}
