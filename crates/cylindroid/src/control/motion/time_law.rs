//! Time laws: the fastest motion of one coordinate from rest to rest within its bounds.
//!
//! Formula  the page of [`TimeLaw`]
//! Units    any length unit u for the coordinate (m, rad, or 1); u/s, u/s^2, u/s^3; time in s
//! Valid    any finite distance, of either sign; bounds positive. An infinite jerk gives the
//!          trapezoid, an infinite velocity no cruise, an infinite acceleration (with a finite
//!          jerk) no phase of constant acceleration. Distance zero: duration zero
//! Fails    on bounds that are NaN, zero or negative, on acceleration and jerk both infinite (the
//!          velocity would jump), on durations that overflow
//! Why so   the times are found first and the extrema from them, so the distance is met to rounding
//!          whatever the case, and one formula serves every degenerate case; the usual tree of
//!          cases, each with its own closed form, disagrees with itself at the borders. The price:
//!          an extremum may exceed its bound by rounding (a few 1e-16 of it)
//! Source   Biagiotti & Melchiorri 2008, sections 3.2 (trapezoid) and 3.4 (double S); their T_j1,
//!          T_a, T_v are tj, 2 tj + tc, tv
//! Checked  tests/motion/laws.rs

use crate::error::{Error, Result, all_finite};

/// Bounds of the absolute values of one coordinate's derivatives, in its unit u (m, rad or 1).
///
/// Infinity means no bound; acceleration and jerk cannot both be infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KinematicBounds {
    /// Largest speed [u/s].
    pub velocity: f64,
    /// Largest acceleration [u/s^2].
    pub acceleration: f64,
    /// Largest jerk [u/s^3]; infinite for a trapezoidal velocity.
    pub jerk: f64,
}

/// The state of one coordinate on its time law.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LawSample {
    /// The coordinate, from 0 to the distance (u).
    pub position: f64,
    /// [u/s]
    pub velocity: f64,
    /// [u/s^2]
    pub acceleration: f64,
    /// [u/s^3]; the impulses of a trapezoidal law are not in it.
    pub jerk: f64,
}

/// A motion of one coordinate from rest at 0 to rest at a distance.
///
/// ```text
/// jerk +j for tj, acceleration a for tc, jerk -j for tj, velocity v for tv, then the mirror image
/// tj = min(a / j, sqrt(v / j), cbrt(h / 2 j))
/// tc = min(v / a - tj, sqrt(tj^2 / 4 + h / a) - 3 tj / 2) where tj = a / j, otherwise 0
/// tv = max(h / v - 2 tj - tc, 0),   T = 4 tj + 2 tc + tv,   h = v_peak (2 tj + tc + tv)
/// ```
///
/// h is the distance in any unit u (m, rad or 1), T the duration (s); v, a and j are the bounds in
/// u/s, u/s^2 and u/s^3. An infinite jerk gives the trapezoidal velocity profile.
///
/// Source: Biagiotti & Melchiorri 2008, sections 3.2 and 3.4.
///
/// ```
/// use cylindroid::control::{KinematicBounds, TimeLaw};
/// let bounds = KinematicBounds { velocity: 1.0, acceleration: 2.0, jerk: f64::INFINITY };
/// let law = TimeLaw::new(3.0, bounds)?;
/// assert_eq!(law.duration(), 3.5); // h / v + v / a
/// assert_eq!(law.at(1.75).position, 1.5);
/// # Ok::<(), cylindroid::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[doc(alias = "trapezoidal velocity profile")]
#[doc(alias = "S-curve")]
pub struct TimeLaw {
    distance: f64,
    duration: f64,
    times: Times,
    /// Peak velocity, acceleration and jerk, with the sign of the distance.
    peak: KinematicBounds,
}

/// Lengths of the segments (s).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Times {
    /// Each of the four with jerk: tj.
    jerk: f64,
    /// Each of the two with constant acceleration: tc.
    constant: f64,
    /// The one with constant velocity: tv.
    cruise: f64,
}

impl KinematicBounds {
    /// No bound at all: the neutral element of [`Self::tightest`].
    pub(crate) const NONE: Self =
        Self { velocity: f64::INFINITY, acceleration: f64::INFINITY, jerk: f64::INFINITY };

