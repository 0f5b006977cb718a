//! The stop of a joint within acceleration and jerk limits, step by step, and the way on it.
//!
//! Formula  a' = clamp(-sign(v) min(A, w(|v|)), a - J dt, a + J dt),  v' = v + a' dt:
//!          the acceleration that reaches v = 0 and a = 0 together, as fast as the jerk permits. w(v)
//!          is the largest deceleration that steps of J dt reduce to zero within the velocity v: the
//!          stopping velocity of `stopping.rs`, one derivative higher
//! Phases   n steps of jerk J, m steps of acceleration A, K steps of jerk J; velocities are sums over
//!          1, i and i^2, ways sums over i and i (i + 1) / 2, so that each phase is a polynomial
//! Units    rad or m, s
//! Valid    J > 0; A > 0 or infinite. The law depends on v and a alone: a stop that is planned again
//!          in the next step is the rest of this one. A larger first velocity v', at the acceleration
//!          (v' - v) / dt, ends nowhere earlier
//! Why so   any stop within the limits would keep a joint inside them; that of least time leaves the
//!          largest velocities. Simulating it takes hundreds of steps at 1 kHz
//! Cost     a search over n: about ten square roots
//! Source   minimum-time stop of a double integrator in velocity and acceleration (Bryson & Ho 1975,
//!          3.9), on the grid of the time steps
//! Checked  tests in this file, tests/it/servo/jerk.rs

use super::stopping::stopping_velocity;
use crate::model::Limits;
use crate::scalar::{clamp, largest};

/// Velocity and acceleration of a joint, and the limits within which it stops.
#[derive(Debug, Clone, Copy)]
pub(in crate::control) struct JerkLimitedStop {
    velocity: f64,
    acceleration: f64,
    /// The largest acceleration, and its largest change in a step.
    most: f64,
    change: f64,
    dt: f64,
    /// Sign of the jerk at first: negative for 1.
    side: f64,
    /// Steps of the first phase, with the velocity after it.
    rising: f64,
    peak: f64,
    /// Steps of the second phase, with the speed after it.
    steady: f64,
    speed: f64,
    /// Steps of the last phase, and its first deceleration.
    falling: f64,
    deceleration: f64,
}

/// The range of positions on a stop, relative to its start, and its largest speed.
#[derive(Debug, Clone, Copy)]
pub(super) struct StopRange {
    pub(super) lowest: f64,
    pub(super) highest: f64,
    pub(super) speed: f64,
}

impl JerkLimitedStop {
    /// The stop from a velocity and an acceleration, which is the last change of the velocity by `dt`.
    pub(in crate::control) fn new(
        limits: &Limits,
        velocity: f64,
        acceleration: f64,
        dt: f64,
    ) -> Self {
        let mut stop = Self {
            velocity,
            acceleration,
            most: limits.acceleration,
            change: limits.jerk * dt,
            dt,
            side: 1.0,
            rising: 0.0,
            peak: velocity,
            steady: 0.0,
            speed: 0.0,
            falling: 0.0,
            deceleration: 0.0,
        };
        stop.side = if acceleration >= stop.aim(velocity) { 1.0 } else { -1.0 };
        stop.load_rising();
        stop.load_rest();
        stop
    }

    /// The acceleration of a stop that is under way: all further changes fit the jerk.
    fn aim(&self, velocity: f64) -> f64 {
        let speed = velocity.abs();
        let most = stopping_velocity(speed, self.change / self.dt, self.dt).min(self.most);
        -most * velocity.signum()
    }

    /// Velocity after `i` steps of the first phase.
    fn rising_velocity(&self, i: f64) -> f64 {
        let change = self.acceleration * i - self.side * self.change * (0.5 * i * (i + 1.0));
        self.velocity + self.dt * change
    }

    /// Way in `i` steps of the first phase.
    fn rising_way(&self, i: f64) -> f64 {
        let pairs = 0.5 * i * (i + 1.0);
        let change = self.acceleration * pairs - self.side * self.change * pairs * (i + 2.0) / 3.0;
        self.dt * (i * self.velocity + self.dt * change)
    }

