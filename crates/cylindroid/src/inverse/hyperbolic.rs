//! Hyperbolic pseudoinverse: joint velocities that are independent of the frame and the unit.
//!
//! Formula  independent columns: J+h = (J^T Q_h J)^-1 J^T Q_h
//!          any rank, joint metric M, J = F C: J+h = C+ (F^T Q_h F)^-1 F^T Q_h,
//!          C+ = M^-1 C^T (C M^-1 C^T)^-1; P_h = J J+h
//!          damped: (J^T Q_h J + lambda M)^-1 J^T Q_h
//!          invariant damped: (G^2 + mu^2)^-1 G J^T Q_h, G = J^T Q_h J, in coordinates of the
//!          joints in which M = 1; tends to J+h as mu goes to zero where that exists, otherwise to
//!          the inverse on the other eigenvectors of G
//! Shapes   J: 6 x m (linear part first) -> m x 6; h, L, c as in `screws`
//! Units    h in m/rad, lambda and mu in m/rad times the unit of M
//! Valid    J+h exists iff F^T Q_h F is regular: never for some systems, see `screws::NoInverse`;
//!          the first damped form is singular where an eigenvalue of G (against M) is -lambda; the
//!          invariant one always exists. For rank 6 and a finite h it is the pseudoinverse of J
//! Fails    only on input that is non-finite or of the wrong shape. Where there is no inverse,
//!          `exists` is false, `reason` says why, and the entries of the matrix are NaN
//! Why so   the Moore-Penrose inverse of a twist Jacobian adds metres to radians: its joint
//!          velocities change with the origin and the unit. These do not; they are not optimal in
//!          any frame either: the realised twist P_h s makes (s - P_h s)^T Q_h (s - P_h s)
//!          stationary
//! Source   Donelan & Selig, theorems 1, 2 and 5, section 6.2; its example 1 has a wrong entry
//!          (row 3, column 2: (16 h^2 + 16 h - 1) / 32 h), its damped form the wrong promise that
//!          it always exists
//! Checked  tests/it/screws/vectors/, tests/it/screws/laws.rs, tests/it/screws/invariance.rs,
//!          tests in this file

use super::report::{Inverse, TruncatedDirection, assemble};
use super::weighted::Weights;
use crate::error::{Error, Result};
use crate::linalg::{Matrix, Metric, Svd, SymmetricEigen};
use crate::screws::{NoInverse, Projector, ScrewOptions, ScrewSystem};
use crate::spatial::{Twist, Wrench};
use crate::tolerance;

/// Options of a hyperbolic pseudoinverse besides the pitch.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct HyperbolicOptions {
    /// Characteristic length, centre and noise, for the rank and the verdict on existence: the
    /// inverse itself does not depend on them.
    pub scale: ScrewOptions,
    /// Metric of the joint velocities, m x m; it matters for dependent columns and for damping.
    pub joint_metric: Option<Metric>,
    /// Damping.
    pub damping: HyperbolicDamping,
}

/// Damping of the hyperbolic pseudoinverse.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub enum HyperbolicDamping {
    /// None: the inverse itself.
    #[default]
    None,
    /// `(J^T Q_h J + lambda M)^-1 J^T Q_h`: may itself be singular.
    Gram {
        /// lambda, in m/rad times the unit of the joint metric; of either sign.
        lambda: f64,
    },
    /// `(G^2 + mu^2)^-1 G J^T Q_h`: always exists.
    Invariant {
        /// mu, positive, in m/rad times the unit of the joint metric.
        mu: f64,
    },
}

