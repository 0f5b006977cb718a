//! The initial state of all sessions of a server.

use std::path::PathBuf;
use std::sync::OnceLock;
use std::time::SystemTime;

use cylindroid::collision::{CollisionModel, CollisionOptions};
use cylindroid::{EndEffector, Mechanism, Result};

use super::assets::Folders;
use super::reaching;
use crate::obstacle::ObstacleArg;

/// The initial state of all sessions of a server.
#[derive(Debug)]
pub(crate) struct Start {
    pub(crate) mechanism: Mechanism,
    pub(crate) q: Vec<f64>,
    pub(crate) end_effector: EndEffector,
    pub(super) folders: Folders,
    pub(super) bodies: StartBodies,
    /// Made when a session first needs it.
    collision_model: OnceLock<Result<CollisionModel>>,
}

/// The obstacles of new sessions.
#[derive(Debug, Default)]
pub(crate) struct StartBodies {
    pub(crate) obstacles: Vec<ObstacleArg>,
    /// True if the servo avoids collisions.
    pub(crate) avoid: bool,
    /// Pairs of links that are not watched.
    pub(crate) disabled: Vec<[String; 2]>,
}

impl Start {
    /// For a mechanism whose loops are assembled starting from `q`; `model` is the name of its
    /// file, `meshes` are additional mesh folders.
    pub(crate) fn new(
        (mechanism, model): (Mechanism, &str),
        q: &[f64],
        end_effector: EndEffector,
        meshes: &[PathBuf],
        bodies: StartBodies,
    ) -> Result<Self> {
        let q = reaching::closed(&mechanism, q)?;
        let folders = Folders::of(&mechanism, model, meshes)?;
        let collision_model = OnceLock::new();
        let start = Self { mechanism, q, end_effector, folders, bodies, collision_model };
        if start.bodies.avoid || !start.bodies.obstacles.is_empty() {
            // Shapes that cannot be made are an error of the command.
            start.collision_model()?;
        }
        Ok(start)
    }

    /// The same, with URLs of meshes below a token, if there is one.
    pub(crate) fn behind(self, token: &str) -> Self {
        if token.is_empty() {
            return self;
        }
        Self { folders: self.folders.behind(token), ..self }
    }

    /// The same, for pages that may have meshes of before this time.
    pub(super) fn since(self, time: SystemTime) -> Self {
        Self { folders: self.folders.since(time), ..self }
    }

    /// The bodies of the links and the obstacles.
    pub(super) fn collision_model(&self) -> Result<CollisionModel> {
        let make = || {
            let disabled = self.bodies.disabled.clone();
            let options = CollisionOptions { disabled, ..CollisionOptions::default() };
            let mut model = CollisionModel::new(&self.mechanism, &options)?;
            for obstacle in &self.bodies.obstacles {
                model.add_obstacle(&obstacle.name, &obstacle.shape, obstacle.world_from_shape)?;
            }
            Ok(model)
        };
        self.collision_model.get_or_init(make).clone()
    }
}
