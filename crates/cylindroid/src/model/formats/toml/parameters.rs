//! The `[parameters]` table of a mechanism file: named numbers, from which expressions derive the
//! others.
//!
//! Keys     of any name: a number, an expression of other parameters, or a table with value, lower,
//!          upper, unit, description
//! Valid    values given at loading replace those of the file, of expressions too; every value lies
//!          within lower and upper, given or not
//! Fails    parameters defined by one another, values out of range, names that expressions cannot
//!          have
//! Why so   a file without the table has no expressions: a text for a number remains an error there
//! Checked  tests/formats/parameters.rs

use std::collections::BTreeMap;
use std::ops::Range;

use ::toml::Spanned;
use ::toml::de::{DeTable, DeValue};

use super::expression::{self, Expression};
use super::value::Table;
use super::values::{Values, parse};
use crate::error::{Error, Result, shown};
use crate::model::formats::span::Source;
use crate::model::{Parameter, ParameterValues, magnitude};
use crate::tolerance::MAX_MAGNITUDE;

const KEYS: [&str; 5] = ["value", "lower", "upper", "unit", "description"];

/// The parameters of a file with their values.
#[derive(Debug)]
pub(super) struct Parameters {
    values: Values,
    list: Vec<Parameter>,
}

/// A parameter as the file has it.
struct Definition<'t> {
    name: &'t str,
    name_span: Range<usize>,
    value: &'t Spanned<DeValue<'t>>,
    table: Option<Table<'t>>,
    /// A value given at loading.
    given: Option<f64>,
    expression: Option<Expression<'t>>,
}

impl Parameters {
    /// The parameters of a file, if it has the table, with these values in place of its own.
    pub(super) fn read<'t>(
        source: &Source<'t>,
        document: &'t DeTable<'t>,
        given: ParameterValues<'_>,
    ) -> Result<Option<Self>> {
        let Some(table) = document.get("parameters") else {
            return match given.first() {
                None => Ok(None),
                Some((name, _)) => Err(none(name, &shown(source.path))),
            };
        };
        let DeValue::Table(map) = table.get_ref() else {
            let help = "write [parameters], and name = number below";
            return Err(source.error(table.span(), "parameters is no table", help));
        };
        let mut definitions = map
            .iter()
            .map(|(name, value)| {
                Definition::read(source, (name.get_ref().as_ref(), name.span()), value)
            })
            .collect::<Result<Vec<_>>>()?;
        definitions.sort_by_key(|d| d.name_span.start);
        for (i, (name, value)) in given.iter().enumerate() {
            let known = definitions.iter().map(|d| d.name);
            let place = known.clone().position(|k| k == *name);
            let place = place.ok_or_else(|| Error::unknown("parameter", name, known))?;
            if given[..i].iter().any(|(other, _)| other == name) {
                return Err(refuse(format!("{name} = {value}"), "it is given twice".to_owned()));
            }
            Error::check_within(name, &[*value], MAX_MAGNITUDE)?;
            definitions[place].given = Some(*value);
        }
        let values = evaluated(source, &definitions)?;
        let ranged = definitions.iter().map(|definition| definition.parameter(&values));
        let list = ranged.collect::<Result<_>>()?;
        Ok(Some(Self { values, list }))
    }

    /// The values, for expressions.
    pub(super) fn values(&self) -> &Values {
        &self.values
    }

    /// The parameters, in the order of the file.
    pub(super) fn list(&self) -> &[Parameter] {
        &self.list
    }
}

/// The values: first of numbers, then of expressions whose parameters have theirs.
fn evaluated(source: &Source<'_>, definitions: &[Definition<'_>]) -> Result<Values> {
    let index: BTreeMap<&str, usize> =
        definitions.iter().enumerate().map(|(i, d)| (d.name, i)).collect();
    // How many names of each are without a value, and who waits for each.
    let mut missing = vec![0; definitions.len()];
    let mut waiting: Vec<Vec<usize>> = vec![Vec::new(); definitions.len()];
    for (i, definition) in definitions.iter().enumerate() {
        for name in definition.names() {
            if let Some(&of) = index.get(name) {
                missing[i] += 1;
                waiting[of].push(i);
            }
        }
    }
    let mut ready: Vec<usize> = (0..definitions.len()).filter(|&i| missing[i] == 0).collect();
    // All names, so that an unknown one is compared with them.
    let mut values = Values(definitions.iter().map(|d| (d.name.to_owned(), f64::NAN)).collect());
    let mut count = 0;
    while let Some(i) = ready.pop() {
        count += 1;
        let value = definitions[i].value(source, &values)?;
        values.0.insert(definitions[i].name.to_owned(), value);
        for &next in &waiting[i] {
            missing[next] -= 1;
            if missing[next] == 0 {
                ready.push(next);
            }
        }
    }
    if count < definitions.len() {
        return Err(cycle(source, definitions, &index, &missing));
    }
    Ok(values)
}

