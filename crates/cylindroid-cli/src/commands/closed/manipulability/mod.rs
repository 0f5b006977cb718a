//! `manipulability`: efficiencies of motion and force, indices, polytopes, gradients.

mod configurations;
mod find;
mod report;

use std::io::Write;
use std::process::ExitCode;

use serde_json::value::RawValue;

use self::find::find;
use super::Posed;
use super::measured::{self, Quantity};
use crate::args::ManipulabilityArgs;
use crate::commands::shared::Style;
use crate::plot;

pub(crate) fn run(
    args: &ManipulabilityArgs,
    style: Style,
    out: &mut dyn Write,
) -> anyhow::Result<ExitCode> {
    if let Some(path) = &args.configurations {
        return configurations::run(path, args, style, out);
    }
    if let Some(path) = &args.plot {
        plot::check(path)?;
    }
    let found = find(Posed::new(&args.closed)?, args)?;
    if let Some(path) = &args.plot {
        let [rates, torques] = [Quantity::Rate, Quantity::Torque];
        let drawing = plot::ellipses::Drawing {
            state: &found.posed.state()?,
            chain: &found.posed.chain,
            metrics: &measured::metrics(&found.posed, args, None)?,
            metric: found.metric,
            velocity_limits: rates.limits(&found.posed, args).ok(),
            torque_limits: torques.limits(&found.posed, args).ok(),
        };
        plot::ellipses::draw(&drawing, path)?;
    }
    report::write(&found, style, out)?;
    Ok(ExitCode::SUCCESS)
}

/// The object of `--json`; `args` say everything but the configuration.
pub(crate) fn report(posed: Posed, args: &ManipulabilityArgs) -> anyhow::Result<Box<RawValue>> {
    report::raw(&find(posed, args)?)
}
