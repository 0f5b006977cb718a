//! Maps of a five-bar against its closed form: modes, cells, circles, aligned links.

use std::f64::consts::TAU;

use cylindroid::sweep::{Axis, Locus, LocusKind, Map, MapOptions};
use cylindroid::{Mechanism, Pose, Vec3};

use crate::robots::{circles, five_bar, five_bar_at, place};

pub(crate) fn axis(name: &str, from: f64, to: f64, count: u64) -> Axis {
    Axis { name: name.to_owned(), from, to, count }
}

pub(crate) fn map(mechanism: &Mechanism, axes: Vec<Axis>) -> Map {
    Map::of(mechanism, MapOptions { axes, ..MapOptions::default() }).unwrap()
}

/// Axes on which no point of a circle about (0, 0) or (2, 0) is a cell by accident.
fn axes(count: u64) -> Vec<Axis> {
    vec![axis("x", -2.513, 3.507, count), axis("y", -2.521, 2.511, count)]
}

const PIVOTS: [[f64; 2]; 2] = [[0.0, 0.0], [2.0, 0.0]];

/// Radii of the inner and outer circle about each pivot.
fn radii() -> [[f64; 2]; 2] {
    let root = 2.0_f64.sqrt();
    [[1.0, 3.0], [root - 1.0, root + 1.0]]
}

/// The smallest distance of a point to the circles of type I.
fn to_circles([x, y]: [f64; 2]) -> f64 {
    let of = |(p, r): ([f64; 2], [f64; 2])| {
        let distance = (x - p[0]).hypot(y - p[1]);
        (distance - r[0]).abs().min((distance - r[1]).abs())
    };
    PIVOTS.into_iter().zip(radii()).map(of).fold(f64::INFINITY, f64::min)
}

/// In each cell every mode has the elbows of the closed form, and no mode is where none is.
#[test]
fn modes_are_those_of_the_closed_form() {
    let mechanism = five_bar();
    let map = map(&mechanism, axes(61));
    let [q1, q5] = ["q1", "q5"].map(|name| place(&mechanism, name));
    let n = mechanism.n();
    let mut both = [0; 2];
    for cell in 0..map.cells() {
        let p: [f64; 2] = map.values(cell).try_into().unwrap();
        let root = 2.0_f64.sqrt();
        let elbows = (circles(PIVOTS[0], 2.0, p, 1.0), circles(PIVOTS[1], 1.0, p, root));
        let reached: Vec<&[f64]> = map
            .modes
            .iter()
            .filter(|mode| mode.reached[cell])
            .map(|mode| &mode.q[cell * n..(cell + 1) * n])
            .collect();
        let (Some(left), Some(right)) = elbows else {
            assert!(reached.is_empty(), "{p:?} is out of reach");
            both[0] += 1;
            continue;
        };
        if to_circles(p) < 1e-6 {
            continue;
        }
        both[1] += 1;
        assert_eq!(reached.len(), 4, "{p:?}, {} from a circle", to_circles(p));
        for elbow in left {
            for knee in right {
                let expected = [
                    elbow[1].atan2(elbow[0]) - 0.25 * TAU,
                    (knee[1] - PIVOTS[1][1]).atan2(knee[0] - PIVOTS[1][0]) - 0.25 * TAU,
                ];
                let fits = |q: &&&[f64]| {
                    let apart = [q[q1] - expected[0], q[q5] - expected[1]];
                    // The closed form loses digits near the circles.
                    let slack = 1e-9_f64.max(1e-14 / to_circles(p).sqrt());
                    apart.iter().all(|x| (x - TAU * (x / TAU).round()).abs() < slack)
                };
                assert_eq!(reached.iter().filter(fits).count(), 1, "{p:?} {expected:?}");
            }
        }
    }
    assert!(both.iter().all(|count| *count > 500), "{both:?}");
}

/// The directions of the two distal links at a configuration.
fn distal(mechanism: &Mechanism, q: &[f64]) -> [Vec3; 2] {
    let state = mechanism.state(q).unwrap();
    let at = |frame: &str| state.pose(mechanism.frame(frame).unwrap()).unwrap();
    let joint = |name: &str| {
        let joint = mechanism.joints().iter().find(|j| j.name == name);
        let (link, place) = match joint {
            Some(j) => (j.parent, j.parent_from_joint),
            None => {
                let l = mechanism.loops().iter().find(|l| l.name == name).unwrap();
                (l.a, l.link_a_from_joint)
            }
        };
        (at(&mechanism.links()[link].name) * place).translation
    };
    let tip = joint("q3");
    ["q2", "q4"].map(|name| {
        let link = tip - joint(name);
        link * (1.0 / link.norm())
    })
}

