//! Projection of the task: the part of a motion to realise if an arm cannot perform all of it.
//!
//! Formula  joint velocities = J+ P x with P a projector on the motions of the arm: orthogonal in
//!          scaled task coordinates (then P changes nothing: J+ P = J+), P_h along the h-reciprocal
//!          twists (then J+ P = J+h), along twists given by the task (26), or damped
//! Shapes   P: 6 x 6 on [v / L; w] at the tool; the motions of the arm are the left singular
//!          vectors of the task Jacobian, which are already available
//! Units    h, mu, lambda in m/rad (mu and lambda times the unit of the joint weights)
//! Valid    tasks of all six components. If P does not exist, or enlarges a twist by more than
//!          `largest`, the reason is kept and the fallback is used; without one the arm stops
//! Why so   the pseudoinverse in joint space is unchanged, so limits, secondary tasks and the
//!          treatment of singularities are the same for every projection
//! Checked  tests/it/servo/projection.rs

use crate::error::{Error, Result};
use crate::inverse::HyperbolicDamping;
use crate::kinematics::ReferenceFrame;
use crate::linalg::Svd;
use crate::screws::{NoInverse, ScaledProjector, ScrewOptions, ScrewSystem};
use crate::spatial::{Pose, Rotation, Twist, Vec3};
use crate::tolerance::GENERIC_RANK;

/// The projection of a task: the part of a twist that is realised; the rest is the discarded
/// component.
///
/// ```text
/// joint velocities = J+ P x
///
/// orthogonal          P = J J+ (scaled):              J+ P = J+
/// hyperbolic          P = P_h, along the h-reciprocal twists:  J+ P = J+h
/// damped hyperbolic   P_h with damping
/// oblique             P along given twists
/// ```
///
/// x is the twist [v / L; w] at the tool, J the scaled task Jacobian, P 6 x 6; pitches and dampings
/// in m/rad. All but the orthogonal projection need a task of all six components. If P does not
/// exist, or enlarges a twist too much, the servo uses the fallback; without one the arm stops.
///
/// Source: Donelan & Selig, Hyperbolic pseudoinverses for kinematics in the Euclidean group.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub enum TaskProjection {
    /// The closest motion in scaled task coordinates: the effect of [`Method`](crate::Method)
    /// alone. It depends on the tool point and the characteristic length.
    #[default]
    Orthogonal,
    /// The hyperbolic pseudoinverse: the discarded component is h-reciprocal to all motions of the
    /// arm, in any frame and unit. It does not exist at principal pitches and for some systems.
    Hyperbolic {
        /// Pitch of the form [m/rad]; infinite for the limit.
        h: f64,
    },
    /// The hyperbolic pseudoinverse with damping.
    DampedHyperbolic {
        /// Pitch of the form [m/rad].
        h: f64,
        /// The damping.
        damping: HyperbolicDamping,
    },
    /// The discarded component is a combination of these twists, which the task leaves free.
    Oblique {
        /// As many as the arm lacks joints to six.
        complement: Vec<Twist>,
        /// The frame of these twists: `Local` (the tool), `LocalWorldAligned` or `World`.
        reference: ReferenceFrame,
    },
}

impl TaskProjection {
    /// The names of the non-orthogonal projections.
    pub const NAMES: [&str; 4] = ["hyperbolic", "hyperbolic-damped", "hyperbolic-gram", "oblique"];

    /// The name in options and reports.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Orthogonal => "orthogonal",
            Self::Hyperbolic { .. } => Self::NAMES[0],
            Self::DampedHyperbolic { damping: HyperbolicDamping::Gram { .. }, .. } => {
                Self::NAMES[2]
            }
            Self::DampedHyperbolic { .. } => Self::NAMES[1],
            Self::Oblique { .. } => Self::NAMES[3],
        }
    }

    /// The pitch of the form, if there is one [m/rad].
    #[must_use]
    pub const fn pitch(&self) -> Option<f64> {
        match self {
            Self::Hyperbolic { h } | Self::DampedHyperbolic { h, .. } => Some(*h),
            Self::Orthogonal | Self::Oblique { .. } => None,
        }
    }

    /// Checks the parameters.
    ///
    /// # Errors
    /// [`Error::InvalidOption`] with the option and its value; non-finite twists.
    pub fn check(&self) -> Result<()> {
        match self {
            Self::Orthogonal => Ok(()),
            Self::Hyperbolic { h } if h.is_nan() => {
                Err(Error::NotFinite { what: "pitch h".into(), value: *h })
            }
            Self::Hyperbolic { .. } => Ok(()),
            Self::DampedHyperbolic { h, damping } => {
                Error::check_finite("pitch h of a damped form", &[*h])?;
                damping.check()
            }
            Self::Oblique { complement, .. } => {
                if complement.len() > 6 {
                    return Err(Error::InvalidOption {
                        option: "complement",
                        value: format!("{} twists", complement.len()),
                        reason: "the complement can have at most six twists".to_owned(),
                    });
                }
                complement.iter().enumerate().try_for_each(|(i, t)| {
                    Error::check_finite(&format!("complement twist {}", i + 1), &t.to_array())
                })
            }
        }
    }
}

/// The frame of the task: the tool's pose, the axes of the components and the characteristic
/// length.
#[derive(Debug, Clone, Copy)]
pub(super) struct TaskFrame {
    pub(super) pose: Pose,
    pub(super) axes: ReferenceFrame,
    pub(super) length: f64,
}

