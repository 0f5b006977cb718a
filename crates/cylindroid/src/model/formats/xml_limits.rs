//! Limits of XML models, verified before the text is parsed: size, elements, nesting, attributes, names,
//! entities; and the prefixes that elements use without a declaration.
//!
//! Why so   a parser allocates for every element and compares all attributes of an element, so a
//!          small file can exhaust memory or time; one pass over the text bounds both. Programs
//!          that read robot files do not expand entities
//! Checked  tests/formats/limits.rs

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::ops::Range;

use super::span::Source;
use super::text_file;
use crate::error::Result;

/// Elements of all files of a model: a URDF of 100 000 links has 600 000.
pub(super) const MOST_ELEMENTS: usize = 1_000_000;
/// Links of a model: with joints, shapes and notes a link takes about 3 kB while it is read.
pub(super) const MOST_LINKS: usize = 120_000;
/// Elements that contain one another.
pub(super) const DEEPEST: usize = 1000;
/// Attributes of one element.
const MOST_ATTRIBUTES: usize = 256;
/// Attributes of a file.
const MOST_ATTRIBUTES_IN_ALL: usize = 2_000_000;
/// Declarations of namespaces of a file.
const MOST_NAMESPACES: usize = 1000;
/// Bytes of an attribute `name`.
const LONGEST_NAME: usize = 1000;

const DOCTYPE: &str = "<!DOCTYPE";

/// The tags of a text, until the first that is broken.
struct Tags<'t> {
    text: &'t str,
    at: usize,
}

/// A part of the text that begins with `<`.
enum Tag {
    Start {
        range: Range<usize>,
        is_empty: bool,
    },
    End {
        range: Range<usize>,
    },
    /// The declaration of an entity.
    Entity {
        at: usize,
    },
    Other,
}

impl Iterator for Tags<'_> {
    type Item = Tag;

    fn next(&mut self) -> Option<Tag> {
        let start = self.at + self.text.get(self.at..)?.find('<')?;
        let rest = &self.text[start..];
        let skip = |open: &str, close: &str| {
            rest.strip_prefix(open).map(|r| r.find(close).map(|i| open.len() + i + close.len()))
        };
        let skipped =
            skip("<!--", "-->").or_else(|| skip("<![CDATA[", "]]>")).or_else(|| skip("<?", "?>"));
        if let Some(length) = skipped {
            self.at = start + length?;
            return Some(Tag::Other);
        }
        if let Some(declaration) = rest.strip_prefix(DOCTYPE) {
            let (length, entity) = document_type(declaration)?;
            self.at = start + DOCTYPE.len() + length;
            return Some(if entity { Tag::Entity { at: self.at } } else { Tag::Other });
        }
        let mut quote = None;
        let bytes = rest.as_bytes();
        let end = bytes.iter().position(|&b| match quote {
            Some(q) => {
                if b == q {
                    quote = None;
                }
                false
            }
            None => {
                if matches!(b, b'"' | b'\'') {
                    quote = Some(b);
                }
                b == b'>'
            }
        })?;
        self.at = start + end + 1;
        let range = start..self.at;
        Some(if bytes.get(1) == Some(&b'/') {
            Tag::End { range }
        } else {
            Tag::Start { range, is_empty: bytes.get(end - 1) == Some(&b'/') }
        })
    }
}

/// The length of a document type declaration after [`DOCTYPE`], with its internal subset; up to the
/// first declaration of an entity if there is one (true). `None` if it is broken, by the rules of
/// the parser: `]` and `>` within comments, instructions and quoted identifiers end nothing.
fn document_type(text: &str) -> Option<(usize, bool)> {
    let mut quote = None;
    let open = text.find(|c: char| match quote {
        Some(q) => {
            quote = quote.filter(|_| c != q);
            false
        }
        None => {
            quote = Some(c).filter(|c| matches!(c, '"' | '\''));
            matches!(c, '[' | '>')
        }
    })?;
    let mut at = open + 1;
    if text[open..].starts_with('>') {
        return Some((at, false));
    }
    loop {
        let rest = text[at..].trim_start();
        at = text.len() - rest.len();
        if let Some(end) = rest.strip_prefix(']') {
            let end = end.trim_start().strip_prefix('>')?;
            return Some((text.len() - end.len(), false));
        }
        if rest.starts_with("<!ENTITY") {
            return Some((at, true));
        }
        let close = match rest {
            _ if rest.starts_with("<!--") => "-->",
            _ if rest.starts_with("<?") => "?>",
            _ if rest.starts_with("<!") => ">",
            _ => return None,
        };
        // The end of "<!-->" is not that of a comment.
        let from = if close == "-->" { 4 } else { 2 };
        at += from + rest[from..].find(close)? + close.len();
    }
}

