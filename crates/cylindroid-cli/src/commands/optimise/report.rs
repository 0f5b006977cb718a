//! What `optimise` prints.

use std::io::Write;

use cylindroid::Mechanism;
use cylindroid::sweep::{Axis, Optimisation, Optimum};
use serde::Serialize;

use crate::args::OptimiseArgs;
use crate::output::{self, Align, number};

#[derive(Debug, Serialize)]
pub(super) struct Report<'a> {
    model: &'a str,
    frame: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    relative_to: Option<&'a str>,
    /// Of each design, in words.
    configurations: String,
    /// Parameters at each point of whose grid designs are evaluated.
    workspace: Vec<AxisJson<'a>>,
    parameters: Vec<ParameterJson<'a>>,
    objectives: Vec<ObjectiveJson<'a>>,
    designs: Vec<DesignJson<'a>>,
    refinements: Vec<RefinementJson<'a>>,
    evaluated: u64,
    invalid: u64,
    without_index: u64,
    /// Of the first design that is invalid or without an index.
    reason: Option<&'a str>,
    seconds: f64,
    #[serde(skip)]
    samples: u64,
}

#[derive(Debug, Serialize)]
struct AxisJson<'a> {
    name: &'a str,
    from: f64,
    to: f64,
    count: u64,
}

#[derive(Debug, Serialize)]
struct ParameterJson<'a> {
    name: &'a str,
    unit: &'a str,
    from: f64,
    to: f64,
}

#[derive(Debug, Serialize)]
struct ObjectiveJson<'a> {
    index: &'a str,
    statistic: &'static str,
    sense: &'static str,
    unit: &'a str,
}

#[derive(Debug, Serialize)]
struct DesignJson<'a> {
    values: &'a [f64],
    indices: &'a [f64],
    refined: bool,
}

#[derive(Debug, Serialize)]
struct RefinementJson<'a> {
    start: &'a [f64],
    values: &'a [f64],
    indices: &'a [f64],
    evaluated: u64,
    converged: bool,
}

impl<'a> Report<'a> {
    pub(super) fn of(
        robot: &'a Mechanism,
        (args, search, found): (&'a OptimiseArgs, &'a Optimisation, &'a Optimum),
        configurations: String,
        workspace: &'a [Axis],
        seconds: f64,
    ) -> Self {
        let axis = |axis: &'a Axis| AxisJson {
            name: &axis.name,
            from: axis.from,
            to: axis.to,
            count: axis.count,
        };
        let parameters = found.parameters.iter().zip(&args.vary).map(|((name, unit), range)| {
            ParameterJson { name, unit, from: range.0.from, to: range.0.to }
        });
        let objectives =
            found.objectives.iter().zip(search.units()).map(|(objective, unit)| ObjectiveJson {
                index: &objective.index,
                statistic: objective.statistic.name(),
                sense: objective.sense.name(),
                unit,
            });
        let designs = found.designs.iter().map(|design| DesignJson {
            values: &design.values,
            indices: &design.indices,
            refined: design.refined,
        });
        let refinements = found.refinements.iter().map(|refinement| RefinementJson {
            start: &refinement.start,
            values: &refinement.values,
            indices: &refinement.indices,
            evaluated: refinement.evaluated,
            converged: refinement.converged,
        });
        Self {
            model: robot.name(),
            frame: &robot.frame_of(search.end_effector().frame).name,
            relative_to: args.relative_to.as_deref(),
            configurations,
            workspace: workspace.iter().map(axis).collect(),
            parameters: parameters.collect(),
            objectives: objectives.collect(),
            designs: designs.collect(),
            refinements: refinements.collect(),
            evaluated: found.evaluated,
            invalid: found.invalid,
            without_index: found.without_index,
            reason: found.reason.as_deref(),
            seconds,
            samples: args.designs.0,
        }
    }

