//! Designs: values of parameters of a mechanism file, each swept through all configurations.
//!
//! Formula  row i is configuration i mod c of design floor(i / c), with c configurations for each
//!          design. Samples and grids lie within the limits of the design
//! Units    those of the file for parameters
//! Valid    designs that have the coordinates of the nominal one. A design without a mechanism (a
//!          value out of range, an expression that is not finite, loops that cannot be closed) has
//!          rows with `design_valid` 0 and no numbers
//! Why so   a refused design is a result of a sweep over designs, not the end of it; the error is
//!          that of loading the file with these values
//! Checked  tests/sweep/designs.rs

use std::iter::once;
use std::ops::Range;

use super::axis::{Axis, points};
use super::capability;
use super::evaluate::Evaluator;
use super::options::SweepOptions;
use super::quantity::Quantity;
use super::sobol::Sobol;
use super::source::Configurations;
use super::table::{Column, Values};
use crate::closure::ParametricModel;
use crate::collision::{CollisionModel, CollisionOptions};
use crate::error::{Error, Result};
use crate::model::{FrameId, Mechanism};
use crate::tolerance::MAX_MAGNITUDE;

/// The column of designs that have a mechanism.
pub(super) const VALID: &str = "design_valid";

/// Values of parameters.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum DesignSpace {
    /// A grid over some parameters; the last axis changes fastest.
    Grid(Vec<Axis>),
    /// Scrambled Sobol' points within ranges of some parameters.
    Samples {
        /// The parameters.
        ranges: Vec<ParameterRange>,
        /// Number of designs.
        count: u64,
        /// Selects one of the scrambled sequences.
        seed: u64,
    },
}

/// The range of a parameter, in the unit of its file.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterRange {
    /// The parameter.
    pub name: String,
    /// Smallest value.
    pub from: f64,
    /// Largest value.
    pub to: f64,
}

/// The axes of a grid by what they name.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisKinds {
    /// Those of coordinates.
    pub coordinates: Vec<Axis>,
    /// Those of parameters.
    pub parameters: Vec<Axis>,
}

impl AxisKinds {
    /// The axes of a mechanism, in their order.
    ///
    /// # Errors
    /// A name that is neither, with the nearest ones; one that is both.
    pub fn of(axes: Vec<Axis>, mechanism: &Mechanism) -> Result<Self> {
        let mut kinds = Self { coordinates: Vec::new(), parameters: Vec::new() };
        for axis in axes {
            let mut coordinates = mechanism.coordinates().iter().map(|c| &c.name);
            let mut parameters = mechanism.parameters().iter().map(|p| &p.name);
            match (coordinates.any(|n| *n == axis.name), parameters.any(|n| *n == axis.name)) {
                (true, false) => kinds.coordinates.push(axis),
                (false, true) => kinds.parameters.push(axis),
                (true, true) => return Err(both("over", &axis.name)),
                (false, false) if mechanism.parameters().is_empty() => {
                    let names = mechanism.coordinates().iter().map(|c| &c.name);
                    return Err(Error::unknown("coordinate", &axis.name, names));
                }
                (false, false) => {
                    let names = mechanism.coordinates().iter().map(|c| &c.name);
                    let all = names.chain(mechanism.parameters().iter().map(|p| &p.name));
                    return Err(Error::unknown("coordinate or parameter", &axis.name, all));
                }
            }
        }
        Ok(kinds)
    }
}

fn both(option: &'static str, name: &str) -> Error {
    let reason = "a coordinate has the name of this parameter; rename one of them".to_owned();
    Error::InvalidOption { option, value: name.to_owned(), reason }
}

impl DesignSpace {
    /// The names of the parameters.
    pub(super) fn names(&self) -> Vec<&str> {
        match self {
            Self::Grid(axes) => axes.iter().map(|a| a.name.as_str()).collect(),
            Self::Samples { ranges, .. } => ranges.iter().map(|r| r.name.as_str()).collect(),
        }
    }

