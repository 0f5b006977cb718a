//! No number of a file is ignored silently: a file with one number changed gives another mechanism,
//! or an error, or its report names the place.

use std::path::Path;

use cylindroid::model::Ignored;
use cylindroid::model::formats::srdf;
use cylindroid::{Mechanism, Result, catalogue};

use crate::closed_file::FINGERS;
use crate::elasticity::{BARS, PARTS};
use crate::mjcf::read_mjcf;
use crate::sdf::read_sdf;
use crate::{read_toml, read_urdf};

/// The byte ranges of the numbers in the values of a text.
fn numbers(text: &str) -> Vec<std::ops::Range<usize>> {
    let is_part = |c: char| c.is_ascii_digit() || matches!(c, '.' | '-' | '+' | 'e' | 'E');
    let mut ranges = Vec::new();
    let mut at = 0;
    while let Some(start) = text[at..].find(is_part).map(|i| at + i) {
        let length = text[start..].find(|c| !is_part(c)).unwrap_or(text.len() - start);
        at = start + length;
        let alone = !text[..start].ends_with(|c: char| c.is_alphanumeric() || c == '_')
            && !text[at..].starts_with(|c: char| c.is_alphanumeric() || c == '_');
        if alone && text[start..at].parse::<f64>().is_ok() {
            ranges.push(start..at);
        }
    }
    ranges
}

/// All that a mechanism holds, without its report.
fn content(m: &Mechanism) -> String {
    let frames = (m.frames(), m.tool(), m.reference(), m.home(), m.name());
    let graph = (m.links(), m.joints(), m.loops(), m.contacts(), m.coordinates());
    format!("{graph:?} {frames:?} {:?}", m.elasticity())
}

fn ablate(name: &str, text: &str, read: impl Fn(&str) -> Result<Mechanism>) {
    ablate_content(name, text, |text| {
        read(text).map(|m| (content(&m), m.report().ignored.clone()))
    });
}

/// The same for anything that is read: its content, and what was ignored.
fn ablate_content(name: &str, text: &str, read: impl Fn(&str) -> Result<(String, Vec<Ignored>)>) {
    let (whole, _) = read(text).unwrap();
    let mut silent = Vec::new();
    for range in numbers(text) {
        let x: f64 = text[range.clone()].parse().unwrap();
        // One change may leave the same direction, the same quaternion, or the larger of two bounds.
        let near = if x.fract() == 0.0 { x + 1.0 } else { x * 1.25 };
        let others = [near, -x - 0.5, 10.0 * x, 0.0].map(|other| {
            let changed = format!("{}{other}{}", &text[..range.start], &text[range.end..]);
            read(&changed).ok()
        });
        let [Some(m), Some(b), Some(c), Some(d)] = others else { continue };
        let same = [&m, &b, &c, &d].iter().all(|(content, _)| *content == whole);
        let line = text[..range.start].matches('\n').count() + 1;
        // Notes of the same kind are one, with the line of the first; a note of an element is one
        // of all that it contains.
        let before = &text[..range.start];
        let key = before.rsplit('=').nth(1).unwrap_or("").rsplit(char::is_whitespace).next();
        let open = open_tags(before);
        let mut says: Vec<String> = open.iter().map(|tag| format!("<{tag}>")).collect();
        let tag = open.last().copied().unwrap_or("");
        says.push(format!("attribute '{}' of <{tag}>", key.unwrap_or("")));
        // The version of a format is no property of the robot.
        let is_version = key == Some("version");
        let noted = is_version
            || (m.1.iter())
                .any(|i| i.line == line || says.iter().any(|s| i.what.contains(s.as_str())));
        if same && !noted {
            let start = text[..range.start].rfind('\n').map_or(0, |i| i + 1);
            silent.push(format!(
                "{name}:{line}: {} in {}",
                &text[range],
                &text[start..].lines().next().unwrap()
            ));
        }
    }
    assert!(silent.is_empty(), "{} silent numbers:\n{}", silent.len(), silent.join("\n"));
}

/// The elements that are open at the end of a text.
fn open_tags(before: &str) -> Vec<&str> {
    let mut open = Vec::new();
    for part in before.split('<').skip(1) {
        let name = part.trim_start_matches('/');
        let name =
            &name[..name.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(name.len())];
        if part.starts_with('/') {
            open.pop();
        } else if !part.starts_with(['!', '?']) && !part.contains("/>") {
            open.push(name);
        }
    }
    open
}

