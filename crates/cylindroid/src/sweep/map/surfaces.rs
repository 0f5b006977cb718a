//! The loci of a map over three axes: surfaces of triangles on which the actuated joints no longer hold
//! the platform, or passive joints move.
//!
//! Formula  s(p) = 0, s the signed distance to singularities of type II of a mode
//! Method   marching tetrahedra over the cells that the mode reaches; the vertex of an edge is found by
//!          regula falsi (Illinois) along it, on ways of the platform from the last configurations
//! Units    of the axes [m or rad]; s has none
//! Valid    mechanisms in which nothing is left free and s has a sign. An edge whose way leaves the mode
//!          or its branch, and one on which s jumps, has no vertex: the surface ends there, as at the
//!          border of the grid and of the mode. Parts smaller than a cell may be missed
//! Why so   triangles have the resolution of the grid, vertices that of rounding. In type I a mode ends:
//!          its distance does not change its sign within it
//! Source   Dowell & Jarratt 1971, A modified regula falsi method for computing the root of an equation
//! Checked  tests/map/surfaces.rs

use std::collections::BTreeMap;

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
use crate::spatial::Vec3;
use crate::tolerance::{LOCUS_MET, SAME_ASSEMBLY};

/// Edges that a thread takes at once: about ten milliseconds.
const BLOCK: usize = 16;
/// Evaluations of an edge at most; a dozen are usual.
const MAX_STEPS: usize = 100;
/// Distance beyond which the end of the search is a jump of the sign [-].
const JUMP: f64 = 1e-9;

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
            let middle = part[part.len() / 2][0];
            let motion = motions.motion(vertices[middle])?;
            let kind = kind_of(problem, LocusKind::TypeTwo, &motion);
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

/// A point of an edge: its share of the way, its node and its distance.
struct Point {
    share: f64,
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
        let (Some(first), Some(last)) = (mode.at(a), mode.at(b)) else { return Ok(None) };
        let node = self.path.node(first)?;
        let mut low = Point { share: 0.0, node, value: mode.type_two[a] };
        let Some(mut high) = self.point(&low, 1.0, &to)? else { return Ok(None) };
        let (here, there) = (self.places(&high.node.q)?, self.places(last)?);
        let is_other = signature_distance(&here, &there, |_| true) > SAME_ASSEMBLY;
        if is_other || (low.value > 0.0) == (high.value > 0.0) {
            return Ok(None);
        }
        // What the ends count: half of an end that stays.
        let mut counted = [low.value, high.value];
        for _ in 0..MAX_STEPS {
            let nearest = if low.value.abs() < high.value.abs() { &low } else { &high };
            let width = high.share - low.share;
            if nearest.value.abs() <= LOCUS_MET || width <= f64::EPSILON {
                break;
            }
            let share = low.share - counted[0] * width / (counted[1] - counted[0]);
            let is_inside = share > low.share && share < high.share;
            let share = if is_inside { share } else { low.share + 0.5 * width };
            let at: Vec<f64> = from.iter().zip(&to).map(|(a, b)| a + share * (b - a)).collect();
            let Some(point) = self.point(nearest, share, &at)? else { return Ok(None) };
            if (point.value > 0.0) == (low.value > 0.0) {
                counted = [point.value, 0.5 * counted[1]];
                low = point;
            } else {
                counted = [0.5 * counted[0], point.value];
                high = point;
            }
        }
        let nearest = if low.value.abs() < high.value.abs() { low } else { high };
        Ok((nearest.value.abs() <= JUMP).then_some(nearest.node.q))
    }

    /// The point of these values of the axes, on the branch of another one.
    fn point(&mut self, from: &Point, share: f64, at: &[f64]) -> Result<Option<Point>> {
        let Ok(node) = self.path.go(&from.node, at)? else { return Ok(None) };
        self.path.equations.set(&node.q)?;
        let block = self.problem.type_two.block(&self.path.equations.jacobian);
        let value = self.problem.type_two.value(&block, &Svd::of(&block));
        Ok(Some(Point { share, node, value }))
    }

    fn places(&self, q: &[f64]) -> Result<Vec<Vec3>> {
        Ok(self.landmarks.at(&link_poses(&self.problem.platform.mechanism.state(q)?)))
    }
}
