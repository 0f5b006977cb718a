//! Sine and cosine as a pair, for one number or for SIMD lanes, and the arc tangent of one;
//! bit-identical on all processors with fused multiply-add, and on all without.
//!
//! Formula  reduction by multiples of pi/2 (Cody-Waite, in three parts or in two fused ones), then
//!          the polynomials of fdlibm; arc tangent: tan(a - pi/4) = (t - 1) / (t + 1) above 0.66,
//!          then a rational function
//! Valid    |x| <= 1e5; beyond it (and for NaN and infinity) the standard library is called
//! Error    0.8 ulp, with fused products 1.6, or 1e-27 where a sine or cosine is less than 1e-11:
//!          they agree with the standard library to 1 and 2 units in the last place; arc tangent
//!          3 ulp
//! Why so   a joint angle costs 18 ns in the standard library and 4 ns here, and forward kinematics
//!          of seven joints consists of seven of these and 400 multiplications
//! Source   FreeBSD msun k_sin.c, k_cos.c, e_rem_pio2.c (the polynomial coefficients); Cephes
//!          atan.c (the rational function)
//! Checked  tests::agrees_with_std, tests::arc_tangents_agree_with_std,
//!          tests::handles_every_quadrant_and_bad_input, tests::lanes_agree_with_std,
//!          tests::many_are_as_each

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use super::simd::{MAX_LANES, Simd};

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
pub(crate) fn sin_cos<R: Simd>(x: R) -> (R, R) {
    if x.all_abs_le(LARGE) { small(x) } else { beyond(x) }
}

/// [`sin_cos`] of each: cosines replace the angles; `memory` is overwritten.
///
/// Step by step, each for all angles: the steps of one angle depend on each other, and processors
/// reorder only some dozens of instructions.
///
/// # Panics
/// If the lengths differ.
#[inline(always)]
pub(super) fn sines_cosines<R: Simd>(x: &mut [R], sines: &mut [R], memory: &mut [R]) {
    let n = x.len();
    assert!(sines.len() == n && memory.len() == n, "as many sines as angles");
    // The sum bounds each of them.
    let mut sizes = R::splat(0.0);
    for x in &*x {
        sizes = sizes + x.abs();
    }
    if !(R::FUSED && sizes.all_abs_le(LARGE)) {
        for i in 0..n {
            (sines[i], x[i]) = sin_cos(x[i]);
        }
        return;
    }
    for i in 0..n {
        (x[i], memory[i]) = reduced(x[i]);
    }
    for i in 0..n {
        let z = x[i] * x[i];
        sines[i] = sine(x[i], z);
        x[i] = z;
    }
    for x in &mut *x {
        *x = cosine(*x);
    }
    for i in 0..n {
        (sines[i], x[i]) = in_quadrant(sines[i], x[i], memory[i]);
    }
}

/// The angle of (cos, sin), of any length between 1e-290 and 1e307, in [-pi, pi], to 3 ulp.
///
/// Takes half the time of the standard library's; the closed form calls it thirty times per pose.
#[inline]
pub(crate) fn atan2(sin: f64, cos: f64) -> f64 {
    const P: [f64; 5] = [
        -8.750_608_600_031_904e-1,
        -1.615_753_718_733_365e1,
        -7.500_855_792_314_705e1,
        -1.228_866_684_490_136_1e2,
        -6.485_021_904_942_025e1,
    ];
    const Q: [f64; 5] = [
        2.485_846_490_142_306_2e1,
        1.650_270_098_316_988_5e2,
        4.328_810_604_912_902_6e2,
        4.853_903_996_359_137e2,
        1.945_506_571_482_614e2,
    ];
    let (x, y) = (cos.abs(), sin.abs());
    let (low, high) = if y > x { (x, y) } else { (y, x) };
    // The tangent, or that of the complement to an eighth of a turn.
    let (up, down, base) =
        if low > 0.66 * high { (low - high, low + high, FRAC_PI_4) } else { (low, high, 0.0) };
    let t = up / down;
    let z = t * t;
    let p = (((P[0] * z + P[1]) * z + P[2]) * z + P[3]) * z + P[4];
    let q = ((((z + Q[0]) * z + Q[1]) * z + Q[2]) * z + Q[3]) * z + Q[4];
    let first = base + (t + t * (z * p / q));
    let upper = if y > x { FRAC_PI_2 - first } else { first };
    (if cos < 0.0 { PI - upper } else { upper }).copysign(sin)
}

/// For |x| <= `LARGE`; anything for other x.
#[inline(always)]
fn small<R: Simd>(x: R) -> (R, R) {
    if R::FUSED {
        let (y, bits) = reduced(x);
        let z = y * y;
        return in_quadrant(sine(y, z), cosine(z), bits);
    }
    let k = R::splat;
    let (n, bits) = quarters(x);
    // In three parts: products with the first ones are exact; the rest is carried along.
    let r = x - n * k(PIO2_1);
    let w = n * k(PIO2_2);
    let y = r - w;
    let tail = ((r - y) - w) - n * k(PIO2_2T);
    let (sin, cos) = with_tail(y, tail);
    in_quadrant(sin, cos, bits)
}

