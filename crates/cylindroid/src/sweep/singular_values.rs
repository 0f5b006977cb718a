//! Singular values of many Jacobians of one shape, batched.
//!
//! Formula  sigma(D_r J_t D_c): chosen rows J_t of J, scaled rows and columns; by one-sided Jacobi
//!          rotations of R^T, from reflections of the longer side
//! Shapes   J: N x 6 x n, values: N x min(t, n), largest first; row-major
//! Units    of the scaled Jacobian
//! Valid    any rank: errors of one rounding of the largest value; values below the threshold of
//!          `Svd::machine_rank` are zero, wherever the columns are that do not count
//! Why so   one Jacobian in each lane of a register; no lane depends on the others, so a value
//!          depends neither on its place nor on the number of rows
//! Checked  tests::agree_with_single, tests::missing_ranks_are_zero, tests/sweep/parts.rs

use crate::linalg::batched::{Reflections, round_robin_pairs, singular_values, sort_descending};
use crate::linalg::rank_threshold;
use crate::scalar::{Array, SimdFloat};
#[cfg(target_arch = "x86_64")]
use crate::scalar::{Avx2, Avx512, Lanes4, Lanes8};

/// The shape and the scales.
#[derive(Debug, Clone)]
pub(super) struct SingularValues {
    /// Columns of the Jacobian.
    n: usize,
    /// Rows of the Jacobian, with their factors.
    rows: Vec<(usize, f64)>,
    /// Factors of the columns.
    columns: Vec<f64>,
    pairs: Vec<(usize, usize)>,
}

impl SingularValues {
    pub(super) fn new(rows: Vec<(usize, f64)>, columns: Vec<f64>) -> Self {
        let n = columns.len();
        let pairs = round_robin_pairs(rows.len().min(n));
        Self { n, rows, columns, pairs }
    }

    /// Number of values of a Jacobian.
    pub(super) fn len(&self) -> usize {
        self.rows.len().min(self.n)
    }

