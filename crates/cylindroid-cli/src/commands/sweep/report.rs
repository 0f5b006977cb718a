//! What `sweep` prints.

use std::io::Write;
use std::path::Path;

use cylindroid::Mechanism;
use cylindroid::sweep::{Column, Source, Statistics, Summary, Sweep};
use serde::Serialize;

use crate::args::SweepArgs;
use crate::commands::configurations::Chosen;
use crate::output::{self, Align, number};

/// What is swept.
#[derive(Debug, Serialize)]
pub(super) struct Head<'a> {
    model: &'a str,
    frame: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    relative_to: Option<&'a str>,
    rows: u64,
    /// In words.
    configurations: String,
    quantities: Vec<&'static str>,
    task: Vec<&'static str>,
    /// True if it was asked for.
    #[serde(skip)]
    task_named: bool,
    metric: &'static str,
}

impl<'a> Head<'a> {
    pub(super) fn of(
        robot: &'a Mechanism,
        sweep: &Sweep,
        source: &Source,
        args: &SweepArgs,
    ) -> Self {
        let all = sweep.rows();
        let rows = all / sweep.designs().unwrap_or(1).max(1);
        let of_map = sweep.voxels().map(|grid| Source::Voxels(grid.clone()));
        let configurations = Chosen::from(args).words(of_map.as_ref().unwrap_or(source), rows);
        let configurations = match sweep.designs() {
            None => configurations,
            Some(designs) => format!("{configurations} of {designs} designs"),
        };
        Self {
            model: robot.name(),
            frame: &robot.frame_of(sweep.end_effector().frame).name,
            relative_to: sweep.relative_to().map(|base| robot.frame_of(base).name.as_str()),
            rows: all,
            configurations,
            quantities: sweep.quantities().iter().map(|q| q.name()).collect(),
            task: sweep.task(),
            task_named: args.task.is_some(),
            metric: args.metric.metric().name(),
        }
    }
}

/// What was done.
pub(super) enum Outcome<'a> {
    Statistics(Vec<(Column, Statistics)>),
    File { path: &'a Path, bytes: u64 },
    Folder { folder: &'a Path, summary: Summary },
}

#[derive(Debug, Serialize)]
pub(super) struct Json<'a> {
    #[serde(flatten)]
    head: &'a Head<'a>,
    seconds: f64,
    rows_per_second: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    columns: Option<Vec<ColumnJson<'a>>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    out: Option<OutJson>,
}

#[derive(Debug, Serialize)]
struct ColumnJson<'a> {
    name: &'a str,
    unit: &'a str,
    description: &'a str,
    smallest: Option<f64>,
    mean: Option<f64>,
    largest: Option<f64>,
    not_finite: Option<u64>,
    names: Option<Vec<NameJson<'a>>>,
}

#[derive(Debug, Serialize)]
struct NameJson<'a> {
    name: &'a str,
    count: u64,
}

#[derive(Debug, Serialize)]
struct OutJson {
    path: String,
    bytes: u64,
    parts: Option<usize>,
    /// Rows of this run.
    computed: u64,
    complete: bool,
}

impl Outcome<'_> {
    pub(super) fn complete(&self) -> bool {
        match self {
            Self::Folder { summary, .. } => summary.complete,
            _ => true,
        }
    }

    fn out(&self, rows: u64) -> Option<OutJson> {
        match self {
            Self::Statistics(_) => None,
            Self::File { path, bytes } => Some(OutJson {
                path: path.display().to_string(),
                bytes: *bytes,
                parts: None,
                computed: rows,
                complete: true,
            }),
            Self::Folder { folder, summary } => Some(OutJson {
                path: folder.display().to_string(),
                bytes: summary.bytes,
                parts: Some(summary.parts),
                computed: summary.computed,
                complete: summary.complete,
            }),
        }
    }

    pub(super) fn json<'a>(&'a self, head: &'a Head<'a>, seconds: f64) -> Json<'a> {
        let columns = match self {
            Self::Statistics(columns) => Some(columns.iter().map(column_json).collect()),
            _ => None,
        };
        let out = self.out(head.rows);
        let computed = out.as_ref().map_or(head.rows, |out| out.computed);
        Json { head, seconds, rows_per_second: computed as f64 / seconds, columns, out }
    }

    pub(super) fn print(&self, head: &Head<'_>, out: &mut dyn Write) -> anyhow::Result<()> {
        let written = self.out(head.rows);
        let mut lines = vec![
            ("model", head.model.to_owned()),
            ("configurations", head.configurations.clone()),
            ("frame", head.frame.to_owned()),
            ("relative to", head.relative_to.unwrap_or_default().to_owned()),
            ("quantities", head.quantities.join(", ")),
            ("task", if head.task_named { head.task.join(", ") } else { String::new() }),
            ("metric", if head.metric == "unit" { "" } else { head.metric }.to_owned()),
        ];
        if let Some(written) = written {
            let size = format!("{} MB", number(written.bytes as f64 * 1e-6));
            lines.push(("out", written.path));
            lines.push(("size", size));
            if let Some(parts) = written.parts {
                lines.push(("finished parts", parts.to_string()));
                lines.push(("rows of this run", written.computed.to_string()));
            }
            if !written.complete {
                lines.push(("interrupted", "--resume continues".to_owned()));
            }
        }
        output::pairs(out, lines)?;
        let Self::Statistics(columns) = self else { return Ok(()) };
        writeln!(out)?;
        let titles = [
            ("column", Align::Left),
            ("unit", Align::Left),
            ("smallest", Align::Right),
            ("mean", Align::Right),
            ("largest", Align::Right),
            ("not finite", Align::Right),
        ];
        // NaN where no entry is finite, which the last column says.
        let of_finite = |x: f64| if x.is_nan() { String::new() } else { number(x) };
        let rows = columns.iter().filter_map(|(column, statistics)| match statistics {
            Statistics::Numbers { smallest, mean, largest, not_finite } => Some(vec![
                column.name.clone(),
                column.unit.to_string(),
                of_finite(*smallest),
                of_finite(*mean),
                of_finite(*largest),
                if *not_finite == 0 { String::new() } else { not_finite.to_string() },
            ]),
            _ => None,
        });
        output::table(out, &titles, rows.collect::<Vec<_>>())?;
        for (column, statistics) in columns {
            let Statistics::Texts(names) = statistics else { continue };
            writeln!(out)?;
            let titles = [(column.name.as_str(), Align::Left), ("configurations", Align::Right)];
            let rows = names.iter().map(|(name, n)| vec![(*name).to_owned(), n.to_string()]);
            output::table(out, &titles, rows)?;
        }
        Ok(())
    }
}

fn column_json((column, statistics): &(Column, Statistics)) -> ColumnJson<'_> {
    let mut json = ColumnJson {
        name: &column.name,
        unit: &column.unit,
        description: column.description,
        smallest: None,
        mean: None,
        largest: None,
        not_finite: None,
        names: None,
    };
    match statistics {
        Statistics::Numbers { smallest, mean, largest, not_finite } => {
            (json.smallest, json.mean, json.largest) =
                (Some(*smallest), Some(*mean), Some(*largest));
            json.not_finite = Some(*not_finite);
        }
        Statistics::Texts(names) => {
            let name = |(name, count): &(&'static str, u64)| NameJson { name, count: *count };
            json.names = Some(names.iter().map(name).collect());
        }
        _ => {}
    }
    json
}
