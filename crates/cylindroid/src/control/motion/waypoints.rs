//! Moves through waypoints: lines of constant twist, joined by blends of constant acceleration.
//!
//! Formula  the page of [`WaypointMove`]
//! Units    m, rad, s
//! Valid    two poses or more, from rest to rest. The corners of the path are rounded: a waypoint is
//!          passed at a distance of T |v1 - v0| / 8, T the duration of its blend. Angular accelerations
//!          are within their bound where |w0 x w1| is at most that bound
//! Fails    on non-finite input, times that do not increase or are too short for the accelerations,
//!          speeds that are not positive, distances, times and bounds that differ by too many orders of
//!          magnitude
//! Why so   a robot need not stop at a waypoint, and the lines between them stay straight; splines
//!          pass through the waypoints exactly, but swing between them. Speeds without times are those
//!          of `waypoints/speeds.rs`
//! Source   Craig 2005, section 7.3 (linear function with parabolic blends); Siciliano et al. 2009,
//!          section 4.2.2
//! Checked  tests/motion/waypoints.rs, tests/motion/dense_waypoints.rs, tests/it/waypoints.rs

mod speeds;

use speeds::{Phases, Segment, Speeds};

use super::cartesian_move::CartesianBounds;
use super::path::CartesianPath;
use super::time_law::KinematicBounds;
use crate::control::servo::Target;
use crate::error::{Error, Result};
use crate::spatial::{Pose, Rotation, Twist, Vec3};
use crate::tolerance::{ORIENTATION, POSITION};

/// Share of the speed that the accelerations permit from which a bound of it counts as none [-].
const FAR_BEYOND: f64 = 1e3;

/// A frame moving through waypoints without stopping, from rest to rest.
///
/// ```text
/// on a line   p' = v,  R' = w x R
/// in a blend  p = p_i - v0 (T - u)^2 / 2 T + v1 u^2 / 2 T,   0 <= u <= T
///             R = exp(w1 u^2 / 2 T) exp(-w0 (T - u)^2 / 2 T) R_i
/// ```
///
/// In a blend of duration T at the waypoint p_i, R_i the twist changes from v0, w0 to v1, w1 with
/// constant acceleration. On a line it is constant, and changes where the blends at its ends are
/// passed at less than its highest speed. Units: m, rad, s.
///
/// ```
/// use cylindroid::control::{CartesianBounds, KinematicBounds, WaypointMove};
/// use cylindroid::{Pose, Vec3};
///
/// let corner = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y].map(Pose::from_translation);
/// let bounds = CartesianBounds {
///     linear: KinematicBounds { velocity: 0.5, acceleration: 1.0, jerk: f64::INFINITY },
///     angular: KinematicBounds { velocity: 1.0, acceleration: 4.0, jerk: f64::INFINITY },
/// };
/// let motion = WaypointMove::new(&corner, bounds)?;
/// assert!((motion.duration() - 4.5).abs() < 1e-12); // 2 m at 0.5 m/s, and the ends
/// let most = motion.largest_deviation();
/// assert!((most - 0.5_f64.sqrt() * 0.5_f64.sqrt() / 8.0).abs() < 1e-12); // T |v1 - v0| / 8
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// Source: Craig 2005, section 7.3; Siciliano et al. 2009, section 4.2.2.
#[derive(Debug, Clone, PartialEq)]
pub struct WaypointMove {
    knots: Vec<Knot>,
    duration: f64,
    largest_deviation: f64,
}

/// A waypoint with its blend, or a place on a line where the speed changes.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Knot {
    pose: Pose,
    /// The middle of the blend (s).
    time: f64,
    /// Duration of the blend (s).
    blend: f64,
    /// Twists before and after, world axes, at the moving origin.
    before: Twist,
    after: Twist,
}

impl WaypointMove {
    /// Through poses with at most the speeds and accelerations of `bounds`; it is slower where blends
    /// would not fit otherwise. Along a densely sampled curve of radius R the speed is that of the
    /// curve, sqrt(a R) or the bound, for any number of points. Poses that repeat the last one before
    /// are left out. An infinite speed is none to keep to. The jerk is not bounded: those of `bounds`
    /// must be infinite.
    ///
    /// # Errors
    /// Fewer than two poses, non-finite poses, bounds that are not positive, a finite jerk; a duration
    /// that overflows.
    pub fn new(poses: &[Pose], bounds: CartesianBounds) -> Result<Self> {
        Self::bounded(poses, None, bounds)
    }

