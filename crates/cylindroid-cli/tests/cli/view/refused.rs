//! What a client may not say, and that the session goes on.

use serde_json::json;
use tungstenite::client::IntoClientRequest;
use tungstenite::{Message, client};

use super::{Server, WAIT};
use std::net::TcpStream;

#[test]
fn a_malformed_message_is_answered_and_the_session_goes_on() {
    let server = Server::new(&["panda"]);
    let mut client = server.client();
    client.next("scene");
    let home = client.next("state")["q"].clone();
    for message in [
        "",
        "{",
        "null",
        " ",
        "[1, 2]",
        "\"play\"",
        "{\"type\": \"jump\"}",
        "{\"type\": [\"play\"]}",
        "{\"type\": \"play\", \"type2\": 1}",
        "{\"type\": \"joint\", \"name\": \"panda_joint1\"}",
        "{\"type\": \"joint\", \"name\": \"panda_joint1\", \"value\": NaN}",
        "{\"type\": \"joint\", \"name\": \"panda_joint1\", \"value\": \"1\"}",
        "{\"type\": \"joint\", \"name\": \"panda_joint9\", \"value\": 1}",
        "{\"type\": \"joint\", \"name\": 1, \"value\": 1}",
        "{\"type\": \"configuration\", \"q\": [0]}",
        "{\"type\": \"configuration\", \"q\": [0, 0, 0, 9, 0, 0, 0]}",
        "{\"type\": \"configuration\", \"q\": {\"a\": 1}}",
        "{\"type\": \"target\", \"position\": [0, 0], \"quaternion\": [1, 0, 0, 0]}",
        "{\"type\": \"target\", \"position\": [0, 0, 1e999], \"quaternion\": [1, 0, 0, 0]}",
        "{\"type\": \"target\", \"position\": [0, 0, 0], \"quaternion\": [0, 0, 0, 0]}",
        "{\"type\": \"null_space\", \"rate\": 0.1, \"index\": -1}",
        "{\"type\": \"null_space\", \"rate\": 0.1, \"index\": 5}",
        "{\"type\": \"compare\", \"methods\": [\"damped\"], \"point\": [0, 0, 0]}",
        "{\"type\": \"seen\", \"seq\": -1}",
        "{\"type\": \"play\", \"id\": [1]}",
        "{\"type\": \"play\", \"type\": \"pause\"}",
    ] {
        client.text(message);
        let complaint = client.next("error");
        for key in ["culprit", "place", "message"] {
            assert!(complaint[key].is_string(), "{message}: {complaint}");
        }
        assert!(!complaint["message"].as_str().unwrap().contains("panicked"), "{complaint}");
        for key in ["culprit", "place"] {
            let text = complaint[key].as_str().unwrap().trim();
            assert!(!text.is_empty(), "{message}: {complaint}");
        }
    }
    client.socket.send(Message::binary(vec![0_u8, 159, 146, 150])).unwrap();
    assert_eq!(client.next("error")["culprit"], "binary");
    assert_eq!(client.done(json!({"type": "pause"}))["q"], home);
}

#[test]
fn numbers_at_the_edge_end_no_session() {
    let server = Server::new(&["panda"]);
    let mut client = server.client();
    client.next("scene");
    for value in [1e150, -1e300, 1e-320] {
        client.say(
            &json!({"type": "target", "position": [value, 0, 0], "quaternion": [1, 0, 0, 1e-160]}),
        );
        client.say(&json!({"type": "compare", "methods": ["damped", "truncated"], "point": [value, value, 0]}));
        client.until(|m| m["type"] == "error" || m["type"] == "compare");
        client.say(&json!({"type": "joint", "name": "panda_joint1", "value": value}));
        client.done(json!({"type": "overlays", "names": ["velocity-ellipsoid", "lost-direction"]}));
    }
    assert_eq!(client.done(json!({"type": "reset"}))["servo"]["status"], "reached");
}

#[test]
fn a_message_too_long_is_refused_and_a_huge_one_ends_its_connection_alone() {
    let server = Server::new(&["panda"]);
    let (mut one, mut other) = (server.client(), server.client());
    other.next("scene");
    let frame = |n: usize| json!({"type": "frame", "name": "x".repeat(n)});
    assert_eq!(other.complaint(&frame(64 * 1024 - 60))["place"], "frame.name");
    let long = other.complaint(&frame(70_000));
    assert_eq!(
        (&long["place"], &long["way_out"]),
        (&"message".into(), &"send a shorter message".into())
    );
    one.next("scene");
    // The server may hang up before all of it is sent.
    let _ = one.socket.send(Message::text(frame(3 << 20).to_string()));
    while one.socket.read().is_ok() {}
    other.done(json!({"type": "pause"}));
}

#[test]
fn foreign_pages_and_names_are_refused() {
    let server = Server::new(&["panda"]);
    let own = server.address();
    for path in ["/", "/ws", "/mesh/0/a.stl"] {
        for headers in [
            "Host: evil.example".to_owned(),
            format!("Host: evil.example:{}", server.port),
            format!("Host: {own}\r\nOrigin: http://evil.example"),
            format!("Host: {own}\r\nOrigin: null"),
            format!("Host: {own}\r\nOrigin: http://127.0.0.1:{}", server.port.wrapping_add(1)),
        ] {
            let (status, answer) = server.ask(&format!("GET {path} HTTP/1.1\r\n{headers}"));
            assert_eq!(status, 403, "{path} {headers}: {answer}");
        }
    }
    let connect = |origin: &str, host: &str| {
        let mut request = format!("ws://{own}/ws").into_client_request().unwrap();
        request.headers_mut().insert("origin", origin.parse().unwrap());
        request.headers_mut().insert("host", host.parse().unwrap());
        let stream = TcpStream::connect(&own).unwrap();
        stream.set_read_timeout(Some(WAIT)).unwrap();
        client(request, stream).is_ok()
    };
    assert!(connect(&format!("http://{own}"), &own));
    let localhost = format!("localhost:{}", server.port);
    assert!(connect(&format!("http://{localhost}"), &localhost));
    assert!(!connect("http://evil.example", &own));
    assert!(!connect(&format!("http://{own}"), &format!("evil.example:{}", server.port)));
}
