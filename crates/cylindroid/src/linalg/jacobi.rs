//! The rotations of the singular value decomposition: columns of B made orthogonal in pairs.
//!
//! Formula  one by one: for each pair of columns a, b the angle with tan 2 angle = 2 a.b / (b.b - a.a),
//!          a' = c a - s b, b' = s a + c b, the same for the columns of W
//!          together, where all angles are small: K_ij = b_i.b_j / (b_j.b_j - b_i.b_i), skew;
//!          B' = B exp(K), W' = W exp(K); quadratic, as the angles of a step are the squares of
//!          those of the one before
//! Shapes   B: long x k, W and K: k x k, columns padded with zeros to a multiple of four numbers
//! Why so   rotations one by one wait for each other's divisions and square roots; together they
//!          are matrix products. Both stop by the same test, so the result is as exact. Four
//!          numbers are one register: written once over [`Real`], compiled for the baseline and
//!          for AVX2
//! Source   Hestenes 1958; de Rijk 1989; Ogita & Aishima 2018 (all angles of a step at once)
//! Checked  tests/it/svd.rs

use super::matrix::Matrix;
use crate::scalar::{Array, Real};
#[cfg(target_arch = "x86_64")]
use crate::scalar::{Lanes4, has_avx2};
use crate::tolerance::JACOBI_ORTHOGONAL;

/// More sweeps than any matrix needs (ten or fewer in practice): the bound that makes the cost finite.
const MAX_SWEEPS: usize = 40;

/// Angles up to this, as the spectral norm of K, are turned together: four terms of the exponential
/// then leave 1e-11 of orthogonality, which one Newton step squares.
const TOGETHER: f64 = 1.0 / 32.0;

/// Up to these four terms (K^6 / 72), two (K^4 / 4) and one (K^2) leave less than a rounding.
const FOUR_TERMS: f64 = 1.0 / 256.0;
const TWO_TERMS: f64 = 1e-4;
const ONE_TERM: f64 = 4e-9;

/// Steps with all angles together, before rotations one by one take over for good.
const MOST_TOGETHER: usize = 8;

/// How B W starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Start {
    /// W is the identity.
    Cold,
    /// From the last W.
    Warm,
    /// From the last W, made orthogonal to rounding first.
    Repaired,
}

/// B, W and what is needed to rotate them without allocation.
#[derive(Debug, Clone)]
pub(super) struct Rotations {
    /// B W, columns of length `long`.
    pub(super) b: PaddedColumns,
    /// The accumulated rotations.
    pub(super) w: PaddedColumns,
    /// Lengths that the columns of B W had; [`super::Svd`] scales them to singular values.
    pub(super) lengths: Vec<f64>,
    /// The order of a sweep.
    pairs: Vec<(usize, usize)>,
    /// The angles K, and their exponential.
    angles: PaddedColumns,
    turn: PaddedColumns,
    square: PaddedColumns,
    row: Vec<f64>,
}

impl Rotations {
    pub(super) fn zeros(long: usize, k: usize) -> Self {
        Self {
            b: PaddedColumns::zeros(long, k),
            w: PaddedColumns::zeros(k, k),
            lengths: vec![0.0; k],
            pairs: tournament(k),
            angles: PaddedColumns::zeros(k, k),
            turn: PaddedColumns::zeros(k, k),
            square: PaddedColumns::zeros(k, k),
            row: vec![0.0; k * LANES],
        }
    }

    pub(super) fn reset(&mut self) {
        let size = self.size();
        self.w.fill(0.0);
        add_identity(&mut self.w.data, size);
    }

    /// Loads `a` (or its transpose if it is wide) times `factor` and makes the columns of B W
    /// orthogonal, of length 1 or 0; the number of sweeps.
    pub(super) fn run(&mut self, a: &Matrix, factor: f64, start: Start) -> usize {
        #[cfg(target_arch = "x86_64")]
        if has_avx2() {
            #[allow(unsafe_code)] // the one way to call a function compiled for more
            // SAFETY: the processor has both features, as just asked.
            return unsafe { self.run_avx2(a, factor, start) };
        }
        self.run_with::<Array<4>>(a, factor, start, self.size())
    }

