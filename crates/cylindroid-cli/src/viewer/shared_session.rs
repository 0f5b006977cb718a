//! A session and its clients: one drives, the others observe, and all of them see the same states.
//!
//! A task of its own moves the servo in real time and gives every client the newest state, with the
//! overlays and distances that this client has asked for. It ends with the session, which lives as
//! long as a client or a program holds it.

use std::collections::BTreeMap;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError, Weak};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use axum::extract::ws::Utf8Bytes;
use cylindroid::Result;
use serde::Serialize;
use tokio::sync::Notify;
use tokio::time::sleep_until;

use super::client_view::ClientView;
use super::dispatcher::{Reply, handle};
use super::drags::{Drag, Drags, Moves};
use super::drawings::Drawings;
use super::elsewhere::Elsewhere;
use super::json::text;
use super::mailbox::{Mailbox, Numbered};
use super::messages::{Complaint, Request};
use super::scene::Scene;
use super::session::{STEPS, Session};
use super::snapshot::{Common, snapshot};
use super::start::Start;

/// Time between states, at the least.
const TURN: Duration = Duration::from_nanos(1_000_000_000 / 60);
/// Maximum servo time that is caught up after a delay; the rest is skipped.
const CATCH_UP: Duration = Duration::from_millis(100);

/// A session and its clients.
#[derive(Debug)]
pub(super) struct SharedSession {
    /// `None`: of one client alone.
    name: Option<String>,
    /// Since 1970 [ms].
    begun: u64,
    inner: Mutex<Inner>,
    changed: Arc<Notify>,
    /// A client moved something that a program waits for.
    dragged: Condvar,
}

#[derive(Debug)]
pub(super) struct Inner {
    pub(super) session: Session,
    pub(super) program: Option<Program>,
    /// The message `model`, once the model has been loaded again.
    model: Option<Utf8Bytes>,
    clients: BTreeMap<u64, Client>,
    next: u64,
    driver: Option<u64>,
    seq: u64,
    began: Instant,
    /// True if the session changed since the last state.
    is_dirty: bool,
    /// Time of the last servo update, if it is moving.
    last: Option<Instant>,
    /// Elapsed time not yet covered by steps.
    owed: Duration,
}

/// What belongs to a program that holds the session.
#[derive(Debug, Default)]
pub(super) struct Program {
    pub(super) drawings: Drawings,
    pub(super) drags: Drags,
    /// True if the drawings changed since they were sent.
    pub(super) is_redrawn: bool,
    pub(super) is_closed: bool,
}

#[derive(Debug)]
struct Client {
    view: ClientView,
    mailbox: Arc<Mailbox>,
}

/// The place of a client, left when it is dropped.
#[derive(Debug)]
pub(super) struct Membership {
    shared: Arc<SharedSession>,
    id: u64,
}

/// The message `session`.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(tag = "type", rename = "session")]
pub(super) struct AboutJson<'a> {
    name: Option<&'a str>,
    begun: u64,
    clients: usize,
    driver: Driver,
    program: bool,
}

/// Who drives, to one client.
#[derive(Debug, Clone, Copy, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
enum Driver {
    You,
    Another,
    Nobody,
}

impl SharedSession {
    /// Begins a session, in a runtime; `None` is the name of one client's own.
    pub(super) fn begin(
        start: Arc<Start>,
        name: Option<String>,
        program: Option<Program>,
    ) -> Result<Arc<Self>> {
        let inner = Inner {
            session: Session::new(start)?,
            program,
            model: None,
            clients: BTreeMap::new(),
            next: 0,
            driver: None,
            seq: 0,
            began: Instant::now(),
            is_dirty: true,
            last: None,
            owed: Duration::ZERO,
        };
        let changed = Arc::new(Notify::new());
        let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        let shared = Arc::new(Self {
            name,
            begun: u64::try_from(now.as_millis()).unwrap_or(u64::MAX),
            inner: Mutex::new(inner),
            changed: Arc::clone(&changed),
            dragged: Condvar::new(),
        });
        tokio::spawn(keep_time(Arc::downgrade(&shared), changed));
        Ok(shared)
    }

