//! Models that clients open.

use std::io::{Read, Write};
use std::net::TcpStream;

use serde_json::{Value, json};

use super::{Server, WAIT};

/// Status and JSON of the answer to a request that opens a model.
fn post(server: &Server, head: &Value, files: &[&[u8]]) -> (u16, Value) {
    let mut body = head.to_string().into_bytes();
    body.push(b'\n');
    files.iter().for_each(|file| body.extend_from_slice(file));
    send(server, &body)
}

fn send(server: &Server, body: &[u8]) -> (u16, Value) {
    let mut stream = TcpStream::connect(server.address()).unwrap();
    stream.set_read_timeout(Some(WAIT)).unwrap();
    let (host, length) = (server.address(), body.len());
    let head = format!("Host: {host}\r\nContent-Length: {length}\r\nConnection: close\r\n\r\n");
    stream.write_all(format!("POST /models HTTP/1.1\r\n{head}").as_bytes()).unwrap();
    stream.write_all(body).unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    let status = answer.split(' ').nth(1).unwrap().parse().unwrap();
    let (_, body) = answer.split_once("\r\n\r\n").unwrap();
    (status, serde_json::from_str(body).unwrap_or_else(|_| json!(body)))
}

/// The id of a model that was opened.
fn id(known: &Value) -> String {
    let id = known["id"].as_str().unwrap();
    assert!(id.len() == 16 && id.chars().all(|c| c.is_ascii_hexdigit()), "{known}");
    id.to_owned()
}

/// The body of an answer.
fn content((status, answer): (u16, String)) -> String {
    assert_eq!(status, 200, "{answer}");
    answer.split_once("\r\n\r\n").unwrap().1.to_owned()
}

/// The models of a server.
fn list(server: &Server) -> Value {
    serde_json::from_str(&content(server.get("/models"))).unwrap()
}

const URDF: &str = "<robot name=\"crane\">
  <link name=\"base\"/>
  <link name=\"arm\"><visual><geometry><mesh filename=\"package://crane/m/a.stl\"/></geometry></visual></link>
  <joint name=\"lift\" type=\"revolute\"><parent link=\"base\"/><child link=\"arm\"/>
    <limit lower=\"-1\" upper=\"1\" velocity=\"1\" effort=\"1\"/></joint>
</robot>
";

#[test]
fn models_are_opened_with_their_files_and_have_sessions() {
    let server = Server::new(&["panda"]);
    let (mesh, package) = (b"solid a\nendsolid a\n", b"<package/>");
    let files = json!([
        ["crane/urdf/crane.urdf", URDF.len()],
        ["crane/m/a.stl", mesh.len()],
        ["crane/package.xml", package.len()]
    ]);
    let head = json!({"open": "crane/urdf/crane.urdf", "files": files});
    let (status, known) = post(&server, &head, &[URDF.as_bytes(), mesh, package]);
    assert_eq!((status, &known["name"]), (200, &json!("crane")));
    let crane_id = id(&known);
    let (status, known) = post(&server, &json!({"open": "five-bar"}), &[]);
    assert_eq!((status, &known["name"]), (200, &json!("five-bar")));
    let other = id(&known);
    assert_ne!(crane_id, other);
    let list = list(&server);
    assert_eq!((&list["name"], &list["opens"]), (&json!("panda"), &json!(true)));
    assert_eq!(list["opened"][1], known);
    assert!(list["catalogue"].as_array().unwrap().iter().any(|m| m["name"] == "stewart"));

    let mut crane = server.client_of(&format!("?model={crane_id}"));
    let scene = crane.next("scene");
    assert_eq!(scene["name"], "crane");
    let url = scene["links"][1]["visuals"][0]["url"].as_str().unwrap();
    assert!(url.starts_with(&format!("/models/{crane_id}/mesh/")), "{url}");
    let (status, text) = server.get(url);
    assert!(status == 200 && text.ends_with("endsolid a\n"), "{text}");
    assert_eq!(server.get(&url.replace(&crane_id, &other)).0, 404);
    assert_eq!(server.get(&url.replace("m/a.stl", "../crane/urdf/crane.urdf")).0, 404);
    let scene = server.client_of(&format!("?model={other}")).next("scene");
    assert_eq!(scene["name"], "five-bar");
    assert_eq!(server.client().next("scene")["name"], "panda");
    let gone = server.client_of("?model=9").next("error");
    assert!(gone["message"].as_str().unwrap().contains("model 9 is not open"), "{gone}");
}

