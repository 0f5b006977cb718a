//! Mobility report: the motions and forces of a closed chain, counted (with the Gruebler-Kutzbach
//! count) and each with a basis.
//!
//! Formula  dof            ker [J_a J_p -G^T]
//!          redundancy     ker J_a: actuated joints move, all else is at rest
//!          indeterminacy  ker [J_p -G^T]: actuated joints are at rest
//!          coordinate     orthogonal to both: k - r - i
//!          idle           ker J_p: passive joints move alone
//!          uncontrollable object motions  ker G^T: the object moves alone
//!          internal       (dom R)^perp, torques in equilibrium without a wrench
//!          zero_torque    (ran R)^perp, wrenches in equilibrium without torques
//!          hyperstatic    ker G and ker J^T: contact forces that equilibrium does not determine
//! Shapes   motions: (q_a + q_p + d) x n, torques: q_a x n, wrenches: d x n, contact forces: t x n
//! Units    of the constraint; bases are orthonormal in units scaled by the characteristic length
//! Valid    any constraint. Counts come from ranks; the Gruebler-Kutzbach count is given for
//!          comparison. The counts are infinitesimal: a motion may exist to first order only, see
//!          `finite_mobility.rs`
//! Why so   every count has its own rank decision; three of the eight follow from the others, see
//!          [`MotionSpace`]
//! Source   Bicchi & Prattichizzo 1998, eqs. 3 to 5; the counts of eq. 5 modulo redundancy and
//!          indeterminacy, since only these are unique
//! Checked  tests/it/closure/reference.rs, tests/it/closure/mobility.rs

use std::fmt;
use std::ops::Range;

use super::blocks::{CoordinateKinds, Parts};
use super::compression::Compression;
use super::force_spaces::hyperstatic_forces;
use super::motion_space::{MotionSpace, RowSelection};
use super::relation::{Relation, RelationDimensions};
use super::subspace::Subspace;
use crate::closure::constraint::velocity_constraint::Constraint;
use crate::linalg::{ColumnSpace, Cut, Matrix, Svd, Threshold};

/// The mobility of a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointMobility {
    /// Largest norm of its entry in a motion of unit norm (scaled) [-], between 0 and 1; for a
    /// component of a vector (rotation, position of a free body), that of the vector.
    pub share: f64,
    /// False where it is locked by the geometry.
    pub moves: bool,
    /// True if it can move with all actuated joints at rest.
    pub free_of_actuators: bool,
    /// True if it can move with the actuated joints and the object at rest (passive joints).
    pub idle: bool,
}

/// A numerically ambiguous rank decision.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RankWarning {
    /// The count that depends on it.
    pub count: &'static str,
    /// The decision.
    pub cut: Cut,
}

impl fmt::Display for RankWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Cut { rank, kept, dropped } = self.cut;
        write!(
            f,
            "{} depends on an ambiguous rank of {} (smallest singular value kept {kept:.1e}, \
             largest dropped {dropped:.1e}, threshold {:.1e}): the configuration may be \
             near-singular or the geometry imprecise; perturb the configuration or set the \
             threshold",
            self.count, rank.rank, rank.threshold
        )
    }
}

/// The mobility of a closed chain in one configuration: motions and forces of every kind, counted
/// and with a basis.
///
/// ```text
/// k = dim ker [J_a J_p -G^T],   r = dim ker J_a,   i = dim ker [J_p -G^T],   c = k - r - i
/// ```
///
/// Counts come from ranks in scaled units; the Gruebler-Kutzbach count is given for comparison.
/// They are instantaneous: see [`FiniteMobility`](super::super::FiniteMobility) for finite motions.
///
/// Source: Bicchi & Prattichizzo 1998, eqs. 3 to 5.
#[derive(Debug, Clone, PartialEq)]
pub struct Mobility {
    /// All motions (q_a, q_p, u).
    pub dof: Subspace,
    /// Motions of actuated joints alone.
    pub redundancy: Subspace,
    /// Motions with the actuated joints at rest, idle ones included.
    pub indeterminacy: Subspace,
    /// Motions orthogonal to both (scaled).
    pub coordinate: Subspace,
    /// The coordinate motions by what moves, see [`Mobility::blocks`].
    pub coordinate_kinds: CoordinateKinds,
    /// Motions of passive joints alone.
    pub idle: Subspace,
    /// Motions of the object alone, which neither actuated nor passive joints can influence.
    pub uncontrollable_object_motions: Subspace,
    /// Motions of passive joints and object together, with the actuated joints at rest: orthogonal
    /// (scaled) to idle and uncontrollable ones.
    pub mixed: Subspace,
    /// Joint torques in equilibrium without a wrench on the object (active internal forces). The
    /// contact forces without a wrench, ker G, are those of
    /// [`internal_forces`](super::super::internal_forces()).
    pub internal: Subspace,
    /// Wrenches in equilibrium without joint torques.
    pub zero_torque: Subspace,
    /// Contact forces that equilibrium with torques and wrench does not determine.
    pub hyperstatic: Subspace,
    /// The counts of the relation between actuated joints and object, whose redundancy and
    /// indeterminacy include motions with passive joints.
    pub relation: RelationDimensions,
    /// Gruebler-Kutzbach count (columns minus rows), for comparison.
    #[doc(alias = "mobility formula")]
    pub gruebler_kutzbach: i64,
    /// Actuated joints, then passive columns.
    pub joints: Vec<JointMobility>,
    /// Numerically ambiguous rank decisions.
    pub ambiguous_ranks: Vec<RankWarning>,
}

