//! Models whose files change while they are shown.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};
use tempfile::TempDir;

use super::{Client, Server};

/// Two links in the plane of x and z with a length each, and a mesh.
fn arm(upper: f64, joints: [&str; 2]) -> String {
    let [a, b] = joints;
    let limits = "<limit lower=\"-1\" upper=\"1\" velocity=\"1\" effort=\"1\"/>";
    let joint = |name: &str, parent: &str, child: &str, z: f64| {
        format!(
            "  <joint name=\"{name}\" type=\"revolute\"><parent link=\"{parent}\"/><child \
             link=\"{child}\"/><origin xyz=\"0 0 {z}\"/><axis xyz=\"0 1 0\"/>{limits}</joint>\n"
        )
    };
    format!(
        "<robot name=\"arm\">\n  <link name=\"base\"/>\n  <link name=\"upper\"><visual><geometry><mesh \
         filename=\"a.stl\"/></geometry></visual></link>\n  <link name=\"lower\"/>\n{}{}</robot>\n",
        joint(a, "base", "upper", 0.0),
        joint(b, "upper", "lower", upper),
    )
}

const MESH: &str = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 \
                    0\nendloop\nendfacet\nendsolid a\n";

fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("arm.urdf"), arm(0.5, ["a", "b"])).unwrap();
    fs::write(folder.path().join("a.stl"), MESH).unwrap();
    folder
}

fn served(path: &Path, more: &[&str]) -> Server {
    let mut arguments = vec![path.to_str().unwrap()];
    arguments.extend_from_slice(more);
    Server::new(&arguments)
}

fn joint(name: &str, value: f64) -> Value {
    json!({"type": "joint", "name": name, "value": value})
}

/// The message after the model has been loaded again, and the scene that follows.
fn reloaded(client: &mut Client, reloads: u64) -> Value {
    client.until(|m| m["type"] == "model" && m["reloads"] == reloads && m["problem"].is_null());
    client.next("scene")
}

#[test]
fn a_changed_file_is_shown_with_joints_and_choices_where_they_were() {
    let folder = folder();
    let path = folder.path().join("arm.urdf");
    let server = served(&path, &[]);
    let mut client = server.client();
    assert_eq!(client.hear()["type"], "scene");
    let mut other = server.client_of("?session=demo");
    other.done(joint("b", 0.75));
    client.done(json!({"type": "frame", "name": "upper"}));
    client.done(json!({"type": "task", "name": "position"}));
    client.done(json!({"type": "method", "name": "damped", "parameters": {"damping": 0.25}}));
    client.done(json!({"type": "add_obstacle", "name": "ball", "shape": {"kind": "sphere", "radius": 0.1}, "position": [0, 1, 0]}));
    client.done(json!({"type": "beside", "models": [{"session": "other", "position": [0, 1, 0], "quaternion": [1, 0, 0, 0], "transparent": false}]}));
    client.done(json!({"type": "overlays", "names": ["joint-axes"]}));
    client.done(joint("a", -0.25));
    client.done(joint("b", 0.5));

    fs::write(&path, arm(0.75, ["a", "b"])).unwrap();
    let scene = reloaded(&mut client, 1);
    assert_eq!(scene["joints"][1]["origin"]["position"], json!([0.0, 0.0, 0.75]));
    assert_eq!((&scene["frame"], &scene["task"]["name"]), (&json!("upper"), &json!("position")));
    assert_eq!(scene["method"]["parameters"], json!({"damping": 0.25}));
    assert_eq!(scene["obstacles"][0]["name"], "ball");
    assert_eq!(scene["beside"][0]["session"], "other");
    let state = client.next("state");
    assert_eq!(state["q"], json!([-0.25, 0.5]));
    assert_eq!(state["target"], state["tool"]);
    assert!(state["overlays"]["joint-axes"].is_object());
    reloaded(&mut other, 1);
    assert_eq!(other.next("state")["q"], json!([0.0, 0.75]));

    // A joint of another name begins at home, and a value outside of new limits is not kept.
    let narrow = arm(0.75, ["a", "c"]).replacen("lower=\"-1\"", "lower=\"-0.125\"", 1);
    fs::write(&path, narrow).unwrap();
    let scene = reloaded(&mut client, 2);
    assert_eq!(scene["coordinates"][1]["name"], "c");
    assert_eq!(client.next("state")["q"], json!([0.0, 0.0]));
    // Who comes later is told as well, and has the new model.
    let mut later = server.client();
    assert_eq!(later.hear(), json!({"type": "model", "reloads": 2, "problem": null}));
    assert_eq!(later.hear()["coordinates"][1]["name"], "c");
}

