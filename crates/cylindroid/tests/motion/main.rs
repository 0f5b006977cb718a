//! Time laws, paths and moves: exact laws, finite differences, closed forms, bad input.

mod laws;
mod moves;
mod paths;