/// A block of the motions, see [`Mobility::blocks`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionBlock<'a> {
    /// Its name in reports.
    pub name: &'static str,
    /// The symbol of its columns in eqs. 3 to 5.
    pub symbol: &'static str,
    /// Its motions (q_a, q_p, u).
    pub motions: &'a Subspace,
    /// The motions in words.
    pub meaning: &'static str,
}

impl Mobility {
    /// With the default threshold.
    ///
    /// ```
    /// use cylindroid::closure::{ClosedChain, Mobility};
    ///
    /// let five_bar = cylindroid::load("five-bar")?;
    /// let chain = ClosedChain::of(&five_bar.state(five_bar.home())?, None, None)?;
    /// let mobility = Mobility::of(&chain.constraint);
    /// assert_eq!((mobility.dof.dimension(), mobility.gruebler_kutzbach), (2, 2));
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[must_use]
    pub fn of(constraint: &Constraint) -> Self {
        let compression = Compression::of(constraint);
        let inner = compression.constraint(constraint);
        let motions = MotionSpace::of(inner);
        let relation = motions.relation();
        let report = Self::from_parts(inner, &motions, &relation);
        if compression.is_trivial() {
            report
        } else {
            report.expanded(constraint, &compression, motions.tolerance())
        }
    }

    /// The report of `constraint`, from that of its compression.
    fn expanded(
        mut self,
        constraint: &Constraint,
        compression: &Compression,
        tolerance: f64,
    ) -> Self {
        let [actuated, passive] = compression.split_off();
        let inner = compression.constraint(constraint).column_scale();
        let inverse: Vec<f64> = inner.iter().map(|s| 1.0 / s).collect();
        let scaled = |space: &Subspace, with: [bool; 2]| {
            compression.expanded(&space.basis.clone().scale_rows(&inverse), with)
        };
        let kernel = scaled(&self.dof, [true, true]);
        let free = scaled(&self.indeterminacy, [false, true]);
        let idle = scaled(&self.idle, [false, true]);
        self.joints = joint_mobility(constraint, [&kernel, &free, &idle], tolerance);
        let units = |motions: Matrix| motions.scale_rows(constraint.column_scale());
        self.redundancy.basis = units(scaled(&self.redundancy, [true, false]));
        let kinds = &mut self.coordinate_kinds;
        for space in [
            &mut self.coordinate,
            &mut self.uncontrollable_object_motions,
            &mut self.mixed,
            &mut kinds.passive,
            &mut kinds.object,
            &mut kinds.both,
        ] {
            space.basis = units(scaled(space, [false, false]));
        }
        (self.dof.basis, self.indeterminacy.basis) = (units(kernel), units(free));
        self.idle.basis = units(idle);
        let torques = self.internal.basis.clone();
        let own = &inner[..torques.rows()];
        let torques = compression.expanded_torques(torques.scale_rows(own));
        let scale = constraint.column_scale()[..torques.rows()].iter().map(|s| 1.0 / s);
        self.internal.basis = torques.scale_rows(&scale.collect::<Vec<_>>());
        self.relation.relation += actuated;
        self.relation.redundancy += actuated;
        self.gruebler_kutzbach += i64::try_from(actuated + passive).unwrap_or(i64::MAX);
        self
    }

