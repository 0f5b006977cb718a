//! `sweep`: quantities of millions of configurations.

mod csv_file;
mod drawing;
mod report;

use std::io::Write;
use std::path::Path;
use std::time::Instant;

use cylindroid::collision::CollisionModel;
use cylindroid::control::Task;
use cylindroid::sweep::{
    Axis, DesignSpace, ParameterRange, Progress, Quantity, Source, Sweep, SweepOptions,
    WriteOptions,
};
use cylindroid::{Error, Mechanism, Vec3};

use self::report::{Head, Outcome};
use crate::args::SweepArgs;
use crate::commands::configurations::Chosen;
use crate::commands::distance::collision_model;
use crate::commands::interrupt::Interrupt;
use crate::commands::progress::{Bar, interrupted};
use crate::commands::shared::{Style, check_varied, end_effector, load, parametric};
use crate::exit::Exit;
use crate::output;
use crate::plot;

pub(crate) fn run(args: &SweepArgs, style: Style, out: &mut dyn Write) -> anyhow::Result<Exit> {
    let robot = load(&args.model, &[])?;
    check_options_of_maps(args)?;
    let chosen = Chosen::from(args);
    let source = chosen.source(&robot)?;
    let parameters = chosen.parameters(&robot)?;
    let varied = args.vary.iter().map(|range| &range.0.name);
    let varied = varied.chain(parameters.iter().map(|axis| &axis.name));
    check_varied(&args.model, varied)?;
    let space = designs(parameters.clone(), args)?;
    let named = args.frame.frame.is_some() || args.frame.tool.is_some();
    let frame = if named { Some(end_effector(&robot, &args.frame)?) } else { None };
    let base = args.relative_to.as_deref();
    let is_map = matches!(source, Source::Voxels(_));
    let quantities = if args.quantities.is_empty() {
        if is_map { Vec::new() } else { Quantity::usual(&robot).to_vec() }
    } else {
        args.quantities.iter().map(|name| Quantity::named(name)).collect::<Result<_, _>>()?
    };
    let task = args.task.as_deref().map(|name| Task::named(name, &robot)).transpose()?;
    let collision = collision(&robot, args, &quantities, space.is_some())?;
    let part_rows = Sweep::usual_part_rows(&robot, &source, space.is_some());
    let options = SweepOptions {
        source: source.clone(),
        quantities,
        columns: Vec::new(),
        end_effector: frame,
        relative_to: base.map(|name| robot.frame(name)).transpose()?,
        task,
        metric: args.metric.metric(),
        length: args.length,
        direction: args
            .direction
            .map_or(SweepOptions::default().direction, |d| Vec3::from_array(d.0)),
        collision,
        part_rows: args.part_rows.map_or(part_rows, |count| count.0),
    };
    let sweep = match space {
        None => Sweep::new(&robot, options)?,
        Some(space) => Sweep::of_designs(&parametric(&args.model)?, space, options)?,
    };
    if let Some(path) = args.out.as_deref().filter(|path| is_csv(path)) {
        if args.resume {
            return Err(Error::InvalidOption {
                option: "--resume",
                value: path.display().to_string(),
                reason: "a .csv file is written as a whole; name a folder".to_owned(),
            }
            .into());
        }
        csv_file::check(&sweep, path)?;
    }
    let picture = match &args.plot {
        None => None,
        Some(path) => {
            plot::check(path)?;
            let axes = (&source, &parameters[..]);
            Some((plot::sweep::plan(&robot, &sweep, axes, args.color.as_deref())?, path))
        }
    };
    let head = Head::of(&robot, &sweep, &source, args);
    let interrupt = Interrupt::new();
    let started = Instant::now();
    let bar = Bar::new();
    let observe = |progress: &Progress| {
        bar.show(progress);
        !interrupt.came()
    };
    // Rows that are drawn too are computed once, and those that take long by all threads.
    let is_slow = match &source {
        Source::Voxels(_) | Source::Poses { .. } => true,
        Source::Samples { .. } => robot.is_closed(),
        _ => false,
    };
    let is_folder = args.out.as_deref().is_some_and(|path| !is_csv(path));
    let is_drawn = picture.as_ref().is_some_and(|(picture, _)| picture.is_of_all());
    let collected =
        !is_folder && (is_drawn || is_slow && (args.out.is_some() || picture.is_some()));
    let table = match collected {
        true => match sweep.collect(args.threads, observe)? {
            Some(table) => Some(table),
            None => return interrupted(),
        },
        false => None,
    };
    let outcome = match &args.out {
        None => match &table {
            Some(table) => Some(Outcome::Statistics(sweep.statistics_of(table))),
            None => sweep.statistics(args.threads, observe)?.map(Outcome::Statistics),
        },
        Some(path) if is_csv(path) => {
            let written = csv_file::write(&sweep, table.as_ref(), path, observe)?;
            written.map(|bytes| Outcome::File { path, bytes })
        }
        Some(folder) => {
            let options = WriteOptions { threads: args.threads, resume: args.resume };
            let summary = sweep.write(folder, &options, observe)?;
            Some(Outcome::Folder { folder, summary })
        }
    };
    drop(bar);
    let seconds = started.elapsed().as_secs_f64();
    let Some(outcome) = outcome else { return interrupted() };
    if let (Some((picture, path)), true) = (picture, outcome.complete()) {
        let folder = args.out.as_deref().filter(|_| is_folder);
        picture.draw(&drawing::columns(&sweep, &picture, table.as_ref(), folder)?, path)?;
    }
    match style {
        Style::Json => output::json(out, &outcome.json(&head, seconds))?,
        Style::Table => outcome.print(&head, out)?,
    }
    Ok(if outcome.complete() { Exit::SUCCESS } else { Exit::INTERRUPTED })
}

