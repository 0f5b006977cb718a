//! Distance to a singularity with a sign: of a block of the Jacobian of the loops.
//!
//! Formula  s = sign(det M) s_r / s_1, with s_1 and s_r the largest and the smallest generic singular
//!          value of the block and M a square part of it, whose rows were chosen where its rank is
//!          clear
//! Shapes   block: t x f, generic rank r, M: f x f
//! Units    none: lengths are divided by the characteristic length
//! Valid    a sign exists where r = f: the columns are dependent at singularities only. With r < f a
//!          motion is left that nothing prescribes, singularities are no surfaces, and s is not
//!          signed. Rows chosen once may become dependent at regular configurations: the sign then
//!          changes where s_r does not vanish, which those who follow it check
//! Why so   with rows to spare (planar loops in space) no determinant exists, and the row space that
//!          carries one moves with the configuration
//! Checked  tests/map/five_bar.rs, tests/map/planar_platform.rs

use std::ops::Range;

use super::coordinates::columns;
use crate::closure::constraint::rate_rank::rate_rank;
use crate::linalg::{Matrix, Qr, Svd};
use crate::tolerance::CLOSURE_RANK;

/// A block of the Jacobian and what it says of singularities.
#[derive(Debug, Clone)]
pub(crate) struct SignedSingularity {
    /// Rows of the Jacobian.
    rows: Range<usize>,
    /// Coordinates.
    pub(crate) columns: Vec<usize>,
    pub(crate) rank: usize,
    /// Rows of M, if there is a sign.
    minor: Option<Vec<usize>>,
    /// Makes the sign that of the first configuration.
    flip: f64,
}

impl SignedSingularity {
    /// Of these rows and columns, with the generic rank over some Jacobians; the sign is positive at
    /// the first, unless it is singular.
    pub(crate) fn new(rows: Range<usize>, columns: Vec<usize>, jacobians: &[Matrix]) -> Self {
        let mut new = Self { rows, columns, rank: 0, minor: None, flip: 1.0 };
        let mut best = (0, 0.0);
        let mut blocks = Vec::new();
        for jacobian in jacobians {
            let block = new.block(jacobian);
            let svd = Svd::of(&block);
            let rank = rate_rank(&svd, CLOSURE_RANK);
            let smallest = rank.checked_sub(1).map_or(0.0, |last| svd.value(last) / svd.value(0));
            if (rank, smallest) > best {
                best = (rank, smallest);
                blocks.insert(0, block);
            } else {
                blocks.push(block);
            }
        }
        new.rank = best.0;
        if new.rank == new.columns.len() && new.rank > 0 {
            let clearest = blocks.first().map(Matrix::transpose);
            let chosen = clearest.map(|b| Qr::pivoted(b).order()[..new.rank].to_vec());
            new.minor = chosen.map(|mut chosen| {
                chosen.sort_unstable();
                chosen
            });
        }
        if let Some(first) = jacobians.first() {
            let block = new.block(first);
            let sign = new.sign(&block);
            new.flip = if sign < 0.0 { -1.0 } else { 1.0 };
        }
        new
    }

    /// True if the distance has a sign.
    pub(crate) fn is_signed(&self) -> bool {
        self.minor.is_some()
    }

    /// The first row of the block.
    pub(crate) fn first_row(&self) -> usize {
        self.rows.start
    }

    /// The block of a Jacobian.
    pub(crate) fn block(&self, jacobian: &Matrix) -> Matrix {
        if self.rows.len() == jacobian.rows() {
            return columns(jacobian, &self.columns);
        }
        let from = self.rows.start;
        Matrix::from_fn(self.rows.len(), self.columns.len(), |i, j| {
            jacobian[(from + i, self.columns[j])]
        })
    }

    /// s, of the block and its decomposition; infinite if the generic rank is zero.
    pub(crate) fn value(&self, block: &Matrix, svd: &Svd) -> f64 {
        self.sign(block) * self.distance(svd)
    }

    /// The absolute value of s.
    pub(crate) fn distance(&self, svd: &Svd) -> f64 {
        let Some(last) = self.rank.checked_sub(1) else { return f64::INFINITY };
        (svd.value(last) / svd.value(0).max(f64::MIN_POSITIVE)).min(1.0)
    }

