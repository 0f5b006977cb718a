//! Scalar functions of the angle in exp, log and their derivatives, accurate down to zero.
//!
//! Each is a Taylor series below `tolerance::SMALL_ANGLE` and a closed form above it; at the switch
//! both agree to 3e-14 relative, and to 2e-13 in `sinc5`, which cancels twice and is multiplied by
//! the fourth power of the angle.
//!
//! Checked  tests::both_sides_of_the_switch

use crate::tolerance::SMALL_ANGLE;

/// `c[0] + c[1] x + c[2] x^2 + ...`
fn polynomial(x: f64, c: &[f64]) -> f64 {
    c.iter().rev().fold(0.0, |sum, &k| sum * x + k)
}

/// atan t / t for x = t^2 up to `tolerance::SMALL_TANGENT`
#[inline]
pub(crate) fn atanc(x: f64) -> f64 {
    1.0 - x * (1.0 / 3.0 - x * (1.0 / 5.0 - x * (1.0 / 7.0 - x * (1.0 / 9.0 - x / 11.0))))
}

/// sin t / t
pub(crate) fn sinc(t: f64) -> f64 {
    if t == 0.0 { 1.0 } else { t.sin() / t }
}

/// (1 - cos t) / t^2, in the form 2 sin^2(t/2) / t^2 that does not cancel
pub(crate) fn cosc(t: f64) -> f64 {
    let s = sinc(0.5 * t);
    0.5 * s * s
}

/// (t - sin t) / t^3
pub(crate) fn sinc3(t: f64) -> f64 {
    if t.abs() < SMALL_ANGLE {
        const C: [f64; 7] = [
            1.0 / 6.0,
            -1.0 / 120.0,
            1.0 / 5_040.0,
            -1.0 / 362_880.0,
            1.0 / 39_916_800.0,
            -1.0 / 6_227_020_800.0,
            1.0 / 1_307_674_368_000.0,
        ];
        polynomial(t * t, &C)
    } else {
        (t - t.sin()) / (t * t * t)
    }
}

/// (1 - (t/2) cot(t/2)) / t^2: the coefficient of K^2 in the inverse derivative of exp
pub(crate) fn cotc(t: f64) -> f64 {
    if t.abs() < SMALL_ANGLE {
        // (1 - x cot x) / (4 x^2) with x = t / 2, powers of x^2
        const C: [f64; 7] = [
            1.0 / 12.0,
            1.0 / 180.0,
            1.0 / 1_890.0,
            1.0 / 18_900.0,
            1.0 / 187_110.0,
            691.0 / 1_277_025_750.0,
            1.0 / 18_243_225.0,
        ];
        polynomial(0.25 * t * t, &C)
    } else {
        let h = 0.5 * t;
        (1.0 - h * h.cos() / h.sin()) / (t * t)
    }
}

/// (1 - t^2/2 - cos t) / t^4
pub(crate) fn cosc4(t: f64) -> f64 {
    if t.abs() < SMALL_ANGLE {
        const C: [f64; 7] = [
            -1.0 / 24.0,
            1.0 / 720.0,
            -1.0 / 40_320.0,
            1.0 / 3_628_800.0,
            -1.0 / 479_001_600.0,
            1.0 / 87_178_291_200.0,
            -1.0 / 20_922_789_888_000.0,
        ];
        polynomial(t * t, &C)
    } else {
        (cosc(t) - 0.5) / (t * t)
    }
}

/// (t - sin t - t^3/6) / t^5
pub(crate) fn sinc5(t: f64) -> f64 {
    if t.abs() < SMALL_ANGLE {
        const C: [f64; 7] = [
            -1.0 / 120.0,
            1.0 / 5_040.0,
            -1.0 / 362_880.0,
            1.0 / 39_916_800.0,
            -1.0 / 6_227_020_800.0,
            1.0 / 1_307_674_368_000.0,
            -1.0 / 355_687_428_096_000.0,
        ];
        polynomial(t * t, &C)
    } else {
        (sinc3(t) - 1.0 / 6.0) / (t * t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_sides_of_the_switch() {
        let below = SMALL_ANGLE * (1.0 - f64::EPSILON);
        for (name, f, most) in [
            ("sinc3", sinc3 as fn(f64) -> f64, 3e-14),
            ("cotc", cotc, 3e-14),
            ("cosc4", cosc4, 3e-14),
            ("sinc5", sinc5, 2e-13),
        ] {
            let (lo, hi) = (f(below), f(SMALL_ANGLE));
            let relative = ((lo - hi) / hi).abs();
            assert!(relative < most, "{name}: {lo} below, {hi} above, {relative:.1e} relative");
        }
    }

    #[test]
    fn limits_at_zero() {
        assert_eq!(sinc(0.0), 1.0);
        assert_eq!(cosc(0.0), 0.5);
        assert_eq!(sinc3(0.0), 1.0 / 6.0);
        assert_eq!(cotc(0.0), 1.0 / 12.0);
        assert_eq!(cosc4(0.0), -1.0 / 24.0);
        assert_eq!(sinc5(0.0), -1.0 / 120.0);
    }

    /// The series, of which enough terms converge at any angle of a rotation.
    #[test]
    fn beyond_small_angles() {
        let series = |first: u32, sign: f64, t: f64| -> f64 {
            let mut term = sign / (1..=first).map(f64::from).product::<f64>();
            let mut sum = 0.0;
            for k in (first + 1..first + 60).step_by(2) {
                sum += term;
                term *= -t * t / (f64::from(k) * f64::from(k + 1));
            }
            sum
        };
        for t in [-2.5, 0.6, 1.0, 2.0, 3.1] {
            for (name, got, expected) in [
                ("cosc", cosc(t), series(2, 1.0, t)),
                ("sinc3", sinc3(t), series(3, 1.0, t)),
                ("cosc4", cosc4(t), series(4, -1.0, t)),
                ("sinc5", sinc5(t), series(5, -1.0, t)),
            ] {
                assert!((got / expected - 1.0).abs() < 1e-12, "{name}({t}) = {got}, {expected}");
            }
        }
    }
}
