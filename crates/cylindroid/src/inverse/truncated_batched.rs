//! Truncated pseudoinverses of many Jacobians, batched: of those in which nothing is truncated.
//!
//! Formula  J^T = Q R: J^+ = Q R^-T, of a tall J its transpose; the singular values are those of
//!          R^T
//! Shapes   J: N x m x n, inverses: N x n x m, singular values: N x min(m, n); all row-major
//! Units    those of the Jacobians
//! Valid    singular values well above the threshold and above [`WEAK`] of the largest: all others
//!          are left to the single inverse. There inverse and values have errors of some roundings
//!          times the condition number, as those of the single inverse
//! Why so   one Jacobian in each lane of a register, and no singular vectors: where nothing is
//!          truncated, a triangular system is the inverse. One-sided Jacobi on R^T needs fewer
//!          sweeps than on J, for its columns are nearer to orthogonal. No lane depends on the
//!          others, so a result depends neither on its place nor on the number of Jacobians
//! Source   Drmač & Veselić 2008, New fast and accurate Jacobi SVD algorithm I, on R^T
//! Checked  tests/it/inverse_batch.rs, tests/it/simd.rs

use crate::linalg::batched::{Reflections, round_robin_pairs, singular_values, sort_descending};
use crate::linalg::{Rank, rank_threshold};
use crate::scalar::{Array, SimdFloat};
#[cfg(target_arch = "x86_64")]
use crate::scalar::{Avx2, Avx512, Lanes4, Lanes8};

/// The smallest singular value over the largest below which reflections lose digits that rotations
/// keep.
const WEAK: f64 = 1e-6;

/// A smallest singular value nearer to the threshold than this factor decides a rank by rounding.
const MARGIN: f64 = 1.0 + 1e-8;

/// The fourth powers of largest singular values outside this range overflow or lose digits.
const POWERS: [f64; 2] = [1e-60, 1e60];

/// Jacobians of one shape and the threshold.
#[derive(Debug)]
pub(super) struct Kernel {
    rows: usize,
    cols: usize,
    eps: f64,
    pairs: Vec<(usize, usize)>,
}

/// Jacobians in, the others out.
#[derive(Debug)]
pub(super) struct Work<'a> {
    pub(super) jacobians: &'a [f64],
    pub(super) matrices: &'a mut [f64],
    pub(super) values: &'a mut [f64],
    pub(super) ranks: &'a mut [Rank],
}

impl Kernel {
    pub(super) fn new(rows: usize, cols: usize, eps: f64) -> Self {
        Self { rows, cols, eps, pairs: round_robin_pairs(rows.min(cols)) }
    }

