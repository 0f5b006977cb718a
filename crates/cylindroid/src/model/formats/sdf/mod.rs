//! SDF: models of Gazebo and Drake, versions 1.4 to 1.11.
//!
//! Formula  parent_from_joint = model_from_parent^-1 model_from_joint, likewise for the child:
//!          every link keeps the frame of the file
//! Units    m, rad (degrees for a pose with `degrees="true"`), kg, N, N m
//! Valid    one model of a file, the one that is named or the first with a joint, with nested and
//!          included models (`model::link`). Joints form a graph:
//!          a spanning tree provides the coordinates, and the remaining joints become loop joints.
//!          The root is `world` if a joint refers to it or the model is static, otherwise the
//!          canonical link
//! Why so   SDF does not declare actuators, so every joint of one coordinate counts as actuated, as
//!          in URDF; for models with loops the report says so
//! Source   sdformat.org, specification
//! Checked  tests/formats/sdf.rs

mod frames;
mod includes;
mod joint;
mod joint_entry;
mod link;
mod text;
mod write;

use std::path::Path;

use roxmltree::{Document, Node};

use self::frames::{Frames, MODEL, PosedFrame};
use self::includes::FORMAT;
use self::joint_entry::JointEntry;
use super::inclusion::{self, ByInclude, Together};
use super::mesh::Packages;
use super::span::Source;
use super::xml::{self, Reader};
use super::xml_limits;
use crate::error::Result;
use crate::model::{Link, Mechanism};
use crate::spatial::Pose;

/// Attributes of `<pose>`.
const POSE: [&str; 4] = ["relative_to", "frame", "rotation_format", "degrees"];

/// The model while it is read.
struct Sdf<'d> {
    reader: Reader<'d>,
    includes: ByInclude<'d>,
    frames: Frames<'d>,
    links: Vec<(Link, Node<'d, 'd>)>,
    joints: Vec<JointEntry<'d>>,
    /// Full names of `<frame>` elements.
    named: Vec<String>,
}

/// Reads the text of an SDF file. The path is used in errors and to find meshes.
///
/// ```
/// use cylindroid::model::formats::sdf;
/// use std::path::Path;
///
/// let text = r#"<sdf version="1.9"><model name="lever">
///     <link name="base"/><link name="lever"/>
///     <joint name="hinge" type="revolute">
///         <parent>base</parent><child>lever</child><axis><xyz>0 0 1</xyz></axis>
///     </joint>
/// </model></sdf>"#;
/// let robot = sdf::parse(text, Path::new("lever.sdf"))?;
/// assert_eq!((robot.name(), robot.n()), ("lever", 1));
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// # Errors
/// [`Error::File`](crate::Error::File) with line and column for broken XML, a file without a
/// model, an invalid number, a name that is missing or unknown, a cycle of frames, and everything
/// that the builder rejects.
pub fn parse(text: &str, path: &Path) -> Result<Mechanism> {
    parse_model(text, path, None)
}

/// [`parse`], of several models that of this name.
pub(super) fn parse_model(text: &str, path: &Path, model: Option<&str>) -> Result<Mechanism> {
    let text = &*xml_limits::without_undeclared(text);
    let source = Source { format: FORMAT, path, text };
    let document = xml::document(&source)?;
    let root = document.root_element();
    let tag = Reader::tag(root);
    if !matches!(root.tag_name().name(), "sdf" | "gazebo") {
        let message =
            format!("the root element is <{}>, SDF begins with <sdf>", root.tag_name().name());
        return Err(source.error(tag, message, ""));
    }
    let together = Together::default();
    let included =
        inclusion::gather(&source, &together, |source, node, _| Ok(includes::find(source, node)))?;
    let sources: Vec<Source<'_>> = included.iter().map(|f| f.source(FORMAT)).collect();
    let documents: Vec<Document<'_>> = sources.iter().map(xml::document).collect::<Result<_>>()?;
    let includes = ByInclude::new(&document, &included, &documents);
    read(source, sources.clone(), root, includes, model)
}

