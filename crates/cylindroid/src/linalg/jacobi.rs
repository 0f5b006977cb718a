//! One-sided Jacobi rotations, the kernel of the singular value decomposition: columns of B are
//! made orthogonal in pairs.
//!
//! Formula  one by one: for each pair of columns a, b the angle with tan 2 angle = 2 a.b / (b.b -
//!          a.a), a' = c a - s b, b' = s a + c b, the same for the columns of W
//!          together, where all angles are small: G = B^T B = D + F with D diagonal, and skew
//!          K_ij = F_ij / (D_j - D_i), once more for the remainder [F, K] / 2;
//!          B' = B E, W' = W E with E = 1 + K + K^2 / 2 + K^3 / 8, orthogonal to K^6 / 64; the
//!          angles of a step are the cubes of those of the previous one
//!          warm: from W extrapolated by its last increment; a uniform motion leaves second
//!          differences only, which one step removes
//! Shapes   B: long x k, W and K: k x k, columns padded with zeros to a multiple of four numbers
//! Why so   rotations one by one are latency-bound by divisions and square roots; together they are
//!          matrix products. Both have the same stopping criterion, so the result is as accurate.
//!          Four numbers are one register: written once over [`Simd4`], compiled for the baseline
//!          and for AVX2
//! Source   Hestenes 1958; de Rijk 1989; Ogita & Aishima 2018 (all angles of a step at once)
//! Checked  tests in this file, tests/it/svd.rs

use super::matrix::Matrix;
use super::small_gemm::{
    AlignedColumns, LANES, Size, add, dot, gram, load_transposed, newton, pair, product, rotate,
    scale, squares, times, transposed_block, unit,
};
use crate::scalar::{Array, Simd4};
#[cfg(target_arch = "x86_64")]
use crate::scalar::{Avx2, Lanes4};
use crate::tolerance::JACOBI_ORTHOGONAL;

/// Maximum number of sweeps; at most ten are needed in practice: it bounds the cost.
const MAX_SWEEPS: usize = 40;

/// Angles up to this, as the spectral norm of K, are turned together: E then lacks 1e-11 of
/// orthogonality, which one Newton step squares.
const TOGETHER: f64 = 1.0 / 32.0;

/// Up to these E with three terms (K^6 / 64), two (K^4 / 4) and one (K^2) is orthogonal to less
/// than a rounding.
const THREE_TERMS: f64 = 1.0 / 256.0;
const TWO_TERMS: f64 = 1e-4;
const ONE_TERM: f64 = 1e-8;

/// From angles and cosines up to this, and second angles up to four times its square, one step
/// leaves less than `JACOBI_ORTHOGONAL`: products of the three.
const LAST: f64 = 4e-6;

/// Maximum number of steps with all angles together; then rotations one by one continue.
const MAX_TOGETHER: usize = 8;

/// How B W starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Start {
    /// W is the identity.
    Cold,
    /// From the last W, extrapolated by its last increment.
    Warm,
    /// The same, made orthogonal to rounding first.
    Repaired,
}

/// B, W and the memory to rotate them without allocation.
#[derive(Debug, Clone)]
pub(super) struct Rotations {
    /// Number of columns.
    pub(super) k: usize,
    /// B W, columns of length `long`.
    pub(super) b: AlignedColumns,
    /// The accumulated rotations.
    pub(super) w: AlignedColumns,
    /// How the last warm start was turned, and W turned on in the same way: where the next starts.
    last_turn: AlignedColumns,
    next: AlignedColumns,
    /// Lengths that the columns of B W had; [`super::Svd`] scales them to singular values.
    pub(super) lengths: AlignedColumns,
    /// The order of a sweep.
    pairs: Vec<(usize, usize)>,
    /// G, K, E and a matrix for products.
    products: AlignedColumns,
    angles: AlignedColumns,
    turn: AlignedColumns,
    square: AlignedColumns,
    row: Vec<f64>,
}