    /// Inverts, and marks in `done` where: results elsewhere are invalid.
    pub(super) fn run(&self, work: Work<'_>, done: &mut [bool]) {
        #[cfg(target_arch = "x86_64")]
        {
            #[allow(unsafe_code)] // the one way to call functions compiled for more
            // SAFETY: the tokens prove that the processor has these features.
            unsafe {
                if let Some(cpu) = Avx512::detect() {
                    return self.run_avx512(cpu, work, done);
                }
                if let Some(cpu) = Avx2::detect() {
                    return self.run_avx2(cpu, work, done);
                }
            }
        }
        self.run_with::<Array<4>>((), work, done);
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx512f,avx2,fma")]
    fn run_avx512(&self, cpu: Avx512, work: Work<'_>, done: &mut [bool]) {
        self.run_with::<Lanes8>(cpu, work, done);
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma")]
    fn run_avx2(&self, cpu: Avx2, work: Work<'_>, done: &mut [bool]) {
        self.run_with::<Lanes4>(cpu, work, done);
    }

    #[inline(always)]
    fn run_with<R: SimdFloat>(&self, cpu: R::Cpu, work: Work<'_>, done: &mut [bool]) {
        // Once more for the Jacobians of arms, whose loops are then known.
        match (self.rows, self.cols) {
            (6, 7) => self.of_shape::<R>(cpu, (6, 7), work, done),
            (6, 6) => self.of_shape::<R>(cpu, (6, 6), work, done),
            shape => self.of_shape::<R>(cpu, shape, work, done),
        }
    }

    #[inline(always)]
    fn of_shape<R: SimdFloat>(
        &self,
        _: R::Cpu,
        (rows, cols): (usize, usize),
        work: Work<'_>,
        done: &mut [bool],
    ) {
        let (k, long, size) = (rows.min(cols), rows.max(cols), rows * cols);
        let mut scratch = Scratch::<R>::new(k, long);
        let mut numbers = vec![0.0; R::LANES * (size + k)];
        let inputs = work.jacobians.chunks(R::LANES * size);
        let outputs = work.matrices.chunks_mut(R::LANES * size);
        let values = work.values.chunks_mut(R::LANES * k);
        let reports = work.ranks.chunks_mut(R::LANES).zip(done.chunks_mut(R::LANES));
        for (((from, to), values), (ranks, done)) in inputs.zip(outputs).zip(values).zip(reports) {
            let count = ranks.len();
            let (rest, rest_values) = numbers.split_at_mut(R::LANES * size);
            if count == R::LANES {
                R::gather(from, size, &mut scratch.entries);
            } else {
                // Lanes that are left over repeat the last Jacobian.
                for (c, x) in scratch.entries.iter_mut().enumerate() {
                    *x = R::from_fn(|lane| from[lane.min(count - 1) * size + c]);
                }
            }
            scratch.invert(rows, cols, &self.pairs);
            if count == R::LANES {
                R::scatter(&scratch.entries, to, size);
                R::scatter(&scratch.values, values, k);
            } else {
                R::scatter(&scratch.entries, rest, size);
                R::scatter(&scratch.values, rest_values, k);
                to.copy_from_slice(&rest[..count * size]);
                values.copy_from_slice(&rest_values[..count * k]);
            }
            for ((values, rank), done) in values.chunks_exact(k).zip(ranks).zip(done) {
                let (largest, smallest) = (values[0], values[k - 1]);
                let threshold = rank_threshold(self.eps, long, largest);
                *done = largest > POWERS[0]
                    && largest < POWERS[1]
                    && smallest > MARGIN * threshold
                    && smallest > WEAK * largest;
                *rank = Rank { rank: k, threshold, gap: f64::INFINITY };
            }
        }
    }
}

/// Memory of one thread.
#[derive(Debug)]
struct Scratch<R> {
    /// The Jacobians, later their inverses, row-major.
    entries: Vec<R>,
    /// J^T, or J of a tall one, and what its QR decomposition leaves; columns.
    columns: Vec<R>,
    diagonal: Vec<R>,
    factors: Vec<R>,
    /// Q, later Q R^-T; columns.
    basis: Vec<R>,
    /// R^T; columns.
    triangle: Vec<R>,
    values: Vec<R>,
}

impl<R: SimdFloat> Scratch<R> {
    fn new(k: usize, long: usize) -> Self {
        let zeros = |n: usize| vec![R::splat(0.0); n];
        Self {
            entries: zeros(long * k),
            columns: zeros(long * k),
            diagonal: zeros(k),
            factors: zeros(k),
            basis: zeros(long * k),
            triangle: zeros(k * k),
            values: zeros(k),
        }
    }

    #[inline(always)]
    fn invert(&mut self, rows: usize, cols: usize, pairs: &[(usize, usize)]) {
        let (k, long) = (rows.min(cols), rows.max(cols));
        if rows <= cols {
            self.columns.copy_from_slice(&self.entries);
        } else {
            transpose(&self.entries, cols, &mut self.columns);
        }
        let mut reflections = Reflections {
            n: long,
            columns: &mut self.columns,
            diagonal: &mut self.diagonal,
            factors: &mut self.factors,
        };
        reflections.run();
        reflections.leading_columns(&mut self.basis);
        reflections.divide_by_transpose(&mut self.basis);
        reflections.transposed_triangle(&mut self.triangle);
        singular_values(&mut self.triangle, k, pairs, &mut self.values);
        sort_descending(&mut self.values);
        if rows <= cols {
            transpose(&self.basis, cols, &mut self.entries);
        } else {
            self.entries.copy_from_slice(&self.basis);
        }
    }
}

/// Rows of `length` numbers to columns.
#[inline(always)]
fn transpose<R: SimdFloat>(rows: &[R], length: usize, columns: &mut [R]) {
    let count = rows.len() / length;
    for (i, row) in rows.chunks_exact(length).enumerate() {
        for (j, x) in row.iter().enumerate() {
            columns[j * count + i] = *x;
        }
    }
}
