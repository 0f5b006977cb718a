//! Models that the page opens besides that of the command: those of the catalogue, and files that
//! it sends, which lie in a temporary folder as long as the model is open.
//!
//! The id of a model is random, so that a server that was restarted has no other model of this id.
//! Pages keep the request that opened it, and send it again.

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use cylindroid::{Error, Mechanism, catalogue};
use serde::{Deserialize, Serialize};
use tempfile::TempDir;

use super::json::text;
use super::names::random_name;
use super::refusal::Refusal;
use super::sessions::Sessions;
use super::start::{Start, StartBodies};

/// Maximum size of the files of a model together [bytes].
pub(super) const LARGEST: usize = 256 << 20;
/// Maximum number of files of a model.
const MOST_FILES: usize = 2000;
/// Longest path of a file and of each part of it [bytes], less than systems permit with the folder.
const LONGEST_PATH: usize = 900;
const LONGEST_PART: usize = 255;
/// Maximum number of models that are open at a time; those without sessions make room.
const MOST_MODELS: usize = 16;
/// Extensions of model files. A xacro file would be a program.
const MODELS: [&str; 5] = ["urdf", "xml", "mjcf", "sdf", "toml"];
/// Random bytes of an id.
const ID: usize = 8;

/// The models that are open.
#[derive(Debug, Default)]
pub(super) struct Opened {
    models: Mutex<Vec<Model>>,
}

#[derive(Debug)]
struct Model {
    id: String,
    sessions: Sessions,
    head: Head,
    /// Its files, removed with it.
    folder: Option<TempDir>,
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
#[derive(Debug, Clone, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct Head {
    /// A model of the catalogue, or one of the files.
    open: String,
    /// Paths and sizes [bytes].
    #[serde(default)]
    files: Vec<(String, usize)>,
    /// That of the model before the server was restarted.
    #[serde(default)]
    id: Option<String>,
}

/// Paths and contents.
type Files<'a> = Vec<(PathBuf, &'a [u8])>;

impl Opened {
    /// Those that are open, in the order of their opening.
    pub(super) fn known(&self) -> Vec<Known> {
        self.models().iter().map(Model::known).collect()
    }

    /// The sessions of a model.
    pub(super) fn sessions(&self, id: &str) -> Option<Sessions> {
        let models = self.models();
        Some(models.iter().find(|model| model.id == id)?.sessions.clone())
    }

    /// The request that opens a model again.
    pub(super) fn request(&self, id: &str) -> Option<Vec<u8>> {
        let (head, folder) = {
            let models = self.models();
            let model = models.iter().find(|model| model.id == id)?;
            let folder = model.folder.as_ref().map(|folder| folder.path().to_owned());
            (model.head.clone(), folder)
        };
        let mut request = text(&head).into_bytes();
        request.push(b'\n');
        for (name, _) in &head.files {
            request.extend(fs::read(folder.as_ref()?.join(name)).ok()?);
        }
        Some(request)
    }

    /// Opens the model of a request, beside these sessions, unless one of its id is open.
    pub(super) fn open(&self, beside: &Sessions, body: &[u8]) -> Result<Known, Box<Refusal>> {
        let (mut head, files) = read(body)?;
        let id = match head.id.take() {
            Some(id) => id,
            None => random_name::<ID>().map_err(|error| {
                Refusal::new(format!("the model gets no id: {error}"), "try it again")
            })?,
        };
        if let Some(model) = self.models().iter().find(|model| model.id == id) {
            return Ok(model.known());
        }
        head.id = Some(id.clone());
        let open = head.open.clone();
        if files.is_empty() {
            let names: Vec<&str> = catalogue::entries().into_iter().map(|e| e.name).collect();
            if !names.contains(&open.as_str()) {
                return Err(Refusal::of(&Error::unknown("model", &open, names), None));
            }
            let loaded = cylindroid::load(&open);
            return loaded
                .and_then(|mechanism| self.keep(beside, (mechanism, &open), (id, head), None))
                .map_err(|error| Refusal::of(&error, None));
        }
        let (folder, path) = unpack(&files).map_err(|error| {
            Refusal::new(format!("the files cannot be kept: {error}"), "free space on the server")
        })?;
        let file = path.join(&open);
        // The folder is there until the line at fault has been read.
        let refuse = |error: Error| Refusal::of(&error, Some(&path));
        let mechanism = cylindroid::load_file(&file).map_err(refuse)?;
        let file = file.to_string_lossy();
        self.keep(beside, (mechanism, &file), (id, head), Some(folder)).map_err(refuse)
    }

