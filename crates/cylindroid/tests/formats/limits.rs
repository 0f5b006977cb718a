//! Limits of the one reader in front of all formats: kinds of files, size, depth, counts, encoding.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use cylindroid::collision::distance;
use cylindroid::model::Geometry;
use cylindroid::{Error, Vec3, load_file};

use crate::mjcf::read_mjcf;
use crate::sdf::read_sdf;
use crate::{ARM_URDF, read_toml, read_urdf};

const ONE: Vec3 = Vec3::new(1.0, 1.0, 1.0);

/// The message of the error, which must be short and come within twenty seconds.
#[track_caller]
fn told<T: std::fmt::Debug>(work: impl FnOnce() -> Result<T, Error>) -> String {
    let start = Instant::now();
    let message = work().unwrap_err().to_string();
    assert!(start.elapsed() < Duration::from_secs(20), "{message}");
    assert!(message.len() < 2000, "a message of {} bytes", message.len());
    message
}

fn written(folder: &tempfile::TempDir, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.path().join(name);
    fs::write(&path, bytes).unwrap();
    path
}

#[test]
fn only_regular_files_of_bounded_size_are_read() {
    let folder = tempfile::tempdir().unwrap();
    assert!(told(|| load_file(folder.path())).ends_with("it is a folder, name a file in it"));
    if cfg!(unix) {
        for device in ["/dev/zero", "/dev/null"] {
            let message = told(|| load_file(Path::new(device)));
            assert!(message.contains("not a regular file"), "{message}");
        }
        let pipe = folder.path().join("pipe.urdf");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        assert!(told(|| load_file(&pipe)).contains("pipe"));
    }
    for name in ["a.urdf", "a.toml", "a.xml", "a.sdf"] {
        let path = written(&folder, name, "");
        fs::File::options().write(true).open(&path).unwrap().set_len(33 << 20).unwrap();
        let message = told(|| load_file(&path));
        assert!(message.contains("larger than 32 MiB"), "{message}");
    }
    let obj = written(&folder, "a.obj", "");
    fs::File::options().write(true).open(&obj).unwrap().set_len((256 << 20) + 1).unwrap();
    let mesh = Geometry::Mesh { uri: "a.obj".into(), path: Some(obj), scale: ONE };
    let ball = Geometry::Sphere { radius: 1.0 };
    let pose = cylindroid::Pose::IDENTITY;
    let message = told(|| distance((&mesh, pose), (&ball, pose)));
    assert!(message.contains("larger than 256 MiB"), "{message}");
    let include = written(&folder, "m.xml", "<mujoco><include file='big.xml'/></mujoco>");
    let big = written(&folder, "big.xml", "");
    fs::File::options().write(true).open(big).unwrap().set_len(33 << 20).unwrap();
    assert!(told(|| load_file(&include)).contains("32 MiB"));
}

/// Files that include a large one: the file that is being read counts as well.
#[test]
fn included_files_have_a_limit_together() {
    let folder = tempfile::tempdir().unwrap();
    let blanks = " ".repeat(30 << 20);
    let include = |name: &str| format!("<include><uri>{name}</uri></include>");
    written(&folder, "c.sdf", format!("<sdf>{blanks}</sdf>"));
    written(&folder, "b.sdf", format!("<sdf>{blanks}{}</sdf>", include("c.sdf")));
    let (two, three) = (include("b.sdf"), include("b.sdf") + &include("c.sdf"));
    let of =
        |includes: &str| format!("<sdf><model name='m'><link name='l'/>{includes}</model></sdf>");
    assert!(load_file(&written(&folder, "two.sdf", of(&two))).is_ok());
    let message = told(|| load_file(&written(&folder, "three.sdf", of(&three))));
    assert!(message.contains("included files exceed 64 MiB together"), "{message}");
}

#[test]
fn counts_have_limits_that_errors_name() {
    let values = format!("a = [{}]", "1,".repeat(1_100_000));
    assert!(told(|| read_toml(&values)).contains("1000000 values"));
    let elements = format!("<robot>{}<link name='l'/></robot>", "<gazebo/>".repeat(1_100_000));
    assert!(told(|| read_urdf(&elements)).contains("1000000 elements"));
    let names: String = (0..300).map(|i| format!(" a{i}='1'")).collect();
    let message = told(|| read_urdf(&format!("<robot><link name='l'{names}/></robot>")));
    assert!(message.contains("256 attributes"), "{message}");
    let long = "x".repeat(1001);
    let message = told(|| read_urdf(&format!("<robot><link name='{long}'/></robot>")));
    assert!(message.contains("1000 bytes in a name"), "{message}");
    let nested = |n: usize| {
        let open: String = (0..n).map(|i| format!("<model name='m{i}'>")).collect();
        format!("<sdf>{open}<link name='l'/>{}</sdf>", "</model>".repeat(n))
    };
    assert!(told(|| read_sdf(&nested(5000))).contains("1000 elements inside one another"));
    assert_eq!(read_sdf(&nested(50)).unwrap().links().len(), 1);
    let entities = "<!DOCTYPE r [<!ENTITY a 'bbbbbbbb'>]><robot><link name='&a;'/></robot>";
    assert!(told(|| read_urdf(entities)).contains("entities"));
}

