//! SRDF: groups of joints, their named states and end effectors, and the pairs of links whose
//! collisions are disabled.
//!
//! Valid    `<group>` of `<joint>`, `<link>`, `<chain>` and other groups, `<group_state>`,
//!          `<end_effector>`, `<passive_joint>`, `<disable_collisions link1 link2>`,
//!          `<disable_default_collisions link>` and `<enable_collisions link1 link2>`, in any order: a
//!          pair that is enabled is not disabled by default. Virtual joints, collision spheres,
//!          properties and what other programs add are in the report
//! Source   MoveIt, srdfdom 2
//! Checked  tests/collision/files.rs::srdf_*, tests/formats/srdf.rs

mod group;

use std::path::Path;

use roxmltree::Node;

use super::span::Source;
use super::text_file;
use super::xml::{self, Reader};
use crate::error::Result;
use crate::model::{LoadReport, Mechanism};

/// What an SRDF says about a robot, by the names of its links and joints.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Srdf {
    /// The groups of joints.
    pub groups: Vec<Group>,
    /// The named states of groups.
    pub states: Vec<GroupState>,
    /// The end effectors.
    pub end_effectors: Vec<EndEffector>,
    /// Joints without drives.
    pub passive_joints: Vec<String>,
    /// Pairs of `<disable_collisions>`.
    pub disabled: Vec<[String; 2]>,
    /// Links of `<disable_default_collisions>`: disabled against all others.
    pub disabled_by_default: Vec<String>,
    /// Pairs of `<enable_collisions>`, exceptions from the default.
    pub enabled: Vec<[String; 2]>,
    /// What was not read.
    pub report: LoadReport,
}

/// A group of joints: the union of its parts.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Group {
    /// Its name.
    pub name: String,
    /// Joints.
    pub joints: Vec<String>,
    /// Links: the joints that move them.
    pub links: Vec<String>,
    /// Chains from a base link to a tip link: the joints between.
    pub chains: Vec<[String; 2]>,
    /// Other groups.
    pub groups: Vec<String>,
}

/// A named configuration of a group.
#[derive(Debug, Clone, PartialEq)]
pub struct GroupState {
    /// Its name.
    pub name: String,
    /// The group, where the file names it.
    pub group: Option<String>,
    /// Joints with their positions [rad or m].
    pub joints: Vec<(String, Vec<f64>)>,
}

/// An end effector.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EndEffector {
    /// Its name.
    pub name: String,
    /// The group of its own joints.
    pub group: String,
    /// The link that carries it: the tip of the arm.
    pub parent_link: String,
    /// The group of the arm, where the file names it.
    pub parent_group: Option<String>,
}

/// Reads the text of an SRDF. The path is for errors only.
///
/// ```
/// use cylindroid::model::formats::srdf;
///
/// let text = r#"<robot name="r"><disable_collisions link1="a" link2="b" reason="Never"/></robot>"#;
/// let srdf = srdf::parse(text, "r.srdf".as_ref())?;
/// assert_eq!(srdf.disabled, [["a".to_owned(), "b".to_owned()]]);
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// # Errors
/// [`Error::File`](crate::Error::File) for broken XML, another root element, a missing name, a position
/// that is not a number.
pub fn parse(text: &str, path: &Path) -> Result<Srdf> {
    let source = Source { format: "SRDF", path, text };
    let document = xml::document(&source)?;
    let root = document.root_element();
    let mut reader = Reader::new(source, root.tag_name().namespace());
    (reader.owners, reader.why) = (&["group", "group_state", "end_effector"], why_unused);
    if root.tag_name().name() != "robot" {
        let message = format!("<{}> is not the root of an SRDF", root.tag_name().name());
        return Err(reader.error(root, Reader::tag(root), message, "an SRDF begins with <robot>"));
    }
    reader.unread_attributes(root, &["name", "version"]);
    let mut srdf = Srdf::default();
    for node in elements(root) {
        let tag = node.tag_name().name();
        let Some(known) = attributes(tag) else { continue };
        reader.unread_attributes(node, known);
        match tag {
            "group" => {
                let group = group(&mut reader, node)?;
                srdf.groups.push(group);
                continue;
            }
            "group_state" => {
                let state = state(&mut reader, node)?;
                srdf.states.push(state);
                continue;
            }
            _ => {}
        }
        let named = |attribute| word(&reader, node, attribute);
        let pair = || -> Result<[String; 2]> { Ok([named("link1")?, named("link2")?]) };
        match tag {
            "end_effector" => {
                srdf.end_effectors.push(EndEffector {
                    name: named("name")?,
                    group: named("group")?,
                    parent_link: named("parent_link")?,
                    parent_group: optional(node, "parent_group"),
                });
            }
            "passive_joint" => srdf.passive_joints.push(named("name")?),
            "disable_collisions" => srdf.disabled.push(pair()?),
            "enable_collisions" => srdf.enabled.push(pair()?),
            _ => srdf.disabled_by_default.push(named("link")?),
        }
    }
    srdf.report.format = source.format;
    reader.report(&[root], &mut srdf.report);
    Ok(srdf)
}

