//! Dispatches each client message to its session and returns the answer.

use cylindroid::{Error, Result};
use serde_json::Value;

use super::compare::compare;
use super::inverse_parameters::invert_by;
use super::messages::{Complaint, Message, Request};
use super::names::Overlay;
use super::reaching::{Reached, assembled, reach};
use super::reports::Report;
use super::session::Session;

/// The answer to a message.
#[derive(Debug)]
pub(super) enum Reply {
    /// None: the next state shows the effect.
    Nothing,
    /// The scene changed and is sent again.
    Scene,
    /// This text.
    Text(String),
    /// A report, to be computed in the background.
    Report(Report),
    /// The client has drawn this state.
    Seen(u64),
}

/// Executes a message. On an error the session is unchanged, except for `joint`, which moves as far
/// as possible.
pub(super) fn handle(
    session: &mut Session,
    request: Request,
) -> std::result::Result<Reply, Complaint> {
    let Request { id, message } = request;
    if let Message::Seen(seen) = message {
        return Ok(Reply::Seen(seen.seq));
    }
    session.acknowledge(id.as_ref());
    obey(session, message, id.as_ref()).map_err(|c| Complaint { reply_to: id, ..c })
}

fn obey(
    session: &mut Session,
    message: Message,
    id: Option<&Value>,
) -> std::result::Result<Reply, Complaint> {
    let at = |place: &'static str| move |error: Error| Complaint::of(place, &error);
    match message {
        Message::Joint(joint) => {
            let Reached { q, complaint } = reach(session.state(), &joint.name, joint.value)?;
            session.stand(&q).map_err(at("joint.value"))?;
            complaint.map_or(Ok(()), Err)?;
        }
        Message::Configuration(desired) => {
            let q = assembled(session.mechanism(), &desired.q);
            q.and_then(|q| session.stand(&q)).map_err(at("configuration.q"))?;
        }
        Message::Target(target) => session.aim(&target)?,
        Message::Frame(frame) => {
            let found = session.mechanism().frame(&frame.name);
            found.and_then(|f| session.choose_frame(f)).map_err(at("frame.name"))?;
            return Ok(Reply::Scene);
        }
        Message::Task(task) => {
            session.choose_task(task.name).map_err(at("task.name"))?;
            return Ok(Reply::Scene);
        }
        Message::Play(_) => session.play(),
        Message::Pause(_) => session.pause(),
        Message::Reset(_) => session.reset().map_err(at("reset"))?,
        Message::NullSpace(desired) => session.turn(&desired)?,
        Message::Actuated(joints) => {
            session.drive_by(&joints.names)?;
            return Ok(Reply::Scene);
        }
        Message::Method(choice) => {
            let options = session.options().clone();
            let best_pitch = || session.best_pitch();
            let (chosen, options) = invert_by(choice, session.state(), options, best_pitch)?;
            session.choose_method(chosen, options).map_err(at("method"))?;
            return Ok(Reply::Scene);
        }
        Message::Overlays(asked) => {
            let names = asked.names.iter().map(|name| Overlay::named(name));
            let mut all: Vec<Overlay> =
                names.collect::<Result<_>>().map_err(at("overlays.names"))?;
            all.sort_unstable();
            all.dedup();
            session.choose_overlays(all);
        }
        Message::Compare(asked) => return compare(session, &asked, id).map(Reply::Text),
        Message::Report(asked) => {
            return Report::new(session, &asked.name, id).map(Reply::Report);
        }
        Message::Seen(seen) => return Ok(Reply::Seen(seen.seq)),
    }
    Ok(Reply::Nothing)
}
