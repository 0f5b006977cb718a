//! The numbers that kernels compute with: one f64, or several side by side.
//!
//! A kernel is written once over [`Simd`] and compiled for plain numbers (the specification), for
//! one register of four or eight, and for arrays where the processor is another one.

mod array;
#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
#[cfg(target_arch = "x86_64")]
mod cpu;
mod simd_float;
mod splitmix64;
mod trig;

use std::ops::{Add, Mul, Neg, Sub};

pub(crate) use array::Array;
#[cfg(target_arch = "x86_64")]
pub(crate) use avx2::Lanes4;
#[cfg(target_arch = "x86_64")]
pub(crate) use avx512::Lanes8;
#[cfg(target_arch = "x86_64")]
pub(crate) use cpu::{Avx2, Avx512};
pub(crate) use simd_float::SimdFloat;
pub(crate) use splitmix64::uniform;
pub(crate) use trig::sin_cos;

/// The nearest number to `x` in [lower, upper]. NaN stays NaN; a NaN bound does not bound, where
/// `f64::clamp` panics.
#[inline]
pub(crate) fn clamp(x: f64, lower: f64, upper: f64) -> f64 {
    if x < lower {
        lower
    } else if x > upper {
        upper
    } else {
        x
    }
}

/// Lanes at the most.
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
    /// [`sin_cos`] of each of `x`: cosines take the place of the angles; `memory` is overwritten.
    ///
    /// Registers do this in a function of its own: its constants need many of them, which numbers
    /// of the caller would lose.
    ///
    /// # Panics
    /// If not all have one length.
    #[inline(always)]
    fn sines_cosines(x: &mut [Self], sines: &mut [Self], memory: &mut [Self]) {
        trig::sines_cosines(x, sines, memory);
    }
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

impl Simd for f64 {
    type Cpu = ();

    const LANES: usize = 1;
    const FUSED: bool = false;

    #[inline(always)]
    fn splat(x: f64) -> Self {
        x
    }

    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        from[0]
    }

    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        to[0] = self;
    }

    #[inline(always)]
    fn from_fn(f: impl Fn(usize) -> f64) -> Self {
        f(0)
    }

    #[inline(always)]
    fn gather(from: &[f64], _stride: usize, to: &mut [Self]) {
        to.copy_from_slice(&from[..to.len()]);
    }

    #[inline(always)]
    fn scatter(from: &[Self], to: &mut [f64], _stride: usize) {
        to[..from.len()].copy_from_slice(from);
    }

    #[inline(always)]
    fn sum(self) -> f64 {
        self
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        self * b + c
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.abs()
    }

    #[inline(always)]
    fn swap_if_odd(a: Self, b: Self, bits: Self) -> (Self, Self) {
        if bits.to_bits() & 1 == 0 { (a, b) } else { (b, a) }
    }

    #[inline(always)]
    fn negate_if_second_bit(self, bits: Self, more: u64) -> Self {
        let sign = (bits.to_bits().wrapping_add(more) & 2) << 62;
        Self::from_bits(self.to_bits() ^ sign)
    }

    #[inline(always)]
    fn all_abs_le(self, limit: f64) -> bool {
        self.abs() <= limit
    }
}
