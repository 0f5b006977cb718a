//! Mimic joints: resolution of chains of mimic joints.
//!
//! Checked  tests/it/model.rs, tests/formats/mechanism_file.rs::mimics_are_read

use std::collections::BTreeMap;

use super::builder::Builder;
use super::joint::Mimic;
use super::joint_spec::JointSpec;
use super::magnitude;
use crate::error::{Error, Result};

impl Builder {
    /// For every mimic joint the independent joint at the end of its chain, with the total ratio
    /// and offset.
    pub(super) fn resolve_mimics(&self) -> Result<BTreeMap<usize, (usize, f64, f64)>> {
        let mut resolved: BTreeMap<usize, (usize, f64, f64)> = BTreeMap::new();
        let by_name: BTreeMap<&str, usize> =
            self.joints.iter().enumerate().map(|(j, o)| (o.name.as_str(), j)).collect();
        for first in 0..self.joints.len() {
            // The joints of a chain that are not resolved yet, each of which follows the next.
            let mut chain: Vec<(usize, &Mimic)> = Vec::new();
            let mut at = first;
            while let (Some(mimic), None) = (&self.joints[at].mimic, resolved.get(&at)) {
                if chain.len() > self.joints.len() {
                    let name = self.joints[first].name.as_str();
                    return self.refuse(
                        name,
                        format!("mimic joint '{name}' follows itself in a ring of mimic joints"),
                    );
                }
                chain.push((at, mimic));
                at = match by_name.get(mimic.joint.as_str()) {
                    Some(&leader) => leader,
                    None => return self.follows_no_joint(&self.joints[at].name, &mimic.joint),
                };
            }
            for (follower, mimic) in chain.into_iter().rev() {
                let (source, ratio, shift) = resolved.get(&at).copied().unwrap_or((at, 1.0, 0.0));
                let multiplier = mimic.multiplier * ratio;
                let offset = mimic.offset + mimic.multiplier * shift;
                self.check_mimic(&self.joints[follower], source, [multiplier, offset])?;
                resolved.insert(follower, (source, multiplier, offset));
                at = follower;
            }
        }
        Ok(resolved)
    }

    /// Refuses a mimic joint that follows what is no joint of the tree.
    fn follows_no_joint<T>(&self, name: &str, leader: &str) -> Result<T> {
        if self.loops.iter().any(|l| l.name == leader) {
            return self.refuse(
                name,
                format!(
                    "mimic joint '{name}' follows '{leader}', which closes a loop and has no \
                     coordinate"
                ),
            );
        }
        let known = self.joints.iter().map(|o| o.name.as_str());
        let unknown = Error::unknown("joint", leader, known);
        self.refuse(name, format!("mimic joint '{name}' follows: {unknown}"))
    }

    /// Returns an error for a mimic joint whose total multiplier or offset, or whose kind or that
    /// of the joint at the end of its chain, is none that can follow.
    fn check_mimic(&self, joint: &JointSpec, source: usize, ratio: [f64; 2]) -> Result<()> {
        let (name, source) = (joint.name.as_str(), &self.joints[source]);
        if let Some(fault) = magnitude::fault(&ratio) {
            return self
                .refuse(name, format!("the multiplier or offset of mimic joint '{name}' {fault}"));
        }
        if joint.kind.dof() == 1 && source.kind.dof() == 1 {
            return Ok(());
        }
        self.refuse(
            name,
            format!(
                "mimic joint '{name}' ({}) follows '{}' ({}); both must have one coordinate",
                joint.kind.name(),
                source.name,
                source.kind.name()
            ),
        )
    }
}
