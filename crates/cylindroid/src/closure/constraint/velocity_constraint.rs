//! The velocity constraint of a closed chain, and the scales that make its ranks mean something.
//!
//! Formula  J_a q_a + J_p q_p - G^T u = 0; scaled M' = D_r [J_a J_p -G^T] D_c
//! Shapes   J_a: t x q_a, J_p: t x q_p, G: d x t
//! Units    a row is a velocity (m/s) or an angular velocity (rad/s) at a contact, a column a rate
//!          of either kind. With the characteristic length l, D_r divides rows of lengths by l and
//!          D_c multiplies columns of lengths by it: M' has no unit.
//! Frame    any: u and its wrench are taken at one point in one frame, each row in a frame of its
//!          own
//! Valid    any sizes, zero too. Several objects: the columns -G^T of those that are not the
//!          reference belong to `passive`.
//! Why so   scaling rows and columns to equal norms instead would need no length, but blows up a
//!          row that is zero up to rounding and then counts it
//! Source   Bicchi & Prattichizzo 1998, eq. 2 and appendix A
//! Checked  tests/it/closure/*.rs (changes of unit), tests/it/closure/bad_input.rs

use crate::error::{Error, Result};
use crate::linalg::{ColumnSpace, Matrix};
use crate::model::CoordinateKind;
use crate::tolerance::{CLOSURE_BLOCK, KERNEL_ROUNDING};

/// What a coordinate or a row of the constraint measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// Metres: sliding joints, linear velocities.
    Length,
    /// Radians: turning joints, angular velocities.
    Angle,
}

impl Unit {
    /// Of a coordinate.
    pub(crate) fn of(kind: CoordinateKind) -> Self {
        if kind.is_length() { Self::Length } else { Self::Angle }
    }

    /// What 1 without unit is where lengths are measured in `length` (m or rad).
    pub(crate) fn size(self, length: f64) -> f64 {
        match self {
            Self::Length => length,
            Self::Angle => 1.0,
        }
    }
}

/// The three matrices of a constraint.
#[derive(Debug, Clone, PartialEq)]
pub struct ConstraintBlocks {
    /// `J_a`, t x q_a: velocities at the contacts by the actuated joints.
    pub actuated: Matrix,
    /// `J_p`, t x q_p: by the passive joints and by objects other than the reference.
    pub passive: Matrix,
    /// `G`, d x t: wrench on the object by the forces at the contacts.
    pub grasp: Matrix,
}

/// The unit of every row and column of a constraint.
#[derive(Debug, Clone, PartialEq)]
pub struct Units {
    /// Of the t rows.
    pub rows: Vec<Unit>,
    /// Of the actuated joints.
    pub actuated: Vec<Unit>,
    /// Of the passive columns.
    pub passive: Vec<Unit>,
    /// Of the object's twist.
    pub object: Vec<Unit>,
}

/// A velocity constraint: finite, of fitting shapes, with its scales.
#[derive(Debug, Clone, PartialEq)]
pub struct Constraint {
    blocks: ConstraintBlocks,
    length: f64,
    /// D_r.
    row_scale: Vec<f64>,
    /// D_c of actuated joints, passive columns and object.
    column_scale: Vec<f64>,
}

impl Constraint {
    /// A constraint whose rows and columns all have one unit, or metres and radians side by side
    /// with the characteristic length 1 m.
    ///
    /// # Errors
    /// ConstraintBlocks of different numbers of rows, NaN or infinity.
    pub fn new(blocks: ConstraintBlocks) -> Result<Self> {
        let t = blocks.grasp.cols();
        for (name, block) in
            [("actuated Jacobian", &blocks.actuated), ("passive Jacobian", &blocks.passive)]
        {
            if block.rows() != t {
                return Err(Error::Dimension {
                    what: format!("{name} (its columns)"),
                    expected: t,
                    got: block.rows(),
                    hint: "one for each column of the grasp matrix".to_owned(),
                });
            }
        }
        check_finite("actuated Jacobian", &blocks.actuated)?;
        check_finite("passive Jacobian", &blocks.passive)?;
        check_finite("grasp matrix", &blocks.grasp)?;
        let n = blocks.actuated.cols() + blocks.passive.cols() + blocks.grasp.rows();
        Ok(Self { blocks, length: 1.0, row_scale: vec![1.0; t], column_scale: vec![1.0; n] })
    }

    /// The same constraint with lengths measured in the characteristic length `length` (m).
    ///
    /// # Errors
    /// Units of the wrong number; a length that is not positive and finite, or so far from one
    /// that scaled entries overflow.
    pub fn with_length(mut self, units: &Units, length: f64) -> Result<Self> {
        Error::check_positive("length", length)?;
        Error::check_len("units of the rows", self.rows(), units.rows.len())?;
        Error::check_len("units of the actuated joints", self.actuated(), units.actuated.len())?;
        Error::check_len("units of the passive joints", self.passive(), units.passive.len())?;
        Error::check_len("units of the object", self.object(), units.object.len())?;
        let scale = |unit: &Unit| unit.size(length);
        self.row_scale = units.rows.iter().map(|u| 1.0 / scale(u)).collect();
        let columns = units.actuated.iter().chain(&units.passive).chain(&units.object);
        self.column_scale = columns.map(scale).collect();
        self.length = length;
        if !self.is_finite_scaled() {
            let scaled = self.scaled_transpose();
            check_finite("constraint scaled by the length, transposed,", &scaled)?;
        }
        Ok(self)
    }

