//! The velocity constraint of a closed chain, scaled by a characteristic length.
//!
//! Formula  J_a q_a + J_p q_p - G^T u = 0; scaled M' = D_r [J_a J_p -G^T] D_c
//! Shapes   J_a: t x q_a, J_p: t x q_p, G: d x t
//! Units    rows are velocities (m/s) or angular velocities (rad/s) at a contact, columns are rates
//!          of either unit. With the characteristic length l, D_r divides rows of lengths by l and
//!          D_c multiplies columns of lengths by it: M' has no unit
//! Frame    any: u and its wrench are taken at one point in one frame, each row in a frame of its
//!          own
//! Valid    any sizes, including zero, up to 2000 columns and 12 000 rows. Several objects: the
//!          columns -G^T of those that are not the reference belong to `passive`
//! Why so   equilibrating rows and columns would need no length, but it amplifies a row that is
//!          zero up to rounding until it counts
//! Source   Bicchi & Prattichizzo 1998, eq. 2 and appendix A
//! Checked  tests/it/closure/scaling.rs, tests/it/closure/bad_input.rs

use std::ops::Range;

use crate::error::{Error, Result};
use crate::linalg::{ColumnSpace, Matrix};
use crate::model::CoordinateKind;
use crate::tolerance::{CLOSURE_BLOCK, KERNEL_ROUNDING, LENGTHS};

/// The unit of a coordinate or of a row of the constraint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// Metres: prismatic joints, linear velocities.
    Length,
    /// Radians: revolute joints, angular velocities.
    Angle,
}

impl Unit {
    /// The unit of a coordinate.
    pub(crate) fn of(kind: CoordinateKind) -> Self {
        if kind.is_length() { Self::Length } else { Self::Angle }
    }

    /// The value (m or rad) of a dimensionless 1 for the characteristic length `length`.
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
    /// `J_a`, t x q_a: contact velocities per rate of the actuated joints.
    pub actuated: Matrix,
    /// `J_p`, t x q_p: per rate of the passive joints and of objects other than the reference.
    pub passive: Matrix,
    /// `G`, d x t, the grasp matrix: wrench on the object per force at the contacts.
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

/// A velocity constraint: finite, of matching shapes, with its scales.
///
/// ```text
/// J_a qd_a + J_p qd_p - G^T u = 0
/// ```
///
/// J_a is t x q_a, J_p t x q_p and G, the grasp matrix, d x t ([`ConstraintBlocks`]); u is the
/// twist of the object, its wrench is taken at the same point. Rows in m/s or rad/s.
///
/// Source: Bicchi & Prattichizzo 1998, eq. 2.
#[derive(Debug, Clone, PartialEq)]
pub struct Constraint {
    blocks: ConstraintBlocks,
    length: f64,
    /// D_r.
    row_scale: Vec<f64>,
    /// D_c of actuated joints, passive columns and object.
    column_scale: Vec<f64>,
    /// Columns that are components of one vector (a rotation, a position): the axes along which
    /// they are taken are a choice.
    vectors: Vec<Range<usize>>,
}

impl Constraint {
    /// A constraint whose rows and columns all have one unit, or mixed units with the
    /// characteristic length 1 m.
    ///
    /// # Errors
    /// Blocks with different numbers of rows; NaN or infinity; more than 2000 columns, or 12 000
    /// rows.
    pub fn new(blocks: ConstraintBlocks) -> Result<Self> {
        let t = blocks.grasp.cols();
        let n = blocks.actuated.cols() + blocks.passive.cols() + blocks.grasp.rows();
        check_size(t, n)?;
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
        let (row_scale, column_scale) = (vec![1.0; t], vec![1.0; n]);
        Ok(Self { blocks, length: 1.0, row_scale, column_scale, vectors: Vec::new() })
    }

