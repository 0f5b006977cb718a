//! Mass matrix of the joints by the composite-rigid-body algorithm.
//!
//! Formula  M = sum over links of J_i^T W_i J_i, and the armature of every joint on the diagonal,
//!          times the square of the ratio of mimic joints: qd^T M qd is twice the kinetic energy. For each
//!          moving frame the composite body of all links beyond it, (m, c, I about c); the momentum
//!          of that body for a unit rate of each of its joint's coordinates, times the twists of all
//!          coordinates on the way to the root
//! Shapes   n x n
//! Units    kg, kg m, kg m^2; rates are joint velocities (of spherical and free joints in the axes
//!          of the child)
//! Frame    none; computed in world axes about centres of mass, so that a far origin costs no digits
//! Valid    any spanning tree; mimic joints move with the joint that they follow. Links without a
//!          mass do not contribute; [`Mechanism::massless_bodies`] names them. Loops are open here
//! Why so   one composite for each frame instead of one Jacobian for each link: n times the depth
//!          instead of n^2 times the depth; the evaluator allocates nothing
//! Source   Walker & Orin 1982; Featherstone, Rigid Body Dynamics Algorithms, 2008, table 6.2
//! Checked  tests/it/mass_matrix.rs, tests/it/pinocchio.rs

use super::jacobian::Tip;
use super::state::State;
use crate::error::{Error, Result};
use crate::linalg::Matrix;
use crate::model::{Mechanism, Node};
use crate::spatial::{AlignedPose, Mat3, Pose, Twist, Vec3, Wrench};

/// Mass, centre of mass and inertia about it.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Body {
    mass: f64,
    center: Vec3,
    inertia: Mat3,
}

impl Body {
    const NONE: Self = Self { mass: 0.0, center: Vec3::ZERO, inertia: Mat3::ZERO };

    /// Both as one body.
    fn with(self, other: Self) -> Self {
        let mass = self.mass + other.mass;
        if mass == 0.0 {
            return Self { inertia: self.inertia + other.inertia, ..self };
        }
        let center = (self.center * self.mass + other.center * other.mass) * mass.recip();
        let arm = Mat3::skew(other.center - self.center);
        let reduced = self.mass * other.mass / mass;
        let inertia = self.inertia + other.inertia - arm * arm * reduced;
        Self { mass, center, inertia }
    }

    fn moved(self, pose: Pose) -> Self {
        let turn = pose.rotation.matrix();
        let inertia = turn * self.inertia * turn.transpose();
        Self { center: pose * self.center, inertia, ..self }
    }
}

/// The mass matrix of a mechanism at one configuration after another, without allocation.
///
/// ```text
/// M = sum_i J_i^T W_i J_i,   qd^T M qd = 2 E_kin
/// ```
///
/// W_i is the inertia of link i, J_i its Jacobian. M is n x n, in kg, kg m and kg m^2. Links without
/// a mass do not contribute; loops are open.
///
/// Source: Walker & Orin 1982; Featherstone 2008, table 6.2.
///
/// ```
/// use cylindroid::Matrix;
/// use cylindroid::kinematics::MassMatrix;
/// use cylindroid::model::{Inertial, JointKind, JointSpec, Link, Mechanism};
/// use cylindroid::spatial::{Mat3, Pose, Vec3};
///
/// // A pendulum: 2 kg at 0.5 m from the hinge.
/// let mut builder = Mechanism::builder("pendulum");
/// builder.link(Link::named("ground"));
/// let inertial = Inertial {
///     mass: 2.0,
///     link_from_inertia: Pose::from_translation(Vec3::X * 0.5),
///     inertia: Mat3::ZERO,
/// };
/// builder.link(Link { inertial: Some(inertial), ..Link::named("bob") });
/// builder.joint(JointSpec::new("hinge", JointKind::Revolute, "ground", "bob"));
/// let pendulum = builder.build()?;
/// let mut mass_matrix = MassMatrix::new(&pendulum);
/// let mut out = Matrix::zeros(1, 1);
/// mass_matrix.evaluate(&pendulum.state(&[0.3])?, &mut out)?;
/// assert!((out[(0, 0)] - 2.0 * 0.25).abs() < 1e-15);
/// # Ok::<(), cylindroid::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct MassMatrix {
    /// Of the links fixed to each slot, in its frame.
    bodies: Vec<Body>,
    composites: Vec<Body>,
    /// Coordinates of the joints with an armature, and what it adds there.
    armatures: Vec<(usize, f64)>,
}

