//! Screws, screw systems and what is built on them.

mod curve;
mod vectors;
