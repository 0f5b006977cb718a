//! The generic counts of a mechanism: what it has where nothing is special about its posture.
//!
//! Method   the counts of the posture in question, of postures near it and of postures anywhere
//!          within the position limits: guesses at random (the same on every run), closed by
//!          [`assemble`]; those that do not close, or come back to the posture, are left out. Of
//!          all, the largest rank and the smallest of every other count
//! Valid    postures of other assembly components count too. A mechanism whose components differ
//!          in mobility (kinematotropic) is measured by the one of least mobility. Where no other
//!          posture closes, the counts are those of the posture itself: see [`Generic::others`]
//! Why so   counts below those of a single regular posture would need that posture to be known;
//!          Grubler's count is wrong for whatever is overconstrained
//! Checked  tests/it/closure/diagnosis.rs

use super::assembly::assemble;
use super::coordinates::column_scale;
use super::graph::ClosedChain;
use super::motions::Motions;
use super::singularity::Counts;
use crate::error::Result;
use crate::kinematics::State;
use crate::model::{FrameId, Mechanism};
use crate::scalar::uniform;
use crate::tolerance::FINITE_STEP;

/// Guesses near the posture, and anywhere.
const GUESSES: (usize, usize) = (6, 6);
/// How far guesses near it are, and those in coordinates without limits [rad, or lengths].
const DISTANCES: (f64, f64) = (0.3, std::f64::consts::FRAC_PI_2);

/// Generic counts and how many postures stand behind them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Generic {
    /// The counts.
    pub counts: Counts,
    /// Closed postures other than the one in question that were counted.
    pub others: usize,
    /// Guesses that were tried for them.
    pub guesses: usize,
}

impl Generic {
    /// Of the mechanism of `state`, for its reference frame or another, at its reach as
    /// characteristic length or another (m).
    ///
    /// # Errors
    /// As [`ClosedChain::of`].
    pub fn of(state: &State, reference: Option<FrameId>, length: Option<f64>) -> Result<Self> {
        let chain = ClosedChain::of(state, reference, length)?;
        Self::around(state, reference, chain.constraint.length(), counted(&chain))
    }

    /// The same for a posture whose counts are known.
    pub(super) fn around(
        state: &State,
        reference: Option<FrameId>,
        length: f64,
        counts: Counts,
    ) -> Result<Self> {
        let mechanism = state.mechanism();
        let mut random = 7;
        let mut generic = Self { counts, others: 0, guesses: GUESSES.0 + GUESSES.1 };
        for guess in 0..generic.guesses {
            let near = guess < GUESSES.0;
            let guess = another(mechanism, state.q(), length, near, &mut random);
            let closed = assemble(mechanism, &guess, &[])?;
            let away = (0..mechanism.n()).any(|i| {
                let change = (closed.q[i] - state.q()[i]).abs();
                change > FINITE_STEP * column_scale(mechanism, i, length)
            });
            if closed.closed && away {
                let chain = ClosedChain::of(&mechanism.state(&closed.q)?, reference, Some(length))?;
                generic.counts = generic.counts.generic(counted(&chain));
                generic.others += 1;
            }
        }
        Ok(generic)
    }
}

fn counted(chain: &ClosedChain) -> Counts {
    let motions = Motions::of(&chain.constraint);
    Counts::of(&motions, &motions.relation())
}

/// A guess within the position limits.
fn another(
    mechanism: &Mechanism,
    q: &[f64],
    length: f64,
    near: bool,
    random: &mut u64,
) -> Vec<f64> {
    let far = if near { DISTANCES.0 } else { DISTANCES.1 };
    let shares: Vec<f64> = q.iter().map(|_| uniform(random)).collect();
    let rates: Vec<f64> = shares
        .iter()
        .enumerate()
        .map(|(i, x)| (2.0 * x - 1.0) * far * column_scale(mechanism, i, length))
        .collect();
    let mut guess = q.to_vec();
    mechanism.integrate_in_place(&mut guess, &rates, 1.0);
    for (i, coordinate) in mechanism.coordinates().iter().enumerate() {
        let l = coordinate.limits;
        if !near && l.lower.is_finite() && l.upper.is_finite() {
            guess[i] = l.lower + (l.upper - l.lower) * shares[i];
        }
        guess[i] = guess[i].clamp(l.lower, l.upper);
    }
    guess
}
