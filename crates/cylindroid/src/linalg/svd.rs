//! Singular value decomposition by one-sided Jacobi rotations, warm-startable.
//!
//! Formula  A = U diag(s) V^T, s descending and not negative
//! Shapes   A: m x n, U: m x k, V: n x k with k = min(m, n)
//! Method   rotate the columns of B (= A when A is tall, else A^T) in pairs from the right until
//!          all are orthogonal: B W = Q diag(s). W is always complete: for a Jacobian with
//!          m <= n it is U, so that lost task directions are known also where s is exactly zero.
//!          A column of Q whose singular value is exactly zero is zero: A does not determine it.
//! Valid    any finite A; a singular value that no number holds is given as the largest number
//! Warm     `decompose_warm` starts from the W of the last call; for a slowly changing Jacobian
//!          one or two sweeps remain. The result is exact either way.
//! Why so   high relative accuracy also of small singular values, no failure on rank-deficient
//!          input (the bidiagonal method of a well-known crate returns wrong values there), no
//!          allocation, and 6 x n is where it is fastest. The alternative, a general library
//!          SVD, took 2.4 to 4.1 us for 6 x 7.
//! Source   Hestenes 1958; de Rijk 1989 (ordering); Maciejewski & Klein 1989 (warm start)
//! Checked  tests/it/svd.rs

use super::matrix::Matrix;
use crate::tolerance::{JACOBI_ORTHOGONAL, MACHINE_RANK};

/// More sweeps than any matrix needs (ten or fewer in practice): the bound that makes the cost finite.
const MAX_SWEEPS: usize = 40;

/// Warm starts between two repairs of W, whose columns drift by a rounding each time.
const WARM_STARTS: usize = 8;

/// A singular value decomposition and the memory to compute the next one without allocation.
#[derive(Debug, Clone)]
pub struct Svd {
    rows: usize,
    cols: usize,
    /// B W, columns of length max(m, n), later Q.
    b: PaddedColumns,
    /// The accumulated rotations, k x k.
    w: PaddedColumns,
    scratch: Vec<f64>,
    /// The order of a sweep.
    pairs: Vec<(usize, usize)>,
    sigma: Vec<f64>,
    order: Vec<usize>,
    /// Warm starts that are left before W is repaired; `None` before the first decomposition.
    warm: Option<usize>,
    sweeps: usize,
}

/// A rank and how sure it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rank {
    /// Number of singular values above the threshold.
    pub rank: usize,
    /// The absolute threshold used, in the unit of the singular values.
    pub threshold: f64,
    /// Smallest singular value kept over largest one dropped: infinite when nothing was dropped
    /// or what was dropped is exactly zero; a gap near 1 means that the rank is a matter of taste.
    pub gap: f64,
}

impl Svd {
    /// Memory for decompositions of `m x n` matrices; holds the decomposition of zero.
    #[must_use]
    pub fn workspace(m: usize, n: usize) -> Self {
        let (k, long) = (m.min(n), m.max(n));
        Self {
            rows: m,
            cols: n,
            b: PaddedColumns::zeros(long, k),
            w: PaddedColumns::zeros(k, k),
            scratch: vec![0.0; k * k],
            pairs: tournament(k),
            sigma: vec![0.0; k],
            order: (0..k).collect(),
            warm: None,
            sweeps: 0,
        }
    }

    /// The decomposition of `a`.
    #[must_use]
    pub fn of(a: &Matrix) -> Self {
        let mut svd = Self::workspace(a.rows(), a.cols());
        svd.decompose(a);
        svd
    }

    /// Decomposes `a` from nothing. Non-finite entries give NaN singular values.
    ///
    /// # Panics
    /// If `a` has not the shape of the workspace.
    pub fn decompose(&mut self, a: &Matrix) {
        self.warm = None;
        self.decompose_warm(a);
    }

