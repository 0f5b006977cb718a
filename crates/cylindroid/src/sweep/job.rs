//! A sweep: a mechanism, configurations, quantities.
//!
//! Checked  tests/sweep/

use std::ops::Range;

use super::capability::{self, VoxelGrid};
use super::designs::{DesignSpace, Designs};
use super::evaluate::Evaluator;
use super::options::{PART_ROWS, SweepOptions};
use super::own_columns::{self, OwnColumn};
use super::quantity::Quantity;
use super::recipe::Recipe;
use super::source::{Configurations, REACHED, Source};
use super::table::{Column, Table, Values};
use crate::closure::ParametricModel;
use crate::error::{Error, Result};
use crate::kinematics::EndEffector;
use crate::model::{Coordinate, FrameId, Mechanism};
use crate::task::Task;

/// Parts at most: the manifest lists all of them.
const MOST_PARTS: u64 = 10_000_000;

/// A sweep of a mechanism: its rows can be computed in any order, anywhere.
///
/// Results do not depend on the number of threads, nor on which rows are asked for together.
#[derive(Debug, Clone)]
pub struct Sweep {
    pub(super) configurations: Configurations,
    pub(super) evaluator: Evaluator,
    pub(super) columns: Vec<Column>,
    own: Vec<OwnColumn>,
    pub(super) recipe: Recipe,
    pub(super) part_rows: u64,
    pub(super) designs: Option<Designs>,
}

impl Sweep {
    /// Rows of a part by default.
    pub const PART_ROWS: u64 = PART_ROWS;

    /// Rows of a part of [`Sweep::of_designs`] by default: fewer, for a design takes longer.
    pub const DESIGN_PART_ROWS: u64 = 1 << 10;

    /// Points of a part of a capability map by default: a point takes as long as thousands of
    /// configurations.
    pub const VOXEL_PART_ROWS: u64 = 1 << 6;

    /// Poses of a part by default: one that is not reached takes up to a tenth of a second.
    pub const POSE_PART_ROWS: u64 = 1 << 7;

    /// Rows of a part that take a few seconds: of samples and files, of designs and samples of closed
    /// chains, of poses, of capability maps.
    #[must_use]
    pub fn usual_part_rows(mechanism: &Mechanism, source: &Source, has_designs: bool) -> u64 {
        match source {
            Source::Voxels(_) => Self::VOXEL_PART_ROWS,
            Source::Poses { .. } => Self::POSE_PART_ROWS,
            Source::Samples { .. } if mechanism.is_closed() => Self::DESIGN_PART_ROWS,
            _ if has_designs => Self::DESIGN_PART_ROWS,
            _ => Self::PART_ROWS,
        }
    }

