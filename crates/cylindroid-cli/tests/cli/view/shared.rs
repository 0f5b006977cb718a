//! Several clients of one session: one drives, the others observe.

use serde_json::{Value, json};

use super::{Client, Server};

/// What a client of the session `demo` is told about it, with this driver and number of clients.
fn told(client: &mut Client, driver: &str, clients: usize) -> Value {
    client.until(|m| m["type"] == "session" && m["driver"] == driver && m["clients"] == clients)
}

fn joint(value: f64) -> Value {
    json!({"type": "joint", "name": "panda_joint1", "value": value})
}

fn first_coordinate(client: &mut Client, value: f64) {
    client.until(|m| m["type"] == "state" && m["q"][0] == value);
}

#[test]
fn all_clients_of_a_session_see_what_its_driver_does() {
    let server = Server::new(&["panda"]);
    let mut driver = server.client_of("?session=demo");
    assert_eq!(driver.hear()["type"], "session");
    assert_eq!(driver.hear()["type"], "scene");
    let mut observer = server.client_of("?session=demo");
    let about = told(&mut observer, "another", 2);
    assert_eq!((&about["name"], &about["program"]), (&json!("demo"), &json!(false)));
    told(&mut driver, "you", 2);

    driver.say(&joint(0.25));
    first_coordinate(&mut observer, 0.25);
    let target = json!({"type": "target", "position": [0.4, 0.1, 0.5], "quaternion": [0, 1, 0, 0]});
    driver.say(&target);
    let seen = observer.until(|m| m["type"] == "state" && m["target"]["position"][1] == 0.1);
    assert_eq!(seen["ack"], Value::Null);
    // A new scene is everybody's.
    driver.say(&json!({"type": "task", "name": "position"}));
    observer.until(|m| m["type"] == "scene" && m["task"]["name"] == "position");

    // Others have sessions of their own.
    let home = crate::json(&["info", "panda"], 0)["home"].clone();
    for query in ["", "?session=other"] {
        let q = server.client_of(query).next("state")["q"].clone();
        assert_eq!(crate::numbers(&q), crate::numbers(&home));
    }
}

#[test]
fn observers_are_refused_until_they_take_over() {
    let server = Server::new(&["panda"]);
    let mut driver = server.client_of("?session=demo");
    driver.next("state");
    let mut observer = server.client_of("?session=demo");
    told(&mut observer, "another", 2);
    for message in [joint(0.5), json!({"type": "reset"}), json!({"type": "pause", "id": 3})] {
        let complaint = observer.complaint(&message);
        assert_eq!(
            (&complaint["place"], &complaint["reply_to"]),
            (&json!("session"), &message["id"])
        );
        assert!(complaint["way_out"].as_str().unwrap().contains("drive"), "{complaint}");
    }
    // It may ask and choose what it sees, and nobody else sees that.
    let state = observer.done(json!({"type": "overlays", "names": ["joint-axes"]}));
    assert!(state["overlays"]["joint-axes"].is_object());
    let state = observer.done(json!({"type": "distances", "margin": 0.2}));
    assert!(state["distances"].is_object());
    observer.say(&json!({"type": "report", "name": "info"}));
    observer.next("report");
    let state = driver.done(joint(0.125));
    assert_eq!((&state["overlays"], &state["distances"]), (&json!({}), &Value::Null));

    observer.say(&json!({"type": "drive", "on": true}));
    told(&mut observer, "you", 2);
    told(&mut driver, "another", 2);
    observer.say(&joint(0.5));
    first_coordinate(&mut driver, 0.5);
    assert_eq!(driver.complaint(&joint(0.1))["place"], "session");

    observer.say(&json!({"type": "drive", "on": false}));
    told(&mut driver, "nobody", 2);
    drop(observer);
    told(&mut driver, "nobody", 1);
    driver.say(&json!({"type": "drive", "on": true}));
    told(&mut driver, "you", 1);
}

