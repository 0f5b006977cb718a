//! The loci of a map over three axes: surfaces of triangles on which the actuated joints no longer hold
//! the platform, or passive joints move.
//!
//! Formula  s(p) = 0, s the signed distance to singularities of type II of a mode
//! Method   marching tetrahedra over the cells that the mode reaches; the vertex of an edge is found by
//!          regula falsi (scalar/bracket.rs) along it, on ways of the platform from the last
//!          configurations
//! Units    of the axes [m or rad]; s has none
//! Valid    mechanisms in which nothing is left free and s has a sign. An edge whose way leaves the mode
//!          or its branch, and one on which s jumps, has no vertex: the surface ends there, as at the
//!          border of the grid and of the mode. Parts smaller than a cell may be missed. At a vertex
//!          |s| <= 10^-12, or 10^-9 where rounding of the way leaves no nearer point on the edge
//! Why so   triangles have the resolution of the grid, vertices that of rounding. In type I a mode ends:
//!          its distance does not change its sign within it
//! Checked  tests/map/surfaces.rs

use std::collections::{BTreeMap, BTreeSet};

use super::super::workers::{Counted, Watch, Workers};
use super::flood::Flooded;
use super::grid::Grid;
use super::loci::kind_of;
use super::problem::Problem;
use super::result::{LocusKind, Surface};
use super::tetrahedra::{Triangles, triangles};
use crate::closure::{
    CurveDomain, CurveTracer, Landmarks, PathNode, PlatformPath, Vanishing, link_poses,
    signature_distance,
};
use crate::error::Result;
use crate::linalg::Svd;
use crate::scalar::Bracket;
use crate::spatial::Vec3;
use crate::tolerance::{LOCUS_MET, SAME_ASSEMBLY};

/// Edges that a thread takes at once: about ten milliseconds.
const BLOCK: usize = 16;
/// Steps on an edge at most; six to twelve are usual, four for each halving where s jumps.
const MAX_STEPS: usize = 240;
/// Distance beyond which a change of the sign without width is a jump [-].
const JUMP: f64 = 1e-9;
/// Width of a bracket without one, as a share of the edge: a few roundings.
const NO_WIDTH: f64 = 4.0 * f64::EPSILON;

/// All surfaces; none if the observer stops the workers.
pub(super) fn surfaces(
    problem: &Problem,
    grid: &Grid,
    modes: &[Flooded],
    workers: &mut Workers<'_>,
) -> Result<Vec<Surface>> {
    let Some(counts) = grid.spatial().filter(|_| problem.type_two.is_signed()) else {
        return Ok(Vec::new());
    };
    let marched: Vec<Triangles> = modes
        .iter()
        .map(|mode| {
            let value = |cell: usize| mode.reached[cell].then_some(mode.type_two[cell]);
            triangles(counts, |cell| value(cell).filter(|x| x.is_finite()).map(|x| x > 0.0))
        })
        .collect();
    let of_mode = |(mode, found): (usize, &Triangles)| {
        found.edges.iter().map(move |edge| (mode, *edge)).collect::<Vec<_>>()
    };
    let edges: Vec<(usize, [usize; 2])> = marched.iter().enumerate().flat_map(of_mode).collect();
    let all = edges.len() as u64;
    workers.begin(Counted { unit: "vertices", all, at_most: false }, 0);
    let blocks: Vec<&[(usize, [usize; 2])]> = edges.chunks(BLOCK).collect();
    let found = workers.run(blocks.len(), |own: &mut Option<Edges<'_>>, block, watch| {
        let own = own.get_or_insert_with(|| Edges::new(problem, grid));
        own.vertices(blocks[block], modes, watch)
    })?;
    let Some(found) = found else { return Ok(Vec::new()) };
    let mut found = found.into_iter().flatten();
    let mut surfaces = Vec::new();
    let mut motions = CurveTracer::new(
        problem.equations.clone(),
        Vanishing::Singularity(problem.type_two.clone()),
        CurveDomain { bounds: Vec::new(), side: None },
        (problem.unknown.clone(), problem.unknown_rank),
    );
    for (mode, mut marched) in marched.into_iter().enumerate() {
        let vertices: Vec<Option<Vec<f64>>> = found.by_ref().take(marched.edges.len()).collect();
        let kept = marched.retain(|edge| vertices[edge].is_some());
        let vertices: Vec<&[f64]> =
            kept.iter().filter_map(|edge| vertices[*edge].as_deref()).collect();
        for part in marched.parts() {
            let corners: BTreeSet<usize> = part.iter().flatten().copied().collect();
            let mut passive = 0;
            for vertex in &corners {
                let motion = motions.motion(vertices[*vertex])?;
                let kind = kind_of(problem, LocusKind::TypeTwo, &motion);
                passive += usize::from(kind == LocusKind::Passive);
            }
            let is_passive = 2 * passive > corners.len();
            let kind = if is_passive { LocusKind::Passive } else { LocusKind::TypeTwo };
            surfaces.push(surface(problem, (kind, mode), &vertices, part));
        }
    }
    Ok(surfaces)
}

