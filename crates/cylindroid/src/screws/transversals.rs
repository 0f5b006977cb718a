//! Transversals: the lines that meet every line of a set.
//!
//! Formula  the page of [`transversals`]
//! Units    m
//! Valid    any number of lines. Two, three and most sets of fewer than four lines have infinitely
//!          many; four have two, one double, none, or infinitely many; a translation among the
//!          zeros is a transversal at infinity: a line that is met there by lines parallel to one
//!          plane
//! Source   Hilbert & Cohn-Vossen, section 3 (regulus); Donelan & Selig, section 4, whose counts
//!          for four and five lines omit the transversals at infinity and the double one
//! Checked  tests/it/screws/vectors/lines.rs

use super::screw::{Line, Screw};
use super::span::angular;
use super::span_estimation::ScrewOptions;
use super::system::ScrewSystem;
use crate::error::Result;
use crate::linalg::SymmetricEigen;
use crate::spatial::Vec3;

/// The common transversals of a set of lines.
#[derive(Debug, Clone, PartialEq)]
pub struct Transversals {
    /// True if there are infinitely many; then `lines` is empty (see
    /// [`Line::transversal_through`] for those of two or three lines).
    pub infinitely_many: bool,
    /// The transversals, where they are finitely many: none, one or two.
    pub lines: Vec<Line>,
    /// Transversals at infinity, each as the direction normal to the planes that hold it.
    pub at_infinity: Vec<Vec3>,
    /// True if the one transversal counts twice: two have come together.
    pub double: bool,
}

/// The common transversals of `lines`.
///
/// ```text
/// z meets every line  iff  <z, l_i>_0 = 0 for all i  and  <z, z>_0 = 0
/// ```
///
/// The transversals are the zeros of the Klein form `<a, b>_0 = 1/2 (v_a . w_b + w_a . v_b)` on the
/// reciprocal system of the lines. Points in m, in the frame of the lines. Fewer than four lines
/// have in general infinitely many; four have two, one double, none, or infinitely many. A
/// translation among the zeros is a transversal at infinity, which meets the lines parallel to one
/// plane.
///
/// Source: Hilbert & Cohn-Vossen, section 3 (regulus); Donelan & Selig, section 4, whose counts for
/// four and five lines omit the transversals at infinity and the double one.
///
/// ```
/// use cylindroid::screws::{Line, ScrewOptions, transversals};
/// use cylindroid::Vec3;
///
/// // Infinitely many lines meet two given lines.
/// let a = Line { point: Vec3::ZERO, direction: Vec3::X };
/// let b = Line { point: Vec3::Z, direction: Vec3::Y };
/// assert!(transversals(&[a, b], &ScrewOptions::default())?.infinitely_many);
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// # Errors
/// Invalid options.
pub fn transversals(lines: &[Line], options: &ScrewOptions) -> Result<Transversals> {
    let twists: Vec<_> = lines.iter().map(Line::twist).collect();
    Ok(transversals_of(&ScrewSystem::of(&twists, options)?))
}

/// The lines that meet every line of a system spanned by lines.
pub(super) fn transversals_of(system: &ScrewSystem) -> Transversals {
    let span = system.span.reciprocal();
    let tolerance = system.tolerance.class;
    let (d, klein) = (span.k(), SymmetricEigen::of(span.gram(0.0), span.k()));
    let vector = |coefficients: &[f64; 6]| {
        let mut x = [0.0; 6];
        for (b, c) in span.vectors().iter().zip(coefficients) {
            x.iter_mut().zip(b).for_each(|(xi, bi)| *xi += c * bi);
        }
        x
    };
    let eigenvector = |i: usize| vector(&klein.vectors[i]);
    let (mut positive, mut negative, mut zero) = (vec![], vec![], vec![]);
    for (i, &value) in klein.values.iter().enumerate().take(d) {
        if value > tolerance {
            positive.push(i);
        } else if value < -tolerance {
            negative.push(i);
        } else {
            zero.push(i);
        }
    }
    let mut found =
        Transversals { infinitely_many: false, lines: vec![], at_infinity: vec![], double: false };
    let zeros: Vec<[f64; 6]> = match (positive.as_slice(), negative.as_slice(), zero.as_slice()) {
        ([p], [n], []) => {
            let (up, down) = (klein.values[*p].sqrt(), (-klein.values[*n]).sqrt());
            let (a, b) = (eigenvector(*p), eigenvector(*n));
            let combine = |s: f64| std::array::from_fn(|i| down * a[i] + s * up * b[i]);
            vec![combine(1.0), combine(-1.0)]
        }
        ([], [], []) => vec![],
        ([..], [..], [_, ..]) if positive.is_empty() || negative.is_empty() => {
            let all: Vec<_> = zero.iter().map(|&i| eigenvector(i)).collect();
            let turning = all.iter().any(|x| angular(x).norm() > tolerance);
            if all.len() > 1 && turning {
                found.infinitely_many = true;
                return found;
            }
            found.double = all.len() == 1 && d == 2 && turning;
            all
        }
        ([], _, []) | (_, [], []) => vec![],
        _ => {
            found.infinitely_many = true;
            return found;
        }
    };
    for x in zeros {
        let twist = system.scale.undo(&x);
        if angular(&x).norm() > tolerance {
            found.lines.extend(Screw::of(twist).map(|s| s.axis));
        } else {
            found.at_infinity.extend(twist.linear.unit(0.0));
        }
    }
    found
}
