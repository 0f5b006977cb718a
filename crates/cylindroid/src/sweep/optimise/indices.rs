//! The numbers of a design that objectives name: statistics of columns over its configurations.
//!
//! Formula  smallest, mean or largest over all configurations, at all points of the workspace; costs
//!          are those to be minimised and the negatives of the others
//! Units    those of the columns
//! Valid    a design has an index if it has a mechanism at each point of the workspace and the column
//!          is finite in each row; poses must be reached, and the rows of a closed chain closed.
//!          Otherwise it is refused, with the reason. Where `reached` or `closed` is an objective
//!          itself, other indices are those of the rows in which it is 1, one at least
//! Why so   a mean or a smallest value over the configurations that happen to have one would prefer
//!          designs that lose the others, and counts of rows without a configuration are zeros that
//!          mean nothing. An objective states the share that is reached and weighs it
//! Checked  tests/sweep/optimise.rs::indices_are_those_of_the_sweep,
//!          tests/sweep/optimise.rs::designs_without_an_index_are_told,
//!          tests/sweep/optimise.rs::rows_without_a_configuration_are_no_zeros

use super::super::axis::Axis;
use super::super::capability;
use super::super::designs::{DesignSpace, Designs, ParameterRange};
use super::super::job::Sweep;
use super::super::options::SweepOptions;
use super::super::quantity::Quantity;
use super::super::source::{REACHED, Source};
use super::super::table::{Column, ColumnKind, Values};
use super::options::{DesignObjective, OptimisationOptions, Sense, Statistic};
use crate::closure::ParametricModel;
use crate::error::{Error, Result, all_finite};
use crate::kinematics::EndEffector;
use crate::model::Mechanism;

/// Rows computed at once.
const ROWS: u64 = 1 << 14;

/// Why a design has no indices.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Refusal {
    /// It has no mechanism.
    Invalid(String),
    /// A number is not finite, or a loop is open.
    WithoutIndex(String),
}

/// Computes the indices of designs.
#[derive(Debug, Clone)]
pub(super) struct Indices {
    designs: Designs,
    /// The parameters that vary, by name.
    pub(super) ranges: Vec<ParameterRange>,
    workspace: Option<DesignSpace>,
    points: u64,
    /// By name, so that the order of the options changes nothing.
    pub(super) objectives: Vec<DesignObjective>,
    /// The columns of the objectives.
    places: Vec<usize>,
    presence: Option<Presence>,
    pub(super) end_effector: EndEffector,
}

/// The column that says whether a row has a configuration: that poses are reached, otherwise that
/// loops are closed.
#[derive(Debug, Clone, Copy)]
struct Presence {
    place: usize,
    /// True if it is an objective, so that rows without a configuration are left out of the others.
    is_objective: bool,
}

/// What a column has had so far.
#[derive(Debug, Clone, Copy)]
struct Gathered {
    smallest: f64,
    sum: f64,
    largest: f64,
    count: u64,
}

impl Indices {
    pub(super) fn new(model: &ParametricModel, options: &OptimisationOptions) -> Result<Self> {
        options.check()?;
        let nominal = model.nominal();
        let mut ranges = options.ranges.clone();
        ranges.sort_by(|a, b| a.name.cmp(&b.name));
        for range in &ranges {
            if range.from > range.to {
                return Err(Error::InvalidOption {
                    option: "vary",
                    value: format!("{} = {}:{}", range.name, range.from, range.to),
                    reason: "the smallest value comes first".to_owned(),
                });
            }
        }
        let mut objectives = options.objectives.clone();
        objectives.sort();
        let of_poses = matches!(options.sweep.source, Source::Poses { .. });
        let mut quantities: Vec<Quantity> = Vec::new();
        for objective in &objectives {
            quantities.extend(quantity_of(nominal, of_poses, &objective.index)?);
        }
        if nominal.is_closed() {
            quantities.push(Quantity::Measures);
        }
        quantities.sort();
        quantities.dedup();
        let sweep = SweepOptions { quantities, ..options.sweep.clone() };
        let space = DesignSpace::Samples {
            ranges: ranges.clone(),
            count: options.designs,
            seed: options.seed,
        };
        let swept = Sweep::of_designs(model, space, sweep)?;
        let end_effector = swept.end_effector();
        let Some(designs) = swept.designs else {
            return Err(Error::unknown("parameter", "", [""]));
        };
        let place = |name: &str| designs.own_columns.iter().position(|c| c.name == name);
        let places = objectives.iter().map(|o| {
            let names = designs.own_columns.iter().skip(1).map(|c| &c.name);
            place(&o.index).ok_or_else(|| Error::unknown("index", &o.index, names))
        });
        let places = places.collect::<Result<Vec<_>>>()?;
        let presence =
            if of_poses { Some(REACHED) } else { nominal.is_closed().then_some("closed") };
        let presence = presence
            .and_then(place)
            .map(|place| Presence { place, is_objective: places.contains(&place) });
        let grid = |axes: &Vec<Axis>| DesignSpace::Grid(axes.clone());
        let workspace = Some(&options.workspace).filter(|axes| !axes.is_empty()).map(grid);
        let points = workspace.as_ref().map_or(Ok(1), |grid| grid.checked_count(model))?;
        Ok(Self { designs, ranges, workspace, points, objectives, places, presence, end_effector })
    }

