//! URDF: links and joints from the ROS robot description.
//!
//! Formula  parent_from_child = Trans(xyz) Rz(yaw) Ry(pitch) Rx(roll) motion(axis, q)
//! Units    m, rad, kg, N, N m, as in the file
//! Valid    expanded URDF. xacro that is not expanded is rejected with the command that does it
//! Why so   real files are lax, so errors outside the kinematics are reported and never rejected;
//!          kinematic data are never guessed. This reader is our own, because the existing crate
//!          drops unknown elements, has no line numbers and reads missing limits as zero
//! Source   wiki.ros.org/urdf/XML; urdfdom for the defaults
//! Checked  tests/formats/urdf.rs, tests/formats/lax.rs, tests/formats/broken.rs

mod joint;
mod link;

use std::collections::BTreeSet;
use std::path::Path;

use roxmltree::Node;

use super::mesh::Packages;
use super::span::Source;
use super::xml::{self, Reader};
use super::xml_limits;
use crate::error::{Error, Result};
use crate::model::Mechanism;
use crate::spatial::{Pose, Quaternion, Rotation, Rpy, Vec3};

/// Reads the text of a URDF. The path is used in errors and to find meshes; nothing is read from
/// it.
///
/// ```
/// use cylindroid::model::formats::urdf;
/// use std::path::Path;
///
/// let text = r#"<robot name="lever">
///     <link name="base"/><link name="lever"/>
///     <joint name="hinge" type="continuous">
///         <parent link="base"/><child link="lever"/><axis xyz="0 0 1"/>
///     </joint>
/// </robot>"#;
/// let robot = urdf::parse(text, Path::new("lever.urdf"))?;
/// assert_eq!((robot.name(), robot.n()), ("lever", 1));
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// # Errors
/// [`Error::File`] with line and column for broken XML, xacro, MJCF and SDF, an invalid number, a
/// name that is missing or unknown, and everything that the builder rejects.
pub fn parse(text: &str, path: &Path) -> Result<Mechanism> {
    read(text, path, path.extension().is_some_and(|e| e.eq_ignore_ascii_case("xacro")))
}

/// Reads the URDF that a xacro file expanded to.
pub(super) fn parse_expanded(text: &str, path: &Path) -> Result<Mechanism> {
    read(text, path, false)
}

fn read(text: &str, path: &Path, is_xacro: bool) -> Result<Mechanism> {
    let text = &*xml_limits::without_undeclared(text);
    let mut source = Source { format: "URDF", path, text };
    let document = xml::document(&source)?;
    let root = document.root_element();
    let tag = Reader::tag(root);
    match root.tag_name().name() {
        "robot" => {}
        "mujoco" | "mujocoinclude" => {
            source.format = "MJCF";
            let help = "load it by its path, or read it with formats::mjcf";
            return Err(source.error(tag, "this is MJCF, not a URDF", help));
        }
        "sdf" | "gazebo" => {
            source.format = "SDF";
            let help = "load it by its path, or read it with formats::sdf";
            return Err(source.error(tag, "this is SDF, not a URDF", help));
        }
        other => {
            let message = format!("the root element is <{other}>, a URDF begins with <robot>");
            return Err(source.error(tag, message, "give a URDF or a mechanism file"));
        }
    }
    refuse_xacro(&source, root, is_xacro)?;
    let namespace = root.tag_name().namespace();
    let mut reader = Reader::new(source, namespace);
    (reader.owners, reader.why) = (&["link", "joint"], why_unused);
    read_robot(&mut reader, root)
}

fn read_robot(reader: &mut Reader<'_>, robot: Node<'_, '_>) -> Result<Mechanism> {
    let path = reader.source.path;
    let name = robot.attribute("name").unwrap_or("").trim();
    let stem = path.file_stem().map(|s| s.to_string_lossy()).unwrap_or_default();
    let mut builder = Mechanism::builder(if name.is_empty() { &stem } else { name });
    if name.is_empty() {
        let why = "the robot has none; the name of the file is used";
        reader.notes.add(robot.range().start, "attribute 'name' of <robot> missing", why, "");
    }
    reader.unread_attributes(robot, &["name", "version"]);

    let materials = reader.materials(robot);
    let packages = Packages::of(path);
    let elements: Vec<_> = robot.children().filter(Node::is_element).collect();
    let mut links = BTreeSet::new();
    let mut count = 0;
    for node in &elements {
        if reader.is(*node, "link") {
            count += 1;
            reader.check_links(*node, count)?;
            builder.link(reader.link(*node, &materials, &packages)?);
            links.extend(node.attribute("name"));
        }
    }
    for node in &elements {
        if is_joint(reader, *node) {
            builder.joint(reader.joint(*node, &links)?);
        }
    }

    let report = builder.report();
    report.format = "URDF";
    reader.report(&[robot], report);
    builder.build().map_err(|e| place(reader, robot, e))
}

