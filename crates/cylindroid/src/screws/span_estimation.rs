//! Estimation of the span of a set of twists: centre, rank and thresholds from noise.
//!
//! Formula  singular values of the unit columns [v(c) / L; w] / |.|, c the least-squares point of
//!          the axes of a basis that is orthonormal at c: a fixed point, found by iteration
//! Units    L, c in m; thresholds without unit
//! Valid    any twists; the result depends on the frame and on the unit to rounding alone
//! Why so   a rank needs a scale, and noise on a twist far from the origin is noise on its moment:
//!          the thresholds include the distance to the centre
//! Checked  tests/it/screws/classes.rs

use super::span::{Scale, Span, angular, dot, least_squares_center, over, size};
use crate::error::{Error, Result};
use crate::linalg::{Matrix, Rank, Svd};
use crate::scalar::{clamp, power_of_two};
use crate::spatial::{Twist, Vec3};
use crate::tolerance::{
    AMBIGUOUS, CENTER_FOUND, FAR_AXIS, FAR_ORIGIN, LENGTHS, MAX_MAGNITUDE, NOISE_CLASS,
    NOISE_CONDITION, NOISE_OF_ZERO, NOISE_RANK, SCREW_CLASS, SCREW_RANK,
};

/// Steps to the centre at most; each shortens the way by a factor that depends on the system.
const CENTER_STEPS: usize = 64;

/// Options of screw systems: characteristic length, centre and noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScrewOptions {
    /// The characteristic length L, in the unit of the twists' linear parts: the `reach` of an arm,
    /// the size of a workspace.
    pub length: f64,
    /// The point at which lengths are measured; `None` for the point nearest to all axes.
    pub center: Option<Vec3>,
    /// Error of the twists, relative to the size of each in this frame.
    ///
    /// A frame far from the axes makes moments large, and the same number then stands for a larger
    /// error at the axes. From an origin at a distance d, the same error at the axes is this number
    /// over `hypot(1, d / length)`. With a noise above rounding, the class of a system near a
    /// threshold may still differ between frames.
    pub noise: f64,
}

impl Default for ScrewOptions {
    /// L = 1, at the axes, exact to rounding.
    fn default() -> Self {
        Self { length: 1.0, center: None, noise: f64::EPSILON }
    }
}

impl ScrewOptions {
    /// The defaults with this characteristic length.
    ///
    /// ```
    /// use cylindroid::screws::ScrewOptions;
    ///
    /// let robot = cylindroid::load("ur5e")?;
    /// assert_eq!(ScrewOptions::with_length(robot.reach()).length, robot.reach());
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[must_use]
    pub fn with_length(length: f64) -> Self {
        Self { length, ..Self::default() }
    }

    /// Validates the options.
    ///
    /// # Errors
    /// [`Error::InvalidOption`] with the option and its value.
    pub fn check(&self) -> Result<()> {
        Error::check_range("length", self.length, &LENGTHS)?;
        if !(self.noise >= 0.0 && self.noise < 0.1) {
            return Err(Error::InvalidOption {
                option: "noise",
                value: self.noise.to_string(),
                reason: "noise is relative to the twists; it must be at least 0 and below 0.1"
                    .to_owned(),
            });
        }
        match self.center {
            Some(c) => Error::check_within("center", &c.to_array(), MAX_MAGNITUDE),
            None => Ok(()),
        }
    }
}

/// Thresholds of one system, without unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Tolerances {
    pub(super) rank: f64,
    pub(super) class: f64,
    /// What noise asks for as a threshold of the class.
    pub(super) noise: f64,
    /// What the noise of these twists, which may be conditioned worse, makes of it.
    pub(super) of_twists: f64,
    /// True if a singular value lies near the threshold of the rank.
    pub(super) narrow_rank: bool,
}

/// Within [`AMBIGUOUS`] of its threshold, unless it is what noise, which asks for a threshold of
/// its own, makes of zero.
pub(super) fn is_narrow(value: f64, threshold: f64, noise: f64) -> bool {
    value < threshold * AMBIGUOUS && value > (threshold / AMBIGUOUS).max(NOISE_OF_ZERO * noise)
}

