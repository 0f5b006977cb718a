//! Solutions at a distance from obstacles and from themselves.
//!
//! Method   a configuration that reaches the goals is accepted if all watched pairs are at least
//!          the gap apart. Otherwise it moves along the self-motion, by the gradients of the
//!          distances below the gap, until they are; without success the search goes on
//! Formula  d = (1 - A+ A) sum (gap - distance) grad distance, scaled to what the closest pair lacks
//! Units    m
//! Valid    a mechanism without redundant joints has no self-motion: the gap then only selects
//! Checked  tests/it/ik_misses.rs

use super::convergence::is_reached;
use super::levenberg_marquardt::Problem;
use super::options::IkOptions;
use super::reason::MissReason;
use super::self_motion::Descent;
use crate::collision::{CollisionModel, NearPair};
use crate::error::{Error, Result};
use crate::kinematics::State;
use crate::model::Mechanism;

/// Steps away from other bodies.
const STEPS: usize = 40;
/// Distance beyond the gap that a step aims at (m).
const BEYOND: f64 = 1e-3;
/// Largest change of a coordinate per step [rad, or m; of long slides a share of their travel].
const LONGEST: f64 = 0.2;
/// Levenberg-Marquardt steps after each.
const CORRECTIONS: usize = 8;

/// The bodies, and the least distance of their pairs.
#[derive(Debug, Clone)]
pub(super) struct Avoidance {
    pub(super) model: CollisionModel,
    gap: f64,
    state: State,
    near: Vec<NearPair>,
    row: Vec<f64>,
    desired: Vec<f64>,
    /// Of the configurations that reach the goals and were not accepted, the one with the largest
    /// distance, and its reason.
    pub(super) best: Option<(Vec<f64>, f64, MissReason)>,
}

impl Avoidance {
    pub(super) fn new(mechanism: &Mechanism, model: CollisionModel, gap: f64) -> Result<Self> {
        if !(gap >= 0.0 && gap.is_finite()) {
            return Err(Error::InvalidOption {
                option: "gap",
                value: gap.to_string(),
                reason: "give a distance in metres, zero or more".to_owned(),
            });
        }
        let (state, mut near) = (mechanism.state(mechanism.home())?, Vec::new());
        let mut own = Self {
            model,
            gap,
            state,
            near: Vec::new(),
            row: vec![0.0; mechanism.n()],
            desired: Vec::new(),
            best: None,
        };
        own.model.near(&own.state, gap, &mut near)?; // refuses the model of another mechanism
        Ok(own)
    }

    /// The closest pair below the gap at `q`.
    fn closest(&mut self, q: &[f64]) -> Result<Option<NearPair>> {
        self.state.set(q)?;
        self.model.near(&self.state, self.gap, &mut self.near)?;
        Ok(self.near.iter().copied().min_by(|a, b| a.distance.total_cmp(&b.distance)))
    }

    /// True if all pairs are apart at `q`, or after a motion of `q` along the solutions.
    pub(super) fn make_free(
        &mut self,
        problem: &mut Problem,
        descent: &mut Descent,
        q: &mut [f64],
        options: &IkOptions,
    ) -> Result<bool> {
        for _ in 0..STEPS {
            let Some(closest) = self.closest(q)? else { return Ok(true) };
            if self.best.as_ref().is_none_or(|(_, distance, _)| closest.distance > *distance) {
                let between = self.model.names(closest.pair).map(str::to_owned);
                let distance = closest.distance;
                let reason = MissReason::Collision { between, distance };
                self.best = Some((q.to_vec(), distance, reason));
            }
            self.desired.clear();
            self.desired.resize(problem.coordinates.len(), 0.0);
            for near in &self.near {
                self.model.gradient_into(&self.state, near, &mut self.row);
                let lacks = self.gap + BEYOND - near.distance;
                for (desired, &c) in self.desired.iter_mut().zip(&problem.coordinates) {
                    *desired += lacks * self.row[c];
                }
            }
            self.model.gradient_into(&self.state, &closest, &mut self.row);
            let rate = {
                let along = (&self.desired[..], &self.row[..]);
                descent.along_solutions(problem, q, along, options)
            };
            let lacks = self.gap + BEYOND - closest.distance;
            let Some(rate) = rate.filter(|rate| *rate > 1e-6 * lacks) else { return Ok(false) };
            let most = problem.largest_change();
            let share = (lacks / rate).min(LONGEST / most);
            problem.d.iter_mut().for_each(|d| *d *= share);
            problem.advance(q);
            let (errors, _) = problem.run(q, options, CORRECTIONS);
            if !is_reached(errors, options) {
                return Ok(false);
            }
        }
        Ok(self.closest(q)?.is_none())
    }
}
