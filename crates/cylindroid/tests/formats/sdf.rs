//! SDF: frames and axes of the versions, loops, kinds, what is noted and refused.

use std::f64::consts::PI;
use std::path::Path;

use cylindroid::model::{Geometry, JointKind, formats};
use cylindroid::{Mechanism, Pose, Result, Rotation, Vec3};

use crate::fk::{assert_close, closed_at_home, frame};
use crate::{pointed_at, refused, report};

const BARS: &str = include_str!("../data/bars.sdf");

pub(crate) fn read_sdf(text: &str) -> Result<Mechanism> {
    formats::sdf::parse(text, Path::new("robots/test.sdf"))
}

fn read(text: &str) -> Mechanism {
    let m = read_sdf(text).unwrap();
    closed_at_home(&m, 1e-12);
    m
}

#[track_caller]
fn check(text: &str, at: &str, says: &str) {
    let error = refused(text, read_sdf(text));
    let all = format!("{} ({})", error.message, error.help);
    assert!(all.contains(says), "'{says}' not in: {all}");
    assert!(pointed_at(text, &error).starts_with(at), "{all}: {:?}", pointed_at(text, &error));
}

fn model(version: &str, inside: &str) -> String {
    format!("<sdf version='{version}'><model name='m'>{inside}</model></sdf>")
}

fn link(name: &str, pose: &str) -> String {
    format!("<link name='{name}'><pose>{pose}</pose></link>")
}

fn joint(kind: &str, inside: &str) -> String {
    format!("<joint name='j' type='{kind}'><parent>a</parent><child>b</child>{inside}</joint>")
}

fn turn(axis: Vec3, angle: f64) -> Rotation {
    Rotation::about(axis, angle).unwrap()
}

fn at(x: f64, y: f64, z: f64) -> Pose {
    Pose::from_translation(Vec3::new(x, y, z))
}

fn find<'m>(m: &'m Mechanism, name: &str) -> &'m cylindroid::model::Joint {
    m.joints().iter().find(|j| j.name == name).unwrap()
}

/// The canonical link is the root: poses are relative to it.
#[test]
fn poses_follow_relative_to() {
    let m = read(BARS);
    assert_eq!((m.name(), m.links()[0].name.as_str()), ("bars", "base"));
    let hub = at(0.2, 0.0, 0.0) * Pose::from_rotation(Rotation::about_z(PI / 2.0));
    assert_close(frame(&m, m.home(), "hub"), hub, 1e-15);
    let crank = hub * at(0.0, 0.0, 0.1) * Pose::from_rotation(turn(Vec3::X, 0.3));
    assert_close(frame(&m, m.home(), "crank"), crank, 1e-15);
    let coupler = crank * at(1.0, 0.0, 0.0);
    assert_close(frame(&m, m.home(), "coupler"), coupler, 1e-15);
    assert_close(frame(&m, m.home(), "rocker"), hub * at(2.0, 0.0, 0.0), 1e-15);
    // The crank turns about an axis of the hub through a point of its own.
    let mut q = m.home().to_vec();
    q[find(&m, "turn").coordinates.start] = 0.7;
    let world_from_joint = crank * at(0.0, 0.05, 0.0) * Pose::from_rotation(Rotation::about_z(0.2));
    let point = world_from_joint.translation;
    let spin = turn(hub.rotation * Vec3::Y, 0.7);
    let about = Pose { rotation: spin, translation: point - spin * point };
    assert_close(frame(&m, &q, "crank"), about * crank, 1e-14);
}

