//! Zones without singularities around a configuration.

use cylindroid::catalogue;
use cylindroid::sweep::{Zone, ZoneOptions, ZoneShape};

use super::{record_error, weighted};
use crate::record::{Record, check};
use crate::robots::{Random, five_bar};

fn record_zone(record: &mut Record, zone: &Zone) {
    record.number(zone.size);
    for component in &zone.components {
        record.numbers(&[component.centre, component.scale]);
    }
    record.number(weighted(&zone.q));
    for bound in &zone.bounds {
        record.word(&(bound.kind, bound.limit.is_some()));
        record.number(bound.distance);
        record.number(weighted(&bound.point));
        record.number(weighted(&bound.q));
    }
    record.word(&(zone.bounds.len(), zone.confirmed, zone.certified));
}

fn options(random: &mut Random<'_>, names: &[&str]) -> ZoneOptions {
    ZoneOptions {
        components: names.iter().map(|name| (*name).to_owned()).collect(),
        scales: if random.once_in(2) {
            Vec::new()
        } else {
            names.iter().map(|_| random.within(0.5, 2.0)).collect()
        },
        shape: [ZoneShape::Ball, ZoneShape::Box][random.below(2)],
        limits: random.once_in(2),
        rays: 4 + random.below(8),
        seed: random.below(100) as u64,
        ..ZoneOptions::default()
    }
}

#[test]
fn zones_of_five_bars() {
    check("position_zones_five_bars", 24, |random, record| {
        let mechanism = five_bar(random);
        let names: &[&str] = if random.once_in(3) { &["q_a1", "q_b1"] } else { &["x", "y"] };
        match Zone::of(&mechanism, options(random, names)) {
            Ok(zone) => record_zone(record, &zone),
            Err(error) => record_error(record, &error),
        }
    });
}

#[test]
fn zones_of_three_legs() {
    check("position_zones_three_legs", 16, |random, record| {
        let mechanism = super::mechanisms::three_legs(random);
        let names: &[&str] =
            [&["x", "y"][..], &["x", "y", "rz"], &["leg0", "leg1", "leg2"]][random.below(3)];
        match Zone::of(&mechanism, options(random, names)) {
            Ok(zone) => record_zone(record, &zone),
            Err(error) => record_error(record, &error),
        }
    });
}

#[test]
fn zones_of_the_catalogue() {
    check("position_zones_catalogue", 8, |random, record| {
        let (name, components): (&str, &[&str]) = [
            ("five-bar", &["x", "y"][..]),
            ("3rrr", &["x", "y"][..]),
            ("3r", &["x", "y", "z"][..]),
        ][random.below(3)];
        let mechanism = catalogue::load(name).unwrap();
        match Zone::of(&mechanism, options(random, components)) {
            Ok(zone) => record_zone(record, &zone),
            Err(error) => record_error(record, &error),
        }
    });
}