/// n, the whole number nearest to x / (pi/2), and a number whose lowest bits are those of n.
#[inline(always)]
fn quarters<R: Simd>(x: R) -> (R, R) {
    let rounded = x.mul_add(R::splat(TWO_OVER_PI), R::splat(ROUND));
    (rounded - R::splat(ROUND), rounded)
}

/// `x - n pi/2` in two parts, the first difference exact, as x is near `n pi/2`; and the bits of n.
#[inline(always)]
fn reduced<R: Simd>(x: R) -> (R, R) {
    let (n, bits) = quarters(x);
    let near = n.mul_add(R::splat(-PIO2_HIGH), x);
    (n.mul_add(R::splat(-PIO2_LOW), near), bits)
}

/// Sines and cosines change places in the odd quadrants; sines are negative in 2 and 3, cosines in
/// 1 and 2.
#[inline(always)]
fn in_quadrant<R: Simd>(sin: R, cos: R, bits: R) -> (R, R) {
    let (s, c) = R::swap_if_odd(sin, cos, bits);
    (s.negate_if_second_bit(bits, 0), c.negate_if_second_bit(bits, 1))
}

/// Of y in [-pi/4, pi/4], `z = y^2`.
#[inline(always)]
fn sine<R: Simd>(y: R, z: R) -> R {
    (y * z).mul_add(z.mul_add(polynomial(z, &S[1..]), R::splat(S[0])), y)
}

/// Of a number in [-pi/4, pi/4] with the square z.
#[inline(always)]
fn cosine<R: Simd>(z: R) -> R {
    (z * z).mul_add(polynomial(z, &C), z.mul_add(R::splat(-0.5), R::splat(1.0)))
}

/// Sine and cosine of y + tail, with the roundings of y carried along.
#[inline(always)]
fn with_tail<R: Simd>(y: R, tail: R) -> (R, R) {
    let k = R::splat;
    let z = y * y;
    let (p, q) = (polynomial(z, &S[1..]), polynomial(z, &C));
    let v = z * y;
    let sin = y - ((z * (k(0.5) * tail - v * p) - tail) - v * k(S[0]));
    let half = k(0.5) * z;
    let w = k(1.0) - half;
    let cos = w + (((k(1.0) - w) - half) + (z * z * q - y * tail));
    (sin, cos)
}

/// `a[0] + z (a[1] + z (a[2] + ...))`
#[inline(always)]
fn polynomial<R: Simd>(z: R, a: &[f64]) -> R {
    let mut sum = R::splat(a[a.len() - 1]);
    for a in a[..a.len() - 1].iter().rev() {
        sum = sum.mul_add(z, R::splat(*a));
    }
    sum
}

/// Where a lane is larger than `LARGE`: those by the standard library.
#[cold]
#[inline(never)]
fn beyond<R: Simd>(x: R) -> (R, R) {
    let (small_sin, small_cos) = small(x);
    let mut lanes = [0.0; MAX_LANES];
    let (mut sin, mut cos) = (lanes, lanes);
    x.store(&mut lanes);
    small_sin.store(&mut sin);
    small_cos.store(&mut cos);
    for (l, x) in lanes.into_iter().enumerate().filter(|(_, x)| !x.all_abs_le(LARGE)) {
        (sin[l], cos[l]) = x.sin_cos();
    }
    (R::load(&sin), R::load(&cos))
}

#[cfg(test)]
mod tests {
    use super::super::Array;
    #[cfg(target_arch = "x86_64")]
    use super::super::{Avx2, Avx512, Lanes4, Lanes8, MAX_LANES, Simd};
    use super::{atan2, sin_cos};
    #[cfg(target_arch = "x86_64")]
    use std::array::from_fn;

