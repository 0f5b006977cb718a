//! Samples and places of self-motions: folds, dips, segments, swings and bounds.

use std::f64::consts::TAU;

use super::*;
use crate::scalar::uniform;

/// Values in any order are kept sorted: a fold lies between neighbours.
#[test]
fn folds_lie_between_neighbouring_values() {
    let mut samples = Samples::default();
    for (value, solutions) in [(0.0, 4), (0.3, 4), (-0.2, 4), (0.7, 2), (0.1, 4)] {
        samples.end_group(0, value, (solutions, [0.0; 7]));
    }
    assert_eq!(samples.fold_between(0, 1e-3), Some((3, 0.5)));
    assert_eq!(samples.fold_between(0, 0.5), None);
    assert_eq!(samples.fold_between(4, 1e-3), None);
    samples.end_group(0, 0.5, (4, [0.0; 7]));
    assert_eq!(samples.fold_between(0, 1e-3).map(|(place, _)| place), Some(4));
}

/// The lines through the outer pairs of four misses meet in the middle, below 1 or not.
#[test]
fn misses_that_may_vanish_between_values_are_looked_at() {
    let of = |misses: [f64; 4], values: [f64; 4]| {
        let mut samples = Samples::default();
        for (miss, value) in misses.into_iter().zip(values) {
            samples.end_group(0, value, (2, [0.0, miss, 0.0, 0.0, 0.0, 0.0, 0.0]));
        }
        samples.fold_between(0, 1e-3)
    };
    let even = [0.0, 1.0, 2.0, 3.0];
    // They meet at 0.9 and 1.1, half a step away.
    assert_eq!(of([2.1, 1.3, 1.3, 2.1], even), Some((1, 1.5)));
    assert_eq!(of([-2.1, -1.3, -1.3, -2.1], even), Some((1, 1.5)));
    assert_eq!(of([1.7, 1.3, 1.3, 1.7], even), None);
    // Wider apart and closer together it is the other way round.
    assert_eq!(of([2.1, 1.3, 1.3, 2.1], [0.0, 1.0, 1.5, 2.5]), None);
    assert_eq!(of([1.7, 1.3, 1.3, 1.7], [0.0, 1.0, 3.0, 4.0]), Some((1, 2.0)));
    // Of different slopes: they meet at 0.94 and 1.03.
    assert_eq!(of([2.5, 1.5, 1.2, 1.8], even), Some((1, 1.5)));
    assert_eq!(of([2.3, 1.5, 1.2, 1.6], even), None);
    // A slope of 1 from values a tenth apart: 0.97, and 1.2 where they are not.
    assert_eq!(of([1.8, 1.3, 1.3, 1.4], [0.0, 1.0, 2.0, 2.1]), Some((1, 1.5)));
    assert_eq!(of([1.4, 1.3, 1.3, 1.8], [0.9, 1.0, 2.0, 3.0]), Some((1, 1.5)));
    assert_eq!(of([1.8, 1.3, 1.3, 1.4], even), None);
    // A condition that grows towards the middle, and one that is met.
    assert_eq!(of([2.1, 1.3, 1.3, 1.2], even), None);
    assert_eq!(of([2.1, 1.3, 0.0, 2.1], even), None);
}

const PREFERRED: [f64; 7] = [0.3, -0.2, 0.5, 0.1, -0.7, 0.4, 0.2];

fn parts([value, angles @ ..]: [f64; 7]) -> (f64, [f64; 6]) {
    (value, angles)
}

fn sample(place: [f64; 7]) -> Sample {
    let (value, angles) = parts(place);
    let (at, to) = parts(PREFERRED);
    let new = Sample { value, angles, wrapped: angles, branch: 0, far: 0.0, excluded: 0.0 };
    Sample { far: new.squared_distance_from((at, &to)), ..new }
}

fn place(sample: &Sample) -> [f64; 7] {
    let [a, b, c, d, e, f] = sample.angles;
    [sample.value, a, b, c, d, e, f]
}

fn along(a: [f64; 7], b: [f64; 7], t: f64) -> [f64; 7] {
    std::array::from_fn(|i| a[i] + t * (b[i] - a[i]))
}

fn product(a: [f64; 7], b: [f64; 7], c: [f64; 7], d: [f64; 7]) -> f64 {
    (0..7).map(|i| (a[i] - b[i]) * (c[i] - d[i])).sum()
}

