//! The sessions of a model by their names, and the places of its clients.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::thread::available_parallelism;

use axum::extract::ws::Utf8Bytes;
use cylindroid::Result;
use tokio::sync::Semaphore;

use super::names::is_plain;
use super::session::Session;
use super::shared_session::SharedSession;
use super::start::Start;

/// Maximum number of concurrent clients: 33 pages with eight models beside the first have 297.
const MOST_CLIENTS: usize = 300;

/// The sessions of a model.
#[derive(Debug, Clone)]
pub(super) struct Sessions {
    known: Arc<Mutex<Known>>,
    /// The one of a program, which all clients join that name no other.
    of_program: Option<Arc<SharedSession>>,
    clients: Arc<AtomicUsize>,
    /// Half of the processors compute reports; the others have the sockets and servos.
    reports: Arc<Semaphore>,
}

#[derive(Debug)]
struct Known {
    start: Arc<Start>,
    /// The message `model`, once the model has been loaded again.
    model: Option<Utf8Bytes>,
    live: Vec<Weak<SharedSession>>,
}

/// The place of a client, released when dropped.
#[derive(Debug)]
pub(super) struct Place(Arc<AtomicUsize>);

/// What the address of a WebSocket asks for.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Asked {
    pub(super) session: Option<String>,
    pub(super) observes: bool,
    /// An opened model, in place of that of the server.
    pub(super) model: Option<String>,
}

impl Asked {
    /// Reads `session=NAME&observe&model=ID`; other words are not for the server.
    pub(super) fn of(query: &str) -> std::result::Result<Self, &'static str> {
        let mut asked = Self::default();
        for word in query.split('&') {
            match word.split_once('=').unwrap_or((word, "")) {
                ("session", name) => asked.session = Some(checked(name)?.to_owned()),
                ("model", id) => asked.model = Some(id.to_owned()),
                ("observe", _) => asked.observes = true,
                _ => {}
            }
        }
        Ok(asked)
    }
}

fn checked(name: &str) -> std::result::Result<&str, &'static str> {
    if is_plain(name) {
        Ok(name)
    } else {
        Err("The name of a session has 1 to 60 letters, digits and characters of '-._~'.")
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

impl Sessions {
    pub(super) fn new(start: Arc<Start>, of_program: Option<Arc<SharedSession>>) -> Self {
        let processors = available_parallelism().map_or(1, usize::from);
        let reports = Arc::new(Semaphore::new((processors / 2).max(1)));
        Self { known: Known::of(start), of_program, clients: Arc::default(), reports }
    }

    /// Those of another model, beside these: all clients together have their places and reports.
    pub(super) fn beside(&self, start: Start) -> Self {
        let (clients, reports) = (Arc::clone(&self.clients), Arc::clone(&self.reports));
        Self { known: Known::of(Arc::new(start)), of_program: None, clients, reports }
    }

    fn known(&self) -> MutexGuard<'_, Known> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn start(&self) -> Arc<Start> {
        Arc::clone(&self.known().start)
    }

    /// All sessions go on with a new version of the model, if there is one, and all clients get the
    /// message `model`.
    pub(super) fn reload(&self, start: Option<Start>, told: Utf8Bytes) -> Result<()> {
        let mut known = self.known();
        if let Some(start) = start {
            let start = Arc::new(start);
            // A session of it can be begun.
            Session::new(Arc::clone(&start))?;
            known.start = start;
        }
        for session in known.live() {
            session.reload(&known.start, told.clone());
        }
        known.model = Some(told);
        Ok(())
    }

    /// True if a program holds a session.
    pub(super) fn are_of_program(&self) -> bool {
        self.of_program.is_some()
    }

    /// True if there is a session, or will be one at once.
    pub(super) fn are_in_use(&self) -> bool {
        Arc::strong_count(&self.known) > 1 || self.known().live().next().is_some()
    }

    /// A place for one more client, unless there are too many.
    pub(super) fn place(&self) -> Option<Place> {
        let more = |n| (n < MOST_CLIENTS).then_some(n + 1);
        self.clients.fetch_update(Ordering::Relaxed, Ordering::Relaxed, more).ok()?;
        Some(Place(Arc::clone(&self.clients)))
    }

    /// The places of reports that are computed at the same time, in the order they are asked for.
    pub(super) fn reports(&self) -> Arc<Semaphore> {
        Arc::clone(&self.reports)
    }

    /// The session of this name, begun if nobody holds it; without a name that of the program, or
    /// one of the client's own.
    pub(super) fn find(&self, name: Option<String>) -> Result<Arc<SharedSession>> {
        let mut known = self.known();
        let found = match &name {
            None => self.of_program.clone(),
            Some(_) => known.live().find(|session| session.name() == name.as_deref()),
        };
        if let Some(session) = found {
            return Ok(session);
        }
        let session = SharedSession::begin(Arc::clone(&known.start), name, None)?;
        if let Some(told) = &known.model {
            session.tell_model(told.clone());
        }
        known.live.retain(|session| session.strong_count() > 0);
        known.live.push(Arc::downgrade(&session));
        Ok(session)
    }
}

impl Known {
    fn of(start: Arc<Start>) -> Arc<Mutex<Self>> {
        Arc::new(Mutex::new(Self { start, model: None, live: Vec::new() }))
    }

    fn live(&self) -> impl Iterator<Item = Arc<SharedSession>> {
        self.live.iter().filter_map(Weak::upgrade)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_name_a_session_and_may_observe() {
        let asked = |session: Option<&str>, observes| {
            Ok(Asked { session: session.map(str::to_owned), observes, model: None })
        };
        assert_eq!(Asked::of(""), asked(None, false));
        assert_eq!(Asked::of("quality=high&session=demo-1"), asked(Some("demo-1"), false));
        assert_eq!(Asked::of("session=a&observe"), asked(Some("a"), true));
        let model = Some("3".to_owned());
        assert_eq!(Asked::of("model=3"), Ok(Asked { model, ..Asked::default() }));
        for name in ["", "a b", "a/b", "%41", &"x".repeat(61)] {
            assert!(Asked::of(&format!("session={name}")).is_err(), "{name}");
        }
    }
}
