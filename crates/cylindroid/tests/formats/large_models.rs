//! Large models are loaded in the time of reading, or refused by a limit that the error names.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use cylindroid::model::formats;
use cylindroid::{Error, Mechanism, load_file};

use crate::mjcf::read_mjcf;
use crate::sdf::read_sdf;
use crate::{ARM_TOML, read_toml, read_urdf};

/// What the work returns; it must take less than twenty seconds.
#[track_caller]
fn soon<T>(work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let done = work();
    let took = start.elapsed();
    assert!(took < Duration::from_secs(20), "{took:?}");
    done
}

#[track_caller]
fn refused(work: impl FnOnce() -> Result<Mechanism, Error>, by: &str) {
    let message = soon(work).unwrap_err().to_string();
    assert!(message.contains(by) && message.len() < 2000, "{message}");
}

fn all(n: usize, each: impl Fn(usize) -> String) -> String {
    (0..n).map(each).collect()
}

#[test]
fn texts_are_no_larger_than_files() {
    let blanks = " ".repeat(33 << 20);
    refused(|| read_toml(&blanks), "larger than 32 MiB");
    let parsed = || formats::toml::parse(&blanks, Path::new("a.toml"));
    refused(parsed, "larger than 32 MiB");
    let arm = cylindroid::load("panda").unwrap();
    let limited = || formats::toml::with_limits_of_text(&arm, &blanks, Path::new("a.toml"));
    refused(limited, "larger than 32 MiB");
    refused(|| read_urdf(&format!("<robot>{blanks}</robot>")), "larger than 32 MiB");
    refused(|| read_mjcf(&format!("<mujoco>{blanks}</mujoco>")), "larger than 32 MiB");
    refused(|| read_sdf(&format!("<sdf>{blanks}</sdf>")), "larger than 32 MiB");
}

/// Every part of a text for which the parser of TOML needs memory.
#[test]
fn words_marks_and_lines_of_a_mechanism_file_have_a_limit() {
    let limit = "more than 4000000 words, marks and lines";
    let many = |part: &str| part.repeat(4_100_000);
    for part in ["\n", "#\n", "# a\n", "\r\n"] {
        refused(|| read_toml(&format!("{ARM_TOML}{}", many(part))), limit);
    }
    for begin in ["a", "a = \"", "a = '", "a = ", "a = [", "a = \"\"\""] {
        for part in [".", "\"", "'", "}", "]", "a ", "\t#", "\\\"", "''"] {
            refused(|| read_toml(&format!("{begin}{}", many(part))), limit);
        }
    }
    for part in ["{", "[", ",", "=", "{a="] {
        refused(|| read_toml(&format!("a = [{}", many(part))), "more than 1000000 values");
    }
    // Far more than any file has.
    let lines = "# a comment of some words\n".repeat(100_000);
    assert_eq!(read_toml(&format!("{lines}{ARM_TOML}")).unwrap().n(), 2);
}

#[test]
fn links_have_a_limit() {
    let limit = "more than 120000 links";
    let links = all(120_001, |i| format!("<link name='{i}'/>"));
    refused(|| read_urdf(&format!("<robot>{links}</robot>")), limit);
    refused(|| read_sdf(&format!("<sdf><model name='m'>{links}</model></sdf>")), limit);
    let world = |inside: &str| format!("<mujoco><worldbody>{inside}</worldbody></mujoco>");
    refused(|| read_mjcf(&world(&"<body/>".repeat(120_000))), limit);
    // Joints of one body have links between them.
    let joints = format!("<body>{}</body>", "<joint/>".repeat(120_001));
    refused(|| read_mjcf(&world(&joints)), limit);
    // Links without a joint are free.
    let coordinates = "more than 120000 coordinates";
    let links = all(25_000, |i| format!("<link name='{i}'/>"));
    refused(|| read_sdf(&format!("<sdf><model name='m'>{links}</model></sdf>")), coordinates);
    let free = "<body><freejoint/></body>".repeat(20_001);
    refused(|| read_mjcf(&world(&free)), coordinates);
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    // Copies by <attach> and by [[robot]].
    let child = format!("<body name='b'>{}</body>", "<body/>".repeat(30_000));
    fs::write(path("child.xml"), world(&child)).unwrap();
    let whole = format!(
        "<mujoco><asset><model name='m' file='child.xml'/></asset><worldbody>{}\
         <attach model='m' body='b' prefix='p'/></worldbody></mujoco>",
        "<body/>".repeat(95_000)
    );
    fs::write(path("whole.xml"), whole).unwrap();
    refused(|| load_file(&path("whole.xml")), limit);
    let chain = all(30_000, |i| {
        let next = i + 1;
        format!(
            "<link name='l{next}'/><joint name='j{i}' type='continuous'><parent link='l{i}'/>\
             <child link='l{next}'/></joint>"
        )
    });
    let chain = format!("<robot name='r'><link name='l0'/>{chain}</robot>");
    fs::write(path("chain.urdf"), chain).unwrap();
    let robots = |n| all(n, |i| format!("[[robot]]\nname = \"r{i}\"\nmodel = \"chain.urdf\"\n"));
    fs::write(path("four.toml"), robots(4)).unwrap();
    refused(|| load_file(&path("four.toml")), "has more than 120000 links");
    fs::write(path("two.toml"), robots(2)).unwrap();
    assert_eq!(soon(|| load_file(&path("two.toml"))).unwrap().n(), 60_000);
}