    /// The values of all Jacobians.
    pub(super) fn run(&self, jacobians: &[f64], out: &mut [f64]) {
        #[cfg(target_arch = "x86_64")]
        {
            #[allow(unsafe_code)] // the one way to call functions compiled for more
            // SAFETY: the tokens prove that the processor has these features.
            unsafe {
                if let Some(cpu) = Avx512::detect() {
                    return self.run_avx512(cpu, jacobians, out);
                }
                if let Some(cpu) = Avx2::detect() {
                    return self.run_avx2(cpu, jacobians, out);
                }
            }
        }
        self.run_with::<Array<4>>((), jacobians, out);
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx512f,avx2,fma")]
    fn run_avx512(&self, cpu: Avx512, jacobians: &[f64], out: &mut [f64]) {
        self.run_with::<Lanes8>(cpu, jacobians, out);
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma")]
    fn run_avx2(&self, cpu: Avx2, jacobians: &[f64], out: &mut [f64]) {
        self.run_with::<Lanes4>(cpu, jacobians, out);
    }

    #[inline(always)]
    fn run_with<R: SimdFloat>(&self, _: R::Cpu, jacobians: &[f64], out: &mut [f64]) {
        let (k, n, t) = (self.len(), self.n, self.rows.len());
        let size = 6 * n;
        let long = t.max(n);
        let mut columns = vec![R::splat(0.0); long * k];
        let mut triangle = vec![R::splat(0.0); k * k];
        let (mut diagonal, mut factors) = (vec![R::splat(0.0); k], vec![R::splat(0.0); k]);
        let mut values = vec![R::splat(0.0); k];
        let mut tail = vec![0.0; R::LANES * k];
        let mut entries = vec![R::splat(0.0); size];
        for (from, to) in jacobians.chunks(R::LANES * size).zip(out.chunks_mut(R::LANES * k)) {
            let count = from.len() / size;
            if count == R::LANES {
                R::gather(from, size, &mut entries);
            } else {
                // Lanes that are left over repeat the last Jacobian.
                for (c, x) in entries.iter_mut().enumerate() {
                    *x = R::from_fn(|lane| from[lane.min(count - 1) * size + c]);
                }
            }
            for (i, (row, scale)) in self.rows.iter().enumerate() {
                for (j, factor) in self.columns.iter().enumerate() {
                    // The shorter side are the columns.
                    let place = if t <= n { i * n + j } else { j * t + i };
                    columns[place] = entries[row * n + j] * R::splat(scale * factor);
                }
            }
            let mut reflections = Reflections {
                n: long,
                columns: &mut columns,
                diagonal: &mut diagonal,
                factors: &mut factors,
            };
            reflections.run();
            reflections.transposed_triangle(&mut triangle);
            singular_values(&mut triangle, k, &self.pairs, &mut values);
            sort_descending(&mut values);
            if count == R::LANES {
                R::scatter(&values, to, k);
            } else {
                R::scatter(&values, &mut tail, k);
                to.copy_from_slice(&tail[..count * k]);
            }
            to.chunks_exact_mut(k).for_each(|values| without_rounding(values, long));
        }
    }
}

/// Zero for values, largest first, that are rounding of a matrix whose longer side is `long`.
fn without_rounding(values: &mut [f64], long: usize) {
    let threshold = values.first().map_or(0.0, |largest| rank_threshold(0.0, long, *largest));
    for value in values.iter_mut().rev().take_while(|value| **value <= threshold) {
        *value = 0.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::{Matrix, Svd};
    use crate::scalar::uniform;

    #[test]
    fn agree_with_single() {
        let mut random = 5;
        for n in 1..10 {
            for rows in [vec![0, 1, 2, 3, 4, 5], vec![0, 1, 5], vec![2]] {
                let scales: Vec<f64> = rows.iter().map(|_| uniform(&mut random) + 0.5).collect();
                let factors: Vec<f64> = (0..n).map(|_| uniform(&mut random) + 0.5).collect();
                let chosen = rows.iter().copied().zip(scales.iter().copied()).collect();
                let kernel = SingularValues::new(chosen, factors.clone());
                let all: Vec<f64> = (0..7 * 6 * n).map(|_| uniform(&mut random) - 0.5).collect();
                let mut found = vec![0.0; 7 * kernel.len()];
                kernel.run(&all, &mut found);
                for (j, found) in all.chunks(6 * n).zip(found.chunks(kernel.len())) {
                    let a = Matrix::from_fn(rows.len(), n, |i, c| {
                        j[rows[i] * n + c] * scales[i] * factors[c]
                    });
                    let svd = Svd::of(&a);
                    for (x, y) in found.iter().zip(svd.values()) {
                        assert!((x - y).abs() <= 1e-14 * svd.value(0), "{n}: {x} and {y}");
                    }
                    // Alone, the same to the bit.
                    let mut alone = vec![0.0; kernel.len()];
                    kernel.run(j, &mut alone);
                    assert_eq!(alone, found);
                }
            }
        }
    }

    /// Columns of zeros and columns that depend on others, in any order.
    #[test]
    fn missing_ranks_are_zero() {
        let mut random = 11;
        for (n, rank, size) in [(7, 3, 1.0), (7, 5, 1e-9), (9, 2, 1e6), (6, 4, 1.0), (4, 1, 1.0)] {
            for place in 0..n {
                let own: Vec<f64> = (0..6 * rank).map(|_| uniform(&mut random) - 0.5).collect();
                // The last of the columns twice, the others at places that go round.
                let column = |j: usize| match (j + n - place) % n {
                    c if c < rank => Some(c),
                    c if c == rank => Some(rank - 1),
                    _ => None,
                };
                let j: Vec<f64> = (0..6 * n)
                    .map(|e| column(e % n).map_or(0.0, |c| size * own[6 * c + e / n]))
                    .collect();
                let kernel =
                    SingularValues::new((0..6).map(|row| (row, 1.0)).collect(), vec![1.0; n]);
                let mut found = vec![0.0; kernel.len()];
                kernel.run(&j, &mut found);
                assert!(found[..rank].iter().all(|x| *x > 1e-4 * size), "{found:?}");
                assert!(found[rank..].iter().all(|x| *x == 0.0), "{found:?}");
            }
        }
    }
}
