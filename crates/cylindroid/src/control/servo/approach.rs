//! Approach to a target: slow enough that joints with small acceleration limits stop at it.
//!
//! Formula  x = s K e + feed-forward, s = min(1, min_i v_i(|d_i|) / |r_i|) with d = J+ e the
//!          remaining displacement of joint i, r = J+ K e the unbounded velocities, v_i(d) the
//!          largest velocity from which `BRAKING` of its acceleration limit stops within d
//!          and of its jerk limit stop within d (`stopping.rs`)
//! Shapes   e, x: m; d, r: n          Units  d in rad or m, r in rad/s or m/s, s [-]
//! Valid    any target; s = 1 for joints without acceleration limits, and for all joints near the
//!          target (d < 2 A / K^2). One s for all joints keeps the path straight. J+ e is of first
//!          order: a joint on a curved path corrects with the remaining acceleration
//! Why so   K e alone falls with e: its deceleration K^2 d exceeds the limit of a weak joint, which
//!          then overshoots the target and oscillates
//! Checked  tests/it/servo/steps.rs::weak_joints_arrive

use super::stopping::{jerk_limited_stopping_velocity, stopping_distance_bound};
use super::task_space::is_locked;
use crate::inverse::Method;
use crate::model::Limits;

/// Share of the acceleration and jerk limits reserved for braking [-].
const BRAKING: f64 = 0.8;

/// The scale s of the feedback that lets every joint stop at its goal: `ways` that are left and
/// `velocities` in scaled coordinates, `columns` the scales.
pub(super) fn scale(
    ways: impl IntoIterator<Item = f64>,
    velocities: &[f64],
    columns: &[f64],
    limits: &[Limits],
    dt: f64,
) -> f64 {
    let joints = ways.into_iter().zip(velocities).zip(columns).zip(limits);
    joints.fold(1.0, |share, (((way, rate), scale), limit)| {
        f64::min(share, share_of((way * scale).abs(), (rate * scale).abs(), limit, dt))
    })
}

/// The share of a gain at which a joint stops at a goal that it is `way` off; locked joints never go.
pub(in crate::control) fn share_of_gain(way: f64, gain: f64, limits: &Limits, dt: f64) -> f64 {
    if is_locked(limits) {
        return 1.0;
    }
    share_of(way.abs(), (gain * way).abs(), limits, dt)
}

/// The share of a velocity from which a joint stops within `way`.
#[inline]
fn share_of(way: f64, rate: f64, limit: &Limits, dt: f64) -> f64 {
    let (a, jerk) = (BRAKING * limit.acceleration, BRAKING * limit.jerk);
    // For most joints an upper bound of the stopping distance suffices.
    if jerk == f64::INFINITY && way > stopping_distance_bound(rate, a, dt) {
        return 1.0;
    }
    // A joint that cannot move is left to the saturation.
    if a > 0.0 && rate > 0.0 {
        return jerk_limited_stopping_velocity(way, a, jerk, dt) / rate;
    }
    1.0
}

/// The method with its own velocity bound scaled by the same factor: otherwise selectively damped
/// least squares would restore what the scaling removes.
pub(super) fn slowed(method: Method, share: f64) -> Method {
    match method {
        Method::SelectivelyDamped { max_joint_velocity } => {
            Method::SelectivelyDamped { max_joint_velocity: max_joint_velocity * share }
        }
        other => other,
    }
}
