//! SRDF: the pairs of links whose collisions are disabled. Groups, states and end effectors are not
//! read.
//!
//! Valid    `<disable_collisions link1 link2>`, `<disable_default_collisions link>` and
//!          `<enable_collisions link1 link2>`, in any order: a pair that is enabled is not disabled by
//!          default
//! Source   MoveIt, srdfdom 2
//! Checked  tests/collision/files.rs::srdf_*

use std::path::Path;

use super::span::Source;
use super::text_file;
use super::xml::{self, Reader};
use crate::error::Result;
use crate::model::Mechanism;

/// The disabled collisions of an SRDF, by the names of links.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Srdf {
    /// Pairs of `<disable_collisions>`.
    pub disabled: Vec<[String; 2]>,
    /// Links of `<disable_default_collisions>`: disabled against all others.
    pub disabled_by_default: Vec<String>,
    /// Pairs of `<enable_collisions>`, exceptions from the default.
    pub enabled: Vec<[String; 2]>,
}

/// Reads the text of an SRDF. The path is for errors only.
///
/// ```
/// use cylindroid::model::formats::srdf;
///
/// let text = r#"<robot name="r"><disable_collisions link1="a" link2="b" reason="Never"/></robot>"#;
/// let srdf = srdf::parse(text, "r.srdf".as_ref())?;
/// assert_eq!(srdf.disabled, [["a".to_owned(), "b".to_owned()]]);
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// # Errors
/// [`Error::File`](crate::Error::File) for broken XML, another root element, or a pair without both
/// links.
pub fn parse(text: &str, path: &Path) -> Result<Srdf> {
    let source = Source { format: "SRDF", path, text };
    let document = xml::document(&source)?;
    let root = document.root_element();
    let reader = Reader::new(source, root.tag_name().namespace());
    if root.tag_name().name() != "robot" {
        let message = format!("<{}> is not the root of an SRDF", root.tag_name().name());
        return Err(reader.error(root, Reader::tag(root), message, "an SRDF begins with <robot>"));
    }
    let mut srdf = Srdf::default();
    for node in root.children().filter(roxmltree::Node::is_element) {
        let pair = || -> Result<[String; 2]> {
            let link = |name| reader.required(node, name).map(|l| l.trim().to_owned());
            Ok([link("link1")?, link("link2")?])
        };
        match node.tag_name().name() {
            "disable_collisions" => srdf.disabled.push(pair()?),
            "enable_collisions" => srdf.enabled.push(pair()?),
            "disable_default_collisions" => {
                srdf.disabled_by_default.push(reader.required(node, "link")?.trim().to_owned());
            }
            _ => {}
        }
    }
    Ok(srdf)
}

/// Reads an SRDF.
///
/// # Errors
/// [`Error::Io`](crate::Error::Io); those of [`parse`].
pub fn load(path: &Path) -> Result<Srdf> {
    parse(&text_file::read(path)?.text, path)
}

impl Srdf {
    /// All disabled pairs of a mechanism: those by default for each of its links.
    #[must_use]
    pub fn pairs(&self, mechanism: &Mechanism) -> Vec<[String; 2]> {
        let same = |p: &[String; 2], a: &str, b: &str| {
            (p[0] == a && p[1] == b) || (p[0] == b && p[1] == a)
        };
        let mut all = self.disabled.clone();
        for a in &self.disabled_by_default {
            for b in mechanism.links().iter().map(|l| &l.name).filter(|b| *b != a) {
                if !self.enabled.iter().any(|p| same(p, a, b)) {
                    all.push([a.clone(), b.clone()]);
                }
            }
        }
        all
    }
}