/// The foot of the perpendicular, if it lies between the ends.
#[test]
fn the_closest_point_of_a_segment_is_the_foot_of_the_perpendicular() {
    let (value, angles) = parts(PREFERRED);
    let mut state = 7;
    let mut some = || -> [f64; 7] { std::array::from_fn(|_| 2.0 * uniform(&mut state) - 1.0) };
    let (mut inside, mut outside) = (0, 0);
    for _ in 0..500 {
        let (a, b) = (some(), some());
        let share = product(PREFERRED, a, b, a) / product(b, a, b, a);
        let found = segment(&sample(a), &sample(b), (value, &angles), f64::INFINITY);
        let Some(found) = found else {
            assert!(share <= 0.0 || share >= 1.0, "{share}");
            outside += 1;
            continue;
        };
        inside += 1;
        let foot = place(&found.sample);
        assert!(product(PREFERRED, foot, b, a).abs() < 1e-12, "{share}");
        assert!(product(along(a, b, share), foot, along(a, b, share), foot) < 1e-24);
        let far = product(PREFERRED, foot, PREFERRED, foot);
        assert!((found.sample.far - far).abs() < 1e-12 && found.sample.excluded > 0.0);
        assert_eq!(found.bound, found.sample.far.sqrt() - SEGMENT_MARGIN);
        // It counts where it may lead closer than what is known.
        let closer = |closest: f64| segment(&sample(a), &sample(b), (value, &angles), closest);
        assert!(closer(found.bound).is_none() && closer(found.bound + 1e-9).is_some());
    }
    assert!(inside > 100 && outside > 20, "{inside} {outside}");
}

/// A swing is looked at in sixteen parts; where the limits clamp it by too much it is left out, and
/// a turn that is shorter the other way round is taken that way.
#[test]
fn the_closest_point_of_a_swing_is_one_of_its_parts() {
    let (value, angles) = parts(PREFERRED);
    let free = |angles: [f64; 6]| (angles, 0.0);
    let a = [0.1, -1.3, 0.4, 0.0, -0.5, 0.5, 0.0];
    let b = [0.2, 1.1, 0.4, 0.3, -0.5, 0.5, 0.0];
    let parts_of = |k: i32| along(a, b, f64::from(k) / 16.0);
    let far = |x: [f64; 7]| product(PREFERRED, x, PREFERRED, x);
    let all = || (1..16).map(parts_of);
    let least = all().map(far).fold(f64::INFINITY, f64::min);
    let found = swing(&sample(a), &sample(b), (value, &angles), &free, 9.0).unwrap();
    assert!((found.sample.far - least).abs() < 1e-12, "{found:?}");
    let is_it = |x: [f64; 7]| product(x, place(&found.sample), x, place(&found.sample)) < 1e-24;
    assert_eq!(all().filter(|x| is_it(*x)).count(), 1);
    assert_eq!(found.bound, found.sample.far.sqrt() - MARGIN);
    let closer = |closest: f64| swing(&sample(a), &sample(b), (value, &angles), &free, closest);
    assert!(closer(found.bound).is_none() && closer(found.bound + 1e-9).is_some());
    // The same end after a whole turn.
    let mut turned = sample(b);
    turned.wrapped[0] += TAU;
    turned.wrapped[2] -= 2.0 * TAU;
    let same = swing(&sample(a), &turned, (value, &angles), &free, 9.0).unwrap();
    assert!((same.sample.far - least).abs() < 1e-12, "{same:?}");
    // Samples that are near one another have no swing between them, nor has one that lies
    // outside of the limits.
    let near = along(a, b, 0.24);
    assert!(swing(&sample(a), &sample(near), (value, &angles), &free, 9.0).is_none());
    assert!(swing(&sample(a), &sample(along(a, b, 0.26)), (value, &angles), &free, 9.0).is_some());
    let clamped = |share: f64| move |angles: [f64; 6]| (angles, share * NEARLY_WITHIN);
    let outside = swing(&sample(a), &sample(b), (value, &angles), &clamped(1.01), 9.0);
    assert!(outside.is_none());
    assert!(swing(&sample(a), &sample(b), (value, &angles), &clamped(0.99), 9.0).is_some());
}

