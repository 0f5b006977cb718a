//! Elasticity of joints, contacts and links: stiffness along motions, compliance in all directions.
//!
//! Units    stiffness N m/rad or N/m; compliance m/N, rad/N, m/(N m), rad/(N m)
//! Frame    a compliance matrix relates a wrench at the origin of its frame, in its axes, to the
//!          twist there, linear part first
//! Checked  tests/it/manipulability/stiffness.rs, tests/formats/elasticity.rs

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
}
