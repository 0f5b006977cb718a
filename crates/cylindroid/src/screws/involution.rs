//! Lines in involution: joint axes that transmit a load without joint torques.
//!
//! Formula  lines J = (s_1 ... s_m) are in involution iff det(J^T Q_0 J) = 0: either they are
//!          dependent, or their span meets its own reciprocal system in a twist z; the wrench
//!          Q_0 z then does no work on any of the lines, although it is a sum of forces along them
//! Shapes   m lines, z a twist, Q_0 z a wrench
//! Units    m; z is a unit vector at the centre and length of the system
//! Valid    2 to 6 lines. z may be of infinite pitch, and the wrench then a pure couple
//! Source   Donelan & Selig, section 4, with corrections: four independent lines are in involution
//!          iff their two transversals coincide (also at infinity) or are infinitely many; five
//!          iff they have a common transversal, which may lie at infinity; "involution iff forces
//!          on the lines in equilibrium" (Sylvester) is for six lines
//! Checked  tests/it/screws/vectors/lines.rs

use super::screw::{Line, Screw};
use super::span_estimation::ScrewOptions;
use super::system::ScrewSystem;
use super::transversals::{Transversals, transversals_of};
use crate::error::Result;
use crate::linalg::SymmetricEigen;
use crate::spatial::{Twist, Wrench};

/// Report on the involution of a set of lines.
#[derive(Debug, Clone)]
pub struct Involution {
    /// Number of lines.
    pub lines: usize,
    /// True if the Gram matrix of the lines in the Klein form is singular.
    pub in_involution: bool,
    /// True if none of the lines is spanned by the others.
    pub independent: bool,
    /// The twists of the lines' span that are reciprocal to all of it.
    pub null_twists: Vec<Twist>,
    /// The first of them as a screw: a common transversal where its pitch is zero.
    pub null_screw: Option<Screw>,
    /// The wrench on it, which needs no torque at joints on the lines.
    pub wrench: Option<Wrench>,
    /// The lines that meet all lines.
    pub transversals: Transversals,
    /// Smallest singular value of the Gram matrix of the span: at or below `threshold` it is zero.
    pub margin: f64,
    /// See `margin`.
    pub threshold: f64,
    /// The system that the lines span.
    pub system: ScrewSystem,
}

/// Whether `lines` are in involution (Sylvester), and what follows from it.
///
/// ```text
/// det(J^T Q_0 J) = 0,   J = (s_1 ... s_m) the lines as twists of pitch zero
/// ```
///
/// Independent lines are in involution if and only if their span contains a twist z that is
/// reciprocal to all of it. The wrench `Q_0 z` then does no work on any of the lines: an arm with
/// these revolute axes carries it without torque. z may be a translation, and the wrench a pure
/// couple. Lines in m.
///
/// ```
/// use cylindroid::screws::{Line, ScrewOptions, involution};
/// use cylindroid::Vec3;
///
/// // Four lines that meet the x axis, itself among them: one common transversal, counted twice.
/// let through = |x: f64, d: [f64; 3]| {
///     Line::through(Vec3::new(x, 0.0, 0.0), Vec3::from_array(d)).unwrap()
/// };
/// let lines = [
///     through(0.0, [1.0, 0.0, 0.0]),
///     through(0.0, [0.0, 0.0, 1.0]),
///     through(1.0, [0.0, 1.0, 0.0]),
///     through(2.0, [0.0, 1.0, 1.0]),
/// ];
/// let found = involution(&lines, &ScrewOptions::default())?;
/// assert!(found.independent && found.in_involution && found.transversals.double);
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// Source: Donelan & Selig, section 4, corrected for four and five lines in the chapter
/// `docs/theory/screws.md` of the book.
///
/// # Errors
/// Invalid options.
pub fn involution(lines: &[Line], options: &ScrewOptions) -> Result<Involution> {
    let twists: Vec<_> = lines.iter().map(Line::twist).collect();
    let system = ScrewSystem::of(&twists, options)?;
    let independent = system.order() == lines.len();
    let k = system.order();
    let gram = SymmetricEigen::of(system.span.gram(0.0), k);
    let threshold = system.tolerance.class;
    let null_twists: Vec<Twist> = (0..k)
        .filter(|&i| gram.values[i].abs() <= threshold)
        .map(|i| {
            let mut x = [0.0; 6];
            for (b, c) in system.span.vectors().iter().zip(gram.vectors[i]) {
                x.iter_mut().zip(b).for_each(|(xi, bi)| *xi += c * bi);
            }
            // What counts as zero is zero: a couple is a couple.
            if x[3..].iter().all(|w| w.abs() <= threshold) {
                x[3..].fill(0.0);
            }
            system.scale.undo(&x)
        })
        .collect();
    let first = null_twists.first().copied();
    Ok(Involution {
        lines: lines.len(),
        in_involution: !independent || first.is_some(),
        independent,
        null_screw: first.and_then(Screw::of),
        wrench: first.map(|z| z.lowered(0.0)),
        null_twists,
        transversals: transversals_of(&system),
        margin: system.span.gram_margin(0.0),
        threshold,
        system,
    })
}
