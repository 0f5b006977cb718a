//! Projections and sections of the ellipsoids of motion and force, against relations in which the
//! other components are free or blocked, and against the support function.

use cylindroid::closure::{Constraint, MotionSpace, Relation};
use cylindroid::linalg::Svd;
use cylindroid::manipulability::{Ellipsoid, EllipsoidView, Manipulability, Metrics, Spectrum};
use cylindroid::{Matrix, catalogue};

use crate::closure::case::cases;
use crate::support::{Random, assert_close, assert_matrix};

fn of(relation: &Relation) -> Manipulability {
    Manipulability::of(relation, &Metrics::UNIT).unwrap()
}

fn selection(components: &[usize], d: usize) -> Matrix {
    Matrix::from_fn(components.len(), d, |i, j| f64::from(u8::from(components[i] == j)))
}

/// A A^T and the projector on the span of B, which do not depend on signs and on equal axes.
fn squares(e: &Ellipsoid) -> (Matrix, Matrix) {
    let square = |a: &Matrix| a * &a.transpose();
    (square(&e.semi_axes), square(&e.unbounded))
}

#[track_caller]
fn assert_same(what: &str, got: &Ellipsoid, expected: &Ellipsoid) {
    let ((a, b), (c, d)) = (squares(got), squares(expected));
    assert_eq!(got.semi_axes.cols(), expected.semi_axes.cols(), "{what}");
    assert_eq!(got.unbounded.cols(), expected.unbounded.cols(), "{what}");
    assert_matrix(what, &a, &c, 1e-9 * c.max_abs().max(1e-300));
    assert_matrix(what, &b, &d, 1e-9);
}

fn choices(d: usize) -> Vec<Vec<usize>> {
    match d {
        3 => vec![vec![0, 1], vec![0], vec![2], vec![2, 0], vec![0, 1, 2]],
        _ => vec![vec![0, 1], vec![1, 2], vec![0, 1, 2], vec![3, 4, 5], vec![5, 0]],
    }
}

/// The projection of the velocities is that of the task whose other components are free; their
/// section that of the motions which a guide permits; for wrenches it is the other way round. In
/// the plane and in space, with passive joints, structural wrenches and redundancy.
#[test]
fn views_are_relations_with_free_and_blocked_components() {
    let mut seen = [0; 4];
    for case in cases() {
        let relation = MotionSpace::of(&case.problem().constraint).relation();
        let all = of(&relation);
        let (velocity, force) = (Ellipsoid::of(&all.kinematic), Ellipsoid::of(&all.force));
        for components in choices(relation.object()) {
            let what = format!("{} {components:?}", case.name);
            let free = of(&relation.task(&selection(&components, relation.object())).unwrap());
            let blocked = of(&relation.section(&components).unwrap());
            let views = [
                (velocity.projection(&components), &free.kinematic),
                (velocity.section(&components), &blocked.kinematic),
                (force.projection(&components), &blocked.force),
                (force.section(&components), &free.force),
            ];
            for (i, (got, expected)) in views.into_iter().enumerate() {
                let expected = Ellipsoid::of(expected);
                assert_same(&format!("{i} of {what}"), &got.unwrap(), &expected);
                seen[i] += expected.unbounded.cols();
            }
        }
    }
    assert!(seen.iter().all(|n| *n > 0), "{seen:?}");
}