fn is_csv(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv"))
}

/// Refuses options of capability maps without one, and rolls without directions; clap does not where
/// another source excludes maps.
fn check_options_of_maps(args: &SweepArgs) -> anyhow::Result<()> {
    let given = [
        ("--directions", args.directions.is_some()),
        ("--rolls", args.rolls.is_some()),
        ("--reach-from", args.reach_from.is_some()),
    ];
    if args.rolls.is_some() && args.directions.is_some_and(|count| count.0 == 0) {
        anyhow::bail!(
            "--rolls are rotations about --directions, of which there are none: omit one"
        );
    }
    match given.iter().find(|(_, is_given)| *is_given && args.reach.is_empty()) {
        Some((name, _)) => {
            anyhow::bail!("{name} is an option of capability maps, which --reach asks for")
        }
        None => Ok(()),
    }
}

/// The shapes of distances, if they are asked for; designs have their own.
fn collision(
    robot: &Mechanism,
    args: &SweepArgs,
    quantities: &[Quantity],
    of_designs: bool,
) -> anyhow::Result<Option<CollisionModel>> {
    let wants = |quantity| quantities.contains(&quantity);
    let given = args.meshes.is_some() || args.model.srdf.is_some();
    if !args.obstacle.is_empty() && !wants(Quantity::ObstacleDistance) {
        anyhow::bail!("--obstacle is seen by obstacle_distance alone; name it in --quantities");
    }
    let own = wants(Quantity::SelfDistance) || wants(Quantity::ObstacleDistance);
    if args.meshes.is_some() && !own {
        anyhow::bail!(
            "--meshes is seen by self_distance and obstacle_distance alone; name one in --quantities"
        );
    }
    if of_designs && own {
        if given || !args.obstacle.is_empty() {
            anyhow::bail!(
                "each design has the shapes of its own links: sweep it alone to give it --meshes, \
                 --srdf or --obstacle"
            );
        }
        return Ok(None);
    }
    let model = || collision_model(robot, &args.collision(), args.model.srdf.as_deref());
    Ok(own.then(model).transpose()?)
}

/// The designs, if parameters vary.
fn designs(parameters: Vec<Axis>, args: &SweepArgs) -> cylindroid::Result<Option<DesignSpace>> {
    let ranges: Vec<ParameterRange> = args.vary.iter().map(|range| range.0.clone()).collect();
    match (parameters.first(), args.designs) {
        (None, None) => Ok(None),
        (Some(_), None) => Ok(Some(DesignSpace::Grid(parameters))),
        (None, Some(count)) => {
            Ok(Some(DesignSpace::Samples { ranges, count: count.0, seed: args.seed }))
        }
        (Some(axis), Some(_)) => Err(Error::InvalidOption {
            option: "--over",
            value: axis.name.clone(),
            reason: "designs are a grid or samples: give parameters in --over or in --vary"
                .to_owned(),
        }),
    }
}
