//! The message `state`: the current state of a session, as one of its clients sees it.

use std::collections::BTreeMap;

use cylindroid::closure::LoopClosureError;
use cylindroid::control::Status;
use cylindroid::{Pose, Result, Twist};
use serde::Serialize;
use serde_json::Value;

use super::bodies::DistancesJson;
use super::client_view::ClientView;
use super::json::{PoseJson, text};
use super::measures::Measures;
use super::overlays::{Shown, shown};
use super::session::Session;
use crate::commands::move_to::sentences::cause;

#[derive(Debug, Serialize)]
#[serde(tag = "type", rename = "state")]
struct StateJson<'a> {
    seq: u64,
    time: f64,
    ack: Option<&'a Value>,
    playing: bool,
    q: &'a [f64],
    links: Vec<PoseJson>,
    tool: PoseJson,
    target: PoseJson,
    error: ErrorJson,
    servo: &'a ServoJson,
    singular: Option<SingularJson>,
    outside_limits: Vec<usize>,
    loops: Vec<LoopJson>,
    contacts: Vec<ContactJson>,
    closure_error: Option<ClosureErrorJson>,
    overlays: BTreeMap<&'static str, Shown>,
    obstacles: Vec<PoseJson>,
    distances: Option<DistancesJson<'a>>,
}

#[derive(Debug, Serialize)]
struct ErrorJson {
    position: f64,
    orientation: f64,
}

#[derive(Debug, Serialize)]
struct ServoJson {
    status: &'static str,
    reason: Option<&'static str>,
    sentence: String,
    limits: Vec<LimitJson>,
    pair: Option<[String; 2]>,
    self_motion: f64,
    /// Linear, angular; world axes, at the tool.
    twist: Option<[f64; 6]>,
}

#[derive(Debug, Serialize)]
struct LimitJson {
    coordinate: usize,
    kind: &'static str,
}

#[derive(Debug, Serialize)]
struct SingularJson {
    values: Vec<f64>,
    threshold: f64,
    rank: usize,
    gap: f64,
    ratio: f64,
    length: f64,
}

#[derive(Debug, Serialize)]
struct LoopJson {
    a: [f64; 3],
    b: [f64; 3],
}

#[derive(Debug, Serialize)]
struct ContactJson {
    point: [f64; 3],
    normal: [f64; 3],
    other: [f64; 3],
}

#[derive(Debug, Serialize)]
struct ClosureErrorJson {
    distance: f64,
    angle: f64,
    closed: bool,
}

/// The parts of a state that are computed once for all clients.
#[derive(Debug)]
pub(super) struct Common {
    servo: ServoJson,
    measures: Option<Measures>,
}

impl Common {
    pub(super) fn of(session: &mut Session) -> Self {
        let servo = servo(session);
        Self { servo, measures: Measures::of(session) }
    }
}

/// The message `state` for a client.
pub(super) fn snapshot(
    session: &mut Session,
    Common { servo, measures }: &Common,
    view: &ClientView,
    seq: u64,
) -> Result<String> {
    session.find_near(view.margin)?;
    let session = &*session;
    let (mechanism, state, options) = (session.mechanism(), session.state(), session.options());
    let poses: Vec<Pose> = mechanism
        .frame_ids()
        .take(mechanism.links().len())
        .map(|frame| state.pose(frame))
        .collect();
    let tool = state.pose(options.end_effector);
    let error = options.task.error(tool, session.target());
    let loops = mechanism.loops().iter().map(|l| LoopJson {
        a: (poses[l.a] * l.link_a_from_joint).translation.to_array(),
        b: (poses[l.b] * l.link_b_from_joint).translation.to_array(),
    });
    let contacts = mechanism.contacts().iter().map(|c| {
        let on_a = poses[c.a] * c.link_a_from_contact;
        ContactJson {
            point: on_a.translation.to_array(),
            normal: on_a.rotation.z_axis().to_array(),
            other: (poses[c.b] * c.link_b_from_contact).translation.to_array(),
        }
    });
    let closure_error =
        if mechanism.is_closed() { Some(LoopClosureError::of(state)?) } else { None };
    let overlays = view.overlays.iter();
    Ok(text(&StateJson {
        seq,
        time: session.time(),
        ack: view.ack.as_ref(),
        playing: session.is_playing(),
        q: state.q(),
        links: poses.iter().map(|p| (*p).into()).collect(),
        tool: tool.into(),
        target: session.target().into(),
        error: ErrorJson { position: error.linear.norm(), orientation: error.angular.norm() },
        servo,
        singular: measures.as_ref().map(|m| SingularJson {
            values: m.condition.inverse.singular_values.clone(),
            threshold: m.condition.inverse.threshold,
            rank: m.condition.inverse.rank,
            gap: m.condition.inverse.gap,
            ratio: m.condition.singular_ratio,
            length: m.length,
        }),
        outside_limits: mechanism.outside_limits(state.q()).collect(),
        loops: loops.collect(),
        contacts: contacts.collect(),
        closure_error: closure_error.map(|g| ClosureErrorJson {
            distance: g.distance,
            angle: g.angle,
            closed: g.is_closed(mechanism.reach()),
        }),
        overlays: overlays.map(|o| (o.name(), shown(*o, session, measures.as_ref()))).collect(),
        obstacles: session.obstacles().iter().map(|o| o.world_from_shape.into()).collect(),
        distances: session.distances(view.margin),
    }))
}

fn servo(session: &Session) -> ServoJson {
    let last = session.last();
    let told = |status, reason, sentence: String| ServoJson {
        status,
        reason,
        sentence,
        limits: limits(session),
        pair: last.and_then(|last| last.pair.clone()),
        self_motion: session.self_motion(),
        twist: session.twist().map(Twist::to_array),
    };
    if let Some(fault) = session.fault() {
        return told("unavailable", None, fault.to_string());
    }
    if !session.is_playing() {
        let why = match session.is_followed() {
            true => "A program sets the configuration.",
            false => "The servo is paused.",
        };
        return told("paused", None, why.to_owned());
    }
    let moving = match session.twist() {
        Some(Twist::ZERO) => "Braking.",
        Some(_) => "Following the commanded twist.",
        None => "Moving to the target.",
    };
    let Some(last) = last else {
        return match session.is_resting() {
            true => told("reached", None, "The target is at the tool.".to_owned()),
            false => told("moving", None, moving.to_owned()),
        };
    };
    match (last.status, &last.pair, &last.stall) {
        (Status::Reached, ..) => told("reached", None, "The target is reached.".to_owned()),
        (Status::Stalled, Some([a, b]), _) => {
            let why = format!("{a} and {b} must not come closer: their distance stops the motion.");
            told("stalled", Some("distance"), why)
        }
        (Status::Stalled, None, Some(stall)) => {
            let (mechanism, q) = (session.mechanism(), session.state().q());
            let why = cause(mechanism, session.options().task, q, stall);
            told("stalled", Some(stall.name()), why)
        }
        (_, Some([a, b]), _) => {
            let why = format!(
                "{}; the distance of {a} and {b} slows the motion.",
                moving.trim_end_matches('.')
            );
            told("moving", None, why)
        }
        _ => told("moving", None, moving.to_owned()),
    }
}

fn limits(session: &Session) -> Vec<LimitJson> {
    let active = session.active_limits().into_iter();
    active.map(|(coordinate, kind)| LimitJson { coordinate, kind: kind.name() }).collect()
}
