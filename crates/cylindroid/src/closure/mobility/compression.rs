//! Compression of a constraint with many more columns than rows: joint velocities that no row feels
//! are split off.
//!
//! Formula  scaled block J' (t x q), QR of its transpose: J'^T = W [R; 0], W = [W1 W2]; in the
//!          coordinates y = W1^T q, z = W2^T q the constraint is R^T y, and every z is a motion of
//!          its own
//! Shapes   W1: q x t, W2: q x (q - t)
//! Units    scaled
//! Valid    blocks of actuated and of passive joints, each if it has more than twice as many columns
//!          as rows, and more than [`MANY`]: W is orthogonal, so that ranks, distances and spaces
//!          are those of the constraint itself
//! Why so   the decompositions of a kernel of a thousand columns take minutes, those of the six rows
//!          that they stand for microseconds
//! Checked  tests/it/closure/long_chains.rs

use std::ops::Range;

use crate::closure::constraint::velocity_constraint::{Constraint, ConstraintBlocks};
use crate::linalg::{Matrix, Qr};

/// Blocks with fewer columns are not compressed.
const MANY: usize = 64;

/// A constraint without the motions that no row feels.
#[derive(Debug, Clone)]
pub(crate) struct Compression {
    /// The constraint in the coordinates y; none if nothing is split off.
    constraint: Option<Constraint>,
    actuated: Option<Qr>,
    passive: Option<Qr>,
    /// Numbers of actuated and of passive joints.
    columns: [usize; 2],
}

impl Compression {
    pub(crate) fn of(constraint: &Constraint) -> Self {
        let rows = constraint.rows();
        let (a, p) = (constraint.actuated(), constraint.passive());
        let long = |columns: usize| columns > MANY.max(2 * rows);
        if !(long(a) || long(p)) {
            return Self { constraint: None, actuated: None, passive: None, columns: [a, p] };
        }
        let scaled = constraint.scaled_transpose();
        let factor = |range: Range<usize>| {
            long(range.len()).then(|| Qr::plain(scaled.rows_between(range.start, range.end)))
        };
        let (actuated, passive) = (factor(0..a), factor(a..a + p));
        let row_scale = constraint.row_scale();
        let column_scale = constraint.column_scale();
        let mut scales = Vec::new();
        let mut block = |qr: &Option<Qr>, own: &Matrix, range: Range<usize>| match qr {
            None => {
                scales.extend_from_slice(&column_scale[range]);
                own.clone()
            }
            Some(qr) => {
                scales.resize(scales.len() + qr.len(), 1.0);
                let r = qr.r();
                Matrix::from_fn(rows, qr.len(), |i, j| r[(j, i)] / row_scale[i])
            }
        };
        let blocks = constraint.blocks();
        let blocks = ConstraintBlocks {
            actuated: block(&actuated, &blocks.actuated, 0..a),
            passive: block(&passive, &blocks.passive, a..a + p),
            grasp: blocks.grasp.clone(),
        };
        scales.extend_from_slice(&column_scale[a + p..]);
        let constraint = Some(constraint.with_columns(blocks, scales));
        Self { constraint, actuated, passive, columns: [a, p] }
    }

    /// The constraint to be analysed instead of `original`.
    pub(crate) fn constraint<'a>(&'a self, original: &'a Constraint) -> &'a Constraint {
        self.constraint.as_ref().unwrap_or(original)
    }

    /// True if nothing is split off.
    pub(crate) fn is_trivial(&self) -> bool {
        self.constraint.is_none()
    }

    /// Numbers of motions z of actuated and of passive joints.
    pub(crate) fn split_off(&self) -> [usize; 2] {
        let of = |qr: &Option<Qr>, columns: usize| qr.as_ref().map_or(0, |qr| columns - qr.len());
        [of(&self.actuated, self.columns[0]), of(&self.passive, self.columns[1])]
    }

    /// Scaled motions (y, object) as motions (q, object), followed by the z of actuated and of
    /// passive joints if these are asked for.
    pub(crate) fn expanded(&self, motions: &Matrix, with: [bool; 2]) -> Matrix {
        let mut from = 0;
        let mut part = |qr: &Option<Qr>, columns: usize| {
            let own = motions.rows_between(from, from + columns);
            from += columns;
            match qr {
                None => own,
                Some(qr) => &qr.basis() * &own,
            }
        };
        let inner = self.constraint.as_ref();
        let size = |f: fn(&Constraint) -> usize| inner.map_or(0, f);
        let actuated = part(&self.actuated, size(Constraint::actuated));
        let passive = part(&self.passive, size(Constraint::passive));
        let object = motions.rows_between(from, motions.rows());
        let heights = [actuated.rows(), passive.rows(), object.rows()];
        let expanded = Matrix::vstack(motions.cols(), &[&actuated, &passive, &object]);
        let mut all = vec![expanded];
        let places = [(&self.actuated, 0, with[0]), (&self.passive, heights[0], with[1])];
        for (qr, above, wanted) in places {
            if let (Some(qr), true) = (qr, wanted) {
                let z = qr.complement();
                let below = heights.iter().sum::<usize>() - above - z.rows();
                let zeros = |rows: usize| Matrix::zeros(rows, z.cols());
                all.push(Matrix::vstack(z.cols(), &[&zeros(above), &z, &zeros(below)]));
            }
        }
        Matrix::hstack(heights.iter().sum(), &all.iter().collect::<Vec<_>>())
    }

    /// The scaled motions of actuated (or passive) joints that are orthogonal to the z and to the
    /// motions `y` of theirs, orthonormal in the coordinates y.
    pub(crate) fn orthogonal_to(&self, actuated: bool, y: Matrix) -> Matrix {
        let others = if y.cols() == y.rows() {
            Matrix::zeros(y.rows(), 0)
        } else {
            Qr::plain(y).complement()
        };
        match if actuated { &self.actuated } else { &self.passive } {
            None => others,
            Some(qr) => &qr.basis() * &others,
        }
    }

    /// Scaled torques of the coordinates y as torques of the actuated joints.
    pub(crate) fn expanded_torques(&self, torques: Matrix) -> Matrix {
        match &self.actuated {
            None => torques,
            Some(qr) => &qr.basis() * &torques,
        }
    }
}
