//! Convex hull of a body given by its support function (expanding polytope).
//!
//! Formula  start from a simplex; query the support point along the normal of a facet; if it lies
//!          beyond, replace all facets visible from it by those from their horizon to it
//! Shapes   d from 1 to about 6; a facet has as many vertices as the body has dimensions
//! Units    of the points; the tolerance is relative to the size of the body
//! Valid    any bounded convex body, also a flat one (the hull is then that of its span). Exact for
//!          polytopes up to the tolerance; for curved bodies an inscribed polytope within the
//!          tolerance: the true facet lies between it and the support points.
//! Fails    never: where the limit on facets is reached, the hull is marked incomplete
//! Why so   one algorithm draws polygons of velocity, solids of force and measures grasps in six
//!          dimensions, for boxes, their images and friction cones; enumerating all vertices first
//!          would cost 2^n
//! Source   van den Bergen 2001 (expanding polytope); Zheng 2013 for its use on grasps
//! Checked  src/linalg/hull/tests.rs

use std::collections::BTreeMap;

use super::matrix::Matrix;
use super::qr::Qr;
use super::vector::dot;
use crate::tolerance::HULL;

/// The goal of a hull.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum HullGoal {
    /// All facets.
    Whole,
    /// Only the facet nearest to the origin, or the one farthest beyond it.
    NearestFacet,
}

/// Options of a hull.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct HullOptions {
    /// The goal.
    pub(crate) goal: HullGoal,
    /// A point that lies beyond a facet by less than this times the size of the body does not
    /// change it [-].
    pub(crate) tolerance: f64,
    /// Maximum number of facets at a time.
    pub(crate) max_facets: usize,
}

/// A simplex of the boundary.
#[derive(Debug, Clone, PartialEq)]
pub struct Facet {
    /// Its vertices, by index.
    pub vertices: Vec<usize>,
    /// Unit outward normal, within the span of the body.
    pub normal: Vec<f64>,
    /// `normal . x` on the facet: the distance of its plane from the origin, negative where the
    /// origin lies beyond.
    pub offset: f64,
    /// Upper bound of the extent of the body beyond it (infinite before it is queried).
    pub gap: f64,
}

/// The convex hull of a polytope of velocities or forces.
#[doc(alias = "convex hull")]
#[derive(Debug, Clone, PartialEq)]
pub struct Hull {
    /// Points of the body; all are vertices of the polytope unless the body is curved.
    pub vertices: Vec<Vec<f64>>,
    /// The boundary in simplices; facets of the body with more vertices are split.
    pub facets: Vec<Facet>,
    /// Directions in which the body extends, orthonormal, a column each: all d for a solid one.
    pub span: Matrix,
    /// False where the limit on facets was reached first.
    pub complete: bool,
}

impl Hull {
    /// The hull of a body in `dimension` coordinates, whose support function `support(n)` returns a
    /// point of largest `n . x`. The queried directions have length one.
    pub(crate) fn of(
        dimension: usize,
        mut support: impl FnMut(&[f64]) -> Vec<f64>,
        options: HullOptions,
    ) -> Self {
        let (points, span, size) = first_points(dimension, &mut support, options.tolerance);
        let mut expansion = Expansion {
            inner: (0..dimension)
                .map(|i| points.iter().map(|p| p[i]).sum::<f64>() / points.len() as f64)
                .collect(),
            vertices: points,
            span,
            facets: Vec::new(),
            slack: options.tolerance * size,
            flat: options.tolerance.min(HULL) * size,
        };
        let k = expansion.span.cols();
        if k > 0 {
            for left_out in 0..=k {
                let corners = (0..=k).filter(|&i| i != left_out).collect();
                expansion.add_facet(corners);
            }
        }
        let complete = expansion.grow(&mut support, options);
        let mut hull = Self {
            vertices: expansion.vertices,
            facets: expansion.facets,
            span: expansion.span,
            complete,
        };
        hull.drop_unused();
        hull
    }

    /// The facet whose plane is nearest to the origin, or the one farthest beyond it.
    #[must_use]
    pub(crate) fn nearest_facet(&self) -> Option<&Facet> {
        self.facets.iter().min_by(|a, b| a.offset.total_cmp(&b.offset))
    }

    /// The vertices in order along the boundary, for a body of two dimensions.
    #[must_use]
    pub fn polygon(&self) -> Vec<&[f64]> {
        if self.span.cols() != 2 {
            return self.vertices.iter().map(Vec::as_slice).collect();
        }
        let n = self.vertices.len() as f64;
        let angle = |p: &[f64]| {
            let along = |j: usize| -> f64 {
                (0..p.len())
                    .map(|i| {
                        let mean = self.vertices.iter().map(|v| v[i]).sum::<f64>() / n;
                        self.span[(i, j)] * (p[i] - mean)
                    })
                    .sum()
            };
            along(1).atan2(along(0))
        };
        let mut order: Vec<(f64, &[f64])> =
            self.vertices.iter().map(|v| (angle(v), v.as_slice())).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        order.into_iter().map(|(_, v)| v).collect()
    }

