//! Mimic joints: resolution of chains of mimic joints.
//!
//! Checked  tests/it/model.rs, tests/formats/mechanism_file.rs::mimics_are_read

use std::collections::BTreeMap;

use super::builder::Builder;
use super::magnitude;
use crate::error::{Error, Result};

impl Builder {
    /// For every mimic joint the independent joint at the end of its chain, with the total ratio
    /// and offset.
    pub(super) fn resolve_mimics(&self) -> Result<BTreeMap<usize, (usize, f64, f64)>> {
        let mut resolved: BTreeMap<usize, (usize, f64, f64)> = BTreeMap::new();
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
                // A joint that was resolved before ends the chain.
                let known = by_name.get(mimic.joint.as_str()).and_then(|j| resolved.get(j));
                if let Some(&(of, ratio, shift)) = known {
                    offset += multiplier * (mimic.offset + mimic.multiplier * shift);
                    multiplier *= mimic.multiplier * ratio;
                    source = of;
                    break;
                }
                offset += multiplier * mimic.offset;
                multiplier *= mimic.multiplier;
                if let Some(fault) = magnitude::fault(&[multiplier, offset]) {
                    return self.refuse(
                        name,
                        format!("the multiplier or offset of mimic joint '{name}' {fault}"),
                    );
                }
                let Some(&j) = by_name.get(mimic.joint.as_str()) else {
                    if self.loops.iter().any(|l| l.name == mimic.joint) {
                        return self.refuse(
                            name,
                            format!(
                                "mimic joint '{name}' follows '{}', which closes a loop and has \
                                 no coordinate",
                                mimic.joint
                            ),
                        );
                    }
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
}