    /// Once more for Jacobians of six and seven joints, whose loops are then known.
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma")]
    fn run_avx2(&mut self, a: &Matrix, factor: f64, start: Start) -> usize {
        const SIX: Size = Size { k: 6, long: 8, short: 8 };
        if self.size() == SIX {
            self.run_with::<Lanes4>(a, factor, start, SIX)
        } else {
            self.run_with::<Lanes4>(a, factor, start, self.size())
        }
    }

    fn size(&self) -> Size {
        Size { k: self.lengths.len(), long: self.b.stride, short: self.w.stride }
    }

    #[inline(always)]
    fn run_with<R: Real>(&mut self, a: &Matrix, factor: f64, start: Start, size: Size) -> usize {
        self.load(a, factor);
        if start == Start::Cold {
            self.reset();
        } else {
            if start == Start::Repaired {
                newton::<R>(&mut self.w.data, &mut self.square.data, size, &mut self.row);
            }
            times::<R>(&mut self.b.data, size.long, &self.w.data, size, &mut self.row);
        }
        let (mut sweeps, mut together) = (0, 0);
        // Rotations one by one while angles are large.
        let mut one_by_one = start == Start::Cold;
        while sweeps < MAX_SWEEPS {
            self.measure::<R>(size);
            sweeps += 1;
            if !one_by_one {
                let Angles { norm, nearly } = self.find_angles::<R>(size);
                if norm == 0.0 {
                    break;
                }
                one_by_one = norm > TOGETHER || together == MOST_TOGETHER;
                if !one_by_one {
                    together += 1;
                    self.turn::<R>(norm, size);
                    if nearly && norm <= ONE_TERM {
                        break; // what is left is the square of that
                    }
                    continue;
                }
            }
            let largest = self.sweep::<R>(size);
            if largest == 0.0 {
                break;
            }
            one_by_one = largest > TOGETHER || together == MOST_TOGETHER;
        }
        self.measure::<R>(size);
        for (j, length) in self.lengths.iter_mut().enumerate() {
            *length = length.sqrt();
            let inverse = if *length > 0.0 { 1.0 / *length } else { 0.0 };
            scale::<R>(&mut self.b.data[j * size.long..][..size.long], inverse);
        }
        sweeps
    }

    #[inline(always)]
    fn load(&mut self, a: &Matrix, factor: f64) {
        let (rows, numbers) = (a.rows(), a.as_slice());
        if a.rows() > a.cols() {
            for j in 0..a.cols() {
                for (b, x) in self.b.column_mut(j).iter_mut().zip(a.column(j)) {
                    *b = x * factor;
                }
            }
        } else {
            for i in 0..rows {
                let row = numbers[i..].iter().step_by(rows);
                for (b, x) in self.b.column_mut(i).iter_mut().zip(row) {
                    *b = x * factor;
                }
            }
        }
    }

    /// The squares of the lengths of all columns.
    #[inline(always)]
    fn measure<R: Real>(&mut self, size: Size) {
        let (b, lengths) = (&self.b.data[..size.k * size.long], &mut self.lengths[..size.k]);
        for (j, length) in lengths.iter_mut().enumerate() {
            let b = padded(b, size.long, j);
            *length = dot::<R>(b, b);
        }
    }

    /// One sweep over all pairs; the tangent of the largest angle, 0 if nothing was turned. Squares
    /// of lengths are kept up to date by the rotations.
    #[inline(always)]
    fn sweep<R: Real>(&mut self, size: Size) -> f64 {
        let mut largest = 0.0_f64;
        for &(i, j) in &self.pairs {
            let (bi, bj) = pair(&mut self.b.data, size.long, i, j);
            let (aa, bb, ab) = (self.lengths[i], self.lengths[j], dot::<R>(bi, bj));
            if !is_oblique(aa, bb, ab, JACOBI_ORTHOGONAL) {
                continue;
            }
            let (difference, double) = (bb - aa, 2.0 * ab);
            let h = (difference * difference + double * double).sqrt();
            let t = double.copysign(double * difference) / (difference.abs() + h);
            let c = 1.0 / (1.0 + t * t).sqrt();
            let s = c * t;
            rotate::<R>(bi, bj, c, s);
            let (wi, wj) = pair(&mut self.w.data, size.short, i, j);
            rotate::<R>(wi, wj, c, s);
            self.lengths[i] = (aa - t * ab).max(0.0);
            self.lengths[j] = bb + t * ab;
            largest = largest.max(t.abs());
        }
        largest
    }

