//! Options of inverse kinematics: tolerances, initial guess, budget, seed.
//!
//! Checked  tests/it/ik.rs

use std::time::Duration;

use super::criterion::Criterion;
use crate::error::{Error, Result};
use crate::model::Mechanism;
use crate::task::HalfSpace;
use crate::tolerance;

/// Limits of the computation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Budget {
    /// Iteration limit, over all restarts.
    pub iterations: usize,
    /// Time limit; the result then depends on the machine. `None`: no limit.
    pub time: Option<Duration>,
}

/// Options of inverse kinematics.
#[derive(Debug, Clone, PartialEq)]
pub struct IkOptions {
    /// Position tolerance of a solution (m).
    pub position_tolerance: f64,
    /// Orientation tolerance of a solution (rad).
    pub orientation_tolerance: f64,
    /// Initial guess: all n coordinates, clamped to the limits; `None`: home.
    pub initial_guess: Option<Vec<f64>>,
    /// Coordinates that keep the values of the initial guess: their indices.
    pub fixed: Vec<usize>,
    /// Prefer the solution closest to the initial guess over the one found first. Closed-form
    /// solutions are always the closest.
    pub nearest: bool,
    /// A preferred configuration, all n coordinates: the solution closest to it instead of the one
    /// closest to the initial guess; implies `nearest`. Coordinates that move no goal are set to it.
    pub posture: Option<Vec<f64>>,
    /// What the self-motion makes as large as possible, instead of approaching a configuration: the
    /// best of the maxima to which the restarts lead. Trees only.
    pub criterion: Option<Criterion>,
    /// Half-spaces of the world that tool points must not leave, to within the position tolerance.
    pub half_spaces: Vec<HalfSpace>,
    /// Seed of the random restarts: the same seed gives the same solution.
    pub seed: u64,
    /// Limits of the computation.
    pub budget: Budget,
    /// Characteristic length that divides positions (m); `None`: that of the mechanism.
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
            posture: None,
            criterion: None,
            half_spaces: Vec::new(),
            seed: 0,
            budget: Budget { iterations: 20_000, time: None },
            length: None,
        }
    }
}

impl IkOptions {
    /// Checks that the options define a solver.
    pub(super) fn check(&self, mechanism: &Mechanism) -> Result<()> {
        Error::check_positive("position tolerance", self.position_tolerance)?;
        Error::check_positive("orientation tolerance", self.orientation_tolerance)?;
        mechanism.length_or(self.length)?;
        if let Some(guess) = &self.initial_guess {
            mechanism.check_q("initial guess", guess)?;
        }
        if let Some(posture) = &self.posture {
            mechanism.check_q("posture", posture)?;
        }
        if let Some(criterion) = &self.criterion {
            criterion.check(mechanism)?;
            if self.nearest || self.posture.is_some() {
                let other = if self.nearest { "nearest" } else { "posture" };
                return Err(Error::InvalidOption {
                    option: "criterion",
                    value: criterion.name().to_owned(),
                    reason: format!("'{other}' asks for another solution; give one of them"),
                });
            }
        }
        self.half_spaces.iter().try_for_each(|half_space| half_space.check(mechanism))?;
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
                reason: "at least one iteration is needed to evaluate the initial guess".to_owned(),
            });
        }
        Ok(())
    }
}