    /// The first phase ends with the last step whose full jerk does not pass the aim.
    fn load_rising(&mut self) {
        let ends = |i: f64| {
            // After i steps, would another one pass?
            let next = self.acceleration - self.side * self.change * (i + 1.0);
            self.side * (next - self.aim(self.rising_velocity(i))) <= 0.0
        };
        let (mut below, mut above) = (0.0_f64, 1.0_f64);
        if ends(below) {
            above = 0.0;
        } else {
            while !ends(above) && above < MOST_STEPS {
                (below, above) = (above, 2.0 * above);
            }
        }
        while above - below > 1.0 {
            let middle = (0.5 * (below + above)).floor();
            if ends(middle) {
                above = middle;
            } else {
                below = middle;
            }
        }
        self.rising = above;
        self.peak = self.rising_velocity(above);
    }

    /// The other phases.
    fn load_rest(&mut self) {
        let speed = self.peak.abs();
        let (dt, jerk) = (self.dt, self.change / self.dt);
        self.steady = 0.0;
        self.speed = speed;
        if self.most < f64::INFINITY {
            // The speed at which the last phase begins with the largest acceleration.
            let k = (self.most / self.change).floor();
            let least = self.change * dt * (k + 1.0) * (0.5 * k + (self.most / self.change - k));
            let loss = self.most * dt;
            if speed > least && loss > 0.0 {
                self.steady = ((speed - least) / loss).ceil().min(MOST_STEPS);
                self.speed = (speed - self.steady * loss).max(0.0);
            }
        }
        self.deceleration = stopping_velocity(self.speed, jerk, dt).min(self.most);
        self.falling =
            if self.speed > 0.0 { (self.deceleration / self.change).ceil().max(1.0) } else { 0.0 };
    }

    /// The velocity of the next step.
    pub(in crate::control) fn next(&self) -> f64 {
        let (a, change) = (self.acceleration, self.change);
        let next = clamp(self.aim(self.velocity), a - change, a + change);
        let velocity = self.velocity + next * self.dt;
        // The last step ends at rest, not beside it by a rounding.
        if velocity.abs() <= ROUNDING * self.velocity.abs() { 0.0 } else { velocity }
    }

    /// Steps until the joint rests.
    pub(in crate::control) fn steps(&self) -> f64 {
        self.rising + self.steady + self.falling
    }

    /// Way after some steps.
    pub(in crate::control) fn way(&self, steps: f64) -> f64 {
        let rising = steps.min(self.rising);
        let steady = (steps - rising).min(self.steady);
        let falling = (steps - rising - steady).min(self.falling);
        let sign = self.peak.signum();
        let mut way = self.rising_way(rising);
        if steady > 0.0 {
            let loss = self.most * self.dt;
            way +=
                sign * self.dt * (steady * self.peak.abs() - 0.5 * loss * steady * (steady + 1.0));
        }
        if falling > 0.0 {
            let i = falling;
            let pairs = 0.5 * i * (i + 1.0);
            let change = self.deceleration * pairs - self.change * pairs * (i - 1.0) / 3.0;
            way += sign * self.dt * (i * self.speed - self.dt * change);
        }
        way
    }

    /// The extreme positions and velocities on the way to rest.
    pub(super) fn range(&self) -> StopRange {
        let end = self.way(f64::INFINITY);
        let mut range = StopRange {
            lowest: end.min(0.0),
            highest: end.max(0.0),
            speed: self.velocity.abs().max(self.peak.abs()),
        };
        self.for_each_extreme(|i| {
            let (way, speed) = (self.rising_way(i), self.rising_velocity(i).abs());
            range.lowest = range.lowest.min(way);
            range.highest = range.highest.max(way);
            range.speed = range.speed.max(speed);
        });
        range
    }

