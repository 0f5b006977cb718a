//! Actuated joints, inverses, overlays and reports.

use serde_json::{Value, json};

use super::{Client, Server, configuration};
use crate::distance::CELL;
use crate::numbers;

fn report(client: &mut Client, name: &str) -> Value {
    client.say(&json!({"type": "report", "name": name, "id": name}));
    let report = client.next("report");
    assert_eq!((&report["name"], &report["reply_to"]), (&name.into(), &name.into()));
    report["report"].clone()
}

/// The numbers of the page are those of the commands, whatever joints are actuated.
#[test]
fn reports_are_those_of_the_commands() {
    let server = Server::new(&["five-bar"]);
    let mut client = server.client();
    client.next("scene");
    for actuated in [["q2", "q3"], ["q1", "q5"]] {
        client.say(&json!({"type": "actuated", "names": actuated}));
        let scene = client.next("scene");
        let is_actuated = |d: &&Value| d["actuated"] == true;
        let found = scene["actuators"].as_array().unwrap().iter().filter(is_actuated);
        assert_eq!(found.map(|d| d["name"].as_str().unwrap()).collect::<Vec<_>>(), actuated);
        client.done(json!({"type": "joint", "name": "q1", "value": 0.05}));
        let state = client.done(json!({"type": "pause"}));
        let (q, actuated) = (configuration(&state), actuated.join(","));
        for name in ["mobility", "manipulability"] {
            let told = report(&mut client, name);
            let printed = crate::json(&[name, "five-bar", "--q", &q, "--actuated", &actuated], 0);
            assert_eq!(told["actuated"], printed["actuated"]);
            same(&told, &printed, name);
        }
    }
    let other = report(&mut client, "screws");
    assert_eq!(other["frame"], "reference");

    let server = Server::new(&["youbot"]);
    let mut client = server.client();
    let q = configuration(&client.next("state"));
    same(
        &report(&mut client, "screws"),
        &crate::json(&["screws", "youbot", "--q", &q], 0),
        "screws",
    );
    same(&report(&mut client, "info"), &crate::json(&["info", "youbot"], 0), "info");
    let unknown = client.complaint(&json!({"type": "report", "name": "mobilty"}));
    assert!(unknown["message"].as_str().unwrap().contains("mobility"), "{unknown}");
}

/// Equal, numbers up to the rounding of their way through text.
pub(super) fn same(a: &Value, b: &Value, place: &str) {
    match (a, b) {
        (Value::Object(x), Value::Object(y)) => {
            assert!(x.keys().eq(y.keys()), "{place}: {a} and {b}");
            x.iter().for_each(|(key, value)| same(value, &y[key], &format!("{place}.{key}")));
        }
        (Value::Array(x), Value::Array(y)) => {
            assert_eq!(x.len(), y.len(), "{place}");
            x.iter().zip(y).for_each(|(a, b)| same(a, b, place));
        }
        (Value::Number(x), Value::Number(y)) => {
            let (x, y) = (x.as_f64().unwrap(), y.as_f64().unwrap());
            assert!((x - y).abs() <= 1e-9 * x.abs().max(1e-6), "{place}: {x} and {y}");
        }
        _ => assert_eq!(a, b, "{place}"),
    }
}

#[test]
fn actuators_that_leave_the_object_free_leave_no_servo() {
    let server = Server::new(&["five-bar"]);
    let mut client = server.client();
    client.next("scene");
    client.say(&json!({"type": "actuated", "names": ["q1"]}));
    client.next("scene");
    let state = client.next("state");
    assert_eq!(state["servo"]["status"], "unavailable");
    assert!(state["servo"]["sentence"].as_str().unwrap().contains("can still move"), "{state}");
    // Joints can be moved all the same, and other actuators take over again.
    assert_eq!(
        client.done(json!({"type": "joint", "name": "q1", "value": 0.1}))["closure_error"]["closed"],
        true
    );
    client.say(&json!({"type": "actuated", "names": ["q1", "q2"]}));
    client.until(|m| m["servo"]["status"] == "reached");
    let server = Server::new(&["panda"]);
    let refused =
        server.client().complaint(&json!({"type": "actuated", "names": ["panda_joint1"]}));
    assert!(refused["message"].as_str().unwrap().contains("no loops"), "{refused}");
}

