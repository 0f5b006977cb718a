//! Mobility where it is known by hand.

use cylindroid::Matrix;
use cylindroid::closure::{
    Constraint, ConstraintBlocks, Mobility, MotionSpace, RowSelection, Subspace,
};
use cylindroid::spatial::Vec3;

use super::case::{case, cases};

fn rows(rows: &[&[f64]]) -> Matrix {
    Matrix::from_rows(rows).unwrap()
}

/// A motion of the actuated joint that either the passive joint or the object takes up: one motion
/// of the paper's equation 5, which after projection leaves nothing (J_a = J_p = (1, 0)^T,
/// G^T = (1 0)).
#[test]
fn a_motion_counted_twice_is_no_coordinate_motion() {
    let constraint = Constraint::new(ConstraintBlocks {
        actuated: rows(&[&[1.0], &[0.0]]),
        passive: rows(&[&[1.0], &[0.0]]),
        grasp: rows(&[&[1.0, 0.0], &[0.0, 1.0], &[0.0, 0.0]]),
    })
    .unwrap();
    let m = Mobility::of(&constraint);
    assert_eq!((m.dof.dimension(), m.redundancy.dimension()), (3, 0));
    assert_eq!(
        [&m.indeterminacy, &m.uncontrollable_object_motions, &m.mixed].map(Subspace::dimension),
        [2, 1, 1]
    );
    assert_eq!(m.coordinate.dimension(), 1);
    let kinds = &m.coordinate_kinds;
    let counts = [&kinds.passive, &kinds.object, &kinds.both].map(Subspace::dimension);
    assert_eq!((counts, kinds.overlap), ([1, 1, 0], 1));
    let r = m.relation;
    assert_eq!((r.coordinate, r.redundancy, r.indeterminacy), (0, 1, 2));
}

/// Grubler's count of the spatial four-bar is -2, it moves by one, and resists three forces that
/// nothing determines.
#[test]
fn spatial_four_bar_moves_against_grubler() {
    let m = Mobility::of(&case("fourbar_3D_hyperstatic").constraint());
    assert_eq!((m.gruebler_kutzbach, m.dof.dimension(), m.hyperstatic.dimension()), (-2, 1, 3));
    assert!(m.joints.iter().all(|j| j.moves && !j.free_of_actuators && !j.idle));
}

/// The rods of a platform on spheres spin: six idle motions, one in each leg.
#[test]
fn rods_on_spheres_spin_idly() {
    let constraint = case("stewart_6SPS_home").constraint();
    let m = Mobility::of(&constraint);
    assert_eq!(m.idle.dimension(), 6);
    let idle: usize = m.joints.iter().filter(|j| j.idle).count();
    // Only the joints of spheres; the sliding ones are actuated.
    assert!(idle >= 12 && m.joints[..6].iter().all(|j| !j.idle), "{idle}");
    for j in 0..6 {
        let spin = m.idle.basis.column(j);
        assert!(spin[..6].iter().chain(&spin[24..]).all(|x| x.abs() < 1e-12));
    }
}

#[test]
fn nothing_actuated_and_everything_actuated() {
    for case in cases() {
        let none = case.actuated_by(&[]).constraint();
        let m = Mobility::of(&none);
        assert_eq!(none.actuated(), 0);
        // Without actuators every motion is indeterminate, and only the structure resists wrenches.
        assert_eq!(m.indeterminacy.dimension(), m.dof.dimension(), "{}", case.name);
        assert_eq!((m.relation.coordinate, m.internal.dimension()), (0, 0), "{}", case.name);
        assert_eq!(
            m.relation.indeterminacy + m.zero_torque.dimension(),
            none.object(),
            "{}",
            case.name
        );
        let all: Vec<usize> = (0..none.passive()).collect();
        let all = case.actuated_by(&all[..all.len() - none.object() * (case.objects() - 1)]);
        let actuated = Mobility::of(&all.constraint());
        assert_eq!(actuated.dof.dimension(), m.dof.dimension(), "{}", case.name);
        assert_eq!(actuated.idle.dimension(), 0, "{}", case.name);
    }
}

/// Three collinear joints: a four-bar folded flat can move in two ways there.
#[test]
fn folded_four_bar_has_a_second_motion() {
    // Joints at 0, 1, 3, 2 on one line; the object is the link from 1 to 3.
    let flat = case("fourbar_fig1cd");
    let mut folded = flat;
    for (j, x) in [0.0, 1.0, 2.0, 3.0].into_iter().enumerate() {
        folded = folded.with_joint_at(j, Vec3::new(x, 0.0, 0.0));
    }
    let m = Mobility::of(&folded.constraint());
    assert_eq!(m.dof.dimension(), 2);
    assert_eq!(m.hyperstatic.dimension(), 1);
    // Nearly folded: regular, but the report warns of an ambiguous rank.
    let nearly = folded.with_joint_at(1, Vec3::new(1.0, 1e-8, 0.0));
    let m = Mobility::of(&nearly.constraint());
    assert_eq!(m.dof.dimension(), 1);
    let warning = m.ambiguous_ranks.iter().find(|d| d.count == "dof").unwrap().to_string();
    assert!(warning.contains("near-singular"), "{warning}");
}

#[test]
fn motions_that_let_rows_stand() {
    let motions = MotionSpace::of(&case("two3R_hardfinger_passive").constraint());
    let locked = motions.vanishing_on(RowSelection { actuated: true, ..RowSelection::default() });
    assert_eq!(locked.cols(), 2);
    assert!(locked.rows_between(0, 3).max_abs() < 1e-14);
    assert_eq!(motions.vanishing_on(RowSelection::default()).cols(), motions.dof());
}

#[test]
fn a_joint_without_way_is_locked() {
    // Two sliders against one wall: the second row locks the second joint.
    let constraint = Constraint::new(ConstraintBlocks {
        actuated: rows(&[&[1.0], &[0.0]]),
        passive: rows(&[&[0.0], &[1.0]]),
        grasp: rows(&[&[1.0, 0.0]]),
    })
    .unwrap();
    let m = Mobility::of(&constraint);
    assert!(m.joints[0].moves && !m.joints[1].moves);
    assert!((m.joints[0].share - 0.5_f64.sqrt()).abs() < 1e-15);
}
