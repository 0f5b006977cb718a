//! Damped least squares (a step of Levenberg and Marquardt) with few rows.
//!
//! Formula  d = A^T (A A^T + l I)^-1 e; if A has fewer columns than rows d = (A^T A + l I)^-1 A^T
//!          e, which is equal
//! Shapes   A: m x n by columns, e: m, d: n; clamped columns count as zero
//! Valid    l > 0 relative to A: the matrix is then positive definite to rounding
//! Why so   a Cholesky decomposition of 6 x 6 costs a tenth of an SVD; iterations tolerate the accuracy
//!          lost by squaring, others refine the solution once
//! Source   Levenberg 1944; Wampler 1986; Golub & Van Loan, Matrix Computations, 2013, 3.5.3
//!          (refinement)
//! Checked  tests in this file (against the SVD)

use super::vector::{dot, dot_unrolled};
use crate::scalar::SimdFloat;

/// The least-squares problem of one configuration, or of a batch.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DampedProblem<'a, R = f64> {
    pub(crate) a: &'a [R],
    pub(crate) e: &'a [R],
    /// Columns that count as zero.
    pub(crate) clamped: &'a [bool],
    pub(crate) damping: R,
}

/// Workspace for steps.
#[derive(Debug, Clone)]
pub(crate) struct Damped {
    gram: Vec<f64>,
    rest: Vec<f64>,
    /// What a solution lacks.
    left: Vec<f64>,
}

impl Damped {
    pub(crate) fn new(m: usize, n: usize) -> Self {
        let size = m.min(n);
        Self { gram: vec![0.0; size * size], rest: vec![0.0; size], left: vec![0.0; m.max(n)] }
    }

    /// Computes the step `d`; false if the matrix is not positive definite.
    pub(crate) fn solve(&mut self, problem: DampedProblem<'_>, d: &mut [f64]) -> bool {
        // Repeated as a constant, so that the common size compiles to straight-line code.
        match (problem.e.len(), problem.clamped.len()) {
            (6, 6..) => self.by_rows(6, problem, d),
            (3, 3..) => self.by_rows(3, problem, d),
            (m, n) if n >= m => self.by_rows(m, problem, d),
            _ => self.by_columns(problem, d),
        }
    }

    /// The same with one step of refinement, for a damping that is small beside A: a residual at
    /// rounding of the terms of `(A A^T + l I) x = e`. No columns may be clamped.
    pub(crate) fn solve_refined(&mut self, problem: DampedProblem<'_>, d: &mut [f64]) -> bool {
        if !self.solve(problem, d) {
            return false;
        }
        let Self { gram, rest, left } = self;
        let DampedProblem { a, e, clamped, damping } = problem;
        let (m, n) = (e.len(), clamped.len());
        let size = m.min(n);
        left[..m].copy_from_slice(e);
        for (column, d) in a.chunks_exact(m).zip(&*d) {
            left.iter_mut().zip(column).for_each(|(l, a)| *l -= a * d);
        }
        if n >= m {
            left.iter_mut().zip(&*rest).for_each(|(l, x)| *l -= damping * x);
            solve(size, gram, &mut left[..m]);
            for (column, d) in a.chunks_exact(m).zip(d) {
                *d += dot(column, &left[..m]);
            }
        } else {
            for (j, x) in rest.iter_mut().enumerate() {
                *x = dot(&a[j * m..(j + 1) * m], &left[..m]) - damping * d[j];
            }
            solve(size, gram, rest);
            d.iter_mut().zip(rest).for_each(|(d, x)| *d += *x);
        }
        true
    }

    #[inline(always)]
    fn by_rows(&mut self, m: usize, problem: DampedProblem<'_>, d: &mut [f64]) -> bool {
        let (gram, rest) = (&mut self.gram[..m * m], &mut self.rest[..m]);
        damped_by_rows(m, problem, (gram, rest), d)
    }

    fn by_columns(&mut self, problem: DampedProblem<'_>, d: &mut [f64]) -> bool {
        let DampedProblem { a, e, clamped, damping } = problem;
        let (m, n) = (e.len(), clamped.len());
        let column = |j: usize| &a[j * m..(j + 1) * m];
        for i in 0..n {
            for j in 0..=i {
                let apart = clamped[i] || clamped[j];
                self.gram[i * n + j] = if apart { 0.0 } else { dot_unrolled(column(i), column(j)) };
            }
            self.gram[i * n + i] += if clamped[i] { 1.0 } else { damping };
            self.rest[i] = if clamped[i] { 0.0 } else { dot(column(i), e) };
        }
        if !factor(n, &mut self.gram) {
            return false;
        }
        solve(n, &self.gram, &mut self.rest);
        d.copy_from_slice(&self.rest);
        true
    }
}

