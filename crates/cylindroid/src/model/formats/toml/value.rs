//! Reads keys of a TOML table: types are checked, errors carry line and column, unknown keys are
//! rejected.
//!
//! Checked  tests/formats/mechanism_file.rs::wrong_values_*, ::what_is_not_known_*

use std::ops::Range;

use ::toml::Spanned;
use ::toml::de::{DeString, DeTable, DeValue};

use super::values::Values;
use crate::error::{Error, Result};
use crate::model::Limits;
use crate::model::formats::span::Source;
use crate::model::magnitude;
use crate::spatial::{Pose, Rpy, Vec3};

/// A table of the file.
#[derive(Debug, Clone)]
pub(super) struct Table<'t> {
    pub(super) source: Source<'t>,
    /// Its name in errors: `[[joint]]`, `limits`, ...
    what: &'static str,
    map: &'t DeTable<'t>,
    pub(super) span: Range<usize>,
    /// With them, expressions may replace numbers.
    parameters: Option<&'t Values>,
}

/// An entry of a list.
pub(super) enum NumberOrTable<'t> {
    Number(f64),
    Table(Table<'t>),
}

impl<'t> Table<'t> {
    /// A table with these keys and no others.
    pub(super) fn new(
        source: Source<'t>,
        what: &'static str,
        map: &'t DeTable<'t>,
        span: Range<usize>,
        keys: &[&str],
    ) -> Result<Self> {
        for key in map.keys() {
            let name = key.get_ref().as_ref();
            if !keys.contains(&name) {
                let unknown = Error::unknown("key", name, keys.iter().copied());
                let help = format!("{what} has the keys {}", keys.join(", "));
                return Err(source.error(key.span(), format!("{unknown} (in {what})"), help));
            }
        }
        Ok(Self { source, what, map, span, parameters: None })
    }

    /// The same table, in which expressions of these parameters may replace numbers.
    pub(super) fn with_parameters(self, parameters: Option<&'t Values>) -> Self {
        Self { parameters, ..self }
    }

    /// A table inside this one.
    fn inside(
        &self,
        what: &'static str,
        map: &'t DeTable<'t>,
        span: Range<usize>,
        keys: &[&str],
    ) -> Result<Self> {
        Ok(Self::new(self.source, what, map, span, keys)?.with_parameters(self.parameters))
    }

    /// The value as a number that is not NaN, if it is one; that of an expression where the file has
    /// parameters.
    fn value(&self, value: &Spanned<DeValue<'_>>) -> Result<Option<f64>> {
        match (value.get_ref().as_str(), self.parameters) {
            (Some(text), Some(parameters)) => {
                parameters.evaluate(&self.source, (text, value.span())).map(Some)
            }
            _ => Ok(number(value.get_ref())),
        }
    }

    fn get(&self, key: &str) -> Option<&'t Spanned<DeValue<'t>>> {
        self.map.get(key)
    }

    pub(super) fn has(&self, key: &str) -> bool {
        self.get(key).is_some()
    }

    /// The place of the value of a key; of the table itself if there is no such key.
    pub(super) fn at(&self, key: &str) -> Range<usize> {
        self.get(key).map_or_else(|| self.span.clone(), Spanned::span)
    }

    /// An error at the value of a key.
    pub(super) fn refuse(
        &self,
        key: &str,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Error {
        self.source.error(self.at(key), message, help)
    }

    fn wrong_type(&self, key: &str, expected: &str, value: &DeValue<'_>) -> Error {
        let message = format!("{key} in {} is {}", self.what, article(value.type_str()));
        self.refuse(key, message, format!("give {expected}"))
    }

    pub(super) fn missing(&self, key: &str) -> Error {
        let message = format!("{} has no {key}", self.what);
        self.refuse(key, message, format!("write {key} = ..."))
    }

    pub(super) fn string(&self, key: &str) -> Result<Option<&'t str>> {
        let Some(value) = self.get(key) else { return Ok(None) };
        let text = value.get_ref().as_str();
        text.map(Some).ok_or_else(|| self.wrong_type(key, "a text in quotes", value.get_ref()))
    }

