//! Where the rounds of the servo end (see `limits`).

use crate::record::check;
use crate::rounds::{self, Kind};

fn rounds_of(kind: Kind, name: &str, rounds: u64) {
    check(name, rounds, |random, record| {
        let tally = rounds::run_with(kind, random);
        record.numbers(&tally.passed);
        for count in [tally.steps, tally.pushes, tally.at_limits, tally.errors] {
            record.word(&count);
        }
        if let Some(nearest) = tally.nearest {
            record.number(nearest);
        }
    });
}

#[test]
fn robots_of_the_catalogue() {
    rounds_of(Kind::Catalogue, "servo_catalogue", 100);
}

#[test]
fn random_robots() {
    rounds_of(Kind::Random, "servo_random", 200);
}

#[test]
fn limits_of_the_jerk() {
    rounds_of(Kind::Jerks, "servo_jerks", 100);
}

#[test]
fn closed_chains() {
    rounds_of(Kind::Closed, "servo_closed", 40);
}

#[test]
fn many_tasks() {
    rounds_of(Kind::Tasks, "servo_tasks", 150);
}

#[test]
fn distances() {
    rounds_of(Kind::Distances, "servo_distances", 60);
}

#[test]
fn distances_of_five_bars() {
    rounds_of(Kind::ClosedDistances, "servo_five_bars", 30);
}

#[test]
fn distances_of_spatial_loops() {
    rounds_of(Kind::SpatialDistances, "servo_spatial_loops", 30);
}

#[test]
fn twists() {
    rounds_of(Kind::Twists, "servo_twists", 100);
}
