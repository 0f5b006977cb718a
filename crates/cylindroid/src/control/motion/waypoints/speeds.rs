//! The speeds on the segments between waypoints: as high as the bounds and the blends permit.
//!
//! Formula  z is the speed as a share of that at which a segment reaches a bound, y = z^2 where two
//!          segments meet. A segment of the duration c at full speed contains half of the blends at
//!          its ends and the change of speed between them:
//!          g_0(y_0) + g_1(y_1) + r |y_1 - y_0| <= 2 c,   g(y) = z T(z), r the time from rest to full
//!          speed. One pass forwards and one backwards give the largest y of all waypoints, from rest
//!          to rest; in between, a segment speeds up as far as its length permits
//! Shapes   n segments, n + 1 waypoints; time and memory proportional to n
//! Units    s; shares [-]
//! Valid    any segments; where a blend turns by more than 60 degrees, faster at one end of a segment
//!          is slower at the other, and both get the same y
//! Fails    never; speeds that overflow are refused where the move is assembled
//! Why so   on a curve of radius R that is sampled densely, y is that of v^2 = a R, for any number of
//!          points: turning and speeding up take turns there, each with all of the acceleration.
//!          Among few points a short segment between long ones may be passed sooner at one speed, in
//!          blends that cut its corners: the way before. Between two segments at full speed, of
//!          which each half is enough for its end, nothing depends on the rest of the path; such a
//!          stretch has the quicker of both
//! Source   forward and backward pass: Bobrow, Dubowsky & Gibson 1985; blends: Craig 2005, section 7.3
//! Checked  tests/motion/dense_waypoints.rs, tests/motion/waypoints.rs, tests in this file

use crate::control::motion::cartesian_move::CartesianBounds;
use crate::scalar::largest;
use crate::spatial::{Twist, Vec3};

/// Largest number of rounds in which segments are lengthened until their blends fit; random polygons
/// take 15, and those that need more are no quicker so.
const ROUNDS: usize = 40;
/// Halvings of an interval of y, whose end is then far below any share that counts.
const HALVINGS: usize = 64;
/// Share of a time by which one way must be quicker than the other to replace it [-].
const QUICKER: f64 = 1e-9;

/// A segment between two waypoints.
#[derive(Debug, Clone, Copy)]
pub(super) struct Segment {
    /// Twist at full speed, world axes.
    full: Twist,
    /// Duration at full speed (s).
    time: f64,
    /// Time from rest to full speed (s).
    ramp: f64,
    /// Largest share of the full speed.
    limit: f64,
}

impl Segment {
    /// Of a way that takes a time (s) at full speed.
    pub(super) fn new(way: Twist, time: f64, limit: f64, bounds: CartesianBounds) -> Self {
        let full = if time > 0.0 { way * (1.0 / time) } else { Twist::ZERO };
        let (linear, angular) = sizes(full, bounds);
        Self { full, time, ramp: linear.max(angular), limit }
    }
}

/// The speeds on a segment, as shares: after the blend at its start, at most, and before the blend at
/// its end.
#[derive(Debug, Clone, Copy)]
pub(super) struct Speeds {
    pub(super) start: f64,
    pub(super) top: f64,
    pub(super) end: f64,
}

/// The motion on a segment, in the order of time.
#[derive(Debug, Clone, Copy)]
pub(super) struct Phases {
    /// Twists after the blend at the start, at most, and before the blend at the end.
    pub(super) twists: [Twist; 3],
    /// Durations of half the blend at the start, of speeding up, of the constant speed, of slowing
    /// down, and of half the blend at the end (s).
    pub(super) times: [f64; 5],
}

impl Segment {
    /// Between blends of these durations (s).
    pub(super) fn phases(&self, speeds: Speeds, blends: [f64; 2]) -> Phases {
        let Speeds { start, top, end } = speeds;
        let [first, last] = [self.part(start, top, blends[0]), self.part(end, top, blends[1])];
        let rest = (self.time - first.way - last.way).max(0.0);
        let constant = if rest > 0.0 { rest / top } else { 0.0 };
        let [up, down] = [(top - start) * self.ramp, (top - end) * self.ramp];
        Phases {
            twists: [start, top, end].map(|share| self.full * share),
            times: [0.5 * blends[0], up, constant, down, 0.5 * blends[1]],
        }
    }

