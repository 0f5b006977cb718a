//! Screws, screw systems and what is built on them.

mod classes;
mod forms;
mod geometry;
mod laws;
mod projectors;
mod sample;
mod vectors;