    fn lock(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Lets a client in, as driver if nobody drives and it does not merely observe.
    pub(super) fn join(self: &Arc<Self>, mailbox: Arc<Mailbox>, observes: bool) -> Membership {
        let mut inner = self.lock();
        let id = inner.next;
        inner.next += 1;
        if inner.driver.is_none() && !observes {
            inner.driver = Some(id);
        }
        let client = Client { view: ClientView::default(), mailbox: Arc::clone(&mailbox) };
        inner.clients.insert(id, client);
        // The client may read while this is written: what comes first is put first.
        self.tell_roles(&inner);
        if let Some(told) = &inner.model {
            mailbox.put_model(told.clone());
        }
        mailbox.put_scene(text(&Scene::of(&inner.session)).into());
        if let Some(program) = &inner.program {
            mailbox.put_drawings(program.drawings.text().into());
        }
        inner.is_dirty = true;
        drop(inner);
        self.changed.notify_one();
        Membership { shared: Arc::clone(self), id }
    }

    pub(super) fn name(&self) -> Option<&str> {
        self.name.as_deref()
    }

    /// Gives all clients, and those to come, the message `model`.
    pub(super) fn tell_model(&self, told: Utf8Bytes) {
        let mut inner = self.lock();
        inner.clients.values().for_each(|client| client.mailbox.put_model(told.clone()));
        inner.model = Some(told);
    }

    /// Goes on with this version of the model, if it is another one.
    pub(super) fn reload(&self, start: &Arc<Start>, told: Utf8Bytes) {
        self.tell_model(told);
        let mut inner = self.lock();
        if inner.session.is_of(start) {
            return;
        }
        // A session of this start can be begun.
        let Ok(session) = inner.session.reloaded(start) else { return };
        inner.session = session;
        inner.show_scene();
        inner.is_dirty = true;
        drop(inner);
        self.changed.notify_one();
    }

    /// The number of clients.
    pub(super) fn clients(&self) -> usize {
        self.lock().clients.len()
    }

    /// The number of clients that there have been.
    pub(super) fn visits(&self) -> u64 {
        self.lock().next
    }

    /// A client alone always drives.
    fn has_roles(&self, inner: &Inner) -> bool {
        self.name.is_some() || inner.program.is_some()
    }

    /// Tells every client who drives.
    fn tell_roles(&self, inner: &Inner) {
        if !self.has_roles(inner) {
            return;
        }
        for (id, client) in &inner.clients {
            let driver = match inner.driver {
                None => Driver::Nobody,
                Some(driver) if driver == *id => Driver::You,
                Some(_) => Driver::Another,
            };
            let about = AboutJson {
                name: self.name.as_deref(),
                begun: self.begun,
                clients: inner.clients.len(),
                driver,
                program: inner.program.is_some(),
            };
            client.mailbox.put_about(text(&about).into());
        }
    }

    /// What a program does with the session; all clients see it.
    pub(super) fn change<T>(&self, what: impl FnOnce(&mut Inner) -> Result<T>) -> Result<T> {
        let mut inner = self.lock();
        let done = what(&mut inner);
        inner.is_dirty = true;
        drop(inner);
        self.changed.notify_one();
        self.dragged.notify_all();
        done
    }

    /// What a program reads.
    pub(super) fn read<T>(&self, what: impl FnOnce(&Inner) -> T) -> T {
        what(&self.lock())
    }

    /// What clients have moved since the last call; waits for it as long as this. `None` if the
    /// program has closed the session.
    pub(super) fn next_drags(&self, patience: Duration) -> Option<Vec<Drag>> {
        let idle = |inner: &mut Inner| {
            inner.program.as_ref().is_some_and(|p| p.drags.is_empty() && !p.is_closed)
        };
        let waited = self.dragged.wait_timeout_while(self.lock(), patience, idle);
        let (mut inner, _) = waited.unwrap_or_else(PoisonError::into_inner);
        let program = inner.program.as_mut().filter(|program| !program.is_closed)?;
        Some(program.drags.take())
    }

    fn is_live(&self) -> bool {
        let inner = self.lock();
        inner.session.is_moving() || inner.is_dirty
    }
}

impl Drop for SharedSession {
    fn drop(&mut self) {
        self.changed.notify_one();
    }
}

/// Steps the servo and publishes states while something moves or changes. After a pause the first
/// state goes out at once.
async fn keep_time(shared: Weak<SharedSession>, changed: Arc<Notify>) {
    let mut due = tokio::time::Instant::now();
    while let Some(is_live) = shared.upgrade().map(|shared| shared.is_live()) {
        if !is_live {
            changed.notified().await;
            continue;
        }
        sleep_until(due).await;
        let Some(shared) = shared.upgrade() else { return };
        due = due.max(tokio::time::Instant::now() - TURN) + TURN;
        shared.lock().turn();
        shared.dragged.notify_all();
    }
}

impl Inner {
    /// Steps the servo for the elapsed time and publishes the new state.
    fn turn(&mut self) {
        if self.session.is_moving() {
            let now = Instant::now();
            self.owed += self.last.map_or(TURN, |last| now - last);
            self.owed = self.owed.min(CATCH_UP);
            let step = Duration::from_secs(1) / STEPS;
            let steps = self.owed.as_nanos() / step.as_nanos();
            let steps = u32::try_from(steps).unwrap_or(0);
            self.owed -= step * steps;
            let moves = Moves::by_steps(&self.session);
            if self.session.advance(u64::from(steps)) {
                self.is_dirty = true;
                self.tell_program(moves);
            }
            self.last = Some(now);
        }
        if !self.session.is_moving() {
            (self.last, self.owed) = (None, Duration::ZERO);
        }
        if std::mem::take(&mut self.is_dirty) {
            self.publish();
        }
    }

