//! Eigenscrews of stiffness and inertia matrices.

use cylindroid::inverse::hyperbolic_svd;
use cylindroid::linalg::Metric;
use cylindroid::screws::{EigenscrewKind, Eigenscrews, ScrewOptions, eigenscrews};
use cylindroid::spatial::{Pose, Vec3, Wrench};
use cylindroid::{Error, Matrix};

use super::laws::{adjoint_matrix, form_matrix};
use super::vectors::reference_matrix;
use crate::support::{Random, assert_close, assert_matrix};

fn springs(wrenches: &[Wrench]) -> Matrix {
    let mut k = Matrix::zeros(6, 6);
    for w in wrenches.iter().map(|w| w.to_array()) {
        for i in 0..6 {
            for j in 0..6 {
                k[(i, j)] += w[i] * w[j];
            }
        }
    }
    k
}

fn random_stiffness(random: &mut Random, rank: usize) -> Matrix {
    let factor = random.matrix(6, rank);
    &factor * &factor.transpose()
}

fn values(found: &Eigenscrews) -> Vec<f64> {
    let mut values: Vec<f64> = found.screws.iter().map(|e| e.eigenvalue).collect();
    values.sort_by(|a, b| b.total_cmp(a));
    values
}

/// The stiffness seen from another frame: A^-T K A^-1.
fn moved(k: &Matrix, pose: Pose) -> Matrix {
    let inverse = adjoint_matrix(pose.inverse());
    &(&inverse.transpose() * k) * &inverse
}

/// K s = l D_h s, s_i^T D_h s_j = sign(l_i) [i = j] with D_h = 2 Q_h, K = sum |l| W W^T.
#[test]
fn eigenscrews_make_the_matrix() {
    let mut random = Random(181);
    for rank in 1..=6 {
        for h in [-2.0, 0.0, 0.3] {
            let k = random_stiffness(&mut random, rank);
            let found = eigenscrews(&k, h).unwrap();
            assert_eq!(found.screws.len(), rank);
            let mut sum = Matrix::zeros(6, 6);
            for (i, a) in found.screws.iter().enumerate() {
                let image = k.mul_vec(&a.twist.to_array());
                let expected = (a.wrench * a.eigenvalue).to_array();
                assert_close("K s", &image, &expected, 1e-9 * a.eigenvalue.abs().max(1.0));
                for (j, b) in found.screws.iter().enumerate() {
                    let sign = if i == j { a.eigenvalue.signum() } else { 0.0 };
                    assert!((2.0 * a.twist.pitch_form(b.twist, h) - sign).abs() < 1e-7);
                }
                let one = springs(&[a.wrench * a.eigenvalue.abs().sqrt()]);
                sum = Matrix::from_fn(6, 6, |r, c| sum[(r, c)] + one[(r, c)]);
            }
            assert_matrix("K", &sum, &k, 1e-9);
            let expected = match rank {
                6 => EigenscrewKind::Definite,
                rank => EigenscrewKind::Semidefinite { rank },
            };
            assert_eq!(found.kind, expected);
        }
    }
}

/// Three of each sign for a definite matrix, rising with h; their sum is 2 h tr K_ff + 2 tr K_fm.
#[test]
fn three_positive_and_three_negative_that_rise_with_the_pitch() {
    let mut random = Random(182);
    for _ in 0..10 {
        let k = random_stiffness(&mut random, 6);
        let trace = |a: usize, b: usize| (0..3).map(|i| k[(a + i, b + i)]).sum::<f64>();
        let mut before: Option<Vec<f64>> = None;
        for h in [-20.0, -1.0, -0.2, 0.0, 0.3, 2.0, 50.0] {
            let found = eigenscrews(&k, h).unwrap();
            let all = values(&found);
            assert!(all[2] > 0.0 && all[3] < 0.0);
            let sum: f64 = all.iter().sum();
            assert!(
                (sum - 2.0 * h * trace(0, 0) - 2.0 * trace(0, 3)).abs() < 1e-9 * sum.abs().max(1.0)
            );
            if let Some(before) = &before {
                assert!(all.iter().zip(before).all(|(a, b)| a > b), "{all:?} after {before:?}");
            }
            before = Some(all);
        }
    }
}

#[test]
fn frames_change_nothing() {
    let mut random = Random(183);
    for rank in [6, 4] {
        let k = random_stiffness(&mut random, rank);
        let here = eigenscrews(&k, 0.4).unwrap();
        let pose = Pose { translation: random.vec3(30.0), ..random.pose() };
        let there = eigenscrews(&moved(&k, pose), 0.4).unwrap();
        assert_close("values", &values(&there), &values(&here), 1e-8);
        let (a, b) = (here.spring_pitch.unwrap(), there.spring_pitch.unwrap());
        assert!((a - b).abs() < 1e-10);
        assert_eq!(there.kind, here.kind);
    }
}

