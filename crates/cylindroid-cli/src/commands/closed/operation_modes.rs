//! `mobility --modes`: the operation modes of a mechanism, and where they meet.

use std::io::Write;

use cylindroid::closure::{
    ModeMeeting, ModeOptions, OperationMode, OperationModes, operation_modes,
};
use serde::Serialize;

use super::singularity::CountsJson;
use super::{Posed, further_modes};
use crate::commands::shared::Style;
use crate::exit::Exit;
use crate::output::{self, Align};

#[derive(Debug, Serialize)]
struct OperationModesJson<'a> {
    model: &'a str,
    frame: &'a str,
    q: &'a [f64],
    actuated: &'a [String],
    /// Those of largest dimension first.
    modes: Vec<OperationModeJson<'a>>,
    meetings: Vec<MeetingJson<'a>>,
    starts: usize,
    closed_starts: usize,
    /// Starts whose mode could not be decided.
    undecided: usize,
    seed: u64,
    /// Estimated chance that another start which closes finds another mode.
    unseen_probability: f64,
}

#[derive(Debug, Serialize)]
struct OperationModeJson<'a> {
    dimension: usize,
    /// To first order, at its configurations.
    dof: usize,
    generic: CountsJson,
    /// Of the motions of the reference frame.
    order: usize,
    class: &'static str,
    /// A configuration of it.
    q: &'a [f64],
    /// Starts that led here.
    found: usize,
    /// True if the given configuration lies on it.
    through: bool,
}

#[derive(Debug, Serialize)]
struct MeetingJson<'a> {
    q: &'a [f64],
    /// A mode for each branch, counted from 0.
    modes: &'a [usize],
    dof: usize,
    counts: CountsJson,
    /// Other configurations in which the same modes meet.
    others: &'a [Vec<f64>],
}

pub(super) fn run(
    posed: &Posed,
    options: ModeOptions,
    style: Style,
    out: &mut dyn Write,
) -> anyhow::Result<Exit> {
    let reference = Some(posed.chain.reference);
    let found = operation_modes(&posed.mechanism, &posed.q, reference, options)?;
    match style {
        Style::Json => output::json(out, &describe(posed, options, &found))?,
        Style::Table => print(out, posed, &found)?,
    }
    Ok(Exit::answer(!found.modes.is_empty()))
}

fn describe<'a>(
    posed: &'a Posed,
    options: ModeOptions,
    found: &'a OperationModes,
) -> OperationModesJson<'a> {
    let mode = |m: &'a OperationMode| OperationModeJson {
        dimension: m.dimension,
        dof: m.dof,
        generic: m.counts.into(),
        order: m.order,
        class: m.class.name(),
        q: &m.configuration,
        found: m.found,
        through: m.through,
    };
    let meeting = |m: &'a ModeMeeting| MeetingJson {
        q: &m.configuration,
        modes: &m.modes,
        dof: m.dof,
        counts: m.counts.into(),
        others: &m.others,
    };
    OperationModesJson {
        model: posed.mechanism.name(),
        frame: posed.frame(),
        q: &posed.q,
        actuated: &posed.chain.actuated,
        modes: found.modes.iter().map(mode).collect(),
        meetings: found.meetings.iter().map(meeting).collect(),
        starts: found.starts,
        closed_starts: found.closed,
        undecided: found.undecided,
        seed: options.seed,
        unseen_probability: found.unseen_probability(),
    }
}

fn print(out: &mut dyn Write, posed: &Posed, found: &OperationModes) -> anyhow::Result<()> {
    let (modes, closed, starts) = (found.modes.len(), found.closed, found.starts);
    let plural = if modes == 1 { "" } else { "s" };
    let result = if modes == 0 {
        format!("none found: {closed} of {starts} starts closed")
    } else {
        format!("{modes} operation mode{plural} from {closed} of {starts} starts that closed")
    };
    let more = further_modes(found.modes.iter().map(|m| m.found), found.unseen_probability());
    let undecided = match found.undecided {
        0 => String::new(),
        n => format!("{n} starts, which closed at or near a singular configuration"),
    };
    let mut lines = vec![
        ("model", posed.mechanism.name().to_owned()),
        ("reference frame", posed.frame().to_owned()),
        ("result", result),
        ("further modes", more),
        ("undecided", undecided),
    ];
    let names = |indices: &[usize]| {
        indices.iter().map(|i| (i + 1).to_string()).collect::<Vec<_>>().join(", ")
    };
    for meeting in &found.meetings {
        let others = match meeting.others.len() {
            0 => String::new(),
            1 => " and another configuration".to_owned(),
            n => format!(" and {n} other configurations"),
        };
        let mut modes = meeting.modes.clone();
        modes.sort_unstable();
        let gains: Vec<String> = modes
            .chunk_by(|a, b| a == b)
            .map(|m| {
                format!(
                    "{} more than on mode {}",
                    meeting.dof.saturating_sub(found.modes[m[0]].dof),
                    m[0] + 1
                )
            })
            .collect();
        lines.push((
            "branches meet",
            format!(
                "of mode{} {}, at {}{others}: {} degrees of freedom to first order, {}",
                if modes.len() == 1 { "" } else { "s" },
                names(&modes),
                super::q_in_words(&meeting.configuration),
                meeting.dof,
                gains.join(", ")
            ),
        ));
    }
    output::pairs(out, lines)?;
    if found.modes.is_empty() {
        return Ok(());
    }
    writeln!(out)?;
    let columns = [
        ("mode", Align::Right),
        ("dof", Align::Right),
        ("idle", Align::Right),
        ("redundancy", Align::Right),
        ("indeterminacy", Align::Right),
        ("zero_torque", Align::Right),
        ("found", Align::Right),
        ("here", Align::Left),
        ("motions of the frame", Align::Left),
    ];
    let rows = found.modes.iter().enumerate().map(|(i, m)| {
        let c = &m.counts;
        let dof = if m.dof == m.dimension {
            m.dimension.to_string()
        } else {
            format!("{} of {}", m.dimension, m.dof)
        };
        let mut row = vec![(i + 1).to_string(), dof];
        let counts = [c.idle, c.redundancy, c.indeterminacy, c.zero_torque, m.found];
        row.extend(counts.map(|n| n.to_string()));
        row.push(if m.through { "yes" } else { "" }.to_owned());
        row.push(format!("{}-system {}", m.order, m.class));
        row
    });
    output::table(out, &columns, rows)?;
    writeln!(out)?;
    for (i, m) in found.modes.iter().enumerate() {
        let exact = |x: &f64| output::without_rounding(*x).to_string();
        let q: Vec<String> = m.configuration.iter().map(exact).collect();
        writeln!(out, "q of mode {}  {}", i + 1, q.join(","))?;
    }
    Ok(())
}
