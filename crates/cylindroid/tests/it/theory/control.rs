//! Errata K1 to K7 of docs/theory/control.md: course notes on Cartesian control.

use cylindroid::linalg::Svd;
use cylindroid::spatial::{Pose, Rotation, Rpy, Vec3};
use cylindroid::{Matrix, ReferenceFrame, catalogue, inverse};

use crate::support::{assert_close, assert_matrix};

fn rows(rows: &[&[f64]]) -> Matrix {
    Matrix::from_rows(rows).unwrap()
}

const TILT: f64 = std::f64::consts::FRAC_PI_3;

/// K1: the orientation error is the rotation vector in base axes, not the difference of angles.
#[test]
fn erratum_orientation_error_is_a_rotation_vector() {
    let roll = 0.01;
    let at = |roll| Rpy { roll, pitch: TILT, yaw: 0.0 }.rotation();
    let pose = |rotation| Pose { rotation, translation: Vec3::ZERO };
    let error = pose(at(0.0)).error_to(pose(at(roll))).angular;
    // The angles differ by (roll, 0, 0).
    let expected = [0.5 * roll, 0.0, -0.75_f64.sqrt() * roll];
    assert_close("error", &error.to_array(), &expected, 1e-15);
}

/// K3: the rate of change of angles is not the angular velocity.
#[test]
fn erratum_jacobian_of_angles_is_another_matrix() {
    let step = 1e-6;
    // Rotating about x at a pitch of 60 degrees: roll changes by 2, yaw by sqrt(3).
    let at = |x: f64| Rpy { roll: 2.0 * x, pitch: TILT, yaw: 3.0_f64.sqrt() * x }.rotation();
    let moved = (at(step) * at(-step).inverse()).log();
    assert_close("w", &(moved * (0.5 / step)).to_array(), &[1.0, 0.0, 0.0], 1e-10);
    let about_x = Rotation::exp(Vec3::X * step) * at(0.0);
    assert!(about_x.angle_to(at(step)) < 1e-10);
}

/// K2: the Jacobian in the axes of the end effector is the one in base axes, rotated.
#[test]
fn erratum_twist_is_rotated_into_the_end_effector() {
    let robot = catalogue::load("panda").unwrap();
    let q: Vec<f64> = robot.home().iter().map(|q| q + 0.2).collect();
    let state = robot.state(&q).unwrap();
    let base = state.jacobian(robot.tool(), ReferenceFrame::LocalWorldAligned).unwrap();
    let tool = state.jacobian(robot.tool(), ReferenceFrame::Local).unwrap();
    let r = state.pose(robot.tool()).unwrap().rotation.matrix().to_rows();
    // eRb is the transpose of the rotation of the tool seen from the base.
    let turn = Matrix::from_fn(6, 6, |i, j| if i / 3 == j / 3 { r[j % 3][i % 3] } else { 0.0 });
    assert_matrix("v_ee", &tool, &(&turn * &base), 1e-14);
    assert!(tool.max_difference(&(&turn.transpose() * &base)) > 0.1);
}

/// K4: singular values are no eigenvalues, and the last ones may be zero.
#[test]
fn erratum_singular_values_are_no_eigenvalues() {
    // Nilpotent: both eigenvalues are zero.
    let j = rows(&[&[0.0, 1.0], &[0.0, 0.0]]);
    assert_eq!((&j * &j).max_abs(), 0.0);
    let values: Vec<f64> = Svd::of(&j).values().collect();
    assert_close("singular values", &values, &[1.0, 0.0], 0.0);
}

/// K5: every value at or below the threshold is cut, not the smallest alone.
#[test]
fn erratum_every_small_value_is_cut() {
    let j = Matrix::diagonal(&[1.0, 1e-4, 1e-5]);
    let found = inverse::truncated(&j, 1e-3).unwrap();
    assert_matrix("J+", &found.matrix, &Matrix::diagonal(&[1.0, 0.0, 0.0]), 1e-15);
    assert_eq!((found.rank, found.dropped.len()), (1, 2));
    // On the threshold: cut, as in numpy.
    let j = Matrix::diagonal(&[1.0, 0.25]);
    assert_eq!(inverse::truncated(&j, 0.25).unwrap().rank, 1);
    assert_eq!(inverse::truncated(&j, 0.249).unwrap().rank, 2);
}

/// K6: J J+ = 1 needs full row rank, and that nothing was cut.
#[test]
fn erratum_full_rank_is_not_enough() {
    let product = |j: &Matrix| j * &inverse::truncated(j, 1e-3).unwrap().matrix;
    let tall = rows(&[&[1.0], &[1.0]]);
    assert_matrix("columns", &product(&tall), &rows(&[&[0.5, 0.5], &[0.5, 0.5]]), 1e-15);
    let weak = Matrix::diagonal(&[1.0, 1e-4]);
    assert_matrix("cut", &product(&weak), &Matrix::diagonal(&[1.0, 0.0]), 1e-15);
    let wide = rows(&[&[1.0, 1.0, 0.0], &[0.0, 1.0, 1.0]]);
    assert_matrix("rows", &product(&wide), &Matrix::identity(2), 1e-15);
}

/// K8: 1 - J+ J leads out of the null space where directions are cut or damped.
#[test]
fn erratum_null_space_of_a_truncated_inverse() {
    let j = rows(&[&[1.0, 0.0, 0.0], &[0.0, 0.01, 0.0]]);
    let leak = |inverse: &Matrix| {
        let mut left = &(&j * inverse) * &j;
        left.as_mut_slice().iter_mut().zip(j.as_slice()).for_each(|(x, y)| *x = y - *x);
        left
    };
    let truncated = inverse::truncated(&j, 0.1).unwrap().matrix;
    let expected = rows(&[&[0.0, 0.0, 0.0], &[0.0, 0.01, 0.0]]);
    assert_matrix("truncated", &leak(&truncated), &expected, 1e-15);
    // s l^2 / (s^2 + l^2), at most l / 2.
    let damped = inverse::damped(&j, 0.1).unwrap().matrix;
    let l2 = 0.01;
    let expected = rows(&[&[l2 / (1.0 + l2), 0.0, 0.0], &[0.0, 0.01 * l2 / (1e-4 + l2), 0.0]]);
    assert_matrix("damped", &leak(&damped), &expected, 1e-15);
    assert!(leak(&inverse::truncated(&j, 1e-12).unwrap().matrix).max_abs() < 1e-15);
}

/// K7: the same arm is close to a singularity in metres and far from any in millimetres.
#[test]
fn erratum_closeness_depends_on_the_unit() {
    let ratio = |unit: f64| {
        let found = inverse::truncated(&Matrix::diagonal(&[1e-3 * unit, 1.0]), 1e-2).unwrap();
        let values = &found.singular_values;
        (values[1] / values[0], found.rank)
    };
    assert_eq!((ratio(1.0), ratio(1e3)), ((1e-3, 1), (1.0, 2)));
}
