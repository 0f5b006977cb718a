use cylindroid::inverse::{self, Method, Weights};
use cylindroid::linalg::{Metric, RowSpace, Svd};
use cylindroid::{Error, Matrix};

use crate::support::{Random, assert_close, assert_matrix};

fn shapes() -> [(usize, usize); 6] {
    [(6, 7), (6, 6), (6, 5), (6, 3), (3, 7), (6, 1)]
}

/// The four laws of Penrose, for every shape and rank.
#[test]
fn penrose() {
    let mut random = Random(21);
    for (m, n) in shapes() {
        for rank in 1..=m.min(n) {
            for _ in 0..50 {
                let j = &random.matrix(m, rank) * &random.matrix(rank, n);
                let inverse = inverse::truncated(&j, 1e-10).unwrap();
                assert_eq!(inverse.rank, rank);
                let p = &inverse.matrix;
                let size = j.frobenius_norm() * p.frobenius_norm();
                let tolerance = 1e-13 * size * size;
                assert_matrix("J P J", &(&(&j * p) * &j), &j, tolerance);
                assert_matrix("P J P", &(&(p * &j) * p), p, tolerance * p.frobenius_norm());
                let (jp, pj) = (&j * p, p * &j);
                assert_matrix("(J P)^T", &jp.transpose(), &jp, tolerance);
                assert_matrix("(P J)^T", &pj.transpose(), &pj, tolerance);
            }
        }
    }
}

/// The threshold is relative: diag(1e-7, 1e-8) has condition number 10 and is not zero.
#[test]
fn truncated_is_relative_to_the_largest_value() {
    let j = Matrix::diagonal(&[1e-7, 1e-8]);
    let inverse = inverse::truncated(&j, 1e-6).unwrap();
    assert_matrix("pinv", &inverse.matrix, &Matrix::diagonal(&[1e7, 1e8]), 1e-7);
    assert_eq!((inverse.rank, inverse.gap), (2, f64::INFINITY));
}

/// Values of numpy 2.4.6:
///
/// ```python
/// J = numpy.array([[1.0, 2.0, 0.0], [0.0, 1.0, 0.1]])
/// print(numpy.linalg.pinv(J, 1e-15).tolist(), numpy.linalg.pinv(J, 0.5).tolist())
/// ```
#[test]
fn truncated_equals_numpy() {
    let j = Matrix::from_rows(&[[1.0, 2.0, 0.0], [0.0, 1.0, 0.1]]).unwrap();
    let all = inverse::truncated(&j, 1e-15).unwrap();
    let one = inverse::truncated(&j, 0.5).unwrap();
    assert_eq!((all.rank, one.rank), (2, 1));
    let numpy = |rows: &[[f64; 2]; 3]| Matrix::from_rows(rows).unwrap();
    let expected = numpy(&[
        [0.961_904_761_904_760_6, -1.904_761_904_761_902_4],
        [0.019_047_619_047_619_063, 0.952_380_952_380_951_9],
        [-0.190_476_190_476_190_2, 0.476_190_476_190_475_6],
    ]);
    assert_matrix("pinv(J, 1e-15)", &all.matrix, &expected, 1e-14);
    let expected = numpy(&[
        [0.146_333_818_069_384_11, 0.060_720_764_415_506_29],
        [0.353_388_400_554_274_5, 0.146_637_421_891_461_67],
        [0.006_072_076_441_550_627, 0.002_519_589_306_044_908],
    ]);
    assert_matrix("pinv(J, 0.5)", &one.matrix, &expected, 1e-15);
    // At the threshold itself the value is cut.
    let at = one.dropped[0].singular_value / one.singular_values[0];
    assert_eq!(inverse::truncated(&j, at).unwrap().rank, 1);
    assert_eq!(inverse::truncated(&j, at * (1.0 - 1e-12)).unwrap().rank, 2);
}

#[test]
fn dropped_directions_are_named() {
    let j = Matrix::diagonal(&[2.0, 1.0, 1e-6]);
    let inverse = inverse::truncated(&j, 1e-3).unwrap();
    assert_eq!(inverse.dropped.len(), 1);
    assert_close("direction", &inverse.dropped[0].direction, &[0.0, 0.0, 1.0], 0.0);
    assert_eq!(inverse.dropped[0].filter_factor, 0.0);
    assert!((inverse.gap - 1e6).abs() < 1e-3);
    assert!((inverse.threshold - 2e-3).abs() < 1e-15);
}

