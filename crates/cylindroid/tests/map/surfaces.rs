//! The type II locus of a 3-RPR over x, y and the angle: a surface of triangles, three legs that meet in
//! a point at each vertex.

use std::collections::BTreeMap;
use std::num::NonZeroUsize;

use cylindroid::spatial::Rotation;
use cylindroid::sweep::{LocusKind, Map, MapOptions, Surface};
use cylindroid::{Mechanism, Pose, Vec3, catalogue};

use crate::five_bar::axis;
use crate::planar_platform::{BASE, PLATFORM, determinant};
use crate::robots::three_rpr_at;

/// Legs of 0.3 m at least: the mode has holes about the joints of the ground, wider than cells.
const LIMITS: &str = "limits = { lower = -0.5, upper = 4.0 }";

/// The map of the mechanism at another place and of another size, over a grid of that size.
fn map_at(world_from_ground: Pose, scale: f64, counts: [u64; 3], limits: &str) -> Map {
    let mechanism = three_rpr_at(BASE, PLATFORM, limits, (world_from_ground, scale));
    let center = world_from_ground.translation;
    Map::of(&mechanism, options(center, scale, counts)).unwrap()
}

fn options(center: Vec3, scale: f64, counts: [u64; 3]) -> MapOptions {
    MapOptions {
        axes: vec![
            axis("x", center.x - 1.03 * scale, center.x + 1.01 * scale, counts[0]),
            axis("y", center.y - 1.01 * scale, center.y + 1.07 * scale, counts[1]),
            axis("rz", -0.83, 0.79, counts[2]),
        ],
        ..MapOptions::default()
    }
}

/// The determinant at a vertex over its largest product, the legs of length one.
fn residual([x, y, angle]: [f64; 3], world_from_ground: Pose, scale: f64) -> f64 {
    let ground_from_world = world_from_ground.inverse();
    let at = ground_from_world * Vec3::new(x, y, 0.0);
    // The platform has the axes of the world at home.
    determinant([at.x / scale, at.y / scale], angle)
}

/// Each inner side of a triangle is one of exactly one other, in the reverse direction; the others are
/// returned with the triangles.
fn rim(surface: &Surface) -> Vec<[usize; 2]> {
    let mut sides = BTreeMap::new();
    for [a, b, c] in &surface.triangles {
        for side in [[*a, *b], [*b, *c], [*c, *a]] {
            assert!(sides.insert(side, ()).is_none(), "a side twice in one direction");
        }
    }
    sides.keys().filter(|[a, b]| !sides.contains_key(&[*b, *a])).copied().collect()
}

#[test]
fn legs_meet_in_a_point_at_each_vertex() {
    let map = map_at(Pose::IDENTITY, 1.0, [15, 16, 9], LIMITS);
    assert!(map.loci.is_empty() && map.signed == [true, true]);
    assert!(!map.surfaces.is_empty());
    let (mut vertices, mut inner) = (0, 0);
    for surface in &map.surfaces {
        assert_eq!((surface.kind, surface.q.len()), (LocusKind::TypeTwo, surface.vertices.len()));
        for vertex in &surface.vertices {
            let value = residual(*vertex, Pose::IDENTITY, 1.0);
            assert!(value.abs() < 1e-8, "{value} at {vertex:?}");
        }
        vertices += surface.vertices.len();
        let rim = rim(surface);
        assert_eq!(surface.closed, rim.is_empty());
        for v in rim.into_iter().flatten() {
            let vertex = surface.vertices[v];
            let ends = is_at_border(&map, vertex) || is_beside_others(&map, surface.mode, vertex);
            assert!(ends, "{vertex:?}");
        }
        inner += surface.triangles.len();
    }
    assert!(vertices > 300 && inner > 500, "{vertices} {inner}");
    // Of each mode all changes of sign between reached neighbours along the axes have a vertex.
    let close = |a: [f64; 3], b: &[f64]| a.iter().zip(b).filter(|(a, b)| a == b).count() >= 2;
    for (number, mode) in map.modes.iter().enumerate() {
        for cell in 0..map.cells() - 1 {
            let next = cell + 1; // along the last axis, unless a row ends
            let (a, b) = (map.values(cell), map.values(next));
            let is_row = a[..2] == b[..2] && mode.reached[cell] && mode.reached[next];
            if !is_row || mode.type_two[cell] * mode.type_two[next] >= 0.0 {
                continue;
            }
            let own = map.surfaces.iter().filter(|surface| surface.mode == number);
            let found = own
                .flat_map(|surface| &surface.vertices)
                .any(|v| close(*v, &a) && v[2] >= a[2] && v[2] <= b[2]);
            let middle = [a[0], a[1], 0.5 * (a[2] + b[2])];
            let ends = is_beside_others(&map, number, middle);
            assert!(found || ends, "between {a:?} and {b:?}");
        }
    }
}

