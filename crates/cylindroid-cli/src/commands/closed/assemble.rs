//! `assemble`: closes the loops of a mechanism from a guess, looks for all ways to close them, and
//! moves coordinates while they stay closed.

mod continuation;
mod job;
mod modes;

use std::io::Write;

use cylindroid::Error;
use cylindroid::closure::{Assembly, ModeOptions, assemble};
use cylindroid::model::Mechanism;
use serde::Serialize;

use self::job::{Job, open_by, q_line};
use super::ClosureErrorJson;
use crate::args::AssembleArgs;
use crate::commands::shared::{Style, configuration, load};
use crate::exit::Exit;
use crate::output::{self, Align};
use crate::values::Joints;

#[derive(Debug, Serialize)]
struct AssembleJson<'a> {
    model: &'a str,
    joint_names: Vec<&'a str>,
    /// True if all loops and contacts are closed.
    closed: bool,
    q: &'a [f64],
    closure_error: ClosureErrorJson,
    steps: usize,
    guess: &'a [f64],
    prescribed: Vec<&'a str>,
    /// Coordinates at a position limit, or beyond it where a guess that is closed was kept.
    at_limit: Vec<&'a str>,
}

pub(crate) fn run(args: &AssembleArgs, style: Style, out: &mut dyn Write) -> anyhow::Result<Exit> {
    let mechanism = load(&args.configuration.model, &[])?;
    let job = Job {
        names: output::joint_names(&mechanism),
        guess: configuration(&mechanism, &args.configuration)?,
        prescribed: prescribed(&mechanism, &args.hold)?,
        mechanism: &mechanism,
    };
    if let Some(starts) = args.modes {
        return modes::run(&job, ModeOptions { starts, seed: args.seed }, style, out);
    }
    if let Some(to) = &args.to {
        let goal = goal(&job, to, args.configuration.degrees)?;
        return continuation::run(&job, &goal, args.least_distance, style, out);
    }
    let found = assemble(&mechanism, &job.guess, &job.prescribed)?;
    let report = AssembleJson {
        model: mechanism.name(),
        joint_names: job.names.clone(),
        closed: found.closed,
        q: &found.q,
        closure_error: found.closure_error.into(),
        steps: found.steps,
        guess: &job.guess,
        prescribed: job.names_of(&job.prescribed),
        at_limit: job.names_of(&found.at_limit),
    };
    match style {
        Style::Json => output::json(out, &report)?,
        Style::Table => print(out, &mechanism, &found, &report)?,
    }
    Ok(Exit::answer(found.closed))
}

/// The places of coordinates by their names, by those of their joints, or `actuated`.
fn prescribed(mechanism: &Mechanism, names: &[String]) -> Result<Vec<usize>, Error> {
    let coordinates = mechanism.coordinates();
    let mut prescribed: Vec<usize> = Vec::new();
    for name in names {
        let joint = mechanism.joints().iter().find(|j| j.name == *name && j.mimic.is_none());
        let places: Vec<usize> = if let Some(i) = coordinates.iter().position(|c| c.name == *name) {
            vec![i]
        } else if let Some(joint) = joint.filter(|j| !j.coordinates.is_empty()) {
            joint.coordinates.clone().collect()
        } else if name == ACTUATED {
            mechanism.actuated().collect()
        } else {
            let known = coordinates.iter().map(|c| c.name.as_str()).chain([ACTUATED]);
            return Err(Error::unknown("coordinate", name, known));
        };
        prescribed.extend(places);
    }
    prescribed.sort_unstable();
    prescribed.dedup();
    Ok(prescribed)
}

/// All that are actuated, where a name is expected.
const ACTUATED: &str = "actuated";

/// The way of `--to`: the named coordinates to their values, those of `--hold` at rest.
fn goal(job: &Job<'_>, to: &Joints, degrees: bool) -> Result<continuation::Goal, Error> {
    let Joints::Some(pairs) = to else {
        return Err(Error::InvalidOption {
            option: "--to",
            value: "a list".to_owned(),
            reason: format!("name the coordinates that go: --to {}=0.5", job.names.join("=0.5,")),
        });
    };
    // What is not named stays as guessed.
    let target = to.configuration(job.mechanism, None, degrees)?;
    job.mechanism.check_q("--to", &target)?;
    let mut goal = continuation::Goal { places: Vec::new(), values: Vec::new() };
    for (name, _) in pairs {
        let place = job.names.iter().position(|n| n == name);
        let place = place.ok_or_else(|| Error::unknown("joint", name, &job.names))?;
        goal.places.push(place);
        goal.values.push(target[place]);
    }
    for &place in job.prescribed.iter().filter(|i| !goal.places.contains(i)).collect::<Vec<_>>() {
        goal.places.push(place);
        goal.values.push(job.guess[place]);
    }
    Ok(goal)
}

fn print(
    out: &mut dyn Write,
    mechanism: &Mechanism,
    found: &Assembly,
    report: &AssembleJson<'_>,
) -> anyhow::Result<()> {
    let (loops, contacts) = (mechanism.loops().len(), mechanism.contacts().len());
    let closure_error = open_by(found.closure_error);
    let result = if found.closed {
        let s = |n: usize| if n == 1 { "" } else { "s" };
        format!(
            "closed: {loops} loop{} and {contacts} contact{} to {closure_error}",
            s(loops),
            s(contacts)
        )
    } else {
        format!(
            "not closed: open by {closure_error} at the last step; try another guess (--q), or prescribe \
             fewer coordinates (--hold); this does not prove that no assembly exists"
        )
    };
    output::pairs(
        out,
        [
            ("model", report.model.to_owned()),
            ("result", result),
            ("steps", found.steps.to_string()),
            ("prescribed", report.prescribed.join(", ")),
            ("at or beyond a limit", report.at_limit.join(", ")),
            ("q", q_line(&found.q)),
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
