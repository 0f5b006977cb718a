//! `distance`: distances between links and to obstacles.

use std::io::Write;
use std::path::Path;

use cylindroid::Mechanism;
use cylindroid::collision::{CollisionModel, CollisionOptions, NearPair};
use cylindroid::model::formats::srdf;
use serde::Serialize;

use crate::args::{CollisionArgs, DistanceArgs};
use crate::commands::shared::{Style, configuration, load};
use crate::exit::Exit;
use crate::output::{self, Align};

#[derive(Debug, Serialize)]
struct DistanceJson<'a> {
    model: &'a str,
    q: &'a [f64],
    joint_names: Vec<&'a str>,
    outside_limits: Vec<&'a str>,
    shapes: usize,
    pairs: usize,
    margin: f64,
    free: bool,
    near: Vec<NearJson<'a>>,
    ignored: Vec<IgnoredJson<'a>>,
}

#[derive(Debug, Serialize)]
struct NearJson<'a> {
    a: &'a str,
    b: &'a str,
    shape_a: &'a str,
    shape_b: &'a str,
    distance: f64,
    point_a: [f64; 3],
    point_b: [f64; 3],
    normal: [f64; 3],
    gradient: Vec<f64>,
}

#[derive(Debug, Serialize)]
struct IgnoredJson<'a> {
    what: &'a str,
    why: &'a str,
}

/// The collision model of the arguments; pairs that the SRDF disables are left out.
pub(crate) fn collision_model(
    robot: &Mechanism,
    args: &CollisionArgs,
    srdf_file: Option<&Path>,
) -> cylindroid::Result<CollisionModel> {
    let disabled = match srdf_file {
        Some(path) => srdf::load(path)?.pairs(robot),
        None => Vec::new(),
    };
    let usual = CollisionOptions::default();
    let options = CollisionOptions {
        meshes: args.meshes.map_or(usual.meshes, Into::into),
        disabled,
        samples: args.samples.unwrap_or(usual.samples),
        ..usual
    };
    let mut model = CollisionModel::new(robot, &options)?;
    for obstacle in &args.obstacle {
        model.add_obstacle(&obstacle.name, &obstacle.shape, obstacle.world_from_shape)?;
    }
    Ok(model)
}

pub(crate) fn run(args: &DistanceArgs, style: Style, out: &mut dyn Write) -> anyhow::Result<Exit> {
    let robot = load(&args.configuration.model, &[])?;
    let mut model =
        collision_model(&robot, &args.collision, args.configuration.model.srdf.as_deref())?;
    let state = robot.state(&configuration(&robot, &args.configuration)?)?;
    let mut near: Vec<NearPair> = Vec::new();
    // Pairs that touch decide on the answer, whatever is asked for. NaN is left for `near` to refuse.
    let margin = if args.margin < 0.0 { 0.0 } else { args.margin };
    model.near(&state, margin, &mut near)?;
    let free = near.iter().all(|n| n.distance >= 0.0);
    near.retain(|n| n.distance <= args.margin);
    near.sort_by(|a, b| a.distance.total_cmp(&b.distance));
    let outside_limits = output::outside_limits(&robot, state.q());
    let bodies = |n: &NearPair| {
        let pair = model.pairs()[n.pair];
        [pair.a, pair.b].map(|i| &model.bodies()[i])
    };
    if style == Style::Json {
        let near = near.iter().map(|n| {
            let [a, b] = bodies(n);
            NearJson {
                a: &a.name,
                b: &b.name,
                shape_a: &a.shape,
                shape_b: &b.shape,
                distance: n.distance,
                point_a: n.point_a.to_array(),
                point_b: n.point_b.to_array(),
                normal: n.normal.to_array(),
                gradient: model.gradient(&state, n),
            }
        });
        let ignored = model.ignored().iter().map(|i| IgnoredJson { what: &i.what, why: &i.why });
        let json = DistanceJson {
            model: robot.name(),
            q: state.q(),
            joint_names: output::joint_names(&robot),
            outside_limits,
            shapes: model.bodies().len(),
            pairs: model.pairs().len(),
            margin: args.margin,
            free,
            near: near.collect(),
            ignored: ignored.collect(),
        };
        output::json(out, &json)?;
        return Ok(Exit::answer(free));
    }
    let note = match model.bodies().iter().any(|b| b.link.is_some()) {
        true => output::outside_note(&outside_limits),
        false => "no link has a collision shape".to_owned(),
    };
    output::pairs(
        out,
        [
            ("model", robot.name().to_owned()),
            ("q [rad or m]", output::entries(state.q())),
            ("shapes", model.bodies().len().to_string()),
            ("pairs watched", model.pairs().len().to_string()),
            ("nearer than", format!("{} m: {}", output::number(args.margin), near.len())),
            ("collision-free", if free { "yes" } else { "no" }.to_owned()),
            ("note", note),
        ],
    )?;
    if !near.is_empty() {
        let columns = [
            ("a", Align::Left),
            ("b", Align::Left),
            ("distance [m]", Align::Right),
            ("point of a [m]", Align::Right),
            ("point of b [m]", Align::Right),
            ("normal", Align::Right),
        ];
        let rows = near.iter().map(|n| {
            let [a, b] = bodies(n);
            let vector = |v: cylindroid::Vec3| output::entries(&v.to_array());
            vec![
                a.name.clone(),
                b.name.clone(),
                output::number(n.distance),
                vector(n.point_a),
                vector(n.point_b),
                vector(n.normal),
            ]
        });
        writeln!(out)?;
        output::table(out, &columns, rows)?;
    }
    if !model.ignored().is_empty() {
        writeln!(out, "\nignored")?;
        let columns = [("what", Align::Left), ("why", Align::Left)];
        let rows = model.ignored().iter().map(|i| vec![i.what.clone(), i.why.clone()]);
        output::table(out, &columns, rows)?;
    }
    Ok(Exit::answer(free))
}
