//! Joints, targets and self-motions.

use serde_json::{Value, json};

use super::choices::same;
use super::{Server, configuration};
use crate::{difference, numbers};

#[test]
fn a_scene_comes_first_and_poses_are_those_of_fk() {
    let server = Server::new(&["panda"]);
    let mut client = server.client();
    let scene = client.hear();
    assert_eq!((&scene["type"], &scene["name"]), (&"scene".into(), &"panda".into()));
    assert_eq!((&scene["closed"], &scene["self_motions"]), (&false.into(), &1.into()));
    assert_eq!(scene["frame"], "hand_tcp");
    assert_eq!(scene["coordinates"][3]["upper"], -0.0698);
    let state = client.done(json!({"type": "joint", "name": "panda_joint2", "value": 0.3}));
    assert!((state["q"][1].as_f64().unwrap() - 0.3).abs() < 1e-12);
    let all = crate::json(&["fk", "panda", "--all", "--q", &configuration(&state)], 0);
    for (link, pose) in
        scene["links"].as_array().unwrap().iter().zip(state["links"].as_array().unwrap())
    {
        let frames = all["frames"].as_array().unwrap();
        let own = &frames.iter().find(|f| f["frame"] == link["name"]).unwrap()["pose"];
        assert!(difference(&numbers(&own["position"]), &numbers(&pose["position"])) < 1e-12);
        let q = &own["quaternion"];
        let q: Vec<f64> = ["w", "x", "y", "z"].iter().map(|k| q[k].as_f64().unwrap()).collect();
        assert!(difference(&q, &numbers(&pose["quaternion"])) < 1e-12);
    }
    // The target went along: nothing is to be done.
    assert_eq!(state["target"], state["tool"]);
}

#[test]
fn a_target_is_reached_and_then_nothing_is_sent() {
    let server = Server::new(&["panda"]);
    let mut client = server.client();
    let first = client.next("state");
    let mut target = first["tool"].clone();
    target["position"][2] = json!(target["position"][2].as_f64().unwrap() - 0.1);
    let mut message = target.clone();
    message["type"] = json!("target");
    client.say(&message);
    let state = client.until(|m| m["servo"]["status"] == "reached");
    assert!(state["error"]["position"].as_f64().unwrap() < 1e-6);
    assert!(state["singular"]["rank"] == 6 && state["singular"]["values"][5].as_f64() > Some(0.0));
    let fk = crate::json(&["fk", "panda", "--q", &configuration(&state)], 0);
    assert!(difference(&numbers(&fk["pose"]["position"]), &numbers(&target["position"])) < 2e-6);
    // It comes to rest, and is silent but for the state after each answer.
    let mut states_in = |seconds| {
        std::thread::sleep(std::time::Duration::from_secs(seconds));
        client.say(&json!({"type": "frame", "name": "none"}));
        std::iter::repeat_with(|| client.hear()).take_while(|m| m["type"] != "error").count()
    };
    assert!((0..30).any(|_| states_in(1) <= 1), "it goes on for half a minute");
    assert_eq!(states_in(2), 1);
    let last = client.next("state")["seq"].as_u64();
    client.say(&json!({"type": "pause"}));
    assert_eq!(client.next("state")["seq"].as_u64(), last.map(|n| n + 1));
}

#[test]
fn targets_out_of_reach_stall_with_their_reason_in_words() {
    let server = Server::new(&["ur5e"]);
    let mut client = server.client();
    let target = json!({"type": "target", "position": [3, 0, 0], "quaternion": [1, 0, 0, 0]});
    client.say(&target);
    let state = client.until(|m| m["servo"]["status"] == "stalled");
    assert_eq!(state["servo"]["reason"], "out-of-reach");
    assert!(state["servo"]["sentence"].as_str().unwrap().contains("out of reach"), "{state}");
}

#[test]
fn pause_holds_and_reset_goes_home() {
    let server = Server::new(&["panda"]);
    let mut client = server.client();
    let home = client.next("state");
    assert_eq!(client.done(json!({"type": "pause"}))["servo"]["status"], "paused");
    let away = json!({"type": "target", "position": [0.4, 0.2, 0.4], "quaternion": [0, 2, 0, 0]});
    let stopped = client.done(away);
    assert!(stopped["q"] == home["q"] && stopped["error"]["position"].as_f64() > Some(0.1));
    assert_eq!(numbers(&stopped["target"]["quaternion"]), [0.0, 1.0, 0.0, 0.0]);
    client.say(&json!({"type": "play"}));
    let there = client.ended();
    assert_ne!(there["q"], home["q"]);
    assert_eq!(client.done(json!({"type": "reset"}))["q"], home["q"]);
}

