//! Existence of the hyperbolic pseudoinverse of a screw system for a pitch, the reason where there
//! is none, and the choice of a pitch.
//!
//! Formula  exists iff B^T Q_h B is regular: margin = its smallest singular value, B orthonormal at
//!          the centre with lengths over L
//! Units    h in m/rad; margin and norms without unit
//! Valid    every order; orders 0 and 6 always have one. The limit of P_h for an infinite pitch is
//!          used where the system (order <= 3) or its reciprocal (order >= 3) contains no
//!          translation. Of the others, those of slope 0 have a limit too (a cylindrical joint,
//!          whose P_h does not depend on h), but systems without one are arbitrarily near: it is
//!          not used, since no measurement could distinguish them
//! Source   Donelan & Selig, theorems 2 and 3, corollary 4 (the sign of h flips on the reciprocal
//!          side); the choice of h by |P_h| is ours: the condition of the Gram matrix misleads for
//!          orders 4 and 5, where it grows with |h| although P_h converges
//! Checked  tests/it/screws/existence.rs, tests/it/screws/vectors/normal_forms.rs,
//!          tests/it/screws/classes.rs

use std::fmt;

use super::class::Class;
use super::projector::coordinates;
use super::span::{Span, angular};
use super::system::ScrewSystem;
use crate::linalg::{Matrix, Svd};
use crate::tolerance::AMBIGUOUS;

/// Existence of a hyperbolic pseudoinverse, with its margin.
#[derive(Debug, Clone, PartialEq)]
pub struct Existence {
    /// True if it exists.
    pub exists: bool,
    /// Smallest singular value of the Gram matrix of the pitch form, without unit (for an infinite
    /// pitch: smallest sine between the system, or its reciprocal, and the translations).
    pub margin: f64,
    /// At or below this it does not exist.
    pub threshold: f64,
    /// The reason if it does not.
    pub reason: Option<NoInverse>,
}

/// The reason why there is no hyperbolic pseudoinverse.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum NoInverse {
    /// The pitch is a principal pitch of the system.
    PrincipalPitch {
        /// The principal pitch [m/rad].
        pitch: f64,
    },
    /// No pitch exists for systems of this class.
    Class {
        /// The class (of the reciprocal system for orders 4 and 5).
        class: Class,
        /// Order of the system.
        order: usize,
    },
    /// The system, or its reciprocal, contains translations, so that its projectors or those of
    /// arbitrarily close systems grow without bound as the pitch goes to infinity.
    NoLimit {
        /// The class (of the reciprocal system for orders 4 and 5).
        class: Class,
        /// Order of the system.
        order: usize,
    },
    /// A damping equal to the negative of an eigenvalue of the Gram matrix.
    DampingMeetsEigenvalue {
        /// The eigenvalue [m/rad times the unit of the joint metric].
        eigenvalue: f64,
    },
    /// The complement does not complete the system to six dimensions.
    NotComplementary {
        /// Order of the system.
        order: usize,
        /// Order of the twists given up.
        other: usize,
    },
    /// The inverse exists, but enlarges motions by more than allowed.
    TooLarge {
        /// Size of the projector: 1 for an orthogonal one onto one screw.
        norm: f64,
    },
    /// The Gram matrix is singular to the tolerance, although no principal pitch is near: the
    /// system is close to a class without an inverse.
    Close {
        /// The class it is found in.
        class: Class,
        /// Order of the system.
        order: usize,
    },
}

impl fmt::Display for NoInverse {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let system = |class: &Class, order: &usize| match order {
            4 | 5 => format!("{order}-system whose reciprocal is of class {class}"),
            _ => format!("{order}-system of class {class}"),
        };
        match self {
            Self::PrincipalPitch { pitch } => write!(
                f,
                "h is the principal pitch {} m/rad of the screws; choose another h",
                six_digits(*pitch)
            ),
            Self::Class { class, order } => write!(
                f,
                "a {} has no hyperbolic pseudoinverse for any h; use the invariant damped form, \
                 or an oblique projection along twists of your choice",
                system(class, order)
            ),
            Self::NoLimit { class, order } => write!(
                f,
                "for a {} the inverse is not defined for an infinite h, where it or that of nearby \
                 systems grows without bound; choose a finite h",
                system(class, order)
            ),
            Self::DampingMeetsEigenvalue { eigenvalue } => write!(
                f,
                "lambda is the negative of the eigenvalue {} of the Gram matrix; choose \
                 another lambda, or the invariant damping, which always exists",
                six_digits(*eigenvalue)
            ),
            Self::NotComplementary { order, other } if order + other != 6 => write!(
                f,
                "the motions span {order} dimensions and the complement {other}; together they \
                 must span six"
            ),
            Self::NotComplementary { .. } => {
                write!(f, "the complement intersects the motions; choose twists outside their span")
            }
            Self::TooLarge { norm } => write!(
                f,
                "the projector enlarges motions by up to {norm:.3e}, more than allowed; \
                 choose another h, or a configuration farther from the one without an inverse"
            ),
            Self::Close { class, order } => write!(
                f,
                "the {} is too close to one without a hyperbolic pseudoinverse; use the invariant \
                 damped form",
                system(class, order)
            ),
        }
    }
}

