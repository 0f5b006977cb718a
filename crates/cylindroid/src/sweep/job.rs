//! A sweep: a mechanism, configurations, quantities.
//!
//! Checked  tests/sweep/

use std::ops::Range;

use super::evaluate::Evaluator;
use super::options::{PART_ROWS, SweepOptions};
use super::recipe::Recipe;
use super::source::Configurations;
use super::table::{Column, Table};
use crate::error::{Error, Result};
use crate::model::Mechanism;

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
    pub(super) recipe: Recipe,
    pub(super) part_rows: u64,
}

impl Sweep {
    /// Rows of a part by default.
    pub const PART_ROWS: u64 = PART_ROWS;

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
        if configurations.rows.div_ceil(options.part_rows) > MOST_PARTS {
            let reason = "the sweep has more than 10 000 000 parts; give parts more rows";
            return refuse("part_rows", options.part_rows.to_string(), reason);
        }
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
