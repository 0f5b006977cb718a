//! Solvers of the last calls of `ik`, for the next ones with the same goals and options.
//!
//! A solver is taken out while it runs: a call of another thread at the same moment prepares its
//! own. What it was asked for is compared as a whole, so that none is used with other options.

use std::sync::{Arc, Mutex, PoisonError};

use cylindroid::Mechanism;
use cylindroid::ik::{Goal, IkOptions, Solver};

/// Solvers at most: as many as frames that a program asks for in turn, with their options.
const MOST: usize = 4;

/// The solvers of a mechanism, the last used at the end.
#[derive(Debug, Clone, Default)]
pub(crate) struct Prepared(Arc<Mutex<Vec<Kept>>>);

/// A solver and its question; targets of frames are left out of its goals.
#[derive(Debug)]
pub(super) struct Kept {
    goals: Vec<Goal>,
    options: IkOptions,
    pub(super) solver: Solver,
}

impl Kept {
    pub(super) fn new(
        mechanism: &Mechanism,
        goals: &[Goal],
        options: &IkOptions,
    ) -> cylindroid::Result<Self> {
        let solver = Solver::new(mechanism, goals, options)?;
        Ok(Self { goals: goals.to_vec(), options: options.clone(), solver })
    }
}

impl Prepared {
    /// A solver that starts at home, as a new one does.
    pub(super) fn take(
        &self,
        mechanism: &Mechanism,
        goals: &[Goal],
        options: &IkOptions,
    ) -> cylindroid::Result<Kept> {
        let found = {
            let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            let place = kept.iter().position(|k| k.goals == goals && k.options == *options);
            place.map(|place| kept.remove(place))
        };
        match found {
            Some(mut kept) => {
                kept.solver.set_initial_guess(mechanism.home())?;
                Ok(kept)
            }
            None => Kept::new(mechanism, goals, options),
        }
    }

    pub(super) fn keep(&self, own: Kept) {
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if kept.len() >= MOST {
            kept.remove(0);
        }
        kept.push(own);
    }
}
