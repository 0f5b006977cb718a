//! Four SIMD lanes in an AVX2 register of x86-64.
//!
//! Valid    values exist only inside functions that are compiled for AVX2 and FMA and take
//!          [`Avx2`], the proof that the processor has them
//! Checked  src/scalar/array.rs::registers_agree_with_arrays,
//!          src/scalar/trig.rs::lanes_agree_with_std

#![allow(unsafe_code)] // intrinsics

use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::cpu::Avx2;
use super::simd::{Simd, Simd4, SimdFloat};
use super::trig;

/// Addition, subtraction and multiplication by intrinsics.
macro_rules! operators {
    ($name:ident, $add:ident, $sub:ident, $mul:ident) => {
        impl Add for $name {
            type Output = Self;

            #[inline(always)]
            fn add(self, other: Self) -> Self {
                // SAFETY: see the head of this file.
                Self(unsafe { $add(self.0, other.0) })
            }
        }

        impl Sub for $name {
            type Output = Self;

            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                // SAFETY: see the head of this file.
                Self(unsafe { $sub(self.0, other.0) })
            }
        }

        impl Mul for $name {
            type Output = Self;

            #[inline(always)]
            fn mul(self, other: Self) -> Self {
                // SAFETY: see the head of this file.
                Self(unsafe { $mul(self.0, other.0) })
            }
        }
    };
}

pub(super) use operators;

/// Four lanes.
#[derive(Debug, Clone, Copy)]
#[repr(transparent)]
pub(crate) struct Lanes4(pub(crate) __m256d);

operators!(Lanes4, _mm256_add_pd, _mm256_sub_pd, _mm256_mul_pd);

impl Neg for Lanes4 {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm256_xor_pd(self.0, _mm256_set1_pd(-0.0)) })
    }
}

/// The first of `rows` rows of `length` numbers, `stride` apart.
///
/// # Panics
/// If the slice is too short.
#[inline(always)]
pub(super) fn rows_of(to: &mut [f64], stride: usize, length: usize, rows: usize) -> *mut f64 {
    // The first condition keeps the second from overflowing.
    assert!(stride <= to.len() && to.len() >= (rows - 1) * stride + length, "rows are missing");
    to.as_mut_ptr()
}

/// The first of `rows` rows of `length` numbers, `stride` apart.
///
/// # Panics
/// If the slice is too short.
#[inline(always)]
pub(super) fn rows_in(from: &[f64], stride: usize, length: usize, rows: usize) -> *const f64 {
    // The first condition keeps the second from overflowing.
    assert!(stride <= from.len() && from.len() >= (rows - 1) * stride + length, "rows are missing");
    from.as_ptr()
}

/// A mask: the sign bit is set in the lanes that have numbers.
#[inline(always)]
fn lanes_of(numbers: &[f64]) -> __m256i {
    const FIRST: [i64; 8] = [-1, -1, -1, -1, 0, 0, 0, 0];
    let window = &FIRST[4 - numbers.len().min(4)..][..4];
    // SAFETY: four integers are there; see the head of this file.
    unsafe { _mm256_loadu_si256(window.as_ptr().cast()) }
}

impl Simd4 for Lanes4 {
    #[inline(always)]
    fn load_partial(from: &[f64]) -> Self {
        // SAFETY: the mask excludes places beyond the slice; see the head of this file.
        Self(unsafe { _mm256_maskload_pd(from.as_ptr(), lanes_of(from)) })
    }

    #[inline(always)]
    fn store_partial(self, to: &mut [f64]) {
        // SAFETY: the mask excludes places beyond the slice; see the head of this file.
        unsafe { _mm256_maskstore_pd(to.as_mut_ptr(), lanes_of(to), self.0) }
    }

    #[inline(always)]
    fn sums([Self(a), Self(b), Self(c), Self(d)]: [Self; 4]) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe {
            // a0 + a1, b0 + b1, a2 + a3, b2 + b3, and the same of c and d
            let (ab, cd) = (_mm256_hadd_pd(a, b), _mm256_hadd_pd(c, d));
            let across = _mm256_permute2f128_pd::<0x21>(ab, cd);
            _mm256_add_pd(_mm256_blend_pd::<0b1100>(ab, cd), across)
        })
    }

    #[inline(always)]
    fn transposed([Self(a), Self(b), Self(c), Self(d)]: [Self; 4]) -> [Self; 4] {
        // SAFETY: see the head of this file.
        unsafe {
            // a0 b0 a2 b2, a1 b1 a3 b3, and the same of c and d
            let (ab_even, ab_odd) = (_mm256_unpacklo_pd(a, b), _mm256_unpackhi_pd(a, b));
            let (cd_even, cd_odd) = (_mm256_unpacklo_pd(c, d), _mm256_unpackhi_pd(c, d));
            [
                Self(_mm256_permute2f128_pd::<0x20>(ab_even, cd_even)),
                Self(_mm256_permute2f128_pd::<0x20>(ab_odd, cd_odd)),
                Self(_mm256_permute2f128_pd::<0x31>(ab_even, cd_even)),
                Self(_mm256_permute2f128_pd::<0x31>(ab_odd, cd_odd)),
            ]
        }
    }
}