/// The hyperbolic pseudoinverse of pitch `h` (h-pseudoinverse) of a 6 x m Jacobian: joint
/// velocities that depend neither on the frame nor, with `h` converted, on the unit of length.
///
/// ```text
/// Q_h = 1/2 [[0, 1], [1, -2 h 1]]   (linear first),   <s, s>_h = w . v - h w . w
/// independent columns:  J+h = (J^T Q_h J)^-1 J^T Q_h
/// any rank, J = F C:    J+h = C^T (C C^T)^-1 (F^T Q_h F)^-1 F^T Q_h
/// ```
///
/// `j` has the linear rows first (the paper writes the angular ones first); the inverse is m x 6.
/// `h` is in m/rad, in the unit of length of the twists, and may be infinite: the limit, where it
/// exists. `P_h = J J+h` projects on the span of the columns along the twists that are h-reciprocal
/// to it. The inverse exists if and only if `J^T Q_h J` has the rank of `j`: not at the principal
/// pitches of the screw system, and for some systems never. Then `exists` is false, `reason` says
/// why, and the entries are NaN. For rank 6 and finite `h` it is the Moore-Penrose inverse. Rank
/// and existence are decided at the characteristic length 1; see [`hyperbolic_with`] for another.
///
/// ```
/// use cylindroid::{inverse, Matrix};
///
/// // A rotation about z through (1, 0, 0), and a motion with w . v = 0.
/// let j = Matrix::from_rows(&[[0.0], [-1.0], [0.0], [0.0], [0.0], [1.0]]).unwrap();
/// let found = inverse::hyperbolic(&j, 0.1)?;
/// assert!(found.exists);
/// assert!((&found.matrix * &j).max_difference(&Matrix::identity(1)) < 1e-15);
/// // The pitch of the joint itself has no inverse.
/// assert!(!inverse::hyperbolic(&j, 0.0)?.exists);
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// Source: Donelan & Selig, *Hyperbolic pseudoinverses for kinematics in the Euclidean group*, eq.
/// 16 and theorem 2; the chapter `docs/theory/screws.md` of the book has the theory and its errata.
///
/// # Errors
/// A matrix that has not six rows or has non-finite entries; a pitch that is NaN.
pub fn hyperbolic(j: &Matrix, h: f64) -> Result<Inverse> {
    hyperbolic_with(j, h, &HyperbolicOptions::default())
}

/// [`hyperbolic`] with a characteristic length, a joint metric M and damping.
///
/// ```text
/// J = F C:            J+h = M^-1 C^T (C M^-1 C^T)^-1 (F^T Q_h F)^-1 F^T Q_h
/// Gram damping:       (J^T Q_h J + lambda M)^-1 J^T Q_h
/// invariant damping:  (G^2 + mu^2 1)^-1 G J^T Q_h,   G = J^T Q_h J where M = 1
/// ```
///
/// Shapes and frame as for [`hyperbolic`]; M is m x m. `lambda` and `mu` are in m/rad times the
/// unit of M. M matters for dependent columns and for damping only. Gram damping is singular where
/// `-lambda` is an eigenvalue of G, for positive `lambda` too; invariant damping always exists and
/// tends to the h-pseudoinverse as `mu` goes to zero.
///
/// ```
/// use cylindroid::inverse::{self, HyperbolicDamping, HyperbolicOptions};
/// use cylindroid::Matrix;
///
/// // The pitch of the joint itself has no inverse; the damped one exists.
/// let j = Matrix::from_rows(&[[0.0], [0.0], [0.0], [0.0], [0.0], [1.0]]).unwrap();
/// let damping = HyperbolicDamping::Invariant { mu: 0.1 };
/// let options = HyperbolicOptions { damping, ..HyperbolicOptions::default() };
/// assert!(!inverse::hyperbolic(&j, 0.0)?.exists);
/// let damped = inverse::hyperbolic_with(&j, 0.0, &options)?;
/// assert!(damped.matrix.as_slice().iter().all(|x| *x == 0.0));
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// Source: Donelan & Selig, sections 2.3 and 6.2 (which promises too much of Gram damping).
///
/// # Errors
/// As [`hyperbolic`]; a metric of the wrong size; options outside their domains.
pub fn hyperbolic_with(j: &Matrix, h: f64, options: &HyperbolicOptions) -> Result<Inverse> {
    check_pitch(h)?;
    Error::check_finite("matrix", j.as_slice())?;
    let system = ScrewSystem::of_columns(j, &options.scale)?;
    match options.damping {
        HyperbolicDamping::None => {
            let reason = system.existence(h).reason;
            let projector = system.projector(h);
            from_projector(j, &system, projector.ok_or(reason), options.joint_metric.as_ref())
        }
        damping => damped(j, h, damping, &system, options.joint_metric.as_ref()),
    }
}

