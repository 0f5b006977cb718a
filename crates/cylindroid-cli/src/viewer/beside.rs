//! Messages about the models that are shown beside that of a session.

use serde::{Deserialize, Serialize};

#[derive(Debug, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "BesideMessage"))]
#[serde(deny_unknown_fields)]
pub(super) struct Beside {
    pub(super) models: Vec<ModelBeside>,
}

/// A model that is shown beside that of a session.
#[derive(Debug, Clone, Deserialize, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(deny_unknown_fields)]
pub(super) struct ModelBeside {
    /// An opened model; null: that of the command.
    pub(super) model: Option<String>,
    /// The session of its joints.
    pub(super) session: String,
    pub(super) position: [f64; 3],
    /// w, x, y, z.
    pub(super) quaternion: [f64; 4],
    pub(super) transparent: bool,
}
