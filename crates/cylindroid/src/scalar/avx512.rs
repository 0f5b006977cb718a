//! Eight SIMD lanes in an AVX-512 register of x86-64.
//!
//! Valid    values exist only inside functions that are compiled for AVX-512F, AVX2 and FMA and
//!          take [`Avx512`], the proof that the processor has them
//! Checked  src/scalar/array.rs::registers_agree_with_arrays,
//!          src/scalar/trig.rs::lanes_agree_with_std

#![allow(unsafe_code)] // intrinsics

use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::avx2::{Lanes4, operators, rows_in, rows_of, store_rest, store_rows, transposed_rows};
use super::cpu::Avx512;
use super::simd::{Simd, SimdFloat};
use super::trig;

/// The bit of the sign.
const SIGN: i64 = i64::MIN;

/// Eight numbers.
#[derive(Debug, Clone, Copy)]
#[repr(transparent)]
pub(crate) struct Lanes8(__m512d);

operators!(Lanes8, _mm512_add_pd, _mm512_sub_pd, _mm512_mul_pd);

impl Lanes8 {
    #[inline(always)]
    fn halves(self) -> [Lanes4; 2] {
        // SAFETY: see the head of this file.
        unsafe {
            [Lanes4(_mm512_castpd512_pd256(self.0)), Lanes4(_mm512_extractf64x4_pd::<1>(self.0))]
        }
    }

    #[inline(always)]
    fn of_halves(low: Lanes4, high: Lanes4) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm512_insertf64x4::<1>(_mm512_castpd256_pd512(low.0), high.0) })
    }
}

impl Neg for Lanes8 {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe {
            _mm512_castsi512_pd(_mm512_xor_si512(
                _mm512_castpd_si512(self.0),
                _mm512_set1_epi64(SIGN),
            ))
        })
    }
}

impl Div for Lanes8 {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm512_div_pd(self.0, other.0) })
    }
}

impl SimdFloat for Lanes8 {
    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm512_sqrt_pd(self.0) })
    }

    #[inline(always)]
    fn copysign(self, other: Self) -> Self {
        // SAFETY: see the head of this file.
        unsafe {
            let (a, b) = (_mm512_castpd_si512(self.0), _mm512_castpd_si512(other.0));
            let sign = _mm512_set1_epi64(SIGN);
            let both = _mm512_or_si512(_mm512_andnot_si512(sign, a), _mm512_and_si512(sign, b));
            Self(_mm512_castsi512_pd(both))
        }
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm512_max_pd(self.0, other.0) })
    }

    #[inline(always)]
    fn select_lt(a: Self, b: Self, then: Self, otherwise: Self) -> Self {
        // SAFETY: see the head of this file.
        unsafe {
            let less = _mm512_cmp_pd_mask::<_CMP_LT_OQ>(a.0, b.0);
            Self(_mm512_mask_blend_pd(less, otherwise.0, then.0))
        }
    }
}

impl Simd for Lanes8 {
    type Cpu = Avx512;

    const LANES: usize = 8;
    const FUSED: bool = true;