    /// Rejects bounds that permit no motion or a jump of the velocity; `what` names the coordinate.
    pub(crate) fn check(self, what: &str) -> Result<()> {
        for (option, value) in [
            ("velocity bound", self.velocity),
            ("acceleration bound", self.acceleration),
            ("jerk bound", self.jerk),
        ] {
            if value.is_nan() || value <= 0.0 {
                return Err(Error::InvalidOption {
                    option,
                    value: value.to_string(),
                    reason: format!("the bound of {what} must be positive; infinity means none"),
                });
            }
        }
        if self.is_unbounded() {
            return Err(Error::InvalidOption {
                option: "acceleration bound",
                value: self.acceleration.to_string(),
                reason: format!(
                    "with an infinite jerk the velocity of {what} would jump; bound one of them"
                ),
            });
        }
        Ok(())
    }

    /// True if the velocity may jump.
    pub(crate) fn is_unbounded(self) -> bool {
        self.acceleration == f64::INFINITY && self.jerk == f64::INFINITY
    }

    /// The bounds of `s` in `x = length s`; none if the length is zero.
    pub(crate) fn over(self, length: f64) -> Self {
        Self {
            velocity: self.velocity / length,
            acceleration: self.acceleration / length,
            jerk: self.jerk / length,
        }
    }

    /// The tighter of two, component-wise.
    pub(crate) fn tightest(self, other: Self) -> Self {
        Self {
            velocity: self.velocity.min(other.velocity),
            acceleration: self.acceleration.min(other.acceleration),
            jerk: self.jerk.min(other.jerk),
        }
    }
}

impl Times {
    /// The fastest law over `h > 0`.
    fn fastest(h: f64, bounds: KinematicBounds) -> Self {
        let KinematicBounds { velocity: v, acceleration: a, jerk: j } = bounds;
        let limit = a / j;
        // v / j is NaN if both are infinite; `min` then keeps the other operand, as it should.
        let jerk = limit.min((v / j).sqrt()).min((0.5 * h / j).cbrt());
        let constant = if jerk < limit {
            0.0
        } else {
            // sqrt(tj^2/4 + h/a) - 3 tj/2 without the cancellation
            let free = h / a;
            let apex =
                (free - 2.0 * jerk * jerk) / ((0.25 * jerk * jerk + free).sqrt() + 1.5 * jerk);
            (v / a - jerk).min(apex).max(0.0)
        };
        Self { jerk, constant, cruise: (h / v - (2.0 * jerk + constant)).max(0.0) }
    }

    /// From rest to the peak velocity (s).
    fn ramp(self) -> f64 {
        2.0 * self.jerk + self.constant
    }

    fn total(self) -> f64 {
        2.0 * self.ramp() + self.cruise
    }
}

impl TimeLaw {
    /// The fastest law over `distance` (u) (of either sign) within `bounds`.
    ///
    /// # Errors
    /// A distance that is not finite; bounds that are NaN, zero or negative, or that leave both
    /// acceleration and jerk infinite; a duration that overflows.
    pub fn new(distance: f64, bounds: KinematicBounds) -> Result<Self> {
        bounds.check("the coordinate")?;
        if !distance.is_finite() {
            return Err(Error::NotFinite {
                what: "distance of a time law".to_owned(),
                value: distance,
            });
        }
        if distance == 0.0 {
            return Ok(Self::instant(0.0));
        }
        let times = Times::fastest(distance.abs(), bounds);
        let law = Self::from_times(distance, times, times.total());
        let KinematicBounds { velocity, acceleration, jerk } = law.peak;
        let numbers = [law.duration, velocity, acceleration, jerk];
        if times.jerk + times.constant > 0.0 && all_finite(&numbers) {
            return Ok(law);
        }
        Err(Error::InvalidOption {
            option: "distance of a time law",
            value: distance.to_string(),
            reason: format!(
                "distance and bounds are too many orders of magnitude apart: it would take {} s",
                law.duration
            ),
        })
    }

    /// A jump over `distance`, for distances too short for a duration.
    fn instant(distance: f64) -> Self {
        Self::from_times(distance, Times::default(), 0.0)
    }

    /// The law of a path coordinate from 0 to 1; without any bound the path has no length and takes
    /// no time.
    pub(crate) fn along(bounds: KinematicBounds) -> Result<Self> {
        if bounds.is_unbounded() { Ok(Self::instant(1.0)) } else { Self::new(1.0, bounds) }
    }

