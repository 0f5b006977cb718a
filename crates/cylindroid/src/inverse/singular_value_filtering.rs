//! Singular value filtering: a smooth function in place of each singular value.
//!
//! Formula  f(s) = (s^3 + nu s^2 + 2 s + 2 s_0) / (s^2 + nu s + 2), gain_i = 1 / f(s_i)
//! Shapes   m x n -> n x m          Units  s_0 in the unit of the singular values, nu [-]
//! Valid    any rank; f(0) = s_0, f(s) -> s for large s, so gains are at most about 1 / s_0.
//!          A direction whose singular value is zero up to rounding has undetermined joint
//!          velocities: its gain is zero.
//! Why so   bounded and smooth without a threshold
//! Source   Colome & Torras 2015, eq. 14
//! Checked  tests/it/inverse.rs::filtered_*

use crate::linalg::Svd;

pub(super) fn gains(svd: &Svd, shape: f64, floor: f64, out: &mut [f64]) -> f64 {
    let rank = svd.machine_rank().rank;
    for (i, (gain, s)) in out.iter_mut().zip(svd.values()).enumerate() {
        // The rational function with its whole part s taken out: nothing but the rest can overflow.
        let filtered = s + 2.0 * floor / (s * (s + shape) + 2.0);
        *gain = if i < rank { 1.0 / filtered } else { 0.0 };
    }
    half_realised(shape, floor)
}

/// The singular value of which half is realised, f(s) = 2 s: the root of s^3 + nu s^2 + 2 s = 2
/// s_0. Newton's method from above; the left side is convex, so it falls to the root.
fn half_realised(shape: f64, floor: f64) -> f64 {
    let mut s = floor;
    for _ in 0..100 {
        // Divided by s^2 + nu s + 2, which neither overflows nor vanishes.
        let q = s * (s + shape) + 2.0;
        let next = s - (s - 2.0 * (floor / q)) / (1.0 + s * (2.0 * s + shape) / q);
        if !(next < s) {
            break;
        }
        s = next;
    }
    s
}
