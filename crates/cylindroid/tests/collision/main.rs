//! Distances of shapes and of the links of mechanisms: exact laws, finite differences, reference
//! vectors.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_cmp_const
)]

mod coal;
mod ellipsoids;
mod files;
mod gradient;
mod laws;
mod pairs;
mod shapes;
#[allow(dead_code)] // of the helpers, a few are needed here
#[path = "../it/support.rs"]
mod support;
mod thin;
