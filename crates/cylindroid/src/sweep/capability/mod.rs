//! Capability maps: the share of the orientations of the tool that an arm reaches at the points of a
//! grid, and the best of an index over the solutions.
//!
//! Read `grid` (points and options), `orientations` (approach directions and rolls), `search`
//! (inverse kinematics of one point) and `rows` (the columns).

mod grid;
mod orientations;
mod rows;
mod search;

pub use grid::VoxelGrid;
pub(super) use grid::{Voxels, columns};
pub(super) use rows::run;
pub(super) use search::Search;
