//! Screw systems: the subspaces of twists that sets of screws span.
//!
//! Formula  span of the columns [v(c) / L; w], rank by singular values of unit columns; class,
//!          moduli and frame from the system itself (order <= 3) or its reciprocal (order 4, 5)
//! Shapes   m twists -> order k <= 6
//! Units    L, c in m; pitches in m/rad
//! Frame    that of the twists; the canonical pose is `frame_from_canonical`
//! Valid    any twists, noisy or dependent. The verdict does not change with the frame, with the
//!          unit of length (as long as L is given in it) or with the twists chosen to span the
//!          system; near a boundary of classes it is flagged as ambiguous
//! Why so   se(3) has no invariant length of a twist, so noise and rank need a scale: L, which the
//!          user knows, and a centre c, which moves with the axes. Deriving L from the twists fails
//!          for a wrist, which has no length
//! Source   Donelan & Selig, section 4; the tolerances: `tolerance.rs`
//! Checked  tests/it/screws/classes.rs, tests/it/screws/vectors/, tests/it/screws/laws.rs

use super::class::{Class, NormalForm};
use super::classify::{Classified, Margin, classify, placed};
use super::screw::{Line, Screw};
use super::span::{Scale, Span, dot, join, over, size};
use super::span_estimation::{ScrewOptions, Tolerances, columns, six, spanned};
use crate::error::{Error, Result};
use crate::linalg::{Matrix, Rank};
use crate::scalar::power_of_two;
use crate::spatial::{Pose, Twist, Vec3};
use crate::tolerance::NOISE_OF_ZERO;

/// A screw system: a subspace of twists, with its Gibson-Hunt class, its principal screws and its
/// canonical frame.
///
/// ```text
/// S = span of the columns of J = (s_1 ... s_m),   order k = rank [v_i(c) / L; w_i]
/// Gram matrix  J^T Q_h J,   <a, b>_h = 1/2 (v_a . w_b + w_a . v_b) - h w_a . w_b
/// S^perp = {r : <r, s>_0 = 0 for all s in S},   principal pitches: zeros of det(J^T Q_h J)
/// ```
///
/// Twists are 6-vectors, linear first, in one frame; pitches are in m/rad. The characteristic
/// length L and the centre c (m) decide ranks and classes only: verdicts change neither with the
/// frame nor with the unit. Systems of order 4 and 5 have the class of their reciprocal system.
///
/// Source: Gibson & Hunt 1990; Donelan & Selig, tables 1 to 3 (corrected in the chapter
/// `docs/theory/screws.md` of the book).
#[derive(Debug, Clone)]
pub struct ScrewSystem {
    pub(super) span: Span,
    pub(super) scale: Scale,
    pub(super) tolerance: Tolerances,
    rank: Rank,
    form: NormalForm,
    canonical: Pose,
    residual: f64,
    margins: Vec<Margin>,
    ambiguous: bool,
    principal: Vec<Screw>,
}

impl ScrewSystem {
    /// The system that these twists of one frame span.
    ///
    /// ```
    /// use cylindroid::screws::{Class, Line, ScrewOptions, ScrewSystem};
    /// use cylindroid::Vec3;
    ///
    /// // Three intersecting axes, a spherical wrist: all rotations about their common point.
    /// let axis = |direction| Line { point: Vec3::X, direction }.twist();
    /// let wrist = [axis(Vec3::X), axis(Vec3::Y), axis(Vec3::Z)];
    /// let system = ScrewSystem::of(&wrist, &ScrewOptions::default())?;
    /// assert_eq!((system.order(), system.center()), (3, Vec3::X));
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// Non-finite twists or options, a length that is not one of [`LENGTHS`](crate::tolerance::LENGTHS).
    pub fn of(twists: &[Twist], options: &ScrewOptions) -> Result<Self> {
        options.check()?;
        if let Some(i) = twists.iter().position(|t| !t.is_finite()) {
            Error::check_finite(&format!("twist {}", i + 1), &twists[i].to_array())?;
        }
        let (span, scale, tolerance, rank) = spanned(twists, options);
        Ok(Self::classified(span, scale, tolerance, rank))
    }

