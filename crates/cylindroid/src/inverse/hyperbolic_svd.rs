//! Hyperbolic singular values and the polar decomposition of a Jacobian in a pitch form.
//!
//! Formula  J^T Q_h J x_i = g_i M x_i,  x_i^T M x_j = [i = j],  s_i = sqrt |g_i|,  t_i = J x_i / s_i
//!          J = T S X^T M,  T^T Q_h T = diag(sign g_i);  J+h = X S^-1 diag(sign g_i) T^T Q_h
//!          J = W H with H = X S X^T M, W = T X^T M:  W^T Q_h W = M E,  E = X diag(sign g_i) X^T M
//! Shapes   J: 6 x m (linear part first) of rank k; T: 6 x k, X: m x k; W: 6 x m; H, E: m x m
//! Units    h in m/rad; g_i in m/rad times the unit of joint velocity squared over that of M
//! Valid    the values are real for every J, every finite h and every metric. The decomposition
//!          exists iff J+h does; H is then unique. E = 1 (on the row space) iff the form is
//!          positive on the span of the columns: the canonical generalised polar decomposition
//! Fails    on non-finite input, an infinite pitch, a metric of the wrong size. Where there is no
//!          decomposition, `verdict` says why; the columns of T without a sign are then twists of
//!          the span that are h-reciprocal to all of it, not divided by anything
//! Why so   singular values of a twist Jacobian add metres to radians. These do not, and depend on
//!          the metric of the joints alone; a metric of twists would be needed for values that do
//!          not, and se(3) has no invariant one
//! Source   Onn, Steinhardt & Bojanczyk 1991 (decomposition); Zha 1996 (its existence); Higham,
//!          Mehl & Tisseur 2010 (canonical generalised polar decomposition); the theorems and their
//!          proofs for pitch forms: docs/theory/hyperbolic-svd.md
//! Checked  tests/it/screws/hyperbolic_svd.rs

use super::hyperbolic::RowSpaceGram;
use super::weighted::Weights;
use crate::error::{Error, Result};
use crate::linalg::{Matrix, Metric};
use crate::screws::{NoInverse, ScrewOptions, ScrewSystem, Signature};

/// Whether a Jacobian has a polar decomposition in a pitch form, and of which kind.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum PolarKind {
    /// The form is positive on the span of the columns: `W^T Q_h W = M` on the row space, the
    /// canonical generalised polar decomposition. `J+h s` minimises its error.
    Positive,
    /// The form is negative there: the same for `-Q_h`, and `J+h s` maximises.
    Negative,
    /// Both signs occur: `W^T Q_h W = M E` with an involution E that commutes with H.
    Signed,
    /// None: the span contains twists that are h-reciprocal to all of it.
    None {
        /// The dimension of these twists.
        isotropic: usize,
        /// The reason, as for the hyperbolic inverse.
        reason: NoInverse,
    },
}

impl PolarKind {
    /// Its name: `positive`, `negative`, `signed` or `none`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Positive => "positive",
            Self::Negative => "negative",
            Self::Signed => "signed",
            Self::None { .. } => "none",
        }
    }

    /// Its meaning in one sentence.
    #[must_use]
    pub fn description(self) -> &'static str {
        match self {
            Self::Positive => "all squares are positive; the inverse minimises its error",
            Self::Negative => "all squares are negative; the inverse maximises its error",
            Self::Signed => "squares of both signs; the inverse is a saddle of its error",
            Self::None { .. } => {
                "no decomposition; motions of the system are h-reciprocal to all of it"
            }
        }
    }
}

/// The hyperbolic singular value decomposition of a Jacobian: see [`hyperbolic_svd`].
#[derive(Debug, Clone, PartialEq)]
pub struct HyperbolicSvd {
    /// The signed squares g_i of the singular values, largest first; exactly zero by kind.
    pub squares: Vec<f64>,
    /// T, 6 x k: twists t_i with `<t_i, t_j>_h = 0`, `<t_i, t_i>_h` the sign of g_i; `J x_i` where
    /// that is zero.
    pub left: Matrix,
    /// X, m x k: joint velocities x_i, orthonormal in the joint metric.
    pub right: Matrix,
    /// Numbers of positive, negative and zero squares.
    pub signature: Signature,
    /// The existence of the decomposition and of the polar one.
    pub verdict: PolarKind,
    dual: Matrix,
}

/// A polar decomposition `J = W H` in a pitch form: see [`hyperbolic_svd`].
#[derive(Debug, Clone, PartialEq)]
pub struct HyperbolicPolar {
    /// W, 6 x m: `W^T Q_h W = M E`.
    pub isometry: Matrix,
    /// H, m x m: `M H` is symmetric and positive, on the row space of J.
    pub stretch: Matrix,
    /// E, m x m: 1 on joint velocities of positive square, -1 on those of negative square, 0 on
    /// those at rest; it commutes with H.
    pub signs: Matrix,
}

impl HyperbolicSvd {
    /// The singular values `sqrt |g_i|` in the order of the squares.
    #[must_use]
    pub fn values(&self) -> Vec<f64> {
        self.squares.iter().map(|g| g.abs().sqrt()).collect()
    }

