//! Sizes of workspaces, and their holes.

use std::f64::consts::PI;

use cylindroid::{Pose, Vec3};

use crate::five_bar::{axis, map};
use crate::robots::{five_bar, five_bar_at};

/// Between the circles about both pivots.
fn is_reached(x: f64, y: f64) -> bool {
    let root = 2.0_f64.sqrt();
    (1.0..3.0).contains(&x.hypot(y)) && (root - 1.0..root + 1.0).contains(&(x - 2.0).hypot(y))
}

#[test]
fn a_five_bar_does_not_reach_its_second_pivot() {
    let count = 81;
    let axes = vec![axis("x", -2.513, 3.507, count), axis("y", -2.521, 2.511, count)];
    let map = map(&five_bar(), axes.clone());
    let workspace = map.workspace();
    // A finer grid of the closed form.
    let fine = 2000;
    let at =
        |i: i32, [from, to]: [f64; 2]| from + (to - from) * (f64::from(i) + 0.5) / f64::from(fine);
    let mut inside = 0;
    for i in 0..fine {
        for k in 0..fine {
            inside += u32::from(is_reached(at(i, [-1.0, 3.5]), at(k, [-2.5, 2.5])));
        }
    }
    let area = f64::from(inside) * 4.5 * 5.0 / f64::from(fine).powi(2);
    assert!((workspace.size / area - 1.0).abs() < 0.01, "{} {area}", workspace.size);
    assert!(!workspace.is_cut);
    let [hole] = &workspace.holes[..] else { panic!("{:?}", workspace.holes) };
    let disc = PI * (2.0_f64.sqrt() - 1.0).powi(2);
    assert!((hole.size / disc - 1.0).abs() < 0.05, "{} {disc}", hole.size);
    assert!((hole.center[0] - 2.0).hypot(hole.center[1]) < 0.02, "{:?}", hole.center);

    // All modes together reach what each of them reaches.
    for (number, mode) in map.modes.iter().enumerate() {
        let own = map.workspace_of(number).unwrap();
        assert!(own.cells == mode.cells() && own.cells <= workspace.cells);
    }
    // A grid that ends within it.
    let cut = crate::five_bar::map(&five_bar(), vec![axis("x", 1.013, 3.507, 21), axes[1].clone()]);
    assert!(cut.workspace().is_cut);
    assert_eq!(cut.workspace().holes.len(), 1);
}

/// The number of a mode of a larger map is none of this one, and the error says so.
#[test]
fn modes_of_other_maps_are_refused() {
    let line = |from, to| vec![axis("x", from, to, 3), axis("y", 1.5, 1.5, 1)];
    let (four, none) = (map(&five_bar(), line(0.5, 1.5)), map(&five_bar(), line(20.0, 21.0)));
    assert!(four.modes.len() == 4 && none.modes.is_empty());
    let message = none.workspace_of(3).unwrap_err().to_string();
    assert!(message.contains("mode = 3") && message.contains("the map has 0 modes"), "{message}");
    assert_eq!(four.workspace_of(3).unwrap().cells, four.modes[3].cells());
}

#[test]
fn sizes_grow_with_the_mechanism() {
    let plain = map(&five_bar(), vec![axis("x", -2.513, 3.507, 31), axis("y", -2.521, 2.511, 31)]);
    let moved = five_bar_at(Pose::from_translation(Vec3::new(0.7, -0.2, 0.0)), 3.0);
    let at = |x: f64, by: f64| 3.0 * x + by;
    let large = map(
        &moved,
        vec![
            axis("x", at(-2.513, 0.7), at(3.507, 0.7), 31),
            axis("y", at(-2.521, -0.2), at(2.511, -0.2), 31),
        ],
    );
    let (a, b) = (plain.workspace(), large.workspace());
    assert_eq!((a.cells, a.holes[0].cells), (b.cells, b.holes[0].cells));
    assert!((b.size / a.size - 9.0).abs() < 1e-9);
    let center = [at(a.holes[0].center[0], 0.7), at(a.holes[0].center[1], -0.2)];
    assert!((center[0] - b.holes[0].center[0]).hypot(center[1] - b.holes[0].center[1]) < 1e-9);
}