impl MassMatrix {
    /// Adds up the links that are fixed to each other.
    #[must_use]
    pub fn new(mechanism: &Mechanism) -> Self {
        let mut bodies = vec![Body::NONE; mechanism.nodes().len() + 1];
        for (i, link) in mechanism.links().iter().enumerate() {
            let Some(inertial) = &link.inertial else { continue };
            let frame = mechanism.frame_of(mechanism.link_frame(i));
            let pose = frame.slot_from_frame * inertial.link_from_inertia;
            let own = Body { mass: inertial.mass, center: Vec3::ZERO, inertia: inertial.inertia };
            bodies[frame.slot] = bodies[frame.slot].with(own.moved(pose));
        }
        let armatures = armatures(mechanism);
        Self { composites: bodies.clone(), bodies, armatures }
    }

    /// M at `state`, a state of the mechanism of [`MassMatrix::new`].
    ///
    /// # Errors
    /// A state of a mechanism with another number of moving bodies; an `out` that is not n x n.
    pub fn evaluate(&mut self, state: &State, out: &mut Matrix) -> Result<()> {
        let n = state.mechanism().n();
        let (nodes, slots) = (state.mechanism().nodes(), state.slots());
        Error::check_len("bodies of the state", self.bodies.len(), slots.len())?;
        Error::check_len("rows of the mass matrix", n, out.rows())?;
        Error::check_len("columns of the mass matrix", n, out.cols())?;
        self.fill(nodes, slots, out);
        Ok(())
    }

    /// Total mass and centre of mass of the moving links, and the Jacobian of the centre, 3 x n:
    /// its velocity in world axes = J * joint velocities. Without allocation; links without mass do
    /// not count, a mechanism without any has a zero mass and its centre at the origin.
    ///
    /// ```
    /// use cylindroid::Matrix;
    /// use cylindroid::kinematics::MassMatrix;
    /// use cylindroid::model::{Inertial, JointKind, JointSpec, Link, Mechanism};
    /// use cylindroid::spatial::{Mat3, Pose, Vec3};
    ///
    /// let mut builder = Mechanism::builder("pendulum");
    /// let at = Pose::from_translation(Vec3::X * 0.5);
    /// let inertial = Inertial { mass: 2.0, link_from_inertia: at, inertia: Mat3::ZERO };
    /// builder.link(Link::named("ground"));
    /// builder.link(Link { inertial: Some(inertial), ..Link::named("bob") });
    /// builder.joint(JointSpec::new("hinge", JointKind::Revolute, "ground", "bob"));
    /// let pendulum = builder.build()?;
    /// let mut jacobian = Matrix::zeros(3, 1);
    /// let state = pendulum.state(&[0.0])?;
    /// let (mass, center) = MassMatrix::new(&pendulum).center_of_mass(&state, &mut jacobian)?;
    /// assert_eq!((mass, center), (2.0, Vec3::X * 0.5));
    /// assert_eq!(jacobian.column(0), [0.0, 0.5, 0.0]);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// A state of a mechanism with another number of moving bodies; an `out` that is not 3 x n.
    #[doc(alias = "center of mass")]
    pub fn center_of_mass(&mut self, state: &State, out: &mut Matrix) -> Result<(f64, Vec3)> {
        let (nodes, slots) = (state.mechanism().nodes(), state.slots());
        Error::check_len("bodies of the state", self.bodies.len(), slots.len())?;
        Error::check_len("rows of the Jacobian", 3, out.rows())?;
        Error::check_len("columns of the Jacobian", state.mechanism().n(), out.cols())?;
        out.as_mut_slice().fill(0.0);
        for ((composite, body), slot) in self.composites.iter_mut().zip(&self.bodies).zip(slots) {
            *composite = body.moved(slot.pose());
        }
        self.composites[0] = Body::NONE; // links fixed to the ground
        for slot in (1..slots.len()).rev() {
            let body = self.composites[slot];
            let parent = nodes[slot - 1].parent;
            self.composites[parent] = self.composites[parent].with(body);
        }
        let whole = self.composites[0];
        if whole.mass == 0.0 {
            return Ok((0.0, Vec3::ZERO));
        }
        for slot in 1..slots.len() {
            let body = self.composites[slot];
            let tip = Tip { nodes, slots, slot, world_from_tip: Pose::IDENTITY };
            tip.for_each_column_above(nodes[slot - 1].parent, body.center, |_, c, twist| {
                let velocity = twist.linear * (body.mass / whole.mass);
                out.column_mut(c).iter_mut().zip(velocity.to_array()).for_each(|(o, v)| *o += v);
            });
        }
        Ok((whole.mass, whole.center))
    }

