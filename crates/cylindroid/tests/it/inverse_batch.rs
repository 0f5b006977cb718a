//! Inverses of many Jacobians are those of each: to the bit, where nothing is truncated to rounding.

use cylindroid::inverse::{InverseBatch, Method};
use cylindroid::linalg::Svd;
use cylindroid::{Error, Matrix};
use rayon::ThreadPoolBuilder;

use crate::support::Random;

fn row_major(j: &Matrix) -> Vec<f64> {
    j.to_rows().concat()
}

/// Every method, shape and rank, zero among them.
#[test]
fn equal_single_inverses() {
    let mut random = Random(70);
    for (m, n) in [(6, 7), (6, 6), (6, 5), (3, 7), (1, 4), (2, 1)] {
        let all: Vec<Matrix> = (0..40)
            .map(|i| match i % (m.min(n) + 1) {
                0 => Matrix::zeros(m, n),
                rank => &random.matrix(m, rank) * &random.matrix(rank, n),
            })
            .collect();
        let stack: Vec<f64> = all.iter().flat_map(row_major).collect();
        for method in Method::ALL {
            let inverses = InverseBatch::new(method, m, n).unwrap().inverses(&stack).unwrap();
            assert_eq!(inverses.ranks.len(), all.len());
            for (i, j) in all.iter().enumerate() {
                let one = method.inverse(j).unwrap();
                let what = format!("{} of {m} x {n}, {i}", method.name());
                let k = m.min(n);
                if matches!(method, Method::Truncated { .. }) && one.rank == k {
                    continue; // batched: see truncated_inverses_agree_to_rounding
                }
                assert_eq!(
                    inverses.matrices[i * m * n..][..m * n],
                    row_major(&one.matrix),
                    "{what}"
                );
                assert_eq!(inverses.singular_values[i * k..][..k], one.singular_values, "{what}");
                let rank = inverses.ranks[i];
                assert_eq!((rank.rank, rank.gap), (one.rank, one.gap), "{what}");
                assert_eq!(rank.threshold, one.threshold, "{what}");
            }
        }
    }
}

/// Of full rank and of any other, of any size, with thresholds on both sides of the smallest
/// singular value and within rounding of it.
#[test]
fn truncated_inverses_agree_to_rounding() {
    let mut random = Random(72);
    for (m, n) in [(6, 7), (6, 6), (7, 6), (6, 5), (3, 7), (1, 4), (2, 1), (1, 1)] {
        let k = m.min(n);
        for eps in [0.0, 1e-9, 1e-3, 0.2] {
            let mut all: Vec<Matrix> = (0..60).map(|_| random.matrix(m, n)).collect();
            all.push(Matrix::zeros(m, n));
            for _ in 0..10 {
                all.push(&random.matrix(m, k - 1) * &random.matrix(k - 1, n));
            }
            for (power, exponent) in [(1, 150), (2, 59), (3, 300), (4, 61), (5, 90)] {
                for size in [10.0_f64.powi(exponent), 10.0_f64.powi(-exponent)] {
                    let j = &all[power];
                    all.push(Matrix::from_fn(m, n, |r, c| size * j[(r, c)]));
                }
            }
            // The smallest singular value at a multiple of the threshold.
            for ratio in [0.999, 1.0 - 1e-15, 1.0, 1.0 + 1e-15, 1.001, 2.0] {
                let svd = Svd::of(&random.matrix(m, n));
                let value = |i: usize| if i + 1 == k && i > 0 { ratio * eps } else { 1.0 };
                all.push(Matrix::from_fn(m, n, |r, c| {
                    (0..k).map(|i| svd.u(i)[r] * value(i) * svd.v(i)[c]).sum()
                }));
            }
            let stack: Vec<f64> = all.iter().flat_map(row_major).collect();
            let batch = InverseBatch::new(Method::Truncated { eps }, m, n).unwrap();
            let inverses = batch.inverses(&stack).unwrap();
            for (i, j) in all.iter().enumerate() {
                let one = Method::Truncated { eps }.inverse(j).unwrap();
                let what = format!("{m} x {n}, {i}, {eps}");
                let values = &inverses.singular_values[i * k..][..k];
                let rank = inverses.ranks[i];
                assert_eq!((rank.rank, rank.gap), (one.rank, one.gap), "{what}");
                assert!((rank.threshold - one.threshold).abs() <= 1e-14 * one.threshold, "{what}");
                for (x, y) in values.iter().zip(&one.singular_values) {
                    assert!((x - y).abs() <= 1e-14 * one.singular_values[0], "{what}: {x} and {y}");
                }
                let matrix = &inverses.matrices[i * m * n..][..m * n];
                let expected = row_major(&one.matrix);
                let size = expected.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
                let kept = one.rank.max(1);
                let condition = one.singular_values[0] / one.singular_values[kept - 1];
                for (x, y) in matrix.iter().zip(&expected) {
                    let near = (x - y).abs() <= 1e-14 * condition * size;
                    assert!(x == y || near, "{what}: {x:e} and {y:e}");
                }
                // Alone, the same to the bit.
                let alone = batch.inverses(&row_major(j)).unwrap();
                assert_eq!(alone.matrices, matrix, "{what}");
                assert_eq!(alone.singular_values, values, "{what}");
            }
        }
    }
}

#[test]
fn threads_change_nothing() {
    let mut random = Random(71);
    let count = 2 * InverseBatch::CHUNK + 7;
    let stack: Vec<f64> = (0..count).flat_map(|_| row_major(&random.matrix(6, 7))).collect();
    let batch = InverseBatch::new(Method::default(), 6, 7).unwrap();
    let with = |threads: usize| {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| batch.inverses(&stack).unwrap())
    };
    let one = with(1);
    assert_eq!(one.ranks.len(), count);
    assert!(one == with(2) && one == with(4));
    let last = &stack[(count - 1) * 42..];
    assert_eq!(one.matrices[(count - 1) * 42..], batch.inverses(last).unwrap().matrices);
}

#[test]
fn bad_input_is_refused() {
    let batch = InverseBatch::new(Method::default(), 2, 3).unwrap();
    assert!(batch.inverses(&[]).unwrap().matrices.is_empty());
    let short = batch.inverses(&[0.0; 7]).unwrap_err();
    assert!(matches!(short, Error::Dimension { expected: 12, got: 7, .. }), "{short}");
    let mut numbers = [1.0; 12];
    numbers[10] = f64::NAN;
    let message = batch.inverses(&numbers).unwrap_err().to_string();
    assert!(message.contains("entry (1, 1) of J[1]"), "{message}");
    assert!(InverseBatch::new(Method::Damped { damping: 0.0 }, 2, 3).is_err());
    assert!(InverseBatch::new(Method::default(), 0, 3).is_err());
}
