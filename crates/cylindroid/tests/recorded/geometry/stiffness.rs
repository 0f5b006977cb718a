//! Stiffness and compliance of arms, platforms and loops, with drives, bearings and links that give
//! way.

use cylindroid::closure::{ClosedChain, Unit, Units};
use cylindroid::manipulability::{Metrics, Stiffness};
use cylindroid::model::Elasticity;
use cylindroid::{Matrix, Mechanism, catalogue};

use super::mechanisms::{configuration, tree};
use super::{counts, definite, error, matrix, span, sum, verdicts};
use crate::record::{Record, check};
use crate::robots::{self, Random};

/// Of some drives, of a joint, of a link.
fn elasticity(random: &mut Random<'_>, mechanism: &Mechanism) -> Elasticity {
    let mut all = Elasticity::default();
    let drives: Vec<usize> = mechanism.actuated().collect();
    for &i in &drives {
        if !random.once_in(5) {
            all.stiffness(&mechanism.coordinates()[i].name, random.power(-1.0, 2.0));
        }
    }
    let small = |random: &mut Random<'_>| {
        let size = random.power(-2.0, 0.0);
        let d = mechanism.dimension().components().len();
        let m = definite(random, d);
        let rank = random.below(2);
        Matrix::from_fn(d, d, |i, j| match rank {
            0 => size * m[(i, j)],
            _ => size * if i == j && i != 1 { 1.0 } else { 0.0 },
        })
    };
    if random.once_in(3) {
        let joint = &mechanism.joints()[random.below(mechanism.joints().len())];
        all.joint(&joint.name, small(random));
    }
    if random.once_in(3) && !mechanism.loops().is_empty() {
        all.joint(&mechanism.loops()[0].name, small(random));
    }
    if random.once_in(3) {
        let link = mechanism.joints()[random.below(mechanism.joints().len())].child;
        all.link(&mechanism.links()[link].name, small(random), random.pose(0.3));
    }
    all
}

fn deflections(record: &mut Record, found: &Stiffness, random: &mut Random<'_>) {
    let d = found.free.rows();
    let wrench: Vec<f64> = (0..d).map(|_| random.within(-1.0, 1.0)).collect();
    let Some(bent) = error(record, found.deflection(&wrench)) else { return };
    record.number(sum(&[bent.energy, sum(&bent.twist), sum(&bent.unbalanced)]));
    let parts: Vec<f64> = bent.parts.iter().map(|part| sum(&part.deflection)).collect();
    record.number(sum(&bent.torques) + sum(&parts));
    let forces: Vec<f64> = bent.forces.iter().flat_map(|f| f.wrench.to_array()).collect();
    record.number(sum(&forces));
    let _ = error(record, found.deflection(&wrench[1..]));
    let mut large = wrench;
    large[0] = [1e121, 0.9e120, f64::NAN][random.below(3)];
    verdicts(record, &[found.deflection(&large).is_ok()]);
}

fn stiff(record: &mut Record, mechanism: &Mechanism, q: &[f64], random: &mut Random<'_>) {
    let state = mechanism.state(q).unwrap();
    let elasticity = elasticity(random, mechanism);
    let length = random.once_in(3).then(|| random.power(-0.5, 0.5));
    let Some(found) = error(record, Stiffness::of(&state, None, length, &elasticity)) else {
        return;
    };
    counts(record, &[found.free.cols(), found.rigid.cols(), found.undetermined]);
    record.number(sum(&found.point.to_array()));
    let usable = |m: &&Matrix| m.max_abs() < 1e5;
    if let Some(k) = found.stiffness.as_ref().filter(usable) {
        matrix(record, k);
    }
    if let Some(c) = found.compliance.as_ref().filter(usable) {
        matrix(record, c);
    }
    let frame = random.pose(1.0);
    if mechanism.dimension().components().len() == 6 {
        if let Some(k) = found.at(frame).filter(|m| usable(&m)) {
            matrix(record, &k);
        }
        if let Some(c) = found.compliance_at(frame).filter(|m| usable(&m)) {
            matrix(record, &c);
        }
    }
    deflections(record, &found, random);
    record.number(span(&found.rigid) + 0.7 * span(&found.free));
    if let Some(l) = found.cholesky().filter(|m| usable(&m)) {
        matrix(record, &l);
    }
    if let Some(all) = found.eigenscrews() {
        counts(record, &[all.kind.name().len(), all.screws.len()]);
        record.number(sum(&all.screws.iter().map(|e| e.eigenvalue).collect::<Vec<_>>()));
    }
}

#[test]
fn arms() {
    check("geometry_stiff_arms", 34, |random, record| {
        let mechanism = match random.below(3) {
            0 => robots::of_catalogue(random, false),
            _ => tree(random, false),
        };
        let q = configuration(random, &mechanism);
        stiff(record, &mechanism, &q, random);
    });
}

#[test]
fn loops() {
    check("geometry_stiff_loops", 50, |random, record| {
        let mechanism = match random.below(3) {
            0 => robots::five_bar(random),
            1 => robots::spatial_loop(random),
            _ => {
                catalogue::load(["five-bar", "3rrr", "stewart", "delta"][random.below(4)]).unwrap()
            }
        };
        let mechanism = if random.once_in(3) {
            let first = mechanism.actuated().next().unwrap();
            let name = mechanism.coordinates()[first].name.clone();
            mechanism.with_actuated(&[&name]).unwrap()
        } else {
            mechanism
        };
        let q = mechanism.home().to_vec();
        stiff(record, &mechanism, &q, random);
    });
}

/// Metrics of limits, lengths and masses.
#[test]
fn metrics() {
    check("geometry_metrics", 40, |random, record| {
        let mechanism = tree(random, false);
        let q = configuration(random, &mechanism);
        let state = mechanism.state(&q).unwrap();
        let chain = ClosedChain::of(&state, None, None).unwrap();
        let length = [0.0, -1.0, 1e-200, f64::NAN, random.power(-1.0, 1.0)][random.below(5)];
        let mut unit = || [Unit::Length, Unit::Angle][random.below(2)];
        let units = Units {
            rows: vec![Unit::Angle; chain.constraint.rows()],
            actuated: (0..chain.constraint.actuated()).map(|_| unit()).collect(),
            passive: Vec::new(),
            object: (0..6).map(|_| unit()).collect(),
        };
        if let Some(found) = error(record, Metrics::characteristic_length(&units, length)) {
            matrix(record, found.object.as_ref().unwrap().lower());
            matrix(record, found.joint.as_ref().unwrap().lower());
            record.number(found.joint.as_ref().unwrap().diagonal_ratio());
        }
        let of_body = Metrics::UNIT.with_inertia(&state, mechanism.tool());
        if let Some(found) = error(record, of_body) {
            matrix(record, found.object.as_ref().unwrap().lower());
        }
        if let Some(found) = error(record, Metrics::UNIT.with_joint_inertia(&state)) {
            matrix(record, found.joint.as_ref().unwrap().lower());
        }
    });
}