    /// Number of sampled designs.
    pub(super) fn samples(&self) -> u64 {
        self.designs.count
    }

    /// Number of configurations of each design.
    pub(super) const fn configurations(&self) -> u64 {
        self.designs.each
    }

    /// The unit of an objective.
    pub(super) fn unit(&self, objective: usize) -> &str {
        &self.designs.own_columns[self.places[objective]].unit
    }

    /// The place of a sampled design in the unit cube of the ranges.
    pub(super) fn sample(&self, design: u64) -> Vec<f64> {
        let values = self.designs.space.values(design);
        let share = |(x, range): (&f64, &ParameterRange)| {
            let width = range.to - range.from;
            if width > 0.0 { ((x - range.from) / width).max(0.0).min(1.0) } else { 0.0 }
        };
        values.iter().zip(&self.ranges).map(share).collect()
    }

    /// The values of the parameters at a place in the unit cube.
    pub(super) fn values(&self, x: &[f64]) -> Vec<f64> {
        let value = |(x, range): (&f64, &ParameterRange)| {
            let own = range.from + x * (range.to - range.from);
            // Rounding must not leave the range.
            own.max(range.from).min(range.to)
        };
        x.iter().zip(&self.ranges).map(value).collect()
    }

    /// The costs of a design.
    pub(super) fn costs(&self, values: &[f64]) -> std::result::Result<Vec<f64>, Refusal> {
        let found = self.indices(values)?;
        let signed = |(x, objective): (f64, &DesignObjective)| match objective.sense {
            Sense::Minimise => x,
            Sense::Maximise => -x,
        };
        Ok(found.into_iter().zip(&self.objectives).map(signed).collect())
    }

    /// The indices of a design, in the order of the objectives.
    fn indices(&self, values: &[f64]) -> std::result::Result<Vec<f64>, Refusal> {
        let begin =
            Gathered { smallest: f64::INFINITY, sum: 0.0, largest: f64::NEG_INFINITY, count: 0 };
        let mut gathered = vec![begin; self.places.len()];
        for point in 0..self.points {
            self.at_point(values, point, &mut gathered)?;
        }
        let index = |(all, objective): (&Gathered, &DesignObjective)| match objective.statistic {
            Statistic::Smallest => all.smallest,
            Statistic::Mean => all.sum / all.count as f64,
            Statistic::Largest => all.largest,
        };
        let found: Vec<f64> = gathered.iter().zip(&self.objectives).map(index).collect();
        if all_finite(&found) {
            return Ok(found);
        }
        if gathered.iter().any(|all| all.count == 0) {
            let reason = "no configuration is reached or closed".to_owned();
            return Err(Refusal::WithoutIndex(reason));
        }
        // Sums overflow only for numbers that no mechanism has.
        Err(Refusal::WithoutIndex("an index overflows".to_owned()))
    }

    /// Why a row has no index, and the way to designs that have it.
    fn absent(&self, row: u64) -> String {
        let (what, name) = match self.designs.options.source {
            Source::Poses { .. } => (format!("pose {row} is not reached"), REACHED),
            Source::Samples { .. } => {
                (format!("no straight path of the drives reaches configuration {row}"), "closed")
            }
            _ => (format!("the loops of configuration {row} are open"), "closed"),
        };
        format!("{what}; with {name}:mean as an index too, others are those of the rest")
    }