/// The attributes of the elements that are read.
fn attributes(tag: &str) -> Option<&'static [&'static str]> {
    Some(match tag {
        "group" | "passive_joint" => &["name"],
        "group_state" => &["name", "group"],
        "end_effector" => &["name", "group", "parent_link", "parent_group"],
        "disable_collisions" | "enable_collisions" => &["link1", "link2", "reason"],
        "disable_default_collisions" => &["link"],
        _ => return None,
    })
}

fn why_unused(name: &str) -> &'static str {
    match name {
        "virtual_joint" => "the base is where the model has it",
        "link_sphere_approximation" | "sphere" => "shapes for collisions are those of the model",
        _ => "not known to this reader",
    }
}

fn elements<'d, 'i>(node: Node<'d, 'i>) -> impl Iterator<Item = Node<'d, 'i>> {
    node.children().filter(Node::is_element)
}

fn word(reader: &Reader<'_>, node: Node<'_, '_>, attribute: &str) -> Result<String> {
    reader.required(node, attribute).map(|name| name.trim().to_owned())
}

fn optional(node: Node<'_, '_>, attribute: &str) -> Option<String> {
    let name = node.attribute(attribute).map(str::trim).filter(|name| !name.is_empty());
    name.map(str::to_owned)
}

fn group(reader: &mut Reader<'_>, node: Node<'_, '_>) -> Result<Group> {
    let mut group = Group { name: word(reader, node, "name")?, ..Group::default() };
    for part in elements(node) {
        let tag = part.tag_name().name();
        let list = match tag {
            "joint" => &mut group.joints,
            "link" => &mut group.links,
            "group" => &mut group.groups,
            "chain" => {
                reader.unread_attributes(part, &["base_link", "tip_link"]);
                let ends = [word(reader, part, "base_link")?, word(reader, part, "tip_link")?];
                group.chains.push(ends);
                continue;
            }
            _ => continue,
        };
        reader.unread_attributes(part, &["name"]);
        list.push(word(reader, part, "name")?);
    }
    Ok(group)
}

fn state(reader: &mut Reader<'_>, node: Node<'_, '_>) -> Result<GroupState> {
    let name = word(reader, node, "name")?;
    let group = optional(node, "group");
    let mut joints = Vec::new();
    for part in elements(node).filter(|part| part.tag_name().name() == "joint") {
        reader.unread_attributes(part, &["name", "value"]);
        reader.required(part, "value")?;
        let values = reader.list(part, "value")?.unwrap_or_default();
        if let Some(fault) = crate::model::magnitude::fault(&values) {
            return Err(reader.refuse(part, "value", format!("value of <joint> {fault}")));
        }
        joints.push((word(reader, part, "name")?, values));
    }
    Ok(GroupState { name, group, joints })
}

/// Reads an SRDF.
///
/// # Errors
/// [`Error::Io`](crate::Error::Io); those of [`parse`].
pub fn load(path: &Path) -> Result<Srdf> {
    let file = text_file::read(path)?;
    let mut srdf = parse(&file.text, path)?;
    if let Some((line, what, why)) = file.note() {
        srdf.report.ignore(line, what, why);
    }
    Ok(srdf)
}

impl Srdf {
    /// All disabled pairs of a mechanism: those by default for each of its links.
    #[must_use]
    pub fn pairs(&self, mechanism: &Mechanism) -> Vec<[String; 2]> {
        let same = |p: &[String; 2], a: &str, b: &str| {
            (p[0] == a && p[1] == b) || (p[0] == b && p[1] == a)
        };
        let mut all = self.disabled.clone();
        for a in &self.disabled_by_default {
            for b in mechanism.links().iter().map(|l| &l.name).filter(|b| *b != a) {
                if !self.enabled.iter().any(|p| same(p, a, b)) {
                    all.push([a.clone(), b.clone()]);
                }
            }
        }
        all
    }
}
