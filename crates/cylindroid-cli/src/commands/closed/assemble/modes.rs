//! `assemble --modes`: the ways in which the loops close.

use std::io::Write;

use cylindroid::closure::{AssemblyModes, Mode, ModeOptions, assembly_modes};
use serde::Serialize;

use super::job::{Job, open_by, q_line};
use crate::commands::closed::{ClosureErrorJson, further_modes};
use crate::commands::shared::Style;
use crate::exit::Exit;
use crate::output::{self, Align};

#[derive(Debug, Serialize)]
struct ModesJson<'a> {
    model: &'a str,
    joint_names: &'a [&'a str],
    /// True if the loops closed in one mode at least.
    closed: bool,
    /// Nearest to the guess first.
    modes: Vec<ModeJson<'a>>,
    starts: usize,
    closed_starts: usize,
    seed: u64,
    /// Degrees of freedom that the prescribed coordinates leave.
    self_motion_dof: usize,
    /// Estimated chance that another start which closes finds another mode.
    unseen_probability: f64,
    /// Of the guess itself.
    guess_closure_error: ClosureErrorJson,
    guess: &'a [f64],
    prescribed: Vec<&'a str>,
}

#[derive(Debug, Serialize)]
struct ModeJson<'a> {
    q: &'a [f64],
    /// Starts that led here.
    found: usize,
    /// From the guess [-].
    distance: f64,
    self_motion_dof: usize,
    closure_error: ClosureErrorJson,
    at_limit: Vec<&'a str>,
}

pub(super) fn run(
    job: &Job<'_>,
    options: ModeOptions,
    style: Style,
    out: &mut dyn Write,
) -> anyhow::Result<Exit> {
    let found = assembly_modes(job.mechanism, &job.guess, &job.prescribed, options)?;
    match style {
        Style::Json => output::json(out, &describe(job, options, &found))?,
        Style::Table => print(out, job, &found)?,
    }
    Ok(Exit::answer(!found.modes.is_empty()))
}

fn describe<'a>(job: &'a Job<'_>, options: ModeOptions, found: &'a AssemblyModes) -> ModesJson<'a> {
    let mode = |m: &'a Mode| ModeJson {
        q: &m.assembly.q,
        found: m.found,
        distance: m.distance,
        self_motion_dof: m.self_motion_dof,
        closure_error: m.assembly.closure_error.into(),
        at_limit: job.names_of(&m.assembly.at_limit),
    };
    ModesJson {
        model: job.mechanism.name(),
        joint_names: &job.names,
        closed: !found.modes.is_empty(),
        modes: found.modes.iter().map(mode).collect(),
        starts: found.starts,
        closed_starts: found.closed,
        seed: options.seed,
        self_motion_dof: found.self_motion_dof(),
        unseen_probability: found.unseen_probability(),
        guess_closure_error: found.first.closure_error.into(),
        guess: &job.guess,
        prescribed: job.names_of(&job.prescribed),
    }
}

fn print(out: &mut dyn Write, job: &Job<'_>, found: &AssemblyModes) -> anyhow::Result<()> {
    let (modes, closed, starts) = (found.modes.len(), found.closed, found.starts);
    let plural = if modes == 1 { "" } else { "s" };
    let result = if modes == 0 {
        format!(
            "none found: no start closed, the guess is open by {}; this does not prove that none \
             exists",
            open_by(found.first.closure_error)
        )
    } else {
        format!("{modes} mode{plural} from {closed} of {starts} starts that closed")
    };
    let more = further_modes(found.modes.iter().map(|m| m.found), found.unseen_probability());
    let self_motion_dof = match found.self_motion_dof() {
        0 => String::new(),
        n => format!(
            "{n} degree{} of freedom: such modes are continua, and each represents all that agree in \
             the landmarks at rest; prescribe more coordinates (--hold)",
            if n == 1 { "" } else { "s" }
        ),
    };
    output::pairs(
        out,
        [
            ("model", job.mechanism.name().to_owned()),
            ("result", result),
            ("further modes", more),
            ("self-motion", self_motion_dof),
            ("prescribed", job.names_of(&job.prescribed).join(", ")),
        ],
    )?;
    if found.modes.is_empty() {
        return Ok(());
    }
    writeln!(out)?;
    let columns = [
        ("mode", Align::Right),
        ("found", Align::Right),
        ("distance", Align::Right),
        ("self-motion dof", Align::Right),
    ];
    let rows = found.modes.iter().enumerate().map(|(i, m)| {
        let count = |n: usize| n.to_string();
        vec![count(i + 1), count(m.found), output::entries(&[m.distance]), count(m.self_motion_dof)]
    });
    output::table(out, &columns, rows)?;
    writeln!(out)?;
    for (i, m) in found.modes.iter().enumerate() {
        writeln!(out, "q of mode {}  {}", i + 1, q_line(&m.assembly.q))?;
    }
    Ok(())
}
