//! Random problems for the solver, and those that a fuzzer makes.
//!
//! Checked  src/control/solver/hierarchy/tests.rs::levels_are_the_optima_of_clarabel

use super::super::active_set::ActiveSet;
use super::super::inequalities::Inequalities;
use crate::linalg::Matrix;
use crate::scalar::uniform;

/// Numbers of the bytes that are given, then of a fixed sequence.
pub(super) struct Random<'b> {
    state: u64,
    bytes: &'b [u8],
    /// Signed numbers are eighths: ranks of matrices of such are clear.
    is_coarse: bool,
}

impl<'b> Random<'b> {
    #[cfg(test)]
    pub(super) fn seeded(state: u64) -> Self {
        Self { state, bytes: &[], is_coarse: false }
    }

    pub(super) fn of_bytes(bytes: &'b [u8]) -> Self {
        Self { state: 0, bytes, is_coarse: false }
    }

    pub(super) fn coarse_of_bytes(bytes: &'b [u8]) -> Self {
        Self { state: 0, bytes, is_coarse: true }
    }

    pub(super) fn unit(&mut self) -> f64 {
        match self.bytes.split_first_chunk() {
            Some((two, rest)) => {
                self.bytes = rest;
                f64::from(u16::from_le_bytes(*two)) / 65536.0
            }
            None => uniform(&mut self.state),
        }
    }

    pub(super) fn signed(&mut self) -> f64 {
        let fine = 2.0 * self.unit() - 1.0;
        if self.is_coarse { (8.0 * fine).round() / 8.0 } else { fine }
    }

    pub(super) fn below(&mut self, n: usize) -> usize {
        match self.bytes.split_first() {
            Some((one, rest)) => {
                self.bytes = rest;
                usize::from(*one) % n
            }
            None => ((self.unit() * n as f64) as usize).min(n - 1),
        }
    }
}

/// A problem: inequalities as dense rows with bounds, and levels.
#[derive(Debug, Clone)]
pub(super) struct Problem {
    pub(super) n: usize,
    pub(super) boxed: bool,
    pub(super) rows: Vec<Vec<f64>>,
    pub(super) lower: Vec<f64>,
    pub(super) upper: Vec<f64>,
    pub(super) levels: Vec<(Matrix, Vec<f64>)>,
}

impl Problem {
    /// Of any shape: rank-deficient, over- and underdetermined levels, repeated rows, bounds that
    /// are equal, tiny, infinite or far away.
    pub(super) fn random(random: &mut Random<'_>) -> Self {
        let n = 1 + random.below(9);
        let boxed = random.below(4) > 0;
        let more = random.below(if boxed { 4 } else { 10 });
        let mut rows: Vec<Vec<f64>> = Vec::new();
        if boxed {
            rows.extend((0..n).map(|i| (0..n).map(|j| f64::from(u8::from(i == j))).collect()));
        }
        for _ in 0..more {
            let row = match random.below(6) {
                0 if !rows.is_empty() => rows[random.below(rows.len())].clone(),
                1 => (0..n).map(|_| f64::from(random.below(3) as u32) - 1.0).collect(),
                _ => (0..n).map(|_| random.signed()).collect(),
            };
            rows.push(row);
        }
        // Feasible by construction, in the middle or at the border.
        let inside: Vec<f64> = (0..n).map(|_| 0.3 * random.signed()).collect();
        let (mut lower, mut upper) = (Vec::new(), Vec::new());
        for row in &rows {
            let value: f64 = row.iter().zip(&inside).map(|(a, b)| a * b).sum();
            let mut room = || match random.below(8) {
                0 => f64::INFINITY,
                1 => 0.0,
                2 => 1e-6 * random.unit(),
                3 => 100.0,
                _ => random.unit(),
            };
            let (below, above) = (room(), room());
            lower.push(value - below);
            upper.push(value + above);
        }
        let levels = (0..1 + random.below(3))
            .map(|_| {
                let m = 1 + random.below(7);
                let a = match random.below(4) {
                    0 => {
                        let rank = 1 + random.below(m.min(n));
                        let [b, c] = [(m, rank), (rank, n)]
                            .map(|(r, c)| Matrix::from_fn(r, c, |_, _| random.signed()));
                        &b * &c
                    }
                    1 => Matrix::from_fn(m, n, |_, _| f64::from(random.below(3) as u32) - 1.0),
                    _ => Matrix::from_fn(m, n, |_, _| random.signed()),
                };
                (a, (0..m).map(|_| 3.0 * random.signed()).collect())
            })
            .collect();
        Self { n, boxed, rows, lower, upper, levels }
    }

    /// The same problem with its rows in the opposite order, each in another unit.
    #[cfg(test)]
    pub(super) fn reverse_and_scale(&mut self) {
        let first = if self.boxed { self.n } else { 0 };
        self.rows[first..].reverse();
        self.lower[first..].reverse();
        self.upper[first..].reverse();
        for i in first..self.rows.len() {
            let unit = [0.125, 1.0, 32.0][i % 3];
            self.rows[i].iter_mut().for_each(|x| *x *= unit);
            self.lower[i] *= unit;
            self.upper[i] *= unit;
        }
        for (a, b) in &mut self.levels {
            let (m, old) = (a.rows(), a.clone());
            *a = Matrix::from_fn(m, self.n, |i, j| old[(m - 1 - i, j)]);
            b.reverse();
        }
    }

    pub(super) fn active_set(&self) -> ActiveSet {
        let first = if self.boxed { self.n } else { 0 };
        let mut inequalities = Inequalities::new(self.n, self.boxed, self.rows.len() - first);
        for (place, row) in self.rows[first..].iter().enumerate() {
            inequalities.set_row(place, |j| row[j]);
        }
        inequalities.lower.copy_from_slice(&self.lower);
        inequalities.upper.copy_from_slice(&self.upper);
        ActiveSet::new(self.n, inequalities)
    }
}
