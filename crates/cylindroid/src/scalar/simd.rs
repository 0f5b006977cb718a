//! The traits of SIMD lanes that kernels are written over: arithmetic, comparison, shuffles.
//!
//! Shapes   a value holds [`Simd::LANES`] numbers; every operation acts on each lane alone, except
//!          where it says otherwise
//! Why so   three traits, because kinematics needs sums and products only ([`Simd`]), eliminations
//!          division and comparison ([`SimdFloat`]), and four lanes alone are transposed ([`Simd4`])

use std::ops::{Add, Div, Mul, Neg, Sub};

/// Maximum number of lanes.
pub(crate) const MAX_LANES: usize = 8;

/// One number, or several in SIMD lanes.
pub(crate) trait Simd:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    /// Proof that the processor has what these lanes need; `()` where they need nothing.
    type Cpu: Copy;
    /// Number of lanes.
    const LANES: usize;
    /// True if [`Simd::mul_add`] rounds once.
    const FUSED: bool;
    /// The same number in all lanes.
    fn splat(x: f64) -> Self;
    /// Loads the first `LANES` numbers.
    fn load(from: &[f64]) -> Self;
    /// Stores into the first `LANES` places.
    fn store(self, to: &mut [f64]);
    /// Lane l is `f(l)`.
    fn from_fn(f: impl Fn(usize) -> f64) -> Self;
    /// Transposing load: lane l of `to[k]` is `from[l * stride + k]`.
    fn gather(from: &[f64], stride: usize, to: &mut [Self]);
    /// Transposing store: lane l of `from[k]` goes to `to[l * stride + k]`.
    fn scatter(from: &[Self], to: &mut [f64], stride: usize);
    /// The sum of all lanes.
    fn sum(self) -> f64;
    /// `self * b + c`, with one rounding if [`Simd::FUSED`].
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// The absolute value.
    fn abs(self) -> Self;
    /// `(a, b)`, in lanes where the lowest bit of `bits` is set `(b, a)`.
    fn swap_if_odd(a: Self, b: Self, bits: Self) -> (Self, Self);
    /// Negated in lanes where the second bit of `bits + more` (as integers) is set.
    fn negate_if_second_bit(self, bits: Self, more: u64) -> Self;
    /// True if the absolute value of every lane is at most `limit`; false for NaN.
    fn all_abs_le(self, limit: f64) -> bool;
    /// [`super::sin_cos`] of each of `x`: cosines replace the angles; `memory` is overwritten.
    ///
    /// For registers this is a function of its own: its constants occupy many registers, and
    /// inlining would spill those of the caller.
    ///
    /// # Panics
    /// If the lengths differ.
    fn sines_cosines(x: &mut [Self], sines: &mut [Self], memory: &mut [Self]);
}

/// Four lanes that can be shuffled.
pub(crate) trait Simd4: SimdFloat {
    /// Loads up to four numbers, zeros in the other lanes.
    fn load_partial(from: &[f64]) -> Self;
    /// Stores into up to four places.
    fn store_partial(self, to: &mut [f64]);
    /// Lane l is the sum of all lanes of the l-th value.
    fn sums(of: [Self; 4]) -> Self;
    /// The transpose: lane l of the k-th value is lane k of the l-th.
    fn transposed(of: [Self; 4]) -> [Self; 4];
}

/// Division, square roots and selection, lane by lane: the operations of eliminations.
pub(crate) trait SimdFloat: Simd + Div<Output = Self> {
    /// The square root; NaN for negative numbers.
    fn sqrt(self) -> Self;
    /// The absolute value of `self` with the sign of `other`.
    fn copysign(self, other: Self) -> Self;
    /// The larger of both; unspecified if one is NaN.
    fn max(self, other: Self) -> Self;
    /// `then` where `a < b`; `otherwise` elsewhere, also where one of them is NaN.
    fn select_lt(a: Self, b: Self, then: Self, otherwise: Self) -> Self;
    /// `self` where `a > b`; zero elsewhere.
    #[inline(always)]
    fn zero_unless_gt(self, a: Self, b: Self) -> Self {
        Self::select_lt(b, a, self, Self::splat(0.0))
    }
}
