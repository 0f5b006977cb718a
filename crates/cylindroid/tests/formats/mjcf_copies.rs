//! MJCF `<replicate>` and `<attach>`: poses against MuJoCo (tests/vectors/mujoco/copies.json and
//! attached.json, written by `cargo xtask vectors`), what refers to copies, what is refused.

use cylindroid::Mechanism;

use crate::mjcf::{against_mujoco, check, read, read_mjcf, world};
use crate::report;

const COPIES: &str = include_str!("../data/copies.xml");

fn mimic(m: &Mechanism, name: &str) -> (String, f64) {
    let joint = m.joints().iter().find(|j| j.name == name).unwrap();
    let mimic = joint.mimic.as_ref().unwrap();
    (mimic.joint.clone(), mimic.multiplier)
}

#[test]
fn copies_are_those_of_mujoco() {
    let m = read(COPIES);
    against_mujoco("copies", &m);
    let moving: Vec<&str> =
        m.joints().iter().filter(|j| j.kind.dof() > 0).map(|j| j.name.as_str()).collect();
    assert_eq!(
        moving[..8],
        ["first", "hip_0", "bend0_0", "turn0_0", "bend1_0", "turn1_0", "knee_0", "hip_1"]
    );
    assert_eq!(moving.len(), 30);
}

#[test]
fn copies_of_constraints_actuators_and_excluded_contacts_follow() {
    let m = read(COPIES);
    for (name, leader, slope) in
        [("turn0_0", "bend0_0", -2.0), ("turn1_2", "bend1_2", -2.0), ("knee_1", "hip_1", -2.0)]
    {
        assert_eq!(mimic(&m, name), (leader.to_owned(), slope));
    }
    let loops: Vec<&str> = m.loops().iter().map(|l| l.name.as_str()).collect();
    assert_eq!(
        loops,
        [
            "pin_0", "pin_1", "pin_2", "hung0_0", "hung1_0", "hung0_1", "hung1_1", "hung0_2",
            "hung1_2"
        ]
    );
    let actuated: Vec<&str> =
        m.joints().iter().filter(|j| j.actuated).map(|j| j.name.as_str()).collect();
    assert_eq!(
        actuated,
        ["first", "bend0_0", "bend1_0", "bend0_1", "bend1_1", "bend0_2", "bend1_2"]
    );
    assert!(
        m.joints().iter().filter(|j| j.name.starts_with("bend")).all(|j| j.limits.effort == 3.0)
    );
    let name = |link: &usize| m.links()[*link].name.as_str();
    let pairs: Vec<_> =
        m.disabled_collisions().iter().map(|p| [name(&p[0]), name(&p[1])]).collect();
    assert_eq!(pairs.len(), 16);
    for [a, b] in [["leg_2", "toe1_2"], ["first", "ring09"]] {
        assert!(pairs.contains(&[a, b]) || pairs.contains(&[b, a]), "{pairs:?}");
    }
    let text = report(&m);
    assert!(text.contains("it ties a copy to what is not copied with it"), "{text}");
    assert!(!text.contains("replicate"), "{text}");
}

#[test]
fn copies_have_as_many_digits_as_their_count() {
    let body = "<body name='b'><geom size='1'/></body>";
    for (count, links) in [("-1", 1), ("0", 1), ("1", 2), ("10", 11)] {
        let m = read(&world(&format!("<replicate count='{count}'>{body}</replicate>")));
        assert_eq!(m.links().len(), links, "{count}");
        let last = if links == 11 { "b09" } else { "b0" };
        assert_eq!(m.frame(last).is_ok(), links > 1, "{count}");
    }
    // A body without a name takes none that a copy has.
    let m = read(&world("<body/><replicate count='3'><body name='body'/></replicate>"));
    assert_eq!(m.links().len(), 5);
}

