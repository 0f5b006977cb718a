//! JSON shared by several messages: poses, and serialisation.

use cylindroid::Pose;
use serde::Serialize;

/// A pose: `world_from_...`, unless it is said to be in a link.
#[derive(Debug, Clone, Copy, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "Pose"))]
pub(super) struct PoseJson {
    position: [f64; 3],
    /// w, x, y, z.
    quaternion: [f64; 4],
}

impl From<Pose> for PoseJson {
    fn from(pose: Pose) -> Self {
        let q = pose.rotation.to_quaternion();
        Self { position: pose.translation.to_array(), quaternion: [q.w, q.x, q.y, q.z] }
    }
}

/// A message as JSON text.
pub(super) fn text(message: &impl Serialize) -> String {
    // Serialisation of names, numbers and lists cannot fail.
    serde_json::to_string(message).unwrap_or_default()
}
