//! Sweeps: samples, quantities, parts, folders.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_cmp_const
)]

mod capability;
mod clearances;
mod closed_samples;
mod designs;
mod errors;
mod folder;
mod invariance;
mod optimise;
mod own_columns;
mod parquet_forms;
mod parts;
mod payload;
mod pinocchio;
mod pose_files;
mod quantities;
mod relative;
mod sampling;
mod shared_folder;

use std::path::Path;

use cylindroid::sweep::{Quantity, Source, Sweep, SweepOptions, Table, Values};
use cylindroid::{Mechanism, ParametricModel};

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

/// An arm of two equal links in the plane, with their length as a parameter.
fn two_links() -> ParametricModel {
    let text = "dimension = 2\ntool = \"tip\"\n[parameters]\nlink = 0.3\n\
        [[joint]]\nname = \"a\"\ntype = \"revolute\"\nbetween = [\"ground\", \"one\"]\n\
        origin = [0, 0]\n\
        [[joint]]\nname = \"b\"\ntype = \"revolute\"\nbetween = [\"one\", \"two\"]\n\
        origin = [\"link\", 0]\n\
        [[frame]]\nname = \"tip\"\nlink = \"two\"\nxyz = [\"link\", 0, 0]\n";
    ParametricModel::of_text(text, Path::new("arm.toml"), &[]).unwrap()
}
