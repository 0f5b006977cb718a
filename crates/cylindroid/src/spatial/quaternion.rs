//! Unit quaternions, and the quaternion of a rotation matrix.
//!
//! Formula  Shepperd's method: the component of largest square first; sign such that w >= 0
//! Valid    any rotation matrix, also at half turns, where w = 0
//! Source   Shepperd 1978
//! Checked  tests/it/spatial.rs::angles_*, tests/it/spatial.rs

use super::vec3::Mat3;

/// A unit quaternion `w + x i + y j + z k`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quaternion {
    /// Real part.
    pub w: f64,
    /// First imaginary part.
    pub x: f64,
    /// Second imaginary part.
    pub y: f64,
    /// Third imaginary part.
    pub z: f64,
}

impl Quaternion {
    /// The quaternion of a rotation matrix, `w >= 0`; with `w = 0` the first imaginary part that
    /// is not zero is positive.
    pub(crate) fn of_matrix(m: Mat3) -> Self {
        let Self { w, x, y, z } = Self::multiple_of_matrix(m);
        // The largest is between 1 and 4: squares neither overflow nor matter where they vanish.
        let scale = 1.0 / (w * w + x * x + y * y + z * z).sqrt();
        Self { w: w * scale, x: x * scale, y: y * scale, z: z * scale }
    }

    /// The same before it has length one: between 1 and 4 times as long.
    pub(crate) fn multiple_of_matrix(m: Mat3) -> Self {
        let [a, b, c] = m.cols;
        // Four times the squared components; the largest is at least 1.
        let squares = [
            1.0 + a.x + b.y + c.z,
            1.0 + a.x - b.y - c.z,
            1.0 - a.x + b.y - c.z,
            1.0 - a.x - b.y + c.z,
        ];
        let largest = (1..4).fold(0, |l, i| if squares[i] > squares[l] { i } else { l });
        let (yz, zx, xy) = (b.z - c.y, c.x - a.z, a.y - b.x); // 4 w (x, y, z)
        let (pyz, pzx, pxy) = (b.z + c.y, c.x + a.z, a.y + b.x); // 4 (yz, zx, xy)
        let s = squares[largest];
        let (w, x, y, z) = match largest {
            0 => (s, yz, zx, xy),
            1 => (yz, s, pxy, pzx),
            2 => (zx, pxy, s, pyz),
            _ => (xy, pzx, pyz, s),
        };
        let sign = [w, x, y, z].into_iter().find(|v| *v != 0.0).map_or(1.0, f64::signum);
        Self { w: w * sign, x: x * sign, y: y * sign, z: z * sign }
    }
}
