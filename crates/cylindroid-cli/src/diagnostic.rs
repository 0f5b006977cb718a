//! Errors on stderr: file errors with the line underlined, others as one paragraph.

use std::fmt;
use std::io::{self, Write};

use cylindroid::model::read_regular_file;
use cylindroid::{Error, FileError};
use miette::{Diagnostic, LabeledSpan, NamedSource, Report, SourceCode};

/// Prints an error; failures of stderr are ignored.
pub(crate) fn print(error: &anyhow::Error) {
    let mut out = io::stderr();
    let _ = match error.downcast_ref::<Error>() {
        Some(Error::File(file)) => writeln!(out, "{:?}", Report::new(Underlined::new(file))),
        _ => writeln!(out, "error: {error:#}"),
    };
}

/// True if the reader closed the pipe, as `head` does; not an error.
pub(crate) fn is_closed_pipe(error: &anyhow::Error) -> bool {
    error.chain().any(|cause| {
        cause
            .downcast_ref::<std::io::Error>()
            .is_some_and(|e| e.kind() == std::io::ErrorKind::BrokenPipe)
    })
}

/// Larger files (bytes) are not shown.
const LARGEST_SHOWN: u64 = 32 << 20;

/// Longer lines (bytes) are not shown.
const LONGEST_SHOWN: usize = 1000;

/// A place in a model file, with the text of the file.
#[derive(Debug)]
struct Underlined {
    error: FileError,
    /// The text of the file; `None` if it can no longer be read.
    source: Option<NamedSource<String>>,
}

impl Underlined {
    fn new(error: &FileError) -> Self {
        let mut error = error.clone();
        let bytes = read_regular_file(&error.path, LARGEST_SHOWN).ok();
        let text = bytes.map(|b| String::from_utf8_lossy(&b).into_owned());
        let text = text.filter(|t| {
            let line = t.lines().nth(error.line.saturating_sub(1));
            line.is_none_or(|line| line.len() <= LONGEST_SHOWN)
        });
        if let Some(text) = &text {
            error.span.start = text.floor_char_boundary(error.span.start);
            error.span.end = text.ceil_char_boundary(error.span.end.max(error.span.start));
        }
        let name = error.path.display().to_string();
        Self { source: text.map(|t| NamedSource::new(name, t)), error }
    }
}

impl fmt::Display for Underlined {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let FileError { format, path, line, column, message, .. } = &self.error;
        write!(f, "{}:{line}:{column}: {message} (read as {format})", path.display())
    }
}

impl std::error::Error for Underlined {}

impl Diagnostic for Underlined {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        (!self.error.help.is_empty()).then(|| Box::new(&self.error.help) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.source.as_ref().map(|s| s as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let label = LabeledSpan::new_with_span(Some("here".to_owned()), self.error.span.clone());
        self.source.is_some().then(|| Box::new(std::iter::once(label)) as Box<_>)
    }
}