    fn ends(&self) -> Vec<[f64; 2]> {
        match self {
            Self::Grid(axes) => axes.iter().map(|a| [a.from, a.to]).collect(),
            Self::Samples { ranges, .. } => ranges.iter().map(|r| [r.from, r.to]).collect(),
        }
    }

    fn option(&self) -> &'static str {
        match self {
            Self::Grid(_) => "over",
            Self::Samples { .. } => "vary",
        }
    }

    /// Number of designs.
    pub(super) fn checked_count(&self, model: &ParametricModel) -> Result<u64> {
        let option = self.option();
        let refuse = |value: &str, reason: String| {
            Err(Error::InvalidOption { option, value: value.to_owned(), reason })
        };
        let names = self.names();
        if names.is_empty() {
            return refuse("", "designs have one parameter at least".to_owned());
        }
        for (i, (name, ends)) in names.iter().zip(self.ends()).enumerate() {
            let known = model.parameters().iter().map(|p| p.name.as_str());
            let Some(parameter) = model.parameters().iter().find(|p| p.name == *name) else {
                return Err(Error::unknown("parameter", name, known));
            };
            if model.nominal().coordinates().iter().any(|c| c.name == *name) {
                return Err(both(option, name));
            }
            if names[..i].contains(name) {
                return refuse(name, "a parameter can be named only once".to_owned());
            }
            Error::check_within(name, &ends, MAX_MAGNITUDE)?;
            let (lower, upper) = (parameter.lower, parameter.upper);
            if let Some(out) = ends.iter().find(|x| !(**x >= lower && **x <= upper)) {
                return refuse(
                    &format!("{name} = {out}"),
                    format!("its range is {lower} to {upper}"),
                );
            }
        }
        match self {
            Self::Grid(axes) => points(axes),
            Self::Samples { count, .. } if *count == 0 || *count > 1 << 32 => {
                refuse(&count.to_string(), "1 to 2^32 designs are possible".to_owned())
            }
            Self::Samples { ranges, .. } if ranges.len() > Sobol::DIMENSIONS => {
                let most = Sobol::DIMENSIONS;
                refuse(&ranges.len().to_string(), format!("at most {most} parameters can vary"))
            }
            Self::Samples { count, .. } => Ok(*count),
        }
    }

    /// The values of a design, in the order of the names.
    pub(super) fn values(&self, design: u64) -> Vec<f64> {
        match self {
            Self::Grid(axes) => {
                let mut left = design;
                let mut values = vec![0.0; axes.len()];
                for (axis, value) in axes.iter().zip(&mut values).rev() {
                    *value = axis.value(left % axis.count);
                    left /= axis.count;
                }
                values
            }
            Self::Samples { ranges, seed, .. } => {
                let mut values = vec![0.0; ranges.len()];
                // Below 2^32, see `checked_count`.
                let index = u32::try_from(design).unwrap_or(u32::MAX);
                Sobol::new(ranges.len(), *seed).write(index, &mut values);
                for (x, range) in values.iter_mut().zip(ranges) {
                    *x = range.from + *x * (range.to - range.from);
                }
                values
            }
        }
    }
}

/// The designs of a sweep, checked.
#[derive(Debug, Clone)]
pub(super) struct Designs {
    pub(super) model: ParametricModel,
    pub(super) space: DesignSpace,
    pub(super) count: u64,
    pub(super) options: SweepOptions,
    /// Configurations of each design.
    pub(super) each: u64,
    /// Columns of one design.
    pub(super) own_columns: Vec<Column>,
    /// Of the nominal design: those of its pairs are watched in all designs that do not always touch,
    /// whether they come near in one of them or not.
    collision: Option<CollisionModel>,
}

impl Designs {
    /// `columns` are those of the nominal design, `each` its rows.
    pub(super) fn new(
        (model, space): (&ParametricModel, DesignSpace),
        options: SweepOptions,
        columns: Vec<Column>,
        each: u64,
    ) -> Result<Self> {
        let count = space.checked_count(model)?;
        let all = CollisionOptions { never_margin: f64::MAX, ..CollisionOptions::default() };
        let collision = options.quantities.contains(&Quantity::SelfDistance);
        let collision =
            collision.then(|| CollisionModel::new(model.nominal(), &all)).transpose()?;
        let model = model.clone();
        Ok(Self { model, space, count, options, each, own_columns: columns, collision })
    }

