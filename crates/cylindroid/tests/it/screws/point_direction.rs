//! Joint velocities that move a point along a direction, against what the arm does.

use cylindroid::inverse::point_direction;
use cylindroid::linalg::Svd;
use cylindroid::spatial::{Pose, Twist, Vec3};
use cylindroid::{Matrix, ReferenceFrame, catalogue};

use super::laws::adjoint_matrix;
use super::sample::matrix;
use crate::support::{Random, planar};

/// The velocity of the point under rates.
fn velocity(j: &Matrix, rates: &[f64], point: Vec3) -> Vec3 {
    let v = j.mul_vec(rates);
    Twist::from_array(std::array::from_fn(|i| v[i])).at_point(point).linear
}

/// Everything that the two parts of an answer promise; `still` of the given dimension.
#[track_caller]
fn check(j: &Matrix, point: Vec3, q: Vec3, reachable: bool, dimension: usize, tolerance: f64) {
    let found = point_direction(j, point, q).unwrap();
    assert_eq!((found.along.is_some(), found.still.cols()), (reachable, dimension), "{j:?}");
    assert_eq!(found.still.rows(), j.cols());
    let gram = &found.still.transpose() * &found.still;
    assert!(gram.max_difference(&Matrix::identity(dimension)) < 1e-12, "orthonormal");
    for c in 0..dimension {
        assert!(velocity(j, found.still.column(c), point).norm() < tolerance);
    }
    if let Some(along) = &found.along {
        let unit = q.unit(0.0).unwrap();
        let error = velocity(j, along, point) - unit;
        assert!(error.norm() < tolerance * (1.0 + along.iter().fold(0.0, |m, x| x.abs().max(m))));
        // The smallest: across every still motion.
        let mut overlap = vec![0.0; dimension];
        found.still.tr_mul_vec_into(along, &mut overlap);
        let size = along.iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!(overlap.iter().all(|x| x.abs() < 1e-12 * size.max(1.0)));
    }
}

/// The dimension of the set counted another way: rates whose velocity across q is zero.
#[test]
fn the_set_is_complete() {
    let mut random = Random(1);
    for m in 1..9 {
        for _ in 0..40 {
            let (j, point, q) = (random.matrix(6, m), random.vec3(1.0), random.vec3(1.0));
            let unit = q.unit(0.0).unwrap();
            let columns: Vec<Vec3> = (0..m)
                .map(|c| {
                    let mut rates = vec![0.0; m];
                    rates[c] = 1.0;
                    velocity(&j, &rates, point)
                })
                .collect();
            let rank = |f: &dyn Fn(Vec3) -> Vec3| {
                let f = Matrix::from_fn(3, m, |i, c| f(columns[c])[i]);
                Svd::of(&f).values().filter(|s| *s > 1e-9).count()
            };
            let (still, all) = (m - rank(&|v| v), m - rank(&|v| v - unit * unit.dot(v)));
            check(&j, point, q, all > still, still, 1e-10);
        }
    }
}

/// The tool of a real arm goes that way.
#[test]
fn arms_go_that_way() {
    let mut random = Random(2);
    for name in ["panda", "youbot", "3r"] {
        let robot = catalogue::load(name).unwrap();
        for _ in 0..20 {
            let q = random.q(&robot);
            let state = robot.state(&q).unwrap();
            let j = state.jacobian(robot.tool(), ReferenceFrame::World).unwrap();
            let at = |q: &[f64]| robot.state(q).unwrap().pose(robot.tool()).unwrap().translation;
            let (point, way) = (at(&q), random.vec3(1.0));
            let found = point_direction(&j, point, way).unwrap();
            let along = found.along.unwrap();
            let speed = along.iter().map(|x| x.abs()).sum::<f64>();
            let step = 1e-4 / (1.0 + speed);
            let there = |x: f64| at(&robot.integrate(&q, &along, x).unwrap());
            let moved = (there(step) - there(-step)) * (0.5 / step);
            // Central differences: step^2 times the third derivative.
            let error = (moved - way.unit(0.0).unwrap()).norm();
            assert!(error < 1e-7 * (1.0 + speed), "{name}: {error:e}");
        }
    }
}

