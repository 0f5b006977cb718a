//! Quotients, roots and choices of lanes: what eliminations need beside products.
//!
//! For numbers, arrays and four lanes; eight lanes are not asked for it.

#![allow(unsafe_code)] // intrinsics

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::*;
use std::array::from_fn;
use std::ops::Div;

#[cfg(target_arch = "x86_64")]
use super::Lanes4;
use super::{Array, Simd};

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

impl<const N: usize> Div for Array<N> {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Self(from_fn(|i| self.0[i] / other.0[i]))
    }
}

impl<const N: usize> SimdFloat for Array<N> {
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.map(f64::sqrt))
    }

    #[inline(always)]
    fn copysign(self, other: Self) -> Self {
        Self(from_fn(|i| self.0[i].copysign(other.0[i])))
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(from_fn(|i| SimdFloat::max(self.0[i], other.0[i])))
    }

    #[inline(always)]
    fn select_lt(a: Self, b: Self, then: Self, otherwise: Self) -> Self {
        Self(from_fn(|i| f64::select_lt(a.0[i], b.0[i], then.0[i], otherwise.0[i])))
    }
}

// SAFETY, for every call below: see the head of avx2.rs.
#[cfg(target_arch = "x86_64")]
impl Div for Lanes4 {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm256_div_pd(self.0, other.0) })
    }
}

#[cfg(target_arch = "x86_64")]
impl SimdFloat for Lanes4 {
    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm256_sqrt_pd(self.0) })
    }

    #[inline(always)]
    fn copysign(self, other: Self) -> Self {
        // SAFETY: as above.
        unsafe {
            let sign = _mm256_set1_pd(-0.0);
            Self(_mm256_or_pd(_mm256_andnot_pd(sign, self.0), _mm256_and_pd(sign, other.0)))
        }
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm256_max_pd(self.0, other.0) })
    }

    #[inline(always)]
    fn select_lt(a: Self, b: Self, then: Self, otherwise: Self) -> Self {
        // SAFETY: as above.
        unsafe {
            let less = _mm256_cmp_pd::<_CMP_LT_OQ>(a.0, b.0);
            Self(_mm256_blendv_pd(otherwise.0, then.0, less))
        }
    }
}