/// A part with vertices of its own.
fn surface(
    problem: &Problem,
    (kind, mode): (LocusKind, usize),
    all: &[&[f64]],
    mut triangles: Vec<[usize; 3]>,
) -> Surface {
    let n = problem.platform.n();
    let (mut vertices, mut configurations) = (Vec::new(), Vec::new());
    let mut places = BTreeMap::new();
    for vertex in triangles.iter_mut().flatten() {
        let from = *vertex;
        *vertex = *places.entry(from).or_insert_with(|| {
            let q = all[from];
            vertices.push([0, 1, 2].map(|k| q[problem.axes[k]]));
            configurations.push(q[..n].to_vec());
            vertices.len() - 1
        });
    }
    let mut sides: BTreeMap<[usize; 2], i32> = BTreeMap::new();
    for [a, b, c] in &triangles {
        for [from, to] in [[*a, *b], [*b, *c], [*c, *a]] {
            let direction = if from < to { 1 } else { -1 };
            *sides.entry([from.min(to), from.max(to)]).or_insert(0) += direction;
        }
    }
    let closed = sides.values().all(|sum| *sum == 0);
    Surface { kind, mode, closed, vertices, triangles, q: configurations }
}

/// Finds vertices on edges of the grid, for one thread.
struct Edges<'a> {
    problem: &'a Problem,
    grid: &'a Grid,
    path: PlatformPath,
    landmarks: Landmarks,
}

/// A point of an edge: its node and its distance.
struct Point {
    node: PathNode,
    value: f64,
}

impl<'a> Edges<'a> {
    fn new(problem: &'a Problem, grid: &'a Grid) -> Self {
        let path = PlatformPath::new(
            problem.equations.clone(),
            problem.axes.clone(),
            problem.type_one.clone(),
        );
        Self { problem, grid, path, landmarks: Landmarks::of(&problem.platform.mechanism) }
    }

    fn vertices(
        &mut self,
        edges: &[(usize, [usize; 2])],
        modes: &[Flooded],
        watch: Watch<'_>,
    ) -> Result<Vec<Option<Vec<f64>>>> {
        let mut all = Vec::with_capacity(edges.len());
        for (mode, ends) in edges {
            if !watch.goes_on() {
                break;
            }
            all.push(self.vertex(&modes[*mode], *ends)?);
            watch.count(1);
        }
        Ok(all)
    }

    /// The configuration on an edge in which the mode is singular, if it leads from one end to the other.
    fn vertex(&mut self, mode: &Flooded, [a, b]: [usize; 2]) -> Result<Option<Vec<f64>>> {
        let (from, to) = (self.grid.values(a), self.grid.values(b));
        let (Some(first), Some(end)) = (mode.at(a), mode.at(b)) else { return Ok(None) };
        let node = self.path.node(first)?;
        let mut kept = Point { node, value: mode.type_two[a] };
        let Some(mut last) = self.point(&kept, &to)? else { return Ok(None) };
        let (here, there) = (self.places(&last.node.q)?, self.places(end)?);
        let is_other = signature_distance(&here, &there, |_| true) > SAME_ASSEMBLY;
        if is_other || (kept.value > 0.0) == (last.value > 0.0) {
            return Ok(None);
        }
        let Some(mut bracket) = Bracket::new([0.0, 1.0], [kept.value, last.value]) else {
            return Ok(None);
        };
        for _ in 0..MAX_STEPS {
            let nearest = if kept.value.abs() < last.value.abs() { &kept } else { &last };
            let has_no_width = bracket.width() <= NO_WIDTH;
            if nearest.value.abs() <= if has_no_width { JUMP } else { LOCUS_MET } {
                return Ok(Some(nearest.node.q.clone()));
            }
            let Some(share) = bracket.place().filter(|_| !has_no_width) else { break };
            let at: Vec<f64> = from.iter().zip(&to).map(|(a, b)| a + share * (b - a)).collect();
            let Some(point) = self.point(nearest, &at)? else { return Ok(None) };
            let before = std::mem::replace(&mut last, point);
            if bracket.narrow(share, last.value) {
                kept = before;
            }
        }
        Ok(None)
    }

    /// The point of these values of the axes, on the branch of another one.
    fn point(&mut self, from: &Point, at: &[f64]) -> Result<Option<Point>> {
        let Ok(node) = self.path.go(&from.node, at)? else { return Ok(None) };
        self.path.equations.set(&node.q)?;
        let block = self.problem.type_two.block(&self.path.equations.jacobian);
        let value = self.problem.type_two.value(&block, &Svd::of(&block));
        Ok(Some(Point { node, value }))
    }

    fn places(&self, q: &[f64]) -> Result<Vec<Vec3>> {
        Ok(self.landmarks.at(&link_poses(&self.problem.platform.mechanism.state(q)?)))
    }
}
