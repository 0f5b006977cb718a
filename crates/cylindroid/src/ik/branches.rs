//! Samples of the self-motion of an arm with one redundant joint, and the places from which its
//! branches may come closer to the preferred configuration.
//!
//! Formula  of the segment between two ends of branches A and B the point closest to the preferred
//!          configuration p: A + t (B - A), t = (p - A) (B - A) / |B - A|^2;
//!          a condition a cos x + b sin x = c of the closed form has no solution where
//!          c / sqrt(a^2 + b^2) is beyond -1 or 1, and some between values where it is beyond
//!          different ones
//! Shapes   a solution: the value of the locked joint and the six angles of the closed form
//! Units    rad
//! Valid    a branch that begins and ends between two samples where its condition is missed on the
//!          same side is found if straight lines through two misses on either side foretell it
//! Why so   near a singularity two joints swing by a large angle while the locked joint hardly moves:
//!          no sample of it lies on the swing, which is nearly straight, and often comes closest.
//!          Joints may leave their limits on it, and come back a full turn away: points of it are
//!          wrapped one by one. It turns them by less than half a turn, as the direction of a point
//!          that passes by an axis
//! Checked  src/ik/nearest.rs (against 1000 random restarts)

use std::ops::Range;

use crate::scalar::nearest_turn;

/// Sampling step of the locked joint [rad].
pub(super) const STEP: f64 = 0.1;
/// Solutions of neighbouring samples with the same signs of roots whose coordinates differ by less
/// are on one branch [rad].
const SAME_BRANCH: f64 = 0.6;
/// Solutions outside the limits by less are clamped to them and corrected [rad].
const NEARLY_WITHIN: f64 = 0.3;
/// Subtracted from lower bounds: a branch may bend between its samples [rad].
const MARGIN: f64 = 0.3;
/// The same for segments between ends of branches [rad].
const SEGMENT_MARGIN: f64 = 0.1;
/// A branch is nearly straight about a sample where the chord over it is longer than this share of
/// those on both sides [-]: it turns by less than 36 degrees there.
const STRAIGHT: f64 = 0.95;
/// It leaves a chord by less than this share of its length [-].
const SAGITTA: f64 = 0.1;
/// Into so many parts a swing is divided.
const SWING_POINTS: i32 = 16;

/// A candidate for one value of the locked joint, a solution up to rounding if it is within the limits.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    pub(super) value: f64,
    pub(super) angles: [f64; 6],
    /// The angles before they were clamped to the limits.
    pub(super) wrapped: [f64; 6],
    /// The signs of roots by joint, the same along a branch.
    pub(super) branch: u8,
    /// Squared distance from the preferred configuration.
    pub(super) far: f64,
    /// Displacement that clamped it to the limits: it is then no solution, but may be near one.
    pub(super) excluded: f64,
}

impl Sample {
    /// True if it is within the limits, or nearly: a place from which a descent may begin.
    fn may_begin(&self) -> bool {
        self.excluded < NEARLY_WITHIN
    }

    /// Largest difference of a coordinate.
    fn difference(&self, other: &Self) -> f64 {
        let apart = |m: f64, (a, b): (&f64, &f64)| m.max((a - b).abs());
        self.angles.iter().zip(&other.angles).fold((self.value - other.value).abs(), apart)
    }

    fn distance(&self, other: &Self) -> f64 {
        let squares = self.angles.iter().zip(&other.angles).map(|(a, b)| (a - b).powi(2));
        (squares.sum::<f64>() + (self.value - other.value).powi(2)).sqrt()
    }

    /// The point at the share `t` of the way to another one, no solution.
    fn towards(&self, other: &Self, t: f64) -> Self {
        let mix = |a: f64, b: f64| a + t * (b - a);
        Self {
            value: mix(self.value, other.value),
            angles: std::array::from_fn(|i| mix(self.angles[i], other.angles[i])),
            excluded: f64::MIN_POSITIVE,
            ..*self
        }
    }

    fn squared_distance_from(&self, (value, angles): (f64, &[f64; 6])) -> f64 {
        let squares = self.angles.iter().zip(angles).map(|(a, b)| (a - b).powi(2));
        squares.sum::<f64>() + (self.value - value).powi(2)
    }
}

/// A place from which a descent may lead to the closest solution.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    /// Lower bound of the distances that it can lead to.
    pub(super) bound: f64,
    pub(super) sample: Sample,
}

/// The samples, grouped by values of the locked joint.
#[derive(Debug, Default)]
pub(super) struct Samples {
    pub(super) all: Vec<Sample>,
    groups: Vec<Group>,
}

