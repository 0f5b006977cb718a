//! The hyperbolic pseudoinverse of `screws` at each pitch: inverse, projectors, Gram determinant,
//! h-reciprocal system, and joint velocities and error form of a twist.

use cylindroid::inverse::{HyperbolicOptions, HyperbolicSvd, hyperbolic_svd, hyperbolic_with};
use cylindroid::screws::{ErrorFormZeros, Existence, Screw, ScrewSystem, gram, gram_determinant};
use cylindroid::{Matrix, Result, Twist};
use serde::Serialize;

use super::basis_screws::basis_screws;
use crate::output::ScrewJson;

/// Everything at one pitch.
#[derive(Debug)]
pub(super) struct AtPitch {
    pub(super) h: f64,
    pub(super) existence: Existence,
    /// Norm of the projector; infinite if it does not exist.
    pub(super) norm: f64,
    /// m x m.
    pub(super) gram: Matrix,
    pub(super) determinant: f64,
    /// For a finite pitch.
    pub(super) svd: Option<HyperbolicSvd>,
    pub(super) matrices: Option<Matrices>,
    pub(super) reciprocal: Vec<Screw>,
    /// For the twist, if one is given and the inverse exists.
    pub(super) velocities: Option<Velocities>,
}

/// Where the inverse exists.
#[derive(Debug)]
pub(super) struct Matrices {
    /// J+h, m x 6.
    pub(super) inverse: Matrix,
    /// P_h on twists.
    pub(super) projector: Matrix,
    /// P*_h on wrenches.
    pub(super) constraint: Matrix,
}

/// What the inverse makes of the twist.
#[derive(Debug)]
pub(super) struct Velocities {
    pub(super) joint_velocities: Vec<f64>,
    /// P_h s
    pub(super) realised: Twist,
    /// Phi_h
    pub(super) error_form: f64,
}

/// The twist of --twist.
#[derive(Debug)]
pub(super) struct Asked {
    pub(super) twist: Twist,
    pub(super) zeros: ErrorFormZeros,
}

impl Asked {
    pub(super) fn of(system: &ScrewSystem, twist: Twist) -> Result<Self> {
        Ok(Self { twist, zeros: system.error_form_zeros(twist)? })
    }
}

impl AtPitch {
    pub(super) fn find(
        jacobian: &Matrix,
        (system, options): (&ScrewSystem, &HyperbolicOptions),
        h: f64,
        twist: Option<Twist>,
    ) -> Result<Self> {
        let inverse = hyperbolic_with(jacobian, h, options)?;
        let projector = system.projector(h).filter(|_| inverse.exists);
        let velocities = twist.zip(projector.as_ref()).map(|(twist, projector)| Velocities {
            joint_velocities: inverse.matrix.mul_vec(&twist.to_array()),
            realised: projector.motion(twist),
            error_form: system.error_form(twist, h).unwrap_or(f64::NAN),
        });
        Ok(Self {
            h,
            existence: system.existence(h),
            norm: system.projector_norm(h),
            gram: gram(jacobian, h)?,
            determinant: gram_determinant(jacobian, h)?,
            svd: match h.is_finite() {
                true => Some(hyperbolic_svd(
                    jacobian,
                    h,
                    &options.scale,
                    options.joint_metric.as_ref(),
                )?),
                false => None,
            },
            matrices: projector.map(|p| Matrices {
                inverse: inverse.matrix,
                projector: p.matrix(),
                constraint: p.constraint_matrix(),
            }),
            reciprocal: basis_screws(&system.h_reciprocal(h)),
            velocities,
        })
    }
}

/// One pitch of --h.
#[derive(Debug, Serialize)]
pub(super) struct AtPitchJson {
    /// [m/rad]; null for infinity.
    h: f64,
    exists: bool,
    margin: f64,
    threshold: f64,
    /// Norm of the projector; null if it does not exist.
    norm: f64,
    reason: Option<String>,
    /// J^T Q_h J
    gram: Vec<Vec<f64>>,
    gram_determinant: f64,
    /// null for an infinite pitch.
    hyperbolic_svd: Option<SvdJson>,
    /// J+h: a row for each twist, six columns, linear first.
    inverse: Option<Vec<Vec<f64>>>,
    /// P_h on twists, linear first.
    projector: Option<Vec<Vec<f64>>>,
    /// P*_h on wrenches, force first.
    constraint_projector: Option<Vec<Vec<f64>>>,
    /// Screws that span the h-reciprocal system.
    reciprocal: Vec<ScrewJson>,
    /// With --twist; null if the inverse does not exist.
    #[serde(skip_serializing_if = "Option::is_none")]
    velocities: Option<Option<VelocitiesJson>>,
}

#[derive(Debug, Serialize)]
struct SvdJson {
    /// Signed squares of the hyperbolic singular values.
    squares: Vec<f64>,
    /// Numbers of positive, negative and zero ones.
    signature: [usize; 3],
    /// `positive`, `negative`, `signed` or `none`.
    polar: &'static str,
}

#[derive(Debug, Serialize)]
struct VelocitiesJson {
    joint_velocities: Vec<f64>,
    realised: [f64; 6],
    error_form: f64,
}

/// The twist of --twist and the pitches at which its error form vanishes.
#[derive(Debug, Serialize)]
pub(super) struct AskedJson {
    twist: [f64; 6],
    error_form_zeros: ZerosJson,
}

#[derive(Debug, Serialize)]
struct ZerosJson {
    /// [m/rad]
    pitches: Vec<f64>,
    everywhere: bool,
    defined: bool,
}

impl AtPitch {
    /// The object of `--json`; `asked` if there is a twist.
    pub(super) fn json(&self, asked: bool) -> AtPitchJson {
        let rows = |of: fn(&Matrices) -> &Matrix| self.matrices.as_ref().map(|m| of(m).to_rows());
        let velocities = || {
            self.velocities.as_ref().map(|v| VelocitiesJson {
                joint_velocities: v.joint_velocities.clone(),
                realised: v.realised.to_array(),
                error_form: v.error_form,
            })
        };
        AtPitchJson {
            h: self.h,
            exists: self.existence.exists,
            margin: self.existence.margin,
            threshold: self.existence.threshold,
            norm: self.norm,
            reason: self.existence.reason.map(|r| r.to_string()),
            gram: self.gram.to_rows(),
            gram_determinant: self.determinant,
            hyperbolic_svd: self.svd.as_ref().map(|svd| SvdJson {
                squares: svd.squares.clone(),
                signature: [svd.signature.positive, svd.signature.negative, svd.signature.zero],
                polar: svd.verdict.name(),
            }),
            inverse: rows(|m| &m.inverse),
            projector: rows(|m| &m.projector),
            constraint_projector: rows(|m| &m.constraint),
            reciprocal: self.reciprocal.iter().map(Into::into).collect(),
            velocities: asked.then(velocities),
        }
    }
}

impl From<&Asked> for AskedJson {
    fn from(asked: &Asked) -> Self {
        let pitches = match &asked.zeros {
            ErrorFormZeros::At(pitches) => pitches.clone(),
            _ => Vec::new(),
        };
        Self {
            twist: asked.twist.to_array(),
            error_form_zeros: ZerosJson {
                pitches,
                everywhere: asked.zeros == ErrorFormZeros::Everywhere,
                defined: asked.zeros != ErrorFormZeros::Undefined,
            },
        }
    }
}
