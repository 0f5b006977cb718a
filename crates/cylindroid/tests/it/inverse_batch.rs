//! Inverses of many Jacobians are those of each, to the bit.

use cylindroid::inverse::{InverseBatch, Method};
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
