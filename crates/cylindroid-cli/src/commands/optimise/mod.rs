//! `optimise`: designs with the best indices, and trade-offs.

mod report;

use std::io::Write;
use std::time::Instant;

use cylindroid::control::Task;
use cylindroid::sweep::{DesignObjective, Optimisation, OptimisationOptions, Sense, SweepOptions};

use self::report::Report;
use crate::args::OptimiseArgs;
use crate::commands::configurations::Chosen;
use crate::commands::interrupt::Interrupt;
use crate::commands::progress::{Bar, interrupted};
use crate::commands::shared::{Style, check_varied, end_effector, load, parametric};
use crate::exit::Exit;
use crate::output;

pub(crate) fn run(args: &OptimiseArgs, style: Style, out: &mut dyn Write) -> anyhow::Result<Exit> {
    let robot = load(&args.model, &[])?;
    let model = parametric(&args.model)?;
    let chosen = Chosen::from(args);
    let source = chosen.source(&robot)?;
    let workspace = chosen.parameters(&robot)?;
    let varied = args.vary.iter().map(|range| &range.0.name);
    let varied = varied.chain(workspace.iter().map(|axis| &axis.name));
    check_varied(&args.model, varied)?;
    let named = args.frame.frame.is_some() || args.frame.tool.is_some();
    let frame = if named { Some(end_effector(&robot, &args.frame)?) } else { None };
    let base = args.relative_to.as_deref();
    let task = args.task.as_deref().map(|name| Task::named(name, &robot)).transpose()?;
    let of = |names: &[String], sense: Sense| {
        let own = names.iter().map(|name| DesignObjective::named(name, sense));
        own.collect::<Result<Vec<_>, _>>()
    };
    let objectives =
        [of(&args.minimise, Sense::Minimise)?, of(&args.maximise, Sense::Maximise)?].concat();
    let options = OptimisationOptions {
        ranges: args.vary.iter().map(|range| range.0.clone()).collect(),
        objectives,
        workspace: workspace.clone(),
        designs: args.designs.0,
        starts: usize::try_from(args.starts.0).unwrap_or(usize::MAX),
        evaluations: args.evaluations.0,
        seed: args.seed,
        sweep: SweepOptions {
            source: source.clone(),
            end_effector: frame,
            relative_to: base.map(|name| robot.frame(name)).transpose()?,
            task,
            metric: args.metric.metric(),
            length: args.length,
            ..SweepOptions::default()
        },
    };
    let search = Optimisation::new(&model, options)?;
    let interrupt = Interrupt::new();
    let started = Instant::now();
    let bar = Bar::new();
    let found = search.run(args.threads, |progress| {
        bar.show(progress);
        !interrupt.came()
    });
    drop(bar);
    let Some(found) = found? else { return interrupted() };
    let configurations = chosen.words(&source, search.configurations());
    let seconds = started.elapsed().as_secs_f64();
    let report = Report::of(&robot, (args, &search, &found), configurations, &workspace, seconds);
    match style {
        Style::Json => output::json(out, &report)?,
        Style::Table => report.print(out)?,
    }
    Ok(Exit::answer(!found.designs.is_empty()))
}
