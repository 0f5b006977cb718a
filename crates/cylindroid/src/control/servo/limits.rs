//! Velocity bounds of a joint for the next step: position, velocity and acceleration limits as one
//! interval.
//!
//! Formula  |v| <= V;  |v - v_before| <= A dt;  and v small enough that braking with A, step by
//!          step, stops before the position limit: d >= D(v), d the distance to the limit, D the
//!          stopping distance of the discrete motion v, v - A dt, v - 2 A dt, ...
//! Stopping with x = v / (A dt), k = floor(x), f = x - k:
//!          D / (A dt^2) = (k + 1) (k / 2 + f), inverted in closed form below; most velocities are
//!          accepted by an upper bound of D without a square root (`BrakingMargin`)
//! Units    rad or m, s
//! Valid    a joint that obeyed the interval in the last step has a non-empty interval in this one.
//!          A measured state that violates it (a push, a start outside the limits) gets the
//!          velocity closest to its last one that moves it no further out.
//! Why so   clamping to (limit - q) / dt alone, as common servo code does, stops a joint at its
//!          limit with an arbitrary deceleration; the continuous formula sqrt(2 A d) overshoots by
//!          up to A dt^2 / 8
//! Checked  tests/it/servo/limits.rs::limits_*, tests in this file

use crate::control::solver::bounds::{LimitKind, VelocityBounds};
use crate::model::Limits;
use crate::scalar::clamp;
use crate::tolerance::{LIMIT_MET, LIMIT_ROUNDING};

/// State of a joint: the position of a coordinate and its last commanded velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointState {
    /// Position [rad or m].
    pub position: f64,
    /// Velocity commanded in the last step [rad/s or m/s].
    pub velocity: f64,
}

impl VelocityBounds {
    /// The velocity bounds of a joint for the next step of `dt` seconds, from its position,
    /// velocity and acceleration limits.
    ///
    /// ```text
    /// |v| <= V,   |v - v_before| <= A dt,   D(v) <= d
    /// D = A dt^2 (k + 1) (k / 2 + f),   k = floor(x),  f = x - k,  x = v / (A dt)
    /// ```
    ///
    /// d is the distance to the position limit, D the stopping distance of the discrete motion v,
    /// v - A dt, v - 2 A dt, ... A joint that obeyed its bounds in the last step has a non-empty
    /// interval in this one; a measured state that violates them gets the velocity closest to its
    /// last one that moves it no further out.
    ///
    /// ```
    /// use cylindroid::control::{JointState, LimitKind, VelocityBounds};
    /// use cylindroid::model::Limits;
    ///
    /// // A joint 0.5 mrad before its upper limit moves there within one step of 1 ms at most.
    /// let limits = Limits { lower: -1.0, upper: 1.0, velocity: 2.0, ..Limits::NONE };
    /// let now = JointState { position: 0.9995, velocity: 0.1 };
    /// let bounds = VelocityBounds::next(&limits, now, 1e-3);
    /// assert!(bounds.upper <= 0.5 + 1e-9 && bounds.upper_cause == LimitKind::Position);
    /// assert_eq!(bounds.met(bounds.clamp(3.0)), Some(LimitKind::Position));
    /// assert!(bounds.contains(-2.0) && !bounds.contains(1.0));
    /// ```
    #[must_use]
    pub fn next(limits: &Limits, now: JointState, dt: f64) -> Self {
        Self::within_change(limits, now, limits.acceleration * dt, dt)
    }

    /// The bounds of a passive joint: it brakes before its position limits, but its velocity
    /// follows those of the others, whatever its changes.
    pub(in crate::control) fn passive(limits: &Limits, now: JointState, dt: f64) -> Self {
        Self::within_change(limits, now, f64::INFINITY, dt)
    }

