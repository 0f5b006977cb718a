//! Serial arms through the same code: the textbook ellipsoid.

use cylindroid::closure::{Constraint, MotionSpace};
use cylindroid::linalg::Svd;
use cylindroid::manipulability::{Manipulability, Metrics, Spectrum};
use cylindroid::{Matrix, ReferenceFrame, catalogue};

use crate::support::{Random, assert_close, assert_matrix};

fn of(jacobian: &Matrix) -> Manipulability {
    let relation = MotionSpace::of(&Constraint::serial(jacobian).unwrap()).relation();
    Manipulability::of(&relation, &Metrics::UNIT).unwrap()
}

fn gram(axes: &Matrix) -> Matrix {
    axes * &axes.transpose()
}

/// Efficiencies are squared singular values, the semi-axes those of `J J^T`, redundant motions the
/// kernel.
#[test]
fn arms_of_the_catalogue() {
    let mut random = Random(84);
    for name in ["panda", "ur5e", "youbot"] {
        let robot = catalogue::load(name).unwrap();
        for _ in 0..20 {
            let state = robot.state(&random.q(&robot)).unwrap();
            let j = state.jacobian(robot.tool(), ReferenceFrame::LocalWorldAligned).unwrap();
            let svd = Svd::of(&j);
            let m = of(&j);
            let rank = j.rows().min(j.cols());
            let squares: Vec<f64> = svd.values().map(|s| s * s).collect();
            assert_close(name, &m.kinematic.values(), &squares, 1e-13 * squares[0]);
            let axes = m.kinematic.semi_axes();
            assert_matrix("axes", &gram(&axes), &gram(&j), 1e-12 * squares[0]);
            assert_eq!(m.kinematic.zeros.cols(), j.cols() - rank);
            assert!((&j * &m.kinematic.zeros).max_abs() < 1e-13);
            let volume: f64 = svd.values().product();
            assert!((m.kinematic.volume() / volume - 1.0).abs() < 1e-10);
            let condition = (svd.value(0) / svd.value(rank - 1)).powi(2);
            assert!((m.kinematic.anisotropy().unwrap() / condition - 1.0).abs() < 1e-8);
            // Forces: w = J^-T tau, and the resistance of the structure for an arm of five joints.
            let inverse: Vec<f64> = m.kinematic.values().iter().rev().map(|e| 1.0 / e).collect();
            let ratio: Vec<f64> =
                m.force.values().iter().zip(&inverse).map(|(f, e)| f / e).collect();
            assert_close("forces", &ratio, &vec![1.0; rank], 1e-9);
            assert_eq!(m.force.infinite.cols(), 6 - rank);
        }
    }
}

/// At a singularity the lost direction has efficiency zero no longer as a number, but as a kind.
#[test]
fn singular_arm() {
    // Two links stretched along x.
    let m = of(&Matrix::from_rows(&[[0.0, 0.0], [2.0, 1.0]]).unwrap());
    assert_close("values", &m.kinematic.values(), &[5.0], 1e-14);
    assert_eq!((m.kinematic.zeros.cols(), m.kinematic.infinite.cols()), (1, 0));
    assert_eq!((m.force.zeros.cols(), m.force.infinite.cols()), (0, 1));
    let resisted = m.force.infinite.column(0);
    assert_close("resisted", &[resisted[0].abs(), resisted[1]], &[1.0, 0.0], 1e-15);
}

#[test]
fn nothing_at_all() {
    let check = |s: &Spectrum| {
        assert_eq!((s.values().len(), s.largest(), s.anisotropy()), (0, None, None));
    };
    let m = of(&Matrix::zeros(3, 2));
    check(&m.kinematic);
    check(&m.force);
    assert_eq!((m.kinematic.zeros.cols(), m.force.infinite.cols()), (2, 3));
    for (d, n) in [(0, 2), (3, 0), (0, 0)] {
        let m = of(&Matrix::zeros(d, n));
        check(&m.kinematic);
        assert_eq!((m.kinematic.zeros.cols(), m.force.infinite.cols()), (n, d));
    }
}

/// Two links nearly stretched by an angle a: the smaller efficiency goes as a^2 down to where the
/// direction counts as lost, and on the other side of that it is a zero by kind.
#[test]
fn both_sides_of_the_switch() {
    let arm = |a: f64| {
        let (s, c) = a.sin_cos();
        of(&Matrix::from_rows(&[[-s, -s], [1.0 + c, c]]).unwrap())
    };
    for a in [1e-2, 1e-4, 1e-6, 1e-8] {
        let m = arm(a);
        assert_eq!(m.kinematic.finite.len(), 2, "{a}");
        // det J = sin a, so the product of efficiencies is its square.
        let product: f64 = m.kinematic.values().iter().product();
        assert!((product / a.sin().powi(2) - 1.0).abs() < 1e-7, "{a}: {product}");
    }
    let m = arm(1e-10);
    assert_eq!((m.kinematic.finite.len(), m.kinematic.zeros.cols()), (1, 1));
    assert_eq!((m.force.finite.len(), m.force.infinite.cols()), (1, 1));
}
