//! One client: receives messages, steps the servo in real time, sends the latest state.
//!
//! One task reads and steps, another writes. Only the latest state is kept between them: a state
//! not yet sent is replaced by a newer one, so slow networks and browsers never lag behind.

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

/// Maximum number of states per second.
const RATE: u32 = 60;
/// Maximum servo time that is caught up after a delay; the rest is skipped.
const CATCH_UP: Duration = Duration::from_millis(100);
/// Maximum number of unread answers; one more ends the connection.
const ANSWERS: usize = 64;
/// Maximum number of states in transit to a client that sends `seen`.
const UNSEEN: usize = 2;
/// Maximum number of concurrent reports.
const REPORTS: usize = 4;
/// A client that receives nothing for this long is disconnected.
const PATIENCE: Duration = Duration::from_secs(30);
/// Interval of pings, and maximum silence of a client, including answers to pings.
const PING: Duration = Duration::from_secs(20);
const SILENCE: Duration = Duration::from_secs(90);

/// The latest state and its number; `None` before the first state of a scene.
type State = Option<Arc<(u64, String)>>;

/// Serves a client until it disconnects.
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
            // The queue is still empty.
            let _ = answers.try_send(Frame::Text(complaint.into()));
        }
    }
    // The senders are dropped: the writer sends the queued frames and ends.
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
    /// True if the session changed since the last state.
    is_dirty: bool,
    /// Time of the last servo update, if it is moving.
    last: Option<Instant>,
    /// Elapsed time not yet covered by steps.
    owed: Duration,
}

impl Client {
    /// Runs until the client disconnects or stops reading.
    async fn serve(&mut self, mut stream: SplitStream<WebSocket>) {
        if self.scene().is_err() {
            return;
        }
        let mut clock: Interval = interval(Duration::from_secs(1) / RATE);
        clock.set_missed_tick_behavior(MissedTickBehavior::Delay);
        let mut silent = tokio::time::Instant::now() + SILENCE;
        let turn = Duration::from_secs(1) / RATE;
        let mut shown = tokio::time::Instant::now() - turn;
        loop {
            let is_live = self.session.is_moving() || self.is_dirty;
            // After a pause the first state goes out at once.
            if is_live && shown.elapsed() >= turn {
                shown = tokio::time::Instant::now();
                clock.reset();
                self.turn();
                continue;
            }
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
                    shown = tokio::time::Instant::now();
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

    /// Steps the servo for the elapsed time and publishes the new state.
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
        // A state that cannot be computed (overflow) is skipped.
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
                "send a shorter message",
            )),
            Frame::Text(said) => read(said),
            Frame::Binary(_) => Err(Complaint::new(
                "message",
                "binary",
                "messages must be text frames",
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
                let what = format!("{REPORTS} reports are in progress");
                let complaint = Complaint::new("report", "report", &what, "wait for one of them");
                let reply_to = self.session.ack().cloned();
                self.answer(text(&Complaint { reply_to, ..complaint }))
            }
            Err(complaint) => self.answer(text(&complaint)),
        }
    }

    fn scene(&self) -> Result<(), Gone> {
        // A state still waiting belongs to the previous scene.
        self.states.send_replace(None);
        self.answer(text(&Scene::of(&self.session)))
    }

    /// A client that does not read its answers counts as disconnected.
    fn answer(&self, text: String) -> Result<(), Gone> {
        self.answers.try_send(Frame::Text(text.into())).map_err(|_| Gone)
    }

    /// Closes with a reason if the client violated the protocol (message too long).
    fn close(&self, error: &axum::Error) {
        let reason = error.to_string();
        let code = if reason.contains("too long") || reason.contains("too large") {
            close_code::SIZE
        } else {
            close_code::PROTOCOL
        };
        let reason = "not a message of docs/viewer.md".into();
        // A full queue means that nobody reads.
        let _ = self.answers.try_send(Frame::Close(Some(CloseFrame { code, reason })));
    }
}

/// The client is disconnected.
#[derive(Debug)]
struct Gone;

/// Sends answers in order and the latest states at the client's pace, until the session ends.
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
        // Clients that never send `seen` get every state.
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
