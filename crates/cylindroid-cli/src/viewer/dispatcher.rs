//! Dispatches each client message to its session and returns the answer.

use std::collections::BTreeSet;

use cylindroid::{Error, Result, Twist, Vec3};
use serde_json::Value;

use super::avoidance::{GAP, MARGIN};
use super::beside::{Beside, ModelBeside};
use super::client_view::ClientView;
use super::compare::compare;
use super::elsewhere::Elsewhere;
use super::inverse_parameters::invert_by;
use super::messages::{Complaint, Message, Request, TargetPose, TwistCommand};
use super::names::{Overlay, is_plain};
use super::obstacle_messages::{AddObstacle, AvoidCollisions, MoveObstacle};
use super::reaching::{Reached, assembled, reach};
use super::reports::Report;
use super::session::Session;
use crate::obstacle::ObstacleArg;

/// Longest name of an obstacle, in characters.
const LONGEST_NAME: usize = 60;
/// Maximum number of models beside that of a session.
const MOST_BESIDE: usize = 8;

/// The answer to a message.
#[derive(Debug)]
pub(super) enum Reply {
    /// None: the next state shows the effect.
    Nothing,
    /// The scene changed and is sent again.
    Scene,
    /// This text.
    Text(String),
    /// Postures, to be computed in pieces.
    States(Elsewhere),
    /// A report, to be computed in the background.
    Report(Report),
    /// The client has drawn this state.
    Seen(u64),
    /// The client wants to drive, or no longer.
    Drive(bool),
}

/// Executes a message of the client with this view. On an error the session is unchanged, except for
/// `joint`, which moves as far as possible.
pub(super) fn handle(
    session: &mut Session,
    view: &mut ClientView,
    request: Request,
) -> std::result::Result<Reply, Complaint> {
    let Request { id, message } = request;
    if let Message::Seen(seen) = message {
        return Ok(Reply::Seen(seen.seq));
    }
    view.ack.clone_from(&id);
    obey(session, view, message, id.as_ref()).map_err(|c| Complaint { reply_to: id, ..c })
}

fn obey(
    session: &mut Session,
    view: &mut ClientView,
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
        Message::Twist(TwistCommand { linear, angular }) => {
            let (linear, angular) = (Vec3::from_array(linear), Vec3::from_array(angular));
            session.follow(Twist { linear, angular })?;
        }
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
            view.overlays = all;
        }
        Message::Compare(asked) => return compare(session, &asked, id).map(Reply::Text),
        Message::States(asked) => return Elsewhere::new(asked, id).map(Reply::States),
        Message::Report(asked) => {
            return Report::new(session, &asked.name, id).map(Reply::Report);
        }
        Message::Distances(asked) => {
            let checked = asked.margin.map_or(Ok(()), |margin| session.check_margin(margin));
            checked.map_err(at("distances.margin"))?;
            view.margin = asked.margin;
        }
        Message::AddObstacle(asked) => {
            let obstacle = obstacle(asked)?;
            session.add_obstacle(obstacle).map_err(at("add_obstacle"))?;
            return Ok(Reply::Scene);
        }
        Message::MoveObstacle(MoveObstacle { name, position, quaternion }) => {
            let pose = TargetPose { position, quaternion }.pose("move_obstacle")?;
            session.move_obstacle(&name, pose).map_err(at("move_obstacle.name"))?;
        }
        Message::RemoveObstacle(obstacle) => {
            session.remove_obstacle(&obstacle.name).map_err(at("remove_obstacle.name"))?;
            return Ok(Reply::Scene);
        }
        Message::AvoidCollisions(AvoidCollisions { on, gap, margin }) => {
            let distances = (gap.unwrap_or(GAP), margin.unwrap_or(MARGIN));
            session.avoid(on.then_some(distances)).map_err(at("avoid_collisions"))?;
            return Ok(Reply::Scene);
        }
        Message::Beside(asked) => {
            session.show_beside(models_beside(asked)?);
            return Ok(Reply::Scene);
        }
        Message::Drive(drive) => return Ok(Reply::Drive(drive.on)),
        Message::Seen(seen) => return Ok(Reply::Seen(seen.seq)),
    }
    Ok(Reply::Nothing)
}

/// The obstacle of a message.
fn obstacle(asked: AddObstacle) -> std::result::Result<ObstacleArg, Complaint> {
    let AddObstacle { name, shape, position, quaternion } = asked;
    if name.trim().is_empty() || name.chars().count() > LONGEST_NAME {
        let what = format!("an obstacle has a name of 1 to {LONGEST_NAME} characters");
        return Err(Complaint::new("add_obstacle.name", &name, &what, "give another name"));
    }
    if let Some((field, length)) = shape.faulty_length() {
        let (place, length) = (format!("add_obstacle.shape.{field}"), length.to_string());
        let what = format!("{field} = {length} m is not positive");
        return Err(Complaint::new(&place, &length, &what, "give a positive length"));
    }
    let world_from_shape = TargetPose { position, quaternion }.pose("add_obstacle")?;
    Ok(ObstacleArg { name, shape: shape.geometry(), world_from_shape })
}

/// The models of a message, whose quaternions get the length one.
fn models_beside(asked: Beside) -> std::result::Result<Vec<ModelBeside>, Complaint> {
    let mut models = asked.models;
    if models.len() > MOST_BESIDE {
        let count = models.len().to_string();
        let what = format!("at most {MOST_BESIDE} models are shown beside that of a session");
        return Err(Complaint::new("beside.models", &count, &what, "leave out the others"));
    }
    let mut sessions = BTreeSet::new();
    for (i, model) in models.iter_mut().enumerate() {
        let place = format!("beside.models[{i}]");
        let refuse = |field: &str, name: &str, what: &str, way_out: &str| {
            Err(Complaint::new(&format!("{place}.{field}"), name, what, way_out))
        };
        let id = model.model.as_deref().unwrap_or("command");
        for (field, name) in [("model", id), ("session", model.session.as_str())] {
            if !is_plain(name) {
                let what = "it is not 1 to 60 letters, digits and characters of '-._~'";
                return refuse(field, name, what, "give such a name");
            }
        }
        if !sessions.insert(model.session.clone()) {
            let what = "two models cannot have one session";
            return refuse("session", &model.session, what, "name another session");
        }
        let (position, quaternion) = (model.position, model.quaternion);
        let q = TargetPose { position, quaternion }.pose(&place)?.rotation.to_quaternion();
        model.quaternion = [q.w, q.x, q.y, q.z];
    }
    Ok(models)
}