/// Seen from ten thousand lengths away, where the rotational stiffness is 1e8 times larger and loses
/// eight digits.
#[test]
fn a_far_origin_changes_nothing() {
    let mut random = Random(187);
    let k = random_stiffness(&mut random, 6);
    let here = eigenscrews(&k, 0.4).unwrap();
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        let pose = Pose { translation: axis * 1e4, ..Pose::IDENTITY };
        let there = eigenscrews(&moved(&k, pose), 0.4).unwrap();
        assert_eq!(there.kind, here.kind);
        assert_close("values", &values(&there), &values(&here), 1e-6);
    }
}

/// Ball's principal screws of inertia: on the principal axes through the centre of mass, of the
/// pitches h +- sqrt(h^2 + r^2), with the eigenvalues m p.
#[test]
fn principal_screws_of_inertia() {
    let mut random = Random(184);
    let (mass, radii) = (2.5, [0.3, 0.2, 0.1]);
    let axes = [Vec3::X, Vec3::Y, Vec3::Z];
    let squares = radii.map(|r: f64| mass * r * r);
    let inertia = Matrix::diagonal(&[mass, mass, mass, squares[0], squares[1], squares[2]]);
    let pose = random.pose();
    for h in [-0.5, 0.0, 0.7] {
        let found = eigenscrews(&moved(&inertia, pose), h).unwrap();
        let mut expected: Vec<(f64, Vec3)> = vec![];
        for (r, axis) in radii.iter().zip(axes) {
            for sign in [1.0, -1.0] {
                expected.push((h + sign * h.hypot(*r), pose.rotation * axis));
            }
        }
        assert_eq!(found.screws.len(), 6);
        for e in &found.screws {
            let screw = e.screw().unwrap();
            let near = |(p, _): &&(f64, Vec3)| (screw.pitch - p).abs() < 1e-9;
            let (pitch, axis) = expected.iter().find(near).expect("a pitch");
            assert!((e.eigenvalue - mass * pitch).abs() < 1e-9);
            assert!(screw.axis.direction.cross(*axis).norm() < 1e-7);
            assert!((screw.axis.nearest(pose.translation) - pose.translation).norm() < 1e-7);
        }
    }
}

/// A rotation of coordinates in which a symmetric matrix of trace zero has a zero diagonal.
fn zero_diagonal(n: &Matrix) -> Matrix {
    let size = n.rows();
    let (mut n, mut u) = (n.clone(), Matrix::identity(size));
    for i in 0..size - 1 {
        // The diagonal from i on sums to zero: an entry of the other sign exists.
        let other = (i + 1..size)
            .min_by(|&a, &b| {
                let with = |j: usize| n[(j, j)] * n[(i, i)].signum();
                with(a).total_cmp(&with(b))
            })
            .unwrap();
        let (a, b, d) = (n[(i, i)], n[(i, other)], n[(other, other)]);
        if a == 0.0 {
            continue;
        }
        // a + 2 b t + d t^2 = 0 has a root, since a d <= 0.
        let t = if d == 0.0 { -a / (2.0 * b) } else { (-b + (b * b - a * d).sqrt()) / d };
        let c = 1.0 / (1.0 + t * t).sqrt();
        let mut turn = Matrix::identity(size);
        turn[(i, i)] = c;
        turn[(other, i)] = c * t;
        turn[(i, other)] = -c * t;
        turn[(other, other)] = c;
        n = &(&turn.transpose() * &n) * &turn;
        u = &u * &turn;
    }
    u
}

/// A definite stiffness is a sum of springs of one pitch for exactly one pitch.
#[test]
fn springs_of_one_pitch() {
    let mut random = Random(185);
    for rank in [2, 4, 6] {
        let factor = random.matrix(6, rank);
        let k = &factor * &factor.transpose();
        let p = eigenscrews(&k, 0.0).unwrap().spring_pitch.unwrap();
        let form = |a: &[f64], b: &[f64]| {
            let w = |x: &[f64]| Wrench::from_array(x.try_into().unwrap());
            w(a).pitch_form(w(b), -p)
        };
        let reduced = Matrix::from_fn(rank, rank, |i, j| form(factor.column(i), factor.column(j)));
        let turned = &factor * &zero_diagonal(&reduced);
        let all: Vec<Wrench> =
            (0..rank).map(|i| Wrench::from_array(turned.column(i).try_into().unwrap())).collect();
        for w in &all {
            assert!((w.force.dot(w.moment) / w.force.dot(w.force) - p).abs() < 1e-9);
        }
        assert_matrix("K", &springs(&all), &k, 1e-12);
    }
    // Springs along lines: pitch zero, in every frame.
    let line = |r: &mut Random| {
        let (point, force) = (r.vec3(1.0), r.vec3(1.0));
        Wrench { force, moment: point.cross(force) }
    };
    let lines: Vec<Wrench> = (0..7).map(|_| line(&mut random)).collect();
    let pitch = eigenscrews(&springs(&lines), 0.2).unwrap().spring_pitch.unwrap();
    assert!(pitch.abs() < 1e-14);
}