#[test]
fn damped_is_the_formula() {
    let mut random = Random(22);
    for (m, n) in shapes() {
        let (j, l) = (random.matrix(m, n), 0.3);
        let inverse = inverse::damped(&j, l).unwrap();
        // (J^T J + l^2) P = J^T
        let jt = j.transpose();
        let left =
            Matrix::from_fn(n, n, |a, b| (&jt * &j)[(a, b)] + if a == b { l * l } else { 0.0 });
        assert_matrix("normal equations", &(&left * &inverse.matrix), &jt, 1e-13);
        for x in 0..20 {
            let v = random.vector(m);
            let (rates, size) = (norm(&inverse.matrix.mul_vec(&v)), norm(&v));
            assert!(rates <= size / (2.0 * l) * (1.0 + 1e-12), "{x}");
        }
    }
}

/// As the smallest value goes to zero, the gain of each method stays finite and (truncation
/// apart) continuous; at zero the report names the lost direction.
#[test]
fn every_method_is_bounded_through_a_singularity() {
    for method in Method::ALL {
        let gain = |s: f64| {
            let j = Matrix::diagonal(&[1.0, 0.7, s]);
            let inverse = method.inverse(&j).unwrap();
            assert!(inverse.matrix.is_finite() && inverse.exists);
            (inverse.matrix[(2, 2)], inverse)
        };
        // max_joint_velocity / M with M = sum |v| |J_j| / s: at most max_joint_velocity; others: their own bounds
        let bound = 1.01 / cylindroid::tolerance::TRUNCATION;
        let mut last = gain(1.0).0;
        let mut s = 1.0;
        while s > 1e-18 {
            let (g, _) = gain(s);
            assert!(g.abs() <= bound, "{}: gain {g} at {s}", method.name());
            // Below 1e-14 the value is zero up to rounding and its direction is noise.
            let jumps =
                matches!(method, Method::Truncated { .. } | Method::SelectivelyDamped { .. });
            if !jumps && s > 1e-14 {
                assert!((g - last).abs() < 3.0, "{}: from {last} to {g} at {s}", method.name());
            }
            last = g;
            s *= 0.99;
        }
        let (_, at_zero) = gain(0.0);
        assert_eq!(at_zero.rank, 2, "{}", method.name());
        assert_close(
            "lost",
            &at_zero.dropped[0].direction.iter().map(|x| x.abs()).collect::<Vec<_>>(),
            &[0.0, 0.0, 1.0],
            1e-15,
        );
        // Regular matrices are inverted exactly by the methods that say so.
        if matches!(
            method,
            Method::Truncated { .. }
                | Method::VariableDamping { .. }
                | Method::NumericalFiltering { .. }
        ) {
            assert!((gain(0.5).0 - 2.0).abs() < 1e-15, "{}", method.name());
        }
    }
}

#[test]
fn variable_damping_is_the_formula() {
    let j = Matrix::diagonal(&[1.0, 0.5, 0.01]);
    let (onset, l) = (0.05, 0.1);
    let share = 1.0 - (0.01_f64 / 0.05).powi(2);
    let variable = Method::VariableDamping { onset, damping: l }.inverse(&j).unwrap();
    let expected = |s: f64, d2: f64| s / (s * s + d2);
    for (i, s) in [1.0, 0.5, 0.01].into_iter().enumerate() {
        assert!((variable.matrix[(i, i)] - expected(s, share * l * l)).abs() < 1e-14);
    }
    // Both sides of the onset agree.
    let near = |s: f64| {
        Method::VariableDamping { onset, damping: l }
            .inverse(&Matrix::diagonal(&[1.0, s]))
            .unwrap()
            .matrix[(1, 1)]
    };
    assert!((near(0.05 * (1.0 - 1e-9)) - near(0.05 * (1.0 + 1e-9))).abs() < 1e-5);
}

#[test]
fn numerical_filtering_is_the_formula() {
    let (onset, l, b) = (0.05, 0.1, 0.2);
    let share = 1.0 - (0.01_f64 / 0.05).powi(2);
    let inverse = Method::NumericalFiltering { onset, damping: l, filter: b }
        .inverse(&Matrix::diagonal(&[1.0, 0.5, 0.01]))
        .unwrap();
    // The weakest direction alone has the filter.
    for (i, s, b) in [(0, 1.0, 0.0), (1, 0.5, 0.0), (2, 0.01, b)] {
        let expected = s / (s * s + share * (l * l + b * b));
        assert!((inverse.matrix[(i, i)] - expected).abs() < 1e-14, "{i}");
    }
}

