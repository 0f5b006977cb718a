//! xacro: macros that write a URDF, expanded by ROS's own program where it is installed
//! (`pip install xacro`).
//!
//! Valid    files with the extension .xacro; without the program, and for text that has no file, the
//!          URDF reader refuses them with the command that expands them
//! Fails    what the program refuses; more than [`LARGEST_FILE`] of output, or more than
//!          [`LONGEST`]
//! Why so   xacro evaluates Python expressions, so nothing but Python expands all of it
//! Checked  tests/formats/load.rs (and xacro.rs of the tests of the command line)

use std::io::{ErrorKind, Read};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use super::text_file::LARGEST_FILE;
use crate::error::{Error, Result};

/// Time for the program to answer.
const LONGEST: Duration = Duration::from_mins(1);
/// Longest message of the program that is repeated, in characters.
const LONGEST_MESSAGE: usize = 1000;

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
        // A program that writes on when nobody reads any more fails for that reason alone.
        let is_long = joined.0.len() as u64 > LARGEST_FILE;
        ended.map(|succeeded| ((succeeded || is_long).then_some(joined.0), joined.1))
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
            Err(refuse(format!("xacro refuses it: {}", cause(&String::from_utf8_lossy(&message)))))
        }
    }
}

/// The last error of the program's messages with the places that follow it, in one line.
fn cause(messages: &str) -> String {
    let lines: Vec<&str> = messages.lines().map(str::trim).collect();
    let is_error = |line: &&str| {
        let kind = line.split_once(':').map(|(kind, _)| kind.to_ascii_lowercase());
        kind.is_some_and(|kind| kind.ends_with("error"))
    };
    let is_place = |line: &&str| {
        let starts = ["when ", "in file:", "instantiated from:", "included from:"];
        starts.iter().any(|start| line.starts_with(start))
    };
    let last = lines.iter().rposition(|line| !line.is_empty() && !is_place(line));
    let first = lines.iter().rposition(is_error).or(last).unwrap_or(0);
    let told = lines[first.min(lines.len())..].iter().take_while(|line| !line.is_empty());
    let told = told.map(|line| line.strip_prefix("error: ").unwrap_or(line).trim());
    let text = told.collect::<Vec<_>>().join("; ");
    match text.char_indices().nth(LONGEST_MESSAGE) {
        _ if text.is_empty() => "no message".to_owned(),
        None => text,
        Some((end, _)) => format!("{}...", &text[..end]),
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
