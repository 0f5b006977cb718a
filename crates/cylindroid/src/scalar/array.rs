//! SIMD lanes as a plain array: the fallback for other processors, and the reference that registers
//! are compared with.
//!
//! Checked  tests::registers_agree_with_arrays

use std::array::from_fn;
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::simd::{Simd, Simd4, SimdFloat};
use super::trig;

/// N lanes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Array<const N: usize>(pub(crate) [f64; N]);

macro_rules! lane_by_lane {
    ($trait:ident, $method:ident, $operator:tt) => {
        impl<const N: usize> $trait for Array<N> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(from_fn(|i| self.0[i] $operator other.0[i]))
            }
        }
    };
}

lane_by_lane!(Add, add, +);
lane_by_lane!(Sub, sub, -);
lane_by_lane!(Mul, mul, *);
lane_by_lane!(Div, div, /);

impl<const N: usize> Neg for Array<N> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self(self.0.map(|x| -x))
    }
}

impl<const N: usize> Simd for Array<N> {
    type Cpu = ();

    const LANES: usize = N;
    const FUSED: bool = false;

    #[inline(always)]
    fn splat(x: f64) -> Self {
        Self([x; N])
    }

    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        Self(from_fn(|i| from[i]))
    }

    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        to[..N].copy_from_slice(&self.0);
    }

    #[inline(always)]
    fn from_fn(f: impl Fn(usize) -> f64) -> Self {
        Self(from_fn(f))
    }

    #[inline(always)]
    fn gather(from: &[f64], stride: usize, to: &mut [Self]) {
        for (k, to) in to.iter_mut().enumerate() {
            *to = Self(from_fn(|l| from[l * stride + k]));
        }
    }

    #[inline(always)]
    fn scatter(from: &[Self], to: &mut [f64], stride: usize) {
        for l in 0..N {
            for (x, to) in from.iter().zip(&mut to[l * stride..]) {
                *to = x.0[l];
            }
        }
    }

    #[inline(always)]
    fn sum(self) -> f64 {
        // Halves first, in the order of registers.
        let mut lanes = self.0;
        let mut half = N;
        while half > 1 {
            half /= 2;
            for l in 0..half {
                lanes[l] += lanes[l + half];
            }
        }
        lanes[0]
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        self * b + c
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.map(f64::abs))
    }

    #[inline(always)]
    fn swap_if_odd(a: Self, b: Self, bits: Self) -> (Self, Self) {
        let pairs: [_; N] = from_fn(|i| f64::swap_if_odd(a.0[i], b.0[i], bits.0[i]));
        (Self(pairs.map(|p| p.0)), Self(pairs.map(|p| p.1)))
    }

    #[inline(always)]
    fn negate_if_second_bit(self, bits: Self, more: u64) -> Self {
        Self(from_fn(|i| self.0[i].negate_if_second_bit(bits.0[i], more)))
    }

    #[inline(always)]
    fn all_abs_le(self, limit: f64) -> bool {
        self.0.iter().all(|x| x.abs() <= limit)
    }

    #[inline(always)]
    fn sines_cosines(x: &mut [Self], sines: &mut [Self], memory: &mut [Self]) {
        trig::sines_cosines(x, sines, memory);
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

impl Simd4 for Array<4> {
    #[inline(always)]
    fn load_partial(from: &[f64]) -> Self {
        Self(from_fn(|i| from.get(i).copied().unwrap_or(0.0)))
    }

    #[inline(always)]
    fn store_partial(self, to: &mut [f64]) {
        to.iter_mut().zip(self.0).for_each(|(to, x)| *to = x);
    }

    #[inline(always)]
    fn sums(of: [Self; 4]) -> Self {
        // Neighbours first, in the order of registers.
        Self(of.map(|Self([a, b, c, d])| (a + b) + (c + d)))
    }

    #[inline(always)]
    fn transposed(of: [Self; 4]) -> [Self; 4] {
        from_fn(|k| Self(from_fn(|l| of[l].0[k])))
    }
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::super::{Avx2, Avx512, Lanes4, Lanes8, MAX_LANES};
    use super::*;

    fn bits<R: Simd>(of: &[R]) -> Vec<u64> {
        let mut lanes = [0.0; MAX_LANES];
        of.iter().flat_map(|x| (x.store(&mut lanes), lanes.map(f64::to_bits)).1).collect()
    }

    /// Registers agree with arrays to the bit: rows of any length, any numbers.
    #[inline(always)]
    fn as_arrays<R: SimdFloat, const N: usize>(_: R::Cpu) {
        for n in 0..=9 {
            for stride in [n, n + 1, n + 5] {
                let from: Vec<f64> = (0..(N - 1) * stride + n).map(|i| i as f64 * 0.37).collect();
                let (mut a, mut b) = (vec![R::splat(0.0); n], vec![Array::<N>::splat(0.0); n]);
                R::gather(&from, stride, &mut a);
                Array::gather(&from, stride, &mut b);
                assert_eq!(bits(&a), bits(&b), "{n} numbers, {stride} apart");
                let (mut to, mut expected) = (vec![-1.0; from.len()], vec![-1.0; from.len()]);
                R::scatter(&a, &mut to, stride);
                Array::scatter(&b, &mut expected, stride);
                assert_eq!(to, expected, "{n} numbers, {stride} apart");
            }
        }
        let some = [0.0, -0.0, 1.5, -2.0, 1e5, -1e300, f64::NAN, f64::INFINITY];
        let whole = 6_755_399_441_055_744.0;
        for turn in 0..some.len() {
            let x: [f64; MAX_LANES] = from_fn(|l| some[(turn + l) % some.len()]);
            let y: [f64; MAX_LANES] = from_fn(|l| whole + ((turn * 3 + l) % 7) as f64 - 3.0);
            let ((a, c), (b, d)) =
                ((R::load(&x), R::load(&y)), (Array::<N>::load(&x), Array::<N>::load(&y)));
            let swapped = (R::swap_if_odd(a, c, c), Array::swap_if_odd(b, d, d));
            for (a, b) in [
                (a.abs(), b.abs()),
                (-a, -b),
                (swapped.0.0, swapped.1.0),
                (swapped.0.1, swapped.1.1),
                (a.negate_if_second_bit(c, 0), b.negate_if_second_bit(d, 0)),
                (a.negate_if_second_bit(c, 1), b.negate_if_second_bit(d, 1)),
                (a / c, b / d),
                (a.abs().sqrt(), b.abs().sqrt()),
                (c.copysign(a), d.copysign(b)),
                (
                    (c - R::splat(whole)).max(R::splat(0.5)),
                    (d - Array::splat(whole)).max(Array::splat(0.5)),
                ),
                (R::select_lt(a, c, a, c), Array::select_lt(b, d, b, d)),
            ] {
                assert_eq!(bits(&[a]), bits(&[b]), "{x:?} {y:?}");
            }
            for limit in [0.0, 1e5, f64::MAX, f64::INFINITY] {
                assert_eq!(a.all_abs_le(limit), b.all_abs_le(limit), "{x:?} {limit}");
                let (a, b) = (a.mul_add(R::splat(0.0), c), b.mul_add(Array::splat(0.0), d));
                assert_eq!(a.all_abs_le(limit), b.all_abs_le(limit));
            }
            let (a, b) = (c - R::splat(whole), d - Array::splat(whole));
            assert_eq!(a.sum(), b.sum());
        }
    }

    #[target_feature(enable = "avx2,fma")]
    fn four(cpu: Avx2) {
        as_arrays::<Lanes4, 4>(cpu);
    }

    #[target_feature(enable = "avx512f,avx2,fma")]
    fn eight(cpu: Avx512) {
        as_arrays::<Lanes8, 8>(cpu);
    }

    #[test]
    #[allow(unsafe_code)]
    fn registers_agree_with_arrays() {
        // SAFETY: the token of each proves that the processor has its features.
        unsafe {
            if let Some(cpu) = Avx2::detect() {
                four(cpu);
            }
            if let Some(cpu) = Avx512::detect() {
                eight(cpu);
            }
        }
    }
}
