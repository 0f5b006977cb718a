//! An orthonormal basis that grows by several vectors at a time.
//!
//! Formula  A = C Q_0^T + L Q^T: the rows of A outside the first columns Q_0, orthonormal as Q^T,
//!          L lower triangular
//! Shapes   Q: n x n, of which the first columns count; A: m x n, L: m x m
//! Valid    rows whose norms outside the others are not rounding. The columns are orthogonal to a
//!          rounding times |A| |L^-1|: a caller who bounds that needs no second pass
//! Cost     of the order of m (k + m) n for m rows after k columns, four columns at a time
//! Source   Golub & Van Loan, Matrix Computations, 2013, 5.2.8 (modified Gram-Schmidt); Bjorck 1967
//!          (its orthogonality)
//! Checked  tests in this file

use super::matrix::Matrix;
use super::small_gemm::{AlignedColumns, LANES, lanes};
use crate::scalar::{Array, Simd4};
#[cfg(target_arch = "x86_64")]
use crate::scalar::{Avx2, Lanes4};

/// Orthonormal columns, at most as many as they are long.
#[derive(Debug, Clone)]
pub(crate) struct Basis {
    columns: AlignedColumns,
}

/// L, and the memory to bound its singular values.
#[derive(Debug, Clone)]
pub(crate) struct LowerTriangle {
    entries: AlignedColumns,
    /// Rows of the inverse, a column each.
    inverse: AlignedColumns,
}

impl LowerTriangle {
    /// m x m.
    pub(crate) fn zeros(m: usize) -> Self {
        Self { entries: AlignedColumns::zeros(m, m), inverse: AlignedColumns::zeros(m, m) }
    }

    /// `x <- L^-1 x` for as many rows as x has.
    pub(crate) fn solve(&self, x: &mut [f64]) {
        for i in 0..x.len() {
            let column = &self.entries.column(i)[i..x.len()];
            let (head, rest) = x[i..].split_at_mut(1);
            head[0] /= column[0];
            rest.iter_mut().zip(&column[1..]).for_each(|(x, l)| *x -= l * head[0]);
        }
    }

    /// The transpose of the leading m x m triangle of `a`, which is upper.
    pub(crate) fn load_transposed(&mut self, a: &Matrix, m: usize) {
        for i in 0..m {
            let column = self.entries.column_mut(i)[i..m].iter_mut().enumerate();
            column.for_each(|(j, x)| *x = a[(i, i + j)]);
        }
    }

    /// True if all singular values of the first m rows and columns are above `least`, by upper bounds
    /// of |L^-1|: |L^-1|_F, and the root of |L^-1 L^-T|_F, which one small value alone makes exact.
    pub(crate) fn is_clear(&mut self, m: usize, least: f64) -> bool {
        #[cfg(target_arch = "x86_64")]
        if let Some(cpu) = Avx2::detect() {
            #[allow(unsafe_code)] // the one way to call a function compiled for more
            // SAFETY: the token proves that the processor has both features.
            return unsafe { is_clear_avx2(cpu, self, m, least) };
        }
        is_clear::<Array<4>>((), self, m, least)
    }
}

impl Basis {
    /// Memory for n columns of length n.
    pub(crate) fn workspace(n: usize) -> Self {
        Self { columns: AlignedColumns::zeros(n, n) }
    }

    pub(crate) fn column(&self, j: usize) -> &[f64] {
        self.columns.column(j)
    }

    pub(crate) fn column_mut(&mut self, j: usize) -> &mut [f64] {
        self.columns.column_mut(j)
    }

    /// Takes the parts along the first columns out of `x`.
    pub(crate) fn project_out(&self, columns: usize, x: &mut [f64]) {
        #[cfg(target_arch = "x86_64")]
        if let Some(cpu) = Avx2::detect() {
            #[allow(unsafe_code)] // as above
            // SAFETY: the token proves that the processor has both features.
            return unsafe { project_out_avx2(cpu, &self.columns, columns, x) };
        }
        project_out::<Array<4>>((), &self.columns, columns, x);
    }

