//! Millions of servo steps over random robots, tasks, limits, starts and pushes: no limit is left,
//! nothing is non-finite, and no bodies that were apart touch. `cargo xtask limits` runs them.

#![allow(clippy::unwrap_used, clippy::panic)] // a round that fails names its seed

mod one_task;
mod robots;
mod rounds;
mod watch;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use crate::rounds::Kind;
use crate::watch::Tally;

fn number(variable: &str, missing: u64) -> u64 {
    std::env::var(variable).map_or(missing, |text| text.parse().unwrap())
}

/// `CYLINDROID_LIMIT_STEPS` steps (10 million), from round `CYLINDROID_LIMIT_SEED` on, of the kind
/// `CYLINDROID_LIMIT_KIND` (all). Every round is random with its own number as seed, so that it can be
/// run again alone.
#[test]
#[ignore = "takes minutes; run by cargo xtask limits"]
fn no_limit_is_left() {
    let most = number("CYLINDROID_LIMIT_STEPS", 10_000_000);
    let (round, steps) = (AtomicU64::new(number("CYLINDROID_LIMIT_SEED", 0)), AtomicU64::new(0));
    let tallies = Mutex::new([(); Kind::ALL.len()].map(|()| Tally::default()));
    let only = std::env::var("CYLINDROID_LIMIT_KIND").ok();
    let is_chosen = |kind: Kind| only.as_ref().is_none_or(|only| only == kind.name());
    let names = Kind::ALL.map(Kind::name);
    assert!(Kind::ALL.into_iter().any(is_chosen), "no kind {only:?}, but {names:?}");
    let start = Instant::now();
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(|| {
                while steps.load(Ordering::Relaxed) < most {
                    let seed = round.fetch_add(1, Ordering::Relaxed);
                    let kind = Kind::of(seed);
                    if !is_chosen(kind) {
                        continue;
                    }
                    let work = AssertUnwindSafe(|| rounds::run(kind, seed));
                    let tally = catch_unwind(work).unwrap_or_else(|_| Tally::panicked(seed));
                    steps.fetch_add(tally.steps, Ordering::Relaxed);
                    tallies.lock().unwrap()[kind as usize].add(tally);
                }
            });
        }
    });
    let tallies = tallies.into_inner().unwrap();
    let mut violations = Vec::new();
    for (kind, tally) in Kind::ALL.into_iter().zip(&tallies) {
        println!("{:<26} {tally}", kind.name());
        let is_looked_at = !kind.watches_distances() || tally.rounds < 50 || tally.looks > 0;
        assert!(is_looked_at, "{}: no distance was looked at", kind.name());
        violations.extend(tally.violations.iter().map(|v| format!("{}: {v}", kind.name())));
    }
    let all: u64 = tallies.iter().map(|t| t.steps).sum();
    println!("{all} steps in {:.0} s", start.elapsed().as_secs_f64());
    violations.iter().take(50).for_each(|v| println!("{v}"));
    assert!(violations.is_empty(), "{} violations", violations.len());
}

/// Scenes in which rows of distances contradict one another: without a look at how braking would end,
/// bodies come 0.1 to 1.4 mm into one another there; 1 um in the last one, without a look at where
/// braking ends.
#[test]
fn bodies_stay_apart_where_distances_contradict_one_another() {
    for seed in [10619, 11498, 13338, 60238] {
        let tally = rounds::run(Kind::Distances, seed);
        assert!(tally.steps == 500 && tally.violations.is_empty(), "{:?}", tally.violations);
    }
}

/// A five-bar two of whose links came 3.8 mm into one another: its passive joints were not looked at
/// while it brakes.
#[test]
fn links_of_a_closed_chain_stay_apart() {
    let tally = rounds::run(Kind::ClosedDistances, 759);
    assert!(tally.steps == 500 && tally.violations.is_empty(), "{:?}", tally.violations);
}

/// Spatial loops whose links come nearer than the gap, and not into one another.
#[test]
fn links_of_spatial_loops_stay_apart() {
    for seed in [33899, 40979, 74099, 79859] {
        let tally = rounds::run(Kind::SpatialDistances, seed);
        assert!(tally.below_gap > 0 && tally.violations.is_empty(), "{seed}: {tally}");
    }
}

/// Scenes in which braking within limits of the jerk was cut to what the tasks ask for, and the arm
/// came 0.4 to 0.5 mm into an obstacle.
#[test]
fn braking_within_jerk_limits_ignores_what_the_tasks_ask_for() {
    for seed in [12752, 15252] {
        let tally = rounds::run(Kind::Jerks, seed);
        assert!(tally.steps == 500 && tally.violations.is_empty(), "{:?}", tally.violations);
    }
}

/// Rounds that a fuzzer found, and a few at random.
#[test]
fn findings_stay_mended() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/findings/servo");
    for entry in std::fs::read_dir(folder).into_iter().flatten() {
        rounds::check(&std::fs::read(entry.unwrap().path()).unwrap());
    }
    for seed in 0..20_u8 {
        rounds::check(&[seed, 0, seed, seed.wrapping_mul(31), 77, 5, seed, 9]);
    }
}
