//! Builder of mechanisms: validates links, joints, loops, contacts and frames, whatever the file
//! format.
//!
//! Links and joints are named in any order; `build` finds the root, orders the joints depth-first
//! in the order given, resolves mimic joints, folds fixed joints away and measures the characteristic length.
//!
//! Checked  tests/it/model.rs, tests/it/graph.rs, tests/formats/broken.rs

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::contact::{Contact, ContactSpec};
use super::default_tool::DefaultTool;
use super::dimension::Dimension;
use super::elasticity::Elasticity;
use super::flatten::FlatMechanism;
use super::joint::Joint;
use super::joint_spec::JointSpec;
use super::link::{Collision, Link};
use super::loop_joint::{LoopJoint, LoopJointSpec};
use super::magnitude;
use super::mechanism::{Coordinate, Data, Frame, FrameId, Mechanism, frame_key};
use super::report::LoadReport;
use super::tool_choice::ToolChoice;
use super::tree_order::TreeOrder;
use crate::error::{Error, Result, all_finite};
use crate::spatial::{Pose, Vec3};
use crate::tolerance::ZERO_AXIS;

/// Collects links, joints and frames; [`Builder::build`] validates them.
///
/// ```
/// use cylindroid::model::{JointKind, JointSpec};
/// use cylindroid::{Mechanism, Pose, Vec3};
///
/// let mut builder = Mechanism::builder("lever");
/// builder.joint(JointSpec::new("hinge", JointKind::Revolute, "base", "lever"));
/// builder.frame("tip", "lever", Pose::from_translation(Vec3::X)).tool("tip");
/// let lever = builder.build()?;
/// assert_eq!((lever.n(), lever.links().len()), (1, 2));
/// assert_eq!(lever.state(&[0.0])?.pose(lever.tool())?.translation, Vec3::X);
/// # Ok::<(), cylindroid::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Builder {
    pub(super) name: String,
    pub(super) links: Vec<Link>,
    collisions: Vec<(String, Collision)>,
    pub(super) disabled_collisions: Vec<[String; 2]>,
    pub(super) joints: Vec<JointSpec>,
    pub(super) loops: Vec<LoopJointSpec>,
    pub(super) halves: BTreeSet<String>,
    contacts: Vec<ContactSpec>,
    dimension: Dimension,
    pub(super) frames: Vec<(String, String, Pose)>,
    pub(super) unassembled: Vec<String>,
    home: Option<Vec<f64>>,
    pub(super) starts: BTreeMap<String, Vec<f64>>,
    tool: Option<String>,
    reference: Option<String>,
    by_name: bool,
    pub(super) elasticity: Elasticity,
    report: LoadReport,
}

