//! The report of a map, as data.

use cylindroid::sweep::{Hole, Locus, Map, Region, Surface};
use cylindroid::{Mechanism, Result};
use serde::Serialize;

use crate::output;

#[derive(Debug, Serialize)]
pub(super) struct MapJson<'a> {
    pub(super) model: &'a str,
    pub(super) frame: &'a str,
    /// The tool point, in axes of the frame [m].
    pub(super) tool: [f64; 3],
    pub(super) axes: Vec<AxisJson<'a>>,
    /// Components that keep a value [m or rad].
    pub(super) held: Vec<HeldJson<'a>>,
    /// Motions that axes and held components leave.
    pub(super) free_motions: usize,
    /// Whether the distances of type I and II have a sign.
    pub(super) signed: [bool; 2],
    pub(super) cells: usize,
    /// Of the sizes of workspace and holes.
    pub(super) size_unit: String,
    /// What the modes reach together.
    pub(super) workspace: RegionJson,
    pub(super) modes: Vec<ModeJson>,
    pub(super) joint_names: Vec<&'a str>,
    pub(super) loci: Vec<LocusJson<'a>>,
    pub(super) surfaces: Vec<SurfaceJson<'a>>,
}

#[derive(Debug, Serialize)]
pub(super) struct AxisJson<'a> {
    pub(super) name: &'a str,
    pub(super) from: f64,
    pub(super) to: f64,
    pub(super) count: u64,
    pub(super) unit: &'static str,
}

#[derive(Debug, Serialize)]
pub(super) struct HeldJson<'a> {
    pub(super) name: &'a str,
    pub(super) value: f64,
}

#[derive(Debug, Serialize)]
pub(super) struct RegionJson {
    pub(super) cells: usize,
    pub(super) size: f64,
    /// True if it ends at the border of the grid.
    pub(super) is_cut: bool,
    pub(super) holes: Vec<HoleJson>,
}

impl From<Region> for RegionJson {
    fn from(region: Region) -> Self {
        let hole = |h: Hole| HoleJson { cells: h.cells, size: h.size, center: h.center };
        let holes = region.holes.into_iter().map(hole).collect();
        Self { cells: region.cells, size: region.size, is_cut: region.is_cut, holes }
    }
}

#[derive(Debug, Serialize)]
pub(super) struct HoleJson {
    pub(super) cells: usize,
    pub(super) size: f64,
    /// The mean of its cells, a value for each axis [m or rad].
    pub(super) center: Vec<f64>,
}

#[derive(Debug, Serialize)]
pub(super) struct ModeJson {
    /// What it reaches.
    #[serde(flatten)]
    pub(super) region: RegionJson,
    /// Smallest distance to singularities of type I and II in them [-].
    pub(super) least_type_one: f64,
    pub(super) least_type_two: f64,
    /// A configuration [rad or m], at the cell farthest from singularities of type II.
    pub(super) q: Vec<f64>,
}

#[derive(Debug, Serialize)]
pub(super) struct LocusJson<'a> {
    pub(super) kind: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) limit: Option<&'a str>,
    pub(super) modes: &'a [usize],
    pub(super) closed: bool,
    pub(super) points: &'a [Vec<f64>],
    pub(super) q: &'a [Vec<f64>],
}

#[derive(Debug, Serialize)]
pub(super) struct SurfaceJson<'a> {
    pub(super) kind: &'static str,
    pub(super) mode: usize,
    pub(super) closed: bool,
    pub(super) vertices: &'a [[f64; 3]],
    pub(super) triangles: &'a [[usize; 3]],
    pub(super) q: &'a [Vec<f64>],
}

/// The report of a map.
pub(super) fn report<'a>(
    robot: &'a Mechanism,
    map: &'a Map,
    (frame, tool): (&'a str, [f64; 3]),
) -> Result<MapJson<'a>> {
    let n = robot.n();
    let least = |values: &[f64]| {
        values.iter().filter(|x| x.is_finite()).fold(f64::INFINITY, |a, x| a.min(x.abs()))
    };
    let modes = map.modes.iter().enumerate().map(|(number, mode)| -> Result<ModeJson> {
        let best = (0..map.cells())
            .filter(|&cell| mode.reached[cell])
            .max_by(|a, b| mode.type_two[*a].abs().total_cmp(&mode.type_two[*b].abs()));
        Ok(ModeJson {
            region: map.workspace_of(number)?.into(),
            least_type_one: least(&mode.type_one),
            least_type_two: least(&mode.type_two),
            q: best.map_or_else(Vec::new, |cell| mode.q[cell * n..(cell + 1) * n].to_vec()),
        })
    });
    let locus = |locus: &'a Locus| LocusJson {
        kind: locus.kind.name(),
        limit: locus.limit.as_deref(),
        modes: &locus.modes,
        closed: locus.closed,
        points: &locus.points,
        q: &locus.q,
    };
    let surface = |surface: &'a Surface| SurfaceJson {
        kind: surface.kind.name(),
        mode: surface.mode,
        closed: surface.closed,
        vertices: &surface.vertices,
        triangles: &surface.triangles,
        q: &surface.q,
    };
    Ok(MapJson {
        model: robot.name(),
        frame,
        tool,
        axes: map
            .axes
            .iter()
            .map(|a| AxisJson {
                name: &a.name,
                from: a.from,
                to: a.to,
                count: a.count,
                unit: Map::unit(&a.name),
            })
            .collect(),
        held: map.held.iter().map(|(name, value)| HeldJson { name, value: *value }).collect(),
        free_motions: map.free_motions,
        signed: map.signed,
        cells: map.cells(),
        size_unit: map.size_unit(),
        workspace: map.workspace().into(),
        modes: modes.collect::<Result<_>>()?,
        joint_names: output::joint_names(robot),
        loci: map.loci.iter().map(locus).collect(),
        surfaces: map.surfaces.iter().map(surface).collect(),
    })
}
