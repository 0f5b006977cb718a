//! Products of small matrices (GEMM) on aligned columns, which are padded with zeros to a multiple
//! of four numbers: loops without remainder, four numbers in a register.
//!
//! Shapes   B: long x k, square matrices k x k; strides are lengths of columns in memory
//! Why so   written once over [`Simd4`], to be inlined where the processor is known
//! Checked  src/linalg/jacobi.rs, tests/it/svd.rs

use super::matrix::Matrix;
use crate::scalar::Simd4;

pub(super) const LANES: usize = 4;

/// Number of columns; lengths of the columns of B and of square matrices in memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Size {
    pub(super) k: usize,
    pub(super) long: usize,
    pub(super) short: usize,
}

/// Columns padded with zeros.
#[derive(Debug, Clone)]
pub(super) struct AlignedColumns {
    rows: usize,
    pub(super) cols: usize,
    pub(super) stride: usize,
    pub(super) data: Vec<f64>,
}

impl AlignedColumns {
    pub(super) fn zeros(rows: usize, cols: usize) -> Self {
        let stride = rows.next_multiple_of(LANES);
        Self { rows, cols, stride, data: vec![0.0; stride * cols] }
    }

    /// Zeros of another shape, which allocates only for more of them than ever before.
    pub(super) fn reshape(&mut self, rows: usize, cols: usize) {
        (self.rows, self.cols, self.stride) = (rows, cols, rows.next_multiple_of(LANES));
        self.data.clear();
        self.data.resize(self.stride * cols, 0.0);
    }

    pub(super) fn fill(&mut self, x: f64) {
        self.data.fill(x);
    }

    /// Exchanges columns i < j.
    pub(super) fn swap(&mut self, i: usize, j: usize) {
        let (a, b) = pair(&mut self.data, self.stride, i, j);
        a.swap_with_slice(b);
    }

    #[inline]
    pub(super) fn column(&self, j: usize) -> &[f64] {
        &self.data[j * self.stride..j * self.stride + self.rows]
    }

    #[inline]
    pub(super) fn column_mut(&mut self, j: usize) -> &mut [f64] {
        &mut self.data[j * self.stride..j * self.stride + self.rows]
    }
}

#[inline(always)]
pub(super) fn padded(columns: &[f64], stride: usize, j: usize) -> &[f64] {
    &columns[j * stride..][..stride]
}

/// Two padded columns, i < j.
#[inline(always)]
pub(super) fn pair(
    columns: &mut [f64],
    stride: usize,
    i: usize,
    j: usize,
) -> (&mut [f64], &mut [f64]) {
    let (head, tail) = columns.split_at_mut(j * stride);
    (&mut head[i * stride..][..stride], &mut tail[..stride])
}

/// Four entries of column j of the identity, from row `first` on.
#[inline(always)]
pub(super) fn unit<R: Simd4>(first: usize, j: usize) -> R {
    R::from_fn(|l| if first + l == j { 1.0 } else { 0.0 })
}

/// Four rows from `i` on of four columns from `j` on, in M^T; zeros beyond the k columns.
#[inline(always)]
pub(super) fn transposed_block<R: Simd4>(m: &[f64], i: usize, j: usize, size: Size) -> [R; LANES] {
    R::transposed([
        four_of(m, j, i, size),
        four_of(m, j, i + 1, size),
        four_of(m, j, i + 2, size),
        four_of(m, j, i + 3, size),
    ])
}

/// Four rows from `first` on of column j.
#[inline(always)]
fn four_of<R: Simd4>(m: &[f64], first: usize, j: usize, size: Size) -> R {
    if j < size.k { R::load(&m[j * size.short + first..]) } else { R::splat(0.0) }
}

/// `b = A^T`, A of k rows.
#[inline(always)]
pub(super) fn load_transposed<R: Simd4>(a: &Matrix, b: &mut [f64], stride: usize, size: Size) {
    let (k, b) = (size.k, &mut b[..size.k * stride]);
    for first in (0..stride).step_by(LANES) {
        for i in (0..k).step_by(LANES) {
            let columns = R::transposed([
                four_rows(a, k, i, first),
                four_rows(a, k, i, first + 1),
                four_rows(a, k, i, first + 2),
                four_rows(a, k, i, first + 3),
            ]);
            for (l, column) in columns.into_iter().enumerate() {
                if i + l < k {
                    column.store(&mut b[(i + l) * stride + first..]);
                }
            }
        }
    }
}

