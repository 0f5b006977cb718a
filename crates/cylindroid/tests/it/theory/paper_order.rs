//! Twists as the papers write them, angular first, and what is made of them.

use cylindroid::Matrix;
use cylindroid::linalg::Svd;
use cylindroid::screws::{Line, Screw, ScrewOptions, ScrewSystem};
use cylindroid::spatial::{Twist, Vec3};

/// A twist in the order of the paper.
pub(super) fn twist(s: [f64; 6]) -> Twist {
    let [wx, wy, wz, vx, vy, vz] = s;
    Twist { linear: Vec3::new(vx, vy, vz), angular: Vec3::new(wx, wy, wz) }
}

/// The columns, linear first.
pub(super) fn columns(twists: &[[f64; 6]]) -> Matrix {
    Matrix::from_fn(6, twists.len(), |i, j| twist(twists[j]).to_array()[i])
}

pub(super) fn lines(twists: &[[f64; 6]]) -> Vec<Line> {
    twists
        .iter()
        .map(|s| {
            assert_eq!(twist(*s).klein(twist(*s)), 0.0, "no line: {s:?}");
            Screw::of(twist(*s)).unwrap().axis
        })
        .collect()
}

pub(super) fn system(twists: &[[f64; 6]]) -> ScrewSystem {
    ScrewSystem::of_columns(&columns(twists), &ScrewOptions::default()).unwrap()
}

pub(super) fn rank(m: &Matrix) -> usize {
    Svd::of(m).machine_rank().rank
}