#[test]
fn copies_that_are_wrong_are_refused() {
    let body = "<body name='b'/>";
    let of = |attributes: &str, inside: &str| {
        world(&format!("<replicate {attributes}>{inside}</replicate>"))
    };
    check(&of("", body), "<replicate", "has no count");
    check(&of("count='2.5'", body), "2.5", "not an integer");
    check(&of("count='2' offset='1 2'", body), "1 2", "expected 3");
    check(&of("count='2'", "<joint name='j'/>"), "j", "no direct child of <replicate>");
    check(&of("count='100000'", &(body.to_owned() + "<body/>")), "<body", "exceed 100000 elements");
    check(&of("count='2' childclass='x'", body), "x", "default class");
    let nested = (0..40).fold(body.to_owned(), |inside, _| {
        format!("<replicate count='1000000000'>{inside}</replicate>")
    });
    assert!(read_mjcf(&world(&nested)).unwrap_err().to_string().contains("exceed"));
}

fn attached() -> Mechanism {
    let path = format!("{}/tests/data/attached.xml", env!("CARGO_MANIFEST_DIR"));
    cylindroid::load_file(path.as_ref()).unwrap()
}

#[test]
fn attached_models_are_those_of_mujoco() {
    let m = attached();
    against_mujoco("attached", &m);
    let moving: Vec<&str> =
        m.joints().iter().filter(|j| j.kind.dof() > 0).map(|j| j.name.as_str()).collect();
    // As MuJoCo names them.
    let expected = [
        "arm",
        "left_palm",
        "left_swing",
        "left_twist",
        "after",
        "mast",
        "all_palm",
        "all_swing",
        "all_twist",
        "all_thumb",
        "row_swing0",
        "row_twist0",
        "row_swing1",
        "row_twist1",
    ];
    assert_eq!(moving, expected);
}

#[test]
fn attached_constraints_and_actuators_come_with_all_their_bodies() {
    let m = attached();
    assert_eq!(mimic(&m, "all_palm"), ("all_thumb".to_owned(), 2.0));
    assert_eq!(mimic(&m, "row_swing1"), ("row_twist1".to_owned(), 1.0));
    assert!(m.joints().iter().all(|j| j.name != "left_palm" || j.mimic.is_none()));
    let loops: Vec<&str> = m.loops().iter().map(|l| l.name.as_str()).collect();
    assert_eq!(loops, ["all_pin"]);
    let actuated: Vec<&str> =
        m.joints().iter().filter(|j| j.actuated).map(|j| j.name.as_str()).collect();
    assert!(actuated.contains(&"arm") && actuated.contains(&"all_thumb"), "{actuated:?}");
    assert!(!actuated.contains(&"after") && !actuated.contains(&"mast"), "{actuated:?}");
    assert_eq!(m.disabled_collisions().len(), 2);
    let text = report(&m);
    assert!(text.contains("it ties a body that is attached to one that is not"), "{text}");
}

#[test]
fn attached_models_that_are_wrong_are_refused() {
    let data = format!("{}/tests/data", env!("CARGO_MANIFEST_DIR"));
    let of = |file: &str, attach: &str| {
        let model = format!("<asset><model name='m' file='{data}/{file}'/></asset>");
        format!("<mujoco>{model}<worldbody>{attach}</worldbody></mujoco>")
    };
    let attach = "<attach model='m' body='tip' prefix='a_'/>";
    check(&of("hand.xml", "<attach model='x' prefix=''/>"), "x", "model");
    check(&of("hand.xml", "<attach model='m' body='tap' prefix=''/>"), "tap", "nearest: tip");
    check(&of("hand.xml", &attach.repeat(2)), "a_", "already");
    check(&of("none.xml", attach), &data, "cannot read");
    let itself = std::env::temp_dir().join(format!("attaches-itself-{}.xml", std::process::id()));
    let name = itself.file_name().unwrap().to_string_lossy();
    std::fs::write(
        &itself,
        format!("<mujoco><asset><model name='m' file='{name}'/></asset></mujoco>"),
    )
    .unwrap();
    let error = cylindroid::load_file(&itself).unwrap_err().to_string();
    std::fs::remove_file(&itself).unwrap();
    assert!(error.contains("10 inside one another"), "{error}");
}

