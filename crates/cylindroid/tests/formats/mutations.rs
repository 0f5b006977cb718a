//! Nothing that stands in a file makes the loaders panic.

use crate::mjcf::read_mjcf;
use crate::sdf::read_sdf;
use crate::{ARM_TOML, ARM_URDF, read_toml, read_urdf};

/// Every truncation of the text, and every byte replaced by bytes that mean something.
fn feed(text: &str, read: impl Fn(&str)) {
    let bytes = text.as_bytes();
    for end in 0..=bytes.len() {
        read(&String::from_utf8_lossy(&bytes[..end]));
    }
    let replacements = b"<>\"'=/ -0.9eE[]{}&;\n\0#\xff";
    for i in 0..bytes.len() {
        let mut mutated = bytes.to_vec();
        mutated[i] = replacements[i % replacements.len()];
        read(&String::from_utf8_lossy(&mutated));
        mutated.remove(i);
        read(&String::from_utf8_lossy(&mutated));
        mutated.splice(i..i, *b"\xc3\xa9-1e999");
        read(&String::from_utf8_lossy(&mutated));
    }
}

#[test]
fn mutated_urdfs_give_a_model_or_an_error() {
    feed(ARM_URDF, |text| {
        let _ = read_urdf(text).map_err(|e| e.to_string());
    });
}

#[test]
fn mutated_mjcf_gives_a_model_or_an_error() {
    feed(include_str!("../data/zoo.xml"), |text| {
        let _ = read_mjcf(text).map_err(|e| e.to_string());
    });
}

#[test]
fn mutated_sdf_gives_a_model_or_an_error() {
    feed(include_str!("../data/bars.sdf"), |text| {
        let _ = read_sdf(text).map_err(|e| e.to_string());
    });
}

#[test]
fn mutated_mechanism_files_give_a_model_or_an_error() {
    feed(ARM_TOML, |text| {
        let _ = read_toml(text).map_err(|e| e.to_string());
    });
    for name in cylindroid::catalogue::names() {
        let path = format!("{}/src/model/catalogue/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let text = std::fs::read_to_string(path).unwrap();
        feed(&text[..text.len().min(1500)], |text| {
            let _ = read_toml(text).map_err(|e| e.to_string());
        });
    }
}

#[test]
fn deep_and_long_files_are_answered() {
    let deep = format!("<robot>{}{}</robot>", "<a>".repeat(50_000), "</a>".repeat(50_000));
    assert!(read_urdf(&deep).is_err());
    let links: String = (0..1000).map(|i| format!("<link name='l{i}'/>")).collect();
    let joints: String = (1..1000)
        .map(|i| {
            let parent = i - 1;
            format!("<joint name='j{i}' type='revolute'><parent link='l{parent}'/><child link='l{i}'/></joint>")
        })
        .collect();
    assert_eq!(read_urdf(&format!("<robot>{links}{joints}</robot>")).unwrap().n(), 999);
    let deep = format!(
        "<mujoco><worldbody>{}{}</worldbody></mujoco>",
        "<body>".repeat(400),
        "</body>".repeat(400)
    );
    assert_eq!(read_mjcf(&deep).unwrap().links().len(), 401);
    let deep =
        deep.replace("<body>", &"<body>".repeat(100)).replace("</body>", &"</body>".repeat(100));
    let _ = read_mjcf(&deep).map_err(|e| e.to_string());
    assert!(read_toml(&format!("a = {}", "[".repeat(50_000))).is_err());
}

/// Whole lines taken out, doubled or exchanged: what is left is well-formed more often, and means
/// something else.
#[test]
fn files_without_some_of_their_lines_give_a_model_or_an_error() {
    let real = [
        crate::robots().join("cassie_description/robots/cassie_v2.sdf"),
        crate::robots().join("../../../../robosuite/models/assets/grippers/xarm7_gripper.xml"),
        crate::robots().join("../../../../robosuite/models/assets/robots/spot/robot.xml"),
    ];
    let own = |name: &str| std::path::PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(name);
    let models = cylindroid::catalogue::names()
        .iter()
        .map(|n| own(&format!("src/model/catalogue/{n}.toml")));
    let data = ["arm.urdf", "zoo.xml", "bars.sdf"].map(|n| own(&format!("tests/data/{n}")));
    for path in real.into_iter().chain(models).chain(data) {
        let text = std::fs::read_to_string(&path).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        let read: fn(&str) -> cylindroid::Result<cylindroid::Mechanism> =
            match path.extension().and_then(|e| e.to_str()) {
                Some("toml") => read_toml,
                Some("sdf") => read_sdf,
                Some("xml") => read_mjcf,
                _ => read_urdf,
            };
        let try_it = |lines: &[&str]| {
            if let Ok(m) = read(&lines.join("\n")) {
                // What was read can be used.
                m.state(m.home()).unwrap();
            }
        };
        for i in 0..lines.len() {
            let mut fewer = lines.clone();
            fewer.remove(i);
            try_it(&fewer);
            let mut more = lines.clone();
            more.insert(i, lines[i]);
            try_it(&more);
            let mut moved = lines.clone();
            moved.swap(i, (i * 7 + 3) % lines.len());
            try_it(&moved);
            let block = i.min(lines.len())..(i + 5).min(lines.len());
            let mut fewer = lines.clone();
            fewer.drain(block);
            try_it(&fewer);
        }
    }
}
