//! What waits for a client: of each kind only the newest, so that slow networks and browsers never
//! lag behind.

use std::sync::{Mutex, MutexGuard, PoisonError};

use axum::extract::ws::Utf8Bytes;
use tokio::sync::Notify;

/// What waits for a client.
#[derive(Debug, Default)]
pub(super) struct Mailbox {
    waiting: Mutex<Waiting>,
    arrived: Notify,
}

#[derive(Debug, Default)]
struct Waiting {
    about: Option<Utf8Bytes>,
    model: Option<Utf8Bytes>,
    scene: Option<Utf8Bytes>,
    drawings: Option<Utf8Bytes>,
    state: Option<Numbered>,
}

/// A state and its number.
#[derive(Debug)]
pub(super) struct Numbered {
    pub(super) seq: u64,
    pub(super) text: Utf8Bytes,
}

impl Mailbox {
    fn waiting(&self) -> MutexGuard<'_, Waiting> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The message `session`.
    pub(super) fn put_about(&self, text: Utf8Bytes) {
        self.waiting().about = Some(text);
        self.arrived.notify_one();
    }

    /// The message `model`.
    pub(super) fn put_model(&self, text: Utf8Bytes) {
        self.waiting().model = Some(text);
        self.arrived.notify_one();
    }

    /// The message `scene`. A state that waits belongs to the previous one.
    pub(super) fn put_scene(&self, text: Utf8Bytes) {
        let mut waiting = self.waiting();
        (waiting.scene, waiting.state) = (Some(text), None);
        self.arrived.notify_one();
    }

    /// The message `drawings`.
    pub(super) fn put_drawings(&self, text: Utf8Bytes) {
        self.waiting().drawings = Some(text);
        self.arrived.notify_one();
    }

    /// The message `state`.
    pub(super) fn put_state(&self, state: Numbered) {
        self.waiting().state = Some(state);
        self.arrived.notify_one();
    }

    /// The next message that comes before answers.
    pub(super) fn first(&self) -> Option<Utf8Bytes> {
        let mut waiting = self.waiting();
        let Waiting { about, model, scene, .. } = &mut *waiting;
        about.take().or_else(|| model.take()).or_else(|| scene.take())
    }

    /// The next message that comes after answers, but states.
    pub(super) fn second(&self) -> Option<Utf8Bytes> {
        self.waiting().drawings.take()
    }

    /// The state, if no scene has to go before it.
    pub(super) fn state(&self) -> Option<Numbered> {
        let mut waiting = self.waiting();
        if waiting.scene.is_some() { None } else { waiting.state.take() }
    }

    /// Waits until something arrives; it may be there already.
    pub(super) async fn arrived(&self) {
        self.arrived.notified().await;
    }
}
