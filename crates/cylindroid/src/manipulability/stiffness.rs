//! Stiffness of a mechanism at its reference frame: stiffness and compliance matrices, deflections.
//!
//! Formula  the page of [`Stiffness`]
//! Shapes   K, C: d x d
//! Units    K: N/m, N/rad, N m/m, N m/rad; C their inverses
//! Frame    twist and wrench at the origin of the reference frame, world axes; [`Stiffness::at`]
//!          for others
//! Valid    small deflections about an unloaded configuration, actuated joints locked or held by
//!          their stiffness. Free and rigid directions are decided by the relation between elastic
//!          coordinates and object, not by the sizes of stiffnesses
//! Why so   compliance is the ellipsoid of motion, and stiffness that of force, in the metric of
//!          elastic energy: neither matrix is inverted, and each exists where the other does not
//! Source   Gosselin 1990 (actuators of parallel manipulators: J^T k J); Salisbury 1980
//! Checked  tests/it/manipulability/stiffness.rs

use super::efficiency::{Direction, Manipulability};
use super::metrics::Metrics;
use crate::closure::{
    ClosedChain, ElasticChain, MotionSpace, StaticLoad, TransmittedWrench, contact_forces,
    transmitted_wrenches,
};
use crate::error::{Error, Result};
use crate::kinematics::State;
use crate::linalg::{Matrix, Metric, dot};
use crate::model::{Dimension, Elasticity, FrameId};
use crate::screws::{Eigenscrews, eigenscrews};
use crate::spatial::{Pose, Twist, Vec3};
use crate::tolerance::MAX_MAGNITUDE;

/// The stiffness of a mechanism at its reference frame.
///
/// ```text
/// J_e e + J_p q_p - G^T u = 0,   V(u) = min 1/2 e^T k e = 1/2 u^T K u,   w = K u,   u = C w
/// ```
///
/// e are the deflections of the elastic coordinates of an [`Elasticity`], k their stiffness; u and w
/// are twist and wrench at the origin of the reference frame, in world axes, linear part first (d =
/// 6, in the plane 3). Actuated joints without stiffness are locked; passive joints give way.
///
/// Source: Gosselin 1990 and Salisbury 1980 for elastic actuators; the virtual joint method
/// (Pashkevich, Klimchik & Chablat 2011) for links.
///
/// ```
/// use cylindroid::manipulability::Stiffness;
/// use cylindroid::model::Elasticity;
///
/// let stewart = cylindroid::load("stewart")?;
/// let mut elasticity = Elasticity::default();
/// for i in 1..=6 {
///     elasticity.stiffness(&format!("leg{i}"), 2e7);
/// }
/// let state = stewart.state(stewart.home())?;
/// let found = Stiffness::of(&state, None, None, &elasticity)?;
/// // Six elastic legs: every direction is elastic.
/// let stiffness = found.stiffness.as_ref().unwrap();
/// assert_eq!((stiffness.rows(), found.free.cols(), found.rigid.cols()), (6, 0, 0));
/// // Under 1000 N downwards the platform sinks by less than a tenth of a millimetre.
/// let sunk = found.deflection(&[0.0, 0.0, -1000.0, 0.0, 0.0, 0.0])?.twist[2];
/// assert!((-1e-4..0.0).contains(&sunk));
/// # Ok::<(), cylindroid::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Stiffness {
    /// K, symmetric and positive semidefinite; `None` if some direction is rigid.
    pub stiffness: Option<Matrix>,
    /// C, symmetric and positive semidefinite; `None` if some motion is free.
    pub compliance: Option<Matrix>,
    /// Motions without deflection: twists, one column each.
    pub free: Matrix,
    /// Wrenches that deflect nothing, one column each.
    pub rigid: Matrix,
    /// Number of forces in loops and contacts that neither equilibrium nor elasticity determines.
    pub undetermined: usize,
    /// The origin of the reference frame (m).
    pub point: Vec3,
    state: State,
    chain: ClosedChain,
    elastic: ElasticChain,
    motions: MotionSpace,
    /// Principal deflections, with the metric of twists in which the free ones are orthonormal.
    principal: Vec<Direction>,
    object: Metric,
}

