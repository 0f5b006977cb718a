//! Rows of a sweep in columns.
//!
//! Checked  tests/sweep/quantities.rs

use std::borrow::Cow;

/// A column: its name, unit and meaning.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// Its SI unit; "1" for numbers without one, empty for others.
    pub unit: Cow<'static, str>,
    /// One phrase.
    pub description: &'static str,
    /// The type of its entries.
    pub(super) kind: ColumnKind,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ColumnKind {
    Number,
    Count,
    Text,
}

impl Column {
    pub(super) fn number(name: &str, unit: &'static str, description: &'static str) -> Self {
        Self { name: name.to_owned(), unit: unit.into(), description, kind: ColumnKind::Number }
    }

    pub(super) fn count(name: &str, description: &'static str) -> Self {
        Self { name: name.to_owned(), unit: "".into(), description, kind: ColumnKind::Count }
    }

    pub(super) fn text(name: &str, description: &'static str) -> Self {
        Self { name: name.to_owned(), unit: "".into(), description, kind: ColumnKind::Text }
    }

    /// A column of the caller.
    pub(super) fn own(name: &str, unit: &str) -> Self {
        let unit = unit.to_owned().into();
        Self { name: name.to_owned(), unit, description: "own column", kind: ColumnKind::Number }
    }

    /// A parameter of the file, whose unit the file names.
    pub(super) fn parameter(name: &str, unit: &str) -> Self {
        let unit = unit.to_owned().into();
        Self { name: name.to_owned(), unit, description: "parameter", kind: ColumnKind::Number }
    }

    /// True for numbers, whole ones too; false for names.
    #[must_use]
    pub const fn is_number(&self) -> bool {
        matches!(self.kind, ColumnKind::Number | ColumnKind::Count)
    }

    /// Entries of rows without results.
    pub(super) fn missing(&self, rows: usize) -> Values {
        match self.kind {
            ColumnKind::Number => Values::Numbers(vec![f64::NAN; rows]),
            ColumnKind::Count => Values::Counts(vec![0; rows]),
            ColumnKind::Text => Values::Texts(vec![""; rows]),
        }
    }

    pub(super) fn empty(&self) -> Values {
        match self.kind {
            ColumnKind::Number => Values::Numbers(Vec::new()),
            ColumnKind::Count => Values::Counts(Vec::new()),
            ColumnKind::Text => Values::Texts(Vec::new()),
        }
    }
}

/// Makes `values` those of the columns, without entries; memory that they have is used again, since
/// the pages of new memory cost as much time as some quantities.
pub(super) fn begin(values: &mut Vec<Values>, columns: &[Column], rows: usize) {
    values.truncate(columns.len());
    for (i, column) in columns.iter().enumerate() {
        match values.get_mut(i) {
            Some(own) if own.is_of(column.kind) => {}
            Some(own) => *own = column.empty(),
            None => values.push(column.empty()),
        }
        values[i].begin(rows);
    }
}

/// The entries of a column.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Values {
    /// Real numbers; infinite or NaN where the description says so.
    Numbers(Vec<f64>),
    /// Whole numbers.
    Counts(Vec<u64>),
    /// Names.
    Texts(Vec<&'static str>),
}

impl Values {
    fn is_of(&self, kind: ColumnKind) -> bool {
        let own = match self {
            Self::Numbers(_) => ColumnKind::Number,
            Self::Counts(_) => ColumnKind::Count,
            Self::Texts(_) => ColumnKind::Text,
        };
        own == kind
    }

    /// Replaces an entry by that of a row without results.
    pub(super) fn blank(&mut self, row: usize) {
        match self {
            Self::Numbers(own) => own[row] = f64::NAN,
            Self::Counts(own) => own[row] = 0,
            Self::Texts(own) => own[row] = "",
        }
    }

    /// Without entries, and with room for so many.
    pub(super) fn begin(&mut self, rows: usize) {
        match self {
            Self::Numbers(own) => {
                own.clear();
                own.reserve_exact(rows);
            }
            Self::Counts(own) => {
                own.clear();
                own.reserve_exact(rows);
            }
            Self::Texts(own) => {
                own.clear();
                own.reserve_exact(rows);
            }
        }
    }

    /// Appends entries of the same type.
    pub(super) fn append(&mut self, more: Self) {
        match (self, more) {
            (Self::Numbers(own), Self::Numbers(more)) => own.extend(more),
            (Self::Counts(own), Self::Counts(more)) => own.extend(more),
            (Self::Texts(own), Self::Texts(more)) => own.extend(more),
            _ => {}
        }
    }
}

impl Values {
    /// Some of them, whole ones as real numbers; `None` for names and for rows that are not there.
    #[must_use]
    pub fn to_numbers(&self, rows: std::ops::Range<usize>) -> Option<Vec<f64>> {
        match self {
            Self::Numbers(numbers) => numbers.get(rows).map(<[f64]>::to_vec),
            Self::Counts(counts) => Some(counts.get(rows)?.iter().map(|c| *c as f64).collect()),
            Self::Texts(_) => None,
        }
    }
}

/// Rows of a sweep in columns.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// The columns.
    pub columns: Vec<Column>,
    /// Their entries, in the same order.
    pub values: Vec<Values>,
}

impl Table {
    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.values.first().map_or(0, |values| match values {
            Values::Numbers(v) => v.len(),
            Values::Counts(v) => v.len(),
            Values::Texts(v) => v.len(),
        })
    }

    /// The column of a name.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<&Values> {
        let place = self.columns.iter().position(|c| c.name == name)?;
        self.values.get(place)
    }

    /// The column of a name, if it is one of real numbers.
    #[must_use]
    pub fn numbers(&self, name: &str) -> Option<&[f64]> {
        match self.column(name)? {
            Values::Numbers(numbers) => Some(numbers),
            _ => None,
        }
    }
}
