//! `zone`: the largest ball or box without singularities.

use std::io::Write;

use cylindroid::Mechanism;
use cylindroid::sweep::{Zone, ZoneBound, ZoneOptions};
use serde::Serialize;

use crate::args::ZoneArgs;
use crate::commands::shared::{Style, load, reference_or_tool};
use crate::exit::Exit;
use crate::output::{self, Align, number};

#[derive(Debug, Serialize)]
struct ZoneJson<'a> {
    model: &'a str,
    frame: &'a str,
    shape: &'static str,
    components: Vec<ComponentJson<'a>>,
    held: Vec<HeldJson<'a>>,
    /// Radius, or half the side, in multiples of the scales.
    size: f64,
    bounds: Vec<BoundJson<'a>>,
    /// Rays of the length of the size that met nothing.
    confirmed: usize,
    /// Those of steps that were short enough for the change of the Jacobians.
    certified: usize,
    q: &'a [f64],
}

#[derive(Debug, Serialize)]
struct ComponentJson<'a> {
    name: &'a str,
    unit: &'static str,
    centre: f64,
    scale: f64,
}

#[derive(Debug, Serialize)]
struct HeldJson<'a> {
    name: &'a str,
    value: f64,
}

#[derive(Debug, Serialize)]
struct BoundJson<'a> {
    kind: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    limit: Option<&'a str>,
    distance: f64,
    point: &'a [f64],
    q: &'a [f64],
}

pub(crate) fn run(args: &ZoneArgs, style: Style, out: &mut dyn Write) -> anyhow::Result<Exit> {
    let robot = load(&args.model, &args.actuated)?;
    let frame = reference_or_tool(&robot, &args.frame)?;
    let at = args.at.iter().map(|at| (at.pair().0.to_owned(), Some(at.pair().1)));
    let free = args.free.iter().map(|name| (name.clone(), None));
    let options = ZoneOptions {
        components: args.components.clone(),
        scales: args.scales.as_ref().map_or_else(Vec::new, |list| list.0.clone()),
        shape: args.shape.shape(),
        held: at.chain(free).collect(),
        end_effector: Some(frame),
        start: Some(args.q.configuration(&robot, args.model.srdf.as_deref(), false)?),
        limits: !args.no_limits,
        rays: args.rays,
        seed: args.seed,
    };
    let zone = Zone::of(&robot, options)?;
    let report = json(&robot, &robot.frame_of(frame.frame).name, &zone);
    match style {
        Style::Json => output::json(out, &report)?,
        Style::Table => print(out, &report)?,
    }
    Ok(Exit::SUCCESS)
}

fn json<'a>(robot: &'a Mechanism, frame: &'a str, zone: &'a Zone) -> ZoneJson<'a> {
    let bound = |bound: &'a ZoneBound| BoundJson {
        kind: bound.kind.name(),
        limit: bound.limit.as_deref(),
        distance: bound.distance,
        point: &bound.point,
        q: &bound.q,
    };
    ZoneJson {
        model: robot.name(),
        frame,
        shape: zone.shape.name(),
        components: zone
            .components
            .iter()
            .map(|c| ComponentJson {
                name: &c.name,
                unit: c.unit,
                centre: c.centre,
                scale: c.scale,
            })
            .collect(),
        held: zone.held.iter().map(|(name, value)| HeldJson { name, value: *value }).collect(),
        size: zone.size,
        bounds: zone.bounds.iter().map(bound).collect(),
        confirmed: zone.confirmed,
        certified: zone.certified,
        q: &zone.q,
    }
}

fn print(out: &mut dyn Write, report: &ZoneJson<'_>) -> anyhow::Result<()> {
    let centre: Vec<String> = report
        .components
        .iter()
        .map(|c| format!("{} = {} {}", c.name, number(c.centre), c.unit))
        .collect();
    let held: Vec<String> = report
        .held
        .iter()
        .map(|h| {
            let unit = cylindroid::sweep::Map::unit(h.name);
            format!("{} = {} {unit}", h.name, number(h.value))
        })
        .collect();
    let reaches: Vec<String> = report
        .components
        .iter()
        .map(|c| format!("{} {} {}", c.name, number(report.size * c.scale), c.unit))
        .collect();
    let what = if report.shape == "ball" { "radius along" } else { "half sides" };
    output::pairs(
        out,
        [
            ("model", report.model.to_owned()),
            ("frame", report.frame.to_owned()),
            ("shape", report.shape.to_owned()),
            ("centre", centre.join(", ")),
            ("held", held.join(", ")),
            (what, reaches.join(", ")),
            ("confirming rays", format!("{}, {} certified", report.confirmed, report.certified)),
        ],
    )?;
    if report.bounds.is_empty() {
        writeln!(out, "\nNothing was met up to this size.")?;
        return Ok(());
    }
    writeln!(out)?;
    let mut columns = vec![("bound", Align::Left), ("distance", Align::Right)];
    columns.extend(report.components.iter().map(|c| (c.name, Align::Right)));
    let rows = report.bounds.iter().map(|bound| {
        let name = bound.limit.map_or_else(|| bound.kind.to_owned(), |of| format!("limit of {of}"));
        let numbers = std::iter::once(bound.distance).chain(bound.point.iter().copied());
        std::iter::once(name).chain(numbers.map(number)).collect::<Vec<_>>()
    });
    output::table(out, &columns, rows)?;
    Ok(())
}
