//! Many configurations at once: poses and Jacobians, mobility and manipulability.

use cylindroid::closure::{MobilityCounts, assemble};
use cylindroid::kinematics::KinematicsBatch;
use cylindroid::manipulability::{BatchOptions, ManipulabilityBatch, Metrics};
use cylindroid::{Mechanism, ReferenceFrame, catalogue};

use super::mechanisms::{chain, configuration, ring, tool, tree};
use super::{counts, definite, error, random_matrix, selection, sum};
use crate::record::{Record, check};
use crate::robots::{self, Random};

const REFERENCES: [ReferenceFrame; 3] =
    [ReferenceFrame::Local, ReferenceFrame::World, ReferenceFrame::LocalWorldAligned];

fn rows(random: &mut Random<'_>, mechanism: &Mechanism, count: usize) -> Vec<f64> {
    (0..count).flat_map(|_| configuration(random, mechanism)).collect()
}

#[test]
fn kinematics() {
    check("geometry_batches", 60, |random, record| {
        let mechanism = if random.once_in(4) { tree(random, false) } else { chain(random) };
        let batch = KinematicsBatch::new(&mechanism, tool(random, &mechanism)).unwrap();
        let count = random.below(14);
        let q = rows(random, &mechanism, count);
        let (n, reference) = (batch.n(), REFERENCES[random.below(3)]);
        counts(record, &[n, count]);
        record.number(sum(&batch.poses(&q).unwrap()));
        record.number(sum(&batch.jacobians(&q, reference).unwrap()));
        let (mut poses, mut jacobians) = (vec![0.0; 16 * count], vec![0.0; 6 * n * count]);
        batch.poses_and_jacobians_into(&q, reference, &mut poses, &mut jacobians).unwrap();
        record.number(sum(&poses) + 0.7 * sum(&jacobians));
        poses.fill(0.0);
        batch.poses_into(&q, &mut poses).unwrap();
        batch.jacobians_into(&q, reference, &mut jacobians).unwrap();
        record.number(sum(&poses) + 0.7 * sum(&jacobians));
        poses.push(0.0);
        let _ = error(record, batch.poses_into(&q, &mut poses));
        jacobians.push(0.0);
        let _ = error(record, batch.jacobians_into(&q, reference, &mut jacobians));
        if let Some(cut) = q.len().checked_sub(1) {
            let _ = error(record, batch.poses(&q[..cut]));
        }
    });
}

/// More than a thread takes at once.
#[test]
fn chunks_of_kinematics() {
    check("geometry_chunks", 2, |random, record| {
        let mechanism = catalogue::load(["3r", "panda"][random.below(2)]).unwrap();
        let batch = KinematicsBatch::new(&mechanism, mechanism.tool()).unwrap();
        let some = rows(random, &mechanism, 41);
        let q: Vec<f64> = some.iter().copied().cycle().take(4133 * batch.n()).collect();
        record.number(sum(&batch.poses(&q).unwrap()));
        record.number(sum(&batch.jacobians(&q, ReferenceFrame::Local).unwrap()));
    });
}

/// Closed near the home, open, or stretched.
fn postures(random: &mut Random<'_>, mechanism: &Mechanism, count: usize) -> Vec<f64> {
    let mut q = Vec::new();
    let spread = random.power(-2.0, 0.0);
    for i in 0..count {
        let mut one = |x: &f64| x + spread * random.within(-1.0, 1.0);
        let guess: Vec<f64> = mechanism.home().iter().map(&mut one).collect();
        let closed = mechanism.is_closed() && i % 4 != 1;
        q.extend(if closed { assemble(mechanism, &guess, &[]).unwrap().q } else { guess });
    }
    q
}