/// The samples of one value.
#[derive(Debug, Clone)]
struct Group {
    value: f64,
    /// Solutions of the closed form, also those outside the limits.
    solutions: usize,
    /// By how much conditions of the closed form miss a solution, beyond -1 or 1; 0 of the others.
    misses: [f64; 7],
    own: Range<usize>,
}

impl Group {
    /// True if a branch begins or ends between two neighbouring values: they have different numbers
    /// of solutions, or conditions miss them on opposite sides.
    fn folds_before(&self, next: &Self) -> bool {
        let cross = |(a, b): (&f64, &f64)| a * b < 0.0;
        self.solutions != next.solutions || self.misses.iter().zip(&next.misses).any(cross)
    }

    /// True if a condition misses its solutions at four neighbouring values, the less the closer to
    /// the middle, such that it may have one there: the lines on both sides meet below 1.
    fn dips(groups: &[Self]) -> bool {
        let [before, left, right, after] = groups else { return false };
        (0..7).any(|i| {
            let misses = [before, left, right, after].map(|group| group.misses[i].abs());
            if misses.contains(&0.0) {
                return false;
            }
            let [far, near, other, beyond] = misses;
            let down = (near - far) / (left.value - before.value);
            let up = (beyond - other) / (after.value - right.value);
            let width = right.value - left.value;
            // Where  near + down x = other - up (width - x).
            let place = (other - up * width - near) / (down - up);
            down < 0.0 && up > 0.0 && near + down * place < 1.0
        })
    }
}

/// The value that is sampled as number k, in steps: 0, 1, -1, 2, -2, ...
pub(super) const fn index_of(k: i32) -> i32 {
    if k % 2 == 0 { -(k / 2) } else { (k + 1) / 2 }
}

impl Samples {
    /// Groups the samples from `first` on, of a value with this number of solutions inside and outside
    /// the limits, and these misses of conditions.
    pub(super) fn end_group(
        &mut self,
        first: usize,
        value: f64,
        (solutions, misses): (usize, [f64; 7]),
    ) {
        let own = first..self.all.len();
        let place = self.groups.partition_point(|group| group.value < value);
        self.groups.insert(place, Group { value, solutions, misses, own });
    }

    /// The middle between two neighbouring values between which a branch begins or ends, of the gaps
    /// from `place` on, if they are further apart than `least`; and the place of the gap.
    pub(super) fn fold_between(&self, place: usize, least: f64) -> Option<(usize, f64)> {
        let groups = &self.groups;
        let is_fold = |i: usize| {
            let around = i.checked_sub(1).and_then(|before| groups.get(before..i + 3));
            groups[i].folds_before(&groups[i + 1]) || around.is_some_and(Group::dips)
        };
        let width = |i: usize| groups[i + 1].value - groups[i].value;
        (place..groups.len().saturating_sub(1))
            .find(|&i| width(i) > least && is_fold(i))
            .map(|i| (i, 0.5 * (groups[i].value + groups[i + 1].value)))
    }

    /// The sample on the same branch among those of another value.
    fn on_branch(&self, sample: &Sample, group: Option<&Group>) -> Option<&Sample> {
        let others = self.all[group?.own.clone()]
            .iter()
            .filter(|s| s.branch == sample.branch && s.may_begin());
        let near = others.map(|s| (s.difference(sample), s));
        let near = near.min_by(|a, b| a.0.total_cmp(&b.0));
        near.filter(|(apart, _)| *apart < SAME_BRANCH).map(|(_, other)| other)
    }

    /// Samples that are closer than their neighbours on the same branch, and points between ends of
    /// branches, the closest first.
    pub(super) fn places(
        &self,
        preferred: (f64, &[f64; 6]),
        within_limits: &impl Fn([f64; 6]) -> ([f64; 6], f64),
        closest: f64,
    ) -> Vec<Place> {
        let mut places = Vec::new();
        let mut ends: Vec<(usize, Sample, Option<Sample>)> = Vec::new();
        let of_groups = self.groups.iter().enumerate();
        for (g, sample) in
            of_groups.flat_map(|(g, group)| self.all[group.own.clone()].iter().map(move |s| (g, s)))
        {
            if !sample.may_begin() {
                continue;
            }
            let around = [g.checked_sub(1).map(|g| &self.groups[g]), self.groups.get(g + 1)];
            let sides = around.map(|group| self.on_branch(sample, group));
            for i in 0..2 {
                if sides[i].is_none() && sample.excluded == 0.0 {
                    // The gap between two values has the number of the larger one.
                    ends.push((g + i, *sample, sides[1 - i].copied()));
                }
            }
            if let Some(bound) = lower_bound(sample, sides).filter(|bound| *bound < closest) {
                places.push(Place { bound, sample: *sample });
            }
        }
        ends.sort_by_key(|end| end.0);
        for gap in ends.chunk_by(|a, b| a.0 == b.0) {
            for (i, (_, a, behind)) in gap.iter().enumerate() {
                let segment = |b: &Sample| segment(a, b, preferred, closest);
                places.extend(gap[i + 1..].iter().filter_map(|(_, b, _)| segment(b)));
                if let (1, Some(behind)) = (gap.len(), behind) {
                    places.extend(segment(&behind.towards(a, 2.0)));
                }
            }
        }
        for gap in self.groups.windows(2) {
            let [before, after] = [&gap[0], &gap[1]].map(|group| &self.all[group.own.clone()]);
            for a in before {
                let others = after.iter().filter(|b| b.branch == a.branch);
                places
                    .extend(others.filter_map(|b| swing(a, b, preferred, within_limits, closest)));
            }
        }
        places.sort_by(|a, b| a.sample.far.total_cmp(&b.sample.far));
        places
    }
}

