//! The type II locus of a 3-RPR at constant orientation is a conic: three legs that meet in a point.

use cylindroid::linalg::Svd;
use cylindroid::sweep::{LocusKind, Map, MapOptions};
use cylindroid::{Matrix, Vec3};

use crate::five_bar::axis;
use crate::robots::three_rpr;

pub(crate) const BASE: [[f64; 2]; 3] = [[-1.0, -0.8], [1.2, -0.7], [0.1, 1.3]];
pub(crate) const PLATFORM: [[f64; 2]; 3] = [[-0.4, -0.2], [0.5, -0.3], [0.1, 0.4]];

/// The determinant of the lines of the legs with the platform at (x, y), turned by an angle.
pub(crate) fn determinant([x, y]: [f64; 2], turn: f64) -> f64 {
    let (s, c) = turn.sin_cos();
    let line = |i: usize| {
        let [bx, by] = PLATFORM[i];
        let end = [x + c * bx - s * by, y + s * bx + c * by];
        let (dx, dy) = (end[0] - BASE[i][0], end[1] - BASE[i][1]);
        Vec3::new(dx, dy, end[0] * dy - end[1] * dx)
    };
    line(0).dot(line(1).cross(line(2)))
}

/// Sefrioui & Gosselin 1995: a polynomial of second degree in x and y.
#[test]
fn the_locus_is_the_conic() {
    for turn in [0.0, 0.3, -0.7] {
        // Six values determine the conic; a seventh confirms it.
        let points = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0], [1.0, 1.0]];
        let terms = |[x, y]: [f64; 2]| [1.0, x, y, x * x, x * y, y * y];
        let system = Matrix::from_fn(6, 6, |i, j| terms(points[i])[j]);
        let values: Vec<f64> = points.iter().map(|p| determinant(*p, turn)).collect();
        let svd = Svd::of(&system);
        let coefficients: Vec<f64> = (0..6)
            .map(|j| {
                (0..6)
                    .map(|k| {
                        let along: f64 = svd.u(k).iter().zip(&values).map(|(u, b)| u * b).sum();
                        svd.v(k)[j] * along / svd.value(k)
                    })
                    .sum()
            })
            .collect();
        let sum =
            |p: [f64; 2]| -> f64 { terms(p).iter().zip(&coefficients).map(|(a, b)| a * b).sum() };
        let size = |p: [f64; 2]| -> f64 {
            terms(p).iter().zip(&coefficients).map(|(a, b)| (a * b).abs()).sum()
        };
        let conic = |p: [f64; 2]| sum(p) / size(p);
        assert!((sum([0.3, -0.6]) - determinant([0.3, -0.6], turn)).abs() < 1e-12);
        let mechanism = three_rpr(BASE, PLATFORM, "limits = { lower = -0.75, upper = 4.0 }");
        let map = Map::of(
            &mechanism,
            MapOptions {
                axes: vec![axis("x", -2.03, 2.01, 41), axis("y", -2.01, 2.07, 41)],
                held: vec![("rz".to_owned(), Some(turn))],
                ..MapOptions::default()
            },
        )
        .unwrap();
        assert_eq!(map.signed, [true, true]);
        let two: Vec<_> = map.loci.iter().filter(|l| l.kind == LocusKind::TypeTwo).collect();
        assert!(!two.is_empty(), "{turn}");
        for locus in two {
            for p in &locus.points {
                let p: [f64; 2] = p.clone().try_into().unwrap();
                assert!(conic(p).abs() < 1e-8, "{p:?} {}", conic(p));
            }
        }
        // Signs of the distance are those of the determinant, up to one for all.
        let mode = map.modes.iter().max_by_key(|mode| mode.cells()).unwrap();
        let mut product = 0.0;
        for cell in (0..map.cells()).filter(|&cell| mode.reached[cell]) {
            let p: [f64; 2] = map.values(cell).try_into().unwrap();
            if conic(p).abs() > 1e-6 {
                let sign = (mode.type_two[cell] * determinant(p, turn)).signum();
                assert!(product == 0.0 || product == sign, "{p:?}");
                product = sign;
            }
        }
        assert_eq!(map.modes.len(), 1, "legs of positive length");
    }
}
