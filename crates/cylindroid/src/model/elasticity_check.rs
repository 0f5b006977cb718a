//! Checks of elastic parts against the mechanism that has them.
//!
//! Checked  tests/formats/elasticity.rs

use super::elasticity::{ElasticElement, ElasticKind, Elasticity};
use super::mechanism::Mechanism;
use crate::error::{Error, Result};
use crate::linalg::{Matrix, SymmetricEigen};
use crate::tolerance::RIGID;

impl Elasticity {
    /// Refuses names that the mechanism does not have, and values without meaning.
    ///
    /// # Errors
    /// [`Error::UnknownName`]; [`Error::InvalidOption`] for a stiffness that is not positive, a
    /// compliance of the wrong size, not symmetric or not positive semidefinite, a loop joint of
    /// several coordinates with a stiffness along its motion, or the root link.
    pub fn check(&self, mechanism: &Mechanism) -> Result<()> {
        self.elements.iter().try_for_each(|e| e.check(mechanism))
    }
}

impl ElasticElement {
    fn check(&self, mechanism: &Mechanism) -> Result<()> {
        let name = self.name.as_str();
        let refuse = |reason: String| {
            Err(Error::InvalidOption { option: "elasticity", value: name.to_owned(), reason })
        };
        let tree = mechanism.joints().iter().map(|j| j.name.as_str());
        let loops = mechanism.loops().iter().map(|l| l.name.as_str());
        let links = || mechanism.links().iter().map(|l| l.name.as_str());
        let body = match &self.kind {
            ElasticKind::Motion { stiffness } => {
                if !(*stiffness > 0.0 && stiffness.is_finite()) {
                    return refuse(format!(
                        "stiffness {stiffness}: give a positive, finite number"
                    ));
                }
                if let Some(joint) = mechanism.loops().iter().find(|l| l.name == name)
                    && joint.kind.dof() != 1
                {
                    return refuse(format!(
                        "it closes a loop and has {} coordinates: only loop joints of one \
                         coordinate can have a stiffness along their motion",
                        joint.kind.dof()
                    ));
                }
                if let Some(joint) = mechanism.joints().iter().find(|j| j.name == name) {
                    if let Some(mimic) = &joint.mimic {
                        return refuse(format!("it follows '{}'; name that joint", mimic.joint));
                    }
                    if joint.kind.dof() == 0 {
                        return refuse("it is fixed; give a compliance instead".to_owned());
                    }
                }
                let mut own = mechanism
                    .coordinates()
                    .iter()
                    .filter(|c| mechanism.joints()[c.joint].name == name)
                    .map(|c| c.kind.is_length());
                if let Some(first) = own.next()
                    && own.any(|length| length != first)
                {
                    return refuse(
                        "it has angles and lengths, whose stiffnesses have different units; name \
                         its coordinates one by one"
                            .to_owned(),
                    );
                }
                let coordinates = mechanism.coordinates().iter().map(|c| c.name.as_str());
                let known: Vec<&str> = tree.chain(loops).chain(coordinates).collect();
                return if known.contains(&name) {
                    Ok(())
                } else {
                    Err(Error::unknown("joint", name, known))
                };
            }
            ElasticKind::Joint(body) => {
                let contacts = mechanism.contacts().iter().map(|c| c.name.as_str());
                let known: Vec<&str> = tree.chain(loops).chain(contacts).collect();
                if !known.contains(&name) {
                    return Err(Error::unknown("joint or contact", name, known));
                }
                body
            }
            ElasticKind::Link(body) => {
                let Some(link) = links().position(|l| l == name) else {
                    return Err(Error::unknown("link", name, links()));
                };
                if !mechanism.joints().iter().any(|j| j.child == link) {
                    return refuse("it is the root, which does not move".to_owned());
                }
                body
            }
        };
        if let Some((link, pose)) = &body.frame {
            if !links().any(|l| l == link) {
                return Err(Error::unknown("link", link, links()));
            }
            if !pose.is_finite() {
                return refuse("the pose of its frame is not finite".to_owned());
            }
        }
        let d = mechanism.dimension().freedoms();
        let c = &body.compliance;
        if (c.rows(), c.cols()) != (d, d) {
            return refuse(format!("the compliance must be {d} x {d} (linear part first)"));
        }
        if !c.is_finite() || !c.is_symmetric() {
            return refuse("the compliance must be finite and symmetric".to_owned());
        }
        let [largest, least] = extremes(c, mechanism.reach());
        if least < -RIGID * largest.max(-least) {
            return refuse("the compliance must be positive semidefinite".to_owned());
        }
        Ok(())
    }
}

/// Largest and least eigenvalue of a compliance, with lengths divided by `length`.
fn extremes(compliance: &Matrix, length: f64) -> [f64; 2] {
    let d = compliance.rows();
    // x, y, z and three rotations, or x, y and one.
    let linear = if d == 6 { 3 } else { 2 };
    let size = |i: usize| if i < linear { length } else { 1.0 };
    let mut scaled = [[0.0; 6]; 6];
    for (i, row) in scaled.iter_mut().enumerate().take(d) {
        for (j, entry) in row.iter_mut().enumerate().take(d) {
            *entry = compliance[(i, j)] / (size(i) * size(j));
        }
    }
    let values = SymmetricEigen::of(scaled, d).values;
    [values[0], values[d - 1]]
}

impl Mechanism {
    /// As [`Elasticity::check`] of its own, with the part as the culprit.
    pub(super) fn check_elasticity(&self) -> Result<()> {
        self.elasticity().elements.iter().try_for_each(|element| {
            element.check(self).map_err(|error| Error::Model {
                model: self.name().to_owned(),
                culprit: format!("elasticity of {}", element.name),
                message: error.to_string(),
            })
        })
    }

    /// Its elastic parts, as in the file.
    #[must_use]
    pub fn elasticity(&self) -> &Elasticity {
        &self.data.elasticity
    }
}
