//! The message `states`: poses and measures at other configurations than the session's, for motions
//! that are played back.

use serde::Serialize;
use serde_json::Value;
use serde_json::value::{RawValue, to_raw_value};

use super::client_view::ClientView;
use super::json::text;
use super::measures::Measures;
use super::messages::{Complaint, States};
use super::posture::posture;
use super::session::Session;

/// Configurations of one message: some take a millisecond.
const MOST: usize = 64;

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(tag = "type", rename = "states")]
pub(super) struct StatesJson<'a> {
    #[cfg_attr(test, ts(type = "string | number | null"))]
    reply_to: Option<&'a Value>,
    #[cfg_attr(test, ts(type = "Posture[]"))]
    states: Vec<Box<RawValue>>,
}

/// The answer to `states`; the session stays where it is.
pub(super) fn states(
    session: &mut Session,
    view: &ClientView,
    asked: &States,
    id: Option<&Value>,
) -> std::result::Result<String, Complaint> {
    if asked.q.len() > MOST {
        let count = asked.q.len();
        let what = format!("{count} configurations are more than {MOST}");
        let way_out = "ask for them in several messages";
        return Err(Complaint::new("states.q", &count.to_string(), &what, way_out));
    }
    let (overlays, margin) =
        if asked.full { (&*view.overlays, view.margin) } else { (&[][..], None) };
    let mut states = Vec::with_capacity(asked.q.len());
    for (i, q) in asked.q.iter().enumerate() {
        let found = session.elsewhere(q, |there| {
            let measures = Measures::of(there);
            let posture = posture(there, measures.as_ref(), overlays, margin)?;
            // Names, numbers and lists can be written.
            Ok(to_raw_value(&posture).unwrap_or_default())
        });
        states.push(found.map_err(|error| Complaint::of(&format!("states.q[{i}]"), &error))?);
    }
    Ok(text(&StatesJson { reply_to: id, states }))
}