/// Six significant digits; rounding of a length of the order of one is zero.
fn six_digits(x: f64) -> f64 {
    if x.abs() < 1e-15 { 0.0 } else { format!("{x:.5e}").parse().unwrap_or(x) }
}

/// The size of the projectors over the pitch, and a pitch that keeps it small.
#[derive(Debug, Clone, PartialEq)]
pub struct PitchChoice {
    /// The proposed pitch [m/rad], infinite where the limit is the smallest; `None` where no pitch
    /// has an inverse.
    pub pitch: Option<f64>,
    /// |P_h| there: 1 is an orthogonal projection.
    pub norm: f64,
    /// |P_h| at pitches up to ten lengths of the system, of both signs: (h, norm), the norm infinite where
    /// there is none.
    pub curve: Vec<(f64, f64)>,
    /// |P_inf|; infinite where the limit does not exist.
    pub norm_at_infinity: f64,
    /// False if no pitch has the smallest norm: it decreases up to the largest pitches searched,
    /// 1000 characteristic lengths, and P_inf does not exist.
    pub attained: bool,
}

/// Rounding of the Gram matrix of a pitch form, times the pitch over the characteristic length [-]: its
/// smallest singular value is known to some roundings of the largest.
const GRAM_ROUNDING: f64 = 16.0 * f64::EPSILON;
/// Pitches beyond this many characteristic lengths are taken for infinite.
const LARGEST_RATIO: f64 = 1e3;
/// Pitches looked at on each side of zero: 24 a decade.
const PER_DECADE: i32 = 24;
/// Decades below [`LARGEST_RATIO`].
const DECADES: i32 = 6;
/// Points at each end of the curve that are not returned: those beyond ten lengths.
const BEYOND: usize = 2 * PER_DECADE as usize;

