use cylindroid::Matrix;
use cylindroid::linalg::{RowSpace, Svd};

use crate::support::{Random, assert_close, assert_matrix};

fn check(a: &Matrix) {
    let svd = Svd::of(a);
    check_decomposition(&svd, a);
}

fn check_decomposition(svd: &Svd, a: &Matrix) {
    assert!(svd.residual(a) < 1e-14, "residual {} of {a:?}", svd.residual(a));
    let values: Vec<f64> = svd.values().collect();
    assert!(values.windows(2).all(|w| w[0] >= w[1]) && values.iter().all(|s| *s >= 0.0));
    let norm = a.frobenius_norm();
    let squares: f64 = values.iter().map(|s| (s / norm).powi(2)).sum();
    assert!(norm == 0.0 || (squares - 1.0).abs() <= 1e-14, "{values:?} against {norm}");
    let rank = svd.machine_rank().rank;
    for i in 0..rank {
        for j in 0..rank {
            let expected = f64::from(u8::from(i == j));
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
            assert!((dot(svd.u(i), svd.u(j)) - expected).abs() < 1e-13, "U of {a:?}");
            assert!((dot(svd.v(i), svd.v(j)) - expected).abs() < 1e-13, "V of {a:?}");
        }
    }
}

#[test]
fn random_matrices_of_every_shape() {
    let mut random = Random(11);
    for m in 1..=8 {
        for n in 1..=9 {
            for _ in 0..50 {
                check(&random.matrix(m, n));
            }
        }
    }
    for _ in 0..20 {
        check(&random.matrix(6, 36));
    }
}

/// A well-known crate gives wrong values for these: exact rank deficiency on a grid.
#[test]
fn rank_deficient_matrices() {
    check(&Matrix::from_fn(3, 5, |_, _| 1.0));
    let mut random = Random(12);
    for rank in 1..=4 {
        for (m, n) in [(3, 5), (6, 7), (6, 3), (5, 5), (6, 6)] {
            for _ in 0..300 {
                let a = random.integer_product(m, n, rank);
                check(&a);
                let exact = integer_rank(&a);
                assert_eq!(Svd::of(&a).machine_rank().rank, exact, "{a:?}");
            }
        }
    }
}

/// Rank by Gaussian elimination in exact rational arithmetic (Bareiss), for small integers.
fn integer_rank(a: &Matrix) -> usize {
    let mut rows: Vec<Vec<i128>> =
        a.to_rows().iter().map(|r| r.iter().map(|x| *x as i128).collect()).collect();
    let (m, n) = (a.rows(), a.cols());
    let (mut rank, mut previous) = (0, 1);
    for col in 0..n {
        let Some(pivot) = (rank..m).find(|&r| rows[r][col] != 0) else { continue };
        rows.swap(rank, pivot);
        for r in rank + 1..m {
            for c in (0..n).rev() {
                if c != col {
                    rows[r][c] =
                        (rows[rank][col] * rows[r][c] - rows[r][col] * rows[rank][c]) / previous;
                }
            }
            rows[r][col] = 0;
        }
        previous = rows[rank][col];
        rank += 1;
        if rank == m {
            break;
        }
    }
    rank
}

/// What rounding leaves of columns that are lost has any lengths, also nearly equal ones.
#[test]
fn held_joints() {
    let columns = [
        [0.209_208_314_000_872_75, 0.183_185_825_266_891_17, 0.586_398_983_401_641_2],
        [-0.658_766_395_315_624_3, 0.752_347_550_273_714, 0.0],
        [-0.103_709_068_293_999_35, 0.096_640_650_347_387_5, 0.074_854_032_786_297_2],
        [-0.556_818_436_439_122, 0.044_891_370_665_425_42, -0.829_420_275_663_231_4],
    ];
    let mut a = Matrix::zeros(6, 7);
    for (j, halves) in [(1, &columns[..2]), (5, &columns[2..])] {
        a.column_mut(j).copy_from_slice(halves.as_flattened());
    }
    check(&a);
    let mut random = Random(16);
    for _ in 0..20_000 {
        let kept = [random.within(0.0, 7.0) as usize, random.within(0.0, 7.0) as usize];
        check(&Matrix::from_fn(6, 7, |_, j| {
            if kept.contains(&j) { random.within(-1.0, 1.0) } else { 0.0 }
        }));
    }
}

#[test]
fn extreme_scales() {
    let mut random = Random(13);
    for scale in [1e-310, 1e-300, 1e-160, 1e-9, 1e9, 1e160, 1e300] {
        let a = Matrix::from_fn(6, 7, |_, _| random.within(-1.0, 1.0) * scale);
        let svd = Svd::of(&a);
        assert!(svd.values().all(f64::is_finite));
        if scale > 1e-290 {
            check_decomposition(&svd, &a);
        }
    }
    // Columns of very different size: small singular values keep their relative accuracy.
    let a = Matrix::diagonal(&[1.0, 1e-70, 1e-140]);
    assert_close(
        "values",
        &Svd::of(&a).values().map(|s| s.log10()).collect::<Vec<_>>(),
        &[0.0, -70.0, -140.0],
        1e-12,
    );
}

