//! Screws, screw systems and what is built on them.

mod classes;
mod curve;
mod forms;
mod geometry;
mod sample;
mod vectors;
