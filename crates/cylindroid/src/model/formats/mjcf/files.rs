//! The files of an MJCF model: `<include>`, each file once.
//!
//! Formula  a path is relative to the folder of the main file; if there is no such file, to that of
//!          the including one
//! Source   mujoco.readthedocs.io, XML reference, include
//! Checked  tests/formats/mjcf.rs::includes_*

use std::path::{Path, PathBuf};

use roxmltree::{Document, Node};

use crate::error::Result;
use crate::model::formats::inclusion::{ByInclude, Included};
use crate::model::formats::span::Source;
use crate::model::formats::xml::Reader;

/// The file that an `<include>` names; `main` is the path of the model.
pub(super) fn find(
    main: &Path,
    source: &Source<'_>,
    include: Node<'_, '_>,
    before: &[Included],
) -> Result<Option<PathBuf>> {
    let name = Reader::new(*source, None).required(include, "file")?.trim().to_owned();
    let path = beside(main, source.path, &name);
    let is_same = |f: &Path| f == path || is_same(f, &path);
    if before.iter().any(|f| is_same(&f.path)) || is_same(source.path) {
        let message = format!("'{name}' is included twice");
        let span = Reader::value(include, "file");
        return Err(source.error(span, message, "include a file only once"));
    }
    Ok(Some(path))
}

/// The path of a file that a model names: from the folder of the main file, or of the one that
/// names it.
pub(super) fn beside(main: &Path, source: &Path, name: &str) -> PathBuf {
    let folder = |path: &Path| path.parent().unwrap_or_else(|| Path::new("")).to_owned();
    let beside = folder(source).join(name);
    let path = Some(folder(main).join(name)).filter(|p| p.exists() || !beside.exists());
    path.unwrap_or(beside)
}

fn is_same(a: &Path, b: &Path) -> bool {
    a.canonicalize().is_ok_and(|a| b.canonicalize().is_ok_and(|b| a == b))
}

/// The documents of a model: the main one, and the included ones.
pub(super) struct Files<'d> {
    pub(super) main: &'d Document<'d>,
    pub(super) included: ByInclude<'d>,
}

impl<'d> Files<'d> {
    /// The root elements of all files, the main one first.
    pub(super) fn roots(&self) -> Vec<Node<'d, 'd>> {
        std::iter::once(self.main.root_element()).chain(self.included.roots()).collect()
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
            match self.included.root(child) {
                Some(root) => stack.extend(elements(root)),
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
