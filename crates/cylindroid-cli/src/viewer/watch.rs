//! Loads the model of the command again when one of its files has changed; pages show the new one,
//! or what is wrong with it beside the old one.
//!
//! Times and lengths of the files are compared twice a second. A change counts once they are the
//! same in two looks, so that a file is not read while it is being written.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, SystemTime};

use cylindroid::Result;
use cylindroid::model::files_read;
use serde::Serialize;

use super::assets::mesh_files;
use super::json::text;
use super::refusal::Refusal;
use super::sessions::Sessions;
use super::start::Start;

const INTERVAL: Duration = Duration::from_millis(500);
/// Times of files are those of a clock that may be late by this.
const TICK: Duration = Duration::from_millis(100);

/// The files of a model.
#[derive(Debug)]
pub(crate) struct Watch {
    files: Stamps,
    /// The time before which pages can have no mesh.
    since: SystemTime,
}

/// The sessions of the model, and its folder.
#[derive(Debug)]
pub(crate) struct Shown {
    sessions: Sessions,
    folder: Option<PathBuf>,
}

/// Time of the last change and length of files; `None` for a file that is not there.
type Stamps = BTreeMap<PathBuf, Option<(SystemTime, u64)>>;

/// The message `model`.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(tag = "type", rename = "model")]
pub(super) struct ModelJson {
    /// How often the model has been loaded again.
    reloads: u64,
    /// Why the newest version is not shown.
    problem: Option<Box<Refusal>>,
}

impl Watch {
    /// The start of a server, and a watch over all files that it was made from.
    pub(crate) fn of(load: impl FnOnce() -> Result<Start>) -> Result<(Start, Self)> {
        let now = SystemTime::now();
        let since = now.checked_sub(TICK).unwrap_or(now);
        let (start, read) = files_read(load);
        let start = start?;
        let files = files_of(Some(&start), &read).into_iter();
        Ok((start, Self { files: files.map(|file| (file.clone(), stamp(&file))).collect(), since }))
    }

    /// True for a model that is in no file.
    pub(crate) fn is_empty(&self) -> bool {
        self.files.is_empty()
    }

    /// Gives the sessions a new version of the model each time its files have changed, until `stop`
    /// is closed.
    pub(crate) fn keep(
        mut self,
        Shown { sessions, folder }: &Shown,
        load: impl Fn() -> Result<Start>,
        stop: &Receiver<()>,
    ) {
        let mut reloads = 0;
        let mut seen = self.files.clone();
        while stop.recv_timeout(INTERVAL) == Err(RecvTimeoutError::Timeout) {
            let now: Stamps = self.files.keys().map(|file| (file.clone(), stamp(file))).collect();
            let is_settled = std::mem::replace(&mut seen, now.clone()) == now;
            if !is_settled || now == self.files {
                continue;
            }
            self.files = now;
            let (start, read) = files_read(&load);
            let needed = files_of(start.as_ref().ok(), &read);
            if start.is_ok() {
                self.files.retain(|file, _| needed.contains(file));
            }
            for file in needed {
                self.files.entry(file).or_insert_with_key(|file| stamp(file));
            }
            seen = self.files.clone();
            let told = |reloads, problem| text(&ModelJson { reloads, problem }).into();
            let done = start.and_then(|start| {
                sessions.reload(Some(start.since(self.since)), told(reloads + 1, None))?;
                reloads += 1;
                Ok(())
            });
            if let Err(error) = done {
                let problem = Refusal::of(&error, folder.as_deref());
                let _ = sessions.reload(None, told(reloads, Some(problem)));
            }
        }
    }
}

impl Shown {
    /// `model` is the name of the file.
    pub(super) fn new(sessions: Sessions, model: &str) -> Self {
        let file = Path::new(model).canonicalize().ok();
        Self { sessions, folder: file.as_deref().and_then(Path::parent).map(Path::to_owned) }
    }
}

fn stamp(file: &Path) -> Option<(SystemTime, u64)> {
    let data = fs::metadata(file).ok()?;
    Some((data.modified().ok()?, data.len()))
}

/// The files that were read, the meshes of the model, and for a xacro file those beside it that it
/// may include.
fn files_of(start: Option<&Start>, read: &[PathBuf]) -> BTreeSet<PathBuf> {
    let meshes = start.into_iter().flat_map(|start| mesh_files(&start.mechanism));
    let is_xacro = |file: &&PathBuf| file.extension().is_some_and(|e| e == "xacro");
    let folders = read.iter().filter(is_xacro).filter_map(|file| file.parent());
    let folders =
        folders.map(|folder| if folder.as_os_str().is_empty() { Path::new(".") } else { folder });
    let beside = folders.filter_map(|folder| fs::read_dir(folder).ok()).flatten().flatten();
    let beside = beside.map(|entry| entry.path()).filter(|path| {
        path.extension().is_some_and(|e| ["xacro", "yaml", "yml"].iter().any(|one| e == *one))
    });
    read.iter().cloned().chain(meshes.map(Path::to_owned)).chain(beside).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The program xacro reads what a file includes, and names none of it.
    #[test]
    fn files_beside_a_xacro_file_are_watched() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        for name in ["arm.xacro", "macros.xacro", "values.yaml", "notes.md"] {
            fs::write(path(name), "").unwrap();
        }
        let wanted = ["arm.xacro", "macros.xacro", "values.yaml"].map(path);
        assert!(files_of(None, &[path("arm.xacro")]).into_iter().eq(wanted));
        assert!(files_of(None, &[path("notes.md")]).into_iter().eq([path("notes.md")]));
    }
}
