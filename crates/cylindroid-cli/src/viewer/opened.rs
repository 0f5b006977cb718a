//! Models that the page opens besides that of the command: those of the catalogue, and files that
//! it sends, which lie in a temporary folder as long as the model is open.

use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use cylindroid::{Error, Mechanism, catalogue};
use serde::{Deserialize, Serialize};
use tempfile::TempDir;

use super::refusal::Refusal;
use super::sessions::Sessions;
use super::start::{Start, StartBodies};

/// Maximum size of the files of a model together [bytes].
pub(super) const LARGEST: usize = 256 << 20;
/// Maximum number of files of a model.
const MOST_FILES: usize = 2000;
/// Maximum number of models that are open at a time; those without sessions make room.
const MOST_MODELS: usize = 16;
/// Extensions of model files. A xacro file would be a program.
const MODELS: [&str; 5] = ["urdf", "xml", "mjcf", "sdf", "toml"];

/// The models that are open.
#[derive(Debug, Default)]
pub(super) struct Opened {
    models: Mutex<Models>,
}

#[derive(Debug, Default)]
struct Models {
    count: usize,
    open: Vec<Model>,
}

#[derive(Debug)]
struct Model {
    id: String,
    sessions: Sessions,
    /// Its files, removed with it.
    _folder: Option<TempDir>,
}

/// A model that is open.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "OpenedModel"))]
pub(super) struct Known {
    id: String,
    name: String,
}

/// A model of the catalogue.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "OfferedModel"))]
pub(super) struct Offer {
    name: &'static str,
    description: String,
}

/// What is to be opened: the first line of a request, as JSON; the bytes of the files follow.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Head {
    /// A model of the catalogue, or one of the files.
    open: String,
    /// Paths and sizes [bytes].
    #[serde(default)]
    files: Vec<(String, usize)>,
}

/// Paths and contents.
type Files<'a> = Vec<(PathBuf, &'a [u8])>;

impl Opened {
    /// Those that are open, in the order of their opening.
    pub(super) fn known(&self) -> Vec<Known> {
        let known = |model: &Model| {
            let name = model.sessions.start().mechanism.name().to_owned();
            Known { id: model.id.clone(), name }
        };
        self.models().open.iter().map(known).collect()
    }

    /// The sessions of a model.
    pub(super) fn sessions(&self, id: &str) -> Option<Sessions> {
        let models = self.models();
        Some(models.open.iter().find(|model| model.id == id)?.sessions.clone())
    }

    /// Opens the model of a request, beside these sessions.
    pub(super) fn open(&self, beside: &Sessions, body: &[u8]) -> Result<Known, Box<Refusal>> {
        let (head, files) = read(body)?;
        if files.is_empty() {
            let names: Vec<&str> = catalogue::entries().into_iter().map(|e| e.name).collect();
            if !names.contains(&head.open.as_str()) {
                return Err(Refusal::of(&Error::unknown("model", &head.open, names), None));
            }
            let loaded = cylindroid::load(&head.open);
            return loaded
                .and_then(|mechanism| self.keep(beside, mechanism, &head.open, None))
                .map_err(|error| Refusal::of(&error, None));
        }
        let (folder, path) = unpack(&files).map_err(|error| {
            Refusal::new(format!("the files cannot be kept: {error}"), "free space on the server")
        })?;
        let file = path.join(&head.open);
        // The folder is there until the line at fault has been read.
        let refuse = |error: Error| Refusal::of(&error, Some(&path));
        let mechanism = cylindroid::load_file(&file).map_err(refuse)?;
        self.keep(beside, mechanism, &file.to_string_lossy(), Some(folder)).map_err(refuse)
    }

