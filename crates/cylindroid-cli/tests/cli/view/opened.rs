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
    let mut stream = TcpStream::connect(server.address()).unwrap();
    stream.set_read_timeout(Some(WAIT)).unwrap();
    let (host, length) = (server.address(), body.len());
    let head = format!("Host: {host}\r\nContent-Length: {length}\r\nConnection: close\r\n\r\n");
    stream.write_all(format!("POST /models HTTP/1.1\r\n{head}").as_bytes()).unwrap();
    stream.write_all(&body).unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    let status = answer.split(' ').nth(1).unwrap().parse().unwrap();
    let (_, body) = answer.split_once("\r\n\r\n").unwrap();
    (status, serde_json::from_str(body).unwrap_or_else(|_| json!(body)))
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
    assert_eq!((status, known), (200, json!({"id": "1", "name": "crane"})));
    let (status, known) = post(&server, &json!({"open": "five-bar"}), &[]);
    assert_eq!((status, &known["name"]), (200, &json!("five-bar")));
    let (_, list) = server.get("/models");
    let (_, list) = list.split_once("\r\n\r\n").unwrap();
    let list: Value = serde_json::from_str(list).unwrap();
    assert_eq!((&list["name"], &list["opens"]), (&json!("panda"), &json!(true)));
    assert_eq!(list["opened"][1], json!({"id": "2", "name": "five-bar"}));
    assert!(list["catalogue"].as_array().unwrap().iter().any(|m| m["name"] == "stewart"));

    let mut crane = server.client_of("?model=1");
    let scene = crane.next("scene");
    assert_eq!(scene["name"], "crane");
    let url = scene["links"][1]["visuals"][0]["url"].as_str().unwrap();
    assert!(url.starts_with("/models/1/mesh/"), "{url}");
    let (status, text) = server.get(url);
    assert!(status == 200 && text.ends_with("endsolid a\n"), "{text}");
    assert_eq!(server.get(&url.replace("/1/", "/2/")).0, 404);
    assert_eq!(server.get(&url.replace("m/a.stl", "../crane/urdf/crane.urdf")).0, 404);
    assert_eq!(server.client_of("?model=2").next("scene")["name"], "five-bar");
    assert_eq!(server.client().next("scene")["name"], "panda");
    let gone = server.client_of("?model=9").next("error");
    assert!(gone["message"].as_str().unwrap().contains("model 9 is not open"), "{gone}");
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
    assert_eq!(open().0, 200);
    let mut kept = server.client_of("?model=1");
    kept.next("scene");
    for _ in 0..16 {
        assert_eq!(open().0, 200);
    }
    let list = server.get("/models").1;
    assert!(list.contains("{\"id\":\"1\"") && !list.contains("{\"id\":\"2\""), "{list}");
    let public = Server::new(&["panda", "--host", "0.0.0.0"]);
    let (status, why) = post(&public, &json!({"open": "3r"}), &[]);
    assert_eq!(status, 403, "{why}");
    assert!(public.get("/models").1.contains("\"opens\":false"));
}