    /// The polar decomposition `J = W H`, where it exists.
    ///
    /// ```
    /// use cylindroid::{inverse, Matrix};
    /// use cylindroid::screws::ScrewOptions;
    ///
    /// // A screw of pitch 0.4 m/rad about z, of which a joint drives twice its unit.
    /// let j = Matrix::from_rows(&[[0.0], [0.0], [0.8], [0.0], [0.0], [2.0]]).unwrap();
    /// let svd = inverse::hyperbolic_svd(&j, 0.15, &ScrewOptions::default(), None)?;
    /// let polar = svd.polar().unwrap();
    /// assert!((polar.stretch[(0, 0)] - 1.0).abs() < 1e-15);
    /// assert!((&polar.isometry * &polar.stretch).max_difference(&j) < 1e-15);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[must_use]
    pub fn polar(&self) -> Option<HyperbolicPolar> {
        if let PolarKind::None { .. } = self.verdict {
            return None;
        }
        let spread = |diagonal: &dyn Fn(usize) -> f64| {
            let scaled = Matrix::from_fn(self.right.rows(), self.right.cols(), |i, j| {
                self.right[(i, j)] * diagonal(j)
            });
            &scaled * &self.dual
        };
        let values = self.values();
        Some(HyperbolicPolar {
            isometry: &self.left * &self.dual,
            stretch: spread(&|i| values[i]),
            signs: spread(&|i| self.signature.sign(i)),
        })
    }
}

/// The hyperbolic singular values of a 6 x m Jacobian in the form of pitch `h` and a joint metric
/// M, independent of the frame, with their decomposition.
///
/// ```text
/// J^T Q_h J x_i = g_i M x_i,   J = T diag(sqrt |g_i|) X^T M,   T^T Q_h T = diag(sign g_i)
/// J J+h = T diag(sign g_i) T^T Q_h = sum_i sign(g_i) t_i t_i^T Q_h
/// ```
///
/// `j` has the linear rows first; `h` is in m/rad, finite. The squares g_i do not change with the
/// frame; they scale with the unit of length. They fall as `h` grows, with the slope `-|w(J x_i)|^2`,
/// and cross zero exactly at the principal pitches. The nonzero ones are the eigenvalues of
/// `J M^-1 J^T Q_h`: with joint stiffness as M, of the compliance of the arm. Rank and zeros are
/// decided at the length and centre of `scale`, as for the hyperbolic inverse.
///
/// ```
/// use cylindroid::inverse::{self, PolarKind};
/// use cylindroid::{Matrix, screws::ScrewOptions};
///
/// // A rotation about z and a slide along z: a cylindrical joint.
/// let j = Matrix::from_rows(&[[0.0, 0.0], [0.0, 0.0], [0.0, 1.0], [0.0, 0.0], [0.0, 0.0], [1.0, 0.0]]);
/// let svd = inverse::hyperbolic_svd(&j.unwrap(), 0.0, &ScrewOptions::default(), None)?;
/// assert_eq!(svd.verdict, PolarKind::Signed);
/// assert!((svd.squares[0] - 0.5).abs() < 1e-15 && (svd.squares[1] + 0.5).abs() < 1e-15);
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// Source: Onn, Steinhardt & Bojanczyk, *The hyperbolic singular value decomposition and
/// applications*, IEEE Transactions on Signal Processing 39, 1991; the chapter
/// `docs/theory/hyperbolic-svd.md` of the book has the theorems.
///
/// # Errors
/// A matrix that has not six rows or has non-finite entries; a pitch that is NaN or infinite; a
/// metric of the wrong size; options outside their domains.
pub fn hyperbolic_svd(
    j: &Matrix,
    h: f64,
    scale: &ScrewOptions,
    joint_metric: Option<&Metric>,
) -> Result<HyperbolicSvd> {
    Error::check_finite("pitch h", &[h])?;
    Error::check_finite("matrix", j.as_slice())?;
    let system = ScrewSystem::of_columns(j, scale)?;
    let weights = Weights { joint: joint_metric.cloned(), task: None };
    let (m, k, length) = (j.cols(), system.order(), system.length());
    let RowSpaceGram { svd, eigen, .. } = RowSpaceGram::of(j, &weights, &system, h / length)?;
    let signature = system.signature(h);
    let squares: Vec<f64> =
        (0..k).map(|i| (signature.sign(i) * eigen.values[i]).max(0.0) * length).collect();
    // In coordinates in which the metric is the identity.
    let mut whitened = Matrix::zeros(m, k);
    for c in 0..k {
        for (i, y) in eigen.vectors[c][..k].iter().enumerate() {
            whitened.column_mut(c).iter_mut().zip(svd.v(i)).for_each(|(x, v)| *x += y * v);
        }
    }
    let mut dual = whitened.clone();
    if let Some(metric) = joint_metric {
        (0..k).for_each(|c| metric.unwhiten_dual(dual.column_mut(c)));
    }
    let dual = dual.transpose();
    let right = weights.unapply(whitened);
    let mut left = j * &right;
    for (i, g) in squares.iter().enumerate().filter(|(_, g)| **g > 0.0) {
        left.column_mut(i).iter_mut().for_each(|x| *x /= g.sqrt());
    }
    let squares = squares.iter().enumerate().map(|(i, g)| signature.sign(i) * g).collect();
    let verdict = verdict(&system, signature, h);
    Ok(HyperbolicSvd { squares, left, right, signature, verdict, dual })
}

fn verdict(system: &ScrewSystem, signature: Signature, h: f64) -> PolarKind {
    let Signature { positive, negative, zero } = signature;
    let close = NoInverse::Close { class: system.class(), order: system.order() };
    match (positive, negative, zero) {
        (_, 0, 0) => PolarKind::Positive,
        (0, _, 0) => PolarKind::Negative,
        (_, _, 0) => PolarKind::Signed,
        (_, _, isotropic) => {
            PolarKind::None { isotropic, reason: system.existence(h).reason.unwrap_or(close) }
        }
    }
}
