//! Elasticity of joints, contacts and links: stiffness along motions, compliance in all directions.
//!
//! Units    stiffness N m/rad or N/m; compliance m/N, rad/N, m/(N m), rad/(N m)
//! Frame    a compliance matrix relates a wrench at the origin of its frame, in its axes, to the
//!          twist there, linear part first
//! Checked  tests/it/manipulability/stiffness.rs, tests/formats/elasticity.rs

use super::builder::Builder;
use super::mechanism::Mechanism;
use crate::error::{Error, Result};
use crate::linalg::Matrix;
use crate::spatial::Pose;

/// The elastic parts of a mechanism; all others are rigid.
///
/// ```
/// use cylindroid::model::Elasticity;
///
/// // Actuators of a platform with 2e7 N/m each.
/// let stewart = cylindroid::load("stewart")?;
/// let mut elasticity = Elasticity::default();
/// for i in 1..=6 {
///     elasticity.stiffness(&format!("leg{i}"), 2e7);
/// }
/// elasticity.check(&stewart)?;
/// assert!(elasticity.stiffness("leg7", 2e7).check(&stewart).is_err());
/// # Ok::<(), cylindroid::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Elasticity {
    /// The elastic parts.
    pub elements: Vec<ElasticElement>,
}

/// An elastic part of a mechanism.
#[derive(Debug, Clone, PartialEq)]
pub struct ElasticElement {
    /// The joint, coordinate, contact or link.
    pub name: String,
    /// Its elasticity.
    pub kind: ElasticKind,
}

/// The elasticity of a part.
#[derive(Debug, Clone, PartialEq)]
pub enum ElasticKind {
    /// Along the motion of a joint: of the drive of an actuated joint, whose position is commanded
    /// on the other side of the spring; of a spring in a passive joint.
    Motion {
        /// Of each coordinate of the joint [N m/rad or N/m].
        stiffness: f64,
    },
    /// Of a joint or a contact in all directions: of its bearing.
    Joint(ElasticBody),
    /// Of a link, between its joint towards the ground in the spanning tree and everything else on
    /// it.
    Link(ElasticBody),
}

/// A compliance matrix and its frame.
#[derive(Debug, Clone, PartialEq)]
pub struct ElasticBody {
    /// Twist for a wrench: 6 x 6, in the plane 3 x 3 (x, y, rotation); positive semidefinite, rigid
    /// in the directions of its null space.
    pub compliance: Matrix,
    /// The link to which the frame is fixed, and its pose there. Without it: the frame of the joint
    /// on its parent link (of a loop joint or contact, on its first link), the frame of the link.
    pub frame: Option<(String, Pose)>,
}

impl Elasticity {
    /// Adds a stiffness along the motion of a joint, or of one of its coordinates; it replaces an
    /// earlier one of that name.
    pub fn stiffness(&mut self, name: &str, stiffness: f64) -> &mut Self {
        let same =
            |e: &ElasticElement| e.name == name && matches!(e.kind, ElasticKind::Motion { .. });
        self.elements.retain(|e| !same(e));
        self.add(name, ElasticKind::Motion { stiffness })
    }

    /// Adds a compliance of a joint, loop joint or contact in all directions, in the joint's frame.
    pub fn joint(&mut self, name: &str, compliance: Matrix) -> &mut Self {
        self.add(name, ElasticKind::Joint(ElasticBody { compliance, frame: None }))
    }

    /// Adds a compliance of a link, in the frame `link_from_element`.
    pub fn link(&mut self, name: &str, compliance: Matrix, link_from_element: Pose) -> &mut Self {
        let frame = Some((name.to_owned(), link_from_element));
        self.add(name, ElasticKind::Link(ElasticBody { compliance, frame }))
    }

    fn add(&mut self, name: &str, kind: ElasticKind) -> &mut Self {
        self.elements.push(ElasticElement { name: name.to_owned(), kind });
        self
    }

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
        if !c.is_finite() || c.max_difference(&c.transpose()) > 1e-9 * c.max_abs() {
            return refuse("the compliance must be finite and symmetric".to_owned());
        }
        Ok(())
    }
}

impl Builder {
    /// Adds elastic parts; [`Builder::build`] checks their names.
    pub fn elasticity(&mut self, elasticity: Elasticity) -> &mut Self {
        self.elasticity.elements.extend(elasticity.elements);
        self
    }
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