/// The inverse by oblique projection: carries out the part of a motion in the span of `j`, along
/// the twists of `complement`, which the task may give up.
///
/// ```text
/// J J+ = J (K^T J)^-1 K^T,   K: wrenches that do no work on the columns of `complement`
/// ```
///
/// `j` is 6 x m, `complement` 6 x c, both linear first and in one frame; the inverse is m x 6. It
/// exists if and only if the two spans together are all of se(3) and meet in zero only, otherwise
/// `exists` is false. It changes with neither the frame nor the unit.
///
/// ```
/// use cylindroid::inverse::{self, HyperbolicOptions};
/// use cylindroid::Matrix;
///
/// // A prismatic joint along x has no hyperbolic pseudoinverse. Give up everything else.
/// let all = Matrix::identity(6);
/// let (j, others) = (all.columns_between(0, 1), all.columns_between(1, 6));
/// assert!(!inverse::hyperbolic(&j, 0.1)?.exists);
/// let found = inverse::oblique(&j, &others, &HyperbolicOptions::default())?;
/// assert!((found.matrix[(0, 0)] - 1.0).abs() < 1e-15);
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// Source: Donelan & Selig, eq. 26.
///
/// # Errors
/// Matrices that have not six rows or have non-finite entries; options outside their domains.
pub fn oblique(j: &Matrix, complement: &Matrix, options: &HyperbolicOptions) -> Result<Inverse> {
    Error::check_finite("matrix", j.as_slice())?;
    Error::check_finite("complement", complement.as_slice())?;
    let system = ScrewSystem::of_columns(j, &options.scale)?;
    let other = ScrewSystem::of_columns(complement, &options.scale)?;
    let reason = NoInverse::NotComplementary { order: system.order(), other: other.order() };
    let projector = system.projector_along(&other);
    from_projector(j, &system, projector.ok_or(Some(reason)), options.joint_metric.as_ref())
}

fn check_pitch(h: f64) -> Result<()> {
    if h.is_nan() {
        return Err(Error::NotFinite { what: "pitch h".into(), value: h });
    }
    Ok(())
}

fn unit(t: Twist) -> Vec<f64> {
    let norm = t.linear.norm().hypot(t.angular.norm());
    t.to_array().map(|x| x / norm).to_vec()
}

/// NaN entries of an inverse that does not exist, so that it cannot be used unnoticed.
fn nan(rows: usize, cols: usize) -> Matrix {
    Matrix::from_fn(rows, cols, |_, _| f64::NAN)
}

/// `C+ X S`: coordinates along the basis of the span, then the smallest joint velocities with
/// these.
fn from_projector(
    j: &Matrix,
    system: &ScrewSystem,
    projector: std::result::Result<Projector, Option<NoInverse>>,
    metric: Option<&Metric>,
) -> Result<Inverse> {
    let weights = Weights { joint: metric.cloned(), task: None };
    let (m, k) = (j.cols(), system.order());
    let coordinates = system.coordinates(j);
    let svd = Svd::of(&weights.apply(&coordinates)?);
    let report = |matrix, reason: Option<NoInverse>, dropped| Inverse {
        matrix,
        singular_values: svd.values().collect(),
        rank: k,
        gap: system.rank().gap,
        threshold: system.rank().threshold,
        dropped,
        exists: reason.is_none(),
        reason,
    };
    let projector = match projector {
        Ok(projector) => projector,
        Err(reason) => return Ok(report(nan(m, 6), reason, vec![])),
    };
    let gains: Vec<f64> = svd.values().map(|s| if s > 0.0 { 1.0 / s } else { 0.0 }).collect();
    let right = weights.unapply(assemble(&svd, &gains));
    let matrix = &right * &projector.coordinate_matrix();
    let dropped = projector
        .kernel()
        .into_iter()
        .map(|t| TruncatedDirection { singular_value: 0.0, direction: unit(t), filter_factor: 0.0 })
        .collect();
    Ok(report(matrix, None, dropped))
}

impl HyperbolicDamping {
    pub(crate) fn check(self) -> Result<()> {
        match self {
            Self::None => Ok(()),
            Self::Gram { lambda } => Error::check_finite("lambda", &[lambda]),
            Self::Invariant { mu } => Error::check_positive("mu", mu),
        }
    }

    /// What divides out an eigenvalue of the Gram matrix; both in units of `length`. `None` where
    /// the damping makes it zero.
    pub(crate) fn gain(self, g: f64, length: f64) -> Option<f64> {
        match self {
            Self::None => (g != 0.0).then(|| 1.0 / g),
            Self::Gram { lambda } => {
                let lambda = lambda / length;
                let sum = g + lambda;
                (sum.abs() > tolerance::SCREW_RANK * (g.abs() + lambda.abs())).then(|| 1.0 / sum)
            }
            Self::Invariant { mu } => {
                let mu = mu / length;
                Some(if g == 0.0 { 0.0 } else { 1.0 / (g + mu * (mu / g)) })
            }
        }
    }
}

/// `J^T Q_h J` on the row space of J, in scaled units and in joint coordinates in which the metric is
/// the identity.
pub(super) struct RowSpaceGram {
    /// Of J in these coordinates.
    pub(super) svd: Svd,
    /// J times its right singular vectors: as many as the rank.
    pub(super) twists: Vec<Twist>,
    /// Of the Gram matrix of these twists.
    pub(super) eigen: SymmetricEigen<6>,
}

