//! Samples of the self-motion of an arm with one redundant joint, and the places from which its
//! branches may come closer to the preferred configuration.
//!
//! Formula  of the segment between two ends of branches A and B the point closest to the preferred
//!          configuration p: A + t (B - A), t = (p - A) (B - A) / |B - A|^2
//! Shapes   a solution: the value of the locked joint and the six angles of the closed form
//! Units    rad
//! Valid    branches shorter than a sampling step may be missed if both of their ends are folds
//! Why so   near a singularity two joints swing by a large angle while the locked joint hardly moves:
//!          no sample of it lies on the swing, which is nearly straight, and often comes closest
//! Checked  src/ik/nearest.rs (against 1000 random restarts)

use std::ops::Range;

/// Sampling step of the locked joint [rad].
pub(super) const STEP: f64 = 0.1;
/// Solutions of neighbouring samples whose coordinates differ by less are on one branch [rad].
const SAME_BRANCH: f64 = 0.6;
/// Subtracted from lower bounds: a branch may bend between its samples [rad].
const MARGIN: f64 = 0.3;
/// The same for segments between ends of branches [rad].
const SEGMENT_MARGIN: f64 = 0.1;

/// A candidate for one value of the locked joint, a solution up to rounding if it is within the limits.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    pub(super) value: f64,
    pub(super) angles: [f64; 6],
    /// Squared distance from the preferred configuration.
    pub(super) far: f64,
    /// Displacement that clamped it to the limits: it is then no solution, but may be near one.
    pub(super) excluded: f64,
}

impl Sample {
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
    own: Range<usize>,
}

/// The value that is sampled as number k, in steps: 0, 1, -1, 2, -2, ...
pub(super) const fn index_of(k: i32) -> i32 {
    if k % 2 == 0 { -(k / 2) } else { (k + 1) / 2 }
}

impl Samples {
    /// Groups the samples from `first` on, of a value with this number of solutions inside and outside
    /// the limits.
    pub(super) fn end_group(&mut self, first: usize, value: f64, solutions: usize) {
        let own = first..self.all.len();
        let place = self.groups.partition_point(|group| group.value < value);
        self.groups.insert(place, Group { value, solutions, own });
    }

    /// The middle between two neighbouring values with different numbers of solutions, of the gaps
    /// from `place` on, if they are further apart than `least`; and the place of the gap.
    pub(super) fn fold_between(&self, place: usize, least: f64) -> Option<(usize, f64)> {
        let gaps = self.groups.windows(2).enumerate().skip(place);
        gaps.filter(|(_, gap)| gap[0].solutions != gap[1].solutions)
            .find(|(_, gap)| gap[1].value - gap[0].value > least)
            .map(|(i, gap)| (i, 0.5 * (gap[0].value + gap[1].value)))
    }

    /// The sample on the same branch among those of another value.
    fn on_branch(&self, sample: &Sample, group: Option<&Group>) -> Option<&Sample> {
        let near = self.all[group?.own.clone()].iter().map(|s| (s.difference(sample), s));
        let near = near.min_by(|a, b| a.0.total_cmp(&b.0));
        near.filter(|(apart, _)| *apart < SAME_BRANCH).map(|(_, other)| other)
    }

    /// Samples that are closer than their neighbours on the same branch, and points between ends of
    /// branches, the closest first.
    pub(super) fn places(&self, preferred: (f64, &[f64; 6]), closest: f64) -> Vec<Place> {
        let mut places = Vec::new();
        let mut ends: Vec<(usize, Sample, Option<Sample>)> = Vec::new();
        let of_groups = self.groups.iter().enumerate();
        for (g, sample) in
            of_groups.flat_map(|(g, group)| self.all[group.own.clone()].iter().map(move |s| (g, s)))
        {
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

/// A lower bound of the distances on the branch between the neighbours of a sample; `None` if a
/// neighbour is closer.
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
    Some(sample.far.sqrt() - longest - MARGIN)
}
