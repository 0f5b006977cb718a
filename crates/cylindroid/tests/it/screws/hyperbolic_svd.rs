//! Hyperbolic singular values and polar decompositions.

use cylindroid::inverse::{self, HyperbolicOptions, HyperbolicSvd, PolarKind, hyperbolic_svd};
use cylindroid::linalg::{Metric, Svd};
use cylindroid::screws::{Class, NoInverse, ScrewOptions, ScrewSystem, Signature, gram};
use cylindroid::spatial::{Twist, Vec3};
use cylindroid::{Error, Matrix};

use super::laws::{adjoint_matrix, form_matrix};
use super::sample::{CLASSES, Form, Setting, matrix, spanning};
use super::vectors::reference_matrix;
use crate::support::{Random, assert_close, assert_matrix};

fn scale() -> ScrewOptions {
    ScrewOptions::default()
}

fn random_metric(random: &mut Random, m: usize) -> Matrix {
    let root = random.matrix(m, m);
    let mut metric = &root.transpose() * &root;
    for i in 0..m {
        metric[(i, i)] += 0.5;
    }
    metric
}

fn diagonal(signs: Signature, k: usize) -> Matrix {
    let sign = |i: usize| {
        f64::from(u8::from(i < signs.positive))
            - f64::from(u8::from(i >= signs.positive + signs.zero))
    };
    Matrix::diagonal(&(0..k).map(sign).collect::<Vec<_>>())
}

/// Every class, more columns than the order, a metric, a pitch: J, M, h and the decomposition.
fn cases(mut check: impl FnMut(&Form, &Matrix, &Matrix, f64, &HyperbolicSvd)) {
    let mut random = Random(172);
    for (order, class) in CLASSES.into_iter().chain([(6, Class::Full)]) {
        for extra in [0, 0, 2] {
            let m = order + extra;
            let form = match order {
                6 => Form { order, class, pitches: vec![], slope: None },
                _ => Form::random(&mut random, order, class),
            };
            let j = match order {
                6 => random.matrix(6, m),
                _ => {
                    let pose = Setting::PLAIN.pose(&mut random);
                    matrix(&spanning(&mut random, &form.basis(), m, pose, &Setting::PLAIN))
                }
            };
            let metric = random_metric(&mut random, m);
            let h = random.within(-1.0, 1.0);
            let named = Metric::new("M", &metric).unwrap();
            let svd = hyperbolic_svd(&j, h, &scale(), Some(&named)).unwrap();
            check(&form, &j, &metric, h, &svd);
        }
    }
}

/// J = T S X^T M with T^T Q_h T = diag(signs) and X^T M X = 1, for every class, with or without a
/// zero among the signs.
#[test]
fn factors_multiply_to_the_jacobian() {
    cases(|form, j, metric, h, svd| {
        let k = form.order;
        let size = 1.0 + j.max_abs();
        let signs = &(&svd.left.transpose() * &form_matrix(h)) * &svd.left;
        assert_matrix("signs", &signs, &diagonal(svd.signature, k), 1e-9 * size * size);
        let ones = &(&svd.right.transpose() * metric) * &svd.right;
        assert_matrix("X", &ones, &Matrix::identity(k), 1e-11);
        let values: Vec<f64> =
            svd.values().iter().map(|s| if *s == 0.0 { 1.0 } else { *s }).collect();
        let product =
            &(&(&svd.left * &Matrix::diagonal(&values)) * &svd.right.transpose()) * metric;
        assert_matrix("J", &product, j, 1e-10 * size);
        let n0 = svd.squares.iter().filter(|g| **g == 0.0).count();
        assert_eq!(n0, svd.signature.zero);
        assert!(svd.squares.is_sorted_by(|a, b| a >= b));
    });
}