    fn keep(
        &self,
        beside: &Sessions,
        (mechanism, file): (Mechanism, &str),
        (id, head): (String, Head),
        folder: Option<TempDir>,
    ) -> cylindroid::Result<Known> {
        let frame = if mechanism.is_closed() { mechanism.reference() } else { mechanism.tool() };
        let q = mechanism.home().to_vec();
        let mut start =
            Start::new((mechanism, file), &q, frame.into(), &[], StartBodies::default())?;
        let mut models = self.models();
        // Another page may have opened it again meanwhile.
        if let Some(model) = models.iter().find(|model| model.id == id) {
            return Ok(model.known());
        }
        if models.len() >= MOST_MODELS {
            let unused = models.iter().position(|model| !model.sessions.are_in_use());
            let Some(unused) = unused else {
                return Err(Error::InvalidOption {
                    option: "models",
                    value: MOST_MODELS.to_string(),
                    reason: "so many are open; close the pages of one of them".to_owned(),
                });
            };
            models.remove(unused);
        }
        start.folders = start.folders.below(&beside.start().folders, &format!("models/{id}"));
        let model = Model { id, sessions: beside.beside(start), head, folder };
        let known = model.known();
        models.push(model);
        Ok(known)
    }

    fn models(&self) -> MutexGuard<'_, Vec<Model>> {
        self.models.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Model {
    fn known(&self) -> Known {
        let name = self.sessions.start().mechanism.name().to_owned();
        Known { id: self.id.clone(), name }
    }
}

/// The catalogue.
pub(super) fn offers() -> Vec<Offer> {
    let offer = |e: catalogue::Entry| Offer { name: e.name, description: e.description };
    catalogue::entries().into_iter().map(offer).collect()
}

/// The parts of a request; every path is a plain one below a folder, and no two are the same.
fn read(body: &[u8]) -> Result<(Head, Files<'_>), Box<Refusal>> {
    let refuse = |message: String| Refusal::new(message, "see docs/viewer.md");
    let end = body.iter().position(|byte| *byte == b'\n').unwrap_or(body.len());
    let (head, mut rest) = (&body[..end], body.get(end + 1..).unwrap_or_default());
    let head: Head = serde_json::from_slice(head)
        .map_err(|error| refuse(format!("the first line of the request is refused: {error}")))?;
    let is_id = |id: &String| id.len() == 2 * ID && id.bytes().all(|b| b.is_ascii_hexdigit());
    if !head.id.iter().all(is_id) {
        return Err(refuse(format!("the id of a model has {} digits in hexadecimal", 2 * ID)));
    }
    if head.files.len() > MOST_FILES {
        let count = head.files.len();
        let help = "leave out files that the model does not refer to";
        return Err(Refusal::new(format!("{count} files are more than {MOST_FILES}"), help));
    }
    let mut files = Vec::with_capacity(head.files.len());
    let mut paths = BTreeSet::new();
    for (name, size) in &head.files {
        let path = Path::new(name);
        let is_plain = |c: Component<'_>| match c {
            Component::Normal(part) => !part.as_encoded_bytes().starts_with(b"."),
            _ => false,
        };
        if name.is_empty() || name.contains(['\\', '\0']) || !path.components().all(is_plain) {
            return Err(refuse(format!("'{name}' is not a path below the folder of a model")));
        }
        let part = path.components().map(|c| c.as_os_str().len()).max().unwrap_or(0);
        if name.len() > LONGEST_PATH || part > LONGEST_PART {
            let what =
                format!("the path '{name:.40}...' has {} bytes, {part} in a part", name.len());
            let help = format!("at most {LONGEST_PATH} are possible, and {LONGEST_PART} in a part");
            return Err(Refusal::new(what, &help));
        }
        // Paths are compared by their parts: a//b is a/b.
        if !paths.insert(path) {
            return Err(refuse(format!("'{name}' is twice among the files")));
        }
        let Some((bytes, more)) = rest.split_at_checked(*size) else {
            return Err(refuse(format!("'{name}' has fewer bytes than the {size} announced")));
        };
        files.push((path.to_owned(), bytes));
        rest = more;
    }
    for (path, _) in &files {
        if let Some(file) = path.ancestors().skip(1).find(|folder| paths.contains(folder)) {
            let (path, file) = (path.display(), file.display());
            return Err(refuse(format!("'{path}' is below '{file}', which is a file too")));
        }
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
