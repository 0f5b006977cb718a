//! Corners of boxes cut by a plane.

use super::*;
use crate::linalg::Svd;
use crate::linalg::test_support::{Random, assert_close};

fn symmetric(bounds: &[f64]) -> Vec<Interval> {
    bounds.iter().map(|b| Interval::symmetric(*b)).collect()
}

/// Against all corners, found by trying all sets of active bounds.
#[test]
fn the_best_corner_is_found() {
    let mut random = Random(92);
    for (n, m) in [(2, 2), (3, 2), (5, 2), (5, 3), (6, 6), (7, 3), (8, 2), (4, 1)] {
        for round in 0..40 {
            let a = if round % 4 == 3 {
                // Rows that repeat: several bounds meet in one corner.
                let base = random.matrix(m, m);
                Matrix::from_fn(n, m, |i, j| base[(i % m, j)])
            } else {
                random.matrix(n, m)
            };
            // The same both ways, different, and some zero.
            let bounds: Vec<Interval> = (0..n)
                .map(|i| {
                    let upper = random.within(0.3, 2.0);
                    let lower = match round % 3 {
                        0 => -upper,
                        2 if i % 2 == 0 => 0.0,
                        _ => -random.within(0.1, 2.0),
                    };
                    Interval { lower, upper }
                })
                .collect();
            let program = BoundedLinearProgram::new(&a, &bounds);
            let (c, second) = (random.vector(m), random.vector(m));
            let z = program.maximize(Objective { first: &c, second: &second });
            let az = a.mul_vec(&z);
            let room = az.iter().zip(&bounds).map(|(x, b)| (x - b.lower).min(b.upper - x));
            assert!(room.clone().all(|r| r > -1e-9), "{az:?}");
            // A corner: as many bounds met as there are unknowns.
            let met = room.filter(|r| *r < 1e-9).count();
            assert!(met >= m, "{n} {m}: {met}");
            // Weak duality: c = A^T y, and y times its bounds equal to the value proves it best.
            let value = dot(&c, &z);
            let mut upper = f64::INFINITY;
            corners(n, m, &mut |rows| {
                let square = Matrix::from_fn(m, m, |i, j| a[(rows[j], i)]);
                if let Some(y) = solve(&square, &c) {
                    let end = |y: f64, b: Interval| y * if y > 0.0 { b.upper } else { b.lower };
                    let bound: f64 = y.iter().zip(rows).map(|(y, r)| end(*y, bounds[*r])).sum();
                    upper = upper.min(bound);
                }
            });
            assert!((value - upper).abs() < 1e-8 * (1.0 + upper), "{n} {m}: {value} {upper}");
        }
    }
}

/// Calls `visit` with every choice of m of n rows.
fn corners(n: usize, m: usize, visit: &mut impl FnMut(&[usize])) {
    fn extend(n: usize, m: usize, rows: &mut Vec<usize>, visit: &mut impl FnMut(&[usize])) {
        if rows.len() == m {
            return visit(rows);
        }
        for i in rows.last().map_or(0, |l| l + 1)..n {
            rows.push(i);
            extend(n, m, rows, visit);
            rows.pop();
        }
    }
    extend(n, m, &mut Vec::new(), visit);
}

fn solve(a: &Matrix, b: &[f64]) -> Option<Vec<f64>> {
    let svd = Svd::of(a);
    let parts = || (0..svd.len()).map(|k| (svd.v(k), dot(svd.u(k), b) / svd.value(k)));
    let entry = |i: usize| parts().map(|(v, x)| v[i] * x).sum();
    (svd.rank(1e-9).rank == a.rows()).then(|| (0..a.cols()).map(entry).collect())
}

/// Ties go to the corner that the second direction prefers.
#[test]
fn ties_are_broken() {
    for n in [2, 3] {
        let a = Matrix::from_fn(n, 2, |i, j| f64::from(u8::from(i % 2 == j)));
        let program = BoundedLinearProgram::new(&a, &symmetric(&vec![1.0; n]));
        assert_close(
            "up",
            &program.maximize(Objective { first: &[1.0, 0.0], second: &[0.3, 0.5] }),
            &[1.0, 1.0],
            1e-15,
        );
        assert_close(
            "down",
            &program.maximize(Objective { first: &[1.0, 0.0], second: &[0.3, -0.5] }),
            &[1.0, -1.0],
            1e-15,
        );
    }
}
