//! The point of a simplex of the difference of two cores that is nearest to the origin.
//!
//! Formula  a triangle contains its projection where all barycentric coordinates are positive, a
//!          tetrahedron the origin where it is on the inner side of all faces; otherwise the nearest
//!          of the faces, edges or vertices
//! Why so   all faces are compared instead of walking regions: nearly flat simplices, at which GJK
//!          ends on curved shapes, then cost digits and not the answer
//! Source   Ericson 2005, Real-Time Collision Detection, section 5.1
//! Checked  tests/collision/laws.rs

use crate::spatial::Vec3;

/// A point of the difference: `point = a - b`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Vertex {
    pub(super) point: Vec3,
    pub(super) a: Vec3,
    pub(super) b: Vec3,
}

/// Up to four vertices and the barycentric coordinates of the nearest point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Simplex {
    vertices: [Vertex; 4],
    /// Those of the first `count` vertices; the rest are not read.
    weights: [f64; 4],
    count: usize,
}

/// Weights of a nearest point and its squared distance from the origin.
type Nearest = ([f64; 4], f64);

impl Simplex {
    pub(super) fn new(first: Vertex) -> Self {
        Self { vertices: [first; 4], weights: [1.0; 4], count: 1 }
    }

    pub(super) fn contains(&self, point: Vec3) -> bool {
        self.vertices[..self.count].iter().any(|v| v.point == point)
    }

    /// The nearest points of a and of b.
    pub(super) fn witnesses(&self) -> (Vec3, Vec3) {
        let all = self.vertices[..self.count].iter().zip(self.weights);
        all.fold((Vec3::ZERO, Vec3::ZERO), |(a, b), (v, w)| (a + v.a * w, b + v.b * w))
    }

    /// Adds a vertex and reduces to the face that contains the nearest point; `None` if the origin
    /// is inside.
    pub(super) fn add(&mut self, vertex: Vertex) -> Option<Vec3> {
        self.vertices[self.count] = vertex;
        self.count += 1;
        let p = self.vertices.map(|v| v.point);
        let (weights, _) = match self.count {
            2 => edge(&p, 0, 1),
            3 => triangle(&p, 0, 1, 2),
            _ => tetrahedron(&p)?,
        };
        let mut kept = 0;
        for (i, weight) in weights.into_iter().enumerate().take(self.count) {
            if weight > 0.0 {
                self.vertices[kept] = self.vertices[i];
                self.weights[kept] = weight;
                kept += 1;
            }
        }
        self.count = kept;
        let all = self.vertices[..kept].iter().zip(self.weights);
        Some(all.fold(Vec3::ZERO, |sum, (v, w)| sum + v.point * w))
    }
}

fn nearer(a: Nearest, b: Nearest) -> Nearest {
    if b.1 < a.1 { b } else { a }
}

fn edge(p: &[Vec3; 4], i: usize, j: usize) -> Nearest {
    let along = p[j] - p[i];
    let (square, share) = (along.dot(along), -p[i].dot(along));
    let t = if share <= 0.0 {
        0.0
    } else if share >= square {
        1.0
    } else {
        share / square
    };
    let mut weights = [0.0; 4];
    weights[j] = t;
    weights[i] += 1.0 - t;
    let nearest = p[i] * (1.0 - t) + p[j] * t;
    (weights, nearest.dot(nearest))
}

fn triangle(p: &[Vec3; 4], i: usize, j: usize, k: usize) -> Nearest {
    let normal = (p[j] - p[i]).cross(p[k] - p[i]);
    let square = normal.dot(normal);
    let areas =
        [p[j].cross(p[k]).dot(normal), p[k].cross(p[i]).dot(normal), p[i].cross(p[j]).dot(normal)];
    if square > 0.0 && areas.iter().all(|x| *x > 0.0) {
        let height = p[i].dot(normal);
        let sum = areas[0] + areas[1] + areas[2];
        let mut weights = [0.0; 4];
        (weights[i], weights[j], weights[k]) = (areas[0] / sum, areas[1] / sum, areas[2] / sum);
        return (weights, height * height / square);
    }
    nearer(nearer(edge(p, i, j), edge(p, j, k)), edge(p, k, i))
}

fn tetrahedron(p: &[Vec3; 4]) -> Option<Nearest> {
    let faces = [[0, 1, 2, 3], [0, 1, 3, 2], [0, 2, 3, 1], [1, 2, 3, 0]];
    let mut inside = true;
    let mut best: Option<Nearest> = None;
    for [i, j, k, other] in faces {
        let normal = (p[j] - p[i]).cross(p[k] - p[i]);
        let (origin, apex) = (-p[i].dot(normal), (p[other] - p[i]).dot(normal));
        if apex != 0.0 && origin * apex >= 0.0 {
            continue;
        }
        inside = false;
        let face = triangle(p, i, j, k);
        best = Some(best.map_or(face, |b| nearer(b, face)));
    }
    if inside { None } else { best }
}
