//! Distances, obstacles, and a servo that avoids collisions.

use serde_json::{Value, json};

use super::{Client, Server};
use crate::distance::CELL;
use crate::numbers;

const BALL: &str = "ball=sphere:0.08@0.4,0.25,0.3";

fn ball(name: &str, position: [f64; 3], radius: f64) -> Value {
    let shape = json!({"kind": "sphere", "radius": radius});
    json!({"type": "add_obstacle", "name": name, "shape": shape, "position": position})
}

fn near(state: &Value) -> &Vec<Value> {
    state["distances"]["near"].as_array().unwrap()
}

/// Pairs, distances and points are those of the command.
#[test]
fn distances_are_those_of_the_command() {
    let server = Server::new(&[CELL, "--obstacle", BALL]);
    let mut client = server.client();
    let scene = client.next("scene");
    assert_eq!(scene["obstacles"], json!([{"name": "ball", "kind": "sphere", "radius": 0.08}]));
    assert_eq!(scene["avoidance"], json!({"gap": 0.01, "margin": 0.3}));
    let state = client.next("state");
    assert_eq!(state["distances"], Value::Null);
    assert_eq!(numbers(&state["obstacles"][0]["position"]), [0.4, 0.25, 0.3]);
    let state = client.done(json!({"type": "distances", "margin": 0.5}));
    let printed = crate::json(&["distance", CELL, "--obstacle", BALL, "--margin", "0.5"], 0);
    assert_eq!(state["distances"]["pairs"], printed["pairs"]);
    let wanted = printed["near"].as_array().unwrap();
    assert!(near(&state).len() == wanted.len() && wanted.len() > 2, "{state}");
    for (told, printed) in near(&state).iter().zip(wanted) {
        for key in ["a", "b", "distance", "point_a", "point_b"] {
            assert_eq!(told[key], printed[key]);
        }
    }
    let state = client.done(json!({"type": "distances", "margin": null}));
    assert_eq!(state["distances"], Value::Null);
}

/// The nearest pairs only, however many there are.
#[test]
fn states_have_a_bounded_number_of_pairs_and_obstacles() {
    let server = Server::new(&[CELL]);
    let mut client = server.client();
    client.next("state");
    for i in 0..32 {
        client.say(&ball(&format!("ball {i}"), [2.0, 0.1 * f64::from(i), 0.0], 0.01));
        client.next("scene");
    }
    let error = client.complaint(&ball("one more", [2.0; 3], 0.1));
    assert!(error["message"].as_str().unwrap().contains("at most 32"), "{error}");
    let state = client.done(json!({"type": "distances", "margin": 100}));
    assert_eq!(near(&state).len(), 32);
    let pairs = state["distances"]["pairs"].as_u64().unwrap();
    assert_eq!(state["distances"]["more"].as_u64(), Some(pairs - 32));
    assert!(near(&state).is_sorted_by_key(|n| n["distance"].as_f64().unwrap()));
}

/// Moves the target through the ball; gives the state at rest.
fn towards_the_ball(client: &mut Client) -> Value {
    let here = client.next("state");
    let target = json!({
        "type": "target", "position": [0.4, 0.25, 0.3], "quaternion": here["tool"]["quaternion"],
    });
    client.done(target);
    client.ended()
}

#[test]
fn a_servo_that_avoids_collisions_stops_before_an_obstacle_and_names_it() {
    let server = Server::new(&[CELL, "--obstacle", BALL]);
    let mut client = server.client();
    let state = towards_the_ball(&mut client);
    let servo = &state["servo"];
    assert_eq!((&servo["status"], &servo["reason"]), (&json!("stalled"), &json!("distance")));
    assert_eq!(servo["pair"], json!(["flange", "ball"]));
    assert!(servo["sentence"].as_str().unwrap().contains("flange and ball"), "{servo}");
    let state = client.done(json!({"type": "distances", "margin": 0.5}));
    let nearest = near(&state)[0]["distance"].as_f64().unwrap();
    assert!((0.01 - 1e-6..0.02).contains(&nearest), "{nearest}");

    // An obstacle that is moved away frees the way.
    let away = json!({"type": "move_obstacle", "name": "ball", "position": [0.4, 1.5, 0.3], "quaternion": [1, 0, 0, 0]});
    client.done(away);
    assert_eq!(client.ended()["servo"]["status"], "reached");
}

#[test]
fn without_avoidance_the_servo_passes_through() {
    let server = Server::new(&[CELL]);
    let mut client = server.client();
    client.next("scene");
    client.say(&ball("ball", [0.4, 0.25, 0.3], 0.08));
    let scene = client.next("scene");
    assert_eq!(scene["avoidance"], Value::Null);
    let state = towards_the_ball(&mut client);
    assert_eq!(state["servo"]["status"], "reached");
    let state = client.done(json!({"type": "distances", "margin": 0.1}));
    assert!(near(&state)[0]["distance"].as_f64() < Some(0.0), "{state}");
    client.say(&json!({"type": "remove_obstacle", "name": "ball"}));
    assert_eq!(client.next("scene")["obstacles"], json!([]));
    let state = client.next("state");
    assert!(near(&state).iter().all(|n| n["b"] != "ball"), "{state}");
}

