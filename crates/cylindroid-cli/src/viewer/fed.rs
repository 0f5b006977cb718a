//! Messages of a client without a socket: what fuzz targets feed, and tests of what they found.

use std::sync::{Arc, OnceLock};
use std::time::Duration;

use cylindroid::catalogue;

use super::client_view::ClientView;
use super::dispatcher::{Reply, handle};
use super::json::text;
use super::messages::{LARGEST, read};
use super::scene::Scene;
use super::session::Session;
use super::snapshot::{Common, snapshot};
use super::start::{Start, StartBodies};

/// The models; the first byte chooses one.
const MODELS: [&str; 2] = ["panda", "five-bar"];

/// Servo steps after each message.
const STEPS: u64 = 6;

/// Messages of one input.
const MOST: usize = 12;

/// Executes a message on each line after the first byte: the session stays finite and within its
/// limits, and every answer says something.
///
/// # Panics
/// Otherwise.
pub(crate) fn feed(bytes: &[u8]) {
    static STARTS: OnceLock<Vec<Arc<Start>>> = OnceLock::new();
    let starts = STARTS.get_or_init(|| MODELS.iter().filter_map(|name| start(name)).collect());
    let Some((first, lines)) = bytes.split_first() else { return };
    let start = Arc::clone(&starts[usize::from(*first) % starts.len()]);
    let Ok(mut session) = Session::new(start) else { return };
    let mut view = ClientView::default();
    let lines = String::from_utf8_lossy(lines);
    for line in lines.lines().filter(|line| line.len() <= LARGEST).take(MOST) {
        let reply = read(line).and_then(|request| handle(&mut session, &mut view, request));
        let answer = match reply {
            Ok(Reply::Scene) => text(&Scene::of(&session)),
            Ok(Reply::Report(report)) => report.text(),
            Ok(Reply::States(mut asked)) => {
                asked.advance(&mut session, &view, Duration::MAX).unwrap_or_default()
            }
            Ok(Reply::Text(text)) => text,
            Ok(_) => "done".to_owned(),
            Err(complaint) => text(&complaint),
        };
        assert!(!answer.is_empty(), "no answer to {line}");
        session.advance(STEPS);
        let clock = session.time();
        let common = Common::of(&mut session, clock);
        // A state that cannot be computed (overflow) is skipped, as it is for clients.
        let _ = snapshot(&mut session, &common, &view, 1);
        check(&session, line);
    }
}

fn start(name: &str) -> Option<Arc<Start>> {
    let robot = catalogue::load(name).ok()?;
    let (q, tool) = (robot.home().to_vec(), robot.tool().into());
    Start::new((robot, name), &q, tool, &[], StartBodies::default()).ok().map(Arc::new)
}

fn check(session: &Session, line: &str) {
    let coordinates = session.mechanism().coordinates();
    for (x, c) in session.state().q().iter().zip(coordinates) {
        let is_inside = *x >= c.limits.lower - 1e-9 && *x <= c.limits.upper + 1e-9;
        assert!(x.is_finite() && is_inside, "{} = {x} after {line}", c.name);
    }
    assert!(session.target().translation.is_finite(), "the target after {line}");
}

#[cfg(test)]
mod tests {
    use super::feed;

    #[test]
    fn findings_stay_mended() {
        for bytes in crate::fed::findings("messages") {
            feed(&bytes);
        }
    }

    /// The examples of the protocol, all to one session of each model.
    #[test]
    fn examples_are_fed() {
        const PAGE: &str = include_str!("../../../../docs/viewer.md");
        let examples: Vec<&str> = PAGE.lines().filter(|l| l.starts_with("{\"type\"")).collect();
        for together in examples.chunks(super::MOST) {
            for model in ["0", "1"] {
                feed(format!("{model}{}", together.join("\n")).as_bytes());
            }
        }
    }
}
