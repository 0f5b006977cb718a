//! From links and joints of SDF to a mechanism: the spanning tree and the loop joints.
//!
//! Checked  tests/formats/sdf.rs::joints_*, ::cassie_*

use std::collections::{BTreeMap, BTreeSet};

use roxmltree::Node;

use super::includes::FORMAT;
use super::joint_entry::JointEntry;
use super::{MODEL, POSE, Placed, Sdf};
use crate::error::{Error, Result};
use crate::model::builder::Builder;
use crate::model::formats::graph::{Branch, Coupling, Rank, spanning_tree};
use crate::model::formats::xml::Reader;
use crate::model::{JointKind, JointSpec, Link, LoopJointSpec, Mechanism};
use crate::spatial::Pose;

/// The root of models that are fixed to the world.
const WORLD: &str = "world";

impl<'d> Sdf<'d> {
    pub(super) fn write(mut self, placed: Placed<'d>) -> Result<Mechanism> {
        let model = placed.model;
        let source = self.reader.source;
        let stem = source.path.file_stem().map(|s| s.to_string_lossy()).unwrap_or_default();
        let own = placed.name(&self.reader);
        let mut builder = Mechanism::builder(own.unwrap_or(&stem));

        let is_static = self.reader.child_flag(model, "static");
        let at_world = self.joints.iter().any(|j| j.between.iter().any(|l| l == WORLD));
        let world_from_model = match self.reader.child(placed.posed(), "pose") {
            Some(pose) => {
                self.reader.unread_attributes(pose, &POSE);
                self.reader.pose_in(pose)?
            }
            None => Pose::IDENTITY,
        };
        let mut names: Vec<String> = Vec::new();
        let mut poses: Vec<Pose> = Vec::new();
        if is_static || at_world || self.links.is_empty() {
            names.push(WORLD.to_owned());
            poses.push(Pose::IDENTITY);
            builder.link(Link::named(WORLD));
        }
        for (link, _) in &self.links {
            poses.push(world_from_model * self.frames.pose(&self.reader, &link.name)?);
            names.push(link.name.clone());
            builder.link(link.clone());
        }
        let index: BTreeMap<&str, usize> =
            names.iter().enumerate().map(|(i, n)| (n.as_str(), i)).collect();
        let root = if names[0] == WORLD {
            0
        } else {
            let carrier = self.frames.link(&self.reader, MODEL)?;
            index.get(carrier.as_str()).copied().unwrap_or(0)
        };
        let graph = Graph { names: &names, poses: &poses, world_from_model };
        self.connect(&mut builder, &graph, &index, root, is_static)?;
        self.add_frames(&mut builder, &index)?;

        let report = builder.report();
        report.format = FORMAT;
        let main = placed.by.document().root_element();
        let roots: Vec<Node<'_, '_>> = std::iter::once(main).chain(self.includes.roots()).collect();
        self.reader.report(&roots, report);
        builder.build().map_err(|error| {
            let Error::Model { culprit, message, .. } = error else { return error };
            match self.frames.get(&culprit) {
                Some(placed) => self.reader.refuse(placed.node, "name", message),
                None => source.error(Reader::tag(placed.by), message, ""),
            }
        })
    }

