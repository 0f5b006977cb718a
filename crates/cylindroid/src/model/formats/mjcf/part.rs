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
