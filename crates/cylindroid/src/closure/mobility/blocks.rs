//! Blocks of the motions of a closed chain: which of actuated joints, passive joints and object
//! move.
//!
//! Formula  columns of eqs. 3 to 5 with the symbols of the paper, in rows (q_a, q_p, u):
//!          redundancy                     [G_r,    0,       0      ]
//!          idle                           [0,      G_p,i,   0      ]
//!          mixed                          [0,      G_pu,i,  G_up,i ]
//!          uncontrollable_object_motions  [0,      0,       G_u,i  ]
//!          coordinate, passive            [G_ap,c, G_pa,c,  0      ]
//!          coordinate, both               [G_apu,c, G_pua,c, G_upa,c]
//!          coordinate, object             [G_au,c, 0,       G_ua,c ]
//! Shapes   (q_a + q_p + d) x n each; the seven numbers add up to the degrees of freedom, plus the
//!          overlap
//! Units    bases are orthonormal in scaled units and given in those of the constraint
//! Valid    any constraint. Each block has the zeros of the paper and is orthogonal (scaled) to the
//!          blocks inside the space that its zeros define, which makes it unique: a motion with the
//!          object at rest to redundancy and idle motions, one with the passive joints at rest to
//!          redundancy and uncontrollable motions, one with the actuated joints at rest to idle and
//!          uncontrollable motions. The motions of `both` are orthogonal to all others
//! Why so   if passive joints and the object can each compensate a motion of the actuated joints,
//!          it lies in `passive` and in `object`: the paper's partition does not exist then, and
//!          the overlap says by how much
//! Source   Bicchi & Prattichizzo 1998, eqs. 3 to 5
//! Checked  tests/it/closure/blocks.rs, tests/it/closure/reference.rs

use super::motion_space::MotionSpace;
use super::subspace::Subspace;
use crate::linalg::{ColumnSpace, Cut, Matrix, Threshold};

/// Coordinate motions by what moves besides the actuated joints (eq. 5), each with a basis. A
/// motion of the actuated joints that either passive joints or the object can compensate is counted
/// in `passive` and in `object`.
#[derive(Debug, Clone, PartialEq)]
pub struct CoordinateKinds {
    /// With passive joints and the object at rest.
    pub passive: Subspace,
    /// With the object and the passive joints at rest.
    pub object: Subspace,
    /// Only with both.
    pub both: Subspace,
    /// Counted in `passive` and in `object`.
    pub overlap: usize,
}

/// The parts of a kernel from which blocks are made, as coefficients of its columns.
pub(super) struct Parts<'a> {
    pub(super) redundancy: &'a Matrix,
    pub(super) idle: &'a Matrix,
    pub(super) uncontrollable: &'a Matrix,
    /// Motions that vanish on actuated joints, on passive ones, on the object.
    pub(super) indeterminacy: &'a Matrix,
    pub(super) object_only: &'a Matrix,
    pub(super) joints_only: &'a Matrix,
}

impl Parts<'_> {
    /// The coordinate blocks, `c` motions in all, and the mixed one.
    pub(super) fn blocks(&self, motions: &MotionSpace, c: usize) -> (CoordinateKinds, Subspace) {
        let k = motions.dof();
        let tolerance = Threshold::Absolute(motions.tolerance());
        let space = |coefficients: &Matrix, cut: Cut| Subspace {
            basis: motions.unscaled(&(motions.kernel() * coefficients)),
            cut,
        };
        // The motions of `all` orthogonal to the columns of `without`, which lie in its span.
        let within = |all: &Matrix, without: &[&Matrix]| {
            if all.cols() == 0 || without.iter().all(|m| m.cols() == 0) {
                return space(all, Cut::of(&[], motions.tolerance())); // nothing to decide
            }
            let without = &all.transpose() * &Matrix::hstack(k, without);
            let others = ColumnSpace::cut_of(without, tolerance);
            space(&(all * &others.complement()), others.cut())
        };
        let passive = within(self.joints_only, &[self.redundancy, self.idle]);
        let object = within(self.object_only, &[self.redundancy, self.uncontrollable]);
        let mixed = within(self.indeterminacy, &[self.idle, self.uncontrollable]);
        let others = [self.joints_only, self.object_only, self.indeterminacy];
        let both = if others.iter().all(|m| m.cols() == 0) {
            Subspace { basis: motions.basis(), cut: motions.cut() }
        } else {
            let others = ColumnSpace::cut_of(Matrix::hstack(k, &others), tolerance);
            space(&others.complement(), others.cut())
        };
        let counted = passive.dimension() + object.dimension() + both.dimension();
        let overlap = counted.saturating_sub(c);
        (CoordinateKinds { passive, object, both, overlap }, mixed)
    }
}