    fn at_point(
        &self,
        values: &[f64],
        point: u64,
        gathered: &mut [Gathered],
    ) -> std::result::Result<(), Refusal> {
        let mut pairs: Vec<(&str, f64)> =
            self.ranges.iter().map(|r| r.name.as_str()).zip(values.iter().copied()).collect();
        let mut place = String::new();
        if let Some(workspace) = &self.workspace {
            let own: Vec<(&str, f64)> =
                workspace.names().into_iter().zip(workspace.values(point)).collect();
            let shown: Vec<String> = own.iter().map(|(name, x)| format!("{name} = {x}")).collect();
            place = format!("at {}: ", shown.join(", "));
            pairs.extend(own);
        }
        let invalid = |error: Error| Refusal::Invalid(format!("{place}{error}"));
        let without = |reason: String| Refusal::WithoutIndex(format!("{place}{reason}"));
        let (configurations, evaluator) = self.designs.prepared(&pairs).map_err(invalid)?;
        let columns = &self.designs.own_columns;
        let (mut start, mut rows) = (0, Vec::new());
        while start < configurations.rows {
            let end = configurations.rows.min(start + ROWS);
            capability::run(&evaluator, &configurations, columns, start..end, &mut rows)
                .map_err(|error| without(error.to_string()))?;
            let present = self.presence.and_then(|own| match rows.get(own.place) {
                Some(Values::Counts(present)) => Some((own, present)),
                _ => None,
            });
            if let Some((own, present)) = present
                && let (false, Some(row)) =
                    (own.is_objective, present.iter().position(|present| *present == 0))
            {
                return Err(without(self.absent(start + row as u64)));
            }
            for (all, place) in gathered.iter_mut().zip(&self.places) {
                let counts = |row: usize| match present {
                    Some((own, present)) => own.place == *place || present[row] == 1,
                    None => true,
                };
                let bad = match rows.get(*place) {
                    Some(Values::Numbers(numbers)) => all.add(numbers.iter().copied(), counts),
                    Some(Values::Counts(all_counts)) => {
                        all.add(all_counts.iter().map(|c| *c as f64), counts)
                    }
                    _ => None,
                };
                if let Some((row, x)) = bad {
                    let (name, row) = (&columns[*place].name, start + row as u64);
                    let reason = format!("{name} of configuration {row} is not finite: {x}");
                    return Err(without(reason));
                }
            }
            start = end;
        }
        Ok(())
    }
}

impl Gathered {
    /// Adds numbers of rows that count, up to the first that is not finite, which is returned with its
    /// place.
    fn add(
        &mut self,
        numbers: impl Iterator<Item = f64>,
        counts: impl Fn(usize) -> bool,
    ) -> Option<(usize, f64)> {
        for (row, x) in numbers.enumerate().filter(|(row, _)| counts(*row)) {
            if !x.is_finite() {
                return Some((row, x));
            }
            self.smallest = self.smallest.min(x);
            self.largest = self.largest.max(x);
            self.sum += x;
            self.count += 1;
        }
        None
    }
}

/// The quantity that has a column; none has that of poses that are reached.
fn quantity_of(nominal: &Mechanism, of_poses: bool, index: &str) -> Result<Option<Quantity>> {
    if of_poses && index == REACHED {
        return Ok(None);
    }
    let possible = Quantity::ALL
        .into_iter()
        .filter(|q| *q != Quantity::ObstacleDistance && (!nominal.is_closed() || q.has_loops()));
    // More singular values than there are have no column in the end.
    let columns = |q: Quantity| q.columns(nominal, 6, false);
    let mut names: Vec<String> = Vec::new();
    for quantity in possible {
        for Column { name, kind, .. } in columns(quantity) {
            if kind != ColumnKind::Text {
                if name == index {
                    return Ok(Some(quantity));
                }
                names.push(name);
            }
        }
    }
    names.extend(of_poses.then(|| REACHED.to_owned()));
    Err(Error::unknown("index", index, names))
}