    /// Half a blend at a share of the speed, and the ramp between it and the highest one.
    fn part(&self, share: f64, top: f64, blend: f64) -> Part {
        let change = (top - share) * self.ramp;
        let way = 0.5 * (blend * share + change * (top + share));
        Part { way, duration: 0.5 * blend + change }
    }
}

/// The half of a blend and the ramp at one end of a segment.
#[derive(Debug, Clone, Copy)]
struct Part {
    /// The way, as a duration at full speed (s).
    way: f64,
    duration: f64,
}

impl Part {
    /// How much longer it takes than at the highest speed of the segment (s).
    fn loss(self, top: f64) -> f64 {
        if self.way > 0.0 { self.duration - self.way / top } else { self.duration }
    }
}

/// A waypoint at which the speed is the same share before and after.
#[derive(Debug, Clone, Copy)]
struct Corner {
    /// Durations of the blend at full speed by the bounds of both accelerations (s), and the share of
    /// the angular one that the turning axis takes there [-].
    linear: f64,
    angular: f64,
    turning: f64,
}

impl Corner {
    /// At the ends of the path: at rest.
    const REST: Self = Self { linear: 0.0, angular: 0.0, turning: 0.0 };

    fn new(before: Twist, after: Twist, bounds: CartesianBounds) -> Self {
        let (linear, angular) = sizes(after - before, bounds);
        Self { linear, angular, turning: turning(before, after, bounds) }
    }

    /// g(y): twice the way of half a blend, as a duration at full speed (s).
    fn need(&self, y: f64) -> f64 {
        y * self.linear.max(self.angular * widened(self.turning * y))
    }

    /// The largest y with g(y) + r y <= `room` (s); infinite or NaN if any is.
    fn largest(&self, room: f64, ramp: f64) -> f64 {
        let Self { linear, angular, turning } = *self;
        let by_linear = room / (linear + ramp);
        // The smaller root of turning r y^2 - sum y + room = 0, without squares of large numbers.
        let sum = angular + ramp + room * turning;
        let double = 2.0 * (turning * ramp).sqrt() * room.sqrt();
        let root = (sum - double).max(0.0).sqrt() * (sum + double).sqrt();
        let y = 2.0 * room / (sum + root);
        let is_widest = turning * y > 1.0 - 1.0 / WIDEST;
        let by_angular = if is_widest { room / (WIDEST * angular + ramp) } else { y };
        by_linear.min(by_angular)
    }
}

/// Largest factor by which a blend takes longer since its axis turns [-].
const WIDEST: f64 = 4.0;

/// The factor by which a blend takes longer if the turning axis takes a share of the acceleration.
fn widened(turning: f64) -> f64 {
    1.0 / (1.0 - turning).max(1.0 / WIDEST)
}

/// The share of the angular acceleration that turns the axis of the first rotation along: at most 3/4
/// |w0 x w1|.
fn turning(before: Twist, after: Twist, bounds: CartesianBounds) -> f64 {
    0.75 * before.angular.cross(after.angular).norm() / bounds.angular.acceleration
}

/// |twist| / a of both parts (s).
pub(super) fn sizes(twist: Twist, bounds: CartesianBounds) -> (f64, f64) {
    let over = |part: Vec3, a: f64| part.norm() / a;
    let Twist { linear, angular } = twist;
    (over(linear, bounds.linear.acceleration), over(angular, bounds.angular.acceleration))
}

/// The duration of the blend between two twists in which no acceleration is exceeded (s).
pub(super) fn blend(before: Twist, after: Twist, bounds: CartesianBounds) -> f64 {
    let (linear, angular) = sizes(after - before, bounds);
    linear.max(angular * widened(turning(before, after, bounds)))
}

