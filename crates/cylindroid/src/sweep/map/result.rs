//! The parts of a map: working modes and loci.
//!
//! Checked  tests/map/five_bar.rs, tests/map/options.rs, tests/map/surfaces.rs

use super::flood::Flooded;
use crate::model::Mechanism;

/// A working mode: configurations that are connected without a singularity of type I between them.
#[derive(Debug, Clone, PartialEq)]
pub struct WorkingMode {
    /// For each cell whether the mode reaches it.
    pub reached: Vec<bool>,
    /// The configuration at each cell, n numbers [rad or m], not a number where it is not reached.
    pub q: Vec<f64>,
    /// For each cell the distance to a singularity of type I (inverse kinematics): smallest generic
    /// over largest singular value of the loops, the platform's prescribed components at rest; with
    /// a sign where one exists [-].
    pub type_one: Vec<f64>,
    /// The same of type II (forward kinematics): with the actuated joints at rest [-].
    pub type_two: Vec<f64>,
    /// Smallest distance to a position limit [rad or m]; infinite without limits.
    pub limit_distance: Vec<f64>,
}

impl WorkingMode {
    /// Number of cells that it reaches.
    #[must_use]
    pub fn cells(&self) -> usize {
        self.reached.iter().filter(|r| **r).count()
    }
}

/// What happens on a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum LocusKind {
    /// Actuated joints move while the platform rests: the boundary of the mode's workspace.
    TypeOne,
    /// The platform moves while the actuated joints rest.
    TypeTwo,
    /// Passive joints alone move, platform and actuated joints rest.
    Passive,
    /// A joint is at a position limit.
    Limit,
}

impl LocusKind {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::TypeOne, Self::TypeTwo, Self::Passive, Self::Limit];

    /// Its name: "type I", "type II", "passive" or "limit".
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::TypeOne => "type I",
            Self::TypeTwo => "type II",
            Self::Passive => "passive",
            Self::Limit => "limit",
        }
    }
}

/// A curve of singular configurations, or of configurations at a limit.
#[derive(Debug, Clone, PartialEq)]
pub struct Locus {
    /// What happens there.
    pub kind: LocusKind,
    /// The coordinate at its limit.
    pub limit: Option<String>,
    /// The modes that it belongs to: those that meet at a singularity of type I.
    pub modes: Vec<usize>,
    /// True if the last point is the first.
    pub closed: bool,
    /// The values of the axes at its points.
    pub points: Vec<Vec<f64>>,
    /// The configurations there [rad or m].
    pub q: Vec<Vec<f64>>,
}

/// A surface of singular configurations of one mode, as triangles.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    /// What happens at most of its vertices: [`LocusKind::TypeTwo`] or [`LocusKind::Passive`]. Where
    /// sheets of both kinds cross, the triangles join them to one surface.
    pub kind: LocusKind,
    /// The mode that it belongs to.
    pub mode: usize,
    /// True if each side of a triangle is one of another. Otherwise it ends with the grid or the mode, or
    /// where the way along an edge leaves the branch or the distance jumps.
    pub closed: bool,
    /// The values of the axes at its vertices [m or rad].
    pub vertices: Vec<[f64; 3]>,
    /// Three vertices each, counterclockwise as seen from where the distance of type II is positive, with
    /// the axes in their order as x, y and z.
    pub triangles: Vec<[usize; 3]>,
    /// The configurations at the vertices [rad or m].
    pub q: Vec<Vec<f64>>,
}

impl Surface {
    /// The section with the plane in which the third axis has a value: the values of the other two at
    /// both ends of each segment. A side of a triangle within the plane belongs to the triangle below it
    /// alone, or with `from_above` to the one above, as where the grid begins.
    #[must_use]
    pub fn section(&self, value: f64, from_above: bool) -> Vec<[[f64; 2]; 2]> {
        let below = |z: f64| if from_above { z <= value } else { z < value };
        let segment = |triangle: &[usize; 3]| {
            let corners = triangle.map(|vertex| self.vertices[vertex]);
            let mut ends = [0, 1, 2].into_iter().filter_map(|i| {
                let (a, b) = (corners[i], corners[(i + 1) % 3]);
                if below(a[2]) == below(b[2]) {
                    return None;
                }
                let share = (value - a[2]) / (b[2] - a[2]);
                Some([0, 1].map(|axis| a[axis] + share * (b[axis] - a[axis])))
            });
            Some([ends.next()?, ends.next()?])
        };
        self.triangles.iter().filter_map(segment).collect()
    }
}

/// A mode without platform coordinates.
pub(super) fn working_mode(mechanism: &Mechanism, mode: Flooded) -> WorkingMode {
    let n = mechanism.n();
    let cells = mode.reached.len();
    let all = mode.q.len() / cells.max(1);
    let mut q = Vec::with_capacity(cells * n);
    let mut limit_distance = Vec::with_capacity(cells);
    for row in mode.q.chunks(all.max(1)) {
        q.extend_from_slice(&row[..n]);
        let distances = mechanism
            .coordinates()
            .iter()
            .zip(row)
            .map(|(c, x)| (x - c.limits.lower).min(c.limits.upper - x));
        let least = distances.fold(f64::INFINITY, f64::min);
        limit_distance.push(if row[0].is_nan() { f64::NAN } else { least });
    }
    WorkingMode {
        reached: mode.reached,
        q,
        type_one: mode.type_one,
        type_two: mode.type_two,
        limit_distance,
    }
}
