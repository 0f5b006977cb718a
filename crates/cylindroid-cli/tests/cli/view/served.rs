//! URLs, pages and meshes.

use std::fs;

use serde_json::json;

use super::Server;
use crate::{cylindroid, json as printed, refused, text};

#[test]
fn it_prints_one_line_and_can_stop_there() {
    let line = text(&["view", "panda", "--check"]);
    assert!(line.starts_with("http://127.0.0.1:") && line.ends_with("/\n"), "{line}");
    assert_eq!(line.lines().count(), 1);
    let object = printed(&["view", "five-bar", "--check", "--actuated", "q1,q5"], 0);
    assert_eq!(object["model"], "five-bar");
    assert!(object["page"].is_boolean() && object["url"].as_str().unwrap().starts_with("http://"));
    let server = Server::new(&["panda"]);
    let port = server.port.to_string();
    assert!(refused(&["view", "panda", "--port", &port]).contains("--port"));
    assert!(refused(&["view", "panda", "--open", "--check"]).contains("--open"));
    assert!(refused(&["view", "pnda"]).contains("panda"));
    assert!(refused(&["view", "panda", "--actuated", "panda_joint1"]).contains("no loops"));
    assert!(refused(&["view", "panda", "--q", "0,0,0,9,0,0,0"]).contains("limits"));
    assert!(refused(&["view", "panda", "--meshes", "no such folder"]).contains("no such folder"));
    assert_eq!(cylindroid(&["view", "panda", "--port", "70000"]).status.code(), Some(2));
}

/// The port is the usual one for the first, unless another program has it, and a free one for the
/// next.
#[test]
fn the_usual_port_or_a_free_one() {
    let is_free = std::net::TcpListener::bind("127.0.0.1:7411").is_ok();
    let servers = [(); 2].map(|()| Server::new_at_usual_port(&["five-bar"]));
    assert!(servers[0].port == 7411 || !is_free, "{}", servers[0].port);
    assert_ne!(servers[0].port, servers[1].port);
    for server in &servers {
        assert_eq!(server.get("/").0, 200);
    }
}

/// Nothing is served outside of the path that only the printed URL contains.
#[test]
fn a_token_hides_the_server() {
    let urls = [(); 2].map(|()| text(&["view", "five-bar", "--check", "--token", "--port", "0"]));
    let tokens = urls.each_ref().map(|url| url.trim().split('/').nth(3).unwrap().to_owned());
    assert!(tokens.iter().all(|token| token.len() == 32) && tokens[0] != tokens[1], "{tokens:?}");
    let server = Server::new(&["five-bar", "--token"]);
    assert_eq!(server.get("/").0, 404);
    let path = format!("/{}/", server.token);
    assert_eq!(server.get(&path).0, 200);
}

/// A server that others reach says so, with the address that they open; one that they do not is silent.
#[test]
fn a_server_for_others_warns() {
    let warning = |host: &str| {
        let output = cylindroid(&["view", "five-bar", "--check", "--port", "0", "--host", host]);
        assert!(output.status.success());
        String::from_utf8(output.stderr).unwrap()
    };
    let text = warning("0.0.0.0");
    assert!(text.contains("note: everyone who reaches this machine can open http://"), "{text}");
    assert!(!warning("127.0.0.1").contains("everyone"));
}

/// `--open` runs the browser of the environment on the URL.
#[cfg(target_os = "linux")]
#[test]
fn it_opens_the_browser() {
    use std::os::unix::fs::PermissionsExt;

    let folder = tempfile::tempdir().unwrap();
    let (browser, seen) = (folder.path().join("browser"), folder.path().join("seen"));
    fs::write(&browser, format!("#!/bin/sh\nprintf %s \"$1\" > {}\n", seen.display())).unwrap();
    fs::set_permissions(&browser, fs::Permissions::from_mode(0o755)).unwrap();
    let server = Server::with_browser(&["five-bar", "--open", "--token"], &browser);
    let url = format!("http://127.0.0.1:{}/{}/", server.port, server.token);
    let begin = std::time::Instant::now();
    while fs::read_to_string(&seen).unwrap_or_default() != url {
        assert!(begin.elapsed().as_secs() < 60, "{:?} is not {url}", fs::read_to_string(&seen));
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
}

#[test]
fn answers_carry_the_security_headers() {
    let server = Server::new(&["panda"]);
    for path in ["/", "/no/such/page", "/mesh/0/x.stl"] {
        let (_, answer) = server.get(path);
        let head = answer.to_ascii_lowercase();
        for header in [
            "x-content-type-options: nosniff",
            "content-security-policy: default-src 'self'",
            "frame-ancestors 'none'",
            "x-frame-options: deny",
            "cross-origin-resource-policy: same-origin",
        ] {
            assert!(head.contains(header), "{path}: {answer}");
        }
        assert!(!head.contains("access-control-allow-origin"));
        assert!(!head.contains("unsafe-"), "{path}: {answer}");
    }
    assert_eq!(server.ask(&format!("POST / HTTP/1.1\r\nHost: {}", server.address())).0, 405);
    assert_eq!(server.get("/no/such/page").0, 404);
    assert_eq!(server.get("/../Cargo.toml").0, 404);
}

/// Loops may close only where a file has a joint beyond its limits: it is shown there, as `fk` and
/// `mobility` take it, and says so when a joint is to move.
#[test]
fn a_home_beyond_its_limits_is_shown() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("bar.toml");
    fs::write(&file, BAR).unwrap();
    let server = Server::new(&[file.to_str().unwrap()]);
    let mut client = server.client();
    assert_eq!(client.next("state")["q"], json!([0.0, 0.0, 0.0]));
    client.say(&json!({"type": "joint", "name": "q1", "value": 0.1}));
    let error = client.next("error");
    assert!(error["message"].as_str().unwrap().contains("q2"), "{error}");
    // Requests are clamped to the limits.
    assert!(refused(&["view", file.to_str().unwrap(), "--q", "0.1,0,0"]).contains("q2"));
}