impl Tolerances {
    /// True if a quantity does not decide the class with certainty.
    pub(super) fn is_narrow(&self, value: f64) -> bool {
        is_narrow(value, self.class, self.noise)
            || (value > self.class && value < self.of_twists * AMBIGUOUS)
    }
}

/// The twists that are the columns of a matrix with six rows.
pub(super) fn columns(jacobian: &Matrix) -> Result<Vec<Twist>> {
    Error::check_len("rows of the matrix of twists", 6, jacobian.rows())?;
    Ok((0..jacobian.cols()).map(|j| Twist::from_array(six(jacobian.column(j)))).collect())
}

pub(super) fn six(x: &[f64]) -> [f64; 6] {
    std::array::from_fn(|i| x[i])
}

/// Span, scale, thresholds and rank of a set of twists.
pub(super) fn spanned(twists: &[Twist], options: &ScrewOptions) -> (Span, Scale, Tolerances, Rank) {
    let largest = |t: &Twist| size(*t, options.length);
    let most = twists.iter().map(largest).fold(0.0, f64::max);
    // Twists that are rounding errors of the others span nothing. Over a power of two, which
    // changes no digit, squares of the others neither overflow nor vanish.
    let power = power_of_two(most);
    let used: Vec<Twist> =
        twists.iter().filter(|t| largest(t) > SCREW_RANK * most).map(|t| over(*t, power)).collect();
    let noise = |factor: f64| NOISE_CLASS * options.noise * factor;
    let class = |factor: f64| clamp(noise(factor), SCREW_CLASS, 0.1);
    let mut scale = Scale {
        center: options
            .center
            .unwrap_or_else(|| least_squares_center(&used, options.length, class(1.0))),
        length: options.length,
    };
    // How much of the digits the way to the centre costs.
    let amplification = |scale: &Scale| {
        used.iter()
            .map(|t| {
                let x = scale.apply(*t);
                let moved = t.angular.norm() * scale.center.norm() / scale.length;
                largest(t).max(moved) / dot(&x, &x).sqrt()
            })
            .fold(1.0, f64::max)
    };
    if options.center.is_none() && !used.is_empty() {
        let amplified = amplification(&scale);
        let span = basis(&used, scale, NOISE_RANK * options.noise * amplified);
        let independent: Vec<Twist> = span.vectors().iter().map(|x| scale.undo(x)).collect();
        scale = center_of(&independent, scale, class(NOISE_CONDITION).max(FAR_AXIS));
    }
    let found = decompose(&used, scale, options, amplification(&scale));
    // Of the space, not of the twists that span it: the threshold is then the same for all of them.
    let lever = match scale.center.norm() / scale.length {
        0.0 => 0.0,
        away => found.span.largest_angular_part() * away,
    };
    let factor = NOISE_CONDITION * lever.hypot(1.0);
    let tolerance = Tolerances {
        rank: found.rank.threshold,
        class: class(factor),
        noise: noise(factor),
        of_twists: noise(amplification(&scale) * found.conditioning),
        narrow_rank: found.narrow,
    };
    (found.span, scale, tolerance, found.rank)
}

