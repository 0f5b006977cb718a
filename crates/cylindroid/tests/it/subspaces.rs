//! QR, spaces of columns and their complements.

use cylindroid::Matrix;
use cylindroid::linalg::{ColumnSpace, Metric, Qr, Svd, Threshold};

use crate::support::{Random, assert_close, assert_matrix};

const SHAPES: [(usize, usize); 9] =
    [(1, 1), (3, 5), (5, 3), (6, 6), (6, 14), (24, 18), (18, 24), (2, 9), (9, 1)];

fn orthonormal(random: &mut Random, rows: usize, cols: usize) -> Matrix {
    ColumnSpace::of(&random.matrix(rows, cols), Threshold::Relative(1e-12)).basis()
}

#[track_caller]
fn assert_orthonormal(what: &str, a: &Matrix, tolerance: f64) {
    assert_matrix(what, &(&a.transpose() * a), &Matrix::identity(a.cols()), tolerance);
}

#[test]
fn qr_rebuilds_the_matrix() {
    let mut random = Random(61);
    for (m, n) in SHAPES {
        for rank in 1..=m.min(n) {
            let a = random.integer_product(m, n, rank);
            for qr in [Qr::pivoted(a.clone()), Qr::plain(a.clone())] {
                let r = qr.r();
                let mut rebuilt = Matrix::zeros(m, n);
                for j in 0..n {
                    let column = rebuilt.column_mut(qr.order()[j]);
                    column[..r.rows()].copy_from_slice(r.column(j));
                    qr.apply(column);
                    // and back
                    let mut again = column.to_vec();
                    qr.apply_transposed(&mut again);
                    again.truncate(r.rows());
                    let size = 1e-14 * (1.0 + a.frobenius_norm());
                    assert_close("Q^T Q R", &again, r.column(j), size);
                }
                assert_matrix("Q R", &rebuilt, &a, 1e-14 * (1.0 + a.frobenius_norm()));
            }
            let r = Qr::pivoted(a).r();
            let diagonal: Vec<f64> = (0..r.rows()).map(|i| r[(i, i)].abs()).collect();
            assert!(diagonal.windows(2).all(|w| w[0] >= w[1] * (1.0 - 1e-12)), "{diagonal:?}");
        }
    }
}

#[test]
fn column_space_and_complement_are_orthonormal_and_complete() {
    let mut random = Random(62);
    for (m, n) in SHAPES {
        for rank in 1..=m.min(n) {
            let a = &random.matrix(m, rank) * &random.matrix(rank, n);
            let space = ColumnSpace::of(&a, Threshold::Relative(1e-10));
            assert_eq!(space.rank(), rank);
            let (basis, complement) = (space.basis(), space.complement());
            assert_eq!((basis.cols(), complement.cols()), (rank, m - rank));
            assert_orthonormal("all", &Matrix::hstack(m, &[&basis, &complement]), 1e-13);
            let outside = &complement.transpose() * &a;
            assert!(outside.max_abs() <= 1e-13 * (1.0 + a.frobenius_norm()), "{outside:?}");
            let values: Vec<f64> = Svd::of(&a).values().collect();
            assert_close("values", space.values(), &values, 1e-13 * (1.0 + values[0]));
        }
    }
}

/// Known singular values, among them some between rounding and the threshold, and matrices whose
/// pivots or bidiagonal forms have zeros in the wrong place.
#[test]
fn column_space_of_known_values() {
    let mut random = Random(66);
    for round in 0..300 {
        let (m, n) = SHAPES[round % SHAPES.len()];
        let k = m.min(n);
        let mut values: Vec<f64> = (0..k)
            .map(|_| {
                10.0_f64.powf(random.within(-14.0, 0.0)) * f64::from(random.within(0.0, 1.0) < 0.8)
            })
            .collect();
        values.sort_by(|a, b| b.total_cmp(a));
        let (u, v) = (orthonormal(&mut random, m, k), orthonormal(&mut random, n, k));
        let a = &(&u * &Matrix::diagonal(&values)) * &v.transpose();
        let threshold = 1e-7;
        if values.iter().any(|s| (s / threshold).log10().abs() < 0.05) {
            continue;
        }
        let space = ColumnSpace::of(&a, Threshold::Absolute(threshold));
        assert_close("values", space.values(), &values, 1e-14);
        let kept = values.iter().filter(|s| **s > threshold).count();
        assert_eq!(space.rank(), kept);
        let outside = &space.complement().transpose() * &a;
        let dropped = values.get(kept).copied().unwrap_or(0.0);
        assert!(outside.frobenius_norm() <= 5.0 * dropped + 1e-14, "{dropped} {outside:?}");
    }
    for rows in [
        vec![vec![0.0, 1.0], vec![0.0, 0.0]],
        vec![vec![1.0, 1.0, 0.0], vec![0.0, 0.0, 1.0], vec![0.0, 0.0, 1.0]],
        vec![vec![0.0, 0.0, 0.0], vec![0.0, 1.0, 1.0], vec![0.0, 1.0, 1.0]],
        vec![vec![1.0, 1e-30], vec![0.0, 1e-20]],
    ] {
        let a = Matrix::from_rows(&rows).unwrap();
        let space = ColumnSpace::of(&a, Threshold::Relative(1e-9));
        let values: Vec<f64> = Svd::of(&a).values().collect();
        assert_close("values", space.values(), &values, 1e-15);
        assert_eq!(space.rank(), Svd::of(&a).rank(1e-9).rank);
    }
}