    /// Gives the program what has been moved by hand.
    fn tell_program(&mut self, moves: Option<Moves>) {
        if let (Some(program), Some(moves)) = (&mut self.program, moves)
            && let Some(drag) = moves.drag(&self.session)
        {
            program.drags.put(drag);
        }
    }

    fn publish(&mut self) {
        self.seq += 1;
        let Self { session, clients, seq, began, program, .. } = self;
        if let Some(program) = program.as_mut().filter(|program| program.is_redrawn) {
            program.is_redrawn = false;
            let drawings = Utf8Bytes::from(program.drawings.text());
            clients.values().for_each(|client| client.mailbox.put_drawings(drawings.clone()));
        }
        let common = Common::of(session, began.elapsed().as_secs_f64());
        let mut made: Vec<(&ClientView, Utf8Bytes)> = Vec::new();
        for client in clients.values() {
            let known = made.iter().find(|(view, _)| **view == client.view);
            let text = match known {
                Some((_, text)) => text.clone(),
                None => {
                    // A state that cannot be computed (overflow) is skipped.
                    let Ok(text) = snapshot(session, &common, &client.view, *seq) else { continue };
                    let text = Utf8Bytes::from(text);
                    made.push((&client.view, text.clone()));
                    text
                }
            };
            client.mailbox.put_state(Numbered { seq: *seq, text });
        }
    }

    /// Gives all clients the new scene.
    pub(super) fn show_scene(&self) {
        let scene = Utf8Bytes::from(text(&Scene::of(&self.session)));
        self.clients.values().for_each(|client| client.mailbox.put_scene(scene.clone()));
    }
}

impl Membership {
    /// Executes a message of this client.
    pub(super) fn obey(&self, request: Request) -> std::result::Result<Reply, Complaint> {
        let mut inner = self.shared.lock();
        let done = self.attempt(&mut inner, request);
        inner.is_dirty |= !matches!(done, Ok(Reply::Seen(_)));
        drop(inner);
        self.shared.changed.notify_one();
        done
    }

    /// Computes for so long; gives the answer once it is there.
    pub(super) fn compute(&self, asked: &mut Elsewhere, share: Duration) -> Option<String> {
        let mut inner = self.shared.lock();
        let Inner { session, clients, .. } = &mut *inner;
        match clients.get(&self.id) {
            Some(client) => asked.advance(session, &client.view, share),
            None => Some(String::new()),
        }
    }

