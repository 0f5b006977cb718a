//! Messages of the client, parsed strictly, and the errors for invalid ones.

use std::collections::BTreeMap;

use cylindroid::spatial::Quaternion;
use cylindroid::{Error, Pose, Vec3};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::beside::Beside;
use super::obstacle_messages::{AddObstacle, AvoidCollisions, Distances, MoveObstacle};
use super::repeated::repeated;

/// Maximum message size [bytes].
pub(super) const LARGEST: usize = 64 * 1024;

/// A message with the id that is returned to its sender.
#[derive(Debug)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "ToServer"))]
pub(super) struct Request {
    #[cfg_attr(test, ts(optional, type = "string | number"))]
    pub(super) id: Option<Value>,
    #[cfg_attr(test, ts(flatten))]
    pub(super) message: Message,
}

/// Described in docs/viewer.md.
#[derive(Debug, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(tag = "type", rename_all = "snake_case"))]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum Message {
    Joint(Joint),
    Configuration(Configuration),
    Target(TargetPose),
    Twist(TwistCommand),
    Frame(Name),
    Task(Name),
    Play(#[cfg_attr(test, ts(skip))] Nothing),
    Pause(#[cfg_attr(test, ts(skip))] Nothing),
    Reset(#[cfg_attr(test, ts(skip))] Nothing),
    NullSpace(NullSpace),
    Actuated(Names),
    Method(MethodChoice),
    Overlays(Names),
    Compare(Compare),
    Report(Name),
    States(States),
    Distances(Distances),
    AddObstacle(AddObstacle),
    MoveObstacle(MoveObstacle),
    RemoveObstacle(Name),
    AvoidCollisions(AvoidCollisions),
    Beside(Beside),
    Drive(Drive),
    Seen(Seen),
}

impl Message {
    /// True if it changes the session, which only its driver may.
    pub(super) fn drives(&self) -> bool {
        let observes = matches!(
            self,
            Self::Overlays(_)
                | Self::Compare(_)
                | Self::Report(_)
                | Self::States(_)
                | Self::Distances(_)
                | Self::Drive(_)
                | Self::Seen(_)
        );
        !observes
    }
}

const TYPES: [&str; 24] = [
    "joint",
    "configuration",
    "target",
    "twist",
    "frame",
    "task",
    "play",
    "pause",
    "reset",
    "null_space",
    "actuated",
    "method",
    "overlays",
    "compare",
    "report",
    "states",
    "distances",
    "add_obstacle",
    "move_obstacle",
    "remove_obstacle",
    "avoid_collisions",
    "beside",
    "drive",
    "seen",
];

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Nothing {}

#[derive(Debug, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "NameMessage"))]
#[serde(deny_unknown_fields)]
pub(super) struct Name {
    pub(super) name: String,
}

#[derive(Debug, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "NamesMessage"))]
#[serde(deny_unknown_fields)]
pub(super) struct Names {
    pub(super) names: Vec<String>,
}

#[derive(Debug, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "JointMessage"))]
#[serde(deny_unknown_fields)]
pub(super) struct Joint {
    pub(super) name: String,
    pub(super) value: f64,
}

#[derive(Debug, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "ConfigurationMessage"))]
#[serde(deny_unknown_fields)]
pub(super) struct Configuration {
    pub(super) q: Vec<f64>,
}

#[derive(Debug, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "TargetMessage"))]
#[serde(deny_unknown_fields)]
pub(super) struct TargetPose {
    pub(super) position: [f64; 3],
    /// w, x, y, z.
    pub(super) quaternion: [f64; 4],
}

/// World axes, at the tool.
#[derive(Debug, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "TwistMessage"))]
#[serde(deny_unknown_fields)]
pub(super) struct TwistCommand {
    pub(super) linear: [f64; 3],
    pub(super) angular: [f64; 3],
}

#[derive(Debug, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "NullSpaceMessage"))]
#[serde(deny_unknown_fields)]
pub(super) struct NullSpace {
    pub(super) rate: f64,
    #[serde(default)]
    pub(super) index: usize,
}

#[derive(Debug, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "MethodMessage"))]
#[serde(deny_unknown_fields)]
pub(super) struct MethodChoice {
    pub(super) name: String,
    #[serde(default)]
    pub(super) parameters: BTreeMap<String, f64>,
    #[serde(default)]
    pub(super) h: Option<f64>,
    #[serde(default)]
    pub(super) fallback: Option<String>,
}

#[derive(Debug, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "CompareMessage"))]
#[serde(deny_unknown_fields)]
pub(super) struct Compare {
    pub(super) methods: [String; 2],
    pub(super) point: [f64; 3],
    #[serde(default)]
    pub(super) h: Option<f64>,
    #[serde(default)]
    pub(super) twist: Option<[f64; 6]>,
}

#[derive(Debug, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "DriveMessage"))]
#[serde(deny_unknown_fields)]
pub(super) struct Drive {
    pub(super) on: bool,
}

#[derive(Debug, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "StatesMessage"))]
#[serde(deny_unknown_fields)]
pub(super) struct States {
    pub(super) q: Vec<Vec<f64>>,
    /// With overlays and distances.
    #[serde(default)]
    pub(super) full: bool,
}

#[derive(Debug, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "SeenMessage"))]
#[serde(deny_unknown_fields)]
pub(super) struct Seen {
    pub(super) seq: u64,
}

impl TargetPose {
    /// The pose; an error names the field of the message `kind`.
    pub(super) fn pose(&self, kind: &str) -> Result<Pose, Complaint> {
        let [w, x, y, z] = self.quaternion;
        let rotation = Quaternion { w, x, y, z }
            .rotation()
            .map_err(|error| Complaint::of(&format!("{kind}.quaternion"), &error))?;
        let translation = Vec3::from_array(self.position);
        // Distances must not overflow.
        Error::check_finite(&format!("position of {kind}"), &[translation.norm()])
            .map_err(|error| Complaint::of(&format!("{kind}.position"), &error))?;
        Ok(Pose { rotation, translation })
    }
}

/// An error in a message.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(tag = "type", rename = "error")]
pub(super) struct Complaint {
    #[cfg_attr(test, ts(type = "string | number | null"))]
    pub(super) reply_to: Option<Value>,
    pub(super) culprit: Box<str>,
    /// Message and field.
    pub(super) place: Box<str>,
    pub(super) message: Box<str>,
    pub(super) way_out: Box<str>,
    /// The value reached by a joint.
    pub(super) nearest: Option<f64>,
}

impl Complaint {
    pub(super) fn new(place: &str, culprit: &str, what: &str, way_out: &str) -> Self {
        // It may repeat a long part of the message that it is about.
        let what = beginning(what, 300);
        let message = if way_out.is_empty() { what } else { format!("{what}; {way_out}") };
        Self {
            reply_to: None,
            culprit: culprit.into(),
            place: place.into(),
            message: message.into(),
            way_out: way_out.into(),
            nearest: None,
        }
    }

    /// An error of the library for the field at `place`.
    pub(super) fn of(place: &str, error: &Error) -> Self {
        let (culprit, way_out) = match error {
            Error::UnknownName { name, similar, .. } => {
                let offer = similar.join(", ");
                (short(name), if offer.is_empty() { offer } else { format!("use {offer}") })
            }
            Error::Dimension { what, hint, .. } => (short(what), hint.clone()),
            Error::NotFinite { what, .. } => (what.clone(), "give finite values".to_owned()),
            Error::OutOfRange { what, range, .. } => {
                (what.clone(), format!("give magnitudes up to {range:e}"))
            }
            Error::InvalidOption { option, reason, .. } => ((*option).to_owned(), reason.clone()),
            Error::Model { model, culprit, message } => {
                let culprit = if culprit.is_empty() { model } else { culprit };
                (culprit.clone(), message.clone())
            }
            _ => (place.to_owned(), String::new()),
        };
        Self {
            reply_to: None,
            culprit: culprit.into(),
            place: place.into(),
            message: error.to_string().into(),
            way_out: way_out.into(),
            nearest: None,
        }
    }
}

/// Parses a message; an error names the field and contains the id if it could be read.
pub(super) fn read(text: &str) -> Result<Request, Complaint> {
    let object: Map<String, Value> = serde_json::from_str(text).map_err(|error| {
        let what = format!("a message must be one JSON object: {error}");
        let culprit = if text.trim().is_empty() { "an empty text".into() } else { short(text) };
        Complaint::new("message", &culprit, &what, "send {\"type\": ..., ...}")
    })?;
    let mut object = object;
    let id = object.remove("id");
    let marked = |complaint| Complaint { reply_to: id.clone(), ..complaint };
    if let Some(id) = id.as_ref().filter(|id| !(id.is_string() || id.is_number())) {
        let (what, way_out) = ("the id must be a string or a number", "give one, or omit the id");
        return Err(Complaint::new("message.id", &short(&id.to_string()), what, way_out));
    }
    if let Some(key) = repeated(text) {
        let (what, way_out) = (format!("'{}' is given twice", short(&key)), "give each field once");
        return Err(marked(Complaint::new("message", &short(&key), &what, way_out)));
    }
    let kind = match object.remove("type") {
        Some(Value::String(kind)) if TYPES.contains(&kind.as_str()) => kind,
        Some(Value::String(kind)) => {
            return Err(marked(Complaint::of("message", &Error::unknown("message", &kind, TYPES))));
        }
        other => {
            let culprit = other.map_or_else(|| "type".to_owned(), |o| short(&o.to_string()));
            let what = "a message must have a \"type\" that is a string";
            let way_out = format!("one of {}", TYPES.join(", "));
            return Err(marked(Complaint::new("message", &culprit, what, &way_out)));
        }
    };
    let fields = Value::Object(object);
    let tagged = Value::Object(Map::from_iter([(kind.clone(), fields)]));
    let message = serde_path_to_error::deserialize(&tagged).map_err(|error| {
        let place = error.path().to_string();
        let culprit = at(&tagged, &place).unwrap_or_else(|| kind.clone());
        let what = error.inner().to_string();
        let way_out = format!("the fields of '{kind}' are listed in docs/viewer.md");
        marked(Complaint::new(&place, &culprit, &what, &way_out))
    })?;
    Ok(Request { id, message })
}

/// The value at a path like `target.position[2]`, shortened; `None` for objects.
fn at(value: &Value, path: &str) -> Option<String> {
    let pointer = path.replace(['.', '['], "/").replace(']', "");
    let found = value.pointer(&format!("/{pointer}"))?;
    (!found.is_object()).then(|| short(&found.to_string()))
}

fn short(text: &str) -> String {
    beginning(text, 60)
}

/// The first `most` characters of a text.
fn beginning(text: &str, most: usize) -> String {
    match text.char_indices().nth(most) {
        None => text.to_owned(),
        Some((end, _)) => format!("{}...", &text[..end]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(text: &str) -> Complaint {
        read(text).unwrap_err()
    }

    #[test]
    fn messages_are_read_with_their_mark() {
        let read = read(r#"{"id": 7, "type": "joint", "name": "q1", "value": 1}"#).unwrap();
        assert_eq!(read.id, Some(7.into()));
        assert!(matches!(read.message, Message::Joint(Joint { value: 1.0, .. })));
        assert!(super::read(r#"{"type": "play"}"#).is_ok());
        assert!(super::read(r#"{"type": "null_space", "rate": 0.5}"#).is_ok());
    }

    /// Every type is documented there with an example that parses.
    #[test]
    fn examples_of_the_protocol_are_read() {
        const PAGE: &str = include_str!("../../../../docs/viewer.md");
        let (_, examples) = PAGE.split_once("## Messages of the client").unwrap();
        let (examples, _) = examples.split_once("## Messages of the server").unwrap();
        let lines: Vec<&str> = examples.lines().filter(|l| l.starts_with("{\"type\"")).collect();
        for line in &lines {
            assert!(read(line).is_ok(), "{line}: {:?}", read(line));
        }
        for kind in TYPES {
            let shown = format!("{{\"type\": \"{kind}\"");
            assert!(lines.iter().any(|l| l.starts_with(&shown)), "no example of {kind}");
            assert!(examples.contains(&format!("`{kind}`")), "{kind} is not explained");
        }
    }

    #[test]
    fn complaints_name_the_place_and_the_way_out() {
        let wrong =
            refused(r#"{"type": "target", "position": [0, 1, "2"], "quaternion": [1, 0, 0, 0]}"#);
        assert_eq!((&*wrong.place, &*wrong.culprit), ("target.position[2]", "\"2\""));
        let short =
            refused(r#"{"type": "target", "position": [0, 1], "quaternion": [1, 0, 0, 0]}"#);
        assert_eq!(&*short.place, "target.position");
        assert!(short.message.contains("length 2"), "{}", short.message);
        let more = refused(r#"{"type": "pause", "now": true, "id": "a"}"#);
        assert!(more.message.contains("now") && more.reply_to == Some("a".into()), "{more:?}");
        let twice = refused(r#"{"type": "play", "id": 3, "type": "pause"}"#);
        assert_eq!((&*twice.culprit, &twice.reply_to), ("type", &Some(3.into())));
        let unknown = refused(r#"{"type": "jont"}"#);
        assert!(unknown.message.contains("joint"), "{}", unknown.message);
        for text in ["", "[]", "7", "{\"type\": 3}", "{}", "{\"type\": \"joint\", \"value\": NaN}"]
        {
            assert_eq!(&*refused(text).place, "message", "{text}");
            assert!(!refused(text).culprit.trim().is_empty(), "{text}");
        }
        assert_eq!(&*refused(r#"{"type": "play", "id": {}}"#).place, "message.id");
        assert_eq!(
            &*refused(r#"{"type": "joint", "name": "a", "value": null}"#).place,
            "joint.value"
        );
        assert_eq!(&*refused(r#"{"type": "joint", "name": "a", "value": 1e999}"#).place, "message");
    }
}
