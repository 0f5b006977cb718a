//! Twists and wrenches: velocities of a rigid body and forces on it.
//!
//! As vectors both have the linear part first: `[v; w]` and `[f; m]`. Only `to_array` and
//! `from_array` depend on it. Power is their only product.
//!
//! Checked  tests/it/spatial.rs::power_is_invariant, tests/it/spatial.rs::adjoint_*

use std::ops::{Add, Mul, Neg, Sub};

use super::vec3::Vec3;

/// The velocity of a rigid body: that of the point at the frame's origin, and its rotation.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Twist {
    /// Velocity of the body's point at the origin of the frame [m/s].
    pub linear: Vec3,
    /// Angular velocity [rad/s].
    pub angular: Vec3,
}

/// The force on a rigid body: its resultant and its moment about the frame's origin.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Wrench {
    /// Force (N).
    pub force: Vec3,
    /// Moment about the origin of the frame [N m].
    pub moment: Vec3,
}

macro_rules! linear_space {
    ($type:ident, $a:ident, $b:ident) => {
        impl $type {
            /// Zero.
            pub const ZERO: Self = Self { $a: Vec3::ZERO, $b: Vec3::ZERO };

            /// From six numbers, linear part first.
            #[must_use]
            pub const fn from_array(v: [f64; 6]) -> Self {
                Self { $a: Vec3::new(v[0], v[1], v[2]), $b: Vec3::new(v[3], v[4], v[5]) }
            }

            /// Six numbers, linear part first.
            #[must_use]
            pub const fn to_array(self) -> [f64; 6] {
                [self.$a.x, self.$a.y, self.$a.z, self.$b.x, self.$b.y, self.$b.z]
            }

            /// True if no component is NaN or infinite.
            #[must_use]
            pub fn is_finite(self) -> bool {
                self.$a.is_finite() && self.$b.is_finite()
            }
        }

        impl Add for $type {
            type Output = Self;
            #[inline]
            fn add(self, o: Self) -> Self {
                Self { $a: self.$a + o.$a, $b: self.$b + o.$b }
            }
        }

        impl Sub for $type {
            type Output = Self;
            #[inline]
            fn sub(self, o: Self) -> Self {
                Self { $a: self.$a - o.$a, $b: self.$b - o.$b }
            }
        }

        impl Neg for $type {
            type Output = Self;
            fn neg(self) -> Self {
                Self { $a: -self.$a, $b: -self.$b }
            }
        }

        impl Mul<f64> for $type {
            type Output = Self;
            #[inline]
            fn mul(self, s: f64) -> Self {
                Self { $a: self.$a * s, $b: self.$b * s }
            }
        }
    };
}

linear_space!(Twist, linear, angular);
linear_space!(Wrench, force, moment);

impl Twist {
    /// Power of a wrench on a body that moves with this twist, both in one frame (W).
    ///
    /// ```
    /// use cylindroid::{Twist, Vec3, Wrench};
    ///
    /// let twist = Twist { linear: Vec3::X * 0.5, angular: Vec3::Z };
    /// let wrench = Wrench { force: Vec3::X * 10.0, moment: Vec3::Z * 2.0 };
    /// assert_eq!(twist.power(wrench), 7.0); // W
    /// ```
    #[must_use]
    pub fn power(self, wrench: Wrench) -> f64 {
        self.linear.dot(wrench.force) + self.angular.dot(wrench.moment)
    }

    /// The Lie bracket `ad(self) other`: the rate of `other`, fixed in a body that moves with
    /// `self`, both in one frame.
    ///
    /// ```
    /// use cylindroid::{Twist, Vec3};
    ///
    /// // A rotation about z carries the x axis of a body towards y.
    /// let axis = |angular| Twist { linear: Vec3::ZERO, angular };
    /// assert_eq!(axis(Vec3::Z).bracket(axis(Vec3::X)), axis(Vec3::Y));
    /// ```
    #[doc(alias = "Lie bracket")]
    #[must_use]
    #[inline]
    pub fn bracket(self, other: Self) -> Self {
        Self {
            linear: self.angular.cross(other.linear) + self.linear.cross(other.angular),
            angular: self.angular.cross(other.angular),
        }
    }

    /// The same motion with the linear part taken at the point `p` (same axes) (m).
    ///
    /// ```
    /// use cylindroid::{Twist, Vec3};
    ///
    /// let spin = Twist { linear: Vec3::ZERO, angular: Vec3::Z };
    /// assert_eq!(spin.at_point(Vec3::X).linear, Vec3::Y);
    /// ```
    #[must_use]
    #[inline]
    pub fn at_point(self, p: Vec3) -> Self {
        Self { linear: self.linear + self.angular.cross(p), angular: self.angular }
    }
}

impl Wrench {
    /// The same wrench with the moment taken about the point `p` (same axes) (m).
    ///
    /// ```
    /// use cylindroid::{Vec3, Wrench};
    ///
    /// // A force along y has the moment -1 N m about a point 1 m along x.
    /// let push = Wrench { force: Vec3::Y, moment: Vec3::ZERO };
    /// assert_eq!(push.at_point(Vec3::X).moment, -Vec3::Z);
    /// ```
    #[must_use]
    pub fn at_point(self, p: Vec3) -> Self {
        Self { force: self.force, moment: self.moment - p.cross(self.force) }
    }
}
