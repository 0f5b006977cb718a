//! Mutations of the messages of docs/viewer.md: an answer or a state comes, the server lives, its
//! numbers are finite, and the robot stays within its limits.

use serde_json::{Value, json};

use super::{Client, Server};
use crate::documents::ROOT;
use crate::fuzz::{Random, mutate, mutate_text, seeds};

/// Rounds of messages without `CYLINDROID_FUZZ_SECONDS`.
const FEW: u64 = 60;

/// Messages before an answer is waited for.
const TOGETHER: usize = 5;

/// The examples of the page.
fn examples() -> Vec<Value> {
    let page = std::fs::read_to_string(format!("{ROOT}/docs/viewer.md")).unwrap();
    let (_, page) = page.split_once("## Messages of the client").unwrap();
    let (page, _) = page.split_once("## Messages of the server").unwrap();
    let lines = page.lines().filter(|line| line.starts_with("{\"type\""));
    lines.map(|line| serde_json::from_str(line).unwrap()).collect()
}

/// Bounds of the coordinates of a scene; `None` without one.
type Bounds = Vec<[Option<f64>; 2]>;

fn bounds(scene: &Value) -> Bounds {
    let coordinates = scene["coordinates"].as_array().unwrap();
    coordinates.iter().map(|c| ["lower", "upper"].map(|side| c[side].as_f64())).collect()
}

/// A state is finite (JSON has no other numbers than null) and within the limits.
fn check(state: &Value, bounds: &Bounds, what: &str) {
    let q = state["q"].as_array().unwrap();
    assert_eq!(q.len(), bounds.len(), "{what}");
    for (x, [lower, upper]) in q.iter().zip(bounds) {
        let x = x.as_f64().unwrap_or_else(|| panic!("{what}: q = {q:?}"));
        let is_inside = lower.is_none_or(|l| x >= l - 1e-9) && upper.is_none_or(|u| x <= u + 1e-9);
        assert!(is_inside, "{what}: {x} of {q:?} outside {lower:?} {upper:?}");
    }
    for pose in state["links"].as_array().unwrap().iter().chain([&state["tool"]]) {
        for part in ["position", "quaternion"] {
            let numbers = pose[part].as_array().unwrap();
            assert!(numbers.iter().all(Value::is_number), "{what}: {pose}");
        }
    }
}

/// Waits until a message of its own has come back, and checks what comes before.
fn settle(client: &mut Client, bounds: &mut Bounds, mark: &str, what: &str) {
    // A smaller `seen` may have been among the messages: states wait for it.
    client.say(&json!({"type": "seen", "seq": 1_u64 << 52}));
    client.say(&json!({"type": "pause", "id": mark}));
    client.until(|message| {
        match message["type"].as_str().unwrap() {
            "scene" => *bounds = self::bounds(message),
            "state" => check(message, bounds, what),
            "error" => {
                let text = message["message"].as_str().unwrap();
                assert!(!text.is_empty() && text.len() < 5000, "{what}: {text}");
                assert!(!text.contains("panicked"), "{what}: {text}");
            }
            _ => {}
        }
        message["type"] == "state" && message["ack"] == mark
    });
}

fn feed(model: &str) {
    let (examples, server) = (examples(), Server::new(&[model]));
    let mut client = server.client();
    let scene = client.next("scene");
    let mut names: Vec<&str> = ["coordinates", "frames", "links", "overlays", "methods"]
        .iter()
        .flat_map(|list| scene[list].as_array().unwrap())
        .filter_map(|entry| entry["name"].as_str())
        .collect();
    names.extend(["ball", "pose", "position", "sphere", "box", "half_space", "info", "screws"]);
    let mut limits = bounds(&scene);
    for seed in seeds(FEW) {
        let mut random = Random(seed);
        let mut sent = Vec::new();
        for _ in 0..TOGETHER {
            let mut message = examples[random.below(examples.len())].clone();
            // Names of this model, so that more is accepted.
            if random.below(2) == 0 && message["name"].is_string() {
                message["name"] = json!(random.of(&names));
            }
            let other = &examples[random.below(examples.len())];
            for _ in 0..random.below(3) {
                mutate(&mut message, other, &names, &mut random);
            }
            let mut text = message.to_string();
            if random.below(4) == 0 {
                text = mutate_text(&text, &mut random);
            }
            client.text(&text);
            sent.push(text);
        }
        settle(&mut client, &mut limits, &seed.to_string(), &format!("seed {seed}: {sent:?}"));
    }
    // Afterwards it serves as before.
    client.say(&json!({"type": "reset"}));
    let mut other = server.client();
    assert_eq!(other.next("scene")["name"], model);
    assert_eq!(other.done(json!({"type": "play"}))["type"], "state");
}

#[test]
fn mutated_messages_to_an_arm() {
    feed("panda");
}

#[test]
fn mutated_messages_to_a_closed_chain() {
    feed("five-bar");
}