impl<'t> Definition<'t> {
    fn read(
        source: &Source<'t>,
        (name, name_span): (&'t str, Range<usize>),
        value: &'t Spanned<DeValue<'t>>,
    ) -> Result<Self> {
        if !expression::is_name(name) {
            let help = "names have letters, digits and underscores, a digit not first";
            let message =
                format!("a parameter cannot be named '{name}': no expression could name it");
            return Err(source.error(name_span, message, help));
        }
        if expression::is_reserved(name) {
            let message = format!("'{name}' has a meaning in expressions already");
            return Err(source.error(name_span, message, "name the parameter otherwise"));
        }
        let (value, table) = match value.get_ref() {
            DeValue::Table(map) => {
                let table = Table::new(*source, "a parameter", map, value.span(), &KEYS)?;
                let value = map.get("value").ok_or_else(|| table.missing("value"))?;
                (value, Some(table))
            }
            _ => (value, None),
        };
        let expression = match value.get_ref().as_str() {
            None => None,
            Some(text) => Some(parse(source, (text, value.span()))?),
        };
        Ok(Self { name, name_span, value, table, given: None, expression })
    }

    /// The parameters that its value needs.
    fn names(&self) -> impl Iterator<Item = &'t str> {
        let own = self.expression.as_ref().filter(|_| self.given.is_none());
        own.into_iter().flat_map(Expression::names)
    }

    fn value(&self, source: &Source<'_>, values: &Values) -> Result<f64> {
        if let Some(given) = self.given {
            return Ok(given);
        }
        let x = match &self.expression {
            Some(own) => values.value(source, own, self.value.span())?,
            None => super::value::number(self.value.get_ref()).ok_or_else(|| {
                let message = format!("parameter '{}' is no number", self.name);
                let help = "give a number, an expression in quotes, or a table with value";
                source.error(self.value.span(), message, help)
            })?,
        };
        match magnitude::fault(&[x]) {
            None => Ok(x),
            Some(fault) => {
                let message = format!("parameter '{}' {fault}", self.name);
                Err(source.error(self.value.span(), message, ""))
            }
        }
    }

    /// The parameter; a value out of its range is refused.
    fn parameter(&self, values: &Values) -> Result<Parameter> {
        let name = self.name;
        let own = Parameter {
            name: name.to_owned(),
            value: values.0.get(name).copied().unwrap_or(f64::NAN),
            lower: f64::NEG_INFINITY,
            upper: f64::INFINITY,
            unit: String::new(),
            description: String::new(),
            expression: match (self.given, self.value.get_ref().as_str()) {
                (None, Some(text)) => text.to_owned(),
                _ => String::new(),
            },
        };
        let Some(table) = self.table.clone() else { return Ok(own) };
        let table = table.with_parameters(Some(values));
        let lower = table.bound("lower")?.unwrap_or(own.lower);
        let upper = table.bound("upper")?.unwrap_or(own.upper);
        if lower > upper {
            let message = format!("the range of '{name}' is empty: {lower} to {upper}");
            return Err(table.refuse("lower", message, "give a lower one below the upper one"));
        }
        let value = own.value;
        if !(value >= lower && value <= upper) {
            let range = format!("its range is {lower} to {upper}");
            return Err(match self.given {
                Some(_) => refuse(format!("{name} = {value}"), range),
                None => table.refuse("value", format!("{name} = {value}, and {range}"), ""),
            });
        }
        let text = |key| table.string(key).map(|text| text.unwrap_or("").to_owned());
        let (unit, description) = (text("unit")?, text("description")?);
        Ok(Parameter { lower, upper, unit, description, ..own })
    }
}

/// Parameters that wait for one another.
fn cycle(
    source: &Source<'_>,
    definitions: &[Definition<'_>],
    index: &BTreeMap<&str, usize>,
    missing: &[usize],
) -> Error {
    let next = |i: usize| {
        let mut names = definitions[i].names().filter_map(|name| index.get(name).copied());
        names.find(|&of| missing[of] > 0)
    };
    let mut path: Vec<usize> = Vec::new();
    let mut here = missing.iter().position(|&n| n > 0);
    while let Some(i) = here.filter(|i| !path.contains(i)) {
        path.push(i);
        here = next(i);
    }
    let first = path.iter().position(|i| Some(*i) == here).unwrap_or(0);
    let mut names: Vec<&str> = path[first..].iter().map(|&i| definitions[i].name).collect();
    names.extend(names.first().copied());
    let message = format!("parameters are defined by one another: {}", names.join(" -> "));
    let place = path.get(first).map_or(0..0, |&i| definitions[i].name_span.clone());
    source.error(place, message, "give one of them a number")
}

fn refuse(value: String, reason: String) -> Error {
    Error::InvalidOption { option: "parameter", value, reason }
}

/// The error of a value for a model without parameters.
pub(in crate::model) fn none(name: &str, model: &str) -> Error {
    let reason =
        format!("{model} has no parameters; a mechanism file (.toml) has some by [parameters]");
    refuse(name.to_owned(), reason)
}
