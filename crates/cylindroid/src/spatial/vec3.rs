//! Vectors of three components and 3 x 3 matrices.
//!
//! Checked  tests/it/spatial.rs

use std::ops::{Add, AddAssign, Index, Mul, Neg, Sub, SubAssign};

/// A vector of three components: a point, a direction, a velocity. Its axes are those in the name
/// of the variable.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Vec3 {
    /// First component.
    pub x: f64,
    /// Second component.
    pub y: f64,
    /// Third component.
    pub z: f64,
}

impl Vec3 {
    /// (0, 0, 0)
    pub const ZERO: Self = Self::new(0.0, 0.0, 0.0);
    /// (1, 0, 0)
    pub const X: Self = Self::new(1.0, 0.0, 0.0);
    /// (0, 1, 0)
    pub const Y: Self = Self::new(0.0, 1.0, 0.0);
    /// (0, 0, 1)
    pub const Z: Self = Self::new(0.0, 0.0, 1.0);

    /// The vector (x, y, z).
    #[must_use]
    pub const fn new(x: f64, y: f64, z: f64) -> Self {
        Self { x, y, z }
    }

    /// The vector of these three numbers.
    #[must_use]
    pub const fn from_array([x, y, z]: [f64; 3]) -> Self {
        Self { x, y, z }
    }

    /// The three numbers.
    #[must_use]
    pub const fn to_array(self) -> [f64; 3] {
        [self.x, self.y, self.z]
    }

    /// Scalar product.
    #[must_use]
    #[inline]
    pub fn dot(self, other: Self) -> f64 {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// Vector product.
    #[must_use]
    #[inline]
    pub fn cross(self, other: Self) -> Self {
        Self::new(
            self.y * other.z - self.z * other.y,
            self.z * other.x - self.x * other.z,
            self.x * other.y - self.y * other.x,
        )
    }

    /// Length, without overflow.
    #[must_use]
    pub fn norm(self) -> f64 {
        let square = self.dot(self);
        // Where squares neither overflow nor lose digits, the root of their sum is ten times
        // faster.
        if (1e-280..1e280).contains(&square) {
            return square.sqrt();
        }
        self.x.hypot(self.y).hypot(self.z)
    }

    /// The unit vector of this direction; `None` if shorter than `shortest` or not finite.
    ///
    /// ```
    /// use cylindroid::Vec3;
    ///
    /// assert_eq!(Vec3::new(3.0, 0.0, 4.0).unit(0.0), Some(Vec3::new(0.6, 0.0, 0.8)));
    /// assert_eq!(Vec3::ZERO.unit(0.0), None);
    /// ```
    #[must_use]
    pub fn unit(self, shortest: f64) -> Option<Self> {
        let norm = self.norm();
        if !(norm > shortest && norm.is_finite()) {
            return None;
        }
        // Too short for its inverse, and for the digits of its components: made longer first.
        if norm < f64::MIN_POSITIVE {
            return (self * 2.0_f64.powi(600)).unit(0.0);
        }
        Some(Self::new(self.x / norm, self.y / norm, self.z / norm))
    }

    /// True if no component is NaN or infinite.
    #[must_use]
    pub fn is_finite(self) -> bool {
        0.0 * self.x + 0.0 * self.y + 0.0 * self.z == 0.0
    }
}

impl Add for Vec3 {
    type Output = Self;
    #[inline]
    fn add(self, o: Self) -> Self {
        Self::new(self.x + o.x, self.y + o.y, self.z + o.z)
    }
}

impl AddAssign for Vec3 {
    #[inline]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl Sub for Vec3 {
    type Output = Self;
    #[inline]
    fn sub(self, o: Self) -> Self {
        Self::new(self.x - o.x, self.y - o.y, self.z - o.z)
    }
}

impl SubAssign for Vec3 {
    #[inline]
    fn sub_assign(&mut self, o: Self) {
        *self = *self - o;
    }
}

impl Neg for Vec3 {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}

impl Mul<f64> for Vec3 {
    type Output = Self;
    #[inline]
    fn mul(self, s: f64) -> Self {
        Self::new(self.x * s, self.y * s, self.z * s)
    }
}

impl Index<usize> for Vec3 {
    type Output = f64;
    /// # Panics
    /// If `i > 2`.
    #[inline]
    #[allow(clippy::panic)] // the contract of Index
    fn index(&self, i: usize) -> &f64 {
        match i {
            0 => &self.x,
            1 => &self.y,
            2 => &self.z,
            _ => panic!("a Vec3 has no component {i}"),
        }
    }
}

/// A 3 x 3 matrix, stored by columns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mat3 {
    /// The images of the unit vectors.
    pub cols: [Vec3; 3],
}