/// The durations of the blends between segments with these speeds; those from and to rest are none,
/// since segments begin and end with them (s).
pub(super) fn blends(segments: &[Segment], speeds: &[Speeds], bounds: CartesianBounds) -> Vec<f64> {
    let mut all = vec![0.0; segments.len() + 1];
    for i in 1..segments.len() {
        let before = segments[i - 1].full * speeds[i - 1].end;
        all[i] = blend(before, segments[i].full * speeds[i].start, bounds);
    }
    all
}

/// The speeds of the quicker of both ways on each stretch between segments at full speed.
pub(super) fn quickest(segments: &[Segment], bounds: CartesianBounds) -> Vec<Speeds> {
    let (mut best, other) = (passes(segments, bounds), one_speed(segments, bounds));
    let both = [&best, &other].map(|speeds| (speeds, blends(segments, speeds, bounds)));
    let parts = |(speeds, blends): &(&Vec<Speeds>, Vec<f64>), i: usize| {
        let Speeds { start, top, end } = speeds[i];
        let of = |share, blend| segments[i].part(share, top, blend);
        ([of(start, blends[i]), of(end, blends[i + 1])], top)
    };
    // Full speed in both, and both fit into either half.
    let is_boundary = |i: usize| {
        both.iter().map(|way| parts(way, i)).all(|(parts, top)| {
            let half = 0.5 * segments[i].time;
            top >= segments[i].limit && parts.iter().all(|part| part.way <= half)
        })
    };
    let (mut times, mut from, mut replaced) = ([0.0; 2], 0, Vec::new());
    for i in 0..=segments.len() {
        let is_end = i == segments.len();
        let is_boundary = !is_end && is_boundary(i);
        let mut next = [0.0; 2];
        for ((time, next), way) in times.iter_mut().zip(&mut next).zip(&both) {
            if is_end {
                continue;
            }
            let ([start, end], top) = parts(way, i);
            *time += start.loss(top);
            if is_boundary {
                *next = end.loss(top);
            } else if segments[i].time > 0.0 {
                *time += end.loss(top) + segments[i].time / top;
            }
        }
        if is_boundary || is_end {
            if times[1] < times[0] * (1.0 - QUICKER) {
                replaced.push(from..i);
            }
            (times, from) = (next, i + 1);
        }
    }
    for stretch in replaced {
        if let Some(before) = stretch.start.checked_sub(1) {
            best[before].end = other[before].end;
        }
        if let (Some(after), Some(other)) = (best.get_mut(stretch.end), other.get(stretch.end)) {
            after.start = other.start;
        }
        best[stretch.clone()].copy_from_slice(&other[stretch]);
    }
    best
}

/// The largest speeds at waypoints, and in between, that are the same before and after a waypoint.
fn passes(segments: &[Segment], bounds: CartesianBounds) -> Vec<Speeds> {
    let count = segments.len();
    let mut corners = vec![Corner::REST];
    let pairs = segments.windows(2);
    corners.extend(pairs.map(|pair| Corner::new(pair[0].full, pair[1].full, bounds)));
    corners.push(Corner::REST);
    let mut y = vec![f64::INFINITY; count + 1];
    for (i, segment) in segments.iter().enumerate() {
        let equal = equal([corners[i], corners[i + 1]], segment);
        y[i] = y[i].min(equal);
        y[i + 1] = y[i + 1].min(equal);
    }
    (y[0], y[count]) = (0.0, 0.0);
    // The largest speed at `to` that is reached from that at `from`.
    let reached = |segment: &Segment, y: &[f64], from: usize, to: usize| {
        let room = 2.0 * segment.time + segment.ramp * y[from] - corners[from].need(y[from]);
        corners[to].largest(room.max(0.0), segment.ramp)
    };
    for (i, segment) in segments.iter().enumerate() {
        y[i + 1] = y[i + 1].min(reached(segment, &y, i, i + 1));
    }
    for (i, segment) in segments.iter().enumerate().rev() {
        y[i] = y[i].min(reached(segment, &y, i + 1, i));
    }
    let speeds = |(i, segment): (usize, &Segment)| {
        let Segment { time, ramp, limit, .. } = *segment;
        let (start, end) = (y[i].sqrt(), y[i + 1].sqrt());
        let room = 2.0 * time - corners[i].need(y[i]) - corners[i + 1].need(y[i + 1]);
        let peak = 0.5 * (room.max(0.0) / ramp + y[i] + y[i + 1]);
        let is_full = peak >= limit * limit;
        let top = if is_full { limit } else { peak.sqrt().max(start).max(end) };
        Speeds { start: start.min(top), top, end: end.min(top) }
    };
    segments.iter().enumerate().map(speeds).collect()
}

