//! The gap between a finger and a moving object, to second order.
//!
//! Formula  object displaced by exp(t u), u = (v, w) at the contact, n into the object, v_t the
//!          tangential velocity, s = n x w the tilt of the object's surface:
//!          d' = n . v,  d'' = v_t^T K_f C K_o v_t + v_t^T (K_o - K_f) C s - s^T C s,
//!          C = (K_f + K_o)^-1: the stationary distance of the paraboloids of both bodies
//! Shapes   gradient: d, form: d x d (d = 6, or 3 in the plane)
//! Units    lengths over `length`, curvatures times it
//! Frame    twist of the object at `about`, world axes
//! Valid    any curvatures with a positive definite sum. For sharp points and edges K is infinite:
//!          each body is a pair (D, N) with K = N D^-1, and the common tangent plane follows from
//!          D_f r = D_o s' + v_t, N_f r + N_o s' + s = 0, regular also then
//! Why so   the paraboloids determine the second order of the distance exactly, since the slopes
//!          are of first order in t and the gap of second order
//! Source   Rimon & Burdick 1998, part I (second derivatives of the distance in configuration space)
//! Checked  tests/it/closure/grasp_mobility/mod.rs::gaps_*

use super::force_closure::{FingerContact, WrenchSpace};
use crate::linalg::{Matrix, Qr, dot};
use crate::model::{Dimension, SurfaceCurvature};
use crate::spatial::Vec3;

/// First and second derivative of a gap along the twists of the object.
#[derive(Debug, Clone)]
pub(super) struct ContactGap {
    pub(super) gradient: Vec<f64>,
    pub(super) form: Matrix,
}

impl ContactGap {
    /// Of a checked contact; none if the curvatures are not those of a point contact.
    pub(super) fn of(contact: &FingerContact, space: WrenchSpace) -> Option<Self> {
        let WrenchSpace { point: about, length, planar } = space;
        let FingerContact { point, normal, curvature, .. } = *contact;
        let arm = (point - about) * (1.0 / length);
        let components = if planar { Dimension::Planar } else { Dimension::Spatial }.components();
        let row = |linear: Vec3, angular: Vec3| -> Vec<f64> {
            let [a, b] = [linear.to_array(), angular.to_array()];
            components.iter().map(|&c| if c < 3 { a[c] } else { b[c - 3] }).collect()
        };
        let tangents: Vec<Vec3> =
            SurfaceCurvature::FLAT.along(normal, planar)?.iter().map(|(t, _)| *t).collect();
        let n = tangents.len();
        let velocities = tangents.iter().map(|&t| row(t, arm.cross(t)));
        let tilts = tangents.iter().map(|&t| row(Vec3::ZERO, t.cross(normal)));
        let rows: Vec<Vec<f64>> = velocities.chain(tilts).collect();
        let motions = Matrix::from_rows(&rows)?;
        let local = |surface: SurfaceCurvature| surface_pair(surface, normal, space, &tangents);
        let form = second_order(&local(curvature.finger)?, &local(curvature.object)?, n);
        Some(Self {
            gradient: row(normal, arm.cross(normal)),
            form: &(&motions.transpose() * &form) * &motions,
        })
    }

    /// The second derivative along a twist.
    pub(super) fn second(&self, twist: &[f64]) -> f64 {
        dot(&self.form.mul_vec(twist), twist)
    }
}

/// D and N of a surface in the basis of the tangents: positions D r have slopes N r.
type SurfacePair = [Matrix; 2];

fn surface_pair(
    surface: SurfaceCurvature,
    normal: Vec3,
    space: WrenchSpace,
    tangents: &[Vec3],
) -> Option<SurfacePair> {
    let n = tangents.len();
    let principal = surface.along(normal, space.planar)?;
    let part = |of: fn(f64) -> f64| {
        Matrix::from_fn(n, n, |i, j| {
            let each = principal.iter().map(|(direction, k)| {
                of(k * space.length) * direction.dot(tangents[i]) * direction.dot(tangents[j])
            });
            each.sum()
        })
    };
    let position = |k: f64| if k.is_infinite() { 0.0 } else { 1.0 / k.hypot(1.0) };
    let slope = |k: f64| if k.is_infinite() { 1.0 } else { k / k.hypot(1.0) };
    Some([part(position), part(slope)])
}

/// The form of d'' in (v_t, s).
fn second_order(finger: &SurfacePair, object: &SurfacePair, n: usize) -> Matrix {
    let ([finger_d, finger_n], [object_d, object_n]) = (finger, object);
    let sign = |a: &Matrix, s: f64| Matrix::from_fn(n, n, |i, j| s * a[(i, j)]);
    let top = Matrix::hstack(n, &[finger_d, &sign(object_d, -1.0)]);
    let bottom = Matrix::hstack(n, &[finger_n, object_n]);
    let inputs: Vec<f64> = (0..2 * n).map(|i| if i < n { 1.0 } else { -1.0 }).collect();
    let touching = Qr::plain(Matrix::vstack(2 * n, &[&top, &bottom]));
    let found = touching.solve(Matrix::diagonal(&inputs));
    let (r, s) = (found.rows_between(0, n), found.rows_between(n, 2 * n));
    let pulled = |x: &Matrix, a: &Matrix, b: &Matrix| &(&x.transpose() * &(a * b)) * x;
    let (object_own, finger_own) = (pulled(&s, object_d, object_n), pulled(&r, finger_d, finger_n));
    let inner = |i: usize, j: usize| object_own[(i, j)] + finger_own[(i, j)];
    // 2 tilt . D_o s + tilt . v_t, symmetric.
    let position = object_d * &s;
    let mixed = Matrix::from_fn(2 * n, 2 * n, |i, j| {
        if i < n {
            return 0.0;
        }
        let velocity = if j == i - n { 1.0 } else { 0.0 };
        2.0 * position[(i - n, j)] + velocity
    });
    Matrix::from_fn(2 * n, 2 * n, |i, j| {
        0.5 * (inner(i, j) + inner(j, i) + mixed[(i, j)] + mixed[(j, i)])
    })
}
