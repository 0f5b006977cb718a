//! The bodies of a session: obstacles, and distances of links to them and to each other.

use cylindroid::collision::{CollisionModel, NearPair};
use cylindroid::{Error, Pose, Result, State};
use serde::Serialize;

use super::start::Start;
use crate::obstacle::ObstacleArg;

/// Maximum number of obstacles of a session.
pub(crate) const MOST_OBSTACLES: usize = 32;
/// Maximum number of pairs in a state: the nearest.
const MOST_PAIRS: usize = 32;

/// The bodies of a session.
#[derive(Debug)]
pub(super) struct Bodies {
    /// Made when it is first needed.
    model: Option<CollisionModel>,
    obstacles: Vec<ObstacleArg>,
    near: Vec<NearPair>,
}

/// The distances in a state.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "Distances"))]
pub(super) struct DistancesJson<'a> {
    margin: f64,
    shapes: usize,
    pairs: usize,
    near: Vec<NearJson<'a>>,
    more: usize,
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "Near"))]
struct NearJson<'a> {
    a: &'a str,
    b: &'a str,
    distance: f64,
    point_a: [f64; 3],
    point_b: [f64; 3],
}

impl Bodies {
    /// With the obstacles of the start.
    pub(super) fn new(start: &Start) -> Self {
        Self { model: None, obstacles: start.bodies.obstacles.clone(), near: Vec::new() }
    }

    pub(super) fn obstacles(&self) -> &[ObstacleArg] {
        &self.obstacles
    }

    /// The collision model with the obstacles.
    pub(super) fn model(&mut self, start: &Start) -> Result<&mut CollisionModel> {
        match &mut self.model {
            Some(model) => Ok(model),
            none => Ok(none.insert(start.collision_model()?)),
        }
    }

    pub(super) fn add(&mut self, start: &Start, obstacle: ObstacleArg) -> Result<()> {
        check_count(self.obstacles.len() + 1)?;
        let ObstacleArg { name, shape, world_from_shape } = &obstacle;
        self.model(start)?.add_obstacle(name, shape, *world_from_shape)?;
        self.obstacles.push(obstacle);
        Ok(())
    }

    pub(super) fn move_to(&mut self, start: &Start, name: &str, pose: Pose) -> Result<()> {
        self.model(start)?.move_obstacle(name, pose)?;
        let own = self.obstacles.iter_mut().filter(|o| o.name == name);
        own.for_each(|o| o.world_from_shape = pose);
        Ok(())
    }

    pub(super) fn remove(&mut self, start: &Start, name: &str) -> Result<()> {
        self.model(start)?.remove_obstacle(name)?;
        self.obstacles.retain(|o| o.name != name);
        Ok(())
    }

    /// Finds the pairs of a state that are closer than `margin` (m), if one is given.
    pub(super) fn find_near(
        &mut self,
        start: &Start,
        state: &State,
        margin: Option<f64>,
    ) -> Result<()> {
        let Some(margin) = margin else { return Ok(()) };
        let mut near = std::mem::take(&mut self.near);
        self.model(start)?.near(state, margin, &mut near)?;
        self.near = near;
        self.near.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        Ok(())
    }

    /// The near pairs that were found for this margin (m).
    pub(super) fn distances(&self, margin: Option<f64>) -> Option<DistancesJson<'_>> {
        let (margin, model) = margin.zip(self.model.as_ref())?;
        let near = self.near.iter().take(MOST_PAIRS).map(|near| {
            let [a, b] = model.names(near.pair);
            NearJson {
                a,
                b,
                distance: near.distance,
                point_a: near.point_a.to_array(),
                point_b: near.point_b.to_array(),
            }
        });
        Some(DistancesJson {
            margin,
            shapes: model.bodies().iter().filter(|body| body.link.is_some()).count(),
            pairs: model.pairs().len(),
            near: near.collect(),
            more: self.near.len().saturating_sub(MOST_PAIRS),
        })
    }
}

/// Refuses more obstacles than a session may have.
pub(crate) fn check_count(count: usize) -> Result<()> {
    if count <= MOST_OBSTACLES {
        return Ok(());
    }
    Err(Error::InvalidOption {
        option: "obstacles",
        value: count.to_string(),
        reason: format!("a session has at most {MOST_OBSTACLES}; remove one first"),
    })
}
