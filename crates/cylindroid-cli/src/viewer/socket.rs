//! One client: its messages go to the session, answers and the newest state to the client.
//!
//! One task reads, another writes. A client that sends much yields to the others after each share
//! of work, in the midst of a message that asks for many postures too. Reports wait for one of the
//! processors that compute them.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::{Duration, Instant};

use axum::body::Bytes;
use axum::extract::ws::{CloseFrame, Message as Frame, WebSocket, close_code};
use futures_util::stream::{SplitSink, SplitStream};
use futures_util::{SinkExt, StreamExt};
use tokio::sync::{Semaphore, mpsc, watch};
use tokio::task::{JoinSet, spawn_blocking, yield_now};
use tokio::time::{sleep_until, timeout};

use super::answers::{Answer, Answers, Gone, queue};
use super::dispatcher::Reply;
use super::json::text;
use super::mailbox::Mailbox;
use super::messages::{Complaint, LARGEST, read};
use super::sessions::{Asked, Sessions};
use super::shared_session::Membership;

/// Maximum number of states in transit to a client that sends `seen`.
const UNSEEN: usize = 2;
/// Maximum number of reports of a client in progress.
const REPORTS: usize = 4;
/// A client that receives nothing for this long is disconnected.
const PATIENCE: Duration = Duration::from_secs(30);
/// Work for one client, after which the others have their turn.
const SHARE: Duration = Duration::from_millis(1);

/// A client that is gone without a word is silent: it answers no pings.
#[derive(Debug, Clone, Copy)]
pub(super) struct Silence {
    /// Interval of pings.
    pub(super) ping: Duration,
    /// A client that is silent for longer is disconnected.
    pub(super) most: Duration,
}

impl Default for Silence {
    fn default() -> Self {
        Self { ping: Duration::from_secs(20), most: Duration::from_secs(90) }
    }
}

/// Serves a client until it disconnects.
pub(super) async fn talk(socket: WebSocket, sessions: Sessions, asked: Asked, silence: Silence) {
    let (sink, stream) = socket.split();
    let mailbox = Arc::new(Mailbox::default());
    let (answers, waiting) = queue();
    let places = sessions.reports();
    let (seen, drawn) = watch::channel(None);
    let mut writer =
        tokio::spawn(write(sink, Arc::clone(&mailbox), waiting, (drawn, silence.ping)));
    match sessions.find(asked.session) {
        Ok(shared) => {
            let membership = shared.join(mailbox, asked.observes);
            drop(shared);
            let reports = JoinSet::new();
            let mut client = Client { membership, answers, seen, places, reports };
            tokio::select! {
                () = client.serve(stream, silence.most) => {}
                _ = &mut writer => return,
            }
        }
        Err(error) => {
            let answers = answers;
            let complaint = text(&Complaint::of("session", &error));
            // The queue is still empty.
            answers.end(Frame::Text(complaint.into()));
        }
    }
    // The senders are dropped: the writer sends the queued frames and ends.
    if timeout(PATIENCE, &mut writer).await.is_err() {
        writer.abort();
    }
}

struct Client {
    membership: Membership,
    answers: Answers,
    seen: watch::Sender<Option<u64>>,
    /// Of the reports of all clients that are computed at the same time.
    places: Arc<Semaphore>,
    reports: JoinSet<Option<String>>,
}

impl Client {
    /// Runs until the client disconnects or stops reading.
    async fn serve(&mut self, mut stream: SplitStream<WebSocket>, silence: Duration) {
        let mut silent = tokio::time::Instant::now() + silence;
        let mut work = Duration::ZERO;
        loop {
            let done = tokio::select! {
                frame = stream.next() => match frame {
                    Some(Ok(frame)) => {
                        let begin = Instant::now();
                        let heard = self.hear(&frame).await;
                        work += begin.elapsed();
                        // An answer may wait for its turn: that is no silence of the client.
                        silent = tokio::time::Instant::now() + silence;
                        heard
                    }
                    Some(Err(error)) => {
                        self.close(&error);
                        return;
                    }
                    None => return,
                },
                () = sleep_until(silent) => return,
                Some(report) = self.reports.join_next(), if !self.reports.is_empty() => {
                    let answered = match report.ok().flatten() {
                        Some(report) => self.answers.send(report).await,
                        None => Ok(()),
                    };
                    silent = tokio::time::Instant::now() + silence;
                    answered
                }
            };
            if done.is_err() {
                return;
            }
            if work > SHARE {
                work = Duration::ZERO;
                yield_now().await;
            }
        }
    }

