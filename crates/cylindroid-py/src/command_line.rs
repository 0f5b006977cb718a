//! The command `cylindroid` of the wheel: the binary's own, inside the interpreter.

use std::ffi::OsString;

use pyo3::prelude::*;

/// Runs the command line with these words, the name of the program first.
///
/// Parameters
/// ----------
/// words : list of str
///     As `sys.argv`.
///
/// Returns
/// -------
/// int
///     The exit code: 0 for success, 1 for a negative answer, 2 for an error, which was printed, 130
///     for a run that Ctrl-C stopped.
#[pyfunction]
pub(crate) fn run_command_line(py: Python<'_>, words: Vec<OsString>) -> u8 {
    py.detach(|| cylindroid_cli::run(words)).code()
}
