//! Extreme equilibrium forces: the edges of the cone of normal forces that balance each other.
//!
//! Formula  f = sum a_r f_r, a_r >= 0, for all f >= 0 with G f = 0; each f_r has a minimal set of
//!          pressing fingers. Double description: the edges of the orthant are cut by one
//!          hyperplane of the row space of G after the other
//! Shapes   G: d x k, f_r: k entries that sum to 1
//! Units    G scaled
//! Valid    up to [`MAX_CONTACTS`] contacts and [`MAX_EDGES`] edges
//! Why so   a few dozen edges at most in practice: two pairs of opposite fingers have two
//! Source   Motzkin et al. 1953; combinatorial test of neighbours Fukuda & Prodon 1996
//! Checked  tests/it/closure/grasp_mobility/mod.rs::equilibria_*

use crate::linalg::{ColumnSpace, Cut, Matrix, Threshold, dot};
use crate::tolerance::{CLOSURE_RANK, EQUILIBRIUM};

/// Maximum number of contacts.
pub(super) const MAX_CONTACTS: usize = 64;
/// Maximum number of edges at any step.
pub(super) const MAX_EDGES: usize = 1000;

/// The edges of the cone, and the cut of the rank of G.
pub(super) struct EquilibriumForces {
    pub(super) edges: Vec<Vec<f64>>,
    pub(super) cut: Cut,
}

struct Edge {
    forces: Vec<f64>,
    pressing: u64,
}

impl Edge {
    /// With forces that sum to one; those of rounding size are zero.
    fn new(mut forces: Vec<f64>) -> Self {
        let sum: f64 = forces.iter().sum();
        let mut pressing = 0;
        for (i, force) in forces.iter_mut().enumerate() {
            *force = if *force > EQUILIBRIUM * sum { *force / sum } else { 0.0 };
            pressing |= u64::from(*force > 0.0) << i;
        }
        Self { forces, pressing }
    }
}

impl EquilibriumForces {
    /// Of the scaled matrix G; none if there are more than [`MAX_EDGES`].
    pub(super) fn of(grasp: &Matrix) -> Option<Self> {
        let k = grasp.cols();
        let space = ColumnSpace::of(&grasp.transpose(), Threshold::Relative(CLOSURE_RANK));
        let planes = space.basis();
        let unit = |i: usize| (0..k).map(|j| if i == j { 1.0 } else { 0.0 }).collect();
        let mut edges: Vec<Edge> = (0..k).map(|i| Edge::new(unit(i))).collect();
        for c in 0..planes.cols() {
            let plane = planes.column(c);
            let values: Vec<f64> = edges.iter().map(|e| dot(plane, &e.forces)).collect();
            let beyond = |sign: f64| {
                let is_beyond = |i: &usize| sign * values[*i] > EQUILIBRIUM;
                (0..values.len()).filter(is_beyond).collect::<Vec<usize>>()
            };
            let (above, below) = (beyond(1.0), beyond(-1.0));
            let mut cut = Vec::new();
            for &i in &above {
                for &j in &below {
                    let union = edges[i].pressing | edges[j].pressing;
                    let between =
                        |(l, e): (usize, &Edge)| l != i && l != j && e.pressing & !union == 0;
                    if edges.iter().enumerate().any(between) {
                        continue;
                    }
                    let pairs = edges[i].forces.iter().zip(&edges[j].forces);
                    let mixed = pairs.map(|(a, b)| values[i] * b - values[j] * a).collect();
                    cut.push(Edge::new(mixed));
                }
            }
            let mut at = 0..edges.len();
            edges.retain(|_| at.next().is_some_and(|i| values[i].abs() <= EQUILIBRIUM));
            edges.extend(cut);
            if edges.len() > MAX_EDGES {
                return None;
            }
        }
        Some(Self { edges: edges.into_iter().map(|e| e.forces).collect(), cut: space.cut() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding is measured by the sum of the forces, however small or large all of them are.
    #[test]
    fn forces_of_rounding_size_are_zero() {
        for size in [1e-6, 1.0, 1e6] {
            let edge = Edge::new([1.0, 3.0, 0.1 * EQUILIBRIUM].map(|f| size * f).to_vec());
            assert_eq!((&edge.forces[2..], edge.pressing), (&[0.0][..], 0b011), "{size}");
            assert!((edge.forces[0] - 0.25).abs() < 1e-9 && (edge.forces[1] - 0.75).abs() < 1e-9);
            let small = Edge::new([1.0, 1.0, 10.0 * EQUILIBRIUM].map(|f| size * f).to_vec());
            assert_eq!(small.pressing, 0b111, "{size}");
        }
    }
}
