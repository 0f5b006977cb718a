//! MJCF: models of MuJoCo.
//!
//! Formula  world_from_body and q equal MuJoCo's xpos, xquat and qpos (quaternions as rotation
//!          vectors); home is qpos0 or the key frame "home"
//! Units    m, kg; degrees unless `<compiler angle="radian">`
//! Valid    bodies, joints, sites, shapes, default classes, `<frame>`, `<replicate>`, `<attach>`,
//!          `<include>` in the model's own folder, `<equality>` connect, weld, joint and tendon, actuators at joints. Other
//!          elements and attributes are listed in the load report
//! Why so   equality constraints become loop joints and mimic joints, so a gripper with loops is
//!          represented like any closed chain of a mechanism file
//! Source   mujoco.readthedocs.io, XML reference
//! Checked  tests/formats/mjcf.rs (against vectors computed by MuJoCo)

mod actuators;
mod assets;
mod attach;
mod attributes;
mod body;
mod compiler;
mod copies;
mod couplings;
mod defaults;
mod equality;
mod files;
mod geom;
mod inertia;
mod limited;
mod massless;
mod mesh_inertia;
mod part;
mod replicate;
mod tendon;
mod unique_name;

use std::cell::Cell;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::rc::Rc;

use roxmltree::{Document, Node};

use self::assets::Assets;
use self::attributes::{FORMAT, why_unused};
use self::compiler::Compiler;
use self::copies::{Copies, Kind};
use self::couplings::Couplings;
use self::defaults::Defaults;
use self::files::Files;
use self::part::{Nesting, Part, report_of_parts};
use self::unique_name::Names;
use super::inclusion::{self, ByInclude, Included, Together};
use super::span::Source;
use super::xml::{self, Reader};
use super::xml_limits;
use crate::error::{Error, Result};
use crate::model::{JointSpec, Link, LoopJointSpec, Mechanism, Mimic};
use crate::spatial::Pose;

/// The model while it is read.
struct Mjcf<'d> {
    reader: Reader<'d>,
    files: Files<'d>,
    compiler: Compiler,
    defaults: Defaults<'d>,
    assets: Assets<'d>,
    links: Vec<Link>,
    joints: Vec<JointSpec>,
    loops: Vec<LoopJointSpec>,
    /// Bodies whose shapes do not collide.
    disabled_collisions: Vec<[String; 2]>,
    /// Name, body, pose on it.
    sites: Vec<(String, String, Pose)>,
    /// Home positions of joints; later ones take precedence.
    starts: Vec<(String, Vec<f64>)>,
    /// What else a joint follows that follows several, by its name.
    sums: BTreeMap<String, Vec<Mimic>>,
    /// Tendons that equality constraints turn into couplings.
    tied: BTreeSet<String>,
    /// Poses of the bodies at qpos0.
    world: BTreeMap<String, Pose>,
    link_names: Names,
    joint_names: Names,
    geom_names: Names,
    /// Names of bodies and joints in the file, of those that were read.
    given_bodies: BTreeSet<String>,
    given_joints: BTreeSet<String>,
    couplings: Couplings<'d>,
    /// Links between the joints of a joint that follows several.
    made_links: usize,
    copies: Copies,
    /// The models that this one may attach.
    attachable: BTreeMap<String, Rc<Part>>,
    has_attached_actuators: bool,
    attached_shapes: usize,
    /// The index of the link of a body of the file.
    link_index: BTreeMap<String, usize>,
    /// The index of the first joint between a body and its parent.
    first_joint: BTreeMap<String, usize>,
    /// The bodies that joints move, and those whose mass is that of meshes that were not read.
    moving: Vec<(Node<'d, 'd>, String)>,
    of_unread_mass: BTreeSet<String>,
}

