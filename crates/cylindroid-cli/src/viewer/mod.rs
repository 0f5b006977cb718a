//! The server of the web viewer: docs/viewer.md is its contract.
//!
//! `server` takes requests that `safety` lets through, `assets` has the files. Every WebSocket is a
//! session of its own: `socket` moves `messages` to a `session` and its `snapshot`s back, in time.
//! No mathematics: what is drawn is the library's.

mod assets;
mod compare;
mod inverting;
mod messages;
mod overlays;
mod reaching;
mod reports;
mod safety;
mod scene;
mod server;
mod session;
mod snapshot;
mod socket;

use std::path::PathBuf;

use cylindroid::{EndEffector, Mechanism, Result};
use serde::Serialize;

pub(crate) use self::server::Server;
pub(crate) use self::session::Start;

/// A message as text.
fn text(message: &impl Serialize) -> String {
    // Names, numbers and lists always have one.
    serde_json::to_string(message).unwrap_or_default()
}

/// True if the page is in the binary.
pub(crate) fn page_is_built() -> bool {
    assets::Page::is_built()
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
        let folders = assets::Folders::of(&mechanism, model, meshes)?;
        Ok(Self { mechanism, q, end_effector, folders })
    }
}
