//! `map`: workspace and singularity loci in the coordinates of the platform.

mod file;
mod mesh;
mod report;

use std::io::Write;

use cylindroid::sweep::{Axis, LocusKind, Map, MapOptions};

use self::report::{MapJson, RegionJson, report};
use crate::args::MapArgs;
use crate::commands::interrupt::Interrupt;
use crate::commands::progress::{Bar, interrupted};
use crate::commands::shared::{Style, load, reference_or_tool};
use crate::exit::Exit;
use crate::output::{self, Align, number};
use crate::plot;

pub(crate) fn run(args: &MapArgs, style: Style, out: &mut dyn Write) -> anyhow::Result<Exit> {
    let robot = load(&args.model, &args.actuated)?;
    if let Some(path) = &args.plot {
        plot::check(path)?;
        plot::map::check(args.over.len())?;
    }
    if let Some(path) = &args.out {
        file::check(path)?;
    }
    let axes: Vec<Axis> = args.over.iter().map(|axis| axis.0.clone()).collect();
    if let Some(path) = &args.mesh {
        mesh::check(path, &axes)?;
    }
    let frame = reference_or_tool(&robot, &args.frame)?;
    let at = args.at.iter().map(|at| (at.pair().0.to_owned(), Some(at.pair().1)));
    let free = args.free.iter().map(|name| (name.clone(), None));
    let options = MapOptions {
        axes,
        held: at.chain(free).collect(),
        end_effector: Some(frame),
        start: Some(args.q.configuration(&robot, args.model.srdf.as_deref(), false)?),
        starts: args.starts,
        seed: args.seed,
        loci: !args.no_loci,
    };
    let interrupt = Interrupt::new();
    let bar = Bar::new();
    let found = Map::run(&robot, options, args.threads, |progress| {
        bar.show(progress);
        !interrupt.came()
    });
    drop(bar);
    let Some(map) = found? else { return interrupted() };
    let report = report(
        &robot,
        &map,
        (&robot.frame_of(frame.frame).name, frame.frame_from_tool.translation.to_array()),
    )?;
    if interrupt.came() {
        return interrupted();
    }
    // Before any file.
    if let Some(path) = &args.mesh {
        mesh::check_map(&map, path)?;
    }
    if let Some(path) = &args.out {
        file::write(&robot, &map, &report, path)?;
    }
    if let Some(path) = &args.mesh {
        mesh::write(&robot, &map, path)?;
    }
    if interrupt.came() {
        return interrupted();
    }
    if let Some(path) = &args.plot {
        plot::map::draw(&map, &format!("{}: workspace of {}", robot.name(), report.frame), path)?;
    }
    match style {
        Style::Json => output::json(out, &report)?,
        Style::Table => print(out, &report)?,
    }
    Ok(Exit::answer(!map.modes.is_empty()))
}

