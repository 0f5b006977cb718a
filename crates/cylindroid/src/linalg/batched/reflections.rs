//! QR decomposition by Householder reflections, batched and without pivoting.
//!
//! Formula  A = Q R by reflections; K the last columns of Q; Y = X R^-1, X R^-T
//! Shapes   A: n x columns, of which the first `steps` are reduced and the others transformed;
//!          K: n x (n - steps); X, Y: any number of rows of R's size
//! Checked  tests::agrees_with_single

use super::{add_times, dot, reflect, reflector};
use crate::scalar::SimdFloat;

/// What the first columns were reduced by.
#[derive(Debug)]
pub(crate) struct Reflections<'a, R> {
    /// Length of the columns.
    pub(crate) n: usize,
    /// `A` in, out of it columns whose entry i is in row i of `Q^T A`; those that were reduced hold
    /// R above their diagonal, and the vectors of the reflections from there on.
    pub(crate) columns: &'a mut [R],
    /// The diagonal of R: one for each column that is reduced.
    pub(crate) diagonal: &'a mut [R],
    /// The factors of the reflections, as many.
    pub(crate) factors: &'a mut [R],
}

impl<R: SimdFloat> Reflections<'_, R> {
    /// Reduces as many columns as there are places for a diagonal.
    #[inline(always)]
    pub(crate) fn run(&mut self) {
        let n = self.n;
        for j in 0..self.diagonal.len() {
            let (head, rest) = self.columns.split_at_mut((j + 1) * n);
            let v = &mut head[j * n + j..];
            let (diagonal, factor) = reflector(v);
            (self.diagonal[j], self.factors[j]) = (diagonal, factor);
            reflect(rest, n, j, v, factor);
        }
    }

    /// What is orthogonal to the columns that were reduced: orthonormal columns.
    #[inline(always)]
    pub(crate) fn complement(&self, out: &mut [R]) {
        self.columns_of_q(self.diagonal.len(), out);
    }

    /// An orthonormal basis of the columns that were reduced: as many columns.
    #[inline(always)]
    pub(crate) fn leading_columns(&self, out: &mut [R]) {
        self.columns_of_q(0, out);
    }

    /// The columns of Q from the `first` on.
    #[inline(always)]
    fn columns_of_q(&self, first: usize, out: &mut [R]) {
        let n = self.n;
        out.fill(R::splat(0.0));
        for (l, column) in out.chunks_exact_mut(n).enumerate() {
            column[first + l] = R::splat(1.0);
        }
        for j in (0..self.diagonal.len()).rev() {
            // A reflection leaves unit vectors before its own.
            let from = j.saturating_sub(first) * n;
            let v = &self.columns[j * n + j..(j + 1) * n];
            reflect(&mut out[from..], n, j, v, self.factors[j]);
        }
    }

    /// R^T, columns: its singular values are those of the columns that were reduced, and its columns
    /// are nearer to orthogonal.
    #[inline(always)]
    pub(crate) fn transposed_triangle(&self, out: &mut [R]) {
        let k = self.diagonal.len();
        for (j, column) in out.chunks_exact_mut(k).enumerate() {
            column[..j].fill(R::splat(0.0));
            column[j] = self.diagonal[j];
            for (i, x) in column.iter_mut().enumerate().skip(j + 1) {
                *x = self.columns[i * self.n + j];
            }
        }
    }

    /// Columns X, as many as were reduced and of length n, to `X R^-T`.
    #[inline(always)]
    pub(crate) fn divide_by_transpose(&self, x: &mut [R]) {
        let n = self.n;
        for (l, d) in self.diagonal.iter().enumerate().rev() {
            let (before, own) = x.split_at_mut(l * n);
            let own = &mut own[..n];
            let inverse = R::splat(1.0) / *d;
            for x in &mut *own {
                *x = *x * inverse;
            }
            for (column, above) in before.chunks_exact_mut(n).zip(&self.columns[l * n..]) {
                add_times(column, -*above, own);
            }
        }
    }
}

/// Every row x of `rows`, as long as the diagonal of R, to `x R^-1`. `columns` hold R above its
/// diagonal, each of length n.
#[inline(always)]
pub(crate) fn divide_by_upper<R: SimdFloat>(
    rows: &mut [R],
    columns: &[R],
    n: usize,
    diagonal: &[R],
) {
    let k = diagonal.len();
    for (l, d) in diagonal.iter().enumerate() {
        let inverse = R::splat(1.0) / *d;
        let above = &columns[l * n..l * n + l];
        for row in rows.chunks_exact_mut(k) {
            row[l] = (row[l] - dot(&row[..l], above)) * inverse;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{Four, four, side_by_side};
    use super::*;
    use crate::linalg::{ColumnSpace, Matrix, Threshold};
    use crate::scalar::Simd;

    #[test]
    fn agrees_with_single() {
        let a = four(7, 4, 5);
        let mut columns = side_by_side(&a);
        let zero = Four::splat(0.0);
        let (mut diagonal, mut factors) = ([zero; 4], [zero; 4]);
        let mut all = Reflections {
            n: 7,
            columns: &mut columns,
            diagonal: &mut diagonal,
            factors: &mut factors,
        };
        all.run();
        let mut k = vec![zero; 7 * 3];
        all.complement(&mut k);
        let mut q = vec![zero; 7 * 4];
        all.leading_columns(&mut q);
        let mut transposed = q.clone();
        all.divide_by_transpose(&mut transposed);
        let mut triangle = vec![zero; 4 * 4];
        all.transposed_triangle(&mut triangle);
        let mut rows = side_by_side(&four(2, 4, 8).map(|m| m.transpose()));
        divide_by_upper(&mut rows, &columns, 7, &diagonal);
        for (l, a) in a.iter().enumerate() {
            let kernel = Matrix::from_fn(7, 3, |i, j| k[j * 7 + i].0[l]);
            assert!((&kernel.transpose() * a).max_abs() < 1e-15 * 20.0);
            let one = &kernel.transpose() * &kernel;
            assert!(one.max_difference(&Matrix::identity(3)) < 1e-14);
            let own = ColumnSpace::of(a, Threshold::Relative(1e-9)).complement();
            let cross = &own.transpose() * &kernel;
            let one = &cross.transpose() * &cross;
            assert!(one.max_difference(&Matrix::identity(3)) < 1e-13);
            // X = Y R
            let r = Matrix::from_fn(4, 4, |i, j| match i.cmp(&j) {
                std::cmp::Ordering::Less => columns[j * 7 + i].0[l],
                std::cmp::Ordering::Equal => diagonal[j].0[l],
                std::cmp::Ordering::Greater => 0.0,
            });
            let y = Matrix::from_fn(2, 4, |i, j| rows[i * 4 + j].0[l]);
            let x = &four(2, 4, 8)[l];
            assert!((&y * &r).max_difference(x) < 1e-13);
            let triangle = Matrix::from_fn(4, 4, |i, j| triangle[j * 4 + i].0[l]);
            assert!(triangle.transpose() == r);
            // A = Q R and Q = Y R^T
            let [q, y] = [&q, &transposed].map(|x| Matrix::from_fn(7, 4, |i, j| x[j * 7 + i].0[l]));
            assert!((&q * &r).max_difference(a) < 1e-14);
            assert!((&y * &r.transpose()).max_difference(&q) < 1e-13);
            let square = &r.transpose() * &r;
            assert!(square.max_difference(&(&a.transpose() * a)) < 1e-13);
        }
    }
}
