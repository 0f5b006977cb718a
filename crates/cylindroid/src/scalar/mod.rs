//! SIMD lanes: the numbers that kernels compute with, one f64 or several at a time.
//!
//! A kernel is written once over [`Simd`] and compiled for plain numbers (its specification), for
//! registers of four or eight lanes, and for arrays on other processors. Registers need a token
//! that proves the CPU feature ([`Avx2`], [`Avx512`]).

mod array;
#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod bracket;
#[cfg(target_arch = "x86_64")]
mod cpu;
mod fnv1a;
mod nearest_turn;
mod plain;
mod power_of_two;
mod simd;
mod splitmix64;
mod trig;

pub(crate) use array::Array;
#[cfg(target_arch = "x86_64")]
pub(crate) use avx2::Lanes4;
#[cfg(target_arch = "x86_64")]
pub(crate) use avx512::Lanes8;
pub(crate) use bracket::Bracket;
#[cfg(target_arch = "x86_64")]
pub(crate) use cpu::{Avx2, Avx512};
pub(crate) use fnv1a::fnv1a;
pub(crate) use nearest_turn::nearest_turn;
pub(crate) use power_of_two::power_of_two;
pub(crate) use simd::{MAX_LANES, Simd, Simd4, SimdFloat};
pub(crate) use splitmix64::uniform;
pub(crate) use trig::{atan2, sin_cos};

/// How kernels round: of two processors with one name all results are the same to the bit.
/// Registers of four and eight lanes agree, plain numbers round each product.
#[cfg(feature = "sweep")]
#[must_use]
pub(crate) fn arithmetic() -> &'static str {
    #[cfg(target_arch = "x86_64")]
    if Avx2::detect().is_some() {
        return "x86_64 with fused multiply-add";
    }
    std::env::consts::ARCH
}

/// The largest number between one that fits and one that does not, after so many halvings.
pub(crate) fn largest(
    fitting: f64,
    other: f64,
    halvings: usize,
    mut fits: impl FnMut(f64) -> bool,
) -> f64 {
    let (mut inside, mut outside) = (fitting, other);
    for _ in 0..halvings {
        let middle = 0.5 * (inside + outside);
        if fits(middle) {
            inside = middle;
        } else {
            outside = middle;
        }
    }
    inside
}

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