    pub(super) fn required_string(&self, key: &str) -> Result<&'t str> {
        self.string(key)?.ok_or_else(|| self.missing(key))
    }

    pub(super) fn boolean(&self, key: &str) -> Result<Option<bool>> {
        let Some(value) = self.get(key) else { return Ok(None) };
        let boolean = value.get_ref().as_bool();
        boolean.map(Some).ok_or_else(|| self.wrong_type(key, "true or false", value.get_ref()))
    }

    /// A number, which may be infinite.
    pub(super) fn bound(&self, key: &str) -> Result<Option<f64>> {
        let Some(value) = self.get(key) else { return Ok(None) };
        let Some(x) = self.value(value)? else {
            return Err(self.wrong_type(key, "a number", value.get_ref()));
        };
        match magnitude::bound_fault(&[x]) {
            None => Ok(Some(x)),
            Some(fault) => Err(self.refuse(key, format!("{key} {fault}"), "")),
        }
    }

    /// A finite number.
    pub(super) fn number(&self, key: &str) -> Result<Option<f64>> {
        match self.bound(key)? {
            Some(x) if !x.is_finite() => {
                Err(self.refuse(key, format!("{key} is not finite"), "give a finite number"))
            }
            x => Ok(x),
        }
    }

    fn array(&self, key: &str) -> Result<Option<&'t [Spanned<DeValue<'t>>]>> {
        let Some(value) = self.get(key) else { return Ok(None) };
        match value.get_ref() {
            DeValue::Array(array) => Ok(Some(array)),
            other => Err(self.wrong_type(key, "a list in [ ]", other)),
        }
    }

    /// A list of finite numbers.
    pub(super) fn numbers(&self, key: &str) -> Result<Option<Vec<f64>>> {
        let Some(array) = self.array(key)? else { return Ok(None) };
        let read = |entry: &Spanned<DeValue<'_>>| {
            let read = self.value(entry)?;
            entry_of(key, read)
                .map_err(|message| self.source.error(entry.span(), message, "give numbers"))
        };
        array.iter().map(read).collect::<Result<_>>().map(Some)
    }

    /// A list of finite numbers as one row, or a list of such lists as rows.
    pub(super) fn number_rows(&self, key: &str) -> Result<Vec<Vec<f64>>> {
        let array = self.array(key)?.unwrap_or_default();
        let read = |entry: &Spanned<DeValue<'_>>| {
            let help = "give numbers, or rows of numbers";
            let read = self.value(entry)?;
            entry_of(key, read).map_err(|message| self.source.error(entry.span(), message, help))
        };
        let is_row = |entry: &Spanned<DeValue<'_>>| matches!(entry.get_ref(), DeValue::Array(_));
        if !array.iter().any(is_row) {
            return Ok(vec![array.iter().map(read).collect::<Result<_>>()?]);
        }
        let row = |entry: &'t Spanned<DeValue<'t>>| match entry.get_ref() {
            DeValue::Array(row) => row.iter().map(read).collect::<Result<_>>(),
            _ => read(entry).map(|x| vec![x]),
        };
        array.iter().map(row).collect()
    }

    /// Two numbers, which may be infinite.
    pub(super) fn two_bounds(&self, key: &str) -> Result<Option<[f64; 2]>> {
        let Some(array) = self.array(key)? else { return Ok(None) };
        let read: Vec<Option<f64>> =
            array.iter().map(|entry| self.value(entry)).collect::<Result<_>>()?;
        let read: Vec<f64> = read.into_iter().flatten().collect();
        let found = <[f64; 2]>::try_from(read).ok().filter(|_| array.len() == 2);
        let wrong = || self.refuse(key, format!("{key} is not a list of two numbers"), "give two");
        found.map(Some).ok_or_else(wrong)
    }

    /// A list of numbers, which may be infinite, and tables with these keys.
    pub(super) fn numbers_or_tables(
        &self,
        key: &str,
        what: &'static str,
        keys: &[&str],
    ) -> Result<Option<Vec<NumberOrTable<'t>>>> {
        let Some(array) = self.array(key)? else { return Ok(None) };
        let read = |entry: &'t Spanned<DeValue<'t>>| match entry.get_ref() {
            DeValue::Table(map) => {
                self.inside(what, map, entry.span(), keys).map(NumberOrTable::Table)
            }
            _ => self.value(entry)?.map(NumberOrTable::Number).ok_or_else(|| {
                let message = format!("an entry of {key} is neither a number nor a table");
                let help = format!("give numbers, or tables of {}", keys.join(", "));
                self.source.error(entry.span(), message, help)
            }),
        };
        array.iter().map(read).collect::<Result<_>>().map(Some)
    }

    /// A vector of three numbers.
    pub(super) fn vec3(&self, key: &str) -> Result<Option<Vec3>> {
        let Some(numbers) = self.numbers(key)? else { return Ok(None) };
        match numbers[..] {
            [x, y, z] => Ok(Some(Vec3::new(x, y, z))),
            _ => Err(self.count(key, "3", numbers.len())),
        }
    }

    /// A point or direction: in the plane two numbers, or three with the last one zero.
    pub(super) fn vector(&self, key: &str, planar: bool) -> Result<Option<Vec3>> {
        if !planar {
            return self.vec3(key);
        }
        let Some(numbers) = self.numbers(key)? else { return Ok(None) };
        match numbers[..] {
            [x, y] => Ok(Some(Vec3::new(x, y, 0.0))),
            [x, y, 0.0] => Ok(Some(Vec3::new(x, y, 0.0))),
            [_, _, z] => {
                let message = format!("{key} leaves the plane: its third number is {z}");
                Err(self.refuse(key, message, "with dimension = 2 it is 0 or left out"))
            }
            _ => Err(self.count(key, "2", numbers.len())),
        }
    }

    fn count(&self, key: &str, expected: &str, got: usize) -> Error {
        let message = format!("{key} in {} has {got} numbers, expected {expected}", self.what);
        self.refuse(key, message, "")
    }

    /// Two names.
    pub(super) fn pair(&self, key: &str) -> Result<[&'t str; 2]> {
        let array = self.array(key)?.ok_or_else(|| self.missing(key))?;
        let texts: Vec<&str> = array.iter().filter_map(|v| v.get_ref().as_str()).collect();
        match texts[..] {
            [a, b] if array.len() == 2 => Ok([a, b]),
            _ => Err(self.refuse(
                key,
                format!("{key} does not name two links"),
                format!("write {key} = [\"ground\", \"crank\"]"),
            )),
        }
    }

    /// A list of names.
    pub(super) fn names(&self, key: &str) -> Result<Option<Vec<&'t str>>> {
        let Some(array) = self.array(key)? else { return Ok(None) };
        let read = |entry: &'t Spanned<DeValue<'t>>| {
            entry.get_ref().as_str().ok_or_else(|| {
                let message = format!("an entry of {key} is not a name");
                self.source.error(entry.span(), message, "give texts in quotes")
            })
        };
        array.iter().map(read).collect::<Result<_>>().map(Some)
    }

    /// The numbers of a table with keys of any name, and their places; `None` if the value is no
    /// table.
    #[allow(clippy::type_complexity)]
    pub(super) fn named_numbers(
        &self,
        key: &str,
    ) -> Result<Option<Vec<(&'t str, f64, Range<usize>)>>> {
        let Some(DeValue::Table(map)) = self.get(key).map(Spanned::get_ref) else {
            return Ok(None);
        };
        let read =
            |(name, value): (&'t Spanned<DeString<'t>>, &'t Spanned<DeValue<'t>>)| match entry_of(
                key,
                self.value(value)?,
            ) {
                Ok(x) => Ok((name.get_ref().as_ref(), x, name.span())),
                Err(message) => Err(self.source.error(value.span(), message, "give numbers")),
            };
        map.iter().map(read).collect::<Result<_>>().map(Some)
    }

    /// A table inside this one.
    pub(super) fn table(
        &self,
        key: &str,
        what: &'static str,
        keys: &[&str],
    ) -> Result<Option<Self>> {
        let Some(value) = self.get(key) else { return Ok(None) };
        match value.get_ref() {
            DeValue::Table(map) => self.inside(what, map, value.span(), keys).map(Some),
            other => Err(self.wrong_type(key, "a table", other)),
        }
    }

    /// The tables of a list, `[[key]]` or `key = [{ ... }, ...]`.
    pub(super) fn tables(&self, key: &str, what: &'static str, keys: &[&str]) -> Result<Vec<Self>> {
        let read = |entry: &'t Spanned<DeValue<'t>>| match entry.get_ref() {
            DeValue::Table(map) => self.inside(what, map, entry.span(), keys),
            _ => {
                let help = format!("write {what}");
                Err(self.source.error(entry.span(), format!("an entry of {key} is no table"), help))
            }
        };
        self.array(key)?.unwrap_or(&[]).iter().map(read).collect()
    }

    /// The pose of the keys `xyz` (m) and `rpy` (rad); the identity without them.
    pub(super) fn pose(&self) -> Result<Pose> {
        let translation = self.vec3("xyz")?.unwrap_or(Vec3::ZERO);
        let [roll, pitch, yaw] = self.vec3("rpy")?.unwrap_or(Vec3::ZERO).to_array();
        Ok(Pose { rotation: Rpy { roll, pitch, yaw }.rotation(), translation })
    }

    /// The key `limits`; missing limits are infinite.
    pub(super) fn limits(&self) -> Result<Limits> {
        let keys = ["lower", "upper", "velocity", "acceleration", "jerk", "effort"];
        let Some(table) = self.table("limits", "limits", &keys)? else { return Ok(Limits::NONE) };
        let or_unlimited = |key| table.bound(key).map(|x| x.unwrap_or(f64::INFINITY));
        Ok(Limits {
            lower: table.bound("lower")?.unwrap_or(f64::NEG_INFINITY),
            upper: or_unlimited("upper")?,
            velocity: or_unlimited("velocity")?,
            acceleration: or_unlimited("acceleration")?,
            jerk: or_unlimited("jerk")?,
            effort: or_unlimited("effort")?,
        })
    }
}

/// The value as a number that is not NaN.
pub(super) fn number(value: &DeValue<'_>) -> Option<f64> {
    let x = match value {
        #[allow(clippy::cast_precision_loss)] // integers of a robot's file are small
        DeValue::Integer(i) => i64::from_str_radix(i.as_str(), i.radix()).ok()? as f64,
        DeValue::Float(f) => f.as_str().parse().ok()?,
        _ => return None,
    };
    (!f64::is_nan(x)).then_some(x)
}

fn article(type_name: &str) -> String {
    let n = if type_name.starts_with(['a', 'e', 'i', 'o', 'u']) { "n" } else { "" };
    format!("a{n} {type_name}")
}

/// A number in a list or table.
fn entry_of(key: &str, read: Option<f64>) -> std::result::Result<f64, String> {
    let Some(x) = read.filter(|x| x.is_finite()) else {
        return Err(format!("an entry of {key} is not a finite number"));
    };
    magnitude::fault(&[x]).map_or(Ok(x), |fault| Err(format!("an entry of {key} {fault}")))
}
