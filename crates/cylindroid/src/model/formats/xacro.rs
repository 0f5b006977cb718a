//! xacro: macros that write a URDF, expanded by ROS's own program where it is installed
//! (`pip install xacro`).
//!
//! Valid    files with the extension .xacro; without the program, and for text that has no file, the
//!          URDF reader refuses them with the command that expands them
//! Fails    what the program refuses; more than [`LARGEST_FILE`] of output, or more than
//!          [`LONGEST`]
//! Why so   xacro evaluates Python expressions, so nothing but Python expands all of it
//! Checked  tests/formats/load.rs

use std::io::{ErrorKind, Read};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use super::text_file::LARGEST_FILE;
use crate::error::{Error, Result};

/// Time for the program to answer.
const LONGEST: Duration = Duration::from_mins(1);

/// The URDF that a file expands to; `None` where the program is not installed.
pub(super) fn expand(path: &Path) -> Result<Option<String>> {
    let refuse = |message: String| Error::Io { path: path.to_owned(), action: "read", message };
    let mut program = Command::new("xacro");
    program.arg(path).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = match program.spawn() {
        Ok(child) => child,
        Err(e) if e.kind() == ErrorKind::NotFound => return Ok(None),
        Err(e) => return Err(refuse(format!("the program xacro does not start: {e}"))),
    };
    let (out, err) = (child.stdout.take(), child.stderr.take());
    let (text, message) = std::thread::scope(|scope| {
        let text = scope.spawn(|| read(out));
        let message = scope.spawn(|| read(err));
        let ended = wait(&mut child);
        let joined = (text.join().unwrap_or_default(), message.join().unwrap_or_default());
        ended.map(|succeeded| (succeeded.then_some(joined.0), joined.1))
    })
    .map_err(|message| refuse(format!("the program xacro {message}")))?;
    match text {
        Some(text) if text.len() as u64 <= LARGEST_FILE => {
            let wrong = |_| refuse("xacro wrote something that is not UTF-8".to_owned());
            String::from_utf8(text).map(Some).map_err(wrong)
        }
        Some(_) => {
            let limit = LARGEST_FILE >> 20;
            Err(refuse(format!("xacro wrote more than {limit} MiB, the limit of a model file")))
        }
        None => {
            let message = String::from_utf8_lossy(&message);
            let last = message.lines().rfind(|l| !l.trim().is_empty()).unwrap_or("no message");
            Err(refuse(format!("xacro refuses it: {}", last.trim())))
        }
    }
}

/// What a program writes, up to the limit of a model file.
fn read(from: Option<impl Read>) -> Vec<u8> {
    let mut bytes = Vec::new();
    if let Some(from) = from {
        // What was read before a fault is an incomplete file, which the reader refuses.
        let _ = from.take(LARGEST_FILE + 1).read_to_end(&mut bytes);
    }
    bytes
}

/// True if the program ended well; it is stopped after [`LONGEST`].
fn wait(child: &mut Child) -> std::result::Result<bool, String> {
    let start = Instant::now();
    loop {
        match child.try_wait() {
            Ok(Some(status)) => return Ok(status.success()),
            Ok(None) if start.elapsed() < LONGEST => std::thread::sleep(Duration::from_millis(5)),
            Ok(None) => {
                let _ = child.kill().and_then(|()| child.wait());
                return Err(format!("does not end within {} s", LONGEST.as_secs()));
            }
            Err(e) => return Err(format!("cannot be waited for: {e}")),
        }
    }
}
