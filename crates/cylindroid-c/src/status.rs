//! Status codes, the text of the last error, and the guard of every function.
//!
//! Checked  tests/programs.rs

use std::cell::RefCell;
use std::ffi::{CString, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};

use cylindroid::Error;

/// The outcome of a call. Numbers never change their meaning; new ones may be added.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum cyl_status {
    /// Done.
    CYL_OK = 0,
    /// A null pointer where a value is required, or text that is not UTF-8.
    CYL_NULL_OR_TEXT = 1,
    /// A file that cannot be read, or with an error in it.
    CYL_FILE = 2,
    /// A joint, frame, method or quantity of this name does not exist; the text has the nearest.
    CYL_UNKNOWN_NAME = 3,
    /// An array of another size than expected.
    CYL_DIMENSION = 4,
    /// A number that is not finite, or out of range.
    CYL_NOT_FINITE = 5,
    /// An option that cannot be used.
    CYL_INVALID_OPTION = 6,
    /// A mechanism for which the call makes no sense.
    CYL_MODEL = 7,
    /// Another error of the library.
    CYL_OTHER = 8,
    /// A defect of the library: please report it. The handle must not be used any more.
    CYL_INTERNAL = 9,
}

thread_local! {
    static LAST: RefCell<CString> = RefCell::new(CString::default());
}

/// A failure on its way to the caller.
pub(crate) struct Failure(pub(crate) cyl_status, pub(crate) String);

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        let status = match &error {
            Error::File(_) | Error::Io { .. } => cyl_status::CYL_FILE,
            Error::UnknownName { .. } => cyl_status::CYL_UNKNOWN_NAME,
            Error::Dimension { .. } => cyl_status::CYL_DIMENSION,
            Error::NotFinite { .. } | Error::OutOfRange { .. } => cyl_status::CYL_NOT_FINITE,
            Error::InvalidOption { .. } => cyl_status::CYL_INVALID_OPTION,
            Error::Model { .. } => cyl_status::CYL_MODEL,
            _ => cyl_status::CYL_OTHER,
        };
        Self(status, error.to_string())
    }
}

pub(crate) fn null(what: &str) -> Failure {
    Failure(cyl_status::CYL_NULL_OR_TEXT, format!("{what} is a null pointer"))
}

/// Runs a call: errors and panics become a status and a text.
pub(crate) fn guard(call: impl FnOnce() -> Result<(), Failure>) -> cyl_status {
    let outcome = catch_unwind(AssertUnwindSafe(call)).unwrap_or_else(|_| {
        let text = "a defect of cylindroid: please report it with what was called";
        Err(Failure(cyl_status::CYL_INTERNAL, text.to_owned()))
    });
    match outcome {
        Ok(()) => cyl_status::CYL_OK,
        Err(Failure(status, text)) => {
            // A text with zeros would end at the first.
            let text = CString::new(text.replace('\0', "?")).unwrap_or_default();
            LAST.with(|last| *last.borrow_mut() = text);
            status
        }
    }
}

/// The text of the last error of this thread; empty without one. Valid until the next call on this
/// thread that fails.
#[unsafe(no_mangle)]
pub extern "C" fn cyl_last_error() -> *const c_char {
    LAST.with(|last| last.borrow().as_ptr())
}

/// The version of the library, as "0.1.0".
#[unsafe(no_mangle)]
pub extern "C" fn cyl_version() -> *const c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}
