//! How fast a target is approached: slow enough that joints with weak accelerations stop at it.
//!
//! Formula  x = s K e + feed-forward, s = min(1, min_i v_i(|d_i|) / |r_i|) with d = J+ e the way
//!          that is left to joint i, r = J+ K e the rates without a bound, v_i(d) the largest rate
//!          from which `BRAKING` of its acceleration limit stops within d (`limits.rs`)
//! Shapes   e, x: m; d, r: n          Units  d in rad or m, r in rad/s or m/s, s [-]
//! Valid    any target; s = 1 for joints without acceleration limits, and near the target for all
//!          (d < 2 A / K^2). One s for all joints keeps the way straight. J+ e is of first order:
//!          a joint whose way is curved corrects with the rest of its acceleration
//! Why so   K e alone falls with e: the deceleration K^2 d that it asks for is beyond a weak joint,
//!          which then swings past the target and back
//! Checked  tests/it/servo/steps.rs::weak_joints_arrive

use super::limits::{stopping_distance_bound, stopping_rate};
use crate::inverse::Method;
use crate::model::Limits;

/// Share of the acceleration limit that is counted on for braking [-].
const BRAKING: f64 = 0.8;

/// The share s of the feedback that lets every joint stop at the end of its way: `ways` and `rates`
/// in scaled coordinates, `columns` the scales.
pub(super) fn share(
    ways: &[f64],
    rates: &[f64],
    columns: &[f64],
    limits: &[Limits],
    dt: f64,
) -> f64 {
    let mut share = 1.0_f64;
    for (((way, rate), scale), limit) in ways.iter().zip(rates).zip(columns).zip(limits) {
        let (way, rate) = ((way * scale).abs(), (rate * scale).abs());
        let a = BRAKING * limit.acceleration;
        // Most rates stop within their way by a bound of what they need.
        if way > stopping_distance_bound(rate, a, dt) {
            continue;
        }
        // A joint that cannot be moved at all is left to the saturation.
        if a > 0.0 && rate > 0.0 {
            share = share.min(stopping_rate(way, a, dt) / rate);
        }
    }
    share
}

/// The method with its own bound of the rates slowed in the same share: without that, selectively
/// damped least squares would give back what the twist loses.
pub(super) fn slowed(method: Method, share: f64) -> Method {
    match method {
        Method::SelectivelyDamped { max_joint_velocity } => {
            Method::SelectivelyDamped { max_joint_velocity: max_joint_velocity * share }
        }
        other => other,
    }
}