    /// Decomposes `a`, starting from the rotations of the last call.
    ///
    /// # Panics
    /// If `a` has not the shape of the workspace.
    pub fn decompose_warm(&mut self, a: &Matrix) {
        assert_eq!((a.rows(), a.cols()), (self.rows, self.cols), "shape of the SVD workspace");
        let k = self.sigma.len();
        let largest = a.max_abs();
        if largest == 0.0 || !largest.is_finite() {
            self.sigma.fill(if largest == 0.0 { 0.0 } else { f64::NAN });
            self.b.data.fill(0.0);
            self.reset_rotations();
            self.order.iter_mut().enumerate().for_each(|(i, o)| *o = i);
            self.warm = None;
            return;
        }
        // Scaled by a power of two, which is exact, so that squares neither overflow nor vanish.
        let scale = power_of_two_below(largest);
        match self.warm {
            Some(left) => {
                if left == 0 {
                    self.reorthonormalise();
                }
                self.warm = Some(left.checked_sub(1).unwrap_or(WARM_STARTS));
                self.load_times_w(a, 1.0 / scale);
            }
            None => {
                self.warm = Some(WARM_STARTS);
                self.reset_rotations();
                self.load(a, 1.0 / scale);
            }
        }
        self.sweeps = 0;
        while self.sweeps < MAX_SWEEPS {
            self.sweeps += 1;
            if !self.sweep() {
                break;
            }
        }
        for j in 0..k {
            self.sigma[j] = dot(self.b.padded(j), self.b.padded(j)).sqrt();
        }
        self.order.sort_unstable_by(|&i, &j| {
            self.sigma[j].total_cmp(&self.sigma[i]).then_with(|| i.cmp(&j))
        });
        for j in 0..k {
            let s = self.sigma[j];
            let inverse = if s > 0.0 { 1.0 / s } else { 0.0 };
            self.b.column_mut(j).iter_mut().for_each(|x| *x *= inverse);
            self.sigma[j] = (s * scale).min(f64::MAX);
        }
        debug_assert!(
            self.value(0) == f64::MAX || self.residual(a) < 1e-11,
            "SVD residual {} of {a:?}",
            self.residual(a)
        );
    }

    /// Number of singular values, min(m, n).
    #[must_use]
    pub fn len(&self) -> usize {
        self.sigma.len()
    }