fn print(out: &mut dyn Write, report: &MapJson<'_>) -> anyhow::Result<()> {
    let axes = report.axes.iter().map(|a| {
        format!("{} from {} to {} {} in {}", a.name, number(a.from), number(a.to), a.unit, a.count)
    });
    let held = report
        .held
        .iter()
        .map(|h| format!("{} = {} {}", h.name, number(h.value), Map::unit(h.name)));
    let held = if report.held.is_empty() {
        "nothing".to_owned()
    } else {
        held.collect::<Vec<_>>().join(", ")
    };
    let free = match report.free_motions {
        0 => "none".to_owned(),
        count => format!(
            "{count}: working modes are not distinguished, and there are no curves; hold components \
             with --at"
        ),
    };
    output::pairs(
        out,
        [
            ("model", report.model.to_owned()),
            ("frame", report.frame.to_owned()),
            ("axes", axes.collect::<Vec<_>>().join("; ")),
            ("held", held),
            ("free motions", free),
            ("working modes", report.modes.len().to_string()),
        ],
    )?;
    if report.modes.is_empty() {
        writeln!(out, "\nNo configuration was found in the cells; --q starts elsewhere.")?;
        return Ok(());
    }
    writeln!(out)?;
    let size = format!("size [{}]", report.size_unit);
    let columns = [
        ("mode", Align::Left),
        ("cells", Align::Right),
        ("of all [%]", Align::Right),
        (&size, Align::Right),
        ("holes", Align::Right),
        ("least type I [-]", Align::Right),
        ("least type II [-]", Align::Right),
    ];
    let of_region = |name: String, region: &RegionJson, least: [String; 2]| {
        let share = 100.0 * region.cells as f64 / report.cells as f64;
        let cells = [region.cells.to_string(), number(share), number(region.size)];
        let holes = region.holes.len().to_string();
        [name].into_iter().chain(cells).chain([holes]).chain(least).collect::<Vec<_>>()
    };
    let mut rows: Vec<_> = report
        .modes
        .iter()
        .enumerate()
        .map(|(i, mode)| {
            let least = [mode.least_type_one, mode.least_type_two].map(number);
            of_region((i + 1).to_string(), &mode.region, least)
        })
        .collect();
    if report.modes.len() > 1 {
        rows.push(of_region("any".to_owned(), &report.workspace, Default::default()));
    }
    output::table(out, &columns, rows)?;
    if report.workspace.is_cut {
        writeln!(
            out,
            "\nThe workspace ends at the border of the grid, beyond which it may go on."
        )?;
    }
    for hole in &report.workspace.holes {
        let center: Vec<String> = hole.center.iter().map(|x| number(*x)).collect();
        writeln!(
            out,
            "\nA hole of {} {} about ({}), {} cells.",
            number(hole.size),
            report.size_unit,
            center.join(", "),
            hole.cells
        )?;
    }
    print_surfaces(out, report)?;
    if report.loci.is_empty() {
        return Ok(());
    }
    writeln!(out)?;
    let columns = [
        ("curves", Align::Left),
        ("modes", Align::Left),
        ("closed", Align::Right),
        ("open", Align::Right),
        ("points", Align::Right),
    ];
    let mut rows: Vec<(String, String, [usize; 3])> = Vec::new();
    for kind in LocusKind::ALL {
        for locus in report.loci.iter().filter(|l| l.kind == kind.name()) {
            let name =
                locus.limit.map_or_else(|| locus.kind.to_owned(), |of| format!("limit of {of}"));
            let modes: Vec<String> = locus.modes.iter().map(|m| (m + 1).to_string()).collect();
            let modes = modes.join(", ");
            let same = |row: &&mut (String, String, [usize; 3])| row.0 == name && row.1 == modes;
            let counts =
                [usize::from(locus.closed), usize::from(!locus.closed), locus.points.len()];
            match rows.iter_mut().find(same) {
                Some(row) => row.2.iter_mut().zip(counts).for_each(|(a, b)| *a += b),
                None => rows.push((name, modes, counts)),
            }
        }
    }
    let rows = rows.into_iter().map(|(name, modes, counts)| {
        [name, modes].into_iter().chain(counts.map(|c| c.to_string())).collect::<Vec<_>>()
    });
    output::table(out, &columns, rows)?;
    Ok(())
}

/// The surfaces by their kinds and modes.
fn print_surfaces(out: &mut dyn Write, report: &MapJson<'_>) -> anyhow::Result<()> {
    if report.surfaces.is_empty() {
        return Ok(());
    }
    writeln!(out)?;
    let columns = [
        ("surfaces", Align::Left),
        ("mode", Align::Left),
        ("closed", Align::Right),
        ("open", Align::Right),
        ("vertices", Align::Right),
        ("triangles", Align::Right),
    ];
    let mut rows: Vec<((&str, usize), [usize; 4])> = Vec::new();
    for surface in &report.surfaces {
        let of = (surface.kind, surface.mode);
        let counts = [
            usize::from(surface.closed),
            usize::from(!surface.closed),
            surface.vertices.len(),
            surface.triangles.len(),
        ];
        match rows.iter_mut().find(|row| row.0 == of) {
            Some(row) => row.1.iter_mut().zip(counts).for_each(|(a, b)| *a += b),
            None => rows.push((of, counts)),
        }
    }
    let rows = rows.into_iter().map(|((kind, mode), counts)| {
        let names = [kind.to_owned(), (mode + 1).to_string()];
        names.into_iter().chain(counts.map(|c| c.to_string())).collect::<Vec<_>>()
    });
    output::table(out, &columns, rows)?;
    Ok(())
}
