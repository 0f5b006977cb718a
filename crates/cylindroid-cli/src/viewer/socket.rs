//! One client: messages in, the newest state out, the servo in time.
//!
//! A task reads and steps, another writes. Between them stands one state, the newest: what was not
//! sent when a newer one is there is gone, whatever the speed of the network or the browser.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::{Duration, Instant};

use axum::body::Bytes;
use axum::extract::ws::{CloseFrame, Message as Frame, WebSocket, close_code};
use futures_util::stream::{SplitSink, SplitStream};
use futures_util::{SinkExt, StreamExt};
use tokio::sync::{mpsc, watch};
use tokio::task::JoinSet;
use tokio::time::{Interval, MissedTickBehavior, interval, sleep_until, timeout};

use super::dispatcher::{Reply, handle};
use super::json::text;
use super::messages::{Complaint, LARGEST, read};
use super::scene::Scene;
use super::session::{STEPS, Session};
use super::snapshot::snapshot;
use super::start::Start;

/// States in a second, at most.
const RATE: u32 = 60;
/// Time of the servo that is made up for at most when its turn comes late; more is left out.
const CATCH_UP: Duration = Duration::from_millis(100);
/// Answers that wait for a client that does not read; one more ends the connection.
const ANSWERS: usize = 64;
/// States under way to a client that says what it has seen.
const UNSEEN: usize = 2;
/// Reports in the making.
const REPORTS: usize = 4;
/// A client that takes nothing for so long is gone.
const PATIENCE: Duration = Duration::from_secs(30);
/// Time between two pings, and how long a client may say nothing at all, not even to these.
const PING: Duration = Duration::from_secs(20);
const SILENCE: Duration = Duration::from_secs(90);

/// The newest state and its number; none where the last scene has none yet.
type State = Option<Arc<(u64, String)>>;

/// Serves a client until it leaves.
pub(super) async fn talk(socket: WebSocket, start: Arc<Start>) {
    let (sink, stream) = socket.split();
    let (states, newest) = watch::channel(None);
    let (answers, waiting) = mpsc::channel(ANSWERS);
    let (seen, drawn) = watch::channel(None);
    let mut writer = tokio::spawn(write(sink, newest, waiting, drawn));
    match Session::new(start) {
        Ok(session) => {
            let mut client = Client {
                session,
                states,
                answers,
                seen,
                reports: JoinSet::new(),
                seq: 0,
                is_dirty: true,
                last: None,
                owed: Duration::ZERO,
            };
            tokio::select! {
                () = client.serve(stream) => {}
                _ = &mut writer => return,
            }
        }
        Err(error) => {
            let answers = answers;
            let complaint = text(&Complaint::of("session", &error));
            // Nothing waits yet.
            let _ = answers.try_send(Frame::Text(complaint.into()));
        }
    }
    // The senders are gone: it sends what waits, and ends.
    if timeout(PATIENCE, &mut writer).await.is_err() {
        writer.abort();
    }
}

struct Client {
    session: Session,
    states: watch::Sender<State>,
    answers: mpsc::Sender<Frame>,
    seen: watch::Sender<Option<u64>>,
    reports: JoinSet<String>,
    seq: u64,
    /// True if something has changed since the last state.
    is_dirty: bool,
    /// When the servo had its last turn, if it moves.
    last: Option<Instant>,
    /// Time that it has not yet moved for.
    owed: Duration,
}

impl Client {
    /// Until the client leaves, or does not read.
    async fn serve(&mut self, mut stream: SplitStream<WebSocket>) {
        if self.scene().is_err() {
            return;
        }
        let mut clock: Interval = interval(Duration::from_secs(1) / RATE);
        clock.set_missed_tick_behavior(MissedTickBehavior::Delay);
        let mut silent = tokio::time::Instant::now() + SILENCE;
        loop {
            let is_live = self.session.is_moving() || self.is_dirty;
            let done = tokio::select! {
                frame = stream.next() => match frame {
                    Some(Ok(frame)) => {
                        silent = tokio::time::Instant::now() + SILENCE;
                        self.hear(&frame)
                    }
                    Some(Err(error)) => {
                        self.close(&error);
                        return;
                    }
                    None => return,
                },
                _ = clock.tick(), if is_live => {
                    self.turn();
                    Ok(())
                }
                () = sleep_until(silent) => return,
                Some(report) = self.reports.join_next(), if !self.reports.is_empty() => {
                    report.map_or(Ok(()), |report| self.answer(report))
                }
            };
            if done.is_err() {
                return;
            }
        }
    }

