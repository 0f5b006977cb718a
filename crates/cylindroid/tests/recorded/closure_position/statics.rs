//! Torques, contact forces, transmitted wrenches and internal forces.

use cylindroid::Matrix;
use cylindroid::closure::{
    ClosedChain, Constraint, ConstraintBlocks, MotionSpace, StaticLoad, Unit, Units,
    contact_forces, joint_torques, row_compliance, transmitted_wrenches,
};
use cylindroid::linalg::Metric;
use cylindroid::manipulability::{Spectrum, internal_force_manipulability};

use super::{near_home, record_error, some_chain, vector, weighted};
use crate::record::{Record, check};
use crate::robots::Random;

fn metric(random: &mut Random<'_>, size: usize) -> Metric {
    if random.once_in(2) {
        let weights: Vec<f64> = (0..size).map(|_| random.power(-1.0, 1.0)).collect();
        return Metric::diagonal("weights", &weights).unwrap();
    }
    let m = Matrix::from_fn(size, size, |_, _| random.within(-1.0, 1.0));
    let square = &m * &m.transpose();
    let unit = |i, j| square[(i, j)] + if i == j { 0.5 } else { 0.0 };
    Metric::new("weights", &Matrix::from_fn(size, size, unit)).unwrap()
}

/// Invariants of a matrix of columns whose signs and basis are arbitrary.
fn weighted_square(columns: &Matrix) -> f64 {
    weighted((columns * &columns.transpose()).as_slice())
}

fn record_spectrum(record: &mut Record, found: &Spectrum) {
    record.word(&(found.finite.len(), found.zeros.cols(), found.infinite.cols()));
    record.number(weighted(&found.values()));
    record.number(weighted_square(&found.semi_axes()));
    record.number(weighted_square(&found.infinite));
}

fn record_statics(random: &mut Random<'_>, record: &mut Record, constraint: &Constraint) {
    let motions = MotionSpace::of(constraint);
    let relation = motions.relation();
    let wrench = vector(random, constraint.object(), 3.0);
    let torque_metric = (!random.once_in(3)).then(|| metric(random, constraint.actuated()));
    let found = joint_torques(&relation, &wrench, torque_metric.as_ref()).unwrap();
    for part in [&found.torques, &found.structural, &found.unbalanced] {
        record.number(weighted(part));
    }
    let compliance = (!random.once_in(3)).then(|| metric(random, constraint.rows()));
    let given = vector(random, constraint.actuated(), 3.0);
    let zero = vec![0.0; wrench.len()];
    for (torques, wrench) in [(&found.torques, &wrench), (&given, &wrench), (&given, &zero)] {
        let load = StaticLoad { torques, wrench };
        let forces = contact_forces(constraint, &motions, load, compliance.as_ref()).unwrap();
        record.number(weighted(&forces.forces));
        record.number(forces.unbalanced);
    }
    let nothing = vec![0.0; given.len()];
    let load = StaticLoad { torques: &nothing, wrench: &zero };
    record.number(contact_forces(constraint, &motions, load, None).unwrap().unbalanced);
    let found =
        internal_force_manipulability(constraint, torque_metric.as_ref(), compliance.as_ref());
    record_spectrum(record, &found.unwrap());
}

/// Of mechanisms.
#[test]
fn statics() {
    check("position_statics", 80, |random, record| {
        let mechanism = some_chain(random);
        let q = if random.once_in(2) {
            mechanism.home().to_vec()
        } else {
            near_home(random, &mechanism, 0.0)
        };
        let state = mechanism.state(&q).unwrap();
        let length = random.once_in(2).then(|| random.power(-1.0, 1.0));
        match ClosedChain::of(&state, None, length) {
            Ok(chain) => record_statics(random, record, &chain.constraint),
            Err(error) => record_error(record, &error),
        }
    });
}

#[test]
fn wrenches_of_joints_and_contacts() {
    check("position_transmitted", 100, |random, record| {
        let mechanism = some_chain(random);
        let state = mechanism.state(&near_home(random, &mechanism, -0.5)).unwrap();
        let Ok(chain) = ClosedChain::of(&state, None, None) else { return };
        let forces = vector(random, chain.constraint.rows(), 5.0);
        for found in transmitted_wrenches(&state, &chain, &forces).unwrap() {
            record.number(weighted(&found.wrench.to_array()));
            record.number(weighted(&found.point.to_array()));
            record.word(&(found.name.len(), found.normal.is_some()));
            record.numbers(&[found.normal.unwrap_or(0.0), found.tangential().unwrap_or(0.0)]);
        }
        let pairs = mechanism.loops().len() + mechanism.contacts().len();
        let soft: Vec<f64> = (0..pairs).map(|_| random.power(-2.0, 0.5)).collect();
        let compliance = row_compliance(&state, &chain, &soft).unwrap();
        record.number(weighted(compliance.lower().as_slice()));
        let motions = MotionSpace::of(&chain.constraint);
        let wrench = vector(random, chain.constraint.object(), 2.0);
        let torques = vector(random, chain.constraint.actuated(), 2.0);
        let load = StaticLoad { torques: &torques, wrench: &wrench };
        let found = contact_forces(&chain.constraint, &motions, load, Some(&compliance)).unwrap();
        record.number(weighted(&found.forces));
        for found in transmitted_wrenches(&state, &chain, &found.forces).unwrap() {
            record.number(weighted(&found.wrench.to_array()));
        }
    });
}