    fn from_times(distance: f64, times: Times, duration: f64) -> Self {
        let ratio = |a: f64, b: f64| if b > 0.0 { a / b } else { 0.0 };
        let velocity = ratio(distance, times.ramp() + times.cruise);
        let acceleration = ratio(velocity, times.jerk + times.constant);
        let jerk = ratio(acceleration, times.jerk);
        Self { distance, duration, times, peak: KinematicBounds { velocity, acceleration, jerk } }
    }

    /// The same motion slowed down to last `duration` (s), within every bound.
    ///
    /// With k = `duration` / [`Self::duration`], the velocity is divided by k, the acceleration by
    /// k^2, the jerk by k^3. This lets several axes end together.
    ///
    /// # Errors
    /// A duration shorter than that of this law, or not finite.
    pub fn scaled_to_duration(self, duration: f64) -> Result<Self> {
        if !duration.is_finite() || duration < self.duration {
            return Err(Error::InvalidOption {
                option: "duration",
                value: duration.to_string(),
                reason: format!("within its bounds this law lasts {} s or more", self.duration),
            });
        }
        if duration == self.duration {
            return Ok(self);
        }
        let times = if self.duration > 0.0 {
            let stretch = |time: f64| time / self.duration * duration;
            let Times { jerk, constant, cruise } = self.times;
            Times { jerk: stretch(jerk), constant: stretch(constant), cruise: stretch(cruise) }
        } else {
            Times { cruise: duration, ..Times::default() }
        };
        Ok(Self::from_times(self.distance, times, duration))
    }

    /// Time from rest to rest (s).
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// The distance (u), as given.
    #[must_use]
    pub fn distance(&self) -> f64 {
        self.distance
    }

    /// The largest absolute values of the derivatives; jerk 0 for a trapezoidal law, whose
    /// acceleration jumps.
    #[must_use]
    pub fn extrema(&self) -> KinematicBounds {
        let KinematicBounds { velocity, acceleration, jerk } = self.peak;
        KinematicBounds {
            velocity: velocity.abs(),
            acceleration: acceleration.abs(),
            jerk: jerk.abs(),
        }
    }

    /// Start times of the seven segments, and the end (s); equal neighbours bound an empty segment.
    #[must_use]
    pub fn switches(&self) -> [f64; 8] {
        let (Times { jerk, constant, .. }, ramp, end) =
            (self.times, self.times.ramp(), self.duration);
        [0.0, jerk, jerk + constant, ramp, end - ramp, end - jerk - constant, end - jerk, end]
    }

    /// The state at time `t` (s): at rest at 0 before 0 (and for NaN), at rest at the distance
    /// after the end. At a jump of the acceleration or the jerk, one of its two values.
    #[must_use]
    pub fn at(&self, t: f64) -> LawSample {
        if t >= self.duration && t >= 0.0 {
            return LawSample { position: self.distance, ..LawSample::default() };
        }
        if t.is_nan() || t < 0.0 {
            return LawSample::default();
        }
        if t <= 0.5 * self.duration {
            return self.rise(t);
        }
        // The second half mirrors the first.
        let left = self.rise(self.duration - t);
        LawSample {
            position: self.distance - left.position,
            acceleration: -left.acceleration,
            ..left
        }
    }

    /// The first half.
    fn rise(&self, t: f64) -> LawSample {
        let KinematicBounds { velocity: v, acceleration: a, jerk: j } = self.peak;
        let (Times { jerk: tj, constant, .. }, ramp) = (self.times, self.times.ramp());
        if t < tj {
            return LawSample {
                position: j * t * t * t / 6.0,
                velocity: 0.5 * j * t * t,
                acceleration: j * t,
                jerk: j,
            };
        }
        if t < tj + constant {
            let d = t - tj;
            return LawSample {
                position: a * tj * tj / 6.0 + 0.5 * a * d * (tj + d),
                velocity: a * (0.5 * tj + d),
                acceleration: a,
                jerk: 0.0,
            };
        }
        if t < ramp {
            let left = ramp - t;
            return LawSample {
                position: v * (0.5 * ramp - left) + j * left * left * left / 6.0,
                velocity: v - 0.5 * j * left * left,
                acceleration: j * left,
                jerk: -j,
            };
        }
        LawSample { position: v * (t - 0.5 * ramp), velocity: v, acceleration: 0.0, jerk: 0.0 }
    }
}
