//! Polytopes of velocity and force from the limits of the drives.

use cylindroid::Matrix;
use cylindroid::closure::{Constraint, MotionSpace, Relation};
use cylindroid::linalg::Interval;
use cylindroid::manipulability::{force_polytope, force_range, velocity_polytope, velocity_range};

use crate::closure::case::{case, cases};
use crate::support::{Random, assert_close};

fn serial(jacobian: &Matrix) -> Relation {
    MotionSpace::of(&Constraint::serial(jacobian).unwrap()).relation()
}

fn symmetric(limits: &[f64]) -> Vec<Interval> {
    limits.iter().map(|l| Interval::symmetric(*l)).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// The image of a box: `h(n) = sum |n . J e_i| limit_i`, and of forces the polar of the one of
/// unit torques.
#[test]
fn redundant_arm_in_the_plane() {
    let mut random = Random(93);
    for n in [2, 3, 5] {
        let j = random.matrix(2, n);
        let limits: Vec<f64> = (0..n).map(|_| random.within(0.3, 2.0)).collect();
        let velocity = velocity_polytope(&serial(&j), &symmetric(&limits)).unwrap();
        // n directions make a polygon of 2 n sides.
        assert_eq!(velocity.hull.polygon().len(), 2 * n);
        assert_eq!((velocity.hull.facets.len(), velocity.unbounded.cols()), (2 * n, 0));
        for facet in &velocity.hull.facets {
            let h: f64 = (0..n).map(|i| dot(&facet.normal, j.column(i)).abs() * limits[i]).sum();
            assert!((facet.offset - h).abs() < 1e-12 * h);
        }
        // |J^T w| <= limits.
        let force = force_polytope(&serial(&j), &symmetric(&limits)).unwrap();
        for w in &force.hull.vertices {
            let torque = j.transpose().mul_vec(w);
            let share: Vec<f64> = torque.iter().zip(&limits).map(|(t, l)| t.abs() / l).collect();
            assert!(share.iter().all(|s| *s <= 1.0 + 1e-12), "{share:?}");
            assert!(share.iter().filter(|s| **s > 1.0 - 1e-12).count() >= 2, "{share:?}");
        }
        for facet in &force.hull.facets {
            // Its normal is a column of J.
            let along = (0..n).any(|i| {
                let a = j.column(i);
                (dot(&facet.normal, a).abs() - dot(a, a).sqrt()).abs() < 1e-12
            });
            assert!(along, "{facet:?}");
        }
    }
}

/// A cube of rates seen from anywhere: a rhombic dodecahedron for four directions in space.
#[test]
fn four_joints_in_space() {
    let s = 1.0;
    let j = Matrix::from_rows(&[[s, s, -s, -s], [s, -s, s, -s], [s, -s, -s, s]]).unwrap();
    let velocity = velocity_polytope(&serial(&j), &symmetric(&[1.0; 4])).unwrap();
    assert!(velocity.hull.complete);
    assert_eq!(velocity.hull.vertices.len(), 14);
    // Twelve rhombi in two triangles each.
    assert_eq!(velocity.hull.facets.len(), 24);
}

/// Every corner is a motion (a balance) of the mechanism with the drives within their limits.
#[test]
fn corners_of_closed_chains() {
    let mut random = Random(94);
    for case in cases() {
        let relation = MotionSpace::of(&case.constraint()).relation();
        // In space only a task of two: there are many corners in six dimensions.
        let relation = if relation.object() > 3 {
            let task = Matrix::from_fn(2, 6, |i, j| f64::from(u8::from(i == j)));
            relation.task(&task).unwrap()
        } else {
            relation
        };
        let limits: Vec<f64> = (0..relation.joints()).map(|_| random.within(0.5, 2.0)).collect();
        for (polytope, parts) in [
            (velocity_polytope(&relation, &symmetric(&limits)).unwrap(), relation.motions()),
            (force_polytope(&relation, &symmetric(&limits)).unwrap(), relation.forces()),
        ] {
            assert!(polytope.hull.complete, "{}", case.name);
            assert_eq!(polytope.hull.span.cols(), parts.object.cols(), "{}", case.name);
            assert_eq!(polytope.unbounded, parts.infinite);
            for facet in &polytope.hull.facets {
                // About zero: the opposite facet is as far.
                assert!(facet.offset > 0.0, "{}", case.name);
            }
            for v in &polytope.hull.vertices {
                // y from u = object y; some z keeps |joint y + zero z| within the limits.
                let inverse = cylindroid::inverse::truncated(&parts.object, 1e-12).unwrap().matrix;
                let y = inverse.mul_vec(v);
                assert_close("u", &parts.object.mul_vec(&y), v, 1e-11 * (1.0 + dot(v, v).sqrt()));
                if parts.zero.cols() == 0 {
                    let q = parts.joint.mul_vec(&y);
                    let share: Vec<f64> = q.iter().zip(&limits).map(|(q, l)| q.abs() / l).collect();
                    assert!(share.iter().all(|s| *s <= 1.0 + 1e-9), "{} {share:?}", case.name);
                    let met = share.iter().filter(|s| **s > 1.0 - 1e-9).count();
                    assert!(met >= y.len(), "{} {share:?}", case.name);
                }
            }
        }
    }
}

/// All five joints driven bind each other: less than any two of them alone would allow, and the
/// torques of all together hold more.
#[test]
fn more_drives_bind_motion_and_help_force() {
    let relation = |name| MotionSpace::of(&case(name).constraint()).relation();
    let (two, five) = (relation("fivebar_sec5_case_a"), relation("fivebar_sec5_case_c"));
    let reach = |hull: &cylindroid::linalg::Hull, n: &[f64]| {
        hull.vertices.iter().map(|v| dot(n, v)).fold(0.0, f64::max)
    };
    let slow = velocity_polytope(&five, &symmetric(&[1.0; 5])).unwrap();
    let fast = velocity_polytope(&two, &symmetric(&[1.0; 2])).unwrap();
    let strong = force_polytope(&five, &symmetric(&[1.0; 5])).unwrap();
    let weak = force_polytope(&two, &symmetric(&[1.0; 2])).unwrap();
    let mut random = Random(95);
    for _ in 0..50 {
        let n = random.vector(3);
        assert!(reach(&slow.hull, &n) <= reach(&fast.hull, &n) + 1e-12);
        assert!(reach(&strong.hull, &n) >= reach(&weak.hull, &n) - 1e-12);
    }
    // The structural wrench has no limit.
    assert_eq!((weak.unbounded.cols(), weak.hull.span.cols()), (1, 2));
}

#[test]
fn limits_that_are_none() {
    let relation = serial(&Matrix::identity(2));
    for limits in [&[1.0, 0.0][..], &[1.0, f64::INFINITY], &[f64::NAN, 1.0], &[1.0]] {
        let error = velocity_polytope(&relation, &symmetric(limits)).unwrap_err().to_string();
        assert!(error.starts_with("velocity limit"), "{error}");
    }
    // Without a size that can be squared.
    for limits in [[1e-121, 1.0], [1.0, 1.1e120], [5e-324, 5e-324]] {
        let error = velocity_range(&relation, &symmetric(&limits)).unwrap_err().to_string();
        assert!(error.contains("from 1e-120 to 1e120"), "{error}");
    }
    let range = velocity_range(&relation, &symmetric(&[1e-120, 1e120])).unwrap();
    for (r, l) in range.iter().zip([1e-120, 1e120]) {
        assert!((r.upper / l - 1.0).abs() < 1e-14 && r.lower == -r.upper, "{range:?}");
    }
    // Nothing driven: nothing moves on command.
    let none = velocity_polytope(&serial(&Matrix::zeros(3, 0)), &[]).unwrap();
    assert_eq!((none.hull.vertices.len(), none.hull.span.cols()), (1, 0));
}

/// Rates that differ both ways: the image of the box is moved by its middle. Torques: the facets
/// are those of each limit.
#[test]
fn limits_that_differ_both_ways() {
    let mut random = Random(96);
    for n in [2, 3, 5] {
        let j = random.matrix(2, n);
        let limits: Vec<Interval> = (0..n)
            .map(|i| Interval {
                lower: if i == 0 { 0.0 } else { -random.within(0.1, 2.0) },
                upper: random.within(0.3, 2.0),
            })
            .collect();
        let relation = serial(&j);
        let velocity = velocity_polytope(&relation, &limits).unwrap();
        assert_eq!(velocity.hull.polygon().len(), 2 * n);
        let support = |normal: &[f64]| -> f64 {
            let end = |i: usize| {
                let along = dot(normal, j.column(i));
                along * if along > 0.0 { limits[i].upper } else { limits[i].lower }
            };
            (0..n).map(end).sum()
        };
        for facet in &velocity.hull.facets {
            assert!((facet.offset - support(&facet.normal)).abs() < 1e-12);
        }
        let range = velocity_range(&relation, &limits).unwrap();
        for (i, r) in range.iter().enumerate() {
            let e: Vec<f64> = (0..2).map(|l| f64::from(u8::from(l == i))).collect();
            let minus: Vec<f64> = e.iter().map(|x| -x).collect();
            assert_close("range", &[r.lower, r.upper], &[-support(&minus), support(&e)], 1e-12);
        }
        // Torques -J^T w within their limits, and two of them at one.
        let force = force_polytope(&relation, &limits).unwrap();
        for w in &force.hull.vertices {
            let torque: Vec<f64> = j.transpose().mul_vec(w).iter().map(|t| -t).collect();
            let room = torque.iter().zip(&limits).map(|(t, l)| (t - l.lower).min(l.upper - t));
            assert!(room.clone().all(|r| r > -1e-12), "{torque:?} {limits:?}");
            assert!(room.filter(|r| *r < 1e-12).count() >= 2, "{torque:?} {limits:?}");
        }
    }
}

/// Cables only pull: two of them on a mass in the plane hold what lies between their directions.
#[test]
fn cables_hold_a_cone() {
    // tau = -J^T w: a cable of length l pulls with its tension, J its direction.
    let j = Matrix::from_rows(&[[1.0, 0.0], [0.0, 1.0]]).unwrap();
    let pulls = vec![Interval { lower: 0.0, upper: 3.0 }; 2];
    let force = force_polytope(&serial(&j), &pulls).unwrap();
    for w in &force.hull.vertices {
        assert!(w.iter().all(|x| (-3.0 - 1e-12..=1e-12).contains(x)), "{w:?}");
    }
    assert_eq!(force.hull.vertices.len(), 4);
}

/// What nothing limits has no end, and what is limited ends at the hull.
#[test]
fn ranges_of_closed_chains() {
    for case in cases().iter().filter(|c| c.task.is_none()) {
        let relation = MotionSpace::of(&case.constraint()).relation();
        let limits = symmetric(&vec![1.0; relation.joints()]);
        for (range, parts) in [
            (velocity_range(&relation, &limits).unwrap(), relation.motions()),
            (force_range(&relation, &limits).unwrap(), relation.forces()),
        ] {
            assert_eq!(range.len(), relation.object());
            for (i, r) in range.iter().enumerate() {
                let free = (0..parts.infinite.cols()).any(|l| parts.infinite[(i, l)].abs() > 1e-6);
                assert_eq!(r.upper.is_infinite(), free, "{} {i}", case.name);
                assert!(free || (r.lower + r.upper).abs() < 1e-9 * (1.0 + r.upper));
            }
        }
        if relation.object() == 3 {
            let hull = velocity_polytope(&relation, &limits).unwrap().hull;
            let range = velocity_range(&relation, &limits).unwrap();
            for i in (0..3).filter(|i| range[*i].upper.is_finite()) {
                let top = hull.vertices.iter().map(|v| v[i]).fold(0.0, f64::max);
                if relation.motions().infinite.cols() == 0 {
                    assert!((top - range[i].upper).abs() < 1e-9 * (1.0 + top), "{}", case.name);
                }
            }
        }
    }
}