/// The deflection under a wrench.
#[derive(Debug, Clone, PartialEq)]
pub struct Deflection {
    /// Of the reference frame: a small displacement (m, rad) at its origin, world axes.
    pub twist: Vec<f64>,
    /// The part of the wrench that a free motion gives way to; the deflection is that of the rest.
    pub unbalanced: Vec<f64>,
    /// Of the elastic parts, in the order of the elasticity.
    pub parts: Vec<PartDeflection>,
    /// Torques of all actuated joints, in the order of the chain [N m or N]: of the drives, as from
    /// [`joint_torques`](crate::closure::joint_torques).
    pub torques: Vec<f64>,
    /// Wrenches in loop joints and contacts. If forces are undetermined, those of least norm.
    pub forces: Vec<TransmittedWrench>,
    /// Elastic energy (J).
    pub energy: f64,
}

/// The deflection of an elastic part.
#[derive(Debug, Clone, PartialEq)]
pub struct PartDeflection {
    /// The joint, coordinate, contact or link.
    pub name: String,
    /// Of each coordinate [rad or m]; of a compliance matrix the twist in its frame, of what lies
    /// beyond (of the second link of a loop joint or contact) relative to the rest.
    pub deflection: Vec<f64>,
}

impl Stiffness {
    /// At `state`, for the mechanism's reference frame or another, with rank decisions by the
    /// characteristic length of the mechanism or another (m).
    ///
    /// # Errors
    /// As [`ClosedChain::of`] and [`Elasticity::check`]; two stiffnesses for one coordinate, a
    /// compliance that is not positive semidefinite, or nothing elastic.
    pub fn of(
        state: &State,
        reference: Option<FrameId>,
        length: Option<f64>,
        elasticity: &Elasticity,
    ) -> Result<Self> {
        let chain = ClosedChain::of(state, reference, length)?;
        let elastic = ElasticChain::of(state, &chain, elasticity)?;
        if elastic.stiffness.is_empty() {
            return Err(Error::InvalidOption {
                option: "elasticity",
                value: state.mechanism().name().to_owned(),
                reason: "nothing is elastic; give a stiffness to actuated joints, or a compliance \
                         to joints, contacts or links ([[elasticity]] in mechanism files)"
                    .to_owned(),
            });
        }
        let motions = MotionSpace::of(&elastic.constraint);
        let relation = motions.relation();
        let metrics = Metrics::characteristic_length(&elastic.units, elastic.constraint.length())?;
        let joint = Some(Metric::diagonal("stiffness", &elastic.stiffness)?);
        let metrics = Metrics { joint, ..metrics };
        let found = Manipulability::of(&relation, &metrics)?;
        let squared = |axes: Matrix| &axes * &axes.transpose();
        let (free, rigid) = (found.kinematic.infinite.clone(), found.force.infinite.clone());
        let unit = || Metric::diagonal("twist", &vec![1.0; relation.object()]);
        Ok(Self {
            stiffness: (rigid.cols() == 0).then(|| squared(found.force.semi_axes())),
            compliance: (free.cols() == 0).then(|| squared(found.kinematic.semi_axes())),
            free,
            rigid,
            undetermined: motions.hyperstatic(),
            point: state.pose_of(chain.reference).translation,
            state: state.clone(),
            chain,
            elastic,
            motions,
            principal: found.kinematic.finite,
            object: metrics.object.map_or_else(unit, Ok)?,
        })
    }

    /// The stiffness matrix at another point and in other axes: those of `world_from_frame`, which
    /// is fixed to the body of the reference frame; in the plane with z as its z axis. Shape and
    /// units as of [`Stiffness::stiffness`].
    ///
    /// ```text
    /// K' = Ad^T K Ad
    /// ```
    #[must_use]
    pub fn at(&self, world_from_frame: Pose) -> Option<Matrix> {
        let map = self.twists_from(world_from_frame);
        self.stiffness.as_ref().map(|k| &(&map.transpose() * k) * &map)
    }

    /// The compliance matrix at another point and in other axes, likewise.
    #[must_use]
    pub fn compliance_at(&self, world_from_frame: Pose) -> Option<Matrix> {
        let map = self.twists_from(world_from_frame);
        // Wrenches: the inverse transpose, whose inverse is the map of the inverse motion.
        let inverse = self.twists_to(world_from_frame);
        debug_assert!((&map * &inverse).max_difference(&Matrix::identity(map.rows())) < 1e-9);
        self.compliance.as_ref().map(|c| &(&inverse * c) * &inverse.transpose())
    }

