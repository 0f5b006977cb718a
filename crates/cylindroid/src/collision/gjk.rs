//! Distance and penetration of convex cores that have no closed form.
//!
//! Formula  Gilbert-Johnson-Keerthi on the difference of the cores: from the point nearest to the
//!          origin, v, the support point w along -v; |v| is an upper and v.w / |v| a lower bound of
//!          the distance. Where the cores overlap, the facet of the difference that is nearest to the
//!          origin (expanding polytope)
//! Units    the sum of the radii of both cores is one, so that no threshold depends on the scale;
//!          metres where it is zero to [`NO_EXTENT`]
//! Valid    bounded cores; the distance is exact to [`GJK_GAP`], the depth to [`DEPTH_GAP`], of that
//!          sum. Where curved cores lie around one place, the depth is the least one that descents
//!          from some facets find (`depth.rs`): a translation by it separates them, and in the tests
//!          none is shorter by more than that
//! Fails    never
//! Why so   parry's GJK ends on curved shapes with 1e-5 of the distance, ours with the rounding; its
//!          expanding polytope is fast and keeps its memory, but gives depth zero for boxes at one
//!          place. Its answer is therefore compared with the support along its normal, and where the
//!          two differ, our own expanding polytope (`linalg/hull.rs`) answers, which allocates.
//!          Supports are evaluated about the centre of the first core, so that a far world origin
//!          costs no digits
//! Source   Gilbert, Johnson & Keerthi 1988; van den Bergen 2001
//! Checked  tests/collision/laws.rs, tests/formats/mutated_files.rs::findings_stay_mended

use parry3d_f64::math::{Pose as ParryPose, Vector};
use parry3d_f64::query::epa::EPA;
use parry3d_f64::query::gjk::{self, CsoPoint, GJKResult, VoronoiSimplex};
use parry3d_f64::shape::SupportMap;

use super::convex::{Core, Placed};
use super::depth::{least_extent, mixed};
use super::separation::Separation;
use super::simplex::{Simplex, Vertex};
use crate::linalg::{Facet, Hull, HullGoal, HullOptions, Qr};
use crate::spatial::{Pose, Vec3};
use crate::tolerance::{DEPTH_GAP, GJK_GAP, NO_EXTENT, ZERO_SEPARATION};

/// Iterations at most; polytopes end after a few, curved shapes after some dozens.
const MAX_ITERATIONS: usize = 128;

/// Facets of the expanding polytope at most: curved shapes at one place have countless ones that are
/// nearly nearest.
const MAX_DEPTH_FACETS: usize = 400;

/// Descents from facets at most, where the polytope has that many.
const MAX_DESCENTS: usize = 32;

/// Scratch memory of the expanding polytope.
pub(super) struct Gjk {
    simplex: VoronoiSimplex,
    epa: EPA,
}

impl std::fmt::Debug for Gjk {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Gjk").finish_non_exhaustive()
    }
}

impl Default for Gjk {
    fn default() -> Self {
        Self { simplex: VoronoiSimplex::new(), epa: EPA::new() }
    }
}

impl Clone for Gjk {
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// A core in world axes about a point, times a factor.
struct Oriented<'a> {
    core: &'a Core,
    pose: &'a Pose,
    offset: Vec3,
    factor: f64,
}

impl Oriented<'_> {
    #[inline]
    fn support(&self, d: Vec3) -> Vec3 {
        let local = self.pose.rotation.matrix().tr_mul(d);
        (self.pose.rotation * self.core.support(local) + self.offset) * self.factor
    }
}

impl SupportMap for Oriented<'_> {
    #[inline]
    fn local_support_point(&self, d: Vector) -> Vector {
        vector(self.support(vec3(d)))
    }
}

fn vec3(v: Vector) -> Vec3 {
    Vec3::new(v.x, v.y, v.z)
}

fn vector(v: Vec3) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

/// The difference of two cores.
struct Difference<'a> {
    a: Oriented<'a>,
    b: Oriented<'a>,
}

impl Difference<'_> {
    /// Its point that is farthest along `d`.
    #[inline]
    fn support(&self, d: Vec3) -> Vertex {
        let (a, b) = (self.a.support(d), self.b.support(-d));
        Vertex { point: a - b, a, b }
    }
}

/// Points of a and b, and the unit normal from a to b.
type Closest = (Vec3, Vec3, Vec3);

impl Gjk {
    /// The separation of two bounded cores, the normal from a to b.
    pub(super) fn separation(&mut self, a: Placed<'_>, b: Placed<'_>) -> Separation {
        let about = a.world_from_shape.translation;
        let size = a.shape.core.bound() + b.shape.core.bound();
        let size = if size > NO_EXTENT { size } else { 1.0 };
        let factor = 1.0 / size;
        let oriented = |p: Placed<'_>| p.world_from_shape.translation - about;
        let difference = Difference {
            a: Oriented {
                core: &a.shape.core,
                pose: a.world_from_shape,
                offset: Vec3::ZERO,
                factor,
            },
            b: Oriented {
                core: &b.shape.core,
                pose: b.world_from_shape,
                offset: oriented(b),
                factor,
            },
        };
        let start = oriented(b).unit(ZERO_SEPARATION).unwrap_or(Vec3::X);
        let (p, q, normal) =
            apart(&difference, start).unwrap_or_else(|| self.overlapping(&difference, start));
        let (point_a, point_b) = (about + p * size, about + q * size);
        let distance = normal.dot(q - p) * size;
        Separation { distance, point_a, point_b, normal }
    }

