//! The files of an MJCF model: `<include>`, each file once.
//!
//! Formula  a path is relative to the folder of the main file; if there is no such file, to that of
//!          the including one
//! Source   mujoco.readthedocs.io, XML reference, include
//! Checked  tests/formats/mjcf.rs::includes_*

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use roxmltree::{Document, Node};

use super::attributes::FORMAT;
use crate::error::{Error, Result, shown};
use crate::model::formats::span::Source;
use crate::model::formats::text_file::{self, LARGEST_INCLUSION, TextFile};
use crate::model::formats::xml::{self, Reader};
use crate::model::formats::xml_limits;

/// Files of a model; deeper inclusion than this is no model of a robot.
const MOST_FILES: usize = 1000;

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
    let folder = main.path.parent().unwrap_or_else(|| Path::new(""));
    let mut found: Vec<Included> = Vec::new();
    read(main, 0, folder, &mut found)?;
    let mut next = 0;
    while next < found.len() {
        // The text is moved out while its own includes are read.
        let (path, text) = (found[next].path.clone(), std::mem::take(&mut found[next].text));
        let source = Source { format: FORMAT, path: &path, text: &text };
        read(&source, next + 1, folder, &mut found)?;
        found[next].text = text;
        next += 1;
    }
    Ok(found)
}

fn read(source: &Source<'_>, file: usize, folder: &Path, found: &mut Vec<Included>) -> Result<()> {
    let document = xml::document(source)?;
    for node in document.descendants().filter(|n| n.has_tag_name("include")) {
        let reader = Reader::new(*source, None);
        let name = reader.required(node, "file")?.trim();
        let refuse = |message: String, help: &str| {
            Err(source.error(Reader::value(node, "file"), message, help))
        };
        let beside = source.path.parent().unwrap_or_else(|| Path::new("")).join(name);
        let path = Some(folder.join(name)).filter(|p| p.exists() || !beside.exists());
        let path = path.unwrap_or(beside);
        let same = |f: &Included| f.path == path || is_same(&f.path, &path);
        if found.iter().any(same) || is_same(source.path, &path) {
            return refuse(format!("'{name}' is included twice"), "include a file only once");
        }
        if found.len() >= MOST_FILES {
            return refuse(format!("the model has more than {MOST_FILES} files"), "");
        }
        match text_file::read(&path) {
            Ok(TextFile { text, .. }) => {
                let text = xml_limits::without_undeclared(&text).into_owned();
                let bytes: usize = found.iter().map(|f| f.text.len()).sum();
                if bytes + text.len() > LARGEST_INCLUSION {
                    let limit = LARGEST_INCLUSION >> 20;
                    return refuse(format!("the files of the model exceed {limit} MiB"), "");
                }
                found.push(Included { path, text, place: (file, node.range().start) });
            }
            Err(Error::Io { path, message, .. }) => {
                return refuse(format!("cannot read {}: {message}", shown(&path)), "");
            }
            Err(error) => return Err(error),
        }
    }
    Ok(())
}

fn is_same(a: &Path, b: &Path) -> bool {
    a.canonicalize().is_ok_and(|a| b.canonicalize().is_ok_and(|b| a == b))
}

/// The documents of a model: the main one, then the included ones.
pub(super) struct Files<'d> {
    pub(super) main: &'d Document<'d>,
    /// By the texts of the files, their `<include>` elements and the documents of these.
    included: BTreeMap<(usize, usize), &'d Document<'d>>,
}

/// Identifies a document by its text.
fn key(document: &Document<'_>) -> usize {
    document.input_text().as_ptr() as usize
}

impl<'d> Files<'d> {
    pub(super) fn new(
        main: &'d Document<'d>,
        included: &'d [Included],
        documents: &'d [Document<'d>],
    ) -> Self {
        let text = |file: usize| key(file.checked_sub(1).map_or(main, |i| &documents[i]));
        let place = |f: &Included| (text(f.place.0), f.place.1);
        Self { main, included: included.iter().map(place).zip(documents).collect() }
    }

    /// The root elements of all files, the main one first.
    pub(super) fn roots(&self) -> Vec<Node<'d, 'd>> {
        let others = self.included.values().map(|d| d.root_element());
        std::iter::once(self.main.root_element()).chain(others).collect()
    }

    /// The `<include>` elements of all files.
    pub(super) fn includes(&self) -> Vec<Node<'d, 'd>> {
        let all = self.roots().into_iter().flat_map(|root| root.descendants());
        all.filter(|n| n.has_tag_name("include")).collect()
    }

    /// The child elements; an `<include>` stands for the children of its file's root.
    pub(super) fn children(&self, node: Node<'d, 'd>) -> Vec<Node<'d, 'd>> {
        let mut children = Vec::new();
        let mut stack: Vec<Node<'d, 'd>> = elements(node);
        while let Some(child) = stack.pop() {
            let place = || (key(child.document()), child.range().start);
            let file = child.has_tag_name("include").then(place);
            match file.and_then(|place| self.included.get(&place)) {
                Some(document) => stack.extend(elements(document.root_element())),
                None => children.push(child),
            }
        }
        children
    }

    /// The children of these sections of the model, all sections of one name taken together.
    pub(super) fn section(&self, name: &str) -> Vec<Node<'d, 'd>> {
        let sections = self.children(self.main.root_element());
        let named = sections.into_iter().filter(|n| n.has_tag_name(name));
        named.flat_map(|n| self.children(n)).collect()
    }
}

/// The child elements, last first.
fn elements<'d>(node: Node<'d, 'd>) -> Vec<Node<'d, 'd>> {
    let mut elements: Vec<_> = node.children().filter(Node::is_element).collect();
    elements.reverse();
    elements
}