/// A parallelogram whose second joint is beyond its limits at zero.
const BAR: &str = r#"name = "bar"
dimension = 2
joint = [
  { name = "q1", type = "revolute", between = ["ground", "crank"], origin = [0, 0], actuated = true },
  { name = "q2", type = "revolute", between = ["crank", "coupler"], origin = [0.3, 1], limits = { lower = 0.5, upper = 2 } },
  { name = "q3", type = "revolute", between = ["coupler", "rocker"], origin = [2.3, 1] },
  { name = "q4", type = "revolute", between = ["rocker", "ground"], origin = [2, 0] },
]
"#;

const ARM: &str = r#"<robot name="arm">
  <link name="base"><visual><geometry><mesh filename="meshes/base.stl" scale="0.5 0.5 0.5"/></geometry></visual></link>
  <link name="arm"><visual><geometry><mesh filename="package://arm/meshes/arm.obj"/></geometry></visual></link>
  <link name="hand"><visual><geometry><mesh filename="../outside.stl"/></geometry></visual></link>
  <link name="tip"><visual><geometry><mesh filename="meshes/none.stl"/></geometry></visual></link>
  <joint name="a" type="continuous"><parent link="base"/><child link="arm"/></joint>
  <joint name="b" type="continuous"><parent link="arm"/><child link="hand"/></joint>
  <joint name="c" type="continuous"><parent link="hand"/><child link="tip"/></joint>
</robot>"#;

/// Meshes and what belongs to them, and nothing that leads out.
#[test]
fn only_files_of_the_model_are_given_out() {
    let all = tempfile::tempdir().unwrap();
    let folder = all.path().join("arm");
    fs::create_dir_all(folder.join("meshes")).unwrap();
    let files = [
        ("arm/arm.urdf", ARM),
        ("arm/meshes/base.stl", "solid base"),
        ("arm/meshes/arm.obj", "mtllib arm.mtl"),
        ("arm/meshes/arm.mtl", "newmtl a"),
        ("arm/meshes/notes.txt", "secret"),
        ("outside.stl", "secret"),
    ];
    for (name, content) in files {
        fs::write(all.path().join(name), content).unwrap();
    }
    #[cfg(unix)]
    {
        use std::os::unix::fs::symlink;
        symlink(all.path().join("outside.stl"), folder.join("meshes/link.stl")).unwrap();
        symlink(all.path(), folder.join("up")).unwrap();
    }
    let model = folder.join("arm.urdf");
    let server = Server::new(&[model.to_str().unwrap()]);
    let scene = server.client().next("scene");
    let mesh = |link: usize| scene["links"][link]["visuals"][0].clone();
    assert_eq!((&mesh(0)["scale"], &mesh(0)["format"]), (&json!([0.5, 0.5, 0.5]), &json!("stl")));
    let url = mesh(0)["url"].as_str().unwrap().to_owned();
    let (status, answer) = server.get(&url);
    assert!(status == 200 && answer.ends_with("solid base"), "{answer}");
    let object = mesh(1)["url"].as_str().unwrap().to_owned();
    assert!(server.get(&object).1.ends_with("mtllib arm.mtl"));
    assert!(server.get(&object.replace("arm.obj", "arm.mtl")).1.ends_with("newmtl a"));
    for (link, word) in [(2, "--meshes"), (3, "not found")] {
        assert!(mesh(link)["url"].is_null());
        assert!(mesh(link)["problem"].as_str().unwrap().contains(word), "{}", mesh(link));
    }
    let root = url.strip_suffix("meshes/base.stl").unwrap();
    for path in [
        "../outside.stl",
        "%2e%2e/outside.stl",
        "%2E%2E%2Foutside.stl",
        "meshes/../../outside.stl",
        "meshes/%2e%2e/%2e%2e/outside.stl",
        "..%2foutside.stl",
        "..%5coutside.stl",
        "meshes/link.stl",
        "up/outside.stl",
        "meshes/notes.txt",
        "arm.urdf",
        "meshes/",
        "",
        "/etc/passwd",
        "%2fetc%2fpasswd",
        "meshes/base.stl%00.txt",
    ] {
        let (status, answer) = server.get(&format!("{root}{path}"));
        assert!(status == 404 || status == 400, "{path}: {answer}");
        assert!(!answer.contains("secret"), "{path}: {answer}");
    }
    assert_eq!(server.get("/mesh/99/meshes/base.stl").0, 404);
    assert_eq!(server.get("/mesh/-1/meshes/base.stl").0, 400);

    let open = Server::new(&[model.to_str().unwrap(), "--meshes", all.path().to_str().unwrap()]);
    let scene = open.client().next("scene");
    let url = scene["links"][2]["visuals"][0]["url"].as_str().unwrap().to_owned();
    assert!(open.get(&url).1.ends_with("secret"), "the user has opened it");
}
