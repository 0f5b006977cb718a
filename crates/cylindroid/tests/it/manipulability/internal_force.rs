//! Manipulability of internal forces: equilibrium, principal directions, grippers by hand.

use cylindroid::Matrix;
use cylindroid::closure::{Constraint, ConstraintBlocks, Mobility};
use cylindroid::linalg::Metric;
use cylindroid::manipulability::internal_force_manipulability;

use crate::closure::case::{Anew, cases, described_anew};
use crate::support::{Random, assert_close};

fn rows(rows: &[&[f64]]) -> Matrix {
    Matrix::from_rows(rows).unwrap()
}

fn largest(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |m, x| m.max(x.abs()))
}

/// In all reference mechanisms: as many as the mobility report counts, in equilibrium, and principal
/// in metrics drawn at random: torques and forces of different directions are orthogonal, and the
/// forces are orthogonal to the hyperstatic ones (the smallest for their torques).
#[test]
fn principal_directions_of_internal_forces() {
    let mut random = Random(414);
    let mut squeezed = 0;
    for case in cases() {
        let constraint = case.constraint();
        let m = Mobility::of(&constraint);
        let weights =
            |random: &mut Random, n| (0..n).map(|_| random.within(0.2, 3.0)).collect::<Vec<_>>();
        let (wtau, wt) =
            (weights(&mut random, constraint.actuated()), weights(&mut random, constraint.rows()));
        let metrics = [("Wtau", &wtau), ("Wt", &wt)].map(|(n, w)| Metric::diagonal(n, w).unwrap());
        let found =
            internal_force_manipulability(&constraint, Some(&metrics[0]), Some(&metrics[1]))
                .unwrap();
        let counts = (found.finite.len(), found.infinite.cols(), found.zeros.cols());
        let expected = (m.internal.dimension(), m.hyperstatic.dimension(), 0);
        assert_eq!(counts, expected, "{}", case.name);
        squeezed += counts.0;
        let blocks = constraint.blocks();
        let weighted = |a: &[f64], w: &[f64], b: &[f64]| -> f64 {
            a.iter().zip(w).zip(b).map(|((a, w), b)| a * w * b).sum()
        };
        for (i, d) in found.finite.iter().enumerate() {
            let force = blocks.grasp.mul_vec(&d.object);
            let mut passive = vec![0.0; constraint.passive()];
            blocks.passive.tr_mul_vec_into(&d.object, &mut passive);
            let mut torque = vec![0.0; constraint.actuated()];
            blocks.actuated.tr_mul_vec_into(&d.object, &mut torque);
            torque.iter_mut().zip(&d.joint).for_each(|(t, tau)| *t += tau);
            let left = largest(&force).max(largest(&passive)).max(largest(&torque));
            assert!(left < 1e-9, "{}: {left:e}", case.name);
            let ratio = weighted(&d.object, &wt, &d.object) / weighted(&d.joint, &wtau, &d.joint);
            let value = d.pair.efficiency();
            assert!((ratio / value - 1.0).abs() < 1e-9, "{}: {ratio} {value}", case.name);
            for other in &found.finite[..i] {
                let across = weighted(&d.object, &wt, &other.object).abs();
                let torques = weighted(&d.joint, &wtau, &other.joint).abs();
                assert!(across.max(torques) < 1e-9, "{}: {across:e} {torques:e}", case.name);
            }
            for j in 0..found.infinite.cols() {
                let across = weighted(&d.object, &wt, found.infinite.column(j)).abs();
                assert!(across < 1e-9, "{}: {across:e}", case.name);
            }
        }
    }
    assert!(squeezed > 30, "{squeezed}");
}

/// The frame of the world has no influence.
#[test]
fn frames_do_not_change_internal_forces() {
    described_anew(Anew::Frame, 97, |case, problem| {
        let here = internal_force_manipulability(&case.constraint(), None, None).unwrap();
        let there = internal_force_manipulability(&problem.constraint, None, None).unwrap();
        assert_close(&case.name, &there.values(), &here.values(), 1e-8);
    });
}

/// Two fingers, each on a lever, press on a block from both sides: the force is the torque over the
/// lever, and every unit of it is felt at both contacts.
#[test]
fn a_gripper_by_hand() {
    let (a, b) = (0.5, 0.2);
    let gripper = Constraint::new(ConstraintBlocks {
        // Contact velocities along x: of the levers, and of the block.
        actuated: rows(&[&[a, 0.0], &[0.0, b]]),
        passive: Matrix::zeros(2, 0),
        grasp: rows(&[&[1.0, 1.0]]),
    })
    .unwrap();
    let found = internal_force_manipulability(&gripper, None, None).unwrap();
    assert_close("efficiency", &found.values(), &[2.0 / (a * a + b * b)], 1e-14);
    let d = &found.finite[0];
    assert!((d.object[0] + d.object[1]).abs() < 1e-14);
    // The ellipsoid of forces: a segment, as long as the force for torques of length one.
    let axes = found.semi_axes();
    let length = axes.frobenius_norm();
    assert!((length - (2.0 / (a * a + b * b)).sqrt()).abs() < 1e-14);
}

/// If only one finger is driven and the other joint is passive, nothing can be squeezed; if the other
/// is locked, the driven one can.
#[test]
fn a_passive_finger_cannot_squeeze() {
    let of = |actuated: Matrix, passive: Matrix| {
        let grasp = rows(&[&[1.0, 1.0]]);
        let blocks = ConstraintBlocks { actuated, passive, grasp };
        internal_force_manipulability(&Constraint::new(blocks).unwrap(), None, None).unwrap()
    };
    let (first, second) = (rows(&[&[0.5], &[0.0]]), rows(&[&[0.0], &[0.5]]));
    let passive = of(first.clone(), second);
    assert_eq!((passive.finite.len(), passive.infinite.cols()), (0, 0));
    let locked = of(first, Matrix::zeros(2, 0));
    assert_close("against a wall", &locked.values(), &[8.0], 1e-14);
}