impl Rotations {
    pub(super) fn zeros(long: usize, k: usize) -> Self {
        Self {
            k,
            b: AlignedColumns::zeros(long, k),
            w: AlignedColumns::zeros(k, k),
            last_turn: AlignedColumns::zeros(k, k),
            next: AlignedColumns::zeros(k, k),
            lengths: AlignedColumns::zeros(k, 1),
            pairs: round_robin_pairs(k),
            products: AlignedColumns::zeros(k, k),
            angles: AlignedColumns::zeros(k, k),
            turn: AlignedColumns::zeros(k, k),
            square: AlignedColumns::zeros(k, k),
            row: vec![0.0; k * LANES],
        }
    }

    /// For matrices of another shape.
    pub(super) fn reshape(&mut self, long: usize, k: usize) {
        self.k = k;
        self.b.reshape(long, k);
        self.lengths.reshape(k, 1);
        let Self { w, last_turn, next, products, angles, turn, square, .. } = self;
        for square in [w, last_turn, next, products, angles, turn, square] {
            square.reshape(k, k);
        }
        self.pairs.clear();
        self.pairs.extend(round_robin(k));
        self.row.resize(k * LANES, 0.0);
    }

    pub(super) fn reset(&mut self) {
        self.w.fill(0.0);
        for j in 0..self.k {
            self.w.column_mut(j)[j] = 1.0;
        }
        self.rest();
    }

    /// Loads `a` (or its transpose if it is wide) times `factor` and makes the columns of B W
    /// orthogonal, of length 1 or 0; the number of sweeps.
    pub(super) fn run(&mut self, a: &Matrix, factor: f64, start: Start) -> usize {
        #[cfg(target_arch = "x86_64")]
        if let Some(cpu) = Avx2::detect() {
            #[allow(unsafe_code)] // the one way to call a function compiled for more
            // SAFETY: the token proves that the processor has both features.
            return unsafe { self.run_avx2(cpu, a, factor, start) };
        }
        self.run_with::<Array<4>>((), a, factor, start, self.size())
    }

    /// Once more for Jacobians of six and seven joints, whose loops are then known.
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma")]
    fn run_avx2(&mut self, cpu: Avx2, a: &Matrix, factor: f64, start: Start) -> usize {
        const SIX: Size = Size { k: 6, long: 8, short: 8 };
        if self.size() == SIX {
            self.run_with::<Lanes4>(cpu, a, factor, start, SIX)
        } else {
            self.run_with::<Lanes4>(cpu, a, factor, start, self.size())
        }
    }

    fn size(&self) -> Size {
        Size { k: self.k, long: self.b.stride, short: self.w.stride }
    }

    #[inline(always)]
    fn run_with<R: Simd4>(
        &mut self,
        _: R::Cpu,
        a: &Matrix,
        factor: f64,
        start: Start,
        size: Size,
    ) -> usize {
        self.load::<R>(a, factor, size);
        if start == Start::Cold {
            self.reset();
        } else {
            std::mem::swap(&mut self.w, &mut self.next);
            if start == Start::Repaired {
                newton::<R>(&mut self.last_turn.data, &mut self.square.data, size, &mut self.row);
                newton::<R>(&mut self.w.data, &mut self.square.data, size, &mut self.row);
            }
            times::<R>(&mut self.b.data, size.long, &self.w.data, size, &mut self.row);
        }
        let (mut sweeps, mut together, mut swept) = (0, 0, false);
        // Rotations one by one while angles are large.
        let mut one_by_one = start == Start::Cold;
        while sweeps < MAX_SWEEPS {
            sweeps += 1;
            if !one_by_one {
                let Angles { norm, is_last } = self.find_angles::<R>(size);
                if norm == 0.0 {
                    break;
                }
                one_by_one = norm > TOGETHER || together == MAX_TOGETHER;
                if !one_by_one {
                    together += 1;
                    self.turn::<R>(norm, size);
                    if is_last {
                        break;
                    }
                    continue;
                }
            }
            swept = true;
            self.measure::<R>(size);
            let largest = self.sweep::<R>(size);
            if largest == 0.0 {
                break;
            }
            one_by_one = largest > TOGETHER || together == MAX_TOGETHER;
        }
        self.measure::<R>(size);
        self.normalise::<R>(size);
        if swept {
            self.rest();
        } else {
            let Self { w, last_turn, next, row, .. } = self;
            product::<R>(&w.data, size.short, &last_turn.data, &mut next.data, size, row);
        }
        sweeps
    }