/// The largest y that both ends of a segment can have.
fn equal(corners: [Corner; 2], segment: &Segment) -> f64 {
    let fits = |y: f64| corners[0].need(y) + corners[1].need(y) <= 2.0 * segment.time;
    let most = segment.limit * segment.limit;
    if fits(most) {
        return most;
    }
    if corners.iter().all(|corner| corner.turning == 0.0) {
        // Then g is proportional to y.
        return 2.0 * segment.time / (corners[0].need(1.0) + corners[1].need(1.0));
    }
    largest(0.0, most, HALVINGS, fits)
}

/// One speed on each segment, lowered until half of the blends at its ends fit; where they do not
/// within `ROUNDS`, it is zero.
fn one_speed(segments: &[Segment], bounds: CartesianBounds) -> Vec<Speeds> {
    let count = segments.len();
    let fastest: Vec<f64> = segments.iter().map(|s| s.time / s.limit).collect();
    let mut durations = fastest.clone();
    let share = |i: usize, durations: &[f64]| {
        let is_slowed = durations[i] > fastest[i];
        if is_slowed { segments[i].time / durations[i] } else { segments[i].limit }
    };
    let blend = |i: usize, durations: &[f64]| {
        let twist =
            |i: usize| segments.get(i).map_or(Twist::ZERO, |s| s.full * share(i, durations));
        blend(if i > 0 { twist(i - 1) } else { Twist::ZERO }, twist(i), bounds)
    };
    let mut blends: Vec<f64> = (0..=count).map(|i| blend(i, &durations)).collect();
    let mut unsettled: Vec<usize> = (0..count).collect();
    let mut short = Vec::new();
    for _ in 0..ROUNDS {
        short.clear();
        for &i in &unsettled {
            let (needed, duration) = (0.5 * (blends[i] + blends[i + 1]), durations[i]);
            if needed > duration * (1.0 + 1e-12) {
                // Blends shrink while the segment grows: the geometric mean of both.
                durations[i] = (needed * duration).sqrt().max(duration * 1.001);
                short.push(i);
            }
        }
        if short.is_empty() {
            break;
        }
        unsettled.clear();
        for &i in &short {
            // Its blends change, and with them the needs of its neighbours.
            let next = unsettled.last().map_or(0, |last| last + 1);
            unsettled.extend(next.max(i.saturating_sub(1))..(i + 2).min(count));
            for corner in [i, i + 1] {
                blends[corner] = blend(corner, &durations);
            }
        }
    }
    for i in short {
        durations[i] = f64::INFINITY;
    }
    let speeds = |i: usize| {
        let top = share(i, &durations);
        let [start, end] = [i == 0, i + 1 == count].map(|rests| if rests { 0.0 } else { top });
        Speeds { start, top, end }
    };
    (0..count).map(speeds).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::uniform;

    /// The largest blend needs exactly the room that there is.
    #[test]
    fn the_largest_blend_fills_the_room() {
        let mut state = 5_u64;
        let mut random = |most: f64| most * uniform(&mut state);
        let mut widest = 0;
        for _ in 0..2000 {
            let (linear, angular, turning) = (random(2.0), random(2.0), random(3.0));
            let corner = Corner { linear, angular, turning };
            let (room, ramp) = (random(2.0), random(1.0));
            let y = corner.largest(room, ramp);
            let filled = corner.need(y) + ramp * y;
            assert!((filled - room).abs() < 1e-10 * (1.0 + room), "{corner:?} {room} {ramp} {y}");
            widest += usize::from(turning * y > 1.0 - 1.0 / WIDEST);
        }
        assert!(widest > 100, "{widest}");
    }
}
