//! Distances to collision of a sweep.
//!
//! Formula  min of the signed distances of the watched pairs, of links to one another or of links to
//!          obstacles; negative: the depth of the deepest penetration
//! Units    m
//! Valid    mechanisms whose links have collision shapes, of closed chains too. Infinite where no pair
//!          is watched, NaN where a link is beyond what numbers can represent
//! Why so   the shapes, pairs and distances are those of `CollisionModel`; pairs whose bounding balls are
//!          farther apart than the smallest distance so far are not evaluated
//! Checked  tests/sweep/clearances.rs

use super::options::SweepOptions;
use super::quantity::Quantity;
use crate::collision::{CollisionModel, CollisionOptions};
use crate::error::{Error, Result};
use crate::kinematics::State;
use crate::model::Mechanism;

/// Shapes, and a state of the mechanism.
#[derive(Debug, Clone)]
pub(super) struct Clearances {
    pub(super) model: CollisionModel,
    state: State,
}

impl Clearances {
    /// Those of the options, otherwise those of the links of the mechanism; `None` if no quantity asks
    /// for them.
    pub(super) fn new(mechanism: &Mechanism, options: &SweepOptions) -> Result<Option<Self>> {
        let mut wanted = options.quantities.iter().filter(|q| q.sees_collisions());
        let Some(quantity) = wanted.next() else { return Ok(None) };
        let refuse = |option: &'static str, value: &str, reason: String| {
            Err(Error::InvalidOption { option, value: value.to_owned(), reason })
        };
        let model = match &options.collision {
            None => CollisionModel::new(mechanism, &CollisionOptions::default())?,
            Some(own) if own.fits(mechanism) => own.clone(),
            Some(own) => {
                let reason = format!("the shapes are those of '{}'", own.mechanism().name());
                return refuse("collision", mechanism.name(), reason);
            }
        };
        if model.bodies().iter().all(|body| body.link.is_none()) {
            let reason = match model.ignored().first() {
                Some(first) => {
                    format!("no link has a collision shape: {}, {}", first.what, first.why)
                }
                None => "no link has a collision shape; give some to the model".to_owned(),
            };
            return refuse("quantities", quantity.name(), reason);
        }
        let of_obstacles = options.quantities.contains(&Quantity::ObstacleDistance);
        if of_obstacles && model.obstacles().next().is_none() {
            let reason = "there is no obstacle; add one at least".to_owned();
            return refuse("quantities", Quantity::ObstacleDistance.name(), reason);
        }
        let state = mechanism.state(mechanism.home())?;
        Ok(Some(Self { model, state }))
    }

    /// The distances of these configurations to obstacles, otherwise of links to one another.
    pub(super) fn of(&mut self, q: &[f64], to_obstacles: bool) -> Result<Vec<f64>> {
        let n = self.state.q().len();
        let mut all = Vec::with_capacity(q.len() / n);
        for q in q.chunks_exact(n) {
            self.state.set(q)?;
            all.push(self.model.clearance(&self.state, to_obstacles));
        }
        Ok(all)
    }
}
