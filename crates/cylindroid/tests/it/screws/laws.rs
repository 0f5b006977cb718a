//! Laws of the hyperbolic pseudoinverse over random systems of every class, rank and shape.

use cylindroid::inverse::{self, HyperbolicDamping, HyperbolicOptions, Weights};
use cylindroid::linalg::{Metric, Svd};
use cylindroid::screws::{Class, NoInverse, ScrewOptions, ScrewSystem};
use cylindroid::spatial::{Pose, Twist, Vec3};
use cylindroid::{Inverse, Matrix, Method};

use super::sample::{CLASSES, Form, Setting, matrix, spanning};
use crate::support::{Random, assert_matrix};

/// The matrix of the form on vectors with the linear part first: [[0, 1/2], [1/2, -h]].
pub(super) fn form_matrix(h: f64) -> Matrix {
    Matrix::from_fn(6, 6, |i, j| match (i / 3, j / 3) {
        (1, 1) if i == j => -h,
        (0, 1) | (1, 0) if i % 3 == j % 3 => 0.5,
        _ => 0.0,
    })
}

pub(super) fn adjoint_matrix(pose: Pose) -> Matrix {
    let columns: Vec<Twist> = (0..6)
        .map(|j| {
            let unit = std::array::from_fn(|i| f64::from(u8::from(i == j)));
            pose.adjoint(Twist::from_array(unit))
        })
        .collect();
    matrix(&columns)
}

/// Symmetric, eigenvalues between about 1 and 6.
fn metric(random: &mut Random, n: usize) -> Matrix {
    let a = random.matrix(n, n);
    let mut m = &a * &a.transpose();
    (0..n).for_each(|i| m[(i, i)] += 1.0);
    m
}

#[track_caller]
fn assert_symmetric(what: &str, a: &Matrix, tolerance: f64) {
    assert_matrix(what, a, &a.transpose(), tolerance);
}

/// A random Jacobian of known class at length one, with a pitch away from the principal ones.
pub(super) struct Case {
    pub(super) form: Form,
    pub(super) j: Matrix,
    pub(super) h: f64,
    pub(super) never: bool,
}

pub(super) fn cases(seed: u64, rounds: usize, mut check: impl FnMut(&mut Random, &Case)) {
    for (c, (order, class)) in CLASSES.into_iter().enumerate() {
        let mut random = Random(100 * seed + c as u64);
        for round in 0..rounds {
            let form = Form::random(&mut random, order, class);
            // Independent columns; six; more than six.
            let count = [order, 6, 8][round % 3];
            let pose = Setting::PLAIN.pose(&mut random);
            let twists = spanning(&mut random, &form.basis(), count, pose, &Setting::PLAIN);
            let sign = if order > 3 { -1.0 } else { 1.0 };
            let h = loop {
                let h = random.within(-3.0, 3.0);
                if form.pitches.iter().all(|p| (sign * p - h).abs() > 0.3) {
                    break h;
                }
            };
            let never = class.never_invertible();
            check(&mut random, &Case { form, j: matrix(&twists), h, never });
        }
    }
    let mut random = Random(seed);
    for count in [6, 6, 7, 8, 12] {
        let j = loop {
            let j = random.matrix(6, count);
            let svd = Svd::of(&j);
            if svd.value(0) < 20.0 * svd.value(5) {
                break j;
            }
        };
        let form = Form { order: 6, class: Class::Full, pitches: vec![], slope: None };
        let h = random.within(-3.0, 3.0);
        check(&mut random, &Case { form, j, h, never: false });
    }
}

fn hyperbolic(j: &Matrix, h: f64, m: Option<&Matrix>, damping: HyperbolicDamping) -> Inverse {
    let joint_metric = m.map(|m| Metric::new("joint metric", m).unwrap());
    let options = HyperbolicOptions { joint_metric, damping, ..HyperbolicOptions::default() };
    inverse::hyperbolic_with(j, h, &options).unwrap()
}

const PLAIN: HyperbolicDamping = HyperbolicDamping::None;