#[test]
fn joints_close_loops() {
    let m = read(BARS);
    assert_eq!((m.n(), m.loops().len()), (1 + 2 + 1, 1));
    let wrist = &m.loops()[0];
    assert_eq!((wrist.name.as_str(), wrist.kind), ("wrist", JointKind::Spherical));
    assert_eq!([wrist.a, wrist.b].map(|i| m.links()[i].name.as_str()), ["rocker", "coupler"]);
    assert_close(wrist.link_b_from_joint, at(1.0, 0.0, 0.0), 1e-15);
    assert_eq!(find(&m, "heel").kind, JointKind::Helical { pitch: 0.5 / (2.0 * PI) });
    let limits = find(&m, "turn").limits;
    assert_eq!((limits.lower, limits.upper, limits.effort), (-1.0, 2.0, 30.0));
    assert_eq!(limits.velocity, f64::INFINITY);
    let actuated: Vec<&str> = m.actuated().map(|i| m.coordinates()[i].name.as_str()).collect();
    assert_eq!(actuated, ["turn", "heel"]);
    let said = report(&m);
    for what in [
        "<joint> of type gearbox (geared)",
        "<dynamics> (turn)",
        "<sensor> (base): settings of the simulator",
        "motors: SDF names none",
    ] {
        assert!(said.contains(what), "'{what}' not in\n{said}");
    }
    let base = &m.links()[0];
    assert_eq!(base.inertial.unwrap().mass, 2.0);
    let plate = &base.visuals[0];
    assert_eq!(plate.geometry, Geometry::Box { size: Vec3::new(0.4, 0.2, 0.1) });
    assert_eq!(plate.rgba, Some([1.0, 0.0, 0.0, 1.0]));
}

/// The five files of Agility's Cassie: loops, balls, gearboxes, axes in the model's frame.
#[test]
fn cassie_has_its_loops() {
    let folder = crate::robots().join("cassie_description/robots");
    for (file, loops, gearboxes) in [
        ("cassie", 6, 10),
        ("cassie_reduced", 4, 0),
        ("cassie_simple", 4, 0),
        ("cassie_v2", 4, 0),
        ("cassie_wo_gearbox_spring", 4, 0),
    ] {
        let path = folder.join(format!("{file}.sdf"));
        let m = cylindroid::load_file(&path).unwrap();
        assert_eq!(m.report().format, "SDF");
        closed_at_home(&m, 1e-12);
        let text = std::fs::read_to_string(&path).unwrap();
        let world = usize::from(text.contains(">world<"));
        // Loops that an actuated joint closes are cut in a link.
        let cut = m.loops().iter().filter(|l| l.name.ends_with(".weld")).count();
        assert_eq!(cut, if file == "cassie" { 2 } else { 0 }, "{file}");
        assert_eq!(m.links().len(), text.matches("<link name").count() + world + cut, "{file}");
        let joints = m.joints().len() - cut + m.loops().len() + gearboxes;
        assert_eq!(joints, text.matches("<joint name").count(), "{file}");
        // A connected graph has as many loops as joints beyond a tree.
        assert_eq!(m.joints().len(), m.links().len() - 1);
        assert_eq!(m.loops().len(), loops, "{file}");
        let says = report(&m).contains("<joint> of type gearbox (10 times");
        assert_eq!(says, gearboxes > 0, "{file}");
    }
    // The two legs mirror one another in the plane x-z of the model.
    let m = cylindroid::load_file(&folder.join("cassie_v2.sdf")).unwrap();
    let pelvis = frame(&m, m.home(), "pelvis").inverse();
    for closing in m.loops().iter().filter(|l| l.name.starts_with("left")) {
        let other = closing.name.replace("left", "right");
        let right = m.loops().iter().find(|l| l.name == other).unwrap();
        let place = |l: &cylindroid::model::LoopJoint| {
            let link = frame(&m, m.home(), &m.links()[l.a].name);
            (pelvis * link * l.link_a_from_joint).translation
        };
        let (l, r) = (place(closing), place(right));
        let mirrored = Vec3::new(r.x, -r.y, r.z);
        assert!((l - mirrored).norm() < 2e-3, "{}: {l:?} {r:?}", closing.name);
    }
}

