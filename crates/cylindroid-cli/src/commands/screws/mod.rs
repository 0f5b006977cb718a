//! `screws`: the screw system of the joint twists and its hyperbolic inverses.

pub(crate) mod basis_screws;
mod find;
mod hyperbolic;
mod involution;
mod joint_metric;
mod report;
mod tables;
mod twists;

use std::io::Write;

use cylindroid::{EndEffector, State};
use serde_json::value::RawValue;

use self::find::find;
use self::twists::Twists;
use crate::args::ScrewsArgs;
use crate::commands::shared::Style;
use crate::exit::Exit;
use crate::plot;

pub(crate) fn run(args: &ScrewsArgs, style: Style, out: &mut dyn Write) -> anyhow::Result<Exit> {
    if let Some(path) = &args.plot {
        plot::check(path)?;
    }
    if let Some(twist) = &args.twist {
        cylindroid::Error::check_finite("--twist", &twist.0)?;
    }
    for h in &args.h {
        if h.is_nan() {
            return Err(cylindroid::Error::NotFinite { what: "--h".into(), value: *h }.into());
        }
    }
    let found = find(Twists::read(args)?, args)?;
    if let Some(path) = &args.plot {
        let matrix = found.twists.matrix();
        let twists = (found.twists.names.as_slice(), &matrix);
        plot::screws::draw(&found.twists.title(), twists, &found.system, path)?;
    }
    report::write(&found, style, out)?;
    Ok(Exit::SUCCESS)
}

/// The object of `--json` for a mechanism; `args` contains all other options.
pub(crate) fn report(
    state: &State,
    of: EndEffector,
    args: &ScrewsArgs,
) -> anyhow::Result<Box<RawValue>> {
    report::raw(&find(Twists::of(state, of)?, args)?)
}