    /// Lower triangular L with K = L L^T, if every direction is elastic.
    #[must_use]
    pub fn cholesky(&self) -> Option<Matrix> {
        self.compliance.as_ref()?;
        let metric = Metric::new("stiffness", self.stiffness.as_ref()?).ok()?;
        Some(metric.lower().clone())
    }

    /// The eigenscrews of the stiffness in the world, in the form of zero pitch: twists that give a
    /// wrench on the same screw ([`eigenscrews`]). None for mechanisms in the plane, and if some
    /// direction is rigid.
    #[must_use]
    pub fn eigenscrews(&self) -> Option<Eigenscrews> {
        let stiffness = self.at(Pose::IDENTITY).filter(|k| k.rows() == 6)?;
        let symmetric = &stiffness.transpose();
        let mean = |i: usize, j: usize| 0.5 * (stiffness[(i, j)] + symmetric[(i, j)]);
        eigenscrews(&Matrix::from_fn(6, 6, mean), 0.0).ok()
    }

    /// The deflection under an external wrench at the origin of the reference frame, world axes.
    ///
    /// # Errors
    /// A wrench of the wrong size, with non-finite entries or with magnitudes beyond 1e120.
    pub fn deflection(&self, wrench: &[f64]) -> Result<Deflection> {
        let elastic = &self.elastic;
        let (d, n) = (elastic.constraint.object(), elastic.stiffness.len());
        Error::check_len("wrench", d, wrench.len())?;
        Error::check_within("wrench", wrench, MAX_MAGNITUDE)?;
        let mut unbalanced = vec![0.0; d];
        for j in 0..self.free.cols() {
            let mut dual = self.free.column(j).to_vec();
            let along = dot(&dual, wrench);
            self.object.apply(&mut dual);
            unbalanced.iter_mut().zip(&dual).for_each(|(u, x)| *u += along * x);
        }
        let balanced: Vec<f64> = wrench.iter().zip(&unbalanced).map(|(w, u)| w - u).collect();
        let (mut twist, mut e) = (vec![0.0; d], vec![0.0; n]);
        for direction in &self.principal {
            let share = dot(&direction.object, &balanced) / direction.pair.input.powi(2);
            twist.iter_mut().zip(&direction.object).for_each(|(t, u)| *t += share * u);
            e.iter_mut().zip(&direction.joint).for_each(|(e, q)| *e += share * q);
        }
        let drives: Vec<f64> = e.iter().zip(&elastic.stiffness).map(|(e, k)| -k * e).collect();
        let load = StaticLoad { torques: &drives, wrench: &balanced };
        let forces = contact_forces(&elastic.constraint, &self.motions, load, None)?.forces;
        let mut torques = vec![0.0; self.chain.constraint.actuated()];
        self.chain.constraint.blocks().actuated.tr_mul_vec_into(&forces, &mut torques);
        torques.iter_mut().for_each(|t| *t = -*t);
        let parts = elastic.parts.iter().map(|part| PartDeflection {
            name: part.name.clone(),
            deflection: part.directions.mul_vec(&e[part.columns.clone()]),
        });
        Ok(Deflection {
            parts: parts.collect(),
            energy: -0.5 * dot(&e, &drives),
            forces: transmitted_wrenches(&self.state, &self.chain, &forces)?,
            twist,
            unbalanced,
            torques,
        })
    }

    /// u at the reference origin in world axes from u' in a frame.
    fn twists_from(&self, frame: Pose) -> Matrix {
        let offset = self.point - frame.translation;
        self.map(|t| {
            let world =
                Twist { linear: frame.rotation * t.linear, angular: frame.rotation * t.angular };
            world.at_point(offset)
        })
    }

    fn twists_to(&self, frame: Pose) -> Matrix {
        let back = frame.rotation.inverse();
        self.map(|t| {
            let there = t.at_point(frame.translation - self.point);
            Twist { linear: back * there.linear, angular: back * there.angular }
        })
    }

    fn map(&self, f: impl Fn(Twist) -> Twist) -> Matrix {
        let planar = self.free.rows() == Dimension::Planar.freedoms();
        let kept = if planar { Dimension::Planar } else { Dimension::Spatial }.components();
        let columns: Vec<[f64; 6]> = kept
            .iter()
            .map(|&c| {
                let mut unit = [0.0; 6];
                unit[c] = 1.0;
                f(Twist::from_array(unit)).to_array()
            })
            .collect();
        Matrix::from_fn(kept.len(), kept.len(), |i, j| columns[j][kept[i]])
    }
}
