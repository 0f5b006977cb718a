//! Curves for plots: the Gram determinant over the pitch, the screws of a two-system (cylindroid).
//!
//! Formula  det(J^T Q_h J), with the 1/2 of Q_h: a polynomial in h whose zeros are the principal
//!          pitches; screws cos(t) s_1 + sin(t) s_2, whose axes sweep the cylindroid
//!          z (x^2 + y^2) = (h_b - h_a) x y (Ball's surface) for a system of class IA
//! Shapes   J: 6 x m, m <= 6
//! Units    h in m/rad
//! Source   Ball 1900, chapter II; Donelan & Selig, section 4, whose determinants of examples 1 and
//!          4 belong to 2 Q_h
//! Checked  tests/it/screws/curve.rs

use super::screw::Screw;
use super::span::{dot, lowered};
use super::span_estimation::{columns, six};
use super::system::ScrewSystem;
use crate::error::{Error, Result};
use crate::linalg::{Matrix, SymmetricEigen};
use crate::spatial::{Twist, Vec3};

/// Twists at most, whose products with one another are a matrix.
const MAX_TWISTS: usize = 2000;

/// The Gram matrix `J^T Q_h J` of the pitch form, m x m, for the twists that are the columns of `j`
/// (6 x m, linear first).
///
/// ```text
/// <a, b>_h = 1/2 (v_a . w_b + w_a . v_b) - h w_a . w_b
/// ```
///
/// `h` in m/rad. Source: Donelan & Selig, section 3.
///
/// # Errors
/// A matrix without six rows, or of more than 2000 columns.
pub fn gram(j: &Matrix, h: f64) -> Result<Matrix> {
    let twists = columns(j)?;
    if twists.len() > MAX_TWISTS {
        return Err(Error::InvalidOption {
            option: "twists",
            value: twists.len().to_string(),
            reason: format!("a Gram matrix is that of at most {MAX_TWISTS}; leave out some"),
        });
    }
    Ok(Matrix::from_fn(twists.len(), twists.len(), |a, b| twists[a].pitch_form(twists[b], h)))
}

/// The Gram determinant `det(J^T Q_h J)` of the pitch form, see [`gram`]: a polynomial in h whose
/// zeros are the principal pitches; zero for more than six twists, which are dependent.
///
/// ```
/// use cylindroid::Matrix;
/// use cylindroid::screws::gram_determinant;
///
/// // A rotation about z: its Gram determinant -h vanishes at its pitch, zero.
/// let j = Matrix::from_rows(&[[0.0], [0.0], [0.0], [0.0], [0.0], [1.0]]).unwrap();
/// assert_eq!(gram_determinant(&j, 0.5)?, -0.5);
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// # Errors
/// A matrix without six rows.
pub fn gram_determinant(j: &Matrix, h: f64) -> Result<f64> {
    columns(j)?;
    let m = j.cols();
    if m > 6 {
        return Ok(0.0);
    }
    let mut g = [[0.0; 6]; 6];
    for (a, row) in g.iter_mut().enumerate().take(m) {
        let image = lowered(&six(j.column(a)), h);
        for (b, x) in row.iter_mut().enumerate().take(m) {
            *x = dot(&image, &six(j.column(b)));
        }
    }
    Ok(SymmetricEigen::of(g, m).values[..m].iter().product())
}

impl ScrewSystem {
    /// The cylindroid: `count` screws of a system of order two (of the reciprocal system for order
    /// four), from one generator of the normal form to the other and on to the first again; empty
    /// for other orders. Translations count with the characteristic length.
    ///
    /// ```text
    /// s(t) = cos(t) s_1 + sin(t) s_2,  0 <= t < pi
    /// z (x^2 + y^2) = (h_b - h_a) x y    (class IA: the surface swept by the axes)
    /// ```
    ///
    /// s_1 and s_2 are the generators, h_a and h_b their pitches (m/rad); x, y, z in the canonical
    /// frame.
    ///
    /// Source: Ball 1900, chapter II.
    ///
    /// ```
    /// use cylindroid::screws::{Line, ScrewOptions, ScrewSystem};
    /// use cylindroid::Vec3;
    ///
    /// // The screws of a cylindroid: their pitches lie between the principal ones.
    /// let yaw = Line { point: Vec3::ZERO, direction: Vec3::Z };
    /// let pitch = Line { point: Vec3::new(0.0, 0.2, 0.0), direction: Vec3::X };
    /// let system = ScrewSystem::of(&[yaw.twist(), pitch.twist()], &ScrewOptions::default())?;
    /// let screws = system.pencil(16);
    /// assert!(screws.len() == 16 && screws.iter().all(|s| s.pitch.abs() < 0.1 + 1e-12));
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[doc(alias = "cylindroid")]
    #[must_use]
    pub fn pencil(&self, count: usize) -> Vec<Screw> {
        let [a, b] = self.normal_form().twists()[..] else { return Vec::new() };
        let scale = |t: Twist| if t.angular == Vec3::ZERO { t * self.length() } else { t };
        let (a, b) = (scale(a), scale(b));
        (0..count)
            .filter_map(|i| {
                let (s, c) = (std::f64::consts::PI * i as f64 / count as f64).sin_cos();
                Screw::of(self.canonical_pose().adjoint(a * c + b * s))
            })
            .collect()
    }
}
