//! `assemble`: closes the loops of a mechanism from a guess.

use std::io::Write;
use std::process::ExitCode;

use cylindroid::Error;
use cylindroid::closure::{Assembly, assemble};
use cylindroid::model::Mechanism;
use serde::Serialize;

use super::GapJson;
use crate::args::AssembleArgs;
use crate::commands::{Style, configuration};
use crate::output::{self, Align, number};

#[derive(Debug, Serialize)]
struct AssembleJson<'a> {
    model: &'a str,
    joint_names: Vec<&'a str>,
    /// True if all loops and contacts are closed.
    closed: bool,
    q: &'a [f64],
    gap: GapJson,
    steps: usize,
    guess: &'a [f64],
    held: &'a [String],
    /// Coordinates that stand at a position limit.
    at_limit: Vec<&'a str>,
}

/// Exit code of loops that do not close.
const NOT_CLOSED: u8 = 1;

pub(crate) fn run(
    args: &AssembleArgs,
    style: Style,
    out: &mut dyn Write,
) -> anyhow::Result<ExitCode> {
    let mechanism = cylindroid::load(&args.posture.model)?;
    let guess = configuration(&mechanism, &args.posture)?;
    let names = output::joint_names(&mechanism);
    let held = args
        .hold
        .iter()
        .map(|name| {
            let place = names.iter().position(|n| n == name);
            place.ok_or_else(|| Error::unknown("coordinate", name, &names))
        })
        .collect::<Result<Vec<usize>, Error>>()?;
    let found = assemble(&mechanism, &guess, &held)?;
    let at_limit = found.at_limit.iter().map(|&i| names[i]).collect();
    let report = AssembleJson {
        model: mechanism.name(),
        joint_names: names.clone(),
        closed: found.closed,
        q: &found.q,
        gap: found.gap.into(),
        steps: found.steps,
        guess: &guess,
        held: &args.hold,
        at_limit,
    };
    match style {
        Style::Json => output::json(out, &report)?,
        Style::Table => print(out, &mechanism, &found, &report)?,
    }
    Ok(if found.closed { ExitCode::SUCCESS } else { ExitCode::from(NOT_CLOSED) })
}

fn print(
    out: &mut dyn Write,
    mechanism: &Mechanism,
    found: &Assembly,
    report: &AssembleJson<'_>,
) -> anyhow::Result<()> {
    let (loops, contacts) = (mechanism.loops().len(), mechanism.contacts().len());
    let gap = format!("{} m, {} rad", number(found.gap.distance), number(found.gap.angle));
    let result = if found.closed {
        format!("closed: {loops} loops and {contacts} contacts to {gap}")
    } else {
        format!(
            "not closed: open by {gap} where the search ended; try another guess (--q), or hold \
             fewer coordinates (--hold); that none was found proves nothing"
        )
    };
    output::pairs(
        out,
        [
            ("model", report.model.to_owned()),
            ("result", result),
            ("steps", found.steps.to_string()),
            ("held", report.held.join(", ")),
            ("at a limit", report.at_limit.join(", ")),
            ("q", found.q.iter().map(f64::to_string).collect::<Vec<_>>().join(",")),
        ],
    )?;
    writeln!(out)?;
    let columns =
        [("coordinate", Align::Left), ("guess", Align::Right), ("assembled", Align::Right)];
    let cell = |x: f64| output::entries(&[x]);
    let rows = report
        .joint_names
        .iter()
        .zip(report.guess.iter().zip(report.q))
        .map(|(name, (guess, q))| vec![(*name).to_owned(), cell(*guess), cell(*q)]);
    Ok(output::table(out, &columns, rows)?)
}
