//! Closures by frames: `[[closure]]` tables, and home assembled where the file loads.

use std::fs;
use std::path::{Path, PathBuf};

use cylindroid::closure::{ClosedChain, Mobility};
use cylindroid::model::{JointKind, formats};
use cylindroid::spatial::{Pose, Vec3};
use cylindroid::{Mechanism, Result};

use crate::fk::{assert_close, closed_at_home, frame};
use crate::mechanism_file::check;
use crate::{pointed_at, refused};

/// A file beside the robots of the test data.
fn path() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/closure.toml")
}

fn read(text: &str) -> Result<Mechanism> {
    cylindroid::load_text(text, &path())
}

fn closure(name: &str, kind: &str, between: [&str; 2], more: &str) -> String {
    let [a, b] = between;
    format!(
        "[[closure]]\nname = \"{name}\"\ntype = \"{kind}\"\nbetween = [\"{a}\", \"{b}\"]\n{more}\n"
    )
}

const FIVE_BAR: &str =
    "[[robot]]\nmodel = \"five_bar.urdf\"\nactuated = [\"left_1\", \"right_1\"]\n";
const TWO_LEGS: &str = "reference = \"left_tip\"\n[[robot]]\nmodel = \"two_legs.urdf\"\n\
     actuated = [\"left_1\", \"left_2\", \"left_3\", \"right_1\", \"right_2\", \"right_3\"]\n";

fn mobility(m: &Mechanism) -> Mobility {
    let chain = ClosedChain::of(&m.state(m.home()).unwrap(), None, None).unwrap();
    let scale = 1e-9 * chain.constraint.length();
    assert!(chain.closure_error.distance < scale && chain.closure_error.angle < 1e-9);
    Mobility::of(&chain.constraint)
}

/// The distance and the angle between two frames at home.
fn apart(m: &Mechanism, a: &str, b: &str) -> (f64, f64) {
    let (a, b) = (frame(m, m.home(), a), frame(m, m.home(), b));
    ((a.translation - b.translation).norm(), a.rotation.angle_to(b.rotation))
}

#[test]
fn a_point_closes_a_planar_tree() {
    let open = cylindroid::load_file(&path().with_file_name("five_bar.urdf")).unwrap();
    assert!((0.08..0.09).contains(&apart(&open, "left_tip", "right_tip").0));
    let m = read(&format!("{FIVE_BAR}{}", closure("tip", "point", ["left_tip", "right_tip"], "")))
        .unwrap();
    assert!(m.unassembled().is_empty());
    assert_eq!((m.n(), m.loops()[0].kind), (4, JointKind::Spherical));
    assert!(apart(&m, "left_tip", "right_tip").0 < 1e-12);
    // The nearest assembly: no coordinate far from zero, where the file has it.
    assert!(m.home().iter().all(|q| q.abs() < 0.3), "{:?}", m.home());
    let found = mobility(&m);
    assert_eq!((found.dof.dimension(), found.relation.indeterminacy), (2, 0));
    // The velocity normal to the plane is constrained twice.
    assert_eq!(found.hyperstatic.dimension(), 1);
}

#[test]
fn a_pose_closes_a_tree_in_space() {
    let m = read(&format!("{TWO_LEGS}{}", closure("hand", "pose", ["left_tip", "right_tip"], "")))
        .unwrap();
    closed_at_home(&m, 1e-12);
    let (distance, angle) = apart(&m, "left_tip", "right_tip");
    assert!(distance < 1e-12 && angle < 1e-12, "{distance} m, {angle} rad");
    let found = mobility(&m);
    assert_eq!((found.dof.dimension(), found.hyperstatic.dimension()), (6, 0));
    assert_eq!((m.n(), m.loops()[0].kind), (12, JointKind::Fixed));
}

/// The lines coincide and so do the origins: a rotation about the line is free, a slide is not.
#[test]
fn an_axis_leaves_the_rotation_about_it() {
    let between = ["left_tip", "right_tip"];
    let m = read(&format!("{FIVE_BAR}{}", closure("tip", "axis", between, ""))).unwrap();
    assert!(apart(&m, between[0], between[1]).0 < 1e-12);
    let found = mobility(&m);
    assert_eq!((found.dof.dimension(), found.hyperstatic.dimension()), (2, 3));
    let axis = "axis = [0, 2, 1]";
    let m = read(&format!("{TWO_LEGS}{}", closure("hinge", "axis", between, axis))).unwrap();
    let axis = Vec3::new(0.0, 2.0, 1.0) * 5.0_f64.sqrt().recip();
    let [a, b] = between.map(|name| frame(&m, m.home(), name));
    assert!((a.translation - b.translation).norm() < 1e-12);
    assert!(((a.rotation * axis) - (b.rotation * axis)).norm() < 1e-12);
    assert_eq!(mobility(&m).dof.dimension(), 7);
}

