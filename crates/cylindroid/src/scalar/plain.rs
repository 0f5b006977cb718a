//! One lane: a plain f64, the specification of every kernel.
//!
//! Checked  src/kinematics/serial_batched.rs::lanes_agree_with_plain_numbers

use super::simd::{Simd, SimdFloat};
use super::trig;

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

    #[inline(always)]
    fn sines_cosines(x: &mut [Self], sines: &mut [Self], memory: &mut [Self]) {
        trig::sines_cosines(x, sines, memory);
    }
}

impl SimdFloat for f64 {
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.sqrt()
    }

    #[inline(always)]
    fn copysign(self, other: Self) -> Self {
        self.copysign(other)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }

    #[inline(always)]
    fn select_lt(a: Self, b: Self, then: Self, otherwise: Self) -> Self {
        if a < b { then } else { otherwise }
    }
}
