//! The models that an SDF file includes: `<include>` with `model://NAME`, a path or a folder.
//!
//! Formula  a relative path is looked up in the folder of the including file; `model://NAME` in its
//!          folders upwards, then in GZ_SIM_RESOURCE_PATH, SDF_PATH and GAZEBO_MODEL_PATH. In a
//!          folder, `model.config` names the file, otherwise it is `model.sdf`
//! Valid    files of this computer; what is not found is noted and missing
//! Source   sdformat.org, specification of include; gazebosim.org, model.config
//! Checked  tests/formats/sdf.rs::includes_*

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use roxmltree::{Document, Node};

use crate::error::Result;
use crate::model::formats::span::Source;
use crate::model::formats::text_file::{self, LARGEST_INCLUSION};
use crate::model::formats::xml::Reader;
use crate::model::formats::{xml, xml_limits};

pub(super) const FORMAT: &str = "SDF";

/// Included files; a file may be included several times.
const MOST_FILES: usize = 1000;

const PATHS: [&str; 4] =
    ["GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH", "SDF_PATH", "GAZEBO_MODEL_PATH"];

/// The text of an included file.
pub(super) struct Included {
    path: PathBuf,
    text: String,
    /// The file (0 is the main one) and the byte offset of its `<include>`.
    place: (usize, usize),
}

impl Included {
    pub(super) fn source(&self) -> Source<'_> {
        Source { format: FORMAT, path: &self.path, text: &self.text }
    }
}

/// Reads the files that a model includes, and those that they include.
pub(super) fn gather(main: &Source<'_>) -> Result<Vec<Included>> {
    let mut found: Vec<Included> = Vec::new();
    read(main, 0, &mut found)?;
    let mut next = 0;
    while next < found.len() {
        // The text is moved out while its own includes are read.
        let (path, text) = (found[next].path.clone(), std::mem::take(&mut found[next].text));
        read(&Source { format: FORMAT, path: &path, text: &text }, next + 1, &mut found)?;
        found[next].text = text;
        next += 1;
    }
    Ok(found)
}

fn read(source: &Source<'_>, file: usize, found: &mut Vec<Included>) -> Result<()> {
    let document = xml::document(source)?;
    for node in document.descendants().filter(|n| n.has_tag_name("include")) {
        let uri = node.children().find(|c| c.has_tag_name("uri"));
        let Some(path) = uri.and_then(|u| u.text()).and_then(|u| find(source.path, u.trim()))
        else {
            continue;
        };
        if found.len() >= MOST_FILES {
            let message = format!("the model includes more than {MOST_FILES} files");
            let help = "does a file include itself?";
            return Err(source.error(Reader::tag(node), message, help));
        }
        let text = text_file::read(&path)?.text;
        let text = xml_limits::without_undeclared(&text).into_owned();
        let bytes: usize = found.iter().map(|f| f.text.len()).sum();
        if bytes + text.len() > LARGEST_INCLUSION {
            let limit = LARGEST_INCLUSION >> 20;
            let message = format!("the files that the model includes exceed {limit} MiB");
            return Err(source.error(Reader::tag(node), message, ""));
        }
        found.push(Included { path, text, place: (file, node.range().start) });
    }
    Ok(())
}

/// The SDF file of a URI.
fn find(from: &Path, uri: &str) -> Option<PathBuf> {
    let from = std::path::absolute(from).ok()?;
    let folder = from.parent()?;
    let roots: Vec<PathBuf> = match uri.strip_prefix("model://") {
        Some(_) => {
            let paths = PATHS.iter().filter_map(std::env::var_os);
            let others = paths.flat_map(|p| std::env::split_paths(&p).collect::<Vec<_>>());
            folder.ancestors().map(Path::to_owned).chain(others).collect()
        }
        None => vec![folder.to_owned()],
    };
    let rest = uri.strip_prefix("model://").or_else(|| uri.strip_prefix("file://")).unwrap_or(uri);
    if rest.is_empty() {
        return None;
    }
    roots.iter().find_map(|root| {
        let path = root.join(rest);
        if path.is_file() {
            return Some(path);
        }
        path.is_dir().then(|| in_folder(&path)).filter(|file| file.is_file())
    })
}

/// The file that `model.config` names last, for the newest version, otherwise `model.sdf`.
fn in_folder(folder: &Path) -> PathBuf {
    let config = text_file::read(&folder.join("model.config")).ok();
    let named = config.and_then(|config| {
        let (path, text) = (folder.join("model.config"), config.text);
        let source = Source { format: FORMAT, path: &path, text: &text };
        let document = xml::document(&source).ok()?;
        let mut files = document.descendants().filter(|n| n.has_tag_name("sdf"));
        files.next_back()?.text().map(|t| t.trim().to_owned())
    });
    folder.join(named.unwrap_or_else(|| "model.sdf".to_owned()))
}

/// The documents of the included files, by the texts and offsets of their `<include>` elements.
#[derive(Debug, Default)]
pub(super) struct Includes<'d> {
    documents: BTreeMap<(usize, usize), Node<'d, 'd>>,
}

/// Identifies a document by its text.
fn key(document: &Document<'_>) -> usize {
    document.input_text().as_ptr() as usize
}

impl<'d> Includes<'d> {
    pub(super) fn new(
        main: &'d Document<'d>,
        included: &'d [Included],
        documents: &'d [Document<'d>],
    ) -> Self {
        let text = |file: usize| key(file.checked_sub(1).map_or(main, |i| &documents[i]));
        let place = |f: &Included| (text(f.place.0), f.place.1);
        let roots = documents.iter().map(Document::root_element);
        Self { documents: included.iter().map(place).zip(roots).collect() }
    }

    /// The model that an `<include>` brings.
    pub(super) fn model(&self, node: Node<'d, 'd>) -> Option<Node<'d, 'd>> {
        let root = self.documents.get(&(key(node.document()), node.range().start))?;
        root.children().find(|n| n.has_tag_name("model"))
    }

    /// The root elements of the included files.
    pub(super) fn roots(&self) -> impl Iterator<Item = Node<'d, 'd>> + '_ {
        self.documents.values().copied()
    }
}
