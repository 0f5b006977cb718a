//! Velocity bounds of a joint for the next step: position, velocity, acceleration and jerk limits as
//! one interval.
//!
//! Formula  |v| <= V;  |v - v_before| <= A dt;  and v small enough that braking with A, step by
//!          step, stops before the position limit: d >= D(v), d the distance to the limit, D the
//!          stopping distance of the discrete motion v, v - A dt, v - 2 A dt, ...
//! Stopping with x = v / (A dt), k = floor(x), f = x - k:
//!          D / (A dt^2) = (k + 1) (k / 2 + f), inverted in closed form below; most velocities are
//!          accepted by an upper bound of D without a square root (`BrakingMargin`)
//! Jerk     |v - v_before - a dt| <= J dt^2, and the stop of least time from v (`jerk_limited_stop.rs`)
//!          leaves neither the position nor the velocity limits. Its own next velocity always fits;
//!          the ends of the interval are found from it by bisection
//! Units    rad or m, s
//! Valid    a joint that obeyed the interval in the last step has a non-empty interval in this one.
//!          A measured state that violates it (a push, a start outside the limits) gets the
//!          velocity closest to its last one that moves it no further out.
//! Why so   clamping to (limit - q) / dt alone, as common servo code does, stops a joint at its
//!          limit with an arbitrary deceleration; the continuous formula sqrt(2 A d) overshoots by
//!          up to A dt^2 / 8
//! Checked  tests/it/servo/limits.rs::limits_*, tests in this file

use super::jerk_limited_stop::JerkLimitedStop;
use super::plant::Plant;
use super::stopping::stopping_velocity;
use crate::control::solver::bounds::{LimitKind, VelocityBounds};
use crate::model::{Limits, Mechanism};
use crate::scalar::largest;
use crate::tolerance::{DEFAULT_RAMP, LIMIT_MET, LIMIT_ROUNDING};

/// State of a joint: the position of a coordinate and its last commanded velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointState {
    /// Position [rad or m].
    pub position: f64,
    /// Velocity commanded in the last step [rad/s or m/s].
    pub velocity: f64,
    /// Change of the commanded velocity in the last step, divided by its duration [rad/s^2 or m/s^2];
    /// counts for joints with a jerk limit.
    pub acceleration: f64,
}

/// Halvings of the interval in which an end of the bounds lies; the rest is below a rounding of the
/// largest change.
const BISECTIONS: usize = 48;

/// Share of a distance or a velocity that sums over the steps of a stop may round away [-].
const JERK_ROUNDING: f64 = 1e-11;

