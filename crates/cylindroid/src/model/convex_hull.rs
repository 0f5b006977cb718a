//! The convex hull of points, checked against all of them.
//!
//! Formula  quickhull; no point lies beyond a facet, beyond an edge sharper than a right angle (along
//!          the mean of the normals of its facets), or beyond the vertices along a principal axis.
//!          Where one does, again with all points scaled to the same extent along their principal
//!          axes, which keeps facets facets; then with the vertices and what lay beyond them
//! Units    of the points; the check runs about their mean, in units of the largest distance from it
//! Valid    three points or more; also flat sets, whose hull has facets on both sides
//! Fails    `None` where quickhull fails, or its facets do not enclose all points to
//!          [`HULL_ROUNDING`] of their extent
//! Why so   parry's quickhull calls a set flat whose variance along an axis is below 1e-7 of its size,
//!          and then drops what protrudes: thin plates, and large ones with one spike
//! Source   Barber, Dobkin & Huhdanpaa 1996 (quickhull, by parry)
//! Checked  tests/collision/thin.rs

use std::collections::BTreeMap;

use parry3d_f64::math::Vector;
use parry3d_f64::transformation::try_convex_hull;

use crate::linalg::SymmetricEigen;
use crate::spatial::{Mat3, Vec3};
use crate::tolerance::HULL_ROUNDING;

/// Hulls of scaled points at most.
const ATTEMPTS: usize = 12;

/// Points in a box of the tree that are compared one by one.
const BOX_POINTS: usize = 8;

/// Indices of points, and triangles of these, counterclockwise seen from outside.
type Facets = (Vec<usize>, Vec<[u32; 3]>);

/// The vertices and triangles (counterclockwise seen from outside) of the convex hull of points;
/// `None` without one that encloses them all.
pub(crate) fn convex_hull(points: &[Vec3]) -> Option<(Vec<Vec3>, Vec<[u32; 3]>)> {
    if !points.iter().all(|p| p.is_finite()) {
        return None;
    }
    let (relative, axes) = relative(points)?;
    let tree = Tree::of(&relative);
    let all: Vec<usize> = (0..points.len()).collect();
    let result = |hull: Facets| (hull.0.iter().map(|&i| points[i]).collect(), hull.1);
    if let Some(hull) = quickhull(points, &all)
        && beyond(&hull, &tree, axes).is_some_and(|points| points.is_empty())
    {
        return Some(result(hull));
    }
    let scaled = scaled(&relative, axes);
    let mut chosen = all;
    for _ in 0..ATTEMPTS {
        let hull = quickhull(&scaled, &chosen)?;
        let beyond = beyond(&hull, &tree, axes)?;
        if beyond.is_empty() {
            return Some(result(hull));
        }
        chosen = hull.0;
        chosen.extend(beyond);
    }
    None
}

/// Points about their mean, the farthest at a distance of one, and their principal axes; `None` for
/// points of no extent.
fn relative(points: &[Vec3]) -> Option<(Vec<Vec3>, Mat3)> {
    let share = 1.0 / points.len().max(1) as f64;
    let mean = points.iter().fold(Vec3::ZERO, |sum, p| sum + *p * share);
    let size = points.iter().map(|p| (*p - mean).norm()).fold(0.0, f64::max);
    if !(size > 0.0 && size.is_finite() && (1.0 / size).is_finite()) {
        return None;
    }
    let relative: Vec<Vec3> = points.iter().map(|p| (*p - mean) * (1.0 / size)).collect();
    let mut moments = [[0.0; 3]; 3];
    for p in relative.iter().map(|p| p.to_array()) {
        for (i, row) in moments.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                *entry += p[i] * p[j] * share;
            }
        }
    }
    let [x, y, _] = SymmetricEigen::of(moments, 3).vectors.map(Vec3::from_array);
    Some((relative, Mat3::from_cols(x, y, x.cross(y))))
}

/// Relative points, scaled along axes to an extent of about one along each.
fn scaled(relative: &[Vec3], axes: Mat3) -> Vec<Vec3> {
    let mut extent = [HULL_ROUNDING; 3];
    let mut turned: Vec<[f64; 3]> = relative.iter().map(|p| axes.tr_mul(*p).to_array()).collect();
    for p in &turned {
        extent = std::array::from_fn(|k| extent[k].max(p[k].abs()));
    }
    turned.iter_mut().for_each(|p| *p = std::array::from_fn(|k| p[k] / extent[k]));
    turned.into_iter().map(Vec3::from_array).collect()
}

/// The hull of the chosen ones of points, by parry.
fn quickhull(points: &[Vec3], chosen: &[usize]) -> Option<Facets> {
    let vector = |&i: &usize| Vector::new(points[i].x, points[i].y, points[i].z);
    let vectors: Vec<Vector> = chosen.iter().map(vector).collect();
    let (vertices, triangles) = try_convex_hull(&vectors).ok()?;
    let bits = |v: &Vector| [v.x, v.y, v.z].map(f64::to_bits);
    let index: BTreeMap<[u64; 3], usize> =
        vectors.iter().map(bits).zip(chosen.iter().copied()).collect();
    let vertices = vertices.iter().map(|v| index.get(&bits(v)).copied());
    Some((vertices.collect::<Option<Vec<usize>>>()?, triangles))
}

