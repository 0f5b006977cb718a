//! The sessions of a server by their names, and the places of its clients.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError, Weak};

use cylindroid::Result;

use super::shared_session::SharedSession;
use super::start::Start;

/// Maximum number of concurrent clients.
const MOST_CLIENTS: usize = 100;
/// Longest name of a session.
const LONGEST_NAME: usize = 60;

/// The sessions of a server.
#[derive(Debug, Clone)]
pub(super) struct Sessions {
    start: Arc<Start>,
    named: Arc<Mutex<BTreeMap<String, Weak<SharedSession>>>>,
    /// The one of a program, which all clients join that name no other.
    of_program: Option<Arc<SharedSession>>,
    clients: Arc<AtomicUsize>,
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
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-._~".contains(c);
    if (1..=LONGEST_NAME).contains(&name.len()) && name.chars().all(is_plain) {
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
        Self { start, named: Arc::default(), of_program, clients: Arc::default() }
    }

    /// Those of another model, beside these: all clients together have their places.
    pub(super) fn beside(&self, start: Start) -> Self {
        let clients = Arc::clone(&self.clients);
        Self { start: Arc::new(start), named: Arc::default(), of_program: None, clients }
    }

    pub(super) fn start(&self) -> &Start {
        &self.start
    }

    /// True if a program holds a session.
    pub(super) fn are_of_program(&self) -> bool {
        self.of_program.is_some()
    }

    /// True if there is a session, or will be one at once.
    pub(super) fn are_in_use(&self) -> bool {
        Arc::strong_count(&self.start) > 1
    }

    /// A place for one more client, unless there are too many.
    pub(super) fn place(&self) -> Option<Place> {
        let more = |n| (n < MOST_CLIENTS).then_some(n + 1);
        self.clients.fetch_update(Ordering::Relaxed, Ordering::Relaxed, more).ok()?;
        Some(Place(Arc::clone(&self.clients)))
    }

    /// The session of this name, begun if nobody holds it; without a name that of the program, or
    /// one of the client's own.
    pub(super) fn find(&self, name: Option<String>) -> Result<Arc<SharedSession>> {
        let begin = |name| SharedSession::begin(Arc::clone(&self.start), name, None);
        let Some(name) = name else {
            return self.of_program.clone().map_or_else(|| begin(None), Ok);
        };
        let mut named = self.named.lock().unwrap_or_else(PoisonError::into_inner);
        named.retain(|_, session| session.strong_count() > 0);
        if let Some(session) = named.get(&name).and_then(Weak::upgrade) {
            return Ok(session);
        }
        let session = begin(Some(name.clone()))?;
        named.insert(name, Arc::downgrade(&session));
        Ok(session)
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
