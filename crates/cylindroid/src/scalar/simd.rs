//! The traits of SIMD lanes that kernels are written over: arithmetic, comparison, shuffles.
//!
//! Shapes   a value holds [`Simd::LANES`] numbers; every operation acts on each lane alone, except
//!          where it says otherwise
//! Why so   three traits, because eight lanes are only needed for kinematics ([`Simd`]), division
//!          and comparison for eliminations ([`SimdFloat`]), transposition for four lanes
//!          ([`Simd4`])

use std::ops::{Add, Div, Mul, Neg, Sub};

/// Lanes at most.
pub(crate) const MAX_LANES: usize = 8;

/// One number, or several that go the same way.
pub(crate) trait Simd:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    /// Proof that the processor has what these lanes need; `()` where they need nothing.
    type Cpu: Copy;
    /// How many.
    const LANES: usize;
    /// True if [`Simd::mul_add`] rounds once.
    const FUSED: bool;
    /// The same number in all lanes.
    fn splat(x: f64) -> Self;
    /// The first `LANES` numbers.
    fn load(from: &[f64]) -> Self;
    /// Into the first `LANES` places.
    fn store(self, to: &mut [f64]);
    /// Lane l is `f(l)`.
    fn from_fn(f: impl Fn(usize) -> f64) -> Self;
    /// Lane l of the k-th is `from[l * stride + k]`.
    fn gather(from: &[f64], stride: usize, to: &mut [Self]);
    /// Lane l of the k-th goes to `to[l * stride + k]`.
    fn scatter(from: &[Self], to: &mut [f64], stride: usize);
    /// All lanes together.
    fn sum(self) -> f64;
    /// `self * b + c`, with one rounding where the processor can.
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// Without its sign.
    fn abs(self) -> Self;
    /// `(a, b)`, in lanes where the lowest bit of `bits` is set `(b, a)`.
    fn swap_if_odd(a: Self, b: Self, bits: Self) -> (Self, Self);
    /// Negated in lanes where the second bit of `bits + more` (as integers) is set.
    fn negate_if_second_bit(self, bits: Self, more: u64) -> Self;
    /// True if no lane is larger than `limit` or not a number.
    fn all_abs_le(self, limit: f64) -> bool;
    /// [`super::sin_cos`] of each of `x`: cosines take the place of the angles; `memory` is
    /// overwritten.
    ///
    /// Registers do this in a function of its own: its constants need many of them, which numbers
    /// of the caller would lose.
    ///
    /// # Panics
    /// If not all have one length.
    fn sines_cosines(x: &mut [Self], sines: &mut [Self], memory: &mut [Self]);
}

/// Four lanes, which can change places.
pub(crate) trait Simd4: SimdFloat {
    /// The first four numbers, zeros where there are fewer.
    fn load_partial(from: &[f64]) -> Self;
    /// Into the first four places, or those that there are.
    fn store_partial(self, to: &mut [f64]);
    /// Lane l is the sum of all lanes of the l-th.
    fn sums(of: [Self; 4]) -> Self;
    /// Lane l of the k-th is lane k of the l-th.
    fn transposed(of: [Self; 4]) -> [Self; 4];
}

/// Numbers that are divided and compared, lane by lane.
pub(crate) trait SimdFloat: Simd + Div<Output = Self> {
    /// The square root; not a number for negative ones.
    fn sqrt(self) -> Self;
    /// The size of `self` with the sign of `other`.
    fn copysign(self, other: Self) -> Self;
    /// The larger; of no number and one, anything.
    fn max(self, other: Self) -> Self;
    /// `then` where `a < b`, else `otherwise`, also where one of them is no number.
    fn select_lt(a: Self, b: Self, then: Self, otherwise: Self) -> Self;
    /// Zero where not `a > b`.
    #[inline(always)]
    fn zero_unless_gt(self, a: Self, b: Self) -> Self {
        Self::select_lt(b, a, self, Self::splat(0.0))
    }
}