fn is_at_border(map: &Map, vertex: [f64; 3]) -> bool {
    map.axes.iter().zip(vertex).any(|(axis, x)| x == axis.from || x == axis.to)
}

/// True if the mode does not reach one of the cells around.
fn is_beside_others(map: &Map, mode: usize, at: [f64; 3]) -> bool {
    let mode = &map.modes[mode];
    let near = |cell: usize| {
        let steps = map.values(cell).into_iter().zip(at).zip(&map.axes);
        steps.into_iter().all(|((own, x), axis)| {
            let step = (axis.to - axis.from) / (axis.count - 1) as f64;
            (own - x).abs() < 2.0 * step
        })
    };
    (0..map.cells()).any(|cell| !mode.reached[cell] && near(cell))
}

/// Sections at the cells have their ends on the locus, those between them beside it, and they separate the
/// cells of both signs as the picture of a slice shows them.
#[test]
fn sections_separate_the_signs() {
    let map = map_at(Pose::IDENTITY, 1.0, [15, 16, 9], LIMITS);
    let [x, y, third] = [&map.axes[0], &map.axes[1], &map.axes[2]];
    let (mut ends, mut crossed) = (0, 0);
    for place in 0..third.count {
        let value = third.value(place);
        for (number, mode) in map.modes.iter().enumerate() {
            let sections = map.section(number, place).unwrap();
            let segments: Vec<_> = sections.into_iter().map(|(_, ends)| ends).collect();
            for [x, y] in segments.iter().flatten() {
                let value = residual([*x, *y, value], Pose::IDENTITY, 1.0);
                assert!(value.abs() < 1e-8, "{value} at {x} {y}");
                ends += 1;
            }
            // Each change of sign along y has the end of a segment on the edge.
            for (column, row) in (0..x.count).flat_map(|c| (0..y.count - 1).map(move |r| (c, r))) {
                let cell = |row: u64| ((column * y.count + row) * third.count + place) as usize;
                let (a, b) = (cell(row), cell(row + 1));
                let reached = mode.reached[a] && mode.reached[b];
                if !reached || mode.type_two[a] * mode.type_two[b] >= 0.0 {
                    continue;
                }
                let (at, from, to) = (x.value(column), y.value(row), y.value(row + 1));
                let on_edge =
                    |end: &[f64; 2]| (end[0] - at).abs() < 1e-12 && end[1] >= from && end[1] <= to;
                let found = segments.iter().flatten().any(on_edge);
                let middle = [at, 0.5 * (from + to), value];
                assert!(found || is_beside_others(&map, number, middle), "{middle:?}");
                crossed += u32::from(found);
            }
        }
        let between = 0.5 * (value + third.value((place + 1).min(third.count - 1)));
        for [x, y] in map.surfaces.iter().flat_map(|s| s.section(between, false)).flatten() {
            let value = residual([x, y, between], Pose::IDENTITY, 1.0);
            assert!(value.abs() < 0.05, "{value} at {x} {y}");
        }
    }
    assert!(ends > 300 && crossed > 50, "{ends} {crossed}");
    let beyond = map.surfaces.iter().flat_map(|s| s.section(third.to + 0.1, false));
    assert_eq!(beyond.count(), 0);
    let refused = |mode, place| map.section(mode, place).unwrap_err().to_string();
    assert!(refused(0, 9).contains("'rz' has 9 values"), "{}", refused(0, 9));
    assert!(refused(99, 0).contains("modes"), "{}", refused(99, 0));
}