#[test]
fn column_space_of_nothing() {
    for (m, n) in [(0, 0), (0, 3), (4, 0)] {
        let space = ColumnSpace::of(&Matrix::zeros(m, n), Threshold::Relative(1e-10));
        assert_eq!((space.rank(), space.basis().cols()), (0, 0));
        assert_orthonormal("complement", &space.complement(), 0.0);
        assert_eq!(space.complement().cols(), m);
    }
    let space = ColumnSpace::of(&Matrix::zeros(3, 2), Threshold::Relative(1e-10));
    assert_eq!((space.rank(), space.complement().cols()), (0, 3));
    let mut a = Matrix::identity(3);
    a[(1, 2)] = f64::NAN;
    assert_eq!(ColumnSpace::of(&a, Threshold::Absolute(1e-9)).rank(), 0);
}

/// A block that holds rounding only has rank 0 at an absolute threshold, whatever its own size.
#[test]
fn column_space_thresholds() {
    let noise = Matrix::diagonal(&[1e-16, 3e-17]);
    assert_eq!(ColumnSpace::of(&noise, Threshold::Absolute(1e-9)).rank(), 0);
    assert_eq!(ColumnSpace::of(&noise, Threshold::Relative(1e-9)).rank(), 2);
    let cut = ColumnSpace::of(&Matrix::diagonal(&[1.0, 1e-7, 1e-10]), Threshold::Absolute(1e-9));
    assert_eq!((cut.rank(), cut.cut().kept, cut.cut().dropped), (2, 1e-7, 1e-10));
    // A gap of 1000, but the kept value stands within 1000 of the threshold.
    assert!(cut.cut().is_ambiguous());
    let sure = ColumnSpace::of(&Matrix::diagonal(&[1.0, 1e-16]), Threshold::Absolute(1e-9));
    assert!(!sure.cut().is_ambiguous());
    let near = ColumnSpace::of(&Matrix::diagonal(&[5e-10]), Threshold::Absolute(1e-9));
    assert!(near.rank() == 0 && near.cut().is_ambiguous());
    assert!(!ColumnSpace::of(&noise, Threshold::Absolute(1e-9)).cut().is_ambiguous());
    for scale in [1e-300, 1e300] {
        let a = Matrix::diagonal(&[scale, 0.5 * scale, 0.0]);
        assert_eq!(ColumnSpace::of(&a, Threshold::Relative(1e-9)).rank(), 2);
    }
}

/// Measured by the dual of the dual nothing changes; `x^T M^-1 x` for a known M.
#[test]
fn dual_metric() {
    let mut random = Random(65);
    for n in 0..7 {
        let a = random.matrix(n, n);
        let aat = &a * &a.transpose();
        let m = Matrix::from_fn(n, n, |i, j| aat[(i, j)] + if i == j { 0.3 } else { 0.0 });
        let metric = Metric::new("M", &m).unwrap();
        let dual = metric.dual();
        let norm = |metric: &Metric, x: &[f64]| {
            let mut y = x.to_vec();
            metric.whiten(&mut y);
            y.iter().map(|a| a * a).sum::<f64>()
        };
        let x = random.vector(n);
        let mx = m.mul_vec(&x);
        // (M x)^T M^-1 (M x) = x^T M x
        let size = 1.0 + norm(&metric, &x);
        assert!((norm(&dual, &mx) - norm(&metric, &x)).abs() < 1e-12 * size);
        assert!((norm(&dual.dual(), &x) - norm(&metric, &x)).abs() < 1e-12 * size);
    }
}