/// The step if A has at least as many columns as rows, with workspace of m x m and m; false if a
/// matrix is not positive definite, and the step is then invalid.
#[inline(always)]
pub(crate) fn damped_by_rows<R: SimdFloat>(
    m: usize,
    problem: DampedProblem<'_, R>,
    (gram, rest): (&mut [R], &mut [R]),
    d: &mut [R],
) -> bool {
    let DampedProblem { a, e, clamped, damping } = problem;
    gram.fill(R::splat(0.0));
    for (column, clamped) in a.chunks_exact(m).zip(clamped) {
        if *clamped {
            continue;
        }
        for i in 0..m {
            for j in 0..=i {
                gram[i * m + j] = column[i].mul_add(column[j], gram[i * m + j]);
            }
        }
    }
    for i in 0..m {
        gram[i * m + i] = gram[i * m + i] + damping;
    }
    let is_definite = factor(m, gram);
    rest.copy_from_slice(&e[..m]);
    solve(m, gram, rest);
    for ((d, column), clamped) in d.iter_mut().zip(a.chunks_exact(m)).zip(clamped) {
        *d = R::splat(0.0);
        if !*clamped {
            for (x, y) in column.iter().zip(&*rest) {
                *d = x.mul_add(*y, *d);
            }
        }
    }
    is_definite
}

/// The Cholesky factor in place, lower, row-major, with its diagonal inverted; false if the matrix
/// is not positive definite.
#[inline(always)]
fn factor<R: SimdFloat>(n: usize, g: &mut [R]) -> bool {
    let (zero, one) = (R::splat(0.0), R::splat(1.0));
    let mut indefinite = zero;
    for j in 0..n {
        let mut pivot = g[j * n + j];
        for k in 0..j {
            pivot = pivot - g[j * n + k] * g[j * n + k];
        }
        indefinite = indefinite + R::select_lt(zero, pivot, zero, one);
        let inverse = one / pivot.sqrt();
        g[j * n + j] = inverse;
        for i in j + 1..n {
            let mut sum = g[i * n + j];
            for k in 0..j {
                sum = sum - g[i * n + k] * g[j * n + k];
            }
            g[i * n + j] = sum * inverse;
        }
    }
    indefinite.all_abs_le(0.0)
}

#[inline(always)]
fn solve<R: SimdFloat>(n: usize, l: &[R], x: &mut [R]) {
    for i in 0..n {
        let mut sum = x[i];
        for k in 0..i {
            sum = sum - l[i * n + k] * x[k];
        }
        x[i] = sum * l[i * n + i];
    }
    for i in (0..n).rev() {
        let mut sum = x[i];
        for k in i + 1..n {
            sum = sum - l[k * n + i] * x[k];
        }
        x[i] = sum * l[i * n + i];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::{Matrix, Svd, norm};
    use crate::scalar::uniform;

    /// V diag(s / (s^2 + l)) U^T e for any shape, with clamped columns.
    #[test]
    fn steps_are_those_of_the_svd() {
        let mut random = 3;
        for round in 0..300 {
            let (m, n) = [(6, 7), (6, 6), (6, 5), (3, 7), (5, 5), (12, 14), (2, 1)][round % 7];
            let a = Matrix::from_fn(m, n, |_, _| uniform(&mut random) - 0.5);
            let e: Vec<f64> = (0..m).map(|_| uniform(&mut random) - 0.5).collect();
            let clamped: Vec<bool> = (0..n).map(|_| uniform(&mut random) < 0.2).collect();
            let damping = 0.01;
            let mut d = vec![0.0; n];
            let problem = DampedProblem { a: a.as_slice(), e: &e, clamped: &clamped, damping };
            assert!(Damped::new(m, n).solve(problem, &mut d));
            let free = Matrix::from_fn(m, n, |i, j| if clamped[j] { 0.0 } else { a[(i, j)] });
            for (d, x) in d.iter().zip(&by_svd(&free, &e, damping)) {
                assert!((d - x).abs() < 1e-12, "{m} x {n}");
            }
        }
    }

    /// Rows that nearly depend on each other, and dampings far below their squares.
    #[test]
    fn refined_steps_are_those_of_the_svd() {
        let mut random = 5;
        for round in 0..700 {
            let (m, n) = [(6, 7), (6, 6), (6, 5), (3, 7), (5, 5), (12, 14), (2, 1)][round % 7];
            let damping = 10_f64.powf(-2.0 - 5.0 * uniform(&mut random));
            let apart = damping.sqrt() * uniform(&mut random);
            let mut a = Matrix::from_fn(m, n, |_, _| uniform(&mut random) - 0.5);
            for j in 0..n {
                a[(m - 1, j)] = a[(0, j)] + apart * (uniform(&mut random) - 0.5);
            }
            let e: Vec<f64> = (0..m).map(|_| uniform(&mut random) - 0.5).collect();
            let mut d = vec![0.0; n];
            let problem =
                DampedProblem { a: a.as_slice(), e: &e, clamped: &vec![false; n], damping };
            assert!(Damped::new(m, n).solve_refined(problem, &mut d));
            let expected = by_svd(&a, &e, damping);
            for (d, x) in d.iter().zip(&expected) {
                let error = (d - x).abs() / norm(&expected);
                assert!(error < 1e-10, "{m} x {n}, damping {damping:e}: {error:e}");
            }
        }
    }

    fn by_svd(a: &Matrix, e: &[f64], damping: f64) -> Vec<f64> {
        let svd = Svd::of(a);
        let mut d = vec![0.0; a.cols()];
        for i in 0..svd.len() {
            let s = svd.value(i);
            let gain = dot(svd.u(i), e) * s / (s * s + damping);
            d.iter_mut().zip(svd.v(i)).for_each(|(x, v)| *x += gain * v);
        }
        d
    }
}