/// Four numbers from row i of column j on, the last ones any; zero beyond the columns.
#[inline(always)]
fn four_rows<R: Simd4>(a: &Matrix, rows: usize, i: usize, j: usize) -> R {
    let numbers = a.as_slice();
    let at = j * rows + i;
    match numbers.get(at..at + LANES) {
        Some(four) => R::load(four),
        None => R::from_fn(|l| numbers.get(at + l).copied().unwrap_or(0.0)),
    }
}

#[inline(always)]
pub(super) fn scale<R: Simd4>(m: &mut [f64], factor: f64) {
    for four in m.as_chunks_mut::<LANES>().0 {
        (R::load(four) * R::splat(factor)).store(four);
    }
}

/// `to = to + factor from + diagonal`, square
#[inline(always)]
pub(super) fn add<R: Simd4>(to: &mut [f64], factor: f64, from: &[f64], diagonal: f64, size: Size) {
    let Size { k, short, .. } = size;
    let (to, from) = (&mut to[..k * short], &from[..k * short]);
    for j in 0..k {
        for first in (0..short).step_by(LANES) {
            let (x, y) = (R::load(&to[j * short + first..]), R::load(&from[j * short + first..]));
            let sum = y.mul_add(R::splat(factor), x);
            unit::<R>(first, j)
                .mul_add(R::splat(diagonal), sum)
                .store(&mut to[j * short + first..]);
        }
    }
}

/// Columns of which four rows stay in registers, and of which eight do.
const MAX_COLUMNS_OF_FOUR_ROWS: usize = 8;
const MAX_COLUMNS_OF_EIGHT_ROWS: usize = 6;

/// `to = from m`, m square; `row` holds four rows.
#[inline(always)]
pub(super) fn product<R: Simd4>(
    from: &[f64],
    stride: usize,
    m: &[f64],
    to: &mut [f64],
    size: Size,
    row: &mut [f64],
) {
    let k = size.k;
    if k > MAX_COLUMNS_OF_FOUR_ROWS {
        to[..k * stride].copy_from_slice(&from[..k * stride]);
        times::<R>(to, stride, m, size, row);
        return;
    }
    let (from, to, m) = (&from[..k * stride], &mut to[..k * stride], &m[..k * size.short]);
    let mut first = 0;
    while k <= MAX_COLUMNS_OF_EIGHT_ROWS && first + 2 * LANES <= stride {
        let rows: [[R; 2]; MAX_COLUMNS_OF_EIGHT_ROWS] = rows_of(from, stride, first, k);
        rows_times(&rows, m, to, stride, first, size);
        first += 2 * LANES;
    }
    while first < stride {
        let rows: [[R; 1]; MAX_COLUMNS_OF_FOUR_ROWS] = rows_of(from, stride, first, k);
        rows_times(&rows, m, to, stride, first, size);
        first += LANES;
    }
}

/// `a = a m`, m square; `row` holds four rows.
#[inline(always)]
pub(super) fn times<R: Simd4>(
    a: &mut [f64],
    stride: usize,
    m: &[f64],
    size: Size,
    row: &mut [f64],
) {
    let k = size.k;
    let (a, m) = (&mut a[..k * stride], &m[..k * size.short]);
    let mut first = 0;
    while k <= MAX_COLUMNS_OF_EIGHT_ROWS && first + 2 * LANES <= stride {
        let rows: [[R; 2]; MAX_COLUMNS_OF_EIGHT_ROWS] = rows_of(a, stride, first, k);
        rows_times(&rows, m, a, stride, first, size);
        first += 2 * LANES;
    }
    while k <= MAX_COLUMNS_OF_FOUR_ROWS && first < stride {
        let rows: [[R; 1]; MAX_COLUMNS_OF_FOUR_ROWS] = rows_of(a, stride, first, k);
        rows_times(&rows, m, a, stride, first, size);
        first += LANES;
    }
    while first < stride {
        for l in 0..k {
            row[l * LANES..][..LANES].copy_from_slice(&a[l * stride + first..][..LANES]);
        }
        for j in 0..k {
            let mut sum = R::splat(0.0);
            for (l, x) in padded(m, size.short, j)[..k].iter().enumerate() {
                sum = R::load(&row[l * LANES..]).mul_add(R::splat(*x), sum);
            }
            sum.store(&mut a[j * stride + first..]);
        }
        first += LANES;
    }
}

/// The rows from `first` on, four for each of C registers, of at most K columns.
#[inline(always)]
fn rows_of<R: Simd4, const C: usize, const K: usize>(
    a: &[f64],
    stride: usize,
    first: usize,
    k: usize,
) -> [[R; C]; K] {
    let mut rows = [[R::splat(0.0); C]; K];
    for l in 0..k {
        for c in 0..C {
            rows[l][c] = R::load(&a[l * stride + first + c * LANES..]);
        }
    }
    rows
}