    fn attempt(
        &self,
        inner: &mut Inner,
        request: Request,
    ) -> std::result::Result<Reply, Complaint> {
        if request.message.drives() && inner.driver != Some(self.id) {
            let what = "this client observes the session";
            let way_out = "send {\"type\": \"drive\", \"on\": true} to take over";
            let complaint = Complaint::new("session", "driver", what, way_out);
            return Err(Complaint { reply_to: request.id, ..complaint });
        }
        let moves = Moves::of(&request.message);
        let Inner { session, clients, .. } = inner;
        let Some(client) = clients.get_mut(&self.id) else { return Ok(Reply::Nothing) };
        let reply = handle(session, &mut client.view, request);
        inner.tell_program(moves);
        self.shared.dragged.notify_all();
        match reply {
            Ok(Reply::Scene) => inner.show_scene(),
            Ok(Reply::Drive(on))
                if self.shared.has_roles(inner) && on != (inner.driver == Some(self.id)) =>
            {
                inner.driver = on.then_some(self.id);
                self.shared.tell_roles(inner);
            }
            _ => {}
        }
        reply
    }
}

impl Drop for Membership {
    fn drop(&mut self) {
        let mut inner = self.shared.lock();
        inner.clients.remove(&self.id);
        if inner.driver == Some(self.id) {
            inner.driver = None;
        }
        self.shared.tell_roles(&inner);
    }
}

#[cfg(test)]
mod tests {
    use std::iter::repeat_with;

    use cylindroid::catalogue;

    use super::*;
    use crate::viewer::messages::read;
    use crate::viewer::start::StartBodies;

    /// How long the next state takes.
    async fn state(mailbox: &Mailbox) -> Duration {
        let begin = tokio::time::Instant::now();
        loop {
            while mailbox.first().is_some() {}
            if mailbox.state().is_some() {
                return begin.elapsed();
            }
            mailbox.arrived().await;
        }
    }

    fn session(name: Option<&str>) -> Arc<SharedSession> {
        let robot = catalogue::load("panda").unwrap();
        let (q, tool) = (robot.home().to_vec(), robot.tool().into());
        let start = Start::new((robot, "panda"), &q, tool, &[], StartBodies::default()).unwrap();
        SharedSession::begin(Arc::new(start), name.map(str::to_owned), None).unwrap()
    }

    /// Pages take a session for one of their own where the scene comes without a role.
    #[tokio::test]
    async fn who_drives_comes_before_the_scene_however_fast_a_client_reads() {
        let shared = session(Some("demo"));
        shared.tell_model("model".into());
        for _ in 0..300 {
            let mailbox = Arc::new(Mailbox::default());
            let reads = Arc::clone(&mailbox);
            // A limit, so that a message that is missing ends the test.
            let looks = move || repeat_with(move || reads.first()).take(10_000_000);
            let all = move || looks().flatten().take(3).collect::<Vec<_>>();
            let reader = std::thread::spawn(all);
            let _membership = shared.join(mailbox, false);
            let messages = reader.join().unwrap();
            assert!(messages[0].starts_with(r#"{"type":"session""#), "{}", messages[0]);
            assert_eq!(messages[1], "model");
            assert!(messages[2].starts_with(r#"{"type":"scene""#));
        }
    }

    /// The clock stands still while a task has something to do.
    #[tokio::test(start_paused = true)]
    async fn states_come_at_once_after_a_pause_and_once_a_turn_otherwise() {
        let shared = session(None);
        let mailbox = Arc::new(Mailbox::default());
        let membership = shared.join(Arc::clone(&mailbox), false);
        state(&mailbox).await;
        let say = |value: f64| {
            let name = "panda_joint1";
            let message = format!(r#"{{"type": "joint", "name": "{name}", "value": {value}}}"#);
            membership.obey(read(&message).unwrap()).unwrap();
        };
        for _ in 0..3 {
            tokio::time::sleep(Duration::from_secs(1)).await;
            assert!(mailbox.state().is_none());
            say(0.1);
            assert_eq!(state(&mailbox).await, Duration::ZERO);
            let mut others = Duration::ZERO;
            for value in [0.2, 0.3, 0.4] {
                say(value);
                others += state(&mailbox).await;
            }
            assert!((TURN..4 * TURN).contains(&others), "{others:?}");
        }
    }
}
