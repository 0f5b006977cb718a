//! What one client of a session has asked to see in its states.

use serde_json::Value;

use super::names::Overlay;

/// What one client of a session has asked to see in its states.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct ClientView {
    pub(super) overlays: Vec<Overlay>,
    /// Pairs of bodies closer than this are included (m); `None`: no distances are computed.
    pub(super) margin: Option<f64>,
    /// The id of its last message.
    pub(super) ack: Option<Value>,
}