/// One element or attribute in a line: a note counts for its line only.
fn lines(text: &str) -> String {
    let mut out = String::new();
    let mut inside = false;
    for c in text.trim_start().chars() {
        match c {
            '<' => {
                inside = true;
                out.push_str(if out.is_empty() { "<" } else { "\n<" });
            }
            '>' => {
                inside = false;
                out.push('>');
            }
            ' ' if inside && out.ends_with(['\'', '"']) => out.push('\n'),
            c => out.push(c),
        }
    }
    out
}

const URDF: &str = "<robot name='r' version='1.0'>
<material name='red'><color rgba='1 0 0 1' alpha='2'/></material>
<link name='a'><inertial><origin xyz='1 2 3' rpy='1 2 3'/><mass value='2' density='3'/>
<inertia ixx='1' ixy='2' ixz='3' iyy='4' iyz='5' izz='6' scale='7'/></inertial>
<visual><origin xyz='1 2 3'/><geometry><box size='1 2 3' bevel='1'/></geometry><material name='red'/></visual>
<collision><geometry><cylinder radius='1' length='2' segments='8'/></geometry></collision></link>
<link name='b'><visual><geometry><mesh filename='x.stl' scale='1 2 3'/></geometry></visual>7</link>
<link name='c'/>
<joint name='j' type='revolute'><parent link='a' weight='2'/><child link='b'/><origin xyz='1 2 3' rpy='1 2 3'/>
<axis xyz='1 2 3' w='1'/><limit lower='-1' upper='1' velocity='3' effort='4' jerk='5'/>
<dynamics damping='1' friction='2'/><safety_controller k_velocity='1' soft_lower_limit='2'/></joint>
<joint name='k' type='prismatic'><parent link='b'/><child link='c'/><axis xyz='0 0 1'/><limit lower='0' upper='9' effort='1' velocity='1'/>
<mimic joint='j' multiplier='2' offset='3' gain='4'/></joint>
<transmission name='t'><reduction>3</reduction></transmission></robot>";

const SDF: &str = "<sdf version='1.9'><model name='m'><pose degrees='1'>1 2 3 4 5 6</pose><self_collide>1</self_collide>
<link name='a'><inertial><mass>2</mass><density>3</density><pose>1 2 3 0 0 0</pose><inertia><ixx>1</ixx><ixy>2</ixy><ixz>3</ixz><iyy>4</iyy><iyz>5</iyz><izz>6</izz></inertia></inertial>
<visual name='v'><geometry><box><size>1 2 3</size><bevel>1</bevel></box></geometry><transparency>0.5</transparency><material><diffuse>1 0 0 1</diffuse><specular>1 1 1 1</specular></material></visual></link>
<link name='b'><gravity>1</gravity><collision name='c'><geometry><cylinder><radius>1</radius><length>2</length></cylinder></geometry><max_contacts>3</max_contacts></collision></link>
<link name='c'><collision name='e'><geometry><ellipsoid><radii>1 2 3</radii></ellipsoid></geometry></collision>
<collision name='p'><geometry><plane><normal>0 1 2</normal><size>3 4</size></plane></geometry></collision></link><link name='d'/>
<frame name='f' attached_to='b'><pose>1 2 3 0 0 0</pose><weight>3</weight></frame>
<joint name='j' type='revolute'><parent weight='2'>a</parent><child>b</child><pose>1 2 3 0 0 0</pose><axis><xyz w='2'>0 0 1</xyz><limit><lower>-1</lower><upper>1</upper><effort>3</effort><velocity>4</velocity><stiffness>5</stiffness></limit><dynamics><damping>3</damping></dynamics></axis></joint>
<joint name='k' type='revolute'><parent>b</parent><child>c</child><axis><xyz>0 1 0</xyz><mimic joint='j' delay='3'><multiplier>2</multiplier><offset>3</offset><reference>4</reference><speed>5</speed></mimic></axis></joint>
<joint name='l' type='screw'><parent>c</parent><child>d</child><screw_thread_pitch>2</screw_thread_pitch><axis><xyz>0 1 0</xyz></axis></joint>
</model></sdf>";