/// Up to 1.4 an axis is in the model's axes; then in the joint's, unless it says otherwise.
#[test]
fn joints_have_axes_by_version() {
    let links = link("a", "0 0 0 0 0 0") + &link("b", "0 0 0 0 0 1.5707963267948966");
    let axis = |more: &str| joint("revolute", &format!("<axis><xyz>1 0 0</xyz>{more}</axis>"));
    let in_root = |version: &str, more: &str| {
        let m = read(&model(version, &format!("{links}{}", axis(more))));
        let joint = find(&m, "j");
        joint.parent_from_joint.rotation * joint.axis
    };
    let close = |a: Vec3, b: Vec3| assert!((a - b).norm() < 1e-15, "{a:?}");
    close(in_root("1.4", ""), Vec3::X);
    close(in_root("1.5", ""), Vec3::Y);
    close(in_root("1.6", "<use_parent_model_frame>1</use_parent_model_frame>"), Vec3::X);
    close(in_root("1.6", "<use_parent_model_frame>false</use_parent_model_frame>"), Vec3::Y);
    close(in_root("1.11", ""), Vec3::Y);
    let text =
        model("1.8", &format!("{links}{}", axis("").replace("<xyz>", "<xyz expressed_in='a'>")));
    close(find(&read(&text), "j").axis, -Vec3::Y);
}

#[test]
fn joints_of_all_kinds() {
    let links = link("a", "0 0 0 0 0 0") + &link("b", "1 0 0 0 0 0");
    let axis = "<axis><xyz>0 1 0</xyz></axis>";
    for (kind, inside, expected) in [
        ("revolute", axis, JointKind::Revolute),
        ("continuous", axis, JointKind::Continuous),
        ("prismatic", axis, JointKind::Prismatic),
        ("fixed", "", JointKind::Fixed),
        ("ball", "", JointKind::Spherical),
        ("screw", "<thread_pitch>-20</thread_pitch>", JointKind::Helical { pitch: 0.05 }),
        (
            "universal",
            "<axis><xyz>0 1 0</xyz></axis><axis2><xyz>1 0 0</xyz></axis2>",
            JointKind::Universal { second: Vec3::X },
        ),
    ] {
        let m = read(&model("1.7", &format!("{links}{}", joint(kind, inside))));
        assert_eq!(find(&m, "j").kind, expected);
        assert_eq!(m.links()[0].name, "a");
    }
    // A limit of 1e16 is none.
    let limit =
        "<axis><xyz>0 0 1</xyz><limit><lower>-1e16</lower><upper>inf</upper></limit></axis>";
    let m = read(&model("1.7", &format!("{links}{}", joint("revolute", limit))));
    assert_eq!(find(&m, "j").limits, cylindroid::model::Limits::NONE);
}

/// Where the tree meets the child first, the joint is the inverse motion.
#[test]
fn joints_from_far_to_near() {
    let links = link("root", "0 0 0 0 0 0") + &link("far", "1 0 0 0.1 0.2 0.3");
    let ends = "<parent>far</parent><child>root</child><pose>0.5 0 0 0 0 0.4</pose>";
    let joint = |kind: &str, rest: &str| {
        model("1.7", &format!("{links}<joint name='j' type='{kind}'>{ends}{rest}</joint>"))
    };
    let m = read(&joint("revolute", "<axis><xyz>0 1 0</xyz></axis>"));
    let place = at(0.5, 0.0, 0.0) * Pose::from_rotation(Rotation::about_z(0.4));
    let home = frame(&m, &[0.0], "far");
    // The motion of the child relative to the parent is q about the axis.
    let moved = frame(&m, &[0.6], "far").inverse() * place;
    let still = home.inverse() * place;
    let expected = Pose::from_rotation(turn(Vec3::Y, 0.6));
    assert_close(still.inverse() * moved, expected, 1e-14);

    let axes = "<axis><xyz>0 1 0</xyz></axis><axis2><xyz>1 0 0</xyz></axis2>";
    let m = read(&joint("universal", axes));
    assert!(find(&m, "j").reversed);
    let moved = frame(&m, &[0.3, 0.8], "far").inverse() * place;
    let expected = Pose::from_rotation(turn(Vec3::Y, 0.3) * turn(Vec3::X, 0.8));
    assert_close(still.inverse() * moved, expected, 1e-14);
    assert!(!report(&m).contains("(j)"), "{}", report(&m));
}

