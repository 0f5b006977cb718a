//! The ellipses that `--plot` draws, and their numbers beside the efficiencies.

use std::io::Write;

use cylindroid::manipulability::{
    Ellipsoid, EllipsoidView, Polytope, force_polytope, velocity_polytope,
};
use cylindroid::{Error, Matrix, Result};
use serde::Serialize;

use super::super::measured::Quantity;
use super::find::Found;
use crate::args::ManipulabilityArgs;
use crate::output::{self, Align, number};
use crate::plot::ellipses::{PlaneShapes, Region, Shape};

/// The shapes in all planes of the figure.
pub(super) fn planes(found: &Found, args: &ManipulabilityArgs) -> Result<Vec<PlaneShapes>> {
    let m = &found.efficiencies;
    let view = args.view.view();
    let [velocity, exerted, resisted] =
        [&m.kinematic, &m.active_force(), &m.passive_force()].map(Ellipsoid::of);
    let velocities = Quantity::Rate.limits(&found.posed, args).ok();
    let torques = Quantity::Torque.limits(&found.posed, args).ok();
    let d = found.components.len();
    let mut planes = Vec::new();
    for components in pairs(found)? {
        let seen = |e: &Ellipsoid| e.seen(view, &components).map(|e| Shape::from(&e));
        // Where others are free for the motions, forces on them are zero.
        let chosen = Matrix::from_fn(2, d, |i, j| f64::from(u8::from(components[i] == j)));
        let free = || found.relation.task(&chosen);
        let blocked = || found.relation.section(&components);
        let (of_motion, of_force) = match view {
            EllipsoidView::Projection => (free()?, blocked()?),
            EllipsoidView::Section => (blocked()?, free()?),
        };
        let region = |p: Polytope| Region::from(&p);
        planes.push(PlaneShapes {
            components,
            velocity: seen(&velocity)?,
            exerted: seen(&exerted)?,
            resisted: seen(&resisted)?,
            velocities: velocities
                .as_ref()
                .map(|l| velocity_polytope(&of_motion, l).map(region))
                .transpose()?,
            forces: torques
                .as_ref()
                .map(|l| force_polytope(&of_force, l).map(region))
                .transpose()?,
        });
    }
    Ok(planes)
}

/// Pairs of components: the linear ones, or all of a task of two or three.
fn pairs(found: &Found) -> Result<Vec<[usize; 2]>> {
    let all = 0..found.components.len();
    let is_linear = |i: &usize| ["x", "y", "z"].contains(&found.components[*i].as_str());
    let linear: Vec<usize> = all.clone().filter(is_linear).collect();
    let chosen = match all.len() {
        2 | 3 if found.task => all.collect(),
        _ if linear.len() > 1 => linear,
        _ => {
            return Err(Error::InvalidOption {
                option: "--task",
                value: found.components.join(","),
                reason: "--plot draws two or three components".to_owned(),
            });
        }
    };
    Ok(match chosen[..] {
        [a, b] => vec![[a, b]],
        _ => vec![[chosen[0], chosen[1]], [chosen[0], chosen[2]], [chosen[1], chosen[2]]],
    })
}

/// The figure in numbers.
#[derive(Debug, Serialize)]
pub(super) struct DrawnJson {
    /// projection (other components free) or section (zero).
    view: &'static str,
    planes: Vec<PlaneJson>,
}

#[derive(Debug, Serialize)]
struct PlaneJson {
    components: [String; 2],
    velocity: ShapeJson,
    force_exerted: ShapeJson,
    force_resisted: ShapeJson,
}

#[derive(Debug, Serialize)]
struct ShapeJson {
    /// Vectors, longest first.
    semi_axes: Vec<[f64; 2]>,
    /// Directions without bound.
    unbounded: Vec<[f64; 2]>,
}

impl From<&Shape> for ShapeJson {
    fn from(s: &Shape) -> Self {
        Self { semi_axes: s.axes.clone(), unbounded: s.endless.clone() }
    }
}

impl DrawnJson {
    pub(super) fn of(found: &Found) -> Option<Self> {
        let (view, planes) = found.drawn.as_ref()?;
        let plane = |p: &PlaneShapes| PlaneJson {
            components: p.components.map(|c| found.components[c].clone()),
            velocity: (&p.velocity).into(),
            force_exerted: (&p.exerted).into(),
            force_resisted: (&p.resisted).into(),
        };
        Some(Self { view: view.name(), planes: planes.iter().map(plane).collect() })
    }
}

/// The semi-axes of all ellipses, and why they are not roots of the efficiencies above.
pub(super) fn print(found: &Found, out: &mut dyn Write) -> anyhow::Result<()> {
    let Some((view, planes)) = &found.drawn else { return Ok(()) };
    let others = match view {
        EllipsoidView::Projection => "free",
        EllipsoidView::Section => "zero",
    };
    let title = format!("drawn, {}", view.name());
    let columns = [
        (title.as_str(), Align::Left),
        ("plane", Align::Left),
        (others, Align::Left),
        ("semi-axes", Align::Left),
        ("unbounded along", Align::Left),
    ];
    let mut rows = Vec::new();
    for p in planes {
        let names = |c: &mut dyn Iterator<Item = usize>| {
            c.map(|c| found.components[c].as_str()).collect::<Vec<_>>().join(", ")
        };
        let plane = names(&mut p.components.into_iter());
        let rest = names(&mut (0..found.components.len()).filter(|c| !p.components.contains(c)));
        for (what, shape) in [
            ("velocity", &p.velocity),
            ("force exerted", &p.exerted),
            ("force resisted", &p.resisted),
        ] {
            let sizes: Vec<String> = shape.sizes().map(number).collect();
            let along = shape.endless.iter().map(|d| format!("({})", output::entries(d)));
            rows.push(vec![
                what.to_owned(),
                plane.clone(),
                if rest.is_empty() { "-".to_owned() } else { rest.clone() },
                if sizes.is_empty() { "none".to_owned() } else { sizes.join(", ") },
                along.collect::<Vec<_>>().join(", "),
            ]);
        }
    }
    output::table(out, &columns, rows)?;
    let whole = planes.iter().all(|p| p.components.len() == found.components.len());
    let unit = found.metric == "unit" && found.own.is_empty();
    let text = match (whole, unit) {
        (true, true) => "The semi-axes are the roots of the efficiencies.",
        (true, false) => {
            "The semi-axes are not the roots of the efficiencies: these measure the output in \
             another metric."
        }
        (false, _) => {
            "The semi-axes are not the roots of the efficiencies, which refer to all components \
             together."
        }
    };
    Ok(writeln!(out, "{text}")?)
}