/// Frame, task and self-motion work as without avoidance.
#[test]
fn a_servo_that_avoids_collisions_follows_target_frame_and_self_motion() {
    let server = Server::new(&[CELL, "--avoid"]);
    let mut client = server.client();
    let home = client.next("state");
    let from = numbers(&home["tool"]["position"]);
    let to = [from[0] - 0.05, from[1] + 0.1, from[2] + 0.05];
    let quaternion = home["tool"]["quaternion"].clone();
    client.done(json!({"type": "target", "position": to, "quaternion": quaternion}));
    let state = client.ended();
    assert_eq!(state["servo"]["status"], "reached");
    assert!(state["error"]["position"].as_f64() < Some(1e-4), "{state}");
    client.say(&json!({"type": "task", "name": "position"}));
    client.next("scene");
    let begin = client.done(json!({"type": "null_space", "rate": 0.2}));
    let until = begin["time"].as_f64().unwrap() + 0.5;
    let turned = client.until(|m| m["time"].as_f64() > Some(until));
    let moved = |a: &Value, b: &Value| {
        let pairs = numbers(a).into_iter().zip(numbers(b));
        pairs.map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
    };
    assert!(moved(&turned["q"], &begin["q"]) > 0.03, "{turned}");
    assert!(moved(&turned["tool"]["position"], &begin["tool"]["position"]) < 1e-3, "{turned}");
    client.done(json!({"type": "null_space", "rate": 0}));
    let far = json!({"type": "target", "position": [3, 0, 0], "quaternion": [1, 0, 0, 0]});
    client.done(far);
    let state = client.until(|m| m["servo"]["status"] == "stalled");
    assert_eq!(state["servo"]["reason"], "out-of-reach");
    client.say(&json!({"type": "avoid_collisions", "on": false}));
    assert_eq!(client.next("scene")["avoidance"], Value::Null);
}

/// Closed chains too: a box beside a five-bar.
#[test]
fn closed_chains_have_obstacles() {
    let server = Server::new(&["five-bar", "--avoid"]);
    let mut client = server.client();
    client.next("scene");
    let shape = json!({"kind": "box", "size": [1, 1, 1]});
    client.say(
        &json!({"type": "add_obstacle", "name": "crate", "shape": shape, "position": [4, 0, 0]}),
    );
    assert_eq!(client.next("scene")["obstacles"][0]["kind"], "box");
    client.say(&json!({"type": "actuated", "names": ["q2", "q4"]}));
    let scene = client.next("scene");
    assert_eq!(
        (scene["avoidance"].is_object(), &scene["obstacles"][0]["name"]),
        (true, &json!("crate"))
    );
    let state = client.done(json!({"type": "distances", "margin": 1}));
    assert_eq!(state["distances"]["shapes"], 0);
}

#[test]
fn obstacles_that_cannot_be_are_refused_with_their_place() {
    let server = Server::new(&[CELL]);
    let mut client = server.client();
    client.next("state");
    client.say(&ball("ball", [1.0, 0.0, 0.0], 0.1));
    client.next("scene");
    let with = |shape: Value| json!({"type": "add_obstacle", "name": "x", "shape": shape, "position": [0, 0, 0]});
    let pose = json!([0, 0, 0, 0]);
    for (message, place, word) in [
        (ball("ball", [0.0; 3], 0.1), "add_obstacle", "ball"),
        (ball("", [0.0; 3], 0.1), "add_obstacle.name", "1 to 60"),
        (ball("x", [0.0; 3], 0.0), "add_obstacle.shape.radius", "radius = 0"),
        (with(json!({"kind": "box", "size": [1, -1, 1]})), "add_obstacle.shape.size", "-1"),
        (with(json!({"kind": "sphere", "radius": 1e300})), "add_obstacle", "too large"),
        (with(json!({"kind": "mesh", "path": "/etc/passwd"})), "add_obstacle.shape.kind", "mesh"),
        (with(json!({"kind": "sphere", "size": 1})), "add_obstacle.shape", "size"),
        (
            json!({"type": "move_obstacle", "name": "bal", "position": [0, 0, 0], "quaternion": [1, 0, 0, 0]}),
            "move_obstacle.name",
            "ball",
        ),
        (
            json!({"type": "move_obstacle", "name": "ball", "position": [0, 0, 0], "quaternion": pose}),
            "move_obstacle.quaternion",
            "quaternion",
        ),
        (json!({"type": "remove_obstacle", "name": "bal"}), "remove_obstacle.name", "ball"),
        (json!({"type": "distances", "margin": 0}), "distances.margin", "margin"),
        (json!({"type": "avoid_collisions", "on": true, "gap": 1}), "avoid_collisions", "margin"),
        (json!({"type": "avoid_collisions", "on": true, "gap": -1}), "avoid_collisions", "gap"),
    ] {
        let error = client.complaint(&message);
        assert_eq!(error["place"], place, "{error}");
        assert!(error["message"].as_str().unwrap().contains(word), "{error}");
    }
    let state = client.done(json!({"type": "pause"}));
    assert_eq!(state["obstacles"].as_array().unwrap().len(), 1);
}

#[test]
fn the_command_refuses_what_is_no_obstacle() {
    let refused = |arguments: &[&str], word: &str| {
        let error = crate::refused(&[&["view", CELL, "--check"], arguments].concat());
        assert!(error.contains(word), "{error}");
    };
    refused(&["--obstacle", "ball=sphere:0.1"], "NAME=SHAPE");
    refused(&["--obstacle", "ball=sphere:-1@0,0,0"], "ball");
    refused(&["--obstacle", BALL, "--obstacle", BALL], "ball");
    let many: Vec<String> = (0..33).map(|i| format!("b{i}=sphere:0.1@9,0,0")).collect();
    let many: Vec<&str> = many.iter().flat_map(|o| ["--obstacle", o]).collect();
    refused(&many, "at most 32");
}