#[test]
fn two_inverses_differ_in_what_moving_the_point_changes() {
    let server = Server::new(&["youbot", "--q", "0.4,0.6,0.9,0.4,0.2"]);
    let mut client = server.client();
    let methods = ["truncated", "hyperbolic"];
    client
        .say(&json!({"type": "compare", "methods": methods, "point": [0.5, -0.2, 0.4], "h": 0.1}));
    let answer = client.next("compare");
    let [plain, invariant] = [0, 1].map(|i| &answer["results"][i]);
    assert_eq!((&plain["invariant"], &invariant["invariant"]), (&false.into(), &true.into()));
    assert!(plain["difference"].as_f64().unwrap() > 1e-3);
    assert_eq!(
        numbers(&invariant["joint_velocities"]).len(),
        answer["names"].as_array().unwrap().len()
    );
    let unknown = client
        .complaint(&json!({"type": "compare", "methods": ["truncated", "x"], "point": [0, 0, 0]}));
    assert_eq!(unknown["place"], "compare.methods");
    let server = Server::new(&["four-bar"]);
    let refused = server
        .client()
        .complaint(&json!({"type": "compare", "methods": methods, "point": [0, 0, 0]}));
    assert!(refused["message"].as_str().unwrap().contains("loops"), "{refused}");
}

#[test]
fn methods_tasks_and_frames_are_taken_or_refused_as_a_whole() {
    let server = Server::new(&["youbot", "--q", "0.4,0.6,0.9,0.4,0.2"]);
    let mut client = server.client();
    client.next("scene");
    client.say(&json!({"type": "method", "name": "damped", "parameters": {"damping": 0.05}}));
    let scene = client.next("scene");
    assert_eq!(
        scene["method"],
        json!({"name": "damped", "parameters": {"damping": 0.05}, "h": null, "fallback": null})
    );
    client.say(&json!({"type": "method", "name": "hyperbolic", "fallback": "truncated"}));
    assert_eq!(client.next("scene")["method"]["fallback"], "truncated");
    let wrong = client.complaint(&json!({"type": "task", "name": "position"}));
    assert!(wrong["message"].as_str().unwrap().contains("whole poses"), "{wrong}");
    for (message, word) in [
        (json!({"type": "method", "name": "dampd"}), "damped"),
        (json!({"type": "method", "name": "damped", "parameters": {"dmping": 1}}), "damping"),
        (json!({"type": "method", "name": "damped", "parameters": {"damping": -1}}), "positive"),
        (json!({"type": "task", "name": "x,yaw"}), "pose"),
        (json!({"type": "frame", "name": "arm_link_9"}), "arm_link_"),
        (json!({"type": "overlays", "names": ["velocity"]}), "velocity-ellipsoid"),
    ] {
        let complaint = client.complaint(&message);
        assert!(complaint["message"].as_str().unwrap().contains(word), "{complaint}");
    }
    client.say(&json!({"type": "method", "name": "truncated"}));
    client.next("scene");
    client.say(&json!({"type": "task", "name": "position"}));
    assert_eq!(client.next("scene")["task"]["components"], json!(["x", "y", "z"]));
    client.say(&json!({"type": "frame", "name": "arm_link_3"}));
    assert_eq!(client.next("scene")["frame"], "arm_link_3");
    let state = client.next("state");
    assert_eq!(state["tool"], state["target"]);
}

/// Every overlay has something to say of every kind of mechanism, and nothing that is not a number.
#[test]
fn overlays_come_with_their_numbers() {
    for model in ["youbot", "five-bar", "stewart", "two-arm", "delta"] {
        let server = Server::new(&[model]);
        let mut client = server.client();
        let scene = client.next("scene");
        let names: Vec<&Value> =
            scene["overlays"].as_array().unwrap().iter().map(|o| &o["name"]).collect();
        let state = client.done(json!({"type": "overlays", "names": names}));
        for name in &names {
            let shown = &state["overlays"][name.as_str().unwrap()];
            assert!(shown.is_object() && !shown.as_object().unwrap().is_empty(), "{model} {name}");
            assert!(!shown["empty"].as_str().is_some_and(str::is_empty));
        }
        let axes = state["overlays"]["joint-axes"]["axes"].as_array().unwrap();
        assert!(axes.len() >= numbers(&state["q"]).len(), "{model}");
        let none = client.done(json!({"type": "overlays", "names": []}));
        assert_eq!(none["overlays"], json!({}));
    }
}