/// Of a 3-RRR with eight modes, none of which reaches all cells: here all edges have their vertices, and a
/// surface ends at the border of the grid or beside a cell that its mode does not reach.
#[test]
fn surfaces_end_with_the_grid_or_the_mode() {
    let mechanism = catalogue::load("3rrr").unwrap();
    let axes =
        vec![axis("x", -0.31, 0.29, 11), axis("y", -0.29, 0.31, 11), axis("rz", -1.21, 1.19, 13)];
    let options = MapOptions { axes, starts: 16, ..MapOptions::default() };
    let map = Map::of(&mechanism, options).unwrap();
    let mut ends = [0, 0];
    for surface in &map.surfaces {
        for v in rim(surface).into_iter().flatten() {
            let vertex = surface.vertices[v];
            let at_border = is_at_border(&map, vertex);
            assert!(at_border || is_beside_others(&map, surface.mode, vertex), "{vertex:?}");
            ends[usize::from(at_border)] += 1;
        }
    }
    assert!(ends.iter().all(|count| *count > 20), "{ends:?}");
}

/// The normals point to positive distances: the plane of a triangle has the two ends of each edge on which
/// it has a corner on its two sides, the cell with the positive distance on that of the normal.
#[test]
fn normals_point_to_positive_distances() {
    const NEAR: f64 = 1e-6; // corners this near to a cell do not say which edge they are on
    let map = map_at(Pose::IDENTITY, 1.0, [15, 16, 9], LIMITS);
    let step = |k: usize| (map.axes[k].to - map.axes[k].from) / (map.axes[k].count - 1) as f64;
    let in_cells = |v: [f64; 3]| [0, 1, 2].map(|k| (v[k] - map.axes[k].from) / step(k));
    let vector = |v: [f64; 3]| Vec3::new(v[0], v[1], v[2]);
    let (mut corners, mut triangles, mut skipped) = (0, 0, 0);
    let mut flips = vec![None; map.modes.len()];
    for surface in &map.surfaces {
        let mode = &map.modes[surface.mode];
        for triangle in &surface.triangles {
            let places = triangle.map(|v| in_cells(surface.vertices[v]));
            let edges = places.map(|at| {
                let first =
                    at.map(|x| if (x - x.round()).abs() < NEAR { x.round() } else { x.floor() });
                let along =
                    [0, 1, 2].map(|k| f64::from(u8::from((at[k] - first[k]).abs() >= NEAR)));
                (first, along)
            });
            if edges.iter().any(|(_, along)| along.iter().all(|x| *x == 0.0)) {
                skipped += 1;
                continue;
            }
            let [a, b, c] = places.map(vector);
            let normal = (b - a).cross(c - a);
            for (at, (first, along)) in places.iter().zip(edges) {
                let share = (0..3).map(|k| at[k] - first[k]).fold(0.0, f64::max);
                for k in 0..3 {
                    assert!((at[k] - first[k] - share * along[k]).abs() < NEAR, "{at:?}");
                }
                let end = [0, 1, 2].map(|k| first[k] + along[k]);
                let signs = [first, end].map(|node| {
                    let [i, j, k] = node.map(|x| x as usize);
                    let cell = (i * 16 + j) * 9 + k;
                    let at: [f64; 3] = map.values(cell).try_into().unwrap();
                    let value = mode.type_two[cell];
                    // The sign is that of the determinant, up to one for all of a mode.
                    let sign = value.signum() * residual(at, Pose::IDENTITY, 1.0).signum();
                    assert_eq!(*flips[surface.mode].get_or_insert(sign), sign);
                    value.signum()
                });
                assert_eq!(signs[0], -signs[1], "{at:?}");
                assert!(normal.dot(vector(along)) * signs[1] > 0.0, "{places:?}");
                corners += 1;
            }
            triangles += 1;
        }
    }
    assert!(triangles > 500 && skipped * 50 < triangles, "{triangles}, {skipped} skipped");
    assert_eq!(corners, 3 * triangles);
}

