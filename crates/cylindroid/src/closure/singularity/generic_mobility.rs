//! Generic mobility: the counts of a mechanism at regular configurations.
//!
//! Method   the counts of the given configuration, of configurations near it and of random
//!          configurations within the position limits: random initial guesses (the same on every
//!          run), closed by [`assemble`]; those that do not close, or return to the given
//!          configuration, are left out. Of all, the largest rank and the smallest of every other
//!          count
//! Valid    configurations of other assembly modes count too. A mechanism whose components differ
//!          in mobility (kinematotropic) is compared with the one of least mobility. If no other
//!          configuration closes, the counts are those of the given one: see
//!          [`GenericMobility::others`]
//! Why so   counts of a single regular configuration would require it to be known; the
//!          Gruebler-Kutzbach count is wrong for overconstrained mechanisms
//! Checked  tests/it/closure/diagnosis.rs

use crate::closure::constraint::closed_chain::ClosedChain;
use crate::closure::mobility::counts::MobilityCounts;
use crate::closure::mobility::motion_space::MotionSpace;
use crate::closure::position::assembly::assemble;
use crate::closure::position::configuration_signature::{link_poses, max_displacement};
use crate::closure::position::initial_guesses::{perturbed, random};
use crate::error::Result;
use crate::kinematics::State;
use crate::model::FrameId;
use crate::tolerance::FINITE_STEP;

/// Number of guesses near the configuration, and of random ones.
const GUESSES: (usize, usize) = (6, 6);
/// Perturbation of the guesses near it [rad, or reaches].
const NEAR: f64 = 0.3;

/// Generic counts, and the number of configurations they come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GenericMobility {
    /// The counts.
    pub counts: MobilityCounts,
    /// Number of other closed configurations that were counted.
    pub others: usize,
    /// Number of initial guesses tried.
    pub guesses: usize,
}

impl GenericMobility {
    /// For the mechanism of `state`, its reference frame or another, with its reach as
    /// characteristic length or another (m).
    ///
    /// ```
    /// use cylindroid::closure::GenericMobility;
    ///
    /// // A straight elbow is singular; generically the arm has rank 6.
    /// let arm = cylindroid::load("ur5e")?;
    /// let state = arm.state(&[0.0, -0.6, 0.0, 0.4, 1.0, 0.0])?;
    /// let generic = GenericMobility::of(&state, None, None)?;
    /// assert!(generic.others > 0 && generic.counts.zero_torque == 0);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
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
        let mut seed = 7;
        let mut generic = Self { counts, others: 0, guesses: GUESSES.0 + GUESSES.1 };
        for guess in 0..generic.guesses {
            let guess = if guess < GUESSES.0 {
                perturbed(mechanism, state.q(), NEAR, &mut seed)
            } else {
                random(mechanism, state.q(), &all, &mut seed)
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