    /// The system spanned by the columns of a Jacobian (6 rows, linear first).
    ///
    /// ```
    /// use cylindroid::screws::{ScrewOptions, ScrewSystem};
    /// use cylindroid::{ReferenceFrame, load};
    ///
    /// let robot = load("youbot")?;
    /// let state = robot.state(robot.home())?;
    /// let jacobian = state.jacobian(robot.tool(), ReferenceFrame::LocalWorldAligned)?;
    /// let system = ScrewSystem::of_columns(&jacobian, &ScrewOptions::with_length(robot.reach()))?;
    /// println!("order {}, class {}", system.order(), system.class());
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`ScrewSystem::of`]; a matrix that has not six rows.
    pub fn of_columns(jacobian: &Matrix, options: &ScrewOptions) -> Result<Self> {
        Self::of(&columns(jacobian)?, options)
    }

    pub(super) fn classified(span: Span, scale: Scale, tolerance: Tolerances, rank: Rank) -> Self {
        let k = span.k();
        let small = match k {
            4 | 5 => span.reciprocal(),
            6 => Span::ZERO,
            _ => span,
        };
        let mut margins = Vec::with_capacity(6);
        let mut system = Self {
            span,
            scale,
            tolerance,
            rank,
            form: NormalForm {
                class: if k == 0 { Class::Zero } else { Class::Full },
                order: k,
                pitches: vec![],
                slope: None,
            },
            canonical: Pose::from_translation(scale.center),
            residual: 0.0,
            margins: vec![],
            ambiguous: false,
            principal: vec![],
        };
        if small.k() > 0 {
            let classified = classify(&small, tolerance.class, NOISE_OF_ZERO * tolerance.noise);
            system.form = NormalForm {
                class: classified.class,
                order: small.k(),
                pitches: classified.pitches.iter().map(|h| h * scale.length).collect(),
                slope: classified.slope,
            };
            system.canonical = Pose {
                rotation: classified.rotation,
                translation: scale.center + classified.origin * scale.length,
            };
            system.residual = residual(&small, &classified);
            system.principal = principal_screws(&system.form, system.canonical, k);
            margins.extend(classified.margins);
            system.ambiguous = classified.depends_on_center;
        }
        system.ambiguous |=
            tolerance.narrow_rank || margins.iter().any(|m| tolerance.is_narrow(m.value));
        system.margins = margins;
        system
    }

    /// Dimension of the system: 0 to 6.
    #[must_use]
    pub fn order(&self) -> usize {
        self.span.k()
    }

    /// The order with its threshold and its gap of singular values.
    #[must_use]
    pub fn rank(&self) -> Rank {
        self.rank
    }

    /// Its class after Gibson and Hunt: of the reciprocal system for orders 4 and 5.
    #[must_use]
    pub fn class(&self) -> Class {
        self.form.class
    }

    /// Class and moduli: the normal form, of the reciprocal system for orders 4 and 5.
    #[must_use]
    pub fn normal_form(&self) -> &NormalForm {
        &self.form
    }

    /// The pose of the canonical frame in the frame of the twists: the normal form in it spans the
    /// system (its reciprocal for orders 4 and 5).
    #[must_use]
    pub fn canonical_pose(&self) -> Pose {
        self.canonical
    }

    /// Sine of the angle between the system and its normal form in the canonical frame: the
    /// deviation from the class.
    #[must_use]
    pub fn residual(&self) -> f64 {
        self.residual
    }

    /// The margins of the classification: the quantities that decide the class.
    #[must_use]
    pub fn margins(&self) -> &[Margin] {
        &self.margins
    }

    /// True if a quantity is so close to its threshold that the class is numerically ambiguous.
    #[must_use]
    pub fn is_ambiguous(&self) -> bool {
        self.ambiguous
    }

    /// The pitches [m/rad] at which the hyperbolic pseudoinverse ceases to exist, largest first (of
    /// class IA2 the single one first); empty for classes that never have one, or have one for
    /// every pitch.
    #[must_use]
    pub fn principal_pitches(&self) -> Vec<f64> {
        self.principal.iter().map(|s| s.pitch).collect()
    }

    /// A screw of the system for each principal pitch: reciprocal to every other screw of the
    /// system in the form of that pitch. Amplitude 1 rad/s.
    #[must_use]
    pub fn principal_screws(&self) -> &[Screw] {
        &self.principal
    }

    /// Twists that span the system: orthonormal at the centre, with the linear part over L.
    #[must_use]
    pub fn basis(&self) -> Vec<Twist> {
        self.span.vectors().iter().map(|x| self.scale.undo(x)).collect()
    }

    /// The characteristic length (m).
    #[must_use]
    pub fn length(&self) -> f64 {
        self.scale.length
    }

    /// The threshold of its class, without unit: a length is zero at or below this times L.
    #[must_use]
    pub fn tolerance(&self) -> f64 {
        self.tolerance.class
    }

    /// The point at which lengths are measured (m).
    #[must_use]
    pub fn center(&self) -> Vec3 {
        self.scale.center
    }

    /// The sine of the angle between a twist and the system, at its centre and length: zero for a
    /// member, one for a twist orthogonal to all of them. Zero for the zero twist.
    ///
    /// ```
    /// use cylindroid::screws::{ScrewOptions, ScrewSystem};
    /// use cylindroid::{Twist, Vec3};
    ///
    /// let slide = |linear| Twist { linear, angular: Vec3::ZERO };
    /// let plane = ScrewSystem::of(&[slide(Vec3::X), slide(Vec3::Y)], &ScrewOptions::default())?;
    /// assert!(plane.sine_to(slide(Vec3::X + Vec3::Y)) < 1e-15);
    /// assert!((plane.sine_to(slide(Vec3::X + Vec3::Z)) - 0.5_f64.sqrt()).abs() < 1e-15);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[must_use]
    pub fn sine_to(&self, twist: Twist) -> f64 {
        let mut x = self.scale.apply(over(twist, power_of_two(size(twist, self.scale.length))));
        let norm = dot(&x, &x).sqrt();
        if norm == 0.0 {
            return 0.0;
        }
        x.iter_mut().for_each(|a| *a /= norm);
        self.span.project_out(&mut x)
    }

    /// True if the twist belongs to the system, to the tolerance of its class.
    ///
    /// ```
    /// use cylindroid::screws::{Line, ScrewOptions, ScrewSystem};
    /// use cylindroid::Vec3;
    ///
    /// let axis = |direction| Line { point: Vec3::ZERO, direction }.twist();
    /// let plane = ScrewSystem::of(&[axis(Vec3::X), axis(Vec3::Y)], &ScrewOptions::default())?;
    /// assert!(plane.contains(axis(Vec3::new(1.0, 1.0, 0.0))));
    /// assert!(!plane.contains(axis(Vec3::Z)));
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[must_use]
    pub fn contains(&self, twist: Twist) -> bool {
        self.sine_to(twist) <= self.tolerance.class
    }
}

