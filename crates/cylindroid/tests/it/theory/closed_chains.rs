//! Errata C1 to C10 of docs/theory/closed-chains.md: Bicchi & Prattichizzo, manipulability of
//! cooperating robots with passive joints.

use cylindroid::Matrix;
use cylindroid::closure::{Constraint, ConstraintBlocks, Mobility};
use cylindroid::linalg::Metric;
use cylindroid::manipulability::{Manipulability, Metrics};
use cylindroid::model::{Dimension, JointKind};
use cylindroid::spatial::Vec3;

use crate::closure::case::case;
use crate::support::assert_close;

fn rows(rows: &[&[f64]]) -> Matrix {
    Matrix::from_rows(rows).unwrap()
}

fn constraint(actuated: Matrix, passive: Matrix, grasp: Matrix) -> Constraint {
    Constraint::new(ConstraintBlocks { actuated, passive, grasp }).unwrap()
}

/// All joints actuated.
fn actuated(jacobian: Matrix, grasp: Matrix) -> Constraint {
    let passive = Matrix::zeros(jacobian.rows(), 0);
    constraint(jacobian, passive, grasp)
}

fn efficiencies(constraint: &Constraint) -> Manipulability {
    weighted(constraint, &Metrics::UNIT)
}

fn weighted(constraint: &Constraint, metrics: &Metrics) -> Manipulability {
    let relation = cylindroid::closure::MotionSpace::of(constraint).relation();
    Manipulability::of(&relation, metrics).unwrap()
}

fn five_bar(name: &str) -> Manipulability {
    efficiencies(&case(&format!("fivebar_sec5_case_{name}")).constraint())
}

/// C1: two motors on one slide. Equation 15 without its cross terms gives any number up to the
/// true one, which belongs to equal torques.
#[test]
fn erratum_cross_terms_of_active_force() {
    let m = efficiencies(&actuated(Matrix::identity(2), rows(&[&[1.0, 1.0]])));
    let active = m.active_force();
    assert_close("active", &active.values(), &[2.0], 1e-14);
    assert_eq!((active.zeros.cols(), active.infinite.cols()), (1, 0));
    let torque = &active.finite[0].joint;
    assert!((torque[0] - torque[1]).abs() < 1e-14);
    // As printed: 1 / |(1 - a, a)|^2.
    let printed = |a: f64| 1.0 / ((1.0 - a).powi(2) + a * a);
    assert_eq!((printed(0.0), printed(0.5)), (1.0, 2.0));
    // Case c of the five-bar: printed 3.5 and 1.35.
    assert_close("five-bar", &five_bar("c").active_force().values(), &[5.9151, 1.5849], 1e-4);
}

/// C1: one motor on an object that moves in two directions at once; equation 16 likewise.
#[test]
fn erratum_cross_terms_of_passive_force() {
    let m = efficiencies(&actuated(rows(&[&[1.0], &[1.0]]), Matrix::identity(2)));
    let passive = m.passive_force();
    assert_close("passive", &passive.values(), &[0.5], 1e-14);
    assert_eq!((passive.zeros.cols(), passive.infinite.cols()), (0, 1));
    // As printed: |(1 - a, a)|^2, at least the true one.
    let printed = |a: f64| (1.0 - a).powi(2) + a * a;
    assert_eq!((printed(0.0), printed(0.5)), (1.0, 0.5));
    // Case b of the five-bar: printed 3.3 and 0.7.
    assert_close("five-bar", &five_bar("b").passive_force().values(), &[3.1061, 0.6439], 1e-4);
}

/// C2: motion and force have reciprocal efficiencies along the same directions.
#[test]
fn erratum_efficiencies_are_reciprocal() {
    let m = efficiencies(&actuated(Matrix::diagonal(&[1.0, 3.0]), Matrix::identity(2)));
    assert_close("motion", &m.kinematic.values(), &[9.0, 1.0], 1e-13);
    assert_close("force", &m.force.values(), &[1.0, 1.0 / 9.0], 1e-14);
    // The best motion and the worst force are along the second coordinate.
    let (motion, force) = (&m.kinematic.finite[0].object, &m.force.finite[1].object);
    assert!(motion[0].abs() < 1e-14 && force[0].abs() < 1e-14);
    for name in ["a", "b", "c"] {
        let m = five_bar(name);
        let mut inverse: Vec<f64> = m.kinematic.values().iter().map(|e| 1.0 / e).collect();
        inverse.reverse();
        assert_close(name, &m.force.values(), &inverse, 1e-11);
    }
}

/// C3: in all cases the structure alone carries a force along the line through joints 1 and 2.
#[test]
fn erratum_infinite_eigenvalue_of_all_cases() {
    for name in ["a", "b", "c"] {
        let passive = five_bar(name).passive_force();
        assert_eq!(passive.infinite.cols(), 1, "{name}");
        // (0, 1, -1) at joint 3 = (1, 2): the moment of a force along y on the line x = 0.
        let wrench = passive.infinite.column(0);
        let expected = [0.0, wrench[1], -wrench[1]];
        assert_close(name, wrench, &expected, 1e-12);
        assert!(wrench[1].abs() > 0.5);
    }
}

