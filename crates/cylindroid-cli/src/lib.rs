//! The command line of cylindroid, and for other programs the server of its viewer and its files of
//! numbers.
//!
//! The binary `cylindroid` is [`run`], and so is the command of the Python package, which starts the
//! viewer by [`show::Viewer`] and reads files of configurations by [`numbers`].

mod args;
mod commands;
mod diagnostic;
mod exit;
#[cfg(any(test, fuzzing))]
mod fed;
mod flags;
mod number_file;
mod obstacle;
mod other_programs;
mod output;
mod output_file;
mod plot;
mod task_trajectory;
mod trajectory;
mod values;
mod viewer;

pub mod show {
    //! The viewer inside another program: a page that follows it.
    pub use crate::viewer::{Drag, Drawing, DrawnShape, ShowOptions, Viewer};
}

pub mod numbers {
    //! Files of numbers inside another program: CSV and Parquet, by the names of their columns.
    pub use crate::number_file::{is_arrow, named_columns, named_configurations};
}

#[cfg(fuzzing)]
#[doc(hidden)]
pub mod fuzzing {
    //! What fuzz targets call.
    use std::path::Path;

    /// Messages of the viewer.
    pub fn messages(bytes: &[u8]) {
        crate::viewer::feed(bytes);
    }

    /// A file of numbers.
    pub fn numbers(path: &Path) {
        crate::fed::numbers(path);
    }

    /// A file of tasks.
    pub fn tasks(path: &Path) {
        crate::fed::tasks(path);
    }
}

use std::ffi::OsString;
use std::io::{self, BufWriter, Write};

use clap::{CommandFactory, Parser};

use crate::args::Cli;
pub use crate::exit::Exit;

/// Runs the command line with these words, the name of the program first. A closed pipe counts as
/// success.
pub fn run(words: impl IntoIterator<Item = OsString>) -> Exit {
    match attempt(words) {
        Ok(exit) => exit,
        Err(error) if diagnostic::is_closed_pipe(&error) => Exit::SUCCESS,
        Err(error) => {
            diagnostic::print(&error);
            Exit::ERROR
        }
    }
}

fn attempt(words: impl IntoIterator<Item = OsString>) -> anyhow::Result<Exit> {
    let words: Vec<OsString> = words.into_iter().collect();
    if let Some((program, rest)) = other_programs::named(&words) {
        return other_programs::run(program, rest);
    }
    let words = words.into_iter().map(|word| {
        word.into_string().map_err(|word| {
            let hint = "rename the file or leave out these bytes";
            anyhow::anyhow!("the argument {word:?} is not UTF-8; {hint}")
        })
    });
    let words = values::join_after_commas(words.collect::<anyhow::Result<Vec<String>>>()?);
    if words.len() <= 1 {
        Cli::command().print_help()?;
        return Ok(Exit::SUCCESS);
    }
    let cli = match Cli::try_parse_from(&words) {
        Ok(cli) => cli,
        Err(message) => {
            // clap prints help and version to stdout with exit code 0.
            message.print()?;
            return Ok(if message.use_stderr() { Exit::ERROR } else { Exit::SUCCESS });
        }
    };
    let mut out = BufWriter::new(io::stdout().lock());
    let code = commands::run(&cli, &mut out).map_err(|error| flags::named(error, &words))?;
    out.flush()?;
    Ok(code)
}