    /// From the motion space and the relation of this constraint.
    ///
    /// # Panics
    /// If they are those of a constraint of other sizes.
    #[must_use]
    pub fn from_parts(constraint: &Constraint, motions: &MotionSpace, relation: &Relation) -> Self {
        const A: RowSelection = RowSelection { actuated: true, passive: false, object: false };
        const P: RowSelection = RowSelection { actuated: false, passive: true, object: false };
        const U: RowSelection = RowSelection { actuated: false, passive: false, object: true };
        let (k, kernel) = (motions.dof(), motions.kernel());
        let tolerance = Threshold::Absolute(motions.tolerance());
        let space = |(part, cut): &(Matrix, Cut)| Subspace {
            basis: motions.unscaled(&(motions.kernel() * part)),
            cut: *cut,
        };
        let [indeterminacy, redundancy] = motions.vanishing_on_rows_and_complement(A);
        let [object_only, idle] = motions.vanishing_on_rows_and_complement(P);
        let [joints_only, uncontrollable_object_motions] =
            motions.vanishing_on_rows_and_complement(U);
        let (r, i) = (redundancy.0.cols(), indeterminacy.0.cols());
        let c = k.saturating_sub(r + i);
        let parts = Parts {
            redundancy: &redundancy.0,
            idle: &idle.0,
            uncontrollable: &uncontrollable_object_motions.0,
            indeterminacy: &indeterminacy.0,
            object_only: &object_only.0,
            joints_only: &joints_only.0,
        };
        let (coordinate_kinds, mixed) = parts.blocks(motions, c);
        let coordinate = if r + i == 0 {
            Subspace { basis: motions.basis(), cut: motions.cut() }
        } else {
            let others = Matrix::hstack(k, &[&redundancy.0, &indeterminacy.0]);
            let others = ColumnSpace::of(&others, tolerance);
            space(&(others.complement(), others.cut()))
        };
        let (internal, structural) = relation.internal_and_structural();
        let [span, joint_rank, object_rank] = relation.cuts();
        let mut report = Self {
            dof: Subspace { basis: motions.basis(), cut: motions.cut() },
            coordinate,
            coordinate_kinds,
            mixed,
            joints: joint_mobility(
                constraint,
                [kernel, &(kernel * &indeterminacy.0), &(kernel * &idle.0)],
                motions.tolerance(),
            ),
            redundancy: space(&redundancy),
            indeterminacy: space(&indeterminacy),
            idle: space(&idle),
            uncontrollable_object_motions: space(&uncontrollable_object_motions),
            internal: Subspace { basis: internal, cut: joint_rank },
            zero_torque: Subspace { basis: structural, cut: object_rank },
            hyperstatic: hyperstatic_forces(constraint, motions),
            relation: relation.dimensions(),
            gruebler_kutzbach: motions.gruebler_kutzbach(),
            ambiguous_ranks: Vec::new(),
        };
        report.ambiguous_ranks = [
            ("dof", report.dof.cut),
            ("redundancy", report.redundancy.cut),
            ("indeterminacy", report.indeterminacy.cut),
            ("idle", report.idle.cut),
            ("uncontrollable_object_motions", report.uncontrollable_object_motions.cut),
            ("relation", span),
            ("internal", joint_rank),
            ("zero_torque", object_rank),
        ]
        .into_iter()
        .filter(|(_, cut)| cut.is_ambiguous())
        .map(|(count, cut)| RankWarning { count, cut })
        .collect();
        report
    }

    /// The blocks of eqs. 3 to 5 in their order. Their numbers add up to the degrees of freedom and
    /// the overlap of [`CoordinateKinds`].
    ///
    /// ```
    /// use cylindroid::closure::{ClosedChain, Mobility};
    ///
    /// // The legs of this platform cannot spin; six coordinate motions need the passive joints.
    /// let stewart = cylindroid::load("stewart")?;
    /// let chain = ClosedChain::of(&stewart.state(stewart.home())?, None, None)?;
    /// let mobility = Mobility::of(&chain.constraint);
    /// let counts = mobility.blocks().map(|block| (block.name, block.motions.dimension()));
    /// assert_eq!(counts.iter().map(|(_, n)| n).sum::<usize>(), mobility.dof.dimension());
    /// assert!(counts.contains(&("coordinate_both", 6)));
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[must_use]
    pub fn blocks(&self) -> [MotionBlock<'_>; 7] {
        let kinds = &self.coordinate_kinds;
        let block = |name, symbol, motions, meaning| MotionBlock { name, symbol, motions, meaning };
        [
            block("redundancy", "Gamma_r", &self.redundancy, "actuated joints alone"),
            block("idle", "Gamma_p,i", &self.idle, "passive joints alone"),
            block(
                "mixed",
                "Gamma_pu,i, Gamma_up,i",
                &self.mixed,
                "passive joints and reference frame, with actuated joints at rest",
            ),
            block(
                "uncontrollable",
                "Gamma_u,i",
                &self.uncontrollable_object_motions,
                "reference frame alone, with all joints at rest",
            ),
            block(
                "coordinate_passive",
                "Gamma_ap,c, Gamma_pa,c",
                &kinds.passive,
                "actuated and passive joints, with the reference frame at rest",
            ),
            block(
                "coordinate_both",
                "Gamma_apu,c, Gamma_pua,c, Gamma_upa,c",
                &kinds.both,
                "actuated and passive joints and reference frame together",
            ),
            block(
                "coordinate_object",
                "Gamma_au,c, Gamma_ua,c",
                &kinds.object,
                "actuated joints and reference frame, with passive joints at rest",
            ),
        ]
    }
}

/// From scaled bases of all motions, of those with the actuated joints at rest, and of idle ones.
fn joint_mobility(
    constraint: &Constraint,
    [all, free, idle]: [&Matrix; 3],
    tolerance: f64,
) -> Vec<JointMobility> {
    // The norm of a scalar's row, the largest singular value of a vector's rows.
    let norm = |of: &Matrix, rows: Range<usize>| match rows.len() {
        1 => of.row_norm(rows.start),
        _ => Svd::of(&of.rows_between(rows.start, rows.end)).largest(),
    };
    (0..constraint.actuated() + constraint.passive())
        .map(|i| {
            let rows = constraint.vector_of(i);
            let share = norm(all, rows.clone());
            let passive = i >= constraint.actuated();
            JointMobility {
                share: share.min(1.0),
                moves: share > tolerance,
                free_of_actuators: passive && norm(free, rows.clone()) > tolerance,
                idle: passive && norm(idle, rows) > tolerance,
            }
        })
        .collect()
}
