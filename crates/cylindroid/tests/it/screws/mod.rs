//! Screws, screw systems and what is built on them.

mod classes;
mod forms;
mod geometry;
mod laws;
mod sample;
mod vectors;