    /// The same constraint with lengths divided by the characteristic length `length` (m).
    ///
    /// ```
    /// use cylindroid::closure::{Constraint, ConstraintBlocks, Unit, Units};
    /// use cylindroid::Matrix;
    ///
    /// // A lever of 2 m pushes a slider: v = 2 q'.
    /// let constraint = Constraint::new(ConstraintBlocks {
    ///     actuated: Matrix::from_rows(&[[2.0]]).unwrap(),
    ///     passive: Matrix::zeros(1, 0),
    ///     grasp: Matrix::identity(1),
    /// })?;
    /// let units = Units {
    ///     rows: vec![Unit::Length],
    ///     actuated: vec![Unit::Angle],
    ///     passive: vec![],
    ///     object: vec![Unit::Length],
    /// };
    /// assert_eq!(constraint.with_length(&units, 0.5)?.length(), 0.5);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// The wrong number of units; a length that is not one of [`LENGTHS`]; scaled entries that
    /// overflow.
    pub fn with_length(mut self, units: &Units, length: f64) -> Result<Self> {
        Error::check_range("length", length, &LENGTHS)?;
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

    /// The same rows with other columns, of these scales.
    pub(crate) fn with_columns(&self, blocks: ConstraintBlocks, column_scale: Vec<f64>) -> Self {
        let (length, row_scale) = (self.length, self.row_scale.clone());
        Self { blocks, length, row_scale, column_scale, vectors: Vec::new() }
    }

    /// The same constraint, with the ranges of columns that are components of one vector.
    pub(crate) fn with_vectors(mut self, vectors: Vec<Range<usize>>) -> Self {
        self.vectors = vectors;
        self
    }

    /// For every actuated or passive column, the columns of the vector of which it is a component:
    /// itself for a scalar.
    pub(crate) fn vector_of(&self, column: usize) -> Range<usize> {
        let own = self.vectors.iter().find(|v| v.contains(&column));
        own.cloned().unwrap_or(column..column + 1)
    }

    /// A serial arm: `u = J q`, all joints actuated.
    ///
    /// ```
    /// use cylindroid::closure::{Constraint, Mobility};
    /// use cylindroid::ReferenceFrame;
    ///
    /// // The one redundant motion of a 7R arm.
    /// let panda = cylindroid::load("panda")?;
    /// let state = panda.state(panda.home())?;
    /// let jacobian = state.jacobian(panda.tool(), ReferenceFrame::LocalWorldAligned)?;
    /// let mobility = Mobility::of(&Constraint::serial(&jacobian)?);
    /// assert_eq!((mobility.dof.dimension(), mobility.redundancy.dimension()), (7, 1));
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// NaN or infinity; more than 2000 columns.
    pub fn serial(jacobian: &Matrix) -> Result<Self> {
        Self::new(ConstraintBlocks {
            actuated: jacobian.clone(),
            passive: Matrix::zeros(jacobian.rows(), 0),
            grasp: Matrix::identity(jacobian.rows()),
        })
    }

    /// The matrices of the constraint.
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

    /// True if no scaled entry overflows: the bound is the largest entry times both largest scales.
    fn is_finite_scaled(&self) -> bool {
        let ConstraintBlocks { actuated, passive, grasp } = &self.blocks;
        let size = actuated.max_abs().max(passive.max_abs()).max(grasp.max_abs());
        let largest = |scale: &[f64]| scale.iter().fold(0.0, |m: f64, s| m.max(*s));
        let (row, column) = (largest(&self.row_scale), largest(&self.column_scale));
        (row * size * column).is_finite() && (row * size).is_finite()
    }

    /// The transpose in scaled coordinates, `D_c M^T D_r`.
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

    /// D_r: a contact force is this factor times its scaled value.
    pub(crate) fn row_scale(&self) -> &[f64] {
        &self.row_scale
    }

    /// D_c: a rate is this factor times its scaled value, a torque its scaled value divided by it.
    pub(crate) fn column_scale(&self) -> &[f64] {
        &self.column_scale
    }
}

/// The most columns of a constraint: joints, further objects and the reference. Bases of its motions
/// are dense, 32 MB each at this size, and their decompositions take minutes.
const MOST_COLUMNS: usize = 2000;

/// The most rows: six for each of as many joints.
const MOST_ROWS: usize = 6 * MOST_COLUMNS;

/// Returns an error for a constraint whose dense matrices would be too large.
pub(crate) fn check_size(rows: usize, columns: usize) -> Result<()> {
    for (size, most, what) in [(columns, MOST_COLUMNS, "columns"), (rows, MOST_ROWS, "rows")] {
        if size > most {
            return Err(Error::InvalidOption {
                option: "constraint of the mechanism",
                value: format!("{size} {what}"),
                reason: format!(
                    "at most {most} are analysed, in dense matrices; analyse a part of the \
                     mechanism (a group of an SRDF, or the others as fixed joints), or the \
                     Jacobians of frames, which have no such limit"
                ),
            });
        }
    }
    Ok(())
}

/// The same for a single matrix, which may have many rows and few columns.
pub(crate) fn check_entries(rows: usize, columns: usize) -> Result<()> {
    let most = MOST_ROWS * MOST_COLUMNS;
    if rows.saturating_mul(columns) > most { check_size(rows, columns) } else { Ok(()) }
}

/// Returns an error for more moving coordinates than a controller or a search has dense matrices for.
pub(crate) fn check_coordinates(what: &'static str, coordinates: usize) -> Result<()> {
    if coordinates <= MOST_COLUMNS {
        return Ok(());
    }
    Err(Error::InvalidOption {
        option: what,
        value: format!("{coordinates} coordinates that move"),
        reason: format!(
            "at most {MOST_COLUMNS} are taken, in dense matrices; name a frame that fewer joints \
             move, or take a part of the mechanism (a group of an SRDF, or the others as fixed joints)"
        ),
    })
}

/// Returns an error for the first entry that is NaN or infinite.
pub(crate) fn check_finite(name: &str, m: &Matrix) -> Result<()> {
    match m.as_slice().iter().position(|x| !x.is_finite()) {
        None => Ok(()),
        Some(i) => Err(Error::NotFinite {
            what: format!("{name} entry ({}, {})", i % m.rows(), i / m.rows()),
            value: m.as_slice()[i],
        }),
    }
}

/// The absolute threshold [-] for blocks of the kernel of a constraint, that is the complement of
/// `space`, the column space of the transposed constraint.
pub(crate) fn kernel_tolerance(space: &ColumnSpace) -> f64 {
    let conditioning = if space.rank() == 0 { 1.0 } else { space.largest() / space.cut().kept };
    CLOSURE_BLOCK.max(KERNEL_ROUNDING * conditioning)
}