fn residual(span: &Span, classified: &Classified) -> f64 {
    let form = NormalForm {
        class: classified.class,
        order: span.k(),
        pitches: classified.pitches.clone(),
        slope: classified.slope,
    };
    let generators: Vec<[f64; 6]> =
        form.twists().iter().map(|t| join(t.linear, t.angular)).collect();
    span.sine_to(&placed(classified, &generators)).min(1.0)
}

/// Those of the system itself: for orders 4 and 5 on the axes of the reciprocal system, with the
/// pitches negated.
fn principal_screws(form: &NormalForm, canonical: Pose, order: usize) -> Vec<Screw> {
    if form.class.never_invertible() || form.class == Class::IB {
        return vec![];
    }
    let axes = match form.class {
        // One of the two directions of IB0 alone: the other is bound to the translation.
        Class::IB0 => vec![canonical.rotation.y_axis()],
        _ => vec![
            canonical.rotation.x_axis(),
            canonical.rotation.y_axis(),
            canonical.rotation.z_axis(),
        ],
    };
    let mut screws: Vec<Screw> = form
        .pitches
        .iter()
        .zip(axes)
        .map(|(&h, direction)| {
            let axis = Line { point: canonical.translation, direction };
            let point = axis.nearest(Vec3::ZERO);
            let pitch = if order > 3 { 0.0 - h } else { h };
            Screw { axis: Line { point, direction }, pitch, amplitude: 1.0 }
        })
        .collect();
    if order > 3 {
        screws.reverse();
    }
    screws
}

impl ScrewSystem {
    /// The columns of a matrix that spans the system, as [v(c) / L; w].
    pub(crate) fn scaled(&self, jacobian: &Matrix) -> Matrix {
        let mut scaled = Matrix::zeros(6, jacobian.cols());
        for j in 0..jacobian.cols() {
            let x = self.scale.apply(Twist::from_array(six(jacobian.column(j))));
            scaled.column_mut(j).copy_from_slice(&x);
        }
        scaled
    }

    /// A matrix on scaled twists as a matrix on twists.
    pub(crate) fn unscaled(&self, a: &Matrix) -> Matrix {
        self.scale.after_scaling(a)
    }

    /// The coordinates of the columns in the basis of the system (k x m).
    pub(crate) fn coordinates(&self, jacobian: &Matrix) -> Matrix {
        let scaled = self.scaled(jacobian);
        let basis = self.span.vectors();
        Matrix::from_fn(basis.len(), jacobian.cols(), |i, j| {
            basis[i].iter().zip(scaled.column(j)).map(|(b, x)| b * x).sum()
        })
    }
}
