//! Assembly: a configuration near a guess in which all loops and contacts are closed.
//!
//! Formula  damped Gauss-Newton: (J^T J + l^2) dq = -J^T r, r what should be held and is not, J its
//!          rates; the damping falls by ten when the error does, and rises by ten when it does not;
//!          every step is cut to the position limits, and coordinates that push against theirs
//!          take no part in it
//! Shapes   r: held rows, J: held rows x free coordinates
//! Units    rows of lengths over the reach, columns of lengths times it
//! Valid    any guess; the answer is the last configuration and how far its loops are open. Where
//!          the guess is near an assembly the steps are Newton's, and the error falls to rounding.
//!          It finds one assembly, mostly the nearest; there may be others, and not to find one
//!          proves nothing
//! Source   Levenberg 1944, Marquardt 1963; the rows: `closed_chain.rs`
//! Checked  tests/it/closure/assembly.rs

use super::coordinates::{at_limit, column_scale, columns, free_places, moved, within_limits};
use crate::closure::constraint::closed_chain::LoopClosureError;
use crate::closure::constraint::constraint_rows::{ConstraintRow, constraint_rows, for_each_rate};
use crate::error::Result;
use crate::inverse::damp;
use crate::linalg::{Matrix, Svd, norm};
use crate::model::Mechanism;

/// Steps at most: a dozen suffice where there is an assembly near.
const MOST_STEPS: usize = 200;
/// First damping, and the largest that is tried, relative to the largest singular value [-].
const DAMPING: (f64, f64) = (1e-3, 1e8);
/// Largest change of any coordinate in a step [rad, or reaches].
const LARGEST_STEP: f64 = 0.5;

/// What came of an attempt to close the loops.
#[derive(Debug, Clone, PartialEq)]
pub struct Assembly {
    /// The configuration.
    pub q: Vec<f64>,
    /// True if every loop and contact is closed to `tolerance::CLOSED` of the reach and in angle.
    pub closed: bool,
    /// How far they are open.
    pub closure_error: LoopClosureError,
    /// Steps taken.
    pub steps: usize,
    /// Coordinates that stand at a position limit or beyond: places in `q`.
    pub at_limit: Vec<usize>,
}