/// The centre of the space that these independent twists span: a function of the space and, along
/// directions nearly parallel to all axes, of the origin of the frame, not of the twists.
///
/// Each step goes to the least-squares point of the axes of a basis that is orthonormal at the
/// previous one and in which the angular parts are orthogonal: unique as long as the choice
/// matters.
fn center_of(twists: &[Twist], start: Scale, turning: f64) -> Scale {
    // All of space is the same at every point, so that the origin will do unless the axes are far from it.
    if twists.len() == 6 && start.center.norm() < FAR_ORIGIN * start.length {
        return Scale { center: Vec3::ZERO, ..start };
    }
    let at = |scale: Scale| Span::of_independent(twists.iter().map(|t| scale.apply(*t)));
    let origin = Scale { center: Vec3::ZERO, ..start };
    // The origin is a start that all twists of the space share, unless axes are far from it.
    let near_axes = |scale: Scale| {
        let span = at(scale);
        let sines = span.turned_by_angular_parts().map(|x| angular(&x).norm());
        sines.filter(|sine| 2.0 * FAR_ORIGIN * sine > 1.0).count()
    };
    let turns = at(start).largest_angular_part() > turning;
    // Of four twists some pure rotation is about any point: a start far away says nothing.
    let near = twists.len() > 3 || start.center.norm() < 5.0 * FAR_ORIGIN * start.length;
    let shared = !turns || (near && near_axes(origin) >= near_axes(start).max(1));
    let first = if shared { origin } else { start };
    let near = stationary(twists, first, turning);
    // Where the system is the same at every point of a line or a plane, as far as can be told, it
    // is the point nearest to the origin; not from so far that the way costs digits.
    let center = at(near)
        .free_translations(0.0)
        .filter(|e| e.dot(near.center).abs() < FAR_ORIGIN * near.length)
        .fold(near.center, |c, e| c - e * e.dot(c));
    stationary(twists, Scale { center, ..near }, turning)
}

/// The fixed point that is reached from `start`.
fn stationary(twists: &[Twist], start: Scale, turning: f64) -> Scale {
    let mut scale = start;
    let mut twists = twists.to_vec();
    let mut before: Option<Vec3> = None;
    for _ in 0..CENTER_STEPS {
        let span = Span::of_independent(twists.iter().map(|t| scale.apply(*t)));
        twists = span.turned_by_angular_parts().map(|x| scale.undo(&x)).collect();
        let step = least_squares_center(&twists, scale.length, turning) - scale.center;
        scale.center += step;
        if step.norm() <= CENTER_FOUND * scale.length {
            break;
        }
        // Every step is a fraction of the previous one: two determine the limit (Aitken).
        let part = before.map_or(0.0, |b: Vec3| step.dot(b) / b.dot(b));
        if part > 0.0 && part < 0.9 {
            scale.center += step * (part / (1.0 - part));
            before = None;
        } else {
            before = Some(step);
        }
    }
    scale
}

/// The columns, made orthonormal in their order, those left out that depend on the ones before
/// them.
fn basis(twists: &[Twist], scale: Scale, noise: f64) -> Span {
    let (mut span, mut smallest) = (Span::ZERO, 1.0_f64);
    for t in twists {
        // Noise of a basis vector is that of its column over its part outside the others.
        let threshold = SCREW_CLASS.max(noise / smallest);
        if let Some(rest) = span.push_independent(scale.apply(*t), threshold) {
            smallest = smallest.min(rest);
        }
    }
    span
}

struct Decomposed {
    span: Span,
    rank: Rank,
    conditioning: f64,
    narrow: bool,
}

fn decompose(
    twists: &[Twist],
    scale: Scale,
    options: &ScrewOptions,
    amplification: f64,
) -> Decomposed {
    let mut unit = Matrix::zeros(6, twists.len());
    for (j, t) in twists.iter().enumerate() {
        let x = scale.apply(*t);
        let norm = dot(&x, &x).sqrt();
        if norm > 0.0 {
            unit.column_mut(j).copy_from_slice(&x.map(|a| a / norm));
        }
    }
    let svd = Svd::of(&unit);
    let noise = NOISE_RANK * options.noise * amplification;
    let threshold = SCREW_RANK.max(noise).min(0.5);
    let k = (0..svd.len()).filter(|&i| svd.value(i) > threshold).count();
    let next = if k < svd.len() { svd.value(k) } else { 0.0 };
    let last = if k > 0 { svd.value(k - 1) } else { 0.0 };
    let gap = if k == 0 || next == 0.0 { f64::INFINITY } else { last / next };
    Decomposed {
        span: Span::of_independent((0..k).map(|i| six(svd.u(i)))),
        rank: Rank { rank: k, threshold, gap },
        conditioning: if k == 0 { 1.0 } else { svd.value(0) / last },
        narrow: svd.values().any(|s| is_narrow(s, threshold, noise)),
    }
}
