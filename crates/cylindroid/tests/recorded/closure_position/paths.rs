//! Paths of prescribed coordinates: their steps, distances and ends.

use cylindroid::closure::{
    ContinuationOptions, ContinuationResult, PathEnd, PathSingularity, track_path,
};
use cylindroid::model::CoordinateKind;
use cylindroid::{Mechanism, catalogue};

use super::{
    near_home, record_closure_error, record_error, some_chain, some_of, weighted,
    weighted_up_to_sign, whole_joints,
};
use crate::record::{Record, check};
use crate::robots::Random;

fn record_singularity(record: &mut Record, found: &PathSingularity) {
    record.word(&found.kind);
    record.number(found.distance);
    let twist = found.twist.to_array();
    record.number(weighted_up_to_sign(&found.joint_velocities));
    record.number(weighted_up_to_sign(&twist));
    // The sign of one relative to the other.
    record.number(weighted(&found.joint_velocities) * weighted(&twist));
    match found.screw {
        None => record.word(&"at rest"),
        Some(screw) => {
            record.numbers(&[screw.pitch, screw.amplitude]);
            record.number(weighted_up_to_sign(&screw.axis.direction.to_array()));
            record.number(weighted(&screw.axis.point.to_array()));
        }
    }
}

fn record_path(record: &mut Record, found: &ContinuationResult) {
    record.word(&found.end.to_string());
    record.number(found.fraction);
    record.number(weighted(&found.q));
    if found.end == PathEnd::Open {
        return record_closure_error(record, found.closure_error);
    }
    match &found.end {
        PathEnd::Singular(singularity) => record_singularity(record, singularity),
        PathEnd::Limit { coordinate } => record.word(coordinate),
        _ => {}
    }
    // Halved steps before the end are decided by rounding.
    record.numbers(&found.path.iter().take(4).map(|p| p.fraction).collect::<Vec<_>>());
    let of_path =
        |of: &dyn Fn(usize) -> f64| -> Vec<f64> { (0..found.path.len()).map(of).collect() };
    record.number(weighted(&of_path(&|i| found.path[i].fraction)));
    let distance = |i: usize| found.path[i].distance.min(2.0);
    record.number(weighted(&of_path(&distance)));
    record.number(weighted(&of_path(&|i| weighted(&found.path[i].q))));
    record.word(&found.path.len());
}

fn options(random: &mut Random<'_>) -> ContinuationOptions {
    match random.below(3) {
        0 => ContinuationOptions::default(),
        _ => ContinuationOptions {
            step: random.power(-1.7, 0.5),
            least_distance: random.power(-5.1, -0.5),
        },
    }
}

/// Far goals for some coordinates, rotation vectors included.
fn goal(random: &mut Random<'_>, mechanism: &Mechanism, start: &[f64], at: &[usize]) -> Vec<f64> {
    let far = random.power(-1.0, 0.5);
    let mut goal_of = |&i: &usize| {
        let unit = match mechanism.coordinates().get(i).map(|c| c.kind) {
            Some(CoordinateKind::Length | CoordinateKind::Position) => mechanism.reach(),
            _ => 1.0,
        };
        start.get(i).copied().unwrap_or(0.0) + unit * random.within(-far, far)
    };
    at.iter().map(&mut goal_of).collect()
}

fn path_of(random: &mut Random<'_>, record: &mut Record, mechanism: &Mechanism) {
    let start = if random.once_in(3) {
        near_home(random, mechanism, -0.5)
    } else {
        mechanism.home().to_vec()
    };
    let mut prescribed = match random.below(4) {
        0 => mechanism.actuated().take(2).collect(),
        1 => vec![random.below(mechanism.n())],
        2 => some_of(random, mechanism.n(), 6),
        _ => vec![0, random.below(mechanism.n())],
    };
    prescribed = whole_joints(random, mechanism, prescribed);
    if random.once_in(40) && !prescribed.is_empty() {
        prescribed.push(prescribed[0]);
    }
    let goal = goal(random, mechanism, &start, &prescribed);
    match track_path(mechanism, &start, &prescribed, &goal, options(random)) {
        Ok(found) => record_path(record, &found),
        Err(error) => record_error(record, &error),
    }
}

#[test]
fn paths_of_random_chains() {
    check("position_paths_random", 120, |random, record| {
        let mechanism = super::mechanisms::closed_chain(random);
        path_of(random, record, &mechanism);
    });
}

#[test]
fn paths_of_the_catalogue() {
    check("position_paths_catalogue", 60, |random, record| {
        let mechanism = crate::robots::of_catalogue(random, true);
        path_of(random, record, &mechanism);
    });
}

/// Planar linkages whose drives meet dead points and limits.
#[test]
fn paths_of_five_bars() {
    check("position_paths_five_bars", 60, |random, record| {
        let mechanism = crate::robots::five_bar(random);
        let prescribed: Vec<usize> = match random.below(3) {
            0 => vec![0],
            1 => vec![0, 1],
            _ => mechanism.actuated().collect(),
        };
        let start = mechanism.home().to_vec();
        let goal = goal(random, &mechanism, &start, &prescribed);
        match track_path(&mechanism, &start, &prescribed, &goal, options(random)) {
            Ok(found) => record_path(record, &found),
            Err(error) => record_error(record, &error),
        }
    });
}

/// Platforms led along the screw to their goal, from singular places as well.
#[test]
fn paths_of_spatial_loops() {
    check("position_paths_spatial", 40, |random, record| {
        let mechanism = if random.once_in(4) {
            catalogue::load("stewart").unwrap()
        } else {
            crate::robots::spatial_loop(random)
        };
        path_of(random, record, &mechanism);
    });
}

#[test]
fn paths_to_where_they_are() {
    check("position_paths_short", 30, |random, record| {
        let mechanism = some_chain(random);
        let start = mechanism.home().to_vec();
        let some = some_of(random, mechanism.n(), 3);
        let prescribed = whole_joints(random, &mechanism, some);
        let goal: Vec<f64> =
            prescribed.iter().map(|&i| start.get(i).copied().unwrap_or(0.0)).collect();
        match track_path(&mechanism, &start, &prescribed, &goal, options(random)) {
            Ok(found) => record_path(record, &found),
            Err(error) => record_error(record, &error),
        }
    });
}