    /// [`WaypointMove::new`] with a speed for each segment (m/s), one fewer than poses: at most that of
    /// the translation on the way to the next pose, and that of `bounds`. A segment that only rotates
    /// has the angular speed of `bounds`. Blends lie between the speeds of both segments.
    ///
    /// # Errors
    /// As [`WaypointMove::new`]; another number of speeds, and speeds that are not positive.
    pub fn with_speeds(poses: &[Pose], speeds: &[f64], bounds: CartesianBounds) -> Result<Self> {
        Self::bounded(poses, Some(speeds), bounds)
    }

    fn bounded(poses: &[Pose], given: Option<&[f64]>, bounds: CartesianBounds) -> Result<Self> {
        check(poses, bounds)?;
        if let Some(given) = given {
            Error::check_len("speeds of the waypoints", poses.len() - 1, given.len())?;
            if let Some(i) = given.iter().position(|speed| speed.is_nan() || *speed <= 0.0) {
                return Err(Error::InvalidOption {
                    option: "speeds of the waypoints",
                    value: format!(
                        "{} m/s from waypoint {i} to {} (0 is the start)",
                        given[i],
                        i + 1
                    ),
                    reason: "a speed must be positive".to_owned(),
                });
            }
        }
        let (poses, places) = &without_repetitions(poses)?;
        let ways = ways(poses)?;
        // Those of the segments that end at the poses that are kept.
        let own = |i: usize| given.map_or(f64::INFINITY, |given| given[places[i + 1] - 1]);
        let fastest = (0..ways.len()).map(own).fold(0.0, f64::max);
        let [linear, angular] = speeds(&ways, bounds);
        let linear = linear.min(fastest);
        let over = |way: Vec3, speed: f64| if speed > 0.0 { way.norm() / speed } else { 0.0 };
        let segment = |(i, way): (usize, &Twist)| {
            let time = over(way.linear, linear).max(over(way.angular, angular));
            let limit = own(i) * time / way.linear.norm();
            let limit = if limit < 1.0 { limit } else { 1.0 };
            Segment::new(*way, time, limit, bounds)
        };
        let segments: Vec<Segment> = ways.iter().enumerate().map(segment).collect();
        Self::assemble(poses, &segments, &speeds::quickest(&segments, bounds), bounds)
    }

    /// Through poses at given times (s): it starts at rest at the first time, passes the others in
    /// the middle of their blends, and ends at rest at the last. Speeds follow from the times; those
    /// of `bounds` are not used.
    ///
    /// # Errors
    /// As [`WaypointMove::new`]; times that do not increase, or too short for the accelerations: the
    /// segment is named.
    pub fn timed(poses: &[Pose], times: &[f64], bounds: CartesianBounds) -> Result<Self> {
        check(poses, bounds)?;
        Error::check_len("times of the waypoints", poses.len(), times.len())?;
        Error::check_finite("times of the waypoints", times)?;
        let refuse = |i: usize, reason: String| {
            let value = format!("{} s to {} s", times[i], times[i + 1]);
            Err(Error::InvalidOption { option: "times of the waypoints", value, reason })
        };
        if let Some(i) = (1..times.len()).position(|i| times[i] <= times[i - 1]) {
            return refuse(i, "they must increase".to_owned());
        }
        let ways = ways(poses)?;
        let mut durations: Vec<f64> = times.windows(2).map(|t| t[1] - t[0]).collect();
        if let Some(i) = durations.iter().position(|d| d.is_infinite()) {
            return refuse(i, "the time between them is not finite".to_owned());
        }
        let last = ways.len() - 1;
        // The blends from and to rest take time of their segments: T (D - T / 2) = |way| / a, or
        // T (D - T) if one segment has both.
        let too_short = |i: usize| {
            refuse(i, "it is too short for the accelerations; allow more time".to_owned())
        };
        let shares = if last == 0 { 1.0 } else { 0.5 };
        let rest = |i: usize| {
            let (linear, angular) = speeds::sizes(ways[i], bounds);
            let (size, whole) = (linear.max(angular), durations[i]);
            // The smaller root without differences of large numbers, nor their squares.
            let least = 2.0 * (shares * size).sqrt();
            let root = (whole - least).sqrt() * (whole + least).sqrt();
            (whole >= least).then(|| 2.0 * size / (whole + root))
        };
        let Some(first) = rest(0) else { return too_short(0) };
        let Some(end) = rest(last) else { return too_short(last) };
        durations[0] -= 0.5 * first;
        durations[last] -= 0.5 * end;
        let of = |(way, time): (&Twist, &f64)| Segment::new(*way, *time, 1.0, bounds);
        let segments: Vec<Segment> = ways.iter().zip(&durations).map(of).collect();
        let mut speeds = vec![Speeds { start: 1.0, top: 1.0, end: 1.0 }; segments.len()];
        (speeds[0].start, speeds[last].end) = (0.0, 0.0);
        let mut blends = speeds::blends(&segments, &speeds, bounds);
        (blends[0], blends[last + 1]) = (first, end);
        for (i, duration) in durations.iter().enumerate() {
            if 0.5 * (blends[i] + blends[i + 1]) > duration * (1.0 + 1e-9) {
                return too_short(i);
            }
        }
        Self::assemble(poses, &segments, &speeds, bounds)
    }