    /// The largest change of the position between two steps, from its value at the first of them.
    pub(in crate::control) fn largest_change(&self, from: f64, to: f64) -> f64 {
        let start = self.way(from);
        let mut largest = (self.way(to) - start).abs();
        if from < self.rising {
            self.for_each_extreme(|i| {
                if i > from && i < to {
                    largest = largest.max((self.rising_way(i) - start).abs());
                }
            });
        }
        largest
    }

    /// The steps of the first phase where acceleration or velocity may change their signs.
    fn for_each_extreme(&self, mut look: impl FnMut(f64)) {
        let top = (self.side * self.acceleration / self.change).floor();
        let (v, a) = (self.side * self.velocity, self.side * self.acceleration);
        let half = a / self.change - 0.5;
        let root = (half * half + 2.0 * v / (self.change * self.dt)).max(0.0).sqrt();
        for near in [top, (half - root).floor(), (half + root).floor()] {
            if near.is_finite() {
                for i in [near - 1.0, near, near + 1.0, near + 2.0] {
                    look(clamp(i, 0.0, self.rising));
                }
            }
        }
    }
}

/// The largest velocity of the next step, up to `most`, from which what moves now with a velocity and
/// an acceleration stops within `room`: of a distance, whose limits are those that joints give it.
pub(in crate::control) fn largest_approach(
    limits: &Limits,
    (velocity, room): (f64, f64),
    most: f64,
    dt: f64,
) -> f64 {
    let fits = |next: f64| {
        let stop = JerkLimitedStop::new(limits, next, (next - velocity) / dt, dt);
        dt * next + stop.range().highest <= room
    };
    if fits(most) { most } else { largest(0.0, most, HALVINGS, fits) }
}

/// Halvings of the interval in which the largest approach lies.
const HALVINGS: usize = 24;

/// Steps of a phase at most.
const MOST_STEPS: f64 = 1e9;

/// Relative rounding of a sum of velocities [-].
const ROUNDING: f64 = 1e-12;

#[cfg(test)]
mod tests {
    use super::super::stopping::jerk_limited_stopping_velocity;
    use super::*;

    fn limits(acceleration: f64, jerk: f64) -> Limits {
        Limits { acceleration, jerk, ..Limits::NONE }
    }

    /// Phases in closed form are the stop that the law gives step by step; it obeys both limits and
    /// ends at rest, without acceleration that a step could not remove.
    #[test]
    fn closed_form_is_the_stop_step_by_step() {
        let mut seed = 7;
        let mut next = || 2.0 * crate::scalar::uniform(&mut seed) - 1.0;
        let mut longest = 0.0_f64;
        for round in 0..4000 {
            let dt = [1e-3, 2e-3, 0.02][round % 3];
            let jerk = 10.0_f64.powf(1.5 + 1.5 * next());
            let most = if round % 5 == 0 { f64::INFINITY } else { 10.0_f64.powf(next()) };
            let limits = limits(most, jerk);
            let a0 = next() * most.min(5.0);
            let v0 = [2.0 * next(), 1e-3 * next(), 0.0][round % 4 % 3];
            let stop = JerkLimitedStop::new(&limits, v0, a0, dt);
            let range = stop.range();
            let (mut v, mut a, mut q) = (v0, a0, 0.0_f64);
            let (mut lowest, mut highest, mut speed) = (0.0_f64, 0.0_f64, v0.abs());
            let mut steps = 0.0;
            while (v != 0.0 || a.abs() > jerk * dt * (1.0 + 1e-9)) && steps < 1e6 {
                let now = JerkLimitedStop::new(&limits, v, a, dt);
                let rest = stop.way(f64::INFINITY) - q;
                let scale = 1.0 + range.highest - range.lowest;
                assert!(
                    (now.way(f64::INFINITY) - rest).abs() < 1e-9 * scale,
                    "{now:?} of {stop:?}"
                );
                let new = now.next();
                let change = (new - v) / dt;
                assert!(change.abs() <= most.max(a0.abs()) * (1.0 + 1e-9), "{now:?}");
                assert!(
                    (change - a).abs() <= jerk * dt * (1.0 + 1e-6) + 1e-9,
                    "{a} {change} {now:?}"
                );
                (v, a, q) = (new, change, q + new * dt);
                steps += 1.0;
                if round % 7 == 0 || steps < 4.0 {
                    assert!((stop.way(steps) - q).abs() < 1e-9 * scale, "{steps} of {stop:?}");
                }
                (lowest, highest, speed) = (lowest.min(q), highest.max(q), speed.max(v.abs()));
            }
            longest = longest.max(steps);
            assert!(v == 0.0, "{stop:?}");
            assert!((steps - stop.steps()).abs() <= 2.0, "{steps} of {stop:?}");
            let scale = 1e-9 * (1.0 + highest - lowest);
            assert!((lowest - range.lowest).abs() < scale, "{lowest} {range:?} {stop:?}");
            assert!((highest - range.highest).abs() < scale, "{highest} {range:?} {stop:?}");
            assert!(
                (speed - range.speed).abs() < 1e-9 * (1.0 + speed),
                "{speed} {range:?} {stop:?}"
            );
        }
        assert!(longest > 1000.0);
    }