/// C4: one anisotropy for the three ellipsoids of each case.
#[test]
fn erratum_anisotropy_of_the_five_bar() {
    for (name, expected) in [("a", 22.455), ("b", 4.8240), ("c", 3.7321)] {
        let m = five_bar(name);
        for spectrum in [&m.kinematic, &m.active_force(), &m.passive_force()] {
            let anisotropy = spectrum.anisotropy().unwrap();
            assert!((anisotropy / expected - 1.0).abs() < 1e-4, "{name}: {anisotropy}");
        }
    }
}

/// C5: a spherical joint constrains three components, all of them linear; in the plane it would
/// be a revolute joint.
#[test]
fn erratum_spherical_joint_is_spatial() {
    let wrenches = JointKind::Spherical.constraint_wrenches(Vec3::Z, Dimension::Spatial);
    assert_eq!(wrenches.len(), 3);
    assert!(wrenches.iter().all(|w| w.moment == Vec3::ZERO));
    let planar = |kind: JointKind| kind.constraint_wrenches(Vec3::Z, Dimension::Planar);
    assert_eq!(planar(JointKind::Spherical), planar(JointKind::Revolute));
    assert_eq!(planar(JointKind::Spherical).len(), 2);
}

/// C6: a motion of the actuated joint that passive joints absorb is redundant, though the actuated
/// Jacobian has no null space.
#[test]
fn erratum_two_redundancies() {
    let one = rows(&[&[1.0], &[0.0]]);
    let m = Mobility::of(&constraint(one.clone(), one, rows(&[&[0.0, 1.0]])));
    assert_eq!((m.dof.dimension(), m.redundancy.dimension()), (1, 0));
    let r = m.relation;
    assert_eq!((r.redundancy, r.indeterminacy, r.coordinate), (1, 0, 0));
}

/// C7: six idle spins add to the mobility of a platform and change no efficiency.
#[test]
fn erratum_idle_legs_count_in_the_mobility() {
    let [spheres, universal] = ["stewart_6SPS_home", "stewart_6UPS_home"].map(case);
    let [m, n] = [&spheres, &universal].map(|c| Mobility::of(&c.constraint()));
    assert_eq!((m.dof.dimension(), m.idle.dimension()), (12, 6));
    assert_eq!((n.dof.dimension(), n.idle.dimension()), (6, 0));
    let [a, b] = [&spheres, &universal].map(|c| efficiencies(&c.constraint()).kinematic.values());
    assert_close("efficiencies", &a, &b, 1e-9);
}

/// C8: a motion that either the passive joint or the object absorbs is counted in two blocks of
/// equation 5, and is no coordinate motion of the relation.
#[test]
fn erratum_motion_counted_twice() {
    let one = rows(&[&[1.0], &[0.0]]);
    let grasp = rows(&[&[1.0, 0.0], &[0.0, 1.0], &[0.0, 0.0]]);
    let chain = constraint(one.clone(), one, grasp);
    let m = Mobility::of(&chain);
    assert_eq!((m.dof.dimension(), m.redundancy.dimension()), (3, 0));
    assert_eq!((m.indeterminacy.dimension(), m.coordinate.dimension()), (2, 1));
    assert_eq!(m.coordinate_kinds.overlap, 1);
    let r = m.relation;
    assert_eq!((r.redundancy, r.indeterminacy, r.coordinate), (1, 2, 0));
    let spectrum = efficiencies(&chain).kinematic;
    assert_eq!((spectrum.finite.len(), spectrum.zeros.cols(), spectrum.infinite.cols()), (0, 1, 2));
}

/// C9: the least weighted effort is across the redundancy in the metric, not in the null space of
/// its transpose.
#[test]
fn erratum_projector_of_appendix_b() {
    let arm = Constraint::serial(&rows(&[&[1.0, 1.0]])).unwrap();
    let metrics = Metrics::UNIT.with_joint(&Matrix::diagonal(&[1.0, 3.0])).unwrap();
    let m = weighted(&arm, &metrics);
    assert_close("efficiency", &m.kinematic.values(), &[4.0 / 3.0], 1e-14);
    let best = &m.kinematic.finite[0].joint;
    assert!((best[0] - 3.0 * best[1]).abs() < 1e-14, "{best:?}");
}

/// C10: a slide of unit lever pushes with F on a spring of stiffness k, which gives way by F / k: twice
/// the energy is F^2 / k.
#[test]
fn erratum_weight_of_wrenches_is_a_compliance() {
    let slide = Constraint::serial(&rows(&[&[1.0]])).unwrap();
    let (k, f) = (50.0, 3.0);
    let twice_the_energy = k * (f / k) * (f / k);
    let compliance = Metric::diagonal("Ww", &[1.0 / k]).unwrap();
    let metrics = Metrics { wrench: Some(compliance), ..Metrics::UNIT };
    let force = weighted(&slide, &metrics).force.values();
    assert_close("energy", &[force[0] * f * f], &[twice_the_energy], 1e-14);
}