#[test]
fn filtered_is_the_rational_function() {
    let (nu, floor) = (10.0, 0.01);
    for s in [1e-3, 0.1, 1.0, 30.0] {
        let g = Method::SingularValueFiltering { shape: nu, floor }
            .inverse(&Matrix::diagonal(&[s]))
            .unwrap()
            .matrix[(0, 0)];
        let f = (s.powi(3) + nu * s * s + 2.0 * s + 2.0 * floor) / (s * s + nu * s + 2.0);
        assert!((g * f - 1.0).abs() < 1e-13);
    }
}

#[test]
fn selectively_damped_never_exceeds_the_rate() {
    let mut random = Random(23);
    let max_joint_velocity = 0.6;
    for round in 0..500 {
        let rank = 1 + round % 6;
        let j = &random.matrix(6, rank) * &random.matrix(rank, 7);
        let task: Vec<f64> = random.vector(6).iter().map(|x| x * 10.0).collect();
        let inverse = inverse::selectively_damped(&j, &task, max_joint_velocity).unwrap();
        let rates = inverse.matrix.mul_vec(&task);
        assert!(rates.iter().all(|r| r.abs() <= max_joint_velocity * (1.0 + 1e-12)), "{rates:?}");
    }
    // A small motion in a regular pose is not damped at all.
    let j = Matrix::diagonal(&[1.0, 0.9, 1.1]);
    let task = [1e-3, 2e-3, -1e-3];
    let exact = inverse::truncated(&j, 1e-9).unwrap().matrix.mul_vec(&task);
    let got =
        inverse::selectively_damped(&j, &task, max_joint_velocity).unwrap().matrix.mul_vec(&task);
    assert_close("rates", &got, &exact, 1e-16);
}

/// Singular values 4 and 3 whose joint directions lie between the two joints: the columns of J have
/// the size 5 / sqrt(2), so that M_i = sqrt(2) (5 / sqrt(2)) / s_i, 5/4 and 5/3, and a large motion
/// along one direction ends at 4/5 or 3/5 of the largest joint velocity; along both, the first joint
/// ends at the whole of it and the second at the difference over the sum, 1/7.
#[test]
fn selectively_damped_slows_each_direction_by_what_its_joints_move() {
    let (half, most) = (0.5_f64.sqrt(), 0.6);
    let j = Matrix::from_rows(&[[4.0 * half, 4.0 * half], [3.0 * half, -3.0 * half]]).unwrap();
    for (task, shares) in [
        ([100.0, 0.0], [0.8, 0.8]),
        ([0.0, 100.0], [0.6, -0.6]),
        ([0.0, -100.0], [-0.6, 0.6]),
        ([100.0, 100.0], [1.0, 1.0 / 7.0]),
    ] {
        let inverse = inverse::selectively_damped(&j, &task, most).unwrap();
        let expected = shares.map(|share| share * most);
        assert_close("rates", &inverse.matrix.mul_vec(&task), &expected, 1e-14);
    }
}

/// At equal singular values the directions are any two: a large motion is clamped along those that
/// are found, a small one is not and has the same rates on both sides.
#[test]
fn selectively_damped_may_jump_at_equal_singular_values() {
    let rates = |turned: bool, size: f64| {
        // 1 up to 1e-9: the directions are the axes, or the diagonals.
        let e = 1e-9;
        let j = if turned {
            Matrix::from_rows(&[[1.0, e], [e, 1.0]]).unwrap()
        } else {
            Matrix::diagonal(&[1.0 + e, 1.0 - e])
        };
        let task = [size, 0.5 * size];
        inverse::selectively_damped(&j, &task, 1.0).unwrap().matrix.mul_vec(&task)
    };
    assert_close("small", &rates(true, 0.1), &rates(false, 0.1), 1e-9);
    let (a, b) = (rates(true, 10.0), rates(false, 10.0));
    assert!((a[0] - b[0]).abs().max((a[1] - b[1]).abs()) > 0.1, "{a:?} {b:?}");
    assert!(a.iter().chain(&b).all(|r| r.abs() <= 1.0 + 1e-12), "{a:?} {b:?}");
}

