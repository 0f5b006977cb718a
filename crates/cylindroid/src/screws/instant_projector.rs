//! Projectors from twists alone, without allocation, for motions that change at every step of a
//! control loop.
//!
//! Formula  P as in `projector.rs`; S the span of the given twists: orthonormal at the centre, by
//!          elimination with pivoting (the twist with the largest remainder first)
//! Shapes   any number of twists
//! Units    L, centre and h in m and m/rad
//! Valid    no allocation where P exists. Where it does not, or enlarges a twist by more than
//!          `tolerance::MAX_PROJECTION_NORM` (at the centre, lengths over L), the reason is a value
//! Why so   a [`ScrewSystem`] also computes class, frame and principal screws, and allocates; its
//!          rank is that of singular values, here it is that of the pivots, which are nowhere
//!          smaller
//! Checked  tests/it/servo/hybrid.rs::projectors_of_twists, tests/allocation/main.rs

use super::existence::NoInverse;
use super::projector::{Projector, coordinates, oblique_coordinates};
use super::span::{Scale, Span, dot, least_squares_center, turns};
use super::span_estimation::ScrewOptions;
use super::system::ScrewSystem;
use crate::error::{Error, Result};
use crate::spatial::Twist;
use crate::tolerance::{MAX_PROJECTION_NORM, NOISE_RANK, SCREW_CLASS, SCREW_RANK};

/// The complement of a projector: the twists along which it projects.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Complement<'a> {
    /// The twists that are h-reciprocal to the motions, in every frame: P_h.
    Reciprocal {
        /// Pitch of the form [m/rad]; infinite for the limit.
        h: f64,
    },
    /// The sums of these twists, which complete the motions to all six dimensions.
    Twists(&'a [Twist]),
}

impl Projector {
    /// The projector on the span of `motions`, or the reason why there is none; all twists in one
    /// frame.
    ///
    /// ```
    /// use cylindroid::screws::{Complement, Projector, ScrewOptions};
    /// use cylindroid::{Twist, Vec3};
    ///
    /// // A ball on a table, seen from the point of contact: it turns as it likes, and slides.
    /// let turn = |angular| Twist { linear: Vec3::ZERO, angular };
    /// let slide = |linear| Twist { linear, angular: Vec3::ZERO };
    /// let free = [turn(Vec3::X), turn(Vec3::Y), turn(Vec3::Z), slide(Vec3::X), slide(Vec3::Y)];
    /// let options = ScrewOptions::with_length(0.1);
    /// let along = Complement::Reciprocal { h: f64::INFINITY };
    /// let projector = Projector::of(&free, along, &options)?.expect("it exists");
    /// assert!(projector.motion(slide(Vec3::Z)).linear.norm() < 1e-15);
    /// // The rotation about the normal is reciprocal to all of them, itself included.
    /// let none = Projector::of(&free, Complement::Reciprocal { h: 0.0 }, &options)?;
    /// println!("{}", none.unwrap_err());
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// Non-finite twists or options, a pitch that is NaN, a length that is not one of [`LENGTHS`](crate::tolerance::LENGTHS).
    pub fn of(
        motions: &[Twist],
        along: Complement<'_>,
        options: &ScrewOptions,
    ) -> Result<std::result::Result<Self, NoInverse>> {
        options.check()?;
        check("motion", motions)?;
        match along {
            Complement::Twists(twists) => check("twist to give up", twists)?,
            Complement::Reciprocal { h } if h.is_nan() => {
                return Err(Error::NotFinite { what: "pitch h".into(), value: h });
            }
            Complement::Reciprocal { .. } => {}
        }
        let scale = scale(motions, along, options);
        let span = spanned(motions, scale, options.noise);
        let found = match along {
            Complement::Reciprocal { h } => coordinates(&span, h / scale.length),
            Complement::Twists(twists) => {
                let other = spanned(twists, scale, options.noise);
                let Some(found) = oblique_coordinates(&span, &other, SCREW_CLASS) else {
                    let (order, other) = (span.k(), other.k());
                    return Ok(Err(NoInverse::NotComplementary { order, other }));
                };
                Some(found)
            }
        };
        // P = B C with B orthonormal is as large as C.
        let size = |c: &[[f64; 6]; 6]| c[..span.k()].iter().map(|r| dot(r, r)).sum::<f64>().sqrt();
        let norm = found.as_ref().map_or(f64::INFINITY, size);
        Ok(match (found, along) {
            (Some(coordinates), _) if norm <= MAX_PROJECTION_NORM => {
                Ok(Self { scale, span, coordinates })
            }
            (_, Complement::Reciprocal { h }) => {
                let options = ScrewOptions { center: Some(scale.center), ..*options };
                let reason = ScrewSystem::of(motions, &options)?.existence(h).reason;
                Err(reason.unwrap_or(NoInverse::TooLarge { norm }))
            }
            (_, Complement::Twists(_)) => Err(NoInverse::TooLarge { norm }),
        })
    }
}

fn check(what: &str, twists: &[Twist]) -> Result<()> {
    match twists.iter().position(|t| !t.is_finite()) {
        None => Ok(()),
        Some(i) => Error::check_finite(&format!("{what} {}", i + 1), &twists[i].to_array()),
    }
}

/// At the axes of the motions; where these are translations, of the twists that are dropped.
fn scale(motions: &[Twist], along: Complement<'_>, options: &ScrewOptions) -> Scale {
    let length = options.length;
    let turning = |twists: &[Twist]| twists.iter().any(|t| turns(t, length, SCREW_CLASS));
    let twists = match along {
        Complement::Twists(twists) if !turning(motions) => twists,
        _ => motions,
    };
    let center =
        options.center.unwrap_or_else(|| least_squares_center(twists, length, SCREW_CLASS));
    Scale { center, length }
}

/// Their span, dependent ones left out.
fn spanned(twists: &[Twist], scale: Scale, noise: f64) -> Span {
    let largest = |t: &Twist| (t.linear.norm() / scale.length).max(t.angular.norm());
    let size = twists.iter().map(largest).fold(0.0, f64::max);
    // Twists that are rounding errors of the others span nothing.
    let used = || twists.iter().filter(|t| largest(t) > SCREW_RANK * size);
    // Made of size one before they are squared, then of length one; with the digits that the way
    // to the centre costs.
    let unit = |t: &Twist| {
        let x = scale.apply(*t * (1.0 / largest(t)));
        let norm = dot(&x, &x).sqrt();
        (x.map(|a| a / norm), 1.0 / norm)
    };
    let amplification = used().map(|t| unit(t).1).fold(1.0, f64::max);
    let threshold = SCREW_RANK.max(NOISE_RANK * noise * amplification).min(0.5);
    let mut span = Span::ZERO;
    while span.k() < 6 {
        let outside = |t: &Twist| {
            let (x, _) = unit(t);
            (span.project_out(&mut x.clone()), x)
        };
        let farthest = used().map(outside).max_by(|a, b| a.0.total_cmp(&b.0));
        match farthest {
            Some((sine, x)) if sine > threshold => span.push(x),
            _ => break,
        };
    }
    span
}
