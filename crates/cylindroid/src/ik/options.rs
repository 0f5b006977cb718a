//! What a solver is told: tolerance, budget, seeds.

use std::time::Duration;

use crate::error::{Error, Result};
use crate::model::Mechanism;
use crate::tolerance;

/// When to give up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Budget {
    /// Steps of all attempts together.
    pub iterations: usize,
    /// Time; the answer then depends on the machine. `None`: as long as it takes.
    pub time: Option<Duration>,
}

/// What a solver is told.
#[derive(Debug, Clone, PartialEq)]
pub struct IkOptions {
    /// Largest position error of an answer (m).
    pub position_tolerance: f64,
    /// Largest orientation error of an answer (rad).
    pub orientation_tolerance: f64,
    /// Where to start: all n coordinates, moved into the limits; `None`: home.
    pub initial_guess: Option<Vec<f64>>,
    /// Coordinates that keep the values of the start: their places.
    pub fixed: Vec<usize>,
    /// Prefer the answer that is nearest to the start over the one that is found first. Of answers
    /// by formulas it is always the nearest.
    pub nearest: bool,
    /// Of the postures that are drawn where the start leads nowhere: the same seed gives the same
    /// answer.
    pub seed: u64,
    /// When to give up.
    pub budget: Budget,
    /// Characteristic length that positions are divided by (m); `None`: the reach.
    pub length: Option<f64>,
}

impl Default for IkOptions {
    fn default() -> Self {
        Self {
            position_tolerance: tolerance::IK_POSITION,
            orientation_tolerance: tolerance::IK_ORIENTATION,
            initial_guess: None,
            fixed: Vec::new(),
            nearest: false,
            seed: 0,
            budget: Budget { iterations: 20_000, time: None },
            length: None,
        }
    }
}

impl IkOptions {
    /// Refuses numbers that make no solver.
    pub(super) fn check(&self, mechanism: &Mechanism) -> Result<()> {
        Error::check_positive("position tolerance", self.position_tolerance)?;
        Error::check_positive("orientation tolerance", self.orientation_tolerance)?;
        if let Some(length) = self.length {
            Error::check_positive("length", length)?;
        }
        if let Some(guess) = &self.initial_guess {
            mechanism.check_q("initial guess", guess)?;
        }
        if let Some(&place) = self.fixed.iter().find(|&&i| i >= mechanism.n()) {
            return Err(Error::InvalidOption {
                option: "fixed",
                value: place.to_string(),
                reason: format!("the mechanism has {} coordinates", mechanism.n()),
            });
        }
        if self.budget.iterations == 0 {
            return Err(Error::InvalidOption {
                option: "iterations",
                value: "0".to_owned(),
                reason: "a budget of one iteration at least is needed to look at the start"
                    .to_owned(),
            });
        }
        Ok(())
    }
}
