//! The builder: every check of a mechanism is here, whatever the file it came from.
//!
//! Links and joints are named in any order; `build` finds the root, orders the joints depth-first
//! in the order given, resolves mimic joints, folds fixed joints away and measures the reach.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::assembly::{Assembly, default_tool};
use super::joint::{Joint, Limits};
use super::link::Link;
use super::mechanism::{Data, Frame, FrameId, Mechanism, frame_key};
use super::report::LoadReport;
use super::spec::JointSpec;
use crate::error::{Error, Result};
use crate::spatial::{Pose, Vec3};
use crate::tolerance::ZERO_AXIS;

/// Reach of a mechanism whose links have no length (m): a wrist still needs a length scale.
const LEAST_REACH: f64 = 1e-3;

/// Collects links, joints and frames; [`Builder::build`] checks them all.
#[derive(Debug, Clone)]
pub struct Builder {
    name: String,
    links: Vec<Link>,
    joints: Vec<JointSpec>,
    frames: Vec<(String, String, Pose)>,
    home: Option<Vec<f64>>,
    tool: Option<String>,
    report: LoadReport,
}

impl Builder {
    pub(super) fn new(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            links: Vec::new(),
            joints: Vec::new(),
            frames: Vec::new(),
            home: None,
            tool: None,
            report: LoadReport { format: "builder", ..LoadReport::default() },
        }
    }

    /// Adds a link.
    pub fn link(&mut self, link: Link) -> &mut Self {
        self.links.push(link);
        self
    }

    /// Adds a joint; links that were not added before exist by being named.
    pub fn joint(&mut self, joint: JointSpec) -> &mut Self {
        self.joints.push(joint);
        self
    }

    /// Adds a named frame on a link.
    pub fn frame(&mut self, name: &str, link: &str, link_from_frame: Pose) -> &mut Self {
        self.frames.push((name.to_owned(), link.to_owned(), link_from_frame));
        self
    }

    /// Sets the home configuration.
    pub fn home(&mut self, q: &[f64]) -> &mut Self {
        self.home = Some(q.to_vec());
        self
    }

    /// Names the frame that is driven when none is named.
    pub fn tool(&mut self, frame: &str) -> &mut Self {
        self.tool = Some(frame.to_owned());
        self
    }

    /// The report that goes into the mechanism.
    pub fn report(&mut self) -> &mut LoadReport {
        &mut self.report
    }

    fn refuse<T>(&self, culprit: &str, message: impl Into<String>) -> Result<T> {
        Err(Error::Model {
            model: self.name.clone(),
            culprit: culprit.to_owned(),
            message: message.into(),
        })
    }

    /// The mechanism.
    ///
    /// # Errors
    /// [`Error::Model`] for names given twice or unknown, a link with two parents, a cycle, more
    /// than one root, an axis without direction, limits that contradict each other or that no
    /// joint of the kind can keep (positions of spherical and free joints), a mimic joint
    /// that follows itself, nothing, or a joint of several coordinates.
    pub fn build(mut self) -> Result<Mechanism> {
        let links = self.index_links()?;
        self.check_joints(&links)?;
        let order = self.depth_first(&links)?;
        let mimics = self.resolve_mimics()?;

        let mut assembly = Assembly::new(self.links.len());
        let root = order.root;
        assembly.place(root, 0, Pose::IDENTITY, 0.0);
        for &j in &order.joints {
            if !mimics.contains_key(&j) {
                assembly.allocate(j, &self.joints[j]);
            }
        }
        for &j in &order.joints {
            let spec = &self.joints[j];
            let source = mimics.get(&j).copied();
            if let Some((of, multiplier, offset)) = source {
                let c = assembly.ranges[&of].start;
                let clash = assembly.count_mimic_limits(c, spec, multiplier, offset);
                if clash {
                    self.report.ignore(
                        0,
                        format!("limits of mimic joint '{}'", spec.name),
                        "they leave no position to the joint it follows, whose own limits hold",
                    );
                }
            }
            assembly.connect(j, spec, links[&spec.parent], links[&spec.child], source);
        }
        self.finish(&links, &order, assembly)
    }

    /// Link names to indices, links named only by joints added.
    fn index_links(&mut self) -> Result<BTreeMap<String, usize>> {
        let mut links = BTreeMap::new();
        for (i, link) in self.links.iter().enumerate() {
            if link.name.is_empty() {
                return self.refuse("", "a link has no name; give every link one");
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
            if names.insert(name, ()).is_some() {
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
                        "link '{}' is the child of two joints, '{other}' and '{name}'; closed \
                         loops cannot be driven by this version, keep one of the joints",
                        joint.child
                    ),
                );
            }
            if let Some(fault) = joint.fault() {
                return self.refuse(name, fault);
            }
        }
        Ok(())
    }

    fn depth_first(&self, links: &BTreeMap<String, usize>) -> Result<Order> {
        let mut children: Vec<Vec<usize>> = vec![Vec::new(); self.links.len()];
        let mut parent_joint = vec![None; self.links.len()];
        for (j, joint) in self.joints.iter().enumerate() {
            children[links[&joint.parent]].push(j);
            parent_joint[links[&joint.child]] = Some(j);
        }
        let roots: Vec<usize> =
            (0..self.links.len()).filter(|&l| parent_joint[l].is_none()).collect();
        let root = match roots.as_slice() {
            [] => return self.refuse_cycle(links, &parent_joint, 0),
            [root] => *root,
            several => {
                let names: Vec<&str> =
                    several.iter().map(|&l| self.links[l].name.as_str()).collect();
                return self.refuse(
                    names[1],
                    format!(
                        "it falls into {} parts: links {} have no parent joint; connect them or \
                         remove all but one",
                        names.len(),
                        names.join(", ")
                    ),
                );
            }
        };
        let mut joints = Vec::with_capacity(self.joints.len());
        let mut visited = vec![false; self.links.len()];
        let mut stack = vec![root];
        while let Some(link) = stack.pop() {
            visited[link] = true;
            joints.extend(parent_joint[link]);
            stack.extend(children[link].iter().rev().map(|&j| links[&self.joints[j].child]));
        }
        match visited.iter().position(|v| !v) {
            None => Ok(Order { root, joints }),
            Some(unreached) => self.refuse_cycle(links, &parent_joint, unreached),
        }
    }

    /// Every link has a parent from here on: walk up until one comes back, and name the ring.
    fn refuse_cycle(
        &self,
        links: &BTreeMap<String, usize>,
        parent_joint: &[Option<usize>],
        start: usize,
    ) -> Result<Order> {
        let mut path = vec![start];
        let mut link = start;
        while let Some(j) = parent_joint[link] {
            link = links[&self.joints[j].parent];
            if let Some(first) = path.iter().position(|&l| l == link) {
                let mut names: Vec<&str> =
                    path[first..].iter().rev().map(|&l| self.links[l].name.as_str()).collect();
                names.push(names[0]);
                let culprit = &self.joints[j].name;
                return self.refuse(
                    culprit,
                    format!(
                        "its links form a cycle without a root: {}; a tree has one link that is \
                         no joint's child",
                        names.join(" -> ")
                    ),
                );
            }
            path.push(link);
        }
        self.refuse(&self.links[start].name, "it is not connected to the root")
    }

    /// For every mimic joint the joint at the end of its chain, with the ratio and offset to it.
    fn resolve_mimics(&self) -> Result<BTreeMap<usize, (usize, f64, f64)>> {
        let mut resolved = BTreeMap::new();
        let by_name: BTreeMap<&str, usize> =
            self.joints.iter().enumerate().map(|(j, o)| (o.name.as_str(), j)).collect();
        for (index, joint) in self.joints.iter().enumerate() {
            let Some(first) = &joint.mimic else { continue };
            let name = joint.name.as_str();
            let (mut multiplier, mut offset) = (1.0, 0.0);
            let mut step = Some(first);
            let mut source = 0;
            let mut length = 0;
            while let Some(mimic) = step {
                offset += multiplier * mimic.offset;
                multiplier *= mimic.multiplier;
                if !(multiplier.is_finite() && offset.is_finite()) {
                    return self.refuse(
                        name,
                        format!("the multiplier and offset of mimic joint '{name}' must be finite"),
                    );
                }
                let Some(&j) = by_name.get(mimic.joint.as_str()) else {
                    let unknown = Error::unknown(
                        "joint",
                        &mimic.joint,
                        self.joints.iter().map(|o| o.name.as_str()),
                    );
                    return self.refuse(name, format!("mimic joint '{name}' follows: {unknown}"));
                };
                source = j;
                step = self.joints[j].mimic.as_ref();
                length += 1;
                if length > self.joints.len() {
                    return self.refuse(
                        name,
                        format!("mimic joint '{name}' follows itself in a ring of mimic joints"),
                    );
                }
            }
            if joint.kind.dof() != 1 || self.joints[source].kind.dof() != 1 {
                return self.refuse(
                    name,
                    format!(
                        "mimic joint '{name}' ({}) follows '{}' ({}); both must have one coordinate",
                        joint.kind.name(),
                        self.joints[source].name,
                        self.joints[source].kind.name()
                    ),
                );
            }
            resolved.insert(index, (source, multiplier, offset));
        }
        Ok(resolved)
    }

    fn finish(
        self,
        links: &BTreeMap<String, usize>,
        order: &Order,
        mut assembly: Assembly,
    ) -> Result<Mechanism> {
        let mut frames: Vec<Frame> = Vec::with_capacity(self.links.len() + self.frames.len());
        for (link, l) in self.links.iter().enumerate() {
            frames.push(assembly.frame(l.name.clone(), link, Pose::IDENTITY));
        }
        for (name, link, pose) in &self.frames {
            let Some(&index) = links.get(link) else {
                let unknown = Error::unknown("link", link, links.keys().map(String::as_str));
                return self.refuse(name, format!("frame '{name}': {unknown}"));
            };
            if frames.iter().any(|f| f.name == *name) {
                return self.refuse(
                    name,
                    format!("'{name}' names two frames (links are frames too); rename one"),
                );
            }
            if !pose.is_finite() {
                return self.refuse(name, format!("the pose of frame '{name}' is not finite"));
            }
            assembly.stretch(index, pose.translation.norm());
            frames.push(assembly.frame(name.clone(), index, *pose));
        }

        let tool = match &self.tool {
            None => default_tool(order, &self.joints, links),
            Some(name) => match frames.iter().position(|f| f.name == *name) {
                Some(i) => i,
                None => {
                    let unknown =
                        Error::unknown("frame", name, frames.iter().map(|f| f.name.as_str()));
                    return self.refuse(name, format!("the tool: {unknown}"));
                }
            },
        };

        let n = assembly.coordinates.len();
        let home = match &self.home {
            None => assembly.coordinates.iter().map(|c| rest(&c.limits)).collect(),
            Some(q) if q.len() == n && q.iter().all(|x| x.is_finite()) => q.clone(),
            Some(q) => {
                return self.refuse(
                    "home",
                    format!("home has {} entries, expected {n} finite numbers", q.len()),
                );
            }
        };

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
                    axis: spec.axis.unit(ZERO_AXIS).unwrap_or(Vec3::Z),
                    limits: spec.limits,
                    mimic: spec.mimic.clone(),
                    coordinates: assembly.ranges.get(&j).cloned().unwrap_or(0..0),
                    actuated: spec.actuated && spec.mimic.is_none(),
                }
            })
            .collect();
        // From places in the specification to places in the order.
        let mut places = vec![0; self.joints.len()];
        order.joints.iter().enumerate().for_each(|(place, &j)| places[j] = place);
        for c in &mut assembly.coordinates {
            c.joint = places[c.joint];
        }
        let frame_key = frame_key(&frames);
        Ok(Mechanism {
            data: Arc::new(Data {
                name: self.name,
                links: self.links,
                joints,
                frame_key,
                frames,
                coordinates: assembly.coordinates,
                nodes: assembly.nodes,
                home,
                tool: FrameId { index: tool, frame_key },
                reach: assembly.reach.max(LEAST_REACH),
                report: self.report,
            }),
        })
    }
}

/// Zero where the limits allow it, else their middle: no joint rests at a limit.
fn rest(limits: &Limits) -> f64 {
    let (lower, upper) = (limits.lower, limits.upper);
    let middle = 0.5 * (lower + upper);
    match (lower <= 0.0 && 0.0 <= upper, middle.is_finite()) {
        (true, _) => 0.0,
        (false, true) => middle,
        (false, false) => 0.0_f64.clamp(lower, upper),
    }
}

/// The root link and the joints, depth-first.
pub(super) struct Order {
    pub(super) root: usize,
    pub(super) joints: Vec<usize>,
}
