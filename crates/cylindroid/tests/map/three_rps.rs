//! The type II locus of the 3-RPS of the catalogue: three planes of forces and the platform in a point.

use std::f64::consts::TAU;

use cylindroid::sweep::{LocusKind, Map, MapOptions};
use cylindroid::{Mechanism, Vec3, catalogue};

use crate::five_bar::axis;

/// The determinant of four planes in a configuration: those of the forces that the legs transmit, and
/// that of the balls. With the slides locked a leg transmits the forces through its ball that lie in the
/// plane of the ball and of the axis of the base joint; the platform moves nevertheless where the four
/// planes meet in a point, at infinity too.
fn of_planes(mechanism: &Mechanism, q: &[f64]) -> f64 {
    let (state, home) = (mechanism.state(q).unwrap(), mechanism.state(mechanism.home()).unwrap());
    let leg = |i: usize| {
        let (s, c) = (TAU * i as f64 / 3.0).sin_cos();
        let rod = mechanism.frame(&format!("rod{}", i + 1)).unwrap();
        let moved = state.pose(rod).unwrap() * home.pose(rod).unwrap().inverse();
        let ball = moved * Vec3::new(0.5 * c, 0.5 * s, 1.0);
        (ball, (ball - Vec3::new(c, s, 0.0)).cross(Vec3::new(-s, c, 0.0)))
    };
    let legs = [0, 1, 2].map(leg);
    let balls = legs.map(|(ball, _)| ball);
    let normal = (balls[1] - balls[0]).cross(balls[2] - balls[0]);
    let plane = |point: Vec3, normal: Vec3| {
        let n = normal * (1.0 / normal.norm());
        [n.x, n.y, n.z, -n.dot(point)]
    };
    let mut rows: Vec<[f64; 4]> = legs.iter().map(|(ball, n)| plane(*ball, *n)).collect();
    rows.push(plane(balls[0], normal));
    determinant(&rows)
}

fn determinant(rows: &[[f64; 4]]) -> f64 {
    let three = |skip: usize| {
        let columns: Vec<usize> = (0..4).filter(|c| *c != skip).collect();
        let row =
            |r: usize| Vec3::new(rows[r][columns[0]], rows[r][columns[1]], rows[r][columns[2]]);
        row(1).dot(row(2).cross(row(3)))
    };
    rows[0][0] * three(0) - rows[0][1] * three(1) + rows[0][2] * three(2) - rows[0][3] * three(3)
}

/// Ebert-Uphoff, Lee & Lipkin 2002, Characteristic tetrahedron of wrench singularities for parallel
/// manipulators with three legs. Over two tilts at the height of home; the other motions follow.
#[test]
fn the_locus_is_where_four_planes_meet() {
    let mechanism = catalogue::load("3rps").unwrap();
    let map = Map::of(
        &mechanism,
        MapOptions {
            axes: vec![axis("pitch", -1.53, 1.51, 25), axis("roll", -1.51, 1.53, 25)],
            ..MapOptions::default()
        },
    )
    .unwrap();
    assert_eq!(map.free_motions, 0);
    let named: Vec<&str> = map.held.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(named, ["z"]);
    assert!(map.signed[1], "{:?}", map.signed);
    let two: Vec<_> = map.loci.iter().filter(|l| l.kind == LocusKind::TypeTwo).collect();
    let kinds: Vec<_> = map.loci.iter().map(|l| (l.kind, l.points.len())).collect();
    assert!(!two.is_empty(), "{kinds:?}");
    let mut seen = 0;
    for locus in two {
        for q in &locus.q {
            let value = of_planes(&mechanism, q);
            assert!(value.abs() < 1e-8, "{value} at {q:?}");
            seen += 1;
        }
    }
    assert!(seen > 20, "{seen}");
    // The sign of the distance is that of the determinant, up to one for each mode.
    for mode in &map.modes {
        let mut product = 0.0;
        let n = mechanism.n();
        for cell in (0..map.cells()).filter(|&cell| mode.reached[cell]) {
            let value = of_planes(&mechanism, &mode.q[cell * n..(cell + 1) * n]);
            if value.abs() > 1e-6 {
                let sign = (mode.type_two[cell] * value).signum();
                assert!(product == 0.0 || product == sign, "cell {cell}: {value}");
                product = sign;
            }
        }
    }
}
