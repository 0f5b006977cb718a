//! Grasp contacts: the contacts of a mechanism on an object, as the fingers of a grasp.
//!
//! Formula  point and normal of the contact frame on the object, at the configuration of the state;
//!          if the file names the object first, the normal is reversed so that it points into the
//!          object
//! Units    mu has none, torsion is a length (m): largest moment about the normal over the normal
//!          force
//! Frame    world
//! Valid    point contacts: `point_frictionless`, `hard_finger`, `soft_finger` (in the plane a hard
//!          finger). The model does not give the pressure distribution of line, plane and complete
//!          contacts
//! Source   Bicchi & Prattichizzo 1998, table 1, for the kinds
//! Checked  tests/it/closure/grasp.rs::fingers_*

use super::force_closure::{FingerContact, Friction, WrenchSpace};
use crate::error::{Error, Result};
use crate::kinematics::State;
use crate::model::{Contact, ContactKind, Dimension, FrameId};
use crate::spatial::{Pose, Vec3};
use crate::tolerance::CLOSED;

/// Properties of a contact besides its kind.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactProperties {
    /// Coefficient of friction that replaces the one of the file [-].
    pub mu: Option<f64>,
    /// Largest moment about the normal over the normal force (m), for soft fingers.
    pub torsion: Option<f64>,
    /// Largest normal force (N).
    pub strength: f64,
}

/// The contacts on the link that carries `object`, with their indices in the mechanism;
/// `properties` gives the properties of each.
///
/// ```
/// use cylindroid::closure::{
///     ContactProperties, GraspMetric, WrenchSpace, grasp_contacts, grasp_quality,
/// };
/// use cylindroid::model::{ContactKind, ContactSpec, JointKind, JointSpec, Mechanism};
/// use cylindroid::{Pose, Rotation, Vec3};
///
/// // Two fingers on opposite sides of a free object.
/// let mut builder = Mechanism::builder("gripper");
/// builder.joint(JointSpec::new("float", JointKind::Free, "base", "object"));
/// for (name, side) in [("left", -1.0), ("right", 1.0)] {
///     let finger = format!("{name} finger");
///     builder.joint(JointSpec::new(&finger, JointKind::Prismatic, "base", &finger));
///     let inward = Rotation::z_to(Vec3::X * -side).unwrap();
///     let at = Pose { rotation: inward, translation: Vec3::X * (0.05 * side) };
///     builder.contact(ContactSpec {
///         link_a_from_contact: at,
///         link_b_from_contact: at,
///         friction: Some(0.5),
///         ..ContactSpec::new(name, ContactKind::HardFinger, &finger, "object")
///     });
/// }
/// let gripper = builder.build()?;
/// let (state, object) = (gripper.state(gripper.home())?, gripper.frame("object")?);
/// let properties = |_: &_| ContactProperties { mu: None, torsion: None, strength: 1.0 };
/// let fingers: Vec<_> =
///     grasp_contacts(&state, object, properties)?.into_iter().map(|(_, f)| f).collect();
/// let space = WrenchSpace::about(&state, object, &fingers)?;
/// // Hard fingers resist no moment about the line through both.
/// assert!(!grasp_quality(&fingers, space, GraspMetric::L1)?.closed);
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// # Errors
/// A frame of another mechanism; a contact on it that is no point contact, or whose coefficients
/// are unknown.
pub fn grasp_contacts(
    state: &State,
    object: FrameId,
    properties: impl Fn(&Contact) -> ContactProperties,
) -> Result<Vec<(usize, FingerContact)>> {
    let mechanism = state.mechanism();
    mechanism.check_frame(object)?;
    let link = mechanism.frame_of(object).link;
    let world_from_link = state.link_pose(link);
    let mut fingers = Vec::new();
    for (place, contact) in mechanism.contacts().iter().enumerate() {
        let (link_from_contact, sign): (Pose, f64) = if contact.b == link {
            (contact.link_b_from_contact, 1.0)
        } else if contact.a == link {
            (contact.link_a_from_contact, -1.0)
        } else {
            continue;
        };
        let at = world_from_link * link_from_contact;
        let known = properties(contact);
        let normal: Vec3 = at.rotation.z_axis() * sign;
        let friction =
            friction(contact, known, mechanism.dimension()).map_err(|message| Error::Model {
                model: mechanism.name().to_owned(),
                culprit: contact.name.clone(),
                message,
            })?;
        let curvature = contact.curvature.unwrap_or_default();
        let curvature = if sign > 0.0 { curvature } else { curvature.exchanged() };
        let finger = FingerContact {
            point: at.translation,
            normal,
            friction,
            strength: known.strength,
            curvature: curvature.rotated(at.rotation),
        };
        fingers.push((place, finger));
    }
    Ok(fingers)
}

fn friction(
    contact: &Contact,
    known: ContactProperties,
    dimension: Dimension,
) -> std::result::Result<Friction, String> {
    let name = &contact.name;
    let mu = || {
        known.mu.or(contact.friction).ok_or_else(|| {
            format!("contact '{name}' has no coefficient of friction; set friction, or give mu")
        })
    };
    match contact.kind {
        ContactKind::PointFrictionless => Ok(Friction::None),
        ContactKind::HardFinger => Ok(Friction::Hard { mu: mu()? }),
        ContactKind::SoftFinger if dimension == Dimension::Planar => {
            Ok(Friction::Hard { mu: mu()? })
        }
        ContactKind::SoftFinger => {
            let torsion = known.torsion.ok_or_else(|| {
                format!(
                    "contact '{name}' is a soft finger; give torsion, its largest moment about \
                     the normal over the normal force (m)"
                )
            })?;
            Ok(Friction::Soft { mu: mu()?, torsion })
        }
        other => Err(format!(
            "contact '{name}' is {}: force closure needs point contacts; model it as several hard \
             or soft fingers at its corners",
            other.name()
        )),
    }
}

impl WrenchSpace {
    /// At the origin of `object` in world axes, with moments divided by the distance to the
    /// farthest of these fingers (by the characteristic length of the mechanism if all are at the
    /// origin).
    /// # Errors
    /// A frame of another mechanism.
    pub fn about(state: &State, object: FrameId, fingers: &[FingerContact]) -> Result<Self> {
        let mechanism = state.mechanism();
        mechanism.check_frame(object)?;
        let point = state.pose_of(object).translation;
        let farthest = fingers.iter().map(|f| (f.point - point).norm()).fold(0.0, f64::max);
        let length =
            if farthest > CLOSED * mechanism.reach() { farthest } else { mechanism.reach() };
        Ok(Self { point, length, planar: mechanism.dimension() == Dimension::Planar })
    }
}
