//! The files that an XML model includes, and those that they include: read once for each
//! `<include>`, within limits.
//!
//! Why so   MJCF and SDF differ in the search for a file alone
//! Fails    more than [`MOST_FILES`] files, more than [`LARGEST_INCLUSION`] bytes, a file that cannot
//!          be read: at the `<include>`; more elements than one file may have: at the file
//! Checked  tests/formats/limits.rs, tests/formats/mjcf.rs::includes_*,
//!          tests/formats/sdf.rs::includes_*

use std::cell::Cell;
use std::collections::BTreeMap;
use std::path::PathBuf;

use roxmltree::{Document, Node};

use super::span::Source;
use super::text_file::{self, TextFile};
use super::xml::{self, Reader};
use super::xml_limits;
use crate::error::{Error, Result, shown};

/// The bytes and elements of the files of a model so far: of those that it includes, and those that
/// it attaches with all that they include.
#[derive(Debug, Default)]
pub(super) struct Together {
    bytes: Cell<usize>,
    elements: Cell<usize>,
}

impl Together {
    /// Counts the text of a file that a model brings in; otherwise returns the limit.
    pub(super) fn count_text(&self, text: &str) -> std::result::Result<(), String> {
        self.bytes.set(self.bytes.get() + text.len());
        if self.bytes.get() <= LARGEST_INCLUSION {
            return Ok(());
        }
        Err(format!("the included files exceed {} MiB together", LARGEST_INCLUSION >> 20))
    }

    fn count_elements(&self, source: &Source<'_>, document: &Document<'_>) -> Result<()> {
        const MOST: usize = xml_limits::MOST_ELEMENTS;
        let own = document.descendants().filter(Node::is_element).count();
        self.elements.set(self.elements.get() + own);
        if self.elements.get() <= MOST {
            return Ok(());
        }
        let message = format!(
            "the files of the model up to this one have more than {MOST} elements together, the \
             limit of this reader"
        );
        Err(source.error(Reader::tag(document.root_element()), message, ""))
    }
}

/// Included files; SDF may include a file several times.
const MOST_FILES: usize = 1000;

/// The bytes of all included files: 64 MiB.
const LARGEST_INCLUSION: usize = 64 << 20;

/// An included file.
pub(super) struct Included {
    pub(super) path: PathBuf,
    text: String,
    /// Byte offset of the first character that replaces bytes that are not UTF-8.
    replaced: Option<usize>,
    /// The file (0 is the main one) and the byte offset of its `<include>`.
    place: (usize, usize),
}

impl Included {
    pub(super) fn source(&self, format: &'static str) -> Source<'_> {
        Source { format, path: &self.path, text: &self.text }
    }
}

/// Reads the files that a model includes, and those that they include. `find` gets the file with an
/// `<include>`, the element and the files before it; `None` leaves the file out.
pub(super) fn gather(
    main: &Source<'_>,
    together: &Together,
    find: impl Fn(&Source<'_>, Node<'_, '_>, &[Included]) -> Result<Option<PathBuf>>,
) -> Result<Vec<Included>> {
    let mut found: Vec<Included> = Vec::new();
    for file in 0_usize.. {
        // The text is moved out while its own includes are read.
        let own = match file.checked_sub(1).map(|i| found.get_mut(i)) {
            None => None,
            Some(None) => break,
            Some(Some(f)) => Some((f.path.clone(), std::mem::take(&mut f.text))),
        };
        let source = match &own {
            None => *main,
            Some((path, text)) => Source { format: main.format, path, text },
        };
        let document = xml::document(&source)?;
        together.count_elements(&source, &document)?;
        for node in document.descendants().filter(|n| n.has_tag_name("include")) {
            let Some(path) = find(&source, node, &found)? else { continue };
            let refuse =
                |message: String, help| Err(source.error(Reader::tag(node), message, help));
            if found.len() >= MOST_FILES {
                let message = format!("the model includes more than {MOST_FILES} files");
                return refuse(message, "does a file include itself?");
            }
            let (text, replaced) = match text_file::read(&path) {
                Ok(TextFile { text, replaced }) => {
                    (xml_limits::without_undeclared(&text).into_owned(), replaced)
                }
                Err(Error::Io { path, message, .. }) => {
                    return refuse(format!("cannot read {}: {message}", shown(&path)), "");
                }
                Err(error) => return Err(error),
            };
            if let Err(message) = together.count_text(&text) {
                return refuse(message, "");
            }
            found.push(Included { path, text, replaced, place: (file, node.range().start) });
        }
        drop(document);
        if let (Some((_, text)), Some(i)) = (own, file.checked_sub(1)) {
            found[i].text = text;
        }
    }
    Ok(found)
}

/// The included documents.
#[derive(Debug)]
pub(super) struct ByInclude<'d> {
    documents: &'d [Document<'d>],
    /// Indices of `documents` by the texts and offsets of their `<include>` elements.
    index: BTreeMap<(usize, usize), usize>,
    /// Files (0 is the main one) and offsets of bytes that are not UTF-8.
    replaced: Vec<(usize, usize)>,
}

impl<'d> ByInclude<'d> {
    /// `documents` are those of `included`.
    pub(super) fn new(
        main: &'d Document<'d>,
        included: &[Included],
        documents: &'d [Document<'d>],
    ) -> Self {
        let text = |file: usize| text_of(file.checked_sub(1).map_or(main, |i| &documents[i]));
        let place = |f: &Included| (text(f.place.0), f.place.1);
        let replaced = |(i, f): (usize, &Included)| f.replaced.map(|at| (i + 1, at));
        Self {
            documents,
            index: included.iter().map(place).zip(0..).collect(),
            replaced: included.iter().enumerate().filter_map(replaced).collect(),
        }
    }

    /// Logs the bytes of the included files that are not UTF-8.
    pub(super) fn note_replaced(&self, reader: &mut Reader<'_>) {
        for (file, at) in &self.replaced {
            reader.notes.add_in(*file, *at, text_file::NOT_UTF8, text_file::WHY_REPLACED, "");
        }
    }

    /// The root element of the file that an `<include>` brings.
    pub(super) fn root(&self, include: Node<'d, 'd>) -> Option<Node<'d, 'd>> {
        let place = (text_of(include.document()), include.range().start);
        self.index.get(&place).map(|i| self.documents[*i].root_element())
    }

    /// The root elements of all included files, in the order in which they were found.
    pub(super) fn roots(&self) -> impl Iterator<Item = Node<'d, 'd>> + use<'d> {
        self.documents.iter().map(Document::root_element)
    }
}

/// Identifies a document by its text.
fn text_of(document: &Document<'_>) -> usize {
    document.input_text().as_ptr() as usize
}
