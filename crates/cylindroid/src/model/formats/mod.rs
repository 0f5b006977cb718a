//! File formats: each module reads one format and writes a [`Builder`].
//!
//! The format is recognised by extension and content: `.toml` is a mechanism file; files that begin
//! with `<` are XML (URDF, MJCF, SDF), distinguished by their root element.
//!
//! [`Builder`]: super::Builder

pub mod dh;
#[cfg(feature = "formats")]
mod graph;
#[cfg(feature = "formats")]
mod inclusion;
#[cfg(feature = "formats")]
pub(crate) mod load;
#[cfg(feature = "formats")]
mod mesh;
#[cfg(feature = "formats")]
pub mod mjcf;
#[cfg(feature = "formats")]
pub mod sdf;
#[cfg(feature = "formats")]
mod span;
#[cfg(feature = "formats")]
pub mod srdf;
#[cfg(feature = "formats")]
mod text_file;
#[cfg(feature = "formats")]
pub mod toml;
#[cfg(feature = "formats")]
pub mod urdf;
#[cfg(feature = "formats")]
mod xacro;
#[cfg(feature = "formats")]
mod xml;
#[cfg(feature = "formats")]
mod xml_limits;