    /// The bounds for a largest change of velocity.
    fn within_change(limits: &Limits, now: JointState, step: f64, dt: f64) -> Self {
        let above = distance_to_limit(limits.upper - now.position, now.position, limits.upper);
        let below = distance_to_limit(now.position - limits.lower, now.position, limits.lower);
        let brake_up = stopping_velocity(above, limits.acceleration, dt);
        let brake_down = -stopping_velocity(below, limits.acceleration, dt);

        let mut bounds = Self {
            lower: -limits.velocity,
            upper: limits.velocity,
            lower_cause: LimitKind::Velocity,
            upper_cause: LimitKind::Velocity,
        };
        if now.velocity + step < bounds.upper {
            (bounds.upper, bounds.upper_cause) = (now.velocity + step, LimitKind::Acceleration);
        }
        if now.velocity - step > bounds.lower {
            (bounds.lower, bounds.lower_cause) = (now.velocity - step, LimitKind::Acceleration);
        }
        // Positions last: they take precedence if a measured state contradicts the other two.
        if brake_up < bounds.upper {
            (bounds.upper, bounds.upper_cause) = (brake_up, LimitKind::Position);
            if bounds.lower > brake_up {
                (bounds.lower, bounds.lower_cause) = (brake_up, LimitKind::Position);
            }
        }
        if brake_down > bounds.lower {
            (bounds.lower, bounds.lower_cause) = (brake_down, LimitKind::Position);
            if bounds.upper < brake_down {
                (bounds.upper, bounds.upper_cause) = (brake_down, LimitKind::Position);
            }
        }
        if bounds.lower > bounds.upper {
            // Velocity against acceleration limit after a push: decelerate as fast as permitted.
            let rate = if now.velocity > 0.0 { bounds.lower } else { bounds.upper };
            (bounds.lower, bounds.upper) = (rate, rate);
        }
        bounds
    }
}

/// A sufficient condition, free of square roots, for a velocity to meet no limit of a joint; such
/// velocities need no bounds.
#[derive(Debug, Clone, Copy)]
pub(super) struct BrakingMargin {
    lower: f64,
    upper: f64,
    velocity: f64,
    /// A dt
    step: f64,
    /// Upper bound of the stopping distance D(v), (square v + linear) v + constant: with x = v / (A
    /// dt), D / (A dt^2) <= x (x + 1) / 2 + 1 / 8, and D = v dt without an acceleration limit.
    square: f64,
    linear: f64,
    constant: f64,
    /// 1 / A; 0 for a locked joint.
    pub(super) slowness: f64,
}

impl BrakingMargin {
    /// For steps of `dt`; a locked joint accepts any velocity.
    pub(super) fn new(limits: &Limits, dt: f64, is_locked: bool) -> Self {
        let limits = if is_locked { &Limits::NONE } else { limits };
        let Limits { lower, upper, velocity, acceleration: a, .. } = *limits;
        // Limits tightened by the rounding of `distance_to_limit`; infinite ones stay.
        let inwards = |limit: f64| {
            if limit.is_finite() { 2.0 * LIMIT_ROUNDING * (1.0 + limit.abs()) } else { 0.0 }
        };
        let (square, linear, constant) = if a == f64::INFINITY {
            (0.0, dt, 0.0)
        } else {
            (0.5 / a, 0.5 * dt, 0.125 * a * dt * dt)
        };
        let (lower, upper) = (lower + inwards(lower), upper - inwards(upper));
        Self { lower, upper, velocity, step: a * dt, square, linear, constant, slowness: 1.0 / a }
    }

    /// True if the velocity lies inside [`VelocityBounds::next`], away from its ends; false also
    /// for some velocities near them, and for NaN.
    #[inline]
    pub(super) fn allows(&self, now: JointState, rate: f64) -> bool {
        const MORE: f64 = 1.0 + 1e3 * LIMIT_MET;
        let speed = MORE * rate.abs();
        let change = (rate - now.velocity).abs() + (MORE - 1.0) * (speed + now.velocity.abs());
        let way = (self.square * speed + self.linear) * speed + self.constant;
        let way = MORE * way + 2.0 * LIMIT_ROUNDING * now.position.abs();
        let (up, down) = (now.position + way < self.upper, now.position - way > self.lower);
        (speed < self.velocity) & (change < self.step) & up & down
    }
}

