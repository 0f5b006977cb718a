//! Millions of configurations: samples, grids or files of them, quantities of each, a folder of
//! Parquet files.
//!
//! Read in this order: `sobol` and `source` (configuration i as a function of i), `quantity` (the
//! columns), `evaluate` (the numbers, by the batches that the other modules have), `table` and
//! `parquet_file` (a part), `job` (a whole sweep), `designs` (of each design), `recipe` and `folder`
//! (on disk, stopped and resumed), `shared_folder` (written by several processes). `capability` has
//! points of a grid in place of configurations. Two go their own way, on the threads of `workers`:
//! `optimise` (the best designs) and `map` (the workspace in the coordinates of the platform).
//!
//! ```
//! use cylindroid::sweep::{Quantity, Source, Sweep, SweepOptions};
//!
//! let robot = cylindroid::load("panda")?;
//! let sweep = Sweep::new(&robot, SweepOptions {
//!     source: Source::Samples { count: 1000, seed: 0 },
//!     quantities: vec![Quantity::Pose, Quantity::Yoshikawa],
//!     ..SweepOptions::default()
//! })?;
//! let table = sweep.table(0..1000)?;
//! let measure = table.numbers("yoshikawa").unwrap();
//! assert!(measure.iter().all(|w| *w >= 0.0));
//! # Ok::<(), cylindroid::Error>(())
//! ```

mod axis;
mod capability;
mod checksum;
mod clearances;
mod closed_samples;
mod collect;
mod columns;
mod designs;
mod direction_numbers;
mod evaluate;
mod folder;
mod job;
mod manifest;
mod map;
mod measures;
mod optimise;
mod options;
mod own_columns;
mod parquet_file;
mod parquet_form;
mod parquet_header;
mod parquet_input;
mod parts;
mod payload;
mod pose_solutions;
mod poses;
mod quantity;
mod recipe;
mod relative;
mod shared_folder;
mod singular_values;
mod sobol;
mod source;
mod statistics;
mod table;
mod workers;

pub use axis::Axis;
pub use capability::VoxelGrid;
pub use designs::{AxisKinds, DesignSpace, ParameterRange};
pub use folder::{Progress, Summary, WriteOptions};
pub use job::Sweep;
pub use manifest::Part;
pub use map::{
    Hole, Locus, LocusKind, Map, MapOptions, Region, Surface, WorkingMode, Zone, ZoneBound,
    ZoneComponent, ZoneOptions, ZoneShape,
};
pub use optimise::{
    DesignObjective, OptimalDesign, Optimisation, OptimisationOptions, Optimum, Refinement, Sense,
    Statistic,
};
pub use options::{SweepOptions, VelocityMetric};
pub use own_columns::{ColumnFunction, OwnColumn};
pub use parquet_input::{coordinate_column, parquet_columns, parquet_configurations};
pub use quantity::Quantity;
pub use shared_folder::SharedFolder;
pub use source::Source;
pub use statistics::Statistics;
pub use table::{Column, Table, Values};
