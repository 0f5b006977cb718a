//! Torques for a wrench, forces at contacts, elastic forces.

use cylindroid::Matrix;
use cylindroid::closure::{Load, Mobility, Motions, Relation, contact_forces, joint_torques};
use cylindroid::linalg::Metric;

use super::case::{Case, case, cases};
use crate::support::{Random, assert_close};

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn setup(case: &Case) -> (cylindroid::closure::Constraint, Motions, Relation) {
    let constraint = case.constraint();
    let motions = Motions::of(&constraint);
    let relation = motions.relation();
    (constraint, motions, relation)
}

/// Balanced torques do no work together with the wrench, are the least, and what is left of the
/// wrench works on free motions of the object alone.
#[test]
fn torques_balance_the_wrench() {
    let mut random = Random(73);
    for case in cases() {
        let (_, _, relation) = setup(&case);
        let wrench = random.vector(relation.object());
        let weights: Vec<f64> = (0..relation.joints()).map(|_| random.within(0.2, 3.0)).collect();
        let metric = Metric::diagonal("weights", &weights).unwrap();
        for (metric, weights) in [(None, vec![1.0; weights.len()]), (Some(&metric), weights)] {
            let found = joint_torques(&relation, &wrench, metric).unwrap();
            let held: Vec<f64> = wrench.iter().zip(&found.unbalanced).map(|(w, l)| w - l).collect();
            let motions = relation.motions().basis();
            let size = 1.0 + found.torques.iter().fold(0.0, |m: f64, t| m.max(t.abs()));
            for j in 0..motions.cols() {
                let (q, u) = motions.column(j).split_at(relation.joints());
                let power = dot(&found.torques, q) + dot(&held, u);
                assert!(power.abs() < 1e-12 * size, "{}: {power}", case.name);
            }
            let internal = relation.forces().zero;
            for j in 0..internal.cols() {
                let weighted: f64 = internal
                    .column(j)
                    .iter()
                    .zip(&weights)
                    .zip(&found.torques)
                    .map(|((h, w), t)| h * w * t)
                    .sum();
                assert!(weighted.abs() < 1e-12 * size, "{}: {weighted}", case.name);
            }
            if relation.dimensions().indeterminacy == 0 {
                assert_close("left", &found.unbalanced, &vec![0.0; wrench.len()], 1e-14);
            }
        }
    }
}

/// `w = G t, tau = -J_a^T t, 0 = J_p^T t`, and elastic forces are orthogonal in the compliance to
/// all that nothing determines.
#[test]
fn contact_forces_are_in_equilibrium() {
    let mut random = Random(74);
    for case in cases() {
        let (constraint, motions, relation) = setup(&case);
        let mobility = Mobility::from_parts(&constraint, &motions, &relation);
        let wrench = random.vector(constraint.object());
        let mut found = joint_torques(&relation, &wrench, None).unwrap();
        let held: Vec<f64> = wrench.iter().zip(&found.unbalanced).map(|(w, l)| w - l).collect();
        // Internal torques may be added at will.
        for j in 0..mobility.internal.dimension() {
            let share = random.within(-1.0, 1.0);
            let h = mobility.internal.basis.column(j);
            found.torques.iter_mut().zip(h).for_each(|(t, h)| *t += share * h);
        }
        let load = Load { torques: &found.torques, wrench: &held };
        let t = constraint.rows();
        let weights: Vec<f64> = (0..t).map(|_| random.within(0.1, 4.0)).collect();
        let compliance = Metric::diagonal("compliance", &weights).unwrap();
        let soft = contact_forces(&constraint, &motions, load, Some(&compliance)).unwrap();
        let least = contact_forces(&constraint, &motions, load, None).unwrap();
        let blocks = constraint.blocks();
        for (forces, weights) in [(&least, &vec![1.0; t]), (&soft, &weights)] {
            let f = &forces.forces;
            let size = 1e-12 * (1.0 + f.iter().fold(0.0, |m: f64, x| m.max(x.abs())));
            assert!(forces.unbalanced < 1e-12, "{}: {}", case.name, forces.unbalanced);
            assert_close("w", &blocks.grasp.mul_vec(f), &held, size);
            let torque: Vec<f64> =
                blocks.actuated.transpose().mul_vec(f).iter().map(|x| -x).collect();
            assert_close("tau", &torque, &found.torques, size);
            let passive = blocks.passive.transpose().mul_vec(f);
            assert_close("passive", &passive, &vec![0.0; constraint.passive()], size);
            let weighted: Vec<f64> = f.iter().zip(weights).map(|(f, w)| f * w).collect();
            for j in 0..mobility.hyperstatic.dimension() {
                let along = dot(mobility.hyperstatic.basis.column(j), &weighted);
                assert!(along.abs() < size, "{}: {along}", case.name);
            }
        }
        if mobility.hyperstatic.dimension() == 0 {
            assert_close(&case.name, &soft.forces, &least.forces, 1e-10);
        }
    }
}

/// Two fingers hold one force together; the stiffer of two springs in parallel takes more.
#[test]
fn stiffer_contact_takes_more() {
    // An object on two supports, both below it: f_1 + f_2 = w.
    let constraint = cylindroid::closure::Constraint::new(cylindroid::closure::Blocks {
        actuated: Matrix::zeros(2, 0),
        passive: Matrix::zeros(2, 0),
        grasp: Matrix::from_rows(&[[1.0, 1.0]]).unwrap(),
    })
    .unwrap();
    let motions = Motions::of(&constraint);
    assert_eq!((motions.dof(), motions.hyperstatic()), (0, 1));
    let load = Load { torques: &[], wrench: &[3.0] };
    let compliance = Metric::diagonal("compliance", &[1.0, 2.0]).unwrap();
    let elastic = contact_forces(&constraint, &motions, load, Some(&compliance)).unwrap();
    assert_close("elastic", &elastic.forces, &[2.0, 1.0], 1e-14);
    let least = contact_forces(&constraint, &motions, load, None).unwrap();
    assert_close("least", &least.forces, &[1.5, 1.5], 1e-14);
}

/// Torques that contradict the wrench are told by what they leave.
#[test]
fn contradiction_is_reported() {
    let (constraint, motions, _) = setup(&case("fivebar_sec5_case_a"));
    let load = Load { torques: &[1.0, 0.0], wrench: &[0.0, 0.0, 0.0] };
    let found = contact_forces(&constraint, &motions, load, None).unwrap();
    assert!(found.unbalanced > 0.1);
    let (_, _, relation) = setup(&case("fivebar_typeII"));
    let gained = relation.motions().infinite;
    // The singular five-bar does not hold a force across its stretched links.
    let found = joint_torques(&relation, gained.column(0), None).unwrap();
    assert_close("left", &found.unbalanced, gained.column(0), 1e-12);
}