    /// True for a matrix without rows or without columns.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.sigma.is_empty()
    }

    /// The `i`-th largest singular value.
    #[must_use]
    #[inline]
    pub fn value(&self, i: usize) -> f64 {
        self.sigma[self.order[i]]
    }

    /// The singular values, largest first.
    #[must_use]
    pub fn values(&self) -> impl ExactSizeIterator<Item = f64> + '_ {
        self.order.iter().map(|&i| self.sigma[i])
    }

    /// Left singular vector of the `i`-th value (m entries).
    #[must_use]
    #[inline]
    pub fn u(&self, i: usize) -> &[f64] {
        let j = self.order[i];
        if self.rows > self.cols { self.b.column(j) } else { self.w.column(j) }
    }

    /// Right singular vector of the `i`-th value (n entries).
    #[must_use]
    #[inline]
    pub fn v(&self, i: usize) -> &[f64] {
        let j = self.order[i];
        if self.rows > self.cols { self.w.column(j) } else { self.b.column(j) }
    }

    /// Number of rows of the decomposed matrix.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns of the decomposed matrix.
    #[must_use]
    pub fn cols(&self) -> usize {
        self.cols
    }

    /// Sweeps that the last decomposition took.
    #[must_use]
    pub fn sweeps(&self) -> usize {
        self.sweeps
    }

    /// `V diag(gain) U^T b`, n entries; `gain` of the place and size of each singular value.
    pub(crate) fn apply_gains(&self, b: &[f64], gain: impl Fn(usize, f64) -> f64) -> Vec<f64> {
        let mut x = vec![0.0; self.cols];
        self.apply_gains_into(b, gain, &mut x);
        x
    }

    /// [`Svd::apply_gains`] without allocation.
    pub(crate) fn apply_gains_into(
        &self,
        b: &[f64],
        gain: impl Fn(usize, f64) -> f64,
        x: &mut [f64],
    ) {
        x.fill(0.0);
        for i in 0..self.len() {
            let along = gain(i, self.value(i)) * super::vector::dot(self.u(i), b);
            x.iter_mut().zip(self.v(i)).for_each(|(x, v)| *x += along * v);
        }
    }

    /// The least x that is nearest to solving `A x = b` in the first `rank` directions.
    pub(crate) fn solve(&self, b: &[f64], rank: usize) -> Vec<f64> {
        self.apply_gains(b, |i, s| if i < rank && s > 0.0 { 1.0 / s } else { 0.0 })
    }

    /// Rank at the relative threshold `eps` (values `s_i <= eps * s_1` do not count), never below
    /// machine precision nor the smallest normal number, which has the largest inverse.
    #[must_use]
    pub fn rank(&self, eps: f64) -> Rank {
        let k = self.len();
        if k == 0 {
            return Rank { rank: 0, threshold: 0.0, gap: f64::INFINITY };
        }
        let machine = MACHINE_RANK * self.rows.max(self.cols) as f64;
        let threshold = (eps.max(machine) * self.value(0)).max(f64::MIN_POSITIVE);
        let rank = self.values().take_while(|&s| s > threshold).count();
        let gap = if rank == 0 || rank == k || self.value(rank) == 0.0 {
            f64::INFINITY
        } else {
            self.value(rank - 1) / self.value(rank)
        };
        Rank { rank, threshold, gap }
    }

    /// Rank at machine precision.
    #[must_use]
    pub fn machine_rank(&self) -> Rank {
        self.rank(0.0)
    }

    /// `|A - U S V^T| / |A|` in the Frobenius norm: zero up to rounding for every result.
    #[must_use]
    pub fn residual(&self, a: &Matrix) -> f64 {
        let largest = a.max_abs();
        if largest == 0.0 {
            return self.values().fold(0.0, f64::max);
        }
        let (mut difference, mut size) = (0.0, 0.0);
        for i in 0..self.rows {
            for j in 0..self.cols {
                let part = |l| self.u(l)[i] * (self.value(l) / largest) * self.v(l)[j];
                let rebuilt: f64 = (0..self.len()).map(part).sum();
                difference += (a[(i, j)] / largest - rebuilt).powi(2);
                size += (a[(i, j)] / largest).powi(2);
            }
        }
        (difference / size).sqrt()
    }

    fn reset_rotations(&mut self) {
        let k = self.sigma.len();
        self.w.data.fill(0.0);
        for i in 0..k {
            self.w.column_mut(i)[i] = 1.0;
        }
    }

    /// B = scaled A, transposed if A is wide.
    fn load(&mut self, a: &Matrix, factor: f64) {
        if self.rows > self.cols {
            for j in 0..self.cols {
                for (b, x) in self.b.column_mut(j).iter_mut().zip(a.column(j)) {
                    *b = x * factor;
                }
            }
        } else {
            for i in 0..self.rows {
                for (j, b) in self.b.column_mut(i).iter_mut().enumerate() {
                    *b = a[(i, j)] * factor;
                }
            }
        }
    }

    /// B = scaled A (or A^T) times W.
    fn load_times_w(&mut self, a: &Matrix, factor: f64) {
        let k = self.sigma.len();
        // A power of two again, so that the sums of large numbers do not overflow before `factor`.
        let guard = if factor < 1.0 { 1.0 / 256.0 } else { 1.0 };
        for l in 0..k {
            let w = &mut self.scratch[..k];
            w.iter_mut().zip(self.w.column(l)).for_each(|(x, w)| *x = w * guard);
            let b = self.b.column_mut(l);
            if self.rows > self.cols {
                a.mul_vec_into(w, b);
            } else {
                a.tr_mul_vec_into(w, b);
            }
            b.iter_mut().for_each(|x| *x *= factor / guard);
        }
    }

    /// One Newton step to the nearest orthogonal matrix, W (3 - W^T W) / 2.
    fn reorthonormalise(&mut self) {
        let k = self.sigma.len();
        for i in 0..k {
            for j in 0..k {
                let dot = dot(self.w.padded(i), self.w.padded(j));
                self.scratch[j * k + i] = if i == j { 1.5 - 0.5 * dot } else { -0.5 * dot };
            }
        }
        // Row by row in place: a row of W is used by its own product only.
        for row in 0..k {
            for j in 0..k {
                self.sigma[j] =
                    (0..k).map(|l| self.w.column(l)[row] * self.scratch[j * k + l]).sum();
            }
            for j in 0..k {
                self.w.column_mut(j)[row] = self.sigma[j];
            }
        }
    }

    /// One sweep over all pairs; true if anything was rotated. `sigma` holds the squared norms of
    /// the columns meanwhile, measured at the start and kept up to date by the rotations.
    fn sweep(&mut self) -> bool {
        let k = self.sigma.len();
        for j in 0..k {
            self.sigma[j] = dot(self.b.padded(j), self.b.padded(j));
        }
        let mut rotated = false;
        for &(i, j) in &self.pairs {
            let (bi, bj) = self.b.pair(i, j);
            let (aa, bb, ab) = (self.sigma[i], self.sigma[j], dot(bi, bj));
            if !(ab * ab > JACOBI_ORTHOGONAL * JACOBI_ORTHOGONAL * aa * bb) {
                continue;
            }
            rotated = true;
            let (difference, double) = (bb - aa, 2.0 * ab);
            let h = (difference * difference + double * double).sqrt();
            let t = double.copysign(double * difference) / (difference.abs() + h);
            let c = 1.0 / (1.0 + t * t).sqrt();
            let s = c * t;
            rotate(bi, bj, c, s);
            let (wi, wj) = self.w.pair(i, j);
            rotate(wi, wj, c, s);
            self.sigma[i] = (aa - t * ab).max(0.0);
            self.sigma[j] = bb + t * ab;
        }
        rotated
    }
}