const MJCF: &str = "<mujoco model='m'><compiler angle='radian' boundmass='1' inertiagrouprange='0 3'/><option timestep='0.1'><flag contact='1'/></option><size njmax='3'/>
<default><joint armature='1' damping='2' range='-2 2'/><geom density='500' friction='1'/><motor ctrlrange='-3 3' kp='4'/></default>
<asset><material name='red' rgba='1 0 0 1' shininess='2'/><texture name='t' width='3'/></asset>
<worldbody><light pos='1 2 3'/><geom type='plane' size='1 1 1' solref='1 2'/>
<body name='a' pos='1 2 3' quat='1 2 3 4' gravcomp='1'><inertial pos='1 2 3' mass='2' diaginertia='1 2 3' weight='2'/><joint name='j' axis='1 2 3' pos='1 2 3' ref='1' stiffness='3'/>
<geom type='capsule' size='1 2' pos='1 2 3' rgba='1 0 0 1' margin='1'/><site name='s' pos='1 2 3' size='3'/>
<body name='b' euler='1 2 3'><joint name='k' type='slide'/><geom type='box' size='1 2 3' mass='3' material='red'/><camera pos='1 2 3'/>
<frame pos='1 2 3' weight='3'><body name='c'><joint name='l' range='-1 1'/><geom type='sphere' size='1' density='300'/></body></frame></body></body></worldbody>
<tendon><fixed name='t' width='3'><joint joint='j' coef='2'/><joint joint='l' coef='3'/></fixed></tendon>
<equality><tendon tendon1='t' polycoef='1 0 0 0 0' solref='1 1'/><joint joint1='k' joint2='j' polycoef='1 2 0 0 0'/><connect body1='c' anchor='1 2 3' solimp='1 2'/></equality>
<contact><exclude body1='a' body2='b' margin='3'/></contact>
<actuator><motor joint='j' gear='2' ctrlrange='-3 3' kp='4'/><position joint='k' kp='3' forcerange='-2 2'/></actuator>
<sensor><gyro site='s' noise='2'/></sensor><keyframe><key name='home' qpos='1 2 3' ctrl='1 2' time='3'/><key name='b' qpos='1 1 1'/></keyframe></mujoco>";

const TOML: &str = "name = 'r'
source = 'test'
tool = 'tip'
[[joint]]
name = 'j'
type = 'revolute'
between = ['ground', 'b']
origin = [1, 2, 3]
axis = [1, 2, 3]
actuated = true
limits = { lower = -1, upper = 1, velocity = 3, acceleration = 4, effort = 5 }
[[joint]]
name = 'k'
type = 'helical'
pitch = 2
between = ['b', 'c']
origin = [1, 2, 4]
axis = [1, 1, 2]
mimic = { joint = 'j', multiplier = 2, offset = 3 }
[[frame]]
name = 'tip'
link = 'c'
xyz = [1, 2, 3]
rpy = [1, 2, 3]";

const CONTACT: &str = "[[joint]]
name = 'j'
type = 'revolute'
between = ['ground', 'arm']
origin = [0, 0, 0]
axis = [0, 0, 1]
[[contact]]
name = 'c'
type = 'soft_finger'
tangent = [1, 0.8, -0.6]
between = ['arm', 'box']
point = [1, 0, 0]
normal = [0, 0.6, 0.8]
friction = 0.5
curvature = [100, { principal = [4, 1], direction = [2, 1, 0] }]";

#[test]
fn no_number_of_a_urdf_is_silent() {
    ablate("urdf", &lines(URDF), read_urdf);
    ablate("arm.urdf", &lines(crate::ARM_URDF), read_urdf);
}

#[test]
fn no_number_of_an_sdf_is_silent() {
    ablate("sdf", &lines(SDF), read_sdf);
    ablate("bars.sdf", &lines(include_str!("../data/bars.sdf")), read_sdf);
}

#[test]
fn no_number_of_an_mjcf_is_silent() {
    ablate("mjcf", &lines(MJCF), read_mjcf);
    ablate("zoo.xml", &lines(include_str!("../data/zoo.xml")), read_mjcf);
    ablate("loops.xml", &lines(include_str!("../data/loops.xml")), read_mjcf);
    ablate("copies.xml", &lines(include_str!("../data/copies.xml")), read_mjcf);
}

