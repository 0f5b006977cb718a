//! A sweep: a mechanism, configurations, quantities.
//!
//! Checked  tests/sweep/

use std::ops::Range;

use super::evaluate::Evaluator;
use super::quantity::Quantity;
use super::recipe::Recipe;
use super::source::{Configurations, Source};
use super::table::{Column, Table};
use crate::error::{Error, Result};
use crate::kinematics::EndEffector;
use crate::model::Mechanism;

/// What a sweep computes. [`Sweep::new`] checks all of it.
#[derive(Debug, Clone)]
pub struct SweepOptions {
    /// The configurations.
    pub source: Source,
    /// The quantities, in the order of their columns.
    pub quantities: Vec<Quantity>,
    /// The frame: the reference of a closed chain, otherwise the tool, by default.
    pub end_effector: Option<EndEffector>,
    /// The components of the twist that the Jacobian's measures see, of `x, y, z, rx, ry, rz` in
    /// world axes. All if empty: `x, y, rz` in the plane.
    pub task: Vec<String>,
    /// The metric of [`Quantity::Yoshikawa`] and [`Quantity::Measures`].
    pub metric: VelocityMetric,
    /// Characteristic length (m): that of the mechanism by default.
    pub length: Option<f64>,
    /// Rows of a part, the unit of work and the file of [`Sweep::write`].
    pub part_rows: u64,
}

impl Default for SweepOptions {
    fn default() -> Self {
        Self {
            source: Source::Samples { count: 0, seed: 0 },
            quantities: vec![Quantity::Pose, Quantity::Yoshikawa],
            end_effector: None,
            task: Vec::new(),
            metric: VelocityMetric::Unit,
            length: None,
            part_rows: Sweep::PART_ROWS,
        }
    }
}

/// The metric of twists and joint velocities.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum VelocityMetric {
    /// m and rad, unscaled.
    #[default]
    Unit,
    /// Lengths over the characteristic length.
    Length,
    /// As `Length`, and joint velocities over their limits.
    Limits,
}

impl VelocityMetric {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Unit, Self::Length, Self::Limits];

    /// Its name in options and recipes.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Unit => "unit",
            Self::Length => "length",
            Self::Limits => "limits",
        }
    }

    /// The metric of this name.
    ///
    /// # Errors
    /// [`Error::UnknownName`] with the nearest names.
    pub fn named(name: &str) -> Result<Self> {
        let found = Self::ALL.into_iter().find(|m| m.name() == name);
        found.ok_or_else(|| Error::unknown("metric", name, Self::ALL.map(Self::name)))
    }
}

/// A sweep of a mechanism: its rows can be computed in any order, anywhere.
///
/// Results do not depend on the number of threads, nor on which rows are asked for together.
#[derive(Debug, Clone)]
pub struct Sweep {
    pub(super) configurations: Configurations,
    pub(super) evaluator: Evaluator,
    pub(super) columns: Vec<Column>,
    pub(super) recipe: Recipe,
    pub(super) part_rows: u64,
}

impl Sweep {
    /// Rows of a part by default.
    pub const PART_ROWS: u64 = 1 << 16;

    /// Checks all options.
    ///
    /// # Errors
    /// Samples of a slider without limits or of a closed chain, an unknown or repeated coordinate,
    /// quantities that a closed chain does not have or that are named twice, unknown components, a
    /// length that is not positive, a metric of limits that a joint does not have.
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
        let configurations = Configurations::new(mechanism, &options.source)?;
        let evaluator = Evaluator::new(mechanism, &options)?;
        let mut columns = vec![Column::count("index", "place in the sweep, from 0")];
        let coordinates = mechanism.coordinates().iter();
        columns.extend(coordinates.map(|c| Column::number(&c.name, c.kind.unit(), "coordinate")));
        for quantity in &options.quantities {
            columns.extend(quantity.columns(mechanism, evaluator.values()));
        }
        for (i, column) in columns.iter().enumerate() {
            if columns[..i].iter().any(|c| c.name == column.name) {
                let reason = "a coordinate has this name too; rename it, or leave out the quantity";
                return refuse("quantities", column.name.clone(), reason);
            }
        }
        let recipe = Recipe::of(mechanism, &options, configurations.rows, &evaluator);
        let part_rows = options.part_rows;
        Ok(Self { configurations, evaluator, columns, recipe, part_rows })
    }

    /// Number of configurations.
    #[must_use]
    pub fn rows(&self) -> u64 {
        self.configurations.rows
    }

    /// The columns: `index`, the coordinates, then the quantities.
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
    /// Rows that the sweep does not have; configurations so far out that a result overflows.
    pub fn table(&self, rows: Range<u64>) -> Result<Table> {
        if rows.start > rows.end || rows.end > self.rows() {
            return Err(Error::InvalidOption {
                option: "rows",
                value: format!("{} to {}", rows.start, rows.end),
                reason: format!("the sweep has {} rows", self.rows()),
            });
        }
        let values = self.evaluator.run(&self.configurations, &self.columns, rows)?;
        Ok(Table { columns: self.columns.clone(), values })
    }
}