/// True for a joint, also one that only Drake reads: ball and universal.
fn is_joint(reader: &Reader<'_>, node: Node<'_, '_>) -> bool {
    let tag = node.document().input_text().get(Reader::tag(node));
    reader.is(node, "joint") || matches!(tag, Some("<drake:joint" | "<drake.joint"))
}

/// Finds the element to which an error of the builder refers.
fn place(reader: &Reader<'_>, robot: Node<'_, '_>, error: Error) -> Error {
    let Error::Model { culprit, message, .. } = error else { return error };
    let named = |kind: &str| {
        let culprit = Some(culprit.as_str());
        robot.children().rfind(|n| reader.is(*n, kind) && n.attribute("name") == culprit)
    };
    let (first, second) =
        if message.contains("joint") { ("joint", "link") } else { ("link", "joint") };
    let Some(node) = named(first).or_else(|| named(second)) else {
        return reader.source.error(Reader::tag(robot), message, "");
    };
    let mimic = node.children().find(|c| reader.is(*c, "mimic"));
    match mimic.filter(|_| message.contains("mimic")) {
        Some(mimic) => reader.refuse(mimic, "joint", message),
        None => reader.refuse(node, "name", message),
    }
}

/// xacro is recognised by its elements, not by a declared prefix, which expanded files keep.
fn refuse_xacro(source: &Source<'_>, root: Node<'_, '_>, is_xacro: bool) -> Result<()> {
    let of_xacro = |n: &Node<'_, '_>| {
        let text = source.text.get(n.range().start..).unwrap_or("");
        text.starts_with("<xacro:")
            || (n.parent() == Some(root) && matches!(n.tag_name().name(), "macro" | "include"))
    };
    let element = root.descendants().filter(Node::is_element).find(of_xacro);
    let Some(node) = element.or(is_xacro.then_some(root)) else { return Ok(()) };
    Err(xml::xacro(source, Reader::tag(node)))
}

impl Reader<'_> {
    /// The pose of the `<origin>` of an element; the identity if it has none.
    fn origin(&mut self, node: Node<'_, '_>) -> Result<Pose> {
        let Some(origin) = self.child(node, "origin") else { return Ok(Pose::IDENTITY) };
        self.leftovers(origin, &["xyz", "rpy", "quat_xyzw"], &[]);
        let translation = self.vector::<3>(origin, "xyz")?.map_or(Vec3::ZERO, Vec3::from_array);
        let rpy = self.vector::<3>(origin, "rpy")?;
        let quaternion = self.vector::<4>(origin, "quat_xyzw")?;
        let rotation = match (rpy, quaternion) {
            (None, None) => Rotation::IDENTITY,
            (Some([roll, pitch, yaw]), None) => Rpy { roll, pitch, yaw }.rotation(),
            (None, Some([x, y, z, w])) => Quaternion { w, x, y, z }
                .rotation()
                .map_err(|e| self.refuse(origin, "quat_xyzw", e.to_string()))?,
            (Some(_), Some(_)) => {
                let message = "<origin> has both rpy and quat_xyzw";
                return Err(self.refuse(origin, "quat_xyzw", message));
            }
        };
        Ok(Pose { rotation, translation })
    }
}

fn why_unused(element: &str) -> &'static str {
    match element {
        "dynamics" => "friction and damping do not enter the kinematics",
        "safety_controller" => "soft limits are not used; those of <limit> hold",
        "calibration" => "encoder references do not enter the kinematics",
        "texture" => "textures are not drawn; the colour is",
        "gazebo" | "transmission" | "sensor" | "ros2_control" | "plugin" => {
            "settings of simulators and controllers are not used"
        }
        _ => "not known to this reader",
    }
}