/// J+h = X S^-1 E T^T Q_h, and both exist together.
#[test]
fn the_inverse_follows_from_the_factors() {
    cases(|_, j, metric, h, svd| {
        let options = HyperbolicOptions {
            joint_metric: Some(Metric::new("M", metric).unwrap()),
            ..HyperbolicOptions::default()
        };
        let inverse = inverse::hyperbolic_with(j, h, &options).unwrap();
        let PolarKind::None { isotropic, reason } = svd.verdict else {
            let gains: Vec<f64> = svd.squares.iter().map(|g| g.signum() / g.abs().sqrt()).collect();
            let right = &svd.right * &Matrix::diagonal(&gains);
            let found = &(&right * &svd.left.transpose()) * &form_matrix(h);
            let size = inverse.matrix.max_abs();
            assert_matrix("J+h", &found, &inverse.matrix, 1e-9 * (1.0 + size * size));
            return;
        };
        assert_eq!((isotropic, Some(reason)), (svd.signature.zero, inverse.reason));
        assert!(!inverse.exists && svd.polar().is_none());
    });
}

/// J = W H, W^T Q_h W = M E, E^2 = 1 on the row space, E H = H E, M H symmetric and positive.
#[test]
fn polar_factors() {
    cases(|form, j, metric, h, svd| {
        let Some(polar) = svd.polar() else { return };
        let (w, stretch, signs) = (&polar.isometry, &polar.stretch, &polar.signs);
        let size = 1.0 + j.max_abs();
        assert_matrix("J", &(w * stretch), j, 1e-10 * size);
        let found = &(&w.transpose() * &form_matrix(h)) * w;
        assert_matrix("W", &found, &(metric * signs), 1e-9 * size * size);
        assert_matrix("E H", &(signs * stretch), &(stretch * signs), 1e-10 * size);
        let (squared, once) = (&(signs * signs) * signs, signs);
        assert_matrix("E^3", &squared, once, 1e-10);
        let symmetric = metric * stretch;
        assert_matrix("M H", &symmetric, &symmetric.transpose(), 1e-10 * size);
        if form.order == j.cols() {
            assert!(Metric::new("M H", &symmetric).is_ok());
            if svd.verdict == PolarKind::Positive {
                assert_matrix("E", signs, &Matrix::identity(j.cols()), 1e-10);
            }
        }
    });
}

/// Definite exactly for type A of order up to 3 and pitches outside the principal ones.
#[test]
fn the_canonical_decomposition_is_that_of_a_minimum() {
    let mut random = Random(173);
    for (order, class) in CLASSES {
        let form = Form::random(&mut random, order, class);
        let pose = Setting::PLAIN.pose(&mut random);
        let twists = spanning(&mut random, &form.basis(), order, pose, &Setting::PLAIN);
        let j = matrix(&twists);
        let kind = |h: f64| hyperbolic_svd(&j, h, &scale(), None).unwrap().verdict;
        let type_a = [Class::H, Class::IA, Class::IIA, Class::IA1, Class::IA2].contains(&class);
        for (h, definite) in [(-5.0, PolarKind::Positive), (5.0, PolarKind::Negative)] {
            assert_eq!(kind(h) == definite, type_a && order <= 3, "{form:?}");
        }
        if form.pitches.len() > 1 && order <= 3 && type_a {
            let between = 0.5 * (form.pitches[0] + form.pitches[1]);
            assert_eq!(kind(between), PolarKind::Signed, "{form:?}");
        }
    }
}

/// Frames change T alone; in millimetres the squares are a thousand times as large.
#[test]
fn frames_and_units() {
    let mut random = Random(174);
    for m in 1..=6 {
        let j = random.matrix(6, m);
        let h = random.within(-1.0, 1.0);
        let here = hyperbolic_svd(&j, h, &scale(), None).unwrap();
        let there = hyperbolic_svd(&(&adjoint_matrix(random.pose()) * &j), h, &scale(), None);
        assert_close("frame", &there.unwrap().squares, &here.squares, 1e-12);
        let unit = Matrix::diagonal(&[1e3, 1e3, 1e3, 1.0, 1.0, 1.0]);
        let options = ScrewOptions::with_length(1e3);
        let small = hyperbolic_svd(&(&unit * &j), 1e3 * h, &options, None).unwrap();
        let scaled: Vec<f64> = here.squares.iter().map(|g| g * 1e3).collect();
        assert_close("unit", &small.squares, &scaled, 1e-9);
        assert_eq!(here.signature, small.signature);
    }
}

