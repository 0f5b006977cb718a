//! Wrong shapes, NaN, empty sets: an error that names the culprit, or a defined answer.

use cylindroid::closure::{
    Constraint, ConstraintBlocks, Mobility, MotionSpace, StaticLoad, Unit, Units, contact_forces,
    joint_torques,
};
use cylindroid::linalg::Metric;
use cylindroid::{Error, Matrix};

use super::case::case;

fn blocks() -> ConstraintBlocks {
    ConstraintBlocks {
        actuated: Matrix::from_fn(4, 2, |i, j| (i + j) as f64),
        passive: Matrix::from_fn(4, 1, |i, _| i as f64),
        grasp: Matrix::from_fn(3, 4, |i, j| (i * j) as f64),
    }
}

#[test]
fn shapes_that_do_not_fit() {
    let wrong = ConstraintBlocks { passive: Matrix::zeros(3, 1), ..blocks() };
    let error = Constraint::new(wrong).unwrap_err();
    assert!(error.to_string().starts_with("passive Jacobian"), "{error}");
    let wrong = ConstraintBlocks { actuated: Matrix::zeros(0, 0), ..blocks() };
    assert!(matches!(Constraint::new(wrong), Err(Error::Dimension { expected: 4, got: 0, .. })));
    let units = Units {
        rows: vec![Unit::Length; 4],
        actuated: vec![Unit::Angle; 2],
        passive: vec![],
        object: vec![Unit::Length; 3],
    };
    let constraint = Constraint::new(blocks()).unwrap();
    let error = constraint.clone().with_length(&units, 1.0).unwrap_err().to_string();
    assert!(error.contains("passive"), "{error}");
    for length in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = constraint.clone().with_length(&units, length).unwrap_err().to_string();
        assert!(error.starts_with("length = "), "{error}");
    }
}

#[test]
fn numbers_that_are_none() {
    for bad in [f64::NAN, f64::INFINITY] {
        let mut b = blocks();
        b.grasp[(1, 2)] = bad;
        let error = Constraint::new(b).unwrap_err().to_string();
        assert!(error.starts_with("grasp matrix entry (1, 2) is not finite"), "{error}");
        assert!(Constraint::serial(&Matrix::diagonal(&[1.0, bad])).is_err());
    }
}

#[test]
fn tasks_that_are_none() {
    let relation = MotionSpace::of(&case("fivebar_sec5_case_a").constraint()).relation();
    let task = |rows: &[&[f64]]| relation.task(&Matrix::from_rows(rows).unwrap());
    let error = task(&[&[1.0, 0.0, 0.0], &[2.0, 0.0, 0.0]]).unwrap_err().to_string();
    assert!(error.contains("rank 1"), "{error}");
    assert!(task(&[&[0.0, 0.0, 0.0]]).is_err());
    assert!(task(&[&[1.0, 0.0]]).is_err());
    assert!(task(&[&[f64::NAN, 0.0, 0.0]]).is_err());
    let four = [1.0, 0.0, 0.0];
    assert!(task(&[&four, &[0.0, 1.0, 0.0], &[0.0, 0.0, 1.0], &[1.0, 1.0, 1.0]]).is_err());
    // RowSelection of very different length are independent all the same.
    assert_eq!(task(&[&[1e-12, 0.0, 0.0], &[0.0, 1e9, 0.0]]).unwrap().object(), 2);
    assert_eq!(relation.task(&Matrix::zeros(0, 3)).unwrap().object(), 0);
}

#[test]
fn loads_that_do_not_fit() {
    let constraint = case("fivebar_sec5_case_a").constraint();
    let motions = MotionSpace::of(&constraint);
    let relation = motions.relation();
    assert!(joint_torques(&relation, &[1.0], None).is_err());
    assert!(joint_torques(&relation, &[f64::NAN, 0.0, 0.0], None).is_err());
    let short = Metric::diagonal("w", &[1.0]).unwrap();
    let wrench = [0.0, 0.0, 1.0];
    let error = joint_torques(&relation, &wrench, Some(&short)).unwrap_err().to_string();
    assert!(error.starts_with("torque metric has 1 entries, expected 2"), "{error}");
    let forces = |torques: &[f64], metric| {
        contact_forces(&constraint, &motions, StaticLoad { torques, wrench: &wrench }, metric)
    };
    assert!(forces(&[1.0], None).is_err());
    assert!(forces(&[1.0, f64::INFINITY], None).is_err());
    assert!(forces(&[1.0, 0.0], Some(&short)).is_err());
}

/// Any of the sizes may be zero.
#[test]
fn empty_constraints() {
    for (t, a, p, d) in [(0, 0, 0, 0), (0, 2, 1, 3), (3, 0, 0, 3), (3, 2, 0, 0), (4, 0, 3, 0)] {
        let constraint = Constraint::new(ConstraintBlocks {
            actuated: Matrix::from_fn(t, a, |i, j| 1.0 + (i * j) as f64),
            passive: Matrix::from_fn(t, p, |i, j| f64::from(u8::from(i == j))),
            grasp: Matrix::from_fn(d, t, |i, j| f64::from(u8::from(i == j))),
        })
        .unwrap();
        let m = Mobility::of(&constraint);
        let n = a + p + d;
        assert_eq!(m.dof.basis.rows(), n);
        let rank = n - m.dof.dimension();
        assert_eq!(m.hyperstatic.dimension(), t - rank, "{t} {a} {p} {d}");
        let r = m.relation;
        assert_eq!(r.relation + r.internal + r.zero_torque + r.coordinate, a + d);
    }
}

/// All zero: nothing is constrained.
#[test]
fn zero_matrices() {
    let constraint = Constraint::new(ConstraintBlocks {
        actuated: Matrix::zeros(3, 2),
        passive: Matrix::zeros(3, 1),
        grasp: Matrix::zeros(6, 3),
    })
    .unwrap();
    let m = Mobility::of(&constraint);
    assert_eq!((m.dof.dimension(), m.redundancy.dimension(), m.hyperstatic.dimension()), (9, 2, 3));
    assert_eq!(m.relation.indeterminacy, 6);
    assert_eq!(m.idle.dimension(), 1);
}
