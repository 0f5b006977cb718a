//! Parallel robots in the coordinates of their platforms: inverse kinematics, maps, singularity loci.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_cmp_const
)]

mod five_bar;
mod inverse;
mod options;
mod planar_platform;
mod region;
mod robots;
#[allow(dead_code)] // of the helpers, a few are needed here
#[path = "../it/support.rs"]
mod support;
mod surfaces;
mod threads;
mod three_rps;
mod zone;
