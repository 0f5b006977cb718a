//! The message `state`: the current state of a session.

use std::collections::BTreeMap;

use cylindroid::closure::LoopClosureError;
use cylindroid::control::Status;
use cylindroid::{Pose, Result};
use serde::Serialize;
use serde_json::Value;

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
    servo: ServoJson,
    singular: Option<SingularJson>,
    outside_limits: Vec<usize>,
    loops: Vec<LoopJson>,
    contacts: Vec<ContactJson>,
    closure_error: Option<ClosureErrorJson>,
    overlays: BTreeMap<&'static str, Shown>,
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
    self_motion: f64,
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

/// The message `state`.
pub(super) fn snapshot(session: &mut Session, seq: u64) -> Result<String> {
    let servo = servo(session);
    let measures = Measures::of(session);
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
    let overlays = session.overlays().iter();
    Ok(text(&StateJson {
        seq,
        time: session.time(),
        ack: session.ack(),
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
    }))
}

fn servo(session: &Session) -> ServoJson {
    let told = |status, reason, sentence: String| ServoJson {
        status,
        reason,
        sentence,
        limits: limits(session),
        self_motion: session.self_motion(),
    };
    if let Some(fault) = session.fault() {
        return told("unavailable", None, fault.to_string());
    }
    if !session.is_playing() {
        return told("paused", None, "The servo is paused.".to_owned());
    }
    match session.last() {
        Some((step, stall)) => match (step.status, stall) {
            (Status::Reached, _) => told("reached", None, "The target is reached.".to_owned()),
            (Status::Stalled, Some(stall)) => {
                let (mechanism, q) = (session.mechanism(), session.state().q());
                let why = cause(mechanism, session.options().task, q, stall);
                told("stalled", Some(stall.name()), why)
            }
            _ => told("moving", None, "Moving to the target.".to_owned()),
        },
        None if session.is_resting() => {
            told("reached", None, "The target is at the tool.".to_owned())
        }
        None => told("moving", None, "Moving to the target.".to_owned()),
    }
}

fn limits(session: &Session) -> Vec<LimitJson> {
    // A servo that has not stepped since it was stopped has no joint velocities.
    if session.last().is_none() {
        return Vec::new();
    }
    let active = session.servo().into_iter().flat_map(|servo| servo.active_limits());
    active.map(|(coordinate, kind)| LimitJson { coordinate, kind: kind.name() }).collect()
}