/// Four numbers of each of four rows, `stride` apart: lane l of the k-th is the k-th of row l.
///
/// # Safety
/// They are there; see the head of this file.
#[inline(always)]
pub(super) unsafe fn transposed_rows(from: *const f64, stride: usize) -> [Lanes4; 4] {
    // SAFETY: as said above.
    unsafe {
        // a0 a1 c0 c1, a2 a3 c2 c3, and the same of b and d
        let (ac, ac_rest) = (pairs(from, 2 * stride), pairs(from.add(2), 2 * stride));
        let from = from.add(stride);
        let (bd, bd_rest) = (pairs(from, 2 * stride), pairs(from.add(2), 2 * stride));
        [
            Lanes4(_mm256_unpacklo_pd(ac, bd)),
            Lanes4(_mm256_unpackhi_pd(ac, bd)),
            Lanes4(_mm256_unpacklo_pd(ac_rest, bd_rest)),
            Lanes4(_mm256_unpackhi_pd(ac_rest, bd_rest)),
        ]
    }
}

/// Two numbers, and two more `stride` after them.
///
/// # Safety
/// They are there; see the head of this file.
#[inline(always)]
unsafe fn pairs(from: *const f64, stride: usize) -> __m256d {
    // SAFETY: as said above.
    unsafe {
        let first = _mm256_castpd128_pd256(_mm_loadu_pd(from));
        _mm256_insertf128_pd::<1>(first, _mm_loadu_pd(from.add(stride)))
    }
}

/// Four rows, `stride` apart.
///
/// # Safety
/// The places are there; see the head of this file.
#[inline(always)]
pub(super) unsafe fn store_rows(rows: [Lanes4; 4], to: *mut f64, stride: usize) {
    for (l, row) in rows.into_iter().enumerate() {
        // SAFETY: as said above.
        unsafe { _mm256_storeu_pd(to.add(l * stride), row.0) };
    }
}

/// What is left over, of four rows, `stride` apart: at most three registers.
///
/// # Safety
/// The places are there; see the head of this file.
#[inline(always)]
pub(super) unsafe fn store_rest(rest: &[Lanes4], to: *mut f64, stride: usize) {
    // SAFETY: as said above.
    unsafe {
        let (twos, one) = rest.as_chunks::<2>();
        for (k, [a, b]) in twos.iter().enumerate() {
            let to = to.add(2 * k);
            let (even, odd) = (_mm256_unpacklo_pd(a.0, b.0), _mm256_unpackhi_pd(a.0, b.0));
            _mm_storeu_pd(to, _mm256_castpd256_pd128(even));
            _mm_storeu_pd(to.add(stride), _mm256_castpd256_pd128(odd));
            _mm_storeu_pd(to.add(2 * stride), _mm256_extractf128_pd::<1>(even));
            _mm_storeu_pd(to.add(3 * stride), _mm256_extractf128_pd::<1>(odd));
        }
        if let [x] = one {
            let to = to.add(2 * twos.len());
            let (low, high) = (_mm256_castpd256_pd128(x.0), _mm256_extractf128_pd::<1>(x.0));
            _mm_storel_pd(to, low);
            _mm_storeh_pd(to.add(stride), low);
            _mm_storel_pd(to.add(2 * stride), high);
            _mm_storeh_pd(to.add(3 * stride), high);
        }
    }
}

impl Simd for Lanes4 {
    type Cpu = Avx2;

    const LANES: usize = 4;
    const FUSED: bool = true;