    pub(super) fn print(&self, out: &mut dyn Write) -> anyhow::Result<()> {
        let some = |count: u64| if count == 0 { String::new() } else { count.to_string() };
        let workspace = self.workspace.iter().map(|axis| {
            format!("{} {} to {} in {}", axis.name, number(axis.from), number(axis.to), axis.count)
        });
        let parameters = self.parameters.iter().map(|parameter| {
            let ParameterJson { name, unit, from, to } = parameter;
            format!("{name} {} to {} {unit}", number(*from), number(*to)).trim_end().to_owned()
        });
        let objectives = self.objectives.iter().map(|objective| {
            let ObjectiveJson { index, statistic, sense, .. } = objective;
            format!("{sense} the {statistic} {index}")
        });
        let counts = format!(
            "{} sampled, {} refined, {} evaluated",
            self.samples,
            self.refinements.len(),
            self.evaluated
        );
        output::pairs(
            out,
            [
                ("model", self.model.to_owned()),
                ("configurations", self.configurations.clone()),
                ("workspace", workspace.collect::<Vec<_>>().join("; ")),
                ("frame", self.frame.to_owned()),
                ("relative to", self.relative_to.unwrap_or_default().to_owned()),
                ("parameters", parameters.collect::<Vec<_>>().join(", ")),
                ("objectives", objectives.collect::<Vec<_>>().join(", ")),
                ("designs", counts),
                ("without a mechanism", some(self.invalid)),
                ("without an index", some(self.without_index)),
                ("reason of the first", self.reason.unwrap_or_default().to_owned()),
            ],
        )?;
        if self.designs.is_empty() {
            writeln!(out, "\nNo design has the indices.")?;
            return Ok(());
        }
        let several = self.objectives.len() > 1;
        let first = if several { "Pareto front" } else { "best design" };
        let with_unit = |name: String, unit: &str| match unit {
            "" | "1" => name,
            unit => format!("{name} [{unit}]"),
        };
        let names = self.parameters.iter().map(|p| with_unit(p.name.to_owned(), p.unit));
        let indices = self
            .objectives
            .iter()
            .map(|o| with_unit(format!("{}:{}", o.index, o.statistic), o.unit));
        let numbers: Vec<String> = names.chain(indices).collect();
        let titles = |first: &'a str, last: &[&'a str]| {
            let own: Vec<String> = std::iter::once(first.to_owned())
                .chain(numbers.iter().cloned())
                .chain(last.iter().map(|title| (*title).to_owned()))
                .collect();
            own
        };
        let print = |out: &mut dyn Write, titles: &[String], rows: Vec<Vec<String>>| {
            let aligned: Vec<(&str, Align)> = titles
                .iter()
                .enumerate()
                .map(|(i, title)| (title.as_str(), if i == 0 { Align::Left } else { Align::Right }))
                .collect();
            output::table(out, &aligned, rows)
        };
        let row = |i: usize, values: &[f64], indices: &[f64]| {
            let numbers = values.iter().chain(indices).map(|x| number(*x));
            std::iter::once((i + 1).to_string()).chain(numbers).collect::<Vec<_>>()
        };
        writeln!(out)?;
        let rows = self.designs.iter().enumerate().map(|(i, design)| {
            let mut row = row(i, design.values, design.indices);
            row.push(if design.refined { "refined" } else { "sampled" }.to_owned());
            row
        });
        print(out, &titles(first, &["origin"]), rows.collect())?;
        if self.refinements.is_empty() {
            return Ok(());
        }
        writeln!(out)?;
        let rows = self.refinements.iter().enumerate().map(|(i, refinement)| {
            let mut row = row(i, refinement.values, refinement.indices);
            row.push(refinement.evaluated.to_string());
            row.push(if refinement.converged { "yes" } else { "no" }.to_owned());
            row
        });
        print(out, &titles("refinement", &["evaluated", "converged"]), rows.collect())?;
        Ok(())
    }
}
