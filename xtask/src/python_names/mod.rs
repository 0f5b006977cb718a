//! Whether Python has what the library does: every public function and method of the library has a
//! namesake in the stub of the Python package, another name there, or a reason for its absence.
//!
//! Namesakes: of `module::function` a function of the package or a member of any class; of
//! `module::Type::method` a member of the class `Type` (of `new` and `of` its constructor), or a
//! function where Python has no such class. The others are lines of `crates/cylindroid-py/names.txt`.
//! Functions that macros define are not seen.

mod exceptions;
pub(crate) mod library;
mod stub;

use std::path::Path;

use anyhow::{Result, bail};

use self::exceptions::{Exception, Way};
use self::library::Function;
use self::stub::Names;

pub(crate) const LIBRARY: &str = "crates/cylindroid/src";
const STUB: &str = "crates/cylindroid-py/python/cylindroid/_core.pyi";
/// Functions of the library that are written in Python.
const SWEEPS: &str = "crates/cylindroid-py/python/cylindroid/_sweeps.py";
const EXCEPTIONS: &str = "crates/cylindroid-py/names.txt";

/// Compares the library with the stub.
///
/// # Errors
/// Functions without a name in Python and without a line, and lines that are not needed.
pub(crate) fn check() -> Result<()> {
    let root = &crate::shell::root();
    let faults = faults(root)?;
    if faults.is_empty() {
        return Ok(());
    }
    bail!(
        "{} faults; write a function for Python, or a line of {EXCEPTIONS}:\n  {}",
        faults.len(),
        faults.join("\n  ")
    )
}

fn faults(root: &Path) -> Result<Vec<String>> {
    let functions = library::public_functions(&root.join(LIBRARY))?;
    let names = Names::parse(&[read(root, STUB)?, read(root, SWEEPS)?].concat());
    let exceptions = exceptions::parse(&read(root, EXCEPTIONS)?)?;
    Ok(compare(&functions, &names, &exceptions))
}

fn read(root: &Path, file: &str) -> Result<String> {
    use anyhow::Context;
    std::fs::read_to_string(root.join(file)).with_context(|| file.to_owned())
}

/// Functions without a name, and lines that are wrong or not needed.
fn compare(functions: &[Function], names: &Names, exceptions: &[Exception]) -> Vec<String> {
    let mut faults = Vec::new();
    let mut needed = vec![false; exceptions.len()];
    for function in functions {
        if names.has_namesake(function) {
            continue;
        }
        let path = function.path();
        // The most specific line decides.
        let line = (0..exceptions.len())
            .filter(|&i| exceptions[i].covers(&path))
            .max_by_key(|&i| exceptions[i].pattern.len());
        match line {
            Some(i) => needed[i] = true,
            None => faults.push(format!("{path} has no name in Python and no line")),
        }
    }
    for (exception, needed) in exceptions.iter().zip(needed) {
        let Exception { line, pattern, way } = exception;
        match way {
            Way::Name(name) if !names.contains(name) => {
                faults.push(format!("line {line}: Python has no '{name}' for {pattern}"));
            }
            _ if !needed => faults.push(format!(
                "line {line}: {pattern} is not needed: no such function, or Python has its name"
            )),
            _ => {}
        }
    }
    faults
}

#[cfg(test)]
mod tests {
    use super::{Names, compare, exceptions, library};

    const STUB: &str = "\
class Screw:
    def __new__(cls, twist: ArrayLike) -> Screw: ...
    @property
    def pitch(self) -> float: ...
    def moved(
        self,
        by: float,
    ) -> Screw: ...

def gram(J: ArrayLike, h: float) -> _Array: ...
";

    fn told(library: &str, lines: &str) -> Vec<String> {
        let root = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| std::fs::write(root.path().join(name), text).unwrap();
        write("lib.rs", "pub mod screws;\nmod inner;\npub use screws::Screw;\n");
        write("screws.rs", library);
        write("inner.rs", "pub fn hidden() {}\n");
        let functions = library::public_functions(root.path()).unwrap();
        compare(&functions, &Names::parse(STUB), &exceptions::parse(lines).unwrap())
    }

    #[test]
    fn namesakes_need_no_line() {
        let library = "pub struct Screw;\nimpl Screw { pub fn of() {} pub fn pitch(&self) {} fn own(&self) {} }\n\
                       pub fn gram() {}\npub fn moved() {}\npub(crate) fn inner() {}\n\
                       struct Own;\nimpl Own { pub fn x(&self) {} }\n\
                       impl Clone for Screw { fn clone(&self) -> Self { Screw } }\n\
                       #[cfg(test)]\nmod tests { pub fn y() {} }\n";
        assert!(told(library, "# nothing\n").is_empty());
        let line = "screws::gram : numpy\n";
        assert_eq!(
            told(library, line),
            ["line 1: screws::gram is not needed: no such function, or Python has its name"]
        );
    }

    #[test]
    fn others_need_a_name_or_a_reason() {
        let library = "pub struct Screw;\nimpl Screw { pub fn at() {} pub fn axis(&self) {} }\n";
        assert_eq!(
            told(library, "screws::Screw::at -> Screw\n"),
            ["screws::Screw::axis has no name in Python and no line"]
        );
        assert_eq!(
            told(library, "screws::Screw::at -> Line\nscrews::Screw::* : numpy\n"),
            ["line 1: Python has no 'Line' for screws::Screw::at"]
        );
        assert!(told(library, "screws::* : numpy\nscrews::Screw::at -> Screw\n").is_empty());
        assert_eq!(told(library, "screws::Screw::* : numpy\nlinalg::* : numpy\n").len(), 1);
    }

    #[test]
    fn lines_are_checked() {
        for bad in ["screws::Screw\n", "screws::Screw : \n", "a : x\na : y\n", "a ->\n"] {
            assert!(exceptions::parse(bad).is_err(), "{bad}");
        }
    }
}