    fn assemble(
        poses: &[Pose],
        segments: &[Segment],
        speeds: &[Speeds],
        bounds: CartesianBounds,
    ) -> Result<Self> {
        let blends = speeds::blends(segments, speeds, bounds);
        let last = segments.len() - 1;
        let (mut time, mut end_before, mut deviation) = (0.0, Twist::ZERO, 0.0_f64);
        let mut knots: Vec<Knot> = Vec::with_capacity(2 * poses.len());
        for (i, segment) in segments.iter().enumerate() {
            let Phases { twists: [start, top, end], times } =
                segment.phases(speeds[i], [blends[i], blends[i + 1]]);
            let [first, up, constant, down, half] = times;
            let mut add = |pose, time, blend, before, after| {
                knots.push(Knot { pose, time, blend, before, after });
            };
            if i > 0 {
                add(poses[i], time, blends[i], end_before, start);
                deviation = deviation.max(0.125 * blends[i] * (start - end_before).linear.norm());
            }
            time += first;
            if i == 0 {
                add(poses[0], 0.5 * up, up, Twist::ZERO, top);
            } else if up > 0.0 {
                let pose = moved(poses[i], start * (first + 0.5 * up));
                add(pose, time + 0.5 * up, up, start, top);
            }
            time += up + constant;
            if i == last {
                add(poses[i + 1], time + 0.5 * down, down, top, Twist::ZERO);
            } else if down > 0.0 {
                let pose = moved(poses[i + 1], end * -(half + 0.5 * down));
                add(pose, time + 0.5 * down, down, top, end);
            }
            time += down + half;
            end_before = end;
        }
        let is_finite =
            |k: &Knot| k.blend.is_finite() && k.before.is_finite() && k.after.is_finite();
        if time.is_finite() && knots.iter().all(is_finite) {
            return Ok(Self { knots, duration: time, largest_deviation: deviation });
        }
        Err(Error::InvalidOption {
            option: "waypoints",
            value: format!("a duration of {time} s"),
            reason: "distances, times and bounds are too many orders of magnitude apart".to_owned(),
        })
    }

    /// Time from rest to rest (s).
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// The largest distance at which a waypoint is passed (m).
    #[must_use]
    pub fn largest_deviation(&self) -> f64 {
        self.largest_deviation
    }