/// Rank, gap, threshold and what was dropped, for each method at one matrix.
#[test]
fn report_of_each_method() {
    let values = [1.0, 0.4, 0.03, 0.001];
    let j = Matrix::diagonal(&values);
    // The directions that are kept, and the threshold where it has a closed form.
    let share = (1.0 - (0.001_f64 / 0.05).powi(2)).sqrt();
    for (method, kept, threshold) in [
        (Method::Truncated { eps: 0.01 }, 3, 0.01),
        (Method::Damped { damping: 0.1 }, 2, 0.1),
        (Method::VariableDamping { onset: 0.05, damping: 0.02 }, 3, 0.02 * share),
        (
            Method::NumericalFiltering { onset: 0.05, damping: 0.002, filter: 0.02 },
            3,
            0.002_f64.hypot(0.02) * share,
        ),
        // s^3 + nu s^2 + 2 s = 2 s_0 at s = 0.02
        (
            Method::SingularValueFiltering {
                shape: 10.0,
                floor: 0.5 * (8e-6 + 10.0 * 4e-4 + 2.0 * 0.02),
            },
            3,
            0.02,
        ),
    ] {
        let (report, name) = (method.inverse(&j).unwrap(), method.name());
        assert_eq!(report.rank, kept, "{name}");
        assert!((report.threshold / threshold - 1.0).abs() < 1e-12, "{name}: {report:?}");
        let gap = values[kept - 1] / values[kept];
        assert!((report.gap / gap - 1.0).abs() < 1e-12, "{name}: {}", report.gap);
        for (i, dropped) in report.dropped.iter().enumerate() {
            let s = values[kept + i];
            let realised = report.matrix[(kept + i, kept + i)] * s;
            assert!((dropped.singular_value / s - 1.0).abs() < 1e-12, "{name}");
            assert!((dropped.filter_factor - realised).abs() < 1e-15 && realised < 0.5, "{name}");
            assert_eq!(dropped.direction[kept + i].abs(), 1.0, "{name}");
        }
        assert_eq!(report.dropped.len(), values.len() - kept, "{name}");
        // Both sides of the threshold; numerical filtering and variable damping move with s.
        if matches!(method, Method::Damped { .. } | Method::SingularValueFiltering { .. }) {
            for (s, rank) in [(threshold * (1.0 - 1e-9), 1), (threshold * (1.0 + 1e-9), 2)] {
                let near = method.inverse(&Matrix::diagonal(&[1.0, s])).unwrap();
                assert_eq!(near.rank, rank, "{name} at {s}");
            }
        }
    }
}

/// Selectively damped least squares drop what needs large rates, here the largest direction: the
/// report and the projector go by the directions, not by their number.
#[test]
fn report_where_a_large_direction_is_dropped() {
    let j = Matrix::diagonal(&[1.0, 0.5, 0.25]);
    let task = [10.0, 0.01, 0.01];
    let report = inverse::selectively_damped(&j, &task, 1.0).unwrap();
    assert_eq!((report.rank, report.dropped.len()), (2, 1));
    assert_eq!(report.dropped[0].singular_value, 1.0);
    assert_eq!(report.dropped[0].direction, [1.0, 0.0, 0.0]);
    assert!((report.dropped[0].filter_factor - 0.1).abs() < 1e-15, "{report:?}");
    assert_eq!(report.gap, 0.25);
    assert_eq!(report.threshold, Svd::of(&j).machine_rank().threshold);
    for (m, n) in [(3, 3), (4, 3), (3, 5)] {
        let j = Matrix::from_fn(m, n, |a, b| if a == b { [1.0, 0.5, 0.25][a] } else { 0.0 });
        let svd = Svd::of(&j);
        let space = RowSpace::from_kept(&svd, &[false, true, true]);
        assert_eq!(space.rank(), 2);
        let mut x = vec![1.0; n];
        space.project_out(&mut x);
        assert_eq!(x[..3], [1.0, 0.0, 0.0]);
        let basis = space.null_space_basis();
        assert_eq!(basis.cols(), n - 2);
        for c in 0..basis.cols() {
            assert_eq!(basis.column(c)[1..3], [0.0, 0.0], "{basis:?}");
        }
    }
}