/// For arms: the projection has the semi-axes of the rows of the Jacobian, and the section those of
/// the rows times the kernel of the others.
#[test]
fn of_random_jacobians() {
    let mut random = Random(1717);
    for _ in 0..40 {
        let jacobian = Matrix::from_fn(6, 7, |_, _| random.within(-1.0, 1.0));
        let e = Ellipsoid::of(
            &of(&MotionSpace::of(&Constraint::serial(&jacobian).unwrap()).relation()).kinematic,
        );
        let axes = |e: &Ellipsoid| -> Vec<f64> {
            (0..e.semi_axes.cols())
                .map(|j| e.semi_axes.column(j).iter().map(|x| x * x).sum::<f64>().sqrt())
                .collect()
        };
        let rows = jacobian.rows_between(0, 3);
        let values: Vec<f64> = Svd::of(&rows).values().collect();
        assert_close("projection", &axes(&e.projection(&[0, 1, 2]).unwrap()), &values, 1e-12);
        // (J J^T)^-1 restricted to the rows: the section's inverse square.
        let square = &jacobian * &jacobian.transpose();
        let svd = Svd::of(&square);
        let inverse = Matrix::from_fn(6, 6, |i, j| {
            (0..6).map(|l| svd.v(l)[i] * svd.u(l)[j] / svd.value(l)).sum()
        });
        let cut = Svd::of(&inverse.rows_between(0, 3).columns_between(0, 3));
        let values: Vec<f64> = cut.values().map(|l| l.recip().sqrt()).collect();
        let mut got = axes(&e.section(&[0, 1, 2]).unwrap());
        got.reverse();
        assert_close("section", &got, &values, 1e-8 * values[2].max(1.0));
    }
}

/// Semi-axes are orthogonal and across the unbounded directions, whatever the metric.
#[test]
fn axes_are_principal_in_any_metric() {
    let mechanism = catalogue::load("five-bar").unwrap();
    let chain = cylindroid::closure::ClosedChain::of(
        &mechanism.state(mechanism.home()).unwrap(),
        None,
        None,
    )
    .unwrap();
    let relation = MotionSpace::of(&chain.constraint).relation();
    let metrics = Metrics::UNIT.with_object(&Matrix::diagonal(&[9.0, 1.0, 0.1])).unwrap();
    let m = Manipulability::of(&relation, &metrics).unwrap();
    let plain = of(&relation);
    for (weighted, unit) in [(&m.kinematic, &plain.kinematic), (&m.force, &plain.force)] {
        let (a, b) = (Ellipsoid::of(weighted), Ellipsoid::of(unit));
        assert_same("the set does not depend on the metric of outputs", &a, &b);
        let gram = &a.semi_axes.transpose() * &a.semi_axes;
        assert!((0..gram.cols()).all(|i| (0..i).all(|j| gram[(i, j)].abs() < 1e-12)));
        assert!((&a.semi_axes.transpose() * &a.unbounded).max_abs() < 1e-12);
    }
}

/// The five-bar of the book with its own numbers: 6.83 and 1.17 are the whole twist's, 2.29 and
/// 0.87 m/s the projection's; with the rotation blocked one motion is left.
#[test]
fn five_bar() {
    let mechanism = catalogue::load("five-bar").unwrap();
    let state = mechanism.state(mechanism.home()).unwrap();
    let chain = cylindroid::closure::ClosedChain::of(&state, None, None).unwrap();
    let m = of(&MotionSpace::of(&chain.constraint).relation());
    let sizes = |spectrum: &Spectrum, view| {
        let e = Ellipsoid::of(spectrum).seen(view, &[0, 1]).unwrap();
        (0..e.semi_axes.cols())
            .map(|j| e.semi_axes[(0, j)].hypot(e.semi_axes[(1, j)]))
            .collect::<Vec<_>>()
    };
    // From J = [-2 -1; ...] in closed form: see the page on manipulability.
    let root = 5_f64.sqrt();
    let projection = [(3.0 + root).sqrt(), (3.0 - root).sqrt()];
    assert_close("projection", &sizes(&m.kinematic, EllipsoidView::Projection), &projection, 1e-12);
    assert_eq!(sizes(&m.kinematic, EllipsoidView::Section).len(), 1);
    let dual: Vec<f64> = projection.iter().rev().map(|x| x.recip()).collect();
    assert_close("dual", &sizes(&m.force, EllipsoidView::Section), &dual, 1e-12);
}

#[test]
fn components_are_checked() {
    let m = of(&MotionSpace::of(&Constraint::serial(&Matrix::identity(3)).unwrap()).relation());
    let e = Ellipsoid::of(&m.kinematic);
    for wrong in [&[][..], &[3], &[0, 0]] {
        assert!(e.projection(wrong).is_err() && e.section(wrong).is_err());
    }
}
