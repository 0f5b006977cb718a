//! Other models of an MJCF file, read for `<attach>`.
//!
//! Checked  tests/formats/mjcf_copies.rs::attached_*

use std::cell::Cell;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::PathBuf;
use std::rc::Rc;

use crate::error::shown;
use crate::model::formats::inclusion::Together;
use crate::model::{JointSpec, Link, LoadReport, LoopJointSpec, Mimic};
use crate::spatial::Pose;

/// The place of a model among those that attach one another.
#[derive(Clone, Copy)]
pub(super) struct Nesting<'a> {
    pub(super) depth: usize,
    /// Models read so far.
    pub(super) models: &'a Cell<usize>,
    pub(super) together: &'a Together,
}

/// Another model, as it was read.
pub(super) struct Part {
    pub(super) links: Vec<Link>,
    pub(super) joints: Vec<JointSpec>,
    pub(super) loops: Vec<LoopJointSpec>,
    pub(super) sums: BTreeMap<String, Vec<Mimic>>,
    pub(super) disabled_collisions: Vec<[String; 2]>,
    pub(super) sites: Vec<(String, String, Pose)>,
    /// Home positions of joints, later ones take precedence.
    pub(super) starts: BTreeMap<String, Vec<Vec<f64>>>,
    pub(super) world: BTreeMap<String, Pose>,
    pub(super) first_joint: BTreeMap<String, usize>,
    pub(super) path: PathBuf,
    pub(super) report: LoadReport,
    pub(super) by_link: ByLink,
}

/// Indices of what a part has at each of its links: an `<attach>` costs as much as what it brings.
#[derive(Default)]
pub(super) struct ByLink {
    pub(super) links: Indices,
    pub(super) sites: Indices,
    /// Pairs that do not collide, at the first of both.
    pub(super) pairs: Indices,
    /// At both links.
    pub(super) loops: Indices,
    /// Bodies at their first joints.
    pub(super) bodies: BTreeMap<usize, String>,
}

#[derive(Default)]
pub(super) struct Indices(BTreeMap<String, Vec<usize>>);

impl Indices {
    fn add(&mut self, link: &str, index: usize) {
        match self.0.get_mut(link) {
            Some(all) => all.push(index),
            None => _ = self.0.insert(link.to_owned(), vec![index]),
        }
    }

    /// Those at any of these links, in their order.
    pub(super) fn at(&self, links: &BTreeSet<String>) -> Vec<usize> {
        let all: BTreeSet<usize> =
            links.iter().filter_map(|link| self.0.get(link)).flatten().copied().collect();
        all.into_iter().collect()
    }
}

impl ByLink {
    pub(super) fn of(
        links: &[Link],
        sites: &[(String, String, Pose)],
        pairs: &[[String; 2]],
        loops: &[LoopJointSpec],
        first_joint: &BTreeMap<String, usize>,
    ) -> Self {
        let mut it = Self::default();
        links.iter().enumerate().for_each(|(i, link)| it.links.add(&link.name, i));
        sites.iter().enumerate().for_each(|(i, site)| it.sites.add(&site.1, i));
        pairs.iter().enumerate().for_each(|(i, pair)| it.pairs.add(&pair[0], i));
        for (i, joint) in loops.iter().enumerate() {
            it.loops.add(&joint.a, i);
            it.loops.add(&joint.b, i);
        }
        it.bodies = first_joint.iter().map(|(body, i)| (*i, body.clone())).collect();
        it
    }
}

/// A body of a part with all that it carries; or the world, with the whole part.
pub(super) struct Subtree {
    pub(super) is_whole: bool,
    /// The link that carries it in its own model.
    pub(super) base: String,
    pub(super) joints: Range<usize>,
    pub(super) links: BTreeSet<String>,
}

impl Part {
    /// The subtree of a body, or of the world; `None` if there is no such body.
    pub(super) fn subtree(&self, body: Option<&str>) -> Option<Subtree> {
        let start = body.map_or(Some(0), |body| self.first_joint.get(body).copied())?;
        let is_whole = body.is_none();
        let carrier = self.joints.get(start).filter(|_| !is_whole).map(|j| j.parent.clone());
        let mut it = Subtree {
            is_whole,
            base: carrier.unwrap_or_else(|| "world".to_owned()),
            joints: start..start,
            links: BTreeSet::new(),
        };
        for joint in &self.joints[start..] {
            if !(it.links.contains(&joint.parent) || it.is_first(it.joints.end, joint)) {
                break;
            }
            it.links.insert(joint.child.clone());
            it.joints.end += 1;
        }
        Some(it)
    }
}

impl Subtree {
    /// The indices of the sites of a part that it has.
    pub(super) fn sites(&self, part: &Part) -> Vec<usize> {
        match self.is_whole {
            true => (0..part.sites.len()).collect(),
            false => part.by_link.sites.at(&self.links),
        }
    }

    /// The number of shapes of a part that it has.
    pub(super) fn shapes(&self, part: &Part) -> usize {
        let own = part.by_link.links.at(&self.links);
        let world = self.is_whole.then_some(0);
        let links = own.into_iter().chain(world).map(|i| &part.links[i]);
        links.map(|l| l.visuals.len() + l.collisions.len()).sum()
    }

    /// True for a joint at its base.
    pub(super) fn is_first(&self, index: usize, joint: &JointSpec) -> bool {
        joint.parent == self.base && (self.is_whole || index == self.joints.start)
    }
}

/// Reports what was ignored in other models.
pub(super) fn report_of_parts(parts: &BTreeMap<String, Rc<Part>>, report: &mut LoadReport) {
    for part in parts.values() {
        for note in &part.report.ignored {
            let what = format!("{} (in {})", note.what, shown(&part.path));
            report.ignore(note.line, what, &*note.why);
        }
    }
}