/// The points farthest beyond a hull, one for each facet, edge or axis along which some are; `None`
/// if the hull is not closed, or not convex.
fn beyond((vertices, triangles): &Facets, tree: &Tree<'_>, axes: Mat3) -> Option<Vec<usize>> {
    let at = |i: u32| vertices.get(i as usize).map(|&i| tree.points[i]);
    let reach = |n: Vec3, from: Vec3| {
        let along = vertices.iter().map(|&i| n.dot(tree.points[i] - from));
        along.fold(f64::NEG_INFINITY, f64::max)
    };
    let mut found = Vec::new();
    let mut check = |n: Vec3, from: Vec3, rounding: f64| {
        let Some((point, along)) = tree.farthest(n, from, HULL_ROUNDING) else { return Some(()) };
        let of_vertices = reach(n, from);
        if along > of_vertices + HULL_ROUNDING {
            found.push(point);
        }
        (of_vertices <= HULL_ROUNDING + rounding).then_some(())
    };
    let mut edges: BTreeMap<(u32, u32), Option<Vec3>> = BTreeMap::new();
    for t in triangles {
        let [a, b, c] = [at(t[0])?, at(t[1])?, at(t[2])?];
        let sides = [b - a, c - b, a - c];
        let normal = sides[0].cross(sides[1]);
        let longest = sides.iter().map(|s| s.norm()).fold(0.0, f64::max);
        let unit = normal.unit(f64::MIN_POSITIVE);
        for edge in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
            if edges.insert(edge, unit).is_some() && unit.is_some() {
                return None;
            }
        }
        if let Some(n) = unit {
            // The normal of a narrow facet has the rounding of its points over its height.
            check(n, a, 8.0 * f64::EPSILON * longest / normal.norm())?;
        }
    }
    for (&(i, j), normal) in &edges {
        let (Some(n), Some(m)) = (normal, *edges.get(&(j, i))?) else { continue };
        if i > j || n.dot(m) > 0.0 {
            continue;
        }
        // Outward across the edge, also of facets back to back.
        let (from, along) = (at(i)?, at(j)? - at(i)?);
        let across = [along.cross(*n), m.cross(along)].map(|v| v.unit(f64::MIN_POSITIVE));
        let [Some(a), Some(b)] = across else { continue };
        if let Some(out) = (a + b).unit(HULL_ROUNDING) {
            check(out, from, f64::INFINITY)?;
        }
    }
    for n in axes.cols.into_iter().flat_map(|axis| [axis, -axis]) {
        let farthest = tree.farthest(n, Vec3::ZERO, reach(n, Vec3::ZERO) + HULL_ROUNDING);
        found.extend(farthest.map(|(point, _)| point));
    }
    Some(found)
}

/// Boxes around points, for the farthest one along a direction.
struct Tree<'a> {
    points: &'a [Vec3],
    /// Indices of points, those of a box next to each other.
    order: Vec<usize>,
    boxes: Vec<Bounds>,
}

/// A box around `order[start..end]`, halves of which are `below`.
struct Bounds {
    start: usize,
    end: usize,
    middle: Vec3,
    half: Vec3,
    below: Option<[usize; 2]>,
}

impl<'a> Tree<'a> {
    fn of(points: &'a [Vec3]) -> Self {
        let order = (0..points.len()).collect();
        let mut tree = Self { points, order, boxes: Vec::new() };
        tree.split(0, points.len());
        tree
    }

    /// Adds the box around a range, and those within it; its index.
    fn split(&mut self, start: usize, end: usize) -> usize {
        let points = self.points;
        let range = &mut self.order[start..end];
        let inf = f64::INFINITY;
        let (mut low, mut high) = ([inf; 3], [-inf; 3]);
        for &i in range.iter() {
            for (k, x) in points[i].to_array().into_iter().enumerate() {
                (low[k], high[k]) = (low[k].min(x), high[k].max(x));
            }
        }
        let (low, high) = (Vec3::from_array(low), Vec3::from_array(high));
        let (middle, half) = ((low + high) * 0.5, (high - low) * 0.5);
        let index = self.boxes.len();
        let longest = (0..3).max_by(|&i, &j| half.to_array()[i].total_cmp(&half.to_array()[j]));
        let axis = longest.unwrap_or(0);
        let many = range.len() > BOX_POINTS;
        let cut = range.len() / 2;
        if many {
            let along = |i: usize| points[i].to_array()[axis];
            range.select_nth_unstable_by(cut, |&i, &j| along(i).total_cmp(&along(j)));
        }
        self.boxes.push(Bounds { start, end, middle, half, below: None });
        if many {
            let below = [self.split(start, start + cut), self.split(start + cut, end)];
            self.boxes[index].below = Some(below);
        }
        index
    }

    /// The point that is farthest along `n` from a point, and how far; `None` if none is by more
    /// than `least`.
    fn farthest(&self, n: Vec3, from: Vec3, least: f64) -> Option<(usize, f64)> {
        let mut best = (None, least);
        let mut open = vec![0];
        while let Some(at) = open.pop() {
            let it = &self.boxes[at];
            let spread = n.x.abs() * it.half.x + n.y.abs() * it.half.y + n.z.abs() * it.half.z;
            if n.dot(it.middle - from) + spread <= best.1 {
                continue;
            }
            if let Some(below) = it.below {
                open.extend(below);
                continue;
            }
            for &i in &self.order[it.start..it.end] {
                let along = n.dot(self.points[i] - from);
                if along > best.1 {
                    best = (Some(i), along);
                }
            }
        }
        best.0.map(|point| (point, best.1))
    }
}
