//! The recipe of a sweep: all that its numbers depend on, as JSON, and the difference of two.
//!
//! Why so   a folder is resumed with the numbers that it already has, so every cause of another
//!          number is in the recipe: the version, the mechanism (by a checksum of its parts), the
//!          configurations, quantities and their options. Threads are no cause
//! Checked  tests/sweep/folder.rs::another_recipe_is_refused

use std::fmt::{self, Display, Write};

use serde_json::{Value, json};
use sha2::{Digest, Sha256};

use super::evaluate::Evaluator;
use super::options::SweepOptions;
use super::source::Source;
use crate::model::Mechanism;

/// A JSON object.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Recipe(pub(super) Value);

impl Display for Recipe {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Display::fmt(&self.0, f)
    }
}

impl Recipe {
    pub(super) fn of(
        mechanism: &Mechanism,
        options: &SweepOptions,
        rows: u64,
        evaluator: &Evaluator,
    ) -> Self {
        let names = mechanism.coordinates().iter().map(|c| c.name.as_str());
        let frame = &mechanism.frame_of(evaluator.end_effector.frame).name;
        let quantities = options.quantities.iter().map(|q| q.name());
        Self(json!({
            "version": env!("CARGO_PKG_VERSION"),
            "model": mechanism.name(),
            "model_checksum": checksum_of(mechanism),
            "coordinates": names.collect::<Vec<_>>(),
            "configurations": source(&options.source),
            "rows": rows,
            "part_rows": options.part_rows,
            "quantities": quantities.collect::<Vec<_>>(),
            "frame": frame,
            "frame_from_tool": evaluator.end_effector.frame_from_tool.to_matrix(),
            "task": evaluator.task,
            "metric": options.metric.name(),
            "length": evaluator.length,
        }))
    }

    /// The first entry in which a recipe differs from this one, with both values.
    pub(super) fn difference(&self, other: &Value) -> Option<String> {
        difference("", &self.0, other)
    }
}

fn difference(path: &str, own: &Value, other: &Value) -> Option<String> {
    if own == other {
        return None;
    }
    if let (Value::Object(a), Value::Object(b)) = (own, other) {
        let keys = a.keys().chain(b.keys().filter(|key| !a.contains_key(*key)));
        for key in keys {
            let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
            let of = |map: &serde_json::Map<String, Value>| map.get(key).cloned();
            let (a, b) = (of(a).unwrap_or_default(), of(b).unwrap_or_default());
            if let Some(found) = difference(&path, &a, &b) {
                return Some(found);
            }
        }
    }
    Some(format!("{path} is {other} there and {own} now"))
}

fn source(source: &Source) -> Value {
    match source {
        Source::Samples { count, seed } => json!({"samples": count, "seed": seed}),
        Source::Grid { axes, rest } => {
            let axis = |a: &super::Axis| json!({"name": a.name, "from": a.from, "to": a.to, "count": a.count});
            json!({"over": axes.iter().map(axis).collect::<Vec<_>>(), "q": rest})
        }
        Source::Configurations(q) => {
            let mut hasher = Sha256::new();
            q.iter().for_each(|x| hasher.update(x.to_le_bytes()));
            json!({"checksum": hexadecimal(&hasher.finalize())})
        }
    }
}

/// Of joints, loops, contacts and frames with all their numbers.
fn checksum_of(mechanism: &Mechanism) -> String {
    struct Sink(Sha256);
    impl Write for Sink {
        fn write_str(&mut self, text: &str) -> fmt::Result {
            self.0.update(text.as_bytes());
            Ok(())
        }
    }
    let mut sink = Sink(Sha256::new());
    let m = mechanism;
    // Writing into a hash cannot fail.
    let _ = write!(
        sink,
        "{:?} {:?} {:?} {:?} {:?} {:?}",
        m.joints(),
        m.loops(),
        m.contacts(),
        m.coordinates(),
        m.frames(),
        m.home()
    );
    hexadecimal(&sink.0.finalize())
}

pub(super) fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}
