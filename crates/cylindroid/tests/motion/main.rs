//! Time laws, paths and moves: exact laws, finite differences, closed forms, bad input.

#![allow(clippy::unwrap_used)] // in the helpers too, not only in the tests

mod dense_waypoints;
mod laws;
mod moves;
mod paths;
mod waypoints;