/// Models beside the first are those of the session: all clients have them, and find their joints in
/// sessions that are named there.
#[test]
fn models_beside_the_first_are_shared() {
    let server = Server::new(&["panda"]);
    let mut driver = server.client_of("?session=demo");
    assert_eq!(driver.next("scene")["beside"], json!([]));
    let mut observer = server.client_of("?session=demo");
    told(&mut observer, "another", 2);
    let copy = |session: &str, quaternion: [f64; 4]| {
        json!({"model": null, "session": session, "position": [1.0, 0.0, 0.5],
               "quaternion": quaternion, "transparent": true})
    };
    let beside = |models: Value| json!({"type": "beside", "models": models});
    driver.say(&beside(json!([copy("demo-1", [2.0, 0.0, 0.0, 0.0])])));
    let models = json!([copy("demo-1", [1.0, 0.0, 0.0, 0.0])]);
    for client in [&mut driver, &mut observer] {
        client.until(|m| m["type"] == "scene" && m["beside"] == models);
    }
    let mut joints = server.client_of("?session=demo-1");
    joints.done(joint(0.25));
    let mut seen = server.client_of("?session=demo-1&observe");
    first_coordinate(&mut seen, 0.25);
    assert_eq!(server.client_of("?session=demo").next("scene")["beside"], models);

    assert_eq!(observer.complaint(&beside(json!([])))["place"], "session");
    let standing = [1.0, 0.0, 0.0, 0.0];
    let many: Vec<Value> = (0..9).map(|i| copy(&i.to_string(), standing)).collect();
    for (models, place, word) in [
        (json!(many), "beside.models", "at most 8"),
        (json!([copy("a b", standing)]), "beside.models[0].session", "1 to 60"),
        (json!([copy("a", standing), copy("a", standing)]), "beside.models[1].session", "two"),
        (json!([copy("a", [0.0; 4])]), "beside.models[0].quaternion", "quaternion"),
        (json!([{"session": "a"}]), "beside.models[0]", "position"),
    ] {
        let complaint = driver.complaint(&beside(models));
        let message = complaint["message"].as_str().unwrap();
        assert!(complaint["place"] == place && message.contains(word), "{complaint}");
    }
    driver.say(&beside(json!([])));
    observer.until(|m| m["type"] == "scene" && m["beside"] == json!([]));
}

#[test]
fn who_comes_where_nobody_drives_drives() {
    let server = Server::new(&["panda"]);
    let mut watching = server.client_of("?session=demo&observe");
    told(&mut watching, "nobody", 1);
    let mut driver = server.client_of("?session=demo");
    told(&mut driver, "you", 2);
    told(&mut watching, "another", 2);
    drop(driver);
    told(&mut watching, "nobody", 1);
    told(&mut server.client_of("?session=demo"), "you", 2);
}

#[test]
fn a_session_lasts_as_long_as_somebody_is_in_it() {
    let server = Server::new(&["panda"]);
    let mut first = server.client_of("?session=demo");
    first.done(joint(0.25));
    let mut second = server.client_of("?session=demo");
    // It is in the session before the first one leaves.
    told(&mut second, "another", 2);
    drop(first);
    told(&mut second, "nobody", 1);
    assert_eq!(server.client_of("?session=demo").next("state")["q"][0], 0.25);
    told(&mut second, "nobody", 1);
    drop(second);
    // The server learns of it when it reads: until then the old session may be found.
    let begin = std::time::Instant::now();
    while server.client_of("?session=demo").next("state")["q"][0] == 0.25 {
        assert!(begin.elapsed() < super::WAIT, "the session did not end");
    }
}

#[test]
fn a_client_alone_always_drives() {
    let server = Server::new(&["panda"]);
    let mut client = server.client();
    client.say(&json!({"type": "drive", "on": false}));
    assert_eq!(client.done(joint(0.25))["q"][0], 0.25);
}

#[test]
fn sessions_have_plain_names() {
    let server = Server::new(&["panda"]);
    for name in ["", "a%20b", "a/b"] {
        let request = format!(
            "GET /ws?session={name} HTTP/1.1\r\nHost: {}\r\nUpgrade: websocket\r\n\
             Connection: upgrade\r\nSec-WebSocket-Version: 13\r\n\
             Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==",
            server.address()
        );
        let (status, answer) = server.ask(&request);
        assert_eq!(status, 400, "{answer}");
        assert!(answer.contains("1 to 60"), "{answer}");
    }
}