impl ScrewSystem {
    /// Whether the projector P_h, and with it the hyperbolic pseudoinverses of all matrices that
    /// span the system, exist. `h` in m/rad, or infinite for the limit.
    ///
    /// ```text
    /// exists iff the smallest singular value of B^T Q_{h/L} B is above the threshold
    /// ```
    ///
    /// B is an orthonormal basis of the system at its centre, lengths over L. Source: Donelan &
    /// Selig, theorems 2 and 3.
    ///
    /// ```
    /// use cylindroid::screws::{Line, ScrewOptions, ScrewSystem};
    /// use cylindroid::Vec3;
    ///
    /// let revolute = Line { point: Vec3::ZERO, direction: Vec3::Z };
    /// let system = ScrewSystem::of(&[revolute.twist()], &ScrewOptions::default())?;
    /// assert!(system.existence(0.1).exists);
    /// // The pitch of a rotation is zero, its principal pitch.
    /// println!("{}", system.existence(0.0).reason.unwrap());
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[must_use]
    pub fn existence(&self, h: f64) -> Existence {
        let ratio = h / self.scale.length;
        let (order, class) = (self.order(), self.class());
        let margin =
            if h.is_infinite() { limit_margin(&self.span) } else { self.span.gram_margin(ratio) };
        // The Gram matrix itself is rounded relative to its size.
        let rounding = if h.is_infinite() { 0.0 } else { GRAM_ROUNDING * ratio.abs() };
        let threshold = self.tolerance.class.max(rounding);
        // NaN is no pitch, and has no inverse.
        let exists = margin > threshold;
        let nearest = || {
            let distance = |p: &f64| (p - h).abs();
            self.principal_pitches().into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))
        };
        let reason = (!exists).then(|| {
            if class.never_invertible() {
                return NoInverse::Class { class, order };
            }
            if h.is_infinite() {
                return NoInverse::NoLimit { class, order };
            }
            match nearest() {
                Some(pitch) if (pitch - h).abs() <= AMBIGUOUS * threshold * self.scale.length => {
                    NoInverse::PrincipalPitch { pitch }
                }
                _ => NoInverse::Close { class, order },
            }
        });
        Existence { exists, margin, threshold, reason }
    }

    /// The norm of P_h, at the centre and length of the system; infinite where there is none.
    ///
    /// ```
    /// use cylindroid::screws::{Line, ScrewOptions, ScrewSystem};
    /// use cylindroid::Vec3;
    ///
    /// // A revolute joint has no projector of its own pitch, zero.
    /// let revolute = Line { point: Vec3::ZERO, direction: Vec3::Z }.twist();
    /// let system = ScrewSystem::of(&[revolute], &ScrewOptions::default())?;
    /// assert_eq!(system.projector_norm(0.0), f64::INFINITY);
    /// assert!(system.projector_norm(1.0) >= 1.0);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[must_use]
    pub fn projector_norm(&self, h: f64) -> f64 {
        self.projector(h).map_or(f64::INFINITY, |p| p.norm())
    }

    /// |P_h| over the pitch, and the pitch where it is smallest: guidance, not a law, since a
    /// small projector is not always the desired one. Ties go to the smallest |h|.
    #[must_use]
    pub fn choose_pitch(&self) -> PitchChoice {
        let length = self.scale.length;
        let norm = |h: f64| self.projector_norm(h);
        let steps = PER_DECADE * DECADES;
        let magnitude = |i: i32| {
            LARGEST_RATIO * length * 10_f64.powf(f64::from(i - steps) / f64::from(PER_DECADE))
        };
        let curve: Vec<(f64, f64)> = (0..=steps)
            .rev()
            .map(|i| -magnitude(i))
            .chain([0.0])
            .chain((0..=steps).map(magnitude))
            .map(|h| (h, norm(h)))
            .collect();
        let norm_at_infinity = norm(f64::INFINITY);
        let mut minima: Vec<usize> = (0..curve.len())
            .filter(|&i| {
                curve[i].1.is_finite()
                    && (i == 0 || curve[i].1 <= curve[i - 1].1)
                    && (i + 1 == curve.len() || curve[i].1 <= curve[i + 1].1)
            })
            .collect();
        minima.sort_by(|&i, &j| {
            curve[i].1.total_cmp(&curve[j].1).then(curve[i].0.abs().total_cmp(&curve[j].0.abs()))
        });
        let Some(&best) = minima.first() else {
            let pitch = norm_at_infinity.is_finite().then_some(f64::INFINITY);
            let norm = norm_at_infinity;
            let curve = curve[BEYOND..curve.len() - BEYOND].to_vec();
            return PitchChoice { pitch, norm, curve, norm_at_infinity, attained: true };
        };
        let (mut pitch, mut smallest) = curve[best];
        for i in minima {
            // Between its neighbours the curve is smooth: golden section. One that is much worse
            // before does not become the best.
            if i == 0 || i + 1 == curve.len() || curve[i].1 > 1.1 * curve[best].1 {
                continue;
            }
            let (mut a, mut b) = (curve[i - 1].0, curve[i + 1].0);
            let golden = 0.5 * (5_f64.sqrt() - 1.0);
            for _ in 0..40 {
                let (c, d) = (b - golden * (b - a), a + golden * (b - a));
                if norm(c) <= norm(d) {
                    b = d;
                } else {
                    a = c;
                }
            }
            let refined = 0.5 * (a + b);
            // A flat minimum is not worth an odd number.
            if norm(refined) < smallest * (1.0 - 1e-6) {
                (pitch, smallest) = (refined, norm(refined));
            }
        }
        // Nor is a minimum at zero worth its rounding.
        if norm(0.0) <= smallest * (1.0 + 1e-6) {
            (pitch, smallest) = (0.0, norm(0.0));
        }
        if norm_at_infinity <= smallest * (1.0 + 1e-6) {
            (pitch, smallest) = (f64::INFINITY, norm_at_infinity);
        }
        let last = curve.len() - 1;
        let ends = [(curve[0], curve[1]), (curve[last], curve[last - 1])];
        let attained = !ends.iter().any(|(end, inner)| pitch == end.0 && end.1 < inner.1);
        let curve = curve[BEYOND..=last - BEYOND].to_vec();
        PitchChoice { pitch: Some(pitch), norm: smallest, curve, norm_at_infinity, attained }
    }
}

/// Smallest sine between the twists of the system (order <= 3) or of its reciprocal (order >= 3)
/// and the translations: zero where no limit of P_h is taken.
fn limit_margin(span: &Span) -> f64 {
    let sine = |s: &Span| {
        if s.k() == 0 {
            return 1.0;
        }
        if s.k() > 3 || coordinates(span, f64::INFINITY).is_none() {
            return 0.0;
        }
        let w = Matrix::from_fn(3, s.k(), |i, j| angular(&s.vectors()[j]).to_array()[i]);
        Svd::of(&w).value(s.k() - 1)
    };
    match span.k() {
        0 | 6 => 1.0,
        1 | 2 => sine(span),
        3 => sine(span).max(sine(&span.reciprocal())),
        _ => sine(&span.reciprocal()),
    }
}