#[test]
fn where_no_rates_go_that_way() {
    // A planar arm moves nothing out of its plane; stretched, its tip not along itself.
    let robot = planar(3);
    for (q, way, reachable, still) in [
        ([0.3, 0.5, -1.0], Vec3::Z, false, 1),
        ([0.3, 0.5, -1.0], Vec3::new(1.0, 0.0, 1e-3), false, 1),
        ([0.3, 0.5, -1.0], Vec3::new(1.0, 2.0, 0.0), true, 1),
        ([0.0, 0.0, 0.0], Vec3::X, false, 2),
        ([0.0, 0.0, 0.0], Vec3::Y, true, 2),
    ] {
        let state = robot.state(&q).unwrap();
        let j = state.jacobian(robot.tool(), ReferenceFrame::World).unwrap();
        let point = state.pose(robot.tool()).unwrap().translation;
        check(&j, point, way, reachable, still, 1e-13);
    }
}

/// A point on the axis stays, in any frame, whatever the joint does.
#[test]
fn a_point_on_the_only_axis() {
    let mut random = Random(3);
    for far in [0.0, 1.0, 1e4] {
        for _ in 0..50 {
            let pose = Pose { rotation: random.rotation(), translation: random.vec3(far) };
            let axis = Twist { linear: Vec3::ZERO, angular: Vec3::Z } * random.within(0.1, 10.0);
            let on_it = pose * (Vec3::Z * random.within(-2.0, 2.0));
            let j = &adjoint_matrix(pose) * &matrix(&[axis]);
            check(&j, on_it, random.vec3(1.0), false, 1, 1e-13 * (1.0 + far));
            // Next to it the point goes one way.
            let beside = pose * Vec3::X;
            check(&j, beside, pose.rotation * Vec3::Y, true, 0, 1e-11 * (1.0 + far));
            check(&j, beside, pose.rotation * Vec3::X, false, 0, 1e-11);
        }
    }
}

#[test]
fn wrong_input() {
    let j = Matrix::from_fn(6, 3, |i, c| (i + c) as f64);
    for bad in [Vec3::ZERO, Vec3::X * f64::NAN, Vec3::X * f64::INFINITY] {
        assert!(point_direction(&j, Vec3::ZERO, bad).is_err());
    }
    assert!(point_direction(&j, Vec3::X * f64::NAN, Vec3::X).is_err());
    assert!(point_direction(&Matrix::zeros(3, 3), Vec3::ZERO, Vec3::X).is_err());
    assert!(point_direction(&Matrix::from_fn(6, 1, |_, _| f64::NAN), Vec3::ZERO, Vec3::X).is_err());
    // No joints: nothing moves.
    let none = point_direction(&Matrix::zeros(6, 0), Vec3::ZERO, Vec3::X).unwrap();
    assert_eq!((none.along, none.still), (None, Matrix::zeros(0, 0)));
    // Joints that do nothing do it freely.
    check(&Matrix::zeros(6, 2), Vec3::ZERO, Vec3::X, false, 2, 1e-15);
}

/// No unit of length changes the answer: per unit of velocity the rates are inversely as large.
#[test]
fn the_set_depends_on_no_unit() {
    let mut random = Random(5);
    for m in 1..8 {
        let (j, point, q) = (random.matrix(6, m), random.vec3(1.0), random.vec3(1.0));
        let plain = point_direction(&j, point, q).unwrap();
        for unit in [1e-14, 1e14] {
            let of_row = |i: usize| if i < 3 { unit } else { 1.0 };
            let scaled = Matrix::from_fn(6, m, |i, c| j[(i, c)] * of_row(i));
            let found = point_direction(&scaled, point * unit, q).unwrap();
            assert_eq!(found.still.cols(), plain.still.cols(), "{m} {unit}");
            let [a, b] =
                [&found.along, &plain.along].map(|along| along.clone().unwrap_or_default());
            assert_eq!(a.len(), b.len(), "{m} {unit}");
            for (a, b) in a.iter().zip(&b) {
                assert!((a * unit - b).abs() < 1e-9 * (1.0 + b.abs()), "{m} {unit}: {a} {b}");
            }
        }
    }
}