    /// A serial arm: `u = J q`, all joints actuated.
    ///
    /// # Errors
    /// NaN or infinity.
    pub fn serial(jacobian: &Matrix) -> Result<Self> {
        Self::new(ConstraintBlocks {
            actuated: jacobian.clone(),
            passive: Matrix::zeros(jacobian.rows(), 0),
            grasp: Matrix::identity(jacobian.rows()),
        })
    }

    /// The matrices it was made of.
    #[must_use]
    pub fn blocks(&self) -> &ConstraintBlocks {
        &self.blocks
    }

    /// The characteristic length (m).
    #[must_use]
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Number of actuated joints.
    #[must_use]
    pub fn actuated(&self) -> usize {
        self.blocks.actuated.cols()
    }

    /// Number of passive columns.
    #[must_use]
    pub fn passive(&self) -> usize {
        self.blocks.passive.cols()
    }

    /// Size of the object's twist.
    #[must_use]
    pub fn object(&self) -> usize {
        self.blocks.grasp.rows()
    }

    /// Number t of constrained components.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.blocks.grasp.cols()
    }

    /// `[J_a J_p -G^T]`, t x (q_a + q_p + d).
    #[must_use]
    pub fn matrix(&self) -> Matrix {
        let (a, p) = (self.actuated(), self.passive());
        Matrix::from_fn(self.rows(), a + p + self.object(), |i, j| {
            if j < a {
                self.blocks.actuated[(i, j)]
            } else if j < a + p {
                self.blocks.passive[(i, j - a)]
            } else {
                -self.blocks.grasp[(j - a - p, i)]
            }
        })
    }

    /// True where lengths in the characteristic length do not overflow: no entry does that has the
    /// largest size and both largest scales.
    fn is_finite_scaled(&self) -> bool {
        let ConstraintBlocks { actuated, passive, grasp } = &self.blocks;
        let size = actuated.max_abs().max(passive.max_abs()).max(grasp.max_abs());
        let largest = |scale: &[f64]| scale.iter().fold(0.0, |m: f64, s| m.max(*s));
        let (row, column) = (largest(&self.row_scale), largest(&self.column_scale));
        (row * size * column).is_finite() && (row * size).is_finite()
    }

    /// Its transpose in scaled coordinates, `D_c M^T D_r`.
    pub(crate) fn scaled_transpose(&self) -> Matrix {
        let (t, a, p) = (self.rows(), self.actuated(), self.passive());
        let mut scaled = Matrix::zeros(self.column_scale.len(), t);
        for (i, r) in self.row_scale.iter().enumerate() {
            let column = scaled.column_mut(i);
            let (actuated, others) = column.split_at_mut(a);
            let (passive, object) = others.split_at_mut(p);
            for (j, x) in actuated.iter_mut().enumerate() {
                *x = self.blocks.actuated[(i, j)];
            }
            for (j, x) in passive.iter_mut().enumerate() {
                *x = self.blocks.passive[(i, j)];
            }
            for (x, g) in object.iter_mut().zip(self.blocks.grasp.column(i)) {
                *x = -g;
            }
            for (x, c) in column.iter_mut().zip(&self.column_scale) {
                *x = r * *x * c;
            }
        }
        scaled
    }

    /// D_r: a force at a contact is this times its scaled value.
    pub(crate) fn row_scale(&self) -> &[f64] {
        &self.row_scale
    }

    /// D_c: a rate is this times its scaled value, a torque its scaled value over this.
    pub(crate) fn column_scale(&self) -> &[f64] {
        &self.column_scale
    }
}

/// Refuses the first entry that is NaN or infinite.
pub(crate) fn check_finite(name: &str, m: &Matrix) -> Result<()> {
    match m.as_slice().iter().position(|x| !x.is_finite()) {
        None => Ok(()),
        Some(i) => Err(Error::NotFinite {
            what: format!("{name} entry ({}, {})", i % m.rows(), i / m.rows()),
            value: m.as_slice()[i],
        }),
    }
}

/// The absolute threshold for blocks of a kernel [-]: the complement of `space`, the column space of
/// a transposed constraint.
pub(crate) fn kernel_tolerance(space: &ColumnSpace) -> f64 {
    let conditioning = if space.rank() == 0 { 1.0 } else { space.largest() / space.cut().kept };
    CLOSURE_BLOCK.max(KERNEL_ROUNDING * conditioning)
}