/// The distance to a limit, less the rounding of the position, the limit and their difference.
fn distance_to_limit(distance: f64, position: f64, limit: f64) -> f64 {
    if limit.is_infinite() {
        return f64::INFINITY;
    }
    (distance - LIMIT_ROUNDING * (1.0 + position.abs() + limit.abs())).max(0.0)
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

#[cfg(test)]
mod tests {
    use super::*;

    fn limits() -> Limits {
        Limits { lower: -1.0, upper: 1.0, velocity: 2.0, acceleration: 10.0, effort: 1.0 }
    }

    /// A joint at maximum velocity stops at its limit without violating any bound.
    #[test]
    fn full_speed_into_the_limit_stops_there() {
        let (limits, dt) = (limits(), 0.003);
        let mut now = JointState { position: -1.0, velocity: 0.0 };
        for _ in 0..2000 {
            let bounds = VelocityBounds::next(&limits, now, dt);
            assert!(bounds.lower <= bounds.upper, "{bounds:?} at {now:?}");
            let rate = bounds.upper;
            assert!((rate - now.velocity).abs() <= limits.acceleration * dt * (1.0 + 1e-12));
            assert!(rate.abs() <= limits.velocity);
            now = JointState { position: now.position + rate * dt, velocity: rate };
            assert!(now.position <= limits.upper, "{}", now.position);
        }
        assert!(limits.upper - now.position < 1e-9, "stops short: {}", now.position);
    }

    /// A velocity accepted by the margin meets no bound, and few that meet none are rejected.
    #[test]
    fn velocities_within_the_margin_meet_no_bound() {
        let mut state = 3;
        let mut next = || 2.0 * crate::scalar::uniform(&mut state) - 1.0;
        let (mut clear, mut inside) = (0, 0);
        for round in 0..200_000 {
            let some = limits();
            let limits = match round % 4 {
                0 => some,
                1 => Limits { acceleration: f64::INFINITY, ..some },
                2 => Limits { lower: f64::NEG_INFINITY, upper: f64::INFINITY, ..some },
                _ => Limits { velocity: f64::INFINITY, ..some },
            };
            let dt = [1e-3, 0.1][round % 2];
            let now = JointState { position: next(), velocity: 2.0 * next() };
            let rate = match round % 3 {
                0 => 2.5 * next(),
                1 => now.velocity + 12.0 * dt * next(),
                _ => stopping_velocity(1.0 - now.position, limits.acceleration, dt),
            };
            let bounds = VelocityBounds::next(&limits, now, dt);
            let free = bounds.contains(rate) && bounds.met(rate).is_none();
            inside += usize::from(free);
            if BrakingMargin::new(&limits, dt, false).allows(now, rate) {
                clear += 1;
                assert!(free, "{rate} in {bounds:?} at {now:?}, {limits:?}, dt = {dt}");
            }
        }
        assert!(clear > inside * 9 / 10, "{clear} clear, {inside} inside");
    }

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

    /// Limits far from zero and wide ranges, where the rounding of `q + dt * velocity` is theirs.
    #[test]
    fn wide_ranges_are_not_left() {
        for size in [1e3, 1e6, 1e9] {
            for (lower, upper) in [(-size, size), (0.3 * size, 0.7 * size), (-1.0, 1.1 * size)] {
                for acceleration in [f64::INFINITY, 10.0 * size] {
                    let limits = Limits { lower, upper, acceleration, ..Limits::NONE };
                    for i in 1..200 {
                        let (share, dt) = (f64::from(i) * 0.005, 0.0007 * f64::from(i));
                        let start = lower + share * (upper - lower);
                        let mut now = JointState { position: start, velocity: 0.0 };
                        for _ in 0..40 {
                            let rate = VelocityBounds::next(&limits, now, dt).upper;
                            now = JointState { position: now.position + rate * dt, velocity: rate };
                            assert!(now.position <= upper, "{} of {limits:?}", now.position);
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn outside_a_limit_only_the_way_back_is_feasible() {
        let now = JointState { position: 1.2, velocity: 0.0 };
        let bounds = VelocityBounds::next(&limits(), now, 0.01);
        assert_eq!(bounds.upper, 0.0);
        assert!(bounds.lower < 0.0);
    }

    #[test]
    fn no_limits_no_bounds() {
        let now = JointState { position: 3.0, velocity: 1.0 };
        let bounds = VelocityBounds::next(&Limits::NONE, now, 0.01);
        assert_eq!((bounds.lower, bounds.upper), (f64::NEG_INFINITY, f64::INFINITY));
    }
}
