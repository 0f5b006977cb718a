//! The initial state of all sessions of a server.

use std::path::PathBuf;

use cylindroid::{EndEffector, Mechanism, Result};

use super::assets::Folders;
use super::reaching;

/// The initial state of all sessions of a server.
#[derive(Debug)]
pub(crate) struct Start {
    pub(crate) mechanism: Mechanism,
    pub(crate) q: Vec<f64>,
    pub(crate) end_effector: EndEffector,
    pub(super) folders: Folders,
}

impl Start {
    /// For a mechanism whose loops are assembled starting from `q`; `model` is the name of its
    /// file, `meshes` are additional mesh folders.
    pub(crate) fn new(
        (mechanism, model): (Mechanism, &str),
        q: &[f64],
        end_effector: EndEffector,
        meshes: &[PathBuf],
    ) -> Result<Self> {
        let q = reaching::closed(&mechanism, q)?;
        let folders = Folders::of(&mechanism, model, meshes)?;
        Ok(Self { mechanism, q, end_effector, folders })
    }
}