/// Every key of every message is named on the page of the protocol.
#[test]
fn messages_have_the_keys_of_their_page() {
    const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/viewer.md");
    let page = std::fs::read_to_string(PAGE).unwrap();
    let check = |message: &Value| {
        // A report is the matter of docs/json.md.
        let mut message = message.clone();
        message.as_object_mut().unwrap().remove("report");
        let mut found = std::collections::BTreeSet::new();
        crate::documents::keys(&message, &mut found);
        let named = |key: &&&str| {
            page.contains(&format!("\"{key}\"")) || page.contains(&format!("`{key}`"))
        };
        let missing: Vec<_> = found.iter().filter(|key| !named(key)).collect();
        assert!(missing.is_empty(), "{missing:?} of {}", message["type"]);
    };
    for arguments in
        [&["youbot", "--frame", "arm_link_2"][..], &["two-arm"], &["five-bar"], &[CELL]]
    {
        let server = Server::new(arguments);
        let mut client = server.client();
        let scene = client.next("scene");
        check(&scene);
        let names: Vec<&Value> =
            scene["overlays"].as_array().unwrap().iter().map(|o| &o["name"]).collect();
        check(&client.done(json!({"type": "overlays", "names": names})));
        check(&client.complaint(&json!({"type": "jump"})));
        let shape = json!({"kind": "ellipsoid", "radii": [0.1, 0.2, 0.3]});
        let egg =
            json!({"type": "add_obstacle", "name": "egg", "shape": shape, "position": [0, 0, 9]});
        client.say(&egg);
        check(&client.next("scene"));
        client.say(&json!({"type": "avoid_collisions", "on": true}));
        check(&client.next("scene"));
        check(&client.done(json!({"type": "distances", "margin": 99})));
        client.say(&json!({"type": "report", "name": "info"}));
        check(&client.next("report"));
        let methods = ["damped", "hyperbolic-gram"];
        client.say(&json!({"type": "compare", "methods": methods, "point": [0, 0, 1], "h": 0.1}));
        check(&client.until(|m| m["type"] == "compare" || m["type"] == "error"));
    }
}

#[test]
fn ellipsoids_and_screws_are_those_of_the_commands() {
    let server = Server::new(&["five-bar"]);
    let mut client = server.client();
    client.next("scene");
    let on = ["velocity-ellipsoid", "active-force-ellipsoid", "passive-force-ellipsoid"];
    let state = client.done(json!({"type": "overlays", "names": on}));
    let printed = crate::json(&["manipulability", "five-bar", "--task", "x,y"], 0);
    for (overlay, key) in on.iter().zip(["kinematic", "active_force", "passive_force"]) {
        let axes = state["overlays"][*overlay]["axes"].as_array().unwrap();
        let squares: Vec<f64> = axes.iter().map(|a| a["size"].as_f64().unwrap().powi(2)).collect();
        // One scale for all, so that the drawing has the shape of the ellipsoid.
        let scale = state["overlays"][*overlay]["scale"].as_f64().unwrap();
        for axis in axes {
            let drawn = numbers(&axis["vector"]).iter().map(|x| x * x).sum::<f64>().sqrt();
            let expected = scale * axis["size"].as_f64().unwrap();
            assert!((drawn - expected).abs() < 1e-12 * expected, "{overlay}: {axis}");
        }
        let finite = numbers(&printed[key]["finite"]);
        assert_eq!(squares.len(), finite.len(), "{overlay}");
        for (a, b) in squares.iter().zip(&finite) {
            assert!((a - b).abs() < 1e-9 * b, "{overlay}: {a} and {b}");
        }
    }

    let server = Server::new(&["youbot", "--frame", "arm_link_2"]);
    let mut client = server.client();
    let q = configuration(&client.next("state"));
    let on = ["cylindroid", "principal-screws", "reciprocal-system"];
    let state = client.done(json!({"type": "overlays", "names": on}));
    let printed = crate::json(&["screws", "youbot", "--frame", "arm_link_2", "--q", &q], 0);
    let system = &state["overlays"]["principal-screws"];
    assert_eq!(
        (&system["order"], &system["gibson_hunt"]),
        (&printed["rank"], &printed["gibson_hunt"])
    );
    let reciprocal = &state["overlays"]["reciprocal-system"];
    assert_eq!(reciprocal["screws"].as_array().unwrap().len(), 4);
    let cylindroid = &state["overlays"]["cylindroid"];
    let (low, high) =
        (cylindroid["pitches"][0].as_f64().unwrap(), cylindroid["pitches"][1].as_f64().unwrap());
    for ruling in cylindroid["rulings"].as_array().unwrap() {
        let pitch = ruling["pitch"].as_f64().unwrap();
        assert!((low..=high).contains(&pitch));
    }
    for pitch in numbers(&printed["principal_pitches"]) {
        assert!(pitch > low - 1e-9 && pitch < high + 1e-9, "{pitch} in {low} to {high}");
    }
}

#[test]
fn a_direction_is_lost_where_the_arm_is_straight() {
    let server = Server::new(&["ur5e", "--q", "zero"]);
    let mut client = server.client();
    client.next("scene");
    let state = client.done(json!({"type": "overlays", "names": ["lost-direction"]}));
    let lost = &state["overlays"]["lost-direction"];
    assert_eq!(lost["lost"], true, "{lost}");
    assert!(lost["sentence"].as_str().unwrap().contains("lost"), "{lost}");
    let bent = client.done(json!({"type": "configuration", "q": [0, -1.2, 1.4, 0.5, 1.5, 0]}));
    assert!(bent["overlays"]["lost-direction"]["empty"].is_string(), "{bent}");
}