    #[inline(always)]
    fn load<R: Simd4>(&mut self, a: &Matrix, factor: f64, size: Size) {
        if a.rows() > a.cols() {
            for j in 0..a.cols() {
                for (b, x) in self.b.column_mut(j).iter_mut().zip(a.column(j)) {
                    *b = x * factor;
                }
            }
        } else {
            load_transposed::<R>(a, &mut self.b.data, size.long, size);
            scale::<R>(&mut self.b.data[..size.k * size.long], factor);
        }
    }

    /// The squares of the lengths of all columns.
    #[inline(always)]
    fn measure<R: Simd4>(&mut self, size: Size) {
        squares::<R>(&self.b.data, size.long, &mut self.lengths.data, size);
    }

    /// Columns of length 1 or 0, and the lengths that they had.
    #[inline(always)]
    fn normalise<R: Simd4>(&mut self, size: Size) {
        let (b, lengths) = (&mut self.b.data[..size.k * size.long], &mut self.lengths.data);
        for four in lengths.as_chunks_mut::<LANES>().0 {
            R::load(four).sqrt().store(four);
        }
        let inverses = &mut self.row[..size.short];
        for (four, to) in lengths.as_chunks::<LANES>().0.iter().zip(inverses.as_chunks_mut().0) {
            let (length, zero) = (R::load(four), R::splat(0.0));
            let inverse: &mut [f64; LANES] = to;
            (R::splat(1.0) / length).zero_unless_gt(length, zero).store(inverse);
        }
        for (j, inverse) in inverses[..size.k].iter().enumerate() {
            scale::<R>(&mut b[j * size.long..][..size.long], *inverse);
        }
    }

    /// Puts the columns in the order of their lengths, the longest first: there already after most
    /// warm starts.
    pub(super) fn sort(&mut self) {
        let lengths = self.lengths.column(0);
        if lengths.iter().zip(lengths.iter().skip(1)).any(|(before, after)| after > before) {
            self.sort_by_exchange();
        }
    }

    #[cold]
    fn sort_by_exchange(&mut self) {
        for end in 1..self.k {
            let mut j = end;
            while j > 0 && self.lengths.data[j] > self.lengths.data[j - 1] {
                self.lengths.data.swap(j, j - 1);
                self.b.swap(j - 1, j);
                self.w.swap(j - 1, j);
                j -= 1;
            }
        }
        self.rest();
    }

    /// Resets the extrapolation: the next start is from W itself.
    fn rest(&mut self) {
        self.next.data.copy_from_slice(&self.w.data);
        self.last_turn.fill(0.0);
        for j in 0..self.k {
            self.last_turn.column_mut(j)[j] = 1.0;
        }
    }

