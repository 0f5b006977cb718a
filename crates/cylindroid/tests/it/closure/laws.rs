//! Laws of every mechanism: no work on the relation, statics from free bodies, bases.

use cylindroid::Matrix;
use cylindroid::closure::{Constraint, Mobility, MotionSpace};
use cylindroid::linalg::{ColumnSpace, Threshold};

use super::case::{case, cases};
use crate::support::Random;

/// `tau^T q_a + w^T u = 0` for every force and every motion, and nothing is missing of either.
#[test]
fn forces_do_no_work_and_are_all() {
    for case in cases() {
        let relation = MotionSpace::of(&case.constraint()).relation();
        let (r, f) = (relation.motions().basis(), relation.forces().basis());
        assert_eq!(r.cols() + f.cols(), relation.joints() + relation.object(), "{}", case.name);
        let work = &f.transpose() * &r;
        assert!(work.max_abs() < 1e-13, "{}: {work:?}", case.name);
        for basis in [&r, &f] {
            let rank = ColumnSpace::of(basis, Threshold::Relative(1e-9)).rank();
            assert_eq!(rank, basis.cols(), "{}", case.name);
        }
    }
}

/// The forces of the equilibrium of all bodies, `w = G t, tau = -J_a^T t, 0 = J_p^T t`, without
/// the forces at contacts, are the same space.
#[test]
fn forces_are_those_of_free_bodies() {
    for case in cases() {
        let constraint = case.constraint();
        let (a, d, t) = (constraint.actuated(), constraint.object(), constraint.rows());
        let p = constraint.passive();
        let m = constraint.matrix();
        // RowSelection: object, actuated joints, passive joints; unknowns (tau, w, t).
        let statics = Matrix::from_fn(d + a + p, a + d + t, |i, j| {
            let unit = |k: usize, l: usize| f64::from(u8::from(k == l));
            if i < d {
                // w - G t, and the columns of the object carry -G^T
                if j < a + d { unit(i + a, j) } else { m[(j - a - d, a + p + i)] }
            } else {
                let joint = i - d;
                if j < a {
                    unit(joint, j)
                } else if j < a + d {
                    0.0
                } else {
                    m[(j - a - d, joint)]
                }
            }
        });
        let kernel = ColumnSpace::of(&statics.transpose(), Threshold::Relative(1e-10)).complement();
        let projected = kernel.rows_between(0, a + d);
        let bodies = ColumnSpace::of(&projected, Threshold::Absolute(1e-9)).basis();
        let f = MotionSpace::of(&constraint).relation().forces().basis();
        assert_eq!(bodies.cols(), f.cols(), "{}", case.name);
        let both = Matrix::hstack(a + d, &[&bodies, &f]);
        let space = ColumnSpace::of(&both, Threshold::Relative(1e-9));
        assert_eq!(space.rank(), f.cols(), "{}", case.name);
    }
}

/// Motions satisfy the constraint.
#[test]
fn motions_keep_the_constraint() {
    for case in cases() {
        let constraint = case.constraint();
        let kept = &constraint.matrix() * &MotionSpace::of(&constraint).basis();
        assert!(kept.max_abs() < 1e-13, "{}: {kept:?}", case.name);
    }
}

/// The bases of the mobility report: orthonormal, motions that keep the constraint with the rows
/// at rest that should be, forces that do no work. That none is missing the counts say.
#[test]
fn bases_are_what_they_say() {
    for case in cases() {
        let constraint = case.constraint();
        let (a, p, m) = (constraint.actuated(), constraint.passive(), constraint.matrix());
        let n = a + p + constraint.object();
        let found = Mobility::of(&constraint);
        let zero = |what: &str, m: &Matrix| {
            assert!(m.max_abs() < 1e-12, "{what} of {}: {m:?}", case.name);
        };
        let (actuated, passive, object) = (0..a, a..a + p, a + p..n);
        for (what, space, still) in [
            ("dof", &found.dof, vec![]),
            ("redundancy", &found.redundancy, vec![&passive, &object]),
            ("indeterminacy", &found.indeterminacy, vec![&actuated]),
            ("idle", &found.idle, vec![&actuated, &object]),
            (
                "uncontrollable_object_motions",
                &found.uncontrollable_object_motions,
                vec![&actuated, &passive],
            ),
            ("coordinate", &found.coordinate, vec![]),
        ] {
            zero(what, &(&m * &space.basis));
            for rows in still {
                zero(what, &space.basis.rows_between(rows.start, rows.end));
            }
        }
        for other in [&found.redundancy, &found.indeterminacy] {
            zero("coordinate", &(&other.basis.transpose() * &found.coordinate.basis));
        }
        let all = &found.dof.basis;
        let (of_joints, of_object) = (all.rows_between(0, a), all.rows_between(a + p, n));
        zero("internal", &(&found.internal.basis.transpose() * &of_joints));
        zero("zero_torque", &(&found.zero_torque.basis.transpose() * &of_object));
        zero("hyperstatic", &(&m.transpose() * &found.hyperstatic.basis));
        for space in [
            &found.dof,
            &found.redundancy,
            &found.indeterminacy,
            &found.idle,
            &found.uncontrollable_object_motions,
            &found.coordinate,
            &found.internal,
            &found.zero_torque,
            &found.hyperstatic,
        ] {
            let gram = &space.basis.transpose() * &space.basis;
            assert!(gram.max_difference(&Matrix::identity(gram.rows())) < 1e-12, "{}", case.name);
        }
    }
}

/// Other joint coordinates for the passive joints, other combinations of the rows: no difference.
#[test]
fn relation_does_not_depend_on_bases() {
    let mut random = Random(72);
    for case in cases() {
        let constraint = case.constraint();
        let blocks = constraint.blocks();
        let regular = |random: &mut Random, n: usize| {
            let noise = random.matrix(n, n);
            Matrix::from_fn(n, n, |i, j| 0.2 * noise[(i, j)] + f64::from(u8::from(i == j)))
        };
        let rows = regular(&mut random, constraint.rows());
        let columns = regular(&mut random, constraint.passive());
        let mixed = Constraint::new(cylindroid::closure::ConstraintBlocks {
            actuated: &rows * &blocks.actuated,
            passive: &(&rows * &blocks.passive) * &columns,
            grasp: &blocks.grasp * &rows.transpose(),
        })
        .unwrap();
        let (one, two) =
            (MotionSpace::of(&constraint).relation(), MotionSpace::of(&mixed).relation());
        assert_eq!(one.dimensions(), two.dimensions(), "{}", case.name);
        for (p, q) in one.finite_pairs().iter().zip(two.finite_pairs()) {
            assert!((p.0 - q.0).abs() + (p.1 - q.1).abs() < 1e-11, "{}", case.name);
        }
    }
}

/// A Delta robot with real rods and one with idealised parallelograms, hyperstatic to the third
/// degree: one relation. So a Stewart platform with rods that spin and one without.
#[test]
fn drawings_of_one_mechanism_have_one_relation() {
    for (one, other) in [
        ("delta_6xUS_rods", "delta_3xRRPaR_hyperstatic"),
        ("stewart_6UPS_home", "stewart_6SPS_home"),
    ] {
        let basis = |name| MotionSpace::of(&case(name).constraint()).relation().motions().basis();
        let (one, other) = (basis(one), basis(other));
        let both = Matrix::hstack(one.rows(), &[&one, &other]);
        let space = ColumnSpace::of(&both, Threshold::Relative(1e-12));
        assert_eq!((space.rank(), one.cols()), (other.cols(), other.cols()));
    }
}
