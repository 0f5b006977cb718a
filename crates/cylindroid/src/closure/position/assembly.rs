//! Assembly: a configuration near an initial guess in which all loops and contacts are closed.
//!
//! Formula  damped Gauss-Newton (Levenberg-Marquardt): (J^T J + l^2) dq = -J^T r, with r the
//!          loop-closure residuals and J their Jacobian; the damping l is divided by ten when the
//!          residual decreases and multiplied by ten when it does not. Every step is clamped to the
//!          position limits, and coordinates that push against a limit are left out of it
//! Shapes   r: t rows, J: t x free coordinates
//! Units    rows of lengths divided by the characteristic length, columns of lengths multiplied by
//!          it
//! Valid    any guess. The result is the last configuration with its loop-closure error. Near an
//!          assembly the steps are Newton steps, and the residual falls to rounding. One assembly
//!          is found, usually the nearest; there may be others, and failure to find one is not a
//!          proof that none exists
//! Source   Levenberg 1944, Marquardt 1963; the rows: `constraint_rows.rs`
//! Checked  tests/it/closure/assembly.rs

use super::coordinates::{at_limit, columns, free_places, largest_change, moved, within_limits};
use super::loop_closure::LoopClosure;
use crate::closure::constraint::loop_closure_error::LoopClosureError;
use crate::closure::constraint::rate_rank::rate_rank;
use crate::error::Result;
use crate::inverse::damp;
use crate::linalg::{Matrix, Svd};
use crate::model::Mechanism;
use crate::tolerance::CLOSURE_RANK;

/// Maximum number of steps: a dozen suffice if there is an assembly nearby.
pub(super) const MAX_STEPS: usize = 200;
/// Initial damping, and the largest that is tried, relative to the largest singular value [-].
const DAMPING: (f64, f64) = (1e-3, 1e8);
/// Largest change of a joint in one step [rad, or characteristic lengths].
const MAX_CHANGE: f64 = 0.5;

/// The result of closing the loops from an initial guess.
#[derive(Debug, Clone, PartialEq)]
pub struct Assembly {
    /// The configuration.
    pub q: Vec<f64>,
    /// True if every loop and contact is closed to `tolerance::CLOSED` of the characteristic length
    /// and in angle.
    pub closed: bool,
    /// How far loops and contacts are open.
    pub closure_error: LoopClosureError,
    /// Number of steps taken.
    pub steps: usize,
    /// Coordinates at a position limit or beyond it: indices into `q`.
    pub at_limit: Vec<usize>,
}

/// Closes the loops of `mechanism` from the initial guess `guess`. The `prescribed` coordinates
/// (indices into `q`) keep their values, the others stay within their position limits (a guess
/// beyond them whose loops are closed is returned unchanged, with these coordinates listed in
/// `at_limit`). Loop joints have no coordinate: their limits are not enforced, and an actuated one
/// cannot be prescribed.
///
/// ```text
/// (J^T J + l^2) dq = -J^T r
/// ```
///
/// Damped Gauss-Newton (Levenberg-Marquardt): r are the loop-closure residuals, J their Jacobian, l
/// the damping; lengths are divided by the characteristic length. Failure to close the loops is not
/// a proof that no assembly exists.
///
/// ```
/// use cylindroid::closure::assemble;
///
/// let five_bar = cylindroid::load("five-bar")?;
/// // The first two coordinates are prescribed, the others follow.
/// let assembly = assemble(&five_bar, &[-0.2, 0.1, 0.0, 0.0], &[0, 1])?;
/// assert!(assembly.closed && assembly.q[..2] == [-0.2, 0.1]);
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// # Errors
/// A guess of the wrong size or with non-finite values; a prescribed index that is no coordinate,
/// or some but not all coordinates of a spherical or free joint.
#[doc(alias = "loop closure")]
#[doc(alias = "Levenberg-Marquardt")]
pub fn assemble(mechanism: &Mechanism, guess: &[f64], prescribed: &[usize]) -> Result<Assembly> {
    assemble_within(mechanism, guess, prescribed, MAX_STEPS)
}

