//! Maps by several threads, watched and stopped.

use std::num::NonZeroUsize;

use cylindroid::sweep::{Axis, Map, MapOptions, Progress};
use cylindroid::{Mechanism, catalogue};

use crate::five_bar::axis;
use crate::robots::{five_bar, three_rpr};

fn options(axes: Vec<Axis>) -> MapOptions {
    MapOptions { axes, starts: 16, ..MapOptions::default() }
}

/// A mechanism with four modes and curves of all kinds but limits, so large that levels have many cells.
fn large() -> (Mechanism, MapOptions) {
    let axes = vec![axis("x", -2.513, 3.507, 91), axis("y", -2.521, 2.511, 91)];
    (five_bar(), options(axes))
}

/// All numbers of a map to the last bit, those that are not numbers among them.
fn text(map: &Map) -> String {
    format!("{map:?}")
}

#[test]
fn threads_change_nothing() {
    let base = [[-1.0, -0.8], [1.2, -0.7], [0.1, 1.3]];
    let platform = [[-0.4, -0.2], [0.5, -0.3], [0.1, 0.4]];
    let with_limits = three_rpr(base, platform, "limits = { lower = -0.3, upper = 0.4 }");
    let space = ["x", "y", "z"].map(|name| match name {
        "z" => axis(name, 0.9, 1.1, 7),
        _ => axis(name, -0.2, 0.2, 9),
    });
    // Curves of limits; three axes; a motion that nothing prescribes.
    for (mechanism, options) in [
        large(),
        (with_limits, options(vec![axis("x", -1.0, 1.0, 41), axis("y", -1.0, 1.0, 41)])),
        (catalogue::load("stewart").unwrap(), options(space.to_vec())),
        (
            catalogue::load("panda").unwrap(),
            options(vec![axis("x", 0.2, 0.7, 14), axis("z", 0.2, 0.8, 14)]),
        ),
    ] {
        let expected = text(&Map::of(&mechanism, options.clone()).unwrap());
        for threads in [1, 2, 8] {
            let threads = NonZeroUsize::new(threads);
            let found = Map::run(&mechanism, options.clone(), threads, |_| true).unwrap().unwrap();
            assert!(text(&found) == expected, "{} by {threads:?}", mechanism.name());
        }
    }
}

/// Restarts, cells and curves are counted, none more often than there are.
#[test]
fn what_is_done_is_counted() {
    let (mechanism, options) = large();
    let mut seen: Vec<Progress> = Vec::new();
    let found = Map::run(&mechanism, options, None, |progress| {
        seen.push(*progress);
        true
    });
    assert_eq!(found.unwrap().unwrap().modes.len(), 4);
    let mut units: Vec<&str> = seen.iter().map(|progress| progress.unit).collect();
    units.dedup();
    assert_eq!(units, ["starts", "cells", "seeds"]);
    for progress in &seen {
        assert!(progress.done <= progress.rows && progress.computed == progress.done);
    }
    for pair in seen.windows(2).filter(|pair| pair[0].unit == pair[1].unit) {
        assert!(pair[0].done <= pair[1].done, "{pair:?}");
    }
}

/// The observer ends it in each of its stages, and is not asked again.
#[test]
fn maps_are_stopped() {
    for threads in [None, NonZeroUsize::new(1), NonZeroUsize::new(8)] {
        for last in ["starts", "cells", "seeds"] {
            let (mechanism, options) = large();
            let mut stopped = 0;
            let found = Map::run(&mechanism, options, threads, |progress| {
                stopped += usize::from(progress.unit == last);
                progress.unit != last
            });
            assert!(found.unwrap().is_none(), "{last}");
            assert_eq!(stopped, 1, "{last}");
        }
    }
    // Also where it is small.
    let small = options(vec![axis("x", 0.5, 1.5, 2), axis("y", 1.5, 1.5, 1)]);
    assert!(Map::run(&five_bar(), small, None, |_| false).unwrap().is_none());
}