/// dg_i / dh = -|w(J x_i)|^2, by central differences.
#[test]
fn squares_fall_with_the_pitch() {
    let mut random = Random(175);
    for m in 1..=6 {
        let j = random.matrix(6, m);
        let h = random.within(-1.0, 1.0);
        let at = |h: f64| hyperbolic_svd(&j, h, &scale(), None).unwrap();
        let (before, here, after) = (at(h - 1e-5), at(h), at(h + 1e-5));
        let images = &j * &here.right;
        for i in 0..m {
            let slope = (after.squares[i] - before.squares[i]) / 2e-5;
            let w: f64 = images.column(i)[3..].iter().map(|x| x * x).sum();
            assert!((slope + w).abs() < 1e-7, "{slope} and {w}");
            assert!(slope <= 0.0);
        }
    }
}

/// In the metric of angular velocities the squares are h_i - h; another metric moves them, and no
/// sign.
#[test]
fn principal_pitches_are_the_squares_in_the_metric_of_angular_velocities() {
    let mut random = Random(176);
    for class in [Class::IA1, Class::IA2, Class::IIA] {
        let form = Form::random(&mut random, 3, class);
        let pose = Setting::PLAIN.pose(&mut random);
        let twists = spanning(&mut random, &form.basis(), 3, pose, &Setting::PLAIN);
        let j = matrix(&twists);
        let angular = Matrix::from_fn(3, 3, |a, b| twists[a].angular.dot(twists[b].angular));
        let metric = Metric::new("M", &angular).unwrap();
        let system = ScrewSystem::of(&twists, &scale()).unwrap();
        let mut pitches: Vec<f64> =
            (0..3).map(|i| form.pitches[i.min(form.pitches.len() - 1)]).collect();
        pitches.sort_by(|a, b| b.total_cmp(a));
        for h in [-3.0, 0.05, 0.3] {
            let svd = hyperbolic_svd(&j, h, &scale(), Some(&metric)).unwrap();
            let expected: Vec<f64> = pitches.iter().map(|p| p - h).collect();
            assert_close("squares", &svd.squares, &expected, 1e-9);
            let plain = hyperbolic_svd(&j, h, &scale(), None).unwrap();
            assert_eq!(plain.signature, system.signature(h));
            assert_eq!(plain.signature, svd.signature);
        }
    }
}

/// J+h exists iff J M^-1 J^T Q_h is diagonalisable: otherwise zero has Jordan blocks of size two, as
/// many as isotropic directions, and of no larger size.
#[test]
fn without_a_decomposition_zero_has_jordan_blocks() {
    cases(|form, j, _, h, svd| {
        // Well conditioned, since ranks of products are decided.
        let basis = matrix(&ScrewSystem::of_columns(j, &scale()).unwrap().basis());
        let metric: Vec<f64> = (0..form.order).map(|i| 1.0 / (1.0 + 0.1 * i as f64)).collect();
        let compliance = &(&basis * &Matrix::diagonal(&metric)) * &basis.transpose();
        let operator = &compliance * &form_matrix(h);
        let rank = |a: &Matrix| Svd::of(a).rank(1e-9).rank;
        let square = &operator * &operator;
        assert_eq!(rank(&operator), form.order);
        assert_eq!(rank(&square), form.order - svd.signature.zero, "{form:?}");
        assert_eq!(rank(&(&square * &operator)), form.order - svd.signature.zero, "{form:?}");
    });
}

/// A joint more: old squares and new ones interlace.
#[test]
fn squares_interlace() {
    let mut random = Random(177);
    let j = random.matrix(6, 6);
    let squares =
        |m| hyperbolic_svd(&j.columns_between(0, m), 0.2, &scale(), None).unwrap().squares;
    for m in 1..6 {
        let (few, many) = (squares(m), squares(m + 1));
        for i in 0..m {
            assert!(many[i] >= few[i] - 1e-14 && few[i] >= many[i + 1] - 1e-14);
        }
    }
}