/// Each of the files is within all limits.
#[test]
fn elements_of_all_files_are_counted_together() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let many = "<a/>".repeat(600_000);
    let limit = "have more than 1000000 elements together";
    let sdf = format!("<sdf><model name='m'><link name='l'/><x>{many}</x></model></sdf>");
    let mjcf = format!("<mujoco><worldbody><body name='b'/></worldbody><x>{many}</x></mujoco>");
    for name in ["a", "b"] {
        fs::write(path(&format!("{name}.sdf")), &sdf).unwrap();
        fs::write(path(&format!("{name}.xml")), &mjcf).unwrap();
    }
    let include =
        |name: &str| format!("<include><uri>{name}.sdf</uri><name>{name}</name></include>");
    let of = |names: &[&str]| {
        let includes: String = names.iter().map(|name| include(name)).collect();
        format!("<sdf><model name='m'><link name='o'/>{includes}</model></sdf>")
    };
    fs::write(path("one.sdf"), of(&["a"])).unwrap();
    fs::write(path("both.sdf"), of(&["a", "b"])).unwrap();
    assert!(soon(|| load_file(&path("one.sdf"))).is_ok());
    refused(|| load_file(&path("both.sdf")), limit);
    let both = "<mujoco><include file='a.xml'/><include file='b.xml'/></mujoco>";
    fs::write(path("both.xml"), both).unwrap();
    refused(|| load_file(&path("both.xml")), limit);
    let attached = "<mujoco><asset><model name='a' file='a.xml'/><model name='b' file='b.xml'/>\
                    </asset><worldbody/></mujoco>";
    fs::write(path("attached.xml"), attached).unwrap();
    refused(|| load_file(&path("attached.xml")), limit);
    // Their bytes, too.
    let blanks = " ".repeat(30 << 20);
    for name in ["d", "e", "f"] {
        fs::write(path(&format!("{name}.xml")), format!("<mujoco>{blanks}</mujoco>")).unwrap();
    }
    let models = ["d", "e", "f"].map(|name| format!("<model name='{name}' file='{name}.xml'/>"));
    let text = format!("<mujoco><asset>{}</asset></mujoco>", models.concat());
    fs::write(path("large.xml"), text).unwrap();
    refused(|| load_file(&path("large.xml")), "exceed 64 MiB together");
}

/// Chains of joints that follow one another, in both orders of the file.
#[test]
fn long_chains_of_couplings_are_read() {
    let n = 20_000;
    let joints = all(n, |i| {
        let (next, leader) = (i + 1, i + 1);
        let mimic = if next < n {
            format!("<mimic joint='j{leader}' multiplier='-1' offset='0.5'/>")
        } else {
            String::new()
        };
        format!(
            "<link name='l{next}'/><joint name='j{i}' type='continuous'><parent link='l{i}'/>\
             <child link='l{next}'/>{mimic}</joint>"
        )
    });
    let urdf = format!("<robot name='r'><link name='l0'/>{joints}</robot>");
    assert_eq!(soon(|| read_urdf(&urdf)).unwrap().n(), 1);
    let body = |i: usize| format!("<body name='b{i}'><joint name='j{i}'/><geom size='1'/></body>");
    let bodies = all(n, body);
    for forward in [true, false] {
        let couplings = all(n - 1, |i| {
            let (a, b) = if forward { (i, i + 1) } else { (i + 1, i) };
            format!("<joint joint1='j{a}' joint2='j{b}'/>")
        });
        let motors = all(n, |i| format!("<motor joint='j{i}'/>"));
        let text = format!(
            "<mujoco><worldbody>{bodies}</worldbody><equality>{couplings}</equality>\
             <actuator>{motors}</actuator></mujoco>"
        );
        let robot = soon(|| read_mjcf(&text)).unwrap();
        assert_eq!((robot.n(), robot.actuated().count()), (1, 1));
    }
    // A ring has one coupling too many.
    let ring = all(n, |i| format!("<joint joint1='j{i}' joint2='j{}'/>", (i + 1) % n));
    let text =
        format!("<mujoco><worldbody>{bodies}</worldbody><equality>{ring}</equality></mujoco>");
    let robot = soon(|| read_mjcf(&text)).unwrap();
    let note = &robot.report().ignored[0];
    assert!(robot.n() == 1 && note.why.contains("would follow one another"), "{note:?}");
}