/// Products of small integers, of known rank.
fn matrix(random: &mut Random<'_>, rows: usize, columns: usize) -> Matrix {
    let rank = random.below(rows.min(columns) + 1);
    let mut integers = |r, c| Matrix::from_fn(r, c, |_, _| random.below(5) as f64 - 2.0);
    &integers(rows, rank) * &integers(rank, columns)
}

fn units(random: &mut Random<'_>, count: usize) -> Vec<Unit> {
    (0..count).map(|_| [Unit::Length, Unit::Angle][random.below(2)]).collect()
}

/// Of matrices of known rank, with units and lengths.
#[test]
fn statics_of_matrices() {
    check("position_statics_of_matrices", 70, |random, record| {
        let [rows, actuated, passive, object] =
            [random.below(9), random.below(5), random.below(5), random.below(5)];
        let blocks = ConstraintBlocks {
            actuated: matrix(random, rows, actuated),
            passive: matrix(random, rows, passive),
            grasp: matrix(random, object, rows),
        };
        let units = Units {
            rows: units(random, rows),
            actuated: units(random, actuated),
            passive: units(random, passive),
            object: units(random, object),
        };
        let length = random.power(-2.0, 2.0);
        let plain = Constraint::new(blocks).unwrap();
        let constraint = plain.with_length(&units, length).unwrap();
        record.number(weighted(constraint.matrix().as_slice()));
        record_statics(random, record, &constraint);
        let huge = if random.once_in(2) { 1e308 } else { 1e-308 };
        match constraint.with_length(&units, huge) {
            Ok(found) => record.word(&found.length()),
            Err(error) => record_error(record, &error),
        }
    });
}

/// Badly conditioned, with entries about the accuracy of their kernels.
#[test]
fn statics_at_the_edge_of_rank() {
    check("position_statics_at_the_edge", 60, |random, record| {
        let [rows, actuated, object] = [3 + random.below(3), 1 + random.below(4), 2];
        let mut blocks = ConstraintBlocks {
            actuated: matrix(random, rows, actuated),
            passive: matrix(random, rows, 3),
            grasp: matrix(random, object, rows),
        };
        let (small, noise) = (random.power(-8.0, -3.0), random.power(-10.0, -6.0));
        for i in 0..rows {
            blocks.passive[(i, 2)] *= small;
            blocks.actuated[(i, 0)] += noise * random.within(-1.0, 1.0);
        }
        let constraint = Constraint::new(blocks).unwrap();
        let motions = MotionSpace::of(&constraint);
        record.word(&(motions.dof(), motions.hyperstatic()));
        let found = internal_force_manipulability(&constraint, None, None).unwrap();
        record.word(&(found.finite.len(), found.zeros.cols(), found.infinite.cols()));
        record.number(weighted_square(&found.infinite));
        record.number(found.values().first().copied().unwrap_or(0.0).min(1e12).sqrt());
    });
}

/// Blocks that do not fit together, and entries that are no numbers.
#[test]
fn constraints_that_are_refused() {
    check("position_refused_constraints", 30, |random, record| {
        let rows = 1 + random.below(3);
        let mut blocks = ConstraintBlocks {
            actuated: Matrix::zeros(rows + usize::from(random.once_in(3)), 2),
            passive: Matrix::zeros(rows, 1 + 2000 * usize::from(random.once_in(4))),
            grasp: Matrix::zeros(3, rows),
        };
        if random.once_in(5) {
            blocks.grasp = Matrix::zeros(1, 12_000 + random.below(2));
            blocks.actuated = Matrix::zeros(blocks.grasp.cols(), 0);
            blocks.passive = blocks.actuated.clone();
            let refused = Constraint::new(blocks).map(|c| c.rows()).map_err(|e| e.to_string());
            return record.word(&refused.map_err(|message| message.len()));
        }
        let (i, j) = (random.below(rows), random.below(2));
        if random.once_in(2) {
            blocks.actuated[(i, j)] = f64::INFINITY;
        }
        if random.once_in(3) {
            blocks.grasp[(i.min(2), 0)] = f64::NAN;
        }
        match Constraint::new(blocks) {
            Ok(constraint) => record.word(&(constraint.rows(), constraint.passive())),
            Err(error) => record_error(record, &error),
        }
    });
}
