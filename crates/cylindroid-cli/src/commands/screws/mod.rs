//! `screws`: what the joint twists span and what can be done with it.

pub(crate) mod report;
mod twists;

use std::io::Write;
use std::process::ExitCode;

use cylindroid::inverse::{PointDirection, point_direction};
use cylindroid::screws::{Involution, Line, Screw, ScrewOptions, ScrewSystem, involution};
use cylindroid::{EndEffector, Result, State, Vec3};
use serde_json::value::RawValue;

use self::twists::Twists;
use crate::args::ScrewsArgs;
use crate::commands::shared::Style;
use crate::plot;

/// The twists and what was found.
#[derive(Debug)]
struct Found {
    twists: Twists,
    system: ScrewSystem,
    screws: Vec<Option<Screw>>,
    /// Of the twists that are lines, where at least two are.
    involution: Option<Involution>,
    /// The rates that move the point along the direction, where both were given.
    point: Option<PointDirection>,
}

pub(crate) fn run(
    args: &ScrewsArgs,
    style: Style,
    out: &mut dyn Write,
) -> anyhow::Result<ExitCode> {
    if let Some(path) = &args.plot {
        plot::check(path)?;
    }
    for h in &args.h {
        if h.is_nan() {
            return Err(cylindroid::Error::NotFinite { what: "--h".into(), value: *h }.into());
        }
    }
    let found = find(Twists::read(args)?, args)?;
    if let Some(path) = &args.plot {
        plot::screws::draw(&found.twists.title(), &found.twists.matrix(), &found.system, path)?;
    }
    report::write(&found, &args.h, style, out)?;
    Ok(ExitCode::SUCCESS)
}

/// The object of `--json` for a mechanism; `args` say everything but which and where.
pub(crate) fn report(
    state: &State,
    of: EndEffector,
    args: &ScrewsArgs,
) -> anyhow::Result<Box<RawValue>> {
    report::raw(&find(Twists::of(state, of), args)?, &args.h)
}

fn find(twists: Twists, args: &ScrewsArgs) -> Result<Found> {
    let options = ScrewOptions {
        length: args.length.unwrap_or(twists.length),
        center: args.center.map(|c| Vec3::from_array(c.0)),
        noise: args.noise.unwrap_or(ScrewOptions::default().noise),
    };
    let system = ScrewSystem::of(&twists.twists, &options)?;
    let screws: Vec<Option<Screw>> = twists.twists.iter().map(|t| Screw::of(*t)).collect();
    let lines = lines(&screws, &system);
    let involution = if lines.len() < 2 { None } else { Some(involution(&lines, &options)?) };
    let point = match (args.point, args.direction) {
        (Some(point), Some(direction)) => Some(point_direction(
            &twists.matrix(),
            Vec3::from_array(point.0),
            Vec3::from_array(direction.0),
        )?),
        _ => None,
    };
    Ok(Found { twists, system, screws, involution, point })
}

/// The axes of the screws of pitch zero, to the tolerance of the system.
fn lines(screws: &[Option<Screw>], system: &ScrewSystem) -> Vec<Line> {
    let is_line = |s: &&Screw| s.pitch.abs() <= system.tolerance() * system.length();
    screws.iter().flatten().filter(is_line).map(|s| s.axis).collect()
}