    fn fill(&mut self, nodes: &[Node], slots: &[AlignedPose], out: &mut Matrix) {
        out.as_mut_slice().fill(0.0);
        self.armatures.iter().for_each(|&(c, armature)| out[(c, c)] += armature);
        for ((composite, body), slot) in self.composites.iter_mut().zip(&self.bodies).zip(slots) {
            *composite = body.moved(slot.pose());
        }
        for slot in (1..slots.len()).rev() {
            let body = self.composites[slot];
            let parent = nodes[slot - 1].parent;
            self.composites[parent] = self.composites[parent].with(body);
            let tip = Tip { nodes, slots, slot, world_from_tip: Pose::IDENTITY };
            let mut own = [(0, Wrench::ZERO); 6];
            let mut count = 0;
            tip.for_each_column_above(parent, body.center, |_, c, twist| {
                own[count] = (c, momentum(&body, twist));
                count += 1;
            });
            tip.for_each_column(body.center, |depth, c, twist| {
                for &(own, momentum) in &own[..count] {
                    // Pairs of coordinates of one joint come twice, in both orders.
                    if depth == 0 && own > c {
                        continue;
                    }
                    let entry = twist.power(momentum);
                    out[(own, c)] += entry;
                    if depth > 0 || own != c {
                        out[(c, own)] += entry;
                    }
                }
            });
        }
    }
}

/// What the armatures of joints add to the diagonal, by coordinate.
fn armatures(mechanism: &Mechanism) -> Vec<(usize, f64)> {
    let joints = mechanism.joints();
    let mut all = Vec::new();
    for joint in joints.iter().filter(|j| j.armature != 0.0) {
        let (mut ratio, mut leader) = (1.0, joint);
        while let Some(mimic) = &leader.mimic {
            ratio *= mimic.multiplier;
            let Some(next) = joints.iter().find(|j| j.name == mimic.joint) else { break };
            leader = next;
        }
        all.extend(joint.coordinates.clone().map(|c| (c, joint.armature * ratio * ratio)));
    }
    all
}

/// Of a body at a twist at its centre of mass.
fn momentum(body: &Body, twist: Twist) -> Wrench {
    Wrench { force: twist.linear * body.mass, moment: body.inertia * twist.angular }
}

impl State {
    /// The mass matrix of the joints, n x n; loops are open: [`MassMatrix`] without allocation for
    /// many states.
    ///
    /// ```
    /// // The catalogue gives no masses.
    /// let arm = cylindroid::load("ur5e")?;
    /// assert_eq!(arm.state(arm.home())?.mass_matrix().max_abs(), 0.0);
    /// assert!(arm.check_masses().is_err());
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[must_use]
    #[doc(alias = "CRBA")]
    #[doc(alias = "joint-space inertia matrix")]
    pub fn mass_matrix(&self) -> Matrix {
        let n = self.mechanism().n();
        let mut out = Matrix::zeros(n, n);
        MassMatrix::new(self.mechanism()).fill(self.mechanism().nodes(), self.slots(), &mut out);
        out
    }
}

impl Mechanism {
    /// Links that move and have no mass, nor has any link fixed to them: the first of each body.
    #[must_use]
    pub fn massless_bodies(&self) -> Vec<&str> {
        let slot = |i: usize| self.frame_of(self.link_frame(i)).slot;
        let links = self.links();
        let mut has_mass = vec![false; self.nodes().len() + 1];
        has_mass[0] = true; // the ground
        for (i, link) in links.iter().enumerate() {
            has_mass[slot(i)] |= link.inertial.is_some();
        }
        let mut named = vec![false; has_mass.len()];
        let mut first = |i: usize| !std::mem::replace(&mut named[slot(i)], true);
        let massless = (0..links.len()).filter(|&i| !has_mass[slot(i)] && first(i));
        massless.map(|i| links[i].name.as_str()).collect()
    }

    /// Refuses a mechanism with moving bodies of which the file gives no mass.
    ///
    /// # Errors
    /// [`Error::Model`], which names the links.
    pub fn check_masses(&self) -> Result<()> {
        /// Most links that are named.
        const MOST: usize = 6;
        let missing = self.massless_bodies();
        let Some(first) = missing.first() else { return Ok(()) };
        let more = missing.len().saturating_sub(MOST);
        let mut names = missing[..missing.len() - more].join(", ");
        if more > 0 {
            names += &format!(" and {more} more");
        }
        Err(Error::Model {
            model: self.name().to_owned(),
            culprit: (*first).to_owned(),
            message: format!(
                "links without mass: {names}; write their mass and inertia into the file \
                 (<inertial> in URDF, SDF and MJCF, [[link]] in mechanism files), or give weights \
                 instead of the inertia"
            ),
        })
    }
}