fn analysed(record: &mut Record, batch: &ManipulabilityBatch, q: &[f64]) {
    let generic = batch.generic();
    let MobilityCounts { rank, idle, redundancy, indeterminacy, zero_torque, .. } = generic;
    counts(record, &[rank, idle, redundancy, indeterminacy, zero_torque]);
    record.number(batch.length());
    let Some(found) = error(record, batch.analyse(q)) else { return };
    for row in found.chunks(ManipulabilityBatch::WIDTH) {
        let whole = &row[ManipulabilityBatch::COUNTS];
        counts(record, &whole.iter().map(|c| *c as usize).collect::<Vec<_>>());
        let finite = |x: &f64| if x.is_finite() { *x } else { 7.0 };
        let distances: Vec<f64> = row[11..15].iter().map(finite).collect();
        record.number(sum(&row[..2]) + sum(&distances));
        let size = row[15].abs().max(1e-3);
        record.number(row[15] / size + row[16].abs().log10() + row[18].min(1e4));
    }
}

fn options(random: &mut Random<'_>, mechanism: &Mechanism) -> BatchOptions {
    let d = mechanism.dimension().components().len();
    let task = match random.below(4) {
        0 => Some(selection(&[0, 1], d)),
        1 => Some(random_matrix(random, 2, d)),
        _ => None,
    };
    let size = task.as_ref().map_or(d, cylindroid::Matrix::rows);
    let mut metrics = Metrics::UNIT;
    if random.once_in(2) {
        metrics = metrics.with_object(&definite(random, size)).unwrap();
    }
    if random.once_in(3) {
        let joints = mechanism.actuated().count();
        metrics = metrics.with_joint(&definite(random, joints)).unwrap();
    }
    let length = random.once_in(3).then(|| random.power(-0.5, 0.5));
    BatchOptions { length, metrics, task, ..BatchOptions::default() }
}

#[test]
fn manipulability_of_closed_chains() {
    check("geometry_closed_batches", 24, |random, record| {
        let names = ["five-bar", "3rrr", "stewart", "four-bar", "delta", "two-arm"];
        let name = names[random.below(names.len())];
        let mut mechanism = catalogue::load(name).unwrap();
        if name == "five-bar" {
            let driven: [&[&str]; 5] =
                [&["q1", "q5"], &["q2", "q4"], &["q3"], &["q1", "q2", "q3"], &["q1", "q4"]];
            mechanism = mechanism.with_actuated(driven[random.below(5)]).unwrap();
        }
        let options = options(random, &mechanism);
        let Some(batch) = error(record, ManipulabilityBatch::new(&mechanism, &options)) else {
            return;
        };
        let count = 1 + random.below(6);
        let q = postures(random, &mechanism, count);
        analysed(record, &batch, &q);
    });
}

#[test]
fn manipulability_of_trees() {
    check("geometry_tree_batches", 36, |random, record| {
        let mechanism = match random.below(4) {
            0 => robots::of_catalogue(random, false),
            1 => chain(random),
            2 => ring(random),
            _ => tree(random, false),
        };
        let options = options(random, &mechanism);
        let Some(batch) = error(record, ManipulabilityBatch::new(&mechanism, &options)) else {
            return;
        };
        let count = 1 + random.below(6);
        let q = rows(random, &mechanism, count);
        analysed(record, &batch, &q);
        let mut short = vec![0.0; 5];
        let _ = error(record, batch.analyse_into(&q, &mut short));
        let mut bad = q;
        if let Some(x) = bad.last_mut() {
            *x = [1e200, f64::NAN][random.below(2)];
            let _ = error(record, batch.analyse(&bad));
        }
    });
}

/// Close to singular configurations, where the kernels ask the analysis of one.
#[test]
fn near_singularities() {
    check("geometry_near", 24, |random, record| {
        let mechanism = catalogue::load(["3r", "ur5e", "puma560"][random.below(3)]).unwrap();
        let task = (mechanism.n() == 3).then(|| selection(&[0, 1, 2], 6));
        let options = BatchOptions { task, ..BatchOptions::default() };
        let batch = ManipulabilityBatch::new(&mechanism, &options).unwrap();
        let mut q = rows(random, &mechanism, 1);
        let bend = q.len() - 1 - usize::from(q.len() > 3);
        q[bend] = [0.0, random.power(-13.0, -1.0)][random.below(2)];
        q.extend(q.clone());
        analysed(record, &batch, &q);
    });
}