#[test]
fn a_self_motion_leaves_the_tool_where_it_is() {
    let server = Server::new(&["panda"]);
    let mut client = server.client();
    let home = client.next("state");
    client.say(&json!({"type": "null_space", "rate": 0.2}));
    let begin = home["time"].as_f64().unwrap();
    let state = client.until(|m| m["time"].as_f64() > Some(begin + 0.5));
    assert_eq!(state["servo"]["self_motion"], 0.2);
    assert!(difference(&numbers(&state["q"]), &numbers(&home["q"])) > 0.05, "{state}");
    let apart =
        difference(&numbers(&state["tool"]["position"]), &numbers(&home["tool"]["position"]));
    assert!(apart < 1e-3, "{apart}");
    assert!(
        client.complaint(&json!({"type": "null_space", "rate": 2}))["message"]
            .as_str()
            .unwrap()
            .contains("-1 to 1")
    );
    assert_eq!(client.done(json!({"type": "null_space", "rate": 0}))["servo"]["self_motion"], 0.0);
}

/// The tool follows a twist while commands arrive, brakes without them, and rests with the target at
/// the tool; with avoided collisions, and of a closed chain, as well.
#[test]
fn a_twist_is_followed_until_commands_end() {
    // Along an axis: the five-bar's object hardly moves along y alone.
    for (arguments, axis) in [(&["panda"][..], 1), (&["panda", "--avoid"], 1), (&["five-bar"], 0)] {
        let across = 1 - axis;
        let server = Server::new(arguments);
        let mut client = server.client();
        let home = client.next("state");
        assert_eq!(home["servo"]["twist"], Value::Null);
        let from = numbers(&home["tool"]["position"]);
        let mut twist = [0.0; 6];
        twist[axis] = 0.05;
        let up = json!({"type": "twist", "linear": twist[..3], "angular": twist[3..]});
        let mut state = client.done(up.clone());
        let begin = state["time"].as_f64().unwrap();
        while state["time"].as_f64() < Some(begin + 0.6) {
            state = client.done(up.clone());
        }
        assert_eq!(state["servo"]["status"], "moving", "{state}");
        assert_eq!(state["servo"]["sentence"], "Following the commanded twist.");
        assert_eq!(numbers(&state["servo"]["twist"]), twist);
        assert_eq!(state["tool"], state["target"]);
        // No command comes any more.
        let last = client.ended();
        assert_eq!(
            (&last["servo"]["status"], &last["servo"]["twist"]),
            (&json!("reached"), &Value::Null)
        );
        assert_eq!(last["tool"], last["target"]);
        let to = numbers(&last["tool"]["position"]);
        let passed = last["time"].as_f64().unwrap() - begin;
        let way = to[axis] - from[axis];
        assert!(way > 0.02 && way < 0.05 * (passed + 0.1), "{way} m in {passed} s");
        let aside = (to[across] - from[across]).abs().max((to[2] - from[2]).abs());
        assert!(aside < 2e-3, "{last}");
        let turned = |state: &Value| numbers(&state["tool"]["quaternion"]);
        // Both signs are the same rotation.
        let cosine: f64 = turned(&last).iter().zip(turned(&home)).map(|(a, b)| a * b).sum();
        assert!(1.0 - cosine.abs() < 1e-6, "{arguments:?}: {cosine}");
        // A target ends it.
        client.done(up);
        let back = json!({"type": "target", "position": from, "quaternion": turned(&home)});
        client.done(back);
        let there = client.ended();
        assert!(there["error"]["position"].as_f64() < Some(1e-3), "{there}");
        assert_eq!(there["servo"]["twist"], Value::Null);
    }
}

#[test]
fn a_paused_servo_refuses_a_twist() {
    let server = Server::new(&["panda"]);
    let mut client = server.client();
    client.done(json!({"type": "pause"}));
    let twist = json!({"type": "twist", "linear": [0, 0, 0.05], "angular": [0, 0, 0]});
    let refused = client.complaint(&twist);
    assert!(refused["message"].as_str().unwrap().contains("paused; send play"), "{refused}");
    client.done(json!({"type": "play"}));
    let short = json!({"type": "twist", "linear": [0, 0], "angular": [0, 0, 0]});
    assert_eq!(client.complaint(&short)["place"], "twist.linear");
}

#[test]
fn joints_stop_at_their_limits_and_say_so() {
    let server = Server::new(&["panda"]);
    let mut client = server.client();
    client.next("scene");
    let far = json!({"type": "joint", "name": "panda_joint4", "value": 1, "id": 7});
    let complaint = client.complaint(&far);
    assert_eq!((&complaint["reply_to"], &complaint["nearest"]), (&7.into(), &(-0.0698).into()));
    assert_eq!(complaint["place"], "joint.value");
    assert_eq!(client.until(|m| m["ack"] == 7)["q"][3], -0.0698);
}

