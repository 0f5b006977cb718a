//! What the sessions of a server begin with.

use std::path::PathBuf;

use cylindroid::{EndEffector, Mechanism, Result};

use super::assets::Folders;
use super::reaching;

/// What all sessions of a server begin with.
#[derive(Debug)]
pub(crate) struct Start {
    pub(crate) mechanism: Mechanism,
    pub(crate) q: Vec<f64>,
    pub(crate) end_effector: EndEffector,
    pub(super) folders: Folders,
}

impl Start {
    /// Of a mechanism at `q` near which its loops close; `model` is the file that it comes from,
    /// `meshes` are further folders of its meshes.
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