#[test]
fn worlds_static_models_and_loose_links() {
    let links = link("a", "0 0 1 0 0 0") + &link("b", "1 0 0 0 0 0");
    let fix = "<joint name='fix' type='fixed'><parent>world</parent><child>a</child></joint>";
    let text = model("1.7", &format!("<pose>0 0 2 0 0 0</pose>{links}{fix}"));
    let m = read(&text);
    assert_eq!(m.links()[0].name, "world");
    assert_close(frame(&m, m.home(), "a"), at(0.0, 0.0, 3.0), 1e-15);
    // b hangs on nothing: a free body, and the report says so.
    assert_eq!((m.n(), find(&m, "b.base").kind), (6, JointKind::Free));
    assert!(report(&m).contains("link without a joint (b)"));
    let m = read(&model("1.7", &format!("<static>true</static>{links}")));
    assert_eq!((m.n(), m.links().len()), (0, 3));
    let nested = format!(
        "<sdf version='1.8'><world name='w'><light/><model name='m'>{}\
         <model name='sub'><pose relative_to='a'>0 1 0 0 0 0</pose>{}<frame name='f'/></model>\
         <joint name='j' type='revolute'><parent>a</parent><child>sub::c</child>\
         <axis><xyz>0 0 1</xyz></axis></joint></model><model name='other'/></world></sdf>",
        link("a", "0 0 1 0 0 0"),
        link("c", "0 0 0.5 0 0 0"),
    );
    let m = read(&nested);
    assert_close(frame(&m, m.home(), "sub::c"), at(0.0, 1.0, 0.5), 1e-15);
    assert_close(frame(&m, m.home(), "sub::f"), at(0.0, 1.0, 0.0), 1e-15);
    assert!(report(&m).contains("further <model> (other)") && report(&m).contains("<light>"));
}

#[test]
fn mimics_are_read() {
    let three = link("a", "0 0 0 0 0 0") + &link("b", "0 0 0 0 0 0") + &link("c", "0 0 0 0 0 0");
    let text = model(
        "1.11",
        &format!(
            "{three}{}<joint name='k' type='revolute'><parent>b</parent><child>c</child><axis>\
             <xyz>0 0 1</xyz><mimic joint='j'><multiplier>2</multiplier><offset>0.5</offset>\
             <reference>0.1</reference></mimic></axis></joint>",
            joint("revolute", "<axis><xyz>0 0 1</xyz></axis>")
        ),
    );
    let m = read(&text);
    let mimic = find(&m, "k").mimic.clone().unwrap();
    assert_eq!((m.n(), mimic.multiplier, mimic.offset), (1, 2.0, 0.3));
}

#[test]
fn what_is_broken_is_pointed_at() {
    check("<sdf", "", "broken XML");
    check("<sdf version='x'/>", "x", "is not a number");
    check("<sdf version='1.6'/>", "<sdf", "this SDF has no <model>");
    check("<robot/>", "<robot", "SDF begins with <sdf>");
    let links = link("a", "0 0 0 0 0 0") + &link("b", "0 0 0 0 0 0");
    let of = |inside: &str| model("1.7", &format!("{links}{inside}"));
    check(&of("<link/>"), "<link", "<link> has no name");
    check(&of(&link("a", "0 0 0 0 0 0")), "a", "are named 'a'");
    check(&of(&link("c", "0 0 0 0 0")), "0 0 0 0 0", "has 5 numbers, expected 6");
    check(&of(&link("c", "0 0 0 0 0 x")), "0 0 0 0 0 x", "'x' is not a number");
    check(&of(&link("c", "0 0 0 0 0 inf")), "0 0 0 0 0 inf", "not finite");
    check(
        &of("<link name='c'><pose relative_to='d'/></link>"),
        "d",
        "no link, joint or frame named 'd'",
    );
    let ring = "<frame name='f'><pose relative_to='g'/></frame><frame name='g'><pose relative_to='f'/></frame>";
    check(&of(&format!("{ring}{}", joint("fixed", ""))), "g", "in a ring");
    let ring = "<frame name='f' attached_to='g'/><frame name='g' attached_to='f'/>";
    assert!(refused(&of(ring), read_sdf(&of(ring))).message.contains("in a ring"));
    check(&of(&joint("hinge", "")), "hinge", "no joint type named 'hinge'");
    check(&of(&joint("revolute", "").replace("<child>b</child>", "")), "<joint", "has no <child>");
    check(&of(&joint("revolute", "").replace("<child>b", "<child>c")), "c", "named 'c'");
    check(&of(&joint("revolute", "").replace("<child>b", "<child>a")), "j", "with itself");
    check(&of(&joint("revolute", "<axis><xyz>0 0 0</xyz></axis>")), "0 0 0", "no direction");
    check(&of(&joint("revolute", "<axis><xyz>0 0</xyz></axis>")), "0 0", "expected 3");
    let far = "<axis><xyz expressed_in='f'>0 0 1</xyz></axis>";
    check(&of(&joint("revolute", far)), "f", "named 'f'");
    let limit = "<axis><limit><lower>2</lower><upper>1</upper></limit></axis>";
    check(&of(&joint("revolute", limit)), "<limit", "above its upper limit 1");
    check(&of(&joint("screw", "<thread_pitch>0</thread_pitch>")), "j", "0 rad/m");
    let axes = "<axis><xyz>0 0 1</xyz></axis><axis2><xyz>0 0 2</xyz></axis2>";
    check(&of(&joint("universal", axes)), "j", "parallel");
    let mimic = "<axis><mimic joint='k'/></axis>";
    check(&of(&joint("revolute", mimic)), "j", "no joint named 'k'");
}