#[test]
fn bytes_of_attached_models_that_are_not_utf8_are_noted() {
    let folder = tempfile::tempdir().unwrap();
    let part = b"<mujoco>\n<!-- gr\xfcn --><worldbody><body name='tip'><geom size='1'/></body></worldbody></mujoco>";
    std::fs::write(folder.path().join("part.xml"), part).unwrap();
    let text = "<mujoco><asset><model name='m' file='part.xml'/></asset><worldbody>\
                <attach model='m' body='tip' prefix='a_'/></worldbody></mujoco>";
    std::fs::write(folder.path().join("whole.xml"), text).unwrap();
    let report = report(&cylindroid::load_file(&folder.path().join("whole.xml")).unwrap());
    assert!(report.contains("bytes that are not UTF-8 in"), "{report}");
    assert!(report.contains("part.xml, line 2"), "{report}");
}

/// Bodies of one large part, attached one by one in any order: each brings its own contents, in their
/// order, and nothing else. Shapes of a world without bodies are counted as well.
#[test]
fn attached_bodies_bring_their_own_contents() {
    let folder = tempfile::tempdir().unwrap();
    let n = 300;
    let all = |piece: &dyn Fn(usize) -> String| (0..n).map(piece).collect::<String>();
    let bodies = all(&|i| {
        format!(
            "<body name='b{i}' pos='{i} 0 0'><joint name='j{i}'/><geom name='g{i}' size='1'/>\
             <site name='s{i}'/><site name='t{i}'/><body name='c{i}'><geom size='1'/></body></body>"
        )
    });
    let pairs = all(&|i| {
        format!(
            "<exclude body1='b{i}' body2='c{i}'/><exclude body1='b{i}' body2='b{}'/>",
            (i + 1) % n
        )
    });
    let pins = all(&|i| format!("<connect name='p{i}' body1='c{i}' anchor='0 0 0'/>"));
    let part = format!(
        "<mujoco><worldbody>{bodies}</worldbody><contact>{pairs}</contact>\
         <equality>{pins}</equality></mujoco>"
    );
    std::fs::write(folder.path().join("part.xml"), part).unwrap();
    let order: Vec<usize> = (0..n).map(|i| i * 7 % n).collect();
    let attached: String =
        order.iter().map(|i| format!("<attach model='m' body='b{i}' prefix='a{i}_'/>")).collect();
    let main = folder.path().join("main.xml");
    let asset = "<asset><model name='m' file='part.xml'/></asset>";
    let text = format!("<mujoco>{asset}<worldbody>{attached}</worldbody></mujoco>");
    std::fs::write(&main, text).unwrap();
    let m = cylindroid::load_file(&main).unwrap();
    assert_eq!((m.n(), m.loops().len(), m.disabled_collisions().len()), (n, n, n));
    let joints = m.joints().iter().filter(|j| j.kind.dof() > 0).map(|j| j.name.clone());
    assert!(joints.eq(order.iter().map(|i| format!("a{i}_j{i}"))));
    let links = m.links().iter().skip(1).map(|l| l.name.clone());
    assert!(links.eq(order.iter().flat_map(|i| ["b", "c"].map(|l| format!("a{i}_{l}{i}")))));
    let frames: Vec<&str> = m.frames().iter().map(|f| f.name.as_str()).collect();
    let sites = frames.iter().filter(|f| f.contains("_s") || f.contains("_t")).copied();
    let expected = order.iter().flat_map(|i| ["s", "t"].map(|s| format!("a{i}_{s}{i}")));
    assert!(sites.eq(expected), "{frames:?}");
    // 2000 shapes a hundred and one times.
    let ball = "<geom size='1'/>".repeat(2000);
    let part = format!("<mujoco><worldbody>{ball}</worldbody></mujoco>");
    std::fs::write(folder.path().join("part.xml"), part).unwrap();
    let bodies: String = (0..101)
        .map(|i| format!("<body name='k{i}'><joint/><attach model='m' prefix='a{i}_'/></body>"))
        .collect();
    let text = format!("<mujoco>{asset}<worldbody>{bodies}</worldbody></mujoco>");
    std::fs::write(&main, text).unwrap();
    let error = cylindroid::load_file(&main).unwrap_err().to_string();
    assert!(error.contains("have more than 200000 shapes"), "{error}");
}
