//! A direction along which all of some vectors advance: the nearest point of their convex hull.
//!
//! Formula  p = the point of conv{a_i} nearest to the origin; a_i . p >= |p|^2 for all i
//! Shapes   a_i, p: n entries
//! Units    none (scaled)
//! Valid    any vectors. The direction is verified; none is returned where the origin is in the
//!          hull, or nearer to it than the steps resolve
//! Why so   it moves with the vectors when they are rotated, unlike the vertex of a linear program
//! Source   Mitchell, Demyanov & Malozemov 1974
//! Checked  tests/it/closure/grasp_mobility/mod.rs::escapes_*

use crate::linalg::dot;
use crate::scalar::clamp;

/// Maximum number of steps.
const MAX_STEPS: usize = 20_000;

/// A direction with a positive product with each of the vectors, if there is one.
pub(super) fn separating_direction(vectors: &[Vec<f64>]) -> Option<Vec<f64>> {
    let count = vectors.len();
    let mut p = vec![0.0; vectors.first()?.len()];
    let mut weights = vec![1.0 / f64::from(u32::try_from(count).ok()?); count];
    for (vector, weight) in vectors.iter().zip(&weights) {
        p.iter_mut().zip(vector).for_each(|(p, v)| *p += weight * v);
    }
    for _ in 0..MAX_STEPS {
        let products: Vec<f64> = vectors.iter().map(|v| dot(v, &p)).collect();
        let lowest = (0..count).min_by(|&i, &j| products[i].total_cmp(&products[j]))?;
        if products[lowest] > 0.5 * dot(&p, &p) {
            return Some(p);
        }
        let used = (0..count).filter(|&i| weights[i] > 0.0);
        let highest = used.max_by(|&i, &j| products[i].total_cmp(&products[j]))?;
        let step: Vec<f64> =
            vectors[lowest].iter().zip(&vectors[highest]).map(|(l, h)| l - h).collect();
        let size = dot(&step, &step);
        if !(size > 0.0) {
            return None;
        }
        let share = clamp(-dot(&step, &p) / size, 0.0, weights[highest]);
        weights[lowest] += share;
        weights[highest] -= share;
        p.iter_mut().zip(&step).for_each(|(p, s)| *p += share * s);
    }
    None
}
