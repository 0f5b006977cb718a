//! The message `state`: the current state of a session, as one of its clients sees it.

use cylindroid::control::Status;
use cylindroid::{Result, Twist};
use serde::Serialize;
use serde_json::Value;

use super::client_view::ClientView;
use super::json::{PoseJson, text};
use super::measures::Measures;
use super::posture::{PostureJson, posture};
use super::session::Session;
use crate::commands::move_to::sentences::cause;

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(tag = "type", rename = "state")]
pub(super) struct StateJson<'a> {
    seq: u64,
    time: f64,
    /// Since the session began (s).
    clock: f64,
    #[cfg_attr(test, ts(type = "string | number | null"))]
    ack: Option<&'a Value>,
    playing: bool,
    target: PoseJson,
    error: ErrorJson,
    servo: &'a ServoJson,
    #[serde(flatten)]
    posture: PostureJson<'a>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "PoseError"))]
struct ErrorJson {
    position: f64,
    orientation: f64,
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "Servo"))]
struct ServoJson {
    status: ServoStatus,
    reason: Option<&'static str>,
    sentence: String,
    limits: Vec<LimitJson>,
    pair: Option<[String; 2]>,
    self_motion: f64,
    joint_velocities: Option<Vec<f64>>,
    /// Linear, angular; world axes, at the tool.
    twist: Option<[f64; 6]>,
}

#[derive(Debug, Clone, Copy, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
enum ServoStatus {
    Moving,
    Reached,
    Stalled,
    Paused,
    Unavailable,
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "ActiveLimit"))]
struct LimitJson {
    coordinate: usize,
    kind: &'static str,
}

/// The parts of a state that are computed once for all clients.
#[derive(Debug)]
pub(super) struct Common {
    /// Since the session began (s).
    clock: f64,
    servo: ServoJson,
    measures: Option<Measures>,
}

impl Common {
    pub(super) fn of(session: &mut Session, clock: f64) -> Self {
        let servo = servo(session);
        Self { clock, servo, measures: Measures::of(session) }
    }
}

/// The message `state` for a client.
pub(super) fn snapshot(
    session: &mut Session,
    Common { clock, servo, measures }: &Common,
    view: &ClientView,
    seq: u64,
) -> Result<String> {
    let options = session.options();
    let error = options.task.error(session.state().pose(options.end_effector)?, session.target());
    let (time, playing, target) = (session.time(), session.is_playing(), session.target().into());
    Ok(text(&StateJson {
        seq,
        time,
        clock: *clock,
        ack: view.ack.as_ref(),
        playing,
        target,
        error: ErrorJson { position: error.linear.norm(), orientation: error.angular.norm() },
        servo,
        posture: posture(session, measures.as_ref(), &view.overlays, view.margin)?,
    }))
}

fn servo(session: &Session) -> ServoJson {
    let last = session.last();
    // A program that moves the robot does not say how fast.
    let rates = session.joint_velocities().filter(|_| !session.is_followed());
    let told = |status, reason, sentence: String| ServoJson {
        status,
        reason,
        sentence,
        limits: limits(session),
        pair: last.and_then(|last| last.pair.clone()),
        self_motion: session.self_motion(),
        joint_velocities: rates.map(<[f64]>::to_vec),
        twist: session.twist().map(Twist::to_array),
    };
    if let Some(fault) = session.fault() {
        return told(ServoStatus::Unavailable, None, fault.to_string());
    }
    if !session.is_playing() {
        let why = match session.is_followed() {
            true => "A program sets the configuration.",
            false => "The servo is paused.",
        };
        return told(ServoStatus::Paused, None, why.to_owned());
    }
    let moving = match session.twist() {
        Some(Twist::ZERO) => "Braking.",
        Some(_) => "Following the commanded twist.",
        None => "Moving to the target.",
    };
    let Some(last) = last else {
        return match session.is_resting() {
            true => told(ServoStatus::Reached, None, "The target is at the tool.".to_owned()),
            false => told(ServoStatus::Moving, None, moving.to_owned()),
        };
    };
    match (last.status, &last.pair, &last.stall) {
        (Status::Reached, ..) => {
            told(ServoStatus::Reached, None, "The target is reached.".to_owned())
        }
        (Status::Stalled, Some([a, b]), _) => {
            let why = format!("{a} and {b} must not come closer: their distance stops the motion.");
            told(ServoStatus::Stalled, Some("distance"), why)
        }
        (Status::Stalled, None, Some(stall)) => {
            let (mechanism, q) = (session.mechanism(), session.state().q());
            let why = cause(mechanism, session.options().task, q, stall);
            told(ServoStatus::Stalled, Some(stall.name()), why)
        }
        (_, Some([a, b]), _) => {
            let why = format!(
                "{}; the distance of {a} and {b} slows the motion.",
                moving.trim_end_matches('.')
            );
            told(ServoStatus::Moving, None, why)
        }
        _ => told(ServoStatus::Moving, None, moving.to_owned()),
    }
}

/// Of the coordinates: an actuated loop joint has none.
fn limits(session: &Session) -> Vec<LimitJson> {
    let n = session.mechanism().n();
    let active = session.active_limits().into_iter().filter(|(i, _)| *i < n);
    active.map(|(coordinate, kind)| LimitJson { coordinate, kind: kind.name() }).collect()
}
