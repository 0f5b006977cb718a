//! Volume and inertia of meshes, as MuJoCo computes them.
//!
//! Formula  pyramids of all triangles (a, b, c) over an apex p, first the mean of the triangles'
//!          centres by their areas: v_k = (a - p) . ((b - p) x (c - p)) / 6,
//!          centre = p + sum v_k 3/4 (centre_k - p) / sum v_k; then, over this centre, V = sum v_k,
//!          P = sum v_k / 20 (2 (a a^T + b b^T + c c^T) + a b^T + b a^T + ...),  I = tr(P) 1 - P.
//!          "legacy" (the default) counts |v_k|, "exact" v_k, "convex" the pyramids of the convex
//!          hull, "shell" the triangles: areas for volumes, 1/12 for 1/20
//! Units    of the vertices (m): V in m^3, or m^2 of a shell; I per kg in m^2
//! Valid    "exact" for closed meshes whose triangles agree in their orientation
//! Fails    `None` without triangles, without a hull that encloses all vertices, or for a volume that
//!          is not positive
//! Source   mujoco.readthedocs.io, XML reference, asset/mesh/inertia; the integrals: Mirtich 1996
//! Checked  tests/formats/mesh_masses.rs (against MuJoCo)

use crate::model::convex_hull::convex_hull;
use crate::model::mesh_file::MeshFile;
use crate::spatial::{Mat3, Vec3};

/// `inertia` of a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum MeshInertia {
    Legacy,
    Exact,
    Convex,
    Shell,
}

impl MeshInertia {
    pub(super) fn named(name: Option<&str>) -> Self {
        match name {
            Some("exact") => Self::Exact,
            Some("convex") => Self::Convex,
            Some("shell") => Self::Shell,
            _ => Self::Legacy,
        }
    }
}

/// Volume, centre, and inertia about the centre of 1 kg, in the axes of the shape.
#[derive(Debug, Clone, Copy)]
pub(super) struct Solid {
    pub(super) volume: f64,
    pub(super) centre: Vec3,
    pub(super) inertia: Mat3,
}

/// The solid of a mesh, its vertices scaled.
pub(super) fn solid(mesh: MeshFile, scale: Vec3, kind: MeshInertia) -> Option<Solid> {
    let scaled = |v: Vec3| Vec3::new(v.x * scale.x, v.y * scale.y, v.z * scale.z);
    let mut vertices: Vec<Vec3> = mesh.vertices.into_iter().map(scaled).collect();
    let mut triangles = mesh.triangles.unwrap_or_default();
    if kind == MeshInertia::Convex {
        let faces;
        (vertices, faces) = convex_hull(&vertices)?;
        triangles = faces.iter().map(|f| f.map(|i| i as usize)).collect();
    }
    let corners = triangles.iter().map(|t| t.map(|i| vertices[i]));
    let corners: Vec<[Vec3; 3]> = corners.collect();
    let area = |[a, b, c]: [Vec3; 3]| 0.5 * (b - a).cross(c - a).norm();
    let middle = |[a, b, c]: [Vec3; 3]| (a + b + c) * (1.0 / 3.0);
    // Volume, or area of a shell, of a triangle seen from an apex.
    let share = |t: [Vec3; 3], apex: Vec3| {
        let [a, b, c] = t.map(|v| v - apex);
        let pyramid = a.dot(b.cross(c)) / 6.0;
        match kind {
            MeshInertia::Legacy => pyramid.abs(),
            MeshInertia::Exact | MeshInertia::Convex => pyramid,
            MeshInertia::Shell => area(t),
        }
    };
    let mean = |weight: &dyn Fn([Vec3; 3]) -> f64, point: &dyn Fn([Vec3; 3]) -> Vec3| {
        let sum: f64 = corners.iter().map(|t| weight(*t)).sum();
        let moment = corners.iter().fold(Vec3::ZERO, |m, t| m + point(*t) * weight(*t));
        (sum, moment * (1.0 / sum))
    };
    let (_, apex) = mean(&area, &middle);
    let far = if kind == MeshInertia::Shell { 1.0 } else { 0.75 };
    let point = |t: [Vec3; 3]| apex + (middle(t) - apex) * far;
    let (_, centre) = mean(&|t| share(t, apex), &point);
    let volume: f64 = corners.iter().map(|t| share(*t, centre)).sum();
    if !(volume > 0.0 && volume.is_finite() && centre.is_finite()) {
        return None;
    }
    let factor = if kind == MeshInertia::Shell { 1.0 / 12.0 } else { 1.0 / 20.0 };
    let mut products = [[0.0; 3]; 3];
    for t in &corners {
        let weight = factor * share(*t, centre);
        let v = t.map(|v| (v - centre).to_array());
        for (i, row) in products.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                // 2 sum v v^T + sum of mixed = sum v v^T + (sum v) (sum v)^T
                let own: f64 = v.iter().map(|x| x[i] * x[j]).sum();
                let sum = |k: usize| v.iter().map(|x| x[k]).sum::<f64>();
                *entry += weight * (own + sum(i) * sum(j));
            }
        }
    }
    let trace = products[0][0] + products[1][1] + products[2][2];
    let inertia = std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let diagonal = if i == j { trace } else { 0.0 };
            (diagonal - products[i][j]) / volume
        })
    });
    Some(Solid { volume, centre, inertia: Mat3::from_rows(inertia) })
}
