//! Maps of platforms: working modes, distances, singularity loci.

use cylindroid::sweep::{Axis, Map, MapOptions};
use cylindroid::{Mechanism, catalogue};

use super::{record_error, weighted};
use crate::record::{Record, check};
use crate::robots::{Random, five_bar};

fn finite(numbers: &[f64]) -> Vec<f64> {
    numbers.iter().map(|x| if x.is_finite() { *x } else { 0.0 }).collect()
}

fn record_map(record: &mut Record, map: &Map) {
    record.word(&(map.free_motions, map.signed, map.modes.len()));
    record.number(weighted(&map.held.iter().map(|(_, x)| *x).collect::<Vec<_>>()));
    for mode in map.modes.iter().take(4) {
        record.word(&mode.cells());
        for numbers in [&mode.type_one, &mode.type_two, &mode.limit_distance] {
            record.number(weighted(&finite(numbers)));
        }
        record.number(weighted(&finite(&mode.q)));
    }
    record.word(&(map.loci.len(), map.surfaces.len()));
    for locus in map.loci.iter().take(8) {
        record.word(&(locus.kind, locus.limit.is_some(), &locus.modes, locus.closed));
        record.word(&locus.points.len());
        record.number(weighted(&locus.points.iter().map(|p| weighted(p)).collect::<Vec<_>>()));
        record.number(weighted(&locus.q.iter().map(|q| weighted(q)).collect::<Vec<_>>()));
    }
    for surface in map.surfaces.iter().take(3) {
        record.word(&(surface.kind, surface.mode, surface.closed, surface.triangles.len()));
    }
}

/// Around the place of the reference at home.
fn axes(random: &mut Random<'_>, mechanism: &Mechanism, names: &[&str], count: u64) -> Vec<Axis> {
    let home = mechanism.state(mechanism.home()).unwrap();
    let frame = if mechanism.is_closed() { mechanism.reference() } else { mechanism.tool() };
    let at = home.pose(frame).unwrap().translation.to_array();
    let size = mechanism.reach() * random.within(0.1, 0.5);
    let one = |name: &&str| {
        let place = ["x", "y", "z"].iter().position(|n| n == name);
        let (middle, half) = place.map_or((0.0, 0.4), |k| (at[k], size));
        Axis {
            name: (*name).to_owned(),
            from: middle - half * random.within(0.5, 1.0),
            to: middle + half * random.within(0.5, 1.0),
            count,
        }
    };
    names.iter().map(one).collect()
}

fn map_of(random: &mut Random<'_>, record: &mut Record, mechanism: &Mechanism, axes: Vec<Axis>) {
    let options = MapOptions {
        axes,
        starts: 1 + random.below(4),
        seed: random.below(100) as u64,
        ..MapOptions::default()
    };
    match Map::of(mechanism, options) {
        Ok(map) => record_map(record, &map),
        Err(error) => record_error(record, &error),
    }
}

#[test]
fn maps_of_five_bars() {
    check("position_maps_five_bars", 14, |random, record| {
        let mechanism = five_bar(random);
        let axes = axes(random, &mechanism, &["x", "y"], 5);
        map_of(random, record, &mechanism, axes);
    });
}

/// Legs of variable length meet their limits.
#[test]
fn maps_of_three_legs() {
    check("position_maps_three_legs", 14, |random, record| {
        let mechanism = super::mechanisms::three_legs(random);
        let names: &[&str] = [&["x", "y"][..], &["y", "rz"], &["x", "y", "rz"]][random.below(3)];
        let axes = axes(random, &mechanism, names, 4);
        map_of(random, record, &mechanism, axes);
    });
}

#[test]
fn maps_of_the_catalogue() {
    check("position_maps_catalogue", 8, |random, record| {
        let (name, names): (&str, &[&str]) =
            [("five-bar", &["x", "y"][..]), ("3r", &["x", "z"]), ("3rrr", &["x"])][random.below(3)];
        let mechanism = catalogue::load(name).unwrap();
        let axes = axes(random, &mechanism, names, 5);
        map_of(random, record, &mechanism, axes);
    });
}