impl Builder {
    pub(super) fn new(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            links: Vec::new(),
            collisions: Vec::new(),
            disabled_collisions: Vec::new(),
            joints: Vec::new(),
            loops: Vec::new(),
            halves: BTreeSet::new(),
            contacts: Vec::new(),
            dimension: Dimension::Spatial,
            frames: Vec::new(),
            unassembled: Vec::new(),
            home: None,
            starts: BTreeMap::new(),
            tool: None,
            reference: None,
            by_name: false,
            elasticity: Elasticity::default(),
            report: LoadReport { format: "builder", ..LoadReport::default() },
        }
    }

    /// Adds a link.
    pub fn link(&mut self, link: Link) -> &mut Self {
        self.links.push(link);
        self
    }

    /// Adds a collision shape to a link, which exists by being named.
    pub fn collision(&mut self, link: &str, shape: impl Into<Collision>) -> &mut Self {
        self.collisions.push((link.to_owned(), shape.into()));
        self
    }

    /// Says that the shapes of two links do not collide.
    pub fn disable_collision(&mut self, a: &str, b: &str) -> &mut Self {
        self.disabled_collisions.push([a.to_owned(), b.to_owned()]);
        self
    }

    /// Adds a joint of the tree; links exist by being named.
    pub fn joint(&mut self, joint: JointSpec) -> &mut Self {
        self.joints.push(joint);
        self
    }

    /// Adds a loop joint: a joint that closes a loop of the tree. Both links must exist without it.
    /// [`LoopJointSpec::new`] has an example.
    pub fn loop_joint(&mut self, joint: LoopJointSpec) -> &mut Self {
        self.loops.push(joint);
        self
    }

    /// Adds a contact; both links must exist without it. [`ContactSpec::new`] has an example.
    pub fn contact(&mut self, contact: ContactSpec) -> &mut Self {
        self.contacts.push(contact);
        self
    }

    /// Sets the dimension; spatial by default.
    pub fn dimension(&mut self, dimension: Dimension) -> &mut Self {
        self.dimension = dimension;
        self
    }

    /// Adds a named frame on a link.
    pub fn frame(&mut self, name: &str, link: &str, link_from_frame: Pose) -> &mut Self {
        self.frames.push((name.to_owned(), link.to_owned(), link_from_frame));
        self
    }

    /// Sets the home position of one joint of the tree; [`Builder::home`] overrides it.
    pub fn start(&mut self, joint: &str, q: &[f64]) -> &mut Self {
        self.starts.insert(joint.to_owned(), q.to_vec());
        self
    }

    /// Sets the home configuration.
    pub fn home(&mut self, q: &[f64]) -> &mut Self {
        self.home = Some(q.to_vec());
        self
    }

    /// Names the default frame (tool).
    pub fn tool(&mut self, frame: &str) -> &mut Self {
        self.tool = Some(frame.to_owned());
        self
    }

    /// Says that this loop joint may be open at home, which is to be assembled.
    pub(super) fn assemble_home(&mut self, loop_joint: &str) -> &mut Self {
        self.unassembled.push(loop_joint.to_owned());
        self
    }

    /// Names decide where the order in which links and joints are given must not.
    #[cfg(feature = "formats")]
    pub(super) fn by_name(&mut self) -> &mut Self {
        self.by_name = true;
        self
    }

    /// Names the frame whose motion is the goal (reference); the tool by default.
    pub fn reference(&mut self, frame: &str) -> &mut Self {
        self.reference = Some(frame.to_owned());
        self
    }

    /// The load report of the mechanism.
    pub fn report(&mut self) -> &mut LoadReport {
        &mut self.report
    }

    pub(super) fn refuse<T>(&self, culprit: &str, message: impl Into<String>) -> Result<T> {
        Err(Error::Model {
            model: self.name.clone(),
            culprit: culprit.to_owned(),
            message: message.into(),
        })
    }

    /// Adds elastic parts; [`Builder::build`] checks their names.
    pub fn elasticity(&mut self, elasticity: Elasticity) -> &mut Self {
        self.elasticity.elements.extend(elasticity.elements);
        self
    }

    /// Builds the mechanism.
    ///
    /// # Errors
    /// [`Error::Model`] for names that are repeated or unknown, a link with two parents, a cycle,
    /// more than one root, an axis without direction, contradictory limits or position limits of
    /// spherical and free joints, a mimic joint that follows itself, an unknown joint, or a joint
    /// of several coordinates; for a loop joint or a contact on an unknown link or on one link
    /// alone; for lengths that are all below [`MIN_LENGTH`](crate::tolerance::MIN_LENGTH), unless
    /// all are zero.
    pub fn build(mut self) -> Result<Mechanism> {
        self.joints.iter_mut().for_each(JointSpec::normalise);
        let links = self.index_links()?;
        self.check_joints(&links)?;
        let order = self.depth_first(&links)?;
        self.check_coordinates()?;
        let mimics = self.resolve_mimics()?;

        let mut flat = FlatMechanism::new(self.links.len());
        let root = order.root;
        flat.place(root, 0, Pose::IDENTITY);
        for &j in &order.joints {
            if !mimics.contains_key(&j) {
                flat.allocate(j, &self.joints[j]);
            }
        }
        for &j in &order.joints {
            let spec = &self.joints[j];
            let source = mimics.get(&j).copied();
            if let Some((of, multiplier, offset)) = source {
                let c = flat.ranges[&of].start;
                let clash = flat.count_mimic_limits(c, spec, multiplier, offset);
                if clash {
                    self.report.ignore(
                        0,
                        format!("limits of mimic joint '{}'", spec.name),
                        "they leave no position for the joint it follows, whose own limits apply",
                    );
                }
            }
            flat.connect(j, spec, links[&spec.parent], links[&spec.child], source);
        }
        self.finish(&links, &order, flat)
    }

    /// Maps link names to indices; links named only by joints are added.
    fn index_links(&mut self) -> Result<BTreeMap<String, usize>> {
        let mut links = BTreeMap::new();
        for (i, link) in self.links.iter().enumerate() {
            if let Some(fault) = link.fault() {
                return self.refuse(&link.name, fault);
            }
            if links.insert(link.name.clone(), i).is_some() {
                return self.refuse(
                    &link.name,
                    format!("two links are named '{}'; rename one of them", link.name),
                );
            }
        }
        for joint in &self.joints {
            for name in [&joint.parent, &joint.child] {
                if name.is_empty() {
                    return self.refuse(
                        &joint.name,
                        format!("joint '{}' does not name both of its links", joint.name),
                    );
                }
                if !links.contains_key(name) {
                    links.insert(name.clone(), self.links.len());
                    self.links.push(Link::named(name));
                }
            }
        }
        for (name, shape) in std::mem::take(&mut self.collisions) {
            match links.get(&name) {
                Some(&i) => self.links[i].collisions.push(shape),
                None => return Err(Error::unknown("link", &name, links.keys())),
            }
        }
        if self.links.is_empty() {
            return self.refuse("", "it has no links; a mechanism has at least one");
        }
        Ok(links)
    }

    fn check_joints(&self, links: &BTreeMap<String, usize>) -> Result<()> {
        let mut names = BTreeMap::new();
        let mut parent_joint: BTreeMap<usize, &str> = BTreeMap::new();
        for joint in &self.joints {
            let name = joint.name.as_str();
            if name.is_empty() {
                return self.refuse("", "a joint has no name; give every joint one");
            }
            if names.insert(name, "joints").is_some() {
                return self
                    .refuse(name, format!("two joints are named '{name}'; rename one of them"));
            }
            if joint.parent == joint.child {
                return self.refuse(
                    name,
                    format!("joint '{name}' connects link '{}' with itself", joint.parent),
                );
            }
            if let Some(other) = parent_joint.insert(links[&joint.child], name) {
                return self.refuse(
                    name,
                    format!(
                        "link '{}' is the child of two joints, '{other}' and '{name}'; keep one, \
                         and close the loop in a mechanism file that includes this one",
                        joint.child
                    ),
                );
            }
            if let Some(fault) = joint.fault(self.dimension) {
                return self.refuse(name, fault);
            }
        }
        let loops = self.loops.iter().map(|l| (l.name.as_str(), "joints"));
        let contacts = self.contacts.iter().map(|c| (c.name.as_str(), "contacts"));
        for (name, what) in loops.chain(contacts) {
            if name.is_empty() {
                return self.refuse("", format!("one of the {what} has no name; give it one"));
            }
            if names.insert(name, what).is_some() {
                let message = format!("two joints or contacts are named '{name}'; rename one");
                return self.refuse(name, message);
            }
        }
        Ok(())
    }

    /// The loop joints and the contacts, with link indices.
    fn closings(&self, links: &BTreeMap<String, usize>) -> Result<(Vec<LoopJoint>, Vec<Contact>)> {
        let place = |name: &str| {
            let name = name.to_owned();
            move |message| Error::Model { model: self.name.clone(), culprit: name, message }
        };
        let close = |l: &LoopJointSpec| l.resolve(links, self.dimension).map_err(place(&l.name));
        let touch = |c: &ContactSpec| c.resolve(links, self.dimension).map_err(place(&c.name));
        Ok((
            self.loops.iter().map(close).collect::<Result<_>>()?,
            self.contacts.iter().map(touch).collect::<Result<_>>()?,
        ))
    }

    /// The home configuration: the one that was set, otherwise that of each joint, otherwise the
    /// rest position; zero in a closed chain, whose loops close there even if a limit excludes it.
    fn home_of(&self, flat: &FlatMechanism) -> Result<Vec<f64>> {
        let n = flat.coordinates.len();
        if let Some(q) = &self.home {
            if q.len() == n && all_finite(q) {
                return Ok(q.clone());
            }
            return self.refuse(
                "home",
                format!("home has {} entries, expected {n} finite numbers", q.len()),
            );
        }
        let closed = !(self.loops.is_empty() && self.contacts.is_empty());
        let still = |c: &Coordinate| if closed { 0.0 } else { c.limits.rest() };
        let mut home: Vec<f64> = flat.coordinates.iter().map(still).collect();
        for (j, spec) in self.joints.iter().enumerate() {
            let Some(start) = self.starts.get(&spec.name).filter(|_| spec.mimic.is_none()) else {
                continue;
            };
            let range = flat.ranges.get(&j).cloned().unwrap_or(0..0);
            if start.len() != range.len() || !all_finite(start) {
                return self.refuse(
                    &spec.name,
                    format!(
                        "the start of joint '{}' has {} entries, expected {} finite numbers",
                        spec.name,
                        start.len(),
                        range.len()
                    ),
                );
            }
            home[range].copy_from_slice(start);
        }
        Ok(home)
    }

    fn finish(
        self,
        links: &BTreeMap<String, usize>,
        order: &TreeOrder,
        mut flat: FlatMechanism,
    ) -> Result<Mechanism> {
        let mut frames: Vec<Frame> = Vec::with_capacity(self.links.len() + self.frames.len());
        let mut names: BTreeSet<&str> = self.links.iter().map(|l| l.name.as_str()).collect();
        for (link, l) in self.links.iter().enumerate() {
            frames.push(flat.frame(l.name.clone(), link, Pose::IDENTITY));
        }
        for (name, link, pose) in &self.frames {
            let Some(&index) = links.get(link) else {
                let unknown = Error::unknown("link", link, links.keys().map(String::as_str));
                return self.refuse(name, format!("frame '{name}': {unknown}"));
            };
            if !names.insert(name) {
                return self.refuse(
                    name,
                    format!("'{name}' names two frames (links are frames too); rename one"),
                );
            }
            if let Some(fault) = magnitude::pose_fault(pose) {
                return self.refuse(name, format!("the pose of frame '{name}' {fault}"));
            }
            frames.push(flat.frame(name.clone(), index, *pose));
        }

        let mut disabled_collisions = Vec::new();
        for pair in &self.disabled_collisions {
            let link = |name: &String| match links.get(name) {
                Some(&link) => Ok(link),
                None => Err(Error::unknown("link", name, links.keys())),
            };
            disabled_collisions.push([link(&pair[0])?, link(&pair[1])?]);
        }
        let named = |what: &str, name: &String| match frames.iter().position(|f| f.name == *name) {
            Some(i) => Ok(i),
            None => {
                let known = frames.iter().map(|f| f.name.as_str());
                self.refuse(name, format!("the {what}: {}", Error::unknown("frame", name, known)))
            }
        };
        let (tool, tool_choice) = match &self.tool {
            Some(name) => (named("tool", name)?, ToolChoice::Named),
            None => {
                let Self { joints, loops, halves, .. } = &self;
                let (frames, by_name) = (&frames, self.by_name);
                DefaultTool { order, joints, loops, halves, links, frames, by_name }.choose()
            }
        };
        let reference = match &self.reference {
            None => tool,
            Some(name) => named("reference", name)?,
        };
        let home = self.home_of(&flat)?;
        let (loops, contacts) = self.closings(links)?;

        let joints = order
            .joints
            .iter()
            .map(|&j| {
                let spec = &self.joints[j];
                Joint {
                    name: spec.name.clone(),
                    kind: spec.kind,
                    parent: links[&spec.parent],
                    child: links[&spec.child],
                    parent_from_joint: spec.parent_from_joint,
                    joint_from_child: spec.joint_from_child,
                    axis: spec.axis.unit(ZERO_AXIS).unwrap_or(Vec3::Z),
                    reversed: spec.reversed,
                    limits: spec.limits,
                    mimic: spec.mimic.clone(),
                    coordinates: flat.ranges.get(&j).cloned().unwrap_or(0..0),
                    actuated: spec.actuated && spec.mimic.is_none(),
                    armature: spec.armature,
                }
            })
            .collect();
        // From indices of the specification to indices of the order.
        let mut places = vec![0; self.joints.len()];
        order.joints.iter().enumerate().for_each(|(place, &j)| places[j] = place);
        for c in &mut flat.coordinates {
            c.joint = places[c.joint];
        }
        let frame_key = frame_key(&frames);
        let id = |index| FrameId { index, frame_key };
        let mechanism = Mechanism {
            data: Arc::new(Data {
                name: self.name,
                links: self.links,
                joints,
                frame_key,
                loops,
                unassembled: self.unassembled,
                contacts,
                dimension: self.dimension,
                reference: id(reference),
                frames,
                coordinates: flat.coordinates,
                nodes: flat.nodes,
                home,
                tool: id(tool),
                tool_choice,
                reach: 1.0,
                far: 0.0,
                elasticity: self.elasticity,
                disabled_collisions,
                report: self.report,
            }),
        };
        mechanism.check_elasticity()?;
        mechanism.check_size()?;
        Ok(mechanism.measured())
    }
}

impl Mechanism {
    /// A builder for a mechanism of this name.
    #[must_use]
    pub fn builder(name: &str) -> Builder {
        Builder::new(name)
    }
}