/// W_q decides between rates that do the same, W_x between errors that cannot all vanish.
#[test]
fn weighted_minimises_in_the_metrics() {
    let mut random = Random(24);
    for (m, n) in shapes() {
        let rank = m.min(n).min(4);
        let j = &random.matrix(m, rank) * &random.matrix(rank, n);
        let metric = |random: &mut Random, k: usize| {
            let a = random.matrix(k, k);
            let aat = &a * &a.transpose();
            Matrix::from_fn(k, k, |i, l| aat[(i, l)] + if i == l { 0.5 } else { 0.0 })
        };
        let (wq, wx) = (metric(&mut random, n), metric(&mut random, m));
        let weights = Weights {
            joint: Some(Metric::new("joint", &wq).unwrap()),
            task: Some(Metric::new("task", &wx).unwrap()),
        };
        let method = Method::Truncated { eps: 1e-10 };
        let p = inverse::weighted(&j, method, &weights).unwrap().matrix;
        // The weighted Penrose laws: W_x J P and W_q P J are symmetric, J P J = J, P J P = P.
        let tolerance = 1e-11 * (1.0 + p.frobenius_norm()).powi(2);
        let (a, b) = (&wx * &(&j * &p), &wq * &(&p * &j));
        assert_matrix("W_x J P", &a.transpose(), &a, tolerance);
        assert_matrix("W_q P J", &b.transpose(), &b, tolerance);
        assert_matrix("J P J", &(&(&j * &p) * &j), &j, tolerance);
        assert_matrix("P J P", &(&(&p * &j) * &p), &p, tolerance);
    }
}

#[test]
fn bad_metrics_are_refused() {
    let reason = |m: &Matrix| Metric::new("joint weights", m).unwrap_err().to_string();
    assert!(reason(&Matrix::from_fn(2, 3, |_, _| 1.0)).contains("square"));
    assert!(reason(&Matrix::diagonal(&[1.0, -1.0])).contains("positive definite"));
    assert!(reason(&Matrix::from_rows(&[[1.0, 0.5], [0.0, 1.0]]).unwrap()).contains("symmetric"));
    assert!(Metric::diagonal("w", &[1.0, 0.0]).is_err());
    let weights = Weights { joint: Some(Metric::diagonal("w", &[1.0]).unwrap()), task: None };
    let error = inverse::weighted(&Matrix::identity(3), Method::default(), &weights).unwrap_err();
    assert!(matches!(error, Error::Dimension { .. }));
}

#[test]
fn bad_input_is_refused() {
    let mut j = Matrix::identity(3);
    j[(1, 2)] = f64::NAN;
    let error = inverse::truncated(&j, 1e-3).unwrap_err();
    assert_eq!(error.to_string(), "matrix entry (1, 2) is not finite: NaN");
    for (method, option) in [
        (Method::Truncated { eps: 1.0 }, "eps"),
        (Method::Truncated { eps: -1e-3 }, "eps"),
        (Method::Damped { damping: 0.0 }, "damping"),
        (Method::Damped { damping: f64::INFINITY }, "damping"),
        (Method::SelectivelyDamped { max_joint_velocity: f64::NAN }, "max_joint_velocity"),
        (Method::SingularValueFiltering { shape: 10.0, floor: 0.0 }, "floor"),
    ] {
        let error = method.inverse(&Matrix::identity(2)).unwrap_err().to_string();
        assert!(error.starts_with(option), "{error}");
    }
    assert!(Method::named("dampd").unwrap_err().to_string().contains("nearest: damped"));
}

/// However large or small the numbers: no square overflows or vanishes on the way.
#[test]
fn extreme_scales() {
    for size in [1e-310, 1e-300, 1e-200, 1e-160, 1.0, 1e160, 1e200, 1e300] {
        let j = Matrix::diagonal(&[size, 0.7 * size, 0.5 * size]);
        for method in Method::ALL {
            let inverse = method.inverse(&j).unwrap();
            let name = format!("{} at {size:e}", method.name());
            assert!(inverse.matrix.is_finite(), "{name}: {:?}", inverse.matrix);
            let share = inverse.matrix[(1, 1)] * j[(1, 1)];
            assert!((0.0..=1.0 + 1e-15).contains(&share), "{name}: {share} realised");
            // Damping far below the singular values does nothing.
            let exact = size > 1e150 && !matches!(method, Method::SelectivelyDamped { .. });
            assert!(!exact || share > 1.0 - 1e-15, "{name}: {share} realised");
        }
        // The damping in the unit of the values: half of the smallest direction is left.
        let half = inverse::damped(&j, 0.5 * size).unwrap();
        let share = half.matrix[(2, 2)] * j[(2, 2)];
        assert!((share - 0.5).abs() < 1e-12 || size < 1e-300, "{size:e}: {share}");
    }
}

#[test]
fn no_rows_or_columns() {
    for (m, n) in [(0, 3), (3, 0), (0, 0)] {
        for method in Method::ALL {
            let inverse = method.inverse(&Matrix::zeros(m, n)).unwrap();
            assert_eq!((inverse.matrix.rows(), inverse.matrix.cols(), inverse.rank), (n, m, 0));
        }
    }
}

fn norm(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}