    /// Steps for the time that has passed, and shows what came of it.
    fn turn(&mut self) {
        if self.session.is_moving() {
            let now = Instant::now();
            let turn = Duration::from_secs(1) / RATE;
            self.owed += self.last.map_or(turn, |last| now - last);
            self.owed = self.owed.min(CATCH_UP);
            let step = Duration::from_secs(1) / STEPS;
            let steps = self.owed.as_nanos() / step.as_nanos();
            let steps = u32::try_from(steps).unwrap_or(0);
            self.owed -= step * steps;
            self.is_dirty |= self.session.advance(u64::from(steps));
            self.last = Some(now);
        }
        if !self.session.is_moving() {
            (self.last, self.owed) = (None, Duration::ZERO);
        }
        if !std::mem::take(&mut self.is_dirty) {
            return;
        }
        self.seq += 1;
        // A state that cannot be told (numbers that overflow) is told with the next.
        if let Ok(state) = snapshot(&mut self.session, self.seq) {
            self.states.send_replace(Some(Arc::new((self.seq, state))));
        }
    }

    fn hear(&mut self, frame: &Frame) -> Result<(), Gone> {
        let said = match frame {
            Frame::Text(said) if said.len() > LARGEST => Err(Complaint::new(
                "message",
                &format!("{} bytes", said.len()),
                &format!("a message has at most {LARGEST} bytes"),
                "send less",
            )),
            Frame::Text(said) => read(said),
            Frame::Binary(_) => Err(Complaint::new(
                "message",
                "binary",
                "messages are text",
                "send one JSON object in a text frame",
            )),
            Frame::Ping(_) | Frame::Pong(_) | Frame::Close(_) => return Ok(()),
        };
        let reply = said.and_then(|request| handle(&mut self.session, request));
        if !matches!(reply, Ok(Reply::Seen(_))) {
            self.is_dirty = true;
        }
        match reply {
            Ok(Reply::Nothing) => Ok(()),
            Ok(Reply::Scene) => self.scene(),
            Ok(Reply::Text(text)) => self.answer(text),
            Ok(Reply::Seen(seq)) => {
                self.seen.send_replace(Some(seq));
                Ok(())
            }
            Ok(Reply::Report(report)) if self.reports.len() < REPORTS => {
                self.reports.spawn_blocking(move || report.text());
                Ok(())
            }
            Ok(Reply::Report(_)) => {
                let what = format!("{REPORTS} reports are in the making");
                let complaint = Complaint::new("report", "report", &what, "wait for one of them");
                let reply_to = self.session.ack().cloned();
                self.answer(text(&Complaint { reply_to, ..complaint }))
            }
            Err(complaint) => self.answer(text(&complaint)),
        }
    }

    fn scene(&self) -> Result<(), Gone> {
        // One that waits is of the scene before.
        self.states.send_replace(None);
        self.answer(text(&Scene::of(&self.session)))
    }

    /// A client that does not read its answers is taken for gone.
    fn answer(&self, text: String) -> Result<(), Gone> {
        self.answers.try_send(Frame::Text(text.into())).map_err(|_| Gone)
    }

    /// Says why, where the client broke the rules: a message that is too long.
    fn close(&self, error: &axum::Error) {
        let reason = error.to_string();
        let code = if reason.contains("too long") || reason.contains("too large") {
            close_code::SIZE
        } else {
            close_code::PROTOCOL
        };
        let reason = "this is no message of docs/viewer.md".into();
        // If there is no room, there is no reader.
        let _ = self.answers.try_send(Frame::Close(Some(CloseFrame { code, reason })));
    }
}

/// The client is gone.
#[derive(Debug)]
struct Gone;

/// Sends answers as they come and states as they are asked for, until the session is gone.
async fn write(
    mut sink: SplitSink<WebSocket, Frame>,
    mut states: watch::Receiver<State>,
    mut answers: mpsc::Receiver<Frame>,
    mut seen: watch::Receiver<Option<u64>>,
) {
    let mut unseen: VecDeque<u64> = VecDeque::new();
    let mut pings = interval(PING);
    loop {
        let drawn = *seen.borrow_and_update();
        while unseen.front().is_some_and(|seq| drawn.is_some_and(|d| *seq <= d)) {
            unseen.pop_front();
        }
        // Who never says what it has seen is sent everything.
        let is_ready = drawn.is_none() || unseen.len() < UNSEEN;
        let frame = tokio::select! {
            biased;
            answer = answers.recv() => match answer {
                Some(frame) => frame,
                None => return,
            },
            Ok(()) = seen.changed(), if !is_ready => continue,
            _ = pings.tick() => Frame::Ping(Bytes::new()),
            Ok(()) = states.changed(), if is_ready => {
                let Some(state) = states.borrow_and_update().clone() else { continue };
                unseen.push_back(state.0);
                if unseen.len() > UNSEEN {
                    unseen.pop_front();
                }
                Frame::Text(state.1.as_str().into())
            }
        };
        match timeout(PATIENCE, sink.send(frame)).await {
            Ok(Ok(())) => {}
            _ => return,
        }
    }
}