/// A page keeps the request that opened a model, and a server that was restarted takes it.
#[test]
fn a_model_is_opened_again_under_its_id() {
    let first = Server::new(&["panda"]);
    let (mesh, package) = (b"solid a\nendsolid a\n", b"<package/>");
    let files = json!([
        ["crane/urdf/crane.urdf", URDF.len()],
        ["crane/m/a.stl", mesh.len()],
        ["crane/package.xml", package.len()]
    ]);
    let head = json!({"open": "crane/urdf/crane.urdf", "files": files});
    let (_, known) = post(&first, &head, &[URDF.as_bytes(), mesh, package]);
    let crane = id(&known);
    let five_bar = id(&post(&first, &json!({"open": "five-bar"}), &[]).1);
    let request = |id: &str| content(first.get(&format!("/models/{id}")));
    let (crane_request, five_bar_request) = (request(&crane), request(&five_bar));
    assert_eq!(first.get("/models/0123456789abcdef").0, 404);
    // It is open.
    assert_eq!(send(&first, crane_request.as_bytes()), (200, known.clone()));
    assert_eq!(list(&first)["opened"].as_array().unwrap().len(), 2);

    let second = Server::new(&["panda"]);
    let query = format!("?model={crane}");
    let gone = second.client_of(&query).next("error");
    assert_eq!((&gone["place"], &gone["culprit"]), (&json!("model"), &known["id"]));
    // Of other models that were opened meanwhile none has its place.
    assert_eq!(post(&second, &json!({"open": "3r"}), &[]).0, 200);
    assert_eq!(send(&second, crane_request.as_bytes()), (200, known));
    let scene = second.client_of(&query).next("scene");
    assert_eq!(scene["name"], "crane");
    let url = scene["links"][1]["visuals"][0]["url"].as_str().unwrap();
    assert!(second.get(url).1.ends_with("endsolid a\n"));
    assert_eq!(id(&send(&second, five_bar_request.as_bytes()).1), five_bar);
    for id in ["", "1", "../../../../abc", "0123456789abcdeg", "0123456789abcdef0"] {
        let (status, told) = post(&second, &json!({"open": "3r", "id": id}), &[]);
        assert_eq!(status, 422, "{id}");
        assert!(told["message"].as_str().unwrap().contains("16 digits"), "{id}: {told}");
    }
}