/// The four laws, with the transpose of the twist side replaced by the adjoint of the form; that
/// of the joint side by the one of the joint metric.
#[test]
fn four_laws() {
    cases(1, 30, |random, case| {
        let (j, h) = (&case.j, case.h);
        let m = metric(random, j.cols());
        for metric in [None, Some(&m)] {
            let found = hyperbolic(j, h, metric, PLAIN);
            assert_eq!(found.exists, !case.never, "{:?}", case.form);
            assert_eq!(found.rank, case.form.order);
            if case.never {
                assert!(found.matrix.as_slice().iter().all(|x| x.is_nan()));
                assert!(matches!(found.reason, Some(NoInverse::Class { .. })));
                continue;
            }
            let a = &found.matrix;
            assert_eq!((a.rows(), a.cols()), (j.cols(), 6));
            // Rounding of a product is relative to the sizes of its factors.
            let (sj, sa) = (j.frobenius_norm(), a.frobenius_norm());
            let size = 1e-13 * (1.0 + sj * sa);
            let p = j * a;
            assert_matrix("(hP1) J A J = J", &(&p * j), j, size * sj);
            assert_matrix("(hP2) A J A = A", &(a * &p), a, size * sa);
            let q = form_matrix(h);
            assert_symmetric("(hP3) Q J A", &(&q * &p), size * (1.0 + h.abs()));
            let identity = Matrix::identity(j.cols());
            let m = metric.unwrap_or(&identity);
            let maj = &(m * a) * j;
            assert_symmetric("(hP4) M A J", &maj, size * m.frobenius_norm());
        }
    });
}

/// J+h of a moved Jacobian is J+h of the Jacobian after moving back; in millimetres too.
#[test]
fn no_frame_and_no_unit_changes_the_rates() {
    cases(2, 12, |random, case| {
        if case.never {
            return;
        }
        let a = hyperbolic(&case.j, case.h, None, PLAIN).matrix;
        for far in [1.0, 100.0, 1e4] {
            let pose = Pose { rotation: random.rotation(), translation: random.vec3(far) };
            let there = hyperbolic(&(&adjoint_matrix(pose) * &case.j), case.h, None, PLAIN);
            assert!(there.exists, "{:?}", case.form);
            // The moved columns themselves are rounded to their size, and it is squared by the
            // way back.
            let rounding = 1e-14 * (10.0 + far * far) * (1.0 + a.frobenius_norm()).powi(2);
            let size = case.j.frobenius_norm();
            let back = &there.matrix * &adjoint_matrix(pose);
            assert_matrix("frame", &back, &a, rounding * (1.0 + size));
        }
        let unit = |i: usize| if i < 3 { 1e3 } else { 1.0 };
        let j = Matrix::from_fn(6, case.j.cols(), |r, c| case.j[(r, c)] * unit(r));
        let options =
            HyperbolicOptions { scale: ScrewOptions::with_length(1e3), ..Default::default() };
        let there = inverse::hyperbolic_with(&j, 1e3 * case.h, &options).unwrap().matrix;
        let back = Matrix::from_fn(j.cols(), 6, |r, c| there[(r, c)] * unit(c));
        let size = 1e-13 * (1.0 + a.frobenius_norm()).powi(2);
        assert_matrix("unit", &back, &a, size);
    });
}

/// For rank 6 nothing is left to choose: Moore-Penrose, in the joint metric.
#[test]
fn rank_six_is_moore_penrose() {
    cases(3, 0, |random, case| {
        let m = metric(random, case.j.cols());
        for joint in [None, Some(Metric::new("joint metric", &m).unwrap())] {
            let weights = Weights { joint: joint.clone(), task: None };
            let method = Method::Truncated { eps: 1e-12 };
            let plain = inverse::weighted(&case.j, method, &weights).unwrap().matrix;
            for h in [0.0, case.h, -40.0, f64::INFINITY] {
                let options =
                    HyperbolicOptions { joint_metric: joint.clone(), ..Default::default() };
                let found = inverse::hyperbolic_with(&case.j, h, &options).unwrap();
                assert!(found.exists && found.dropped.is_empty());
                assert_matrix("J+h", &found.matrix, &plain, 1e-11);
            }
        }
    });
}