    /// Checks all options.
    ///
    /// # Errors
    /// Samples of a slider without limits or of a closed chain, an unknown or repeated coordinate,
    /// quantities that a closed chain does not have or that are named twice, unknown components, a
    /// length that is not of its size, a metric of limits that a joint does not have, collision shapes
    /// that no link has or of another mechanism, obstacles that are missing, own columns without a name
    /// or with that of another column; of a capability map own columns, quantities that are no
    /// index, and orientations that too few joints reach; of poses components that inverse kinematics
    /// does not take, and poses that are not finite; relative to a frame payloads, measures, poses and
    /// capability maps.
    pub fn new(mechanism: &Mechanism, options: SweepOptions) -> Result<Self> {
        let refuse = |option: &'static str, value: String, reason: &str| {
            Err(Error::InvalidOption { option, value, reason: reason.to_owned() })
        };
        if options.part_rows == 0 || options.part_rows > 1 << 24 {
            return refuse("part_rows", options.part_rows.to_string(), "1 to 2^24 are possible");
        }
        for (i, quantity) in options.quantities.iter().enumerate() {
            if options.quantities[..i].contains(quantity) {
                return refuse("quantities", quantity.name().to_owned(), "it is named twice");
            }
        }
        let (end_effector, _) = options.place(mechanism)?;
        let configurations = Configurations::new(mechanism, &options.source, end_effector)?;
        check_parts(configurations.rows, options.part_rows)?;
        let evaluator = Evaluator::new(mechanism, &options)?;
        let mut columns = vec![Column::count("index", "place in the sweep, from 0")];
        if evaluator.search.is_some() {
            columns.extend(capability::columns(mechanism, &options.quantities)?);
            if let Some(column) = options.columns.first() {
                let reason = "own columns see configurations, which points of a grid have many of";
                return refuse("columns", column.name.clone(), reason);
            }
        } else {
            let unit = |c: &Coordinate| Column::number(&c.name, c.kind.unit(), "coordinate");
            columns.extend(mechanism.coordinates().iter().map(unit));
            if configurations.of_poses() {
                columns.push(Column::count(
                    REACHED,
                    "1 if a configuration reaches the pose, 0 if none is found",
                ));
            }
            for quantity in &options.quantities {
                let is_relative = evaluator.relative.is_some();
                columns.extend(quantity.columns(mechanism, evaluator.values(), is_relative));
            }
        }
        check_names(&columns)?;
        columns.extend(own_columns::columns(&options.columns, &columns)?);
        let recipe = Recipe::of(mechanism, &options, configurations.rows, &evaluator);
        let (part_rows, own) = (options.part_rows, options.columns);
        Ok(Self { configurations, evaluator, columns, own, recipe, part_rows, designs: None })
    }

    /// The sweep of each design: values of parameters of a mechanism file. Its columns are `index`,
    /// `design`, `design_valid` and the parameters, then those of [`Sweep::new`].
    ///
    /// # Errors
    /// Those of [`Sweep::new`] for the nominal design; unknown or repeated parameters, ranges beyond
    /// those of the file, a parameter with the name of a coordinate, own columns, given
    /// collision shapes, distances to obstacles.
    pub fn of_designs(
        model: &ParametricModel,
        space: DesignSpace,
        options: SweepOptions,
    ) -> Result<Self> {
        if let Some(column) = options.columns.first() {
            return Err(Error::InvalidOption {
                option: "columns",
                value: column.name.clone(),
                reason: "own columns see configurations, not designs; sweep one design at a time"
                    .to_owned(),
            });
        }
        if options.quantities.contains(&Quantity::ObstacleDistance) {
            return Err(Error::InvalidOption {
                option: "quantities",
                value: Quantity::ObstacleDistance.name().to_owned(),
                reason: "designs have no obstacles; sweep one design at a time".to_owned(),
            });
        }
        if options.collision.is_some() {
            return Err(Error::InvalidOption {
                option: "collision",
                value: model.nominal().name().to_owned(),
                reason: "these shapes are those of one design; each has those of its own links \
                         without this option"
                    .to_owned(),
            });
        }
        let mut sweep = Self::new(model.nominal(), options.clone())?;
        let (length, part_rows) = (options.length, options.part_rows);
        let each = sweep.rows();
        let designs = Designs::new((model, space), options, sweep.columns, each)?;
        sweep.columns = designs.columns();
        check_names(&sweep.columns)?;
        let Some(rows) = each.checked_mul(designs.count) else {
            return Err(Error::InvalidOption {
                option: "rows",
                value: format!("{} designs of {each} configurations", designs.count),
                reason: "they are more than 2^64".to_owned(),
            });
        };
        check_parts(rows, part_rows)?;
        sweep.recipe = sweep.recipe.with_designs(&designs, rows, length);
        sweep.designs = Some(designs);
        Ok(sweep)
    }

    /// Number of configurations.
    #[must_use]
    pub fn rows(&self) -> u64 {
        let designs = self.designs.as_ref().map_or(1, |designs| designs.count);
        self.configurations.rows * designs
    }

    /// Number of designs, of [`Sweep::of_designs`].
    #[must_use]
    pub fn designs(&self) -> Option<u64> {
        self.designs.as_ref().map(|designs| designs.count)
    }

    /// The points and orientations of a capability map; in the plane with one roll.
    #[must_use]
    pub fn voxels(&self) -> Option<&VoxelGrid> {
        self.evaluator.search.as_ref().map(capability::Search::grid)
    }

    /// The frame of poses and Jacobians.
    #[must_use]
    pub const fn end_effector(&self) -> EndEffector {
        self.evaluator.end_effector
    }

    /// The frame from which that one is seen; `None`: the world.
    #[must_use]
    pub fn relative_to(&self) -> Option<FrameId> {
        self.evaluator.relative.as_ref().map(|relative| relative.base)
    }

    /// The quantities, in the order of their columns.
    #[must_use]
    pub fn quantities(&self) -> &[Quantity] {
        &self.evaluator.quantities
    }

    /// The components of the twist that the Jacobian's measures see, of [`Task::COMPONENTS`].
    #[must_use]
    pub fn task(&self) -> Vec<&'static str> {
        self.evaluator.task.iter().map(|&i| Task::COMPONENTS[i]).collect()
    }

    /// The columns: `index`, the coordinates, the quantities, then own columns.
    #[must_use]
    pub fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// The recipe as a JSON object: all that the numbers depend on.
    #[must_use]
    pub fn recipe(&self) -> String {
        self.recipe.to_string()
    }

    /// These rows, computed on the thread of the caller.
    ///
    /// # Errors
    /// Rows that the sweep does not have; configurations so far out that a result overflows; errors of
    /// own columns.
    pub fn table(&self, rows: Range<u64>) -> Result<Table> {
        let mut values = Vec::new();
        self.fill(rows, &mut values)?;
        Ok(Table { columns: self.columns.clone(), values })
    }

    /// The same into memory that may have other rows.
    pub(super) fn fill(&self, rows: Range<u64>, values: &mut Vec<Values>) -> Result<()> {
        if rows.start > rows.end || rows.end > self.rows() {
            return Err(Error::InvalidOption {
                option: "rows",
                value: format!("{} to {}", rows.start, rows.end),
                reason: format!("the sweep has {} rows", self.rows()),
            });
        }
        if let Some(designs) = &self.designs {
            *values = designs.run(&self.columns, rows)?;
            return Ok(());
        }
        let others = &self.columns[..self.columns.len() - self.own.len()];
        let from = &self.configurations;
        capability::run(&self.evaluator, from, others, rows.clone(), values)?;
        values.extend(own_columns::run(&self.own, from, rows)?);
        Ok(())
    }
}

/// Returns an error for too many parts.
fn check_parts(rows: u64, part_rows: u64) -> Result<()> {
    if rows.div_ceil(part_rows) <= MOST_PARTS {
        return Ok(());
    }
    Err(Error::InvalidOption {
        option: "part_rows",
        value: part_rows.to_string(),
        reason: "the sweep has more than 10 000 000 parts; give parts more rows".to_owned(),
    })
}

/// Returns an error for a column whose name another one has.
fn check_names(columns: &[Column]) -> Result<()> {
    for (i, column) in columns.iter().enumerate() {
        if columns[..i].iter().any(|c| c.name == column.name) {
            return Err(Error::InvalidOption {
                option: "quantities",
                value: column.name.clone(),
                reason: "a coordinate or parameter has this name too; rename it, or leave out the \
                         quantity"
                    .to_owned(),
            });
        }
    }
    Ok(())
}
