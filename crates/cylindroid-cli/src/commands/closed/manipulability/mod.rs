//! `manipulability`: efficiencies of motion and force, indices, polytopes, gradients.

mod configurations;
mod drawn;
mod find;
mod report;

use std::io::Write;

use serde_json::value::RawValue;

use self::find::find;
use super::{Posed, measured};
use crate::args::ManipulabilityArgs;
use crate::commands::shared::Style;
use crate::exit::Exit;
use crate::plot;

pub(crate) fn run(
    args: &ManipulabilityArgs,
    style: Style,
    out: &mut dyn Write,
) -> anyhow::Result<Exit> {
    if let Some(path) = &args.configurations {
        return configurations::run(path, args, style, out);
    }
    if let Some(path) = &args.plot {
        plot::check(path)?;
    }
    let mut found = find(Posed::new(&args.closed)?, args)?;
    if let Some(path) = &args.plot {
        let planes = drawn::planes(&found, args)?;
        let drawing = plot::ellipses::Drawing {
            state: &found.posed.state()?,
            chain: &found.posed.chain,
            components: &found.components,
            task: found.task,
            metric: found.metric,
            view: args.view.view(),
            planes: &planes,
        };
        plot::ellipses::draw(&drawing, path)?;
        found.drawn = Some((args.view.view(), planes));
    }
    report::write(&found, style, out)?;
    Ok(Exit::SUCCESS)
}

/// The object of `--json`; `args` say everything but the configuration.
pub(crate) fn report(posed: Posed, args: &ManipulabilityArgs) -> anyhow::Result<Box<RawValue>> {
    report::raw(&find(posed, args)?)
}