    #[inline(always)]
    fn splat(x: f64) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm512_set1_pd(x) })
    }

    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        let from = &from[..8];
        // SAFETY: eight numbers are there; see the head of this file.
        Self(unsafe { _mm512_loadu_pd(from.as_ptr()) })
    }

    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        let to = &mut to[..8];
        // SAFETY: eight places are there; see the head of this file.
        unsafe { _mm512_storeu_pd(to.as_mut_ptr(), self.0) }
    }

    #[inline(always)]
    fn from_fn(f: impl Fn(usize) -> f64) -> Self {
        let x = [f(0), f(1), f(2), f(3), f(4), f(5), f(6), f(7)];
        // SAFETY: see the head of this file.
        Self(unsafe { _mm512_setr_pd(x[0], x[1], x[2], x[3], x[4], x[5], x[6], x[7]) })
    }

    #[inline(always)]
    fn gather(from: &[f64], stride: usize, to: &mut [Self]) {
        let n = to.len();
        if n < 4 {
            for (k, x) in to.iter_mut().enumerate() {
                *x = Self::from_fn(|l| from[l * stride + k]);
            }
            return;
        }
        let from = rows_in(from, stride, n, Self::LANES);
        // The last block may begin in the one before.
        for k in (0..n.div_ceil(4)).map(|block| (4 * block).min(n - 4)) {
            // SAFETY: `rows_in` has looked that these numbers are there.
            let [low, high] = unsafe {
                let low = from.add(k);
                [transposed_rows(low, stride), transposed_rows(low.add(4 * stride), stride)]
            };
            for ((x, low), high) in to[k..k + 4].iter_mut().zip(low).zip(high) {
                *x = Self::of_halves(low, high);
            }
        }
    }

    #[inline(always)]
    fn scatter(from: &[Self], to: &mut [f64], stride: usize) {
        // As twice four lanes.
        let (fours, rest) = from.as_chunks::<4>();
        let to = rows_of(to, stride, from.len(), Self::LANES);
        let half = 4 * stride;
        for (k, four) in fours.iter().enumerate() {
            // SAFETY: `rows_of` has looked that these places are there.
            unsafe {
                let (four, to) = (four.as_ptr().cast::<f64>(), to.add(4 * k));
                store_rows(transposed_rows(four, Self::LANES), to, stride);
                store_rows(transposed_rows(four.add(4), Self::LANES), to.add(half), stride);
            }
        }
        let done = 4 * fours.len();
        let zero = Lanes4::splat(0.0);
        let (mut low, mut high) = ([zero; 3], [zero; 3]);
        for ((x, low), high) in rest.iter().zip(&mut low).zip(&mut high) {
            [*low, *high] = x.halves();
        }
        // SAFETY: as above.
        unsafe {
            store_rest(&low[..rest.len()], to.add(done), stride);
            store_rest(&high[..rest.len()], to.add(done + half), stride);
        }
    }

    #[inline(always)]
    fn sum(self) -> f64 {
        let [low, high] = self.halves();
        (low + high).sum()
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm512_fmadd_pd(self.0, b.0, c.0) })
    }

    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm512_abs_pd(self.0) })
    }

    #[inline(always)]
    fn swap_if_odd(a: Self, b: Self, bits: Self) -> (Self, Self) {
        // SAFETY: see the head of this file.
        unsafe {
            let odd = _mm512_test_epi64_mask(_mm512_castpd_si512(bits.0), _mm512_set1_epi64(1));
            (Self(_mm512_mask_blend_pd(odd, a.0, b.0)), Self(_mm512_mask_blend_pd(odd, b.0, a.0)))
        }
    }

    #[inline(always)]
    fn negate_if_second_bit(self, bits: Self, more: u64) -> Self {
        // SAFETY: see the head of this file.
        unsafe {
            let sum = _mm512_add_epi64(
                _mm512_castpd_si512(bits.0),
                _mm512_set1_epi64(more.cast_signed()),
            );
            let second = _mm512_and_si512(_mm512_slli_epi64::<62>(sum), _mm512_set1_epi64(SIGN));
            Self(_mm512_castsi512_pd(_mm512_xor_si512(_mm512_castpd_si512(self.0), second)))
        }
    }

    #[inline(always)]
    fn all_abs_le(self, limit: f64) -> bool {
        // SAFETY: see the head of this file.
        unsafe {
            let size = _mm512_abs_pd(self.0);
            _mm512_cmp_pd_mask::<_CMP_LE_OQ>(size, _mm512_set1_pd(limit)) == 0xff
        }
    }

    #[inline(always)]
    fn sines_cosines(x: &mut [Self], sines: &mut [Self], memory: &mut [Self]) {
        // SAFETY: see the head of this file.
        unsafe { sines_cosines(x, sines, memory) }
    }
}

#[target_feature(enable = "avx512f,avx2,fma")]
#[inline(never)]
fn sines_cosines(x: &mut [Lanes8], sines: &mut [Lanes8], memory: &mut [Lanes8]) {
    trig::sines_cosines(x, sines, memory);
}
