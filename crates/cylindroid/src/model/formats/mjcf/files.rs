//! The files of an MJCF model: `<include>` inside the model's own folder, each file once.
//!
//! Checked  tests/formats/mjcf.rs::includes_*

use std::path::{Component, Path, PathBuf};

use roxmltree::{Document, Node};

use super::attributes::FORMAT;
use crate::error::Result;
use crate::model::formats::span::Source;
use crate::model::formats::xml::{self, Reader};

/// The text of an included file.
pub(super) struct Included {
    /// As the `<include>` names it.
    name: String,
    path: PathBuf,
    text: String,
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
    read(main, folder, &mut found)?;
    let mut next = 0;
    while next < found.len() {
        // The text is moved out while its own includes are read.
        let (path, text) = (found[next].path.clone(), std::mem::take(&mut found[next].text));
        read(&Source { format: FORMAT, path: &path, text: &text }, folder, &mut found)?;
        found[next].text = text;
        next += 1;
    }
    Ok(found)
}

fn read(source: &Source<'_>, folder: &Path, found: &mut Vec<Included>) -> Result<()> {
    let document = xml::document(source)?;
    for node in document.descendants().filter(|n| n.has_tag_name("include")) {
        let reader = Reader::new(*source, None);
        let name = reader.required(node, "file")?;
        let refuse = |message: String, help: &str| {
            Err(source.error(Reader::value(node, "file"), message, help))
        };
        let inside = |c: Component<'_>| matches!(c, Component::Normal(_) | Component::CurDir);
        if !Path::new(name).components().all(inside) {
            let help = "put the file into the folder of the model and include it by its name";
            return refuse(format!("'{name}' leaves the folder of the model"), help);
        }
        if found.iter().any(|f| f.name == name) {
            return refuse(format!("'{name}' is included twice"), "include a file only once");
        }
        let path = folder.join(name);
        match std::fs::read(&path) {
            Ok(bytes) => {
                let text = String::from_utf8_lossy(&bytes).into_owned();
                found.push(Included { name: name.to_owned(), path, text });
            }
            Err(e) => return refuse(format!("cannot read {}: {e}", path.display()), ""),
        }
    }
    Ok(())
}

/// The documents of a model: the main one, then the included ones.
pub(super) struct Files<'d> {
    pub(super) main: &'d Document<'d>,
    pub(super) included: Vec<(&'d str, &'d Document<'d>)>,
}

impl<'d> Files<'d> {
    pub(super) fn new(
        main: &'d Document<'d>,
        included: &'d [Included],
        documents: &'d [Document<'d>],
    ) -> Self {
        let names = included.iter().map(|f| f.name.as_str());
        Self { main, included: names.zip(documents).collect() }
    }

    /// The child elements; an `<include>` stands for the children of its file's root.
    pub(super) fn children(&self, node: Node<'d, 'd>) -> Vec<Node<'d, 'd>> {
        let mut children = Vec::new();
        let mut stack: Vec<Node<'d, 'd>> = elements(node);
        while let Some(child) = stack.pop() {
            let file = child.has_tag_name("include").then(|| child.attribute("file")).flatten();
            match file.and_then(|f| self.included.iter().find(|i| i.0 == f)) {
                Some((_, document)) => stack.extend(elements(document.root_element())),
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