    /// All columns: the design and its parameters before those of the configurations.
    pub(super) fn columns(&self) -> Vec<Column> {
        let parameters = self.space.names().into_iter().map(|name| {
            let unit = self.model.parameters().iter().find(|p| p.name == name).map(|p| &p.unit);
            Column::parameter(name, unit.map_or("", |unit| unit))
        });
        let (index, rest) =
            self.own_columns.split_first().map_or((None, &[][..]), |(i, r)| (Some(i), r));
        let design = Column::count("design", "place of the design, from 0");
        let valid = Column::count(VALID, "1 if the design has a mechanism, otherwise 0");
        let own = index.cloned().into_iter().chain(once(design)).chain(once(valid));
        own.chain(parameters).chain(rest.iter().cloned()).collect()
    }

    /// What computes the rows of a design, which has these values of parameters; an error for one
    /// without a mechanism.
    pub(super) fn prepared(&self, values: &[(&str, f64)]) -> Result<(Configurations, Evaluator)> {
        let (own, nominal) = (self.model.with(values)?, self.model.nominal());
        let names =
            |m: &Mechanism| m.coordinates().iter().map(|c| c.name.clone()).collect::<Vec<_>>();
        if names(&own) != names(nominal) {
            return Err(Error::Model {
                model: own.name().to_owned(),
                culprit: String::new(),
                message: "the design has other coordinates than the file".to_owned(),
            });
        }
        let mut options = self.options.clone();
        // A reference point may coincide with a link in one design and not in another.
        let of_design = |frame: FrameId| match frame {
            frame if frame == nominal.reference() => Ok(own.reference()),
            frame if frame == nominal.tool() => Ok(own.tool()),
            frame => own.frame(&nominal.frame_of(frame).name),
        };
        if let Some(end_effector) = &mut options.end_effector {
            end_effector.frame = of_design(end_effector.frame)?;
        }
        options.relative_to = options.relative_to.map(of_design).transpose()?;
        options.collision = match &self.collision {
            Some(nominal) => Some(nominal.of_design(&own)?),
            None => None,
        };
        let configurations = Configurations::new(&own, &options.source, options.place(&own)?.0)?;
        Ok((configurations, Evaluator::new(&own, &options)?))
    }

    /// The rows, in the columns of the sweep.
    pub(super) fn run(&self, columns: &[Column], rows: Range<u64>) -> Result<Vec<Values>> {
        let mut out: Vec<Values> = columns.iter().map(Column::empty).collect();
        let mut own = Vec::new();
        let mut start = rows.start;
        while start < rows.end {
            let design = start / self.each;
            let first = design * self.each;
            let end = rows.end.min(first + self.each);
            let count = usize::try_from(end - start).unwrap_or(0);
            let values = self.space.values(design);
            let pairs: Vec<(&str, f64)> =
                self.space.names().into_iter().zip(values.iter().copied()).collect();
            let prepared = self.prepared(&pairs);
            match &prepared {
                Ok((configurations, evaluator)) => {
                    let (rows, columns) = (start - first..end - first, &self.own_columns);
                    capability::run(evaluator, configurations, columns, rows, &mut own)?;
                }
                Err(_) => own = self.own_columns.iter().map(|c| c.missing(count)).collect(),
            }
            let mut before = vec![
                Values::Counts((start..end).collect()),
                Values::Counts(vec![design; count]),
                Values::Counts(vec![u64::from(prepared.is_ok()); count]),
            ];
            before.extend(values.into_iter().map(|x| Values::Numbers(vec![x; count])));
            let all = before.into_iter().chain(own.drain(1..));
            out.iter_mut().zip(all).for_each(|(column, more)| column.append(more));
            start = end;
        }
        Ok(out)
    }
}