/// Closes the loops of `mechanism` from `guess`; the coordinates in `held` keep their values, the
/// others their position limits (a guess beyond them whose loops are closed is returned as it is,
/// with the coordinates named in `at_limit`). Closing joints have no coordinate: their limits do
/// not count, and one that is driven cannot be held.
///
/// ```
/// use cylindroid::closure::assemble;
///
/// let five_bar = cylindroid::load("five-bar")?;
/// // The first two joints as wanted, the others follow.
/// let assembly = assemble(&five_bar, &[-0.2, 0.1, 0.0, 0.0], &[0, 1])?;
/// assert!(assembly.closed && assembly.q[..2] == [-0.2, 0.1]);
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// # Errors
/// A guess of the wrong size or not finite; a held place that is no coordinate, or one of a
/// spherical or free joint that is not held as a whole.
pub fn assemble(mechanism: &Mechanism, guess: &[f64], held: &[usize]) -> Result<Assembly> {
    mechanism.check_q("guess", guess)?;
    let free = free_places(mechanism, held)?;
    let length = mechanism.reach();
    let mut now = Closing::at(mechanism, guess, &free, length)?;
    if !now.is_closed(length) {
        let within = within_limits(mechanism, guess.to_vec(), &free);
        now = Closing::at(mechanism, &within, &free, length)?;
    }
    let mut damping = DAMPING.0;
    let mut steps = 0;
    while now.error > 0.0 && steps < MOST_STEPS && damping < DAMPING.1 {
        steps += 1;
        let q = now.step(mechanism, &free, damping);
        let next = Closing::at(mechanism, &q, &free, length)?;
        // NaN is no improvement.
        if next.error < now.error {
            let little = next.error > 0.5 * now.error && next.is_closed(length);
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

/// The passive joints for given driven ones: [`assemble`] with the driven coordinates held.
///
/// A driven joint that closes a loop has no coordinate whose value could be given, so that it does
/// not hold: a mechanism with such joints keeps their motions, and the nearest of its assemblies is
/// returned. Where there are more drives than degrees of freedom, their values may contradict each
/// other: then the result is not closed, its closure_error is what remains, shared out by least squares, and
/// the driven values stand as given.
///
/// # Errors
/// As [`assemble`].
pub fn recover_passive(mechanism: &Mechanism, guess: &[f64]) -> Result<Assembly> {
    let driven: Vec<usize> = mechanism.actuated().collect();
    assemble(mechanism, guess, &driven)
}

/// A configuration with its residuals and their rates, scaled.
#[derive(Debug)]
pub(crate) struct Closing {
    pub(crate) q: Vec<f64>,
    pub(crate) residuals: Vec<f64>,
    pub(crate) rates: Matrix,
    pub(crate) error: f64,
    pub(crate) closure_error: LoopClosureError,
}

impl Closing {
    pub(crate) fn at(
        mechanism: &Mechanism,
        q: &[f64],
        free: &[usize],
        length: f64,
    ) -> Result<Self> {
        let state = mechanism.state(q)?;
        let (all, _, closure_error) = constraint_rows(&state)?;
        let held: Vec<ConstraintRow> =
            all.into_iter().filter(|row| row.rate_of.is_none()).collect();
        let residuals: Vec<f64> = held.iter().map(|row| row.scaled_residual(length)).collect();
        let mut columns = vec![None; mechanism.n()];
        for (j, &i) in free.iter().enumerate() {
            columns[i] = Some((j, column_scale(mechanism, i, length)));
        }
        let mut rates = Matrix::zeros(held.len(), free.len());
        for_each_rate(&state, &held, |i, coordinate, rate| {
            if let Some((j, scale)) = columns[coordinate] {
                rates[(i, j)] += rate * scale / held[i].unit.size(length);
            }
        });
        let error = norm(&residuals);
        Ok(Self { q: q.to_vec(), residuals, rates, error, closure_error })
    }

    pub(crate) fn is_closed(&self, length: f64) -> bool {
        self.closure_error.is_closed(length)
    }

    /// The configuration after a damped step, within the position limits: coordinates at a limit
    /// that would go on beyond it take no part. `free` are those of the rates.
    fn step(&self, mechanism: &Mechanism, free: &[usize], damping: f64) -> Vec<f64> {
        let mut rates = self.rates.clone();
        let mut places = free.to_vec();
        loop {
            let change = self.change(&rates, damping);
            let q = moved(mechanism, &self.q, &places, &change);
            let stuck = |i: usize| {
                let (before, l) = (self.q[i], mechanism.coordinates()[i].limits);
                (before <= l.lower && q[i] < l.lower) || (before >= l.upper && q[i] > l.upper)
            };
            let going: Vec<usize> = (0..places.len()).filter(|&k| !stuck(places[k])).collect();
            if going.len() == places.len() {
                return within_limits(mechanism, q, free);
            }
            rates = columns(&rates, &going);
            places = going.iter().map(|&k| places[k]).collect();
        }
    }

    /// The damped step of the coordinates that have these rates.
    fn change(&self, rates: &Matrix, damping: f64) -> Vec<f64> {
        let svd = Svd::of(rates);
        let l = damping * svd.values().next().unwrap_or(0.0);
        let gain = |_, s| if s > 0.0 { -damp(s, l) } else { 0.0 };
        let mut change = svd.apply_gains(&self.residuals, gain);
        let most = change.iter().fold(0.0, |m: f64, c| m.max(c.abs()));
        if most > LARGEST_STEP {
            change.iter_mut().for_each(|c| *c *= LARGEST_STEP / most);
        }
        change
    }
}