/// Theorem 5: J+h s makes (s - J t)^T Q_h (s - J t) stationary; below all principal pitches it is
/// a minimum, above them a maximum, between a saddle (type A of order up to three).
#[test]
fn the_error_is_stationary() {
    cases(4, 9, |random, case| {
        if case.never {
            return;
        }
        let type_a = case.form.order <= 3
            && matches!(
                case.form.class,
                Class::H | Class::IA | Class::IIA | Class::IA1 | Class::IA2
            );
        for h in [case.h, -9.0, 9.0] {
            let a = hyperbolic(&case.j, h, None, PLAIN).matrix;
            let s = random.twist();
            let rates = a.mul_vec(&s.to_array());
            let phi = |t: &[f64]| {
                let moved = case.j.mul_vec(t);
                let rest = s - Twist::from_array(std::array::from_fn(|i| moved[i]));
                rest.pitch_form(rest, h)
            };
            let at = phi(&rates);
            let (mut up, mut down) = (false, false);
            // In any direction, and along the principal screws, where it curves most.
            let system = ScrewSystem::of_columns(&case.j, &ScrewOptions::default()).unwrap();
            let screws = system.principal_screws().iter().map(|s| s.twist().to_array());
            let mut steps: Vec<_> = screws.map(|s| a.mul_vec(&s)).collect();
            steps.extend((0..20).map(|_| random.vector(rates.len())));
            for step in steps {
                let there = |x: f64| {
                    phi(&rates.iter().zip(&step).map(|(r, d)| r + x * d).collect::<Vec<_>>())
                };
                // The function is quadratic: central differences have no truncation.
                let (plus, minus) = (there(1.0), there(-1.0));
                let size = plus.abs() + minus.abs() + at.abs();
                let rates_size: f64 = rates.iter().map(|r| r.abs()).sum();
                let tolerance = 1e-12 * (1.0 + size) * (1.0 + rates_size);
                assert!((plus - minus).abs() <= tolerance, "{:?} {h}: {plus} {minus}", case.form);
                up |= 0.5 * (plus + minus) - at > tolerance;
                down |= 0.5 * (plus + minus) - at < -tolerance;
            }
            if type_a {
                let (above, below) = (|p: &f64| *p > h, |p: &f64| *p < h);
                let expected =
                    (case.form.pitches.iter().any(above), case.form.pitches.iter().any(below));
                assert_eq!((up, down), expected, "{:?} {h}", case.form);
            }
        }
    });
}

/// (J^T Q_h J + lambda M) A = J^T Q_h, and no other A where the matrix is regular.
#[test]
fn gram_damping_solves_its_equation() {
    cases(5, 12, |random, case| {
        let (j, h) = (&case.j, case.h);
        let m = metric(random, j.cols());
        let identity = Matrix::identity(j.cols());
        for metric in [None, Some(&m)] {
            for lambda in [0.7, 3.0, 20.0, -8.0] {
                let found = hyperbolic(j, h, metric, HyperbolicDamping::Gram { lambda });
                assert!(found.exists, "{:?} {lambda}: {:?}", case.form, found.reason);
                let lowered = &j.transpose() * &form_matrix(h);
                let mut damped = &lowered * j;
                let m = metric.unwrap_or(&identity);
                for r in 0..j.cols() {
                    for c in 0..j.cols() {
                        damped[(r, c)] += lambda * m[(r, c)];
                    }
                }
                let size = (1.0 + damped.frobenius_norm()) * (1.0 + found.matrix.frobenius_norm());
                assert_matrix("damped", &(&damped * &found.matrix), &lowered, 1e-13 * size);
            }
        }
    });
}

