//! Screw systems of limbs: twists, constraint wrenches and actuation wrenches of each serial or
//! closed connection between ground and platform.
//!
//! Formula  T_i  twists of the platform with limb i only
//!          W_i^c = T_i^perp, the wrenches that the limb resists whatever its actuators do
//!          W_i^c + W_i^a = (T_i with the actuators of the limb locked)^perp
//!          T = intersection of all T_i = (sum of all W_i^c)^perp, ^perp: reciprocal
//! Shapes   dim T_i: connectivity; dim T_i + dim W_i^c = d (6, in the plane 3)
//! Units    m, rad
//! Frame    world, at the world origin
//! Valid    any mechanism. W_i^a is determined up to W_i^c: it is taken orthogonal to W_i^c at the
//!          centre of the limb's joints at the platform, with the characteristic length; forces
//!          through that centre stay forces through it. In the plane, wrenches of the plane only
//! Why so   limbs act on the platform in parallel, so that spaces of wrenches add up and spaces of
//!          twists intersect; no choice of loop joints enters
//! Source   Hunt 1978; Zlatanov, Bonev & Gosselin 2002; Joshi & Tsai 2002
//! Checked  tests/it/closure/limbs.rs

use super::limb_graph::{EdgeKind, LimbEdges, limbs};
use super::limb_motion::{LimbColumn, LimbConstraint, LimbMotion, PlatformCoordinates};
use crate::closure::constraint::constraint_rows::constraint_rows;
use crate::error::Result;
use crate::kinematics::State;
use crate::linalg::{ColumnSpace, Matrix, Threshold, dot, norm};
use crate::model::{FrameId, JointKind, Mechanism};
use crate::screws::{ScrewOptions, ScrewSystem};
use crate::spatial::{Twist, Vec3};
use crate::tolerance::{CLOSURE_BLOCK, KERNEL_ROUNDING};

/// A limb and its screw systems. A wrench is given as the screw of its axis: force in place of the
/// angular velocity, moment in place of the linear velocity.
#[derive(Debug, Clone)]
pub struct Limb {
    /// Its joints and contacts, from ground to platform if it is serial.
    pub joints: Vec<String>,
    /// Its actuated coordinates and loop joints.
    pub actuated: Vec<String>,
    /// False if it has loops of its own, such as a parallelogram.
    pub serial: bool,
    /// Twists that the limb permits to the platform; their number is the connectivity.
    pub twists: ScrewSystem,
    /// Wrenches on the platform that the limb resists whatever its actuators do.
    pub constraint: ScrewSystem,
    /// Wrenches on the platform that its actuators balance, beyond the constraint wrenches.
    pub actuation: ScrewSystem,
    pub(crate) space: LimbSpace,
}

/// The scaled spaces of a limb, at the reference point.
#[derive(Debug, Clone)]
pub(crate) struct LimbSpace {
    edges: LimbEdges,
    motion: LimbMotion,
    pub(crate) constraint: Matrix,
    /// Centre of its joints at the platform.
    pub(crate) center: Vec3,
    /// Its actuators; none if there is no other limb.
    pub(crate) actuators: Vec<Actuator>,
}

/// An actuated coordinate of a limb.
#[derive(Debug, Clone)]
pub(crate) struct Actuator {
    pub(crate) name: String,
    /// The wrench that it alone balances, beyond the constraint wrenches; `None` if there is none.
    pub(crate) wrench: Option<Vec<f64>>,
    /// Its twist at the reference point (world axes), for a unit rate.
    pub(crate) twist: Twist,
    /// Power of the wrench with the platform for a unit rate.
    pub(crate) power: f64,
    /// Where its link passes the motion on.
    pub(crate) point: Option<Vec3>,
}

/// The limbs of a mechanism between ground and platform, with their screw systems.
///
/// ```text
/// T = intersection of T_i = (sum of W_i^c)^perp
/// ```
///
/// Source: Hunt 1978; Zlatanov, Bonev & Gosselin 2002; Joshi & Tsai 2002.
#[derive(Debug, Clone)]
pub struct LimbScrews {
    /// The limbs, in the order of their first joints.
    pub limbs: Vec<Limb>,
    /// Twists of the platform.
    pub twists: ScrewSystem,
    /// Wrenches on the platform that the limbs resist together whatever the actuators do.
    pub constraint: ScrewSystem,
    pub(crate) platform: PlatformCoordinates,
    /// Number of actuated coordinates and loop joints of the mechanism.
    pub(crate) actuators: usize,
}

