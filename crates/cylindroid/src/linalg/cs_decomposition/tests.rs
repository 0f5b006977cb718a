//! The CS decomposition of random spaces and of known angles.

use super::*;
use crate::linalg::test_support::{Random, assert_close, assert_matrix};
use crate::linalg::{ColumnSpace, Threshold};

fn orthonormal(random: &mut Random, rows: usize, cols: usize) -> Matrix {
    ColumnSpace::of(&random.matrix(rows, cols), Threshold::Relative(1e-12)).basis()
}

#[track_caller]
fn assert_orthonormal(what: &str, a: &Matrix, tolerance: f64) {
    assert_matrix(what, &(&a.transpose() * a), &Matrix::identity(a.cols()), tolerance);
}

fn check_cs(basis: &Matrix, split: usize) -> CsDecomposition {
    let cs = CsDecomposition::of(basis, split);
    let (rows, k) = (basis.rows(), basis.cols());
    let times = |a: &Matrix, scale: &[f64]| a * &Matrix::diagonal(scale);
    let stack = Matrix::vstack(k, &[&times(&cs.x, &cs.cosines), &times(&cs.y, &cs.sines)]);
    assert_matrix("[X C; Y S]", &stack, &(basis * &cs.z), 2e-14);
    assert_orthonormal("Z", &cs.z, 1e-13);
    assert!(cs.sines.windows(2).all(|w| w[0] >= w[1] - 1e-15), "{:?}", cs.sines);
    assert!(cs.cosines.windows(2).all(|w| w[0] <= w[1] + 1e-15), "{:?}", cs.cosines);
    // Directions that are there at all are orthonormal.
    let there = |a: &Matrix, size: &[f64]| {
        let columns: Vec<usize> = (0..k).filter(|&j| size[j] > 1e-9).collect();
        Matrix::from_fn(a.rows(), columns.len(), |i, j| a[(i, columns[j])])
    };
    assert_orthonormal("X", &there(&cs.x, &cs.cosines), 1e-13);
    assert_orthonormal("Y", &there(&cs.y, &cs.sines), 1e-13);
    assert_eq!((cs.x.rows(), cs.y.rows()), (split, rows - split));
    cs
}

#[test]
fn cs_of_random_spaces() {
    let mut random = Random(63);
    for (a, b) in [(1, 1), (2, 3), (6, 6), (14, 6), (3, 6), (6, 0), (0, 6), (5, 1)] {
        for k in 0..=a + b {
            let basis = orthonormal(&mut random, a + b, k);
            let cs = check_cs(&basis, a);
            // More directions than rows of a block leave zeros.
            let infinite = (0..k).filter(|&j| cs.kind(j, 1e-9) == PairKind::Infinite).count();
            let zero = (0..k).filter(|&j| cs.kind(j, 1e-9) == PairKind::Zero).count();
            assert_eq!((infinite, zero), (k.saturating_sub(a), k.saturating_sub(b)), "{a} {b} {k}");
        }
    }
}

/// Known angles, clustered, and at both ends down to the smallest: sine and cosine are both right.
#[test]
fn cs_finds_the_angles_it_was_built_from() {
    let mut random = Random(64);
    let small: [f64; 6] = [0.0, 1e-300, 1e-16, 1e-12, 1e-9, 1e-5];
    let quarter = std::f64::consts::FRAC_PI_4;
    let half = std::f64::consts::FRAC_PI_2;
    for round in 0..200 {
        let mut pairs: Vec<(f64, f64)> = (0..5)
            .map(|i| match (round + i) % 5 {
                0 => (small[(round / 5) % 6].sin(), small[(round / 5) % 6].cos()),
                1 => (small[(round / 7) % 6].cos(), small[(round / 7) % 6].sin()),
                2 => (quarter.cos(), quarter.sin()),
                3 => ((quarter + 1e-9).cos(), (quarter + 1e-9).sin()),
                _ => {
                    let t = random.within(0.0, half);
                    (t.cos(), t.sin())
                }
            })
            .collect();
        pairs.sort_by(|p, q| q.1.total_cmp(&p.1).then(p.0.total_cmp(&q.0)));
        let (a, b) = (7, 6);
        let (x, y) = (orthonormal(&mut random, a, 5), orthonormal(&mut random, b, 5));
        let z = orthonormal(&mut random, 5, 5);
        let c: Vec<f64> = pairs.iter().map(|p| p.0).collect();
        let s: Vec<f64> = pairs.iter().map(|p| p.1).collect();
        let stack =
            Matrix::vstack(5, &[&(&x * &Matrix::diagonal(&c)), &(&y * &Matrix::diagonal(&s))]);
        let cs = check_cs(&(&stack * &z.transpose()), a);
        assert_close("cosines", &cs.cosines, &c, 2e-15);
        assert_close("sines", &cs.sines, &s, 2e-15);
    }
}
