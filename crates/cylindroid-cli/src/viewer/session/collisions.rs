//! Obstacles and distances of a session, and its servo while it avoids collisions.

use cylindroid::collision::CollisionModel;
use cylindroid::control::CollisionAvoidance;
use cylindroid::{Error, Pose, Result};

use super::super::avoidance::Avoidance;
use super::super::bodies::DistancesJson;
use super::Session;
use crate::obstacle::ObstacleArg;

impl Session {
    /// Least distance and margin (m), if collisions are avoided.
    pub(in super::super) fn avoided(&self) -> Option<(f64, f64)> {
        self.avoidance.as_ref().map(|(distances, _)| *distances)
    }

    pub(in super::super) fn obstacles(&self) -> &[ObstacleArg] {
        self.bodies.obstacles()
    }

    /// Finds the pairs of the state that are closer than `margin` (m), if one is given.
    pub(in super::super) fn find_near(&mut self, margin: Option<f64>) -> Result<()> {
        self.bodies.find_near(&self.start, &self.state, margin)
    }

    /// The near pairs that were found for this margin (m).
    pub(in super::super) fn distances(&self, margin: Option<f64>) -> Option<DistancesJson<'_>> {
        self.bodies.distances(margin)
    }

    /// Avoids collisions with this least distance and margin (m), or does not.
    pub(in super::super) fn avoid(&mut self, distances: Option<(f64, f64)>) -> Result<()> {
        self.avoidance = match distances {
            None => None,
            Some(distances @ (gap, margin)) => {
                CollisionAvoidance::check_distances(gap, margin)?;
                let model = self.bodies.model(&self.start)?.clone();
                let (mechanism, options, target) = (&self.mechanism, &self.options, self.target);
                let servo = Avoidance::new(mechanism, options, target, model, distances);
                Some((distances, servo))
            }
        };
        self.wake();
        Ok(())
    }

    /// Refuses a margin (m) that is not positive, and models without distances.
    pub(in super::super) fn check_margin(&mut self, margin: f64) -> Result<()> {
        Error::check_positive("margin", margin)?;
        self.bodies.model(&self.start).map(|_| ())
    }

    pub(in super::super) fn add_obstacle(&mut self, obstacle: ObstacleArg) -> Result<()> {
        self.bodies.add(&self.start, obstacle.clone())?;
        let ObstacleArg { name, shape, world_from_shape } = obstacle;
        self.change_avoided(|model| model.add_obstacle(&name, &shape, world_from_shape))
    }

    pub(in super::super) fn move_obstacle(&mut self, name: &str, pose: Pose) -> Result<()> {
        self.bodies.move_to(&self.start, name, pose)?;
        self.change_avoided(|model| model.move_obstacle(name, pose))
    }

    pub(in super::super) fn remove_obstacle(&mut self, name: &str) -> Result<()> {
        self.bodies.remove(&self.start, name)?;
        self.change_avoided(|model| model.remove_obstacle(name))
    }

    /// Changes the obstacles of the servo, which continues.
    fn change_avoided(
        &mut self,
        change: impl FnOnce(&mut CollisionModel) -> Result<()>,
    ) -> Result<()> {
        if let Some((_, Ok(avoidance))) = &mut self.avoidance {
            avoidance.model_mut().map_or(Ok(()), change)?;
            (self.last, self.trouble) = (None, None);
            self.is_resting = false;
        }
        Ok(())
    }
}