impl Mat3 {
    /// The identity.
    pub const IDENTITY: Self = Self { cols: [Vec3::X, Vec3::Y, Vec3::Z] };
    /// The zero matrix.
    pub const ZERO: Self = Self { cols: [Vec3::ZERO; 3] };

    /// The matrix with these columns.
    #[must_use]
    pub const fn from_cols(a: Vec3, b: Vec3, c: Vec3) -> Self {
        Self { cols: [a, b, c] }
    }

    /// The matrix with these rows.
    #[must_use]
    pub fn from_rows(r: [[f64; 3]; 3]) -> Self {
        Self::from_cols(
            Vec3::new(r[0][0], r[1][0], r[2][0]),
            Vec3::new(r[0][1], r[1][1], r[2][1]),
            Vec3::new(r[0][2], r[1][2], r[2][2]),
        )
    }

    /// The rows.
    #[must_use]
    pub fn to_rows(self) -> [[f64; 3]; 3] {
        let t = self.transpose().cols;
        [t[0].to_array(), t[1].to_array(), t[2].to_array()]
    }

    /// The matrix of the vector product: `skew(a) b = a x b`.
    ///
    /// ```
    /// use cylindroid::Vec3;
    /// use cylindroid::spatial::Mat3;
    ///
    /// assert_eq!(Mat3::skew(Vec3::X) * Vec3::Y, Vec3::X.cross(Vec3::Y));
    /// ```
    #[doc(alias = "cross product matrix")]
    #[doc(alias = "hat")]
    #[must_use]
    pub fn skew(a: Vec3) -> Self {
        Self::from_cols(
            Vec3::new(0.0, a.z, -a.y),
            Vec3::new(-a.z, 0.0, a.x),
            Vec3::new(a.y, -a.x, 0.0),
        )
    }

    /// The transpose.
    #[must_use]
    pub fn transpose(self) -> Self {
        let [a, b, c] = self.cols;
        Self::from_cols(
            Vec3::new(a.x, b.x, c.x),
            Vec3::new(a.y, b.y, c.y),
            Vec3::new(a.z, b.z, c.z),
        )
    }

    /// The determinant.
    #[must_use]
    pub fn determinant(self) -> f64 {
        let [a, b, c] = self.cols;
        a.dot(b.cross(c))
    }

    /// `self^T v`, without forming the transpose.
    #[must_use]
    #[inline]
    pub fn tr_mul(self, v: Vec3) -> Vec3 {
        Vec3::new(self.cols[0].dot(v), self.cols[1].dot(v), self.cols[2].dot(v))
    }

    /// Largest absolute entry.
    #[must_use]
    pub fn max_abs(self) -> f64 {
        self.cols.iter().flat_map(|c| c.to_array()).fold(0.0, |m: f64, x| m.max(x.abs()))
    }

    /// True if no entry is NaN or infinite.
    #[must_use]
    pub fn is_finite(self) -> bool {
        self.cols.iter().all(|c| c.is_finite())
    }
}

impl Mul<Vec3> for Mat3 {
    type Output = Vec3;
    #[inline]
    fn mul(self, v: Vec3) -> Vec3 {
        let [a, b, c] = self.cols;
        Vec3::new(
            a.x * v.x + b.x * v.y + c.x * v.z,
            a.y * v.x + b.y * v.y + c.y * v.z,
            a.z * v.x + b.z * v.y + c.z * v.z,
        )
    }
}

impl Mul for Mat3 {
    type Output = Self;
    #[inline]
    fn mul(self, o: Self) -> Self {
        Self { cols: o.cols.map(|c| self * c) }
    }
}

impl Mul<f64> for Mat3 {
    type Output = Self;
    fn mul(self, s: f64) -> Self {
        Self { cols: self.cols.map(|c| c * s) }
    }
}

impl Add for Mat3 {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        let ([a, b, c], [d, e, f]) = (self.cols, o.cols);
        Self::from_cols(a + d, b + e, c + f)
    }
}

impl Sub for Mat3 {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        self + o * -1.0
    }
}
