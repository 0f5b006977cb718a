//! What the search takes from formulas: all answers for six hinges, and for seven those that one of
//! them leaves.
//!
//! Valid    one goal that is a whole pose. Of seven hinges one is held at its start, then at values
//!          spread over its limits: every value that reaches gives up to eight answers
//! Why so   a value costs a microsecond or two, an attempt of the search ten times as much
//! Checked  tests/it/ik.rs, tests/it/analytic.rs

use std::f64::consts::PI;

use super::analytic::{Analytic, Postures};
use super::goal::{Goal, Task};
use super::options::IkOptions;
use crate::error::Result;
use crate::kinematics::Chain;
use crate::model::Mechanism;
use crate::spatial::Pose;

/// Values of the held joint before the search takes over.
pub(super) const VALUES: usize = 32;
/// Values without any answer before it does: arms whose limits or axes leave the formulas nothing
/// must not pay for all of them.
pub(super) const FRUITLESS: usize = 4;
/// Steps of this share of a range spread evenly, however many there are: the golden ratio.
const SHARE: f64 = 0.618_033_988_749_894_9;

/// Formulas for the goal of a solver.
#[derive(Debug, Clone)]
pub(super) struct Formulas {
    pub(super) analytic: Analytic,
    /// Of seven joints the one that is held, with the range of its values.
    held: Option<(usize, [f64; 2])>,
}

impl Formulas {
    /// `None` where there are none.
    pub(super) fn of(mechanism: &Mechanism, goals: &[Goal], options: &IkOptions) -> Option<Self> {
        let [goal] = goals else { return None };
        if goal.task.components != Task::POSE.components {
            return None;
        }
        let chain = Chain::new(mechanism, goal.end_effector);
        let free = chain.coordinates().iter().filter(|c| !options.fixed.contains(c));
        let free: Vec<usize> = free.copied().collect();
        let holding = |held: &[usize]| Analytic::holding(mechanism, goal.end_effector, held).ok();
        if free.len() != 7 {
            return Some(Self { analytic: holding(&options.fixed)?, held: None });
        }
        // The last first: of arms with ball joints at both ends the elbow must not be held.
        free.into_iter().rev().find_map(|c| {
            let analytic = holding(&[&options.fixed[..], &[c]].concat())?;
            let limits = mechanism.coordinates()[c].limits;
            let range = [limits.lower.max(limits.upper.min(PI) - 2.0 * PI), limits.upper.min(PI)];
            Some(Self { analytic, held: Some((c, range)) })
        })
    }

    /// True if they give all answers there are.
    pub(super) fn are_all(&self) -> bool {
        self.held.is_none()
    }

    /// Answers; of seven joints those of the i-th value of the one that is held. `start` gets it.
    pub(super) fn solve(&mut self, target: Pose, start: &mut [f64], i: usize) -> Result<Postures> {
        if let Some((c, [lower, upper])) = self.held
            && i > 0
        {
            start[c] = lower + (upper - lower) * (SHARE * i as f64).fract();
        }
        self.analytic.solve(target, start)
    }
}