    /// Writes the angles to first order, 0 for columns that are orthogonal.
    #[inline(always)]
    fn find_angles<R: Real>(&mut self, size: Size) -> Angles {
        let (b, lengths) = (&self.b.data[..size.k * size.long], &self.lengths[..size.k]);
        let angles = &mut self.angles.data[..size.k * size.short];
        let (mut squares, mut nearly) = (0.0, true);
        for j in 0..size.k {
            for i in 0..j {
                let ab = dot::<R>(padded(b, size.long, i), padded(b, size.long, j));
                let (aa, bb) = (lengths[i], lengths[j]);
                let oblique = is_oblique(aa, bb, ab, JACOBI_ORTHOGONAL);
                let angle = if oblique { ab / (bb - aa) } else { 0.0 };
                angles[j * size.short + i] = angle;
                angles[i * size.short + j] = -angle;
                squares += angle * angle;
                nearly &= !is_oblique(aa, bb, ab, ONE_TERM);
            }
        }
        // Singular values of a skew matrix come in pairs: its norm is at most this.
        Angles { norm: f64::sqrt(squares), nearly }
    }

    /// Turns all columns by the angles found.
    #[inline(always)]
    fn turn<R: Real>(&mut self, norm: f64, size: Size) {
        // 1 + K (1 + K / 2 (1 + K / 3 (1 + K / 4))), as far as it counts
        let turn = &mut self.turn.data;
        turn.copy_from_slice(&self.angles.data);
        let terms: &[f64] = if norm > TWO_TERMS {
            &[4.0, 3.0, 2.0]
        } else if norm > ONE_TERM {
            &[2.0]
        } else {
            &[]
        };
        for term in terms {
            scale::<R>(turn, 1.0 / term);
            add_identity(turn, size);
            times::<R>(turn, size.short, &self.angles.data, size, &mut self.row);
        }
        add_identity(turn, size);
        if norm > FOUR_TERMS {
            newton::<R>(turn, &mut self.square.data, size, &mut self.row);
        }
        times::<R>(&mut self.b.data, size.long, &self.turn.data, size, &mut self.row);
        times::<R>(&mut self.w.data, size.short, &self.turn.data, size, &mut self.row);
    }
}

/// Number of columns; lengths of the columns of B and of W in memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Size {
    k: usize,
    long: usize,
    short: usize,
}

/// What [`Rotations::find_angles`] found.
struct Angles {
    /// A bound of the spectral norm of K; 0 if all columns are orthogonal.
    norm: f64,
    /// True if the cosines between all columns, which for lengths far apart are larger than these
    /// angles, are at most [`ONE_TERM`].
    nearly: bool,
}

/// True if the cosine between columns of these squared lengths is larger.
#[inline(always)]
fn is_oblique(aa: f64, bb: f64, ab: f64, cosine: f64) -> bool {
    ab * ab > cosine * cosine * aa * bb
}

/// One Newton step to the nearest orthogonal matrix, W (3 - W^T W) / 2.
#[inline(always)]
fn newton<R: Real>(w: &mut [f64], square: &mut [f64], size: Size, row: &mut [f64]) {
    let stride = size.short;
    let (w, square) = (&mut w[..size.k * stride], &mut square[..size.k * stride]);
    for i in 0..size.k {
        for j in 0..=i {
            let half = -0.5 * dot::<R>(padded(w, stride, i), padded(w, stride, j));
            let x = if i == j { 1.5 + half } else { half };
            square[j * stride + i] = x;
            square[i * stride + j] = x;
        }
    }
    times::<R>(w, stride, square, size, row);
}

