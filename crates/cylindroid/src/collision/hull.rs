//! A convex hull of points, for support points by ascent over its edges.
//!
//! Formula  from the vertex that is farthest along one of six axes, to the neighbour that is
//!          farthest along d, until none is farther
//! Valid    also flat sets of points and fewer than four: their hull is then all of them
//! Why so   a hull of a mesh has hundreds of vertices, a path over its edges a few; a local maximum
//!          of a linear function on a convex polytope is a global one
//! Source   van den Bergen 2003, section 4.3.4; hull by `model/convex_hull.rs`
//! Checked  tests/collision/laws.rs, tests in this file

use crate::model::convex_hull::convex_hull;
use crate::spatial::Vec3;
use crate::tolerance::HULL_ROUNDING;

/// Hulls of at most this many vertices are scanned: shorter than an ascent.
const SCANNED: usize = 24;

/// The convex hull of points.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Hull {
    vertices: Vec<Vec3>,
    /// The neighbours of vertex i are `neighbours[first[i]..first[i + 1]]`; empty if scanned.
    first: Vec<u32>,
    neighbours: Vec<u32>,
    /// The vertices farthest along x, -x, y, -y, z, -z.
    extremes: [u32; 6],
    bound: f64,
}

impl Hull {
    /// The hull and its centre, to which its vertices are relative; `None` without points.
    pub(super) fn of(points: &[Vec3]) -> Option<(Self, Vec3)> {
        let (mut vertices, triangles) = hull(points);
        let first = *vertices.first()?;
        let (mut low, mut high) = (first, first);
        for v in &vertices {
            low = Vec3::new(low.x.min(v.x), low.y.min(v.y), low.z.min(v.z));
            high = Vec3::new(high.x.max(v.x), high.y.max(v.y), high.z.max(v.z));
        }
        let center = (low + high) * 0.5;
        vertices.iter_mut().for_each(|v| *v -= center);
        let bound = vertices.iter().map(|v| v.norm()).fold(0.0, f64::max);
        let (first, neighbours) = adjacency(vertices.len(), &triangles);
        let farthest = |d: Vec3| {
            let all = vertices.iter().enumerate();
            let best = all.max_by(|a, b| a.1.dot(d).total_cmp(&b.1.dot(d)));
            best.map_or(0, |(i, _)| i as u32)
        };
        let axes = [Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y, Vec3::Z, -Vec3::Z];
        let extremes = axes.map(farthest);
        let mut hull = Self { vertices, first, neighbours, extremes, bound };
        if !hull.ascends_to(&triangles) {
            (hull.first, hull.neighbours) = (Vec::new(), Vec::new());
        }
        Some((hull, center))
    }

    /// Whether the ascent along the normals of all triangles reaches these.
    fn ascends_to(&self, triangles: &[[u32; 3]]) -> bool {
        triangles.iter().all(|t| {
            let [a, b, c] = t.map(|i| self.vertices[i as usize]);
            let Some(n) = (b - a).cross(c - a).unit(f64::MIN_POSITIVE) else { return true };
            n.dot(a - self.support(n)) <= HULL_ROUNDING * self.bound
        })
    }

    /// The vertices, relative to the centre.
    pub(super) fn vertices(&self) -> &[Vec3] {
        &self.vertices
    }

    pub(super) fn bound(&self) -> f64 {
        self.bound
    }

    /// The vertex that is farthest along `d`.
    pub(super) fn support(&self, d: Vec3) -> Vec3 {
        if self.neighbours.is_empty() {
            let mut best = (f64::NEG_INFINITY, Vec3::ZERO);
            for v in &self.vertices {
                let along = v.dot(d);
                if along > best.0 {
                    best = (along, *v);
                }
            }
            return best.1;
        }
        let size = [d.x.abs(), d.y.abs(), d.z.abs()];
        let axis = if size[0] >= size[1] && size[0] >= size[2] {
            0
        } else {
            1 + usize::from(size[2] > size[1])
        };
        let negative = [d.x, d.y, d.z][axis] < 0.0;
        let mut at = self.extremes[2 * axis + usize::from(negative)];
        let mut along = self.vertices[at as usize].dot(d);
        loop {
            let range = self.first[at as usize] as usize..self.first[at as usize + 1] as usize;
            let before = at;
            for &other in &self.neighbours[range] {
                let there = self.vertices[other as usize].dot(d);
                if there > along {
                    (at, along) = (other, there);
                }
            }
            if at == before {
                return self.vertices[at as usize];
            }
        }
    }
}

/// Vertices and triangles of the hull; all points and no triangles where there is none.
fn hull(points: &[Vec3]) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut distinct: Vec<Vec3> = points.iter().copied().filter(|p| p.is_finite()).collect();
    let order = |a: &Vec3, b: &Vec3| {
        a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z))
    };
    distinct.sort_by(order);
    distinct.dedup();
    if distinct.len() < 5 {
        return (distinct, Vec::new());
    }
    convex_hull(&distinct).unwrap_or((distinct, Vec::new()))
}

/// The neighbours of all vertices, in one list; empty where a scan is shorter.
fn adjacency(count: usize, triangles: &[[u32; 3]]) -> (Vec<u32>, Vec<u32>) {
    if count <= SCANNED || triangles.is_empty() {
        return (Vec::new(), Vec::new());
    }
    let mut lists: Vec<Vec<u32>> = vec![Vec::new(); count];
    for t in triangles {
        for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
            lists[a as usize].push(b);
            lists[b as usize].push(a);
        }
    }
    if lists.iter().any(Vec::is_empty) {
        return (Vec::new(), Vec::new());
    }
    let mut first = vec![0];
    let mut neighbours = Vec::new();
    for list in &mut lists {
        list.sort_unstable();
        list.dedup();
        neighbours.extend_from_slice(list);
        first.push(neighbours.len() as u32);
    }
    (first, neighbours)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::uniform;

    #[test]
    fn ascent_finds_what_a_scan_finds() {
        let mut seed = 7;
        let mut vector =
            || Vec3::from_array(std::array::from_fn(|_| 2.0 * uniform(&mut seed) - 1.0));
        let points: Vec<Vec3> = (0..2000)
            .map(|_| vector())
            .map(|v| v * (0.2 / v.norm()) + Vec3::new(1.0, 2.0, 3.0))
            .collect();
        let (hull, center) = Hull::of(&points).unwrap();
        assert!(hull.neighbours.len() > 2000);
        for _ in 0..1000 {
            let d = vector();
            let best =
                points.iter().map(|p| (*p - center).dot(d)).fold(f64::NEG_INFINITY, f64::max);
            assert!((hull.support(d).dot(d) - best).abs() < 1e-14);
        }
        assert!((hull.bound() - 0.2).abs() < 0.01);
    }
}
