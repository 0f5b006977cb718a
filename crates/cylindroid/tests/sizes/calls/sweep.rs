//! Public functions of the module.

use super::prelude::*;

calls! {
    sweep::Axis::value;
    sweep::AxisKinds::of;
    sweep::DesignObjective::name;
    sweep::DesignObjective::named;
    sweep::LocusKind::name;
    sweep::Map::cells;
    sweep::Map::of;
    sweep::Map::unit;
    sweep::Map::values;
    sweep::Optimisation::configurations;
    sweep::Optimisation::end_effector;
    sweep::Optimisation::evaluate;
    sweep::Optimisation::new;
    sweep::Optimisation::run = |o: &'static Optimisation, threads: Option<NonZeroUsize>, go_on: bool| o.run(threads, |_| go_on);
    sweep::Optimisation::units;
    sweep::Quantity::description;
    sweep::Quantity::name;
    sweep::Quantity::named;
    sweep::Quantity::usual;
    sweep::Sense::name;
    sweep::SharedFolder::open = |s: &'static Sweep, to: &'static Path, resume: bool| { SharedFolder::open(s, to, resume).is_ok() };
    sweep::SharedFolder::write_manifest = |s: &'static Sweep, to: &'static Path, parts: &'static [Option<Part>]| { SharedFolder::open(s, to, false).and_then(|folder| folder.write_manifest(s, parts)) };
    sweep::Statistic::name;
    sweep::Sweep::check_memory;
    sweep::Sweep::collect = |s: &'static Sweep, threads: Option<NonZeroUsize>, go_on: bool| s.collect(threads, |_| go_on);
    sweep::Sweep::columns;
    sweep::Sweep::designs;
    sweep::Sweep::end_effector;
    sweep::Sweep::listed_parts;
    sweep::Sweep::manifest;
    sweep::Sweep::new;
    sweep::Sweep::of_designs;
    sweep::Sweep::part;
    sweep::Sweep::part_file;
    sweep::Sweep::part_name;
    sweep::Sweep::parts;
    sweep::Sweep::quantities;
    sweep::Sweep::recipe;
    sweep::Sweep::recipe_difference;
    sweep::Sweep::rows;
    sweep::Sweep::rows_in;
    sweep::Sweep::statistics = |s: &'static Sweep, threads: Option<NonZeroUsize>, go_on: bool| s.statistics(threads, |_| go_on);
    sweep::Sweep::table;
    sweep::Sweep::task;
    sweep::Sweep::write = |s: &'static Sweep, to: &'static Path, how: &'static WriteOptions, go_on: bool| s.write(to, how, |_| go_on);
    sweep::Sweep::write_part;
    sweep::Table::column;
    sweep::Table::numbers;
    sweep::Table::rows;
    sweep::VelocityMetric::name;
    sweep::VelocityMetric::named;
    sweep::WorkingMode::cells;
    sweep::parquet_configurations;
}
