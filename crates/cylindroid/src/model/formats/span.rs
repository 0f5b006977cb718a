//! Places in a model file: from byte ranges to errors with line and column, and the log of ignored
//! elements.
//!
//! Checked  tests in this file, tests/formats/broken.rs

use std::collections::{BTreeMap, HashSet};
use std::ops::Range;
use std::path::Path;

use crate::error::{Error, FileError, shown};
use crate::model::LoadReport;

/// The text of a model file, for errors with line and column.
#[derive(Debug, Clone, Copy)]
pub(super) struct Source<'a> {
    pub(super) format: &'static str,
    pub(super) path: &'a Path,
    pub(super) text: &'a str,
}

impl Source<'_> {
    /// An error at a byte range of the text.
    pub(super) fn error(
        &self,
        span: Range<usize>,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Error {
        let start = self.clamp(span.start);
        let end = self.clamp(span.end).max(start);
        let (line, column) = self.line_column(start);
        Error::File(Box::new(FileError {
            format: self.format,
            path: self.path.to_owned(),
            line,
            column,
            span: start..end,
            message: message.into(),
            help: help.into(),
        }))
    }

    /// The byte offset of a line and a column in characters, both from 1.
    pub(super) fn offset(&self, line: usize, column: usize) -> usize {
        let start: usize =
            self.text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
        let rest = &self.text[start..];
        let within = rest.char_indices().nth(column.saturating_sub(1)).map_or(rest.len(), |c| c.0);
        start + within
    }

    fn line_column(&self, offset: usize) -> (usize, usize) {
        let before = &self.text[..offset];
        let line_start = before.rfind('\n').map_or(0, |i| i + 1);
        let line = before.bytes().filter(|b| *b == b'\n').count() + 1;
        (line, before[line_start..].chars().count() + 1)
    }

    /// The offset, moved back to the start of a character inside the text.
    fn clamp(&self, offset: usize) -> usize {
        let mut offset = offset.min(self.text.len());
        while !self.text.is_char_boundary(offset) {
            offset -= 1;
        }
        offset
    }
}

/// Characters of the names listed in one note; further names are only counted.
const NAMES_SHOWN: usize = 60;

/// Distinct notes of a file; further parts are only counted.
const NOTES_KEPT: usize = 10_000;

/// The log of ignored elements and attributes, one note for each distinct reason.
#[derive(Debug, Default)]
pub(super) struct IgnoredLog {
    notes: Vec<Note>,
    /// The note of each file, part and reason.
    index: BTreeMap<(usize, String, &'static str), usize>,
    /// Parts beyond [`NOTES_KEPT`].
    uncounted: usize,
    /// Files and offsets of all notes.
    places: HashSet<(usize, usize)>,
}

#[derive(Debug)]
struct Note {
    /// 0 is the main file.
    file: usize,
    offset: usize,
    what: String,
    why: &'static str,
    count: usize,
    names: Vec<String>,
}

impl IgnoredLog {
    /// Logs `what` at a byte offset; `name` is that of its owner (may be empty). Repetitions of the
    /// same `what` are counted.
    pub(super) fn add(
        &mut self,
        offset: usize,
        what: impl Into<String>,
        why: &'static str,
        name: &str,
    ) {
        self.add_in(0, offset, what, why, name);
    }

    /// [`IgnoredLog::add`] for a file that the main one (0) includes.
    pub(super) fn add_in(
        &mut self,
        file: usize,
        offset: usize,
        what: impl Into<String>,
        why: &'static str,
        name: &str,
    ) {
        self.places.insert((file, offset));
        let key = (file, what.into(), why);
        let index = match self.index.get(&key) {
            Some(&index) => index,
            None if self.notes.len() >= NOTES_KEPT => {
                self.uncounted += 1;
                return;
            }
            None => {
                let what = key.1.clone();
                self.notes.push(Note { file, offset, what, why, count: 0, names: Vec::new() });
                self.index.insert(key, self.notes.len() - 1);
                self.notes.len() - 1
            }
        };
        let note = &mut self.notes[index];
        note.count += 1;
        note.offset = note.offset.min(offset);
        // One name more than is shown tells that there are more.
        let shown: usize = note.names.iter().map(String::len).sum();
        if !name.is_empty() && shown <= NAMES_SHOWN && !note.names.iter().any(|n| n == name) {
            note.names.push(name.to_owned());
        }
    }

