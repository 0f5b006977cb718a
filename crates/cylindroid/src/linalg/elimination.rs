//! Elimination of the leading columns of a matrix by Householder reflections, in place.
//!
//! Formula  A = [A_1 A_2], A_1 P = Q [R; 0], R of full row rank; A becomes [R; 0] (above the
//!          reflections) beside Q^T A_2
//! Shapes   A: m x n, A_1: m x p, R: r x p
//! Valid    where the rank of A_1 is clear; says so where it is not. No allocation
//! Checked  tests in this file

use super::matrix::Matrix;
use super::qr::{reflect, reflect_rest, square};

/// Largest remainder of a column that counts as zero, and smallest that counts as regular: what
/// lies between leaves the rank open.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RankGap {
    pub(crate) zero: f64,
    pub(crate) regular: f64,
}

impl RankGap {
    /// For columns of this size.
    pub(crate) fn times(self, size: f64) -> Self {
        Self { zero: self.zero * size, regular: self.regular * size }
    }
}

/// The reflections that eliminate the leading columns of a matrix, which holds them.
#[derive(Debug, Clone)]
pub(crate) struct Elimination {
    factors: Vec<f64>,
    order: Vec<usize>,
    sizes: Vec<f64>,
    rank: usize,
    columns: usize,
}

impl Elimination {
    /// Memory for so many leading columns.
    pub(crate) fn workspace(columns: usize) -> Self {
        Self {
            factors: vec![0.0; columns],
            order: vec![0; columns],
            sizes: vec![0.0; columns],
            rank: 0,
            columns: 0,
        }
    }

    /// Eliminates the first `columns` columns of `a`, the largest remainder first; false where a
    /// remainder lies in the gap.
    pub(crate) fn eliminate(&mut self, a: &mut Matrix, columns: usize, gap: RankGap) -> bool {
        self.eliminate_beside(a, columns, a.cols() - columns, gap)
    }

    /// The same for an A_2 of the next `beside` columns: those after them stay as they are.
    pub(crate) fn eliminate_beside(
        &mut self,
        a: &mut Matrix,
        columns: usize,
        beside: usize,
        gap: RankGap,
    ) -> bool {
        (self.rank, self.columns) = (0, columns);
        for j in 0..columns {
            (self.order[j], self.sizes[j]) = (j, square(a.column(j)));
        }
        let (zero, regular) = (gap.zero * gap.zero, gap.regular * gap.regular);
        for j in 0..columns {
            let largest =
                (j..columns).fold(j, |b, l| if self.sizes[l] > self.sizes[b] { l } else { b });
            let size = self.sizes[largest];
            if j == a.rows() || size <= zero {
                break;
            }
            if !(size >= regular) {
                return false;
            }
            a.swap_columns(j, largest);
            self.sizes.swap(j, largest);
            self.order.swap(j, largest);
            self.factors[j] = reflect_rest(a, columns + beside, j, size.sqrt(), |l, rest| {
                if l < columns {
                    self.sizes[l] = square(rest);
                }
            });
            self.rank += 1;
        }
        true
    }

    /// r, the rank of A_1.
    pub(crate) fn rank(&self) -> usize {
        self.rank
    }

    /// `order()[j]` is the column of A_1 in place `j` of R.
    pub(crate) fn order(&self) -> &[usize] {
        &self.order[..self.columns]
    }

    /// `x <- Q x`, m entries; `a` as eliminated.
    pub(crate) fn apply(&self, a: &Matrix, x: &mut [f64]) {
        for j in (0..self.rank).rev() {
            reflect(a, j, self.factors[j], x);
        }
    }

    /// `x <- R_1^-1 x` for the regular leading block R_1 of R.
    pub(crate) fn solve(&self, a: &Matrix, x: &mut [f64]) {
        for i in (0..self.rank).rev() {
            x[i] /= a[(i, i)];
            let (above, rest) = x.split_at_mut(i);
            above.iter_mut().zip(a.column(i)).for_each(|(y, r)| *y -= r * rest[0]);
        }
    }

