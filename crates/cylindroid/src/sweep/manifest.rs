//! `manifest.json` of a folder: the recipe, the columns, and the finished parts with their
//! checksums.
//!
//! Why so   written under another name and renamed, so that it is always whole; a part that is not
//!          in it is computed again
//! Checked  tests/sweep/folder.rs

use std::fs::{self, File};
use std::io::Write;
use std::path::Path;

use serde_json::{Value, json};

use super::checksum::Checksum;
use super::recipe::Recipe;
use super::table::Column;
use crate::error::{Error, Result};

/// The file in the folder.
pub(super) const MANIFEST: &str = "manifest.json";

/// Its name while it is written.
pub(super) const TEMPORARY: &str = ".manifest.json.tmp";

/// A finished part.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Part {
    /// Size of the file (bytes).
    pub bytes: u64,
    /// XXH3 of the file, 128 bits, hexadecimal: what `xxhsum -H128` prints.
    pub checksum: String,
}

impl Part {
    /// A part with this content.
    #[must_use]
    pub fn of(content: &[u8]) -> Self {
        Self { bytes: content.len() as u64, checksum: Checksum::of(content) }
    }
}

/// The name of a part.
pub(super) fn part_name(part: usize) -> String {
    format!("part-{part:06}.parquet")
}

/// The number of the part whose file has this name.
pub(super) fn part_number(name: &str) -> Option<usize> {
    name.strip_prefix("part-")?.strip_suffix(".parquet")?.parse().ok()
}

/// The manifest of a folder, if there is one.
pub(super) fn read(folder: &Path) -> Result<Option<Value>> {
    let path = folder.join(MANIFEST);
    if !path.exists() {
        return Ok(None);
    }
    let text = crate::model::read_regular_file(&path, 1 << 30)?;
    of_bytes(&path, &text).map(Some)
}

/// A manifest that was read from here.
pub(super) fn of_bytes(path: &Path, bytes: &[u8]) -> Result<Value> {
    serde_json::from_slice(bytes).map_err(|error| Error::Io {
        path: path.to_owned(),
        action: "read",
        message: format!("it is no manifest of a sweep: {error}"),
    })
}

/// The finished parts that a manifest lists, by their number.
pub(super) fn parts(manifest: &Value, count: usize) -> Vec<Option<Part>> {
    let mut parts = vec![None; count];
    for entry in manifest["parts"].as_array().into_iter().flatten() {
        let number = entry["file"].as_str().and_then(part_number);
        let own = number.and_then(|number| parts.get_mut(number));
        if let (Some(own), Some(bytes), Some(checksum)) =
            (own, entry["bytes"].as_u64(), entry["xxh128"].as_str())
        {
            *own = Some(Part { bytes, checksum: checksum.to_owned() });
        }
    }
    parts
}

/// The text of the manifest.
pub(super) fn text(
    (recipe, columns): (&Recipe, &[Column]),
    (rows, part_rows): (u64, u64),
    parts: &[Option<Part>],
) -> String {
    let column = |c: &Column| json!({"name": c.name, "unit": c.unit, "description": c.description});
    let entry = |(i, part): (usize, &Option<Part>)| {
        let part = part.as_ref()?;
        let first = i as u64 * part_rows;
        Some(json!({
            "file": part_name(i),
            "first_row": first,
            "rows": part_rows.min(rows - first),
            "bytes": part.bytes,
            "xxh128": part.checksum,
        }))
    };
    let manifest = json!({
        "recipe": recipe.0,
        "columns": columns.iter().map(column).collect::<Vec<_>>(),
        "rows": rows,
        "complete": parts.iter().all(Option::is_some),
        "parts": parts.iter().enumerate().filter_map(entry).collect::<Vec<_>>(),
    });
    format!("{manifest:#}\n")
}

/// Writes the manifest.
pub(super) fn write(folder: &Path, text: &str) -> Result<()> {
    let path = folder.join(MANIFEST);
    let temporary = folder.join(TEMPORARY);
    let written = File::create(&temporary).and_then(|mut file| {
        file.write_all(text.as_bytes())?;
        file.sync_all()?;
        fs::rename(&temporary, &path)?;
        sync_folder(folder)
    });
    written.map_err(|error| cannot_write(&path, &error))
}

/// Makes renamed files of a folder durable; Windows has nothing of the kind.
fn sync_folder(folder: &Path) -> std::io::Result<()> {
    if cfg!(unix) { File::open(folder)?.sync_all() } else { Ok(()) }
}

pub(super) fn cannot_write(path: &Path, error: &std::io::Error) -> Error {
    use std::io::ErrorKind::{FileTooLarge, QuotaExceeded, StorageFull};
    let full = matches!(error.kind(), StorageFull | QuotaExceeded | FileTooLarge);
    let hint = "; finished parts are kept, --resume continues after them";
    let message = format!("{error}{}", if full { hint } else { "" });
    Error::Io { path: path.to_owned(), action: "write", message }
}
