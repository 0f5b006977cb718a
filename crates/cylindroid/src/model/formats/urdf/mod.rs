//! URDF: links and joints from the ROS robot description.
//!
//! Formula  parent_from_child = Trans(xyz) Rz(yaw) Ry(pitch) Rx(roll) motion(axis, q)
//! Units    m, rad, kg, N, N m, as in the file
//! Valid    expanded URDF. xacro is refused with the command that expands it; MJCF and SDF are
//!          refused by name
//! Why so   real files are lax, so what the kinematics does not need is noted and never refused;
//!          what it does need is never guessed. A reader of our own, because the existing crate
//!          drops unknown elements, has no line numbers and reads missing limits as zero
//! Source   wiki.ros.org/urdf/XML; urdfdom for the defaults
//! Checked  tests/formats/urdf.rs, tests/formats/lax.rs, tests/formats/broken.rs

mod joint;
mod link;
mod mesh;
mod xml;

use std::collections::BTreeSet;
use std::path::Path;

use roxmltree::{Document, Node, ParsingOptions};

use self::mesh::Packages;
use self::xml::Reader;
use super::place::{Notes, Source};
use crate::error::{Error, Result};
use crate::model::Mechanism;

/// What to do with a xacro file.
const XACRO_HELP: &str = "expand it first: pip install xacro, then \
                          xacro file.urdf.xacro > file.urdf";

/// Reads the text of a URDF. The path is used in errors and to find meshes; nothing is read from
/// it.
///
/// # Errors
/// [`Error::File`] with line and column for broken XML, xacro, MJCF and SDF, a number that is not
/// one, a name that is missing or unknown, and all that the builder refuses.
pub fn parse(text: &str, path: &Path) -> Result<Mechanism> {
    let mut source = Source { format: "URDF", path, text };
    let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(|e| broken(&source, &e))?;
    let root = document.root_element();
    let tag = Reader::tag(root);
    match root.tag_name().name() {
        "robot" => {}
        "mujoco" | "mujocoinclude" => {
            source.format = "MJCF";
            let help = "give a URDF or a mechanism file; MuJoCo's own tools can convert";
            return Err(source.error(tag, "this is MJCF, which this version does not read", help));
        }
        "sdf" | "gazebo" => {
            source.format = "SDF";
            let help = "give the URDF it was made from, or a mechanism file";
            return Err(source.error(tag, "this is SDF, which this version does not read", help));
        }
        other => {
            let message = format!("the root element is <{other}>, a URDF begins with <robot>");
            return Err(source.error(tag, message, "give a URDF or a mechanism file"));
        }
    }
    refuse_xacro(&source, root)?;
    let namespace = root.tag_name().namespace();
    let mut reader = Reader { source, notes: Notes::default(), namespace };
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
    reader.leftovers(robot, &["name", "version"], &["link", "joint", "material"]);

    let materials = reader.materials(robot);
    let packages = Packages::of(path);
    let elements: Vec<_> = robot.children().filter(Node::is_element).collect();
    let mut links = BTreeSet::new();
    for node in &elements {
        if reader.is(*node, "link") {
            builder.link(reader.link(*node, &materials, &packages)?);
            links.extend(node.attribute("name"));
        }
    }
    for node in &elements {
        if reader.is(*node, "joint") {
            builder.joint(reader.joint(*node, &links)?);
        }
    }

    let report = builder.report();
    report.format = "URDF";
    std::mem::take(&mut reader.notes).write(&reader.source, report);
    builder.build().map_err(|e| place(reader, robot, e))
}

/// Finds the element that an error of the builder speaks of.
fn place(reader: &Reader<'_>, robot: Node<'_, '_>, error: Error) -> Error {
    let Error::Model { culprit, message, .. } = error else { return error };
    let named = |kind: &str| {
        let wanted = Some(culprit.as_str());
        robot.children().rfind(|n| reader.is(*n, kind) && n.attribute("name") == wanted)
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

/// xacro is told by its elements. A declared prefix alone says nothing: expanded files keep it.
fn refuse_xacro(source: &Source<'_>, root: Node<'_, '_>) -> Result<()> {
    let is_xacro = |n: &Node<'_, '_>| {
        let text = source.text.get(n.range().start..).unwrap_or("");
        text.starts_with("<xacro:")
            || (n.parent() == Some(root) && matches!(n.tag_name().name(), "macro" | "include"))
    };
    let extension = source.path.extension().is_some_and(|e| e.eq_ignore_ascii_case("xacro"));
    let element = root.descendants().filter(Node::is_element).find(is_xacro);
    let Some(node) = element.or(extension.then_some(root)) else { return Ok(()) };
    Err(xacro(source, Reader::tag(node)))
}

fn xacro(source: &Source<'_>, span: std::ops::Range<usize>) -> Error {
    source.error(span, "this is xacro, a program that writes a URDF, not a URDF", XACRO_HELP)
}

fn broken(source: &Source<'_>, error: &roxmltree::Error) -> Error {
    let position = error.pos();
    let offset = source.offset(position.row as usize, position.col as usize);
    let span = offset..offset + 1;
    if matches!(error, roxmltree::Error::UnknownNamespace(prefix, _) if prefix == "xacro") {
        return xacro(source, span);
    }
    let text = error.to_string();
    let message = text.strip_suffix(&format!(" at {position}")).unwrap_or(&text);
    source.error(span, format!("broken XML: {message}"), "")
}
