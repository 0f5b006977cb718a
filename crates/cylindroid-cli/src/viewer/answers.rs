//! The queue of a client's answers, bounded by their number and their size: what a client does not
//! read takes little memory.

use std::sync::Arc;

use axum::extract::ws::Message as Frame;
use tokio::sync::{OwnedSemaphorePermit, Semaphore, mpsc};

/// Maximum number of unread answers; the next message waits until one is read.
const ANSWERS: usize = 64;
/// Maximum size of unread answers together [bytes]; a longer one is alone.
const UNREAD: u32 = 512 * 1024;

/// The end where answers are put in.
#[derive(Debug)]
pub(super) struct Answers {
    frames: mpsc::Sender<Answer>,
    places: Arc<Semaphore>,
}

/// An answer, which takes its place in the queue until it is dropped.
#[derive(Debug)]
pub(super) struct Answer {
    pub(super) frame: Frame,
    /// None of pings and states, which do not queue.
    pub(super) place: Option<OwnedSemaphorePermit>,
}

/// The client is disconnected.
#[derive(Debug)]
pub(super) struct Gone;

/// An empty queue.
pub(super) fn queue() -> (Answers, mpsc::Receiver<Answer>) {
    let (frames, waiting) = mpsc::channel(ANSWERS);
    (Answers { frames, places: Arc::new(Semaphore::new(UNREAD as usize)) }, waiting)
}

impl Answers {
    /// Waits while too many answers are unread.
    pub(super) async fn send(&self, text: String) -> Result<(), Gone> {
        let size = u32::try_from(text.len()).unwrap_or(UNREAD).min(UNREAD);
        let places = Arc::clone(&self.places);
        let place = places.acquire_many_owned(size).await.map_err(|_| Gone)?;
        let answer = Answer { frame: Frame::Text(text.into()), place: Some(place) };
        self.frames.send(answer).await.map_err(|_| Gone)
    }

    /// The last frame, unless the queue is full: then nobody reads.
    pub(super) fn end(&self, frame: Frame) {
        let _ = self.frames.try_send(frame.into());
    }
}

impl From<Frame> for Answer {
    fn from(frame: Frame) -> Self {
        Self { frame, place: None }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use tokio::time::timeout;

    use super::*;

    /// Small answers queue up to their number, large ones up to their size.
    #[test]
    fn unread_answers_are_few_or_small() {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
        runtime.block_on(async {
            for (bytes, most) in [(10, ANSWERS), (200 * 1024, 2), (10 << 20, 1)] {
                let (answers, mut waiting) = queue();
                let send = || timeout(Duration::from_millis(50), answers.send("x".repeat(bytes)));
                for _ in 0..most {
                    send().await.unwrap().unwrap();
                }
                assert!(send().await.is_err(), "{bytes}");
                drop(waiting.recv().await);
                send().await.unwrap().unwrap();
                // One that waits ends with the client.
                drop(waiting);
                assert!(send().await.unwrap().is_err(), "{bytes}");
            }
        });
    }
}