    /// Removes vertices that became interior.
    fn drop_unused(&mut self) {
        if self.facets.is_empty() {
            return;
        }
        let mut used = vec![false; self.vertices.len()];
        for facet in &self.facets {
            facet.vertices.iter().for_each(|&v| used[v] = true);
        }
        let mut number = 0;
        let numbers: Vec<usize> = used
            .iter()
            .map(|&u| {
                number += usize::from(u);
                number.saturating_sub(1)
            })
            .collect();
        for facet in &mut self.facets {
            facet.vertices.iter_mut().for_each(|v| *v = numbers[*v]);
        }
        let mut keep = used.iter();
        self.vertices.retain(|_| *keep.next().unwrap_or(&true));
    }
}

/// Corners of a simplex of the full dimension of the body, the span of the body, its size.
fn first_points(
    dimension: usize,
    support: &mut impl FnMut(&[f64]) -> Vec<f64>,
    tolerance: f64,
) -> (Vec<Vec<f64>>, Matrix, f64) {
    let mut points: Vec<Vec<f64>> = Vec::new();
    let mut span = Matrix::zeros(dimension, 0);
    let mut size: f64 = 0.0;
    while span.cols() < dimension {
        // The largest extent orthogonal to the span so far: none along a basis means none at all.
        let directions = Qr::plain(span.clone()).complement();
        let mut best: (f64, Vec<f64>) = (0.0, Vec::new());
        for j in 0..directions.cols() {
            for sign in [1.0, -1.0] {
                let n: Vec<f64> = directions.column(j).iter().map(|x| sign * x).collect();
                let x = support(&n);
                if points.is_empty() {
                    points.push(x);
                    continue;
                }
                let reach = (dot(&n, &x) - dot(&n, &points[0])).abs();
                if reach > best.0 {
                    best = (reach, x);
                }
            }
        }
        size = size.max(best.0);
        if !(best.0 > tolerance * size) {
            break;
        }
        let edge: Vec<f64> = best.1.iter().zip(&points[0]).map(|(a, b)| a - b).collect();
        let edge = Matrix::from_fn(dimension, 1, |i, _| edge[i] / best.0);
        span = Matrix::hstack(dimension, &[&span, &edge]);
        points.push(best.1);
    }
    (points, Qr::plain(span).basis(), size)
}

struct Expansion {
    vertices: Vec<Vec<f64>>,
    facets: Vec<Facet>,
    span: Matrix,
    /// A point inside.
    inner: Vec<f64>,
    /// Distance beyond a facet up to which a point does not change it.
    slack: f64,
    /// Distance beyond a facet up to which the facet counts as invisible: rounding, since a visible
    /// facet that is kept folds the surface.
    flat: f64,
}

impl Expansion {
    fn add_facet(&mut self, vertices: Vec<usize>) {
        let first = &self.vertices[vertices[0]];
        let k = self.span.cols();
        let edges = Matrix::from_fn(k, k - 1, |i, j| {
            let other = &self.vertices[vertices[j + 1]];
            (0..first.len()).map(|l| self.span[(l, i)] * (other[l] - first[l])).sum()
        });
        let across = Qr::plain(edges).complement();
        let mut normal = self.span.mul_vec(across.column(0));
        let mut offset = dot(&normal, first);
        if dot(&normal, &self.inner) > offset {
            normal.iter_mut().for_each(|x| *x = -*x);
            offset = -offset;
        }
        self.facets.push(Facet { vertices, normal, offset, gap: f64::INFINITY });
    }

    /// The facet to be queried next.
    fn open(&self, goal: HullGoal) -> Option<usize> {
        let (i, facet) = match goal {
            HullGoal::Whole => {
                self.facets.iter().enumerate().rev().find(|(_, f)| f.gap == f64::INFINITY)?
            }
            HullGoal::NearestFacet => {
                self.facets.iter().enumerate().min_by(|a, b| a.1.offset.total_cmp(&b.1.offset))?
            }
        };
        (facet.gap == f64::INFINITY).then_some(i)
    }

    /// True when the goal is reached.
    fn grow(&mut self, support: &mut impl FnMut(&[f64]) -> Vec<f64>, options: HullOptions) -> bool {
        while let Some(i) = self.open(options.goal) {
            if self.facets.len() > options.max_facets {
                return false;
            }
            let x = support(&self.facets[i].normal);
            let gain = dot(&self.facets[i].normal, &x) - self.facets[i].offset;
            if !(gain > self.slack) {
                self.facets[i].gap = gain.max(0.0);
                continue;
            }
            let new = self.vertices.len();
            let mut rim: BTreeMap<Vec<usize>, usize> = BTreeMap::new();
            let flat = self.flat;
            self.facets.retain(|facet| {
                let visible = dot(&facet.normal, &x) - facet.offset > flat;
                if visible {
                    for left_out in 0..facet.vertices.len() {
                        let mut ridge = facet.vertices.clone();
                        ridge.remove(left_out);
                        ridge.sort_unstable();
                        *rim.entry(ridge).or_default() += 1;
                    }
                }
                !visible
            });
            self.vertices.push(x);
            for (mut ridge, times) in rim {
                if times == 1 {
                    ridge.push(new);
                    self.add_facet(ridge);
                }
            }
        }
        true
    }
}

#[cfg(test)]
mod tests;
