//! Products `y + C diag(f) B^T x`: coefficients of a vector along columns, and the sum of others
//! with these coefficients.
//!
//! Formula  y' = y + C diag(f) B^T x;  x' = x - C diag(f) C^T x
//! Shapes   B: m x k, C: n x k, aligned; f: k
//! Why so   a servo uses a decomposition for nothing else. The eight columns of a block are
//!          independent of each other; written once over [`Simd4`], compiled for the baseline and
//!          for AVX2
//! Checked  tests::blocks_are_plain_sums, tests/it/svd.rs::null_space_is_the_kernel

use super::small_gemm::{AlignedColumns, LANES};
use crate::scalar::{Array, Simd4};
#[cfg(target_arch = "x86_64")]
use crate::scalar::{Avx2, Lanes4};

/// Columns of a block.
const BLOCK: usize = 8;

/// Adds to `y` the columns of `to`, each times its factor and the product of `x` with that of
/// `from`.
#[inline]
pub(super) fn add_through(
    from: &AlignedColumns,
    factors: &[f64],
    to: &AlignedColumns,
    x: &[f64],
    y: &mut [f64],
) {
    #[cfg(target_arch = "x86_64")]
    if let (Some(from), Some(to)) = (six(from), six(to))
        && let Some(cpu) = Avx2::detect()
    {
        #[allow(unsafe_code)] // the one way to call a function compiled for more than the baseline
        // SAFETY: the token proves that the processor has both features.
        unsafe {
            add_through_six(cpu, from, factors, to, x, y);
        }
        return;
    }
    for (i, factors) in factors.chunks(BLOCK).enumerate() {
        add::<Array<4>>((), Block::of(from, i), factors, Block::of(to, i), x, y);
    }
}

/// Takes the parts along the columns out of `x`, each times its factor. "Twice is enough" (Kahan).
#[inline]
pub(super) fn reorthogonalise(
    columns: &AlignedColumns,
    factor: impl Fn(usize) -> f64,
    x: &mut [f64],
) {
    for i in 0..columns.cols.div_ceil(BLOCK) {
        let factors: [f64; BLOCK] = std::array::from_fn(|l| factor(i * BLOCK + l));
        #[cfg(target_arch = "x86_64")]
        if let Some(columns) = six(columns)
            && let Some(cpu) = Avx2::detect()
        {
            #[allow(unsafe_code)] // as above
            // SAFETY: the token proves that the processor has both features.
            unsafe {
                reorthogonalise_six(cpu, columns, &factors, x);
            }
            return;
        }
        for _ in 0..2 {
            remove::<Array<4>>((), Block::of(columns, i), &factors, x);
        }
    }
}

