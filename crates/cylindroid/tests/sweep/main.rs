//! Sweeps: samples, quantities, parts, folders.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_cmp_const
)]

mod capability;
mod closed_samples;
mod designs;
mod folder;
mod optimise;
mod own_columns;
mod parts;
mod payload;
mod pinocchio;
mod pose_files;
mod quantities;
mod sampling;
mod shared_folder;

use cylindroid::Mechanism;
use cylindroid::sweep::{Quantity, Source, Sweep, SweepOptions, Table, Values};

/// Samples of a model of the catalogue.
fn samples(model: &str, count: u64, quantities: &[Quantity]) -> Sweep {
    of(&cylindroid::load(model).unwrap(), Source::Samples { count, seed: 7 }, quantities)
}

fn of(mechanism: &Mechanism, source: Source, quantities: &[Quantity]) -> Sweep {
    let options = SweepOptions { source, quantities: quantities.to_vec(), ..Default::default() };
    Sweep::new(mechanism, options).unwrap()
}

/// The bits of all numbers, which also compare what is not a number.
fn bits(table: &Table) -> Vec<Vec<u64>> {
    let of = |values: &Values| match values {
        Values::Numbers(numbers) => numbers.iter().map(|x| x.to_bits()).collect(),
        Values::Counts(counts) => counts.clone(),
        Values::Texts(texts) => texts.iter().map(|t| t.bytes().map(u64::from).sum()).collect(),
        _ => panic!(),
    };
    table.values.iter().map(of).collect()
}

/// The configurations of a table.
fn configurations(mechanism: &Mechanism, table: &Table) -> Vec<Vec<f64>> {
    let columns: Vec<&[f64]> =
        mechanism.coordinates().iter().map(|c| table.numbers(&c.name).unwrap()).collect();
    (0..table.rows()).map(|i| columns.iter().map(|c| c[i]).collect()).collect()
}
