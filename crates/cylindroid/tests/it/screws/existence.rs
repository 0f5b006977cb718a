//! Whether the inverse of a pitch exists, and the reason: near principal pitches, and for pitches so large
//! that rounding decides.

use cylindroid::screws::{NoInverse, ScrewOptions, ScrewSystem};
use cylindroid::spatial::{Twist, Vec3};

use crate::support::Random;

const fn rotation(about: Vec3) -> Twist {
    Twist { linear: Vec3::ZERO, angular: about }
}

const fn translation(along: Vec3) -> Twist {
    Twist { linear: along, angular: Vec3::ZERO }
}

/// Of a cylindrical joint the Gram matrix is [[0, 1/2], [1/2, -h]], and its smaller eigenvalue
/// (sqrt(h^2 + 1) - |h|) / 2, which falls as 1 / (4 |h|) while the rounding of its entries grows.
#[test]
fn the_threshold_covers_the_rounding_of_large_pitches() {
    let mut random = Random(41);
    for length in [1e-3, 1.0, 1e3] {
        for _ in 0..20 {
            let pose = random.pose();
            let twists =
                [rotation(Vec3::Z), translation(Vec3::Z * length)].map(|t| pose.adjoint(t));
            let system = ScrewSystem::of(&twists, &ScrewOptions::with_length(length)).unwrap();
            for exponent in 0..=24 {
                let h = 10_f64.powf(0.5 * f64::from(exponent));
                let [up, down] = [h, -h].map(|h| system.existence(h * length));
                let expected = 0.5 / (h.hypot(1.0) + h);
                for found in [&up, &down] {
                    let error = (found.margin - expected).abs();
                    assert!(error <= found.threshold, "{h}: {found:?} for {expected:e}");
                    // Nothing exists of which rounding leaves no digit.
                    assert!(!found.exists || error < 0.2 * expected, "{h}: {found:?}");
                }
                assert_eq!((up.exists, up.threshold), (down.exists, down.threshold), "{h}");
                assert_eq!(up.exists, exponent <= 13, "{h}: {up:?}");
            }
        }
    }
}

/// A pitch is named where it is near, whatever the unit of length; far from it, the system is close to a
/// class without an inverse.
#[test]
fn only_a_near_pitch_is_the_reason() {
    for length in [1e-3, 1.0, 1e3] {
        let options = ScrewOptions::with_length(length);
        let axes = [rotation(Vec3::X), rotation(Vec3::Z), translation(Vec3::Z * length)];
        let system = ScrewSystem::of(&axes, &options).unwrap();
        for gap in [0.0, 5e-9, -5e-9] {
            let found = system.existence(gap * length);
            let Some(NoInverse::PrincipalPitch { pitch }) = found.reason else {
                panic!("{length} {gap}: {found:?}")
            };
            assert!(pitch.abs() < 1e-12 * length, "{pitch}");
        }
        for h in [3e7, -3e7] {
            let found = system.existence(h * length);
            let reason = NoInverse::Close { class: system.class(), order: 3 };
            assert_eq!(found.reason, Some(reason), "{length} {h}: {found:?}");
        }
    }
}

/// Six digits, of both signs; rounding is zero.
#[test]
fn pitches_in_reasons_have_six_digits() {
    let text = |pitch: f64| NoInverse::PrincipalPitch { pitch }.to_string();
    for (pitch, shown) in [
        (0.123_456_789, "pitch 0.123457 m/rad"),
        (-0.123_456_789, "pitch -0.123457 m/rad"),
        (2e-16, "pitch 0 m/rad"),
        (-2e-16, "pitch 0 m/rad"),
        (2e-6, "pitch 0.000002 m/rad"),
    ] {
        assert!(text(pitch).contains(shown), "{}", text(pitch));
    }
}