    /// In units in the last place of b.
    fn ulps(a: f64, b: f64) -> f64 {
        let unit = b.abs().max(1e-300);
        (a - b).abs() / (unit.next_up() - unit)
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
    fn arc_tangents_agree_with_std() {
        let mut x = -3.2_f64;
        while x < 3.2 {
            for size in [1e-12, 1.0, 3e9] {
                let (s, c) = (size * x.sin(), size * x.cos());
                let exact = s.atan2(c);
                let error = (atan2(s, c) - exact).abs() / (exact.abs() * f64::EPSILON);
                assert!(error <= 3.0, "{x}: {error} ulp");
            }
            x += 1.234_567e-4;
        }
        use std::f64::consts::{FRAC_PI_2, PI};
        for sin in [0.0, -0.0_f64] {
            assert_eq!(atan2(sin, 1.0).to_bits(), sin.to_bits());
            assert_eq!(atan2(sin, -1.0), PI.copysign(sin));
        }
        assert_eq!((atan2(1.0, 0.0), atan2(-1.0, -0.0)), (FRAC_PI_2, -FRAC_PI_2));
        // Both sides of the change of the formula.
        for tangent in [0.66_f64.next_down(), 0.66, 0.66_f64.next_up(), 1.0 / 0.66] {
            assert!((atan2(tangent, 1.0) - tangent.atan()).abs() < 3e-16, "{tangent}");
        }
        assert!(atan2(1.0, f64::NAN).is_nan() && atan2(f64::NAN, 1.0).is_nan());
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

    /// [`Simd::sines_cosines`] of rows of lanes: the sines and then the cosines of each row.
    #[cfg(target_arch = "x86_64")]
    macro_rules! of_lanes {
        ($name:ident, $lanes:ident, $cpu:ident, $features:literal) => {
            #[target_feature(enable = $features)]
            fn $name(_: $cpu, rows: &[[f64; MAX_LANES]]) -> Vec<[[f64; MAX_LANES]; 2]> {
                let mut x: Vec<$lanes> = rows.iter().map(|x| $lanes::load(x)).collect();
                let (mut sines, mut memory) = (x.clone(), x.clone());
                $lanes::sines_cosines(&mut x, &mut sines, &mut memory);
                let mut all = vec![[[0.0; MAX_LANES]; 2]; rows.len()];
                for ((all, sines), cosines) in all.iter_mut().zip(sines).zip(x) {
                    sines.store(&mut all[0]);
                    cosines.store(&mut all[1]);
                }
                all
            }
        };
    }

    #[cfg(target_arch = "x86_64")]
    of_lanes!(of_four, Lanes4, Avx2, "avx2,fma");
    #[cfg(target_arch = "x86_64")]
    of_lanes!(of_eight, Lanes8, Avx512, "avx512f,avx2,fma");

    #[cfg(target_arch = "x86_64")]
    type Many<'a> = &'a dyn Fn(&[[f64; MAX_LANES]]) -> Vec<[[f64; MAX_LANES]; 2]>;

    /// With the number of lanes, for all that the processor has.
    #[cfg(target_arch = "x86_64")]
    #[allow(unsafe_code)]
    fn each_form(check: impl Fn(usize, Many<'_>)) {
        if let Some(cpu) = Avx2::detect() {
            // SAFETY: the token proves that the processor has both features.
            check(4, &|rows| unsafe { of_four(cpu, rows) });
        }
        if let Some(cpu) = Avx512::detect() {
            // SAFETY: as above.
            check(8, &|rows| unsafe { of_eight(cpu, rows) });
        }
    }

    #[cfg(target_arch = "x86_64")]
    #[test]
    fn lanes_agree_with_std() {
        each_form(|lanes, of| {
            for i in 0..20_000 {
                let row = from_fn(|l| f64::from(i * 8 + l as i32) * 1.234_567_8 - 9.9e4);
                let [sines, cosines] = of(&[row])[0];
                for l in 0..lanes {
                    let (sin, cos) = row[l].sin_cos();
                    assert!(ulps(sines[l], sin).max(ulps(cosines[l], cos)) <= 2.0, "{}", row[l]);
                }
            }
        });
    }

    /// Other angles in the same register do not change a bit of a sine, however large they are.
    #[cfg(target_arch = "x86_64")]
    #[test]
    fn many_are_as_each() {
        let rows: Vec<[f64; 8]> = (0..9)
            .map(|i| [0.3, 2.5, -4.0, 71.0, 1e-9, 9e3, -0.8, 1.6].map(|x| x * f64::from(i - 4)))
            .collect();
        let others = [1e9, f64::NAN, 3.0, 1e300, -1e5, 1e5 + 1.0, 0.0, 5.0];
        each_form(|lanes, of| {
            for (row, expected) in rows.iter().zip(of(&rows)) {
                let before_others = of(&[*row, others])[0];
                let mut mixed = *row;
                (mixed[1], mixed[2]) = (1e9, f64::INFINITY);
                let mixed = of(&[mixed])[0];
                assert_eq!([mixed[0][1], mixed[1][1]], <[f64; 2]>::from(1e9_f64.sin_cos()));
                assert!(mixed[0][2].is_nan() && mixed[1][2].is_nan());
                for (k, expected) in expected.iter().enumerate() {
                    assert_eq!(before_others[k][..lanes], expected[..lanes], "{row:?}");
                    assert_eq!(mixed[k][0], expected[0], "{row:?}");
                    assert_eq!(mixed[k][3..lanes], expected[3..lanes], "{row:?}");
                }
            }
        });
    }
}