    /// The depth and its normal, where the cores overlap or touch.
    fn overlapping(&mut self, difference: &Difference<'_>, start: Vec3) -> Closest {
        let here = ParryPose::IDENTITY;
        let (a, b) = (&difference.a, &difference.b);
        self.simplex.reset(CsoPoint::from_shapes(&here, a, b, vector(start)));
        let result = gjk::closest_points(&here, a, b, f64::MAX, true, &mut self.simplex);
        if result == GJKResult::Intersection
            && let Some((p, q, n)) = self.epa.closest_points(&here, a, b, &self.simplex)
            && let Some(found) = confirmed(difference, (vec3(p), vec3(q), vec3(n)), DEPTH_GAP)
        {
            return found;
        }
        nearest_facet(difference)
    }
}

/// The closest points of two cores; `None` if they overlap or touch.
#[inline]
fn apart(difference: &Difference<'_>, start: Vec3) -> Option<Closest> {
    let first = difference.support(start);
    let mut simplex = Simplex::new(first);
    let mut nearest = first.point;
    let mut lower = f64::NEG_INFINITY;
    let mut best = (f64::INFINITY, (Vec3::ZERO, Vec3::ZERO));
    for _ in 0..MAX_ITERATIONS {
        let distance = nearest.norm();
        if !(distance > GJK_GAP) {
            return None;
        }
        // Rounding has ended the progress.
        if distance >= best.0 {
            break;
        }
        best = (distance, simplex.witnesses());
        let next = difference.support(nearest * (-1.0 / distance));
        lower = lower.max(nearest.dot(next.point) / distance);
        if distance - lower <= GJK_GAP || simplex.contains(next.point) {
            break;
        }
        match simplex.add(next) {
            Some(point) => nearest = point,
            None if lower > 0.0 => break,
            None => return None,
        }
    }
    // Without a plane between them the cores touch.
    if lower <= 0.0 {
        return None;
    }
    let (p, q) = best.1;
    Some((p, q, (q - p) * (1.0 / best.0)))
}

/// The translation apart along a normal, given points of a facet there; `None` if the difference
/// extends beyond the facet by more than `gap`.
fn confirmed(difference: &Difference<'_>, facet: Closest, gap: f64) -> Option<Closest> {
    let (p, q, normal) = facet;
    let normal = normal.unit(ZERO_SEPARATION)?;
    let depth = normal.dot(difference.support(normal).point);
    (depth - normal.dot(p - q) <= gap).then(|| (p, p - normal * depth, normal))
}

/// The facet of the difference that is nearest to the origin.
fn nearest_facet(difference: &Difference<'_>) -> Closest {
    let mut seen: Vec<Vertex> = Vec::new();
    let support = |d: &[f64]| {
        let vertex = difference.support(Vec3::new(d[0], d[1], d[2]));
        seen.push(vertex);
        vertex.point.to_array().to_vec()
    };
    let options = HullOptions {
        goal: HullGoal::NearestFacet,
        tolerance: GJK_GAP,
        max_facets: MAX_DEPTH_FACETS,
    };
    let hull = Hull::of(3, support, options);
    let facet = hull.nearest_facet().filter(|_| hull.span.cols() == 3);
    if let Some(facet) = facet {
        if !hull.complete
            && let Some(found) = refined(difference, &hull, &mut seen)
        {
            return found;
        }
        let is_corner = |v: &Vertex| {
            let at = |i: &usize| hull.vertices[*i].as_slice() == v.point.to_array().as_slice();
            facet.vertices.iter().any(at)
        };
        let corners: Vec<Vertex> = seen.iter().copied().filter(is_corner).collect();
        let normal = Vec3::new(facet.normal[0], facet.normal[1], facet.normal[2]);
        if let Some((p, q)) = mixed(&corners, Vec3::ZERO)
            && let Some(found) = confirmed(difference, (p, q, normal), f64::INFINITY)
        {
            return found;
        }
    }
    // Flat: across it the cores only touch.
    let across = Qr::plain(hull.span).complement();
    let normal = match across.cols() {
        0 => Vec3::X,
        _ => Vec3::new(across[(0, 0)], across[(1, 0)], across[(2, 0)]),
    };
    let depth = |n: Vec3| n.dot(difference.support(n).point);
    let normal = if depth(-normal) < depth(normal) { -normal } else { normal };
    let p = mixed(&seen, Vec3::ZERO).map_or(Vec3::ZERO, |(p, _)| p);
    (p, p - normal * depth(normal), normal)
}

/// The least extent of the difference, by descents from the facets of an unfinished hull
/// along which it extends least.
fn refined(difference: &Difference<'_>, hull: &Hull, seen: &mut Vec<Vertex>) -> Option<Closest> {
    let start = |facet: &Facet| {
        let normal = Vec3::new(facet.normal[0], facet.normal[1], facet.normal[2]);
        let normal = normal.unit(ZERO_SEPARATION)?;
        Some((normal, normal.dot(difference.support(normal).point)))
    };
    let mut starts: Vec<(Vec3, f64)> = hull.facets.iter().filter_map(start).collect();
    starts.sort_by(|a, b| a.1.total_cmp(&b.1));
    let mut best: Option<(Vec3, f64)> = None;
    for (normal, _) in starts.into_iter().take(MAX_DESCENTS) {
        let support = |d: Vec3| {
            let vertex = difference.support(d);
            seen.push(vertex);
            vertex.point
        };
        let found = least_extent(support, normal);
        if best.is_none_or(|(_, depth)| found.1 < depth) {
            best = Some(found);
        }
    }
    let (normal, depth) = best?;
    let near = |v: &&Vertex| v.point.dot(normal) >= depth - DEPTH_GAP;
    let near: Vec<Vertex> = seen.iter().filter(near).copied().collect();
    let (p, _) = mixed(&near, normal * depth)?;
    Some((p, p - normal * depth, normal))
}
