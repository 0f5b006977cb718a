//! Commands that are programs of their own, as in git: `cylindroid ros2` is `cylindroid-ros2`, so
//! that this program does not carry what only they need.

use std::env::consts::EXE_SUFFIX;
use std::ffi::{OsStr, OsString};
use std::io::ErrorKind;
use std::path::Path;
use std::process::Command;

use anyhow::{Context, bail};

use crate::exit::Exit;

const PROGRAMS: [&str; 1] = ["ros2"];

/// The program of a command line, if it is another one, with the words for it.
pub(crate) fn named(words: &[OsString]) -> Option<(&'static str, &[OsString])> {
    let [_, command, rest @ ..] = words else { return None };
    PROGRAMS.into_iter().find(|name| command == name).map(|name| (name, rest))
}

/// Runs the program: that beside this one, otherwise that of the PATH.
pub(crate) fn run(name: &str, words: &[OsString]) -> anyhow::Result<Exit> {
    let file = format!("cylindroid-{name}{EXE_SUFFIX}");
    let beside = std::env::current_exe().ok().map(|own| own.with_file_name(&file));
    let beside = beside.filter(|path| path.is_file());
    let path = beside.as_deref().map_or(OsStr::new(&file), Path::as_os_str);
    start(Command::new(path).args(words)).or_else(|error| {
        if error.kind() != ErrorKind::NotFound {
            return Err(error).context(path.display().to_string());
        }
        bail!(
            "`cylindroid {name}` is a program of its own, cylindroid-{name}, which is neither \
             beside this one nor in the PATH; install it with `cargo install cylindroid-{name}`, or \
             in the repository with `cargo install --path crates/cylindroid-{name}`"
        )
    })
}

/// In place of this process, which signals then reach.
#[cfg(unix)]
fn start(command: &mut Command) -> std::io::Result<Exit> {
    use std::os::unix::process::CommandExt;
    Err(command.exec())
}

#[cfg(not(unix))]
fn start(command: &mut Command) -> std::io::Result<Exit> {
    let code = command.status()?.code().and_then(|code| u8::try_from(code).ok());
    Ok(code.map_or(Exit::ERROR, Exit::of))
}