/// At another place, turned and of another size: the same equation; where the grid moves along, the same
/// triangles.
#[test]
fn the_world_and_the_unit_do_not_count() {
    let counts = [9, 10, 7];
    let plain = map_at(Pose::IDENTITY, 1.0, counts, LIMITS);
    let size = |map: &Map| map.surfaces.iter().map(|s| s.triangles.len()).sum::<usize>();
    for (offset, scale, limits) in [
        (Vec3::new(3.0, -7.0, 0.0), 1.0, LIMITS.to_owned()),
        (Vec3::ZERO, 1000.0, "limits = { lower = -500.0, upper = 4000.0 }".to_owned()),
        (Vec3::new(0.0, 2.0, 0.0), 1e-3, "limits = { lower = -0.5e-3, upper = 4e-3 }".to_owned()),
    ] {
        let moved = map_at(Pose::from_translation(offset), scale, counts, &limits);
        assert_eq!(size(&moved), size(&plain));
        for (a, b) in plain.surfaces.iter().zip(&moved.surfaces) {
            assert_eq!(
                (a.kind, a.mode, a.closed, &a.triangles),
                (b.kind, b.mode, b.closed, &b.triangles)
            );
            for (a, b) in a.vertices.iter().zip(&b.vertices) {
                let expected = [a[0] * scale + offset.x, a[1] * scale + offset.y, a[2]];
                for (k, (x, y)) in expected.iter().zip(b).enumerate() {
                    let unit = if k < 2 { scale } else { 1.0 };
                    let rounding = 1e-14 * (1.0 + offset.norm());
                    assert!((x - y).abs() < 1e-8 * unit + rounding, "{expected:?} {b:?}");
                }
            }
        }
    }
    let turned = Pose { rotation: Rotation::about_z(0.7), translation: Vec3::new(-0.5, 1.5, 0.0) };
    let map = map_at(turned, 1.0, counts, LIMITS);
    assert!(size(&map) > 50);
    for vertex in map.surfaces.iter().flat_map(|s| &s.vertices) {
        let value = residual(*vertex, turned, 1.0);
        assert!(value.abs() < 1e-8, "{value} at {vertex:?}");
    }
}

#[test]
fn threads_change_nothing() {
    let mechanism = three_rpr_at(BASE, PLATFORM, LIMITS, (Pose::IDENTITY, 1.0));
    let options = options(Vec3::ZERO, 1.0, [7, 8, 6]);
    let text = |map: &Map| format!("{map:?}");
    let expected = Map::of(&mechanism, options.clone()).unwrap();
    assert!(!expected.surfaces.is_empty());
    let mut units: Vec<&str> = Vec::new();
    for threads in [1, 2, 8] {
        let threads = NonZeroUsize::new(threads);
        let found = Map::run(&mechanism, options.clone(), threads, |progress| {
            units.push(progress.unit);
            progress.done <= progress.rows
        });
        assert!(text(&found.unwrap().unwrap()) == text(&expected));
    }
    units.dedup();
    assert_eq!(units[..3], ["starts", "cells", "vertices"]);
    // Stopped among them, there is no map.
    let stopped = Map::run(&mechanism, options, None, |progress| progress.unit != "vertices");
    assert!(stopped.unwrap().is_none());
}

/// Nor for those who do not ask, for fewer axes, and where a motion is left.
#[test]
fn some_maps_have_none() {
    let surfaces = |mechanism: &Mechanism, options: MapOptions| {
        Map::of(mechanism, options).unwrap().surfaces.len()
    };
    let mechanism = three_rpr_at(BASE, PLATFORM, LIMITS, (Pose::IDENTITY, 1.0));
    let all = options(Vec3::ZERO, 1.0, [5, 6, 4]);
    assert!(surfaces(&mechanism, all.clone()) > 0);
    assert_eq!(surfaces(&mechanism, MapOptions { loci: false, ..all.clone() }), 0);
    let flat = options(Vec3::ZERO, 1.0, [5, 6, 1]);
    assert_eq!(surfaces(&mechanism, flat), 0);
    let two = MapOptions { axes: all.axes[..2].to_vec(), ..all };
    assert_eq!(surfaces(&mechanism, two), 0);
    let panda = catalogue::load("panda").unwrap();
    let space = MapOptions {
        axes: vec![axis("x", 0.3, 0.6, 4), axis("y", -0.2, 0.2, 4), axis("z", 0.3, 0.6, 4)],
        starts: 4,
        ..MapOptions::default()
    };
    assert_eq!(surfaces(&panda, space), 0);
}