/// Where lambda is the negative of an eigenvalue of the Gram matrix there is none, and it says so.
#[test]
fn gram_damping_meets_an_eigenvalue() {
    let mut random = Random(6);
    for _ in 0..50 {
        // Orthogonal columns of pitches 1.5 and -0.5 and amplitude a: the eigenvalues are known.
        let (a, pose) = (random.within(0.5, 2.0), random.pose());
        let x = Twist { linear: Vec3::X * 1.5, angular: Vec3::X } * a;
        let y = Twist { linear: Vec3::Y * -0.5, angular: Vec3::Y } * a;
        let j = matrix(&[pose.adjoint(x), pose.adjoint(y)]);
        let h = random.within(-3.0, 3.0);
        for pitch in [1.5, -0.5] {
            let eigenvalue = a * a * (pitch - h);
            let damping = HyperbolicDamping::Gram { lambda: -eigenvalue };
            let found = hyperbolic(&j, h, None, damping);
            let Some(NoInverse::DampingMeetsEigenvalue { eigenvalue: said }) = found.reason else {
                panic!("{found:?}")
            };
            assert!(!found.exists && found.matrix.as_slice().iter().all(|x| x.is_nan()));
            assert!((said - eigenvalue).abs() < 1e-12, "{said} {eigenvalue}");
        }
    }
    // The example that the paper overlooks: one rotation, h = 1, lambda = 1.
    let j = matrix(&[Twist { linear: Vec3::ZERO, angular: Vec3::X }]);
    assert!(!hyperbolic(&j, 1.0, None, HyperbolicDamping::Gram { lambda: 1.0 }).exists);
}

/// A screw of the pitch h takes no part, however small mu is: what rounding leaves of its zero is not
/// divided by mu^2. Beside it, an orthogonal screw of another pitch keeps its motion.
#[test]
fn invariant_damping_leaves_zeros_out() {
    let mut random = Random(16);
    for _ in 0..50 {
        let (size, pose) = (10.0_f64.powf(random.within(-2.0, 2.0)), random.pose());
        let h = size * [-3.0, -0.2, 0.3, 2.0][(random.next_u64() % 4) as usize];
        let screw = |axis: Vec3, pitch: f64| Twist { linear: axis * pitch, angular: axis };
        let placed = Pose { translation: pose.translation * size, ..pose };
        let other = h + 0.7 * size;
        let columns = [screw(Vec3::X, h), screw(Vec3::Y, other)].map(|s| placed.adjoint(s));
        for (count, rates) in [(1, vec![0.0]), (2, vec![0.0, 1.0])] {
            let j = matrix(&columns[..count]);
            let damping = HyperbolicDamping::Invariant { mu: 1e-9 * size };
            let found = hyperbolic(&j, h, None, damping).matrix;
            let along = found.mul_vec(&columns[count - 1].to_array());
            for (rate, expected) in along.iter().zip(&rates) {
                assert!((rate - expected).abs() < 1e-9, "{size} {h} {count}: {along:?}");
            }
            let largest = found.as_slice().iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            assert!(largest < 100.0 * (1.0 + 1.0 / size), "{size} {h} {count}: {largest}");
        }
    }
}

/// The invariant damping always exists, does not depend on the frame, and comes to J+h with the
/// square of mu where that exists, else to a limit.
#[test]
fn invariant_damping() {
    cases(7, 9, |random, case| {
        let h = case.h;
        // Sized so that mu is small against every eigenvalue of the Gram matrix but the zeros.
        let gram = Svd::of(&(&(&case.j.transpose() * &form_matrix(h)) * &case.j));
        let smallest = gram.values().filter(|s| *s > 1e-9 * gram.value(0)).last();
        let scale = smallest.map_or(1.0, |s| f64::sqrt(10.0 / s));
        let j = &Matrix::from_fn(6, case.j.cols(), |r, c| scale * case.j[(r, c)]);
        let m = metric(random, j.cols());
        for metric in [None, Some(&m)] {
            let damped = |mu: f64| {
                let found = hyperbolic(j, h, metric, HyperbolicDamping::Invariant { mu });
                assert!(found.exists && found.reason.is_none() && found.matrix.is_finite());
                found.matrix
            };
            for far in [1.0, 100.0] {
                let pose = Pose { rotation: random.rotation(), translation: random.vec3(far) };
                let mu = random.within(0.01, 1.0);
                let here = damped(mu);
                let moved = &adjoint_matrix(pose) * j;
                let there = hyperbolic(&moved, h, metric, HyperbolicDamping::Invariant { mu });
                let back = &there.matrix * &adjoint_matrix(pose);
                let size = (1.0 + here.frobenius_norm()).powi(2) * (1.0 + j.frobenius_norm());
                assert_matrix("frame", &back, &here, 1e-13 * far * far * size * (1.0 + 1.0 / mu));
            }
            let limit = match case.never {
                false => hyperbolic(j, h, metric, PLAIN).matrix,
                true => damped(1e-9),
            };
            let mu = 1e-2;
            let far = damped(mu).max_difference(&limit);
            let near = damped(0.1 * mu).max_difference(&limit);
            let floor = 1e-11 * (1.0 + limit.frobenius_norm());
            assert!(near <= 0.0102 * far + floor, "{:?}: {near} {far}", case.form);
        }
    });
}