    #[inline(always)]
    fn splat(x: f64) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm256_set1_pd(x) })
    }

    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        let from = &from[..4];
        // SAFETY: four numbers are there; see the head of this file.
        Self(unsafe { _mm256_loadu_pd(from.as_ptr()) })
    }

    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        let to = &mut to[..4];
        // SAFETY: four places are there; see the head of this file.
        unsafe { _mm256_storeu_pd(to.as_mut_ptr(), self.0) }
    }

    #[inline(always)]
    fn from_fn(f: impl Fn(usize) -> f64) -> Self {
        let [a, b, c, d] = [f(0), f(1), f(2), f(3)];
        // SAFETY: see the head of this file.
        Self(unsafe { _mm256_setr_pd(a, b, c, d) })
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
            let rows = unsafe { transposed_rows(from.add(k), stride) };
            to[k..k + 4].copy_from_slice(&rows);
        }
    }

    #[inline(always)]
    fn scatter(from: &[Self], to: &mut [f64], stride: usize) {
        let (fours, rest) = from.as_chunks::<4>();
        let to = rows_of(to, stride, from.len(), Self::LANES);
        for (k, four) in fours.iter().enumerate() {
            // SAFETY: `rows_of` has looked that these places are there.
            unsafe {
                let rows = transposed_rows(four.as_ptr().cast(), Self::LANES);
                store_rows(rows, to.add(4 * k), stride);
            }
        }
        // SAFETY: as above.
        unsafe { store_rest(rest, to.add(4 * fours.len()), stride) }
    }

    #[inline(always)]
    fn sum(self) -> f64 {
        // SAFETY: see the head of this file.
        unsafe {
            let half =
                _mm_add_pd(_mm256_castpd256_pd128(self.0), _mm256_extractf128_pd::<1>(self.0));
            _mm_cvtsd_f64(_mm_add_sd(half, _mm_unpackhi_pd(half, half)))
        }
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm256_fmadd_pd(self.0, b.0, c.0) })
    }

    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm256_andnot_pd(_mm256_set1_pd(-0.0), self.0) })
    }

    #[inline(always)]
    fn swap_if_odd(a: Self, b: Self, bits: Self) -> (Self, Self) {
        // SAFETY: see the head of this file.
        unsafe {
            // What is chosen by is the sign.
            let odd = _mm256_castsi256_pd(_mm256_slli_epi64::<63>(_mm256_castpd_si256(bits.0)));
            (Self(_mm256_blendv_pd(a.0, b.0, odd)), Self(_mm256_blendv_pd(b.0, a.0, odd)))
        }
    }

    #[inline(always)]
    fn negate_if_second_bit(self, bits: Self, more: u64) -> Self {
        // SAFETY: see the head of this file.
        unsafe {
            let sum = _mm256_castpd_si256(bits.0);
            let sum = match more {
                0 => sum,
                _ => _mm256_add_epi64(sum, _mm256_set1_epi64x(more.cast_signed())),
            };
            let second = _mm256_castsi256_pd(_mm256_slli_epi64::<62>(sum));
            Self(_mm256_xor_pd(self.0, _mm256_and_pd(second, _mm256_set1_pd(-0.0))))
        }
    }

    #[inline(always)]
    fn all_abs_le(self, limit: f64) -> bool {
        // SAFETY: see the head of this file.
        unsafe {
            let size = _mm256_andnot_pd(_mm256_set1_pd(-0.0), self.0);
            _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LE_OQ>(size, _mm256_set1_pd(limit))) == 0b1111
        }
    }

    #[inline(always)]
    fn sines_cosines(x: &mut [Self], sines: &mut [Self], memory: &mut [Self]) {
        // SAFETY: see the head of this file.
        unsafe { sines_cosines(x, sines, memory) }
    }
}

#[target_feature(enable = "avx2,fma")]
#[inline(never)]
fn sines_cosines(x: &mut [Lanes4], sines: &mut [Lanes4], memory: &mut [Lanes4]) {
    trig::sines_cosines(x, sines, memory);
}

impl Div for Lanes4 {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm256_div_pd(self.0, other.0) })
    }
}

impl SimdFloat for Lanes4 {
    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm256_sqrt_pd(self.0) })
    }

    #[inline(always)]
    fn copysign(self, other: Self) -> Self {
        // SAFETY: see the head of this file.
        unsafe {
            let sign = _mm256_set1_pd(-0.0);
            Self(_mm256_or_pd(_mm256_andnot_pd(sign, self.0), _mm256_and_pd(sign, other.0)))
        }
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm256_max_pd(self.0, other.0) })
    }

    #[inline(always)]
    fn select_lt(a: Self, b: Self, then: Self, otherwise: Self) -> Self {
        // SAFETY: see the head of this file.
        unsafe {
            let less = _mm256_cmp_pd::<_CMP_LT_OQ>(a.0, b.0);
            Self(_mm256_blendv_pd(otherwise.0, then.0, less))
        }
    }
}