/// Every point of every curve is on its known locus to 1e-8, and curves are whole.
#[test]
fn loci_are_circles_and_aligned_links() {
    let mechanism = five_bar();
    let map = map(&mechanism, axes(61));
    let of = |kind: LocusKind| -> Vec<&Locus> {
        map.loci.iter().filter(|locus| locus.kind == kind).collect()
    };
    let (one, two) = (of(LocusKind::TypeOne), of(LocusKind::TypeTwo));
    assert_eq!(one.len() + two.len(), map.loci.len(), "neither passive curves nor limits");
    for locus in &one {
        for p in &locus.points {
            let p: [f64; 2] = p.clone().try_into().unwrap();
            assert!(to_circles(p) < 1e-8, "{p:?} is {} from a circle", to_circles(p));
        }
        // A fold joins two modes, and goes on where the other leg folds.
        assert!([2, 4].contains(&locus.modes.len()), "{:?}", locus.modes);
    }
    let points: usize = two.iter().map(|locus| locus.points.len()).sum();
    assert!(points > 200, "{points}");
    for locus in &two {
        assert_eq!(locus.modes.len(), 1);
        for q in &locus.q {
            let [a, b] = distal(&mechanism, q);
            assert!(a.cross(b).norm() < 1e-8, "{}", a.cross(b).norm());
        }
        // Open curves end at a boundary of the mode or of the box.
        if !locus.closed {
            for p in [locus.points.first().unwrap(), locus.points.last().unwrap()] {
                let p: [f64; 2] = p.clone().try_into().unwrap();
                let to_box = map.axes.iter().zip(p).fold(f64::INFINITY, |least: f64, (a, x)| {
                    least.min((x - a.from).abs()).min((a.to - x).abs())
                });
                assert!(to_circles(p) < 1e-5 || to_box < 1e-6, "{p:?}");
            }
        }
    }
    // Whole arcs: all points of the outer circle of the left leg that the right leg reaches are near
    // a point of a curve.
    for step in 0..720 {
        let (s, c) = (TAU * f64::from(step) / 720.0).sin_cos();
        let p = [3.0 * c, 3.0 * s];
        let distance = (p[0] - 2.0).hypot(p[1]);
        let inside = map.axes.iter().zip(p).all(|(a, x)| x > a.from && x < a.to);
        let [[_, _], [inner, outer]] = radii();
        if inside && distance > inner + 0.05 && distance < outer - 0.05 {
            let near = |q: &Vec<f64>| (q[0] - p[0]).hypot(q[1] - p[1]) < 0.05;
            assert!(one.iter().any(|locus| locus.points.iter().any(near)), "{p:?}");
        }
    }
}

/// A moved, turned and scaled mechanism has moved, turned and scaled loci.
#[test]
fn loci_move_with_the_mechanism() {
    let plain = map(&five_bar(), axes(31));
    // Turned by a quarter and twice as large, the axes change places.
    let other = five_bar_at(
        Pose {
            rotation: cylindroid::Rotation::about_z(0.25 * TAU),
            ..Pose::from_translation(Vec3::new(5.0, 7.0, 0.0))
        },
        2.0,
    );
    let [x, y] = &axes(31)[..] else { panic!() };
    let turned = map(
        &other,
        vec![
            axis("x", 5.0 - 2.0 * y.to, 5.0 - 2.0 * y.from, 31),
            axis("y", 7.0 + 2.0 * x.from, 7.0 + 2.0 * x.to, 31),
        ],
    );
    assert_eq!(plain.modes.len(), turned.modes.len());
    let cells = |map: &Map| {
        let mut all: Vec<usize> = map.modes.iter().map(|mode| mode.cells()).collect();
        all.sort_unstable();
        all
    };
    assert_eq!(cells(&plain), cells(&turned));
    for kind in LocusKind::ALL {
        let count = |map: &Map| map.loci.iter().filter(|l| l.kind == kind).count();
        assert_eq!(count(&plain), count(&turned), "{kind:?}");
    }
    let back = |p: &[f64]| [(p[1] - 7.0) / 2.0, (5.0 - p[0]) / 2.0];
    for locus in turned.loci.iter().filter(|l| l.kind == LocusKind::TypeOne) {
        assert!(locus.points.iter().all(|p| to_circles(back(p)) < 1e-8));
    }
}