    /// The least x with `A_1^T x = b` for a b that permits one: m entries.
    pub(crate) fn least_solution(&self, a: &Matrix, b: &[f64], x: &mut [f64]) {
        x.fill(0.0);
        for i in 0..self.rank {
            let sum: f64 = a.column(i)[..i].iter().zip(&*x).map(|(r, x)| r * x).sum();
            x[i] = (b[self.order[i]] - sum) / a[(i, i)];
        }
        self.apply(a, x);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::{Svd, norm};
    use crate::scalar::uniform;

    const GAP: RankGap = RankGap { zero: 1e-10, regular: 1e-5 };

    /// A random m x n matrix of rank r.
    fn random(m: usize, n: usize, r: usize, state: &mut u64) -> Matrix {
        let mut next = || 2.0 * uniform(state) - 1.0;
        let left = Matrix::from_fn(m, r, |_, _| next());
        let right = Matrix::from_fn(r, n, |_, _| next());
        &left * &right
    }

    /// Ranks are found, `Q^T A_2` is that of the reflections, and solutions are those of the
    /// pseudoinverse.
    #[test]
    fn solutions_are_those_of_the_pseudoinverse() {
        let mut state = 3;
        for round in 0..300 {
            let (m, p) = (1 + round % 7, round % 5);
            let r = (round % 4).min(m).min(p);
            let first = random(m, p, r, &mut state);
            let rest = random(m, 2, 2, &mut state);
            let mut a = Matrix::hstack(m, &[&first, &rest]);
            let mut elimination = Elimination::workspace(p);
            assert!(elimination.eliminate(&mut a, p, GAP));
            assert_eq!(elimination.rank(), r);
            for j in 0..2 {
                let mut back = a.column(p + j).to_vec();
                elimination.apply(&a, &mut back);
                for (b, x) in back.iter().zip(rest.column(j)) {
                    assert!((b - x).abs() < 1e-12);
                }
            }
            // A_1^T x = b with a b in its range.
            let b = first.transpose().mul_vec(rest.column(0));
            let mut x = vec![0.0; m];
            elimination.least_solution(&a, &b, &mut x);
            let svd = Svd::of(&first.transpose());
            let expected = svd.solve(&b, r);
            for (x, e) in x.iter().zip(&expected) {
                assert!((x - e).abs() < 1e-9 * (1.0 + norm(&expected)), "{x} {e}");
            }
            // A_1 x = b by R, where the columns are independent.
            if r == p {
                let mut x = a.column(p)[..p].to_vec();
                elimination.solve(&a, &mut x);
                let expected = Svd::of(&first).solve(rest.column(0), r);
                for (x, &i) in x.iter().zip(elimination.order()) {
                    assert!((x - expected[i]).abs() < 1e-8 * (1.0 + norm(&expected)));
                }
            }
        }
    }

    /// A remainder between zero and regular leaves the rank open.
    #[test]
    fn ranks_that_are_not_clear_are_not_decided() {
        let mut a = Matrix::from_rows(&[[1.0, 0.0], [0.0, 1e-7]]).unwrap();
        assert!(!Elimination::workspace(2).eliminate(&mut a, 2, GAP));
    }

    /// In other units the same ranks are open, zero and regular.
    #[test]
    fn a_gap_has_the_size_of_its_columns() {
        for size in [1e-12, 1.0, 1e9] {
            let rank = |second: f64| {
                let mut a = Matrix::from_rows(&[[size, 0.0], [0.0, second * size]]).unwrap();
                let mut elimination = Elimination::workspace(2);
                elimination.eliminate(&mut a, 2, GAP.times(size)).then(|| elimination.rank())
            };
            assert_eq!([1e-11, 1e-7, 1e-4].map(rank), [Some(1), None, Some(2)], "{size}");
        }
    }
}