impl TaskFrame {
    /// A twist given in `reference`, in scaled task coordinates.
    fn scaled(&self, twist: Twist, reference: ReferenceFrame) -> [f64; 6] {
        let turn = |t: Twist, r: Rotation| Twist { linear: r * t.linear, angular: r * t.angular };
        let aligned = match reference {
            ReferenceFrame::Local => turn(twist, self.pose.rotation),
            ReferenceFrame::World => twist.at_point(self.pose.translation),
            ReferenceFrame::LocalWorldAligned => twist,
        };
        let t = match self.axes {
            ReferenceFrame::Local => turn(aligned, self.pose.rotation.inverse()),
            ReferenceFrame::World | ReferenceFrame::LocalWorldAligned => aligned,
        };
        Twist { linear: t.linear * (1.0 / self.length), angular: t.angular }.to_array()
    }
}

/// The projection that a servo should use, and its fallback.
#[derive(Debug, Clone, Copy)]
pub(super) struct ProjectionChoice<'a> {
    pub(super) projection: &'a TaskProjection,
    pub(super) fallback: Option<&'a TaskProjection>,
    /// Largest norm of a projector [-].
    pub(super) largest: f64,
}

/// The projector of this step.
#[derive(Debug, Clone)]
pub(super) struct StepProjection {
    projector: Option<ScaledProjector>,
    reason: Option<NoInverse>,
    stopped: bool,
}

impl StepProjection {
    pub(super) const fn new() -> Self {
        Self { projector: None, reason: None, stopped: false }
    }

    /// Computes the projector for this decomposition, or that of the fallback.
    pub(super) fn load(&mut self, choice: ProjectionChoice<'_>, svd: &Svd, frame: TaskFrame) {
        *self = Self::new();
        let ProjectionChoice { projection, fallback, largest } = choice;
        match projector(projection, largest, svd, frame) {
            Ok(found) => self.projector = found,
            Err(reason) => {
                self.reason = Some(reason);
                match fallback.map(|f| projector(f, largest, svd, frame)) {
                    Some(Ok(found)) => self.projector = found,
                    Some(Err(_)) | None => self.stopped = true,
                }
            }
        }
    }

    /// `x <- P x`; zero without a projector.
    pub(super) fn apply(&self, x: &mut [f64]) {
        if self.stopped {
            x.fill(0.0);
        } else if let (Some(p), Ok(x)) = (&self.projector, <&mut [f64; 6]>::try_from(x)) {
            *x = p.apply(x);
        }
    }

    /// The reason why the requested projector was not used.
    pub(super) fn reason(&self) -> Option<NoInverse> {
        self.reason
    }

    /// True if the fallback did not exist either, or was not given.
    pub(super) fn is_stopped(&self) -> bool {
        self.stopped
    }
}

/// `None` for the identity.
fn projector(
    projection: &TaskProjection,
    largest: f64,
    svd: &Svd,
    frame: TaskFrame,
) -> std::result::Result<Option<ScaledProjector>, NoInverse> {
    if *projection == TaskProjection::Orthogonal {
        return Ok(None);
    }
    let k = svd.rank(GENERIC_RANK).rank;
    let motions = (0..k).map(|i| std::array::from_fn(|r| svd.u(i)[r]));
    let found = match projection {
        TaskProjection::Orthogonal => return Ok(None),
        TaskProjection::Hyperbolic { h } => {
            let found = ScaledProjector::hyperbolic(motions, h / frame.length);
            match found {
                Some(p) if p.norm() <= largest => p,
                _ => {
                    let norm = found.map_or(f64::INFINITY, |p| p.norm());
                    return Err(why_not(svd, k, *h, frame.length, norm));
                }
            }
        }
        TaskProjection::DampedHyperbolic { h, damping } => {
            let twists = (0..k).map(|i| std::array::from_fn(|r| svd.u(i)[r] * svd.value(i)));
            let gain = |g: f64| damping.gain(g, frame.length);
            ScaledProjector::damped(twists, h / frame.length, gain)
                .map_err(|g| NoInverse::DampingMeetsEigenvalue { eigenvalue: g * frame.length })?
        }
        TaskProjection::Oblique { complement, reference } => {
            let given_up = complement.iter().map(|t| frame.scaled(*t, *reference));
            ScaledProjector::oblique(motions, given_up)?
        }
    };
    let norm = found.norm();
    if norm > largest { Err(NoInverse::TooLarge { norm }) } else { Ok(Some(found)) }
}

/// The reason why no hyperbolic inverse of pitch `h` exists within the bound of its norm.
fn why_not(svd: &Svd, k: usize, h: f64, length: f64, norm: f64) -> NoInverse {
    let twist = |i: usize| {
        let [a, b, c, d, e, f] = std::array::from_fn(|r| svd.u(i)[r]);
        Twist::from_array([a * length, b * length, c * length, d, e, f])
    };
    let twists: Vec<Twist> = (0..k).map(twist).collect();
    // At the tool, like the projector.
    let options = ScrewOptions { center: Some(Vec3::ZERO), ..ScrewOptions::with_length(length) };
    ScrewSystem::of(&twists, &options)
        .ok()
        .and_then(|system| system.existence(h).reason)
        .unwrap_or(NoInverse::TooLarge { norm })
}