/// A robot of included parts: a folder with a `model.config`, a file, one of them twice.
#[test]
fn includes_are_nested_models() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, text).unwrap();
        path
    };
    write(
        "models/wheel/model.config",
        "<model><name>w</name><sdf version='1.5'>w.sdf</sdf></model>",
    );
    write(
        "models/wheel/w.sdf",
        "<sdf version='1.4'><model name='wheel'><pose>9 9 9 0 0 0</pose><link name='rim'/>\
         <link name='cap'><pose>0 0 1 0 0 0</pose></link>\
         <joint name='spin' type='revolute'><parent>rim</parent><child>cap</child>\
         <axis><xyz>0 1 0</xyz></axis></joint></model></sdf>",
    );
    write(
        "models/plain/model.sdf",
        "<sdf version='1.9'><model name='box'><link name='b'/></model></sdf>",
    );
    let main = write(
        "models/robot/robot.sdf",
        "<sdf version='1.9'><world name='w'>\
         <model name='ground'><static>1</static><link name='g'/></model>\
         <model name='robot'><link name='base'/>\
         <include><uri>model://wheel</uri><name>left</name><pose>0 1 0 0 0 0</pose></include>\
         <include><uri>../wheel/w.sdf</uri><name>right</name></include>\
         <include><uri>../plain</uri></include><include><uri>model://none</uri></include>\
         <joint name='l' type='fixed'><parent>base</parent><child>left::rim</child></joint>\
         <joint name='r' type='fixed'><parent>base</parent><child>right::rim</child></joint>\
         <joint name='b' type='fixed'><parent>base</parent><child>box::b</child></joint>\
         </model></world></sdf>",
    );
    let m = cylindroid::load_file(&main).unwrap();
    assert_eq!((m.name(), m.n()), ("robot", 2));
    let at = |name: &str| frame(&m, m.home(), name).translation;
    assert_eq!(at("left::cap"), Vec3::new(0.0, 1.0, 1.0));
    assert_eq!(at("right::cap"), Vec3::new(9.0, 9.0, 10.0));
    let said = report(&m);
    assert!(said.contains("further <model> (ground)"), "{said}");
    assert!(
        said.contains("<include>") && said.contains("what it would bring is missing"),
        "{said}"
    );
    assert!(said.contains("that of the <include> counts"), "{said}");
    let itself = write(
        "a.sdf",
        "<sdf version='1.9'><model name='a'><link name='l'/><include><uri>a.sdf</uri></include>\
         </model></sdf>",
    );
    let error = cylindroid::load_file(&itself).unwrap_err().to_string();
    assert!(error.contains("includes more than 1000 files"), "{error}");
}