/// Six columns of five to eight numbers, as arms have them.
#[inline]
#[cfg(target_arch = "x86_64")]
fn six(columns: &AlignedColumns) -> Option<&[f64; 48]> {
    if columns.stride == 8 { columns.data.as_slice().try_into().ok() } else { None }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn add_through_six(
    cpu: Avx2,
    from: &[f64; 48],
    factors: &[f64],
    to: &[f64; 48],
    x: &[f64],
    y: &mut [f64],
) {
    let (from, to) = (Block::of_six(from), Block::of_six(to));
    add::<Lanes4>(cpu, from, factors, to, x, y);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn reorthogonalise_six(cpu: Avx2, columns: &[f64; 48], factors: &[f64; BLOCK], x: &mut [f64]) {
    let block = Block::of_six(columns);
    remove::<Lanes4>(cpu, block, factors, x);
    remove::<Lanes4>(cpu, block, factors, x);
}

/// Some columns.
#[derive(Debug, Clone, Copy)]
struct Block<'a> {
    numbers: &'a [f64],
    count: usize,
    stride: usize,
}

impl<'a> Block<'a> {
    /// The i-th block.
    #[inline(always)]
    fn of(columns: &'a AlignedColumns, i: usize) -> Self {
        let (stride, first) = (columns.stride, i * BLOCK);
        let count = columns.cols.saturating_sub(first).min(BLOCK);
        Self { numbers: &columns.data[first * stride..][..count * stride], count, stride }
    }

    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    fn of_six(numbers: &'a [f64; 48]) -> Self {
        Self { numbers, count: 6, stride: 8 }
    }
}

#[inline(always)]
fn add<R: Simd4>(
    _: R::Cpu,
    from: Block<'_>,
    factors: &[f64],
    to: Block<'_>,
    x: &[f64],
    y: &mut [f64],
) {
    combine::<R>(to, &times(coefficients::<R>(from, x), factors, 1.0), y);
}

#[inline(always)]
fn remove<R: Simd4>(_: R::Cpu, columns: Block<'_>, factors: &[f64; BLOCK], x: &mut [f64]) {
    combine::<R>(columns, &times(coefficients::<R>(columns, x), factors, -1.0), x);
}

/// Products of `x` with the columns, in two registers.
#[inline(always)]
fn coefficients<R: Simd4>(block: Block<'_>, x: &[f64]) -> [R; 2] {
    let Block { numbers, count, stride } = block;
    let mut products = [R::splat(0.0); BLOCK];
    for row in (0..stride).step_by(LANES) {
        let x = R::load_partial(x.get(row..).unwrap_or(&[]));
        for j in 0..count {
            products[j] = R::load(&numbers[j * stride + row..]).mul_add(x, products[j]);
        }
    }
    let [a, b, c, d, e, f, g, h] = products;
    [R::sums([a, b, c, d]), R::sums([e, f, g, h])]
}

#[inline(always)]
fn times<R: Simd4>(along: [R; 2], factors: &[f64], sign: f64) -> [f64; BLOCK] {
    let (mut to, sign) = ([0.0; BLOCK], R::splat(sign));
    let (four, eight) = to.split_at_mut(LANES);
    (along[0] * R::load_partial(factors) * sign).store(four);
    (along[1] * R::load_partial(factors.get(LANES..).unwrap_or(&[])) * sign).store(eight);
    to
}

#[inline(always)]
fn combine<R: Simd4>(block: Block<'_>, factors: &[f64; BLOCK], y: &mut [f64]) {
    let Block { numbers, count, stride } = block;
    for row in (0..stride).step_by(LANES) {
        let y = y.get_mut(row..).unwrap_or(&mut []);
        let mut sum = R::load_partial(y);
        for j in 0..count {
            sum = R::load(&numbers[j * stride + row..]).mul_add(R::splat(factors[j]), sum);
        }
        sum.store_partial(y);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Six columns, which have a form of their own, and more than a block of them.
    #[test]
    fn blocks_are_plain_sums() {
        let mut state = 9;
        let mut next = || 2.0 * crate::scalar::uniform(&mut state) - 1.0;
        for (m, n, k) in [(6, 7, 6), (6, 6, 6), (3, 7, 3), (12, 20, 11), (6, 5, 6)] {
            let (mut from, mut to) = (AlignedColumns::zeros(m, k), AlignedColumns::zeros(n, k));
            for j in 0..k {
                from.column_mut(j).iter_mut().chain(to.column_mut(j)).for_each(|x| *x = next());
            }
            let factors: Vec<f64> = (0..k).map(|_| next()).collect();
            let (x, y): (Vec<f64>, Vec<f64>) =
                ((0..m).map(|_| next()).collect(), (0..n).map(|_| next()).collect());
            let mut got = y.clone();
            add_through(&from, &factors, &to, &x, &mut got);
            for i in 0..n {
                let along = |j| -> f64 { from.column(j).iter().zip(&x).map(|(a, b)| a * b).sum() };
                let part = |j: usize| to.column(j)[i] * factors[j] * along(j);
                let expected = y[i] + (0..k).map(part).sum::<f64>();
                assert!((got[i] - expected).abs() < 1e-14, "{} and {expected}", got[i]);
            }
        }
    }
}
