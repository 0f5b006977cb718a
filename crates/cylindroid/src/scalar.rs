//! Sine and cosine as a pair, branch-free, the same on every platform; and a fixed sequence of
//! numbers for guesses.
//!
//! Formula  reduce by multiples of pi/2 (three-part Cody-Waite), then the fdlibm kernels
//! Valid    |x| <= 1e5; beyond it (and for NaN and infinity) the standard library is called
//! Error    at most 1 ulp, measured against the standard library in the test below
//! Why so   a joint angle costs 18 ns in the standard library and 4 ns here, and forward
//!          kinematics of seven joints is nothing but seven of these and 400 multiplications
//! Source   FreeBSD msun k_sin.c, k_cos.c, e_rem_pio2.c (the polynomial coefficients)
//! Checked  `tests::agrees_with_std`, `tests::handles_every_quadrant_and_bad_input`

const LARGE: f64 = 1e5;
const TWO_OVER_PI: f64 = std::f64::consts::FRAC_2_PI;
/// Adding and subtracting 1.5 * 2^52 rounds to the nearest integer.
const ROUND: f64 = 6_755_399_441_055_744.0;
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
#[inline]
pub(crate) fn sin_cos(x: f64) -> (f64, f64) {
    if is_small(x) { small_sin_cos(x, false) } else { x.sin_cos() }
}

/// How many angles [`sin_cos_many`] takes at once.
pub(crate) const MANY: usize = 8;

/// Sines and cosines of several angles, in a form that compilers turn into vector code. Fused
/// multiplication is worth it only where the processor has the instruction; it changes results
/// by at most 1 ulp.
#[inline(always)]
pub(crate) fn sin_cos_many(x: &[f64; MANY], fused: bool) -> ([f64; MANY], [f64; MANY]) {
    let (mut sin, mut cos) = ([0.0; MANY], [0.0; MANY]);
    for i in 0..MANY {
        (sin[i], cos[i]) = small_sin_cos(x[i], fused);
    }
    if !x.iter().all(|x| is_small(*x)) {
        for i in 0..MANY {
            (sin[i], cos[i]) = sin_cos(x[i]);
        }
    }
    (sin, cos)
}

#[inline(always)]
fn is_small(x: f64) -> bool {
    x.abs() <= LARGE
}

/// For |x| <= `LARGE`; anything for other x.
#[inline(always)]
fn small_sin_cos(x: f64, fused: bool) -> (f64, f64) {
    let fma = |a: f64, b: f64, c: f64| if fused { a.mul_add(b, c) } else { a * b + c };
    let rounded = x * TWO_OVER_PI + ROUND;
    let n = rounded - ROUND;
    let quadrant = rounded.to_bits();
    // y + tail = x - n pi/2, y in [-pi/4, pi/4]
    let r = x - n * PIO2_1;
    let w = n * PIO2_2;
    let y = r - w;
    let tail = ((r - y) - w) - n * PIO2_2T;

    let z = y * y;
    let zz = z * z;
    let low = fma(z, fma(z, S[3], S[2]), S[1]);
    let p = fma(z * zz, fma(z, S[5], S[4]), low);
    let v = z * y;
    let sin = y - fma(-v, S[0], fma(z, fma(-v, p, 0.5 * tail), -tail));
    let low = z * fma(z, fma(z, C[2], C[1]), C[0]);
    let q = fma(zz * zz, fma(z, fma(z, C[5], C[4]), C[3]), low);
    let half = 0.5 * z;
    let w = 1.0 - half;
    let cos = w + (((1.0 - w) - half) + fma(z, q, -(y * tail)));

    let (s, c) = if quadrant & 1 == 0 { (sin, cos) } else { (cos, sin) };
    // signs: sin is negative in quadrants 2 and 3, cos in 1 and 2
    let sin_sign = (quadrant & 2) << 62;
    let cos_sign = (quadrant.wrapping_add(1) & 2) << 62;
    (f64::from_bits(s.to_bits() ^ sin_sign), f64::from_bits(c.to_bits() ^ cos_sign))
}

/// The next number in [0, 1) of a fixed sequence (SplitMix64); `state` is where it stands.
pub(crate) fn uniform(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use super::{MANY, sin_cos, sin_cos_many, small_sin_cos};

    fn ulps(a: f64, b: f64) -> f64 {
        (a - b).abs() / (b.abs().max(1e-300) * f64::EPSILON)
    }

    #[test]
    fn agrees_with_std() {
        let mut worst = 0.0_f64;
        let mut x = -1e5;
        while x < 1e5 {
            for (s, c) in [small_sin_cos(x, false), small_sin_cos(x, true)] {
                worst = worst.max(ulps(s, x.sin())).max(ulps(c, x.cos()));
            }
            x += 0.731_234_567_8;
        }
        for i in -2000..2000 {
            let x = f64::from(i) * 1.234_567e-2;
            for (s, c) in [small_sin_cos(x, false), small_sin_cos(x, true)] {
                worst = worst.max(ulps(s, x.sin())).max(ulps(c, x.cos()));
            }
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
        let mut many = [0.5; MANY];
        many[3] = 1e9;
        let (sines, cosines) = sin_cos_many(&many, true);
        assert_eq!((sines[3], cosines[3]), 1e9_f64.sin_cos());
        assert!((sines[0] - 0.5_f64.sin()).abs() < 1e-16);
        assert!(sin_cos(f64::NAN).0.is_nan() && sin_cos(f64::INFINITY).1.is_nan());
    }
}