#[test]
fn a_broken_file_is_told_with_its_line_beside_the_old_model() {
    let folder = folder();
    let path = folder.path().join("arm.urdf");
    let server = served(&path, &[]);
    let mut client = server.client();
    client.done(joint("a", 0.25));
    let broken = arm(0.5, ["a", "b"]).replace("<child link=\"lower\"", "<child link=\"lover\"");
    fs::write(&path, broken).unwrap();
    let told = client.next("model");
    let problem = &told["problem"];
    assert_eq!((&told["reloads"], &problem["file"]), (&json!(0), &json!("arm.urdf")));
    assert_eq!(problem["line"], 6);
    assert!(problem["message"].as_str().unwrap().contains("lover"), "{told}");
    assert!(problem["text"].as_str().unwrap().starts_with("<joint name=\"b\""), "{told}");
    // The old model goes on, for clients to come as well.
    assert_eq!(client.done(joint("b", 0.5))["q"], json!([0.25, 0.5]));
    let mut later = server.client();
    assert_eq!(later.hear(), told);
    assert_eq!(later.hear()["links"].as_array().unwrap().len(), 3);

    fs::write(&path, arm(1.0, ["a", "b"])).unwrap();
    let scene = reloaded(&mut client, 1);
    assert_eq!(scene["joints"][1]["origin"]["position"][2], 1.0);
    assert_eq!(client.next("state")["q"], json!([0.25, 0.5]));
}

#[test]
fn meshes_and_included_files_are_watched() {
    let folder = folder();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("cell.toml", "[[robot]]\nmodel = \"arm.urdf\"\n");
    let server = served(&folder.path().join("cell.toml"), &["--token"]);
    let mut client = server.client();
    let url = |scene: &Value| -> String {
        let links = scene["links"].as_array().unwrap();
        let mut urls = links.iter().flat_map(|l| l["visuals"].as_array().unwrap());
        urls.next().unwrap()["url"].as_str().unwrap().to_owned()
    };
    let first = url(&client.next("scene"));
    assert!(server.get(&first).1.ends_with(MESH), "{first}");
    let larger = MESH.replace("1 0 0", "2.5 0 0");
    write("a.stl", &larger);
    let second = url(&reloaded(&mut client, 1));
    assert!(second.starts_with(&format!("{first}?changed=")), "{second}");
    assert!(server.get(&second).1.ends_with(&larger));
    write("arm.urdf", &arm(0.75, ["a", "b"]));
    let scene = reloaded(&mut client, 2);
    assert_eq!(url(&scene), second);
    write("cell.toml", "[[robot]]\nmodel = \"three.urdf\"\n");
    let told = client.until(|m| !m["problem"].is_null() && m["type"] == "model");
    assert_eq!(told["problem"]["line"], 2, "{told}");
    // A file that is wanted and not there yet is watched, too.
    write("three.urdf", &arm(0.5, ["c", "d"]));
    let scene = reloaded(&mut client, 3);
    assert_eq!(scene["coordinates"][1]["name"], "d");
}

/// The session of a closed chain keeps its actuated joints and closes its loops.
#[test]
fn loops_are_closed_in_the_new_model() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("five.toml");
    let text = include_str!("../../../../cylindroid/src/model/catalogue/five-bar.toml");
    fs::write(&path, text).unwrap();
    let server = served(&path, &[]);
    let mut client = server.client();
    client.done(json!({"type": "actuated", "names": ["q2", "q4"]}));
    let before = client.done(joint("q2", 0.125));
    fs::write(&path, format!("{text}\n# another version\n")).unwrap();
    let scene = reloaded(&mut client, 1);
    let actuated = scene["actuators"].as_array().unwrap().iter();
    let actuated: Vec<&Value> =
        actuated.filter(|a| a["actuated"] == true).map(|a| &a["name"]).collect();
    assert_eq!(actuated, ["q2", "q4"]);
    let after = client.next("state");
    let (before, after_q) = (crate::numbers(&before["q"]), crate::numbers(&after["q"]));
    for (old, new) in before.iter().zip(&after_q) {
        assert!((old - new).abs() < 1e-9, "{before:?} {after_q:?}");
    }
    assert_eq!(after["closure_error"]["closed"], true);
}

#[test]
fn nothing_is_watched_without_a_wish() {
    let folder = folder();
    let path = folder.path().join("arm.urdf");
    let server = served(&path, &["--no-watch"]);
    let watched = served(&path, &[]);
    fs::write(&path, arm(0.75, ["a", "b"])).unwrap();
    reloaded(&mut watched.client(), 1);
    assert_eq!(server.client().hear()["type"], "scene");
}