#[test]
fn what_is_wrong_with_a_model_is_told_with_its_place() {
    let server = Server::new(&["panda"]);
    let refused = |head: Value, files: &[&[u8]]| {
        let (status, refusal) = post(&server, &head, files);
        assert_eq!(status, 422, "{refusal}");
        refusal
    };
    let broken = URDF.replace("child link=\"arm\"", "child link=\"leg\"");
    let head = json!({"open": "a/b.urdf", "files": [["a/b.urdf", broken.len()]]});
    let told = refused(head, &[broken.as_bytes()]);
    assert_eq!((&told["file"], &told["line"]), (&json!("a/b.urdf"), &json!(4)));
    assert!(told["message"].as_str().unwrap().contains("leg"), "{told}");
    assert!(told["text"].as_str().unwrap().starts_with("<joint name"), "{told}");
    for (name, part) in [
        ("../a.urdf", "not a path"),
        ("/tmp/a.urdf", "not a path"),
        ("a/.b/a.urdf", "not a path"),
        ("a\\a.urdf", "not a path"),
        ("", "not a path"),
        ("a.xacro", "none of the model files"),
        ("a.sh", "none of the model files"),
    ] {
        let told = refused(json!({"open": name, "files": [[name, 1]]}), &[b"x"]);
        assert!(told["message"].as_str().unwrap().contains(part), "{name}: {told}");
    }
    for (one, other) in
        [("a.urdf", "a.urdf"), ("a/./b.urdf", "a/b.urdf"), ("a/b.urdf", "a//b.urdf")]
    {
        let head = json!({"open": one, "files": [[one, 1], [other, 1]]});
        let told = refused(head, &[b"x", b"y"]);
        assert!(told["message"].as_str().unwrap().contains("twice"), "{other}: {told}");
    }
    for other in ["a.urdf/b.urdf", "a.urdf//b/c.urdf"] {
        let head = json!({"open": "a.urdf", "files": [[other, 1], ["a.urdf", 1]]});
        let told = refused(head, &[b"x", b"y"]);
        assert!(told["message"].as_str().unwrap().contains("'a.urdf', which is a file"), "{told}");
    }
    for (name, count) in [("x".repeat(5000), "5000"), (format!("a/{}", "x".repeat(256)), "256")] {
        let told =
            refused(json!({"open": "a.urdf", "files": [["a.urdf", 1], [name, 1]]}), &[b"xy"]);
        let message = told["message"].as_str().unwrap();
        assert!(message.contains(count) && message.len() < 120, "{told}");
        assert!(told["help"].as_str().unwrap().contains("at most 900"), "{told}");
    }
    let short = refused(json!({"open": "a.urdf", "files": [["a.urdf", 9]]}), &[b"x"]);
    assert!(short["message"].as_str().unwrap().contains("fewer bytes"), "{short}");
    let long = refused(json!({"open": "a.urdf", "files": [["a.urdf", 0]]}), &[b"x"]);
    assert!(long["message"].as_str().unwrap().contains("belong to no file"), "{long}");
    let many: Vec<Value> = (0..2001).map(|i| json!([format!("{i}.urdf"), 0])).collect();
    let many = refused(json!({"open": "1.urdf", "files": many}), &[]);
    assert!(many["message"].as_str().unwrap().contains("2001 files"), "{many}");
    let unknown = refused(json!({"open": "pandda"}), &[]);
    assert!(unknown["message"].as_str().unwrap().contains("panda"), "{unknown}");
    let path = refused(json!({"open": "/etc/passwd"}), &[]);
    assert!(path["message"].as_str().unwrap().contains("no model"), "{path}");
    refused(json!({"opens": "panda"}), &[]);
    refused(json!(7), &[]);
    assert!(server.get("/models").1.contains("\"opened\":[]"));
}

/// Those without sessions make room; a server that others reach opens none.
#[test]
fn few_models_are_open_and_only_of_this_machine() {
    let server = Server::new(&["panda"]);
    let open = || post(&server, &json!({"open": "3r"}), &[]);
    let first = id(&open().1);
    let mut kept = server.client_of(&format!("?model={first}"));
    kept.next("scene");
    let second = id(&open().1);
    for _ in 0..15 {
        assert_eq!(open().0, 200);
    }
    let list = content(server.get("/models"));
    assert!(list.contains(&first) && !list.contains(&second), "{list}");
    let public = Server::new(&["panda", "--host", "0.0.0.0"]);
    let (status, why) = post(&public, &json!({"open": "3r"}), &[]);
    assert_eq!(status, 403, "{why}");
    // Before the files come, which never do.
    let host = public.address();
    let head = format!("POST /models HTTP/1.1\r\nHost: {host}\r\nContent-Length: 269484032");
    assert_eq!(public.ask(&head).0, 403);
    assert!(public.get("/models").1.contains("\"opens\":false"));
}