impl LimbScrews {
    /// At a configuration, for the mechanism's reference frame or another on the platform, with its
    /// characteristic length or another (m).
    ///
    /// ```
    /// use cylindroid::closure::LimbScrews;
    ///
    /// // Each leg of a Stewart platform permits all motions; its cylinder pushes along a line.
    /// let stewart = cylindroid::load("stewart")?;
    /// let screws = LimbScrews::of(&stewart.state(stewart.home())?, None, None)?;
    /// assert_eq!(screws.limbs.len(), 6);
    /// let leg = &screws.limbs[0];
    /// assert_eq!((leg.twists.order(), leg.constraint.order()), (6, 0));
    /// assert!(leg.actuation.principal_screws()[0].pitch.abs() < 1e-9);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`ClosedChain::of`](super::super::ClosedChain::of).
    pub fn of(state: &State, reference: Option<FrameId>, length: Option<f64>) -> Result<Self> {
        let mechanism = state.mechanism();
        let reference = reference.unwrap_or_else(|| mechanism.reference());
        mechanism.check_frame(reference)?;
        let length = mechanism.length_or(length)?;
        let platform = PlatformCoordinates::of(mechanism, state, reference, length);
        let (rows, ..) = constraint_rows(state)?;
        let mut all = Vec::new();
        let edges = limbs(mechanism, reference);
        let fixed = mechanism.frame_of(reference).slot == 0;
        let several = edges.len() > 1;
        for limb in edges {
            let constraint = LimbConstraint::of(state, &limb, &rows, &platform);
            all.push(Limb::of(state, limb, &constraint, &platform, several)?);
        }
        let d = platform.d();
        let wrenches: Vec<&Matrix> = all.iter().map(|l| &l.space.constraint).collect();
        let whole = if fixed {
            ColumnSpace::of(&Matrix::identity(d), Threshold::Absolute(CLOSURE_BLOCK))
        } else {
            span(&platform, &wrenches)
        };
        Ok(Self {
            twists: platform.twist_system(&whole.complement())?,
            constraint: platform.wrench_system(&whole.basis())?,
            limbs: all,
            actuators: actuators(mechanism),
            platform,
        })
    }
}

impl Limb {
    fn of(
        state: &State,
        edges: LimbEdges,
        constraint: &LimbConstraint,
        platform: &PlatformCoordinates,
        several: bool,
    ) -> Result<Self> {
        let mechanism = state.mechanism();
        let motion = constraint.twists(&|_| false);
        let center = edges.platform_point(state, platform.origin);
        let wrenches = complement(platform, &motion.basis);
        let locked = constraint.twists(&|j| constraint.columns[j].actuated);
        let actuation = beyond(platform, &locked.basis, &wrenches, center);
        // The weld of a joint that is cut in a link is no joint of the file.
        let names = |e: &super::limb_graph::Edge| match e.kind {
            EdgeKind::Joint(i) => Some(mechanism.joints()[i].name.clone()),
            EdgeKind::Loop(i) => {
                let joint = &mechanism.loops()[i];
                (!joint.is_cut(&mechanism.links()[joint.a].name)).then(|| joint.name.clone())
            }
            EdgeKind::Contact(i) => Some(mechanism.contacts()[i].name.clone()),
        };
        let mut space =
            LimbSpace { constraint: wrenches, center, actuators: Vec::new(), edges, motion };
        // The indices of transmission compare limbs.
        let actuated = |c: &LimbColumn| several && c.actuated;
        for (j, column) in constraint.columns.iter().enumerate().filter(|(_, c)| actuated(c)) {
            let others_free = constraint.twists(&|k| k == j);
            let wrench = beyond(platform, &others_free.basis, &space.constraint, center);
            let wrench = (wrench.cols() > 0).then(|| wrench.column(0).to_vec());
            let power = wrench.as_deref().map_or(0.0, |w| match &space.motion.rates {
                Some(rates) => space.power(platform, w, &rates[j]),
                None => platform.length * dot(w, space.motion.twists.column(j)) / column.size,
            });
            space.actuators.push(Actuator {
                name: column.name.clone(),
                wrench,
                power,
                twist: joint_twist(state, column.edge, &column.name, platform.origin),
                point: space.edges.transmission_point(state, platform.origin, column.edge),
            });
        }
        Ok(Self {
            joints: space.edges.edges.iter().filter_map(names).collect(),
            actuated: {
                let actuated = constraint.columns.iter().filter(|c| c.actuated);
                actuated.map(|c| c.name.clone()).collect()
            },
            serial: space.edges.serial,
            twists: platform.twist_system(&space.motion.basis)?,
            constraint: platform.wrench_system(&space.constraint)?,
            actuation: platform.wrench_system(&actuation)?,
            space,
        })
    }
}