fn read<'d>(
    source: Source<'d>,
    included: Vec<Source<'d>>,
    root: Node<'d, 'd>,
    includes: ByInclude<'d>,
    wanted: Option<&str>,
) -> Result<Mechanism> {
    let mut reader = Reader::new(source, None);
    reader.included = included;
    includes.note_replaced(&mut reader);
    (reader.owners, reader.why) = (&["link", "joint", "frame", "model"], why_unused);
    for root in std::iter::once(root).chain(includes.roots()) {
        reader.unread_attributes(root, &["version"]);
        version(&reader, root)?;
    }
    let worlds = root.children().filter(|n| n.has_tag_name("world"));
    let places = std::iter::once(root).chain(worlds).flat_map(|p| p.children());
    let models: Vec<Placed<'_>> = places
        .filter_map(|node| match node.tag_name().name() {
            "model" => Some(Placed { model: node, by: node }),
            "include" => included_model(&includes, node).map(|model| Placed { model, by: node }),
            _ => None,
        })
        .collect();
    if models.is_empty() {
        let tag = Reader::tag(root);
        return Err(source.error(tag, "this SDF has no <model>", "give a file with one"));
    }
    // A world is a ground and objects around a robot.
    let is_robot = |m: &Placed<'_>| m.model.descendants().any(|n| n.has_tag_name("joint"));
    let chosen = match wanted {
        None => models[models.iter().position(is_robot).unwrap_or(0)],
        Some(wanted) => {
            let names: Vec<&str> = models.iter().filter_map(|m| m.name(&reader)).collect();
            let found = models.iter().find(|m| m.name(&reader) == Some(wanted));
            found.copied().ok_or_else(|| {
                let names = names.join(", ");
                let message = format!("this SDF has no model '{wanted}'; it has {names}");
                source.error(Reader::tag(root), message, "")
            })?
        }
    };
    for other in models.iter().filter(|m| m.by != chosen.by) {
        let name = other.name(&reader).unwrap_or("").to_owned();
        let why = match wanted {
            None => {
                "one model of a file is read, the first with a joint or else the first; \
                 FILE.sdf#NAME reads the one of this name"
            }
            Some(_) => "FILE.sdf#NAME reads the model of this name alone",
        };
        reader.note(other.by, "further <model>", why, &name);
        pass_over(&mut reader, &includes, *other);
    }
    if let Some(world) = chosen.by.parent_element().filter(|p| p.has_tag_name("world")) {
        reader.unread_attributes(world, &["name"]);
    }
    let mut it = Sdf {
        reader,
        includes,
        frames: Frames::default(),
        links: Vec::new(),
        joints: Vec::new(),
        named: Vec::new(),
    };
    it.read(chosen)?;
    it.write(chosen)
}

/// Accounts for the models that another one includes: they lie in files of their own.
fn pass_over<'d>(reader: &mut Reader<'_>, includes: &ByInclude<'d>, other: Placed<'d>) {
    let mut stack = vec![other.by];
    while let Some(node) = stack.pop() {
        if let Some(model) = included_model(includes, node) {
            reader.pass_over(model);
            stack.push(model);
        }
        stack.extend(node.children().filter(Node::is_element));
    }
}

/// The model that an `<include>` brings.
fn included_model<'d>(includes: &ByInclude<'d>, node: Node<'d, 'd>) -> Option<Node<'d, 'd>> {
    includes.root(node)?.children().find(|n| n.has_tag_name("model"))
}

/// The version of the format that an element is written in.
fn version(reader: &Reader<'_>, node: Node<'_, '_>) -> Result<f64> {
    let root = node.document().root_element();
    let Some(text) = root.attribute("version") else { return Ok(1.5) };
    let version = text.trim().parse().ok().filter(|v: &f64| v.is_finite()).ok_or_else(|| {
        reader.refuse(root, "version", format!("version '{text}' is not a number"))
    })?;
    // 1.10 and 1.11 come after 1.9.
    Ok(if version < 1.2 { 1.9 } else { version })
}

/// A model, and the element that places it: itself, or an `<include>`.
#[derive(Debug, Clone, Copy)]
struct Placed<'d> {
    model: Node<'d, 'd>,
    by: Node<'d, 'd>,
}

