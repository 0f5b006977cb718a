//! Screws, screw systems and what is built on them.

mod bases;
mod classes;
mod curve;
mod eigenscrews;
mod error_form;
mod existence;
mod forms;
mod geometry;
mod hyperbolic_svd;
mod invariance;
mod laws;
mod pitch_conics;
mod point_direction;
mod projectors;
mod sample;
mod signature;
mod vectors;
