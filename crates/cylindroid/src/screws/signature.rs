//! Signature of a pitch form on a screw system: the signs that no choice of basis changes.
//!
//! Formula  eigenvalues of B^T Q_h B above, below and at zero; with the finite eigenvalues h_i of
//!          the pencil B^T Q_0 B - h B_w^T B_w (the principal pitches), z the dimension of the
//!          twists reciprocal to the system at every pitch, and 2 c = order - z - number of h_i:
//!          positive = c + #{h_i > h}, negative = c + #{h_i < h}, zero = z + #{h_i = h}
//! Units    h in m/rad
//! Valid    every system and finite pitch. With the reciprocal system at the pitch -h the positive
//!          counts and one zero count add up to 3, and so do the negative ones
//! Why so   decided by the eigenvalues of the Gram matrix of an orthonormal basis, with the
//!          threshold of [`ScrewSystem::existence`], not by the name of the class: the signature is
//!          defined near a boundary of classes too
//! Source   Sylvester's law of inertia; the formula is proved in docs/theory/hyperbolic-svd.md
//! Checked  tests/it/screws/signature.rs

use std::fmt;

use super::system::ScrewSystem;
use crate::linalg::SymmetricEigen;

/// Numbers of positive, negative and zero directions of an indefinite form: its inertia.
#[doc(alias = "inertia")]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Signature {
    /// Dimension of the largest subspace on which the form is positive.
    pub positive: usize,
    /// Dimension of the largest subspace on which it is negative.
    pub negative: usize,
    /// Dimension of the twists of the system that are reciprocal to all of it.
    pub zero: usize,
}

impl Signature {
    /// True if the form is regular: the hyperbolic inverse exists.
    #[must_use]
    pub fn is_regular(self) -> bool {
        self.zero == 0
    }

    /// The signs of eigenvalues in descending order, those within `threshold` of zero counted so.
    pub(crate) fn of(values: &[f64], threshold: f64) -> Self {
        let positive = values.iter().filter(|x| **x > threshold).count();
        let negative = values.iter().filter(|x| **x < -threshold).count();
        Self { positive, negative, zero: values.len() - positive - negative }
    }

    /// The sign of the `i`-th of the eigenvalues in descending order: 1, 0 or -1.
    pub(crate) fn sign(self, i: usize) -> f64 {
        if i < self.positive {
            1.0
        } else if i < self.positive + self.zero {
            0.0
        } else {
            -1.0
        }
    }
}

impl fmt::Display for Signature {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "({}, {}, {})", self.positive, self.negative, self.zero)
    }
}

impl ScrewSystem {
    /// The signature of the form of pitch `h` (m/rad, finite) on the system.
    ///
    /// ```text
    /// signs of the eigenvalues of B^T Q_h B,   <a, b>_h = 1/2 (v_a . w_b + w_a . v_b) - h w_a . w_b
    /// ```
    ///
    /// Of a system of order up to 3 without translations, as many are positive as principal pitches
    /// lie above `h`; its hyperbolic inverses minimise their error only where all are. A NaN or
    /// infinite pitch counts all directions as zero.
    ///
    /// ```
    /// use cylindroid::screws::{Line, ScrewOptions, ScrewSystem, Signature};
    /// use cylindroid::Vec3;
    ///
    /// // Two axes at right angles, 0.2 m apart: principal pitches 0.1 and -0.1 m/rad.
    /// let yaw = Line { point: Vec3::ZERO, direction: Vec3::Z };
    /// let pitch = Line { point: Vec3::new(0.0, 0.2, 0.0), direction: Vec3::X };
    /// let system = ScrewSystem::of(&[yaw.twist(), pitch.twist()], &ScrewOptions::default())?;
    /// assert_eq!(system.signature(0.0), Signature { positive: 1, negative: 1, zero: 0 });
    /// assert_eq!(system.signature(-0.2), Signature { positive: 2, negative: 0, zero: 0 });
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[must_use]
    pub fn signature(&self, h: f64) -> Signature {
        let k = self.order();
        let ratio = h / self.scale.length;
        if !ratio.is_finite() {
            return Signature { zero: k, ..Signature::default() };
        }
        let eigen = SymmetricEigen::of(self.span.gram(ratio), k);
        Signature::of(&eigen.values[..k], self.existence(h).threshold)
    }
}
