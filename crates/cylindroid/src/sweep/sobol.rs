//! The Sobol' sequence with Owen's scrambling: points of the unit cube that fill it evenly, each a
//! pure function of seed and index.
//!
//! Formula  x_d(i) = scramble(xor of the direction vectors v_dk of the bits k set in i, seed, d),
//!          v_dk by the recurrence of the primitive polynomial of dimension d
//! Shapes   index: 32 bits, dimensions: at most [`Sobol::DIMENSIONS`]
//! Units    multiples of 2^-32, half of one added: never 0, never 1
//! Valid    the points 0 to 2^m - 1, and every later block of that size, have one point in each
//!          interval [j, j + 1) / 2^m of each dimension, whatever the seed
//! Why so   any part of a sweep can be computed anywhere, in any order; independent random numbers
//!          leave gaps, grids of seven joints have a few values of each. The crate sobol_burley has
//!          2^16 points of 24 bits, too few for millions of samples
//! Source   Joe & Kuo 2008 (direction numbers); Burley 2020, Vegdahl 2021 (scrambling by a hash)
//! Checked  tests::first_points, tests/sweep/sampling.rs::every_prefix_is_a_net

use super::direction_numbers::DIRECTION_NUMBERS;
#[cfg(target_arch = "x86_64")]
use crate::scalar::Avx2;

/// Bits of an index and of a number.
const BITS: usize = 32;
/// Points computed at once.
const BLOCK: usize = 256;

/// The scrambled sequence of a seed.
#[derive(Debug, Clone)]
pub(super) struct Sobol {
    dimensions: Vec<Dimension>,
}

#[derive(Debug, Clone)]
struct Dimension {
    /// Bits in reverse order, which scrambling needs: v_dk of the bits k of the index.
    vectors: [u32; BITS],
    /// The exclusive or of the vectors of each index below [`BLOCK`].
    low: Vec<u32>,
    scramble: u32,
}

impl Sobol {
    /// Dimensions at most.
    pub(super) const DIMENSIONS: usize = DIRECTION_NUMBERS.len() + 1;

    /// The first `dimensions` dimensions, at most [`Sobol::DIMENSIONS`].
    pub(super) fn new(dimensions: usize, seed: u64) -> Self {
        let dimension = |d: usize| {
            let vectors = direction_vectors(d).map(u32::reverse_bits);
            let low = (0..BLOCK).map(|i| combine(&vectors, i)).collect();
            Dimension { vectors, low, scramble: hash(seed, d) }
        };
        Self { dimensions: (0..dimensions).map(dimension).collect() }
    }

    /// The points `first`, `first + 1`, ...: a number of (0, 1) for each dimension, one point after
    /// the other.
    pub(super) fn write(&self, first: u32, out: &mut [f64]) {
        #[cfg(target_arch = "x86_64")]
        if let Some(cpu) = Avx2::detect() {
            #[allow(unsafe_code)] // the one way to call functions compiled for more
            // SAFETY: the token proves that the processor has these features.
            return unsafe { self.write_avx2(cpu, first, out) };
        }
        self.write_with(first, out);
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn write_avx2(&self, _: Avx2, first: u32, out: &mut [f64]) {
        self.write_with(first, out);
    }

    #[inline(always)]
    fn write_with(&self, first: u32, out: &mut [f64]) {
        let width = self.dimensions.len();
        let mut numbers = [0.0; BLOCK];
        let mut start = first as usize;
        let mut left = out;
        // Indices of a block share their higher bits.
        while left.len() >= width {
            let low = start % BLOCK;
            let count = (BLOCK - low).min(left.len() / width);
            let (points, rest) = left.split_at_mut(count * width);
            for (d, dimension) in self.dimensions.iter().enumerate() {
                let high = combine(&dimension.vectors, start - low);
                let numbers = &mut numbers[..count];
                for (number, bits) in numbers.iter_mut().zip(&dimension.low[low..low + count]) {
                    let x = scramble(high ^ bits, dimension.scramble);
                    *number = (f64::from(x.reverse_bits()) + 0.5) * (1.0 / 4_294_967_296.0);
                }
                for (point, number) in points.chunks_exact_mut(width).zip(numbers) {
                    point[d] = *number;
                }
            }
            start += count;
            left = rest;
        }
    }
}

/// v_dk for k = 0, 1, ...; the first dimension is van der Corput's sequence.
fn direction_vectors(d: usize) -> [u32; BITS] {
    let mut v = [0_u32; BITS];
    let Some((a, m)) = d.checked_sub(1).and_then(|i| DIRECTION_NUMBERS.get(i)) else {
        return std::array::from_fn(|k| 1 << (BITS - 1 - k));
    };
    let degree = m.len();
    for k in 0..BITS {
        v[k] = match m.get(k) {
            Some(m) => m << (BITS - 1 - k),
            None => {
                let start = v[k - degree] ^ (v[k - degree] >> degree);
                let terms = (1..degree).filter(|j| (a >> (degree - 1 - j)) & 1 == 1);
                terms.fold(start, |x, j| x ^ v[k - j])
            }
        };
    }
    v
}

fn combine(vectors: &[u32; BITS], index: usize) -> u32 {
    let set = vectors.iter().enumerate().filter(|(k, _)| (index >> k) & 1 == 1);
    set.fold(0, |x, (_, v)| x ^ v)
}

/// Owen's scrambling of a number with its bits in reverse order: a bit is changed by those before
/// it, as a hash says.
#[inline(always)]
fn scramble(mut x: u32, by: u32) -> u32 {
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(by);
    x = x.wrapping_mul((by >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}

/// Of seed and dimension: the finaliser of SplitMix64.
fn hash(seed: u64, dimension: usize) -> u32 {
    let mut z = seed.wrapping_add((dimension as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 32) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Without scrambling, the points that every implementation of these numbers has (in the order
    /// of the index, not of Gray's code).
    #[test]
    fn first_points() {
        let expected = [
            [0.0, 0.0, 0.0, 0.0],
            [0.5, 0.5, 0.5, 0.5],
            [0.25, 0.75, 0.75, 0.75],
            [0.75, 0.25, 0.25, 0.25],
            [0.125, 0.625, 0.375, 0.125],
            [0.625, 0.125, 0.875, 0.625],
        ];
        for (i, point) in expected.iter().enumerate() {
            for (d, x) in point.iter().enumerate() {
                let found = combine(&direction_vectors(d), i);
                assert_eq!(f64::from(found) / 4_294_967_296.0, *x, "point {i}, dimension {d}");
            }
        }
    }

    /// Blocks change nothing.
    #[test]
    fn points_are_functions_of_their_index() {
        let sobol = Sobol::new(7, 3);
        let mut all = vec![0.0; 7 * 1000];
        sobol.write(4_294_966_000, &mut all);
        for i in [0, 1, 255, 256, 511, 999] {
            let mut one = [0.0; 7];
            sobol.write(4_294_966_000 + i, &mut one);
            assert_eq!(one, all[7 * i as usize..][..7]);
        }
    }
}
