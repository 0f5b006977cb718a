//! The type II locus of the 3-RPS of the catalogue: three planes of forces and the platform in a point.

use cylindroid::sweep::{LocusKind, Map, MapOptions};
use cylindroid::{Mechanism, Vec3, catalogue};

use crate::five_bar::axis;

/// The determinant of the planes of the forces that the legs transmit, and that of the balls, in a
/// configuration: zero where they meet in a point, at infinity too.
///
/// A leg transmits the forces through its ball in the plane of the slide and the axis of the base joint.
/// With the slides locked the platform moves where these three pencils and it have a point in common: all
/// wrenches then meet one line of the platform through this point, or they do at infinity.
fn of_planes(mechanism: &Mechanism, q: &[f64]) -> f64 {
    let state = mechanism.state(q).unwrap();
    let rods: Vec<_> = (1..=3)
        .map(|i| {
            let pose = |link: String| state.pose(mechanism.frame(&link).unwrap()).unwrap();
            let home = mechanism.state(mechanism.home()).unwrap();
            let at_home = |link: String| home.pose(mechanism.frame(&link).unwrap()).unwrap();
            let angle = core::f64::consts::TAU * f64::from(i - 1) / 3.0;
            let (ball, base) = (
                Vec3::new(0.5 * angle.cos(), 0.5 * angle.sin(), 1.0),
                Vec3::new(angle.cos(), angle.sin(), 0.0),
            );
            let tangent = Vec3::new(-angle.sin(), angle.cos(), 0.0);
            let rod = pose(format!("rod{i}")) * at_home(format!("rod{i}")).inverse();
            let ball = rod * ball;
            (ball, (ball - base).cross(tangent))
        })
        .collect();
    let balls: Vec<Vec3> = rods.iter().map(|(ball, _)| *ball).collect();
    let normal = (balls[1] - balls[0]).cross(balls[2] - balls[0]);
    let plane = |point: Vec3, normal: Vec3| {
        let n = normal * (1.0 / normal.norm());
        [n.x, n.y, n.z, -n.dot(point)]
    };
    let mut rows: Vec<[f64; 4]> = rods.iter().map(|(ball, n)| plane(*ball, *n)).collect();
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

/// Over two tilts at the height of home, with the parasitic motions that follow from them.
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