/// Columns padded with zeros to a multiple of four numbers, so that loops over them have no rest.
#[derive(Debug, Clone)]
struct PaddedColumns {
    rows: usize,
    stride: usize,
    data: Vec<f64>,
}

impl PaddedColumns {
    fn zeros(rows: usize, cols: usize) -> Self {
        let stride = rows.next_multiple_of(LANES);
        Self { rows, stride, data: vec![0.0; stride * cols] }
    }

    #[inline]
    fn column(&self, j: usize) -> &[f64] {
        &self.data[j * self.stride..j * self.stride + self.rows]
    }

    #[inline]
    fn column_mut(&mut self, j: usize) -> &mut [f64] {
        &mut self.data[j * self.stride..j * self.stride + self.rows]
    }

    #[inline]
    fn padded(&self, j: usize) -> &[f64] {
        &self.data[j * self.stride..(j + 1) * self.stride]
    }

    /// Two padded columns, i < j.
    #[inline]
    fn pair(&mut self, i: usize, j: usize) -> (&mut [f64], &mut [f64]) {
        let (head, tail) = self.data.split_at_mut(j * self.stride);
        (&mut head[i * self.stride..(i + 1) * self.stride], &mut tail[..self.stride])
    }
}

const LANES: usize = 4;

/// All pairs of k columns, ordered so that neighbours share no column: the processor works on
/// several rotations at once, whose square roots would otherwise wait for each other.
fn tournament(k: usize) -> Vec<(usize, usize)> {
    let ring = (k + k % 2).saturating_sub(1);
    let mut pairs = Vec::with_capacity(k * k / 2);
    for round in 0..ring {
        for i in 0..=ring / 2 {
            let a = if i == 0 { ring } else { (round + i) % ring };
            let b = (round + ring - i) % ring;
            if a < k && b < k && a != b {
                pairs.push((a.min(b), a.max(b)));
            }
        }
    }
    pairs
}

fn power_of_two_below(x: f64) -> f64 {
    // The exponent bits alone; subnormal numbers use the smallest normal power.
    f64::from_bits(x.to_bits() & 0x7ff0_0000_0000_0000).max(f64::MIN_POSITIVE)
}

/// Scalar product of padded columns.
#[inline]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sum = [0.0; LANES];
    for (x, y) in a.as_chunks::<LANES>().0.iter().zip(b.as_chunks::<LANES>().0) {
        for l in 0..LANES {
            sum[l] += x[l] * y[l];
        }
    }
    (sum[0] + sum[2]) + (sum[1] + sum[3])
}

#[inline]
fn rotate(a: &mut [f64], b: &mut [f64], c: f64, s: f64) {
    let (a, b) = (a.as_chunks_mut::<LANES>().0, b.as_chunks_mut::<LANES>().0);
    for (x, y) in a.iter_mut().zip(b) {
        for l in 0..LANES {
            let (p, q) = (x[l], y[l]);
            x[l] = c * p - s * q;
            y[l] = s * p + c * q;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::tournament;

    #[test]
    fn every_pair_once() {
        for k in 0..12 {
            let mut pairs = tournament(k);
            assert!(pairs.iter().all(|(i, j)| i < j && *j < k));
            pairs.sort_unstable();
            pairs.dedup();
            assert_eq!(pairs.len(), k * k.saturating_sub(1) / 2, "{k}");
        }
    }
}
