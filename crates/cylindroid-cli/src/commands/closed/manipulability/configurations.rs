//! `manipulability --configurations`: the numbers of many configurations.

use std::io::Write;
use std::path::Path;

use cylindroid::Error;
use cylindroid::manipulability::{BatchOptions, ManipulabilityBatch};
use serde::Serialize;

use super::super::measured::Task;
use super::super::{Posed, measured};
use crate::args::{ManipulabilityArgs, MetricName};
use crate::commands::shared::Style;
use crate::exit::Exit;
use crate::number_file;
use crate::output::{self, Align, number};
use crate::values::Weights;

#[derive(Debug, Serialize)]
struct ConfigurationsJson<'a> {
    model: &'a str,
    /// The reference.
    frame: &'a str,
    actuated: &'a [String],
    passive: &'a [String],
    /// Characteristic length [m].
    length: f64,
    metric: &'static str,
    /// Names of the components of the twist, or of the task, that are measured.
    components: &'a [String],
    /// Metrics given in place of a part of it.
    own_metrics: Vec<&'static str>,
    /// Names of the numbers of a row.
    columns: [&'static str; ManipulabilityBatch::WIDTH],
    /// A row for each configuration; null is infinite, or nothing to measure.
    rows: Vec<&'a [f64]>,
}

pub(super) fn run(
    path: &Path,
    args: &ManipulabilityArgs,
    style: Style,
    out: &mut dyn Write,
) -> anyhow::Result<Exit> {
    if args.metric == MetricName::Inertia {
        return Err(Error::InvalidOption {
            option: "--metric",
            value: "inertia".to_owned(),
            reason:
                "it is another one in every configuration; use unit, length or limits, or give \
                     --wu, for --configurations"
                    .to_owned(),
        }
        .into());
    }
    if args.wq == Some(Weights::Inertia) {
        return Err(Error::InvalidOption {
            option: "--wq",
            value: "inertia".to_owned(),
            reason: "it is another one in every configuration; give weights for --configurations"
                .to_owned(),
        }
        .into());
    }
    let posed = Posed::new(&args.closed)?;
    let (mechanism, chain) = (&posed.mechanism, &posed.chain);
    let names: Vec<&str> = mechanism.coordinates().iter().map(|c| c.name.as_str()).collect();
    let q = number_file::configurations(path, &names)?;
    let task = Task::new(&posed, args)?;
    let metrics = measured::metrics(&posed, args, task.as_ref())?;
    let (components, task) = match task {
        Some(task) => (task.names, Some(task.map)),
        None => (posed.components().iter().map(|c| (*c).to_owned()).collect(), None),
    };
    let is_task = task.is_some();
    let options = BatchOptions {
        reference: Some(chain.reference),
        length: Some(chain.constraint.length()),
        metrics,
        task,
        generic: None,
    };
    let numbers = ManipulabilityBatch::new(mechanism, &options)?.analyse(&q)?;
    let rows: Vec<&[f64]> = numbers.chunks(ManipulabilityBatch::WIDTH).collect();
    if style == Style::Table {
        print(out, &posed, (args.metric, is_task.then_some(&components)), &rows)?;
        return Ok(Exit::SUCCESS);
    }
    let own = [("wu", args.wu.is_some()), ("wq", args.wq.is_some())];
    let report = ConfigurationsJson {
        model: mechanism.name(),
        frame: posed.frame(),
        actuated: &chain.actuated,
        passive: &chain.passive,
        length: chain.constraint.length(),
        metric: args.metric.name(),
        components: &components,
        own_metrics: own.into_iter().filter(|o| o.1).map(|o| o.0).collect(),
        columns: ManipulabilityBatch::COLUMNS,
        rows,
    };
    output::json(out, &report)?;
    Ok(Exit::SUCCESS)
}

/// Numbers that are the same everywhere once, the others in a table.
fn print(
    out: &mut dyn Write,
    posed: &Posed,
    (metric, task): (MetricName, Option<&Vec<String>>),
    rows: &[&[f64]],
) -> anyhow::Result<()> {
    let changes = |i: &usize| rows.iter().any(|row| row[*i].to_bits() != rows[0][*i].to_bits());
    let (changing, still): (Vec<usize>, Vec<usize>) =
        (0..ManipulabilityBatch::WIDTH).partition(changes);
    let same = still.iter().filter_map(|&i| {
        let first = rows.first()?;
        Some(format!("{} {}", ManipulabilityBatch::COLUMNS[i], number(first[i])))
    });
    output::pairs(
        out,
        [
            ("model", posed.mechanism.name().to_owned()),
            ("reference frame", posed.frame().to_owned()),
            ("actuated", super::super::list(&posed.chain.actuated)),
            ("configurations", rows.len().to_string()),
            ("metric", metric.name().to_owned()),
            ("task", task.map_or_else(String::new, |task| task.join(", "))),
            ("the same in all", same.collect::<Vec<_>>().join(", ")),
        ],
    )?;
    if changing.is_empty() {
        return Ok(());
    }
    writeln!(out)?;
    let mut columns = vec![("", Align::Right)];
    columns.extend(changing.iter().map(|&i| (ManipulabilityBatch::COLUMNS[i], Align::Right)));
    let lines = rows.iter().enumerate().map(|(k, row)| {
        let numbers = changing.iter().map(|&i| number(row[i]));
        std::iter::once((k + 1).to_string()).chain(numbers).collect()
    });
    Ok(output::table(out, &columns, lines)?)
}