/// Neither a bracket nor an angle in a comment, an instruction or quotes ends a document type
/// declaration.
#[test]
fn no_entity_is_hidden() {
    let entity = "<!ENTITY a 'b'>";
    for before in [
        "",
        "<!-- ]> -->",
        "<!-->-->",
        "<?p ]> ?>",
        "<!NOTATION n SYSTEM ']'>",
        "<!NOTATION n SYSTEM \"]\"><!ATTLIST r a CDATA ']'>",
        "<!ELEMENT r ANY> \n",
    ] {
        for name in ["r", "r SYSTEM 'a]'", "r SYSTEM '>['", "r PUBLIC \"[\" \"'>\""] {
            let doctype = |inside: &str| {
                format!("<!DOCTYPE {name} [{before}{inside}]><robot><link name='l'/></robot>")
            };
            let message = told(|| read_urdf(&doctype(entity)));
            assert!(message.contains("the file declares entities"), "{before} {name}: {message}");
            let robot = read_urdf(&doctype("<!-- <!ENTITY -->"));
            assert_eq!(robot.unwrap().links().len(), 1, "{before} {name}");
        }
    }
    // What hides elements from the limits is broken for the parser too.
    let deep = format!("{}{}", "<a>".repeat(2000), "</a>".repeat(2000));
    for head in ["<!DOCTYPE r [ ", "<!DOCTYPE r [<!-- ]>", "<!DOCTYPE r 'a>", "<!OTHER ['>"] {
        assert!(told(|| read_urdf(&format!("{head}{deep}"))).contains("broken XML"), "{head}");
    }
}

/// The elements of comments, texts and declarations are not counted.
#[test]
fn only_elements_are_counted() {
    let text = "<?xml version='1.0'?><!DOCTYPE robot><!-- <a> <!ENTITY <b -->\n<robot name='>'>\
                <![CDATA[<c><d>]]><link name='l'/></robot>";
    assert_eq!(read_urdf(text).unwrap().links().len(), 1);
    let comment = format!("<robot><!--{}--><link name='l'/></robot>", "<a>".repeat(2000));
    assert_eq!(read_urdf(&comment).unwrap().links().len(), 1);
}

#[test]
fn encodings_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let with = |head: &str, name: &[u8]| {
        [head.as_bytes(), b"<robot name='r'><link name='", name, b"'/></robot>"].concat()
    };
    let latin = with("<?xml version='1.0' encoding='ISO-8859-1'?>", b"\xe4rm");
    let m = load_file(&written(&folder, "latin.urdf", latin)).unwrap();
    assert_eq!((m.links()[0].name.as_str(), m.report().ignored.len()), ("ärm", 0));
    let m = load_file(&written(&folder, "none.urdf", with("\n", b"\xe4rm"))).unwrap();
    let note = &m.report().ignored[0];
    assert_eq!((note.line, note.what.as_str()), (2, "bytes that are not UTF-8"));
    let message = told(|| load_file(&written(&folder, "a.toml", b"name = \"\xe4\"")));
    assert!(message.ends_with("a.toml:1:9: this is not UTF-8, which a mechanism file must be"));
    // In an included file.
    let part = b"<mujocoinclude>\n<!-- \xe4 --></mujocoinclude>".to_vec();
    written(&folder, "part.xml", part);
    let whole = b"<mujoco><include file='part.xml'/><worldbody/></mujoco>".to_vec();
    let m = load_file(&written(&folder, "whole.xml", whole)).unwrap();
    let note = &m.report().ignored[0];
    assert_eq!(note.line, 2);
    assert!(note.what.starts_with("bytes that are not UTF-8"), "{}", note.what);
    assert!(note.what.contains("part.xml"), "{}", note.what);
    let part = b"<sdf version='1.9'>\n<model name='\xe4'><link name='l'/></model></sdf>".to_vec();
    written(&folder, "part.sdf", part);
    let whole = b"<sdf version='1.9'><model name='m'><link name='b'/><include><uri>part.sdf</uri>\
        </include></model></sdf>";
    let m = load_file(&written(&folder, "whole.sdf", whole)).unwrap();
    let mut notes = m.report().ignored.iter();
    let note = notes.find(|note| note.what.starts_with("bytes that are not UTF-8")).unwrap();
    assert!(note.line == 2 && note.what.contains("part.sdf"), "{}", note.what);
    let utf16: Vec<u8> = "\u{feff}<robot/>".encode_utf16().flat_map(u16::to_le_bytes).collect();
    assert!(told(|| load_file(&written(&folder, "a.urdf", utf16))).contains("UTF-16"));
}