    fn keep(
        &self,
        beside: &Sessions,
        mechanism: Mechanism,
        file: &str,
        folder: Option<TempDir>,
    ) -> cylindroid::Result<Known> {
        let frame = if mechanism.is_closed() { mechanism.reference() } else { mechanism.tool() };
        let q = mechanism.home().to_vec();
        let mut start =
            Start::new((mechanism, file), &q, frame.into(), &[], StartBodies::default())?;
        let mut models = self.models();
        if models.open.len() >= MOST_MODELS {
            let unused = models.open.iter().position(|model| !model.sessions.are_in_use());
            let Some(unused) = unused else {
                return Err(Error::InvalidOption {
                    option: "models",
                    value: MOST_MODELS.to_string(),
                    reason: "so many are open; close the pages of one of them".to_owned(),
                });
            };
            models.open.remove(unused);
        }
        models.count += 1;
        let (id, name) = (models.count.to_string(), start.mechanism.name().to_owned());
        start.folders = start.folders.below(&beside.start().folders, &format!("models/{id}"));
        let known = Known { id: id.clone(), name };
        models.open.push(Model { id, sessions: beside.beside(start), _folder: folder });
        Ok(known)
    }

    fn models(&self) -> MutexGuard<'_, Models> {
        self.models.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The catalogue.
pub(super) fn offers() -> Vec<Offer> {
    let offer = |e: catalogue::Entry| Offer { name: e.name, description: e.description };
    catalogue::entries().into_iter().map(offer).collect()
}

/// The parts of a request; every path is a plain one below a folder.
fn read(body: &[u8]) -> Result<(Head, Files<'_>), Box<Refusal>> {
    let refuse = |message: String| Refusal::new(message, "see docs/viewer.md");
    let end = body.iter().position(|byte| *byte == b'\n').unwrap_or(body.len());
    let (head, mut rest) = (&body[..end], body.get(end + 1..).unwrap_or_default());
    let head: Head = serde_json::from_slice(head)
        .map_err(|error| refuse(format!("the first line of the request is refused: {error}")))?;
    if head.files.len() > MOST_FILES {
        let count = head.files.len();
        let help = "leave out files that the model does not refer to";
        return Err(Refusal::new(format!("{count} files are more than {MOST_FILES}"), help));
    }
    let mut files = Vec::with_capacity(head.files.len());
    for (name, size) in &head.files {
        let path = Path::new(name);
        let is_plain = |c: Component<'_>| match c {
            Component::Normal(part) => !part.as_encoded_bytes().starts_with(b"."),
            _ => false,
        };
        if name.is_empty() || name.contains(['\\', '\0']) || !path.components().all(is_plain) {
            return Err(refuse(format!("'{name}' is not a path below the folder of a model")));
        }
        let Some((bytes, more)) = rest.split_at_checked(*size) else {
            return Err(refuse(format!("'{name}' has fewer bytes than the {size} announced")));
        };
        files.push((path.to_owned(), bytes));
        rest = more;
    }
    if !rest.is_empty() {
        return Err(refuse(format!("{} bytes belong to no file", rest.len())));
    }
    let extension = Path::new(&head.open).extension().and_then(|e| e.to_str());
    let is_model = extension.is_some_and(|e| MODELS.iter().any(|m| e.eq_ignore_ascii_case(m)));
    let is_there = head.files.iter().any(|(name, _)| *name == head.open);
    if !(head.files.is_empty() || is_model && is_there) {
        let (kinds, name) = (MODELS.join(", "), &head.open);
        let help = "expand xacro files first: xacro robot.urdf.xacro > robot.urdf";
        let what = format!("'{name}' is none of the model files of the request ({kinds})");
        return Err(Refusal::new(what, help));
    }
    Ok((head, files))
}

/// Writes the files to a folder of their own; gives its path with links resolved.
fn unpack(files: &Files<'_>) -> io::Result<(TempDir, PathBuf)> {
    let folder = TempDir::with_prefix("cylindroid-")?;
    let path = folder.path().canonicalize()?;
    for (name, bytes) in files {
        let file = path.join(name);
        fs::create_dir_all(file.parent().unwrap_or(&path))?;
        fs::write(file, bytes)?;
    }
    Ok((folder, path))
}