/// The eigenscrews of a serial arm's stiffness are the hyperbolic singular vectors of its Jacobian
/// in the metric of joint stiffness, and the eigenvalues half the inverses of the squares.
#[test]
fn stiffness_of_an_arm() {
    let mut random = Random(186);
    let j = random.matrix(6, 6);
    let stiffness: Vec<f64> = (0..6).map(|_| random.within(0.5, 4.0)).collect();
    let metric = Metric::diagonal("K", &stiffness).unwrap();
    let svd = hyperbolic_svd(&j, 0.25, &ScrewOptions::default(), Some(&metric)).unwrap();
    // J^-T K_q J^-1 by the inverse that the library has for every h.
    let inverse = cylindroid::inverse::hyperbolic(&j, 0.25).unwrap().matrix;
    let k = &(&inverse.transpose() * &Matrix::diagonal(&stiffness)) * &inverse;
    let symmetric = Matrix::from_fn(6, 6, |i, l| 0.5 * (k[(i, l)] + k[(l, i)]));
    let found = eigenscrews(&symmetric, 0.25).unwrap();
    let mut expected: Vec<f64> = svd.squares.iter().map(|g| 0.5 / g).collect();
    expected.sort_by(|a, b| b.total_cmp(a));
    let size = expected.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    assert_close("values", &values(&found), &expected, 1e-9 * size);
}

/// f = v on x, y, z and m = -w, w, w: the eigenvalues on x are +-i at h = 0. A spring along a line is
/// reciprocal to itself.
#[test]
fn matrices_without_six_eigenscrews() {
    let indefinite = eigenscrews(&Matrix::diagonal(&[1.0, 1.0, 1.0, -1.0, 1.0, 1.0]), 0.0).unwrap();
    assert!(indefinite.screws.is_empty());
    assert!(matches!(indefinite.kind, EigenscrewKind::Indefinite { smallest } if smallest < -0.1));
    let line = springs(&[Wrench { force: Vec3::X, moment: Vec3::ZERO }]);
    let found = eigenscrews(&line, 0.0).unwrap();
    assert_eq!(found.kind, EigenscrewKind::Defective { rank: 1, missing: 1 });
    assert_eq!((found.screws.len(), found.kind.name()), (0, "defective"));
    let found = eigenscrews(&line, 0.5).unwrap();
    assert_eq!(found.kind, EigenscrewKind::Semidefinite { rank: 1 });
    assert!((found.screws[0].eigenvalue - 1.0).abs() < 1e-12);
    let torsion = eigenscrews(&Matrix::diagonal(&[0.0, 0.0, 0.0, 1.0, 1.0, 1.0]), 0.0).unwrap();
    assert_eq!(torsion.kind, EigenscrewKind::Defective { rank: 3, missing: 3 });
    assert_eq!(torsion.spring_pitch, None);
    let none = eigenscrews(&Matrix::zeros(6, 6), 0.0).unwrap();
    assert_eq!(none.kind, EigenscrewKind::Semidefinite { rank: 0 });
}

/// The complex pair that the verdict speaks of: (D_0^-1 K)^2 = -1 on a plane.
#[test]
fn an_indefinite_matrix_may_have_complex_values() {
    let k = Matrix::diagonal(&[1.0, 1.0, 1.0, -1.0, 1.0, 1.0]);
    let operator = &(&form_matrix(0.0) * &Matrix::diagonal(&[2.0; 6])) * &k;
    let twice = &operator * &operator;
    assert_close("v", twice.column(0), &[-1.0, 0.0, 0.0, 0.0, 0.0, 0.0], 0.0);
    assert_close("w", twice.column(3), &[0.0, 0.0, 0.0, -1.0, 0.0, 0.0], 0.0);
}

#[test]
fn values_of_numpy() {
    let cases: serde_json::Value =
        serde_json::from_str(include_str!("../../vectors/pitch_forms/pitch_forms.json")).unwrap();
    for case in cases["stiffness"].as_array().unwrap() {
        let k = reference_matrix(&case["stiffness"]);
        let found = eigenscrews(&k, case["h"].as_f64().unwrap()).unwrap();
        let expected: Vec<f64> =
            case["values"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
        assert_close("values", &values(&found), &expected, 1e-8);
    }
}

#[test]
fn stiffness_without_an_answer_is_refused() {
    let mut k = Matrix::identity(6);
    assert!(matches!(eigenscrews(&k, f64::NAN), Err(Error::NotFinite { .. })));
    k[(0, 1)] = 0.5;
    assert!(eigenscrews(&k, 0.0).unwrap_err().to_string().contains("symmetric"));
    assert!(eigenscrews(&Matrix::identity(5), 0.0).is_err());
}