impl<'d> Placed<'d> {
    /// The name that the `<include>` gives, otherwise that of the model.
    fn name(self, reader: &Reader<'_>) -> Option<&'d str> {
        let given = self.by.children().find(|c| c.has_tag_name("name") && self.by != self.model);
        let own = || self.model.attribute("name");
        given.map(|n| reader.text_of(n)).or_else(own).map(str::trim).filter(|n| !n.is_empty())
    }

    /// The element whose `<pose>` counts.
    fn posed(self) -> Node<'d, 'd> {
        let has_pose = self.by.children().any(|c| c.has_tag_name("pose"));
        if has_pose { self.by } else { self.model }
    }

    /// Marks what an `<include>` may contain.
    fn note_unread(self, reader: &mut Reader<'_>) {
        if self.by != self.model {
            reader.leftovers(self.by, &[], &["uri", "name", "pose"]);
            for value in self
                .by
                .children()
                .filter(|c| ["uri", "name"].iter().any(|tag| c.has_tag_name(*tag)))
            {
                reader.value_of(value);
                reader.text_of(value);
            }
            if let Some(own) = self.model.children().find(|c| c.has_tag_name("pose"))
                && self.posed() == self.by
            {
                reader.note(own, "<pose>", "that of the <include> counts", "");
            }
        }
    }
}

impl<'d> Sdf<'d> {
    /// The model and those nested in it: frames first, then the elements that refer to them.
    fn read(&mut self, outermost: Placed<'d>) -> Result<()> {
        let mut joints = Vec::new();
        let mut stack = vec![(outermost, String::new())];
        while let Some((placed, scope)) = stack.pop() {
            let model = placed.model;
            placed.note_unread(&mut self.reader);
            let packages = Packages::of(self.reader.path_of(model));
            let attributes = ["name", "canonical_link", "placement_frame"];
            self.reader.unread_attributes(model, &attributes);
            if let Some(frame) = model.attribute("placement_frame") {
                let why = "it moves the whole model, not its parts";
                self.reader.note(model, "placement_frame", why, frame);
            }
            let mut nested = Vec::new();
            let mut first_link = None;
            for node in model.children().filter(Node::is_element) {
                match node.tag_name().name() {
                    "link" => {
                        self.reader.check_links(node, self.links.len() + 1)?;
                        let name = self.place(node, &scope, None)?;
                        first_link.get_or_insert_with(|| name.clone());
                        let link = self.reader.sdf_link(node, &name, &packages)?;
                        self.links.push((link, node));
                    }
                    "joint" => {
                        let child = self.reader.child_text(node, "child").unwrap_or("").to_owned();
                        self.place(node, &scope, Some(child))?;
                        joints.push((node, scope.clone()));
                    }
                    "frame" => {
                        self.reader.leftovers(node, &["name", "attached_to"], &["pose"]);
                        let to = node.attribute("attached_to").map(str::trim).unwrap_or("");
                        let name = self.place(node, &scope, Some(to.to_owned()))?;
                        self.named.push(name);
                    }
                    "model" => {
                        let own = self.reader.required(node, "name")?;
                        nested.push((Placed { model: node, by: node }, scoped(&scope, own)));
                    }
                    "include" => {
                        let Some(model) = included_model(&self.includes, node) else { continue };
                        let placed = Placed { model, by: node };
                        let own = placed.name(&self.reader).unwrap_or("");
                        nested.push((placed, self.scope_of(node, &scope, own)?));
                    }
                    _ => {}
                }
            }
            // The frame of a model is attached to its canonical link: by default the first link,
            // in a model without links that of its first model.
            let canonical = model.attribute("canonical_link").map(|l| scoped(&scope, l.trim()));
            let inner = nested.first().map(|(_, scope)| scoped(scope, MODEL));
            let attached_to = canonical.or(first_link).or(inner).unwrap_or_default();
            if scope.is_empty() {
                let (relative_to, pose) = (MODEL.to_owned(), Pose::IDENTITY);
                let placed = PosedFrame { node: model, relative_to, pose, attached_to };
                self.frames.insert(&self.reader, MODEL.to_owned(), placed)?;
            } else {
                let outer = scope.rsplit_once("::").map_or("", |s| s.0);
                let (relative_to, pose) = self.pose_of(placed.posed(), outer, MODEL)?;
                let placed = PosedFrame { node: model, relative_to, pose, attached_to };
                let own = scoped(&scope, MODEL);
                let alias = PosedFrame {
                    relative_to: own.clone(),
                    pose: Pose::IDENTITY,
                    attached_to: own.clone(),
                    node: model,
                };
                self.frames.insert(&self.reader, own, placed)?;
                self.frames.insert(&self.reader, scope.clone(), alias)?;
            }
            stack.extend(nested.into_iter().rev());
        }
        for (node, scope) in joints {
            let joint = self.joint(node, &scope)?;
            self.joints.extend(joint);
        }
        Ok(())
    }

