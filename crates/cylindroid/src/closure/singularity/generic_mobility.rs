//! The generic counts of a mechanism: what it has where nothing is special about its configuration.
//!
//! Method   the counts of the configuration in question, of configurations near it and of configurations anywhere
//!          within the position limits: guesses at random (the same on every run), closed by
//!          [`assemble`]; those that do not close, or come back to the configuration, are left out. Of
//!          all, the largest rank and the smallest of every other count
//! Valid    configurations of other assembly components count too. A mechanism whose components differ
//!          in mobility (kinematotropic) is measured by the one of least mobility. Where no other
//!          configuration closes, the counts are those of the configuration itself: see [`GenericMobility::others`]
//! Why so   counts below those of a single regular configuration would need that configuration to be known;
//!          Grubler's count is wrong for whatever is overconstrained
//! Checked  tests/it/closure/diagnosis.rs

use crate::closure::constraint::closed_chain::ClosedChain;
use crate::closure::mobility::counts::MobilityCounts;
use crate::closure::mobility::motion_space::MotionSpace;
use crate::closure::position::assembly::assemble;
use crate::closure::position::configuration_signature::{link_poses, max_displacement};
use crate::closure::position::initial_guesses::{anywhere, near};
use crate::error::Result;
use crate::kinematics::State;
use crate::model::FrameId;
use crate::tolerance::FINITE_STEP;

/// Guesses near the configuration, and anywhere.
const GUESSES: (usize, usize) = (6, 6);
/// How far guesses near it are [rad, or reaches].
const NEAR: f64 = 0.3;

/// Generic counts and how many configurations stand behind them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GenericMobility {
    /// The counts.
    pub counts: MobilityCounts,
    /// Closed configurations other than the one in question that were counted.
    pub others: usize,
    /// Guesses that were tried for them.
    pub guesses: usize,
}

impl GenericMobility {
    /// Of the mechanism of `state`, for its reference frame or another, at its reach as
    /// characteristic length or another (m).
    ///
    /// # Errors
    /// As [`ClosedChain::of`].
    pub fn of(state: &State, reference: Option<FrameId>, length: Option<f64>) -> Result<Self> {
        let chain = ClosedChain::of(state, reference, length)?;
        Self::around(state, reference, chain.constraint.length(), counted(&chain))
    }

    /// The same for a configuration whose counts are known.
    pub(crate) fn around(
        state: &State,
        reference: Option<FrameId>,
        length: f64,
        counts: MobilityCounts,
    ) -> Result<Self> {
        let mechanism = state.mechanism();
        let all: Vec<usize> = (0..mechanism.n()).collect();
        let here = link_poses(state);
        let mut random = 7;
        let mut generic = Self { counts, others: 0, guesses: GUESSES.0 + GUESSES.1 };
        for guess in 0..generic.guesses {
            let guess = if guess < GUESSES.0 {
                near(mechanism, state.q(), NEAR, &mut random)
            } else {
                anywhere(mechanism, state.q(), &all, &mut random)
            };
            let closed = assemble(mechanism, &guess, &[])?;
            let there = mechanism.state(&closed.q)?;
            let away = max_displacement(&link_poses(&there), &here, mechanism) > FINITE_STEP;
            if closed.closed && away {
                let chain = ClosedChain::of(&there, reference, Some(length))?;
                generic.counts = generic.counts.generic(counted(&chain));
                generic.others += 1;
            }
        }
        Ok(generic)
    }
}

fn counted(chain: &ClosedChain) -> MobilityCounts {
    let motions = MotionSpace::of(&chain.constraint);
    MobilityCounts::of(&motions, &motions.relation())
}
