//! Marching tetrahedra: triangles where numbers at the nodes of a grid change their sign.
//!
//! Formula  the cube between eight nodes is six tetrahedra, one for each order of the axes: its way from
//!          the first node to the last goes along the axes in this order
//! Shapes   nodes n1 x n2 x n3, the last index changes fastest; of n nodes along the axes
//! Valid    any signs: an edge with a change of sign has one vertex, which all tetrahedra around it share,
//!          so that each inner edge of a triangle has one other triangle. Normals, in axes in the
//!          order of the grid, point to positive numbers
//! Why so   cubes have ambiguous signs, tetrahedra have none; the diagonals of two cubes agree on the face
//!          between them
//! Source   Doi & Koide 1991, An efficient method of triangulating equi-valued surfaces by using
//!          tetrahedral cells
//! Checked  tests in this file, tests/map/surfaces.rs

use std::collections::BTreeMap;

/// The tetrahedra of a cube: the orders of the axes, and whether they are even.
const ORDERS: [([usize; 3], bool); 6] = [
    ([0, 1, 2], true),
    ([1, 2, 0], true),
    ([2, 0, 1], true),
    ([0, 2, 1], false),
    ([2, 1, 0], false),
    ([1, 0, 2], false),
];
/// Even orders of the corners of a tetrahedron with each of them first.
const ONE_FIRST: [[usize; 4]; 4] = [[0, 1, 2, 3], [1, 0, 3, 2], [2, 3, 0, 1], [3, 2, 1, 0]];
/// Even orders with each pair first.
const TWO_FIRST: [[usize; 4]; 6] =
    [[0, 1, 2, 3], [0, 2, 3, 1], [0, 3, 1, 2], [1, 2, 0, 3], [1, 3, 2, 0], [2, 3, 0, 1]];

/// Triangles over edges of the grid.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Triangles {
    /// The edges with a vertex, by their two nodes, the smaller one first.
    pub(super) edges: Vec<[usize; 2]>,
    /// Places in `edges`.
    pub(super) triangles: Vec<[usize; 3]>,
}

/// The triangles of a grid with these counts of nodes. `sign` is that of a node, `None` without a number:
/// tetrahedra with such a node have no triangles.
pub(super) fn triangles(counts: [usize; 3], sign: impl Fn(usize) -> Option<bool>) -> Triangles {
    let strides = [counts[1] * counts[2], counts[2], 1];
    let mut found = Triangles::default();
    let mut places = BTreeMap::new();
    for i in 0..counts[0].saturating_sub(1) {
        for j in 0..counts[1].saturating_sub(1) {
            for k in 0..counts[2].saturating_sub(1) {
                let first = i * strides[0] + j * strides[1] + k * strides[2];
                for (order, is_even) in ORDERS {
                    let mut nodes = [first; 4];
                    for (corner, axis) in order.into_iter().enumerate() {
                        nodes[corner + 1] = nodes[corner] + strides[axis];
                    }
                    let signs = nodes.map(&sign);
                    let [Some(a), Some(b), Some(c), Some(d)] = signs else { continue };
                    for triangle in of_tetrahedron([a, b, c, d], is_even) {
                        let corners = triangle.map(|[a, b]| {
                            let edge = [nodes[a].min(nodes[b]), nodes[a].max(nodes[b])];
                            *places.entry(edge).or_insert_with(|| {
                                found.edges.push(edge);
                                found.edges.len() - 1
                            })
                        });
                        found.triangles.push(corners);
                    }
                }
            }
        }
    }
    found
}

/// The triangles of a tetrahedron, their corners by pairs of its own.
fn of_tetrahedron(positive: [bool; 4], is_even: bool) -> Vec<[[usize; 2]; 3]> {
    let of = |count: usize| positive.iter().filter(|sign| **sign).count() == count;
    let mut found = Vec::new();
    let mut push = |[a, b, c]: [[usize; 2]; 3], towards: bool| {
        found.push(if towards == is_even { [a, b, c] } else { [a, c, b] });
    };
    if of(1) || of(3) {
        // The corner that differs: if it is negative, the normal points away from it.
        let alone = of(1);
        let Some(order) = ONE_FIRST.iter().find(|order| positive[order[0]] == alone) else {
            return found;
        };
        let [a, b, c, d] = *order;
        push([[a, b], [a, c], [a, d]], !alone);
    } else if of(2) {
        let Some(order) = TWO_FIRST.iter().find(|o| !positive[o[0]] && !positive[o[1]]) else {
            return found;
        };
        let [a, b, c, d] = *order;
        push([[a, c], [a, d], [b, d]], true);
        push([[a, c], [b, d], [b, c]], true);
    }
    found
}

impl Triangles {
    /// Without the triangles at edges that have no vertex, and without edges that have no triangle.
    pub(super) fn retain(&mut self, has_vertex: impl Fn(usize) -> bool) -> Vec<usize> {
        self.triangles.retain(|corners| corners.iter().all(|edge| has_vertex(*edge)));
        let mut used = vec![false; self.edges.len()];
        self.triangles.iter().flatten().for_each(|edge| used[*edge] = true);
        let kept: Vec<usize> = (0..self.edges.len()).filter(|edge| used[*edge]).collect();
        let mut places = vec![0; self.edges.len()];
        kept.iter().enumerate().for_each(|(place, edge)| places[*edge] = place);
        self.triangles.iter_mut().flatten().for_each(|edge| *edge = places[*edge]);
        self.edges = kept.iter().map(|edge| self.edges[*edge]).collect();
        kept
    }