/// Returns an error for a text that exceeds a limit.
pub(super) fn check(source: &Source<'_>) -> Result<()> {
    text_file::check_size(source)?;
    let (mut elements, mut depth, mut attributes, mut namespaces) = (0, 0, 0, 0);
    let exceeds = |at: usize, what: &str, most: usize| {
        let message = format!("the file has more than {most} {what}, the limit of this reader");
        Err(source.error(at..at + 1, message, ""))
    };
    for tag in (Tags { text: source.text, at: 0 }) {
        match tag {
            Tag::Start { range, is_empty } => {
                elements += 1;
                if elements > MOST_ELEMENTS {
                    return exceeds(range.start, "elements", MOST_ELEMENTS);
                }
                if depth >= DEEPEST {
                    return exceeds(range.start, "elements inside one another", DEEPEST);
                }
                depth += usize::from(!is_empty);
                let mut own = 0;
                for (name, value) in Attributes::of(&source.text[range.clone()]) {
                    own += 1;
                    namespaces += usize::from(name.starts_with("xmlns"));
                    if name == "name" && value.len() > LONGEST_NAME {
                        let what = "bytes in a name";
                        return exceeds(range.start, what, LONGEST_NAME);
                    }
                }
                attributes += own;
                if own > MOST_ATTRIBUTES {
                    return exceeds(range.start, "attributes of one element", MOST_ATTRIBUTES);
                }
                if attributes > MOST_ATTRIBUTES_IN_ALL {
                    return exceeds(range.start, "attributes", MOST_ATTRIBUTES_IN_ALL);
                }
                if namespaces > MOST_NAMESPACES {
                    return exceeds(range.start, "declarations of namespaces", MOST_NAMESPACES);
                }
            }
            Tag::End { .. } => depth = depth.saturating_sub(1),
            Tag::Entity { at } => {
                let message = "the file declares entities, which programs for robots do not expand";
                return Err(source.error(at..at + 8, message, "replace them by their values"));
            }
            Tag::Other => {}
        }
    }
    Ok(())
}

/// The name of the root element.
pub(super) fn root(text: &str) -> Option<&str> {
    let mut tags = Tags { text, at: 0 };
    let range = tags.find_map(|tag| match tag {
        Tag::Start { range, .. } => Some(range),
        _ => None,
    })?;
    Some(name_of(&text[range]))
}

/// The name in a tag, prefix included.
fn name_of(tag: &str) -> &str {
    let name = tag.trim_start_matches(['<', '/']);
    &name[..name.find(|c: char| c.is_whitespace() || "/>".contains(c)).unwrap_or(name.len())]
}

/// The attributes of a start tag: names and values.
struct Attributes<'t> {
    rest: &'t str,
}

impl<'t> Attributes<'t> {
    fn of(tag: &'t str) -> Self {
        Self { rest: tag.find(char::is_whitespace).map_or("", |i| &tag[i..]) }
    }
}

impl<'t> Iterator for Attributes<'t> {
    type Item = (&'t str, &'t str);

    fn next(&mut self) -> Option<Self::Item> {
        let (name, rest) = self.rest.split_once('=')?;
        let rest = rest.trim_start();
        let quote = rest.chars().next().filter(|c| matches!(c, '"' | '\''))?;
        let (value, rest) = rest[1..].split_once(quote)?;
        self.rest = rest;
        Some((name.trim(), value))
    }
}

/// The text with `prefix.` for `prefix:` in the names of elements and attributes where no
/// `xmlns:prefix` declares it: programs for robots do not require declarations.
pub(super) fn without_undeclared(text: &str) -> Cow<'_, str> {
    if text.len() as u64 > text_file::LARGEST_FILE {
        return Cow::Borrowed(text); // refused by `check`
    }
    let mut declared = BTreeSet::from(["xml", "xmlns", "xacro"]);
    // That of the root must be declared.
    declared.extend(root(text).and_then(|name| name.split_once(':')).map(|(prefix, _)| prefix));
    let mut used = Vec::new();
    for tag in (Tags { text, at: 0 }) {
        let (Tag::Start { range, .. } | Tag::End { range }) = tag else { continue };
        let tag = &text[range.clone()];
        let keys = Attributes::of(tag).map(|(key, _)| key);
        for name in std::iter::once(name_of(tag)).chain(keys) {
            let Some((prefix, local)) = name.split_once(':') else { continue };
            if prefix == "xmlns" {
                declared.insert(local);
            } else {
                // Both are parts of `text`.
                used.push((
                    prefix,
                    prefix.as_ptr() as usize + prefix.len() - text.as_ptr() as usize,
                ));
            }
        }
    }
    used.retain(|(prefix, _)| !declared.contains(prefix) && !prefix.is_empty());
    if used.is_empty() {
        return Cow::Borrowed(text);
    }
    let mut bytes = text.as_bytes().to_vec();
    used.iter().for_each(|&(_, colon)| bytes[colon] = b'.');
    String::from_utf8(bytes).map_or(Cow::Borrowed(text), Cow::Owned)
}