    /// The sign of det M, 1 without a sign.
    fn sign(&self, block: &Matrix) -> f64 {
        let Some(minor) = &self.minor else { return 1.0 };
        let mut m = Matrix::from_fn(minor.len(), minor.len(), |i, j| block[(minor[i], j)]);
        self.flip * determinant_sign(&mut m)
    }
}

/// The sign of the determinant of a square matrix, which is eliminated; 0 if a column vanishes.
fn determinant_sign(a: &mut Matrix) -> f64 {
    let n = a.rows();
    let mut sign = 1.0;
    for k in 0..n {
        let pivot = (k..n).fold(k, |p, i| if a[(i, k)].abs() > a[(p, k)].abs() { i } else { p });
        let largest = a[(pivot, k)];
        if largest == 0.0 {
            return 0.0;
        }
        if pivot != k {
            sign = -sign;
            for j in k..n {
                let column = a.column_mut(j);
                column.swap(k, pivot);
            }
        }
        sign *= largest.signum();
        for i in k + 1..n {
            let ratio = a[(i, k)] / largest;
            for j in k + 1..n {
                let above = a[(k, j)];
                a[(i, j)] -= ratio * above;
            }
        }
    }
    sign
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::uniform;

    /// The sign of a product is the product of the signs; a swap of rows changes it.
    #[test]
    fn signs_of_determinants() {
        let mut state = 5;
        for n in 1..7 {
            let mut random = || Matrix::from_fn(n, n, |_, _| 2.0 * uniform(&mut state) - 1.0);
            let (a, b) = (random(), random());
            let sign = |m: &Matrix| determinant_sign(&mut m.clone());
            assert_eq!(sign(&(&a * &b)), sign(&a) * sign(&b));
            if n > 1 {
                let swapped = Matrix::from_fn(n, n, |i, j| a[(if i < 2 { 1 - i } else { i }, j)]);
                assert_eq!(sign(&swapped), -sign(&a));
            }
            assert_eq!(sign(&Matrix::zeros(n, n)), 0.0);
            // A zero on the diagonal is no zero determinant: ones beside it, a cycle of n.
            let cycle = Matrix::from_fn(n, n, |i, j| f64::from(u8::from((i + 1) % n == j)));
            assert_eq!(sign(&cycle), if n % 2 == 0 { -1.0 } else { 1.0 });
        }
    }

    /// Rows that are always zero do not hide the sign.
    #[test]
    fn rows_to_spare() {
        let at = |x: f64| Matrix::from_rows(&[[0.0, 0.0], [1.0, 0.5], [2.0, 1.0 + x]]).unwrap();
        let s = SignedSingularity::new(0..3, vec![0, 1], &[at(1.0), at(0.3)]);
        assert!(s.is_signed());
        let value = |x: f64| s.value(&at(x), &Svd::of(&at(x)));
        assert!(value(0.1) > 0.0 && value(-0.1) < 0.0 && value(0.0).abs() < 1e-15);
        let wide = SignedSingularity::new(0..3, vec![0, 1, 0], &[at(1.0)]);
        assert!(!wide.is_signed());
    }

    /// A block of some of the rows is that of these rows alone.
    #[test]
    fn rows_of_other_loops_do_not_count() {
        let own = |x: f64| Matrix::from_rows(&[[1.0, 0.5], [2.0, 1.0 + x]]).unwrap();
        let beside = |x: f64| {
            let rows = [[3.0, 0.0, 7.0], [1.0, 0.5, -4.0], [2.0, 1.0 + x, 5.0], [0.0, 9.0, 1.0]];
            Matrix::from_rows(&rows).unwrap()
        };
        let s = SignedSingularity::new(1..3, vec![0, 1], &[beside(1.0)]);
        assert_eq!((s.block(&beside(0.2)), s.first_row(), s.rank), (own(0.2), 1, 2));
        let value = |x: f64| s.value(&s.block(&beside(x)), &Svd::of(&own(x)));
        assert!(value(0.1) > 0.0 && value(-0.1) < 0.0 && value(0.0).abs() < 1e-15);
    }
}