#[cfg(unix)]
#[test]
fn a_path_that_is_not_utf_8_is_written_with_its_bytes() {
    use std::os::unix::ffi::OsStrExt as _;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(std::ffi::OsStr::from_bytes(b"a\xff.urdf"));
    assert!(told(|| load_file(&path)).contains("a\\xff.urdf: "));
    fs::write(&path, "<robot><link/></robot>").unwrap();
    assert!(told(|| load_file(&path)).contains("a\\xff.urdf:1:8: "));
    fs::write(&path, ARM_URDF).unwrap();
    assert_eq!(load_file(&path).unwrap().n(), 3);
}

/// The time of loading is that of reading: 50 000 links, sites, joints that follow one another,
/// notes of different elements.
#[test]
fn large_models_are_loaded() {
    let n = 50_000;
    let all = |each: &dyn Fn(usize) -> String| (1..n).map(each).collect::<String>();
    let links = all(&|i| format!("<link name='l{i}'/>"));
    let joints = all(&|i| {
        let (parent, last) = (i - 1, i.saturating_sub(1).max(1));
        let mimic = if i > 1 { format!("<mimic joint='j{last}'/>") } else { String::new() };
        format!(
            "<joint name='j{i}' type='continuous'><parent link='l{parent}'/><child link='l{i}'/>\
             {mimic}</joint><a{i}/>"
        )
    });
    let robot = read_urdf(&format!("<robot><link name='l0'/>{links}{joints}</robot>")).unwrap();
    assert_eq!((robot.n(), robot.links().len()), (1, n));
    let last = robot.report().ignored.iter().find(|i| i.line == 0).unwrap();
    assert!(last.what.ends_with("further elements and attributes"), "{}", last.what);
    let sites = all(&|i| format!("<site name='s{i}'/>"));
    let bodies = all(&|i| format!("<body name='b{i}'><joint name='j{i}'/></body>"));
    let motors = all(&|i| format!("<motor joint='j{i}'/>"));
    let robot = read_mjcf(&format!(
        "<mujoco><worldbody>{sites}{bodies}</worldbody><actuator>{motors}</actuator></mujoco>"
    ));
    assert_eq!(robot.unwrap().n(), n - 1);
    let frames = all(&|i| {
        let to = if i == 1 { "l".to_owned() } else { format!("f{}", i - 1) };
        format!("<frame name='f{i}' attached_to='{to}'><pose>0 0 1 0 0 0</pose></frame>")
    });
    let robot = read_sdf(&format!("<sdf><model name='m'><link name='l'/>{frames}</model></sdf>"));
    assert_eq!(robot.unwrap().frames().len(), n);
}

/// Seven files, each of which brings in the next one ten times, would be a million robots.
#[test]
fn robots_of_all_included_files_are_counted() {
    let folder = tempfile::tempdir().unwrap();
    for i in 0..7 {
        let next = format!("f{}.toml", i + 1);
        let robot = |k: usize| format!("[[robot]]\nname = \"r{k}\"\nmodel = \"{next}\"\n");
        written(&folder, &format!("f{i}.toml"), (0..10).map(robot).collect::<String>());
    }
    let joint = "[[joint]]\nname = \"j\"\ntype = \"revolute\"\nbetween = [\"ground\", \"b\"]\naxis = [0, 0, 1]\norigin = [0, 0, 0]\n";
    written(&folder, "f7.toml", joint);
    let message = told(|| load_file(&folder.path().join("f0.toml")));
    assert!(message.contains("is one more than 1000 robots"), "{message}");
    // Each file counts for itself.
    for _ in 0..2 {
        let robot = load_file(&folder.path().join("f5.toml")).unwrap();
        assert_eq!(robot.n(), 100);
    }
}