/// The largest numbers: what no number holds is the largest one, and nothing is NaN.
#[test]
fn largest_numbers() {
    for (m, n) in [(1, 1), (2, 2), (6, 7), (7, 3)] {
        for size in [1e307, 1.5e308, f64::MAX] {
            let a = Matrix::from_fn(m, n, |i, j| if (i + 2 * j) % 3 == 0 { -size } else { size });
            let mut svd = Svd::of(&a);
            svd.decompose_warm(&a);
            assert!(svd.values().all(|s| s.is_finite()), "{m} x {n} of {size:e}");
            for i in 0..svd.machine_rank().rank {
                let norm = svd.u(i).iter().map(|x| x * x).sum::<f64>();
                assert!((norm - 1.0).abs() < 1e-13, "{m} x {n} of {size:e}: {norm}");
            }
            let least = size * f64::from(u8::from(svd.value(0) < f64::MAX));
            assert!(svd.value(0) >= least);
        }
        let diagonal = Matrix::diagonal(&[f64::MAX, 1e308]);
        assert_eq!(Svd::of(&diagonal).values().collect::<Vec<_>>(), [f64::MAX, 1e308]);
    }
}

#[test]
fn hilbert_matrix_to_relative_accuracy() {
    // Smallest singular value of the 8 x 8 Hilbert matrix, from 50-digit arithmetic.
    let hilbert = Matrix::from_fn(8, 8, |i, j| 1.0 / (i + j + 1) as f64);
    let svd = Svd::of(&hilbert);
    assert!((svd.value(7) / 1.111_538_966_372_442_4e-10 - 1.0).abs() < 1e-5);
    check(&hilbert);
}

#[test]
fn zero_empty_and_bad_matrices() {
    let svd = Svd::of(&Matrix::zeros(6, 7));
    assert_eq!(svd.machine_rank().rank, 0);
    assert_eq!(svd.machine_rank().gap, f64::INFINITY);
    assert!(Svd::of(&Matrix::zeros(6, 0)).is_empty());
    let mut a = Matrix::identity(3);
    a[(1, 2)] = f64::NAN;
    assert!(Svd::of(&a).values().all(f64::is_nan));
}

/// A turning Jacobian: the warm decomposition equals a cold one whatever the step, on both sides of
/// every number of terms, and is cheaper where steps are small.
#[test]
fn warm_starts_do_not_drift() {
    let mut random = Random(14);
    let shapes = [(6, 7), (6, 6), (6, 4), (3, 7), (5, 12)];
    for ((m, n), size) in shapes.iter().flat_map(|&s| [1e-1, 1e-2, 1e-3, 1e-5].map(|h| (s, h))) {
        let (a, b) = (random.matrix(m, n), random.matrix(m, n));
        let mut warm = Svd::workspace(m, n);
        let (mut cold_sweeps, mut warm_sweeps) = (0, 0);
        for step in 0..5000 {
            let t = f64::from(step) * size;
            let now = Matrix::from_fn(m, n, |i, j| a[(i, j)] * t.cos() + b[(i, j)] * t.sin());
            warm.decompose_warm(&now);
            let cold = Svd::of(&now);
            check_decomposition(&warm, &now);
            let (w, c): (Vec<f64>, Vec<f64>) = (warm.values().collect(), cold.values().collect());
            assert_close("values", &w, &c, 1e-13);
            cold_sweeps += cold.sweeps();
            warm_sweeps += warm.sweeps();
        }
        assert!(
            warm_sweeps < cold_sweeps || size > 1e-3,
            "{warm_sweeps} warm, {cold_sweeps} cold, {m} x {n}, steps of {size}"
        );
    }
}

#[test]
fn null_space_is_the_kernel() {
    let mut random = Random(15);
    for (m, n) in [(6, 7), (6, 10), (3, 7), (6, 6), (6, 4)] {
        for rank in 1..=m.min(n) {
            let a = random.integer_product(m, n, rank);
            let svd = Svd::of(&a);
            let space = RowSpace::exact(&svd);
            let basis = space.null_space_basis();
            assert_eq!(basis.cols(), n - space.rank());
            let image = &a * &basis;
            assert!(image.max_abs() <= 1e-13 * a.frobenius_norm(), "A N = {image:?}");
            assert_matrix(
                "N^T N",
                &(&basis.transpose() * &basis),
                &Matrix::identity(basis.cols()),
                1e-13,
            );
            let mut x = random.vector(n);
            space.project_out(&mut x);
            let ax = Matrix::from_fn(m, 1, |i, _| a.mul_vec(&x)[i]);
            assert!(ax.max_abs() <= 1e-12 * a.frobenius_norm());
            let along = basis.transpose().mul_vec(&x);
            assert_close("x in the basis", &basis.mul_vec(&along), &x, 1e-13);
        }
    }
}

/// Of a matrix other than the one decomposed, the residual is their relative difference.
#[test]
fn residual_of_another_matrix() {
    let mut random = Random(1611);
    let (a, change) = (random.matrix(6, 7), random.matrix(6, 7));
    let svd = Svd::of(&a);
    for size in [1e-6, 1e-3, 1.0] {
        let other = Matrix::from_fn(6, 7, |i, j| a[(i, j)] + size * change[(i, j)]);
        let expected = size * change.frobenius_norm() / other.frobenius_norm();
        assert!((svd.residual(&other) / expected - 1.0).abs() < 1e-7);
    }
    assert!(svd.residual(&a) < 1e-15 * 10.0);
}