    /// Computes the spanning tree; a part without connection to the root gets a free joint.
    fn connect(
        &mut self,
        builder: &mut Builder,
        graph: &Graph<'_>,
        index: &BTreeMap<&str, usize>,
        root: usize,
        is_static: bool,
    ) -> Result<()> {
        let place = |name: &String| index.get(name.as_str()).copied().unwrap_or(root);
        let ends: Vec<[usize; 2]> =
            self.joints.iter().map(|j| [place(&j.between[0]), place(&j.between[1])]).collect();
        let followed: BTreeSet<&str> =
            self.joints.iter().filter_map(|j| j.mimic.as_ref()).map(|m| m.joint.as_str()).collect();
        let coupling = |j: &JointEntry<'_>| {
            Coupling::of(j.mimic.is_some(), followed.contains(j.name.as_str()))
        };
        let named: Vec<_> =
            self.joints.iter().map(|j| (j.name.clone(), j.kind, coupling(j))).collect();
        let ranks: Vec<Rank<'_>> = named
            .iter()
            .map(|(name, kind, coupling)| Rank::new(name, *kind, *coupling, actuated(*kind)))
            .collect();
        let mut groups = crate::model::formats::graph::Groups::new(graph.names.len());
        ends.iter().for_each(|[a, b]| _ = groups.join(*a, *b));
        let mut roots = vec![root];
        for link in 0..graph.names.len() {
            if groups.join(root, link) {
                let kind = if is_static { JointKind::Fixed } else { JointKind::Free };
                let name = &graph.names[link];
                builder.joint(JointSpec {
                    parent_from_joint: graph.poses[root].inverse() * graph.poses[link],
                    actuated: false,
                    ..JointSpec::new(&format!("{name}.base"), kind, &graph.names[root], name)
                });
                if let Some(placed) = self.frames.get(name)
                    && !is_static
                {
                    let why = "no joint connects it with the rest; it moves freely";
                    self.reader.note(placed.node, "link without a joint", why, name);
                }
                roots.push(link);
            }
        }
        let spanned = spanning_tree(graph.names.len(), &ends, &ranks, &roots);
        for branch in &spanned.tree {
            let joint = &self.joints[branch.joint];
            builder.joint(graph.branch(joint, branch));
        }
        for &j in &spanned.loops {
            builder.closing_joint(graph.closing(&self.joints[j], ends[j]));
        }
        if let Some(&first) = spanned.loops.first() {
            let node = self.joints[first].node;
            let why = "SDF names none: every joint of one coordinate counts as actuated";
            self.reader.note(node, "motors", why, "");
        }
        Ok(())
    }

    fn add_frames(&mut self, builder: &mut Builder, index: &BTreeMap<&str, usize>) -> Result<()> {
        for name in &self.named {
            let link = self.frames.link(&self.reader, name)?;
            if !index.contains_key(link.as_str()) {
                continue;
            }
            let of = |frame: &str| self.frames.pose(&self.reader, frame);
            let link_from_frame = of(&link)?.inverse() * of(name)?;
            builder.frame(name, &link, link_from_frame);
        }
        Ok(())
    }
}

/// True for joints of these kinds, which count as actuated.
fn actuated(kind: JointKind) -> bool {
    kind.dof() == 1
}

/// The links and their poses.
struct Graph<'a> {
    names: &'a [String],
    poses: &'a [Pose],
    world_from_model: Pose,
}

impl Graph<'_> {
    /// A joint of the tree.
    fn branch(&self, joint: &JointEntry<'_>, branch: &Branch) -> JointSpec {
        let world_from_joint = self.world_from_model * joint.model_from_joint;
        JointSpec {
            name: joint.name.clone(),
            kind: joint.kind,
            parent: self.names[branch.parent].clone(),
            child: self.names[branch.child].clone(),
            parent_from_joint: self.poses[branch.parent].inverse() * world_from_joint,
            joint_from_child: world_from_joint.inverse() * self.poses[branch.child],
            axis: joint.axis,
            reversed: branch.reversed,
            limits: joint.limits,
            mimic: joint.mimic.clone(),
            actuated: actuated(joint.kind),
            armature: 0.0,
        }
    }

    fn closing(&self, joint: &JointEntry<'_>, [a, b]: [usize; 2]) -> LoopJointSpec {
        let world_from_joint = self.world_from_model * joint.model_from_joint;
        LoopJointSpec {
            name: joint.name.clone(),
            kind: joint.kind,
            a: self.names[a].clone(),
            b: self.names[b].clone(),
            link_a_from_joint: self.poses[a].inverse() * world_from_joint,
            link_b_from_joint: self.poses[b].inverse() * world_from_joint,
            axis: joint.axis,
            limits: joint.limits,
            actuated: actuated(joint.kind),
        }
    }
}