    /// Makes the m columns from `first` on, which are the rows of A, orthonormal, to each other and to
    /// the columns before; `lower` becomes L. False if one of them is less than `dependent` of its
    /// norm outside the others.
    pub(crate) fn orthonormalise(
        &mut self,
        first: usize,
        m: usize,
        dependent: f64,
        lower: &mut LowerTriangle,
    ) -> bool {
        let (columns, entries) = (&mut self.columns, &mut lower.entries);
        #[cfg(target_arch = "x86_64")]
        if let Some(cpu) = Avx2::detect() {
            #[allow(unsafe_code)] // as above
            // SAFETY: the token proves that the processor has both features.
            return unsafe { orthonormalise_avx2(cpu, columns, first, m, dependent, entries) };
        }
        orthonormalise::<Array<4>>((), columns, first, m, dependent, entries)
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn orthonormalise_avx2(
    cpu: Avx2,
    columns: &mut AlignedColumns,
    first: usize,
    m: usize,
    dependent: f64,
    lower: &mut AlignedColumns,
) -> bool {
    orthonormalise::<Lanes4>(cpu, columns, first, m, dependent, lower)
}

#[inline(always)]
fn orthonormalise<R: Simd4>(
    _: R::Cpu,
    columns: &mut AlignedColumns,
    first: usize,
    m: usize,
    dependent: f64,
    lower: &mut AlignedColumns,
) -> bool {
    if m == 0 {
        return true;
    }
    let stride = columns.stride;
    let (before, own) = columns.data.split_at_mut(first * stride);
    let own = &mut own[..m * stride];
    // The norms of the rows, in the diagonal until they are replaced.
    for (i, row) in own.chunks_exact(stride).enumerate() {
        lower.column_mut(i)[i] = lanes::<R>(row, row).sum().sqrt();
    }
    for column in before.chunks_exact(stride) {
        remove::<R>(column, own, |_, _| ());
    }
    for k in 0..m {
        let (done, rest) = own.split_at_mut((k + 1) * stride);
        let column = &mut done[k * stride..];
        let length = lanes::<R>(column, column).sum().sqrt();
        let whole = std::mem::replace(&mut lower.column_mut(k)[k], length);
        // NaN as well.
        if !(length > dependent * whole) {
            return false;
        }
        let factor = R::splat(1.0 / length);
        for four in column.as_chunks_mut::<LANES>().0 {
            (R::load(four) * factor).store(four);
        }
        let lower = &mut lower.column_mut(k)[k + 1..];
        remove::<R>(column, rest, |i, along| lower[i] = along);
    }
    true
}

/// Takes the parts along `column` out of the `others`; `f` gets each with its number.
#[inline(always)]
fn remove<R: Simd4>(column: &[f64], others: &mut [f64], mut f: impl FnMut(usize, f64)) {
    let stride = column.len();
    let mut blocks = others.chunks_exact_mut(LANES * stride);
    let mut i = 0;
    for block in &mut blocks {
        let (a, block) = block.split_at_mut(stride);
        let (b, block) = block.split_at_mut(stride);
        let (c, d) = block.split_at_mut(stride);
        let mut sums = [R::splat(0.0); LANES];
        for at in (0..stride).step_by(LANES) {
            let x = R::load(&column[at..]);
            sums[0] = R::load(&a[at..]).mul_add(x, sums[0]);
            sums[1] = R::load(&b[at..]).mul_add(x, sums[1]);
            sums[2] = R::load(&c[at..]).mul_add(x, sums[2]);
            sums[3] = R::load(&d[at..]).mul_add(x, sums[3]);
        }
        let mut along = [0.0; LANES];
        R::sums(sums).store(&mut along);
        let parts = along.map(|x| R::splat(-x));
        for at in (0..stride).step_by(LANES) {
            let x = R::load(&column[at..]);
            x.mul_add(parts[0], R::load(&a[at..])).store(&mut a[at..]);
            x.mul_add(parts[1], R::load(&b[at..])).store(&mut b[at..]);
            x.mul_add(parts[2], R::load(&c[at..])).store(&mut c[at..]);
            x.mul_add(parts[3], R::load(&d[at..])).store(&mut d[at..]);
        }
        for along in along {
            f(i, along);
            i += 1;
        }
    }
    for other in blocks.into_remainder().chunks_exact_mut(stride) {
        let along = lanes::<R>(column, other).sum();
        let part = R::splat(-along);
        for at in (0..stride).step_by(LANES) {
            R::load(&column[at..]).mul_add(part, R::load(&other[at..])).store(&mut other[at..]);
        }
        f(i, along);
        i += 1;
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn project_out_avx2(cpu: Avx2, columns: &AlignedColumns, count: usize, x: &mut [f64]) {
    project_out::<Lanes4>(cpu, columns, count, x);
}

#[inline(always)]
fn project_out<R: Simd4>(_: R::Cpu, columns: &AlignedColumns, count: usize, x: &mut [f64]) {
    if count == 0 {
        return;
    }
    let stride = columns.stride;
    // Four columns at a time: they are orthogonal to each other.
    let mut blocks = columns.data[..count * stride].chunks_exact(LANES * stride);
    for block in &mut blocks {
        take_out::<R, LANES>(block, stride, x);
    }
    for column in blocks.remainder().chunks_exact(stride) {
        take_out::<R, 1>(column, stride, x);
    }
}

/// Takes the parts along K columns out of `x`.
#[inline(always)]
fn take_out<R: Simd4, const K: usize>(columns: &[f64], stride: usize, x: &mut [f64]) {
    let mut sums = [R::splat(0.0); K];
    for at in (0..stride).step_by(LANES) {
        let x = R::load_partial(&x[at..]);
        for (k, sum) in sums.iter_mut().enumerate() {
            *sum = R::load(&columns[k * stride + at..]).mul_add(x, *sum);
        }
    }
    let parts = sums.map(|sum| R::splat(-sum.sum()));
    for at in (0..stride).step_by(LANES) {
        let x = &mut x[at..];
        let mut rest = R::load_partial(x);
        for (k, part) in parts.iter().enumerate() {
            rest = R::load(&columns[k * stride + at..]).mul_add(*part, rest);
        }
        rest.store_partial(x);
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn is_clear_avx2(cpu: Avx2, lower: &mut LowerTriangle, m: usize, least: f64) -> bool {
    is_clear::<Lanes4>(cpu, lower, m, least)
}

#[inline(always)]
fn is_clear<R: Simd4>(_: R::Cpu, lower: &mut LowerTriangle, m: usize, least: f64) -> bool {
    let LowerTriangle { entries, inverse } = lower;
    let square = invert::<R>(entries, inverse, m);
    let share = least * least;
    if square * share < 1.0 {
        return true;
    }
    if !(square * share < m as f64) {
        return false; // the largest value of the inverse has at least this part of all
    }
    let row = |i: usize| &inverse.data[i * inverse.stride..][..inverse.stride];
    let mut fourth = 0.0;
    for i in 0..m {
        for j in 0..=i {
            let end = (j + 1).next_multiple_of(LANES);
            let product = lanes::<R>(&row(i)[..end], &row(j)[..end]).sum();
            fourth += if j < i { 2.0 } else { 1.0 } * product * product;
        }
    }
    fourth * share * share < 1.0
}

/// Rows of the inverse, one after another: of row i the rows before, each times its entry of L.
/// Returns |L^-1|_F squared.
#[inline(always)]
fn invert<R: Simd4>(lower: &AlignedColumns, inverse: &mut AlignedColumns, m: usize) -> f64 {
    let stride = inverse.stride;
    let mut square = R::splat(0.0);
    for i in 0..m {
        let (done, row) = inverse.data.split_at_mut(i * stride);
        let row = &mut row[..stride];
        let end = (i + 1).next_multiple_of(LANES);
        let factor = R::splat(1.0 / lower.column(i)[i]);
        for at in (0..end).step_by(LANES) {
            let mut sum = R::from_fn(|l| if at + l == i { 1.0 } else { 0.0 });
            // Rows before `at` are zero here.
            for k in at..i {
                let entry = R::splat(-lower.data[k * lower.stride + i]);
                sum = R::load(&done[k * stride + at..]).mul_add(entry, sum);
            }
            let x = sum * factor;
            x.store(&mut row[at..]);
            square = x.mul_add(x, square);
        }
    }
    square.sum()
}

#[cfg(test)]
mod tests {
    use super::super::test_support::{Random, assert_close};
    use super::super::{Matrix, Svd};
    use super::*;

    /// Random rows after random columns: the rows come back, the basis is orthonormal, and
    /// clear are those whose singular values are.
    #[test]
    fn rows_come_back_from_the_basis() {
        let mut random = Random(7);
        for (n, k, m) in [(1, 0, 1), (7, 0, 6), (7, 2, 5), (9, 3, 4), (15, 1, 12), (35, 4, 27)] {
            let rows = random.matrix(k + m, n);
            let mut basis = Basis::workspace(n);
            let mut lower = LowerTriangle::zeros(m.max(k));
            let load = |basis: &mut Basis, from: usize, to: usize| {
                for i in from..to {
                    let column = basis.column_mut(i).iter_mut();
                    column.enumerate().for_each(|(j, x)| *x = rows[(i, j)]);
                }
            };
            load(&mut basis, 0, k);
            assert!(basis.orthonormalise(0, k, 1e-9, &mut lower));
            load(&mut basis, k, k + m);
            assert!(basis.orthonormalise(k, m, 1e-9, &mut lower));
            for i in 0..k + m {
                let mut unit = basis.column(i).to_vec();
                basis.project_out(i, &mut unit);
                assert_close("outside", &unit, basis.column(i), 1e-11);
                assert!((unit.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-11);
            }
            let entry = |i: usize, j: usize| if j > i { 0.0 } else { lower.entries.column(j)[i] };
            let l = Matrix::from_fn(m, m, entry);
            for i in 0..m {
                let mut row: Vec<f64> = (0..n).map(|j| rows[(k + i, j)]).collect();
                basis.project_out(k, &mut row);
                let back: Vec<f64> = (0..n)
                    .map(|j| (0..=i).map(|p| l[(i, p)] * basis.column(k + p)[j]).sum())
                    .collect();
                assert_close("row", &back, &row, 1e-12);
            }
            let x = random.vector(m);
            let mut solution = x.clone();
            lower.solve(&mut solution);
            assert_close("solution", &l.mul_vec(&solution), &x, 1e-9);
            let svd = Svd::of(&l);
            let least = svd.values().fold(f64::INFINITY, f64::min);
            let square = svd.values().map(|s| s.powi(-2)).sum::<f64>();
            let fourth = svd.values().map(|s| s.powi(-4)).sum::<f64>();
            assert!(lower.is_clear(m, 0.999_999 * square.powf(-0.5)));
            assert!(lower.is_clear(m, 0.999_999 * fourth.powf(-0.25)));
            assert!(!lower.is_clear(m, 1.000_001 * fourth.powf(-0.25)));
            assert!(!lower.is_clear(m, 1.000_001 * least), "{n} {k} {m}");
        }
    }

    /// The form of this processor and plain arrays.
    #[test]
    fn registers_agree_with_arrays() {
        let mut random = Random(3);
        for (n, k, m) in [(5, 1, 3), (7, 0, 6), (13, 6, 7)] {
            let mut basis = Basis::workspace(n);
            for i in 0..k + m {
                basis.column_mut(i).copy_from_slice(&random.vector(n));
            }
            let (mut lower, mut plain) = (LowerTriangle::zeros(m), LowerTriangle::zeros(m));
            let mut columns = basis.columns.clone();
            assert!(basis.orthonormalise(0, k, 1e-9, &mut LowerTriangle::zeros(k)));
            let first = &mut AlignedColumns::zeros(k, k);
            assert!(orthonormalise::<Array<4>>((), &mut columns, 0, k, 1e-9, first));
            assert!(basis.orthonormalise(k, m, 1e-9, &mut lower));
            assert!(orthonormalise::<Array<4>>((), &mut columns, k, m, 1e-9, &mut plain.entries));
            assert_close("columns", &basis.columns.data, &columns.data, 1e-11);
            assert_close("triangle", &lower.entries.data, &plain.entries.data, 1e-11);
            let x = random.vector(n);
            let (mut these, mut those) = (x.clone(), x);
            basis.project_out(k + m, &mut these);
            project_out::<Array<4>>((), &columns, k + m, &mut those);
            assert_close("outside", &these, &those, 1e-11);
            for least in [1e-9, 1e-3, 0.1, 0.5, 2.0] {
                let clear = is_clear::<Array<4>>((), &mut plain, m, least);
                assert_eq!(lower.is_clear(m, least), clear, "{n} {k} {m} {least}");
            }
        }
    }

    /// A row that depends on the others, a zero row and one that is not finite are found.
    #[test]
    fn dependent_rows_are_found() {
        for last in [[1.0, 2.0, 3.0], [0.0; 3], [f64::NAN, 0.0, 0.0]] {
            let mut basis = Basis::workspace(3);
            for (i, row) in [[1.0, 0.0, 0.0], [0.0, 2.0, 3.0], last].into_iter().enumerate() {
                basis.column_mut(i).copy_from_slice(&row);
            }
            assert!(!basis.orthonormalise(0, 3, 1e-10, &mut LowerTriangle::zeros(3)));
        }
    }
}