/// On a straight branch nothing is closer than the bound, which is the distance of the chord that
/// is as far as it can be less what the branch may leave it by.
#[test]
fn bounds_are_below_the_distances_on_a_branch() {
    let foot = [0.3, -0.2, 0.5, 0.1, -0.7, 0.4, 1.2];
    let at = |t: f64| {
        let mut x = foot;
        (x[0], x[1]) = (x[0] + 0.6 * t, x[1] + 0.8 * t);
        sample(x)
    };
    // Two tenths apart, at a distance of 1.
    let (before, here, after) = (at(-0.2), at(0.0), at(0.2));
    let straight = lower_bound(&here, [Some(&before), Some(&after)]).unwrap();
    assert!((straight - (0.99_f64.sqrt() - 0.02)).abs() < 1e-12, "{straight}");
    // The longer of both sides counts.
    let uneven = lower_bound(&here, [Some(&at(-0.1)), Some(&at(0.4))]).unwrap();
    assert!((uneven - (0.96_f64.sqrt() - 0.04)).abs() < 1e-12, "{uneven}");
    // At an end, and where it bends: the whole way and the margin may be lost.
    let end = lower_bound(&here, [Some(&before), None]).unwrap();
    assert!((end - (1.0 - SAME_BRANCH - MARGIN)).abs() < 1e-12, "{end}");
    let mut aside = foot;
    aside[2] += 0.2;
    let bent = lower_bound(&here, [Some(&before), Some(&sample(aside))]).unwrap();
    assert!((bent - (1.0 - 0.2 - MARGIN)).abs() < 1e-12, "{bent}");
    // A neighbour is closer.
    assert!(lower_bound(&after, [Some(&here), Some(&at(0.4))]).is_none());
    assert!(lower_bound(&before, [Some(&at(-0.4)), Some(&here)]).is_none());
    // Of samples outside of the limits the one that is clamped least counts, however far.
    let clamped = |t: f64, excluded: f64| Sample { excluded, ..at(t) };
    let sides = |x: f64| [clamped(-0.2, 0.2), clamped(0.2, x)];
    let of = |x: f64| {
        let [a, b] = sides(x);
        lower_bound(&clamped(0.0, 0.1), [Some(&a), Some(&b)])
    };
    assert!(of(0.05).is_none());
    assert!((of(0.15).unwrap() - (1.0 - 0.2 - MARGIN)).abs() < 1e-12);
    // Nor is a branch known to be straight where one of the three is clamped.
    let doubtful = lower_bound(&here, [Some(&clamped(-0.2, 0.2)), Some(&after)]).unwrap();
    assert!((doubtful - (1.0 - 0.2 - MARGIN)).abs() < 1e-12, "{doubtful}");
    // A closer neighbour outside of the limits does not count.
    let kept = lower_bound(&after, [Some(&clamped(0.0, 0.1)), Some(&at(0.4))]);
    assert!(kept.is_some());
}

/// The largest change of the value or of an angle, whatever its sign; at a limit, a little displaced
/// samples are a place to begin.
#[test]
fn samples_differ_by_their_largest_coordinate() {
    let at = |first: f64, third: f64| sample([first, 0.5, 0.2, third, 0.5, 0.5, 0.5]);
    let cases = [(0.3, 0.1, 0.3), (-0.3, 0.1, 0.3), (0.1, 0.4, 0.4), (0.1, -0.4, 0.4)];
    for (first, third, expected) in cases {
        let difference = at(first, third - 0.7).difference(&at(0.0, -0.7));
        assert!((difference - expected).abs() < 1e-15, "{difference}");
    }
    for (share, expected) in [(0.0, true), (0.9, true), (1.1, false)] {
        let excluded = share * NEARLY_WITHIN;
        assert_eq!(Sample { excluded, ..at(0.0, 0.0) }.may_begin(), expected);
    }
}

#[test]
fn values_are_sampled_from_the_middle_outwards() {
    assert_eq!([0, 1, 2, 3, 4, 5, 6].map(index_of), [0, 1, -1, 2, -2, 3, -3]);
}

