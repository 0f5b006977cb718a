//! Reads elements and attributes of XML models: numbers are checked, errors carry line and column,
//! unused elements and attributes are reported. Shared by URDF, MJCF and SDF.
//!
//! Checked  tests/formats/broken.rs, tests/formats/mutations.rs

use std::cell::RefCell;
use std::collections::HashSet;
use std::ops::Range;
use std::path::Path;

use roxmltree::{Document, Node, ParsingOptions};

use super::span::{IgnoredLog, Source};
use super::xml_limits;
use crate::error::{Error, Result};
use crate::model::{LoadReport, magnitude};

/// What to do with a xacro file.
pub(super) const XACRO_HELP: &str = "pip install xacro, and files named .xacro are expanded when \
                                     they are loaded; others by xacro file.urdf.xacro > file.urdf";

/// The state shared by all parts of a reader.
#[derive(Debug)]
pub(super) struct Reader<'a> {
    pub(super) source: Source<'a>,
    /// The texts of included files.
    pub(super) included: Vec<Source<'a>>,
    pub(super) notes: IgnoredLog,
    /// Files and offsets of elements whose attributes and children were accounted for, and of texts
    /// that were read.
    read: RefCell<HashSet<(usize, usize)>>,
    /// The namespace of the root: elements of another one are extensions.
    pub(super) namespace: Option<&'a str>,
    /// Elements whose `name` identifies the owner of an ignored element or attribute in notes.
    pub(super) owners: &'static [&'static str],
    /// The reason for ignoring an element or attribute of this name.
    pub(super) why: fn(&str) -> &'static str,
}

/// Elements, texts and comments of a file: blanks around every element are texts too.
const MOST_NODES: u32 = 3 * xml_limits::MOST_ELEMENTS as u32;

/// Parses XML within the limits of this reader; errors carry line and column.
pub(super) fn document<'t>(source: &Source<'t>) -> Result<Document<'t>> {
    xml_limits::check(source)?;
    let options =
        ParsingOptions { allow_dtd: true, nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    Document::parse_with_options(source.text, options).map_err(|error| {
        let position = error.pos();
        let offset = source.offset(position.row as usize, position.col as usize);
        let span = offset..offset + 1;
        if matches!(&error, roxmltree::Error::UnknownNamespace(prefix, _) if prefix == "xacro") {
            return xacro(source, span);
        }
        let text = error.to_string();
        let message = text.strip_suffix(&format!(" at {position}")).unwrap_or(&text);
        source.error(span, format!("broken XML: {message}"), "")
    })
}

pub(super) fn xacro(source: &Source<'_>, span: Range<usize>) -> Error {
    source.error(span, "this is xacro, a program that writes a URDF, not a URDF", XACRO_HELP)
}

impl<'a> Reader<'a> {
    /// A reader of one file.
    pub(super) fn new(source: Source<'a>, namespace: Option<&'a str>) -> Self {
        let (included, notes, read) = (Vec::new(), IgnoredLog::default(), RefCell::default());
        let why = |_: &str| "not known to this reader";
        Self { source, included, notes, read, namespace, owners: &[], why }
    }

    /// The index of the file of a node: 0 is the main one.
    fn file(&self, node: Node<'_, '_>) -> usize {
        let text = node.document().input_text().as_ptr();
        self.included.iter().position(|s| s.text.as_ptr() == text).map_or(0, |i| i + 1)
    }