/// These rows of a times m, into `to`.
#[inline(always)]
fn rows_times<R: Simd4, const C: usize, const K: usize>(
    rows: &[[R; C]; K],
    m: &[f64],
    to: &mut [f64],
    stride: usize,
    first: usize,
    size: Size,
) {
    for j in 0..size.k {
        let m = padded(m, size.short, j);
        let mut sums = [R::splat(0.0); C];
        for l in 0..size.k {
            let factor = R::splat(m[l]);
            for c in 0..C {
                sums[c] = rows[l][c].mul_add(factor, sums[c]);
            }
        }
        for c in 0..C {
            sums[c].store(&mut to[j * stride + first + c * LANES..]);
        }
    }
}

/// `products = B^T B`
#[inline(always)]
pub(super) fn gram<R: Simd4>(b: &[f64], stride: usize, products: &mut [f64], size: Size) {
    let Size { k, short, .. } = size;
    let (b, products) = (&b[..k * stride], &mut products[..k * short]);
    for j in 0..k {
        for i in (0..short).step_by(LANES) {
            let sums = R::sums([
                lanes_of_dot(b, stride, i, j, k),
                lanes_of_dot(b, stride, i + 1, j, k),
                lanes_of_dot(b, stride, i + 2, j, k),
                lanes_of_dot(b, stride, i + 3, j, k),
            ]);
            sums.store(&mut products[j * short + i..]);
        }
    }
}

/// Squares of the lengths of the columns; `to` is padded.
#[inline(always)]
pub(super) fn squares<R: Simd4>(b: &[f64], stride: usize, to: &mut [f64], size: Size) {
    let Size { k, short, .. } = size;
    let (b, to) = (&b[..k * stride], &mut to[..short]);
    for j in (0..short).step_by(LANES) {
        let sums = R::sums([
            lanes_of_dot(b, stride, j, j, k),
            lanes_of_dot(b, stride, j + 1, j + 1, k),
            lanes_of_dot(b, stride, j + 2, j + 2, k),
            lanes_of_dot(b, stride, j + 3, j + 3, k),
        ]);
        sums.store(&mut to[j..]);
    }
}

/// Products of columns i and j whose sum is theirs; zeros beyond the k columns.
#[inline(always)]
fn lanes_of_dot<R: Simd4>(b: &[f64], stride: usize, i: usize, j: usize, k: usize) -> R {
    if i < k { lanes::<R>(padded(b, stride, i), padded(b, stride, j)) } else { R::splat(0.0) }
}

/// Products of padded columns whose sum is theirs.
#[inline(always)]
pub(super) fn lanes<R: Simd4>(a: &[f64], b: &[f64]) -> R {
    let mut sum = R::splat(0.0);
    for (x, y) in a.as_chunks::<LANES>().0.iter().zip(b.as_chunks::<LANES>().0) {
        sum = R::load(x).mul_add(R::load(y), sum);
    }
    sum
}

/// Scalar product of padded columns.
#[inline(always)]
pub(super) fn dot<R: Simd4>(a: &[f64], b: &[f64]) -> f64 {
    lanes::<R>(a, b).sum()
}

#[inline(always)]
pub(super) fn rotate<R: Simd4>(a: &mut [f64], b: &mut [f64], c: f64, s: f64) {
    let (c, s) = (R::splat(c), R::splat(s));
    let (a, b) = (a.as_chunks_mut::<LANES>().0, b.as_chunks_mut::<LANES>().0);
    for (x, y) in a.iter_mut().zip(b) {
        let (p, q) = (R::load(x), R::load(y));
        (-s).mul_add(q, c * p).store(x);
        s.mul_add(p, c * q).store(y);
    }
}

/// One Newton step to the nearest orthogonal matrix, W (3 - W^T W) / 2.
#[inline(always)]
pub(super) fn newton<R: Simd4>(w: &mut [f64], products: &mut [f64], size: Size, row: &mut [f64]) {
    let Size { k, short, .. } = size;
    gram::<R>(w, short, products, size);
    for j in 0..k {
        for first in (0..short).step_by(LANES) {
            let four = &mut products[j * short + first..][..LANES];
            (unit::<R>(first, j) * R::splat(1.5) - R::load(four) * R::splat(0.5)).store(four);
        }
    }
    times::<R>(w, short, products, size, row);
}