    /// The scope of an included model; its name must not be empty or that of another.
    fn scope_of(&self, node: Node<'d, 'd>, outer: &str, own: &str) -> Result<String> {
        let scope = scoped(outer, own);
        if own.is_empty() || self.frames.get(&scope).is_some() {
            let message = format!("an included model is named '{own}' as another frame is");
            let help = "give the <include> a <name>";
            return Err(self.reader.error(node, Reader::tag(node), message, help));
        }
        Ok(scope)
    }

    /// Records the pose of a link (attached to itself), a joint or a frame.
    fn place(&mut self, node: Node<'d, 'd>, scope: &str, on: Option<String>) -> Result<String> {
        let own = self.reader.required(node, "name")?.trim();
        let name = scoped(scope, own);
        let (attached_to, missing) = match on {
            None => (name.clone(), MODEL.to_owned()),
            Some(on) if on.is_empty() => (scoped(scope, MODEL), MODEL.to_owned()),
            // A joint at the world is placed in the model.
            Some(on) if on == "world" => (scoped(scope, MODEL), MODEL.to_owned()),
            Some(on) => (scoped(scope, &on), on),
        };
        let (relative_to, pose) = self.pose_of(node, scope, &missing)?;
        let placed = PosedFrame { node, relative_to, pose, attached_to };
        self.frames.insert(&self.reader, name.clone(), placed)?;
        Ok(name)
    }

    /// The `<pose>` of an element and the full name of the frame that it is relative to.
    fn pose_of(
        &mut self,
        node: Node<'d, 'd>,
        scope: &str,
        missing: &str,
    ) -> Result<(String, Pose)> {
        let Some(pose) = self.reader.child(node, "pose") else {
            return Ok((scoped(scope, missing), Pose::IDENTITY));
        };
        self.reader.unread_attributes(pose, &POSE);
        let given = ["relative_to", "frame"].into_iter().find_map(|a| pose.attribute(a));
        let to = given.map(str::trim).filter(|t| !t.is_empty()).unwrap_or(missing);
        Ok((scoped(scope, to), self.reader.pose_in(pose)?))
    }
}

/// The full name of `name` in a nested model.
fn scoped(scope: &str, name: &str) -> String {
    if scope.is_empty() { name.to_owned() } else { format!("{scope}::{name}") }
}

fn is_true(text: &str) -> bool {
    matches!(text.trim(), "1" | "true")
}

fn degrees() -> f64 {
    std::f64::consts::PI / 180.0
}

fn why_unused(name: &str) -> &'static str {
    match name {
        "physics"
        | "self_collide"
        | "enable_wind"
        | "gravity"
        | "kinematic"
        | "surface"
        | "laser_retro"
        | "must_be_base_link"
        | "velocity_decay"
        | "allow_auto_disable"
        | "plugin"
        | "sensor"
        | "scene"
        | "state"
        | "audio"
        | "atmosphere"
        | "wind"
        | "gui"
        | "spherical_coordinates"
        | "magnetic_field" => "settings of the simulator are not used",
        "stiffness" | "dissipation" | "damping" => {
            "springs and damping do not enter the kinematics"
        }
        "light" | "cast_shadows" | "transparency" | "meta" | "visibility_flags" | "script"
        | "specular" | "emissive" | "lighting" | "pbr" | "shader" | "double_sided"
        | "render_order" | "submesh" => "it is not drawn",
        "include" => "it is not fetched: what it would bring is missing",
        "gearbox_ratio" | "gearbox_reference_body" => "gearboxes are not modelled",
        "battery" | "projector" | "particle_emitter" | "gripper" => {
            "it does not enter the kinematics"
        }
        _ => "not known to this reader",
    }
}