    /// Between any two steps, also of a stop that turns round, once or twice.
    #[test]
    fn the_largest_change_is_that_of_all_steps() {
        let mut seed = 5;
        let mut next = || 2.0 * crate::scalar::uniform(&mut seed) - 1.0;
        let mut turns = 0;
        for round in 0..2000 {
            let limits = limits(1.0 + next().abs(), 10.0_f64.powf(1.0 + next()));
            // Slow ones that brake hard turn round.
            let (v0, a0) =
                [(next(), 1.5 * next()), (0.05 * next().abs(), -1.5 * next().abs())][round % 2];
            let stop = JerkLimitedStop::new(&limits, v0, a0, 0.004);
            let last = stop.steps();
            let ways: Vec<f64> = (0..=last as usize).map(|i| stop.way(i as f64)).collect();
            let from = if round % 4 < 2 { 0 } else { (0.5 * (1.0 + next()) * last) as usize };
            let (mut furthest, mut is_turning) = (0.0_f64, false);
            for to in from..ways.len() {
                let change = (ways[to] - ways[from]).abs();
                furthest = furthest.max(change);
                is_turning |= furthest > 1.1 * change;
                let told = stop.largest_change(from as f64, to as f64);
                assert!((told - furthest).abs() < 1e-12, "{told} {furthest} {from} {to} {stop:?}");
            }
            turns += usize::from(is_turning);
        }
        assert!(turns > 100, "{turns}");
    }

    /// A larger velocity in this step ends no lower.
    #[test]
    fn faster_steps_end_no_lower() {
        let mut seed = 11;
        let mut next = || 2.0 * crate::scalar::uniform(&mut seed) - 1.0;
        for _ in 0..20_000 {
            let limits = limits(1.0 + next(), 10.0_f64.powf(2.0 * next()));
            let (dt, before) = (0.004, 0.5 * next());
            let mut speeds = [next(), next()].map(|x| before + x * limits.acceleration * dt);
            speeds.sort_by(f64::total_cmp);
            let [low, high] = speeds.map(|v| {
                let range = JerkLimitedStop::new(&limits, v, (v - before) / dt, dt).range();
                (dt * v + range.lowest, dt * v + range.highest)
            });
            assert!(low.0 <= high.0 + 1e-12 && low.1 <= high.1 + 1e-12, "{low:?} {high:?}");
        }
    }

    /// From rest of the acceleration, the smooth profile stops within its distance.
    #[test]
    fn the_smooth_velocity_stops_in_time() {
        for distance in [1e-6, 1e-3, 0.1, 2.0, 40.0] {
            for jerk in [0.5, 10.0, 300.0] {
                let v = jerk_limited_stopping_velocity(distance, 2.0, jerk, 1e-4);
                let stop = JerkLimitedStop::new(&limits(2.0, jerk), v, 0.0, 1e-4);
                let way = stop.way(f64::INFINITY);
                assert!(way <= distance + 2e-4 * v && way > 0.5 * distance, "{way} of {distance}");
            }
        }
    }
}