/// [`assemble`] in at most so many steps.
pub(super) fn assemble_within(
    mechanism: &Mechanism,
    guess: &[f64],
    prescribed: &[usize],
    most_steps: usize,
) -> Result<Assembly> {
    mechanism.check_q("guess", guess)?;
    let free = free_places(mechanism, prescribed)?;
    let length = mechanism.reach();
    let mut now = LoopClosure::at(mechanism, guess, &free, length)?;
    if !now.is_closed(length) {
        let within = within_limits(mechanism, guess.to_vec(), &free);
        now = LoopClosure::at(mechanism, &within, &free, length)?;
    }
    let mut damping = DAMPING.0;
    let mut steps = 0;
    while now.residual_norm > 0.0 && steps < most_steps && damping < DAMPING.1 {
        steps += 1;
        let q = damped_step(mechanism, &now, &free, damping);
        let next = LoopClosure::at(mechanism, &q, &free, length)?;
        // NaN is no improvement.
        if next.residual_norm < now.residual_norm {
            let little = next.residual_norm > 0.5 * now.residual_norm && next.is_closed(length);
            (now, damping) = (next, 0.1 * damping);
            if little {
                break; // rounding
            }
        } else if now.is_closed(length) {
            break;
        } else {
            damping *= 10.0;
        }
    }
    Ok(Assembly {
        closed: now.is_closed(length),
        closure_error: now.closure_error,
        at_limit: at_limit(mechanism, &now.q),
        q: now.q,
        steps,
    })
}

/// The passive coordinates for given actuated ones: [`assemble`] with the actuated coordinates
/// prescribed.
///
/// An actuated loop joint has no coordinate that could be prescribed: a mechanism with such joints
/// keeps their degrees of freedom, and the nearest assembly is returned. If there are more
/// actuators than degrees of freedom, their values may contradict each other: the result is then
/// not closed, its loop-closure error is the remaining one, distributed by least squares, and the
/// actuated coordinates keep the given values.
///
/// ```
/// use cylindroid::closure::recover_passive;
///
/// let stewart = cylindroid::load("stewart")?;
/// let mut guess = stewart.home().to_vec();
/// let leg = stewart.actuated().next().unwrap();
/// guess[leg] += 0.05;
/// let assembly = recover_passive(&stewart, &guess)?;
/// assert!(assembly.closed && assembly.q[leg] == guess[leg]);
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// # Errors
/// As [`assemble`].
pub fn recover_passive(mechanism: &Mechanism, guess: &[f64]) -> Result<Assembly> {
    let actuated: Vec<usize> = mechanism.actuated().collect();
    assemble(mechanism, guess, &actuated)
}

/// The configuration after a damped step, within the position limits: coordinates at a limit that
/// would move beyond it are left out. `free` are those of the Jacobian.
fn damped_step(
    mechanism: &Mechanism,
    here: &LoopClosure,
    free: &[usize],
    damping: f64,
) -> Vec<f64> {
    let mut jacobian = here.jacobian.clone();
    let mut places = free.to_vec();
    loop {
        let mut change = damped_change(&jacobian, &here.residuals, damping);
        let largest = largest_change(mechanism, &places, &change);
        if largest > MAX_CHANGE {
            change.iter_mut().for_each(|c| *c *= MAX_CHANGE / largest);
        }
        let q = moved(mechanism, &here.q, &places, &change);
        let blocked = |i: usize| {
            let (before, l) = (here.q[i], mechanism.coordinates()[i].limits);
            (before <= l.lower && q[i] < l.lower) || (before >= l.upper && q[i] > l.upper)
        };
        let moving: Vec<usize> = (0..places.len()).filter(|&k| !blocked(places[k])).collect();
        if moving.len() == places.len() {
            return within_limits(mechanism, q, free);
        }
        jacobian = columns(&jacobian, &moving);
        places = moving.iter().map(|&k| places[k]).collect();
    }
}

/// The damped least-squares change of the coordinates of this Jacobian; none where all rates are zero,
/// or rounding: it would be of any size.
fn damped_change(jacobian: &Matrix, residuals: &[f64], damping: f64) -> Vec<f64> {
    let svd = Svd::of(jacobian);
    if rate_rank(&svd, CLOSURE_RANK) == 0 {
        return vec![0.0; jacobian.cols()];
    }
    let l = damping * svd.largest();
    svd.apply_gains(residuals, |_, s| -damp(s, l))
}