impl RowSpaceGram {
    /// `h`: scaled.
    pub(super) fn of(j: &Matrix, weights: &Weights, system: &ScrewSystem, h: f64) -> Result<Self> {
        let svd = Svd::of(&weights.apply(&system.scaled(j))?);
        let twists: Vec<Twist> = (0..system.order())
            .map(|i| Twist::from_array(std::array::from_fn(|r| svd.u(i)[r] * svd.value(i))))
            .collect();
        let mut gram = [[0.0; 6]; 6];
        for (row, a) in gram.iter_mut().zip(&twists) {
            for (x, b) in row.iter_mut().zip(&twists) {
                *x = a.pitch_form(*b, h);
            }
        }
        let eigen = SymmetricEigen::of(gram, twists.len());
        Ok(Self { svd, twists, eigen })
    }
}

/// `V diag(gain(g)) V^T J^T Q_h` over the eigenvalues g of `J^T Q_h J` on the row space of J, in
/// joint coordinates that the metric makes orthonormal.
fn damped(
    j: &Matrix,
    h: f64,
    damping: HyperbolicDamping,
    system: &ScrewSystem,
    metric: Option<&Metric>,
) -> Result<Inverse> {
    if h.is_infinite() {
        return Err(Error::InvalidOption {
            option: "h",
            value: h.to_string(),
            reason: "the damped forms require a finite pitch".to_owned(),
        });
    }
    damping.check()?;
    let weights = Weights { joint: metric.cloned(), task: None };
    let k = system.order();
    let h = h / system.length();
    let RowSpaceGram { svd, twists, eigen } = RowSpaceGram::of(j, &weights, system, h)?;
    // What rounding leaves of a zero would be divided by the square of a small mu.
    let rounding = tolerance::MACHINE_RANK * svd.largest().powi(2) * (1.0 + h.abs());
    let mut reason = None;
    let mut matrix = Matrix::zeros(j.cols(), 6);
    for (&g, vector) in eigen.values.iter().zip(&eigen.vectors).take(k) {
        let g = if g.abs() <= rounding { 0.0 } else { g };
        let Some(gain) = damping.gain(g, system.length()) else {
            reason = Some(NoInverse::DampingMeetsEigenvalue { eigenvalue: g * system.length() });
            continue;
        };
        let mut row = Wrench::ZERO;
        let mut rates = vec![0.0; j.cols()];
        for (i, (twist, c)) in twists.iter().zip(vector).enumerate() {
            row = row + twist.lowered(h) * *c;
            rates.iter_mut().zip(svd.v(i)).for_each(|(r, v)| *r += c * v);
        }
        for (column, x) in row.to_array().into_iter().enumerate() {
            for (entry, r) in matrix.column_mut(column).iter_mut().zip(&rates) {
                *entry += gain * r * x;
            }
        }
    }
    let matrix = match reason {
        None => system.unscaled(&weights.unapply(matrix)),
        Some(_) => nan(j.cols(), 6),
    };
    Ok(Inverse {
        matrix,
        singular_values: svd.values().collect(),
        rank: k,
        gap: system.rank().gap,
        threshold: system.rank().threshold,
        dropped: vec![],
        exists: reason.is_none(),
        reason,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// g / (g^2 + mu^2), at zero too; lambda and mu are lengths as g.
    #[test]
    fn gains_of_dampings() {
        let damped = |g: f64, length: f64| HyperbolicDamping::Invariant { mu: 0.4 }.gain(g, length);
        assert_eq!(damped(0.0, 1.0), Some(0.0));
        for g in [1.0, -1.0, 0.3, -2.0, 1e-9] {
            for length in [1.0, 0.2] {
                let mu: f64 = 0.4 / length;
                let expected = g / (g * g + mu * mu);
                let found = damped(g, length).unwrap();
                assert!((found - expected).abs() < 1e-15 * expected.abs().max(1.0), "{g} {length}");
            }
        }
        let plain = |g| HyperbolicDamping::None.gain(g, 1.0);
        assert_eq!((plain(0.0), plain(1.0), plain(-0.5)), (None, Some(1.0), Some(-2.0)));
        let gram = |g| HyperbolicDamping::Gram { lambda: 0.5 }.gain(g, 0.5);
        assert_eq!((gram(-1.0), gram(1.0), gram(0.0)), (None, Some(0.5), Some(1.0)));
    }
}