/// The point of a segment that is closest to the preferred configuration, if it is inside of the
/// segment and closer than `closest`.
fn segment(a: &Sample, b: &Sample, preferred: (f64, &[f64; 6]), closest: f64) -> Option<Place> {
    let (value, angles) = preferred;
    let (mut along, mut squared) = ((value - a.value) * (b.value - a.value), 0.0);
    squared += (b.value - a.value).powi(2);
    for ((from, to), angle) in a.angles.iter().zip(&b.angles).zip(angles) {
        let way = to - from;
        along += (angle - from) * way;
        squared += way * way;
    }
    if !(along > 0.0 && along < squared) {
        return None;
    }
    let point = a.towards(b, along / squared);
    let far = point.squared_distance_from(preferred);
    let bound = far.sqrt() - SEGMENT_MARGIN;
    (bound < closest).then_some(Place { bound, sample: Sample { far, ..point } })
}

/// The point closest to the preferred configuration of a swing, the segment between two neighbouring
/// samples of one branch that are far apart: of points on it that `within_limits` wraps, clamps and
/// tells the displacement of. Each joint may leave its limits and come back a full turn away.
fn swing(
    a: &Sample,
    b: &Sample,
    preferred: (f64, &[f64; 6]),
    within_limits: &impl Fn([f64; 6]) -> ([f64; 6], f64),
    closest: f64,
) -> Option<Place> {
    let ways: [f64; 6] = std::array::from_fn(|i| nearest_turn(b.wrapped[i] - a.wrapped[i], 0.0));
    if ways.iter().all(|way| way.abs() < SAME_BRANCH) {
        return None;
    }
    let points = (1..SWING_POINTS).filter_map(|k| {
        let t = f64::from(k) / f64::from(SWING_POINTS);
        let (angles, excluded) = within_limits(std::array::from_fn(|i| a.wrapped[i] + t * ways[i]));
        let value = a.value + t * (b.value - a.value);
        let point = Sample { value, angles, excluded: f64::MIN_POSITIVE, ..*a };
        let far = point.squared_distance_from(preferred);
        (excluded < NEARLY_WITHIN).then_some(Sample { far, ..point })
    });
    let sample = points.min_by(|p, q| p.far.total_cmp(&q.far))?;
    let bound = sample.far.sqrt() - MARGIN;
    (bound < closest).then_some(Place { bound, sample })
}

/// A lower bound of the distances on the branch between the neighbours of a sample; `None` if a
/// neighbour is closer.
///
/// Where the branch is nearly straight there it leaves its chords by little, and a chord between two
/// points at least d away is nowhere closer than the root of `d^2 - (half of it)^2`.
fn lower_bound(sample: &Sample, sides: [Option<&Sample>; 2]) -> Option<f64> {
    let mut longest = 0.0_f64;
    for side in sides {
        let Some(other) = side else {
            longest = longest.max(SAME_BRANCH);
            continue;
        };
        let closer = match sample.excluded > 0.0 {
            true => other.excluded < sample.excluded,
            false => other.excluded == 0.0 && other.far < sample.far,
        };
        if closer {
            return None;
        }
        longest = longest.max(other.distance(sample));
    }
    if let [Some(a), Some(b)] = sides
        && [a, sample, b].iter().all(|s| s.excluded == 0.0)
        && a.distance(b) > STRAIGHT * (a.distance(sample) + sample.distance(b))
    {
        let squared = sample.far - 0.25 * longest * longest;
        return Some(squared.max(0.0).sqrt() - SAGITTA * longest);
    }
    Some(sample.far.sqrt() - longest - MARGIN)
}

#[cfg(test)]
mod tests;
