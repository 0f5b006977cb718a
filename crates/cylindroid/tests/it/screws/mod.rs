//! Screws, screw systems and what is built on them.

mod forms;
mod geometry;
mod vectors;
