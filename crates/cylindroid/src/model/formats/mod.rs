//! File formats: each file here reads one format and writes nothing but a [`Builder`].
//!
//! The format is told by the extension and by what stands in the file: `.toml` is a mechanism
//! file, everything that begins with `<` is XML (URDF, MJCF, SDF) and is told by its root element.
//!
//! [`Builder`]: super::Builder

pub mod dh;
#[cfg(feature = "formats")]
mod graph;
#[cfg(feature = "formats")]
mod load;
#[cfg(feature = "formats")]
mod mesh;
#[cfg(feature = "formats")]
pub mod mjcf;
#[cfg(feature = "formats")]
pub mod sdf;
#[cfg(feature = "formats")]
mod span;
#[cfg(feature = "formats")]
pub mod toml;
#[cfg(feature = "formats")]
pub mod urdf;
#[cfg(feature = "formats")]
mod xml;

#[cfg(feature = "formats")]
pub use load::{load, load_file};