/// Sizes, poses and gears that a shape or a joint does not have; axes of joints without one.
#[test]
fn no_number_without_a_meaning_is_silent() {
    let geom = |attributes: &str| {
        format!(
            "<mujoco><worldbody><body name='a'><joint name='j' type='hinge' axis='0 1 2'/>\
             <geom {attributes}/></body></worldbody></mujoco>"
        )
    };
    for attributes in [
        "type='sphere' size='1 2 3'",
        "type='capsule' size='1 2 3'",
        "type='capsule' size='1 2 3' fromto='0 0 1 2 3 4' pos='1 2 3' euler='1 2 3'",
        "type='box' size='1 2 3' fromto='0 0 1 2 3 4' quat='1 2 3 4'",
        "type='cylinder' size='1 2' pos='1 2 3' axisangle='1 2 3 4'",
        "type='plane' size='1 2 3'",
    ] {
        ablate(attributes, &lines(&geom(attributes)), read_mjcf);
    }
    let motor = "<mujoco><worldbody><body name='a'><joint name='j' type='hinge' axis='0 1 2'/>\
                 <geom size='1'/></body></worldbody>\
                 <actuator><motor joint='j' gear='2 3 4 5 6 7' ctrlrange='-3 3'/></actuator></mujoco>";
    ablate("motor", &lines(motor), read_mjcf);
    for kind in ["floating", "spherical", "ball", "fixed", "universal", "planar"] {
        let urdf = format!(
            "<robot name='r'><link name='a'/><link name='b'/><joint name='j' type='{kind}'>\
             <parent link='a'/><child link='b'/><axis xyz='1 2 3'/><limit velocity='3'/></joint></robot>"
        );
        ablate(kind, &lines(&urdf), read_urdf);
    }
    for kind in ["ball", "fixed", "continuous", "universal"] {
        let sdf = format!(
            "<sdf version='1.9'><model name='m'><link name='a'/><link name='b'/>\
             <joint name='j' type='{kind}'><parent>a</parent><child>b</child>\
             <axis><xyz>1 2 3</xyz><limit><lower>-2</lower><upper>3</upper></limit></axis>\
             </joint></model></sdf>"
        );
        ablate(kind, &lines(&sdf), read_sdf);
    }
}

#[test]
fn no_number_of_an_srdf_is_silent() {
    let text = "<robot name='r' version='2'><group name='g' priority='2'><joint name='a' weight='2'/>
<link name='l' order='3'/><chain base_link='b' tip_link='c' length='4'/><group name='h' rank='2'/><plugin rate='3'/></group>
<group name='h'/><group_state name='s' group='g' time='3'><joint name='a' value='1 2' speed='3'/><gain>4</gain></group_state>
<end_effector name='e' group='h' parent_link='c' mass='2'/><virtual_joint name='v' type='fixed' offset='2'/>
<passive_joint name='p' damping='2'/><disable_collisions link1='a' link2='b' reason='Never' count='3'/>
<enable_collisions link1='a' link2='b' count='3'/><disable_default_collisions link='c' count='3'/>
<link_sphere_approximation link='a'><sphere center='1 2 3' radius='2'/></link_sphere_approximation></robot>";
    ablate_content("srdf", &lines(text), |text| {
        let srdf = srdf::parse(text, Path::new("r.srdf"))?;
        let parts = (&srdf.groups, &srdf.states, &srdf.end_effectors, &srdf.passive_joints);
        let pairs = (&srdf.disabled, &srdf.disabled_by_default, &srdf.enabled);
        Ok((format!("{parts:?} {pairs:?}"), srdf.report.ignored.clone()))
    });
}

#[test]
fn no_number_of_a_mechanism_file_is_silent() {
    ablate("toml", TOML, read_toml);
    ablate("arm.toml", crate::ARM_TOML, read_toml);
    ablate("tables of contacts", FINGERS, read_toml);
    ablate("contact in space", CONTACT, read_toml);
    ablate("elasticity", &format!("{BARS}{PARTS}"), read_toml);
    ablate("parameters", include_str!("../data/five_bar_parameters.toml"), read_toml);
}

/// Arms of Denavit-Hartenberg tables, closed chains, contacts and robots that include robots.
#[test]
fn no_number_of_the_catalogue_is_silent() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/model/catalogue");
    for name in catalogue::names() {
        let text = std::fs::read_to_string(folder.join(format!("{name}.toml"))).unwrap();
        // Numbers of prose are none of the mechanism.
        let is_prose =
            |l: &&str| ["#", "source =", "description ="].iter().any(|p| l.starts_with(p));
        let text: Vec<&str> = text.lines().filter(|l| !is_prose(l)).collect();
        ablate(name, &text.join("\n"), read_toml);
    }
}