#[inline(always)]
fn add_identity(m: &mut [f64], size: Size) {
    let m = &mut m[..size.k * size.short];
    for i in 0..size.k {
        m[i * size.short + i] += 1.0;
    }
}

#[inline(always)]
fn scale<R: Real>(m: &mut [f64], factor: f64) {
    for four in m.as_chunks_mut::<LANES>().0 {
        (R::load(four) * R::splat(factor)).store(four);
    }
}

#[inline(always)]
fn padded(columns: &[f64], stride: usize, j: usize) -> &[f64] {
    &columns[j * stride..][..stride]
}

/// Two padded columns, i < j.
#[inline(always)]
fn pair(columns: &mut [f64], stride: usize, i: usize, j: usize) -> (&mut [f64], &mut [f64]) {
    let (head, tail) = columns.split_at_mut(j * stride);
    (&mut head[i * stride..][..stride], &mut tail[..stride])
}

/// Columns padded with zeros to a multiple of four numbers, so that loops over them have no rest.
#[derive(Debug, Clone)]
pub(super) struct PaddedColumns {
    rows: usize,
    stride: usize,
    data: Vec<f64>,
}

impl PaddedColumns {
    fn zeros(rows: usize, cols: usize) -> Self {
        let stride = rows.next_multiple_of(LANES);
        Self { rows, stride, data: vec![0.0; stride * cols] }
    }

    pub(super) fn fill(&mut self, x: f64) {
        self.data.fill(x);
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

const LANES: usize = 4;

/// `a = a m`, m square; `row` holds four rows of a.
#[inline(always)]
fn times<R: Real>(a: &mut [f64], stride: usize, m: &[f64], size: Size, row: &mut [f64]) {
    /// Columns whose four rows stay in registers.
    const FEW: usize = 8;
    let k = size.k;
    let (a, m) = (&mut a[..k * stride], &m[..k * size.short]);
    let mut few = [R::splat(0.0); FEW];
    for four in (0..stride).step_by(LANES) {
        for l in 0..k {
            let numbers = &a[l * stride + four..][..LANES];
            if k <= FEW {
                few[l] = R::load(numbers);
            } else {
                row[l * LANES..][..LANES].copy_from_slice(numbers);
            }
        }
        for j in 0..k {
            let m = padded(m, size.short, j);
            let mut sum = R::splat(0.0);
            for l in 0..k {
                let of = if k <= FEW { few[l] } else { R::load(&row[l * LANES..]) };
                sum = of.times_plus(R::splat(m[l]), sum);
            }
            sum.store(&mut a[j * stride + four..]);
        }
    }
}

/// Scalar product of padded columns.
#[inline(always)]
fn dot<R: Real>(a: &[f64], b: &[f64]) -> f64 {
    let mut sum = R::splat(0.0);
    for (x, y) in a.as_chunks::<LANES>().0.iter().zip(b.as_chunks::<LANES>().0) {
        sum = R::load(x).times_plus(R::load(y), sum);
    }
    sum.sum()
}

#[inline(always)]
fn rotate<R: Real>(a: &mut [f64], b: &mut [f64], c: f64, s: f64) {
    let (c, s) = (R::splat(c), R::splat(s));
    let (a, b) = (a.as_chunks_mut::<LANES>().0, b.as_chunks_mut::<LANES>().0);
    for (x, y) in a.iter_mut().zip(b) {
        let (p, q) = (R::load(x), R::load(y));
        (-s).times_plus(q, c * p).store(x);
        s.times_plus(p, c * q).store(y);
    }
}

/// All pairs of k columns, ordered so that neighbours share no column: the processor works on
/// several rotations at once, whose square roots would otherwise wait for each other.
pub(crate) fn tournament(k: usize) -> Vec<(usize, usize)> {
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

#[cfg(test)]
mod tests {
    use super::*;

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
