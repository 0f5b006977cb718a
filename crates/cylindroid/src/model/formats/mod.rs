//! File formats: each file here reads one format and writes nothing but a [`Builder`].
//!
//! The format is told by the extension and by what stands in the file: `.toml` is a mechanism
//! file, everything that begins with `<` is XML (URDF, MJCF, SDF) and is told by its root element.
//!
//! [`Builder`]: super::Builder

pub mod dh;
mod graph;
mod load;
mod mesh;
pub mod mjcf;
pub mod sdf;
mod span;
pub mod toml;
pub mod urdf;
mod xml;

pub use load::{load, load_file};