impl LimbSpace {
    /// The power of a wrench that does no work while a column is at rest, for a unit rate of it;
    /// `rates`: those of the column in all motions.
    fn power(&self, platform: &PlatformCoordinates, wrench: &[f64], rates: &[f64]) -> f64 {
        let size = dot(rates, rates);
        let powers = self.motion.twists.transpose().mul_vec(wrench);
        let along = dot(&powers, rates);
        if size > 0.0 { platform.length * along / size } else { 0.0 }
    }
}

/// The twist of a joint for a unit rate of the coordinate `name`: that of its farther link in the
/// tree, of the second link of a loop joint.
fn joint_twist(state: &State, edge: EdgeKind, name: &str, at: Vec3) -> Twist {
    let mechanism = state.mechanism();
    match edge {
        EdgeKind::Joint(i) => {
            let joint = &mechanism.joints()[i];
            let [parent, child] = [joint.parent, joint.child].map(|l| mechanism.link_frame(l));
            let end = mechanism.frame_of(parent).slot;
            let mut found = Twist::ZERO;
            state.tip(child).for_each_column_above(end, at, |_, c, twist| {
                if mechanism.coordinates()[c].name == name {
                    found = twist;
                }
            });
            found
        }
        EdgeKind::Loop(i) => {
            let joint = &mechanism.loops()[i];
            let frame = state.link_pose(joint.a) * joint.link_a_from_joint;
            let axis = frame.rotation * joint.axis;
            let turn = Twist { linear: axis.cross(at - frame.translation), angular: axis };
            let slide = Twist { linear: axis, angular: Vec3::ZERO };
            match joint.kind {
                JointKind::Prismatic => slide,
                JointKind::Helical { pitch } => turn + slide * pitch,
                _ => turn,
            }
        }
        EdgeKind::Contact(_) => Twist::ZERO,
    }
}

/// The space that orthonormal columns span together.
pub(crate) fn span(platform: &PlatformCoordinates, parts: &[&Matrix]) -> ColumnSpace {
    ColumnSpace::of(&Matrix::hstack(platform.d(), parts), Threshold::Absolute(CLOSURE_BLOCK))
}

fn complement(platform: &PlatformCoordinates, twists: &Matrix) -> Matrix {
    span(platform, &[twists]).complement()
}

/// The wrenches reciprocal to `locked`, orthogonal to `wrenches` at `center`.
fn beyond(
    platform: &PlatformCoordinates,
    locked: &Matrix,
    wrenches: &Matrix,
    center: Vec3,
) -> Matrix {
    // Twists of the limb are reciprocal to its constraint wrenches: both leave what is beyond.
    let rest = span(platform, &[locked, wrenches]).complement();
    let at_center = platform.orthogonal_at(center, &rest, wrenches);
    let columns: Vec<Vec<f64>> = (0..at_center.cols())
        .map(|j| {
            let column = at_center.column(j);
            let size = norm(column);
            column.iter().map(|x| x / size).collect()
        })
        .collect();
    Matrix::from_fn(platform.d(), columns.len(), |i, j| columns[j][i])
}

impl PlatformCoordinates {
    fn options(&self) -> ScrewOptions {
        ScrewOptions { noise: KERNEL_ROUNDING, ..ScrewOptions::with_length(self.length) }
    }

    fn twist_system(&self, columns: &Matrix) -> Result<ScrewSystem> {
        let at_world = |j| self.twist(columns.column(j)).at_point(-self.origin);
        ScrewSystem::of(&(0..columns.cols()).map(at_world).collect::<Vec<_>>(), &self.options())
    }

    fn wrench_system(&self, columns: &Matrix) -> Result<ScrewSystem> {
        let at_world = |j| {
            let wrench = self.wrench(columns.column(j)).at_point(-self.origin);
            Twist { linear: wrench.moment, angular: wrench.force }
        };
        ScrewSystem::of(&(0..columns.cols()).map(at_world).collect::<Vec<_>>(), &self.options())
    }
}

/// Number of actuated coordinates and loop joints of a mechanism.
fn actuators(mechanism: &Mechanism) -> usize {
    mechanism.actuated().count() + mechanism.loops().iter().filter(|l| l.actuated).count()
}