#[test]
fn damping_outside_its_domain() {
    let j = matrix(&[Twist { linear: Vec3::ZERO, angular: Vec3::X }]);
    let with = |h: f64, damping| {
        let options = HyperbolicOptions { damping, ..Default::default() };
        inverse::hyperbolic_with(&j, h, &options)
    };
    for mu in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(with(0.3, HyperbolicDamping::Invariant { mu }).is_err(), "{mu}");
    }
    for lambda in [f64::NAN, f64::INFINITY] {
        assert!(with(0.3, HyperbolicDamping::Gram { lambda }).is_err());
    }
    assert!(with(f64::INFINITY, HyperbolicDamping::Invariant { mu: 1.0 }).is_err());
    assert!(with(f64::NAN, PLAIN).is_err());
    assert!(inverse::hyperbolic(&Matrix::zeros(5, 2), 0.3).is_err());
    assert!(inverse::hyperbolic(&Matrix::from_fn(6, 1, |_, _| f64::NAN), 0.3).is_err());
    let joint_metric = Some(Metric::diagonal("joint metric", &[1.0, 2.0]).unwrap());
    let options = HyperbolicOptions { joint_metric, ..Default::default() };
    assert!(inverse::hyperbolic_with(&j, 0.3, &options).is_err(), "a metric of another size");
    // No joints, and joints that do nothing: the inverse is zero.
    for m in [0, 3] {
        let none = inverse::hyperbolic(&Matrix::zeros(6, m), 0.3).unwrap();
        assert!(none.exists);
        assert_eq!(none.matrix, Matrix::zeros(m, 6));
    }
}

/// Eq. (26): on the span of J, along the twists given up, in any frame.
#[test]
fn oblique_projection() {
    cases(8, 9, |random, case| {
        let lacking = 6 - case.form.order;
        let k = random.matrix(6, lacking);
        let system = ScrewSystem::of_columns(&case.j, &ScrewOptions::default()).unwrap();
        let other = ScrewSystem::of_columns(&k, &ScrewOptions::default()).unwrap();
        let found = inverse::oblique(&case.j, &k, &HyperbolicOptions::default()).unwrap();
        assert!(found.exists);
        let p = &case.j * &found.matrix;
        let size = 1e-13 * (1.0 + case.j.frobenius_norm() * found.matrix.frobenius_norm()).powi(2);
        assert_matrix("P P = P", &(&p * &p), &p, size);
        assert_matrix("P J = J", &(&p * &case.j), &case.j, size * case.j.frobenius_norm());
        assert_matrix("P K = 0", &(&p * &k), &Matrix::zeros(6, lacking), size);
        let projector = system.projector_along(&other).unwrap();
        assert_matrix("projector", &projector.matrix(), &p, size);
        // Not enough to give up, and what may not be given up.
        if case.form.order > 0 && lacking > 0 {
            let short = Matrix::from_fn(6, lacking - 1, |r, c| k[(r, c)]);
            let reason = |k: &Matrix| {
                let found = inverse::oblique(&case.j, k, &HyperbolicOptions::default()).unwrap();
                assert!(!found.exists && found.matrix.as_slice().iter().all(|x| x.is_nan()));
                found.reason
            };
            let order = case.form.order;
            let expected = NoInverse::NotComplementary { order, other: lacking - 1 };
            assert_eq!(reason(&short), Some(expected));
            let mut meets = k.clone();
            meets.column_mut(0).copy_from_slice(case.j.column(0));
            let expected = NoInverse::NotComplementary { order, other: lacking };
            assert_eq!(reason(&meets), Some(expected));
        }
    });
}
