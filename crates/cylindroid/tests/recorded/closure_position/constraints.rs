//! Constraints at configurations near home, closed and open, one by one and in batches.

use cylindroid::closure::{ClosedChain, LoopClosureError, MotionSpace, Unit};
use cylindroid::manipulability::{BatchOptions, ManipulabilityBatch};

use cylindroid::Mechanism;

use super::{near_home, record_closure_error, record_error, some_chain, weighted};
use crate::record::{Record, check};
use crate::robots::Random;

fn letters(units: &[Unit]) -> String {
    units.iter().map(|u| if *u == Unit::Length { 'm' } else { 'r' }).collect()
}

fn record_chain(record: &mut Record, chain: &ClosedChain) {
    let constraint = &chain.constraint;
    record.word(&(constraint.rows(), constraint.object(), constraint.actuated()));
    let units = &chain.units;
    for units in [&units.rows, &units.actuated, &units.passive, &units.object] {
        record.word(&letters(units));
    }
    record.number(constraint.length());
    record_closure_error(record, chain.closure_error);
    let matrix = constraint.matrix();
    record.number(weighted(matrix.as_slice()));
    for j in 0..matrix.cols().min(4) {
        record.number(weighted(matrix.column(j)));
    }
    let motions = MotionSpace::of(constraint);
    record.word(&(motions.dof(), motions.hyperstatic()));
}

#[test]
fn constraints() {
    check("position_constraints", 90, |random, record| {
        let mechanism = some_chain(random);
        let q = match random.below(3) {
            0 => mechanism.home().to_vec(),
            _ => near_home(random, &mechanism, 0.5),
        };
        let frames = mechanism.frames().len();
        let name = &mechanism.frames()[random.below(frames)].name;
        let reference = mechanism.frame(name).unwrap();
        let length = random.power(-2.0, 2.0);
        let reference = (!random.once_in(3)).then_some(reference);
        let length = (!random.once_in(3)).then_some(length);
        let state = mechanism.state(&q).unwrap();
        match ClosedChain::of(&state, reference, length) {
            Ok(chain) => record_chain(record, &chain),
            Err(error) => record_error(record, &error),
        }
        if let Ok(error) = LoopClosureError::of(&state) {
            record.word(&(error.is_closed(mechanism.reach()), error.is_closed(1e8)));
        }
    });
}

/// Errors near the threshold.
#[test]
fn closed_or_not() {
    check("position_closed_or_not", 40, |random, record| {
        let error = LoopClosureError {
            distance: random.power(-12.0, -8.0),
            angle: random.power(-12.0, -8.0),
        };
        for length in [1e-2, 1.0, 30.0] {
            record.word(&error.is_closed(length));
        }
    });
}

/// With most joints actuated: all of them, two of three, or half.
fn driven(random: &mut Random<'_>, mechanism: &Mechanism, share: usize) -> Mechanism {
    let joints = mechanism.joints().iter().filter(|j| j.mimic.is_none());
    let names: Vec<&String> = joints
        .filter(|j| !j.coordinates.is_empty() && (share == 1 || !random.once_in(share)))
        .map(|j| &j.name)
        .collect();
    mechanism.with_actuated(&names).unwrap_or_else(|_| mechanism.clone())
}

#[test]
fn batches() {
    check("position_batches", 70, |random, record| {
        let plain = some_chain(random);
        let share = 1 + random.below(3);
        let mechanism = driven(random, &plain, share);
        let reference = mechanism.frames()[random.below(mechanism.frames().len())].name.clone();
        let options = BatchOptions {
            reference: random.once_in(2).then(|| mechanism.frame(&reference).unwrap()),
            length: random.once_in(2).then(|| random.power(-1.0, 1.0)),
            ..BatchOptions::default()
        };
        let batch = match ManipulabilityBatch::new(&mechanism, &options) {
            Ok(batch) => batch,
            Err(error) => return record_error(record, &error),
        };
        let mut q = mechanism.home().to_vec();
        for _ in 0..5 {
            q.extend(near_home(random, &mechanism, 0.3));
        }
        for row in batch.analyse(&q).unwrap().chunks(ManipulabilityBatch::WIDTH) {
            record.word(&row[ManipulabilityBatch::COUNTS].iter().sum::<f64>());
            let finite = |x: &f64| if x.is_finite() { *x } else { 0.0 };
            record.number(weighted(&row.iter().map(finite).collect::<Vec<_>>()));
        }
    });
}

/// Universal joints whose axes are parallel where they close.
#[test]
fn universal_joints_that_fold() {
    check("position_universal_joints", 30, |random, record| {
        let mechanism = super::mechanisms::closed_by_universal_joint(random);
        let batch = ManipulabilityBatch::new(&mechanism, &BatchOptions::default()).unwrap();
        let folded = if random.once_in(2) { 0.0 } else { random.power(-9.0, 0.0) };
        let mut q = mechanism.home().to_vec();
        q[0] += std::f64::consts::FRAC_PI_2 - folded;
        let state = mechanism.state(&q).unwrap();
        record_chain(record, &ClosedChain::of(&state, None, None).unwrap());
        let finite = |x: &f64| if x.is_finite() { *x } else { 0.0 };
        let found = batch.analyse(&q).unwrap();
        record.number(weighted(&found.iter().map(finite).collect::<Vec<_>>()));
    });
}
