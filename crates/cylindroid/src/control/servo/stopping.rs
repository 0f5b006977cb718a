//! Velocities from which a joint stops within a distance.
//!
//! Formula  steps v, v - A dt, v - 2 A dt, ...: with x = v / (A dt), k = floor(x), f = x - k the way is
//!          D = A dt^2 (k + 1) (k / 2 + f), inverted in closed form. Under a jerk limit as well:
//!          J^(1/3) d^(2/3) while A is not reached, otherwise the root of v^2 / (2 A) + v A / (2 J) = d
//! Units    rad or m, s
//! Valid    d >= 0, any limits, infinite ones included
//! Checked  tests in this file

use crate::model::Limits;
use crate::scalar::clamp;

/// Longest way back of a task whose joints brake that counts as none (scaled) [-]: joints that follow a bent
/// edge always have a short one, and would creep along it.
pub(in crate::control) const NEGLIGIBLE_WAY_BACK: f64 = 2e-4;

/// Halvings of the interval in which the largest share lies of velocities from which no task turns back.
pub(in crate::control) const SHARE_HALVINGS: usize = 6;

/// The time in which a joint stops from this speed, with the ramps of its jerk limit (s).
#[inline]
pub(in crate::control) fn stopping_time(speed: f64, limits: &Limits) -> f64 {
    if speed == 0.0 {
        return 0.0;
    }
    let Limits { acceleration: a, jerk, .. } = *limits;
    let ramps =
        if jerk == f64::INFINITY { 0.0 } else { 2.0 * (a / jerk).min((speed / jerk).sqrt()) };
    speed / a + ramps
}

/// Upper bound of the distance in which steps of `dt` with deceleration `acceleration` stop a
/// velocity >= 0; infinite or NaN if the acceleration is unlimited or zero.
#[inline]
pub(super) fn stopping_distance_bound(rate: f64, acceleration: f64, dt: f64) -> f64 {
    (0.5 * rate / acceleration + 0.5 * dt) * rate + 0.125 * acceleration * dt * dt
}

/// The largest velocity from which steps of `dt` with deceleration `acceleration` stop within
/// `distance`.
pub(in crate::control) fn stopping_velocity(distance: f64, acceleration: f64, dt: f64) -> f64 {
    if distance == f64::INFINITY {
        return f64::INFINITY;
    }
    if acceleration == f64::INFINITY {
        return distance / dt;
    }
    let unit = acceleration * dt * dt;
    if unit == 0.0 {
        return 0.0;
    }
    let scaled = distance / unit;
    let k = (0.5 * ((1.0 + 8.0 * scaled).sqrt() - 1.0)).floor();
    let f = clamp((scaled - 0.5 * k * (k + 1.0)) / (k + 1.0), 0.0, 1.0);
    (k + f) * acceleration * dt
}

/// The largest velocity without acceleration from which a joint stops within `distance`, within its
/// acceleration and jerk limits, in continuous time. No bound of a step: `jerk_limited_stop.rs` is.
///
/// ```text
/// J^(1/3) d^(2/3) while A is not reached,  otherwise the root of v^2 / (2 A) + v A / (2 J) = d
/// ```
pub(in crate::control) fn jerk_limited_stopping_velocity(
    distance: f64,
    acceleration: f64,
    jerk: f64,
    dt: f64,
) -> f64 {
    let most = stopping_velocity(distance, acceleration, dt);
    if jerk == f64::INFINITY || !distance.is_finite() {
        return most;
    }
    let (a, j, d) = (acceleration, jerk, distance.max(0.0));
    let smooth = if a == f64::INFINITY || d <= a * a * a / (j * j) {
        (j * d * d).cbrt()
    } else {
        let half = 0.5 * a / j;
        a * ((half * half + 2.0 * d / a).sqrt() - half)
    };
    most.min(smooth)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stopping_velocity_uses_the_whole_distance() {
        for distance in [1e-9, 1e-5, 0.01, 0.3, 5.0] {
            let (a, dt) = (7.0, 0.002);
            let mut v = stopping_velocity(distance, a, dt);
            let mut way = 0.0;
            while v > 0.0 {
                way += v * dt;
                v -= a * dt;
            }
            assert!(
                (way - distance).abs() < 1e-12 * (1.0 + distance / 1e-3),
                "{way} of {distance}"
            );
        }
    }
}