#[test]
fn loops_stay_closed_whatever_is_moved() {
    let server = Server::new(&["five-bar"]);
    let mut client = server.client();
    let scene = client.hear();
    assert_eq!((&scene["closed"], &scene["objects"][0]["name"]), (&true.into(), &"coupler".into()));
    for (name, value) in [("q1", 0.05), ("q2", -0.1), ("q3", 0.02)] {
        let state = client.done(json!({"type": "joint", "name": name, "value": value}));
        assert_eq!(state["closure_error"]["closed"], true, "{name}: {state}");
        let i = ["q1", "q2", "q3"].iter().position(|n| *n == name).unwrap();
        assert!((state["q"][i].as_f64().unwrap() - value).abs() < 1e-9, "{name}: {state}");
        let [a, b] = ["a", "b"].map(|side| numbers(&state["loops"][0][side]));
        assert!(difference(&a, &b) < 1e-9);
    }
    let mut target = client.done(json!({"type": "reset"}))["tool"].clone();
    target["position"] = json!([1.2, 1.8, 0]);
    target["type"] = json!("target");
    client.say(&json!({"type": "task", "name": "x,y"}));
    client.say(&target);
    let state = client.until(|m| {
        m["servo"]["status"] == "reached" && m["error"]["position"].as_f64() < Some(1e-6)
    });
    assert!(difference(&numbers(&state["tool"]["position"])[..2], &[1.2, 1.8]) < 1e-5);
    assert_eq!(state["closure_error"]["closed"], true);
    // Beyond what the rods allow it stops, with the nearest.
    let complaint = client.complaint(&json!({"type": "joint", "name": "q1", "value": 3}));
    let (nearest, message) = (complaint["nearest"].as_f64().unwrap(), &complaint["message"]);
    assert!(nearest < 3.0 && message.as_str().unwrap().contains("q1"), "{complaint}");
    assert!(complaint["way_out"].as_str().is_some_and(|w| !w.is_empty()));
}

#[test]
fn configurations_are_assembled() {
    let server = Server::new(&["stewart"]);
    let mut client = server.client();
    let n = client.hear()["coordinates"].as_array().unwrap().len();
    let mut q = vec![0.0; n];
    q[0] = 0.02;
    let state = client.done(json!({"type": "configuration", "q": q}));
    assert_eq!(state["closure_error"]["closed"], true);
    let short = client.complaint(&json!({"type": "configuration", "q": [0, 1]}));
    assert!(short["message"].as_str().unwrap().contains("expected"), "{short}");
}

/// States at other configurations are those of a session that goes there; the asking one stays.
#[test]
fn states_elsewhere_are_those_of_a_session_that_is_there() {
    for (model, joint, value) in [("panda", "panda_joint2", 0.3), ("five-bar", "q1", 0.05)] {
        let server = Server::new(&[model]);
        let [mut here, mut there] = [server.client(), server.client()];
        let names = json!({"type": "overlays", "names": ["joint-axes", "velocity-ellipsoid"]});
        here.say(&names);
        there.say(&names);
        let home = here.done(json!({"type": "distances", "margin": 0.5}));
        there.say(&json!({"type": "distances", "margin": 0.5}));
        let moved = there.done(json!({"type": "joint", "name": joint, "value": value}));
        let q = [&home["q"], &moved["q"], &home["q"]];
        here.say(&json!({"type": "states", "q": q, "full": true, "id": 5}));
        let answer = here.next("states");
        assert_eq!(answer["reply_to"], 5);
        let states = answer["states"].as_array().unwrap();
        assert_eq!(states.len(), 3);
        for (state, there) in states.iter().zip([&home, &moved, &home]) {
            for (field, value) in state.as_object().unwrap() {
                same(value, &there[field], field);
            }
        }
        let still = here.done(json!({"type": "pause"}));
        assert_eq!((&still["q"], &still["links"]), (&home["q"], &home["links"]));
        here.say(&json!({"type": "states", "q": [home["q"]]}));
        let bare = here.next("states");
        assert!(bare["states"][0]["overlays"].as_object().unwrap().is_empty());
        assert!(bare["states"][0]["distances"].is_null() && bare["reply_to"].is_null());
    }
}

#[test]
fn states_of_wrong_configurations_are_refused_with_their_place() {
    let server = Server::new(&["five-bar"]);
    let mut client = server.client();
    let home = client.next("state")["q"].clone();
    let short = client.complaint(&json!({"type": "states", "q": [home, [1]]}));
    assert_eq!(short["place"], "states.q[1]");
    let many = vec![home.clone(); 65];
    let many = client.complaint(&json!({"type": "states", "q": many}));
    assert!(many["message"].as_str().unwrap().contains("65 configurations"), "{many}");
    let text = client.complaint(&json!({"type": "states", "q": [home, "q"]}));
    assert_eq!(text["place"], "states.q[1]");
    assert_eq!(client.done(json!({"type": "pause"}))["q"], home);
}
