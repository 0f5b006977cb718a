//! Values of parameters, and of expressions of them at their places in the file.
//!
//! Checked  tests/formats/parameters.rs

use std::collections::BTreeMap;
use std::ops::Range;

use super::expression::{self, Expression};
use crate::error::{Error, Result};
use crate::model::formats::span::Source;

/// Values of parameters by name.
#[derive(Debug, Default)]
pub(super) struct Values(pub(super) BTreeMap<String, f64>);

/// A text of the file, and its range with its quotes.
pub(super) type Written<'t> = (&'t str, Range<usize>);

impl Values {
    /// The value of an expression.
    pub(super) fn evaluate(&self, source: &Source<'_>, text: Written<'_>) -> Result<f64> {
        let expression = parse(source, text.clone())?;
        self.value(source, &expression, text.1)
    }

    /// The value of an expression that was parsed from the text at this range.
    pub(super) fn value(
        &self,
        source: &Source<'_>,
        expression: &Expression<'_>,
        span: Range<usize>,
    ) -> Result<f64> {
        let unknown = |name: &str| Error::unknown("parameter", name, self.0.keys()).to_string();
        let value = expression.value(|name| self.0.get(name).copied(), unknown);
        value.map_err(|fault| at(source, (expression.text(), span), fault, ""))
    }
}

/// Parses a text of the file.
pub(super) fn parse<'t>(source: &Source<'_>, text: Written<'t>) -> Result<Expression<'t>> {
    Expression::parse(text.0).map_err(|fault| at(source, text, fault, expression::help()))
}

/// An error inside a text of the file.
fn at(
    source: &Source<'_>,
    (text, span): Written<'_>,
    fault: expression::Fault,
    help: impl Into<String>,
) -> Error {
    // Behind the quotes; a text with escapes has other places than the file.
    let written = source.text.get(span.clone()).and_then(|written| written.find(text));
    let place = written.map_or(span.clone(), |quotes| {
        let start = span.start + quotes;
        start + fault.span.start..start + fault.span.end
    });
    source.error(place, fault.message, help)
}
