//! Linear algebra, inverses, distances of shapes: matrices and shapes of every kind, written down.

mod chains;
mod inverses;
mod matrices;
mod models;
mod shapes;

use cylindroid::Matrix;

use crate::record::Record;
use crate::robots::Random;

/// A sum in which each number has its own weight.
fn sum(numbers: &[f64]) -> f64 {
    numbers.iter().enumerate().map(|(i, x)| x / (i as f64 + 1.3)).sum()
}

/// Numbers of any unit: their sizes and their shares of these, summed up apart.
#[derive(Debug, Default)]
struct Sums {
    sizes: Vec<f64>,
    numbers: Vec<f64>,
}

impl Sums {
    /// A number near one.
    fn number(&mut self, x: f64) {
        self.numbers.push(x);
    }

    /// A rank or another small count: the parts of the numbers are seen beside it.
    fn count(&mut self, n: usize) {
        self.numbers.push(0.01 * n as f64);
    }

    /// A number of any size.
    fn size(&mut self, x: f64) {
        if x.is_finite() && x != 0.0 {
            self.sizes.push(x.abs().log10());
            self.numbers.push(x.signum());
        } else {
            // Odd numbers for zero, NaN and infinity.
            let others = [(x == 0.0, 1.9), (x.is_nan(), 3.3), (x > 0.0, 5.7), (x < 0.0, 9.1)];
            self.numbers.extend(others.iter().find(|o| o.0).map(|o| o.1));
        }
    }

    /// Numbers of one size.
    fn scaled(&mut self, numbers: &[f64]) {
        let size = numbers.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let all_finite = numbers.iter().all(|x| x.is_finite());
        self.size(if all_finite { size } else { f64::NAN });
        if all_finite && size > 0.0 {
            self.number(sum(&numbers.iter().map(|x| x / size).collect::<Vec<_>>()));
        }
    }

    fn write(self, record: &mut Record) {
        if !self.sizes.is_empty() {
            record.number(sum(&self.sizes));
        }
        record.number(sum(&self.numbers));
    }
}

/// True if the columns are orthonormal to rounding.
fn is_orthonormal(a: &Matrix) -> bool {
    (&a.transpose() * a).max_difference(&Matrix::identity(a.cols())) < 1e-13
}

/// Numbers from -1 to 1.
fn plain(random: &mut Random<'_>, m: usize, n: usize) -> Matrix {
    Matrix::from_fn(m, n, |_, _| random.within(-1.0, 1.0))
}

fn vector(random: &mut Random<'_>, n: usize) -> Vec<f64> {
    (0..n).map(|_| random.within(-1.0, 1.0)).collect()
}

fn times(a: &Matrix, f: impl Fn(usize, usize) -> f64) -> Matrix {
    Matrix::from_fn(a.rows(), a.cols(), |i, j| a[(i, j)] * f(i, j))
}

/// Small whole numbers of rank r at most.
fn whole(random: &mut Random<'_>, m: usize, n: usize, r: usize) -> Matrix {
    let mut one = |m, n| Matrix::from_fn(m, n, |_, _| random.below(5) as f64 - 2.0);
    &one(m, r) * &one(r, n)
}

/// The kinds of [`any`].
const KINDS: usize = 14;

/// A matrix of the k-th kind: regular, of low rank, graded, tiny, huge, sparse, orthogonal, ...
fn any(random: &mut Random<'_>, kind: usize, m: usize, n: usize) -> Matrix {
    let rank = 1 + random.below(m.min(n).max(1));
    let a = plain(random, m, n);
    match kind {
        0 => whole(random, m, n, rank),
        1 => {
            let size = random.within(0.5, 2.0);
            times(&whole(random, m, n, rank), |_, _| size)
        }
        2 => &plain(random, m, rank) * &plain(random, rank, n),
        3 => times(&a, |_, j| 10_f64.powi(-2 * j as i32)),
        4 => times(&a, |i, _| 10_f64.powi(-(i as i32))),
        5 => {
            let size = random.power(-150.0, 150.0);
            times(&a, |_, _| size)
        }
        6 => Matrix::from_fn(m, n, |i, j| a[(i, 0)] + 1e-6 * a[(i, j)]),
        7 => Matrix::from_fn(m, n, |i, j| if (i + j) % 3 == 0 { a[(i, j)] } else { 0.0 }),
        8 => Matrix::from_fn(m, n, |i, j| if i == j { 2.0 - (i % 3) as f64 } else { 0.0 }),
        9 => times(&a, |_, j| f64::from(u8::from(j % 3 != 1))),
        10 => Matrix::from_fn(m, n, |i, j| a[(i, j % 2)]),
        11 => Matrix::from_fn(m, n, |i, j| if i / 3 == j / 3 { a[(i, j)] } else { 0.0 }),
        12 => Matrix::from_fn(m, n, |i, j| if i == j || i + 1 == j { a[(i, j)] } else { 0.0 }),
        _ => a,
    }
}