#[test]
fn frames_are_those_of_links_joints_frames_and_sites() {
    // The frames of the joints are those of their child links.
    let by = |a: &str, b: &str, more: &str| {
        let text = format!("{FIVE_BAR}{more}{}", closure("tip", "point", [a, b], ""));
        let m = read(&text).unwrap();
        mobility(&m);
        m
    };
    let links = by("left_tip", "right_tip", "");
    assert_eq!(by("left_end", "right_end", "").home(), links.home());
    let frames = "[[frame]]\nname = \"l\"\nlink = \"left_link2\"\nxyz = [0.3, 0, 0]\n\
                  [[frame]]\nname = \"r\"\nlink = \"right_link2\"\nxyz = [0.3, 0, 0]\n";
    let m = by("l", "r", frames);
    m.home().iter().zip(links.home()).for_each(|(a, b)| assert!((a - b).abs() < 1e-12));
    // Robots with names, one of them an MJCF model whose sites are frames.
    let folder = tempfile::tempdir().unwrap();
    let leg = "<mujoco><worldbody><body name='a'><joint name='j' axis='0 0 1'/>\
               <geom size='0.1'/><body name='b' pos='0.3 0 0'><joint name='k' axis='0 0 1'/>\
               <geom size='0.1'/><site name='tip' pos='0.2 0 0'/></body></body></worldbody></mujoco>";
    fs::write(folder.path().join("leg.xml"), leg).unwrap();
    let robot = |name: &str, x: f64| {
        format!(
            "[[robot]]\nname = \"{name}\"\nmodel = \"leg.xml\"\nbase = {{ xyz = [{x:?}, 0, 0] }}\n\
                 start = {{ k = 0.4 }}\n"
        )
    };
    let text = format!("{}{}", robot("l", 0.0), robot("r", 0.1))
        + &closure("tips", "point", ["l/tip", "r/tip"], "");
    let m = cylindroid::load_text(&text, &folder.path().join("legs.toml")).unwrap();
    assert!(apart(&m, "l/tip", "r/tip").0 < 1e-12);
    assert_eq!(mobility(&m).dof.dimension(), 2);
}

/// In the plane, with links of the file itself: a point leaves the rotation, a pose does not.
#[test]
fn frames_of_a_planar_file() {
    let bar = |name: &str, [a, b]: [&str; 2], x: f64, y: f64| {
        format!(
            "[[joint]]\nname = \"{name}\"\ntype = \"revolute\"\nbetween = [\"{a}\", \"{b}\"]\n\
             origin = [{x:?}, {y:?}]\n"
        )
    };
    let legs = bar("a", ["ground", "u"], 0.0, 0.0)
        + &bar("b", ["u", "v"], 0.0, 1.0)
        + &bar("c", ["ground", "w"], 1.5, 0.0)
        + &bar("d", ["w", "x"], 1.5, 1.0)
        + "[[frame]]\nname = \"f\"\nlink = \"v\"\nxyz = [1, 0.1, 0]\n\
           [[frame]]\nname = \"g\"\nlink = \"x\"\nxyz = [-0.8, 0, 0]\n";
    for (kind, dof) in [("point", 2), ("axis", 2), ("pose", 1)] {
        let text = format!("dimension = 2\n{legs}{}", closure("k", kind, ["f", "g"], ""));
        let m = read(&text).unwrap();
        let (distance, angle) = apart(&m, "f", "g");
        assert!(distance < 1e-12 && (kind != "pose" || angle < 1e-12), "{kind}");
        assert_eq!(mobility(&m).dof.dimension(), dof, "{kind}");
    }
}