/// At a principal pitch a value goes to zero as the root of the distance.
#[test]
fn values_vanish_as_a_root() {
    let screw = |h: f64, e: Vec3| Twist { linear: e * h, angular: e };
    let j = matrix(&[screw(0.4, Vec3::X), screw(-0.1, Vec3::Y)]);
    for d in [1e-2, 1e-4, 1e-6] {
        let svd = hyperbolic_svd(&j, 0.4 - d, &scale(), None).unwrap();
        assert!((svd.values()[0] - d.sqrt()).abs() < 1e-9 * d.sqrt().recip());
    }
    let svd = hyperbolic_svd(&j, 0.4, &scale(), None).unwrap();
    assert_eq!((svd.squares[0], svd.signature.zero), (0.0, 1));
    assert!(matches!(
        svd.verdict,
        PolarKind::None { isotropic: 1, reason: NoInverse::PrincipalPitch { .. } }
    ));
    assert_close("isotropic", svd.left.column(0), j.column(0), 1e-15);
}

/// With the Klein form on both sides, A* A = Q_0^-1 A^T Q_0 A has the simple negative eigenvalues -1
/// and -4: a symmetric B with B^2 = A* A would have a real eigenvalue of square -1.
#[test]
fn a_map_of_twists_without_polar_decomposition() {
    // Columns: the screws of pitch 1 and -1 along each axis; orthonormal in the Klein form.
    let screws = Matrix::from_fn(6, 6, |i, j| {
        let (axis, sign) = (j / 2, if j % 2 == 0 { 1.0 } else { -1.0 });
        if i == axis { sign } else { f64::from(u8::from(i == axis + 3)) }
    });
    let signs = Matrix::diagonal(&[1.0, -1.0, 1.0, -1.0, 1.0, -1.0]);
    let form = &(&screws.transpose() * &form_matrix(0.0)) * &screws;
    assert_matrix("form", &form, &signs, 0.0);
    let mut a = Matrix::identity(6);
    (a[(0, 0)], a[(1, 1)], a[(1, 0)], a[(0, 1)]) = (0.0, 0.0, 1.0, 2.0);
    let square = &(&(&signs * &a.transpose()) * &signs) * &a;
    let expected = Matrix::diagonal(&[-1.0, -4.0, 1.0, 1.0, 1.0, 1.0]);
    assert_matrix("A* A", &square, &expected, 0.0);
}

/// numpy's unsymmetric eigensolver: xtask/vectors/pitch_form_vectors.py.
#[test]
fn values_and_factors_of_numpy() {
    let cases: serde_json::Value =
        serde_json::from_str(include_str!("../../vectors/pitch_forms/pitch_forms.json")).unwrap();
    let cases = cases["joints"].as_array().unwrap();
    assert_eq!(cases.len(), 17);
    for case in cases {
        let j = reference_matrix(&case["j"]);
        let metric = Metric::new("M", &reference_matrix(&case["metric"])).unwrap();
        let h = case["h"].as_f64().unwrap();
        let svd = hyperbolic_svd(&j, h, &scale(), Some(&metric)).unwrap();
        let squares: Vec<f64> =
            case["squares"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
        assert_close("squares", &svd.squares, &squares, 1e-9);
        let polar = svd.polar().unwrap();
        assert_matrix("W", &polar.isometry, &reference_matrix(&case["isometry"]), 1e-8);
        assert_matrix("H", &polar.stretch, &reference_matrix(&case["stretch"]), 1e-8);
        assert_matrix("E", &polar.signs, &reference_matrix(&case["signs"]), 1e-8);
    }
}

#[test]
fn input_without_an_answer_is_refused() {
    let j = Matrix::from_fn(6, 2, |i, j| (i + j) as f64);
    for h in [f64::NAN, f64::INFINITY] {
        assert!(matches!(hyperbolic_svd(&j, h, &scale(), None), Err(Error::NotFinite { .. })));
    }
    let metric = Metric::diagonal("M", &[1.0]).unwrap();
    assert!(hyperbolic_svd(&j, 0.0, &scale(), Some(&metric)).is_err());
    assert!(hyperbolic_svd(&Matrix::zeros(5, 2), 0.0, &scale(), None).is_err());
    let zero = hyperbolic_svd(&Matrix::zeros(6, 2), 0.0, &scale(), None).unwrap();
    assert!(zero.squares.is_empty());
    assert_eq!(gram(&j, 0.0).unwrap().rows(), 2);
}