    async fn hear(&mut self, frame: &Frame) -> Result<(), Gone> {
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
        match said.and_then(|request| self.membership.obey(request)) {
            Ok(Reply::Nothing | Reply::Scene | Reply::Drive(_)) => Ok(()),
            Ok(Reply::Text(text)) => self.answers.send(text).await,
            Ok(Reply::States(mut asked)) => loop {
                if let Some(text) = self.membership.compute(&mut asked, SHARE) {
                    break self.answers.send(text).await;
                }
                yield_now().await;
            },
            Ok(Reply::Seen(seq)) => {
                self.seen.send_replace(Some(seq));
                Ok(())
            }
            Ok(Reply::Report(report)) if self.reports.len() < REPORTS => {
                let places = Arc::clone(&self.places);
                self.reports.spawn(async move {
                    let place = places.acquire_owned().await.ok()?;
                    let compute = move || {
                        let _place = place;
                        report.text()
                    };
                    spawn_blocking(compute).await.ok()
                });
                Ok(())
            }
            Ok(Reply::Report(report)) => {
                let what = format!("{REPORTS} reports are in progress");
                let complaint = Complaint::new("report", "report", &what, "wait for one of them");
                let reply_to = report.reply_to().cloned();
                self.answers.send(text(&Complaint { reply_to, ..complaint })).await
            }
            Err(complaint) => self.answers.send(text(&complaint)).await,
        }
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
        self.answers.end(Frame::Close(Some(CloseFrame { code, reason })));
    }
}

/// Sends answers in order and the newest of everything else at the client's pace, until the client
/// is gone.
async fn write(
    mut sink: SplitSink<WebSocket, Frame>,
    mailbox: Arc<Mailbox>,
    mut answers: mpsc::Receiver<Answer>,
    (mut seen, interval): (watch::Receiver<Option<u64>>, Duration),
) {
    let mut unseen: VecDeque<u64> = VecDeque::new();
    let mut ping = tokio::time::Instant::now() + interval;
    loop {
        let drawn = *seen.borrow_and_update();
        while unseen.front().is_some_and(|seq| drawn.is_some_and(|d| *seq <= d)) {
            unseen.pop_front();
        }
        // Clients that never send `seen` get every state.
        let is_ready = drawn.is_none() || unseen.len() < UNSEEN;
        let answer: Answer = if ping <= tokio::time::Instant::now() {
            ping = tokio::time::Instant::now() + interval;
            Frame::Ping(Bytes::new()).into()
        } else if let Some(text) = mailbox.first() {
            Frame::Text(text).into()
        } else if let Ok(answer) = answers.try_recv() {
            answer
        } else if let Some(text) = mailbox.second() {
            Frame::Text(text).into()
        } else if let Some(state) = is_ready.then(|| mailbox.state()).flatten() {
            unseen.push_back(state.seq);
            if unseen.len() > UNSEEN {
                unseen.pop_front();
            }
            Frame::Text(state.text).into()
        } else {
            tokio::select! {
                answer = answers.recv() => match answer {
                    Some(answer) => answer,
                    None => return,
                },
                Ok(()) = seen.changed(), if !is_ready => continue,
                () = sleep_until(ping) => continue,
                () = mailbox.arrived() => continue,
            }
        };
        // Its place is free once it is sent.
        let Answer { frame, place } = answer;
        match timeout(PATIENCE, sink.send(frame)).await {
            Ok(Ok(())) => drop(place),
            _ => return,
        }
    }
}