/// One condition that is missed on both sides is enough; one that is met on one side is none.
#[test]
fn conditions_that_change_sides_fold() {
    let folds = |left: [f64; 7], right: [f64; 7]| {
        let mut samples = Samples::default();
        samples.end_group(0, 0.0, (2, left));
        samples.end_group(0, 1.0, (2, right));
        samples.fold_between(0, 1e-3).is_some()
    };
    let of = |a: f64, b: f64| [0.0, a, 0.0, 0.0, b, 0.0, 0.0];
    assert!(folds(of(1.2, -1.1), of(1.3, 1.1)) && folds(of(-1.2, 0.0), of(1.3, 0.0)));
    assert!(!folds(of(1.2, -1.1), of(1.3, -1.2)) && !folds(of(-1.2, 0.0), of(0.0, 1.2)));
    // Misses that grow slowly on one side and quickly on the other do not vanish between.
    let mut samples = Samples::default();
    for (value, miss) in [(0.0, 0.96), (1.0, 1.01), (2.0, 3.0), (3.0, 3.1)] {
        samples.end_group(0, value, (2, of(miss, 0.0)));
    }
    assert_eq!(samples.fold_between(0, 1e-3), None);
}

/// Values and branches of the places, the closest first, of samples at 0.06, 0.16, ... : branch, from
/// and to which of them, and its angles less those that are preferred.
fn places_of(branches: &[(u8, Range<usize>, [f64; 6])]) -> Vec<(f64, u8)> {
    let (value, angles) = parts(PREFERRED);
    let mut samples = Samples::default();
    for (g, at) in [0.06, 0.16, 0.26, 0.36, 0.46].into_iter().enumerate() {
        let first = samples.all.len();
        for (branch, _, away) in branches.iter().filter(|(_, own, _)| own.contains(&g)) {
            let mut place = PREFERRED;
            place[0] = at;
            place[1..].iter_mut().zip(away).for_each(|(x, away)| *x += away);
            samples.all.push(Sample { branch: *branch, ..sample(place) });
        }
        samples.end_group(first, at, (samples.all.len() - first, [0.0; 7]));
    }
    let free = |angles: [f64; 6]| (angles, 0.0);
    let places = samples.places((value, &angles), &free, 10.0);
    assert!(places.is_sorted_by(|a, b| a.sample.far <= b.sample.far));
    places.iter().map(|p| ((p.sample.value * 1e6).round() / 1e6, p.sample.branch)).collect()
}

#[test]
fn places_are_the_closest_samples_and_points_beyond_the_ends_of_branches() {
    let one = [0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let other = [0.0, 0.0, 0.0, 0.0, 1.5, 0.0];
    // Through all values: the sample next to 0.3, and between both ends on the left.
    let (a, b) = ((0, 0..5, one), (1, 0..5, other));
    assert_eq!(places_of(std::slice::from_ref(&a)), [(0.26, 0)]);
    assert_eq!(places_of(&[a, b]), [(0.46, 0), (0.06, 0), (0.26, 0), (0.26, 1)]);
    // A branch that ends before 0.36 is followed for a step: to 0.3, where it is closest.
    let short = (0, 1..3, one);
    assert_eq!(places_of(std::slice::from_ref(&short)), [(0.3, 0), (0.26, 0)]);
    assert_eq!(places_of(&[(0, 0..2, one)]), [(0.16, 0)]);
    // Not where another one begins there, and no point between both is closer than they are.
    let next = (2, 3..5, [0.0, 0.0, 0.0, 0.0, 0.0, 1.2]);
    assert_eq!(places_of(&[short, next]), [(0.26, 0), (0.36, 2)]);
    // The other one ends elsewhere.
    let found = places_of(&[(0, 1..3, one), (1, 0..5, other)]);
    assert_eq!(found, [(0.3, 0), (0.26, 0), (0.26, 1)]);
}

/// Where a branch jumps from one value to the next it may swing: the closest point of the swing is a
/// place, besides that between its two ends and the ends themselves.
#[test]
fn places_lie_on_swings() {
    let at = |angle: f64| [angle, 0.0, 0.0, 0.0, 0.0, 0.5];
    let found = places_of(&[(0, 2..3, at(-1.0)), (0, 3..4, at(1.0))]);
    assert_eq!(found.len(), 4, "{found:?}");
    assert_eq!(found[1], (0.31, 0));
    let apart = places_of(&[(0, 2..3, at(-1.0)), (1, 3..4, at(1.0))]);
    assert_eq!(apart.len(), 3, "{apart:?}");
}