/// Steps on the way to a limit whose roundings of the position may add up.
const STEPS_TO_LIMIT: f64 = 500.0;

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
    /// let now = JointState { position: 0.9995, velocity: 0.1, acceleration: 0.0 };
    /// let bounds = VelocityBounds::next(&limits, now, 1e-3);
    /// assert!(bounds.upper <= 0.5 + 1e-9 && bounds.upper_cause == LimitKind::Position);
    /// assert_eq!(bounds.met(bounds.clamp(3.0)), Some(LimitKind::Position));
    /// assert!(bounds.contains(-2.0) && !bounds.contains(1.0));
    /// ```
    #[must_use]
    pub fn next(limits: &Limits, now: JointState, dt: f64) -> Self {
        if limits.jerk < f64::INFINITY {
            return Self::within_jerk(limits, now, dt);
        }
        Self::within_change(limits, now, limits.acceleration * dt, dt)
    }

    /// The bounds of a joint with a jerk limit.
    fn within_jerk(limits: &Limits, now: JointState, dt: f64) -> Self {
        let JointState { position, velocity, acceleration } = now;
        let braking = JerkLimitedStop::new(limits, velocity, acceleration, dt).next();
        // The ends for motions upwards, and downwards with all signs changed.
        let end = |sign: f64, limit: f64| {
            let (v, a, mut brake) = (sign * velocity, sign * acceleration, sign * braking);
            if brake > limits.velocity && brake <= limits.velocity * (1.0 + JERK_ROUNDING) {
                brake = limits.velocity;
            }
            let most_room = distance_to_limit(sign * (limit - position), position, limit);
            // The roundings of all steps to the limit are kept free at first.
            let room = if most_room == f64::INFINITY {
                most_room
            } else {
                let size = 1.0 + position.abs() + limit.abs();
                most_room - JERK_ROUNDING * most_room - STEPS_TO_LIMIT * LIMIT_ROUNDING * size
            };
            let faster = stopping_velocity((limits.velocity - v).max(0.0), limits.jerk, dt) * dt;
            let candidates = [
                (v + faster, LimitKind::Velocity),
                (limits.velocity, LimitKind::Velocity),
                (v + limits.acceleration * dt, LimitKind::Acceleration),
                (v + (a + limits.jerk * dt) * dt, LimitKind::Jerk),
            ];
            let [first, ..] = candidates;
            let least = |x: (f64, LimitKind), y: (f64, LimitKind)| if y.0 < x.0 { y } else { x };
            let (most, cause) = candidates.into_iter().fold(first, least);
            let highest =
                |v: f64, a: f64| dt * v + JerkLimitedStop::new(limits, v, a, dt).range().highest;
            let fits = |new: f64| highest(new, (new - v) / dt) <= room;
            let brake_fits = |brake: f64| highest(brake, (brake - v) / dt) <= most_room;
            if most <= brake || room == f64::INFINITY || fits(most) {
                return (most.max(brake), cause);
            }
            let end = if fits(brake) {
                largest(brake, most, BISECTIONS, fits)
            } else if brake_fits(brake) {
                brake
            } else {
                // Positions take precedence if a measured state contradicts the others.
                brake.min(largest(0.0, brake.max(0.0), BISECTIONS, |new| highest(new, 0.0) <= room))
            };
            (end, LimitKind::Position)
        };
        let (upper, upper_cause) = end(1.0, limits.upper);
        let (lower, lower_cause) = end(-1.0, limits.lower);
        let (lower, upper) = if -lower > upper {
            // One of them takes precedence: that of the side towards which the joint moves.
            if velocity > 0.0 { (upper, upper) } else { (-lower, -lower) }
        } else {
            (-lower, upper)
        };
        Self { lower, upper, lower_cause, upper_cause }
    }

    /// The same for a joint that is to move with a `desired` velocity: with a jerk limit no velocity is
    /// commanded from which the acceleration cannot end there. Otherwise velocities swing about it.
    #[must_use]
    pub(in crate::control) fn towards(
        mut self,
        desired: f64,
        limits: &Limits,
        now: JointState,
        dt: f64,
    ) -> Self {
        if limits.jerk == f64::INFINITY || !desired.is_finite() {
            return self;
        }
        let gap = desired - now.velocity;
        let end = now.velocity + (stopping_velocity(gap.abs(), limits.jerk, dt) * dt).copysign(gap);
        if gap >= 0.0 {
            let end = end.max(self.lower);
            if end < self.upper {
                (self.upper, self.upper_cause) = (end, LimitKind::Jerk);
            }
        } else {
            let end = end.min(self.upper);
            if end > self.lower {
                (self.lower, self.lower_cause) = (end, LimitKind::Jerk);
            }
        }
        self
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

/// Limits of a servo's options, for joints that have none in the model.
#[derive(Debug, Clone, Copy)]
pub(in crate::control) struct DefaultLimits {
    /// Acceleration [rad/s^2 or m/s^2]; `None` for the default ramp.
    pub acceleration: Option<f64>,
    /// Jerk [rad/s^3 or m/s^3].
    pub jerk: f64,
}

/// The limits of these coordinates, then those of actuated loop joints, of a servo with this gain:
/// those of the model within the margins of the plant, where it has no acceleration or jerk limit the
/// default ones. The acceleration is bounded such that the jerk ends it in half of the time 1/gain:
/// otherwise the tool swings about its target.
pub(in crate::control) fn limits_of_servo(
    mechanism: &Mechanism,
    coordinates: impl Iterator<Item = usize>,
    plant: &Plant,
    default: DefaultLimits,
    gain: f64,
) -> Vec<Limits> {
    let (all, n) = (mechanism.coordinates(), mechanism.n());
    // Positions of loop joints are no coordinates.
    let (lower, upper) = (f64::NEG_INFINITY, f64::INFINITY);
    let actuated = mechanism.loops().iter().filter(|l| l.actuated);
    let loops = actuated.map(|l| Limits { lower, upper, ..l.limits });
    let or = |own: &mut f64, other: f64| {
        if *own == f64::INFINITY {
            *own = other;
        }
    };
    coordinates
        .map(|c| (c, all[c].limits))
        .chain((n..).zip(loops))
        .map(|(place, mut own)| {
            plant.keep_off(&mut own);
            let ramp = DEFAULT_RAMP * mechanism.unit_of(place);
            or(&mut own.acceleration, default.acceleration.unwrap_or(ramp));
            or(&mut own.jerk, default.jerk);
            if own.jerk < f64::INFINITY && gain > 0.0 {
                own.acceleration = own.acceleration.min(0.5 * own.jerk / gain);
            }
            own
        })
        .collect()
}

/// The acceleration of a joint after a step in which its velocity changed, for [`JointState`]: zero
/// after a change beyond its limits, as a push makes necessary.
pub(in crate::control) fn acceleration_of(
    limits: &Limits,
    before: f64,
    change: f64,
    dt: f64,
) -> f64 {
    const MORE: f64 = 1.0 + 1e-6;
    let now = change / dt;
    let is_within =
        now.abs() <= MORE * limits.acceleration && (now - before).abs() <= MORE * limits.jerk * dt;
    if is_within { now } else { 0.0 }
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
        // With a jerk limit no velocity is accepted here.
        let step = if limits.jerk < f64::INFINITY { 0.0 } else { a * dt };
        Self { lower, upper, velocity, step, square, linear, constant, slowness: 1.0 / a }
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

#[cfg(test)]
mod tests {
    use super::*;

    fn limits() -> Limits {
        Limits { lower: -1.0, upper: 1.0, velocity: 2.0, acceleration: 10.0, ..Limits::NONE }
    }

    /// A joint at maximum velocity stops at its limit without violating any bound.
    #[test]
    fn full_speed_into_the_limit_stops_there() {
        let (limits, dt) = (limits(), 0.003);
        let mut now = JointState { position: -1.0, velocity: 0.0, acceleration: 0.0 };
        for _ in 0..2000 {
            let bounds = VelocityBounds::next(&limits, now, dt);
            assert!(bounds.lower <= bounds.upper, "{bounds:?} at {now:?}");
            let rate = bounds.upper;
            assert!((rate - now.velocity).abs() <= limits.acceleration * dt * (1.0 + 1e-12));
            assert!(rate.abs() <= limits.velocity);
            now = JointState {
                position: now.position + rate * dt,
                velocity: rate,
                acceleration: 0.0,
            };
            assert!(now.position <= limits.upper, "{}", now.position);
        }
        assert!(limits.upper - now.position < 1e-9, "stops short: {}", now.position);
    }

    /// A push in either direction is no acceleration of the joint's own.
    #[test]
    fn changes_beyond_the_limits_are_no_acceleration() {
        let (limits, dt) = (Limits { jerk: 1e3, ..limits() }, 1e-2);
        for sign in [-1.0, 1.0] {
            let of = |before: f64, now: f64| {
                sign * acceleration_of(&limits, sign * before, sign * now * dt, dt)
            };
            assert_eq!(of(2.0, 5.0), 5.0);
            assert_eq!(of(5.0, -4.0), -4.0);
            assert_eq!(of(5.0, 11.0), 0.0); // acceleration
            assert_eq!(of(-2.0, 9.0), 0.0); // jerk
        }
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
            let now = JointState { position: next(), velocity: 2.0 * next(), acceleration: 0.0 };
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
                        let mut now =
                            JointState { position: start, velocity: 0.0, acceleration: 0.0 };
                        for _ in 0..40 {
                            let rate = VelocityBounds::next(&limits, now, dt).upper;
                            now = JointState {
                                position: now.position + rate * dt,
                                velocity: rate,
                                acceleration: 0.0,
                            };
                            assert!(now.position <= upper, "{} of {limits:?}", now.position);
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn outside_a_limit_only_the_way_back_is_feasible() {
        let now = JointState { position: 1.2, velocity: 0.0, acceleration: 0.0 };
        let bounds = VelocityBounds::next(&limits(), now, 0.01);
        assert_eq!(bounds.upper, 0.0);
        assert!(bounds.lower < 0.0);
    }

    #[test]
    fn no_limits_no_bounds() {
        let now = JointState { position: 3.0, velocity: 1.0, acceleration: 0.0 };
        let bounds = VelocityBounds::next(&Limits::NONE, now, 0.01);
        assert_eq!((bounds.lower, bounds.upper), (f64::NEG_INFINITY, f64::INFINITY));
    }

    /// The same within some roundings of limits far from zero: what is kept free grows with them.
    #[test]
    fn the_margin_keeps_free_what_the_bounds_do() {
        let (mut clear, dt) = (0, 1e-3);
        for size in [1.0, 30.0, 1e6] {
            let limits = Limits { lower: -size, upper: size, ..Limits::NONE };
            let margin = BrakingMargin::new(&limits, dt, false);
            let rounding = size * f64::EPSILON;
            for (steps, sign) in (0..100).flat_map(|i| [(i, 1.0), (i, -1.0)]) {
                let position = sign * (size - f64::from(steps) * rounding);
                let now = JointState { position, velocity: 0.0, acceleration: 0.0 };
                let bounds = VelocityBounds::next(&limits, now, dt);
                for way in 0..500 {
                    let rate = sign * 0.1 * f64::from(way) * rounding / dt;
                    if margin.allows(now, rate) {
                        clear += 1;
                        let free = bounds.contains(rate) && bounds.met(rate).is_none();
                        assert!(free, "{rate} in {bounds:?} at {now:?}");
                    }
                }
            }
        }
        assert!(clear > 1000, "{clear}");
    }
}