/// A world whose objects are files: each is noted once, with the reason, and what they include is
/// not noted as unknown.
#[test]
fn included_objects_of_a_world_are_noted_once() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, inside: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, format!("<sdf version='1.9'>{inside}</sdf>")).unwrap();
        path
    };
    write("lid.sdf", "<model name='lid'><link name='l'/></model>");
    write(
        "box.sdf",
        "<model name='box'><link name='b'/><include><uri>lid.sdf</uri></include></model>",
    );
    let world = write(
        "world.sdf",
        "<world name='w'><model name='arm'><link name='a'/><link name='b'/>\
         <joint name='j' type='revolute'><parent>a</parent><child>b</child>\
         <axis><xyz>0 0 1</xyz></axis></joint></model>\
         <include><uri>box.sdf</uri></include></world>",
    );
    let said = report(&cylindroid::load_file(&world).unwrap());
    assert_eq!(said.lines().count(), 1, "{said}");
    assert!(said.contains("further <model> (box)"), "{said}");
}

/// Of several robots in a world each is read by its name, that of an `<include>` too; the report and
/// the error say how.
#[test]
fn a_model_of_a_world_is_chosen_by_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let arm = |name: &str, joint: &str| {
        format!(
            "<model name='{name}'><link name='a'/><link name='b'/>\
             <joint name='{joint}' type='revolute'><parent>a</parent><child>b</child>\
             <axis><xyz>0 0 1</xyz></axis></joint></model>"
        )
    };
    let write = |name: &str, inside: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, format!("<sdf version='1.9'>{inside}</sdf>")).unwrap();
        path.to_string_lossy().into_owned()
    };
    write("lift.sdf", &arm("lift", "l"));
    let world = format!(
        "<world name='w'><model name='ground'><link name='g'/></model>{}{}\
         <include><uri>lift.sdf</uri><name>hoist</name></include></world>",
        arm("left arm", "j"),
        arm("right", "k"),
    );
    let world = write("two#arms.sdf", &world);
    let read = |name: &str| cylindroid::load(&format!("{world}{name}"));
    for (given, name, joint) in [
        ("", "left arm", Some("j")),
        ("#left arm", "left arm", Some("j")),
        ("#right", "right", Some("k")),
        ("#hoist", "hoist", Some("l")),
        ("#ground", "ground", None),
    ] {
        let m = read(given).unwrap();
        let found = m.joints().iter().find(|j| j.kind.dof() == 1).map(|j| j.name.as_str());
        assert_eq!((m.name(), found), (name, joint), "{given}");
        let said = report(&m);
        assert!(said.contains("FILE.sdf#NAME"), "{said}");
        for other in ["left arm", "right", "hoist", "ground"] {
            assert_eq!(said.contains(other), other != name, "{given}: {said}");
        }
    }
    let error = read("#lift").unwrap_err().to_string();
    let says = ["no model 'lift'", "it has ground, left arm, right, hoist"];
    assert!(says.iter().all(|part| error.contains(part)), "{error}");
    let arm = folder.path().join("arm.urdf");
    std::fs::write(&arm, "<robot name='r'><link name='a'/></robot>").unwrap();
    let error = cylindroid::load(&format!("{}#r", arm.display())).unwrap_err().to_string();
    assert!(error.contains("names a model of an SDF file"), "{error}");
    assert!(cylindroid::load("none.sdf#r").is_err());
}

/// Nothing but nested models: the canonical link is that of the first.
#[test]
fn a_model_without_links_has_the_canonical_link_of_its_first_model() {
    let m = read(
        "<sdf version='1.9'><model name='m'><model name='n'><pose>1 0 0 0 0 0</pose><link name='a'/>\
         <link name='b'/><joint name='j' type='revolute'><parent>a</parent><child>b</child>\
         <axis><xyz>0 0 1</xyz></axis></joint></model></model></sdf>",
    );
    assert_eq!((m.n(), m.links()[0].name.as_str()), (1, "n::a"));
}

/// Elements of Drake and others whose prefix has no declaration, as in many files.
#[test]
fn prefixes_need_no_declaration() {
    let text =
        "<sdf version='1.9'><model name='m'><drake:x/><link name='a' my:b='1'/></model></sdf>";
    let said = report(&read(text));
    assert_eq!(said.lines().count(), 2, "{said}");
}
