//! What a column of a Parquet file holds, by its logical type: numbers in some form, or other things that are
//! stored as numbers.
//!
//! Formulas a decimal is its integer * 10^-scale, rounded once
//! Checked  tests/sweep/parquet_forms.rs

use parquet::basic::{ConvertedType, LogicalType, Type as Physical};
use parquet::schema::types::ColumnDescriptor;

/// How integers are numbers; floating-point numbers are as they are stored.
#[derive(Debug, Clone, Copy)]
pub(super) enum Form {
    Signed,
    Unsigned,
    Decimal { scale: i32 },
}

impl Form {
    /// The form of a column, or what it holds instead of numbers that can be read. Of texts and bytes
    /// without a logical type each row says that it has no number.
    pub(super) fn of(column: &ColumnDescriptor) -> Result<Self, &'static str> {
        // Those that older readers know by their converted type have one here too.
        match column.logical_type_ref() {
            Some(LogicalType::Time(_)) => return Err("times of day"),
            Some(LogicalType::Timestamp(_)) => return Err("points in time"),
            Some(LogicalType::Float16) => return Err("numbers of 16 bits, which are not read"),
            Some(LogicalType::_Unknown { .. }) => return Err("values of an unknown kind"),
            _ => {}
        }
        match column.converted_type() {
            ConvertedType::DATE => Err("dates"),
            ConvertedType::TIME_MILLIS | ConvertedType::TIME_MICROS => Err("times of day"),
            ConvertedType::TIMESTAMP_MILLIS | ConvertedType::TIMESTAMP_MICROS => {
                Err("points in time")
            }
            ConvertedType::DECIMAL => match column.physical_type() {
                Physical::INT32 | Physical::INT64 => {
                    Ok(Self::Decimal { scale: column.type_scale() })
                }
                _ => Err("decimals in bytes, which are not read"),
            },
            ConvertedType::UINT_8
            | ConvertedType::UINT_16
            | ConvertedType::UINT_32
            | ConvertedType::UINT_64 => Ok(Self::Unsigned),
            _ if column.physical_type() == Physical::INT96 => Err("points in time"),
            _ => Ok(Self::Signed),
        }
    }

    pub(super) fn of_short(self, x: i32) -> f64 {
        match self {
            Self::Signed => f64::from(x),
            Self::Unsigned => f64::from(x.cast_unsigned()),
            Self::Decimal { scale } => decimal(x.into(), scale),
        }
    }

    pub(super) fn of_long(self, x: i64) -> f64 {
        match self {
            Self::Signed => x as f64,
            Self::Unsigned => x.cast_unsigned() as f64,
            Self::Decimal { scale } => decimal(x, scale),
        }
    }
}

/// By its text: a division would round an integer beyond 2^53 twice.
fn decimal(x: i64, scale: i32) -> f64 {
    // Never NaN: it is always the text of a number.
    format!("{x}e-{scale}").parse().unwrap_or(f64::NAN)
}