    /// Accounts for a part at a file and offset without a note of its own.
    pub(super) fn pass_over(&mut self, place: (usize, usize)) {
        self.places.insert(place);
    }

    /// True if the part at this file and offset is accounted for.
    pub(super) fn has(&self, place: (usize, usize)) -> bool {
        self.places.contains(&place)
    }

    /// Writes the notes into a report, in the order of the files; the main one is the first.
    pub(super) fn write(mut self, sources: &[Source<'_>], report: &mut LoadReport) {
        self.notes.sort_by_key(|n| (n.file, n.offset));
        let (mut file, mut line, mut counted) = (0, 1, 0);
        for note in self.notes {
            let Some(source) = sources.get(note.file) else { continue };
            if note.file != file {
                (file, line, counted) = (note.file, 1, 0);
            }
            let offset = source.clamp(note.offset);
            line += source.text.as_bytes()[counted..offset].iter().filter(|b| **b == b'\n').count();
            counted = offset;
            let mut detail = Vec::new();
            if note.file > 0 {
                detail.push(format!("in {}", shown(source.path)));
            }
            if note.count > 1 {
                detail.push(format!("{} times", note.count));
            }
            if !note.names.is_empty() {
                let mut names = note.names.iter();
                let mut list = names.next().cloned().unwrap_or_default();
                for name in names {
                    if list.len() + name.len() > NAMES_SHOWN {
                        list += ", ...";
                        break;
                    }
                    list = format!("{list}, {name}");
                }
                detail.push(list);
            }
            let what = if detail.is_empty() {
                note.what
            } else {
                format!("{} ({})", note.what, detail.join(": "))
            };
            report.ignore(line, what, note.why);
        }
        if self.uncounted > 0 {
            let what = format!("{} further elements and attributes", self.uncounted);
            report.ignore(0, what, "not known to this reader");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "<a>\n  <é x='1'/>\n</a>";

    fn source() -> Source<'static> {
        Source { format: "URDF", path: Path::new("a.urdf"), text: TEXT }
    }

    #[test]
    fn columns_count_characters_and_offsets_come_back() {
        let x = TEXT.find('x').unwrap();
        let Error::File(e) = source().error(x..x + 1, "m", "h") else { panic!("not a file error") };
        assert_eq!((e.line, e.column, e.span), (2, 6, x..x + 1));
        assert_eq!(source().offset(2, 6), x);
    }

    #[test]
    fn ranges_outside_the_text_or_inside_a_character_are_moved() {
        let inside = TEXT.find('é').unwrap() + 1;
        for span in [inside..inside, 1000..2000, inside + 1..inside] {
            assert!(matches!(source().error(span, "m", ""), Error::File(_)));
        }
        assert_eq!(source().offset(99, 99), TEXT.len());
    }

    #[test]
    fn notes_of_the_same_thing_are_one() {
        let mut notes = IgnoredLog::default();
        notes.add(20, "<dynamics>", "not used", "b");
        notes.add(5, "<dynamics>", "not used", "a");
        notes.add(0, "<gazebo>", "not used", "");
        let mut report = LoadReport::default();
        notes.write(&[source()], &mut report);
        assert_eq!(report.ignored.len(), 2);
        assert_eq!(report.ignored[1].what, "<dynamics> (2 times: b, a)");
        assert_eq!((report.ignored[0].line, report.ignored[1].line), (1, 2));
    }
}