/// Reads the text of an MJCF model. The path is used in errors, to find meshes, and to read the
/// files that the model includes.
///
/// ```
/// use cylindroid::model::formats::mjcf;
/// use std::path::Path;
///
/// let text = r#"<mujoco><worldbody><body name="lever">
///     <joint name="hinge" axis="0 0 1"/><geom size="0.1"/>
/// </body></worldbody></mujoco>"#;
/// let robot = mjcf::parse(text, Path::new("lever.xml"))?;
/// assert_eq!((robot.n(), robot.joints()[0].name.as_str()), (1, "hinge"));
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// # Errors
/// [`Error::File`] with line and column for broken XML, a number that is not one, a name that is
/// missing or unknown, an include that cannot be read, and everything that the builder rejects.
pub fn parse(text: &str, path: &Path) -> Result<Mechanism> {
    let nesting = Nesting { depth: 0, models: &Cell::new(0), together: &Together::default() };
    with_model(text, path, nesting, |model, name| model.write(name))
}

/// What is made of a model that is read.
type Finish<T> = fn(Mjcf<'_>, Option<&str>) -> Result<T>;

fn with_model<T>(text: &str, path: &Path, nesting: Nesting<'_>, finish: Finish<T>) -> Result<T> {
    let text = &*xml_limits::without_undeclared(text);
    let source = Source { format: FORMAT, path, text };
    let main = xml::document(&source)?;
    let root = main.root_element();
    if !matches!(root.tag_name().name(), "mujoco" | "mujocoinclude") {
        let message =
            format!("the root element is <{}>, MJCF begins with <mujoco>", root.tag_name().name());
        return Err(source.error(Reader::tag(root), message, ""));
    }
    let find = |s: &Source<'_>, node: Node<'_, '_>, before: &[Included]| {
        files::find(path, s, node, before)
    };
    let included = inclusion::gather(&source, nesting.together, find)?;
    let sources: Vec<Source<'_>> = included.iter().map(|f| f.source(FORMAT)).collect();
    let documents: Vec<Document<'_>> = sources.iter().map(xml::document).collect::<Result<_>>()?;
    let files = Files { main: &main, included: ByInclude::new(&main, &included, &documents) };
    let name = main.root_element().attribute("model");
    finish(read(source, sources.clone(), files, nesting)?, name)
}

fn read<'d>(
    source: Source<'d>,
    included: Vec<Source<'d>>,
    files: Files<'d>,
    nesting: Nesting<'_>,
) -> Result<Mjcf<'d>> {
    let mut reader = Reader::new(source, None);
    reader.included = included;
    files.included.note_replaced(&mut reader);
    (reader.owners, reader.why) = (&["body", "key", "default"], why_unused);
    let root = files.main.root_element();
    reader.unread_attributes(root, &["model"]);
    let sections = ["asset", "contact", "equality", "actuator", "keyframe", "tendon"];
    for section in files.children(root) {
        match section.tag_name().name() {
            "compiler" | "default" => {}
            "worldbody" => reader.unread_attributes(section, &["childclass"]),
            name if sections.contains(&name) => reader.unread_attributes(section, &[]),
            "size" => reader.note(section, "<size>", why_unused("option"), ""),
            name => reader.note(section, format!("<{name}>"), why_unused(name), ""),
        }
    }
    for include in files.includes() {
        reader.unread_attributes(include, &["file"]);
    }
    for root in files.roots().into_iter().skip(1) {
        reader.unread_attributes(root, &["model"]);
    }
    let compiler = Compiler::read(&files, &mut reader)?;
    let defaults = Defaults::read(&files, &mut reader)?;
    let mut it = Mjcf {
        reader,
        files,
        compiler,
        defaults,
        assets: Assets::default(),
        links: Vec::new(),
        joints: Vec::new(),
        loops: Vec::new(),
        disabled_collisions: Vec::new(),
        sites: Vec::new(),
        starts: Vec::new(),
        sums: BTreeMap::new(),
        tied: BTreeSet::new(),
        world: BTreeMap::new(),
        link_names: Names::default(),
        joint_names: Names::default(),
        geom_names: Names::default(),
        given_bodies: BTreeSet::new(),
        given_joints: BTreeSet::new(),
        couplings: Couplings::default(),
        made_links: 0,
        copies: Copies::default(),
        attachable: BTreeMap::new(),
        has_attached_actuators: false,
        attached_shapes: 0,
        link_index: BTreeMap::new(),
        first_joint: BTreeMap::new(),
        moving: Vec::new(),
        of_unread_mass: BTreeSet::new(),
    };
    it.assets()?;
    it.parts(nesting)?;
    it.bodies()?;
    it.note_massless();
    let sections = ["tendon", "actuator"].map(|name| it.files.section(name));
    it.couplings = Couplings::of(&it.joints, &it.starts, &it.sums, sections);
    it.excluded_contacts()?;
    it.set_total_mass();
    it.equalities()?;
    it.tendons();
    it.actuators()?;
    it.key_frame(nesting.depth == 0)?;
    Ok(it)
}