    /// The triangles of each connected part, those of the first one first.
    pub(super) fn parts(&self) -> Vec<Vec<[usize; 3]>> {
        let mut root: Vec<usize> = (0..self.edges.len()).collect();
        fn top(root: &mut [usize], mut i: usize) -> usize {
            while root[i] != i {
                root[i] = root[root[i]];
                i = root[i];
            }
            i
        }
        for [a, b, c] in &self.triangles {
            for other in [b, c] {
                let (a, b) = (top(&mut root, *a), top(&mut root, *other));
                root[a.max(b)] = a.min(b);
            }
        }
        let mut parts: Vec<Vec<[usize; 3]>> = Vec::new();
        let mut places = BTreeMap::new();
        for triangle in &self.triangles {
            let part = *places.entry(top(&mut root, triangle[0])).or_insert_with(|| {
                parts.push(Vec::new());
                parts.len() - 1
            });
            parts[part].push(*triangle);
        }
        parts
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// The triangles of a function over a grid, with vertices in the middles of edges.
    fn of(counts: [usize; 3], function: impl Fn([f64; 3]) -> f64) -> (Triangles, Vec<[f64; 3]>) {
        let at = |node: usize| {
            let (i, rest) = (node / (counts[1] * counts[2]), node % (counts[1] * counts[2]));
            [i, rest / counts[2], rest % counts[2]].map(|x| x as f64)
        };
        let found = triangles(counts, |node| Some(function(at(node)) > 0.0));
        let middle = |[a, b]: &[usize; 2]| {
            let (a, b) = (at(*a), at(*b));
            [0, 1, 2].map(|i| 0.5 * (a[i] + b[i]))
        };
        let vertices = found.edges.iter().map(middle).collect();
        (found, vertices)
    }

    /// Each side of a triangle is one of the reverse direction of another, and Euler's characteristic.
    fn characteristic(found: &Triangles) -> i64 {
        let sides: Vec<[usize; 2]> =
            found.triangles.iter().flat_map(|[a, b, c]| [[*a, *b], [*b, *c], [*c, *a]]).collect();
        let once: BTreeSet<[usize; 2]> = sides.iter().copied().collect();
        assert_eq!(once.len(), sides.len());
        assert!(sides.iter().all(|[a, b]| once.contains(&[*b, *a])));
        let count = |count: usize| i64::try_from(count).unwrap();
        count(found.edges.len()) - count(sides.len() / 2) + count(found.triangles.len())
    }

    #[test]
    fn spheres_and_tori_are_closed() {
        let distance = |p: [f64; 3], c: [f64; 3]| {
            p.iter().zip(c).map(|(p, c)| (p - c) * (p - c)).sum::<f64>().sqrt()
        };
        let sphere = |p| distance(p, [5.1, 6.2, 7.3]) - 4.4;
        let (ball, vertices) = of([12, 13, 14], sphere);
        assert_eq!((characteristic(&ball), ball.parts().len()), (2, 1));
        // Normals point outside, to positive numbers.
        let mut volume = 0.0;
        for triangle in &ball.triangles {
            let [a, b, c] = triangle.map(|v| vertices[v]);
            let cross =
                |i: usize, j: usize| (b[i] - a[i]) * (c[j] - a[j]) - (b[j] - a[j]) * (c[i] - a[i]);
            let normal = [cross(1, 2), cross(2, 0), cross(0, 1)];
            volume += a.iter().zip(normal).map(|(a, n)| a * n / 6.0).sum::<f64>();
        }
        let expected = 4.0 / 3.0 * std::f64::consts::PI * 4.4_f64.powi(3);
        assert!((volume / expected - 1.0).abs() < 0.1, "{volume} for {expected}");
        let torus = |p: [f64; 3]| {
            let (x, y, z) = (p[0] - 9.1, p[1] - 9.2, p[2] - 4.3);
            (x.hypot(y) - 5.3).hypot(z) - 2.4
        };
        let (ring, _) = of([19, 20, 9], torus);
        assert_eq!((characteristic(&ring), ring.parts().len()), (0, 1));
        let two = |p| distance(p, [3.1, 3.2, 3.3]).min(distance(p, [9.1, 3.2, 3.3])) - 2.1;
        let (both, _) = of([13, 7, 7], two);
        assert_eq!((characteristic(&both), both.parts().len()), (4, 2));
        // Random signs are closed too, but for the border of the grid, which has one sign.
        let noise = |p: [f64; 3]| (12.9 * p[0] + 78.2 * p[1] + 37.7 * p[2]).sin() * 4e4;
        let inner = |p: [f64; 3]| p.iter().all(|x| (1.0..=7.0).contains(x));
        let (rough, _) =
            of([9, 9, 9], |p| if inner(p) { noise(p).fract().abs() - 0.5 } else { -1.0 });
        characteristic(&rough);
    }

    #[test]
    fn edges_without_a_vertex_have_no_triangles() {
        let (mut found, _) = of([3, 3, 3], |p| p[0] + 0.1 * p[1] - 1.05);
        let before = found.triangles.len();
        let kept = found.retain(|edge| edge != 0);
        assert!(found.triangles.len() < before && kept.len() == found.edges.len());
        assert!(found.triangles.iter().flatten().all(|v| *v < found.edges.len()));
        let none = triangles([3, 3, 3], |node| (node != 13).then_some(node > 10));
        let around: Vec<usize> = none.edges.iter().flatten().copied().collect();
        assert!(!around.is_empty() && !around.contains(&13));
        assert!(triangles([1, 3, 3], |_| Some(true)).triangles.is_empty());
    }
}
