//! Hulls by farthest points.

use super::*;
use crate::linalg::test_support::Random;

const WHOLE: HullOptions =
    HullOptions { goal: HullGoal::Whole, tolerance: 1e-9, max_facets: 10_000 };

fn support(points: &[Vec<f64>]) -> impl FnMut(&[f64]) -> Vec<f64> + '_ {
    |n| points.iter().max_by(|p, q| dot(n, p).total_cmp(&dot(n, q))).unwrap().clone()
}

/// Corners of the cube of d dimensions.
fn cube(d: usize) -> Vec<Vec<f64>> {
    (0..1 << d)
        .map(|bits| (0..d).map(|i| if bits >> i & 1 == 1 { 1.0 } else { -1.0 }).collect())
        .collect()
}

#[test]
fn cubes() {
    for d in 1..=5 {
        let points = cube(d);
        let hull = Hull::of(d, support(&points), WHOLE);
        assert!(hull.complete);
        assert_eq!((hull.vertices.len(), hull.span.cols()), (1 << d, d));
        for facet in &hull.facets {
            assert!((facet.offset - 1.0).abs() < 1e-12, "{d}: {facet:?}");
            let largest = facet.normal.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
            assert!((largest - 1.0).abs() < 1e-12);
            assert_eq!(facet.vertices.len(), d);
        }
        // Volume by the simplices from the middle: (offset * area) / d.
        if d == 2 {
            assert_eq!(hull.polygon().len(), 4);
        }
    }
}

/// All points lie behind all facets, every facet holds its corners, and inner points are no
/// vertices.
#[test]
fn random_points() {
    let mut random = Random(91);
    for d in 1..=5 {
        for count in [d + 1, 2 * d + 3, 40] {
            let points: Vec<Vec<f64>> = (0..count).map(|_| random.vector(d)).collect();
            let hull = Hull::of(d, support(&points), WHOLE);
            assert!(hull.complete);
            for facet in &hull.facets {
                for p in &points {
                    assert!(dot(&facet.normal, p) <= facet.offset + 1e-9);
                }
                for &v in &facet.vertices {
                    assert!((dot(&facet.normal, &hull.vertices[v]) - facet.offset).abs() < 1e-12);
                }
            }
            assert!(hull.vertices.iter().all(|v| points.contains(v)));
        }
    }
}

/// A square in space, a segment, a point.
#[test]
fn flat_bodies() {
    let square: Vec<Vec<f64>> = cube(2).iter().map(|p| vec![p[0], p[1], p[0] + 2.0]).collect();
    let hull = Hull::of(3, support(&square), WHOLE);
    assert_eq!((hull.span.cols(), hull.vertices.len(), hull.facets.len()), (2, 4, 4));
    let polygon = hull.polygon();
    for i in 0..4 {
        let (a, b) = (polygon[i], polygon[(i + 1) % 4]);
        let side: f64 = a.iter().zip(b).map(|(x, y)| (x - y).powi(2)).sum();
        assert!(side < 8.1, "neighbours on the rim: {polygon:?}");
    }
    let segment = vec![vec![0.0, 1.0], vec![2.0, 1.0]];
    let hull = Hull::of(2, support(&segment), WHOLE);
    assert_eq!((hull.span.cols(), hull.vertices.len(), hull.facets.len()), (1, 2, 2));
    let hull = Hull::of(3, |_| vec![1.0, 2.0, 3.0], WHOLE);
    assert_eq!((hull.span.cols(), hull.vertices.len(), hull.facets.len()), (0, 1, 0));
    assert!(Hull::of(0, |_| vec![], WHOLE).complete);
}

/// The ball is approached from inside; the nearest facet alone is found with few of them.
#[test]
fn curved_bodies() {
    // An ellipsoid about (0, 0.1, 0) with semi-axes 1, 0.5, 0.8: the nearest plane is at 0.4.
    let axes = [1.0, 0.5, 0.8];
    let ellipsoid = |n: &[f64]| {
        let scaled: Vec<f64> = n.iter().zip(axes).map(|(x, a)| x * a).collect();
        let norm = dot(&scaled, &scaled).sqrt();
        (0..3).map(|i| scaled[i] * axes[i] / norm + if i == 1 { 0.1 } else { 0.0 }).collect()
    };
    let options = HullOptions { goal: HullGoal::NearestFacet, tolerance: 1e-3, max_facets: 10_000 };
    let hull = Hull::of(3, ellipsoid, options);
    assert!(hull.complete);
    let nearest = hull.nearest_facet().unwrap();
    assert!(nearest.offset < 0.4 && nearest.offset + nearest.gap >= 0.4 - 1e-12, "{nearest:?}");
    assert!(nearest.gap < 2.2e-3 && hull.facets.len() < 200, "{}", hull.facets.len());
    // Too few facets allowed: the answer says so.
    let few = HullOptions { max_facets: 10, goal: HullGoal::Whole, ..options };
    assert!(!Hull::of(3, ellipsoid, few).complete);
}