    /// One sweep over all pairs; the tangent of the largest angle, 0 if nothing was turned. Squares
    /// of lengths are kept up to date by the rotations.
    #[inline(always)]
    fn sweep<R: Simd4>(&mut self, size: Size) -> f64 {
        let mut largest = 0.0_f64;
        for &(i, j) in &self.pairs {
            let (bi, bj) = pair(&mut self.b.data, size.long, i, j);
            let lengths = &mut self.lengths.data;
            let (aa, bb, ab) = (lengths[i], lengths[j], dot::<R>(bi, bj));
            if !(ab * ab > JACOBI_ORTHOGONAL * JACOBI_ORTHOGONAL * (aa * bb)) {
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
            lengths[i] = (aa - t * ab).max(0.0);
            lengths[j] = bb + t * ab;
            largest = largest.max(t.abs());
        }
        largest
    }

    /// Writes the angles, 0 for columns that are orthogonal.
    #[inline(always)]
    fn find_angles<R: Simd4>(&mut self, size: Size) -> Angles {
        let Size { k, short, .. } = size;
        let numbers = k * short;
        let Self { b, products, angles, square, turn, row, lengths, .. } = self;
        gram::<R>(&b.data, size.long, &mut products.data, size);
        let (products, angles) = (&mut products.data[..numbers], &mut angles.data[..numbers]);
        // Inverses of D_j - D_i.
        let inverses = &mut square.data[..numbers];
        let lengths = &mut lengths.data[..short];
        for first in (0..short).step_by(LANES) {
            let mut diagonal = R::splat(0.0);
            for j in first..k.min(first + LANES) {
                let four = R::load(&products[j * short + first..]);
                diagonal = four.mul_add(unit(first, j), diagonal);
            }
            diagonal.store(&mut lengths[first..]);
        }
        let one = R::splat(1.0);
        let least = R::splat(JACOBI_ORTHOGONAL * JACOBI_ORTHOGONAL);
        let (little, some) = (R::splat(ONE_TERM * ONE_TERM), R::splat(LAST * LAST));
        let (mut squares, mut oblique, mut too_oblique) =
            (R::splat(0.0), R::splat(0.0), R::splat(0.0));
        for j in 0..k {
            for first in (0..short).step_by(LANES) {
                let here = j * short + first;
                let (aa, bb) = (R::load(&lengths[first..]), R::splat(lengths[j]));
                let ab = R::load(&products[here..]) * (one - unit(first, j));
                ab.store(&mut products[here..]);
                // Cosines are compared by their squares.
                let (ab_ab, aa_bb) = (ab * ab, aa * bb);
                let inverse = one / (bb - aa);
                inverse.store(&mut inverses[here..]);
                let angle = (ab * inverse).zero_unless_gt(ab_ab, least * aa_bb);
                angle.store(&mut angles[here..]);
                squares = angle.mul_add(angle, squares);
                oblique = oblique + one.zero_unless_gt(ab_ab, little * aa_bb);
                too_oblique = too_oblique + one.zero_unless_gt(ab_ab, some * aa_bb);
            }
        }
        let norm = norm(squares);
        let (small, last) = (norm <= ONE_TERM && oblique.sum() == 0.0, too_oblique.sum() == 0.0);
        if small || norm > TOGETHER {
            return Angles { norm, is_last: small };
        }
        // Once more for what these leave, [F, K] / 2: F K and its transpose.
        let left = &mut turn.data[..numbers];
        product::<R>(products, short, angles, left, size, row);
        let (mut squares, half) = (R::splat(0.0), R::splat(0.5));
        for i in (0..short).step_by(LANES) {
            for j in (0..short).step_by(LANES) {
                let transposed = transposed_block::<R>(left, i, j, size);
                for (l, transposed) in transposed.into_iter().enumerate() {
                    if j + l < k {
                        let here = (j + l) * short + i;
                        let left =
                            (R::load(&left[here..]) + transposed) * (half - half * unit(i, j + l));
                        let aa_bb = R::load(&lengths[i..]) * R::splat(lengths[j + l]);
                        let angle = (left * R::load(&inverses[here..]))
                            .zero_unless_gt(left * left, least * aa_bb);
                        squares = angle.mul_add(angle, squares);
                        (R::load(&angles[here..]) + angle).store(&mut products[here..]);
                    }
                }
            }
        }
        // It is of the size of the squares of the first, but where lengths are nearly equal.
        let second = self::norm(squares);
        if !(second <= norm) {
            return Angles { norm, is_last: false };
        }
        std::mem::swap(&mut self.angles, &mut self.products);
        let is_last = last && norm <= LAST && second <= 4.0 * LAST * LAST;
        Angles { norm: norm + second, is_last }
    }

    /// Turns all columns by the angles found.
    #[inline(always)]
    fn turn<R: Simd4>(&mut self, norm: f64, size: Size) {
        let Self { b, w, angles, turn, square, row, last_turn, .. } = self;
        let (angles, e, square) = (&angles.data, &mut turn.data, &mut square.data);
        if norm > TWO_TERMS {
            // S = 1 + K^2 / 8, E = K S + 4 S - 3
            product::<R>(angles, size.short, angles, e, size, row);
            square.fill(0.0);
            add::<R>(square, 0.125, e, 1.0, size);
            product::<R>(angles, size.short, square, e, size, row);
            add::<R>(e, 4.0, square, -3.0, size);
        } else if norm > ONE_TERM {
            product::<R>(angles, size.short, angles, e, size, row);
            scale::<R>(e, 0.5);
            add::<R>(e, 1.0, angles, 1.0, size);
        } else {
            e.fill(0.0);
            add::<R>(e, 1.0, angles, 1.0, size);
        }
        if norm > THREE_TERMS {
            newton::<R>(e, square, size, row);
        }
        times::<R>(&mut b.data, size.long, e, size, row);
        times::<R>(&mut w.data, size.short, e, size, row);
        times::<R>(&mut last_turn.data, size.short, e, size, row);
    }
}

/// What [`Rotations::find_angles`] found.
struct Angles {
    /// A bound of the spectral norm of K; 0 if all columns are orthogonal.
    norm: f64,
    /// True if these angles leave nothing, and neither do the cosines, which for lengths far apart
    /// are larger.
    is_last: bool,
}

/// A bound of the spectral norm of a skew matrix, from the squares of its entries: its singular
/// values come in pairs.
#[inline(always)]
fn norm<R: Simd4>(squares: R) -> f64 {
    (0.5 * squares.sum()).sqrt()
}

/// All pairs of k columns, ordered so that neighbours share no column: the processor works on
/// several rotations at once, whose square roots would otherwise depend on each other.
pub(crate) fn round_robin_pairs(k: usize) -> Vec<(usize, usize)> {
    round_robin(k).collect()
}

fn round_robin(k: usize) -> impl Iterator<Item = (usize, usize)> {
    let ring = (k + k % 2).saturating_sub(1);
    let places = (0..ring).flat_map(move |round| (0..=ring / 2).map(move |i| (round, i)));
    places.filter_map(move |(round, i)| {
        let a = if i == 0 { ring } else { (round + i) % ring };
        let b = (round + ring - i) % ring;
        (a < k && b < k && a != b).then_some((a.min(b), a.max(b)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pair_once() {
        for k in 0..12 {
            let mut pairs = round_robin_pairs(k);
            assert!(pairs.iter().all(|(i, j)| i < j && *j < k));
            pairs.sort_unstable();
            pairs.dedup();
            assert_eq!(pairs.len(), k * k.saturating_sub(1) / 2, "{k}");
        }
    }

    /// Registers and plain numbers, cold and warm, in the sizes that are known to the compiler and
    /// in others.
    #[test]
    fn registers_agree_with_plain_numbers() {
        let mut state = 5;
        for (m, n) in [(6, 7), (6, 6), (7, 6), (3, 7), (6, 12), (9, 9)] {
            let start = Matrix::from_fn(m, n, |_, _| crate::scalar::uniform(&mut state));
            let (k, long) = (m.min(n), m.max(n));
            let (mut fast, mut plain) = (Rotations::zeros(long, k), Rotations::zeros(long, k));
            let mut from = Start::Cold;
            for step in 0..40 {
                let t = f64::from(step) * 1e-3;
                let a =
                    Matrix::from_fn(m, n, |i, j| start[(i, j)] + t * ((i + 2 * j) as f64).sin());
                fast.run(&a, 0.25, from);
                plain.run_with::<Array<4>>((), &a, 0.25, from, plain.size());
                for (x, y) in [(&fast.b, &plain.b), (&fast.w, &plain.w)] {
                    for (x, y) in x.data.iter().zip(&y.data) {
                        assert!((x - y).abs() < 1e-11, "{m} x {n}, step {step}: {x} and {y}");
                    }
                }
                from = if step % 9 == 8 { Start::Repaired } else { Start::Warm };
            }
        }
    }
}