/// A file that includes one with closures finds its links where they are assembled.
#[test]
fn included_closures_are_assembled_first() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    fs::copy(path().with_file_name("five_bar.urdf"), place("five_bar.urdf")).unwrap();
    let tip = closure("tip", "point", ["left_tip", "right_tip"], "");
    fs::write(place("inner.toml"), format!("{FIVE_BAR}{tip}")).unwrap();
    let inner = cylindroid::load_file(&place("inner.toml")).unwrap();
    let Pose { translation: t, .. } = frame(&inner, inner.home(), "left_tip");
    let rod = format!(
        "[[joint]]\nname = \"rod\"\ntype = \"spherical\"\nbetween = [\"r/left_tip\", \"rod\"]\n\
         origin = [{:?}, {:?}, {:?}]\n",
        t.x, t.y, t.z
    );
    let outer = format!("[[robot]]\nname = \"r\"\nmodel = \"inner.toml\"\n{rod}");
    let m = cylindroid::load_text(&outer, &place("outer.toml")).unwrap();
    for (c, q) in inner.coordinates().iter().zip(inner.home()) {
        let i = m.coordinates().iter().position(|o| o.name == format!("r/{}", c.name)).unwrap();
        assert_eq!(m.home()[i], *q, "{}", c.name);
    }
    assert_eq!(m.loops()[0].name, "r/tip");
    let rod = frame(&m, m.home(), "rod");
    assert_close(rod, Pose::from_translation(t), 1e-12);
    // Without the assembly the loops stay open, and say so.
    let open = formats::toml::parse(&outer, &place("outer.toml")).unwrap();
    assert_eq!(open.unassembled(), ["r/tip"]);
    assert!(apart(&open, "r/left_tip", "r/right_tip").0 > 0.08);
}

#[test]
fn a_loop_that_cannot_be_closed_says_by_how_much() {
    let far = "[[frame]]\nname = \"far\"\nlink = \"left_link2\"\nxyz = [2, 0, 0]\n";
    let tip = closure("tip", "point", ["far", "right_tip"], "");
    let text = format!("{FIVE_BAR}{far}{tip}");
    let error = refused(&text, read(&text));
    assert_eq!(pointed_at(&text, &error), "\"tip\"");
    // Stretched out: 2 m less the other links, 0.25 m, 0.2 m, 0.25 m and 0.3 m.
    for part in ["closure 'tip' cannot be closed", "remain 1.000 m apart", "'left_link2'"] {
        assert!(error.message.contains(part), "{error}");
    }
}

#[test]
fn closures_that_make_no_sense_are_pointed_at() {
    let five =
        |name, kind, between, more| format!("{FIVE_BAR}{}", closure(name, kind, between, more));
    let tips = ["left_tip", "right_tip"];
    let refused_at = |text: &str, place: &str, part: &str| {
        let error = refused(text, read(text));
        assert_eq!(pointed_at(text, &error), place);
        let all = format!("{} {}", error.message, error.help);
        assert!(all.contains(part), "{part} not in {all}");
    };
    refused_at(&five("t", "ball", tips, ""), "\"ball\"", "the types are pose, point, axis");
    let pair = ["left_tp", "right_tip"];
    refused_at(&five("t", "point", pair, ""), "[\"left_tp\", \"right_tip\"]", "nearest: left_tip");
    let pair = ["left_link2", "left_2"];
    refused_at(&five("t", "point", pair, ""), "[\"left_link2\", \"left_2\"]", "frames of one link");
    refused_at(
        &five("t", "point", tips, "axis = [0, 0, 1]"),
        "[0, 0, 1]",
        "only a closure of type",
    );
    refused_at(&five("t", "axis", tips, "axis = [0, 0, 0]"), "[0, 0, 0]", "no direction");
    refused_at(&five("left_1", "point", tips, ""), "\"left_1\"", "named 'left_1'");
    check("[[closure]]\nname = \"a\"\n", "", "the file has no joints");
}

/// A `fixed` joint does not glue the frames of robots where they happen to stand.
#[test]
fn fixed_joints_between_open_frames_are_refused() {
    let fixed = |more: &str| {
        let between = "between = [\"left_tip\", \"right_tip\"]";
        format!("{FIVE_BAR}[[joint]]\nname = \"weld\"\ntype = \"fixed\"\n{between}\n{more}\n")
    };
    let text = fixed("");
    let error = refused(&text, read(&text));
    assert_eq!(pointed_at(&text, &error), "\"fixed\"");
    assert!(error.message.contains("0.085 m and 1.500 rad apart"), "{error}");
    assert!(error.help.contains("[[closure]]"), "{error}");
    // At a point of the world they are welded as they are.
    let m = read(&fixed("origin = [0, 0.46, 0]")).unwrap();
    closed_at_home(&m, 1e-14);
    assert!(m.home().iter().all(|q| *q == 0.0));
}