#[test]
fn long_tendons_are_read() {
    let n = 6000;
    let bodies = all(n, |i| format!("<body name='b{i}'><joint name='j{i}'/></body>"));
    let terms = all(n, |i| format!("<joint joint='j{i}' coef='1'/>"));
    let fixed = |name: &str| format!("<fixed name='{name}'>{terms}</fixed>");
    let of = |tendons: &[&str]| {
        let all: String = tendons.iter().map(|t| fixed(t)).collect();
        let ties: String = tendons.iter().map(|t| format!("<tendon tendon1='{t}'/>")).collect();
        format!(
            "<mujoco><worldbody>{bodies}</worldbody><tendon>{all}</tendon>\
             <equality>{ties}</equality></mujoco>"
        )
    };
    let robot = soon(|| read_mjcf(&of(&["a"]))).unwrap();
    assert_eq!((robot.n(), robot.joints().len()), (n - 1, 2 * n - 2));
    // Each makes 9999 links.
    let bodies = all(20_000, |i| format!("<body name='b{i}'><joint name='j{i}'/></body>"));
    let (mut tendons, mut ties) = (String::new(), String::new());
    for t in 0..12 {
        let first = 10_000 + t;
        let terms = all(10_000, |i| format!("<joint joint='j{i}' coef='1'/>"));
        let own = format!("<joint joint='j{first}' coef='1'/>");
        write!(tendons, "<fixed name='t{t}'>{terms}{own}</fixed>").unwrap();
        write!(ties, "<tendon tendon1='t{t}'/>").unwrap();
    }
    let text = format!(
        "<mujoco><worldbody>{bodies}</worldbody><tendon>{tendons}</tendon>\
         <equality>{ties}</equality></mujoco>"
    );
    refused(|| read_mjcf(&text), "more than 120000 links");
}

#[test]
fn many_default_classes_and_names_are_read() {
    let n = 40_000;
    let classes = all(n, |i| {
        format!("<default class='c{i}'><geom size='0.1'/><joint armature='1'/></default>")
    });
    let bodies = all(n, |i| {
        format!("<body name='b{i}'><joint name='j{i}' class='c{i}'/><geom class='c{i}'/></body>")
    });
    let robot = soon(|| {
        read_mjcf(&format!(
            "<mujoco><default>{classes}</default><worldbody>{bodies}</worldbody></mujoco>"
        ))
    });
    assert_eq!(robot.unwrap().n(), n);
    // Constraints without a name, which get a number.
    let ties = all(n - 1, |i| format!("<weld body1='b{i}' body2='b{}'/>", i + 1));
    let bodies = all(n, |i| format!("<body name='b{i}'/>"));
    let robot = soon(|| {
        read_mjcf(&format!(
            "<mujoco><worldbody>{bodies}</worldbody><equality>{ties}</equality></mujoco>"
        ))
    });
    assert_eq!(robot.unwrap().loops()[n - 2].name, format!("weld.{}", n - 1));
}

/// A chain whose frames cannot meet: the search of home is bounded, whatever the size.
#[test]
fn the_search_of_home_is_bounded() {
    let of = |n: usize, every: usize| {
        let mut text = String::new();
        for i in 0..n {
            let on = if i == 0 { "ground".to_owned() } else { format!("l{}", i - 1) };
            write!(
                text,
                "[[joint]]\nname = \"j{i}\"\ntype = \"revolute\"\nbetween = [\"{on}\", \"l{i}\"]\n\
                 origin = [{i}, 0, 0]\naxis = [0, 0, 1]\n[[frame]]\nname = \"f{i}\"\n\
                 link = \"l{i}\"\nxyz = [0, 0, {i}]\n"
            )
            .unwrap();
        }
        for i in (every..n).step_by(every) {
            write!(
                text,
                "[[closure]]\nname = \"c{i}\"\ntype = \"pose\"\nbetween = [\"f{}\", \"f{i}\"]\n",
                i - every
            )
            .unwrap();
        }
        text
    };
    refused(|| read_toml(&of(12, 4)), "found from home and 63 random restarts within the limits;");
    for n in [200, 1000] {
        let message = soon(|| read_toml(&of(n, 4))).unwrap_err().to_string();
        assert!(message.contains(&format!("a mechanism of {n} coordinates")), "{message}");
        assert!(message.contains("give a start nearer to an assembly (home"), "{message}");
    }
}
