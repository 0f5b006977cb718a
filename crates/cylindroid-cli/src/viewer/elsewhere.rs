//! The message `states`: poses and measures at other configurations than the session's, for motions
//! that are played back.

use std::time::{Duration, Instant};

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

/// A message `states` that is being answered; the session stays where it is.
#[derive(Debug)]
pub(super) struct Elsewhere {
    asked: States,
    reply_to: Option<Value>,
    /// At the first of the configurations.
    done: Vec<Box<RawValue>>,
}

impl Elsewhere {
    pub(super) fn new(asked: States, id: Option<&Value>) -> std::result::Result<Self, Complaint> {
        if asked.q.len() > MOST {
            let count = asked.q.len();
            let what = format!("{count} configurations are more than {MOST}");
            let way_out = "ask for them in several messages";
            return Err(Complaint::new("states.q", &count.to_string(), &what, way_out));
        }
        Ok(Self { asked, reply_to: id.cloned(), done: Vec::new() })
    }

    /// Computes for so long, one configuration at least; gives the answer, or the complaint, once
    /// it is there.
    pub(super) fn advance(
        &mut self,
        session: &mut Session,
        view: &ClientView,
        share: Duration,
    ) -> Option<String> {
        let Self { asked, reply_to, done } = self;
        let (overlays, margin) =
            if asked.full { (&*view.overlays, view.margin) } else { (&[][..], None) };
        let begin = Instant::now();
        while let Some(q) = asked.q.get(done.len()) {
            let found = session.elsewhere(q, |there| {
                let measures = Measures::of(there);
                let posture = posture(there, measures.as_ref(), overlays, margin)?;
                // Names, numbers and lists can be written.
                Ok(to_raw_value(&posture).unwrap_or_default())
            });
            match found {
                Ok(posture) => done.push(posture),
                Err(error) => {
                    let complaint = Complaint::of(&format!("states.q[{}]", done.len()), &error);
                    return Some(text(&Complaint { reply_to: reply_to.take(), ..complaint }));
                }
            }
            if begin.elapsed() >= share && done.len() < asked.q.len() {
                return None;
            }
        }
        let states = std::mem::take(done);
        Some(text(&StatesJson { reply_to: reply_to.as_ref(), states }))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use cylindroid::catalogue;

    use super::*;
    use crate::viewer::start::{Start, StartBodies};

    #[test]
    fn an_answer_in_pieces_is_that_in_one_go() {
        let robot = catalogue::load("panda").unwrap();
        let (home, tool) = (robot.home().to_vec(), robot.tool().into());
        let start = Start::new((robot, "panda"), &home, tool, &[], StartBodies::default()).unwrap();
        let mut session = Session::new(Arc::new(start)).unwrap();
        let view = ClientView::default();
        let asked = || {
            let q = (0..5).map(|i| {
                let mut q = home.clone();
                q[0] += 0.1 * f64::from(i);
                q
            });
            let asked = States { q: q.collect(), full: false };
            Elsewhere::new(asked, Some(&Value::from("mark"))).unwrap()
        };
        let at_once = asked().advance(&mut session, &view, Duration::MAX).unwrap();
        let mut pieces = asked();
        for _ in 0..4 {
            assert_eq!(pieces.advance(&mut session, &view, Duration::ZERO), None);
        }
        let last = pieces.advance(&mut session, &view, Duration::ZERO).unwrap();
        assert_eq!(last, at_once);
        let answer: Value = serde_json::from_str(&last).unwrap();
        assert_eq!(answer["reply_to"], "mark");
        assert_eq!(answer["states"].as_array().unwrap().len(), 5);
        assert_eq!(session.state().q(), home);
    }
}