impl Mjcf<'_> {
    /// Reports tendons that couple no joints here.
    fn tendons(&mut self) {
        let sections = self.files.children(self.files.main.root_element());
        for section in sections.into_iter().filter(|n| n.has_tag_name("tendon")) {
            self.reader.unread_attributes(section, &[]);
        }
        for tendon in self.files.section("tendon") {
            let name = tendon.attribute("name").unwrap_or("");
            if !self.tied.contains(name) {
                let what = format!("<{}> in <tendon>", tendon.tag_name().name());
                self.reader.note(tendon, what, why_unused("tendon"), name);
            }
        }
    }

    /// Pairs of bodies of `<exclude>`; pairs of geoms are reported as unused.
    fn excluded_contacts(&mut self) -> Result<()> {
        for node in self.files.section("contact") {
            let name = node.attribute("name").unwrap_or("");
            if !node.has_tag_name("exclude") {
                let what = format!("<{}> in <contact>", node.tag_name().name());
                let why = "pairs are chosen by contype and conaffinity, and <exclude>";
                self.reader.note(node, what, why, name);
                continue;
            }
            self.reader.unread_attributes(node, &["name", "body1", "body2"]);
            for copy in self.copies_of(node) {
                self.copies.current = copy;
                let [a, b] = ["body1", "body2"].map(|body| self.reader.required(node, body));
                let [a, b] = [a?, b?].map(|body| self.copies.name(Kind::Body, body.trim()));
                if [&a, &b].iter().all(|body| self.link_names.contains(body)) {
                    self.disabled_collisions.push([a, b]);
                } else {
                    self.reader.note(node, "<exclude>", "it names no bodies of this model", name);
                }
            }
        }
        Ok(())
    }

    fn write(mut self, model: Option<&str>) -> Result<Mechanism> {
        let source = self.reader.source;
        let stem = source.path.file_stem().map(|s| s.to_string_lossy()).unwrap_or_default();
        let name = model.map(str::trim).filter(|n| !n.is_empty()).unwrap_or(&stem);
        let mut builder = Mechanism::builder(name);
        for link in std::mem::take(&mut self.links) {
            builder.link(link);
        }
        for joint in std::mem::take(&mut self.joints) {
            for part in self.parts_of(joint) {
                builder.joint(part);
            }
        }
        for joint in self.loops {
            builder.loop_joint(joint);
        }
        for [a, b] in self.disabled_collisions {
            builder.disable_collision(&a, &b);
        }
        // MJCF has separate namespaces for sites and bodies; frames share one here.
        for (name, link, pose) in self.sites {
            let is_free = self.link_names.insert(&name);
            let name = if is_free { name } else { self.link_names.unique(&format!("site:{name}")) };
            builder.frame(&name, &link, pose);
        }
        for (joint, q) in self.starts {
            builder.start(&joint, &q);
        }
        let report = builder.report();
        report.format = FORMAT;
        self.reader.report(&self.files.roots(), report);
        report_of_parts(&self.attachable, report);
        builder.build().map_err(|error| {
            let Error::Model { culprit, message, .. } = error else { return error };
            let root = self.files.main.root_element();
            let named = |n: &Node<'_, '_>| {
                !culprit.is_empty() && n.attribute("name") == Some(culprit.as_str())
            };
            match root.descendants().find(named) {
                Some(node) => source.error(Reader::value(node, "name"), message, ""),
                None => source.error(Reader::tag(root), message, ""),
            }
        })
    }
}
