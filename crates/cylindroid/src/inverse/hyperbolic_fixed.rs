//! Hyperbolic pseudoinverse of independent twists without allocation, for a control loop.
//!
//! Formula  J S = B R (Gram-Schmidt, twice), J+h = R^-1 (B^T Q_h B)^-1 B^T Q_h S, S the scaling to
//!          [v(c) / L; w]
//! Shapes   J: 6 x m, m <= 6 -> m x 6
//! Units    h in m/rad
//! Valid    no allocation where the columns are clearly independent and the inverse clearly
//!          exists: every pivot above 1e-2, |P_h| below 1e3, which bounds the smallest singular
//!          value of the Gram matrix by 1 / (|P_h|^2 |Q_h^-1|). Otherwise `hyperbolic_with` decides
//! Why so   for independent columns neither singular values nor a joint metric are needed; the
//!          class is for reports, not for loops
//! Checked  tests/it/hyperbolic.rs::independent_*

use super::hyperbolic::{HyperbolicOptions, hyperbolic_with};
use crate::error::{Error, Result};
use crate::linalg::Matrix;
use crate::screws::{NoInverse, ScrewOptions, independent_coordinates};

/// Writes the hyperbolic pseudoinverse of pitch `h` of the 6 x m Jacobian `j` into `out` (m x 6),
/// and returns the reason if there is none (the entries are then NaN). For control loops on a
/// Jacobian of one's own: no allocation where the inverse clearly exists.
///
/// ```
/// use cylindroid::screws::ScrewOptions;
/// use cylindroid::{inverse, Matrix};
///
/// let j = Matrix::from_rows(&[[0.0], [-1.0], [0.0], [0.0], [0.0], [1.0]]).unwrap();
/// let mut out = Matrix::zeros(1, 6);
/// let reason = inverse::hyperbolic_into(&j, 0.1, &ScrewOptions::default(), &mut out)?;
/// assert!(reason.is_none() && (&out * &j).max_difference(&Matrix::identity(1)) < 1e-15);
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// # Errors
/// As [`hyperbolic_with`]; an `out` of the wrong size.
pub fn hyperbolic_into(
    j: &Matrix,
    h: f64,
    scale: &ScrewOptions,
    out: &mut Matrix,
) -> Result<Option<NoInverse>> {
    Error::check_len("rows of the inverse", j.cols(), out.rows())?;
    Error::check_len("columns of the inverse", 6, out.cols())?;
    if h.is_finite() && j.rows() == 6 && independent_coordinates(j, h, scale, out) {
        return Ok(None);
    }
    let options = HyperbolicOptions { scale: *scale, ..HyperbolicOptions::default() };
    let inverse = hyperbolic_with(j, h, &options)?;
    *out = inverse.matrix;
    Ok(inverse.reason)
}