    /// The path of the file of a node.
    pub(super) fn path_of(&self, node: Node<'_, '_>) -> &'a Path {
        let source = self.file(node).checked_sub(1).and_then(|i| self.included.get(i));
        source.unwrap_or(&self.source).path
    }

    /// An error at a byte range of the file of the node.
    pub(super) fn error(
        &self,
        node: Node<'_, '_>,
        span: Range<usize>,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Error {
        let source = self.file(node).checked_sub(1).and_then(|i| self.included.get(i));
        source.unwrap_or(&self.source).error(span, message, help)
    }

    /// Returns an error at an element with which a model has more links than this reader allows.
    pub(super) fn check_links(&self, node: Node<'_, '_>, links: usize) -> Result<()> {
        const MOST: usize = xml_limits::MOST_LINKS;
        if links <= MOST {
            return Ok(());
        }
        let message = format!("the model has more than {MOST} links, the limit of this reader");
        Err(self.error(node, Self::tag(node), message, ""))
    }

    /// Accounts for an element, and all that it contains, about which another note speaks.
    pub(super) fn pass_over(&mut self, node: Node<'_, '_>) {
        self.notes.pass_over((self.file(node), node.range().start));
    }

    /// Logs an ignored part of a node; `name` is that of its owner (may be empty).
    pub(super) fn note(
        &mut self,
        node: Node<'_, '_>,
        what: impl Into<String>,
        why: &'static str,
        name: &str,
    ) {
        self.note_at(node, node.range().start, what, why, name);
    }

    fn note_at(
        &mut self,
        node: Node<'_, '_>,
        offset: usize,
        what: impl Into<String>,
        why: &'static str,
        name: &str,
    ) {
        let file = self.file(node);
        self.notes.add_in(file, offset, what, why, name);
    }

    /// Writes the notes into the report of a model. Every element of the documents that was neither
    /// read nor noted is noted here, so that no part of a file is ignored silently.
    pub(super) fn report(&mut self, roots: &[Node<'_, '_>], report: &mut LoadReport) {
        for root in roots {
            self.note_unread(*root);
        }
        let mut sources = vec![self.source];
        sources.extend(&self.included);
        std::mem::take(&mut self.notes).write(&sources, report);
    }

    fn note_unread(&mut self, root: Node<'_, '_>) {
        let file = self.file(root);
        let mut stack = vec![root];
        while let Some(node) = stack.pop() {
            let place = (file, node.range().start);
            let is_read = self.read.borrow().contains(&place);
            if node.is_text() {
                if !is_read && !node.text().unwrap_or("").trim().is_empty() {
                    let parent = node.parent_element().map_or("", |p| p.tag_name().name());
                    let owner = self.owner(node);
                    self.note(node, format!("text in <{parent}>"), "it has no meaning here", owner);
                }
            } else if is_read {
                stack.extend(node.children().filter(|n| n.is_element() || n.is_text()));
            } else if !self.notes.has(place) {
                let name = node.tag_name().name();
                let owner = self.owner(node);
                self.note(node, format!("<{name}>"), (self.why)(name), owner);
            }
        }
    }

    /// Marks an element, or a text, as read.
    pub(super) fn mark(&self, node: Node<'_, '_>) {
        self.read.borrow_mut().insert((self.file(node), node.range().start));
    }

    /// True for an element of this name in the namespace of the root.
    pub(super) fn is(&self, node: Node<'_, '_>, name: &str) -> bool {
        node.is_element()
            && node.tag_name().name() == name
            && node.tag_name().namespace() == self.namespace
    }

    /// The byte range of `<name`, prefix included.
    pub(super) fn tag(node: Node<'_, '_>) -> Range<usize> {
        let start = node.range().start;
        let text = node.document().input_text().get(start..).unwrap_or("");
        let length = text.find(|c: char| c.is_whitespace() || c == '/' || c == '>');
        start..start + length.unwrap_or(text.len())
    }

    /// The byte range of an attribute's value; of the tag if there is no such attribute.
    pub(super) fn value(node: Node<'_, '_>, attribute: &str) -> Range<usize> {
        node.attribute_node(attribute).map_or_else(|| Self::tag(node), |a| a.range_value())
    }

    pub(super) fn required<'d>(&self, node: Node<'d, '_>, attribute: &str) -> Result<&'d str> {
        node.attribute(attribute).filter(|v| !v.trim().is_empty()).ok_or_else(|| {
            let tag = node.tag_name().name();
            self.error(
                node,
                Self::value(node, attribute),
                format!("<{tag}> has no {attribute}"),
                format!("write <{tag} {attribute}=\"...\">"),
            )
        })
    }

    /// The numbers of an attribute, any count; infinite ones are accepted, NaN is rejected.
    pub(super) fn list(&self, node: Node<'_, '_>, attribute: &str) -> Result<Option<Vec<f64>>> {
        let Some(text) = node.attribute(attribute) else { return Ok(None) };
        let what = || format!("{attribute} of <{}>", node.tag_name().name());
        let read = |(word, message)| self.refuse_number(node, attribute, word, message);
        numbers_in(text)
            .map(Some)
            .map_err(|word| read((text, format!("{}: '{word}' is not a number", what()))))
    }

    /// An error about the numbers of an attribute.
    fn refuse_number(
        &self,
        node: Node<'_, '_>,
        attribute: &str,
        text: &str,
        message: String,
    ) -> Error {
        let help = if text.contains("${") || text.contains("$(") { XACRO_HELP } else { "" };
        self.error(node, Self::value(node, attribute), message, help)
    }

    /// The numbers of an attribute; infinite ones are accepted, NaN is rejected.
    fn numbers<const N: usize>(
        &self,
        node: Node<'_, '_>,
        attribute: &str,
    ) -> Result<Option<[f64; N]>> {
        let Some(values) = self.list(node, attribute)? else { return Ok(None) };
        let count = values.len();
        match <[f64; N]>::try_from(values) {
            Ok(values) => Ok(Some(values)),
            Err(_) => {
                let tag = node.tag_name().name();
                let message = format!("{attribute} of <{tag}> has {count} numbers, expected {N}");
                let help = format!("{attribute} takes {N} number{}", if N == 1 { "" } else { "s" });
                Err(self.error(node, Self::value(node, attribute), message, help))
            }
        }
    }

    /// A vector of finite numbers.
    pub(super) fn vector<const N: usize>(
        &self,
        node: Node<'_, '_>,
        attribute: &str,
    ) -> Result<Option<[f64; N]>> {
        let values = self.numbers::<N>(node, attribute)?;
        self.check(node, attribute, values.and_then(|v| magnitude::fault(&v)))?;
        Ok(values)
    }

    /// A finite number.
    pub(super) fn number(&self, node: Node<'_, '_>, attribute: &str) -> Result<Option<f64>> {
        Ok(self.vector::<1>(node, attribute)?.map(|[x]| x))
    }

    /// A limit: a number that may be infinite.
    pub(super) fn bound(&self, node: Node<'_, '_>, attribute: &str) -> Result<Option<f64>> {
        let limit = self.numbers::<1>(node, attribute)?;
        self.check(node, attribute, limit.and_then(|x| magnitude::bound_fault(&x)))?;
        Ok(limit.map(|[x]| x))
    }

    fn check(&self, node: Node<'_, '_>, attribute: &str, fault: Option<String>) -> Result<()> {
        let Some(fault) = fault else { return Ok(()) };
        let message = format!("{attribute} of <{}> {fault}", node.tag_name().name());
        Err(self.error(node, Self::value(node, attribute), message, "give finite numbers"))
    }

    /// The first child element of this name; further ones are logged as ignored.
    pub(super) fn child<'d, 'i>(&mut self, node: Node<'d, 'i>, name: &str) -> Option<Node<'d, 'i>> {
        let mut all = node.children().filter(|c| self.is(*c, name));
        let first = all.next()?;
        if let Some(second) = all.next() {
            let what = format!("second <{name}> in <{}>", node.tag_name().name());
            let owner = node.attribute("name").unwrap_or("");
            self.note(second, what, "the first one counts", owner);
        }
        Some(first)
    }

    /// An error at the value of an attribute, with a complete message.
    pub(super) fn refuse(
        &self,
        node: Node<'_, '_>,
        attribute: &str,
        message: impl Into<String>,
    ) -> Error {
        self.error(node, Self::value(node, attribute), message, "")
    }

    /// Marks an element as read, and logs attributes and children that are not among those known;
    /// known children are read themselves, or logged at the end.
    pub(super) fn leftovers(&mut self, node: Node<'_, '_>, attributes: &[&str], children: &[&str]) {
        self.unread_attributes(node, attributes);
        for child in node.children().filter(Node::is_element) {
            let name = child.tag_name().name();
            let known = child.tag_name().namespace() == self.namespace && children.contains(&name);
            if !known {
                let owner = if node.parent_element().is_none() { "" } else { self.owner(node) };
                let why = (self.why)(name);
                self.note(child, format!("<{name}>"), why, owner);
            }
        }
    }

    /// Marks an element as read, and logs attributes that are not among those known.
    pub(super) fn unread_attributes(&mut self, node: Node<'_, '_>, known: &[&str]) {
        self.mark(node);
        let tag = node.tag_name().name();
        let owner = self.owner(node);
        for attribute in node.attributes() {
            if attribute.namespace().is_some() || !known.contains(&attribute.name()) {
                let name = attribute.name();
                let what = format!("attribute '{name}' of <{tag}>");
                let why = (self.why)(name);
                self.note_at(node, attribute.range().start, what, why, owner);
            }
        }
    }

    /// The name of the link, joint, ... that contains an element.
    pub(super) fn owner<'d>(&self, node: Node<'d, '_>) -> &'d str {
        node.ancestors()
            .find(|n| self.owners.contains(&n.tag_name().name()))
            .and_then(|n| n.attribute("name"))
            .unwrap_or("")
    }
}

/// The numbers of a text; an error with the first word that is not a number, or is NaN.
pub(super) fn numbers_in(text: &str) -> std::result::Result<Vec<f64>, &str> {
    let number = |word: &'_ str| word.parse().ok().filter(|x: &f64| !x.is_nan());
    text.split_whitespace().map(|word| number(word).ok_or(word)).collect()
}