    /// Pose and twist (world axes, at the moving origin) at time `t` (s); at rest at the start before
    /// 0 and at the end after the duration.
    #[must_use]
    pub fn at(&self, t: f64) -> (Pose, Twist) {
        let ends = (&self.knots[0], &self.knots[self.knots.len() - 1]);
        if t.is_nan() || t <= 0.0 {
            return (ends.0.pose, Twist::ZERO);
        }
        if t >= self.duration {
            return (ends.1.pose, Twist::ZERO);
        }
        // The knot whose line or blend is at t: the last that has begun.
        let begun = self.knots.partition_point(|k| k.time - 0.5 * k.blend <= t);
        let knot = &self.knots[begun.max(1) - 1];
        let u = t - (knot.time - 0.5 * knot.blend);
        if u >= knot.blend {
            let since = t - knot.time;
            return (moved(knot.pose, knot.after * since), knot.after);
        }
        let (share, whole) = (u / knot.blend, knot.blend);
        let out = knot.after * (0.5 * u * share);
        let left = (whole - u) * (1.0 - share);
        let rest = moved(knot.pose, knot.before * (-0.5 * left));
        let turn = Rotation::exp(out.angular);
        let pose =
            Pose { translation: rest.translation + out.linear, rotation: turn * rest.rotation };
        let twist = Twist {
            linear: knot.before.linear * (1.0 - share) + knot.after.linear * share,
            angular: (turn * knot.before.angular) * (1.0 - share) + knot.after.angular * share,
        };
        (pose, twist)
    }

    /// The target of a servo of period `dt` (s) at time `t` (s): the present pose, and the constant
    /// twist that leads to the pose of the next step; without a next step (`dt` zero or NaN) the
    /// twist at `t`.
    #[must_use]
    pub fn target(&self, t: f64, dt: f64) -> Target {
        let ((pose, twist), rate) = (self.at(t), 1.0 / dt);
        if !rate.is_finite() {
            return Target { pose, feed_forward: twist };
        }
        Target { pose, feed_forward: pose.error_to(self.at(t + dt).0) * rate }
    }
}

/// A pose moved by a way in world axes, position and orientation each for itself.
fn moved(pose: Pose, way: Twist) -> Pose {
    Pose {
        translation: pose.translation + way.linear,
        rotation: Rotation::exp(way.angular) * pose.rotation,
    }
}

/// The poses without those that repeat the last one before, and their places among all; at least
/// the first and one more, and the end as given.
fn without_repetitions(poses: &[Pose]) -> Result<(Vec<Pose>, Vec<usize>)> {
    let (mut kept, mut places) = (vec![poses[0]], vec![0]);
    for (i, pose) in poses.iter().enumerate().skip(1) {
        let way = CartesianPath::line(kept[kept.len() - 1], *pose)?.derivative(0.0);
        if way.linear.norm() > POSITION || way.angular.norm() > ORIENTATION {
            kept.push(*pose);
            places.push(i);
        }
    }
    let end = poses.len() - 1;
    if kept.len() == 1 {
        kept.push(poses[end]);
        places.push(end);
    }
    let last = kept.len() - 1;
    (kept[last], places[last]) = (poses[end], end);
    Ok((kept, places))
}

/// Displacement and rotation vector of every segment, world axes.
fn ways(poses: &[Pose]) -> Result<Vec<Twist>> {
    let way = |pair: &[Pose]| Ok(CartesianPath::line(pair[0], pair[1])?.derivative(0.0));
    poses.windows(2).map(way).collect()
}

/// The bounds of both speeds, without those far beyond what is reached from rest on all ways
/// together.
fn speeds(ways: &[Twist], bounds: CartesianBounds) -> [f64; 2] {
    let top = |bounds: KinematicBounds, part: fn(&Twist) -> Vec3| {
        let length: f64 = ways.iter().map(|way| part(way).norm()).sum();
        bounds.velocity.min(FAR_BEYOND * bounds.acceleration.sqrt() * length.sqrt())
    };
    [top(bounds.linear, |way| way.linear), top(bounds.angular, |way| way.angular)]
}

fn check(poses: &[Pose], bounds: CartesianBounds) -> Result<()> {
    bounds.linear.check("the linear part")?;
    bounds.angular.check("the angular part")?;
    let refuse = |value: String, reason: &str| {
        let reason = reason.to_owned();
        Err(Error::InvalidOption { option: "waypoints", value, reason })
    };
    if bounds.linear.jerk.is_finite() || bounds.angular.jerk.is_finite() {
        let jerk = bounds.linear.jerk.min(bounds.angular.jerk);
        return refuse(format!("jerk {jerk}"), "blends have no bounded jerk; leave it infinite");
    }
    if poses.len() < 2 {
        return refuse(format!("{} poses", poses.len()), "a move needs a start and an end");
    }
    Ok(())
}
